/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/relaxation.h>

#include "check.h"
#include "series.h"

static void check_admissible(const ph_prony *p, const ph_prony *q)
{
    ph_error err = PH_ERROR_INIT;
    CHECK_OK(ph_prony_validate(q, &err)); /* every term positive semidefinite */
    ph_sym4 a = ph_prony_instantaneous(p), b = ph_prony_instantaneous(q);
    CHECK(difference(&b, &a) < 1e-10);
    CHECK(difference(&q->equilibrium, &p->equilibrium) == 0);
}

/* The plain way: equal steps of log time, each exact term shared between its two neighbours
 * linearly in log time. Admissible, limits kept, and an upper bound of what can be reached. */
static ph_prony *interpolated(const ph_prony *p, int nterms)
{
    ph_error err = PH_ERROR_INIT;
    ph_prony_term term[MOST_RANDOM_TERMS];
    ph_prony *q = NULL;
    double lo = log(p->term[0].time), hi = log(p->term[p->nterms - 1].time);
    for (int j = 0; j < nterms; j++)
        term[j] = (ph_prony_term){exp(lo + (hi - lo) * j / (nterms - 1)),
                                  {.n = p->equilibrium.n}};
    for (int m = 0; m < p->nterms; m++) {
        double at = (log(p->term[m].time) - lo) / (hi - lo) * (nterms - 1);
        int j = (int)fmin(at, nterms - 2);
        for (int k = 0; k < 2; k++)
            term[j + k].stiffness =
                ph_sym4_combine(1, &term[j + k].stiffness, k ? at - j : 1 - (at - j),
                                &p->term[m].stiffness);
    }
    CHECK_OK(ph_prony_new(&p->equilibrium, nterms, term, &q, &err));
    return q;
}

/* Both limits kept, terms admissible, the error as measured by hand, and not worse than the
 * plain way's (least squares is not the least largest error: a factor 1.5 is allowed). */
static void test_terms(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    for (int trial = 0; trial < check_trials(2); trial++) {
        int n = trial % 2 ? 6 : 3;
        ph_prony *p = random_series(&seed, n, 20, 5, 1 + trial % n, 1);
        static const int several[] = {1, 2, 4, 8};
        for (int i = 0; i < 4; i++) {
            int terms = several[i];
            ph_prony *q = NULL;
            double error = NAN;
            CHECK_OK(ph_prony_compress(p, terms, 0, &q, &error, &err));
            check_admissible(p, q);
            CHECK(q->nterms <= terms);
            ph_prony *plain = terms > 1 ? interpolated(p, terms) : NULL;
            CHECK(!plain || error < 1.5 * ph_prony_difference(plain, p));
            ph_prony_free(&plain);
            double worst = 0;
            for (double u = -6; u < 5; u += 0.05) {
                ph_sym4 a = ph_prony_at_time(q, pow(10, u)),
                        b = ph_prony_at_time(p, pow(10, u));
                for (int k = 0; k < n; k++)
                    worst = fmax(worst, fabs(a.m[k][k] - b.m[k][k]) / b.m[k][k]);
            }
            /* axes are some of all directions; the error has a floor of C(0)/1000 below */
            CHECK(worst <= error * 1.05);
            ph_prony_free(&q);
        }
        ph_prony_free(&p);
    }
    CHECK_END();
}

static void test_tolerance(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    ph_prony *p = random_series(&seed, 3, 30, 4, 2, 0.1);
    int last = 0;
    static const double tolerance[] = {0.3, 0.1, 0.05};
    for (int k = 0; k < 3; k++) {
        ph_prony *q = NULL;
        double error = NAN;
        CHECK_OK(ph_prony_compress(p, 0, tolerance[k], &q, &error, &err));
        check_admissible(p, q);
        CHECK(error <= tolerance[k] && q->nterms >= last);
        CHECK_REL(error, ph_prony_difference(q, p), 1e-12);
        last = q->nterms;
        ph_prony_free(&q);
    }
    CHECK(last > 2 && last < 16);
    ph_prony_free(&p);
    CHECK_END();
}

/* A series that is two exponentials in disguise (each split in three near times). */
static void test_finds_the_times(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    ph_prony_term term[6];
    ph_sym4 a = random_stiffness(&seed, 6), b = random_semidefinite(&seed, 6, 2);
    for (int k = 0; k < 3; k++) {
        term[k] = (ph_prony_term){0.01 * (1 + 1e-5 * k), a};
        term[3 + k] = (ph_prony_term){7 * (1 + 1e-5 * k), b};
    }
    ph_prony *p = NULL, *q = NULL;
    double error = NAN;
    CHECK_OK(ph_prony_new(&a, 6, term, &p, &err));
    CHECK_OK(ph_prony_compress(p, 2, 0, &q, &error, &err));
    CHECK(q->nterms == 2);
    /* the step of the search ends at 1 % of a time */
    CHECK_REL(q->term[0].time, 0.01, 0.02);
    CHECK_REL(q->term[1].time, 7, 0.02);
    CHECK_ABS(error, 0, 0.01);
    ph_prony_free(&p);
    ph_prony_free(&q);
    CHECK_END();
}

/* Times from 1e-12 to 1e12, a fluid, 40 terms, directions that do not relax. */
static void test_extremes(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    double error;
    ph_prony *q = NULL, *p = random_series(&seed, 3, 40, 24, 1, 0);
    CHECK_OK(ph_prony_compress(p, 12, 0, &q, &error, &err));
    check_admissible(p, q);
    ph_prony *plain = interpolated(p, 12);
    CHECK(error < 1.5 * ph_prony_difference(plain, p));
    ph_prony_free(&plain);
    ph_prony_free(&q);
    CHECK_OK(ph_prony_compress(p, 40, 0, &q, &error, &err)); /* nothing to do */
    CHECK(error == 0 && q->nterms == 40);
    ph_prony_free(&q);
    ph_prony_free(&p);
    ph_prony_term term[8];
    for (int k = 0; k < 8; k++)
        term[k] = (ph_prony_term){pow(3, k), ph_sym4_isotropic_kg(0, 1)}; /* no bulk */
    ph_sym4 rest = ph_sym4_isotropic_kg(5000, 1);
    CHECK_OK(ph_prony_new(&rest, 8, term, &p, &err));
    CHECK_OK(ph_prony_compress(p, 3, 0, &q, &error, &err));
    check_admissible(p, q);
    plain = interpolated(p, 3);
    CHECK(error < ph_prony_difference(plain, p));
    ph_prony_free(&plain);
    for (int m = 0; m < q->nterms; m++)
        CHECK_ABS(q->term[m].stiffness.m[0][0] + 2 * q->term[m].stiffness.m[0][1], 0,
                  1e-10);
    ph_prony_free(&q);
    ph_prony_free(&p);
    CHECK_END();
}

static void test_refusals(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    ph_prony *p = random_series(&seed, 3, 4, 4, 1, 1), *q = NULL;
    double error;
    static const double bad[] = {0, 1, -1, NAN, INFINITY};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        CHECK(ph_prony_compress(p, 0, bad[i], &q, &error, NULL) == PH_EINVAL && !q);
    CHECK(ph_prony_compress(p, -1, 0.1, &q, &error, NULL) == PH_EINVAL && !q);
    const ph_prony none = {p->equilibrium, 0, NULL};
    CHECK_OK(ph_prony_compress(&none, 3, 0, &q, &error, &err));
    CHECK(q->nterms == 0 && error == 0);
    ph_prony_free(&q);
    ph_prony_free(&p);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_terms),           cmocka_unit_test(test_tolerance),
        cmocka_unit_test(test_finds_the_times), cmocka_unit_test(test_extremes),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
