/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Real transforms of one scalar field on a layout. Built from one- and two-dimensional
 * FFTW plans whose sizes do not depend on the number of threads and that are chosen
 * without timing, so that the same input gives the same bits with any number of threads. */
#ifndef PH_SPACE_FFT_H
#define PH_SPACE_FFT_H

#include "core/check.h"
#include "space/layout.h"

typedef struct ph_fft ph_fft;

/** Plans for a layout. @return PH_OK; PH_ENOMEM. */
ph_status ph_i_fft_new(const ph_layout *layout, int threads, ph_fft **out, ph_error *err);
void ph_i_fft_free(ph_fft **fft);
/** Complex values of a transform: n0 n1 (n2/2+1). */
ptrdiff_t ph_i_fft_modes(const ph_fft *fft);
/** Complex values along the last axis, n2/2+1. */
ptrdiff_t ph_i_fft_row(const ph_fft *fft);
/** hat(k) = sum_x u(x) exp(-i k.x). `real` is kept. @param[out] hat interleaved complex */
void ph_i_fft_forward(ph_fft *fft, const double *real, double *hat);
/** real(x) = sum_k hat(k) exp(i k.x), no factor 1/n. `hat` is kept unless it is `work`;
 *  `work` [modes complex] is overwritten. */
void ph_i_fft_backward(ph_fft *fft, const double *hat, double *work, double *real);
/** Transforms made so far. */
long ph_i_fft_count(const ph_fft *fft);

#endif
