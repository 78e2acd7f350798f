/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Error bars of the result of a case: its companions, and what they say. */
#include "companion.h"
#include "core/check.h"
#include "slope.h"

#include <math.h>
#include <string.h>

/* All that was solved beside one result. */
typedef struct evidence {
    ph_i_companion k;
    ph_result *result;
    ph_result *coarse, *half, *other; /* coarser grid: as it is, half the horizon, another
                                       * constraint */
    ph_result *pristine;              /* coarser grid, and nothing is loaded or cracked */
    ph_viscoelastic *relaxation;      /* coarser grid */
    ph_sym4 matrix;
    char no_horizon[200], no_boundary[200], no_pristine[200];
    ph_error_evidence e;
} evidence;

/* What is set into the result when all of it is there. */
typedef struct outcome {
    ph_error_bar *last, *steps, *pristine;
    ph_failure_error *failure;
} outcome;

static const double pi = 3.14159265358979323846;

static const char other_path[] =
    "bonds break: on another grid they take another path; see "
    "effective.damage.pristine_error_bar and "
    "effective.failure.difference";

static void outcome_clear(outcome *b)
{
    free(b->last);
    free(b->steps);
    free(b->pristine);
    free(b->failure);
}

static void clear(evidence *v)
{
    ph_result_free(&v->coarse);
    ph_result_free(&v->half);
    ph_result_free(&v->other);
    ph_result_free(&v->pristine);
    ph_viscoelastic_free(&v->relaxation);
    ph_i_companion_clear(&v->k);
}

static bool wants(const evidence *v, const char *part)
{
    for (size_t i = 0; i < ph_nerror_parts; i++)
        if (strcmp(ph_error_parts[i].info.name, part) == 0)
            return v->k.c->error_parts >> i & 1u;
    return false;
}

/* ---- fractions: reached, and asked for ---- */

/* What is painted by node centres against what cut cells hold, which is exact. */
static ph_status painted_off(evidence *v, double *off, ph_error *err)
{
    ph_status st = PH_OK;
    ph_case exact = v->k.coarse;
    ph_microstructure *micro = NULL;
    double *fraction = NULL;
    exact.interface = PH_INTERFACE_COMPOSITE;
    PH_TRY(ph_rve_paint(&exact, v->k.packing, &micro, err));
    PH_ALLOC(fraction, micro->nmaterials, "fractions");
    ph_microstructure_fractions(micro, fraction);
    for (int m = 0; m < micro->nmaterials; m++)
        if (m != v->k.c->matrix) *off += fabs(fraction[m] - v->result->fractions[m]);
out:
    ph_microstructure_free(&micro);
    free(fraction);
    return st;
}

static ph_status fractions(evidence *v, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_case *c = v->k.c;
    if (c->voxels.file[0] || !wants(v, "geometry")) return PH_OK;
    PH_TRY(ph_sym4_reduce(&c->materials[c->matrix].stiffness, c->kinematics, &v->matrix,
                          err));
    v->e.matrix = &v->matrix;
    v->e.share = 1.0 - v->result->fractions[c->matrix];
    for (int i = 0; v->k.packing && i < v->k.packing->nkinds; i++) {
        const ph_filler_report *r = &v->k.packing->kind[i];
        if (isfinite(r->target)) v->e.share_off += fabs(r->target - r->reached);
    }
    if (v->result->interface == PH_INTERFACE_NODE_CENTRE && v->k.micro)
        PH_TRY(painted_off(v, &v->e.share_off, err));
out:
    return st;
}

/* In the plane corners are off more than what is round, and mixed voxels less. */
static const double corners = 1.7, voxels = 0.5;

static bool has_corner(const ph_solid *s)
{
    return s->kind[0] == PH_EXTENT_FLAT && s->kind[1] == PH_EXTENT_FLAT;
}

static bool has_corners(const evidence *v)
{
    const ph_case *c = v->k.c;
    const ph_packing *p = v->k.packing;
    ph_solid solid;
    for (int i = 0; i < c->ninclusions; i++)
        if (ph_shape_place(&c->inclusions[i], &v->result->grid, &solid, NULL) == PH_OK &&
            has_corner(&solid))
            return true;
    for (ptrdiff_t i = 0; p && i < p->nsolids; i++)
        if (has_corner(&p->solid[i])) return true;
    return false;
}

/* What is known of the two grids. Squares that a finer grid shows are exact on both: no law. */
static void look(evidence *v)
{
    const ph_microstructure *m = v->k.problem->micro;
    double n = 1.0;
    v->e.no_coarse = v->k.why;
    v->e.ratio = v->k.ratio;
    v->e.by_centres = v->result->interface == PH_INTERFACE_NODE_CENTRE &&
                      v->k.coarse_problem.interface == PH_INTERFACE_NODE_CENTRE;
    if (v->k.why[0] || v->k.ratio < 1.0) return;
    for (int a = 0; a < 3; a++)
        n = fmax(n, (double)m->grid.n[a]);
    ph_interface interface =
        v->e.by_centres ? PH_INTERFACE_NODE_CENTRE : PH_INTERFACE_COMPOSITE;
    v->e.expected = ph_i_slope_of(m, interface, v->result).slope / n;
    v->e.mixed = v->k.c->voxels.file[0] != 0;
    if (v->e.mixed)
        v->e.expected *= voxels;
    else if (m->grid.kinematics != PH_SPACE && has_corners(v))
        v->e.expected *= corners;
}

/* ---- what is asked for beside: half the horizon, another constraint ---- */

static ph_status solve_half(evidence *v, ph_error *err)
{
    ph_status st = PH_OK;
    ph_problem p = v->k.coarse_problem;
    v->e.no_horizon = v->no_horizon;
    if (!wants(v, "horizon") || !v->coarse || v->result->failure) {
        snprintf(v->no_horizon, sizeof v->no_horizon, "%s", v->e.no_coarse);
        return PH_OK;
    }
    if (!p.model.horizon_is_length) {
        snprintf(v->no_horizon, sizeof v->no_horizon,
                 "the horizon goes with the spacing: it is in the discretisation");
        return PH_OK;
    }
    p.model.horizon *= 0.5;
    PH_TRY(ph_i_companion_solve(&v->k, &p, &v->half, v->no_horizon, err));
    if (!v->half) return PH_OK;
    v->e.horizon = &v->coarse->stiffness;
    v->e.half_horizon = &v->half->stiffness;
out:
    return st;
}

/* Periodic against linear displacements, all else against periodic. */
static ph_status solve_other(evidence *v, ph_error *err)
{
    ph_status st = PH_OK;
    ph_problem p = v->k.coarse_problem;
    bool periodic = strcmp(v->result->constraint, "periodic") == 0;
    v->e.no_boundary = v->no_boundary;
    if (!wants(v, "boundary") || !v->coarse || v->result->failure) {
        snprintf(v->no_boundary, sizeof v->no_boundary, "%s", v->e.no_coarse);
        return PH_OK;
    }
    p.constraint =
        (ph_constraint_params){.kind = periodic ? "linear_displacement" : "periodic"};
    PH_TRY(ph_i_companion_solve(&v->k, &p, &v->other, v->no_boundary, err));
    if (!v->other) return PH_OK;
    v->e.constraint = &v->coarse->stiffness;
    v->e.other_constraint = &v->other->stiffness;
out:
    return st;
}

/* ---- an elastic result, with cracks or without ---- */

static ph_status judge(evidence *v, ph_error_bar *bar, ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(ph_error_bar_estimate(&v->e, bar, err));
    bar->seconds = v->k.seconds;
    bar->iterations = v->k.iterations;
    bar->applications = v->k.applications;
    bar->ffts = v->k.ffts;
    if (v->coarse) memcpy(bar->nodes, v->coarse->grid.n, sizeof bar->nodes);
out:
    return st;
}

/* Spacing over the half length of the cracks, where several are there of all together. */
static double tips_of(const ph_grid *g, const ph_damage_step *s)
{
    double h = 0.0, half = g->kinematics == PH_SPACE ? pi : 2.0;
    if (!(s->surface > 0.0 && s->density > 0.0)) return 0.0;
    for (int a = 0; a < 3; a++)
        if (g->n[a] > 1) h = fmax(h, g->size[a] / (double)g->n[a]);
    half *= s->density / s->surface; /* sum of a^2 over that of a, of a^3 over a^2 */
    return h / half;
}

/* Every step against the same step of the companion; the last one is the result. */
static ph_status judge_steps(evidence *v, outcome *b, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_damage *d = v->result->damage;
    const ph_damage *coarse = v->coarse ? v->coarse->damage : NULL;
    if (!d || !coarse || coarse->nsteps != d->nsteps || d->nsteps < 1) return PH_OK;
    PH_ALLOC(b->steps, d->nsteps, "the error bars of the steps");
    for (int i = 0; i < d->nsteps; i++) {
        v->e.stiffness = &d->step[i].stiffness;
        v->e.stabilisation = &d->step[i].stabilisation_energy;
        v->e.coarse = &coarse->step[i].stiffness;
        v->e.uncracked = &d->pristine;
        v->e.tips = tips_of(&v->result->grid, &d->step[i]);
        PH_TRY(judge(v, &b->steps[i], err));
    }
    *b->last = b->steps[d->nsteps - 1];
out:
    return st;
}

/* The cell without cracks. The stabilisation is that of the first step, which has no less. */
static ph_status judge_pristine(evidence *v, outcome *b, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_damage *d = v->result->damage,
                    *coarse = v->coarse ? v->coarse->damage : NULL;
    if (!d || d->nsteps < 1) return PH_OK;
    PH_ALLOC(b->pristine, 1, "the error bars of the pristine cell");
    v->e.stiffness = &d->pristine;
    v->e.stabilisation = &d->step[0].stabilisation_energy;
    v->e.tips = 0.0;
    v->e.coarse = NULL;
    v->e.no_coarse = v->result->failure ? v->no_pristine : v->k.why;
    if (v->pristine)
        v->e.coarse = &v->pristine->stiffness;
    else if (coarse && !v->result->failure)
        v->e.coarse = &coarse->pristine;
    PH_TRY(judge(v, b->pristine, err));
out:
    return st;
}

static double apart(const evidence *v, double value, double coarse)
{
    return fabs(coarse - value) / (fabs(v->k.ratio - 1.0) * fabs(value));
}

/* The two paths of breaks. */
static ph_status judge_failure(evidence *v, outcome *b, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_failure_path *p = v->result->failure,
                          *q = v->coarse ? v->coarse->failure : NULL;
    if (!p) return PH_OK;
    PH_ALLOC(b->failure, 1, "the errors of the path");
    ph_failure_error *e = b->failure;
    *e = (ph_failure_error){NAN, NAN, NAN, NAN, NAN, NAN, ""};
    if (!q) {
        snprintf(e->why, sizeof e->why, "%s",
                 v->k.why[0] ? v->k.why : "no discretisation is asked for");
        return PH_OK;
    }
    e->first_load = apart(v, p->first_load, q->first_load);
    e->peak_load = apart(v, p->peak_load, q->peak_load);
    e->peak_stress = apart(v, p->peak_stress, q->peak_stress);
    e->toughness = apart(v, p->toughness, q->toughness);
    e->first_time = apart(v, p->first_time, q->first_time);
    e->end_time = apart(v, p->end_time, q->end_time);
out:
    return st;
}

static ph_status judge_all(evidence *v, outcome *b, ph_error *err)
{
    ph_status st = PH_OK;
    PH_ALLOC(b->last, 1, "error bars");
    PH_TRY(judge(v, b->last, err));
    if (!v->result->failure) PH_TRY(judge_steps(v, b, err));
    PH_TRY(judge_pristine(v, b, err));
    PH_TRY(judge_failure(v, b, err));
out:
    return st;
}

/* The result owns them from now on. */
static void hand_over(outcome *b, ph_result *r)
{
    free(r->error_bar);
    r->error_bar = b->last;
    if (r->damage) {
        free(r->damage->error_bars);
        free(r->damage->pristine_error_bar);
        r->damage->error_bars = b->steps;
        r->damage->pristine_error_bar = b->pristine;
    }
    if (r->failure) {
        free(r->failure->error);
        r->failure->error = b->failure;
    }
    *b = (outcome){0};
}

/* Where the path keeps the length of the horizon, the stiffness goes with the spacing as the
 * case says. */
static ph_status solve_pristine(evidence *v, ph_error *err)
{
    ph_problem p = v->k.coarse_problem;
    p.model = v->k.problem->model;
    p.loading = NULL;
    p.failure = NULL;
    p.cracks = NULL;
    p.sequence = NULL;
    return ph_i_companion_solve(&v->k, &p, &v->pristine, v->no_pristine, err);
}

/* The companions without which there is no bar. */
static ph_status solve_coarse(evidence *v, ph_error *err)
{
    ph_status st = PH_OK;
    snprintf(v->no_pristine, sizeof v->no_pristine, "%s", v->k.why);
    if (v->k.why[0] || !wants(v, "discretisation")) return PH_OK;
    if (v->result->failure) PH_TRY(solve_pristine(v, err));
    PH_TRY(ph_i_companion_solve(&v->k, &v->k.coarse_problem, &v->coarse, v->k.why, err));
out:
    return st;
}

static ph_status collect(evidence *v, ph_error *err)
{
    ph_status st = PH_OK;
    v->e = (ph_error_evidence){.result = v->result, .parts = v->k.c->error_parts};
    PH_TRY(ph_i_companion_build(&v->k, err));
    PH_TRY(solve_coarse(v, err));
    look(v);
    if (v->coarse && v->result->failure) v->e.no_coarse = other_path;
    if (v->coarse && !v->result->failure) v->e.coarse = &v->coarse->stiffness;
    PH_TRY(solve_half(v, err));
    PH_TRY(solve_other(v, err));
    PH_TRY(fractions(v, err));
out:
    return st;
}

static bool is_complete(const ph_result *r)
{
    unsigned all = (1u << ph_strains(r->grid.kinematics)) - 1u;
    return r->converged && (r->loads & all) == all;
}

ph_status ph_rve_error_bar(const ph_case *c, const ph_problem *problem, const ph_ctx *ctx,
                           ph_result *result, ph_error *err)
{
    PH_GIVEN(c && problem && problem->micro && result);
    ph_status st = PH_OK;
    evidence v = {
        .k = {.c = c, .problem = problem, .ctx = ctx, .horizon = result->horizon},
        .result = result};
    outcome b = {0};
    if (c->error_parts == 0 || !is_complete(result) || problem->nconstants > 0)
        return PH_OK;
    PH_TRY(collect(&v, err));
    PH_TRY(judge_all(&v, &b, err));
    hand_over(&b, result);
out:
    outcome_clear(&b);
    clear(&v);
    return st;
}

/* ---- a relaxation ---- */

/* The same route on the coarser grid; what fails is a reason. */
static ph_status relax(evidence *v, const ph_relaxation_params *params, ph_error *err)
{
    ph_error own = PH_ERROR_INIT;
    if (v->k.why[0] || !wants(v, "discretisation")) return PH_OK;
    ph_status st = ph_viscoelastic_solve(&v->k.coarse_problem, params, v->k.ctx,
                                         &v->relaxation, &own);
    if (st == PH_ECANCELLED || st == PH_ENOMEM) {
        if (err) *err = own;
        return st;
    }
    if (st != PH_OK) {
        snprintf(v->k.why, sizeof v->k.why, "coarser grid: %.150s", own.msg);
    } else {
        v->k.seconds += v->relaxation->seconds;
        v->k.iterations += v->relaxation->iterations;
        v->k.applications += v->relaxation->applications;
    }
    return PH_OK;
}

static ph_sym4 at(const ph_viscoelastic *v, double time)
{
    return isinf(time)   ? v->series->equilibrium
           : time == 0.0 ? ph_prony_instantaneous(v->series)
                         : ph_prony_at_time(v->series, time);
}

/* The bars of an effective relaxation. */
typedef struct time_bars {
    int n;
    ph_time_error_bar *at; /* [n] at once, one a decade, at last */
} time_bars;

static ph_status times_of(const ph_prony *series, time_bars *bars, ph_error *err)
{
    ph_status st = PH_OK;
    int n = 0;
    double *grid = NULL;
    PH_TRY(ph_prony_grid(series, false, 1, &n, &grid, err));
    PH_ALLOC(bars->at, n + 2, "the error bars of the times");
    for (int i = 0; i < n; i++)
        bars->at[i + 1].time = grid[i];
    bars->at[n + 1].time = INFINITY;
    bars->n = n + 2;
out:
    free(grid);
    return st;
}

static ph_status judge_times(evidence *v, const ph_viscoelastic *x, time_bars *bars,
                             ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(times_of(x->series, bars, err));
    for (int i = 0; i < bars->n; i++) {
        double time = bars->at[i].time;
        ph_sym4 here = at(x, time), there;
        v->e.stiffness = &here;
        if (v->relaxation && v->relaxation->series) {
            there = at(v->relaxation, time);
            v->e.coarse = &there;
        }
        PH_TRY(judge(v, &bars->at[i].bar, err));
        if (v->relaxation)
            memcpy(bars->at[i].bar.nodes, v->k.micro->grid.n,
                   sizeof bars->at[i].bar.nodes);
    }
out:
    v->e.stiffness = v->e.coarse = NULL; /* of this function */
    return st;
}

ph_status ph_rve_relaxation_error_bar(const ph_case *c, const ph_problem *problem,
                                      const ph_relaxation_params *params,
                                      const ph_ctx *ctx, ph_viscoelastic *out,
                                      ph_error *err)
{
    PH_GIVEN(c && problem && problem->micro && params && out && out->elastic);
    ph_status st = PH_OK;
    ph_result *r = out->elastic;
    evidence v = {.k = {.c = c, .problem = problem, .ctx = ctx, .horizon = r->horizon},
                  .result = r};
    ph_error_bar *first = NULL;
    time_bars bars = {0};
    if (c->error_parts == 0 || !out->series || !is_complete(r)) return PH_OK;
    v.e = (ph_error_evidence){.result = r, .parts = c->error_parts, .time = out->error};
    PH_TRY(ph_i_companion_build(&v.k, err));
    PH_TRY(relax(&v, params, err));
    look(&v);
    PH_TRY(fractions(&v, err));
    PH_ALLOC(first, 1, "error bars");
    PH_TRY(judge_times(&v, out, &bars, err));
    *first = bars.at[0].bar;
    free(r->error_bar);
    free(out->error_bars);
    r->error_bar = first;
    out->error_bars = bars.at;
    out->nerror_bars = bars.n;
    first = NULL;
    bars.at = NULL;
out:
    free(first);
    free(bars.at);
    clear(&v);
    return st;
}
