/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a grid adds to a mean: extrapolation from the same realisations on two grids. */
#include "campaign/estimators.h"
#include "core/check.h"

#include <math.h>

bool ph_i_is_pair(const ph_grid_pair *g, int nmodels)
{
    return g->fine >= 0 && g->fine < g->coarse && g->coarse < nmodels && g->ratio > 1 &&
           isfinite(g->ratio);
}

static ph_status check(const ph_grid_pair *grid, double confidence, int nmodels,
                       const ph_model_samples *models, ptrdiff_t seen, ptrdiff_t n,
                       ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(ph_i_is_pair(grid, nmodels), PH_EINVAL,
             "discretisation takes two of %d models, the finer first, and a ratio > 1",
             nmodels);
    PH_CHECK(confidence > 0 && confidence < 1, PH_EINVAL,
             "the confidence must be in (0, 1), got %g", confidence);
    for (int i = 0; i < 2; i++) {
        const ph_model_samples *m = &models[i ? grid->coarse : grid->fine];
        PH_CHECK(m->dimension == 1 && seen >= 0 && seen <= n && n <= m->n, PH_EINVAL,
                 "model %d: %d numbers a realisation, %td realisations; 1 number, "
                 "%td <= %td realisations are needed",
                 i ? grid->coarse : grid->fine, m->dimension, m->n, seen, n);
    }
out:
    return st;
}

ph_status ph_estimation_bias(const ph_grid_pair *grid, double confidence, int nmodels,
                             const ph_model_samples *models, ptrdiff_t seen, ptrdiff_t n,
                             ph_discretisation *out, ph_error *err)
{
    ph_status st = PH_OK;
    double all = 0, mean = 0, scattered = 0, centre = 0, m2 = 0;
    PH_GIVEN(grid && models && out);
    PH_TRY(check(grid, confidence, nmodels, models, seen, n, err));
    for (ptrdiff_t k = 0; k < n; k++) {
        double d = models[grid->coarse].value[k] - models[grid->fine].value[k];
        if (!isfinite(d)) continue;
        all++;
        mean += (d - mean) / all;
        if (k >= seen) continue;
        double before = d - centre;
        scattered++;
        centre += before / scattered;
        m2 += before * (d - centre);
    }
    PH_CHECK(scattered >= 2, PH_ESINGULAR,
             "only %g of %td realisations did not fail on both grids", scattered, seen);
    out->n = (ptrdiff_t)all;
    out->dof = scattered - 1;
    out->estimate = mean / (grid->ratio - 1);
    out->standard_error = sqrt(m2 / out->dof / all) / (grid->ratio - 1);
    out->half_width = ph_i_student(confidence, out->dof) * out->standard_error;
out:
    return st;
}
