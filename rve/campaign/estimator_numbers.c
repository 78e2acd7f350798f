/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How many realisations of every level reach a variance at least cost. */
#include "campaign/estimators.h"
#include "core/check.h"

#include <math.h>

/* Levels at their bounds stay there, the others share what variance is left. */
static void share(int n, const double *V, const double *c, const double *bound, double v,
                  double *out)
{
    bool bounded[PH_MAX_MODELS] = {false}, again = true;
    while (again) {
        double sum = 0, left = v;
        again = false;
        for (int l = 0; l < n; l++)
            if (bounded[l])
                left -= V[l] / bound[l];
            else
                sum += sqrt(V[l] * c[l]);
        for (int l = 0; l < n; l++) {
            if (!bounded[l]) out[l] = sqrt(V[l] / c[l]) * sum / left;
            if (!bounded[l] && out[l] <= bound[l]) bounded[l] = again = true;
            if (bounded[l]) out[l] = bound[l];
        }
    }
}

void ph_i_allocate(int n, const double *V, const double *c, const double *least, double v,
                   double *out)
{
    double bound[PH_MAX_MODELS];
    for (int l = 0; l < n; l++)
        bound[l] = fmax(least[l], l ? bound[l - 1] : 0);
    for (int round = 0; round <= n; round++) { /* each lifts one more level at least */
        bool descends = false;
        share(n, V, c, bound, v, out);
        for (int l = 1; l < n; l++)
            if (out[l] < out[l - 1]) {
                bound[l] = out[l - 1];
                descends = true;
            }
        if (!descends) return;
    }
    for (int l = 1; l < n; l++)
        out[l] = fmax(out[l], out[l - 1]);
}

ph_status ph_estimation_allocate(int n, const double *variance, const double *cost,
                                 const double *least, double v, double *out,
                                 ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(n >= 1 && n <= PH_MAX_MODELS && variance && cost && least && out, PH_EINVAL,
             "an estimate has 1 to %d levels, got %d", PH_MAX_MODELS, n);
    PH_CHECK(v > 0 && isfinite(v), PH_EINVAL, "the variance must be > 0, got %g", v);
    for (int l = 0; l < n; l++)
        PH_CHECK(variance[l] >= 0 && isfinite(variance[l]) && cost[l] > 0 &&
                     isfinite(cost[l]) && least[l] >= 1 && isfinite(least[l]),
                 PH_EINVAL,
                 "level %d: variance %g, cost %g, at least %g: must be >= 0, > 0, >= 1",
                 l, variance[l], cost[l], least[l]);
    ph_i_allocate(n, variance, cost, least, v, out);
out:
    return st;
}
