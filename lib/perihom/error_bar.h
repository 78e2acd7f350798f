/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a result is off, part by part. Theory: docs/theory/error-bars.md. */
#ifndef PERIHOM_ERROR_BAR_H
#define PERIHOM_ERROR_BAR_H

#include <perihom/quantity.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { PH_MAX_ERROR_PARTS = 12, PH_MAX_ERROR_CONSTANTS = 40 };

/** What the parts of an error are estimated from. Borrows everything; NULL and 0: that is
 *  not known, and the parts that need it say so. Tensors in Mandel notation. */
typedef struct ph_error_evidence {
    const ph_result *result;  /* bounds, loads, residuals, energy of the stabilisation */
    const ph_sym4 *stiffness; /* what is judged; NULL: the stiffness of the result */
    const double *stabilisation; /* its share of the energy; NULL: that of the result */
    /* the same on a grid whose spacing is `ratio` times as wide; below 1 it is finer */
    const ph_sym4 *coarse;
    double ratio;
    const char *no_coarse; /* why there is none */
    bool by_centres;       /* both grids take the phase at the centre of a cell */
    bool mixed;            /* the coarser grid mixes what are voxels on this one */
    /* relative error of moduli that such grids have on the mean of many cells; 0: no law */
    double expected;
    /* with cracks: the same cell without them, and the spacing over their half length */
    const ph_sym4 *uncracked;
    double tips;
    /* two tensors of the coarse grid: of this horizon, and of half of it */
    const ph_sym4 *horizon, *half_horizon;
    const char *no_horizon;
    /* and two: of this constraint, and of another one */
    const ph_sym4 *constraint, *other_constraint;
    const char *no_boundary;
    /* sum over the materials but the matrix of |share there - share asked for|, their
     * share, and the stiffness of the matrix; NULL: nothing was asked for */
    const ph_sym4 *matrix;
    double share, share_off;
    double time;    /* relative error of the basis of a relaxation; 0: nothing relaxes */
    unsigned parts; /* bit i: ph_error_parts[i] is wanted; 0: all of `auto` */
} ph_error_evidence;

/** One cause of error. */
typedef struct ph_error_part {
    ph_entry info;
    bool automatic; /* part of `auto`; else only where it is asked for */
    bool bound;     /* of the worst case: added in full, not in squares */
    bool needed;    /* no bar without it, where it is wanted */
    /* why this evidence says nothing of it, or NULL */
    const char *(*refuses)(const ph_error_evidence *e);
    /* what it may put a quantity off, in the unit of the quantity, >= 0; NaN: unknown */
    double (*error)(const ph_error_evidence *e, const ph_quantity *q, double value);
} ph_error_part;
PH_API extern const ph_error_part ph_error_parts[];
PH_API extern const size_t ph_nerror_parts;
/** The parts of `auto`, as bits. */
PH_API unsigned ph_error_parts_auto(void);

/** One constant. Errors are relative to its value. */
typedef struct ph_error_constant {
    char name[16]; /* of ph_quantity_find */
    double value;
    double bar;        /* 95 %; NaN: not estimated */
    double richardson; /* value extrapolated to spacing zero, order 1.7; NaN: none */
    double part[PH_MAX_ERROR_PARTS]; /* in the order of ph_error_parts; NaN: none */
    const char *why;                 /* bar is NaN, or NULL */
} ph_error_constant;

/** Error bars of the constants of one tensor. A value. */
typedef struct ph_error_bar {
    int count;
    ph_error_constant constant[PH_MAX_ERROR_CONSTANTS];
    char why[PH_MAX_ERROR_PARTS][200]; /* a part that is not there; "": it is */
    ptrdiff_t nodes[3]; /* of the companion on the coarser grid; zeros: none */
    double ratio;       /* of the spacings */
    double seconds;     /* of the companions, and what they took: */
    long iterations, applications, ffts;
} ph_error_bar;

/** Error bars of every constant: E1 .., nu12 .., G12 .., isotropic.E .., C11 ..
 *
 *      bar = sqrt(sum of part^2 over the parts that are estimates) + those that are bounds
 *
 *  relative to the value, and for moduli at most the distance to the farther of the bounds
 *  of Reuss and Voigt. Constants without meaning here (a coupling C16 of an orthotropic
 *  tensor) have no bar and say why.
 *  @param[out] out constants and reasons; what companions took is left as it is
 *  @return PH_OK; PH_EINVAL. Cost: some thousand evaluations of 6 x 6 matrices.
 *  Ref: [Richardson1911]. Tested: tests/unit/test_error_bar.c */
PH_API ph_status ph_error_bar_estimate(const ph_error_evidence *evidence,
                                       ph_error_bar *out, ph_error *err);
/** The constant called `name`, or NULL. */
PH_API const ph_error_constant *ph_error_bar_find(const ph_error_bar *bar,
                                                  const char *name);

#ifdef __cplusplus
}
#endif
#endif
