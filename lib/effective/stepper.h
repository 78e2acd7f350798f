/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Time steps of a viscoelastic medium, one elastic-like solve each.
 *
 * Branch m of a phase carries the stress C_m q_m, dq_m/dt + q_m/tau_m = d eps/dt. For a
 * strain that is linear in time over the step, with x = dt/tau_m,
 *
 *     q_m <- exp(-x) q_m + A(x) d eps,   A(x) = (1 - exp(-x))/x
 *
 * is exact ([Simo1998] ch. 10, [Galadima2023] (8-8)), and the step is the elastic problem
 *
 *     B^T C_alg B du = -B^T [ C_inf eps + sum_m exp(-x) C_m q_m + C_alg d macro ]
 *     C_alg = C_inf + sum_m A(x) C_m
 *
 * The strain is B u + macro whatever the model, and q_m obeys a linear equation with the same
 * tau_m in every cell: it is the strain of a displacement field that relaxes,
 * q_m = B w_m + macro_m, w_m <- exp(-x) w_m + A(x) du. One displacement field for each
 * distinct relaxation time is all that the medium remembers: nd numbers a node, whatever the
 * number of strain points, and the operator itself, with C_m for C, gives the forces of the
 * past. Cut cells remember beside it the jumps of their laminates (effective/cut_points.h).
 *
 * A jump is a step with dt = 0. Second order in dt for fields that bend.
 * Tested: tests/unit/test_stepper.c, tests/cross/test_time_and_frequency.c */
#ifndef PH_EFFECTIVE_STEPPER_H
#define PH_EFFECTIVE_STEPPER_H

#include "effective/cut_points.h"
#include "effective/relaxing_bonds.h"
#include "effective/run.h"

#include <string.h>

/** exp(-x), and (1 - exp(-x))/x without cancellation. x >= 0, may overflow to infinity. */
double ph_i_step_decay(double x);
double ph_i_step_ramp(double x);

/** What the medium is in after the last step. Load and response: a component that the
 *  constraint loads by a macro strain answers with a stress, one that it loads by a macro
 *  stress (uniform_traction) with a strain. */
typedef struct ph_step_state {
    double stress[6], strain[6]; /* means over the RVE, Mandel */
    double energy;               /* stored, per volume */
    double dissipation;          /* its rate, per volume */
} ph_step_state;

typedef struct ph_stepper {
    ph_run *run; /* operator, solver, constraint; borrowed */
    ph_relaxing_map *relax;
    ph_cut_points *cuts;      /* or NULL */
    ph_relaxing_bonds *bonds; /* of model bond, or NULL */
    const double *tau;        /* [ntimes] relaxation times */
    double *map_weight;       /* of the times of `relax` */
    double tolerance;         /* of the residual, relative to the forces of the parts */
    int ns, ntimes;
    ptrdiff_t unknowns; /* nd * cells */

    /* The state: one block, all that a restart needs. */
    double *block;
    size_t size;
    double *time, *last_dt; /* of the step before; 0: none, or a jump */
    double *macro, *macro_memory, *last_macro, *traction;
    double *u, *memory, *last, *jump, *jump_memory;

    /* The step that is tried. */
    double dt, tangent_dt; /* tangent_dt: of the tensors in the map; NaN: none */
    double *decay, *ramp, *weight;
    double dmacro[6], dtraction[6];
    double *du, *residual, *work;
    bool pending;     /* `work` is a correction that the residual does not know */
    double reference; /* the forces that the residual is held against */
    double history[6], strain[6]; /* mean stress and strain without the increment */
    double *part; /* [ntimes + 1][6] mean stress of the branches, then C_inf */
    double *held; /* [ntimes + 1] twice the energy of the parts, summed over the cells */
    double part_energy, part_dissipation, mean_strain[6], cut_stress[6];
    bool measured; /* the parts are those of the state */

    long solves, iterations; /* counted */
} ph_stepper;

/** A medium at rest. `run` is built (ph_i_run_build) and keeps its map, whose tensors the
 *  stepper changes; its solver is made anew with each tangent.
 *  @return PH_OK; PH_EUNPHYSICAL (bonds of a phase whose Poisson's ratio moves); PH_ENOMEM */
ph_status ph_i_stepper_new(ph_run *run, double tolerance, ph_stepper **out,
                           ph_error *err);
void ph_i_stepper_free(ph_stepper **stepper);

/** Begin a step of dt >= 0 from the state: tangent, forces of the past, first guess. */
ph_status ph_i_stepper_begin(ph_stepper *s, double dt, ph_error *err);
/** Add to the increment of the load, [ns] Mandel, and solve. May be called again. */
ph_status ph_i_stepper_solve(ph_stepper *s, const double *dload, ph_error *err);
/** The response at the end of the step as it is solved, [ns] Mandel, and the mean stress. */
ph_status ph_i_stepper_response(ph_stepper *s, double *response, double *stress,
                                ph_error *err);
/** Estimated error of the mean stress, as a norm, by the bending of the fields over the step:
 *  their second derivative from the step before, the stress that it makes in the branches,
 *  and what the medium makes of that (a rough solve; the step can then only be accepted). 0
 *  where there was no step before.
 *  @param[in] bends bit a: macro strain a is not a straight line over the step either */
ph_status ph_i_stepper_error(ph_stepper *s, unsigned bends, double *error, ph_error *err);
/** The load turns a corner here: the step before says nothing of the next. */
void ph_i_stepper_corner(ph_stepper *s);
/** Take the step. */
ph_status ph_i_stepper_accept(ph_stepper *s, ph_error *err);
/** Take a step of dt whose increment is known. @param[in] du [unknowns] dmacro [ns] Mandel */
ph_status ph_i_stepper_take(ph_stepper *s, double dt, const double *du,
                            const double *dmacro, ph_error *err);
/** Means of the state. */
ph_status ph_i_stepper_state(ph_stepper *s, ph_step_state *out, ph_error *err);
/** d response / d load of a step of dt: ns solves. The step that is tried is lost.
 *  @param[out] field [ns] of [unknowns], increments of the unit loads; or NULL */
ph_status ph_i_stepper_tangent(ph_stepper *s, double dt, ph_sym4 *tangent,
                               double *const *field, ph_error *err);
/** Bonds have broken: what every branch remembers is from here on the strain of what is left.
 *  Forces are out of balance until a step is made, of dt = 0 where they break at once.
 *  @return PH_OK; PH_ENOMEM */
ph_status ph_i_stepper_broken(ph_stepper *s, ph_error *err);
/** Let operator and solver be those of a jump. */
ph_status ph_i_stepper_instantaneous(ph_stepper *s, ph_error *err);

/** What a step takes, per volume: the work of the mean stress, and what the branches lose.
 *  Integrals over the step of fields that are straight in time, so that without solver errors
 *  external = stored after - stored before + viscous up to the forces out of balance between
 *  the ends of the step, O(dt^2). Not of cut cells. */
typedef struct ph_step_work {
    double external, viscous;
} ph_step_work;
/** Of the step that is solved and not yet taken. Cost: an application and sums for each
 *  branch. Source: lib/effective/step_work.c */
ph_status ph_i_stepper_work(ph_stepper *s, ph_step_work *out, ph_error *err);
/** Let the operator have the tensors of branch m, or of C_inf (m = ntimes); and of the step. */
void ph_i_stepper_show(ph_stepper *s, int m);
void ph_i_stepper_show_tangent(ph_stepper *s);

/** At rest again, at time 0. */
void ph_i_stepper_reset(ph_stepper *s);

/** The state as `size` doubles: put aside and taken up again, bit for bit. */
static inline void ph_i_stepper_save(const ph_stepper *s, double *block)
{
    memcpy(block, s->block, s->size * sizeof(double));
}
void ph_i_stepper_restore(ph_stepper *s, const double *block);

#endif
