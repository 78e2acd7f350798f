/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/history.h>
#include <perihom/material.h>

#include "check.h"
#include "tensors.h"

/* A series of a few random terms. */
static ph_prony *random_series(uint64_t *seed, int n, double equilibrium)
{
    ph_error err = PH_ERROR_INIT;
    ph_prony_term term[4];
    ph_prony *p = NULL;
    ph_sym4 e = random_stiffness(seed, n), zero = {.n = n};
    e = ph_sym4_combine(equilibrium, &e, 0, &zero);
    for (int m = 0; m < 4; m++)
        term[m] = (ph_prony_term){pow(10, check_uniform(seed, -2, 2)),
                                  random_stiffness(seed, n)};
    CHECK_OK(ph_prony_new(&e, 4, term, &p, &err));
    return p;
}

/* A step of strain gives back C(t), a step of stress the creep compliance. */
static void test_steps(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    static const double times[] = {-1, 0, 1e-3, 0.5, 0.5, 7, 400};
    for (int n = 3; n <= 6; n += 3)
        for (int stress = 0; stress < 2; stress++) {
            ph_prony *p = random_series(&seed, n, stress ? 0 : 1);
            ph_history *h = NULL;
            ph_creep *creep = NULL;
            double got[7][6], v[36];
            CHECK_OK(ph_prony_creep(p, &creep, &err));
            CHECK_OK(ph_history_ramp(n, n - 1, stress, 2, 0, 1e9, 0, &h, &err));
            CHECK_OK(ph_prony_response(p, h, 7, times, got, &err));
            for (int k = 0; k < 7; k++) {
                ph_sym4 c = stress ? ph_creep_at_time(creep, times[k])
                                   : ph_prony_at_time(p, times[k]);
                ph_sym4_to_voigt(&c, !stress, v);
                for (int i = 0; i < n; i++)
                    CHECK_ABS(got[k][i], k ? 2 * v[n * i + n - 1] : 0,
                              1e-12 * fabs(v[n * n - 1]));
            }
            ph_history_free(&h);
            ph_creep_free(&creep);
            ph_prony_free(&p);
        }
    CHECK_END();
}

/* Strain to stress to strain: points dense enough that the stress between them is nearly
 * straight; error of the lines goes with the square of the spacing. */
static void test_there_and_back(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    ph_prony *p = random_series(&seed, 3, 1);
    double error[2];
    for (int fine = 0; fine < 2; fine++) {
        int points = fine ? 1600 : 800;
        ph_history *strain = NULL, *stress = NULL;
        double(*answer)[6] = calloc((size_t)points + 1, sizeof *answer);
        CHECK_OK(ph_history_cycle(3, 0, false, &(ph_cycle){0, 0.01, 1, 1, points},
                                  &strain, &err));
        CHECK_OK(ph_history_new(3, strain->npoints, true, &stress, &err));
        memcpy(stress->time, strain->time,
               (size_t)strain->npoints * sizeof *strain->time);
        CHECK_OK(ph_prony_response(p, strain, strain->npoints, strain->time,
                                   stress->value, &err));
        CHECK_OK(
            ph_prony_response(p, stress, stress->npoints, stress->time, answer, &err));
        error[fine] = 0;
        for (int k = 0; k <= points; k++)
            error[fine] = fmax(error[fine], fabs(answer[k][0] - strain->value[k][0]));
        ph_history_free(&strain);
        ph_history_free(&stress);
        free(answer);
    }
    CHECK_ABS(error[1] / 0.01, 0, 1e-3);
    CHECK_ABS(error[0] / error[1], 4, 1);
    ph_prony_free(&p);
    CHECK_END();
}

/* The recursion is exact for straight lines: cutting a piece changes nothing. */
static void test_pieces_may_be_cut(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    ph_prony *p = random_series(&seed, 6, 1);
    ph_history *h = NULL;
    CHECK_OK(ph_history_ramp(6, 1, false, 0.02, 3, 1, 50, &h, &err));
    double times[400], once[6], many[400][6];
    for (int k = 0; k < 400; k++)
        times[k] = 0.1 * (k + 1);
    CHECK_OK(ph_prony_response(p, h, 400, times, many, &err));
    for (int k = 0; k < 400; k += 57) {
        CHECK_OK(ph_prony_response(p, h, 1, &times[k], &once, &err));
        for (int i = 0; i < 6; i++)
            CHECK_ABS(many[k][i], once[i], 1e-14);
    }
    ph_history_free(&h);
    ph_prony_free(&p);
    CHECK_END();
}

/* After the strain has gone back to zero the stress fades, from the other side. */
static void test_recovery_and_extremes(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    static const ph_modulus_term term[] = {{1e-12, 1}, {1, 2}, {1e12, 4}};
    const ph_modulus E = {0.5, 3, term};
    ph_material m;
    ph_history *h = NULL;
    CHECK_OK(ph_material_viscoelastic_young("x", &E, 0.0, &m, &err));
    CHECK_OK(ph_history_ramp(6, 0, false, 1, 0, 5, 100, &h, &err));
    static const double times[] = {1e-20, 1e-6, 4.999999, 5, 5.000001, 104};
    double got[6][6];
    CHECK_OK(ph_prony_response(m.relaxation, h, 6, times, got, &err));
    CHECK_REL(got[0][0], 7.5, 1e-7);
    CHECK_REL(got[1][0], 6.5, 1e-5);
    CHECK_REL(got[2][0], 4.5 + 2 * exp(-5), 1e-6);
    CHECK_REL(got[3][0], 2 * expm1(-5) - 1, 1e-6);
    CHECK_REL(got[4][0], 2 * expm1(-5), 1e-5);
    CHECK(fabs(got[5][0]) < 1e-10);
    ph_history_free(&h);
    ph_material_clear(&m);
    CHECK_END();
}

static void test_histories(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_history *h = NULL;
    double x[6];
    CHECK_OK(ph_history_ramp(6, 3, true, 2, 1, 1, 1, &h, &err));
    ph_history_at(h, -1, x);
    CHECK(x[3] == 0);
    ph_history_at(h, 0.25, x);
    CHECK_ABS(x[3], 0.5, 1e-15);
    ph_history_at(h, 2.5, x);
    CHECK_ABS(x[3], 1, 1e-15);
    ph_history_at(h, 99, x);
    CHECK(x[3] == 0);
    ph_history_free(&h);
    CHECK_OK(ph_history_ramp(6, 3, true, 2, 0, 1, 1, &h, &err));
    ph_history_at(h, 0, x);
    CHECK(x[3] == 2);
    ph_history_at(h, 1, x);
    CHECK(x[3] == 0);
    h->time[1] = NAN;
    CHECK(ph_history_validate(h, NULL) == PH_EINVAL);
    h->time[1] = -1;
    CHECK(ph_history_validate(h, NULL) == PH_EINVAL);
    h->time[1] = h->time[2] = 0;
    CHECK(ph_history_validate(h, NULL) == PH_EINVAL);
    ph_history_free(&h);
    CHECK(ph_history_new(4, 1, false, &h, NULL) == PH_EINVAL && !h);
    CHECK(ph_history_new(6, 0, false, &h, NULL) == PH_EINVAL && !h);
    CHECK(ph_history_ramp(3, 3, false, 1, 0, 1, 0, &h, NULL) == PH_EINVAL && !h);
    CHECK(ph_history_ramp(3, 0, false, 1, -1, 1, 0, &h, NULL) == PH_EINVAL && !h);
    CHECK(ph_history_ramp(3, 0, false, 1, 0, 0, 0, &h, NULL) == PH_EINVAL && !h);
    CHECK(ph_history_ramp(3, 0, false, 1, 0, INFINITY, 0, &h, NULL) == PH_EINVAL && !h);
    CHECK(ph_history_ramp(3, 0, false, NAN, 0, 1, 0, &h, NULL) == PH_EINVAL && !h);
    CHECK(ph_history_cycle(3, 0, false, &(ph_cycle){0, 1, 0, 1, 8}, &h, NULL) ==
              PH_EINVAL &&
          !h);
    CHECK(ph_history_cycle(3, 0, false, &(ph_cycle){0, 1, 1, 0, 8}, &h, NULL) ==
              PH_EINVAL &&
          !h);
    CHECK(ph_history_cycle(3, 0, false, &(ph_cycle){0, 1, 1, 1, 3}, &h, NULL) ==
              PH_EINVAL &&
          !h);
    CHECK(ph_history_cycle(3, 0, false, &(ph_cycle){0, 1, 1, 1 << 30, 8}, &h, NULL) ==
          PH_EINVAL);
    CHECK_END();
}

static void test_refusals(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    ph_prony *p = random_series(&seed, 3, 1);
    ph_history *h = NULL, *six = NULL;
    double out[2][6], times[2] = {1, 0};
    CHECK_OK(ph_history_ramp(3, 0, true, 1, 0, 1, 0, &h, &err));
    CHECK_OK(ph_history_ramp(6, 0, true, 1, 0, 1, 0, &six, &err));
    CHECK(ph_prony_response(p, h, 2, times, out, NULL) == PH_EINVAL);
    times[1] = NAN;
    CHECK(ph_prony_response(p, h, 2, times, out, NULL) == PH_EINVAL);
    CHECK(ph_prony_response(p, six, 1, times, out, NULL) == PH_EINVAL);
    const ph_prony none = {{.n = 3}, 0, NULL};
    CHECK(ph_prony_response(&none, h, 1, times, out, NULL) == PH_ESINGULAR);
    h->value[1][0] = NAN;
    CHECK(ph_prony_response(p, h, 1, times, out, NULL) == PH_EINVAL);
    ph_history_free(&h);
    ph_history_free(&six);
    ph_prony_free(&p);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_steps),
        cmocka_unit_test(test_there_and_back),
        cmocka_unit_test(test_pieces_may_be_cut),
        cmocka_unit_test(test_recovery_and_extremes),
        cmocka_unit_test(test_histories),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
