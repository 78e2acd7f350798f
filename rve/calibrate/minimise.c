/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Levenberg-Marquardt in a box. */
#include "calibrate/calibrate.h"
#include "core/jacobi.h"

#include <math.h>
#include <string.h>

static double square(int n, const double *f)
{
    double sum = 0;
    for (int i = 0; i < n; i++)
        sum += f[i] * f[i];
    return isfinite(sum) ? sum : (double)INFINITY;
}

/* Where the differences of unknown j are taken, two places beside u, and the weights of what
 * f is there minus f at u: where nothing changes the derivative is exactly zero. */
static void stencil(const ph_i_search *how, const double u[K], int j, double place[2],
                    double weight[2])
{
    double h = fmin(how->step, (how->hi[j] - how->lo[j]) / 2);
    if (u[j] - h >= how->lo[j] && u[j] + h <= how->hi[j]) {
        place[0] = u[j] - h;
        place[1] = u[j] + h;
        weight[0] = -1 / (place[1] - place[0]);
        weight[1] = -weight[0];
        return;
    }
    double s = u[j] - h < how->lo[j] ? h : -h;
    place[0] = u[j] + s;
    place[1] = u[j] + 2 * s;
    weight[0] = 2 / s;
    weight[1] = -0.5 / s;
}

ph_status ph_i_jacobian(const ph_i_residuals *r, const ph_i_search *how,
                        const double u[K], double *f, double *J, bool *known,
                        ph_error *err)
{
    ph_status st = PH_OK;
    int n = r->n, m = 1;
    double(*at)[K] = NULL, *all = NULL, weight[K][2];
    PH_ALLOC(at, 2 * K + 1, "a Jacobian");
    PH_ALLOC(all, (size_t)(2 * K + 1) * n, "a Jacobian");
    memcpy(at[0], u, sizeof at[0]);
    for (int j = 0; j < r->k; j++) {
        double place[2];
        if (how->hi[j] <= how->lo[j]) continue;
        stencil(how, u, j, place, weight[j]);
        for (int i = 0; i < 2; i++, m++) {
            memcpy(at[m], u, sizeof at[m]);
            at[m][j] = place[i];
        }
    }
    PH_TRY(r->eval(r->user, m, at[0], all, err));
    memcpy(f, all, (size_t)n * sizeof *f);
    *known = true;
    for (int i = 0; i < n; i++) {
        int at_j = 1;
        for (int j = 0; j < K; j++)
            J[i * K + j] = 0;
        for (int j = 0; j < r->k; j++) {
            if (how->hi[j] <= how->lo[j]) continue;
            double first = all[(size_t)at_j * n + i] - all[i];
            double second = all[(size_t)(at_j + 1) * n + i] - all[i];
            J[i * K + j] = weight[j][0] * first + weight[j][1] * second;
            at_j += 2;
            *known = *known && isfinite(J[i * K + j]);
        }
    }
out:
    free(at);
    free(all);
    return st;
}

/* The quadratic model at u. */
typedef struct quadratic {
    int k;
    double A[K][K], g[K];
} quadratic;

static void quadratic_of(quadratic *q, int k, int n, const double *f, const double *J)
{
    *q = (quadratic){.k = k};
    for (int i = 0; i < n; i++)
        for (int a = 0; a < k; a++) {
            q->g[a] += J[i * K + a] * f[i];
            for (int b = 0; b < k; b++)
                q->A[a][b] += J[i * K + a] * J[i * K + b];
        }
}

/* d minimises the damped model over the unknowns that may move; scaled by the diagonal and
 * solved in eigenvectors, so that flat directions do no harm. */
static void damped_step(const quadratic *q, const bool *may, double lambda, double d[K])
{
    double S[K][K] = {{0}}, V[K][K] = {{0}}, scale[K], largest = 0;
    for (int a = 0; a < q->k; a++)
        largest = fmax(largest, q->A[a][a]);
    for (int a = 0; a < q->k; a++)
        scale[a] = 1 / sqrt(fmax(fmax(q->A[a][a], 1e-12 * largest), 1e-300));
    for (int a = 0; a < q->k; a++)
        for (int b = 0; b < q->k; b++)
            S[a][b] = may[a] && may[b] ? q->A[a][b] * scale[a] * scale[b] : a == b;
    ph_i_jacobi(q->k, K, &S[0][0], &V[0][0]);
    for (int a = 0; a < q->k; a++)
        d[a] = 0;
    for (int e = 0; e < q->k; e++) {
        double along = 0;
        for (int a = 0; a < q->k; a++)
            if (may[a]) along -= V[a][e] * q->g[a] * scale[a];
        along /= fmax(S[e][e], 0) + lambda;
        for (int a = 0; a < q->k; a++)
            if (may[a]) d[a] += V[a][e] * along * scale[a];
    }
}

static double curvature(const quadratic *q, const double d[K])
{
    double sum = 0;
    for (int a = 0; a < q->k; a++)
        for (int b = 0; b < q->k; b++)
            sum += d[a] * q->A[a][b] * d[b];
    return sum;
}

/* A step inside the box from u: what would leave it goes to the bound and no further, and
 * the others follow. @return the fall of chi2 that the model predicts */
static double boxed_step(const quadratic *q, const ph_i_search *how, const double u[K],
                         double lambda, double next[K], double d[K])
{
    bool may[K];
    double fixed[K] = {0}, slope = 0;
    for (int a = 0; a < q->k; a++)
        may[a] = !(u[a] <= how->lo[a] && q->g[a] >= 0) &&
                 !(u[a] >= how->hi[a] && q->g[a] <= 0);
    for (bool inside = false; !inside;) {
        quadratic rest = *q;
        for (int a = 0; a < q->k; a++)
            for (int b = 0; b < q->k; b++)
                rest.g[a] += q->A[a][b] * fixed[b];
        damped_step(&rest, may, lambda, d);
        inside = true;
        for (int a = 0; a < q->k; a++) {
            double to = fmin(fmax(u[a] + d[a], how->lo[a]), how->hi[a]);
            if (!may[a] || to == u[a] + d[a]) continue;
            fixed[a] = to - u[a];
            may[a] = inside = false;
        }
    }
    memcpy(next, u, K * sizeof *next);
    for (int a = 0; a < q->k; a++) {
        next[a] = fmin(fmax(u[a] + d[a] + fixed[a], how->lo[a]), how->hi[a]);
        d[a] = next[a] - u[a];
        slope += d[a] * q->g[a];
    }
    return -2 * slope - curvature(q, d);
}

static double scale_of(const ph_i_search *how, int k, int n, double chi2)
{
    if (!isnan(how->scale)) return how->scale;
    return chi2 / (n > k ? n - k : 1);
}

static bool short_enough(const quadratic *q, const ph_i_search *how, int n, double chi2,
                         const double d[K])
{
    double longest = 0, errors = curvature(q, d);
    for (int a = 0; a < q->k; a++)
        longest = fmax(longest, fabs(d[a]));
    return longest < 1e-7 ||
           errors <= how->tolerance * how->tolerance * scale_of(how, q->k, n, chi2);
}

ph_status ph_i_minimise(const ph_i_residuals *r, const ph_i_search *how, double u[K],
                        double *chi2, bool *converged, ph_error *err)
{
    ph_status st = PH_OK;
    int n = r->n;
    double *f = NULL, *J = NULL, *trial = NULL, lambda = 1e-3;
    bool known = true, done = false;
    PH_ALLOC(f, n, "a fit");
    PH_ALLOC(J, (size_t)n * K, "a fit");
    PH_ALLOC(trial, n, "a fit");
    for (int i = 0; i < how->iterations && !done; i++) {
        quadratic q;
        PH_TRY(ph_i_jacobian(r, how, u, f, J, &known, err));
        *chi2 = square(n, f);
        if (!known || !isfinite(*chi2)) break;
        quadratic_of(&q, r->k, n, f, J);
        for (bool better = false; !better && !done;) {
            double next[K], d[K];
            double fall = boxed_step(&q, how, u, lambda, next, d);
            /* A step that is short because it is damped says nothing. */
            bool last =
                short_enough(&q, how, n, *chi2, d) && (lambda <= 1e-2 || lambda > 1e8);
            if (!(fall > 0)) { /* nowhere to go, or a step to be shorter */
                lambda *= 10;
                done = last || lambda > 1e12;
                continue;
            }
            PH_TRY(r->eval(r->user, 1, next, trial, err));
            double now = square(n, trial);
            better = now < *chi2;
            if (better) {
                double ratio = (*chi2 - now) / fall;
                memcpy(u, next, K * sizeof *u);
                *chi2 = now;
                lambda *= ratio > 0.75 ? 0.1 : ratio < 0.25 ? 4 : 0.5;
            } else {
                lambda *= 10;
            }
            done = last || lambda > 1e12;
        }
    }
    *converged = done;
out:
    free(f);
    free(J);
    free(trial);
    return st;
}
