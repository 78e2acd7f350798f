/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Grids, from the one that the plan expects to be fine enough to the one that is. */
#include <perihom/error_bar.h>

#include "fidelity/fidelity.h"

#include <math.h>
#include <string.h>
#include <time.h>

/* Set on random cells that the study does not hold, docs/accuracy-costs.md. */
static const double order = 1.7; /* of what is taken away */
/* Estimated error: k |d|^(1-w) e^w of what two grids and the plan say; next grids are chosen as
 * if it fell as n^-q. Errors are smoother in space. */
typedef struct estimate {
    double k, w, q;
} estimate;
static const estimate in_plane = {1.8, 0.3, 1.3}, in_space = {0.9, 0.0, 1.7};
static const double coarse_grids =
    10; /* laws of small errors say too little of large ones */
static const double least_step = 1.15; /* nodes of the next grid over those of this */
static const double most_step = 2;
static const double more_bytes = 1.1;
static const double slower = 1.3; /* seconds of the next grid over their prediction */
/* Companions of a grid: ratios of nodes that tell the law from the noise. */
static const double least_ratio = 1.3, most_ratio = 4.1;
/* Share of the accuracy that the solver may take, as seen in the tensor's asymmetry. */
static const double for_solver = 0.25;
static const double lowest_tolerance = 1e-10;

/* A grid that was solved. */
typedef struct solution {
    ptrdiff_t n; /* nodes of the longest axis; 0: none */
    ph_sym4 stiffness;
    ph_microstructure *micro;
    ph_crack_plan *cracks;
    ph_result *result;
} solution;

typedef struct search {
    const ph_case *c;
    const ph_ctx *ctx;
    ph_fidelity *f;
    double start;
    double left; /* error of what is offered over the first-order one of its finer grid */
    solution fine, coarse;
} search;

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void clear(solution *s)
{
    ph_result_free(&s->result);
    ph_crack_plan_free(&s->cracks);
    ph_microstructure_free(&s->micro);
    s->n = 0;
}

void ph_fidelity_free(ph_fidelity **f)
{
    if (!f || !*f) return;
    ph_result_free(&(*f)->result);
    ph_crack_plan_free(&(*f)->cracks);
    ph_microstructure_free(&(*f)->micro);
    free(*f);
    *f = NULL;
}

/* ---- one grid ---- */

static ph_case with_settings(const search *s, ptrdiff_t n)
{
    ph_case mine = *s->c; /* borrows the arrays */
    mine.nconstants = 0;  /* the whole tensor: it is combined with another one */
    mine.solver.tolerance = s->f->tolerance;
    mine.solver.energy = s->f->plan.energy;
    if (!(s->c->accuracy.given & PH_SETTING_PRECISION)) mine.solver.precision = "auto";
    if (!s->f->plan.fixed || n != ph_i_fidelity_longest(s->c->nodes))
        ph_i_fidelity_grid(s->c, n, mine.nodes);
    return mine;
}

static void note_step(search *s, const ph_case *mine, const ph_result *r, double seconds,
                      double cpu)
{
    ph_fidelity *f = s->f;
    f->seconds += seconds;
    f->cpu += cpu;
    f->operations += r ? ph_trade_work(r) : 0;
    if (f->nsteps == PH_FIDELITY_STEPS) return;
    ph_fidelity_step *step = &f->step[f->nsteps++];
    *step = (ph_fidelity_step){.tolerance = mine->solver.tolerance, .estimate = NAN};
    memcpy(step->nodes, mine->nodes, sizeof step->nodes);
    for (int k = 0; k < f->plan.nconstants; k++) {
        step->value[k] = NAN;
        if (r && r->converged)
            ph_quantity_value(&f->plan.constant[k], r, &step->value[k], NULL);
    }
    if (r) step->work = r->work;
    step->operations = r ? ph_trade_work(r) : 0;
    step->seconds = seconds;
    step->cpu = cpu;
}

/* May the tolerance be lower than it is? */
static bool may_tighten(const search *s)
{
    return !(s->c->accuracy.given & PH_SETTING_TOLERANCE) &&
           s->f->tolerance > lowest_tolerance;
}

static ph_status solve_once(search *s, const ph_case *mine, solution *out, ph_error *err)
{
    ph_status st = PH_OK;
    double start = now(), cpu = ph_i_cpu_seconds();
    PH_TRY(ph_rve_build(mine, &out->micro, err));
    PH_TRY(ph_rve_cracks(mine, &out->cracks, err));
    const ph_problem problem = ph_rve_problem(mine, out->micro, out->cracks);
    st = ph_homogenise(&problem, s->ctx, &out->result, err);
    if (st == PH_OK || st == PH_ENOCONV)
        note_step(s, mine, out->result, now() - start, ph_i_cpu_seconds() - cpu);
out:
    return st;
}

/* The equations are solved to their tolerance, and yet the tensor is not good enough. */
static bool is_too_loose(const ph_result *r, double tolerance)
{
    double worst = 0;
    for (int k = 0; r && k < r->nloads; k++)
        worst = fmax(worst, r->residual[k]);
    return r && r->nloads > 0 && worst <= tolerance;
}

/* Solve a grid; with a lower tolerance where the solver's error shows. */
static ph_status solve_grid(search *s, ptrdiff_t n, solution *out, ph_error *err)
{
    ph_status st = PH_OK;
    for (;;) {
        ph_error why = PH_ERROR_INIT;
        const ph_case mine = with_settings(s, n);
        clear(out);
        st = solve_once(s, &mine, out, &why);
        bool rough = st == PH_OK && !(mine.solver.energy > 0) &&
                     out->result->asymmetry > for_solver * s->f->plan.accuracy;
        rough |= st == PH_ENOCONV && is_too_loose(out->result, s->f->tolerance);
        if (rough && may_tighten(s)) {
            s->f->tolerance = fmax(0.1 * s->f->tolerance, lowest_tolerance);
            continue;
        }
        if (st != PH_OK && err) *err = why;
        break;
    }
    PH_TRY(st);
    out->n = n;
    out->stiffness = out->result->stiffness;
out:
    return st;
}

/* ---- what two grids say ---- */

static double value_of(const search *s, const ph_quantity *q, const ph_sym4 *stiffness)
{
    double x = NAN;
    const ph_result r = {.stiffness = *stiffness,
                         .loads = (1u << stiffness->n) - 1u,
                         .grid = {.kinematics = s->c->kinematics}};
    return ph_quantity_value(q, &r, &x, NULL) == PH_OK ? x : (double)NAN;
}

/* Worst constant of a stiffness against another one. */
static double distance(const search *s, const ph_sym4 *from, const ph_sym4 *to)
{
    double worst = 0;
    for (int k = 0; k < s->f->plan.nconstants; k++) {
        const ph_quantity *q = &s->f->plan.constant[k];
        double error = ph_trade_error(q, value_of(s, q, from), value_of(s, q, to));
        worst = fmax(worst, isfinite(error) ? error : 1);
    }
    return worst;
}

/* A tensor of two others may have no inverse. */
static bool is_physical(const search *s, const ph_sym4 *offered, const ph_sym4 *fine)
{
    for (int k = 0; k < s->f->plan.nconstants; k++) {
        const ph_quantity *q = &s->f->plan.constant[k];
        if (!(value_of(s, q, offered) > 0) && value_of(s, q, fine) > 0) return false;
    }
    return true;
}

static const estimate *estimate_of(const search *s)
{
    return ph_i_fidelity_axes(s->c) == 3 ? &in_space : &in_plane;
}

/* The offered stiffness, and its error. */
static double judge(search *s, ph_sym4 *offered, bool *improved)
{
    const solution *fine = &s->fine, *coarse = &s->coarse;
    double ratio = (double)fine->n / (double)coarse->n;
    double step = 1 / (pow(ratio, order) - 1);
    double raw = distance(s, &coarse->stiffness, &fine->stiffness) / (ratio - 1);
    double expected = ph_i_fidelity_expected(&s->f->plan, (double)fine->n), error = raw;
    const estimate *by = estimate_of(s);
    *offered = ph_sym4_combine(1 + step, &fine->stiffness, -step, &coarse->stiffness);
    *improved = is_physical(s, offered, &fine->stiffness);
    if (*improved) {
        double moved = distance(s, &fine->stiffness, offered);
        error = by->k * moved;
        if (expected > 0) error = by->k * pow(moved, 1 - by->w) * pow(expected, by->w);
        error *= 1 + coarse_grids * error;
        s->f->grid_error = moved + error;
    } else {
        *offered = fine->stiffness;
        s->f->grid_error = error;
    }
    s->left = raw > 0 ? error / raw : 1;
    return error;
}

/* ---- the budget ---- */

/* Bytes and seconds of a grid: as those of the last one, a cell; before, as the plan has it. */
static void foresee(const search *s, double cells, double *bytes, double *seconds)
{
    const ph_fidelity *f = s->f;
    *bytes = f->plan.bytes_a_node * cells;
    *seconds = f->plan.seconds_a_node * cells;
    if (f->nsteps == 0) return;
    const ph_fidelity_step *last = &f->step[f->nsteps - 1];
    double share = cells;
    for (int a = 0; a < 3; a++)
        share /= (double)last->nodes[a];
    *bytes = more_bytes * (double)last->work.peak_bytes * share;
    *seconds = slower * last->seconds * share;
}

static double cells_of(const search *s, ptrdiff_t n)
{
    ptrdiff_t nodes[3];
    ph_i_fidelity_grid(s->c, n, nodes);
    return (double)nodes[0] * (double)nodes[1] * (double)nodes[2];
}

static bool affordable(search *s, ptrdiff_t n)
{
    const ph_case_accuracy *a = &s->c->accuracy;
    double cells = cells_of(s, n), spent = now() - s->start;
    double seconds, bytes;
    foresee(s, cells, &bytes, &seconds);
    bool time = a->seconds > 0 && spent + seconds > a->seconds;
    bool memory = a->memory > 0 && bytes > a->memory;
    if (!time && !memory) {
        s->f->missing[0] = 0;
        return true;
    }
    snprintf(s->f->missing, sizeof s->f->missing,
             "budget.%s: the %s grid, %td nodes along the longest axis, takes about "
             "%.2g s and %.2g bytes; %.2g s are spent",
             time ? "seconds" : "memory", s->f->nsteps ? "next" : "first", n, seconds,
             bytes, spent);
    return false;
}

/* ---- the search ---- */

static ptrdiff_t half_of(ptrdiff_t n)
{
    ptrdiff_t half = (n + 1) / 2;
    return half < 4 && n > 5 ? 4 : half < 2 ? 2 : half;
}

/* Companion of a first grid of n nodes. */
static ph_status begin(search *s, ptrdiff_t n, ph_error *err)
{
    ph_status st = PH_OK;
    ptrdiff_t half = half_of(n);
    if (s->c->nfillers > 0 && !s->f->plan.fixed) { /* the drawing, and a finer grid */
        half = n;
        n = ph_i_fidelity_round(1.5 * (double)n);
    }
    /* What can be had; no grid coarser than the drawing shows the fillers. */
    while (!s->f->plan.fixed && !s->c->nfillers && n > 8 && !affordable(s, n)) {
        n = half;
        half = half_of(n);
    }
    PH_CHECK(affordable(s, half), PH_ENOCONV, "accuracy %.3g %% is not reached: %s",
             100 * s->f->plan.accuracy, s->f->missing);
    PH_TRY(solve_grid(s, half, &s->coarse, err));
    if (affordable(s, n)) {
        PH_TRY(solve_grid(s, n, &s->fine, err));
        goto out;
    }
    /* That is then all there is, with what a coarser one says of it. */
    s->fine = s->coarse;
    s->coarse = (solution){0};
    if (s->c->nfillers > 0 || half_of(half) >= half) goto out;
    char missing[sizeof s->f->missing];
    memcpy(missing, s->f->missing, sizeof missing);
    PH_TRY(solve_grid(s, half_of(half), &s->coarse, err));
    memcpy(s->f->missing, missing, sizeof missing);
out:
    return st;
}

/* Take the offered tensor over. */
static void offer(search *s)
{
    ph_fidelity *f = s->f;
    ph_sym4 offered = s->fine.stiffness;
    f->error = f->grid_error = NAN;
    f->improved = false;
    if (s->coarse.n) f->error = judge(s, &offered, &f->improved);
    s->fine.result->stiffness = offered;
    ph_fidelity_step *last = &f->step[f->nsteps - 1];
    last->estimate = f->error;
    last->improved = f->improved;
    f->reached = f->error <= f->plan.accuracy;
}

static ptrdiff_t next_grid(const search *s)
{
    const ph_fidelity *f = s->f;
    double more = pow(f->error / f->plan.accuracy, 1 / estimate_of(s)->q);
    more = fmin(fmax(more, least_step), most_step);
    ptrdiff_t n = ph_i_fidelity_round(more * (double)s->fine.n);
    return n > s->fine.n ? n : ph_i_fidelity_round((double)s->fine.n + 1);
}

/* One grid further. @param[out] on false: there is none */
static ph_status go_on(search *s, bool *on, ph_error *err)
{
    ph_status st = PH_OK;
    ph_fidelity *f = s->f;
    solution next = {0}, half = {0};
    ptrdiff_t n = next_grid(s);
    *on = false;
    if (f->plan.fixed) {
        snprintf(f->missing, sizeof f->missing,
                 "microstructure.nodes are given: %.3g %% needs about %.0f along the "
                 "longest axis; without them the grid is chosen",
                 100 * f->plan.accuracy, (double)s->fine.n * f->error / f->plan.accuracy);
        goto out;
    }
    if (n <= s->fine.n || f->nsteps >= PH_FIDELITY_STEPS - 2) {
        snprintf(f->missing, sizeof f->missing, "no finer grid is admissible");
        goto out;
    }
    if (!affordable(s, n)) {
        size_t at = strlen(f->missing);
        double needed = (double)s->fine.n * f->error / f->plan.accuracy;
        snprintf(f->missing + at, sizeof f->missing - at,
                 "; %.3g %% needs about %.0f nodes", 100 * f->plan.accuracy, needed);
        goto out;
    }
    double ratio = (double)n / (double)s->fine.n;
    bool near = ratio >= least_ratio && ratio <= most_ratio;
    if (!near && (double)n / (double)s->coarse.n > most_ratio)
        PH_TRY(solve_grid(s, half_of(n), &half, err));
    PH_TRY(solve_grid(s, n, &next, err));
    s->fine.result->stiffness = s->fine.stiffness;
    solution *companion = near ? &s->fine : half.n ? &half : NULL;
    if (companion) {
        clear(&s->coarse);
        s->coarse = *companion;
        *companion = (solution){0};
    }
    clear(&s->fine);
    s->fine = next;
    next = (solution){0};
    *on = true;
out:
    clear(&half);
    clear(&next);
    return st;
}

/* Error bars of every constant: as those of a grid whose companion is off by what is left. The
 * extrapolated values are those of the two grids as they are. */
static ph_status put_bars(search *s, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_sym4 *fine = &s->fine.stiffness, *coarse = &s->coarse.stiffness;
    ph_result *r = s->fine.result;
    ph_error_bar *bar = NULL, *plain = NULL;
    double ratio = (double)s->fine.n / (double)s->coarse.n;
    ph_sym4 step = ph_sym4_combine(1, fine, -1, coarse),
            companion = ph_sym4_combine(1, &r->stiffness, -s->left, &step);
    const ph_error_evidence grids = {
        .result = r, .stiffness = fine, .coarse = coarse, .ratio = ratio};
    ph_error_evidence e = grids;
    e.stiffness = NULL;
    e.coarse = &companion;
    e.expected =
        fmin(s->left, 1) * ph_i_fidelity_expected(&s->f->plan, (double)s->fine.n);
    e.parts = s->c->error_parts;
    PH_ALLOC(bar, 1, "error bars");
    PH_ALLOC(plain, 1, "extrapolated values");
    PH_TRY(ph_error_bar_estimate(&e, bar, err));
    PH_TRY(ph_error_bar_estimate(&grids, plain, err));
    ph_i_fidelity_grid(s->c, s->coarse.n, bar->nodes);
    for (int k = 0; k < bar->count; k++)
        bar->constant[k].richardson = plain->constant[k].richardson;
    free(r->error_bar);
    r->error_bar = bar;
    bar = NULL;
out:
    free(plain);
    free(bar);
    return st;
}

/* What the search found, into the caller's hands. */
static void hand_over(search *s)
{
    ph_fidelity *f = s->f;
    f->settings = with_settings(s, s->fine.n);
    memcpy(f->nodes, f->settings.nodes, sizeof f->nodes);
    f->result = s->fine.result;
    f->micro = s->fine.micro;
    f->cracks = s->fine.cracks;
    s->fine = (solution){0};
    f->result->seconds = f->seconds;
    int k = f->result->nnotes;
    if (f->improved && k < PH_MAX_NOTES)
        snprintf(f->result->notes[f->result->nnotes++], sizeof f->result->notes[0],
                 "accuracy: the stiffness is extrapolated from two grids");
}

static ph_status climb(search *s, ph_error *err)
{
    ph_status st = PH_OK;
    ph_fidelity *f = s->f;
    bool on = true;
    PH_TRY(begin(s, ph_i_fidelity_longest(f->plan.nodes), err));
    offer(s);
    while (on && !f->reached && s->coarse.n) {
        ph_error why = PH_ERROR_INIT;
        st = go_on(s, &on, &why);
        if (st == PH_ENOCONV) { /* the grid before is what there is */
            snprintf(f->missing, sizeof f->missing, "the next grid: %.300s", why.msg);
            st = PH_OK;
            break;
        }
        if (st != PH_OK && err) *err = why;
        PH_TRY(st);
        if (on) offer(s);
    }
    if (s->coarse.n && s->c->error_parts) PH_TRY(put_bars(s, err));
    hand_over(s);
    char error[64] = "";
    if (isfinite(f->error))
        snprintf(error, sizeof error, ", the error is about %.2g %%", 100 * f->error);
    PH_CHECK(f->reached, PH_ENOCONV, "accuracy %.3g %% is not reached%s: %s",
             100 * f->plan.accuracy, error, f->missing);
out:
    return st;
}

ph_status ph_fidelity_solve(const ph_case *c, const ph_ctx *ctx, ph_fidelity **out,
                            ph_error *err)
{
    PH_GIVEN(c && out);
    ph_status st = PH_OK;
    search s = {.c = c, .ctx = ctx, .start = now()};
    PH_ALLOC(s.f, 1, "a search for settings");
    PH_TRY(ph_fidelity_plan_case(c, &s.f->plan, err));
    s.f->tolerance = s.f->plan.tolerance;
    st = climb(&s, err);
    if (s.f->result) {
        *out = s.f;
        s.f = NULL;
    }
out:
    clear(&s.fine);
    clear(&s.coarse);
    ph_fidelity_free(&s.f);
    return st;
}
