/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "check.h"
#include "core/nnls.h"

enum { ROWS = 30, COLUMNS = 8 };

/* The conditions of Karush, Kuhn and Tucker hold: x >= 0, the gradient is zero where x > 0
 * and not negative elsewhere. They are sufficient: the problem is convex. */
static void check_optimal(int m, int n, const double *a, const double *x, double rss)
{
    double residual[ROWS], sum = 0, size = 0;
    for (int i = 0; i < m; i++) {
        residual[i] = a[n * m + i];
        for (int k = 0; k < n; k++)
            residual[i] -= a[k * m + i] * x[k];
        sum += residual[i] * residual[i];
        size += a[n * m + i] * a[n * m + i];
    }
    CHECK_ABS(rss, sum, 1e-12 * size);
    for (int k = 0; k < n; k++) {
        double w = 0, length = 0;
        for (int i = 0; i < m; i++) {
            w += a[k * m + i] * residual[i];
            length += a[k * m + i] * a[k * m + i];
        }
        CHECK(x[k] >= 0);
        /* rounding of some tens of terms of size |a| |b| */
        CHECK(w <= 1e-13 * sqrt(length * size));
        if (x[k] > 0) CHECK_ABS(w, 0, 1e-13 * sqrt(length * size));
    }
}

static void test_optimality(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    for (int trial = 0; trial < check_trials(200); trial++) {
        int n = 1 + (int)check_uniform(&seed, 0, COLUMNS);
        int m = trial % 5 == 0 ? n / 2 + 1 : ROWS; /* also fewer rows than columns */
        double a[(COLUMNS + 1) * ROWS], copy[(COLUMNS + 1) * ROWS], x[COLUMNS], rss;
        for (int k = 0; k < (n + 1) * m; k++)
            a[k] = copy[k] = check_uniform(&seed, trial % 3 ? -1 : 0, 1) *
                             pow(10, trial % 7 ? 0 : 3 * (k / m)); /* unlike columns */
        CHECK_OK(ph_i_nnls(m, n, copy, x, &rss, &err));
        check_optimal(m, n, a, x, rss);
    }
    CHECK_END();
}

static void test_exact_solution(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    double a[(COLUMNS + 1) * ROWS] = {0}, x[COLUMNS], rss;
    for (int k = 0; k < COLUMNS * ROWS; k++)
        a[k] = check_uniform(&seed, 0, 1);
    for (int i = 0; i < ROWS; i++) /* 3, 0, 2, 0 ... */
        a[COLUMNS * ROWS + i] = 3 * a[i] + 2 * a[2 * ROWS + i];
    CHECK_OK(ph_i_nnls(ROWS, COLUMNS, a, x, &rss, &err));
    for (int k = 0; k < COLUMNS; k++)
        CHECK_ABS(x[k], k == 0 ? 3 : k == 2 ? 2 : 0, 1e-12);
    CHECK(rss < 1e-24);
    CHECK_END();
}

static void test_degenerate(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    /* a column of zeros, two equal columns, b against all of them */
    double a[4 * 3] = {0, 0, 0, 1, 2, 3, 1, 2, 3, 1, 2, 3}, x[3], rss;
    CHECK_OK(ph_i_nnls(3, 3, a, x, &rss, &err));
    CHECK_ABS(x[1] + x[2], 1, 1e-14);
    CHECK(x[0] == 0 && rss < 1e-28);
    double b[2 * 3] = {1, 2, 3, -1, -1, -1};
    CHECK_OK(ph_i_nnls(3, 1, b, x, &rss, &err));
    CHECK(x[0] == 0);
    CHECK_ABS(rss, 3, 1e-14);
    double none[3] = {3, 0, 4};
    CHECK_OK(ph_i_nnls(3, 0, none, x, &rss, &err));
    CHECK_ABS(rss, 25, 1e-13);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_optimality),
        cmocka_unit_test(test_exact_solution),
        cmocka_unit_test(test_degenerate),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
