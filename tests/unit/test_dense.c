/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "check.h"
#include "core/dense.h"

enum { M = 9, N = 6 };

static void fill(uint64_t *seed, double *a, int count)
{
    for (int i = 0; i < count; i++)
        a[i] = check_uniform(seed, -1, 1);
}

/* Q R with the columns in their order is A, to the arithmetic of a few dozen products. */
static void qr_is_the_matrix(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int pivot = 0; pivot < 2; pivot++) {
        double a[M * N], q[M * N], d[N], beta[N], x[M];
        int order[N];
        fill(&seed, a, M * N);
        for (int i = 0; i < M; i++)
            a[3 * M + i] = 1e-9 * a[i]; /* nearly dependent, and small */
        memcpy(q, a, sizeof a);
        ph_i_qr(M, N, q, d, beta, pivot ? order : NULL);
        for (int j = 0; j < N; j++) {
            memset(x, 0, sizeof x);
            for (int i = 0; i < j; i++)
                x[i] = q[j * M + i];
            x[j] = d[j];
            ph_i_qr_apply(M, N, q, beta, x);
            const double *want = a + (pivot ? order[j] : j) * M;
            for (int i = 0; i < M; i++)
                CHECK_ABS(x[i], want[i], 1e-14);
            ph_i_qr_transposed(M, N, q, beta, x);
            CHECK_ABS(x[j], d[j], 1e-14);
            if (pivot && j > 0) CHECK(fabs(d[j]) <= fabs(d[j - 1]) * (1 + 1e-14));
        }
    }
    CHECK_END();
}

/* Columns 1 and 1e-12 of a well-conditioned matrix: both singular values to all digits.
 * s1^2 + s2^2 = trace, s1 s2 = determinant give them without a difference. */
static void small_singular_values_are_exact(void **state)
{
    (void)state;
    const double small = 1e-12, b = 0.5;
    double a[4] = {1, b, b * small, small}, s[2];
    double det = (1 - b * b) * small, t = (1 + b * b) * (1 + small * small);
    double s1 = sqrt(0.5 * (t + sqrt(t * t - 4 * det * det)));
    ph_i_singular_values(2, 2, a, s);
    CHECK_REL(fmax(s[0], s[1]), s1, 1e-15);
    CHECK_REL(fmin(s[0], s[1]), det / s1, 4e-15);
    CHECK_ABS(a[0] * a[2] + a[1] * a[3], 0.0, 1e-15 * det);
    CHECK_END();
}

/* Invariants of any matrix; a column of zeros is a singular value of zero. */
static void invariants(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    double a[M * N], s[N], squares = 0.0, sum = 0.0;
    int zeros = 0;
    fill(&seed, a, M * N);
    memset(a + 2 * M, 0, sizeof *a * M);
    for (int i = 0; i < M * N; i++)
        squares += a[i] * a[i];
    ph_i_singular_values(M, N, a, s);
    for (int j = 0; j < N; j++) {
        sum += s[j] * s[j];
        zeros += s[j] == 0.0;
    }
    CHECK_REL(sum, squares, 1e-14);
    CHECK(zeros == 1);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(qr_is_the_matrix),
        cmocka_unit_test(small_singular_values_are_exact),
        cmocka_unit_test(invariants),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
