/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The RVE as one element of a macroscale mesh: condensed to the nodes of its faces. */
#ifndef PERIHOM_SUPERELEMENT_H
#define PERIHOM_SUPERELEMENT_H

#include <perihom/homogenise.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Static condensation of an RVE to the nodes that it shares with its neighbours. K is the
 *  matrix of the energy of the RVE alone: of its points (stress points, finite elements,
 *  nodes of nosb) with their whole families, or of its bonds, those that leave it by half. A
 *  macroscale body is then the sum of its superelements, every energy counted once. With b
 *  the nodes that are kept and i those inside, free of forces,
 *
 *      S = K_bb - K_bi K_ii^-1 K_ib,   u_i = -K_ii^-1 K_ib u_b
 *
 *  Kept is a boundary volume: the reach of the family inside the RVE and as much outside
 *  (finite elements and smallest families: the one layer on the faces). S is exact for any
 *  displacement of these nodes, symmetric, positive semidefinite, and rigid motions cost
 *  nothing. Owns its arrays. */
typedef struct ph_superelement {
    ph_kinematics kinematics;
    int nd;                /* components of displacement, 2 or 3 */
    int strains;           /* generalised plane strain: 1, the macro strain 33; else 0 */
    ptrdiff_t nodes;       /* that are kept */
    double (*position)[3]; /* [nodes] from the lower corner of the RVE */
    double
        *stiffness; /* [n][n], n = nd * nodes + strains: row nd * node + component; force
                        * over displacement (2D: per unit of thickness); last, of strain 33,
                        * volume times stress 33 */
    ptrdiff_t condensed; /* displacements that were eliminated */
    ph_sym4 linear;      /* effective stiffness, u = eps x on what is kept; Mandel */
    ph_sym4 periodic; /* and with u - eps x periodic; both as of ph_homogenise, the collar
                          * inside, with what `auto` chooses under linear_displacement */
} ph_superelement;

enum { PH_SUPERELEMENT_MOST = 8000 }; /* displacements that are kept: 0.5 GB */

/** Condense a cell. Both effective stiffnesses come from the one factorisation.
 *  @param[in] problem any model; constraint and solver are not looked at; no cracks
 *  @return PH_OK; PH_EINVAL (cracks, one cell along an axis or fewer than the family needs,
 *          more than PH_SUPERELEMENT_MOST); PH_ESINGULAR (a piece inside that nothing holds);
 *          PH_ENOMEM. Cost: a factorisation and one solution per displacement that is kept.
 *  Ref: [Galadima2023] ch. 4. Tested: tests/cross/test_superelement.c */
PH_API ph_status ph_superelement_new(const ph_problem *problem, const ph_ctx *ctx,
                                     ph_superelement **out, ph_error *err);
PH_API void ph_superelement_free(ph_superelement **element);
/** Matrix Market text (array real symmetric), the nodes and where they are as comments;
 *  malloc'd. @return PH_OK; PH_EINVAL; PH_ENOMEM. */
PH_API ph_status ph_superelement_to_mtx(const ph_superelement *element, char **text,
                                        ph_error *err);
/** HDF5: /stiffness/{data, indices, indptr} (compressed rows as of scipy.sparse.csr_matrix,
 *  zeros left out, attribute shape), /position [nodes][3], /linear and /periodic (Voigt), and
 *  attributes components, strains, kinematics. @return PH_OK; PH_EINVAL; PH_EIO; PH_ENOMEM. */
PH_API ph_status ph_superelement_write_h5(const ph_superelement *element,
                                          const char *path, ph_error *err);

#ifdef __cplusplus
}
#endif
#endif
