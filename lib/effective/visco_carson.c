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

ph_status ph_i_relaxation_carson(const ph_problem *problem,
                                 const ph_relaxation_params *params, const ph_ctx *ctx,
                                 ph_viscoelastic *out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_material *phase = NULL;
    ph_microstructure at;
    double start = ph_i_run_now();
    PH_CHECK(problem && problem->micro, PH_EINVAL, "no microstructure");
    PH_CHECK(params->ncarson > 0, PH_EINVAL, "route carson needs Carson variables");
    PH_ALLOC(phase, problem->micro->nmaterials, "phases");
    PH_ALLOC(out->values, params->ncarson, "values of the Carson variable");
    PH_ALLOC(out->points, params->ncarson, "values of the Carson variable");
    for (int i = 0; i < params->ncarson; i++) {
        ph_problem elastic = *problem;
        ph_result *result = NULL;
        double s = params->carson[i];
        int iterations = 0;
        elastic.micro = &at;
        PH_TRY(phases_at(problem->micro, s, phase, &at, err));
        st = ph_homogenise(&elastic, ctx, &result, err);
        for (int a = 0; result && a < result->nloads; a++)
            iterations += result->iterations[a];
        if (st == PH_OK) {
            out->values[out->nvalues++] = (ph_carson_value){s, result->stiffness};
            out->points[out->npoints++] =
                (ph_carson_point){s, (double)NAN, iterations, 0};
            out->iterations += iterations;
            out->applications += result->applications;
        } else
            ph_error_prefix(err, "Carson variable %g: ", s);
        ph_result_free(&out->elastic);
        out->elastic = result;
        if (st != PH_OK) goto out;
    }
    out->seconds = ph_i_run_now() - start;
out:
    free(phase);
    return st;
}
