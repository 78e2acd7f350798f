/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A gradient as a product in Fourier space: its cost does not depend on the family. */
#ifndef PH_MODEL_CONVOLUTION_H
#define PH_MODEL_CONVOLUTION_H

#include <perihom/family.h>

#include "core/memory.h"
#include "space/fft.h"

typedef struct ph_convolution {
    ph_layout layout;
    ph_fft *fft; /* borrowed */
    int threads;
    ptrdiff_t modes;
    double *g[3]; /* [modes] complex, by direction; NULL where inactive */
    double *work; /* [modes] complex */
} ph_convolution;

/** Symbol ghat_d(k) = sum_b g_bd exp(i k.o_b) of a gradient, complex [modes], by direction.
 *  `real` [cells] is work. Wrap-around of large families comes out right. */
void ph_i_gradient_symbol(ph_fft *fft, const ph_layout *layout, ptrdiff_t count,
                          const int (*offset)[3], const double (*g)[3], int direction,
                          double *real, double *hat);

ph_status ph_i_convolution_init(ph_convolution *conv, const ph_layout *layout,
                                ph_fft *fft, const ph_family *family, int threads,
                                ph_meter *meter, ph_error *err);
void ph_i_convolution_clear(ph_convolution *conv, ph_meter *meter);
/** strain [ns][cells] = scale * sym grad u, from uhat [nd][modes] complex (kept). */
void ph_i_convolution_strain(ph_convolution *conv, const double *uhat, double scale,
                             double *strain);
/** fhat [nd][modes] = B^H F(stress), stress [ns][cells] (kept). */
void ph_i_convolution_divergence(ph_convolution *conv, const double *stress,
                                 double *fhat);

#endif
