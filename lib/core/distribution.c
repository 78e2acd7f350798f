/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/distribution.h>

#include "core/check.h"

#include <gsl/gsl_cdf.h>

#include <math.h>

static double constant_cdf(const ph_distribution *d, double x)
{
    return x >= d->p[0];
}
static double constant_quantile(const ph_distribution *d, double u)
{
    (void)u;
    return d->p[0];
}

static double uniform_cdf(const ph_distribution *d, double x)
{
    double t = d->p[1] > d->p[0] ? (x - d->p[0]) / (d->p[1] - d->p[0]) : x >= d->p[0];
    return fmin(fmax(t, 0), 1);
}
static double uniform_quantile(const ph_distribution *d, double u)
{
    return d->p[0] + u * (d->p[1] - d->p[0]);
}

/* Values min, min + step, ..: how many. */
static double steps(const ph_distribution *d)
{
    return floor((d->p[1] - d->p[0]) / d->p[2] * (1 + 1e-12)) + 1;
}
static double discrete_cdf(const ph_distribution *d, double x)
{
    double n = steps(d);
    return fmin(fmax(floor((x - d->p[0]) / d->p[2] + 1e-9) + 1, 0), n) / n;
}
static double discrete_quantile(const ph_distribution *d, double u)
{
    double n = steps(d);
    return d->p[0] + d->p[2] * fmin(floor(u * n), n - 1);
}

static double normal_cdf(const ph_distribution *d, double x)
{
    return d->p[1] > 0 ? gsl_cdf_ugaussian_P((x - d->p[0]) / d->p[1]) : x >= d->p[0];
}
static double normal_quantile(const ph_distribution *d, double u)
{
    return d->p[0] + d->p[1] * gsl_cdf_ugaussian_Pinv(u);
}

/* Mean m and standard deviation s of X: those of log X are zeta and sigma. */
static void of_logarithm(const ph_distribution *d, double *zeta, double *sigma)
{
    double m = d->p[0], s = d->p[1];
    *sigma = sqrt(log1p(s * s / (m * m)));
    *zeta = log(m) - 0.5 * *sigma * *sigma;
}
static double lognormal_cdf(const ph_distribution *d, double x)
{
    double zeta, sigma;
    of_logarithm(d, &zeta, &sigma);
    if (x <= 0) return 0;
    return sigma > 0 ? gsl_cdf_ugaussian_P((log(x) - zeta) / sigma) : x >= d->p[0];
}
static double lognormal_quantile(const ph_distribution *d, double u)
{
    double zeta, sigma;
    of_logarithm(d, &zeta, &sigma);
    return exp(zeta + sigma * gsl_cdf_ugaussian_Pinv(u));
}

static double weibull_cdf(const ph_distribution *d, double x)
{
    return x <= 0 ? 0 : gsl_cdf_weibull_P(x, d->p[1], d->p[0]);
}
static double weibull_quantile(const ph_distribution *d, double u)
{
    return gsl_cdf_weibull_Pinv(u, d->p[1], d->p[0]);
}

static double table_cdf(const ph_distribution *d, double x)
{
    double sum = 0;
    for (int i = 0; i < d->n && d->value[i] <= x; i++)
        sum += d->weight[i];
    return fmin(sum, 1);
}
static double table_quantile(const ph_distribution *d, double u)
{
    double sum = 0;
    for (int i = 0; i < d->n; i++)
        if (u < (sum += d->weight[i])) return d->value[i];
    return d->value[d->n - 1];
}

const ph_distribution_kind ph_distributions[] = {
    {{"constant", "one value; a plain number stands for it", "", "any"},
     {"value"},
     false,
     constant_cdf,
     constant_quantile},
    {{"uniform", "every value from min to max alike", "", "min <= max"},
     {"min", "max"},
     false,
     uniform_cdf,
     uniform_quantile},
    {{"discrete_uniform", "min, min + step, ... up to max, alike", "",
      "min <= max, step > 0"},
     {"min", "max", "step"},
     false,
     discrete_cdf,
     discrete_quantile},
    {{"normal", "Gauss, may be cut at min and max", "", "std >= 0"},
     {"mean", "std"},
     true,
     normal_cdf,
     normal_quantile},
    {{"lognormal", "mean and std of the quantity itself, not of its logarithm", "",
      "mean > 0, std >= 0"},
     {"mean", "std"},
     true,
     lognormal_cdf,
     lognormal_quantile},
    {{"weibull", "1 - exp(-(x / scale)^shape)", "", "shape > 0, scale > 0"},
     {"shape", "scale"},
     true,
     weibull_cdf,
     weibull_quantile},
    {{"table", "values with their weights", "", "2 to 32 values"},
     {"values", "weights"},
     false,
     table_cdf,
     table_quantile},
};
const size_t ph_ndistributions = sizeof ph_distributions / sizeof *ph_distributions;
enum { CONSTANT, UNIFORM, DISCRETE, NORMAL, LOGNORMAL, WEIBULL, TABLE };

ph_distribution ph_distribution_constant(double x)
{
    return (ph_distribution){
        .kind = CONSTANT, .p = {x}, .min = -INFINITY, .max = INFINITY};
}

ph_status ph_distribution_check(const ph_distribution *d, ph_error *err)
{
    PH_GIVEN(d);
    ph_status st = PH_OK;
    const double *p = d->p;
    PH_CHECK(d->kind >= 0 && d->kind < (int)ph_ndistributions, PH_EINVAL,
             "no distribution is given");
    for (int i = 0; i < PH_DISTRIBUTION_KEYS; i++)
        PH_CHECK(isfinite(p[i]), PH_EUNPHYSICAL, "parameters must be finite");
    if (d->kind == UNIFORM || d->kind == DISCRETE)
        PH_CHECK(p[0] <= p[1], PH_EUNPHYSICAL,
                 "min (%g) must not be larger than max (%g)", p[0], p[1]);
    if (d->kind == DISCRETE)
        PH_CHECK(p[2] > 0, PH_EUNPHYSICAL, "step must be > 0, got %g", p[2]);
    if (d->kind == NORMAL || d->kind == LOGNORMAL)
        PH_CHECK(p[1] >= 0, PH_EUNPHYSICAL, "std must be >= 0, got %g", p[1]);
    if (d->kind == LOGNORMAL)
        PH_CHECK(p[0] > 0, PH_EUNPHYSICAL, "mean must be > 0, got %g", p[0]);
    if (d->kind == WEIBULL)
        PH_CHECK(p[0] > 0 && p[1] > 0, PH_EUNPHYSICAL, "shape and scale must be > 0");
    if (d->kind == TABLE)
        PH_CHECK(d->n >= 1 && d->n <= PH_TABLE_MAX, PH_EUNPHYSICAL,
                 "a table has 1 to %d values", PH_TABLE_MAX);
    const ph_distribution_kind *kind = &ph_distributions[d->kind];
    PH_CHECK(d->min <= d->max, PH_EUNPHYSICAL,
             "min (%g) must not be larger than max (%g)", d->min, d->max);
    double below = kind->cdf(d, nextafter(d->min, -INFINITY)), to = kind->cdf(d, d->max);
    PH_CHECK(!kind->truncates || to - below > 1e-12, PH_EUNPHYSICAL,
             "never gives a value from %g to %g", d->min, d->max);
out:
    return st;
}

double ph_distribution_cdf(const ph_distribution *d, double x)
{
    if (!d) return NAN;
    const ph_distribution_kind *kind = &ph_distributions[d->kind];
    if (!kind->truncates || (isinf(d->min) && isinf(d->max))) return kind->cdf(d, x);
    double a = kind->cdf(d, d->min), b = kind->cdf(d, d->max);
    if (x < d->min) return 0;
    if (x >= d->max) return 1;
    return b > a ? (kind->cdf(d, x) - a) / (b - a) : 1;
}

double ph_distribution_quantile(const ph_distribution *d, double u)
{
    if (!d) return NAN;
    const ph_distribution_kind *kind = &ph_distributions[d->kind];
    if (!kind->truncates || (isinf(d->min) && isinf(d->max))) return kind->quantile(d, u);
    double a = isinf(d->min) ? 0 : kind->cdf(d, d->min),
           b = isinf(d->max) ? 1 : kind->cdf(d, d->max), v = a + u * (b - a);
    if (v <= 0 || v >= 1) return fmin(fmax(d->p[0], d->min), d->max);
    return fmin(fmax(kind->quantile(d, v), d->min), d->max);
}

double ph_distribution_mean(const ph_distribution *d, double (*g)(double x))
{
    if (!d) return NAN;
    enum { POINTS = 512 };
    double sum = 0;
    for (int i = 0; i < POINTS; i++) {
        double x = ph_distribution_quantile(d, (i + 0.5) / POINTS);
        sum += g ? g(x) : x;
    }
    return sum / POINTS;
}

void ph_distribution_range(const ph_distribution *d, double *lo, double *hi)
{
    if (!d || !lo || !hi) return;
    *lo = d->min;
    *hi = d->max;
    switch (d->kind) {
    case CONSTANT:
        *lo = *hi = d->p[0];
        break;
    case UNIFORM:
    case DISCRETE:
        *lo = d->p[0];
        *hi = d->p[1];
        break;
    case TABLE:
        *lo = d->value[0];
        *hi = d->value[d->n - 1];
        break;
    case LOGNORMAL:
    case WEIBULL:
        *lo = fmax(*lo, 0);
        break;
    default:
        if (d->kind == NORMAL && !(d->p[1] > 0)) *lo = *hi = d->p[0];
        break;
    }
}

static uint64_t mix(uint64_t z)
{
    z += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

double ph_random_uniform(ph_random *r)
{
    if (!r) return NAN;
    uint64_t z = mix(mix(mix(mix(r->seed) ^ r->realisation) ^ r->object) ^ r->draw++);
    return ((double)(z >> 12) + 0.5) * 0x1p-52;
}

double ph_random_normal(ph_random *r)
{
    if (!r) return NAN;
    return gsl_cdf_ugaussian_Pinv(ph_random_uniform(r));
}
