/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Posterior samples: affine-invariant ensemble with stretch moves [Goodman2010] on the
 * surrogate. The prior is uniform on the scale of each unknown, between its bounds. */
#include "calibrate/calibrate.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_linalg.h>

#include <math.h>
#include <string.h>

enum { BURN = 1000, THIN = 5 };
static const double STRETCH = 2;

typedef struct chain {
    const ph_i_fit *c;
    int k, n, walkers;
    double
        *root; /* [n][n] Cholesky factor of the residuals' covariance; NULL: no sigma */
    double *f; /* [n] */
    double (*u)[K];
    double *density; /* [walkers] logarithm */
    ph_random random;
    long tried, taken;
} chain;

/* Of the covariance of the residuals: of the data, and of the means over the realisations. */
static ph_status find_root(chain *h, ph_error *err)
{
    ph_status st = PH_OK;
    memcpy(h->root, h->c->S, (size_t)h->n * h->n * sizeof *h->root);
    for (int i = 0; i < h->n; i++)
        h->root[i * h->n + i] += h->c->spread.scale;
    gsl_matrix_view view = gsl_matrix_view_array(h->root, (size_t)h->n, (size_t)h->n);
    /* positive definite: at least sigma^2 on the diagonal */
    PH_CHECK(gsl_linalg_cholesky_decomp1(&view.matrix) == 0, PH_ESINGULAR,
             "the covariance of the measurements is singular");
out:
    return st;
}

static ph_status log_density(chain *h, const double u[K], double *out, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_i_surrogate *s = h->c->surrogate;
    double sum = 0;
    *out = -INFINITY;
    for (int j = 0; j < h->k; j++)
        if (!(u[j] >= s->lo[j] && u[j] <= s->hi[j])) goto out;
    PH_TRY(ph_i_surrogate_residuals(h->c->surrogate, 1, u, h->f, err));
    if (h->root) {
        gsl_matrix_view L = gsl_matrix_view_array(h->root, (size_t)h->n, (size_t)h->n);
        gsl_vector_view f = gsl_vector_view_array(h->f, (size_t)h->n);
        gsl_blas_dtrsv(CblasLower, CblasNoTrans, CblasNonUnit, &L.matrix, &f.vector);
    }
    for (int i = 0; i < h->n; i++)
        sum += h->f[i] * h->f[i];
    /* sigma not known: integrated over, with the prior 1 / sigma */
    *out = h->root ? -0.5 * sum : -0.5 * h->n * log(sum);
out:
    return st;
}

static ph_status start(chain *h, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_i_surrogate *s = h->c->surrogate;
    const ph_i_spread *e = &h->c->spread;
    for (int w = 0; w < h->walkers; w++) {
        for (int j = 0; j < h->k; j++) {
            double wide = (s->hi[j] - s->lo[j]) / 2;
            double error = sqrt(e->data[j][j] + e->sampling[j][j]);
            bool flat = e->unknown[j] == PH_FIT_FLAT;
            double x = h->c->best[j] + ph_random_normal(&h->random) * fmin(error, wide);
            double y = s->lo[j] + 2 * wide * ph_random_uniform(&h->random);
            h->u[w][j] = flat || x < s->lo[j] || x > s->hi[j] ? y : x;
        }
        PH_TRY(log_density(h, h->u[w], &h->density[w], err));
    }
out:
    return st;
}

/* Every walker once: stretched along the line to one of the other half. */
static ph_status sweep(chain *h, ph_error *err)
{
    ph_status st = PH_OK;
    int half = h->walkers / 2;
    for (int w = 0; w < h->walkers; w++) {
        double at[K] = {0}, density;
        int other = (int)(half * ph_random_uniform(&h->random)) + (w < half ? half : 0);
        double root = 1 + (STRETCH - 1) * ph_random_uniform(&h->random);
        double z = root * root / STRETCH;
        for (int j = 0; j < h->k; j++)
            at[j] = h->u[other][j] + z * (h->u[w][j] - h->u[other][j]);
        PH_TRY(log_density(h, at, &density, err));
        double odds = (h->k - 1) * log(z) + density - h->density[w];
        h->tried++;
        if (!(log(ph_random_uniform(&h->random)) < odds)) continue;
        h->taken++;
        memcpy(h->u[w], at, sizeof at);
        h->density[w] = density;
    }
out:
    return st;
}

/* Integrated autocorrelation time of unknown j, in sweeps: covariances averaged over the
 * walkers, summed up to a window of five times itself [Sokal1997]. */
static double autocorrelation(const double *path, int sweeps, int walkers, int j)
{
    double mean = 0, variance = 0, time = 1;
    size_t all = (size_t)sweeps * walkers;
    for (size_t i = 0; i < all; i++)
        mean += path[i * K + j];
    mean /= (double)all;
    for (size_t i = 0; i < all; i++)
        variance += (path[i * K + j] - mean) * (path[i * K + j] - mean);
    variance /= (double)all;
    if (!(variance > 0)) return NAN;
    for (int lag = 1; lag < sweeps / 2 && lag < 5 * time; lag++) {
        double sum = 0;
        for (int t = 0; t + lag < sweeps; t++)
            for (int w = 0; w < walkers; w++)
                sum += (path[((size_t)t * walkers + w) * K + j] - mean) *
                       (path[((size_t)(t + lag) * walkers + w) * K + j] - mean);
        time += 2 * sum / ((double)(sweeps - lag) * walkers) / variance;
    }
    return time;
}

static int by_size(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void describe(ph_fit *out, int j, double *sorted)
{
    ph_fit_estimate *o = &out->unknown[j];
    static const double share[3] = {0.025, 0.5, 0.975};
    double sum = 0, square = 0;
    int n = out->nsamples;
    for (int i = 0; i < n; i++)
        sum += sorted[i] = out->sample[(size_t)i * out->nunknowns + j];
    o->posterior_mean = sum / n;
    for (int i = 0; i < n; i++)
        square += (sorted[i] - o->posterior_mean) * (sorted[i] - o->posterior_mean);
    o->posterior_std = n > 1 ? sqrt(square / (n - 1)) : (double)NAN;
    qsort(sorted, (size_t)n, sizeof *sorted, by_size);
    for (int q = 0; q < 3; q++) {
        double at = share[q] * (n - 1);
        int i = (int)at;
        double rest = at - i;
        o->posterior_quantile[q] =
            sorted[i] + (i + 1 < n ? rest * (sorted[i + 1] - sorted[i]) : 0);
    }
}

/* Sweeps of the whole ensemble; path [sweeps][walkers][K]. */
static ph_status run(chain *h, int sweeps, double *path, ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(start(h, err));
    for (int t = 0; t < BURN; t++)
        PH_TRY(sweep(h, err));
    h->tried = h->taken = 0;
    for (int t = 0; t < sweeps; t++) {
        PH_TRY(sweep(h, err));
        memcpy(path + (size_t)t * h->walkers * K, h->u,
               (size_t)h->walkers * sizeof *h->u);
    }
out:
    return st;
}

ph_status ph_i_posterior(ph_i_fit *c, ph_error *err)
{
    ph_status st = PH_OK;
    ph_fit *out = c->out;
    int k = c->problem->nunknowns, n = c->problem->nmeasurements,
        asked = c->params.samples;
    chain h = {.c = c, .k = k, .n = n, .walkers = 4 * k < 20 ? 20 : 4 * k};
    double *path = NULL, *sorted = NULL;
    if (asked < 1) goto out;
    if (!c->surrogate) {
        ph_i_fit_note(out, "no posterior: it needs the surrogate that the profiles need");
        goto out;
    }
    int rows = (asked + h.walkers - 1) / h.walkers, sweeps = rows * THIN;
    h.random = (ph_random){.seed = c->params.seed, .object = 0x506f7374};
    PH_ALLOC(h.f, n, "a posterior");
    PH_ALLOC(h.u, h.walkers, "a posterior");
    PH_ALLOC(h.density, h.walkers, "a posterior");
    PH_ALLOC(path, (size_t)sweeps * h.walkers * K, "a posterior");
    PH_ALLOC(out->sample, (size_t)asked * k, "a posterior");
    PH_ALLOC(sorted, asked, "a posterior");
    if (c->sigma_known) {
        PH_ALLOC(h.root, (size_t)n * n, "a posterior");
        PH_TRY(find_root(&h, err));
    }
    PH_TRY(run(&h, sweeps, path, err));
    for (int i = 0; i < asked; i++)
        for (int j = 0; j < k; j++) {
            size_t t = (size_t)(i / h.walkers) * THIN + THIN - 1;
            double u = path[(t * h.walkers + i % h.walkers) * K + j];
            out->sample[(size_t)i * k + j] =
                ph_i_unknown_value(&c->problem->unknown[j], u);
        }
    out->nsamples = asked;
    out->walkers = h.walkers;
    out->acceptance = (double)h.taken / (double)h.tried;
    for (int j = 0; j < k; j++) {
        describe(out, j, sorted);
        out->unknown[j].autocorrelation = autocorrelation(path, sweeps, h.walkers, j);
    }
out:
    free(h.root);
    free(h.f);
    free(h.u);
    free(h.density);
    free(path);
    free(sorted);
    return st;
}
