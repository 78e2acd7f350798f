/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PH_CORE_COMPLEX_H
#define PH_CORE_COMPLEX_H

#include <complex.h>

/** re + i im; CMPLX of C11, which not every compiler has. */
static inline double complex ph_i_complex(double re, double im)
{
    return re + im * (double complex)I;
}

#endif
