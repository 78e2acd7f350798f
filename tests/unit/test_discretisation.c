/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a grid adds, from models that are linear in the spacing, and the total error of it and
 * of sampling. */
#include "check.h"
#include "synthetic_models.h"

static const double truth = 3.0;
static double slope = 0.02; /* what the grid of model 0 adds */

/* x_0 and x_1 on one grid (x_1 solved less accurately), x_2 with spacings twice as wide: the
 * slope itself differs from realisation to realisation. */
static void grids(uint64_t r, uint64_t k, int i, double *out)
{
    double z = synthetic_normal(r, k, 0), c = slope + 0.02 * synthetic_normal(r, k, 1);
    out[0] = truth + 0.1 * z + (i == 2 ? 2 * c : c);
    if (i == 1) out[0] += 0.005 * synthetic_normal(r, k, 2);
    if (i == 2) out[0] += 0.005 * synthetic_normal(r, k, 3);
}

static const synthetic three = {3, {1, 1, 1}, {1, 0.4, 0.1}, grids};
static const ph_grid_pair pair = {1, 2, 2};

static synthetic_run sample(uint64_t r, ptrdiff_t n)
{
    synthetic_run run;
    memset(&run, 0, sizeof run);
    for (int i = 0; i < 3; i++) {
        run.samples[i] = (ph_model_samples){.dimension = 1, .cost = three.cost[i]};
        synthetic_extend(&three, r, &run, i, n);
    }
    return run;
}

/* By hand: three pairs, ratio 3, one of a fourth failed. */
static void test_by_hand(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    const double fine[] = {1, 2, NAN, 4, 9}, coarse[] = {3, 6, 5, 10, 9};
    const ph_model_samples m[] = {{1, 5, fine, 1}, {1, 5, coarse, 1}};
    const ph_grid_pair thrice = {0, 1, 3};
    ph_discretisation b;
    CHECK_OK(ph_estimation_bias(&thrice, 0.95, 2, m, 4, 4, &b, &err));
    CHECK(b.n == 3 && b.dof == 2);
    CHECK_REL(b.estimate, 2.0, 1e-15);                 /* (2 + 4 + 6) / 3 / (3 - 1) */
    CHECK_REL(b.standard_error, 1 / sqrt(3.0), 1e-15); /* 2 / sqrt(3) / 2 */
    CHECK_REL(b.half_width, 4.302652729911275 * b.standard_error, 1e-9); /* t(2) */
    /* The fifth pair moves the mean, not the scatter. */
    CHECK_OK(ph_estimation_bias(&thrice, 0.95, 2, m, 4, 5, &b, &err));
    CHECK(b.n == 4 && b.dof == 2);
    CHECK_REL(b.estimate, 1.5, 1e-15);
    CHECK_REL(b.standard_error, 0.5, 1e-15);
    CHECK_END();
}

/* 95 % of the intervals hold the slope: 93 to 97 % of 1000. */
static void test_covers(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    int n = check_trials(1000), held = 0;
    uint64_t seed = check_seed() * 1000003;
    double sum = 0, variance = 0;
    for (int r = 0; r < n; r++) {
        synthetic_run run = sample(seed + (uint64_t)r, 12);
        ph_discretisation b;
        CHECK_OK(ph_estimation_bias(&pair, 0.95, 3, run.samples, 12, 12, &b, &err));
        held += fabs(b.estimate - slope) <= b.half_width;
        sum += b.estimate - slope;
        variance += b.standard_error * b.standard_error;
        synthetic_free(&run);
    }
    print_message("%.1f %% held\n", 100.0 * held / n);
    CHECK(fabs(sum / n) < 4 * sqrt(variance / n / n));
    CHECK(held > 0.93 * n && held < 0.97 * n);
    CHECK_END();
}

/* |mean - truth|, grid included, is within what was asked for in 93 % at least: |bias| and its
 * half-width are added in full, so that more than 95 % are no error. */
static void total_holds(const char *method, double s, double asked, double most)
{
    int n = check_trials(400), within = 0, reached = 0;
    uint64_t seed = check_seed() * 1000003;
    double cost = 0;
    slope = s;
    const ph_estimation_rule rule = {
        .method = method, .half_width = asked, .grid = pair, .total = true};
    for (int r = 0; r < n; r++) {
        ph_error err = PH_ERROR_INIT;
        synthetic_run run;
        CHECK_OK(
            synthetic_estimate(&three, &rule, seed + (uint64_t)r, r % 3, &run, &err));
        const ph_estimation *e = &run.e;
        double error =
            fabs(e->bias.estimate) + e->bias.half_width + e->estimate.half_width;
        within += fabs(e->estimate.mean - truth) <= asked;
        reached += e->reached;
        cost += e->estimate.cost;
        CHECK(!e->reached || error <= asked * (1 + 1e-9));
        CHECK(e->bias.n >= 12 && e->done && (e->reached || e->finer > 0));
        synthetic_free(&run);
    }
    print_message("%s, grid %g of %g: %.1f %% within, %d of %d reached, cost %.4g\n",
                  method, s, asked, 100.0 * within / n, reached, n, cost / n);
    slope = 0.02;
    CHECK(within >= 0.93 * n);
    CHECK(reached >= 0.99 * n);
    CHECK(cost / n < most);
}

/* Scatter of pairs 0.021, of the mean 0.1. With 0.02 of 0.04 left, plain takes
 * (1.96 0.102 / hs)^2 + 0.5 (1.96 0.021 / hb)^2 with hs + hb = 0.02: least, 208, at hb 0.0043.
 * What is left is estimated, and enters squared: up to half more. */
static void test_total(void **state)
{
    (void)state;
    total_holds("plain", 0.02, 0.04, 1.5 * 208);
    total_holds("auto", 0.02, 0.04, 150);
    total_holds("auto", 0.0, 0.03, 150);
    total_holds("multilevel", -0.02, 0.04, 300);
    CHECK_END();
}

/* More than is asked for comes from the grid: pilots only, and how much finer. */
static void test_grid_too_coarse(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    synthetic_run run;
    slope = 0.3;
    const ph_estimation_rule rule = {
        .half_width = 0.02, .relative = true, .grid = pair, .total = true};
    CHECK_OK(synthetic_estimate(&three, &rule, 5, 0, &run, &err));
    slope = 0.02;
    CHECK(run.e.done && !run.e.reached && run.e.want[0] == 12);
    CHECK_REL(run.e.finer, 2 * 0.3 / (0.02 * 3.3), 0.2);
    CHECK(strstr(run.e.reason, "the grid alone") && strstr(run.e.reason, "finer"));
    CHECK(run.e.estimate.half_width > 0 && fabs(run.e.estimate.mean - 3.3) < 0.2);
    synthetic_free(&run);
    CHECK_END();
}

/* What there is beyond the wants changes nothing. */
static void test_pure(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    synthetic_run a, b;
    const ph_estimation_rule rule = {.half_width = 0.04, .grid = pair, .total = true};
    CHECK_OK(synthetic_estimate(&three, &rule, 77, 0, &a, &err));
    CHECK_OK(synthetic_estimate(&three, &rule, 77, 1000, &b, &err));
    CHECK(memcmp(a.e.want, b.e.want, sizeof a.e.want) == 0);
    CHECK(a.e.estimate.mean == b.e.estimate.mean);
    CHECK(a.e.bias.estimate == b.e.bias.estimate);
    CHECK(a.e.bias.half_width == b.e.bias.half_width);
    synthetic_free(&a);
    synthetic_free(&b);
    CHECK_END();
}

/* A budget that is too small is spent, not exceeded, and that is said. */
static void test_budget(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    synthetic_run run;
    const ph_estimation_rule rule = {
        .half_width = 0.022, .grid = pair, .total = true, .budget = 60};
    CHECK_OK(synthetic_estimate(&three, &rule, 3, 0, &run, &err));
    CHECK(run.e.done && !run.e.reached && run.e.estimate.cost <= 60 * (1 + 1e-12));
    synthetic_free(&run);
    CHECK_END();
}

static void test_arguments(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    synthetic_run run = sample(1, 30);
    ph_discretisation b = {.estimate = 7, .n = 7};
    ph_estimation e;
    const ph_grid_pair wrong[] = {{0},        {1, 1, 2}, {2, 1, 2},   {1, 3, 2},
                                  {-1, 1, 2}, {1, 2, 1}, {1, 2, NAN}, {1, 2, INFINITY}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        const ph_estimation_rule rule = {
            .half_width = 0.1, .grid = wrong[i], .total = true};
        CHECK(ph_estimation_bias(&wrong[i], 0.95, 3, run.samples, 9, 9, &b, &err) ==
              PH_EINVAL);
        CHECK(b.estimate == 7 && b.n == 7); /* untouched */
        CHECK(ph_estimation_next(&rule, 3, run.samples, &e, &err) == PH_EINVAL);
    }
    const ph_estimation_rule no_width = {.budget = 100, .grid = pair, .total = true};
    CHECK(ph_estimation_next(&no_width, 3, run.samples, &e, &err) == PH_EINVAL);
    ph_status (*bias)(const ph_grid_pair *, double, int, const ph_model_samples *,
                      ptrdiff_t, ptrdiff_t, ph_discretisation *, ph_error *) =
        ph_estimation_bias;
    CHECK(bias(NULL, 0.95, 3, run.samples, 9, 9, &b, &err) == PH_EINVAL);
    CHECK(bias(&pair, 0.95, 3, NULL, 9, 9, &b, &err) == PH_EINVAL);
    CHECK(bias(&pair, 0.95, 3, run.samples, 9, 9, NULL, &err) == PH_EINVAL);
    CHECK(bias(&pair, 1, 3, run.samples, 9, 9, &b, &err) == PH_EINVAL);
    CHECK(bias(&pair, NAN, 3, run.samples, 9, 9, &b, &err) == PH_EINVAL);
    CHECK(bias(&pair, 0.95, 3, run.samples, 10, 9, &b, &err) == PH_EINVAL);
    CHECK(bias(&pair, 0.95, 3, run.samples, 9, 31, &b, &err) == PH_EINVAL);
    CHECK(bias(&pair, 0.95, 3, run.samples, -1, 9, &b, &err) == PH_EINVAL);
    CHECK(bias(&pair, 0.95, 3, run.samples, 1, 9, &b, &err) == PH_ESINGULAR);
    synthetic_free(&run);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_by_hand),   cmocka_unit_test(test_covers),
        cmocka_unit_test(test_total),     cmocka_unit_test(test_grid_too_coarse),
        cmocka_unit_test(test_pure),      cmocka_unit_test(test_budget),
        cmocka_unit_test(test_arguments),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
