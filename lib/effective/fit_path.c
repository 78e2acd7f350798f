/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Times are sought one after the other: the best place for one more, then all of them move. */
#include "core/dense.h"
#include "core/nnls.h"
#include "effective/fit_internal.h"

#include <math.h>
#include <string.h>

enum { PER_DECADE = 16, MOST_STEPS = 80 };

/* Room for the matrices, and where one more time may stand. */
typedef struct work {
    double *a; /* [columns][m]: active columns, then slopes or candidates, residual */
    double *grid;
    int ngrid;
} work;

static double *column_of(const ph_i_prony_fit_rows *r, const work *w, int k)
{
    return w->a + k * r->m;
}

static ph_status solve(const ph_i_prony_fit_rows *r, ph_i_prony_fit_model *m,
                       ph_error *err)
{
    return ph_i_prony_fit_solve(r, m->constant, m->rate, m->n, m->time, m->c, &m->rss,
                                err);
}

/* The columns whose coefficient is not zero; with `slopes` then c dA/d(ln time) of those
 * with a time. @return their number; *nslopes; which[] the times that they belong to */
static int put_active(const ph_i_prony_fit_rows *r, const ph_i_prony_fit_model *m,
                      const work *w, int which[PH_PRONY_FIT_TERMS + 1], int *nslopes)
{
    const int extras = ph_i_prony_fit_extras(m);
    int n = 0, k = 0;
    for (int e = 0; e < extras; e++)
        if (m->c[e] > 0)
            ph_i_prony_fit_extra_column(r, m->rate && e == extras - 1,
                                        column_of(r, w, n++));
    for (int t = 0; t < m->n; t++)
        if (m->c[extras + t] > 0) which[k++] = t;
    for (int j = 0; j < k; j++) {
        double *slope = column_of(r, w, n + k + j), c = m->c[extras + which[j]];
        ph_i_prony_fit_column(r, m->time[which[j]], column_of(r, w, n + j), slope);
        for (ptrdiff_t i = 0; i < r->m; i++)
            slope[i] *= c;
    }
    *nslopes = k;
    return n + k;
}

/* y - A c, weighted */
static void put_residual(const ph_i_prony_fit_rows *r, const ph_i_prony_fit_model *m,
                         double *column)
{
    const int extras = ph_i_prony_fit_extras(m);
    for (ptrdiff_t i = 0; i < r->m; i++) {
        double sum = 0;
        for (int e = 0; e < extras && !r->is_loss[i]; e++)
            sum += m->c[e] * (m->rate && e == extras - 1 ? r->x[i] : 1);
        for (int t = 0; t < m->n; t++)
            if (m->c[extras + t] > 0)
                sum += m->c[extras + t] * ph_i_prony_fit_basis(r, i, m->time[t], NULL);
        column[i] = r->weight[i] * (r->y[i] - sum);
    }
}

/* Step of the times of size |D step| bounded by lambda: min |z - R step|^2 + lambda^2 |step|^2,
 * R the triangle of the slopes without what the coefficients can follow. */
static void damped_step(int k, ptrdiff_t stride, const double *triangle, const double *z,
                        double lambda, double *small, double *step)
{
    const int rows = 2 * k;
    memset(small, 0, (size_t)rows * (size_t)(k + 1) * sizeof *small);
    for (int j = 0; j < k; j++) {
        for (int i = 0; i <= j; i++)
            small[j * rows + i] = triangle[j * stride + i];
        small[j * rows + k + j] = lambda;
        small[k * rows + j] = z[j];
    }
    ph_i_qr_columns(rows, k, k + 1, small);
    ph_i_back_substitute(rows, k, small, small + k * rows, step);
}

/* Levenberg and Marquardt in ln(time), the coefficients eliminated. */
static ph_status refine(const ph_i_prony_fit_rows *r, const work *w,
                        ph_i_prony_fit_model *m, ph_error *err)
{
    ph_status st = PH_OK;
    int which[PH_PRONY_FIT_TERMS + 1], k = 0;
    double step[PH_PRONY_FIT_TERMS + 1], *small = NULL, lambda = -1;
    PH_ALLOC(small, 2 * (PH_PRONY_FIT_TERMS + 1) * (PH_PRONY_FIT_TERMS + 2),
             "the fit of a series");
    for (int count = 0; count < MOST_STEPS; count++) {
        int n = put_active(r, m, w, which, &k);
        if (k == 0 || n + k > r->m) break;
        put_residual(r, m, column_of(r, w, n + k));
        ph_i_qr_columns(r->m, n + k, n + k + 1, w->a);
        const double *triangle = column_of(r, w, n) + n;
        const double *z = column_of(r, w, n + k) + n;
        double size = 0, before = m->rss, longest = 0;
        for (int j = 0; j < k; j++)
            size = fmax(size, fabs(triangle[j * r->m + j]));
        if (lambda < 0) lambda = 1e-2 * size;
        bool better = false;
        for (int attempt = 0; attempt < 12 && !better; attempt++) {
            ph_i_prony_fit_model trial = *m;
            damped_step(k, r->m, triangle, z, lambda, small, step);
            longest = 0;
            for (int j = 0; j < k; j++) {
                double d = fmin(fmax(step[j], -1), 1), *t = &trial.time[which[j]];
                longest = fmax(longest, fabs(d));
                *t = fmin(fmax(*t * exp(d), r->first), r->last);
            }
            PH_TRY(solve(r, &trial, err));
            better = trial.rss < m->rss;
            if (better) *m = trial;
            lambda *= better ? 0.2 : 6;
        }
        if (!better || before - m->rss < 1e-9 * before || longest < 1e-10) break;
    }
out:
    free(small);
    return st;
}

/* Terms without modulus go, terms so near to each other that no data tell them apart are
 * one. True if anything changed. */
static bool tidy(ph_i_prony_fit_model *m)
{
    const int extras = ph_i_prony_fit_extras(m);
    double sum = 0;
    int before = m->n, n = 0;
    for (int k = 0; k < m->n; k++)
        sum += m->c[extras + k];
    for (int k = 0; k < m->n; k++) { /* by time */
        double time = m->time[k], c = m->c[extras + k];
        int j = k;
        for (; j > 0 && m->time[j - 1] > time; j--) {
            m->time[j] = m->time[j - 1];
            m->c[extras + j] = m->c[extras + j - 1];
        }
        m->time[j] = time;
        m->c[extras + j] = c;
    }
    for (int k = 0; k < before; k++) {
        double time = m->time[k], c = m->c[extras + k];
        if (!(c > 1e-13 * sum)) continue;
        if (n > 0 && time < 1.02 * m->time[n - 1]) {
            double *kept = &m->c[extras + n - 1], share = c / (*kept + c);
            m->time[n - 1] *= pow(time / m->time[n - 1], share);
            *kept += c;
            continue;
        }
        m->time[n] = time;
        m->c[extras + n++] = c;
    }
    m->n = n;
    return n < before;
}

/* The time of the grid whose term would lower the sum of squares the most, the others'
 * coefficients being free; 0 if none lowers it. */
static double best_place(const ph_i_prony_fit_rows *r, const work *w,
                         const ph_i_prony_fit_model *m)
{
    int which[PH_PRONY_FIT_TERMS + 1], k;
    const int n = put_active(r, m, w, which, &k);
    const double *z = column_of(r, w, n + w->ngrid);
    double best = 0, place = 0;
    for (int g = 0; g < w->ngrid; g++)
        ph_i_prony_fit_column(r, w->grid[g], column_of(r, w, n + g), NULL);
    put_residual(r, m, column_of(r, w, n + w->ngrid));
    ph_i_qr_columns(r->m, n, n + w->ngrid + 1, w->a);
    for (int g = 0; g < w->ngrid; g++) {
        const double *a = column_of(r, w, n + g);
        double along = 0, square = 0, whole = 0;
        for (ptrdiff_t i = 0; i < r->m; i++) {
            along += i < n ? 0 : a[i] * z[i];
            square += i < n ? 0 : a[i] * a[i];
            whole += a[i] * a[i];
        }
        if (along <= 0 || square < 1e-20 * whole || along * along / square <= best)
            continue;
        best = along * along / square;
        place = w->grid[g];
    }
    return place;
}

static ph_status work_new(const ph_i_prony_fit_rows *r, work *w, ph_error *err)
{
    ph_status st = PH_OK;
    const double decades = log10(r->last / r->first);
    w->ngrid = 1 + (int)ceil(PER_DECADE * decades);
    const int more = w->ngrid > PH_PRONY_FIT_TERMS ? w->ngrid : PH_PRONY_FIT_TERMS;
    PH_ALLOC(w->a, (PH_PRONY_FIT_TERMS + 6 + more) * r->m, "the fit of a series");
    PH_ALLOC(w->grid, w->ngrid, "the fit of a series");
    for (int g = 0; g < w->ngrid; g++)
        w->grid[g] = r->first * pow(r->last / r->first, (g + 0.5) / w->ngrid);
out:
    return st;
}

static double criterion(const ph_i_prony_fit_rows *r, const ph_i_prony_fit_model *m)
{
    int used = 0;
    for (int e = 0; e < ph_i_prony_fit_extras(m); e++)
        used += m->c[e] > 0;
    return ph_i_prony_fit_criterion(r, used, m->n, m->rss);
}

/* Refine until nothing is left to tidy. */
static ph_status settle(const ph_i_prony_fit_rows *r, const work *w,
                        ph_i_prony_fit_model *m, ph_error *err)
{
    ph_status st = PH_OK;
    for (int round = 0; round < 4; round++) {
        PH_TRY(refine(r, w, m, err));
        if (!tidy(m)) break;
        PH_TRY(solve(r, m, err));
    }
out:
    return st;
}

ph_status ph_i_prony_fit_path(const ph_i_prony_fit_rows *r, bool constant, bool rate,
                              int want, ph_i_prony_fit_model best[PH_PRONY_FIT_TERMS + 1],
                              ph_error *err)
{
    ph_status st = PH_OK;
    work w = {.a = NULL};
    ph_i_prony_fit_model m = {.constant = constant, .rate = rate};
    double least = INFINITY;
    int stalled = 0;
    for (int k = 0; k <= PH_PRONY_FIT_TERMS; k++)
        best[k].rss = -1;
    PH_TRY(work_new(r, &w, err));
    PH_TRY(solve(r, &m, err));
    best[0] = m;
    while (m.n < PH_PRONY_FIT_TERMS && stalled < 3) {
        /* a parameter fewer than there are rows */
        if (2 * (m.n + 1) + ph_i_prony_fit_extras(&m) >= r->m) break;
        if (m.rss < 1e-26 * (double)r->m || (want > 0 && m.n >= want)) break;
        double place = best_place(r, &w, &m);
        if (place == 0) break;
        m.time[m.n++] = place;
        PH_TRY(solve(r, &m, err));
        PH_TRY(settle(r, &w, &m, err));
        ph_i_prony_fit_model *b = &best[m.n];
        bool new_best = b->rss < 0 || m.rss < b->rss * (1 - 1e-6);
        if (new_best) *b = m;
        double now = criterion(r, &m);
        bool better = now < least;
        least = fmin(least, now);
        stalled = better || (want > 0 && new_best) ? 0 : stalled + 1;
    }
out:
    free(w.a);
    free(w.grid);
    return st;
}
