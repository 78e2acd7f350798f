/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The material point: exact solutions, tangent, energy, restart, threads. */
#include <perihom.h>

#include "tensors.h"

#include <omp.h>

enum { STEPS = 400 };

/* A random positive semidefinite tensor of rank 2 or n. */
static ph_sym4 random_term(uint64_t *seed, int n, bool thin)
{
    ph_sym4 c = {.n = n};
    for (int r = 0; r < (thin ? 2 : n); r++) {
        double v[6];
        for (int i = 0; i < n; i++)
            v[i] = check_uniform(seed, -1, 1);
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++)
                c.m[i][j] += v[i] * v[j];
    }
    return c;
}

static ph_effective *random_effective(uint64_t *seed, int n, int terms, bool fluid)
{
    ph_error err = PH_ERROR_INIT;
    ph_prony_term term[40];
    ph_effective *e = calloc(1, sizeof *e);
    for (int k = 0; k < terms; k++) {
        term[k].time = pow(10, check_uniform(seed, -6, 6));
        term[k].stiffness = random_term(seed, n, k % 2);
    }
    ph_sym4 infinity = fluid ? (ph_sym4){.n = n} : random_stiffness(seed, n);
    CHECK_OK(ph_prony_new(&infinity, terms, term, &e->relaxation, &err));
    e->stiffness = ph_prony_instantaneous(e->relaxation);
    return e;
}

static ph_point_material *point_of(const ph_effective *e)
{
    ph_error err = PH_ERROR_INIT;
    ph_point_material *m = NULL;
    CHECK_OK(ph_point_material_new(e, &m, &err));
    return m;
}

static void random_strain(uint64_t *seed, int n, double size, double *de)
{
    for (int i = 0; i < n; i++)
        de[i] = check_uniform(seed, -size, size);
}

/* A jump, then rest: stress is C(t) eps, in any steps. Round-off of the sum over terms. */
static void relaxation_is_the_series(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int trial = 0; trial < check_trials(10); trial++) {
        int n = trial % 2 ? 3 : 6;
        ph_effective *e = random_effective(&seed, n, 1 + trial % 12, trial % 3 == 0);
        ph_point_material *m = point_of(e);
        double *h = calloc(ph_point_state_size(m), sizeof *h), s[6], de[6], rest[6] = {0};
        random_strain(&seed, n, 1, de);
        CHECK(ph_point_update(m, h, de, 0, s, NULL) == PH_OK);
        double t = 0;
        for (int k = 0; k < 30; k++) {
            double dt = pow(10, check_uniform(&seed, -8, 7)), voigt[36], size = 0;
            CHECK(ph_point_update(m, h, rest, dt, s, NULL) == PH_OK);
            t += dt;
            ph_sym4 c = ph_prony_at_time(e->relaxation, t), all = e->stiffness;
            ph_sym4_to_voigt(&c, true, voigt);
            size = ph_sym4_norm(&all);
            for (int i = 0; i < n; i++) {
                double want = 0;
                for (int j = 0; j < n; j++)
                    want += voigt[i * n + j] * de[j];
                CHECK_ABS(s[i], want, 1e-13 * size);
            }
        }
        free(h);
        ph_point_material_free(&m);
        ph_effective_free(&e);
    }
    CHECK_END();
}

/* A ramp taken in one step or in many ends at the same stress: the recursion is exact for it. */
static void ramps_do_not_depend_on_steps(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_effective *e = random_effective(&seed, 6, 9, false);
    ph_point_material *m = point_of(e);
    size_t size = ph_point_state_size(m);
    double *one = calloc(size, sizeof *one), *many = calloc(size, sizeof *many);
    double de[6], part[6], a[6], b[6];
    random_strain(&seed, 6, 1, de);
    for (int i = 0; i < 6; i++)
        part[i] = de[i] / STEPS;
    ph_point_update(m, one, de, 10, a, NULL);
    for (int k = 0; k < STEPS; k++)
        ph_point_update(m, many, part, 10.0 / STEPS, b, NULL);
    for (int i = 0; i < 6; i++) /* 400 roundings of the running sums */
        CHECK_ABS(a[i], b[i], 400 * 2e-16 * ph_sym4_norm(&e->stiffness));
    free(one);
    free(many);
    ph_point_material_free(&m);
    ph_effective_free(&e);
    CHECK_END();
}

/* The stress is linear in the increment, so differences of any size give the tangent. */
static void tangent(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int trial = 0; trial < check_trials(10); trial++) {
        int n = trial % 2 ? 3 : 6;
        ph_effective *e = random_effective(&seed, n, 1 + trial, false);
        ph_point_material *m = point_of(e);
        size_t size = ph_point_state_size(m);
        double *h = calloc(size, sizeof *h), *copy = calloc(size, sizeof *copy);
        double de[6], s[6], T[36], dt = pow(10, check_uniform(&seed, -8, 8));
        for (int k = 0; k < 5; k++) {
            random_strain(&seed, n, 1, de);
            ph_point_update(m, h, de, dt, s, NULL);
        }
        memcpy(copy, h, size * sizeof *h);
        random_strain(&seed, n, 1, de);
        ph_point_update(m, copy, de, dt, s, T);
        for (int j = 0; j < n; j++) {
            double up[6], change[6];
            memcpy(up, de, sizeof up);
            up[j] += 1e-3;
            memcpy(copy, h, size * sizeof *h);
            ph_point_update(m, copy, up, dt, change, NULL);
            for (int i = 0; i < n; i++) {
                CHECK_ABS((change[i] - s[i]) / 1e-3, T[i * n + j],
                          1e-7 * ph_sym4_norm(&e->stiffness));
                CHECK_ABS(T[i * n + j], T[j * n + i],
                          1e-14 * ph_sym4_norm(&e->stiffness));
            }
        }
        free(h);
        free(copy);
        ph_point_material_free(&m);
        ph_effective_free(&e);
    }
    CHECK_END();
}

/* Over a closed cycle from the virgin state the work done on the point is not negative. The
 * work of a step is the integral of stress over a linear strain: fine substeps, trapezoid. */
static void no_energy_from_cycles(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int trial = 0; trial < check_trials(20); trial++) {
        ph_effective *e = random_effective(&seed, 6, 1 + trial % 8, trial % 4 == 0);
        ph_point_material *m = point_of(e);
        double *h = calloc(ph_point_state_size(m), sizeof *h);
        double total[6] = {0}, de[6], before[6] = {0}, s[6], work = 0, gross = 0;
        for (int leg = 0; leg < 6; leg++) {
            double dt = pow(10, check_uniform(&seed, -4, 4));
            if (leg == 5)
                for (int i = 0; i < 6; i++)
                    de[i] = -total[i];
            else
                random_strain(&seed, 6, 1, de);
            for (int i = 0; i < 6; i++) {
                total[i] += de[i];
                de[i] /= STEPS;
            }
            for (int k = 0; k < STEPS; k++) {
                ph_point_update(m, h, de, dt / STEPS, s, NULL);
                double w = 0;
                for (int i = 0; i < 6; i++)
                    w += 0.5 * (s[i] + before[i]) * de[i];
                work += w;
                gross += fabs(w);
                memcpy(before, s, sizeof s);
            }
        }
        CHECK(work >= -1e-12 * gross);
        free(h);
        ph_point_material_free(&m);
        ph_effective_free(&e);
    }
    CHECK_END();
}

/* A history from a saved state has the bits of the uninterrupted one; so have threads that
 * share the material. */
static void restart_and_threads(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_effective *e = random_effective(&seed, 6, 12, false);
    ph_point_material *m = point_of(e);
    size_t size = ph_point_state_size(m);
    double want[6], *half = calloc(size, sizeof *half);
    double *h = calloc(size, sizeof *h);
    for (int k = 0; k < 100; k++) {
        double de[6] = {sin(k), cos(k), sin(2 * k), 0.1, cos(3 * k), sin(k) * cos(k)};
        if (k == 50) memcpy(half, h, size * sizeof *h);
        ph_point_update(m, h, de, 0.01 * k, want, NULL);
    }
    bool same[4];
#pragma omp parallel for num_threads(4)
    for (int t = 0; t < 4; t++) {
        double s[6] = {0}, *own = malloc(size * sizeof *own);
        memcpy(own, half, size * sizeof *own);
        for (int k = 50; k < 100; k++) {
            double de[6] = {sin(k), cos(k), sin(2 * k), 0.1, cos(3 * k), sin(k) * cos(k)};
            ph_point_update(m, own, de, 0.01 * k, s, NULL);
        }
        same[t] = memcmp(s, want, sizeof s) == 0 && memcmp(own, h, size * sizeof *h) == 0;
        free(own);
    }
    for (int t = 0; t < 4; t++)
        CHECK(same[t]);
    free(h);
    free(half);
    ph_point_material_free(&m);
    ph_effective_free(&e);
    CHECK_END();
}

/* Many points at once have the bits of one after the other. */
static void many_points(void **state)
{
    (void)state;
    enum { POINTS = 7 };
    uint64_t seed = check_seed();
    for (int trial = 0; trial < 6; trial++) {
        const int n = trial % 2 ? 3 : 6;
        ph_effective *e = random_effective(&seed, n, 1 + 2 * trial, false);
        ph_point_material *m = point_of(e);
        const size_t size = ph_point_state_size(m);
        double *one = calloc(POINTS * size, sizeof *one), T[36], U[36];
        double *all = calloc(POINTS * size, sizeof *all);
        double de[POINTS * 6], s[POINTS * 6], r[POINTS * 6];
        for (int step = 0; step < 5; step++) {
            const double dt = step ? pow(10, check_uniform(&seed, -7, 7)) : 0;
            random_strain(&seed, POINTS * n, 1, de);
            CHECK(ph_points_update(m, POINTS, all, de, dt, s, T) == PH_OK);
            for (int p = 0; p < POINTS; p++)
                CHECK(ph_point_update(m, one + p * size, de + p * n, dt, r + p * n, U) ==
                      PH_OK);
            CHECK(memcmp(all, one, POINTS * size * sizeof *one) == 0);
            CHECK(memcmp(s, r, sizeof(double) * (size_t)(POINTS * n)) == 0);
            CHECK(memcmp(T, U, sizeof(double) * (size_t)(n * n)) == 0);
        }
        de[POINTS * n - 1] = NAN;
        CHECK(ph_points_update(m, POINTS, all, de, 1, s, NULL) == PH_EINVAL);
        CHECK(ph_points_update(m, -1, all, de, 1, s, NULL) == PH_EINVAL);
        CHECK(ph_points_update(m, 0, NULL, NULL, 1, NULL, NULL) == PH_OK);
        CHECK(memcmp(all, one, POINTS * size * sizeof *one) == 0);
        free(one);
        free(all);
        ph_point_material_free(&m);
        ph_effective_free(&e);
    }
    CHECK_END();
}

/* Times from 1e-12 to 1e12 and steps of any size: finite, and an elastic material is Hooke. */
static void extremes_and_refusals(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    ph_sym4 c = random_stiffness(&seed, 6);
    ph_effective elastic = {.stiffness = c}, none = {.stiffness = {.n = 6}};
    ph_point_material *m = point_of(&elastic), *refused = NULL;
    double h[6] = {0}, de[6], s[6], T[36], D[36];
    random_strain(&seed, 6, 1, de);
    ph_sym4_to_voigt(&c, true, D);
    CHECK(ph_point_state_size(m) == 6 && ph_point_components(m) == 6);
    CHECK(ph_point_update(m, h, de, 1, s, T) == PH_OK);
    CHECK(memcmp(T, D, sizeof T) == 0 && memcmp(h, s, sizeof h) == 0);
    double kept[6], bad[6] = {NAN, 0, 0, 0, 0, 0};
    memcpy(kept, h, sizeof h);
    CHECK(ph_point_update(m, h, bad, 1, s, NULL) == PH_EINVAL);
    CHECK(ph_point_update(m, h, de, -1, s, NULL) == PH_EINVAL);
    CHECK(ph_point_update(m, h, de, NAN, s, NULL) == PH_EINVAL);
    CHECK(ph_point_update(m, h, de, INFINITY, s, NULL) == PH_EINVAL);
    CHECK(memcmp(kept, h, sizeof h) == 0 && memcmp(kept, s, sizeof s) == 0);
    ph_point_material_free(&m);
    ph_point_material_free(&m);
    CHECK(ph_point_material_new(&none, &refused, &err) == PH_EINVAL && !refused);
    CHECK(ph_point_material_new(NULL, &refused, NULL) == PH_EINVAL && !refused);
    ph_prony_term term[3] = {{1e-12, c}, {1, c}, {1e12, c}};
    ph_effective wide = {0};
    CHECK_OK(ph_prony_new(&c, 3, term, &wide.relaxation, &err));
    wide.stiffness = ph_prony_instantaneous(wide.relaxation);
    m = point_of(&wide);
    double state4[24] = {0};
    for (int k = -300; k <= 300; k += 20) {
        CHECK(ph_point_update(m, state4, de, pow(10, k), s, T) == PH_OK);
        for (int i = 0; i < 6; i++)
            CHECK(isfinite(s[i]) && isfinite(T[7 * i]));
    }
    ph_point_material_free(&m);
    ph_prony_free(&wide.relaxation);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(relaxation_is_the_series),
        cmocka_unit_test(ramps_do_not_depend_on_steps),
        cmocka_unit_test(tangent),
        cmocka_unit_test(no_energy_from_cycles),
        cmocka_unit_test(restart_and_threads),
        cmocka_unit_test(many_points),
        cmocka_unit_test(extremes_and_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
