/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One realisation of a case: microstructure, loads, outputs. */
#include "campaign/campaign.h"

#include <math.h>
#include <string.h>
#include <time.h>

/* Above it ph_homogenise refines the entries if it has the fields of all loads. */
static const double refined_contrast = 1e3;

static double now(void)
{
    struct timespec t;
    timespec_get(&t, TIME_UTC);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static bool needs_all(const ph_case *c)
{
    double softest = INFINITY, stiffest = 0.0;
    const char *kind = c->constraint.kind;
    if (kind && strcmp(kind, "uniform_traction") == 0) return true;
    for (int i = 0; i < c->nmaterials; i++) {
        double low, high;
        if (c->materials[i].is_void) return true;
        ph_sym4_eigenvalues(&c->materials[i].stiffness, &low, &high);
        softest = fmin(softest, low);
        stiffest = fmax(stiffest, high);
    }
    return stiffest > refined_contrast * softest;
}

unsigned ph_scenario_loads(const ph_scenario *s)
{
    if (!s) return 0;
    unsigned loads = 0;
    for (int i = 0; i < s->noutputs; i++)
        loads |= ph_quantity_loads(&s->output[i], s->c->kinematics);
    if (loads && needs_all(s->c)) loads = (1u << ph_strains(s->c->kinematics)) - 1u;
    return loads;
}

ph_status ph_scenario_admits(const ph_case *c, const ph_quantity *q, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(c && q, PH_EINVAL, "NULL case or output");
    const char *no = ph_quantity_refuses(q, c->kinematics);
    bool there = strncmp(q->name, "fraction.", 9) != 0;
    PH_CHECK(!no, PH_EINVAL, "%s: %s", q->name, no);
    for (int m = 0; m < c->nmaterials && !there; m++)
        there = strcmp(c->materials[m].name, q->argument) == 0;
    PH_CHECK(there, PH_EINVAL, "%s: the case has no material '%s'", q->name, q->argument);
out:
    return st;
}

static ph_status check_outputs(const ph_scenario *s, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(s && s->c && s->output, PH_EINVAL, "NULL scenario, case or outputs");
    PH_CHECK(s->noutputs >= 1 && s->noutputs <= PH_MAX_OUTPUTS, PH_EINVAL,
             "%d outputs: 1 to %d are admissible", s->noutputs, PH_MAX_OUTPUTS);
    PH_CHECK(!ph_i_is_open(s->c), PH_EINVAL, "%s", ph_i_open_words);
    for (int i = 0; i < s->noutputs; i++)
        PH_TRY(ph_scenario_admits(s->c, &s->output[i], err));
out:
    return st;
}

static void account(const ph_result *r, ph_evaluation *e)
{
    e->work = r->work;
    e->seconds_solve = r->seconds_solve;
    e->nodes = ph_grid_cells(&r->grid);
}

/* Outputs at a time or a frequency need the series, the others the elastic tensor. */
static ph_status solve(const ph_scenario *s, const ph_problem *problem, const ph_ctx *ctx,
                       ph_result **out, ph_error *err)
{
    ph_status st = PH_OK;
    bool relaxes = false;
    ph_viscoelastic *v = NULL;
    for (int i = 0; i < s->noutputs; i++)
        relaxes |= isfinite(s->output[i].at);
    if (!relaxes || !ph_case_relaxes(s->c) || problem->loading) {
        ph_problem elastic = *problem;
        elastic.nconstants = s->noutputs;
        elastic.constants = s->output;
        return ph_homogenise(&elastic, ctx, out, err);
    }
    const ph_relaxation_params params = {.route = s->c->viscoelastic.route,
                                         .tolerance = s->c->viscoelastic.tolerance};
    PH_TRY(ph_viscoelastic_solve(problem, &params, ctx, &v, err));
    PH_CHECK(v->series, PH_EINVAL,
             "viscoelastic.route: %s gives no series, which an output at a time needs",
             v->route);
    *out = v->elastic;
    (*out)->relaxation = v->series;
    v->elastic = NULL;
    v->series = NULL;
out:
    ph_viscoelastic_free(&v);
    return st;
}

const char ph_i_open_words[] =
    "the case asks for an accuracy, for which one solution finds its grid: give "
    "microstructure.nodes";

bool ph_i_is_open(const ph_case *c)
{
    return c->accuracy.relative > 0 && !(c->accuracy.given & PH_SETTING_NODES);
}

ph_status ph_i_scenario_solve(const ph_scenario *s, const ph_ctx *ctx, ph_result **out,
                              ph_error *err)
{
    ph_status st = PH_OK;
    ph_microstructure *micro = NULL;
    ph_crack_plan *plan = NULL;
    PH_TRY(check_outputs(s, err));
    ph_case mine = *s->c; /* borrows the arrays of the case */
    mine.realisation = s->realisation;
    mine.failure.realisation = s->realisation;
    PH_TRY(ph_rve_build(&mine, &micro, err));
    PH_TRY(ph_rve_cracks(&mine, &plan, err));
    ph_problem problem = ph_rve_problem(&mine, micro, plan);
    problem.loads = ph_scenario_loads(s);
    problem.keep_fields = false;
    /* No load: the bounds need none, and the result has the fractions. */
    if (problem.loads == 0) problem.constraint = (ph_constraint_params){.kind = "voigt"};
    PH_TRY(solve(s, &problem, ctx, out, err));
out:
    ph_crack_plan_free(&plan);
    ph_microstructure_free(&micro);
    return st;
}

ph_status ph_scenario_evaluate(const ph_scenario *s, const ph_ctx *ctx,
                               ph_evaluation *out, ph_error *err)
{
    ph_status st = PH_OK;
    double start = now();
    ph_result *result = NULL;
    ph_evaluation e = {0};
    PH_CHECK(out, PH_EINVAL, "NULL evaluation");
    PH_TRY(ph_i_scenario_solve(s, ctx, &result, err));
    e.n = s->noutputs;
    for (int i = 0; i < e.n; i++)
        PH_TRY(ph_quantity_value(&s->output[i], result, &e.value[i], err));
    account(result, &e);
    e.seconds = now() - start;
    *out = e;
out:
    ph_result_free(&result);
    return st;
}
