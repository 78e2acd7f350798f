/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Errors of the estimate: of the data by the Fisher matrix, of the sampling by what each
 * realisation pulls. */
#include "calibrate/calibrate.h"
#include "core/jacobi.h"

#include <gsl/gsl_cdf.h>

#include <math.h>
#include <string.h>

/* Below this share of the largest eigenvalue a direction is rounding. */
static const double NOTHING = 1e-10;

static void find_directions(ph_i_spread *e, int k)
{
    double S[K][K], V[K][K] = {{0}};
    int order[K];
    memcpy(S, e->hessian, sizeof S);
    ph_i_jacobi(k, K, &S[0][0], &V[0][0]);
    for (int a = 0; a < k; a++) {
        int at = a;
        while (at > 0 && S[order[at - 1]][order[at - 1]] < S[a][a]) {
            order[at] = order[at - 1];
            at--;
        }
        order[at] = a;
    }
    for (int a = 0; a < k; a++) {
        e->eigenvalue[a] = fmax(S[order[a]][order[a]], 0);
        int largest = 0;
        for (int j = 0; j < k; j++)
            if (fabs(V[j][order[a]]) > fabs(V[largest][order[a]])) largest = j;
        double sign = V[largest][order[a]] < 0 ? -1 : 1;
        for (int j = 0; j < k; j++)
            e->vector[a][j] = sign * V[j][order[a]];
    }
}

/* One standard error of direction a in shares of the range; its length there where the whole
 * box is one. */
static void judge_directions(ph_i_spread *e, int k)
{
    double scale = isnan(e->scale) ? 0 : e->scale;
    e->known = 0;
    for (int a = 0; a < k; a++) {
        double error = sqrt(scale / e->eigenvalue[a]);
        bool nothing = !(e->eigenvalue[a] > NOTHING * e->eigenvalue[0]);
        e->direction[a] = nothing || error > 1   ? PH_FIT_FLAT
                          : 2 * 1.96 * error > 1 ? PH_FIT_WEAK
                                                 : PH_FIT_KNOWN;
        e->known += e->direction[a] != PH_FIT_FLAT;
    }
    for (int j = 0; j < k; j++) {
        e->unknown[j] = PH_FIT_KNOWN;
        for (int a = 0; a < k; a++)
            if (fabs(e->vector[a][j]) > 0.1 && e->direction[a] > e->unknown[j])
                e->unknown[j] = e->direction[a];
    }
}

static void invert(ph_i_spread *e, int k)
{
    for (int i = 0; i < k; i++)
        for (int j = 0; j < k; j++) {
            e->inverse[i][j] = 0;
            for (int a = 0; a < k; a++)
                if (e->direction[a] != PH_FIT_FLAT)
                    e->inverse[i][j] +=
                        e->vector[a][i] * e->vector[a][j] / e->eigenvalue[a];
            e->data[i][j] = e->scale * e->inverse[i][j];
        }
}

/* How much a residual of measurement i moves the estimate: -(J^T J)^-1 J_i. */
static void influence(const ph_i_spread *e, int k, const double *J, int i, double a[K])
{
    for (int j = 0; j < k; j++) {
        a[j] = 0;
        for (int b = 0; b < k; b++)
            a[j] -= e->inverse[j][b] * J[i * K + b];
    }
}

static double mean_of(const ph_i_samples *s, const ph_i_set *set, int point, int output)
{
    double sum = 0;
    int count = 0;
    for (int r = 0; r < s->n[point]; r++)
        if (ph_i_samples_uses(s, point, r)) {
            sum += ph_i_samples_answer(s, set, point, r, output);
            count++;
        }
    return sum / count;
}

/* pull[r][j]: share of realisation r of one point in the deviation of the estimate, scaled so
 * that the sum of squares is an unbiased variance. */
static void pull_of(const ph_i_samples *s, const ph_i_set *set, const double *J,
                    const ph_i_spread *e, int point, double *pull)
{
    const ph_fit_problem *p = s->problem;
    int count = ph_i_samples_count(s, point, NULL);
    memset(pull, 0, (size_t)s->capacity * K * sizeof *pull);
    for (int i = 0; i < p->nmeasurements && count > 1; i++) {
        const ph_fit_measurement *m = &p->measurement[i];
        if (m->point != point) continue;
        double a[K], mean = mean_of(s, set, point, m->output);
        double share = 1 / sqrt((double)count * (count - 1)) / s->sigma[i];
        influence(e, p->nunknowns, J, i, a);
        for (int r = 0; r < s->n[point]; r++) {
            if (!ph_i_samples_uses(s, point, r)) continue;
            double d = ph_i_samples_answer(s, set, point, r, m->output) - mean;
            for (int j = 0; j < p->nunknowns; j++)
                pull[(size_t)r * K + j] += a[j] * d * share;
        }
    }
}

/* Covariance of the sampling, the part of each point as if it were alone, and degrees of
 * freedom: those of the parts together [Satterthwaite1946]. */
static ph_status find_sampling(const ph_i_samples *s, const ph_i_set *set,
                               const double *J, ph_i_spread *e, double (*part)[K],
                               ph_error *err)
{
    ph_status st = PH_OK;
    const ph_fit_problem *p = s->problem;
    int k = p->nunknowns;
    double *own = NULL, *all = NULL, sum[K] = {0}, weighed[K] = {0};
    PH_ALLOC(own, (size_t)s->capacity * K, "errors");
    PH_ALLOC(all, (size_t)s->capacity * K, "errors");
    for (int i = 0; i < p->npoints; i++) {
        int count = ph_i_samples_count(s, i, NULL);
        pull_of(s, set, J, e, i, own);
        memset(part[i], 0, sizeof part[i]);
        for (int r = 0; r < s->n[i]; r++)
            for (int j = 0; j < k; j++) {
                double pull = own[(size_t)r * K + j];
                all[(size_t)r * K + j] += pull;
                part[i][j] += pull * pull;
            }
        for (int j = 0; j < k && count > 1; j++) {
            sum[j] += part[i][j];
            weighed[j] += part[i][j] * part[i][j] / (count - 1);
        }
    }
    for (int r = 0; r < s->capacity; r++)
        for (int a = 0; a < k; a++)
            for (int b = 0; b < k; b++)
                e->sampling[a][b] += all[(size_t)r * K + a] * all[(size_t)r * K + b];
    for (int j = 0; j < k; j++)
        e->freedom[j] = weighed[j] > 0 ? sum[j] * sum[j] / weighed[j] : (double)INFINITY;
out:
    free(own);
    free(all);
    return st;
}

ph_status ph_i_spread_find(const ph_i_samples *s, const double u[K], const double *f,
                           const double *J, double scale, ph_i_spread *out,
                           double (*part)[K], ph_error *err)
{
    ph_status st = PH_OK;
    const ph_fit_problem *p = s->problem;
    int k = p->nunknowns, n = p->nmeasurements;
    double chi2 = 0;
    ph_i_spread e = {.scale = scale};
    for (int i = 0; i < n; i++) {
        chi2 += f[i] * f[i];
        for (int a = 0; a < k; a++)
            for (int b = 0; b < k; b++)
                e.hessian[a][b] += J[i * K + a] * J[i * K + b];
    }
    find_directions(&e, k);
    judge_directions(&e, k);
    if (isnan(scale) && n > e.known) {
        e.scale = chi2 / (n - e.known);
        judge_directions(&e, k);
    }
    invert(&e, k);
    PH_TRY(find_sampling(s, ph_i_samples_at(s, u), J, &e, part, err));
    *out = e;
out:
    return st;
}

double ph_i_spread_quantile(const ph_i_spread *e, int measurements, bool sigma_known,
                            int j, double *freedom)
{
    double data = isnan(e->data[j][j]) ? 0 : e->data[j][j], sampling = e->sampling[j][j];
    double parts = sampling * sampling / e->freedom[j];
    if (!sigma_known && measurements > e->known)
        parts += data * data / (measurements - e->known);
    double total = data + sampling;
    *freedom = parts > 0 ? total * total / parts : (double)INFINITY;
    if (*freedom > 1e6) *freedom = INFINITY;
    return isinf(*freedom) ? gsl_cdf_ugaussian_Pinv(0.975)
                           : gsl_cdf_tdist_Pinv(0.975, *freedom);
}

void ph_i_spread_allocate(const ph_i_samples *s, const ph_i_spread *e,
                          const double (*part)[K], const double *target, int at_most,
                          int *n, bool *enough)
{
    const ph_fit_problem *p = s->problem;
    int j = 0; /* the unknown in greatest need */
    for (int a = 1; a < p->nunknowns; a++)
        if (e->sampling[a][a] * target[j] * target[j] >
            e->sampling[j][j] * target[a] * target[a])
            j = a;
    *enough = e->sampling[j][j] <= target[j] * target[j];
    double roots = 0, parts = 0;
    for (int i = 0; i < p->npoints; i++) {
        roots += sqrt(part[i][j] * ph_i_samples_count(s, i, NULL));
        parts += part[i][j];
    }
    /* Points share their realisations, so that their errors do not just add up. */
    double together = parts > 0 ? e->sampling[j][j] / parts : 1;
    for (int i = 0; i < p->npoints; i++) {
        double root = sqrt(part[i][j] * ph_i_samples_count(s, i, NULL));
        double want = root * roots * together / (target[j] * target[j]);
        double most = fmin(4.0 * s->n[i], at_most);
        /* 10 % more than the estimate asks for, so that one round mostly does. */
        n[i] = (int)fmax(fmin(ceil(1.1 * want), most), s->n[i]);
    }
}

ph_status ph_i_spread_covariance(const ph_i_samples *s, const double u[K], double *S,
                                 ph_error *err)
{
    ph_status st = PH_OK;
    const ph_fit_problem *p = s->problem;
    const ph_i_set *set = ph_i_samples_at(s, u);
    int n = p->nmeasurements;
    size_t width = (size_t)s->capacity;
    double *e = NULL; /* [n][capacity] deviations, scaled */
    PH_ALLOC(e, n * width, "a covariance");
    for (int i = 0; i < n; i++) {
        const ph_fit_measurement *m = &p->measurement[i];
        int count = ph_i_samples_count(s, m->point, NULL);
        double mean = mean_of(s, set, m->point, m->output);
        double share = 1 / sqrt((double)count * (count - 1)) / s->sigma[i];
        for (int r = 0; r < s->n[m->point] && count > 1; r++)
            if (ph_i_samples_uses(s, m->point, r))
                e[i * width + r] =
                    share * (ph_i_samples_answer(s, set, m->point, r, m->output) - mean);
    }
    for (int i = 0; i < n; i++)
        for (int k = 0; k <= i; k++) {
            double sum = 0;
            for (size_t r = 0; r < width; r++)
                sum += e[i * width + r] * e[k * width + r];
            S[i * n + k] = S[k * n + i] = sum;
        }
out:
    free(e);
    return st;
}
