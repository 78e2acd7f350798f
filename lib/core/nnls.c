/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/nnls.h"

#include "core/dense.h"

#include <float.h>
#include <math.h>
#include <string.h>

void ph_i_back_substitute(ptrdiff_t m, int n, const double *a, const double *b, double *x)
{
    double largest = 0;
    for (int i = 0; i < n && i < m; i++)
        largest = fmax(largest, fabs(a[i * m + i]));
    for (int i = n - 1; i >= 0; i--) {
        double pivot = i < m ? a[i * m + i] : 0, sum = i < m ? b[i] : 0;
        for (int j = i + 1; j < n && i < m; j++)
            sum -= a[j * m + i] * x[j];
        x[i] = fabs(pivot) > 1e-15 * largest ? sum / pivot : 0;
    }
}

/* A problem in triangular form: rows x n, and what it is solved with. */
typedef struct problem {
    int n, rows;
    const double *r, *b; /* [n][rows], [rows] */
    double *q;           /* [n + 1][rows]: the free columns and b */
    double *x, *z;       /* [n] */
    double *free_z;      /* [n] z of the free ones, in their order */
    double *residual;    /* [rows] */
    bool *is_free;       /* [n] */
    int *column;         /* [n] the free ones */
} problem;

static ph_status problem_new(int n, int rows, problem *p, ph_error *err)
{
    ph_status st = PH_OK;
    PH_ALLOC(p->q, (ptrdiff_t)(n + 1) * rows, "least squares");
    PH_ALLOC(p->residual, rows, "least squares");
    PH_ALLOC(p->x, n, "least squares");
    PH_ALLOC(p->z, n, "least squares");
    PH_ALLOC(p->free_z, n, "least squares");
    PH_ALLOC(p->is_free, n, "least squares");
    PH_ALLOC(p->column, n, "least squares");
    p->n = n;
    p->rows = rows;
out:
    return st;
}

static void problem_free(problem *p)
{
    free(p->q);
    free(p->residual);
    free(p->x);
    free(p->z);
    free(p->free_z);
    free(p->is_free);
    free(p->column);
}

/* z: least squares with the free columns alone, zero elsewhere. */
static void solve_free(problem *p)
{
    const size_t bytes = (size_t)p->rows * sizeof *p->q;
    int count = 0;
    for (int k = 0; k < p->n; k++) {
        p->z[k] = 0;
        if (!p->is_free[k]) continue;
        memcpy(p->q + (ptrdiff_t)count * p->rows, p->r + (ptrdiff_t)k * p->rows, bytes);
        p->column[count++] = k;
    }
    double *b = p->q + (ptrdiff_t)count * p->rows;
    memcpy(b, p->b, bytes);
    ph_i_qr_columns(p->rows, count, count + 1, p->q);
    ph_i_back_substitute(p->rows, count, p->q, b, p->free_z);
    for (int k = 0; k < count; k++)
        p->z[p->column[k]] = p->free_z[k];
}

static double update_residual(problem *p)
{
    memcpy(p->residual, p->b, (size_t)p->rows * sizeof *p->residual);
    for (int k = 0; k < p->n; k++)
        for (int i = 0; p->x[k] != 0 && i < p->rows; i++)
            p->residual[i] -= p->r[(ptrdiff_t)k * p->rows + i] * p->x[k];
    return ph_i_inner(p->rows, p->residual, p->residual);
}

/* The column along which the residual falls fastest, -1 if none. */
static int steepest(const problem *p, const bool *barred, double least)
{
    int best = -1;
    for (int k = 0; k < p->n; k++) {
        double w = ph_i_inner(p->rows, p->r + (ptrdiff_t)k * p->rows, p->residual);
        if (p->is_free[k] || barred[k] || w <= least) continue;
        least = w;
        best = k;
    }
    return best;
}

/* Go from x towards z until an entry becomes zero; false when z was reached. */
static bool step_towards(problem *p)
{
    double share = 1;
    int stop = -1;
    for (int k = 0; k < p->n; k++) {
        if (!p->is_free[k] || p->z[k] > 0) continue;
        double t = p->x[k] / (p->x[k] - p->z[k]);
        if (p->x[k] <= 0) t = 0;
        if (t >= share && stop >= 0) continue;
        share = t;
        stop = k;
    }
    for (int k = 0; k < p->n; k++)
        if (p->is_free[k]) p->x[k] += share * (p->z[k] - p->x[k]);
    if (stop < 0) return false;
    for (int k = 0; k < p->n; k++) {
        if (!p->is_free[k] || (k != stop && p->x[k] > 0)) continue;
        p->x[k] = 0;
        p->is_free[k] = false;
    }
    return true;
}

static ph_status iterate(problem *p, bool *barred, ph_error *err)
{
    ph_status st = PH_OK;
    const double least = 4 * DBL_EPSILON * sqrt(ph_i_inner(p->rows, p->b, p->b));
    (void)update_residual(p);
    for (int step = 0;; step++) {
        int k = steepest(p, barred, least);
        if (k < 0) break;
        PH_CHECK(step < 30 * p->n, PH_ENOCONV,
                 "non-negative least squares: no end after %d steps", step);
        p->is_free[k] = true;
        solve_free(p);
        if (p->z[k] <= 0) { /* only rounding said that it would help */
            p->is_free[k] = false;
            barred[k] = true;
            continue;
        }
        memset(barred, 0, (size_t)p->n * sizeof *barred);
        while (step_towards(p))
            solve_free(p);
        (void)update_residual(p);
    }
out:
    return st;
}

ph_status ph_i_nnls(ptrdiff_t m, int n, double *a, double *x, double *rss, ph_error *err)
{
    ph_status st = PH_OK;
    problem p = {.q = NULL};
    double *r = NULL, *scale = NULL;
    bool *barred = NULL;
    const int rows = m < n + 1 ? (int)m : n + 1;
    PH_ALLOC(scale, n, "least squares");
    PH_ALLOC(r, (ptrdiff_t)(n + 1) * rows, "least squares");
    PH_ALLOC(barred, n, "least squares");
    PH_TRY(problem_new(n, rows, &p, err));
    for (int k = 0; k < n; k++) {
        double *c = a + k * m, length = sqrt(ph_i_inner(m, c, c));
        scale[k] = length > 0 ? 1 / length : 0;
        for (ptrdiff_t i = 0; i < m; i++)
            c[i] *= scale[k];
    }
    ph_i_qr_columns(m, n + 1, n + 1, a); /* b is the last column */
    for (int k = 0; k <= n; k++)
        for (int i = 0; i < rows; i++)
            r[(ptrdiff_t)k * rows + i] = a[k * m + i];
    p.r = r;
    p.b = r + (ptrdiff_t)n * rows;
    PH_TRY(iterate(&p, barred, err));
    for (int k = 0; k < n; k++)
        x[k] = p.x[k] * scale[k];
    if (rss) *rss = update_residual(&p);
out:
    problem_free(&p);
    free(r);
    free(scale);
    free(barred);
    return st;
}
