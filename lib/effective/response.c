/* SPDX-License-Identifier: GPL-3.0-or-later */
/* With h_m = x - v_m, v_m following x with the delay tau_m (tau v' = x - v):
 *
 *     sigma = C_inf eps + sum C_m h_m,    eps = J_0 sigma + sum J_m (sigma - h_m) + Phi int sigma
 *
 * and over a piece of length dt in which x grows by dx linearly, with y = dt / tau_m,
 *
 *     h_m <- exp(-y) h_m + (1 - exp(-y))/y dx,      a jump: h_m <- h_m + dx. */
#include <perihom/history.h>

#include "core/check.h"

#include <math.h>
#include <string.h>

typedef struct walker {
    const ph_history *history;
    const ph_prony_term *term;
    int nterms, n;
    ph_sym4 direct; /* C_inf; J_0 + sum J_m */
    double sign;    /* of the sum over terms: 1; -1 */
    const ph_sym4 *flow;
    double *h; /* [nterms][6], Mandel like the rest */
    double now, x[6], integral[6];
    double scale_in[6], scale_out[6]; /* Voigt to Mandel; back */
    int next;                         /* point of the history */
} walker;

static void jump(walker *w, const double *x)
{
    for (int i = 0; i < w->n; i++) {
        for (int m = 0; m < w->nterms; m++)
            w->h[6 * m + i] += x[i] - w->x[i];
        w->x[i] = x[i];
    }
}

static void advance(walker *w, double time, const double *x)
{
    double dt = time - w->now;
    for (int m = 0; m < w->nterms; m++) {
        double y = dt / w->term[m].time;
        double fade = exp(-y), gain = y > 0 ? -expm1(-y) / y : 1;
        for (int i = 0; i < w->n; i++)
            w->h[6 * m + i] = fade * w->h[6 * m + i] + gain * (x[i] - w->x[i]);
    }
    for (int i = 0; i < w->n; i++) {
        w->integral[i] += dt * (w->x[i] + (x[i] - w->x[i]) / 2);
        w->x[i] = x[i];
    }
    w->now = time;
}

static void point(const walker *w, int p, double x[6])
{
    for (int i = 0; i < w->n; i++)
        x[i] = w->history->value[p][i] * w->scale_in[i];
}

/* To `time`, over the points before it. */
static void walk(walker *w, double time)
{
    const ph_history *k = w->history;
    double x[6];
    for (; w->next < k->npoints && k->time[w->next] <= time; w->next++) {
        point(w, w->next, x);
        if (w->next == 0) w->now = k->time[0];
        if (k->time[w->next] > w->now)
            advance(w, k->time[w->next], x);
        else
            jump(w, x);
    }
    if (w->next == 0 || time <= w->now) return;
    memcpy(x, w->x, sizeof x);
    if (w->next < k->npoints) {
        double end[6], share = (time - w->now) / (k->time[w->next] - w->now);
        point(w, w->next, end);
        for (int i = 0; i < w->n; i++)
            x[i] += share * (end[i] - x[i]);
    }
    advance(w, time, x);
}

static void add(const walker *w, double factor, const ph_sym4 *c, const double *x,
                double *y)
{
    for (int i = 0; i < w->n; i++)
        for (int j = 0; j < w->n; j++)
            y[i] += factor * c->m[i][j] * x[j];
}

static void respond(const walker *w, double *out)
{
    double y[6] = {0};
    add(w, 1, &w->direct, w->x, y);
    for (int m = 0; m < w->nterms; m++)
        add(w, w->sign, &w->term[m].stiffness, &w->h[6 * m], y);
    if (w->flow) add(w, 1, w->flow, w->integral, y);
    memset(out, 0, 6 * sizeof *out);
    for (int i = 0; i < w->n; i++)
        out[i] = y[i] * w->scale_out[i];
}

static void relaxes(walker *w, const ph_prony *p)
{
    w->term = p->term;
    w->nterms = p->nterms;
    w->direct = p->equilibrium;
    w->sign = 1;
}

static void creeps(walker *w, const ph_creep *c)
{
    w->term = c->term;
    w->nterms = c->nterms;
    w->direct = c->instantaneous;
    for (int m = 0; m < c->nterms; m++)
        w->direct = ph_sym4_combine(1, &w->direct, 1, &c->term[m].stiffness);
    w->sign = -1;
    w->flow = &c->fluidity;
}

ph_status ph_prony_response(const ph_prony *p, const ph_history *history, int ntimes,
                            const double *times, double (*response)[6], ph_error *err)
{
    PH_GIVEN(p && history && response && (times || ntimes == 0));
    ph_status st = PH_OK;
    ph_creep *creep = NULL;
    walker w = {.history = history, .n = p->equilibrium.n};
    PH_CHECK(history->n == w.n, PH_EINVAL, "a history of %d components, a series of %d",
             history->n, w.n);
    PH_TRY(ph_history_validate(history, err));
    for (int k = 0; k < ntimes; k++)
        PH_CHECK(isfinite(times[k]) && (k == 0 || times[k] >= times[k - 1]), PH_EINVAL,
                 "the times of a response must be numbers and not decrease, got %g",
                 times[k]);
    if (history->stress) {
        PH_TRY(ph_prony_creep(p, &creep, err));
        creeps(&w, creep);
    } else {
        relaxes(&w, p);
    }
    /* shear: engineering strain times 1/sqrt 2, stress times sqrt 2 */
    for (int i = 0; i < w.n; i++) {
        bool shear = i >= (w.n == 3 ? 2 : 3);
        w.scale_in[i] = !shear ? 1 : history->stress ? sqrt(2) : sqrt(0.5);
        w.scale_out[i] = w.scale_in[i];
    }
    PH_ALLOC(w.h, 6 * (size_t)w.nterms, "the state of the terms");
    for (int k = 0; k < ntimes; k++) {
        walk(&w, times[k]);
        respond(&w, response[k]);
    }
out:
    free(w.h);
    ph_creep_free(&creep);
    return st;
}
