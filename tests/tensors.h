/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random tensors and rotations for the tests; include after check.h. */
#ifndef TESTS_TENSORS_H
#define TESTS_TENSORS_H

#include <perihom/tensor.h>

#include "check.h"

/* A A^T + I/2: positive definite, condition number below about 1e2. */
static inline ph_sym4 random_stiffness(uint64_t *seed, int n)
{
    ph_sym4 a = {.n = n}, t = {.n = n};
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            t.m[j][i] = a.m[i][j] = check_uniform(seed, -1, 1);
    ph_sym4 c = ph_sym4_product(&a, &t);
    for (int i = 0; i < n; i++)
        c.m[i][i] += 0.5;
    return c;
}

/* From a random unit quaternion. */
static inline void random_rotation(uint64_t *seed, double R[9])
{
    double q[4], s = 0;
    do {
        s = 0;
        for (int i = 0; i < 4; i++) {
            q[i] = check_uniform(seed, -1, 1);
            s += q[i] * q[i];
        }
    } while (s > 1 || s < 0.01);
    for (int i = 0; i < 4; i++)
        q[i] /= sqrt(s);
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    const double r[9] = {
        1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
        2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
        2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
    memcpy(R, r, sizeof r);
}

/* |a - b| / |b|, or |a| where b is zero. */
static inline double difference(const ph_sym4 *a, const ph_sym4 *b)
{
    ph_sym4 d = ph_sym4_combine(1.0, a, -1.0, b);
    double norm = ph_sym4_norm(b);
    return ph_sym4_norm(&d) / (norm > 0 ? norm : 1.0);
}

/* Component of a Mandel tensor (n = 6) by its four axes. */
static inline double entry(const ph_sym4 *c, int i, int j, int k, int l)
{
    static const int index[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
    double s = (i == j ? 1 : sqrt(2)) * (k == l ? 1 : sqrt(2));
    return c->m[index[i][j]][index[k][l]] / s;
}

/* R_ip R_jq R_kr R_ls C_pqrs by the definition, 81 terms. */
static inline double rotated_entry(const ph_sym4 *c, const double R[9], int i, int j,
                                   int k, int l)
{
    double sum = 0;
    for (int a = 0; a < 81; a++) {
        int p = a % 3, q = a / 3 % 3, r = a / 9 % 3, s = a / 27;
        sum += R[3 * i + p] * R[3 * j + q] * R[3 * k + r] * R[3 * l + s] *
               entry(c, p, q, r, s);
    }
    return sum;
}

/* Smallest eigenvalue of a - b over |b|: not negative where a bounds b from above. */
static inline double gap(const ph_sym4 *a, const ph_sym4 *b)
{
    ph_sym4 d = ph_sym4_combine(1.0, a, -1.0, b);
    double lo;
    ph_sym4_eigenvalues(&d, &lo, NULL);
    double norm = ph_sym4_norm(b);
    return lo / (norm > 0 ? norm : 1.0);
}

#endif
