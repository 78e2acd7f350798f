/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cells of the map of the extremes (docs/extremes.md): each is solved, flagged or refused, and
 * what is solved is as right as an exact identity can tell. */
#include "extremes.h"

/* Equal shear moduli: the plane bulk modulus is known whatever grid, horizon and geometry.
 * Stress points have only the residual 1e-6 of the solver in the strain, which is off by that
 * times the spread of bulk moduli, 11; nodes an error of the order of horizon / edge. Grids
 * of one and two nodes are one mixture, whose laminate is exact. */
static void test_equal_shear(void **state)
{
    (void)state;
    static const ptrdiff_t nodes[] = {1, 2, 3, 5, 8, 13};
    for (int k = 0; k < 6; k++)
        for (int horizon = 0; horizon <= 2; horizon++) {
            const extreme x = {.nu_matrix = -0.5,
                               .nu_disk = 0.45,
                               .equal_shear = true,
                               .fraction = 0.3,
                               .nodes = nodes[k],
                               .horizon = horizon};
            answer a = ask(&x);
            CHECK(a.outcome == SOLVED);
            CHECK_REL(a.bulk, a.exact_bulk, horizon ? 0.01 * horizon : 1e-5);
            if (nodes[k] <= 2) CHECK(a.iterations == 0);
        }
    CHECK_END();
}

/* A sample of everything with everything. */
static void test_every_cell_has_an_outcome(void **state)
{
    (void)state;
    static const double contrast[] = {0, 1e-6, 1e-3, 0.1, 10, 1e3, 1e6};
    static const double nu[] = {-0.9, 0, 0.3, 0.49, 0.4999};
    static const double fraction[] = {0, 1e-4, 0.1, 0.5, 0.78};
    uint64_t seed = check_seed();
    int count[4] = {0};
    for (int trial = 0; trial < 150 * check_trials(1); trial++) {
        const extreme x = {.contrast = contrast[(int)(7 * check_random(&seed))],
                           .nu_matrix = nu[(int)(5 * check_random(&seed))],
                           .nu_disk = nu[(int)(5 * check_random(&seed))],
                           .fraction = fraction[(int)(5 * check_random(&seed))],
                           .nodes = 1 + (ptrdiff_t)(9 * check_random(&seed)),
                           .horizon = floor(4 * check_random(&seed))};
        answer a = ask(&x);
        count[a.outcome]++;
        if (a.outcome == WRONG)
            print_message("contrast %g nu %g %g fraction %g nodes %td horizon %g: %s\n",
                          x.contrast, x.nu_matrix, x.nu_disk, x.fraction, x.nodes,
                          x.horizon, a.message);
        CHECK(a.outcome != WRONG);
    }
    CHECK(count[SOLVED] > count[REFUSED] && count[SOLVED] > count[FLAGGED]);
    CHECK_END();
}

/* What is known to be beyond reach says so. */
static void test_said_so(void **state)
{
    (void)state;
    const extreme images = {.contrast = 10, .fraction = 0.3, .nodes = 4, .horizon = 3},
                  stiff = {.contrast = 1e6,
                           .nu_matrix = 0.3,
                           .nu_disk = 0.3,
                           .fraction = 0.7,
                           .nodes = 16};
    answer a = ask(&images), b = ask(&stiff);
    CHECK(a.outcome == REFUSED && strstr(a.message, "images"));
    CHECK(b.outcome == FLAGGED); /* rigid disks a cell apart: 140 times too stiff */
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_equal_shear),
                                       cmocka_unit_test(test_every_cell_has_an_outcome),
                                       cmocka_unit_test(test_said_so)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
