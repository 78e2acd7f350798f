/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Real transforms of one scalar field on a layout. Built from one- and two-dimensional
 * FFTW plans whose sizes do not depend on the number of threads and that are chosen
 * without timing, so that the same input gives the same bits with any number of threads. */
#ifndef PH_SPACE_FFT_H
#define PH_SPACE_FFT_H

#include "core/check.h"
#include "space/layout.h"

/** Functions of one precision R:
 *  _new       plans for a layout. @return PH_OK; PH_ENOMEM
 *  _modes     complex values of a transform: n0 n1 (n2/2+1)
 *  _row       complex values along the last axis, n2/2+1
 *  _forward   hat(k) = sum_x u(x) exp(-i k.x), interleaved complex; `real` is kept
 *  _backward  real(x) = sum_k hat(k) exp(i k.x), no factor 1/n; `hat` is kept unless it is
 *             `work` [modes complex], which is overwritten
 *  _count     transforms made so far */
#define PH_FFT_FUNCTIONS(R, suffix)                                                      \
    typedef struct ph_fft##suffix ph_fft##suffix;                                        \
    ph_status ph_i_fft_new##suffix(const ph_layout *layout, int threads,                 \
                                   ph_fft##suffix **out, ph_error *err);                 \
    void ph_i_fft_free##suffix(ph_fft##suffix **fft);                                    \
    ptrdiff_t ph_i_fft_modes##suffix(const ph_fft##suffix *fft);                         \
    ptrdiff_t ph_i_fft_row##suffix(const ph_fft##suffix *fft);                           \
    void ph_i_fft_forward##suffix(ph_fft##suffix *fft, const R *real, R *hat);           \
    void ph_i_fft_backward##suffix(ph_fft##suffix *fft, const R *hat, R *work, R *real); \
    long ph_i_fft_count##suffix(const ph_fft##suffix *fft)
PH_FFT_FUNCTIONS(double, );
PH_FFT_FUNCTIONS(float, _single);

#endif
