/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "check.h"

#include <perihom_campaign.h>

/* A small random case in plane stress, every key of interest open to overrides. */
static const char text[] =
    "perihom: 1\n"
    "materials: {m: {E: 3.5, nu: 0.3}, f: {E: 178, nu: 0.3}}\n"
    "microstructure:\n"
    "  dimension: 2\n"
    "  plane: stress\n"
    "  size: [32, 32]\n"
    "  nodes: [32, 32]\n"
    "  matrix: m\n"
    "  interface: node_centre\n"
    "  fillers: [{shape: platelet, material: f, volume_fraction: 0.05, thickness: 1.0,\n"
    "             aspect_ratio: 12, counting: nodes}]\n";

static ph_case *read_case(const char *const *sets, size_t nsets)
{
    ph_error err = PH_ERROR_INIT;
    ph_case *c = NULL;
    CHECK_OK(ph_case_parse(text, sizeof text - 1, "case", sets, nsets, &c, NULL, &err));
    return c;
}

static int find_all(const char *const *names, int n, ph_quantity *q)
{
    ph_error err = PH_ERROR_INIT;
    for (int i = 0; i < n; i++)
        CHECK_OK(ph_quantity_find(names[i], &q[i], &err));
    return n;
}

static ph_evaluation evaluate(const ph_case *c, uint64_t i, const ph_quantity *q, int n,
                              int threads)
{
    ph_error err = PH_ERROR_INIT;
    ph_evaluation e = {0};
    const ph_scenario s = {c, i, n, q};
    CHECK_OK(ph_scenario_evaluate(&s, &(ph_ctx){.threads = threads}, &e, &err));
    return e;
}

static void test_what_a_case_admits(void **state)
{
    (void)state;
    ph_case *c = read_case(NULL, 0);
    ph_quantity q[5];
    ph_error err = PH_ERROR_INIT;
    find_all((const char *const[]){"E1", "fraction.f", "E1(t=1)", "E3", "fraction.g"}, 5,
             q);
    for (int i = 0; i < 3; i++) /* a time is no material */
        CHECK_OK(ph_scenario_admits(c, &q[i], &err));
    CHECK(ph_scenario_admits(c, &q[3], &err) == PH_EINVAL);
    CHECK(strncmp(err.msg, "E3: ", 4) == 0);
    err = (ph_error)PH_ERROR_INIT;
    CHECK(ph_scenario_admits(c, &q[4], &err) == PH_EINVAL);
    CHECK(strcmp(err.msg, "fraction.g: the case has no material 'g'") == 0);
    CHECK(ph_scenario_admits(NULL, &q[0], NULL) == PH_EINVAL);
    CHECK(ph_scenario_admits(c, NULL, NULL) == PH_EINVAL);
    ph_case_free(&c);
    CHECK_END();
}

static void test_the_same_bits(void **state)
{
    (void)state;
    ph_case *c = read_case(NULL, 0);
    ph_quantity q[3];
    int n = find_all((const char *const[]){"E1", "G12", "fraction.f"}, 3, q);
    ph_evaluation first[3], e;
    for (int k = 0; k < 3; k++)
        first[k] = evaluate(c, (uint64_t)k, q, n, 1);
    for (int k = 2; k >= 0; k--) { /* another order, other numbers of threads */
        e = evaluate(c, (uint64_t)k, q, n, k + 1);
        CHECK(memcmp(e.value, first[k].value, sizeof(double) * 3) == 0);
        CHECK(e.work.iterations == first[k].work.iterations && e.work.iterations > 0);
        /* two mean stresses instead of three strains */
        CHECK(e.work.loads == 2 && e.nodes == 1024 && e.work.peak_bytes > 0 && e.n == 3);
    }
    CHECK(first[0].value[0] != first[1].value[0]);
    /* the realisation of the case is replaced, nothing else: run gives the same number */
    ph_case *third = read_case((const char *const[]){"microstructure.realisation=2"}, 1);
    ph_microstructure *micro = NULL;
    ph_result *r = NULL;
    ph_error err = PH_ERROR_INIT;
    CHECK_OK(ph_rve_build(third, &micro, &err));
    const ph_problem p = {.micro = micro,
                          .interface = third->interface,
                          .model = third->model,
                          .constraint = third->constraint,
                          .solver = third->solver,
                          .nconstants = 2,
                          .constants = q};
    CHECK_OK(ph_homogenise(&p, NULL, &r, &err));
    double E1 = 0;
    CHECK_OK(ph_quantity_value(&q[0], r, &E1, &err));
    CHECK(E1 == first[2].value[0]);
    ph_result_free(&r);
    ph_microstructure_free(&micro);
    ph_case_free(&third);
    ph_case_free(&c);
    CHECK_END();
}

/* The same fillers whatever else changes: with another modulus only the modulus differs. */
static void test_common_random_numbers(void **state)
{
    (void)state;
    ph_case *a = read_case(NULL, 0);
    ph_case *b = read_case((const char *const[]){"materials.f.E=1780"}, 1);
    ph_quantity q[2];
    int n = find_all((const char *const[]){"fraction.f", "C11"}, 2, q);
    for (uint64_t i = 0; i < 4; i++) {
        ph_evaluation x = evaluate(a, i, q, n, 1), y = evaluate(b, i, q, n, 1);
        CHECK(x.value[0] == y.value[0]);
        CHECK(y.value[1] > x.value[1]); /* a stiffer filler in the same place */
    }
    ph_case_free(&a);
    ph_case_free(&b);
    CHECK_END();
}

static void test_only_the_loads_needed(void **state)
{
    (void)state;
    ph_case *c = read_case(NULL, 0);
    ph_quantity q[3];
    find_all((const char *const[]){"C11", "fraction.f", "E1"}, 3, q);
    ph_evaluation one = evaluate(c, 0, q, 1, 1), none = evaluate(c, 0, q + 1, 1, 1);
    ph_evaluation all = evaluate(c, 0, q, 3, 1);
    CHECK(one.work.loads == 1 && none.work.loads == 0 && all.work.loads == 2);
    CHECK(none.work.iterations == 0 && none.value[0] == all.value[1]);
    /* the solver's tolerance is 1e-6 on the residual; the stress average is off by no more
     * than that times the contrast of 50 */
    CHECK_REL(one.value[0], all.value[0], 50 * 1e-6);
    ph_case_free(&c);
    /* a void needs all loads: entries are refined with the fields of all */
    c = read_case((const char *const[]){"materials.f={void: true}"}, 1);
    CHECK(ph_scenario_loads(&(ph_scenario){c, 0, 1, q}) == 7);
    ph_case_free(&c);
    c = read_case((const char *const[]){"materials.f.E=3600"}, 1);
    CHECK(ph_scenario_loads(&(ph_scenario){c, 0, 1, q}) == 7);
    CHECK(ph_scenario_loads(&(ph_scenario){c, 0, 1, q + 1}) == 0);
    ph_case_free(&c);
    CHECK_END();
}

static void test_refusals(void **state)
{
    (void)state;
    ph_case *c = read_case(NULL, 0);
    ph_quantity q[1];
    ph_evaluation e = {.n = -7};
    find_all((const char *const[]){"E3"}, 1, q);
    CHECK(ph_scenario_evaluate(NULL, NULL, &e, NULL) == PH_EINVAL);
    const ph_scenario wrong[] = {{c, 0, 1, q},
                                 {c, 0, 0, q},
                                 {c, 0, PH_MAX_OUTPUTS + 1, q},
                                 {NULL, 0, 1, q},
                                 {c, 0, 1, NULL}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        CHECK(ph_scenario_evaluate(&wrong[i], NULL, &e, NULL) == PH_EINVAL);
    find_all((const char *const[]){"E1"}, 1, q);
    CHECK(ph_scenario_evaluate(&wrong[0], NULL, NULL, NULL) == PH_EINVAL);
    ph_case_free(&c);
    /* the one drawn is longer than the box */
    c = read_case((const char *const[]){"microstructure.fillers.0.aspect_ratio="
                                        "{normal: {mean: 100, std: 1, min: 1}}"},
                  1);
    CHECK(ph_scenario_evaluate(&(ph_scenario){c, 0, 1, q}, NULL, &e, NULL) ==
          PH_EUNPHYSICAL);
    ph_case_free(&c);
    c = read_case((const char *const[]){"solver={tolerance: 1e-12, max_iterations: 2}"},
                  1);
    CHECK(ph_scenario_evaluate(&(ph_scenario){c, 0, 1, q}, NULL, &e, NULL) == PH_ENOCONV);
    ph_case_free(&c);
    CHECK(e.n == -7);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_what_a_case_admits),
        cmocka_unit_test(test_the_same_bits),
        cmocka_unit_test(test_common_random_numbers),
        cmocka_unit_test(test_only_the_loads_needed),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
