/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Leave-one-out: what a fit to the other measurements says of this one. */
#include "calibrate/calibrate.h"

#include <math.h>
#include <string.h>

/* The surrogate without measurement `out`. */
typedef struct without {
    ph_i_surrogate *s;
    int out;
    double *all; /* [n] */
} without;

static ph_status eval_without(void *user, int m, const double *u, double *f,
                              ph_error *err)
{
    ph_status st = PH_OK;
    without *w = user;
    int n = w->s->n;
    for (int i = 0; i < m; i++) {
        PH_TRY(ph_i_surrogate_residuals(w->s, 1, u + (size_t)i * K, w->all, err));
        double *to = f + (size_t)i * (n - 1);
        memcpy(to, w->all, (size_t)w->out * sizeof *f);
        memcpy(to + w->out, w->all + w->out + 1, (size_t)(n - 1 - w->out) * sizeof *f);
    }
out:
    return st;
}

/* Residual of measurement i in the fit without it. */
static ph_status predict(const ph_i_fit *c, without *w, double *residual, bool *at_edge,
                         ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_surrogate *s = w->s;
    ph_i_residuals r = {s->k, s->n - 1, eval_without, w};
    ph_i_search how = {
        .step = 1e-5, .tolerance = 1e-4, .scale = c->spread.scale, .iterations = 100};
    double u[K], chi2;
    bool converged;
    memcpy(u, c->best, sizeof u);
    memcpy(how.lo, s->lo, sizeof how.lo);
    memcpy(how.hi, s->hi, sizeof how.hi);
    for (int j = 0; j < s->k; j++)
        if (c->spread.unknown[j] == PH_FIT_FLAT) how.lo[j] = how.hi[j] = u[j];
    PH_TRY(ph_i_minimise(&r, &how, u, &chi2, &converged, err));
    for (int j = 0; j < s->k; j++)
        if ((u[j] <= s->lo[j] && s->lo[j] > 0) || (u[j] >= s->hi[j] && s->hi[j] < 1))
            *at_edge = true;
    PH_TRY(ph_i_surrogate_residuals(s, 1, u, w->all, err));
    *residual = w->all[w->out];
out:
    return st;
}

static double leverage(const ph_i_fit *c, int i)
{
    double h = 0;
    int k = c->problem->nunknowns;
    for (int a = 0; a < k; a++)
        for (int b = 0; b < k; b++)
            h += c->J[i * K + a] * c->spread.inverse[a][b] * c->J[i * K + b];
    return fmin(h, 1);
}

ph_status ph_i_left_out(ph_i_fit *c, ph_error *err)
{
    ph_status st = PH_OK;
    int n = c->problem->nmeasurements, edges = 0;
    without w = {.s = c->surrogate};
    double sum = 0;
    PH_ALLOC(w.all, n, "a fit");
    for (int i = 0; i < n; i++) {
        ph_fit_point *p = &c->out->point[i];
        double residual = NAN;
        bool at_edge = false;
        p->leverage = leverage(c, i);
        w.out = i;
        /* Linear where there is no surrogate; exact for a linear model. */
        if (n > c->spread.known && p->leverage < 1 - 1e-9)
            residual = c->f[i] / (1 - p->leverage);
        double linear = residual;
        if (!isnan(residual) && c->surrogate)
            PH_TRY(predict(c, &w, &residual, &at_edge, err));
        if (at_edge) residual = linear;
        edges += at_edge;
        p->left_out = p->measured + residual * c->sigma[i];
        double in_sigma = residual * c->sigma[i] / p->sigma;
        sum += in_sigma * in_sigma;
    }
    c->out->left_out_rms = sqrt(sum / n);
    if (edges)
        ph_i_fit_note(c->out,
                      "leave-one-out: %d of %d fits leave the box of the surrogate; "
                      "their predictions are linear",
                      edges, n);
out:
    free(w.all);
    return st;
}
