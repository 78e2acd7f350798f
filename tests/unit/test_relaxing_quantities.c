/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Quantities at a time or a frequency: E1(t=1), C11_loss(omega=2). */
#include "check.h"

#include <perihom_campaign.h>

static const char text[] =
    "perihom: 1\n"
    "materials: {m: {nu: 0.3, E: {infinity: 3, terms: [{modulus: 17, time: 2}]}}, f: {E: "
    "20, nu: 0.3}}\n"
    "microstructure: {dimension: 2, plane: stress, size: [1, 1], nodes: [8, 8], matrix: "
    "m}\n";

static void test_names(void **state)
{
    (void)state;
    static const struct {
        const char *name, *constant;
        int row, stress;
        double at;
    } good[] = {{"E1(t=1)", "E1", 0, 1, 1},
                {"C66(t=0.5e-3)", "C66", 0, 1, 0.5e-3},
                {"nu12(t=0)", "nu12", 0, 0, 0},
                {"isotropic.K_storage(omega=10)", "isotropic.K", 1, 1, 10},
                {"nu12_loss(omega=3)", "nu12", 2, 0, 3},
                {"G12_tan_delta(omega=3)", "G12", 3, 0, 3}};
    static const char *const bad[] = {
        "E1(t=-1)",  "E1(t=)",      "E1(t=1",       "E1(1)",    "E1(t=nan)",
        "E1(t=inf)", "E1(omega=1)", "E4(t=1)",      "C21(t=1)", "C17(t=1)",
        "C(t=1)",    "(t=1)",       "E1_loss(t=1)", "E1(t=1)x", "nu12_tan_delta(omega=1)",
        "S11(t=1)"};
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        ph_error err = PH_ERROR_INIT;
        ph_quantity q;
        CHECK_OK(ph_quantity_find(good[i].name, &q, &err));
        CHECK(strcmp(q.argument, good[i].constant) == 0 && q.row == good[i].row);
        CHECK(q.at == good[i].at && q.stress == good[i].stress);
        CHECK(ph_quantity_loads(&q, PH_PLANE_STRESS) == 7u);
        CHECK(ph_quantity_refuses(&q, PH_PLANE_STRESS) == NULL);
    }
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        ph_quantity q;
        if (ph_quantity_find(bad[i], &q, NULL) == PH_OK) print_error("%s\n", bad[i]);
        CHECK(ph_quantity_find(bad[i], &q, NULL) == PH_EINVAL);
    }
    ph_quantity q;
    CHECK(ph_quantity_find("E3(t=1)", &q, NULL) == PH_OK &&
          ph_quantity_refuses(&q, PH_PLANE_STRESS) && !ph_quantity_refuses(&q, PH_SPACE));
    CHECK_END();
}

static void test_values(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    static const char *const names[] = {"E1(t=1)",
                                        "E1_storage(omega=2)",
                                        "E1_loss(omega=2)",
                                        "E1_tan_delta(omega=2)",
                                        "nu12(t=5)",
                                        "fraction.m",
                                        "E2"};
    const double x = 4, store = 3 + 17 * x * x / (1 + x * x), loss = 17 * x / (1 + x * x);
    const double want[] = {3 + 17 * exp(-0.5), store, loss, loss / store, 0.3, 1, 20};
    ph_quantity q[7];
    ph_case *c = NULL;
    ph_evaluation e = {0};
    CHECK_OK(ph_case_parse(text, strlen(text), "t", NULL, 0, &c, NULL, &err));
    for (int i = 0; i < 7; i++)
        CHECK_OK(ph_quantity_find(names[i], &q[i], &err));
    const ph_scenario s = {c, 0, 7, q};
    CHECK_OK(ph_scenario_evaluate(&s, &(ph_ctx){.threads = 1}, &e, &err));
    for (int i = 0; i < 7; i++)
        CHECK_REL(e.value[i], want[i], 1e-9);
    ph_case_free(&c);
    /* nothing relaxes: an error, not the elastic value */
    static const char *const elastic[] = {"materials.m.E=3"};
    CHECK_OK(ph_case_parse(text, strlen(text), "t", elastic, 1, &c, NULL, &err));
    const ph_scenario none = {c, 0, 7, q};
    CHECK(ph_scenario_evaluate(&none, &(ph_ctx){.threads = 1}, &e, &err) == PH_EINVAL);
    CHECK(strstr(err.msg, "no material of the case relaxes"));
    ph_case_free(&c);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_names),
        cmocka_unit_test(test_values),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
