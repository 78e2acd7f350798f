/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/tensor.h>

#include "core/check.h"
#include "effective/directions.h"

#include <math.h>

void ph_i_normal_matrix(int n, const double normal[3], double N[6][3])
{
    const double h = sqrt(0.5);
    const double x = normal[0], y = normal[1], z = n == 3 ? 0.0 : normal[2];
    const double three[3][3] = {{x, 0, 0}, {0, y, 0}, {h * y, h * x, 0}};
    const double six[6][3] = {{x, 0, 0},         {0, y, 0},         {0, 0, z},
                              {0, h * z, h * y}, {h * z, 0, h * x}, {h * y, h * x, 0}};
    for (int a = 0; a < n; a++)
        for (int i = 0; i < 3; i++)
            N[a][i] = n == 3 ? three[a][i] : six[a][i];
}

bool ph_i_invert_small(int d, double M[3][3], double R[3][3])
{
    if (d == 2) M[2][2] = 1.0;
    double det = 0.0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, e = (j + 2) % 3;
            R[j][i] = M[a][c] * M[b][e] - M[a][e] * M[b][c];
        }
    for (int i = 0; i < 3; i++)
        det += M[0][i] * R[i][0];
    if (!(det > 0.0) || !isfinite(det)) return false;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            R[i][j] /= det;
    return true;
}

void ph_i_contract(const ph_sym4 *c, double N[6][3], double CN[6][3], double Z[3][3])
{
    const int d = c->n == 3 ? 2 : 3;
    for (int a = 0; a < c->n; a++)
        for (int i = 0; i < d; i++) {
            CN[a][i] = 0.0;
            for (int b = 0; b < c->n; b++)
                CN[a][i] += c->m[a][b] * N[b][i];
        }
    for (int i = 0; i < d; i++)
        for (int j = 0; j < d; j++) {
            Z[i][j] = 0.0;
            for (int a = 0; a < c->n; a++)
                Z[i][j] += N[a][i] * CN[a][j];
        }
}

bool ph_i_gamma(const ph_sym4 *c, const double normal[3], ph_sym4 *gamma)
{
    const int d = c->n == 3 ? 2 : 3;
    double N[6][3], CN[6][3], Z[3][3] = {{0}}, R[3][3];
    ph_i_normal_matrix(c->n, normal, N);
    ph_i_contract(c, N, CN, Z);
    if (!ph_i_invert_small(d, Z, R)) return false;
    ph_sym4 g = {.n = c->n};
    for (int a = 0; a < g.n; a++) {
        double NR[3] = {0.0, 0.0, 0.0};
        for (int i = 0; i < d; i++)
            for (int j = 0; j < d; j++)
                NR[j] += N[a][i] * R[i][j];
        for (int b = 0; b < g.n; b++)
            for (int j = 0; j < d; j++)
                g.m[a][b] += NR[j] * N[b][j];
    }
    *gamma = g;
    return true;
}

static ph_status check_laminate(const ph_sym4 *c1, const ph_sym4 *c2, double fraction2,
                                const double normal[3], ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(c1->n == c2->n && (c1->n == 3 || c1->n == 6), PH_EINVAL,
             "laminate of tensors of %d and %d components", c1->n, c2->n);
    PH_CHECK(fraction2 >= 0.0 && fraction2 <= 1.0, PH_EINVAL,
             "laminate: fraction must be in [0, 1], got %g", fraction2);
    double z = c1->n == 3 ? 0.0 : normal[2];
    double square = normal[0] * normal[0] + normal[1] * normal[1] + z * z;
    PH_CHECK(fabs(square - 1.0) < 1e-6, PH_EINVAL,
             "laminate: normal must have length 1, got %g", sqrt(square));
out:
    return st;
}

ph_status ph_sym4_laminate(const ph_sym4 *c1, const ph_sym4 *c2, double fraction2,
                           const double normal[3], ph_sym4 *out, ph_error *err)
{
    PH_GIVEN(c1 && c2 && normal && out);
    ph_status st = PH_OK;
    const int n = c1->n, d = n == 3 ? 2 : 3;
    const double f1 = 1.0 - fraction2, f2 = fraction2;
    PH_TRY(check_laminate(c1, c2, fraction2, normal, err));
    ph_sym4 mean = ph_sym4_combine(f1, c1, f2, c2);
    bool hole = ph_sym4_norm(c1) == 0.0 || ph_sym4_norm(c2) == 0.0;
    if (f1 > 0.0 && f2 > 0.0 && !hole) {
        double N[6][3], DN[6][3], Z1[3][3], Z2[3][3], M[3][3] = {{0}}, R[3][3];
        ph_sym4 D = ph_sym4_combine(1.0, c1, -1.0, c2);
        ph_i_normal_matrix(n, normal, N);
        ph_i_contract(c1, N, DN, Z1);
        ph_i_contract(c2, N, DN, Z2);
        for (int i = 0; i < d; i++)
            for (int j = 0; j < d; j++)
                M[i][j] = f2 * Z1[i][j] + f1 * Z2[i][j];
        PH_CHECK(ph_i_invert_small(d, M, R), PH_ESINGULAR,
                 "laminate: neither phase resists the strain across the layers");
        ph_i_contract(&D, N, DN, Z1);
        for (int a = 0; a < n; a++)
            for (int b = 0; b < n; b++)
                for (int i = 0; i < d; i++)
                    for (int j = 0; j < d; j++)
                        mean.m[a][b] -= f1 * f2 * DN[a][i] * R[i][j] * DN[b][j];
    }
    *out = mean;
out:
    return st;
}
