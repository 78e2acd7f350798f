/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An error parted between size, grid and number, where bias and scatter are known. */
#include "check.h"
#include "split_model.h"

#include <gsl/gsl_cdf.h>

static ph_split_answer *choose(const ph_split_question *q)
{
    ph_error err = PH_ERROR_INIT;
    ph_split_answer *a = NULL;
    CHECK_OK(ph_split_choose(q, &a, &err));
    if (!a) fail();
    return a;
}

/* By hand: edges 1 and 2 of a line, bias a / f. Weights 1 and 2, X = 1 and 1/2, mean X 2/3:
 * c = (1/3, -1/3) / (1/9 + 1/18) = (2, -2), a_i = 2 (x_i(1) - x_i(2)). */
static void test_by_hand(void **state)
{
    (void)state;
    const double factor[] = {1, 2}, cost[] = {1, 2}, zero = 0, one = 1;
    const double value[] = {11, 12, 13, NAN, 12, 10, 10, 11, 9, 10};
    const ph_split_question q = {.dimensions = 1,
                                 .exponent = 1,
                                 .accuracy = 50,
                                 .absolute = true,
                                 .confidence = 0.95,
                                 .least = 5,
                                 .most = 1000,
                                 .npoints = 1,
                                 .nsizes = 2,
                                 .factor = factor,
                                 .n = 5,
                                 .value = value,
                                 .cost = cost,
                                 .ngrids = 1,
                                 .grid_error = &zero,
                                 .grid_cost = &one};
    ph_split_answer *a = choose(&q);
    /* slopes 2, 4, 4, 4 of the realisations that are there at both: mean 3.5, deviation 1 */
    const double t = 3.182446305284263; /* Student's, 3 degrees of freedom */
    CHECK_REL(a->point[0].bias, 3.5, 1e-14);
    CHECK_REL(a->point[1].bias, 1.75, 1e-14);
    CHECK_REL(a->point[0].bias_half_width, t * 0.5, 1e-9);
    CHECK_REL(a->point[1].bias_half_width, t * 0.25, 1e-9);
    CHECK(a->point[0].n == 4 && a->point[1].n == 5);
    CHECK_REL(a->point[0].mean, 12, 1e-15);
    CHECK_REL(a->point[1].mean, 10, 1e-15);
    /* variances 2/3 and 1/2, times volumes 2/3 and 1: one of (3 2/3 + 4 1) / 7 */
    CHECK(a->one_scatter);
    CHECK_REL(a->point[0].scatter, sqrt(6.0 / 7), 1e-14);
    CHECK_REL(a->point[1].scatter, sqrt(3.0 / 7), 1e-14);
    CHECK(a->pilot_cost == 15 && a->step == PH_SPLIT_CHOSEN && a->chosen == 1);
    ph_split_answer_free(&a);
    CHECK(a == NULL);
    ph_split_answer_free(&a);
    CHECK_END();
}

/* The least number that meets the inequality of ph_split_choose, one by one. */
static double needed(const ph_split_size *s, double accuracy, double grid, double least)
{
    double scale = fabs(s->mean);
    for (double n = least; n < 1e4; n++) {
        double h = gsl_cdf_tdist_Pinv(0.975, n - 1) * s->scatter / sqrt(n);
        if (fabs(s->bias) + hypot(s->bias_half_width, h) <= (accuracy - grid) * scale)
            return n;
    }
    return INFINITY;
}

/* Bias ~ edge^-2, variance ~ 1 / area, work ~ area: the choice is the cheapest of all sizes and
 * grids, found by trying all numbers. */
static void test_optimum(void **state)
{
    (void)state;
    const double grid_error[] = {0.004, 0.008, 0.002}, grid_cost[] = {1, 0.25, 4};
    const double bias[] = {0, 0.001, 0.004, -0.004}, accuracy[] = {0.012, 0.02, 0.05};
    int chosen[SPLIT_SIZES] = {0}, coarse = 0;
    for (int b = 0; b < 4; b++)
        for (int t = 0; t < 3; t++) {
            const split_model m = {2, 2, bias[b], 0.03, 0.3};
            ph_split_question q =
                split_ask(&m, (uint64_t)(10 * b + t), accuracy[t], SPLIT_SIZES, 320);
            double least = INFINITY;
            int best = -1;
            q.ngrids = 3;
            q.grid_error = grid_error;
            q.grid_cost = grid_cost;
            ph_split_answer *a = choose(&q);
            for (int i = 0; i < a->ncandidates; i++) {
                const ph_split_candidate *c = &a->candidate[i];
                CHECK(c->size == i / 3 && c->grid == i % 3);
                double there = c->grid ? 0 : 320,
                       n = needed(&a->point[c->size], accuracy[t], grid_error[c->grid],
                                  fmax(20, there)),
                       work = (n - there) * q.cost[c->size] * grid_cost[c->grid];
                CHECK(c->meets == isfinite(n));
                /* the fixed point and the first success differ by one at most */
                if (c->meets) CHECK(fabs(c->needed - n) <= 1);
                if (c->meets) CHECK(c->error <= accuracy[t] * (1 + 1e-12));
                if (work < least) least = work;
            }
            for (int i = 0; i < a->ncandidates; i++)
                if (a->candidate[i].meets && a->candidate[i].to_go <= least + 4) best = i;
            CHECK((a->chosen >= 0) == isfinite(least));
            if (a->chosen >= 0) {
                const ph_split_candidate *c = &a->candidate[a->chosen];
                CHECK(best >= 0 && c->to_go <= least + 4); /* a realisation more */
                chosen[c->size]++;
                coarse += c->grid;
            }
            ph_split_answer_free(&a);
            split_clear(&q);
        }
    CHECK(chosen[SPLIT_SIZES - 1] > 0 &&
          coarse == 0); /* pilots that are there are free */
    CHECK_END();
}

static ph_split_step step_of(const split_model *m, double accuracy, int sizes,
                             int64_t pilots, double *factor_needed)
{
    ph_split_question q = split_ask(m, 3, accuracy, sizes, pilots);
    ph_split_answer *a = choose(&q);
    ph_split_step step = a->step;
    CHECK((step == PH_SPLIT_CHOSEN) <= (a->chosen >= 0));
    *factor_needed = a->factor_needed;
    ph_split_answer_free(&a);
    split_clear(&q);
    return step;
}

static void test_steps(void **state)
{
    (void)state;
    double factor;
    const split_model flat = {2, 2, 0, 0.01, 0}, biased = {2, 2, 0.04, 0.002, 0},
                      quiet = {2, 2, 0.001, 0, 0}, rough = {2, 2, 0, 0.05, 0};
    /* wide enough for two sizes */
    CHECK(step_of(&flat, 0.1, 2, 20, &factor) == PH_SPLIT_CHOSEN && factor == 0);
    /* nothing random: the bias is seen exactly */
    CHECK(step_of(&quiet, 0.01, 2, 20, &factor) == PH_SPLIT_CHOSEN);
    /* a bias of 4 % at the case's edge needs a larger one for 2 % */
    CHECK(step_of(&biased, 0.02, 2, 20, &factor) == PH_SPLIT_LARGER && factor > 1);
    /* hopeless by the law, but the case's own edge is tried, and larger ones are not */
    CHECK(step_of(&biased, 0.001, 2, 20, &factor) == PH_SPLIT_LARGER);
    CHECK(step_of(&biased, 0.001, 3, 20, &factor) == PH_SPLIT_NONE);
    /* 1 % at twice the edge: 0.8 % is out of reach, half of it takes 3.2 times the edge */
    CHECK(step_of(&biased, 0.008, SPLIT_SIZES, 20, &factor) == PH_SPLIT_NONE);
    CHECK_REL(factor, sqrt(0.04 / 0.004), 0.1); /* the bias is known to 7 % */
    /* no larger one: only more pilots tell a bias of zero from one that matters */
    CHECK(step_of(&rough, 0.005, SPLIT_SIZES, 4, &factor) == PH_SPLIT_MORE);
    CHECK_END();
}

/* Scatter that does not go with the volume is seen, and then each size has its own. */
static void test_scatter(void **state)
{
    (void)state;
    const split_model m = {2, 2, 0, 0.01, 0};
    ph_split_question q = split_ask(&m, 1, 0.05, 3, 40);
    double *value = (double *)(uintptr_t)q.value;
    for (int i = 0; i < 40; i++)
        value[i] = 1 + 6 * (value[i] - 1);
    ph_split_answer *a = choose(&q);
    CHECK(!a->one_scatter);
    for (int k = 0; k < 3; k++)
        CHECK(a->point[k].scatter == a->point[k].deviation);
    ph_split_answer_free(&a);
    split_clear(&q);
    CHECK_END();
}

/* Points share size and half width; the worst of them is reckoned with. */
static void test_points(void **state)
{
    (void)state;
    const split_model good = {2, 2, 0, 0.01, 0}, bad = {2, 2, 0.01, 0.02, 0};
    ph_split_question a = split_ask(&good, 1, 0.2, 2, 20),
                      b = split_ask(&bad, 2, 0.2, 2, 20), both = b;
    double value[80], cost[4] = {0.25, 0.5, 0.5, 0.5};
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < 20; i++) {
            value[40 * k + i] = a.value[20 * k + i];
            value[40 * k + 20 + i] = -3 * b.value[20 * k + i];
        }
    both.npoints = 2;
    both.value = value;
    both.cost = cost;
    ph_split_answer *one = choose(&b), *two = choose(&both);
    for (int k = 0; k < 2; k++) {
        CHECK(two->candidate[k].point == 1 && two->candidate[k].meets);
        CHECK_REL(two->candidate[k].half_width, one->candidate[k].half_width, 1e-12);
        CHECK_REL(two->candidate[k].needed, 20 + one->candidate[k].needed, 1e-12);
    }
    ph_split_answer_free(&one);
    ph_split_answer_free(&two);
    split_clear(&a);
    split_clear(&b);
    CHECK_END();
}

static void test_afforded(void **state)
{
    (void)state;
    const split_model m = {2, 2, 0.002, 0.05, 0};
    ph_split_question q = split_ask(&m, 5, 0.006, SPLIT_SIZES, 40);
    ph_split_answer *a = choose(&q);
    CHECK(a->chosen >= 0);
    double cost = a->candidate[a->chosen].to_go, last = INFINITY;
    CHECK(cost > 0 && ph_split_afforded(&q, a, cost) <= q.accuracy);
    for (double share = 0; share <= 2; share += 0.125) {
        double now = ph_split_afforded(&q, a, share * cost);
        CHECK(now <= last && now > 0);
        last = now;
    }
    CHECK(isnan(ph_split_afforded(&q, a, -1)) && isnan(ph_split_afforded(&q, NULL, 1)));
    ph_split_answer_free(&a);
    split_clear(&q);
    CHECK_END();
}

static void test_what_is_refused(void **state)
{
    (void)state;
    const split_model m = {2, 2, 0, 0.01, 0};
    const ph_split_question good = split_ask(&m, 1, 0.05, 2, 20);
    const double falling[] = {1, 0.5, 1, 1, 1}, no_cost[] = {0, 1}, nan_grid = NAN;
    ph_split_question q[12];
    ph_split_answer *a = NULL;
    for (int i = 0; i < 12; i++)
        q[i] = good;
    q[0].nsizes = 1;
    q[1].nmore = PH_SPLIT_SIZES;
    q[2].accuracy = NAN;
    q[3].n = 3;
    q[4].most = 19;
    q[5].factor = falling;
    q[6].cost = no_cost;
    q[7].grid_error = &nan_grid;
    q[8].value = NULL;
    q[9].confidence = 1;
    q[10].exponent = 0;
    q[11].ngrids = 0;
    for (int i = 0; i < 12; i++)
        CHECK(ph_split_choose(&q[i], &a, NULL) == PH_EINVAL && !a);
    CHECK(ph_split_choose(NULL, &a, NULL) == PH_EINVAL);
    /* too few that did not fail; a mean of zero */
    double *value = (double *)(uintptr_t)good.value;
    for (int i = 0; i < 40; i++)
        value[i] = i % 20 < 3 || i >= 20 ? value[i] : (double)NAN;
    CHECK(ph_split_choose(&good, &a, NULL) == PH_ESINGULAR && !a);
    for (int i = 0; i < 40; i++)
        value[i] = 0;
    CHECK(ph_split_choose(&good, &a, NULL) == PH_ESINGULAR && !a);
    split_clear((ph_split_question *)(uintptr_t)&good);
    CHECK_END();
}

/* Whole campaigns: the mean is within the accuracy of that of infinitely large cells in 95 % of
 * them and more (tests/verify/split_table.c, docs/theory/sampling.md). Of 60 three below 95 %
 * are not unlikely: at most 6 outside. */
static void test_covers(void **state)
{
    (void)state;
    const split_model m[] = {{2, 2, 0.005, 0.02, 0.5}, {3, 3, 0.002, 0.02, 0}};
    const double accuracy[] = {0.02, 0.015};
    uint64_t seed = check_seed() * 1009;
    for (int k = 0; k < 2; k++) {
        int outside = 0;
        for (int i = 0; i < 60; i++) {
            split_run r = split_campaign(&m[k], seed + (uint64_t)i, accuracy[k]);
            CHECK(r.step == PH_SPLIT_CHOSEN && r.n >= r.pilots);
            outside += !(r.error <= accuracy[k]);
        }
        CHECK(outside <= 6);
    }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_by_hand), cmocka_unit_test(test_optimum),
        cmocka_unit_test(test_steps),   cmocka_unit_test(test_scatter),
        cmocka_unit_test(test_points),  cmocka_unit_test(test_afforded),
        cmocka_unit_test(test_covers),  cmocka_unit_test(test_what_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
