/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/nnls.h"
#include "effective/fit_internal.h"

#include <math.h>

int ph_i_prony_fit_extras(const ph_i_prony_fit_model *m)
{
    return m->constant + m->rate;
}

double ph_i_prony_fit_basis(const ph_i_prony_fit_rows *r, ptrdiff_t i, double time,
                            double *slope)
{
    double value = 0, derivative = 0;
    if (r->kind == PH_PRONY_DYNAMIC) {
        double z = r->x[i] * time, d = 1 + z * z, q = 1 / (1 + 1 / (z * z));
        if (z > 1e100) d = INFINITY; /* z^2 would be */
        value = r->is_loss[i] ? z / d : q;
        derivative = r->is_loss[i] ? z / d * (1 - 2 * q) : 2 * q / d;
    } else {
        double z = r->x[i] / time, e = exp(-z);
        value = r->kind == PH_PRONY_CREEP ? -expm1(-z) : e;
        derivative = r->kind == PH_PRONY_CREEP ? -z * e : z * e;
        if (e == 0) derivative = 0;
    }
    if (slope) *slope = derivative;
    return value;
}

void ph_i_prony_fit_extra_column(const ph_i_prony_fit_rows *r, bool rate, double *column)
{
    for (ptrdiff_t i = 0; i < r->m; i++)
        column[i] = r->is_loss[i] ? 0 : r->weight[i] * (rate ? r->x[i] : 1);
}

void ph_i_prony_fit_column(const ph_i_prony_fit_rows *r, double time, double *column,
                           double *slope)
{
    for (ptrdiff_t i = 0; i < r->m; i++) {
        double s;
        column[i] = r->weight[i] * ph_i_prony_fit_basis(r, i, time, &s);
        if (slope) slope[i] = r->weight[i] * s;
    }
}

ph_status ph_i_prony_fit_solve(const ph_i_prony_fit_rows *r, bool constant, bool rate,
                               int ntimes, const double *times, double *c, double *rss,
                               ph_error *err)
{
    ph_status st = PH_OK;
    double *a = NULL;
    int n = 0;
    PH_ALLOC(a, (ptrdiff_t)(ntimes + 3) * r->m, "the fit of a series");
    if (constant) ph_i_prony_fit_extra_column(r, false, a + n++ * r->m);
    if (rate) ph_i_prony_fit_extra_column(r, true, a + n++ * r->m);
    for (int k = 0; k < ntimes; k++)
        ph_i_prony_fit_column(r, times[k], a + n++ * r->m, NULL);
    for (ptrdiff_t i = 0; i < r->m; i++)
        a[n * r->m + i] = r->weight[i] * r->y[i];
    PH_TRY(ph_i_nnls(r->m, n, a, c, rss, err));
out:
    free(a);
    return st;
}

double ph_i_prony_fit_criterion(const ph_i_prony_fit_rows *r, int nextra_used, int terms,
                                double rss)
{
    const double m = (double)r->m, p = 2.0 * terms + nextra_used;
    if (r->known_sd) return rss + p * log(m);
    /* below 1e-13 a relative misfit is rounding: no reason for more terms */
    return m * log(fmax(rss / m, 1e-26)) + p * log(m);
}
