/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Means over realisations with the help of cheaper models of the same realisations.
 * Theory: docs/theory/multilevel.md. Knows nothing of cases: numbers in, numbers out. */
#ifndef PERIHOM_ESTIMATORS_H
#define PERIHOM_ESTIMATORS_H

#include <perihom/catalogue.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { PH_MAX_MODELS = 8, PH_MAX_CONTROLS = 16 };

/** What one model made of realisations 0, 1, ... of the same random input. Borrows. */
typedef struct ph_model_samples {
    int dimension;       /* numbers a realisation; above 1 for the last model only */
    ptrdiff_t n;         /* realisations that are there */
    const double *value; /* [n][dimension]; NaN where the realisation failed */
    double cost;         /* of one realisation, in any unit, > 0 */
} ph_model_samples;

/** A way to the mean of model 0. With x_l the models of its chain (x_0 is model 0) and
 *  numbers of realisations n_0 <= n_1 <= ... (realisation k has every model with k < n_l),
 *
 *      mean = sum_l  1/n_l sum_(k < n_l)  B_l (x_l - b_l . x_(l+1))(k),   B_l = b_0 .. b_(l-1)
 *
 *  where the last model has no subtrahend. Its expectation is that of x_0, whatever the
 *  others are and whatever b is, as long as b does not see the realisations it multiplies. */
typedef struct ph_estimator {
    ph_entry info;
    bool levels; /* uses the other models */
    bool fits;   /* b_l is fitted by least squares (else 1) */
} ph_estimator;
PH_API extern const ph_estimator ph_estimators[];
PH_API extern const size_t ph_nestimators;

/** Two models that differ in nothing but the spacing of their grids: h for `fine`, which is
 *  also that of model 0, and ratio h for `coarse`. ratio 0: there are no such models. */
typedef struct ph_grid_pair {
    int fine, coarse; /* models, fine < coarse */
    double ratio;     /* > 1 */
} ph_grid_pair;

/** What a grid adds to the mean, by extrapolation at first order [Richardson1911]: with
 *  E[x_h] = E[x_0] + c h, c h = E[x_rh - x_h] / (r - 1), from pairs of the same realisation. */
typedef struct ph_discretisation {
    double estimate; /* c h: the mean of the grid less that of an infinitely fine one */
    double standard_error, half_width;
    double dof;  /* of Student's t in half_width */
    ptrdiff_t n; /* pairs that did not fail; 0: none there, the rest NaN */
} ph_discretisation;

/** When to stop, and how. Zeroed: auto, 95 %, nothing wanted (which is refused). */
typedef struct ph_estimation_rule {
    const char
        *method; /* in ph_estimators[]; NULL or "auto": what the pilots say is cheapest */
    double half_width; /* of the confidence interval; 0: spend the budget */
    bool relative;     /* half_width is a share of |mean| */
    double confidence; /* 0: 0.95 */
    double budget;     /* cost never to be exceeded, in the unit of the costs; 0: none */
    ptrdiff_t pilot;   /* realisations of model 0 before anything is decided; 0: 12 */
    ph_grid_pair grid; /* where there is one */
    bool total; /* half_width holds |discretisation|, its half-width and that of the mean
                 * together; needs a grid pair and half_width > 0 */
} ph_estimation_rule;

/** One term of the sum. */
typedef struct ph_level_report {
    int model;
    ptrdiff_t n;        /* realisations */
    double valid;       /* of these, those that did not fail on this level */
    double dof;         /* degrees of freedom of `variance` */
    double cost;        /* of one realisation */
    double variance;    /* of B_l (x_l - b_l . x_(l+1)) */
    double coefficient; /* b_l; of several controls their number */
    double correlation; /* of x_l and its fit by x_(l+1); NaN for the last */
    double difference;  /* mean of x_l - x_(l+1) over the common realisations: what the
                         * coarser model is off; NaN for the last and for several controls */
    double difference_error; /* its standard error */
} ph_level_report;

typedef struct ph_mean_estimate {
    double mean, standard_error, half_width;
    double dof; /* of Student's t in half_width, by [Satterthwaite1946] */
    int nlevels;
    ph_level_report level[PH_MAX_MODELS];
    double cost;       /* of all realisations of all models, pilots too */
    double plain_cost; /* what plain Monte Carlo would take for the same standard error */
} ph_mean_estimate;

/** Where an estimation stands. */
typedef struct ph_estimation {
    int method; /* index into ph_estimators[]; -1 before the pilots are there */
    int nlevels;
    int model[PH_MAX_MODELS];      /* the chain, model 0 first */
    ptrdiff_t want[PH_MAX_MODELS]; /* realisations of every model that are needed now */
    ptrdiff_t decided[PH_MAX_MODELS]; /* those whose scatter the last decision saw */
    bool done;                        /* nothing more is needed */
    bool reached;           /* the half-width asked for (done without it: budget) */
    int stage;              /* 0: pilots, 1: chain chosen, 2: half-way, 3: the end */
    char reason[384];       /* why this method; what stopped it */
    ph_discretisation bias; /* with rule.total; else zeros */
    double finer; /* rule.total, not reached: so many times finer must the grid be for its
                   * error to be half of what is asked for; 0: not the grid's fault */
    ph_mean_estimate estimate; /* from the realisations of the last full stage */
} ph_estimation;

/** What to compute next. Call it, compute the realisations that it wants, call it again,
 *  until `done`.
 *
 *  Pilots first: `pilot` realisations of model 0, more of the others. They choose the chain
 *  (every subset of the models is tried, plain among them) and the numbers n_l that give the
 *  half-width at least cost, n_l ~ sqrt(V_l / c_l) [Giles2008, Peherstorfer2016]. Half of
 *  these are computed; the variances of all that is then there give the final numbers. The
 *  interval is Student's with exactly those variances and their degrees of freedom, as in
 *  [Stein1945] after [Hall1981]: realisations that came later do not make it shorter, so that
 *  stopping where scatter happens to look small costs no coverage. Pilots count in the mean.
 *
 *  A pure function: decisions are taken at the ends of the stages from realisations
 *  0 .. want - 1, never from what happens to be there beyond them. So neither order nor
 *  workers nor interruptions change an answer, and a stopped estimation is continued by
 *  calling this with what there is. `cost` must not change between calls.
 *  @param[in]  models [nmodels], each cheaper than the one before
 *  @return PH_OK; PH_EINVAL (models, costs, rule); PH_ESINGULAR (fewer than two pilots that
 *          did not fail). Cost: O(stages x realisations x controls^2).
 *  Tested: tests/unit/test_estimators.c, tests/laws/test_unbiased.c */
PH_API ph_status ph_estimation_next(const ph_estimation_rule *rule, int nmodels,
                                    const ph_model_samples *models, ph_estimation *out,
                                    ph_error *err);
/** Discretisation from the first n realisations of both models of `grid`; its scatter (and the
 *  degrees of freedom) from the first `seen` of them, as in ph_estimation.decided.
 *
 *  With rule.total ph_estimation_next takes from what is asked for the |estimate|, and parts
 *  the rest between the half-widths of discretisation and mean so that all realisations
 *  together cost least. Where the estimate alone is as much as is asked for, it stops.
 *  @return PH_OK; PH_EINVAL (no pair, no such model, seen > n, too few realisations);
 *          PH_ESINGULAR (fewer than two of the seen pairs did not fail).
 *  Tested: tests/unit/test_discretisation.c */
PH_API ph_status ph_estimation_bias(const ph_grid_pair *grid, double confidence,
                                    int nmodels, const ph_model_samples *models,
                                    ptrdiff_t seen, ptrdiff_t n, ph_discretisation *out,
                                    ph_error *err);
/** The mean of another quantity of the same realisations by the chain and the numbers of
 *  `e` (its `want`, all of which must be there), with coefficients of its own. */
PH_API ph_status ph_estimation_mean(const ph_estimation *e, double confidence,
                                    int nmodels, const ph_model_samples *models,
                                    ph_mean_estimate *out, ph_error *err);
/** Numbers of realisations that reach a variance at least cost:
 *  n_l = sqrt(V_l / c_l) sum_m sqrt(V_m c_m) / v, together (sum_l sqrt(V_l c_l))^2 / v,
 *  with n_l >= least_l and n_l >= n_(l-1).
 *  @param[in]  v wanted variance of the sum, > 0
 *  @param[out] n not rounded
 *  @return PH_OK; PH_EINVAL. */
PH_API ph_status ph_estimation_allocate(int nlevels, const double *variance,
                                        const double *cost, const double *least, double v,
                                        double *n, ph_error *err);

#ifdef __cplusplus
}
#endif
#endif
