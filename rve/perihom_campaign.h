/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Many realisations of many cases. */
#ifndef PERIHOM_CAMPAIGN_H
#define PERIHOM_CAMPAIGN_H

#include <perihom_rve.h>

#ifdef __cplusplus
extern "C" {
#endif

#define PH_MAX_OUTPUTS 64

/** One realisation of a case, and what is asked of it. Borrows everything. */
typedef struct ph_scenario {
    const ph_case *c;     /* read with its overrides: ph_case_read(path, sets, ...) */
    uint64_t realisation; /* in place of the one of the case */
    int noutputs;         /* 1 .. PH_MAX_OUTPUTS */
    const ph_quantity *output; /* [noutputs] */
} ph_scenario;

/** What came out of a scenario, and what it cost. */
typedef struct ph_evaluation {
    int n;
    double value[PH_MAX_OUTPUTS]; /* in the order of the outputs */
    int iterations;               /* of all loads together */
    int nloads;                   /* that were solved */
    long applications;            /* of the operator */
    ptrdiff_t nodes;
    size_t peak_bytes; /* of the solver's own arrays */
    double seconds;    /* wall clock, microstructure and solution */
    double seconds_solve;
} ph_evaluation;

/** Which loads the outputs of a case need together (as ph_problem.loads; 0: none).
 *
 *  The union of ph_quantity_loads; all where that is not accurate enough: contrast above
 *  1e3 or a void (then entries are refined with the fields of all loads), or
 *  uniform_traction, whose compliance is inverted as a whole. */
PH_API unsigned ph_scenario_loads(const ph_scenario *scenario);

/** Build the microstructure of the realisation, solve the loads that the outputs need, and
 *  read the outputs off.
 *
 *  A pure function of (case, seed, realisation, outputs): the same bits on any number of
 *  threads, in any order. Two cases that differ in any key but the seed draw the same random
 *  numbers for the same realisation (common random numbers): filler k of both has the same
 *  draws, whatever its amount or properties.
 *  @param[out] out untouched on failure
 *  @return PH_OK; PH_EINVAL (no outputs, an output that this kinematics has not);
 *          PH_EUNPHYSICAL (fillers that find no room); PH_ENOCONV; PH_ESINGULAR; PH_ENOMEM;
 *          PH_ECANCELLED. Tested: tests/unit/test_scenario.c */
PH_API ph_status ph_scenario_evaluate(const ph_scenario *scenario, const ph_ctx *ctx,
                                      ph_evaluation *out, ph_error *err);

#ifdef __cplusplus
}
#endif
#endif
