/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Automatic fidelity on random cells: what it offers is within the accuracy asked for. The large
 * study is docs/make_accuracy.py; this is a small one of the same kind. */
#include "check.h"

#include <perihom_fidelity.h>

enum { CELLS = 5 };

/* One to three disks or ellipses of one material, contrast 0.1 to 30. */
static void random_cell(uint64_t *seed, char *text, size_t size)
{
    static const char *const plane[] = {"strain", "stress", "generalised_strain"};
    int n = 1 + (int)(3 * check_random(seed));
    size_t at = (size_t)snprintf(
        text, size,
        "perihom: 1\nmaterials: {m: {E: 1, nu: %.3f}, f: {E: %.4g, nu: %.3f}}\n"
        "microstructure:\n  dimension: 2\n  plane: %s\n  size: [1, 1]\n  matrix: m\n"
        "  inclusions:\n",
        check_uniform(seed, 0.1, 0.4), pow(10, check_uniform(seed, -1, 1.5)),
        check_uniform(seed, 0.1, 0.4), plane[(int)(3 * check_random(seed))]);
    for (int i = 0; i < n; i++) {
        double r = check_uniform(seed, 0.1, 0.4 / sqrt(n));
        at += (size_t)snprintf(
            text + at, size - at,
            "    - {shape: ellipse, centre: [%.4f, %.4f], semi_axes: [%.4f, %.4f], "
            "angle: %.1f, material: f}\n",
            check_random(seed), check_random(seed), r, r * check_uniform(seed, 0.4, 1),
            check_uniform(seed, 0, 180));
    }
    snprintf(text + at, size - at, "accuracy: {relative: 0.01}\n");
}

static ph_case *read_case(const char *text, const char *const *sets, size_t n)
{
    ph_error err = PH_ERROR_INIT;
    ph_case *c = NULL;
    CHECK_OK(ph_case_parse(text, strlen(text), "cell", sets, n, &c, NULL, &err));
    return c;
}

/* Constants extrapolated from 48 and 96 nodes: off by a fifth of what is asked for here. */
static void reference_of(const char *text, const ph_quantity *q, int n, double *out)
{
    static const char *const nodes[] = {"microstructure.nodes=[48, 48]",
                                        "microstructure.nodes=[96, 96]"};
    for (int g = 0; g < 2; g++) {
        ph_error err = PH_ERROR_INIT;
        const char *const sets[] = {nodes[g], "solver.tolerance=1e-4"};
        ph_case *c = read_case(text, sets, 2);
        ph_evaluation e = {0};
        const ph_scenario s = {c, 0, n, q};
        if (c) CHECK_OK(ph_scenario_evaluate(&s, NULL, &e, &err));
        for (int k = 0; k < n; k++)
            out[k] = g ? 2 * e.value[k] - out[k] : e.value[k];
        ph_case_free(&c);
    }
}

static bool is_within(const char *text, double accuracy, const ph_quantity *q, int n,
                      const double *reference)
{
    char set[64];
    ph_error err = PH_ERROR_INIT;
    ph_fidelity *f = NULL;
    snprintf(set, sizeof set, "accuracy.relative=%g", accuracy);
    const char *const sets[] = {set};
    ph_case *c = read_case(text, sets, 1);
    double worst = 0;
    if (c) CHECK_OK(ph_fidelity_solve(c, NULL, &f, &err));
    CHECK(f && f->reached && f->error <= accuracy);
    for (int k = 0; f && k < n; k++) {
        double x = NAN;
        CHECK_OK(ph_quantity_value(&q[k], f->result, &x, &err));
        worst = fmax(worst, ph_trade_error(&q[k], x, reference[k]));
    }
    bool good = f && worst <= accuracy;
    if (!good) print_message("%g: off by %g\n%s", accuracy, worst, text);
    ph_fidelity_free(&f);
    ph_case_free(&c);
    return good;
}

static void test_random_cells(void **state)
{
    (void)state;
    static const double accuracy[] = {0.03, 0.01};
    uint64_t seed = check_seed();
    int trials = check_trials(CELLS), within = 0;
    for (int i = 0; i < trials; i++) {
        char text[2048];
        ph_quantity q[PH_TRADE_CONSTANTS];
        double reference[PH_TRADE_CONSTANTS] = {0};
        random_cell(&seed, text, sizeof text);
        ph_case *c = read_case(text, NULL, 0);
        int n = c ? ph_trade_constants(c, q) : 0;
        CHECK(n >= 3);
        reference_of(text, q, n, reference);
        for (int a = 0; a < 2; a++)
            within += is_within(text, accuracy[a], q, n, reference);
        ph_case_free(&c);
    }
    /* 95 % of many: of 10, two misses or fewer have a probability of 99 % */
    print_message("%d of %d within\n", within, 2 * trials);
    CHECK(within >= 0.8 * 2 * trials);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_random_cells)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
