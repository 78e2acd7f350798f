/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/tensor.h>

#include "check.h"
#include "tensors.h"

static void test_isotropic(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_engineering e;
    ph_sym4 c = ph_sym4_isotropic(3, 0.2);
    CHECK_OK(ph_engineering_constants(&c, &e, &err));
    for (int i = 0; i < 3; i++) {
        CHECK_REL(e.E[i], 3.0, 1e-14);
        for (int j = 0; j < 3; j++)
            if (i != j) CHECK_REL(e.nu[i][j], 0.2, 1e-13);
    }
    CHECK_REL(e.G12, 1.25, 1e-14);
    CHECK_REL(e.G13, 1.25, 1e-14);
    CHECK_REL(e.G23, 1.25, 1e-14);
    CHECK_END();
}

static void test_orthotropic(void **state)
{
    (void)state;
    /* E1 10 E2 5 E3 2, nu12 .3 nu13 .2 nu23 .1, G23 1 G13 2 G12 3 by their definition */
    double s[36] = {0.1,   -0.03, -0.02, 0, 0,  0, -0.03, 0.2, -0.02, 0, 0, 0,
                    -0.02, -0.02, 0.5,   0, 0,  0, 0,     0,   0,     1, 0, 0,
                    0,     0,     0,     0, .5, 0, 0,     0,   0,     0, 0, 1. / 3};
    ph_error err = PH_ERROR_INIT;
    ph_engineering e;
    ph_sym4 c = ph_sym4_from_voigt(6, s, false);
    CHECK_OK(ph_sym4_inverse(&c, &c, &err));
    CHECK_OK(ph_engineering_constants(&c, &e, &err));
    CHECK_REL(e.E[0], 10, 1e-13);
    CHECK_REL(e.E[1], 5, 1e-13);
    CHECK_REL(e.E[2], 2, 1e-13);
    CHECK_REL(e.nu[0][1], 0.3, 1e-13);
    CHECK_REL(e.nu[1][0], 0.15, 1e-13);
    CHECK_REL(e.nu[0][2], 0.2, 1e-13);
    CHECK_REL(e.nu[2][1], 0.04, 1e-13);
    CHECK_REL(e.G23, 1, 1e-13);
    CHECK_REL(e.G13, 2, 1e-13);
    CHECK_REL(e.G12, 3, 1e-13);
    CHECK(isnan(e.nu[0][0]));
    CHECK_END();
}

static void test_plane(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_engineering e;
    ph_sym4 c = ph_sym4_isotropic(3, 0.2), p;
    CHECK_OK(ph_sym4_reduce(&c, PH_PLANE_STRESS, &p, &err));
    CHECK_OK(ph_engineering_constants(&p, &e, &err));
    CHECK_REL(e.E[0], 3, 1e-14);
    CHECK_REL(e.nu[1][0], 0.2, 1e-13);
    CHECK_REL(e.G12, 1.25, 1e-14);
    CHECK(isnan(e.E[2]) && isnan(e.nu[0][2]) && isnan(e.G23) && isnan(e.G13));
    CHECK_OK(ph_sym4_reduce(&c, PH_PLANE_STRAIN, &p, &err));
    CHECK_OK(ph_engineering_constants(&p, &e, &err));
    CHECK_REL(e.E[1], 3 / (1 - 0.04), 1e-14); /* E/(1-nu^2), nu/(1-nu) */
    CHECK_REL(e.nu[0][1], 0.25, 1e-13);
    ph_sym4 zero = {.n = 6};
    CHECK(ph_engineering_constants(&zero, &e, &err) == PH_ESINGULAR && isnan(e.E[0]));
    CHECK_END();
}

static void test_nearest_isotropic(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_error err = PH_ERROR_INIT;
    ph_sym4 c = ph_sym4_isotropic(3, 0.2), p;
    ph_isotropic i = ph_nearest_isotropic(&c, PH_SPACE);
    CHECK_REL(i.E, 3, 1e-14);
    CHECK_REL(i.nu, 0.2, 1e-13);
    CHECK_REL(i.K, 3 / 1.8, 1e-14);
    CHECK_ABS(i.distance, 0, 1e-15);
    CHECK_OK(ph_sym4_reduce(&c, PH_PLANE_STRESS, &p, &err));
    i = ph_nearest_isotropic(&p, PH_PLANE_STRESS);
    CHECK_REL(i.E, 3, 1e-14);
    CHECK_REL(i.nu, 0.2, 1e-13);
    CHECK_REL(i.K, 3 / (2 * 0.8), 1e-14);
    for (int t = 0; t < 20;
         t++) { /* no other isotropic tensor is nearer; turning is harmless */
        double R[9];
        c = random_stiffness(&seed, 6);
        i = ph_nearest_isotropic(&c, PH_SPACE);
        for (int k = 0; k < 4; k++) {
            ph_sym4 near =
                ph_sym4_isotropic_kg(i.K + 0.01 * (k - 1.5), i.G + 0.01 * (k % 2 - .5));
            CHECK(difference(&near, &c) > i.distance);
        }
        random_rotation(&seed, R);
        c = ph_sym4_rotate(&c, R);
        ph_isotropic j = ph_nearest_isotropic(&c, PH_SPACE);
        CHECK_REL(j.K, i.K, 1e-13);
        CHECK_REL(j.G, i.G, 1e-13);
        CHECK_REL(j.distance, i.distance, 1e-12);
    }
    ph_sym4 zero = {.n = 3};
    i = ph_nearest_isotropic(&zero, PH_PLANE_STRAIN);
    CHECK(isnan(i.E) && i.K == 0 && i.distance == 0);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_isotropic),
        cmocka_unit_test(test_orthotropic),
        cmocka_unit_test(test_plane),
        cmocka_unit_test(test_nearest_isotropic),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
