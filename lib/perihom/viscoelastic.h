/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PERIHOM_VISCOELASTIC_H
#define PERIHOM_VISCOELASTIC_H

#include <perihom/catalogue.h>
#include <perihom/error_bar.h>
#include <perihom/history.h>
#include <perihom/homogenise.h>
#include <perihom/prony.h>

#ifdef __cplusplus
extern "C" {
#endif

/** How the effective relaxation is computed. Zeroed: all defaults. */
typedef struct ph_relaxation_params {
    const char *route; /* in ph_relaxation_routes[]; NULL: "reduced" */
    double tolerance;  /* relative error of the effective tensor, 1e-12 to 1; 0: 1e-4 */
    int max_points;    /* of the Carson variable that `reduced` may solve; 0: 40 */
    const double *carson; /* [ncarson] 1/time, >= 0, INFINITY: instantaneous; `carson`
                           * solves each of them, `reduced` evaluates its model there */
    int ncarson;
    const double *times; /* [ntimes] not decreasing, >= 0: of the curve and the response;
                          * `stepping` steps to them */
    int ntimes;
    const double *omega; /* [nomega] angular frequencies > 0 of the complex modulus, which
                          * `frequency` solves */
    int nomega;
    const ph_history
        *history; /* of macro strain or stress; NULL: none. `stepping` follows
                                * it, the others take the response of their series */
} ph_relaxation_params;

/** One value of the Carson variable that was solved. */
typedef struct ph_carson_point {
    double s;       /* 1/time; 0: equilibrium, INFINITY: instantaneous */
    double error;   /* of the model before this point was solved, relative; NaN: first */
    int iterations; /* of all loads */
    int added;      /* vectors that the basis took from it */
} ph_carson_point;

/** Effective stiffness at one value of the Carson variable. */
typedef struct ph_carson_value {
    double s;
    ph_sym4 stiffness; /* Mandel, C*(s) = s L[C*](s) */
} ph_carson_value;

/** Effective relaxation tensor at one time. */
typedef struct ph_time_value {
    double time;
    ph_sym4 stiffness; /* Mandel, C*(t) */
} ph_time_value;

/** Effective complex modulus C' + i C'' at one angular frequency. */
typedef struct ph_dynamic_value {
    double omega;
    ph_sym4 storage, loss; /* Mandel; positive semidefinite */
} ph_dynamic_value;

/** Error bars of C*(t): time 0 is at once, INFINITY at last. */
typedef struct ph_time_error_bar {
    double time;
    ph_error_bar bar;
} ph_time_error_bar;

/** Effective relaxation and what it cost. Owns its parts. */
typedef struct ph_viscoelastic {
    const char *route; /* catalogue name */
    /* C*(t), exact poles of the reduced model; NULL where the route gives none. Its sum at
     * t = 0 is `instantaneous`. */
    ph_prony *series;
    ph_sym4 instantaneous,
        equilibrium; /* n = 3 or 6, Mandel; 0: the route does not say */
    int lost;        /* directions of macro strain that carry no stress at equilibrium */
    double error;    /* estimated relative error of C*(s), any s > 0: the largest
                   * x.(C_model - C).x / x.C_model.x */
    double error_at; /* where it was largest */

    int npoints;
    ph_carson_point *points; /* [npoints] in the order in which they were solved */
    int nvalues;
    ph_carson_value *values; /* [nvalues] at params->carson */
    int ncurve;
    ph_time_value *curve;  /* [ncurve] at params->times; `frequency`, `carson`: none */
    double (*response)[6]; /* [ncurve] to params->history, Voigt; or NULL */
    int ndynamic;
    ph_dynamic_value
        *dynamic; /* [ndynamic] at params->omega; `stepping`, `carson`: none */

    int nerror_bars;
    ph_time_error_bar *error_bars; /* [nerror_bars], as in ph_result, or NULL */

    int basis;          /* fields */
    size_t basis_bytes; /* of the fields and what is kept with them */
    long iterations;    /* of the solver, all loads and points */
    long applications;  /* of the operator, everything counted */
    long steps;         /* of `stepping`, all loads */
    int functions;      /* distinct moduli of s that the phases have */
    double seconds;
    ph_result *elastic; /* the instantaneous problem, and every note */
} ph_viscoelastic;

/** A route. */
typedef struct ph_relaxation_route ph_relaxation_route;
struct ph_relaxation_route {
    ph_entry info;
    /* `out` comes zeroed with its route set; the caller frees it whatever is returned. */
    ph_status (*solve)(const ph_problem *problem, const ph_relaxation_params *params,
                       const ph_ctx *ctx, ph_viscoelastic *out, ph_error *err);
};
PH_API extern const ph_relaxation_route ph_relaxation_routes[];
PH_API extern const size_t ph_nrelaxation_routes;

/** Effective relaxation tensor of a microstructure whose materials may have
 *  `relaxation` (ph_material); those without are elastic.
 *
 *  @param[in] params NULL: defaults
 *  @return PH_OK; PH_ENOCONV (a point did not converge, or max_points did not meet the
 *          tolerance); PH_EINVAL; PH_EUNPHYSICAL; PH_ENOMEM; PH_ECANCELLED.
 *  Cost: that of a few elastic problems, see docs/theory/viscoelastic.md. */
PH_API ph_status ph_viscoelastic_solve(const ph_problem *problem,
                                       const ph_relaxation_params *params,
                                       const ph_ctx *ctx, ph_viscoelastic **out,
                                       ph_error *err);
PH_API void ph_viscoelastic_free(ph_viscoelastic **v);

#ifdef __cplusplus
}
#endif
#endif
