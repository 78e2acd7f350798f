/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The estimators: allocation, arguments, order, budget, and cases with a known answer. */
#include "check.h"
#include "synthetic_models.h"

static void pair(uint64_t r, uint64_t k, int i, double *out)
{
    double x = synthetic_normal(r, k, 1);
    out[0] = i ? x : 2 + x + 0.1 * synthetic_normal(r, k, 0);
}

static const synthetic two = {2, {1, 1}, {1, 0.01}, pair};

static void allocation_is_the_formula(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    double V[] = {0.01, 0.2, 0.7}, c[] = {1, 0.2, 0.01}, one[] = {1, 1, 1}, n[3];
    double sum = 0, cost = 0, variance = 0;
    CHECK_OK(ph_estimation_allocate(3, V, c, one, 1e-3, n, &err));
    for (int l = 0; l < 3; l++) {
        sum += sqrt(V[l] * c[l]);
        cost += n[l] * c[l];
        variance += V[l] / n[l];
    }
    CHECK_REL(cost, sum * sum / 1e-3, 1e-12);
    CHECK_REL(variance, 1e-3, 1e-12);
    CHECK_REL(n[1], sqrt(0.2 / 0.2) * sum / 1e-3, 1e-12);
    CHECK_END();
}

/* With bounds: the variance is met, bounds hold, and no shift of cost between two levels
 * that are free is an improvement. */
static void bounds_of_the_allocation(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int trial = 0; trial < check_trials(2000); trial++) {
        ph_error err = PH_ERROR_INIT;
        int n = 1 + (int)(check_random(&seed) * 5);
        double V[5], c[5], least[5], out[5], sum = 0;
        for (int l = 0; l < n; l++) {
            V[l] = pow(10, check_uniform(&seed, -4, 1));
            c[l] = pow(10, check_uniform(&seed, -3, 1));
            least[l] = ceil(pow(10, check_uniform(&seed, 0, 3)));
        }
        double v = pow(10, check_uniform(&seed, -5, -1));
        CHECK_OK(ph_estimation_allocate(n, V, c, least, v, out, &err));
        for (int l = 0; l < n; l++) {
            sum += V[l] / out[l];
            CHECK(out[l] >= least[l] * (1 - 1e-12));
            CHECK(l == 0 || out[l] >= out[l - 1] * (1 - 1e-12));
        }
        CHECK(sum <= v * (1 + 1e-9));
    }
    CHECK_END();
}

static void plain_is_the_mean(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_estimation_rule rule = {.method = "plain", .budget = 50};
    synthetic_run run;
    CHECK_OK(synthetic_estimate(&two, &rule, 3, 0, &run, &err));
    const ph_mean_estimate *e = &run.e.estimate;
    double mean = 0, square = 0;
    CHECK(run.e.want[0] == 50 && run.e.want[1] == 0 && e->nlevels == 1);
    for (int k = 0; k < 50; k++)
        mean += run.value[0][k] / 50;
    int seen = (int)run.e.decided[0];
    double part = 0;
    for (int k = 0; k < seen; k++)
        part += run.value[0][k] / seen;
    for (int k = 0; k < seen; k++)
        square += pow(run.value[0][k] - part, 2) / (seen - 1);
    CHECK_REL(e->mean, mean, 1e-13);
    CHECK_REL(e->standard_error, sqrt(square / 50), 1e-12);
    CHECK_REL(e->dof, seen - 1, 1e-12);
    CHECK_REL(e->cost, 50, 1e-15);
    CHECK_REL(e->plain_cost, 50, 1e-12);
    /* t(0.975) of 24 degrees of freedom, from a table */
    if (seen == 25) CHECK_REL(e->half_width / e->standard_error, 2.0639, 1e-4);
    CHECK(seen == 25);
    synthetic_free(&run);
    CHECK_END();
}

/* x_0 = 7 + 3 x_1 exactly: all scatter is that of the cheap model. */
static void exact(uint64_t r, uint64_t k, int i, double *out)
{
    double x = synthetic_normal(r, k, 1);
    out[0] = i ? x : 7 + 3 * x;
}

static void an_exact_model_leaves_its_own_scatter(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    const synthetic s = {2, {1, 1}, {1, 0.01}, exact};
    ph_estimation_rule rule = {.half_width = 0.1};
    synthetic_run run;
    CHECK_OK(synthetic_estimate(&s, &rule, 5, 0, &run, &err));
    double mean = 0;
    for (ptrdiff_t k = 0; k < run.e.want[1]; k++)
        mean += run.value[1][k] / (double)run.e.want[1];
    CHECK(run.e.want[0] == 12); /* the pilots */
    CHECK(run.e.nlevels == 2 && run.e.method == 1);
    CHECK_REL(run.e.estimate.level[0].coefficient, 3, 1e-10);
    CHECK_REL(run.e.estimate.level[0].correlation, 1, 1e-10);
    CHECK(run.e.estimate.level[0].variance < 1e-20);
    /* Folds weigh alike though they are not of one size: 1 / n. */
    CHECK_ABS(run.e.estimate.mean, 7 + 3 * mean, 0.05 * run.e.estimate.half_width);
    synthetic_free(&run);
    CHECK_END();
}

static void same_bits_whatever_is_there(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_estimation_rule rule = {.half_width = 0.05};
    synthetic_run a, b;
    CHECK_OK(synthetic_estimate(&two, &rule, 11, 0, &a, &err));
    CHECK_OK(synthetic_estimate(&two, &rule, 11, 1234, &b, &err));
    CHECK(memcmp(&a.e, &b.e, sizeof a.e) == 0);
    CHECK(b.samples[0].n > a.samples[0].n);
    ph_mean_estimate again;
    CHECK_OK(ph_estimation_mean(&b.e, 0.95, 2, b.samples, &again, &err));
    CHECK(again.mean == a.e.estimate.mean && again.half_width == a.e.estimate.half_width);
    synthetic_free(&a);
    synthetic_free(&b);
    CHECK_END();
}

static void the_budget_holds(void **state)
{
    (void)state;
    for (int i = 0; i < 20; i++) {
        ph_error err = PH_ERROR_INIT;
        double budget = 13 + 3 * i;
        ph_estimation_rule rule = {.budget = budget, .half_width = i % 2 ? 1e-3 : 0};
        synthetic_run run;
        CHECK_OK(synthetic_estimate(&two, &rule, (uint64_t)i, 0, &run, &err));
        CHECK(run.e.done && !run.e.reached);
        CHECK(run.e.estimate.cost <= budget * (1 + 1e-12));
        CHECK(run.e.estimate.cost > 0.9 * budget);
        CHECK(strstr(run.e.reason, "budget"));
        synthetic_free(&run);
    }
    CHECK_END();
}

static void constant(uint64_t r, uint64_t k, int i, double *out)
{
    (void)r, (void)k;
    out[0] = 4 + i;
}

static void realisations_that_do_not_differ(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    const synthetic s = {2, {1, 1}, {1, 0.1}, constant};
    ph_estimation_rule rule = {.half_width = 0.01, .relative = true};
    synthetic_run run;
    CHECK_OK(synthetic_estimate(&s, &rule, 1, 0, &run, &err));
    CHECK(run.e.done && run.e.reached && run.e.want[0] == 12);
    CHECK(run.e.estimate.mean == 4 && run.e.estimate.half_width == 0);
    synthetic_free(&run);
    /* a budget to spend on no scatter: no chain is better than plain (0 / 0) */
    rule = (ph_estimation_rule){.budget = 40};
    CHECK_OK(synthetic_estimate(&s, &rule, 1, 0, &run, &err));
    CHECK(run.e.done && run.e.method == 0 && run.e.nlevels == 1);
    CHECK(run.e.estimate.mean == 4 && run.e.estimate.half_width == 0);
    synthetic_free(&run);
    CHECK_END();
}

static void nothing(uint64_t r, uint64_t k, int i, double *out)
{
    pair(r, k, i, out);
    if (k != 3) out[0] = NAN;
}

static void too_few_that_did_not_fail(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    const synthetic s = {2, {1, 1}, {1, 0.1}, nothing};
    ph_estimation_rule rule = {.half_width = 0.01};
    synthetic_run run;
    CHECK(synthetic_estimate(&s, &rule, 1, 0, &run, &err) == PH_ESINGULAR);
    CHECK(strstr(err.msg, "did not fail"));
    synthetic_free(&run);
    CHECK_END();
}

#define REFUSED(what, rule, n, models, text)                                             \
    do {                                                                                 \
        ph_error err = PH_ERROR_INIT;                                                    \
        ph_estimation e;                                                                 \
        CHECK(ph_estimation_next(rule, n, models, &e, &err) == PH_EINVAL);               \
        if (!strstr(err.msg, text)) print_error("%s: %s\n", what, err.msg);              \
        CHECK(strstr(err.msg, text));                                                    \
    } while (0)

static void wrong_arguments(void **state)
{
    (void)state;
    ph_estimation_rule ok = {.half_width = 0.1}, r;
    ph_model_samples m[2] = {{1, 0, NULL, 1}, {1, 0, NULL, 0.1}}, w[2];
    double bad[] = {NAN, -1, INFINITY};
    REFUSED("no rule", NULL, 2, m, "without a rule");
    REFUSED("no models", &ok, 0, m, "1 to 8 models");
    REFUSED("many models", &ok, 9, m, "1 to 8 models");
    REFUSED("NULL", &ok, 2, NULL, "1 to 8 models");
    for (int i = 0; i < 3; i++) {
        r = ok, r.half_width = bad[i];
        REFUSED("half-width", &r, 2, m, "half-width");
        r = ok, r.budget = bad[i];
        REFUSED("budget", &r, 2, m, "budget");
        memcpy(w, m, sizeof w), w[1].cost = bad[i];
        REFUSED("cost", &ok, 2, w, "cost");
    }
    r = (ph_estimation_rule){0};
    REFUSED("nothing wanted", &r, 2, m, "one of them must be > 0");
    r = ok, r.confidence = 1;
    REFUSED("confidence", &r, 2, m, "confidence");
    r = ok, r.confidence = NAN;
    REFUSED("confidence", &r, 2, m, "confidence");
    r = ok, r.pilot = 3;
    REFUSED("pilot", &r, 2, m, "pilot");
    r = ok, r.method = "magic";
    REFUSED("method", &r, 2, m, "unknown estimator 'magic'");
    r = ok, r.budget = 5;
    REFUSED("budget", &r, 2, m, "pilots alone");
    memcpy(w, m, sizeof w), w[0].dimension = 2;
    REFUSED("dimension", &ok, 2, w, "model 0 has 1 to 1");
    memcpy(w, m, sizeof w), w[1].dimension = 17;
    REFUSED("dimension", &ok, 2, w, "model 1 has 1 to 16");
    memcpy(w, m, sizeof w), w[1].n = 4;
    REFUSED("no values", &ok, 2, w, "4 realisations");
    ph_error err = PH_ERROR_INIT;
    double V = 1, c = 1, least = 0, n;
    CHECK(ph_estimation_allocate(1, &V, &c, &least, 1, &n, &err) == PH_EINVAL);
    least = 1;
    CHECK(ph_estimation_allocate(1, &V, &c, &least, NAN, &n, &err) == PH_EINVAL);
    CHECK(ph_estimation_allocate(9, &V, &c, &least, 1, &n, &err) == PH_EINVAL);
    ph_estimation e = {.method = -1};
    ph_mean_estimate mean;
    CHECK(ph_estimation_mean(&e, 0.95, 2, m, &mean, &err) == PH_EINVAL);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(allocation_is_the_formula),
        cmocka_unit_test(bounds_of_the_allocation),
        cmocka_unit_test(plain_is_the_mean),
        cmocka_unit_test(an_exact_model_leaves_its_own_scatter),
        cmocka_unit_test(same_bits_whatever_is_there),
        cmocka_unit_test(the_budget_holds),
        cmocka_unit_test(realisations_that_do_not_differ),
        cmocka_unit_test(too_few_that_did_not_fail),
        cmocka_unit_test(wrong_arguments),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
