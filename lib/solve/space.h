/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The vectors of a solver: [components][planes][plane] doubles, in real space, or complex
 * half spectra whose products count the conjugate half. Sums are taken plane by plane and
 * then in order, so that they do not depend on the number of threads. */
#ifndef PH_SOLVE_SPACE_H
#define PH_SOLVE_SPACE_H

#include "core/memory.h"
#include "space/fft.h"

typedef struct ph_space {
    ptrdiff_t planes; /* nd * n0 */
    ptrdiff_t plane;  /* doubles per plane */
    ptrdiff_t row;    /* doubles per row of a half spectrum; 0: real space */
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

/** a . b */
double ph_i_dot(const ph_space *space, const double *a, const double *b);
/** x += alpha p, r -= alpha q; returns r . r */
double ph_i_step(const ph_space *space, double alpha, const double *p, const double *q,
                 double *x, double *r);
/** p = z + beta p */
void ph_i_direction(const ph_space *space, double beta, const double *z, double *p);

#endif
