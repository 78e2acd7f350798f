/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Vectors of three components. */
#ifndef PERIHOM_CORE_VEC3_H
#define PERIHOM_CORE_VEC3_H

#include <math.h>

/** a . b */
static inline double ph_i_dot3(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/** c = a x b; c is neither a nor b. */
static inline void ph_i_cross3(const double *a, const double *b, double *c)
{
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

/** a to length 1; a is not zero. */
static inline void ph_i_normalise3(double *a)
{
    double length = sqrt(ph_i_dot3(a, a));
    for (int d = 0; d < 3; d++)
        a[d] /= length;
}

#endif
