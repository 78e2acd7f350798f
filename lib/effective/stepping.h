/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The route `stepping`: a history of macro strain or stress, step by step, with the steps
 * that its tolerance asks for. */
#ifndef PH_EFFECTIVE_STEPPING_H
#define PH_EFFECTIVE_STEPPING_H

#include "effective/stepper.h"

/** A history of macro strains and stresses, straight between its points. The medium is at
 *  rest before the first, where a value that is not zero is a jump, as are two points of one
 *  time. */
typedef struct ph_load_history {
    int n;               /* points, >= 1 */
    const double *time;  /* [n] not decreasing, the first >= 0 */
    const double *value; /* [n][ns] Mandel: strain or stress */
    unsigned stress;     /* bit a: component a is a stress, else a strain */
} ph_load_history;

/** How to step. Zeroed: all defaults. */
typedef struct ph_stepping_params {
    double tolerance; /* error of the stress, relative; 0: 1e-4 */
    double fixed;     /* > 0: every step so long (but to land on points and outputs) */
    double shortest;  /* the first step after a jump; 0: 1/20 of the shortest time */
    long most_steps;  /* 0: 1000000 */
} ph_stepping_params;

/** What stepping took. */
typedef struct ph_stepping_report {
    long steps, rejected, solves, iterations, applications;
    double most_dissipated; /* least of work - stored energy of a step over its largest */
} ph_stepping_report;

/** Step through a history from rest; state [noutput] at the times asked for, which are within
 *  the history or after it (its last values are then held).
 *  @param[in] output [noutput] not decreasing, >= the first time of the history
 *  @return PH_OK; PH_EINVAL; PH_ENOCONV (a solve, or more than most_steps); PH_ECANCELLED */
ph_status ph_i_stepping(ph_stepper *s, const ph_load_history *history, int noutput,
                        const double *output, const ph_stepping_params *params,
                        ph_step_state *state, ph_stepping_report *report, ph_error *err);

#endif
