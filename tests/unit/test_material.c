/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/material.h>

#include "check.h"
#include "tensors.h"

static void test_isotropic(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_material m;
    CHECK_OK(ph_material_isotropic("resin", 3.0, 0.38, &m, &err));
    CHECK(m.is_isotropic && !m.is_void && strcmp(m.name, "resin") == 0 &&
          isnan(m.density));
    ph_sym4 want = ph_sym4_isotropic(3.0, 0.38);
    CHECK_ABS(difference(&m.stiffness, &want), 0, 0);
    static const double bad[][2] = {{-1, 0.3}, {0, 0.3},  {NAN, 0.3}, {INFINITY, 0.3},
                                    {1, 0.5},  {1, -1.0}, {1, NAN},   {1, 0.62}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        ph_error e = PH_ERROR_INIT;
        CHECK(ph_material_isotropic("x", bad[i][0], bad[i][1], &m, &e) == PH_EUNPHYSICAL);
        CHECK(strstr(e.msg, "'x'") != NULL && strstr(e.msg, "got") != NULL);
    }
    CHECK(strcmp(m.name, "resin") == 0); /* failures leave the output alone */
    CHECK_END();
}

static void test_anisotropic(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    double v[36], R[9];
    ph_material m;
    ph_sym4 c = random_stiffness(&seed, 6);
    random_rotation(&seed, R);
    ph_sym4_to_voigt(&c, true, v);
    CHECK_OK(ph_material_anisotropic("ply", v, NULL, &m, &err));
    CHECK(!m.is_isotropic && isnan(m.E) && difference(&m.stiffness, &c) < 1e-14);
    CHECK_OK(ph_material_anisotropic("ply", v, R, &m, &err));
    c = ph_sym4_rotate(&c, R);
    CHECK(difference(&m.stiffness, &c) < 1e-14);
    v[1] += 0.01;
    CHECK(ph_material_anisotropic("ply", v, NULL, &m, &err) == PH_EUNPHYSICAL);
    CHECK(strstr(err.msg, "C12") != NULL);
    v[1] -= 0.01;
    v[0] = -v[0];
    err = (ph_error)PH_ERROR_INIT;
    CHECK(ph_material_anisotropic("ply", v, NULL, &m, &err) == PH_EUNPHYSICAL);
    CHECK(strstr(err.msg, "positive definite") != NULL);
    v[0] = NAN;
    CHECK(ph_material_anisotropic("ply", v, NULL, &m, NULL) == PH_EUNPHYSICAL);
    CHECK_END();
}

static void test_void(void **state)
{
    (void)state;
    ph_material m = ph_material_void("a name that is much longer than the sixty-three "
                                     "characters that a material name may have");
    CHECK(m.is_void && m.stiffness.n == 6 && ph_sym4_norm(&m.stiffness) == 0);
    CHECK(strlen(m.name) == sizeof m.name - 1);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_isotropic),
        cmocka_unit_test(test_anisotropic),
        cmocka_unit_test(test_void),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
