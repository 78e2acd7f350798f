/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Curves of a known material at several temperatures: the factors between them come back. */
#include <perihom/fit.h>

#include "check.h"

enum { TEMPERATURES = 6, EACH = 40, ALL = TEMPERATURES * EACH };

static const double temperature_of[TEMPERATURES] = {105, 110, 115, 120, 130, 145};
static const ph_shift wlf = {.kind = PH_SHIFT_WLF, .c1 = 12, .c2 = 60, .reference = 120};
static const ph_shift arrhenius = {
    .kind = PH_SHIFT_ARRHENIUS, .activation_energy = 4e5, .reference = 120};

typedef struct curves {
    double x[ALL], value[ALL], loss[ALL], temperature[ALL];
    ph_prony_data data;
} curves;

/* A broad material: six terms a decade apart; each curve spans three decades. */
static void measure(ph_prony_kind kind, const ph_shift *law, curves *c)
{
    for (int i = 0; i < ALL; i++) {
        double a, x = pow(10, -1.5 + 3.0 * (i % EACH) / (EACH - 1));
        c->temperature[i] = temperature_of[i / EACH];
        assert_int_equal(ph_shift_factor(law, c->temperature[i], 273.15, &a, NULL),
                         PH_OK);
        c->x[i] = x;
        c->value[i] = 0.05;
        c->loss[i] = 0;
        for (int k = 0; k < 9; k++) {
            double tau = a * pow(10, k - 4), z = x * tau;
            if (kind == PH_PRONY_DYNAMIC) {
                c->value[i] += z * z / (1 + z * z) / (k + 1);
                c->loss[i] += z / (1 + z * z) / (k + 1);
            } else {
                c->value[i] += exp(-x / tau) / (k + 1);
            }
        }
    }
    c->data = (ph_prony_data){.kind = kind,
                              .n = ALL,
                              .x = c->x,
                              .value = c->value,
                              .loss = kind == PH_PRONY_DYNAMIC ? c->loss : NULL};
}

static void test_overlap(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    static curves c;
    double factor[ALL], gap;
    const ph_shift *const laws[] = {&wlf, &arrhenius};
    for (int k = 0; k < 4; k++) {
        measure(k < 2 ? PH_PRONY_RELAXATION : PH_PRONY_DYNAMIC, laws[k % 2], &c);
        CHECK_OK(ph_shift_overlap(&c.data, c.temperature, 120, factor, &gap, &err));
        for (int i = 0; i < ALL; i += EACH) {
            double a;
            CHECK_OK(ph_shift_factor(laws[k % 2], c.temperature[i], 273.15, &a, &err));
            /* straight lines between points 0.18 apart in ln x are some 1e-3 off a curve
             * that bends over 2.3: two or three joints of that size */
            CHECK_ABS(log(factor[i]), log(a), 0.02);
            for (int j = 1; j < EACH; j++)
                CHECK(factor[i + j] == factor[i]);
        }
        CHECK(gap < 5e-3);
        CHECK(factor[3 * EACH] == 1); /* the reference itself */
    }
    CHECK_END();
}

/* The master curve is one series: fitted as well as a single temperature would be. */
static void test_master_curve(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    static curves c;
    double a;
    measure(PH_PRONY_RELAXATION, &wlf, &c);
    for (int i = 0; i < ALL; i++) {
        CHECK_OK(ph_shift_factor(&wlf, c.temperature[i], 273.15, &a, &err));
        c.x[i] /= a;
    }
    ph_prony_fit *fit = NULL;
    CHECK_OK(
        ph_prony_fit_new(&c.data, &(ph_prony_fit_params){.per_decade = 1}, &fit, &err));
    CHECK(fit && fit->misfit < 1e-11);
    ph_prony_fit_free(&fit);
    CHECK_END();
}

static void test_laws(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    double T[TEMPERATURES], a[TEMPERATURES], misfit;
    ph_shift found;
    const ph_shift *const laws[] = {&wlf, &arrhenius};
    for (int k = 0; k < 2; k++) {
        int n = 0;
        for (int i = 0; i < TEMPERATURES; i++) {
            if (temperature_of[i] == 120) continue;
            T[n] = temperature_of[i];
            CHECK_OK(ph_shift_factor(laws[k], T[n], 273.15, &a[n], &err));
            n++;
        }
        CHECK_OK(
            ph_shift_fit(laws[k]->kind, n, T, a, 120, 273.15, &found, &misfit, &err));
        CHECK_ABS(misfit, 0, 1e-9);
        CHECK(found.kind == laws[k]->kind && found.reference == 120);
        if (k == 0) CHECK_REL(found.c1, 12, 1e-9);
        if (k == 0) CHECK_REL(found.c2, 60, 1e-9);
        if (k == 1) CHECK_REL(found.activation_energy, 4e5, 1e-12);
        /* Arrhenius is WLF with C2 = T_ref in kelvin and C1 = E_a / (R T_ref ln 10) */
        CHECK_OK(
            ph_shift_fit(laws[1 - k]->kind, n, T, a, 120, 273.15, &found, &misfit, &err));
        if (k == 0) CHECK(misfit > 0.1);
        if (k == 1) CHECK_REL(found.c2, 393.15, 1e-6);
        if (k == 1) CHECK_REL(found.c1, 4e5 / (8.31446 * 393.15 * log(10)), 1e-5);
    }
    CHECK_END();
}

static void test_refused(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    static curves c;
    double factor[ALL], T[2] = {100, 130}, a[2] = {10, 0.1}, misfit;
    ph_shift law;
    measure(PH_PRONY_RELAXATION, &wlf, &c);
    CHECK(ph_shift_overlap(&c.data, c.temperature, 121, factor, NULL, &err) == PH_EINVAL);
    CHECK(strstr(err.msg, "no data at the reference temperature 121"));
    err = (ph_error)PH_ERROR_INIT;
    for (int i = 0; i < EACH; i++) /* the lowest temperature: a thousand times stiffer */
        c.value[i] *= 1e3;
    /* curves can always be laid over each other, but not well: the gap says so */
    double gap;
    CHECK_OK(ph_shift_overlap(&c.data, c.temperature, 120, factor, &gap, &err));
    CHECK(gap > 1);
    c.data.n = EACH + 2;
    CHECK(ph_shift_overlap(&c.data, c.temperature, 105, factor, NULL, &err) == PH_EINVAL);
    CHECK(strstr(err.msg, "2 points at 110: a curve needs 3"));
    c.x[3] = 0;
    CHECK(ph_shift_overlap(&c.data, c.temperature, 105, factor, NULL, NULL) == PH_EINVAL);
    CHECK(ph_shift_fit(PH_SHIFT_NONE, 2, T, a, 120, 0, &law, &misfit, NULL) == PH_EINVAL);
    CHECK(ph_shift_fit(PH_SHIFT_WLF, 1, T, a, 120, 0, &law, &misfit, NULL) == PH_EINVAL);
    CHECK(ph_shift_fit(PH_SHIFT_WLF, 0, T, a, 120, 0, &law, &misfit, NULL) == PH_EINVAL);
    CHECK(ph_shift_fit(PH_SHIFT_WLF, 2, T, a, 100, 0, &law, &misfit, NULL) == PH_EINVAL);
    a[0] = 0.1;
    a[1] = 10; /* slower when hot */
    CHECK(ph_shift_fit(PH_SHIFT_ARRHENIUS, 2, T, a, 120, 0, &law, &misfit, NULL) ==
          PH_EUNPHYSICAL);
    CHECK(ph_shift_fit(PH_SHIFT_WLF, 2, T, a, 120, 0, &law, &misfit, NULL) ==
          PH_EUNPHYSICAL);
    a[0] = -1;
    CHECK(ph_shift_fit(PH_SHIFT_WLF, 2, T, a, 120, 0, &law, &misfit, NULL) == PH_EINVAL);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_overlap),
        cmocka_unit_test(test_master_curve),
        cmocka_unit_test(test_laws),
        cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
