/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Simple-cubic spheres, fraction 0.2, E 1 and 10, nu 0.3 both: exact values from body-fitted
 * spectral elements. */
#include "solve.h"

/* C11, C12 from a pull along 1, C44 from a shear: two loads of six say all. */
static void check_grid(ptrdiff_t n, double tol)
{
    ph_microstructure *m = round_cell(PH_SPACE, n, 0.2, isotropic("matrix", 1.0, 0.3),
                                      isotropic("sphere", 10.0, 0.3));
    ph_problem p = {.micro = m, .loads = 1u | 8u};
    p.model.points = PH_POINTS_STRESS;
    ph_result *res = homogenise(&p);
    if (res) {
        const ph_sym4 *c = &res->stiffness;
        CHECK_REL(c->m[0][0], 1.879899, tol);
        CHECK_REL(c->m[1][0], 0.723387, tol);
        CHECK_REL(c->m[2][0], 0.723387, tol);
        CHECK_REL(0.5 * c->m[3][3], 0.524211, tol);
        CHECK(most_iterations(res) <= 25);
    }
    ph_result_free(&res);
    ph_microstructure_free(&m);
    CHECK_END();
}

/* First order in h; measured 0.61, 0.19, 0.085 % (worst is C44). */
static void test_16(void **state)
{
    (void)state, check_grid(16, 8e-3);
}
static void test_32(void **state)
{
    (void)state, check_grid(32, 2.5e-3);
}
static void test_64(void **state)
{
    (void)state, check_grid(64, 1e-3);
}

/* A cubic cell has a cubic tensor: the three axes see the same. */
static void test_cubic(void **state)
{
    (void)state;
    ph_microstructure *m = round_cell(PH_SPACE, 12, 0.2, isotropic("matrix", 1.0, 0.3),
                                      isotropic("sphere", 10.0, 0.3));
    ph_problem p = {.micro = m};
    ph_sym4 c = stiffness_of(&p);
    /* symmetry of the discrete problem; what is left is the solver's 1e-6, squared in C */
    for (int i = 1; i <= 3; i++) {
        CHECK_REL(voigt(&c, i, i), voigt(&c, 1, 1), 1e-9);
        CHECK_REL(voigt(&c, i + 3, i + 3), voigt(&c, 4, 4), 1e-9);
        CHECK_REL(voigt(&c, i, i % 3 + 1), voigt(&c, 1, 2), 1e-9);
        for (int j = 4; j <= 6; j++)
            CHECK_ABS(voigt(&c, i, j), 0.0, 1e-6);
    }
    ph_microstructure_free(&m);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_16), cmocka_unit_test(test_32), cmocka_unit_test(test_64),
        cmocka_unit_test(test_cubic)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
