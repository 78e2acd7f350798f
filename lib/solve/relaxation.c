/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Adaptive dynamic relaxation [Underwood1983], [Kilic2010]: the steady state of a damped
 * motion with a fictitious density D and unit time step,
 *
 *   D u'' + c D u' + A u = b,   D_i = 1/4 sum_j |A_ij|,
 *   v(n+1/2) = [ (2 - c) v(n-1/2) + 2 F/D ] / (2 + c),  u(n+1) = u(n) + v(n+1/2)
 *
 * with F = b - A u. By Gershgorin's theorem D^-1 A <= 4: the step is stable. The damping is
 * critical for the frequency that the motion shows, from local stiffnesses
 *
 *   k_i = -(F_i(n) - F_i(n-1)) / (D_i v_i(n-1/2)),  c = 2 sqrt( sum k_i w_i / sum w_i )
 *
 * with weights w_i = D_i v_i^2: the Rayleigh quotient of the step. The weights u_i^2 of the
 * references take as many steps or up to 1.6 times as many: docs/theory/solvers.md. */
#include "solve/solver.h"

#include <math.h>
#include <string.h>

enum { PATIENCE = 50 }; /* steps for each iteration that other solvers would be given */
static const double margin = 1.02, most_damping = 1.9;

typedef struct relaxation {
    ph_operator *op;
    ph_meter *meter;
    const ph_setting *setting;
    ph_space space;
    double *inverse;    /* 1/D, zero where nothing moves */
    double *u, *v, *f;  /* displacement, velocity, force */
    double *b, *before; /* load, force of the step before */
} relaxation;

static size_t field_size(const relaxation *s)
{
    return (size_t)(s->op->layout.nd * s->op->layout.cells);
}

const char *ph_i_relaxation_refuses(const ph_system *system)
{
    (void)system;
    return NULL;
}

void ph_i_relaxation_free(void **state)
{
    relaxation *s = *state;
    if (!s) return;
    double **field[] = {&s->inverse, &s->u, &s->v, &s->f, &s->b, &s->before};
    for (size_t i = 0; i < sizeof field / sizeof *field; i++)
        ph_i_doubles_free(s->meter, field[i], field_size(s));
    ph_i_space_clear(&s->space);
    free(s);
    *state = NULL;
}

/* 1/D of everything that is free and has stiffness. */
static ph_status densities(relaxation *s, const ph_operator_params *params, ph_error *err)
{
    ph_status st = PH_OK;
    ph_assembly list = {0};
    const uint8_t *fixed = s->setting->fixed;
    PH_TRY(ph_i_assembly_init(&list, s->op, &s->setting->box, params, s->meter, err));
    PH_TRY(ph_i_assembly_row_sums(&list, s->inverse, err));
    for (size_t i = 0; i < field_size(s); i++) {
        bool held = fixed && fixed[i % (size_t)s->op->layout.cells];
        double sum = s->inverse[i];
        s->inverse[i] = held || sum <= 0.0 ? 0.0 : 4.0 / (margin * sum);
    }
out:
    ph_i_assembly_clear(&list);
    return st;
}

ph_status ph_i_relaxation_init(const ph_system *system, void **state, ph_error *err)
{
    ph_status st = PH_OK;
    relaxation *s = NULL;
    void *self = NULL;
    PH_ALLOC(s, 1, "the solver");
    self = s;
    s->op = system->op;
    s->meter = system->meter;
    s->setting = system->setting;
    PH_TRY(ph_i_operator_in_space(s->op, err));
    PH_TRY(ph_i_space_init(&s->space, &s->op->layout, NULL, s->op->threads, err));
    double **field[] = {&s->inverse, &s->u, &s->v, &s->f, &s->b, &s->before};
    for (size_t i = 0; i < sizeof field / sizeof *field; i++)
        PH_DOUBLES(*field[i], s->meter, field_size(s), "a field of the relaxation");
    PH_TRY(ph_i_operator_in_space(s->op, err));
    PH_TRY(densities(s, system->params, err));
    *state = self;
    self = NULL;
out:
    ph_i_relaxation_free(&self);
    return st;
}

/* sum k_i w_i and sum w_i. k_i w_i = -(F_i - F_i before) v_i: no division by small v. */
static double damping(const relaxation *s)
{
    double stiff = 0.0, weight = 0.0;
    for (size_t i = 0; i < field_size(s); i++) {
        if (s->inverse[i] == 0.0) continue;
        stiff -= (s->f[i] - s->before[i]) * s->v[i];
        weight += s->v[i] * s->v[i] / s->inverse[i];
    }
    if (!(stiff > 0.0) || !(weight > 0.0)) return 0.0;
    return fmin(most_damping, 2.0 * sqrt(stiff / weight));
}

static void step(relaxation *s, double c, bool first)
{
    ptrdiff_t n = (ptrdiff_t)field_size(s);
    double keep = first ? 0.0 : (2.0 - c) / (2.0 + c),
           push = first ? 0.5 : 2.0 / (2.0 + c);
#pragma omp parallel for simd num_threads(s->op->threads) schedule(static, PH_CHUNK)
    for (ptrdiff_t i = 0; i < n; i++) {
        s->v[i] = keep * s->v[i] + push * s->inverse[i] * s->f[i];
        s->u[i] += s->v[i];
        s->before[i] = s->f[i];
    }
}

/* f = b - A u where something moves, zero elsewhere. Returns |f|. */
static double force(relaxation *s)
{
    ptrdiff_t n = (ptrdiff_t)field_size(s);
    ph_i_operator_apply(s->op, s->u, s->f);
#pragma omp parallel for simd num_threads(s->op->threads) schedule(static, PH_CHUNK)
    for (ptrdiff_t i = 0; i < n; i++)
        s->f[i] = s->inverse[i] > 0.0 ? s->b[i] - s->f[i] : 0.0;
    return sqrt(ph_i_dot(&s->space, s->f, s->f));
}

static ph_status relax(relaxation *s, double b2, ph_cg_report *report, ph_error *err)
{
    long most = (long)PATIENCE * report->max_iterations;
    double c = 0.0;
    while (report->residual > report->tolerance) {
        if (report->iterations >= most)
            return ph_i_give_up(PH_ENOCONV, report, "not converged", err);
        step(s, c, report->iterations == 0);
        report->residual = force(s) / b2;
        report->iterations++;
        if (!isfinite(report->residual))
            return ph_i_give_up(PH_ESINGULAR, report, "the relaxation overflowed", err);
        if (ph_i_told_to_stop(report))
            return ph_i_give_up(PH_ECANCELLED, report, "interrupted", err);
        c = damping(s);
    }
    return PH_OK;
}

ph_status ph_i_relaxation_solve(void *state, const double *load, double *u,
                                ph_cg_report *report, ph_error *err)
{
    relaxation *s = state;
    size_t bytes = field_size(s) * sizeof(double);
    memcpy(s->b, load, bytes);
    memset(s->u, 0, bytes);
    memset(s->v, 0, bytes);
    double b2 = force(s);
    report->iterations = 0;
    report->residual = b2 > 0.0 ? 1.0 : 0.0;
    ph_status st = relax(s, b2, report, err);
    memcpy(u, s->u, bytes);
    return st;
}
