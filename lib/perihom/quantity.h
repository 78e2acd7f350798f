/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scalar quantities of a result by name: what campaigns average and calibrations fit. */
#ifndef PERIHOM_QUANTITY_H
#define PERIHOM_QUANTITY_H

#include <perihom/catalogue.h>
#include <perihom/homogenise.h>

#ifdef __cplusplus
extern "C" {
#endif

struct ph_quantity_kind;

/** One quantity, as ph_quantity_find understood its name. A value; borrows nothing. */
typedef struct ph_quantity {
    const struct ph_quantity_kind *kind;
    char name[96];     /* as asked for */
    int row, column;   /* components 0..5 (order 11 22 33 23 13 12) or axes, by kind */
    char argument[64]; /* fraction.NAME: the material */
    double at;         /* time or angular frequency, where the kind has one; else NaN */
    int stress;        /* power of the unit of stress in its unit: 1, 0 or -1 */
} ph_quantity;

/** A family of quantities. */
typedef struct ph_quantity_kind {
    ph_entry info; /* name: the words of the family, for people */
    /** Fill row, column, argument, at and stress from q->name; false: not of this kind. */
    bool (*parse)(ph_quantity *q);
    /** The i-th word of the family, or NULL after the last; for suggestions. */
    const char *(*word)(size_t i);
    /** Why a result of this kinematics has no such quantity, or NULL. */
    const char *(*refuses)(const ph_quantity *q, ph_kinematics kin);
    unsigned (*loads)(const ph_quantity *q, ph_kinematics kin);
    ph_status (*value)(const ph_quantity *q, const ph_result *r, double *out,
                       ph_error *err);
    /* Component whose row of the compliance it is taken from; NULL: it is not. Then the loads
     * that are coupled to this one are enough. */
    int (*row)(const ph_quantity *q, ph_kinematics kin);
    /* The loads whose fields its entries take where these are energies of pairs of fields (of
     * compliances: mean stresses) */
    unsigned (*fields)(const ph_quantity *q, ph_kinematics kin);
} ph_quantity_kind;
PH_API extern const ph_quantity_kind ph_quantity_kinds[];
PH_API extern const size_t ph_nquantity_kinds;

/** The quantity called `name`: E1, nu12, G12, C11 (Voigt, engineering shear), S66,
 *  isotropic.E, stretch.E1, fraction.NAME ... (`perihom list quantities`).
 *  @return PH_OK; PH_EINVAL with the nearest name. Tested: tests/unit/test_quantity.c */
PH_API ph_status ph_quantity_find(const char *name, ph_quantity *out, ph_error *err);
/** Why results of this kinematics do not have it ("E3 needs three dimensions or ..."), or
 *  NULL. */
PH_API const char *ph_quantity_refuses(const ph_quantity *q, ph_kinematics kin);
/** The loads that it needs of any cell (bit a: macro strain a, as ph_problem.loads): C11 one,
 *  isotropic.K the normal ones, E1 all, because it needs the inverse. 0: no load, nothing to
 *  solve. Of a cell whose symmetry decouples some of them see ph_problem.constants. */
PH_API unsigned ph_quantity_loads(const ph_quantity *q, ph_kinematics kin);
/** Its value. C_ij comes from load i where that was solved, else from load j; they differ by
 *  the tolerance of the solver (a result with all loads is symmetric). E, nu, G and S are taken
 *  from the columns that are there if these are exactly zero in the rows of the others.
 *  @param[out] out untouched on failure
 *  @return PH_OK; PH_EINVAL (the kinematics has none, a load it needs was not solved, no
 *          such material); PH_ESINGULAR (no inverse). */
PH_API ph_status ph_quantity_value(const ph_quantity *q, const ph_result *result,
                                   double *out, ph_error *err);

#ifdef __cplusplus
}
#endif
#endif
