/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/jacobi.h"

#include <math.h>
#include <stdbool.h>

/* Quadratic convergence: a few sweeps do, the rest find nothing to rotate. */
enum { SWEEPS = 30 };

/* (x, y) -> (c x - s y, s x + c y) */
static void turn(double c, double s, double *x, double *y)
{
    double old = *x;
    *x = c * old - s * *y;
    *y = s * old + c * *y;
}

/* The rotation that zeroes a[p][q]. */
static void rotate(int n, int stride, double *a, double *v, int p, int q)
{
    double off = a[p * stride + q];
    double theta = (a[q * stride + q] - a[p * stride + p]) / (2.0 * off);
    double t = (theta >= 0.0 ? 1.0 : -1.0) / (fabs(theta) + hypot(theta, 1.0));
    double c = 1.0 / hypot(t, 1.0), s = t * c;
    for (int k = 0; k < n; k++)
        turn(c, s, &a[k * stride + p], &a[k * stride + q]);
    for (int k = 0; k < n; k++)
        turn(c, s, &a[p * stride + k], &a[q * stride + k]);
    for (int k = 0; v && k < n; k++)
        turn(c, s, &v[k * stride + p], &v[k * stride + q]);
    a[p * stride + q] = a[q * stride + p] = 0.0;
}

void ph_i_jacobi(int n, int stride, double *a, double *v)
{
    for (int i = 0; v && i < n; i++)
        for (int j = 0; j < n; j++)
            v[i * stride + j] = i == j ? 1.0 : 0.0;
    bool turned = true;
    for (int sweep = 0; turned && sweep < SWEEPS; sweep++) {
        turned = false;
        for (int p = 0; p < n; p++)
            for (int q = p + 1; q < n; q++) {
                double off = a[p * stride + q];
                if (off == 0.0 || !isfinite(off)) continue;
                rotate(n, stride, a, v, p, q);
                turned = true;
            }
    }
}
