/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Samples of each distribution against its own formula, with fixed seeds. */
#include <perihom.h>

#include "check.h"

enum { SAMPLES = 20000 };

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void sample(const ph_distribution *d, uint64_t seed, double *x)
{
    ph_random r = {seed, 0, 0, 0};
    for (int i = 0; i < SAMPLES; i++) {
        r.object = (uint64_t)i; /* as fillers draw: one number each */
        r.draw = 3;
        x[i] = ph_distribution_quantile(d, ph_random_uniform(&r));
    }
    qsort(x, SAMPLES, sizeof *x, ascending);
}

/* Kolmogorov and Smirnov: sup |F_n - F| sqrt(n) is above 1.95 once in a thousand samples.
 * F comes from the formula here, not from the catalogue. */
static void check_ks(const ph_distribution *d,
                     double (*F)(const ph_distribution *, double))
{
    static double x[SAMPLES];
    double worst = 0;
    sample(d, 11, x);
    for (int i = 0; i < SAMPLES; i++) {
        double f = F(d, x[i]);
        worst = fmax(worst, fmax((i + 1.0) / SAMPLES - f, f - (double)i / SAMPLES));
        CHECK_ABS(ph_distribution_cdf(d, x[i]), f, 1e-9);
    }
    if (worst * sqrt(SAMPLES) >= 1.95)
        print_error("%s\n", ph_distributions[d->kind].info.name);
    CHECK(worst * sqrt(SAMPLES) < 1.95);
}

static double phi(double z)
{
    return 0.5 * erfc(-z / sqrt(2.0));
}
static double uniform(const ph_distribution *d, double x)
{
    return (x - d->p[0]) / (d->p[1] - d->p[0]);
}
static double normal(const ph_distribution *d, double x)
{
    return phi((x - d->p[0]) / d->p[1]);
}
static double truncated(const ph_distribution *d, double x)
{
    double a = normal(d, d->min), b = normal(d, d->max);
    return (normal(d, x) - a) / (b - a);
}
static double lognormal(const ph_distribution *d, double x)
{
    double s2 = log(1 + d->p[1] * d->p[1] / d->p[0] / d->p[0]);
    return phi((log(x) - log(d->p[0]) + s2 / 2) / sqrt(s2));
}
static double weibull(const ph_distribution *d, double x)
{
    return 1 - exp(-pow(x / d->p[1], d->p[0]));
}

static ph_distribution make(const char *name, double a, double b, double c)
{
    ph_distribution d = {.p = {a, b, c}, .min = -INFINITY, .max = INFINITY};
    for (size_t i = 0; i < ph_ndistributions; i++)
        if (strcmp(ph_distributions[i].info.name, name) == 0) d.kind = (int)i;
    return d;
}

static void test_continuous(void **state)
{
    (void)state;
    ph_distribution d = make("uniform", -1, 3, 0);
    check_ks(&d, uniform);
    d = make("normal", 300, 60, 0);
    check_ks(&d, normal);
    d.min = 250;
    d.max = 420;
    check_ks(&d, truncated);
    d = make("lognormal", 10, 4, 0);
    check_ks(&d, lognormal);
    d = make("weibull", 1.7, 25, 0);
    check_ks(&d, weibull);
    CHECK_END();
}

/* Chi square of k values: above k - 1 + 4 sqrt(2 (k - 1)) + 10 less than once in 1e4. */
static void check_chi2(const ph_distribution *d, const double *value, const double *share,
                       int k)
{
    static double x[SAMPLES];
    double chi2 = 0, all = 0;
    sample(d, 5, x);
    for (int j = 0; j < k; j++) {
        double n = 0, want = share[j] * SAMPLES;
        for (int i = 0; i < SAMPLES; i++)
            n += fabs(x[i] - value[j]) < 1e-9;
        chi2 += (n - want) * (n - want) / want;
        all += n;
    }
    CHECK(all == SAMPLES);
    CHECK(chi2 < k - 1 + 4 * sqrt(2.0 * (k - 1)) + 10);
}

static void test_discrete(void **state)
{
    (void)state;
    const double value[] = {0, 15, 30, 45, 60, 75, 90},
                 seventh[] = {1 / 7., 1 / 7., 1 / 7., 1 / 7., 1 / 7., 1 / 7., 1 / 7.};
    ph_distribution d = make("discrete_uniform", 0, 90, 15);
    check_chi2(&d, value, seventh, 7);
    d = make("table", 0, 0, 0);
    d.n = 3;
    const double v[] = {1, 2.5, 7}, w[] = {0.2, 0.5, 0.3};
    memcpy(d.value, v, sizeof v);
    memcpy(d.weight, w, sizeof w);
    check_chi2(&d, v, w, 3);
    d = ph_distribution_constant(4);
    const double four = 4, one = 1;
    check_chi2(&d, &four, &one, 1);
    CHECK_END();
}

static void test_mean_and_range(void **state)
{
    (void)state;
    double lo, hi;
    ph_distribution d = make("lognormal", 10, 4, 0);
    /* 512 midpoints in u leave out tails of mass 1e-3: some 1e-3 of the mean */
    CHECK_REL(ph_distribution_mean(&d, NULL), 10, 2e-3);
    ph_distribution_range(&d, &lo, &hi);
    CHECK(lo == 0 && isinf(hi));
    d = make("uniform", 2, 6, 0);
    CHECK_REL(ph_distribution_mean(&d, NULL), 4, 1e-12);
    CHECK_END();
}

/* Neighbouring seeds, realisations, objects and draws share nothing: correlations of 2e4
 * pairs stay below 4 / sqrt(2e4). Numbers are what they were when this was written. */
static void test_counters(void **state)
{
    (void)state;
    for (int which = 0; which < 4; which++) {
        double sum = 0;
        for (uint64_t i = 0; i < SAMPLES; i++) {
            ph_random a = {1, 2, i, 7}, b = a;
            uint64_t *counter[4] = {&b.seed, &b.realisation, &b.object, &b.draw};
            ++*counter[which];
            sum += (ph_random_uniform(&a) - 0.5) * (ph_random_uniform(&b) - 0.5) * 12;
        }
        CHECK(fabs(sum / SAMPLES) < 4 / sqrt(SAMPLES));
    }
    ph_random r = {1, 0, 0, 0}, again = r;
    double first = ph_random_uniform(&r), second = ph_random_uniform(&r);
    CHECK(first != second && ph_random_uniform(&again) == first);
    CHECK(first > 0 && first < 1);
    CHECK_END();
}

static void test_errors(void **state)
{
    (void)state;
    ph_distribution bad[] = {make("uniform", 3, 1, 0),
                             make("discrete_uniform", 0, 1, 0),
                             make("normal", 0, -1, 0),
                             make("lognormal", -1, 1, 0),
                             make("weibull", 0, 1, 0),
                             make("table", 0, 0, 0),
                             make("normal", NAN, 1, 0),
                             make("normal", 0, 1, 0),
                             {.kind = -1}};
    bad[7].min = 100; /* 100 standard deviations away: never */
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        ph_error err = PH_ERROR_INIT;
        CHECK(ph_distribution_check(&bad[i], &err) != PH_OK);
        CHECK(err.msg[0] != 0);
    }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_continuous),     cmocka_unit_test(test_discrete),
        cmocka_unit_test(test_mean_and_range), cmocka_unit_test(test_counters),
        cmocka_unit_test(test_errors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
