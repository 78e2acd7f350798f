/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inside of a calibration. Every unknown is u in [0, 1]; residuals are (model - measured) / sigma.
 * samples.c runs the model, minimise.c fits, spread.c finds errors, surrogate.c and what
 * stands on it (profile.c, left_out.c, posterior.c) need no further realisation. */
#ifndef RVE_CALIBRATE_H
#define RVE_CALIBRATE_H

#include "core/check.h"

#include <perihom_calibrate.h>

enum { K = PH_FIT_UNKNOWNS };

/** Residuals of m parameter sets at once. A set where the model has no answer gets NaN.
 *  @param[in]  u [m][K] @param[out] f [m][n] */
typedef struct ph_i_residuals {
    int k, n;
    ph_status (*eval)(void *user, int m, const double *u, double *f, ph_error *err);
    void *user;
} ph_i_residuals;

/* ---- samples.c: the model's answers, each asked for once */

/** The answers at one value of the unknowns. */
typedef struct ph_i_set {
    double u[K];
    bool refused;         /* the model fails here in most realisations */
    int capacity;         /* realisations that there is room for */
    double *y;            /* [npoints][capacity][noutputs] */
    unsigned char *state; /* [npoints][capacity] 0 missing, 1 answer, 2 failed */
} ph_i_set;

typedef struct ph_i_samples {
    const ph_fit_problem *problem;
    const ph_ctx *ctx;
    const double *sigma; /* [nmeasurements], never NaN */
    int *n;              /* [npoints] realisations in use */
    int capacity;
    unsigned char
        *dropped; /* [npoints][capacity]: failed somewhere, so left out everywhere */
    int nsets, sets_capacity;
    ph_i_set **set;
    long solves, failures;
    ph_error last_failure;
    const char *stage;
} ph_i_samples;

ph_status ph_i_samples_init(ph_i_samples *s, const ph_fit_problem *problem,
                            const double *sigma, const ph_ctx *ctx, ph_error *err);
void ph_i_samples_free(ph_i_samples *s);
/** Use n[p] realisations of point p from now on. Never fewer than before. */
ph_status ph_i_samples_raise(ph_i_samples *s, const int *n, ph_error *err);
/** A ph_i_residuals.eval; `user` is the samples. Realisations that fail at some value of
 *  the unknowns drop out at all of them; where more than half of those of a point fail, the
 *  value of the unknowns is refused instead. */
ph_status ph_i_samples_residuals(void *user, int m, const double *u, double *f,
                                 ph_error *err);
/** The set at u, whose answers are there. */
const ph_i_set *ph_i_samples_at(const ph_i_samples *s, const double u[K]);
/** Realisations of a point that count, and those dropped. */
int ph_i_samples_count(const ph_i_samples *s, int point, int *dropped);
/** Answer of one realisation, in use and not dropped. */
double ph_i_samples_answer(const ph_i_samples *s, const ph_i_set *set, int point, int r,
                           int output);
bool ph_i_samples_uses(const ph_i_samples *s, int point, int r);
/** Value of the unknowns from u. */
double ph_i_unknown_value(const ph_fit_unknown *x, double u);
double ph_i_unknown_slope(const ph_fit_unknown *x, double u); /* d value / d u */
double ph_i_unknown_place(const ph_fit_unknown *x, double value);

/* ---- minimise.c */

typedef struct ph_i_search {
    double lo[K], hi[K]; /* equal: held */
    double step;         /* of the differences */
    double tolerance;    /* stop where a step is shorter than this many standard errors */
    double scale;        /* sigma^2 of the residuals; NaN: estimate it from them */
    int iterations;      /* at most */
} ph_i_search;

/** Levenberg-Marquardt inside a box: the step solves (J^T J + lambda D) d = -J^T f on the
 *  unknowns that are not held at a bound, and is clipped [More1978].
 *  @param[in,out] u start, then the minimum @param[out] chi2 INFINITY: no answer at start
 *  @return PH_OK also where it ran out of iterations (*converged false) */
ph_status ph_i_minimise(const ph_i_residuals *r, const ph_i_search *how, double u[K],
                        double *chi2, bool *converged, ph_error *err);
/** Residuals and their Jacobian [n][K] at u, central differences (one-sided of second order
 *  at the ends of the box); *known false where the model has no answer beside u. */
ph_status ph_i_jacobian(const ph_i_residuals *r, const ph_i_search *how,
                        const double u[K], double *f, double *J, bool *known,
                        ph_error *err);

/* ---- spread.c */

/** Errors at the minimum, in u. */
typedef struct ph_i_spread {
    double hessian[K][K];               /* J^T J */
    double eigenvalue[K], vector[K][K]; /* vector[j] is direction j, largest first */
    ph_fit_knowledge direction[K], unknown[K];
    int known;                                        /* directions that are not flat */
    double data[K][K], sampling[K][K], inverse[K][K]; /* covariances; J^T J inverted */
    double freedom[K];                                /* of the sampling errors */
    double scale; /* sigma^2 that the data's errors were multiplied by; NaN: not known */
} ph_i_spread;

/** @param[in] f,J at the minimum u; scale NaN: from the misfit
 *  @param[out] part [npoints] variance that the sampling of each point brings, alone */
ph_status ph_i_spread_find(const ph_i_samples *s, const double u[K], const double *f,
                           const double *J, double scale, ph_i_spread *out,
                           double (*part)[K], ph_error *err);
/** Quantile for a 95 % interval of unknown j, and its degrees of freedom
 *  of both errors together [Satterthwaite1946]. */
double ph_i_spread_quantile(const ph_i_spread *e, int measurements, bool sigma_known,
                            int j, double *freedom);
/** Realisations that the next round should have, n_p in proportion to the error that one
 *  realisation of the point leaves in the estimate [Neyman1934].
 *  @param[in] target [k] sampling standard error that is wanted, in u
 *  @param[out] enough the target is reached already */
void ph_i_spread_allocate(const ph_i_samples *s, const ph_i_spread *e,
                          const double (*part)[K], const double *target, int at_most,
                          int *n, bool *enough);

/** Covariance of the residuals that the sampling of the means brings. @param[out] S [n][n] */
ph_status ph_i_spread_covariance(const ph_i_samples *s, const double u[K], double *S,
                                 ph_error *err);

/* ---- surrogate.c: means between Chebyshev nodes of a box */

enum { PH_I_SURROGATE_UNKNOWNS = 4, PH_I_NODES_MAX = 17 };

typedef struct ph_i_surrogate {
    int k, n, nodes, total; /* unknowns, measurements, nodes an axis, nodes in all */
    double lo[K], hi[K];
    double node[PH_I_NODES_MAX], weight[PH_I_NODES_MAX]; /* in [0, 1], barycentric */
    double (*place)[K];                                  /* [total] */
    double *f;                                           /* [total][n] residuals */
    double error; /* largest at the check points, residuals */
} ph_i_surrogate;

/** Interpolate the residuals in the box; needs `total` evaluations and some to check.
 *  @return PH_OK, *built false where the model has no answer somewhere in the box */
ph_status ph_i_surrogate_new(const ph_i_residuals *r, const double lo[K],
                             const double hi[K], const double centre[K],
                             ph_i_surrogate **out, bool *built, ph_error *err);
void ph_i_surrogate_free(ph_i_surrogate **s);
/** A ph_i_residuals.eval; `user` is the surrogate. */
ph_status ph_i_surrogate_residuals(void *user, int m, const double *u, double *f,
                                   ph_error *err);

/* ---- profile.c, left_out.c, posterior.c */

/** A calibration under way. */
typedef struct ph_i_fit {
    const ph_fit_problem *problem;
    ph_fit_params params;
    ph_i_samples samples;
    ph_i_residuals residuals;
    double *sigma;
    bool sigma_known;
    double scale; /* 1, or NaN: from the misfit */
    double best[K], chi2;
    int nminima;
    double minimum[PH_FIT_MINIMA][K];
    double minimum_chi2[PH_FIT_MINIMA];
    double *f, *J;     /* at the best */
    double (*part)[K]; /* [npoints] of the sampling variance */
    double *S;         /* [n][n] covariance of the residuals by sampling */
    ph_i_spread spread;
    bool bent[K]; /* flat at the best, but not over the whole range */
    ph_i_surrogate *surrogate;
    ph_fit *out;
    double began;
} ph_i_fit;

/** Rise of the misfit at the ends of the 95 % interval of unknown j, sampling included. */
double ph_i_rise(const ph_i_fit *c, int j);
/** Build the surrogate in a box that the intervals (and the posterior) do not leave. */
ph_status ph_i_profile_box(ph_i_fit *c, ph_error *err);
ph_status ph_i_profile(ph_i_fit *c, ph_error *err);
ph_status ph_i_left_out(ph_i_fit *c, ph_error *err);
ph_status ph_i_posterior(ph_i_fit *c, ph_error *err);

/* ---- search.c */

ph_i_search ph_i_search_of(const ph_i_fit *c); /* calibrate.c */
/** Local search from u with the realisations of now. */
ph_status ph_i_descend(ph_i_fit *c, double u[K], double *chi2, ph_error *err);
/** Scan and local searches: fills c->minimum, the best first. */
ph_status ph_i_search_minima(ph_i_fit *c, ph_error *err);

/* ---- report.c: fill c->out before and after profiles and posterior */

ph_status ph_i_report(ph_i_fit *c, ph_error *err);
void ph_i_conclude(ph_i_fit *c);

void ph_i_fit_note(ph_fit *fit, const char *fmt, ...) PH_PRINTF(2, 3);

#endif
