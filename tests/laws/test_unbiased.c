/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Means by cheaper models over many repetitions: the mean of the means is the true one, and
 * the 95 % intervals hold it in 93 to 97 %. */
#include "check.h"
#include "synthetic_models.h"

static const double truth = 3.0;

/* A chain like that of a solver: each model the one before seen less sharply. */
static void chain(uint64_t r, uint64_t k, int i, double *out)
{
    double z = 0.96 * synthetic_normal(r, k, 2), y = 0;
    if (i < 2) y = z + 0.22 * synthetic_normal(r, k, 1);
    if (i == 0) out[0] = truth + y + 0.17 * synthetic_normal(r, k, 0);
    if (i == 1) out[0] = 5.0 + 1.3 * y;
    if (i == 2) out[0] = -1.0 + 0.4 * z;
}

/* Skewed: exp of a normal, mean 3; the cheap model is its logarithm, and then three numbers
 * of which one is useless. */
static void skewed(uint64_t r, uint64_t k, int i, double *out)
{
    double z = synthetic_normal(r, k, 0), s = 0.5;
    double x = truth * exp(s * z - 0.5 * s * s);
    if (i == 0) out[0] = x;
    if (i == 1) out[0] = z + 0.2 * synthetic_normal(r, k, 1);
    if (i == 2) {
        out[0] = z + 0.5 * synthetic_normal(r, k, 2);
        out[1] = z * z;
        out[2] = synthetic_normal(r, k, 3);
    }
}

static void unrelated(uint64_t r, uint64_t k, int i, double *out)
{
    out[0] = (i ? 0 : truth) + synthetic_normal(r, k, (uint64_t)i);
}

/* One realisation in ten fails on every model, one in fifty on the finest only. */
static void failing(uint64_t r, uint64_t k, int i, double *out)
{
    ph_random q = {r, k, 77, 0};
    double u = ph_random_uniform(&q);
    chain(r, k, i, out);
    if (u < 0.1 || (i == 0 && u < 0.12)) out[0] = NAN;
}

static const synthetic cases[] = {
    {3, {1, 1, 1}, {1, 0.3, 0.02}, chain},
    {3, {1, 1, 3}, {1, 0.1, 0.01}, skewed},
    {2, {1, 1}, {1, 0.1}, unrelated},
    {3, {1, 1, 1}, {1, 0.3, 0.02}, failing},
};

typedef struct tally {
    int n, covered, reached;
    double sum, squares, variance, cost, plain;
} tally;

static tally repeat(const synthetic *s, const ph_estimation_rule *rule, uint64_t seed,
                    int n)
{
    tally t = {.n = n};
    for (int r = 0; r < n; r++) {
        ph_error err = PH_ERROR_INIT;
        synthetic_run run;
        CHECK_OK(
            synthetic_estimate(s, rule, seed * 1000003 + (uint64_t)r, 0, &run, &err));
        double off = run.e.estimate.mean - truth;
        t.sum += off;
        t.squares += off * off;
        t.variance += run.e.estimate.standard_error * run.e.estimate.standard_error;
        t.covered += fabs(off) <= run.e.estimate.half_width;
        t.reached += run.e.reached;
        t.cost += run.e.estimate.cost;
        t.plain += run.e.estimate.plain_cost;
        synthetic_free(&run);
    }
    return t;
}

/* |mean of the means - truth| within 4 of its standard errors; intervals as they say: 93 to
 * 97 % of them, where the noise of 1000 repetitions is 0.7 %. */
static void honest(const synthetic *s, const ph_estimation_rule *rule, tally *t)
{
    int n = check_trials(1000);
    *t = repeat(s, rule, check_seed(), n);
    double bias = t->sum / n, error = sqrt((t->squares / n - bias * bias) / n);
    double covered = (double)t->covered / n;
    print_message("%s h %g: off by %.1f standard errors, %.1f %% covered, cost %.4g of "
                  "plain's %.4g\n",
                  rule->method, rule->half_width, bias / error, 100 * covered,
                  t->cost / n, t->plain / n);
    CHECK(fabs(bias) < 4 * error);
    CHECK(covered > 0.93 && covered < 0.97);
    CHECK(t->reached == n);
}

/* Theory: (sum sqrt(V c))^2 / v = 109 for h = 0.08 (V 0.17^2, 0.22^2, 0.96^2). Student's t
 * instead of 1.96 and pilots of models that are then not used cost some per cent more. */
static void a_chain_of_models(void **state)
{
    (void)state;
    tally t;
    ph_estimation_rule rule = {.method = "auto", .half_width = 0.08};
    double v = (0.08 / 1.959964) * (0.08 / 1.959964);
    double root = 0.17 + 0.22 * sqrt(0.3) + 0.96 * sqrt(0.02), theory = root * root / v;
    honest(&cases[0], &rule, &t);
    CHECK(t.cost / t.n < 1.12 * theory);
    CHECK(t.cost / t.n > 0.95 * theory);
    CHECK_REL(t.plain / t.n, 1 / v, 0.1); /* t of 40 degrees, squared: 6 % more */
    CHECK_END();
}

static void few_realisations(void **state)
{
    (void)state;
    tally t;
    ph_estimation_rule rule = {.method = "control_variate", .half_width = 0.2};
    honest(&cases[0], &rule, &t);
    CHECK(4 * t.cost < t.plain);
    CHECK_END();
}

static void differences_as_they_are(void **state)
{
    (void)state;
    tally t;
    ph_estimation_rule rule = {.method = "multilevel", .half_width = 0.1};
    honest(&cases[0], &rule, &t);
    CHECK(t.cost < t.plain);
    CHECK_END();
}

/* No correlation: the plain mean, at the price of the pilots. */
static void models_that_do_not_help(void **state)
{
    (void)state;
    tally t;
    ph_estimation_rule rule = {.method = "auto", .half_width = 0.2};
    honest(&cases[2], &rule, &t);
    CHECK(t.cost < 1.1 * t.plain);
    CHECK_END();
}

static void realisations_that_fail(void **state)
{
    (void)state;
    tally t;
    ph_estimation_rule rule = {.method = "auto", .half_width = 0.2};
    honest(&cases[3], &rule, &t);
    CHECK_END();
}

/* Numbers fixed beforehand: no bias whatever the distribution. Skewed residuals of a fit that
 * sees only 8 of them; 4 standard errors of 5000 repetitions are 0.6 % of the mean. */
static void fixed_numbers_have_no_bias(void **state)
{
    (void)state;
    int n = check_trials(5000);
    double sum = 0, squares = 0;
    uint64_t seed = check_seed() * 1000003;
    for (int r = 0; r < n; r++) {
        ph_error err = PH_ERROR_INIT;
        synthetic_run run = {.e = {.method = 1, .nlevels = 3, .model = {0, 1, 2}}};
        ph_mean_estimate out;
        for (int i = 0; i < 3; i++) {
            static const ptrdiff_t counts[] = {9, 17, 70};
            run.samples[i] = (ph_model_samples){.dimension = cases[1].dimension[i],
                                                .cost = cases[1].cost[i]};
            run.e.want[i] = run.e.decided[i] = run.e.estimate.level[i].n = counts[i];
            synthetic_extend(&cases[1], seed + (uint64_t)r, &run, i, counts[i]);
        }
        CHECK_OK(ph_estimation_mean(&run.e, 0.95, 3, run.samples, &out, &err));
        sum += out.mean - truth;
        squares += (out.mean - truth) * (out.mean - truth);
        synthetic_free(&run);
    }
    double bias = sum / n, error = sqrt((squares / n - bias * bias) / n);
    print_message("off by %.1f standard errors\n", bias / error);
    CHECK(fabs(bias) < 4 * error);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_chain_of_models),
        cmocka_unit_test(few_realisations),
        cmocka_unit_test(differences_as_they_are),
        cmocka_unit_test(models_that_do_not_help),
        cmocka_unit_test(realisations_that_fail),
        cmocka_unit_test(fixed_numbers_have_no_bias),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
