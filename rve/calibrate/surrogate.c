/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tensor-product Chebyshev interpolation of the residuals, barycentric [Berrut2004]. */
#include "calibrate/calibrate.h"

#include <math.h>
#include <string.h>

/* Nodes an axis by number of unknowns: first try, and once more where that is not enough. */
static const int nodes_of[2][PH_I_SURROGATE_UNKNOWNS + 1] = {{1, 9, 5, 4, 3},
                                                             {1, 17, 9, 6, 4}};
enum { CHECKS = 4 };
static const double ENOUGH = 0.02; /* of sigma */

void ph_i_surrogate_free(ph_i_surrogate **s)
{
    if (!s || !*s) return;
    free((*s)->place);
    free((*s)->f);
    free(*s);
    *s = NULL;
}

static void place_nodes(ph_i_surrogate *s, int free_axes, const int *axis)
{
    int n = s->nodes;
    for (int i = 0; i < n; i++) {
        /* Chebyshev points of the second kind: the ends are among them. */
        s->node[i] = n == 1 ? 0.5 : 0.5 - 0.5 * cos(i * acos(-1.0) / (n - 1));
        s->weight[i] = (i % 2 ? -1 : 1) * (i == 0 || i == n - 1 ? 0.5 : 1);
    }
    for (int t = 0; t < s->total; t++) {
        int rest = t;
        for (int j = 0; j < s->k; j++)
            s->place[t][j] = s->lo[j];
        for (int a = 0; a < free_axes; a++) {
            double x = s->node[rest % n];
            int j = axis[a];
            s->place[t][j] = s->lo[j] + (s->hi[j] - s->lo[j]) * x;
            if (x == 1) s->place[t][j] = s->hi[j];
            rest /= n;
        }
    }
}

/* Lagrange basis at x in [0, 1]. */
static void basis(const ph_i_surrogate *s, double x, double *b)
{
    double sum = 0;
    for (int i = 0; i < s->nodes; i++) {
        double d = x - s->node[i];
        if (d == 0) {
            memset(b, 0, (size_t)s->nodes * sizeof *b);
            b[i] = 1;
            return;
        }
        b[i] = s->weight[i] / d;
        sum += b[i];
    }
    for (int i = 0; i < s->nodes; i++)
        b[i] /= sum;
}

static void evaluate(const ph_i_surrogate *s, const double u[K], double *f)
{
    double b[K][PH_I_NODES_MAX];
    for (int j = 0; j < s->k; j++)
        if (s->hi[j] > s->lo[j])
            basis(s, (u[j] - s->lo[j]) / (s->hi[j] - s->lo[j]), b[j]);
    memset(f, 0, (size_t)s->n * sizeof *f);
    for (int t = 0; t < s->total; t++) {
        int rest = t;
        double w = 1;
        for (int j = 0; j < s->k; j++) {
            if (!(s->hi[j] > s->lo[j])) continue;
            w *= b[j][rest % s->nodes];
            rest /= s->nodes;
        }
        if (w == 0) continue;
        for (int i = 0; i < s->n; i++)
            f[i] += w * s->f[(size_t)t * s->n + i];
    }
}

ph_status ph_i_surrogate_residuals(void *user, int m, const double *u, double *f,
                                   ph_error *err)
{
    const ph_i_surrogate *s = user;
    (void)err;
    for (int i = 0; i < m; i++)
        evaluate(s, u + (size_t)i * K, f + (size_t)i * s->n);
    return PH_OK;
}

/* Largest error at places that are no nodes: the centre, and some spread over the box. */
static ph_status check(ph_i_surrogate *s, const ph_i_residuals *r, const double centre[K],
                       bool *built, ph_error *err)
{
    ph_status st = PH_OK;
    double at[CHECKS][K] = {{0}}, *exact = NULL, *guess = NULL;
    PH_ALLOC(exact, CHECKS * (size_t)s->n, "a surrogate");
    PH_ALLOC(guess, s->n, "a surrogate");
    for (int c = 0; c < CHECKS; c++)
        for (int j = 0; j < s->k; j++) {
            /* additive recurrence with the golden ratio's relatives */
            double x = fmod(0.5 + c * pow(0.6180339887498949, 1 + 0.5 * j), 1.0);
            at[c][j] =
                c == 0 ? centre[j] : s->lo[j] + (s->hi[j] - s->lo[j]) * (0.1 + 0.8 * x);
        }
    PH_TRY(r->eval(r->user, CHECKS, at[0], exact, err));
    s->error = 0;
    for (int c = 0; c < CHECKS; c++) {
        evaluate(s, at[c], guess);
        for (int i = 0; i < s->n; i++) {
            double d = fabs(guess[i] - exact[(size_t)c * s->n + i]);
            *built = *built && isfinite(d);
            s->error = fmax(s->error, d);
        }
    }
out:
    free(exact);
    free(guess);
    return st;
}

static ph_status make(const ph_i_residuals *r, const double lo[K], const double hi[K],
                      const double centre[K], int nodes, ph_i_surrogate **out,
                      bool *built, ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_surrogate *s = NULL;
    int axis[K], free_axes = 0;
    PH_ALLOC(s, 1, "a surrogate");
    s->k = r->k;
    s->n = r->n;
    s->nodes = nodes;
    s->total = 1;
    memcpy(s->lo, lo, sizeof s->lo);
    memcpy(s->hi, hi, sizeof s->hi);
    for (int j = 0; j < r->k; j++)
        if (hi[j] > lo[j]) {
            axis[free_axes++] = j;
            s->total *= nodes;
        }
    PH_ALLOC(s->place, s->total, "a surrogate");
    PH_ALLOC(s->f, (size_t)s->total * s->n, "a surrogate");
    place_nodes(s, free_axes, axis);
    PH_TRY(r->eval(r->user, s->total, s->place[0], s->f, err));
    *built = true;
    for (size_t i = 0; i < (size_t)s->total * s->n; i++)
        *built = *built && isfinite(s->f[i]);
    if (!*built) goto out;
    PH_TRY(check(s, r, centre, built, err));
    if (!*built) goto out;
    *out = s;
    s = NULL;
out:
    ph_i_surrogate_free(&s);
    return st;
}

ph_status ph_i_surrogate_new(const ph_i_residuals *r, const double lo[K],
                             const double hi[K], const double centre[K],
                             ph_i_surrogate **out, bool *built, ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_surrogate *s = NULL, *finer = NULL;
    *built = false;
    if (r->k > PH_I_SURROGATE_UNKNOWNS) goto out;
    PH_TRY(make(r, lo, hi, centre, nodes_of[0][r->k], &s, built, err));
    if (*built && s->error > ENOUGH) {
        bool also = false;
        PH_TRY(make(r, lo, hi, centre, nodes_of[1][r->k], &finer, &also, err));
        if (also && finer->error < s->error) {
            ph_i_surrogate_free(&s);
            s = finer;
            finer = NULL;
        }
    }
    *out = s;
    s = NULL;
out:
    ph_i_surrogate_free(&s);
    ph_i_surrogate_free(&finer);
    return st;
}
