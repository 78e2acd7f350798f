/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Route `reduced`: a few values of s, each solved from the reduced solution, until no gap
 * between them holds an error above the tolerance; then the exact poles of the model. */
#include "effective/visco.h"

#include <math.h>
#include <string.h>

enum { MAX_POINTS = 40, MORE = 4 };
/* Of the tolerance: energy that the first values (both ends) and the others may leave. */
static const double end_share = 1e-3, inner_share = 0.25;
/* A gap is seen if a visit was where its product is this share of its most. One of less than
 * the second share of the largest need not be: it is believed to hold so many times the
 * error that the others suggest. */
static const double seen = 0.5, small = 0.1, doubt = 8.0;
/* An error of less than this share of the tolerance asks for no more fields; the values of s
 * around it may hold so many times as much. */
static const double enough = 0.25, around = 4.0;
/* Contrast that does not move: one elastic solution is all there is. */
static const double still = 1e-12;

typedef struct walk {
    ph_path path;
    int zeros, visits;
    double *zero;  /* t where the basis is exact */
    double *visit; /* t where it was found to be good enough */
    double kappa;  /* largest error over product of all visits */
    bool settled;  /* the last visit found nothing to do */
} walk;

static double product(const walk *w, double t)
{
    double p = 1.0;
    for (int k = 0; k < w->zeros; k++) {
        double x = tanh(0.5 * (t - w->zero[k]));
        p *= x * x;
    }
    return p;
}

/* Zeros at or before t: the number of its gap. */
static int gap_of(const walk *w, double t)
{
    int n = 0;
    for (int k = 0; k < w->zeros; k++)
        n += w->zero[k] <= t;
    return n;
}

static bool was_seen(const walk *w, double t, double most)
{
    for (int k = 0; k < w->visits; k++)
        if (gap_of(w, w->visit[k]) == gap_of(w, t) &&
            product(w, w->visit[k]) >= seen * most)
            return true;
    return false;
}

/* The value of largest product in the gaps that were not seen, that product, and the largest
 * of all gaps. */
static int next_value(const walk *w, double *largest, double *of_all)
{
    int at = -1;
    *largest = *of_all = 0.0;
    for (int g = 0; g <= w->zeros; g++) {
        double most = 0.0;
        int i_most = -1;
        for (int i = 0; i < w->path.n; i++)
            if (gap_of(w, w->path.t[i]) == g && product(w, w->path.t[i]) > most)
                most = product(w, w->path.t[i]), i_most = i;
        *of_all = fmax(*of_all, most);
        if (i_most >= 0 && most > *largest && !was_seen(w, w->path.t[i_most], most))
            *largest = most, at = i_most;
    }
    return at;
}

static ph_status note_point(ph_viscoelastic *out, double s, double error, long iterations,
                            int added, ph_error *err)
{
    ph_status st = PH_OK;
    void *p = realloc(out->points, sizeof *out->points * (size_t)(out->npoints + 1));
    PH_CHECK(p, PH_ENOMEM, "no memory for %d points", out->npoints + 1);
    out->points = p;
    out->points[out->npoints++] = (ph_carson_point){s, error, (int)iterations, added};
out:
    return st;
}

/* Visit value i of the path. What is found there bounds the error from then on: fields only
 * lower it. */
static ph_status go(ph_visco *v, walk *w, int i, bool end, double share, ph_error *err)
{
    ph_status st = PH_OK;
    double error, left, s = w->path.s[i];
    long before = v->out->iterations;
    int added;
    PH_TRY(ph_i_visco_visit(v, s, share, end ? 0.0 : enough * v->tolerance, &error, &left,
                            &added, err));
    PH_TRY(note_point(v->out, s, error, v->out->iterations - before, added, err));
    double p = product(w, w->path.t[i]);
    if (!end && p > 0.0) w->kappa = fmax(w->kappa, error / p);
    w->settled = !end && error <= v->tolerance;
    if (!w->settled) {
        w->zero[w->zeros++] = w->path.t[i];
        error = left;
    } else
        w->visit[w->visits++] = w->path.t[i];
    if (added == 0 && !end) error = fmax(error, fmin(around * error, v->tolerance));
    if (error >= v->out->error) v->out->error = error, v->out->error_at = s;
out:
    return st;
}

static ph_status walk_on(ph_visco *v, int most, ph_error *err)
{
    ph_status st = PH_OK;
    walk w = {0};
    PH_TRY(ph_i_path_new(v, v->tolerance, &w.path, err));
    PH_ALLOC(w.zero, most + MORE, "values of s");
    PH_ALLOC(w.visit, most + MORE, "values of s");
    int ns = v->run.map->ns, last = w.path.n - 1;
    double largest, of_all;
    PH_TRY(go(v, &w, 0, true, end_share, err));
    if (w.path.t[last] > still) PH_TRY(go(v, &w, last, true, end_share, err));
    while (w.path.t[last] > still) {
        int next = next_value(&w, &largest, &of_all);
        if (next < 0) break;
        if (w.settled && largest < small * of_all &&
            doubt * w.kappa * largest <= v->tolerance) {
            v->out->error = fmax(v->out->error, doubt * w.kappa * largest);
            break;
        }
        PH_CHECK(v->out->npoints < most, PH_ENOCONV,
                 "after %d values of s the error may still be %.2g (tolerance %.2g)",
                 v->out->npoints, fmax(v->out->error, doubt * w.kappa * largest),
                 v->tolerance);
        PH_TRY(go(v, &w, next, false, inner_share / (ns * ns), err));
    }
out:
    ph_i_path_clear(&w.path);
    free(w.zero);
    free(w.visit);
    return st;
}

ph_status ph_i_relaxation_reduced(const ph_problem *problem,
                                  const ph_relaxation_params *params, const ph_ctx *ctx,
                                  ph_viscoelastic *out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_visco v;
    double start = ph_i_run_now();
    int most = params->max_points > 0 ? params->max_points : MAX_POINTS;
    PH_TRY(ph_i_visco_begin(&v, problem, params, ctx, out, err));
    if (v.run.op) PH_TRY(walk_on(&v, most, err));
    PH_TRY(ph_i_visco_answer(out, &v.model, params, v.fluid, v.tolerance, err));
out:
    ph_i_visco_end(&v, start);
    ph_i_visco_clear(&v);
    return st;
}
