/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Automatic fidelity: an accuracy and a budget in place of settings. */
#ifndef PERIHOM_FIDELITY_H
#define PERIHOM_FIDELITY_H

#include <perihom_trade.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { PH_FIDELITY_STEPS = 24, PH_FIDELITY_WHY = 12 };

/** What an analysis of the case says before anything is solved. */
typedef struct ph_fidelity_plan {
    double accuracy; /* relative error asked for, of the worst constant */
    int nconstants;
    ph_quantity constant[PH_TRADE_CONSTANTS];
    double spread; /* ln(Voigt / Reuss), worst modulus, at most ln 1000 */
    double
        boundary; /* cells that hold a boundary of phases, of all cells, times the nodes of
                      * the longest axis: does not depend on the grid */
    double slope; /* expected error times the nodes of the longest axis */
    double bytes_a_node, seconds_a_node; /* rough, as ph_homogenise_estimate has them */
    ptrdiff_t nodes[3];                  /* grid to begin with */
    bool fixed;                          /* the case gives the grid */
    double tolerance;                    /* of the solver */
    double energy; /* share of its energy that the solver may leave; 0: tolerance alone */
    int nwhy;
    char why[PH_FIDELITY_WHY][200];
} ph_fidelity_plan;

/** One solution on the way. */
typedef struct ph_fidelity_step {
    ptrdiff_t nodes[3];
    double tolerance;
    double value[PH_TRADE_CONSTANTS]; /* on this grid */
    double
        estimate; /* of the error of what is offered, worst constant; NaN: of a first grid */
    bool improved; /* by the coarser grid */
    ph_work work;
    double operations;   /* ph_trade_work */
    double seconds, cpu; /* wall clock; CPU time of the process */
} ph_fidelity_step;

/** How an accuracy was reached, or not. Owns its parts. */
typedef struct ph_fidelity {
    ph_fidelity_plan plan;
    int nsteps;
    ph_fidelity_step step[PH_FIDELITY_STEPS];
    bool reached;
    double error;       /* estimated, of the result, worst constant */
    double grid_error;  /* the same of the finest grid as it is, not extrapolated */
    ptrdiff_t nodes[3]; /* of the result */
    double tolerance;
    bool improved;                   /* its stiffness is extrapolated */
    double operations, seconds, cpu; /* of all steps */
    char missing[320];               /* not reached: what it would take; else "" */
    ph_case
        settings; /* the case with what was chosen; borrows its arrays from the case */
    ph_microstructure *micro;
    ph_crack_plan *cracks;
    ph_result *result; /* stiffness improved */
} ph_fidelity;
PH_API void ph_fidelity_free(ph_fidelity **fidelity);

/** What ph_fidelity_solve will begin with, and why. Solves nothing.
 *
 *  The error of composite cells is expected to be slope / n sqrt(8 / n) with
 *
 *      slope = K ln(Voigt / Reuss) boundary,    K = 0.065 in 2D, 0.13 in 3D
 *
 *  measured on random cells (docs/accuracy-costs.md); 2.4 times that where
 *  cells hold the phase at their centre.
 *  @return PH_OK; PH_EINVAL (the case asks for no accuracy); as ph_rve_build.
 *  Tested: tests/unit/test_fidelity.c */
PH_API ph_status ph_fidelity_plan_case(const ph_case *c, ph_fidelity_plan *out,
                                       ph_error *err);

/** Solve a case to the accuracy that it asks for, at the cheapest settings that reach it.
 *
 *  A grid by the plan and one of about half its nodes; r the ratio of their nodes,
 *
 *      d = (C(n) - C(n/r)) / (r^1.7 - 1),   offered C(n) + d,   error x (1 + 10 x)
 *
 *  with x = k |d|^(1-w) e(n)^w, e(n) the error that the plan expects, k = 1.8 and w = 0.3 in 2D,
 *  k = 0.9 and w = 0 in 3D. Where the estimate is larger than asked for, the next grid is the
 *  one that is expected to be fine enough; the grid before is its companion.
 *  The solver stops where a tenth of the accuracy is left of the energy; where that has no
 *  bound, its tolerance falls until the columns of the tensor are symmetric enough.
 *  Settings that the case gives are kept.
 *  @param[out] out also with PH_ENOCONV, but where the budget is too small for any grid
 *  @return PH_OK: reached; PH_ENOCONV: the budget, or settings that are given, cannot meet the
 *          accuracy: the best result is there and `missing` says what it would take; PH_EINVAL;
 *          PH_ESINGULAR; PH_ENOMEM; PH_ECANCELLED. Tested: tests/unit/test_fidelity.c */
PH_API ph_status ph_fidelity_solve(const ph_case *c, const ph_ctx *ctx, ph_fidelity **out,
                                   ph_error *err);

/** The result document with the block "fidelity" (docs/results.md), malloc'd. */
PH_API ph_status ph_fidelity_to_json(const ph_fidelity *fidelity, const ph_case *c,
                                     const char *command, char **json, ph_error *err);

#ifdef __cplusplus
}
#endif
#endif
