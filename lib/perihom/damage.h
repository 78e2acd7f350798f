/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PERIHOM_DAMAGE_H
#define PERIHOM_DAMAGE_H

#include <perihom/crack.h>

#ifdef __cplusplus
extern "C" {
#endif

/** What changes from step to step. */
typedef enum ph_sequence_kind {
    PH_SEQUENCE_NONE,    /* the cracks as they are: one step */
    PH_SEQUENCE_GROWTH,  /* some cracks have a new length in every step */
    PH_SEQUENCE_DENSITY, /* more and more of the cracks are there */
    PH_SEQUENCE_LOADING  /* of a result: bonds break under a load, see failure.h */
} ph_sequence_kind;

/** Steps of prescribed damage. Bonds do not heal: values must not fall. Borrows its arrays. */
typedef struct ph_crack_sequence {
    ph_sequence_kind kind;
    int nsteps;
    const double
        *value;        /* [nsteps] crack length (each growing crack), or crack density */
    const bool *grows; /* growth: [cracks->count] */
    ph_crack_tip tip;  /* growth */
    ptrdiff_t first;   /* density: cracks before this one are always there and count; of
                          * the others the first so many that the density of the set is the
                          * nearest to the value */
} ph_crack_sequence;

typedef struct ph_damage_step {
    double value;      /* of the sequence or the load; NaN without one */
    double density;    /* ph_cracks_density of the cracks that are there */
    double surface;    /* ph_cracks_surface of them; bonds that broke do not count */
    ph_sym4 stiffness; /* secant, Mandel */
    /* d stress / d strain. Without a loading, and where no bond broke since the step before,
     * it is the secant: between breaks the cell is linear. Else the slope of the curve
     * between the two steps, as the symmetric tensor C - t (A E)(A E) / (E : A : E) that gives
     * it along the load E: A what the stiffness lost on the way, t = load before / (load -
     * load before). NaN where some strains are found by zero stress. Mandel */
    ph_sym4 tangent;
    double psi[3];       /* E_n of this step over E_n without cracks, as many as axes */
    double tensor[3];    /* D_n = 1 - sqrt(psi_n), see ph_damaged_stiffness */
    double tensor_error; /* |C(D) - C| over the pristine |C| */
    double anisotropy;   /* of the stiffness, ph_anisotropy_index */
    double mean_damage;  /* over the nodes of the RVE: weight of broken bonds over all */
    ptrdiff_t broken_bonds, damaged_nodes;
    ptrdiff_t mute_nodes;        /* carry no stress: too few bonds are left */
    int iterations;              /* of all loads */
    double residual;             /* the worst of the loads */
    double stabilisation_energy; /* the worst of the loads: share of the energy */
    double strain[6]; /* of a loading: macro strain, Voigt, engineering shear */
    /* Where fields are kept: damage of every node of the RVE [cells], and those of the loads
     * as of ph_result, which itself has those of the last step. Else NULL */
    double *field;
    int nfields;
    struct ph_fields *fields;
} ph_damage_step;

/** What cracks did. Owns its arrays. */
typedef struct ph_damage {
    ph_sequence_kind kind;
    ph_sym4 pristine; /* without cracks, Mandel */
    int nsteps;
    ph_damage_step *step;
    double *field; /* [cells of the RVE] damage of every node in the last step, 0 .. 1 */
    struct ph_error_bar *error_bars; /* [nsteps] as in ph_result, or NULL */
    struct ph_error_bar *pristine_error_bar;
} ph_damage;

PH_API void ph_damage_free(ph_damage **damage);

/** Elastic anisotropy index of a stiffness, 0 if and only if it is isotropic.
 *
 *  2D (n = 3):  A^2 = [1/4 (C11+C22+2C12)(S11+S22+2S12) - 1]^2
 *                   + 2 [1/16 (C11+C22-2C12+4C66)(S11+S22-2S12+S66) - 1]^2
 *  3D (n = 6):  the universal log-Euclidean one: A^2 = [ln KV/KR]^2 + 5 [ln GV/GR]^2
 *
 *  The source of the 2D index prints 1/6 for 1/16, which does not vanish for an isotropic
 *  tensor. Infinity where the stiffness has no inverse.
 *  Ref: 2D [Galadima2023] (7-1) after [Li2020]; 3D [Kube2016]. */
PH_API double ph_anisotropy_index(const ph_sym4 *stiffness);
/** The stiffness that a damage tensor with principal axes 1, 2 (, 3) leaves:
 *
 *      C(D) = M C_0 M,  M = diag(1 - D_n; shears: sqrt((1 - D_i) (1 - D_j))), Mandel
 *
 *  E_n is (1 - D_n)^2 of what it was. Positive semidefinite for all D <= 1, exact for no
 *  damage and for none but axial moduli in general: ph_damage_step has the error.
 *  @param[in] D [3] or [2], <= 1. @return n = 0 where something is missing
 *  Ref: [Cordebois1982] (energy equivalence). Tested: tests/laws/test_damage_law.c */
PH_API ph_sym4 ph_damaged_stiffness(const ph_sym4 *pristine, const double *D);
/** Young's modulus along axis n = 0, 1, 2 (2D: 0, 1) of a stiffness that may be singular:
 *  the least energy of a unit strain n with all other strains free, 0 if it costs nothing. */
PH_API double ph_axial_modulus(const ph_sym4 *stiffness, int axis);

#ifdef __cplusplus
}
#endif
#endif
