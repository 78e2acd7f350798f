/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/tensor.h>

#include "core/check.h"
#include "core/jacobi.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* The pair of axes of each component, and the factor sqrt(2) of a shear one. */
static const int pair6[6][2] = {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};
static const int pair3[3][2] = {{0, 0}, {1, 1}, {0, 1}};
static const double root2 = 1.41421356237309504880;

static const int *pair(int n, int a)
{
    return n == 3 ? pair3[a] : pair6[a];
}

static double shear_factor(int n, int a)
{
    const int *p = pair(n, a);
    return p[0] == p[1] ? 1.0 : root2;
}

int ph_displacements(ph_kinematics kin)
{
    return kin == PH_PLANE_STRAIN || kin == PH_PLANE_STRESS ? 2 : 3;
}

int ph_strains(ph_kinematics kin)
{
    return ph_displacements(kin) == 2 ? 3 : 6;
}

ph_sym4 ph_sym4_from_voigt(int n, const double *voigt, bool stiffness)
{
    if (!voigt) return (ph_sym4){0};
    ph_sym4 c = {.n = n};
    for (int a = 0; a < n; a++)
        for (int b = 0; b < n; b++) {
            double s = shear_factor(n, a) * shear_factor(n, b);
            c.m[a][b] = stiffness ? voigt[a * n + b] * s : voigt[a * n + b] / s;
        }
    return c;
}

void ph_sym4_to_voigt(const ph_sym4 *c, bool stiffness, double *voigt)
{
    if (!c || !voigt) return;
    const int n = c->n;
    for (int a = 0; a < n; a++)
        for (int b = 0; b < n; b++) {
            double s = shear_factor(n, a) * shear_factor(n, b);
            voigt[a * n + b] = stiffness ? c->m[a][b] / s : c->m[a][b] * s;
        }
}

ph_sym4 ph_sym4_isotropic_kg(double K, double G)
{
    ph_sym4 c = {.n = 6};
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            c.m[a][b] = K - 2.0 * G / 3.0;
    for (int a = 0; a < 6; a++)
        c.m[a][a] += 2.0 * G;
    return c;
}

ph_sym4 ph_sym4_isotropic(double E, double nu)
{
    return ph_sym4_isotropic_kg(E / (3.0 * (1.0 - 2.0 * nu)), E / (2.0 * (1.0 + nu)));
}

/* Lower Cholesky factor of the symmetric part; false if it is not positive definite. A
 * pivot that is round-off of the largest diagonal entry counts as zero: what is left of a
 * severed cell is such a tensor, and its own small diagonal is no measure. */
static bool cholesky(const ph_sym4 *c, double L[6][6])
{
    double largest = 0.0;
    for (int j = 0; j < c->n; j++)
        largest = fmax(largest, c->m[j][j]);
    for (int j = 0; j < c->n; j++) {
        double pivot = c->m[j][j];
        for (int k = 0; k < j; k++)
            pivot -= L[j][k] * L[j][k];
        if (!(pivot > 16.0 * DBL_EPSILON * largest) || !isfinite(pivot)) return false;
        L[j][j] = sqrt(pivot);
        for (int i = j + 1; i < c->n; i++) {
            double s = 0.5 * (c->m[i][j] + c->m[j][i]);
            for (int k = 0; k < j; k++)
                s -= L[i][k] * L[j][k];
            L[i][j] = s / L[j][j];
        }
    }
    return true;
}

ph_status ph_sym4_inverse(const ph_sym4 *c, ph_sym4 *inv, ph_error *err)
{
    PH_GIVEN(c && inv);
    ph_status st = PH_OK;
    const int n = c->n;
    double L[6][6] = {{0}}, M[6][6] = {{0}}; /* M = L^-1 */
    PH_CHECK(cholesky(c, L), PH_ESINGULAR,
             "the tensor is singular or not positive definite: no inverse");
    for (int j = 0; j < n; j++) {
        M[j][j] = 1.0 / L[j][j];
        for (int i = j + 1; i < n; i++) {
            double s = 0.0;
            for (int k = j; k < i; k++)
                s -= L[i][k] * M[k][j];
            M[i][j] = s / L[i][i];
        }
    }
    ph_sym4 r = {.n = n};
    for (int i = 0; i < n; i++)
        for (int j = 0; j <= i; j++) {
            for (int k = i; k < n; k++)
                r.m[i][j] += M[k][i] * M[k][j];
            r.m[j][i] = r.m[i][j];
        }
    *inv = r;
out:
    return st;
}

void ph_sym4_eigenvalues(const ph_sym4 *c, double *smallest, double *largest)
{
    if (!c) return;
    const int n = c->n;
    double a[6][6] = {{0}};
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            a[i][j] = 0.5 * (c->m[i][j] + c->m[j][i]);
    ph_i_jacobi(n, 6, &a[0][0], NULL);
    double lo = a[0][0], hi = a[0][0];
    for (int i = 1; i < n; i++) {
        lo = fmin(lo, a[i][i]);
        hi = fmax(hi, a[i][i]);
    }
    if (smallest) *smallest = lo;
    if (largest) *largest = hi;
}

bool ph_sym4_is_stiffness(const ph_sym4 *c)
{
    if (!c) return false;
    if (c->n != 3 && c->n != 6) return false;
    double skew = 0.0, norm = 0.0, L[6][6] = {{0}};
    for (int i = 0; i < c->n; i++)
        for (int j = 0; j < c->n; j++) {
            if (!isfinite(c->m[i][j])) return false;
            double d = c->m[i][j] - c->m[j][i];
            skew += d * d;
            norm += c->m[i][j] * c->m[i][j];
        }
    return skew <= 1e-12 * norm && cholesky(c, L);
}

ph_sym4 ph_sym4_product(const ph_sym4 *a, const ph_sym4 *b)
{
    if (!a || !b) return (ph_sym4){0};
    ph_sym4 c = {.n = a->n};
    for (int i = 0; i < a->n; i++)
        for (int k = 0; k < a->n; k++)
            for (int j = 0; j < a->n; j++)
                c.m[i][j] += a->m[i][k] * b->m[k][j];
    return c;
}

ph_sym4 ph_sym4_combine(double a, const ph_sym4 *x, double b, const ph_sym4 *y)
{
    if (!x || !y) return (ph_sym4){0};
    ph_sym4 c = {.n = x->n};
    for (int i = 0; i < x->n; i++)
        for (int j = 0; j < x->n; j++)
            c.m[i][j] = a * x->m[i][j] + b * y->m[i][j];
    return c;
}

double ph_sym4_norm(const ph_sym4 *c)
{
    if (!c) return NAN;
    double s = 0.0;
    for (int i = 0; i < c->n; i++)
        for (int j = 0; j < c->n; j++)
            s += c->m[i][j] * c->m[i][j];
    return sqrt(s);
}

ph_sym4 ph_sym4_rotate(const ph_sym4 *c, const double *R)
{
    if (!c || !R) return (ph_sym4){0};
    /* In Mandel notation a rotation of space is an orthogonal Q: C' = Q C Q^T. */
    const int n = c->n, d = n == 3 ? 2 : 3;
    ph_sym4 Q = {.n = n}, Qt = {.n = n};
    for (int a = 0; a < n; a++)
        for (int b = 0; b < n; b++) {
            const int *p = pair(n, a), *q = pair(n, b);
            double x = R[p[0] * d + q[0]] * R[p[1] * d + q[1]] +
                       R[p[0] * d + q[1]] * R[p[1] * d + q[0]];
            Q.m[a][b] = Qt.m[b][a] = 0.5 * x * shear_factor(n, a) * shear_factor(n, b);
        }
    ph_sym4 r = ph_sym4_product(&Q, c);
    return ph_sym4_product(&r, &Qt);
}

/* The rows and columns `keep` of c, with sigma = 0 in the three others if `condense`. */
static ph_status in_plane(const ph_sym4 *c, bool condense, ph_sym4 *out, ph_error *err)
{
    static const int keep[3] = {0, 1, 5}, drop[3] = {2, 3, 4};
    ph_status st = PH_OK;
    ph_sym4 r = {.n = 3}, bb = {.n = 3};
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
            r.m[a][b] = c->m[keep[a]][keep[b]];
            bb.m[a][b] = c->m[drop[a]][drop[b]];
        }
    if (condense) {
        PH_TRY(ph_sym4_inverse(&bb, &bb, err));
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++)
                for (int k = 0; k < 3; k++)
                    for (int l = 0; l < 3; l++)
                        r.m[a][b] -=
                            c->m[keep[a]][drop[k]] * bb.m[k][l] * c->m[drop[l]][keep[b]];
    }
    *out = r;
out:
    return st;
}

ph_status ph_sym4_reduce(const ph_sym4 *c, ph_kinematics kin, ph_sym4 *out, ph_error *err)
{
    PH_GIVEN(c && out);
    ph_status st = PH_OK;
    PH_CHECK(c->n == 6 || ph_strains(kin) == 3, PH_EINVAL,
             "a plane stiffness cannot become a spatial one");
    if (c->n == ph_strains(kin))
        *out = *c;
    else if (ph_sym4_norm(c) == 0.0)
        *out = (ph_sym4){.n = 3};
    else
        PH_TRY(in_plane(c, kin == PH_PLANE_STRESS, out, err));
out:
    return st;
}
