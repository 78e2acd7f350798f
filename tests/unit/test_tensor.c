/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/tensor.h>

#include "check.h"
#include "tensors.h"

/* Round-off of a few 6 x 6 products of numbers of size one. */
static const double ROUND = 1e-13;

static void test_voigt_round_trip(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int n = 3; n <= 6; n += 3) {
        double v[36], back[36];
        for (int i = 0; i < n * n; i++)
            v[i] = check_uniform(&seed, -1, 1);
        for (int kind = 0; kind < 2; kind++) {
            ph_sym4 c = ph_sym4_from_voigt(n, v, kind);
            ph_sym4_to_voigt(&c, kind, back);
            for (int i = 0; i < n * n; i++)
                CHECK_ABS(back[i], v[i], 1e-15);
        }
    }
    CHECK_END();
}

static void test_isotropic_in_voigt(void **state)
{
    (void)state;
    /* E = 1, nu = 1/4: lambda = mu = 0.4. */
    ph_sym4 c = ph_sym4_isotropic(1.0, 0.25);
    double v[36];
    ph_sym4_to_voigt(&c, true, v);
    CHECK_ABS(v[0], 1.2, 1e-15);
    CHECK_ABS(v[1], 0.4, 1e-15);
    CHECK_ABS(v[3 * 6 + 3], 0.4, 1e-15);
    CHECK_ABS(v[5 * 6 + 5], 0.4, 1e-15);
    CHECK_ABS(v[5], 0.0, 0.0);
    ph_sym4 s;
    ph_error err = PH_ERROR_INIT;
    CHECK_OK(ph_sym4_inverse(&c, &s, &err));
    ph_sym4_to_voigt(&s, false, v);
    CHECK_ABS(v[0], 1.0, 1e-14);
    CHECK_ABS(v[1], -0.25, 1e-14);
    CHECK_ABS(v[4 * 6 + 4], 2.5, 1e-14);
    CHECK_END();
}

static void test_inverse(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_error err = PH_ERROR_INIT;
    for (int t = 0; t < check_trials(50); t++) {
        ph_sym4 c = random_stiffness(&seed, t % 2 ? 3 : 6), s, one = {.n = c.n};
        for (int i = 0; i < c.n; i++)
            one.m[i][i] = 1.0;
        CHECK_OK(ph_sym4_inverse(&c, &s, &err));
        ph_sym4 p = ph_sym4_product(&c, &s);
        CHECK_ABS(difference(&p, &one), 0.0, 100 * ROUND); /* condition below ~1e2 */
        ph_sym4 same = c;
        CHECK_OK(ph_sym4_inverse(&same, &same, &err));
        CHECK_ABS(difference(&same, &s), 0.0, 0.0);
    }
    ph_sym4 flat = ph_sym4_isotropic_kg(1.0, 0.0), before = flat;
    CHECK(ph_sym4_inverse(&flat, &flat, &err) == PH_ESINGULAR);
    CHECK_ABS(difference(&flat, &before), 0.0, 0.0); /* untouched */
    ph_sym4 zero = {.n = 3};
    CHECK(ph_sym4_inverse(&zero, &zero, NULL) == PH_ESINGULAR);
    CHECK_END();
}

/* What a solve leaves of a cell that is cut through across axis 2, as it was seen: each
 * pivot is large beside its own diagonal and round-off of the tensor. */
static void test_severed(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    const double left[9] = {3.4, 1e-16, 0, 1e-16, 5e-29, 0, 0, 0, 4e-35};
    ph_sym4 c = ph_sym4_from_voigt(3, left, true), s;
    ph_engineering e;
    CHECK(ph_sym4_inverse(&c, &s, &err) == PH_ESINGULAR);
    CHECK(ph_engineering_constants(&c, &e, &err) == PH_ESINGULAR && isnan(e.nu[0][1]));
    CHECK(!ph_sym4_is_stiffness(&c));
    const double weak[9] = {3.4, 1e-12, 0, 1e-12, 5e-12, 0, 0, 0, 4e-12};
    c = ph_sym4_from_voigt(3, weak,
                           true); /* this one is twelve decades apart, and sound */
    CHECK_OK(ph_engineering_constants(&c, &e, &err));
    CHECK_REL(e.E[1], 5e-12, 1e-9);
    CHECK_END();
}

static void test_eigenvalues(void **state)
{
    (void)state;
    double lo, hi;
    ph_sym4 c = ph_sym4_isotropic_kg(2.0, 0.5); /* 3K once, 2G five times */
    ph_sym4_eigenvalues(&c, &lo, &hi);
    CHECK_ABS(lo, 1.0, ROUND);
    CHECK_ABS(hi, 6.0, ROUND);
    uint64_t seed = check_seed();
    for (int t = 0; t < 20; t++) { /* C - lo I and hi I - C lose their rank */
        ph_sym4 r = random_stiffness(&seed, t % 2 ? 3 : 6), shifted = r;
        ph_sym4_eigenvalues(&r, &lo, &hi);
        CHECK(lo > 0 && lo <= hi);
        for (int i = 0; i < r.n; i++)
            shifted.m[i][i] -= lo * (1 - 1e-9);
        CHECK(ph_sym4_is_stiffness(&shifted));
        for (int i = 0; i < r.n; i++)
            shifted.m[i][i] -= lo * 2e-9;
        CHECK(!ph_sym4_is_stiffness(&shifted));
    }
    CHECK_END();
}

static void test_is_stiffness(void **state)
{
    (void)state;
    ph_sym4 c = ph_sym4_isotropic(1.0, 0.3);
    CHECK(ph_sym4_is_stiffness(&c));
    c.m[0][1] += 1e-3;
    CHECK(!ph_sym4_is_stiffness(&c));
    c = ph_sym4_isotropic(1.0, 0.3);
    c.m[2][2] = NAN;
    CHECK(!ph_sym4_is_stiffness(&c));
    c = ph_sym4_isotropic(1.0, 0.3);
    c.m[3][3] = -1;
    CHECK(!ph_sym4_is_stiffness(&c));
    c.n = 5;
    CHECK(!ph_sym4_is_stiffness(&c));
    CHECK_END();
}

static void test_rotation(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_sym4 iso = ph_sym4_isotropic(3.0, 0.2);
    for (int t = 0; t < check_trials(20); t++) {
        double R[9], Rt[9], a[4];
        random_rotation(&seed, R);
        for (int i = 0; i < 9; i++)
            Rt[i] = R[i % 3 * 3 + i / 3];
        ph_sym4 c = random_stiffness(&seed, 6);
        ph_sym4 turned = ph_sym4_rotate(&iso, R);
        CHECK_ABS(difference(&turned, &iso), 0, ROUND);
        turned = ph_sym4_rotate(&c, R);
        CHECK_REL(ph_sym4_norm(&turned), ph_sym4_norm(&c), ROUND);
        ph_sym4 back = ph_sym4_rotate(&turned, Rt);
        CHECK_ABS(difference(&back, &c), 0, ROUND);
        /* against the definition, for three components */
        CHECK_ABS(turned.m[0][0], rotated_entry(&c, R, 0, 0, 0, 0), ROUND * 10);
        CHECK_ABS(turned.m[1][3] / sqrt(2), rotated_entry(&c, R, 1, 1, 1, 2), ROUND * 10);
        CHECK_ABS(turned.m[3][5] / 2, rotated_entry(&c, R, 1, 2, 0, 1), ROUND * 10);
        /* a plane rotation of the plane block is the block of the rotated tensor */
        double w = check_uniform(&seed, 0, 6.28);
        double P[9] = {cos(w), -sin(w), 0, sin(w), cos(w), 0, 0, 0, 1};
        a[0] = P[0], a[1] = P[1], a[2] = P[3], a[3] = P[4];
        for (int kin = PH_PLANE_STRAIN; kin <= PH_PLANE_STRESS; kin++) {
            ph_sym4 plane, other;
            ph_error err = PH_ERROR_INIT;
            CHECK_OK(ph_sym4_reduce(&c, (ph_kinematics)kin, &plane, &err));
            plane = ph_sym4_rotate(&plane, a);
            other = ph_sym4_rotate(&c, P);
            CHECK_OK(ph_sym4_reduce(&other, (ph_kinematics)kin, &other, &err));
            CHECK_ABS(difference(&plane, &other), 0, 100 * ROUND);
        }
    }
    CHECK_END();
}

static void test_reduce(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    double v[36];
    ph_sym4 c = ph_sym4_isotropic(2.0, 0.3), r, zero = {.n = 6};
    CHECK_OK(ph_sym4_reduce(&c, PH_PLANE_STRESS, &r, &err));
    CHECK(r.n == 3);
    ph_sym4_to_voigt(&r, true, v); /* E/(1-nu^2) [1 nu; nu 1], G */
    CHECK_REL(v[0], 2.0 / 0.91, ROUND);
    CHECK_REL(v[1], 0.6 / 0.91, ROUND);
    CHECK_REL(v[8], 2.0 / 2.6, ROUND);
    CHECK_OK(ph_sym4_reduce(&c, PH_PLANE_STRAIN, &r, &err));
    CHECK_ABS(r.m[0][0], c.m[0][0], 0);
    CHECK_ABS(r.m[2][2], c.m[5][5], 0);
    ph_sym4 again;
    CHECK_OK(ph_sym4_reduce(&r, PH_PLANE_STRAIN, &again, &err));
    CHECK_ABS(difference(&r, &again), 0, 0);
    CHECK_OK(ph_sym4_reduce(&c, PH_GENERALISED_STRAIN, &r, &err));
    CHECK_ABS(difference(&r, &c), 0, 0);
    CHECK_OK(ph_sym4_reduce(&zero, PH_PLANE_STRESS, &r, &err));
    CHECK(r.n == 3 && ph_sym4_norm(&r) == 0.0);
    CHECK(ph_sym4_reduce(&again, PH_SPACE, &r, &err) == PH_EINVAL);
    CHECK(ph_strains(PH_GENERALISED_STRAIN) == 6 &&
          ph_displacements(PH_PLANE_STRESS) == 2);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_voigt_round_trip),
        cmocka_unit_test(test_isotropic_in_voigt),
        cmocka_unit_test(test_inverse),
        cmocka_unit_test(test_severed),
        cmocka_unit_test(test_eigenvalues),
        cmocka_unit_test(test_is_stiffness),
        cmocka_unit_test(test_rotation),
        cmocka_unit_test(test_reduce),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
