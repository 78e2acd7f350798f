/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Route `carson`: the elastic problem of every s, each on its own. Shares nothing with
 * `reduced` but the elastic solver. */
#include "effective/visco.h"

#include <math.h>
#include <string.h>

/* The microstructure with the phases of one s; borrows everything but the materials. */
static ph_status phases_at(const ph_microstructure *micro, double s, ph_material *phase,
                           ph_microstructure *out, ph_error *err)
{
    ph_status st = PH_OK;
    for (int p = 0; p < micro->nmaterials; p++)
        PH_TRY(ph_material_at(&micro->materials[p], s, &phase[p], err));
    *out = *micro;
    out->materials = phase;
out:
    return st;
}

/* The discretisation that `reduced` takes: `auto` decided for all s, and the coefficient of
 * (S) that follows one phase, where the elastic problem takes that of its softest. */
static void same_discretisation(const ph_visco *v, const ph_microstructure *at, double s,
                                ph_problem *p)
{
    const ph_result *res = v->run.result;
    if (v->run.constraint->analytic || res->bond.present) return;
    if (strcmp(res->model, "nosb") != 0) return;
    p->model.points = res->points;
    p->model.stabilisation = res->stabilisation;
    p->model.stabilisation_value = res->stabilisation_value;
    if (res->stabilisation != PH_STABILISE_SPECTRAL) return;
    double softest = INFINITY;
    ph_sym4 c;
    for (int m = 0; m < at->nmaterials; m++) {
        bool used = v->run.map->used[m] && !at->materials[m].is_void;
        if (!used || ph_sym4_reduce(&at->materials[m].stiffness, at->grid.kinematics, &c,
                                    NULL) != PH_OK)
            continue;
        softest = fmin(softest, ph_i_visco_softness(&c));
    }
    const ph_material *soft = &v->run.problem->micro->materials[v->soft];
    if (ph_sym4_reduce(&soft->stiffness, at->grid.kinematics, &c, NULL) == PH_OK)
        p->model.stabilisation_value *=
            ph_i_visco_softness(&c) * ph_i_visco_factor(v, s) / softest;
}

/* The elastic problem of s becomes that of the answer. */
static ph_status solve_at(const ph_visco *v, const ph_problem *problem, double s,
                          ph_material *phase, const ph_ctx *ctx, ph_viscoelastic *out,
                          int *iterations, ph_error *err)
{
    ph_status st = PH_OK;
    ph_microstructure at;
    ph_problem elastic = *problem;
    ph_result *result = NULL;
    *iterations = 0;
    elastic.micro = &at;
    PH_TRY(phases_at(problem->micro, s, phase, &at, err));
    same_discretisation(v, &at, s, &elastic);
    st = ph_homogenise(&elastic, ctx, &result, err);
    for (int a = 0; result && a < result->nloads; a++)
        *iterations += result->iterations[a];
    if (st != PH_OK) ph_error_prefix(err, "Carson variable %g: ", s);
    out->iterations += *iterations;
    if (result) out->applications += result->work.applications;
    if (result && out->elastic) ph_i_work_add(&result->work, &out->elastic->work);
    ph_result_free(&out->elastic);
    out->elastic = result;
out:
    return st;
}

ph_status ph_i_relaxation_carson(const ph_problem *problem,
                                 const ph_relaxation_params *params, const ph_ctx *ctx,
                                 ph_viscoelastic *out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_material *phase = NULL;
    double start = ph_i_run_now();
    int iterations;
    ph_visco v = {0};
    PH_CHECK(params->ncarson > 0, PH_EINVAL, "route carson needs Carson variables");
    PH_TRY(ph_i_visco_choose(&v, problem, ctx, err));
    PH_ALLOC(phase, problem->micro->nmaterials, "phases");
    PH_ALLOC(out->values, params->ncarson, "values of the Carson variable");
    PH_ALLOC(out->points, params->ncarson, "values of the Carson variable");
    for (int i = 0; i < params->ncarson; i++) {
        double s = params->carson[i];
        PH_TRY(solve_at(&v, problem, s, phase, ctx, out, &iterations, err));
        out->values[out->nvalues++] = (ph_carson_value){s, out->elastic->stiffness};
        out->points[out->npoints++] = (ph_carson_point){s, (double)NAN, iterations, 0};
    }
    /* what the elastic report is about */
    PH_TRY(solve_at(&v, problem, INFINITY, phase, ctx, out, &iterations, err));
    out->instantaneous = out->elastic->stiffness;
    out->seconds = ph_i_run_now() - start;
out:
    free(phase);
    ph_i_visco_clear(&v);
    return st;
}
