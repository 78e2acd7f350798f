/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inside of progressive failure: at which stretch every bond breaks, and the events. */
#ifndef PH_EFFECTIVE_FAILURE_H
#define PH_EFFECTIVE_FAILURE_H

#include <perihom/distribution.h>

#include "effective/run.h"

enum { PH_STRENGTH_FORMS = 2 }; /* criteria by which a bond can break */

/** Critical stretches of all bonds: amplitude of the classes of both ends times the form of
 *  the criterion at this bond, times the scatter. */
typedef struct ph_strengths {
    const ph_broken *broken;      /* borrowed: nodes and bonds */
    int classes;                  /* 2 (materials + 1): 2 material + (in a filler) */
    const int32_t *class, *owner; /* [cells] of the box */
    int32_t *own;                 /* what the two point to, where it is ours */
    const ptrdiff_t *source;      /* cell of the RVE in a cell of the box, or NULL */
    double *amplitude[2];         /* [classes^2] whole, apart; INFINITY: does not break */
    uint8_t *criterion[2];        /* [classes^2] */
    double *shape[2];             /* [classes^2] Weibull shape, 0: none */
    double *form[PH_STRENGTH_FORMS]; /* [family->count] */
    bool scatters;
    uint64_t seed, realisation;
    ph_crossing crossing;
} ph_strengths;

/** @param[in] family springs for model bond; of nosb the sums over a lattice of springs with
 *  the same horizon stand for them
 *  @return PH_OK; PH_EINVAL (a rule that does not fit its phase or the model); PH_ENOMEM */
ph_status ph_i_strengths_new(const ph_run *run, const ph_failure *failure,
                             ph_strengths **out, ph_error *err);
void ph_i_strengths_free(ph_strengths **strengths);
/** Critical stretch of bond b of node x, which leads to y; x holds the bond of the pair that
 *  points to positive offsets. INFINITY: it does not break. */
double ph_i_strength(const ph_strengths *strengths, ptrdiff_t x, ptrdiff_t b,
                     ptrdiff_t y);

/** The loading of a run, event by event; and in time, where `run` is one that relaxes. */
ph_status ph_i_run_failure(ph_run *run, ph_error *err);
ph_status ph_i_run_failure_in_time(ph_run *run, ph_error *err);

/** Steps at which a loading wants the stiffness, from 1 on, and how many they are. */
bool ph_i_wants_stiffness(const ph_loading *loading, int step);
int ph_i_stiffness_steps(const ph_loading *loading);
/** @return PH_EINVAL with what is wrong */
ph_status ph_i_check_loading(const ph_run *run, ph_error *err);
/** Cut the cracks that are there, and make run->result->failure with their damage. */
ph_status ph_i_failure_begin(ph_run *run, ph_error *err);
/** One more event, zeroed. */
ph_status ph_i_failure_event(ph_failure_path *path, ph_failure_event **out,
                             ph_error *err);

#endif
