/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The vectors of a solver: [components][planes][plane] numbers, in real space, or complex
 * half spectra whose products count the conjugate half. Sums are taken plane by plane and
 * then in order, so that they do not depend on the number of threads. */
#ifndef PH_SOLVE_SPACE_H
#define PH_SOLVE_SPACE_H

#include "core/memory.h"
#include "space/fft.h"

typedef struct ph_space {
    ptrdiff_t planes; /* nd * n0 */
    ptrdiff_t plane;  /* numbers per plane */
    ptrdiff_t row;    /* numbers per row of a half spectrum; 0: real space */
    bool nyquist;     /* the last column of a row stands for itself */
    int threads;
    double *partial; /* [2][planes] */
} ph_space;

ph_status ph_i_space_init(ph_space *space, const ph_layout *layout, const ph_fft *fft,
                          int threads, ph_error *err); /* fft NULL: real space */
void ph_i_space_clear(ph_space *space);
static inline size_t ph_i_space_size(const ph_space *s)
{
    return (size_t)(s->planes * s->plane);
}

/** In precision R: _dot a . b; _step x += alpha p, r -= alpha q, returns r . r; _direction
 *  p = z + beta p. Sums are double. */
#define PH_SPACE_FUNCTIONS(R, suffix)                                                    \
    double ph_i_dot##suffix(const ph_space *space, const R *a, const R *b);              \
    double ph_i_step##suffix(const ph_space *space, double alpha, const R *p,            \
                             const R *q, R *x, R *r);                                    \
    void ph_i_direction##suffix(const ph_space *space, double beta, const R *z, R *p)
PH_SPACE_FUNCTIONS(double, );
PH_SPACE_FUNCTIONS(float, _single);

#endif
