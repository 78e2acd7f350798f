/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solve/space.h"

#include "core/real.h"

#ifndef PH_SINGLE
ph_status ph_i_space_init(ph_space *space, const ph_layout *layout, const ph_fft *fft,
                          int threads, ph_error *err)
{
    ph_status st = PH_OK;
    ptrdiff_t row = fft ? 2 * ph_i_fft_row(fft) : 0;
    *space = (ph_space){.planes = layout->nd * layout->n[0],
                        .plane = layout->n[1] * (fft ? row : layout->n[2]),
                        .row = row,
                        .nyquist = layout->n[2] % 2 == 0,
                        .threads = threads > 0 ? threads : 1};
    PH_ALLOC(space->partial, space->planes, "partial sums");
out:
    return st;
}

void ph_i_space_clear(ph_space *space)
{
    free(space->partial);
    space->partial = NULL;
}

#endif

/* Sum of a half spectrum over the whole: twice, but for the columns that stand alone. */
static double plane_dot(const ph_space *s, const real *restrict a, const real *restrict b)
{
    double sum = 0.0, own = 0.0;
#pragma omp simd reduction(+ : sum)
    for (ptrdiff_t k = 0; k < s->plane; k++)
        sum += (double)a[k] * (double)b[k];
    if (!s->row) return sum;
    for (ptrdiff_t k = 0; k < s->plane; k += s->row) {
        own += (double)a[k] * (double)b[k] + (double)a[k + 1] * (double)b[k + 1];
        if (s->nyquist && s->row > 2) {
            ptrdiff_t last = k + s->row - 2;
            own += (double)a[last] * (double)b[last] +
                   (double)a[last + 1] * (double)b[last + 1];
        }
    }
    return 2.0 * sum - own;
}

static double in_order(const ph_space *s)
{
    double sum = 0.0;
    for (ptrdiff_t i = 0; i < s->planes; i++)
        sum += s->partial[i];
    return sum;
}

double PH_REAL(ph_i_dot)(const ph_space *s, const real *a, const real *b)
{
#pragma omp parallel for num_threads(s->threads) schedule(static)
    for (ptrdiff_t i = 0; i < s->planes; i++)
        s->partial[i] = plane_dot(s, a + i * s->plane, b + i * s->plane);
    return in_order(s);
}

double PH_REAL(ph_i_step)(const ph_space *s, double alpha, const real *p, const real *q,
                          real *x, real *r)
{
    const real step = (real)alpha;
#pragma omp parallel for num_threads(s->threads) schedule(static)
    for (ptrdiff_t i = 0; i < s->planes; i++) {
        const real *restrict pi = p + i * s->plane, *restrict qi = q + i * s->plane;
        real *restrict xi = x + i * s->plane, *restrict ri = r + i * s->plane;
#pragma omp simd
        for (ptrdiff_t k = 0; k < s->plane; k++) {
            xi[k] += step * pi[k];
            ri[k] -= step * qi[k];
        }
        s->partial[i] = plane_dot(s, ri, ri);
    }
    return in_order(s);
}

void PH_REAL(ph_i_direction)(const ph_space *s, double beta, const real *z, real *p)
{
    const ptrdiff_t n = s->planes * s->plane;
    const real factor = (real)beta;
#pragma omp parallel for simd num_threads(s->threads) schedule(static, PH_CHUNK)
    for (ptrdiff_t k = 0; k < n; k++)
        p[k] = z[k] + factor * p[k];
}
