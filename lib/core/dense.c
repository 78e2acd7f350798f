/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/dense.h"

#include <math.h>
#include <string.h>

double ph_i_inner(ptrdiff_t n, const double *restrict a, const double *restrict b)
{
    double s = 0.0;
#pragma omp simd reduction(+ : s)
    for (ptrdiff_t i = 0; i < n; i++)
        s += a[i] * b[i];
    return s;
}

/* x -= beta (v.x) v */
static void reflect(ptrdiff_t n, double beta, const double *restrict v,
                    double *restrict x)
{
    double t = beta * ph_i_inner(n, v, x);
#pragma omp simd
    for (ptrdiff_t i = 0; i < n; i++)
        x[i] -= t * v[i];
}

/* Turns x into the v whose reflection takes x to (diagonal, 0 ... 0); its factor. */
static double reflection(ptrdiff_t n, double *x, double *diagonal)
{
    double norm = sqrt(ph_i_inner(n, x, x));
    *diagonal = x[0] > 0.0 ? -norm : norm;
    x[0] -= *diagonal;
    double vv = ph_i_inner(n, x, x);
    return vv > 0.0 ? 2.0 / vv : 0.0;
}

static void swap_columns(int m, double *a, double *b)
{
    for (int i = 0; i < m; i++) {
        double t = a[i];
        a[i] = b[i], b[i] = t;
    }
}

void ph_i_qr(int m, int n, double *a, double *diagonal, double *beta, int *order)
{
    for (int j = 0; order && j < n; j++)
        order[j] = j;
    for (int k = 0; k < n && k < m; k++) {
        int best = k;
        double most = -1.0;
        for (int j = k; order && j < n; j++) {
            double s = ph_i_inner(m - k, a + (size_t)j * m + k, a + (size_t)j * m + k);
            if (s > most) most = s, best = j;
        }
        if (best != k) {
            int t = order[k];
            swap_columns(m, a + (size_t)k * m, a + (size_t)best * m);
            order[k] = order[best], order[best] = t;
        }
        double *v = a + (size_t)k * m + k;
        beta[k] = reflection(m - k, v, &diagonal[k]);
        for (int j = k + 1; j < n; j++)
            reflect(m - k, beta[k], v, a + (size_t)j * m + k);
    }
}

void ph_i_qr_apply(int m, int k, const double *a, const double *beta, double *x)
{
    for (int j = k - 1; j >= 0; j--)
        reflect(m - j, beta[j], a + (size_t)j * m + j, x + j);
}

void ph_i_qr_transposed(int m, int k, const double *a, const double *beta, double *x)
{
    for (int j = 0; j < k; j++)
        reflect(m - j, beta[j], a + (size_t)j * m + j, x + j);
}

void ph_i_qr_columns(ptrdiff_t m, int n, int columns, double *a)
{
    for (int k = 0; k < n && k < m; k++) {
        double *v = a + k * m + k, diagonal, beta = reflection(m - k, v, &diagonal);
        for (int j = k + 1; j < columns; j++)
            reflect(m - k, beta, v, a + j * m + k);
        v[0] = diagonal;
        memset(v + 1, 0, (size_t)(m - k - 1) * sizeof *v);
    }
}

/* Quadratic convergence: a few sweeps do. */
enum { SWEEPS = 40 };
static const double orthogonal = 1e-15;

static void turn(int m, double c, double s, double *restrict x, double *restrict y)
{
#pragma omp simd
    for (int i = 0; i < m; i++) {
        double old = x[i];
        x[i] = c * old - s * y[i];
        y[i] = s * old + c * y[i];
    }
}

/* Make columns p and q orthogonal; s holds their norms. Returns whether they were not. */
static int orthogonalise(int m, double *x, double *y, double *sx, double *sy)
{
    if (*sx == 0.0 || *sy == 0.0) return 0;
    /* In units of the norms: squares of columns of 1e-200 are not numbers. */
    double cosine = ph_i_inner(m, x, y) / *sx / *sy;
    if (fabs(cosine) <= orthogonal * sqrt((double)m)) return 0;
    double ratio = *sy / *sx, theta = (ratio - 1.0 / ratio) / (2.0 * cosine);
    double t = (theta >= 0.0 ? 1.0 : -1.0) / (fabs(theta) + sqrt(1.0 + theta * theta));
    double c = 1.0 / sqrt(1.0 + t * t);
    turn(m, c, t * c, x, y);
    *sx = sqrt(ph_i_inner(m, x, x));
    *sy = sqrt(ph_i_inner(m, y, y));
    return 1;
}

void ph_i_singular_values(int m, int n, double *a, double *s)
{
    for (int j = 0; j < n; j++)
        s[j] = sqrt(ph_i_inner(m, a + (size_t)j * m, a + (size_t)j * m));
    for (int sweep = 0, turned = 1; turned && sweep < SWEEPS; sweep++) {
        turned = 0;
        for (int p = 0; p < n; p++)
            for (int q = p + 1; q < n; q++)
                turned +=
                    orthogonalise(m, a + (size_t)p * m, a + (size_t)q * m, &s[p], &s[q]);
    }
}
