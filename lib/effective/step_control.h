/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A time step to prescribed means: strains for some components, stresses for the others,
 * whatever the constraint loads by. Tested with the routes that step. */
#ifndef PH_EFFECTIVE_STEP_CONTROL_H
#define PH_EFFECTIVE_STEP_CONTROL_H

#include "effective/stepper.h"

typedef struct ph_step_control {
    ph_stepper *s;    /* borrowed */
    unsigned stress;  /* bit a: component a is prescribed as a stress */
    bool bends;       /* some component is found by corrections of its load */
    double tolerance; /* of what is missing, relative to what is there */
    double least;     /* and to this, where less is there; 0 */
    ph_sym4 tangent;  /* d response / d load, of some step; n = 0: none yet */
    double target[6]; /* at the end of the step, Mandel */
} ph_step_control;

ph_step_control ph_i_step_control(ph_stepper *s, unsigned stress);
/** Is component i prescribed by its load, or by its response? */
bool ph_i_step_is_direct(const ph_step_control *control, int i);
/** A step to the targets; not taken yet. @param[out] stress mean at its end, [ns] Mandel */
ph_status ph_i_step_attempt(ph_step_control *control, double dt, double *stress,
                            ph_error *err);

#endif
