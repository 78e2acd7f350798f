/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/quantity.h>

#include "check.h"

/* A result with the orthotropic tensor E1 10 E2 5 E3 2, nu12 .3 nu13 .2 nu23 .1,
 * G23 1 G13 2 G12 3. */
static ph_result orthotropic(void)
{
    double s[36] = {0.1,   -0.03, -0.02, 0, 0,  0, -0.03, 0.2, -0.02, 0, 0, 0,
                    -0.02, -0.02, 0.5,   0, 0,  0, 0,     0,   0,     1, 0, 0,
                    0,     0,     0,     0, .5, 0, 0,     0,   0,     0, 0, 1. / 3};
    static char names[3][64] = {"matrix", "fibre", "fibre"};
    static double fractions[3] = {0.5, 0.3, 0.2};
    ph_result r = {.grid = {.kinematics = PH_SPACE, .n = {1, 1, 1}}, .loads = 63};
    r.stiffness = ph_sym4_from_voigt(6, s, false);
    ph_sym4_inverse(&r.stiffness, &r.stiffness, NULL);
    r.nmaterials = 3;
    r.names = names;
    r.fractions = fractions;
    return r;
}

static double value(const char *name, const ph_result *r)
{
    ph_error err = PH_ERROR_INIT;
    ph_quantity q;
    double x = NAN;
    CHECK_OK(ph_quantity_find(name, &q, &err));
    CHECK_OK(ph_quantity_value(&q, r, &x, &err));
    return x;
}

static void test_values(void **state)
{
    (void)state;
    const ph_result r = orthotropic();
    const struct {
        const char *name;
        double want;
    } row[] = {{"E1", 10},      {"E2", 5},     {"E3", 2},      {"nu12", 0.3},
               {"nu21", 0.15},  {"nu13", .2},  {"nu31", 0.04}, {"nu23", .1},
               {"nu32", .04},   {"G23", 1},    {"G13", 2},     {"G12", 3},
               {"C66", 3},      {"C44", 1},    {"C14", 0},     {"S11", 0.1},
               {"S66", 1 / 3.}, {"S12", -0.03}};
    for (size_t i = 0; i < sizeof row / sizeof *row; i++)
        CHECK_ABS(value(row[i].name, &r), row[i].want, 1e-13);
    /* sum over j of C_1j S_j1 = 1 */
    double one = value("C11", &r) * value("S11", &r) +
                 value("C12", &r) * value("S21", &r) +
                 value("C13", &r) * value("S31", &r);
    CHECK_REL(one, 1.0, 1e-13);
    CHECK_REL(value("fraction.fibre", &r), 0.5, 1e-15);
    CHECK_END();
}

static void test_isotropic_tensor(void **state)
{
    (void)state;
    ph_result r = orthotropic();
    r.stiffness = ph_sym4_isotropic(3, 0.2);
    CHECK_REL(value("isotropic.E", &r), 3, 1e-13);
    CHECK_REL(value("isotropic.nu", &r), 0.2, 1e-13);
    CHECK_REL(value("isotropic.K", &r), 3 / (3 * 0.6), 1e-13);
    CHECK_REL(value("isotropic.G", &r), 1.25, 1e-13);
    CHECK_ABS(value("isotropic.distance", &r), 0, 1e-14);
    r.grid.kinematics = PH_PLANE_STRESS;
    r.loads = 7;
    ph_sym4 space = r.stiffness;
    ph_sym4_reduce(&space, PH_PLANE_STRESS, &r.stiffness, NULL);
    CHECK_REL(value("stretch.E1", &r), 3, 1e-13);
    CHECK_REL(value("stretch.E2", &r), 3, 1e-13);
    CHECK_REL(value("C66", &r), 1.25, 1e-13);
    CHECK_REL(value("E2", &r), 3, 1e-13);
    CHECK_END();
}

static unsigned loads(const char *name, ph_kinematics kin)
{
    ph_quantity q;
    CHECK(ph_quantity_find(name, &q, NULL) == PH_OK);
    return ph_quantity_loads(&q, kin);
}

static void test_loads(void **state)
{
    (void)state;
    CHECK(loads("C11", PH_SPACE) == 1 && loads("C21", PH_SPACE) == 1);
    CHECK(loads("C66", PH_SPACE) == 32 && loads("C66", PH_PLANE_STRAIN) == 4);
    CHECK(loads("E1", PH_SPACE) == 63 && loads("S11", PH_PLANE_STRESS) == 7);
    CHECK(loads("isotropic.K", PH_GENERALISED_STRAIN) == 7);
    CHECK(loads("isotropic.K", PH_PLANE_STRESS) == 3);
    CHECK(loads("stretch.E2", PH_PLANE_STRESS) == 2);
    CHECK(loads("fraction.x", PH_SPACE) == 0);
    CHECK_END();
}

/* An entry comes from whichever of its two columns is there; nothing else does. */
static void test_partial_results(void **state)
{
    (void)state;
    ph_result r = orthotropic();
    ph_quantity q;
    ph_error err = PH_ERROR_INIT;
    double x = -1;
    const double want = value("C12", &r);
    r.loads = 2; /* column 2 only */
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++)
            if (j != 1) r.stiffness.m[i][j] = 0;
    CHECK(value("C12", &r) == want && value("C21", &r) == want);
    const char *const lost[] = {"C11", "E1", "S12", "isotropic.K", "isotropic.E"};
    for (size_t i = 0; i < sizeof lost / sizeof *lost; i++) {
        CHECK_OK(ph_quantity_find(lost[i], &q, &err));
        CHECK(ph_quantity_value(&q, &r, &x, NULL) == PH_EINVAL);
        CHECK(x == -1);
    }
    CHECK_END();
}

static void test_refusals(void **state)
{
    (void)state;
    ph_quantity q;
    const struct {
        const char *name;
        ph_kinematics kin;
        bool refused;
    } row[] = {{"E3", PH_PLANE_STRESS, true},
               {"E3", PH_GENERALISED_STRAIN, false},
               {"nu13", PH_PLANE_STRAIN, true},
               {"nu21", PH_PLANE_STRAIN, false},
               {"G12", PH_PLANE_STRAIN, false},
               {"G23", PH_PLANE_STRAIN, true},
               {"C33", PH_PLANE_STRESS, true},
               {"C66", PH_PLANE_STRESS, false},
               {"S45", PH_SPACE, false},
               {"stretch.E1", PH_SPACE, true},
               {"stretch.E1", PH_PLANE_STRESS, false}};
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        CHECK(ph_quantity_find(row[i].name, &q, NULL) == PH_OK);
        CHECK((ph_quantity_refuses(&q, row[i].kin) != NULL) == row[i].refused);
    }
    CHECK_END();
}

static void test_names(void **state)
{
    (void)state;
    ph_quantity q = {.row = 77};
    const char *const bad[] = {"",          "e",         "E4",        "nu11", "nu123",
                               "G11",       "C1",        "C07",       "C111", "fraction",
                               "fraction.", "isotropic", "stretch.E3"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        CHECK(ph_quantity_find(bad[i], &q, NULL) == PH_EINVAL);
    char longest[400];
    memset(longest, 'E', sizeof longest);
    longest[sizeof longest - 1] = 0;
    CHECK(ph_quantity_find(longest, &q, NULL) == PH_EINVAL);
    CHECK(ph_quantity_find(NULL, &q, NULL) == PH_EINVAL);
    CHECK(ph_quantity_find("E1", NULL, NULL) == PH_EINVAL);
    CHECK(q.row == 77);
    ph_error err = PH_ERROR_INIT;
    CHECK(ph_quantity_find("isotropc.E", &q, &err) == PH_EINVAL);
    CHECK(strstr(err.msg, "'isotropic.E'"));
    /* every word that is suggested is one */
    for (size_t k = 0; k < ph_nquantity_kinds; k++)
        for (size_t i = 0; ph_quantity_kinds[k].word(i); i++) {
            CHECK(ph_quantity_find(ph_quantity_kinds[k].word(i), &q, NULL) == PH_OK);
            CHECK(q.kind == &ph_quantity_kinds[k]);
        }
    CHECK_END();
}

static void test_no_number(void **state)
{
    (void)state;
    ph_result r = orthotropic();
    ph_quantity q;
    double x = 5;
    r.stiffness.m[0][0] = NAN;
    CHECK(ph_quantity_find("C11", &q, NULL) == PH_OK);
    CHECK(ph_quantity_value(&q, &r, &x, NULL) == PH_ESINGULAR);
    CHECK(ph_quantity_find("E1", &q, NULL) == PH_OK);
    CHECK(ph_quantity_value(&q, &r, &x, NULL) == PH_ESINGULAR);
    CHECK(ph_quantity_value(&q, NULL, &x, NULL) == PH_EINVAL);
    CHECK(ph_quantity_find("fraction.none", &q, NULL) == PH_OK);
    CHECK(ph_quantity_value(&q, &r, &x, NULL) == PH_EINVAL);
    CHECK(x == 5);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_values),    cmocka_unit_test(test_isotropic_tensor),
        cmocka_unit_test(test_loads),     cmocka_unit_test(test_partial_results),
        cmocka_unit_test(test_refusals),  cmocka_unit_test(test_names),
        cmocka_unit_test(test_no_number),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
