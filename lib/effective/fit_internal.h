/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PH_EFFECTIVE_FIT_INTERNAL_H
#define PH_EFFECTIVE_FIT_INTERNAL_H

#include <perihom/fit.h>

#include "core/check.h"

/** The rows of the least-squares problem: y ~ sum of coefficients times basis functions. */
typedef struct ph_i_prony_fit_rows {
    ph_prony_kind kind;
    ptrdiff_t m;
    double *x, *y, *weight; /* [m] */
    bool *is_loss;          /* [m] */
    bool known_sd;          /* weights are inverse standard deviations */
    double first, last;     /* range in which times are sought */
} ph_i_prony_fit_rows;

/** Coefficients come in the order: constant (infinity, or instantaneous compliance), rate
 *  (fluidity, creep of fluids only), then one a time. */
typedef struct ph_i_prony_fit_model {
    bool constant, rate;
    int n;
    double time[PH_PRONY_FIT_TERMS + 1]; /* sought times; given ones live elsewhere */
    double c[PH_PRONY_FIT_TERMS + 3];
    double rss;
} ph_i_prony_fit_model;

/** Coefficients besides those of the times. */
int ph_i_prony_fit_extras(const ph_i_prony_fit_model *m);
/** Basis function of a relaxation (or retardation) time at row i, and its derivative with
 *  respect to ln(time) (may be NULL). */
double ph_i_prony_fit_basis(const ph_i_prony_fit_rows *r, ptrdiff_t i, double time,
                            double *slope);
/** Column of weighted values: extra 0 or 1, see above. */
void ph_i_prony_fit_extra_column(const ph_i_prony_fit_rows *r, bool rate, double *column);
void ph_i_prony_fit_column(const ph_i_prony_fit_rows *r, double time, double *column,
                           double *slope);

/** The best non-negative coefficients for `ntimes` given times.
 *  @param[out] c [extras + ntimes] */
ph_status ph_i_prony_fit_solve(const ph_i_prony_fit_rows *r, bool constant, bool rate,
                               int ntimes, const double *times, double *c, double *rss,
                               ph_error *err);

/** Number of parameters and BIC. */
double ph_i_prony_fit_criterion(const ph_i_prony_fit_rows *r, int nextra_used, int terms,
                                double rss);

/** Models of 0, 1, 2 ... terms: best[n] has n terms, rss < 0 where there is none.
 *  @param[in] want stop at this number; 0: where the criterion has passed its least */
ph_status ph_i_prony_fit_path(const ph_i_prony_fit_rows *r, bool constant, bool rate,
                              int want, ph_i_prony_fit_model best[PH_PRONY_FIT_TERMS + 1],
                              ph_error *err);

#endif
