/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/estimates.h>

#include "check.h"
#include "tensors.h"

static void test_sphere_is_eshelby(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    for (double nu = -0.4; nu < 0.5; nu += 0.1) { /* Eshelby 1957 */
        ph_sym4 c = ph_sym4_isotropic(2.0, nu), s;
        CHECK_OK(ph_eshelby_tensor(&c, PH_SHAPE_SPHERE, 0, &s, &err));
        CHECK_REL(s.m[0][0], (7 - 5 * nu) / (15 * (1 - nu)), 1e-14);
        CHECK_ABS(s.m[0][2], (5 * nu - 1) / (15 * (1 - nu)), 1e-14);
        CHECK_REL(s.m[3][3] / 2, (4 - 5 * nu) / (15 * (1 - nu)), 1e-14);
    }
    CHECK_END();
}

static void test_cylinder_is_mura(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    const double nu = 0.3, q = 1 / (8 * (1 - nu));
    ph_sym4 c = ph_sym4_isotropic(2.0, nu), s, plane;
    CHECK_OK(ph_eshelby_tensor(&c, PH_SHAPE_CYLINDER, 0, &s, &err));
    CHECK_REL(s.m[0][0], (5 - 4 * nu) * q, 1e-14);
    CHECK_REL(s.m[0][1], (4 * nu - 1) * q, 1e-13);
    CHECK_REL(s.m[0][2], nu / (2 * (1 - nu)), 1e-13);
    CHECK_ABS(s.m[2][2], 0, 0);
    CHECK_ABS(s.m[2][0], 0, 0);
    CHECK_REL(s.m[3][3] / 2, 0.25, 1e-14);
    CHECK_REL(s.m[5][5] / 2, (3 - 4 * nu) * q, 1e-14);
    CHECK_OK(ph_sym4_reduce(&c, PH_PLANE_STRAIN, &plane, &err));
    CHECK_OK(ph_eshelby_tensor(&plane, PH_SHAPE_CYLINDER, 0, &s, &err));
    CHECK_REL(s.m[0][0], (5 - 4 * nu) * q, 1e-14);
    CHECK_REL(s.m[2][2] / 2, (3 - 4 * nu) * q, 1e-14);
    CHECK_END();
}

/* Mura 1987 (11.28), (11.29): spheroid a1 = a2, aspect a = a3/a1. */
static void test_spheroid_is_mura(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    const double nu = 0.25, pi = acos(-1.0), q = 1 / (8 * pi * (1 - nu));
    static const double aspects[] = {0.05, 0.3, 0.6, 1.7, 4, 20};
    for (size_t i = 0; i < sizeof aspects / sizeof *aspects; i++) {
        const double a = aspects[i], a2 = a * a;
        double I1 = a < 1 ? 2 * pi * a / pow(1 - a2, 1.5) * (acos(a) - a * sqrt(1 - a2))
                          : 2 * pi * a / pow(a2 - 1, 1.5) * (a * sqrt(a2 - 1) - acosh(a));
        double I3 = 4 * pi - 2 * I1;
        double I13 = (I1 - I3) / (a2 - 1), I33 = (4 * pi / a2 - 2 * I13) / 3;
        double I12 = (pi - I13 / 4), I11 = I12; /* 3 I11 + I12 + I13 = 4 pi */
        ph_sym4 c = ph_sym4_isotropic(3.0, nu), s;
        CHECK_OK(ph_eshelby_tensor(&c, PH_SHAPE_SPHEROID, a, &s, &err));
        /* these expressions cancel by up to 1e3 */
        CHECK_REL(s.m[0][0], q * (3 * I11 + (1 - 2 * nu) * I1), 1e-11);
        CHECK_REL(s.m[2][2], q * (3 * a2 * I33 + (1 - 2 * nu) * I3), 1e-11);
        CHECK_ABS(s.m[0][1], q * (I12 - (1 - 2 * nu) * I1), 1e-12);
        CHECK_ABS(s.m[0][2], q * (a2 * I13 - (1 - 2 * nu) * I1), 1e-12);
        CHECK_ABS(s.m[2][0], q * (I13 - (1 - 2 * nu) * I3), 1e-12);
        CHECK_REL(s.m[5][5] / 2, q * (I12 + (1 - 2 * nu) * I1), 1e-11);
        CHECK_REL(s.m[4][4] / 2, q / 2 * ((1 + a2) * I13 + (1 - 2 * nu) * (I1 + I3)),
                  1e-11);
    }
    CHECK_END();
}

static void test_closed_form_is_quadrature(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_error err = PH_ERROR_INIT;
    static const double aspects[] = {1e-3,   0.01,    0.2,     0.7, 0.7072, 0.9999, 1,
                                     1.0001, 1.22474, 1.22475, 3,   100,    1000};
    for (size_t i = 0; i < sizeof aspects / sizeof *aspects; i++) {
        ph_sym4 c = ph_sym4_isotropic(1, check_uniform(&seed, -0.5, 0.49)), p, q;
        CHECK_OK(ph_hill_tensor(&c, PH_SHAPE_SPHEROID, aspects[i], &p, &err));
        CHECK_OK(ph_hill_tensor_quadrature(&c, PH_SHAPE_SPHEROID, aspects[i], &q, &err));
        CHECK_ABS(difference(&p, &q), 0,
                  1e-11); /* ten times the quadrature's tolerance */
    }
    ph_sym4 c = ph_sym4_isotropic(1, 0.3), p, q;
    CHECK_OK(ph_hill_tensor(&c, PH_SHAPE_CYLINDER, 0, &p, &err));
    CHECK_OK(ph_hill_tensor_quadrature(&c, PH_SHAPE_CYLINDER, 0, &q, &err));
    CHECK_ABS(difference(&p, &q), 0, 1e-13);
    CHECK_OK(ph_sym4_reduce(&c, PH_PLANE_STRESS, &c, &err));
    CHECK_OK(ph_hill_tensor(&c, PH_SHAPE_CYLINDER, 0, &p, &err));
    CHECK_OK(ph_hill_tensor_quadrature(&c, PH_SHAPE_CYLINDER, 0, &q, &err));
    CHECK_ABS(difference(&p, &q), 0, 1e-13);
    CHECK_END();
}

/* The two formulas meet where the code changes from one to the other. */
static void test_no_jump_where_the_formula_changes(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_sym4 c = ph_sym4_isotropic(1, 0.2), p, q;
    const double turn[] = {sqrt(0.5), sqrt(1.5)};
    for (int i = 0; i < 2; i++) {
        CHECK_OK(ph_hill_tensor(&c, PH_SHAPE_SPHEROID, turn[i] * (1 - 1e-14), &p, &err));
        CHECK_OK(ph_hill_tensor(&c, PH_SHAPE_SPHEROID, turn[i] * (1 + 1e-14), &q, &err));
        CHECK_ABS(difference(&p, &q), 0, 2e-14);
    }
    CHECK_END();
}

/* Extreme shapes: laminate and cylinder, to first order in the aspect and its inverse; the
 * softest direction of C0 - C0 P C0 of a crack keeps its digits. */
static void test_extreme_aspects(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    const double nu = 0.3, G = 1 / 2.6, pi = acos(-1.0);
    const double R[9] = {0, 0, 1, 0, 1, 0, -1, 0, 0}; /* axis 1 to axis 3 */
    ph_sym4 c = ph_sym4_isotropic(1, nu), p, layer, fibre, s;
    CHECK_OK(ph_hill_tensor(&c, PH_SHAPE_LAMINATE, 0, &layer, &err));
    layer = ph_sym4_rotate(&layer, R);
    CHECK_OK(ph_hill_tensor(&c, PH_SHAPE_CYLINDER, 0, &fibre, &err));
    CHECK_OK(ph_hill_tensor(&c, PH_SHAPE_SPHEROID, 1e-6, &p, &err));
    CHECK_ABS(difference(&p, &layer), 0, 3e-6);
    CHECK_OK(ph_hill_tensor(&c, PH_SHAPE_SPHEROID, 1e6, &p, &err));
    CHECK_ABS(difference(&p, &fibre), 0, 1e-10); /* a^-2 log a */
    CHECK_REL(p.m[2][2], (log(2e6) - 1 - 1 / (4 * (1 - nu))) / 1e12 / G, 1e-9);
    /* Penny: 1 - S3333 = pi a (1 - 2 nu)/(4 (1 - nu)) ... (Mura 11.23) */
    CHECK_OK(ph_eshelby_tensor(&c, PH_SHAPE_SPHEROID, 1e-6, &s, &err));
    CHECK_REL(1 - s.m[2][2], pi * 1e-6 * (1 - 2 * nu) / (4 * (1 - nu)), 1e-5);
    CHECK_REL(s.m[0][0], pi * 1e-6 * (13 - 8 * nu) / (32 * (1 - nu)), 1e-5);
    CHECK(ph_hill_tensor(&c, PH_SHAPE_SPHEROID, 1e-7, &p, NULL) == PH_EINVAL);
    CHECK(ph_hill_tensor(&c, PH_SHAPE_SPHEROID, NAN, &p, NULL) == PH_EINVAL);
    CHECK(ph_hill_tensor(&(ph_sym4){.n = 6}, PH_SHAPE_SPHERE, 1, &p, NULL) != PH_OK);
    CHECK_OK(ph_sym4_reduce(&c, PH_PLANE_STRAIN, &c, &err));
    CHECK(ph_hill_tensor(&c, PH_SHAPE_SPHERE, 1, &p, NULL) == PH_EINVAL);
    CHECK_END();
}

/* Anisotropic media: the tensor turns with medium and shape, is symmetric and positive,
 * and a sphere of a cubic medium has the symmetry of the cube. */
static void test_anisotropic(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_error err = PH_ERROR_INIT;
    for (int t = 0; t < 3; t++) {
        double R[9], lo;
        random_rotation(&seed, R);
        ph_sym4 c = random_stiffness(&seed, 6), p, q;
        for (int i = 0; i < 6; i++)
            c.m[i][i] += 2; /* anisotropy that 1e-10 can resolve */
        CHECK_OK(ph_hill_tensor(&c, PH_SHAPE_SPHERE, 0, &p, &err));
        ph_sym4_eigenvalues(&p, &lo, NULL);
        CHECK(lo > 0);
        c = ph_sym4_rotate(&c, R);
        CHECK_OK(ph_hill_tensor(&c, PH_SHAPE_SPHERE, 0, &q, &err));
        p = ph_sym4_rotate(&p, R);
        CHECK_ABS(difference(&p, &q), 0, 1e-10);
        double w = check_uniform(&seed, 0, 3),
               Z[9] = {cos(w), -sin(w), 0, sin(w), cos(w), 0, 0, 0, 1};
        CHECK_OK(ph_hill_tensor(&c, PH_SHAPE_CYLINDER, 0, &p, &err));
        p = ph_sym4_rotate(&p, Z);
        c = ph_sym4_rotate(&c, Z);
        CHECK_OK(ph_hill_tensor(&c, PH_SHAPE_CYLINDER, 0, &q, &err));
        CHECK_ABS(difference(&p, &q), 0, 1e-10);
    }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sphere_is_eshelby),
        cmocka_unit_test(test_cylinder_is_mura),
        cmocka_unit_test(test_spheroid_is_mura),
        cmocka_unit_test(test_closed_form_is_quadrature),
        cmocka_unit_test(test_no_jump_where_the_formula_changes),
        cmocka_unit_test(test_extreme_aspects),
        cmocka_unit_test(test_anisotropic),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
