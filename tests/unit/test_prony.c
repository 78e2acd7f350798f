/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/prony.h>

#include "check.h"
#include "tensors.h"

enum { TERMS = 12 };

/* A series of random positive semidefinite terms, times over 24 decades, unsorted. */
static ph_prony *random_series(uint64_t *seed, int n, int nterms)
{
    ph_error err = PH_ERROR_INIT;
    ph_prony_term term[TERMS];
    ph_prony *p = NULL;
    for (int m = 0; m < nterms; m++)
        term[m] = (ph_prony_term){pow(10, check_uniform(seed, -12, 12)),
                                  random_stiffness(seed, n)};
    ph_sym4 equilibrium = random_stiffness(seed, n);
    CHECK_OK(ph_prony_new(&equilibrium, nterms, term, &p, &err));
    return p;
}

static void test_new_sorts_and_copies(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    ph_prony *p = random_series(&seed, 6, TERMS), *q = NULL, *none = NULL;
    for (int m = 1; m < p->nterms; m++)
        CHECK(p->term[m].time > p->term[m - 1].time);
    CHECK_OK(ph_prony_copy(p, &q, &err));
    CHECK(q->term != p->term && q->nterms == p->nterms);
    CHECK(memcmp(q->term, p->term, TERMS * sizeof *p->term) == 0);
    CHECK_OK(ph_prony_copy(NULL, &none, &err));
    CHECK(none == NULL);
    ph_prony_free(&p);
    ph_prony_free(&q);
    ph_prony_free(&q);
    ph_prony_free(NULL);
    CHECK(p == NULL && q == NULL);
    CHECK_END();
}

/* One term against the closed forms, where x = s tau runs from 1e-300 to 1e300. */
static void test_one_term(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    ph_sym4 stiffness = random_stiffness(&seed, 6), zero = {.n = 6}, re, im;
    ph_prony_term term = {1e-3, stiffness};
    ph_prony *p = NULL;
    CHECK_OK(ph_prony_new(&zero, 1, &term, &p, &err));
    double C = stiffness.m[1][1];
    static const double x[] = {1e-297, 1e-150, 1e-3, 0.5, 1, 7, 1e12, 1e150, 1e297};
    for (size_t i = 0; i < sizeof x / sizeof *x; i++) {
        double s = x[i] / 1e-3;
        /* four roundings */
        CHECK_REL(ph_prony_carson(p, s).m[1][1], C * (x[i] / (1 + x[i])), 1e-15);
        ph_prony_complex(p, s, &re, &im);
        double y = 1 / x[i]; /* x^2 overflows: the same written with 1/x */
        CHECK_REL(re.m[1][1],
                  x[i] < 1 ? C * (x[i] * x[i] / (1 + x[i] * x[i]))
                           : C * (1 / (1 + y * y)),
                  2e-15);
        CHECK_REL(im.m[1][1],
                  x[i] < 1 ? C * (x[i] / (1 + x[i] * x[i])) : C * (y / (1 + y * y)),
                  2e-15);
    }
    CHECK_REL(ph_prony_at_time(p, 2e-3).m[1][1], C * exp(-2.0), 1e-15);
    CHECK_ABS(ph_prony_at_time(p, 0).m[1][1], C, 0);
    CHECK_ABS(ph_prony_at_time(p, INFINITY).m[1][1], 0, 0);
    CHECK_ABS(ph_prony_carson(p, 0).m[1][1], 0, 0);
    CHECK_ABS(ph_prony_carson(p, INFINITY).m[1][1], C, 0);
    ph_prony_complex(p, 0, &re, &im);
    CHECK(re.m[1][1] == 0 && im.m[1][1] == 0);
    ph_prony_complex(p, INFINITY, &re, &im);
    CHECK(re.m[1][1] == C && im.m[1][1] == 0);
    ph_prony_free(&p);
    CHECK_END();
}

/* C(s) = s int_0^inf C(t) exp(-s t) dt, by the trapezoidal rule in ln t: the integrand is
 * analytic and falls off at both ends like t and exp(-s t), so the rule converges
 * exponentially; 1e-10 at a step of 0.02 over 70 e-folds. */
static void test_carson_is_the_transform(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_prony *p = random_series(&seed, 3, 5);
    for (int m = 0; m < p->nterms; m++)
        p->term[m].time = pow(10, m - 2);
    for (double s = 1e-3; s < 2e3; s *= 10) {
        double sum = 0, step = 0.02, want = ph_prony_carson(p, s).m[0][0];
        for (double u = -30; u < 5; u += step) {
            double t = exp(u) / s;
            sum += step * s * t * exp(-s * t) * ph_prony_at_time(p, t).m[0][0];
        }
        CHECK_REL(sum, want, 1e-10);
    }
    ph_prony_free(&p);
    CHECK_END();
}

static void test_rotation_and_shift(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    double R[9];
    ph_prony *p = random_series(&seed, 6, TERMS), *q = NULL;
    CHECK_OK(ph_prony_copy(p, &q, &err));
    random_rotation(&seed, R);
    ph_prony_rotate(q, R);
    ph_sym4 was = ph_prony_carson(p, 0.3), now = ph_prony_carson(q, 0.3);
    was = ph_sym4_rotate(&was, R);
    CHECK(difference(&was, &now) < 1e-14);
    CHECK_OK(ph_prony_scale_times(p, 100, &err));
    was = ph_prony_carson(p, 0.003);
    was = ph_sym4_rotate(&was, R);
    CHECK(difference(&was, &now) < 1e-14);
    static const double bad[] = {0, -1, NAN, INFINITY, 1e295, 1e-295};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        double before = p->term[0].time;
        CHECK(ph_prony_scale_times(p, bad[i], NULL) == PH_EUNPHYSICAL);
        CHECK(p->term[0].time == before);
    }
    ph_prony_free(&p);
    ph_prony_free(&q);
    CHECK_END();
}

static void refuse(const ph_sym4 *equilibrium, int nterms, const ph_prony_term *term,
                   ph_status status, const char *word)
{
    ph_error err = PH_ERROR_INIT;
    ph_prony *p = NULL;
    CHECK(ph_prony_new(equilibrium, nterms, term, &p, &err) == status);
    CHECK(p == NULL);
    if (!strstr(err.msg, word)) print_error("'%s' lacks '%s'\n", err.msg, word);
    CHECK(strstr(err.msg, word) != NULL);
    ph_prony_free(&p);
}

static void test_refusals(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    ph_prony_term good[2] = {{1, random_stiffness(&seed, 6)},
                             {2, random_stiffness(&seed, 6)}},
                  bad[2];
    ph_sym4 zero = {.n = 6}, flat = {.n = 3}, odd = {.n = 4};
    static const double times[] = {0, -1, NAN, INFINITY, 1e-305, 1e305};
    refuse(&zero, -1, good, PH_EINVAL, "-1");
    refuse(&flat, 2, good, PH_EINVAL, "6 x 6");
    refuse(&odd, 0, good, PH_EINVAL, "n = 3 or 6");
    for (size_t i = 0; i < sizeof times / sizeof *times; i++) {
        memcpy(bad, good, sizeof bad);
        bad[1].time = times[i];
        refuse(&zero, 2, bad, PH_EUNPHYSICAL, "relaxation time must be > 0");
    }
    memcpy(bad, good, sizeof bad);
    bad[1].time = bad[0].time;
    refuse(&zero, 2, bad, PH_EUNPHYSICAL, "distinct");
    memcpy(bad, good, sizeof bad);
    bad[1].stiffness.m[0][1] += 0.1;
    refuse(&zero, 2, bad, PH_EUNPHYSICAL, "symmetric");
    bad[1].stiffness.m[0][1] = NAN;
    refuse(&zero, 2, bad, PH_EUNPHYSICAL, "finite");
    memcpy(bad, good, sizeof bad);
    bad[1].stiffness.m[2][2] = -1;
    refuse(&zero, 2, bad, PH_EUNPHYSICAL, "positive semidefinite");
    refuse(&bad[1].stiffness, 0, bad, PH_EUNPHYSICAL, "equilibrium");
    ph_prony *p = NULL;
    CHECK_OK(ph_prony_new(&zero, 0, NULL, &p, &err)); /* nothing at all is a series */
    CHECK(ph_sym4_norm(&(ph_sym4){.n = 6}) == 0 && p->nterms == 0);
    ph_prony_free(&p);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_new_sorts_and_copies),
        cmocka_unit_test(test_one_term),
        cmocka_unit_test(test_carson_is_the_transform),
        cmocka_unit_test(test_rotation_and_shift),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
