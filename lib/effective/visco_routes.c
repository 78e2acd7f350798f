/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The routes `stepping` and `frequency` as entries of the catalogue. */
#include "effective/frequency.h"
#include "effective/stepping.h"
#include "effective/visco.h"

#include <math.h>
#include <string.h>

/* The residual of a solve may be this share of the tolerance of the answer. */
static const double share_of_solver = 1e-2, default_tolerance = 1e-4;

/* What both begin and end with. */
typedef struct call {
    ph_run run;
    ph_viscoelastic *out;
    double start, tolerance;
} call;

static double tolerance_of_solver(const call *c)
{
    double own = c->run.problem->solver.tolerance;
    return fmin(own > 0.0 ? own : 1e-6, share_of_solver * c->tolerance);
}

static ph_status begin(call *c, const ph_problem *problem,
                       const ph_relaxation_params *params, const ph_ctx *ctx,
                       ph_viscoelastic *out, ph_error *err)
{
    ph_status st = PH_OK;
    *c = (call){.run = {.problem = problem, .ctx = ctx}, .out = out};
    c->start = ph_i_run_now();
    out->error = out->error_at = (double)NAN;
    c->tolerance = params->tolerance > 0.0 ? params->tolerance : default_tolerance;
    PH_TRY(ph_i_run_relaxing(&c->run, err));
    PH_TRY(ph_i_run_loads(&c->run, err)); /* at once: what the elastic report is about */
    PH_TRY(ph_i_run_stiffness(&c->run, err));
    out->instantaneous = c->run.result->stiffness;
    for (int a = 0; a < c->run.result->nloads; a++)
        out->iterations += c->run.result->iterations[a];
out:
    return st;
}

static void end(call *c)
{
    if (c->run.result) {
        ph_i_run_account(&c->run, c->start, ph_i_run_now() - c->start);
        c->out->applications = c->run.result->work.applications;
        c->out->seconds = c->run.result->seconds;
        c->out->elastic = c->run.result;
        c->out->elastic->converged = true; /* a failure hands nothing out */
        c->run.result = NULL;
    }
    ph_i_run_clear(&c->run);
}

/* ---- stepping ---------------------------------------------------------------------------- */

/* Voigt component i of strains or stresses as a Mandel one: multiply by. */
static double to_mandel(int ns, int i, bool stress)
{
    bool shear = i >= (ns == 6 ? 3 : 2);
    return !shear ? 1.0 : stress ? sqrt(2.0) : sqrt(0.5);
}

static void count(call *c, const ph_stepping_report *report)
{
    c->out->steps += report->steps;
    c->out->iterations += report->iterations;
}

/* Column `a` of C*(t) from a jump of macro strain a at t = 0. */
static ph_status step_column(call *c, ph_stepper *s, int a,
                             const ph_relaxation_params *params, ph_step_state *state,
                             ph_error *err)
{
    ph_status st = PH_OK;
    ph_stepping_report report;
    double zero = 0.0, unit[6] = {0};
    unit[a] = 1.0;
    const ph_load_history jump = {1, &zero, unit, 0};
    PH_TRY(ph_i_stepping(s, &jump, params->ntimes, params->times,
                         &(ph_stepping_params){.tolerance = c->tolerance}, state, &report,
                         err));
    for (int i = 0; i < s->ns; i++)
        for (int k = 0; k < params->ntimes; k++)
            c->out->curve[k].stiffness.m[i][a] = state[k].stress[i];
    count(c, &report);
out:
    return st;
}

static void symmetrise(ph_sym4 *c, int n)
{
    c->n = n;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < i; j++)
            c->m[i][j] = c->m[j][i] = 0.5 * (c->m[i][j] + c->m[j][i]);
}

/* The response to a history, Voigt, zero before it begins. */
static ph_status step_history(call *c, ph_stepper *s, const ph_relaxation_params *params,
                              ph_step_state *state, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_history *h = params->history;
    const int ns = s->ns;
    int early = 0;
    double *value = NULL;
    ph_stepping_report report;
    PH_CHECK(h->n == ns, PH_EINVAL, "the history has %d components, the case %d", h->n,
             ns);
    PH_ALLOC(value, h->npoints * ns, "the history");
    for (int k = 0; k < h->npoints; k++)
        for (int i = 0; i < ns; i++)
            value[k * ns + i] = h->value[k][i] * to_mandel(ns, i, h->stress);
    const ph_load_history load = {h->npoints, h->time, value,
                                  h->stress ? (1u << ns) - 1u : 0u};
    while (early < params->ntimes && params->times[early] < h->time[0])
        early++;
    PH_TRY(ph_i_stepping(s, &load, params->ntimes - early, params->times + early,
                         &(ph_stepping_params){.tolerance = c->tolerance}, state, &report,
                         err));
    for (int k = early; k < params->ntimes; k++)
        for (int i = 0; i < ns; i++)
            c->out->response[k][i] =
                h->stress ? state[k - early].strain[i] / to_mandel(ns, i, false)
                          : state[k - early].stress[i] / to_mandel(ns, i, true);
    count(c, &report);
out:
    free(value);
    return st;
}

ph_status ph_i_relaxation_stepping(const ph_problem *problem,
                                   const ph_relaxation_params *params, const ph_ctx *ctx,
                                   ph_viscoelastic *out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_stepper *s = NULL;
    ph_step_state *state = NULL;
    call c;
    PH_TRY(begin(&c, problem, params, ctx, out, err));
    PH_CHECK(params->ntimes > 0, PH_EINVAL, "route stepping needs times");
    PH_TRY(ph_i_stepper_new(&c.run, tolerance_of_solver(&c), &s, err));
    PH_ALLOC(state, params->ntimes, "states");
    PH_ALLOC(out->curve, params->ntimes, "the curve");
    for (int a = 0; a < s->ns; a++)
        PH_TRY(step_column(&c, s, a, params, state, err));
    for (; out->ncurve < params->ntimes; out->ncurve++) {
        out->curve[out->ncurve].time = params->times[out->ncurve];
        symmetrise(&out->curve[out->ncurve].stiffness, s->ns);
    }
    if (!params->history) goto out;
    PH_ALLOC(out->response, params->ntimes, "the response");
    PH_TRY(step_history(&c, s, params, state, err));
out:
    ph_i_stepper_free(&s);
    end(&c);
    free(state);
    return st;
}

/* ---- frequency --------------------------------------------------------------------------- */

ph_status ph_i_relaxation_frequency(const ph_problem *problem,
                                    const ph_relaxation_params *params, const ph_ctx *ctx,
                                    ph_viscoelastic *out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_complex_modulus *modulus = NULL;
    call c;
    PH_TRY(begin(&c, problem, params, ctx, out, err));
    PH_CHECK(params->nomega > 0, PH_EINVAL, "route frequency needs frequencies");
    PH_ALLOC(modulus, params->nomega, "complex moduli");
    PH_ALLOC(out->dynamic, params->nomega, "complex moduli");
    PH_TRY(ph_i_frequency(&c.run, tolerance_of_solver(&c), params->nomega, params->omega,
                          modulus, err));
    for (int k = 0; k < params->nomega; k++) {
        out->dynamic[out->ndynamic++] =
            (ph_dynamic_value){modulus[k].omega, modulus[k].storage, modulus[k].loss};
        out->iterations += modulus[k].iterations;
    }
out:
    end(&c);
    free(modulus);
    return st;
}
