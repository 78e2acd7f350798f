/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Error bars of the result of a case: its geometry once more on a coarser grid. Theory:
 * docs/theory/error-bars.md. */
#ifndef PERIHOM_RVE_ERROR_BAR_H
#define PERIHOM_RVE_ERROR_BAR_H

#include <perihom_rve.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Nodes of the coarser grid: half of those of the case (which must be set), rounded up.
 *  @param[out] nodes may be c->nodes; @param[out] ratio of the spacings, geometric mean over
 *  the axes. @return NULL, or why there is none */
PH_API const char *ph_rve_companion_nodes(const ph_case *c, ptrdiff_t nodes[3],
                                          double *ratio);

/** What a case would take with its companions, and as its materials relax: the estimate of
 *  ph_homogenise_estimate and that of the companions. Nothing is solved.
 *  @param[in] problem of the case
 *  @return PH_OK; PH_EINVAL; PH_ENOMEM. Tested: tests/unit/test_cost.c */
PH_API ph_status ph_rve_estimate(const ph_case *c, const ph_problem *problem,
                                 ph_estimate *out, ph_error *err);

/** Solve the companions that c->error_parts asks for and put the error bars into `result`.
 *
 *  Does nothing where no part is wanted, or the result has not converged or lacks columns.
 *  What cannot be estimated says why; only an interruption, a lack of memory and arguments
 *  that do not belong together fail.
 *  @param[in] problem of the case, as it was solved; @param[in,out] result of it
 *  @return PH_OK; PH_ECANCELLED; PH_ENOMEM; PH_EINVAL. Cost: 1/4 of the solution in the
 *  plane, 1/8 in space, told in result->error_bar. Tested: tests/verify/test_error_bars.c */
PH_API ph_status ph_rve_error_bar(const ph_case *c, const ph_problem *problem,
                                  const ph_ctx *ctx, ph_result *result, ph_error *err);

/** The same for a relaxation: error bars of C*(t) at once, at one time a decade and at last, in
 *  out->error_bars, and those at once in out->elastic->error_bar. Nothing where the route
 *  gives no series. @param[in] params with which `out` was solved */
PH_API ph_status ph_rve_relaxation_error_bar(const ph_case *c, const ph_problem *problem,
                                             const ph_relaxation_params *params,
                                             const ph_ctx *ctx, ph_viscoelastic *out,
                                             ph_error *err);

#ifdef __cplusplus
}
#endif
#endif
