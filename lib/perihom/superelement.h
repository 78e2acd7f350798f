/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The RVE as one element of a macroscale mesh: condensed to the nodes of its faces. */
#ifndef PERIHOM_SUPERELEMENT_H
#define PERIHOM_SUPERELEMENT_H

#include <perihom/homogenise.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Static condensation of the RVE cut from the material. With b the nodes on its faces and i
 *  those inside, free of forces,
 *
 *      S = K_bb - K_bi K_ii^-1 K_ib,   u_i = -K_ii^-1 K_ib u_b
 *
 *  S is exact for any displacement of the faces. It is symmetric, positive semidefinite, and
 *  rigid motions cost nothing. Owns its arrays. */
typedef struct ph_superelement {
    ph_kinematics kinematics;
    int nd;                /* components of displacement, 2 or 3 */
    ptrdiff_t nodes;       /* on the faces */
    double (*position)[3]; /* [nodes] from the lower corner of the RVE */
    double *stiffness;   /* [n][n], n = nd * nodes: row nd * node + component; force over
                           * displacement (2D: per unit of thickness) */
    ptrdiff_t condensed; /* displacements that were eliminated */
    ph_sym4 linear;      /* effective stiffness, u = eps x on the faces; Mandel */
    ph_sym4 periodic;    /* and with u - eps x periodic: that of ph_homogenise */
} ph_superelement;

enum { PH_SUPERELEMENT_MOST = 8000 }; /* displacements of the faces: 0.5 GB */

/** Condense the finite elements of a cell (model `local`) to its faces. Both effective
 *  stiffnesses come from the one factorisation.
 *  @param[in] problem model.kind "local"; constraint and solver are not looked at; no cracks
 *  @return PH_OK; PH_EINVAL (another model, generalised plane strain, which has a strain that
 *          is no displacement of a node, cracks, more than PH_SUPERELEMENT_MOST); PH_ESINGULAR
 *          (a piece inside that nothing holds); PH_ENOMEM.
 *  Cost: a factorisation and one solution per displacement of the faces.
 *  Ref: [Galadima2023] ch. 4. Tested: tests/cross/test_superelement.c */
PH_API ph_status ph_superelement_new(const ph_problem *problem, const ph_ctx *ctx,
                                     ph_superelement **out, ph_error *err);
PH_API void ph_superelement_free(ph_superelement **element);
/** Matrix Market text (array real symmetric), the nodes and where they are as comments;
 *  malloc'd. @return PH_OK; PH_EINVAL; PH_ENOMEM. */
PH_API ph_status ph_superelement_to_mtx(const ph_superelement *element, char **text,
                                        ph_error *err);

#ifdef __cplusplus
}
#endif
#endif
