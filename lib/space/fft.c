/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "space/fft.h"

#include "core/real.h"

#include <fftw3.h>

#include <pthread.h>
#include <string.h>

#ifdef PH_SINGLE
#define FFTW(name) fftwf_##name
#else
#define FFTW(name) fftw_##name
#endif
typedef FFTW(plan) fft_plan;
typedef FFTW(complex) fft_complex;
typedef struct PH_REAL(ph_fft) fft;

/* FFTW's planner is one for the whole process; execution is not locked. */
static pthread_mutex_t planner = PTHREAD_MUTEX_INITIALIZER;

enum { COLUMNS = 16 }; /* columns of a 2D grid transformed at once along axis 0 */

struct PH_REAL(ph_fft) {
    ptrdiff_t n[3], row, modes,
        plane; /* row: complex per line; plane: complex per plane */
    int threads;
    long count;
    fft_plan plane_forward, plane_backward; /* axes 1 and 2 of one plane */
    ptrdiff_t block, blocks;                /* columns per outer transform */
    fft_plan outer[2][2]; /* [forward, backward][in place, out of place] */
    fft_plan rest[2][2];  /* the last block, if it is narrower */
};

/* Plans load vectors of 16 bytes; where arrays, planes or columns do not all begin at such an
 * address they are told. */
static unsigned planning(size_t bytes)
{
    return bytes % 16 ? FFTW_ESTIMATE | FFTW_UNALIGNED : FFTW_ESTIMATE;
}

static fft_plan plan_outer(const fft *f, ptrdiff_t howmany, int sign, real *a, real *b)
{
    int n[1] = {(int)f->n[0]};
    return FFTW(plan_many_dft)(1, n, (int)howmany, (fft_complex *)a, NULL, (int)f->plane,
                               1, (fft_complex *)b, NULL, (int)f->plane, 1, sign,
                               planning((size_t)f->modes * sizeof(fft_complex)));
}

static bool plan_all(fft *f, real *field, real *a, real *b)
{
    int rank = f->n[1] > 1 ? 2 : 1;
    int dims[2] = {(int)f->n[1], (int)f->n[2]};
    const int *n = rank == 2 ? dims : dims + 1;
    size_t reals = (size_t)(f->n[1] * f->n[2]) * sizeof(real),
           complexes = (size_t)f->plane * sizeof(fft_complex);
    unsigned flags = planning(reals | complexes);
    f->plane_forward = FFTW(plan_dft_r2c)(rank, n, field, (fft_complex *)a, flags);
    f->plane_backward = FFTW(plan_dft_c2r)(rank, n, (fft_complex *)a, field, flags);
    bool ok = f->plane_forward && f->plane_backward;
    if (f->n[0] == 1) return ok;
    for (int s = 0; s < 2; s++)
        for (int o = 0; o < 2; o++) {
            int sign = s ? FFTW_BACKWARD : FFTW_FORWARD;
            f->outer[s][o] = plan_outer(f, f->block, sign, a, o ? b : a);
            ok = ok && f->outer[s][o];
            if (f->plane % f->block) {
                f->rest[s][o] = plan_outer(f, f->plane % f->block, sign, a, o ? b : a);
                ok = ok && f->rest[s][o];
            }
        }
    return ok;
}

ph_status PH_REAL(ph_i_fft_new)(const ph_layout *layout, int threads, fft **out,
                                ph_error *err)
{
    ph_status st = PH_OK;
    fft *f = NULL;
    real *field = NULL, *a = NULL, *b = NULL;
    *out = NULL;
    PH_ALLOC(f, 1, "transform plans");
    for (int d = 0; d < 3; d++)
        f->n[d] = layout->n[d];
    f->row = f->n[2] / 2 + 1;
    f->plane = f->n[1] * f->row;
    f->modes = f->n[0] * f->plane;
    f->threads = threads > 0 ? threads : 1;
    const ptrdiff_t step = 16 / (ptrdiff_t)sizeof(fft_complex); /* columns to 16 bytes */
    f->block = f->n[1] > 1 ? (f->row + step - 1) / step * step : COLUMNS;
    if (f->block > f->plane) f->block = f->plane;
    f->blocks = (f->plane + f->block - 1) / f->block;
    PH_CHECK(f->modes < (ptrdiff_t)1 << 30 && f->plane < (ptrdiff_t)1 << 30, PH_EINVAL,
             "the grid of %td cells is too large for one transform", layout->cells);
    field = FFTW(malloc)(sizeof(real) * (size_t)layout->cells);
    a = FFTW(malloc)(sizeof(fft_complex) * (size_t)f->modes);
    b = FFTW(malloc)(sizeof(fft_complex) * (size_t)f->modes);
    PH_CHECK(field && a && b, PH_ENOMEM, "no memory to plan transforms of %td cells",
             layout->cells);
    pthread_mutex_lock(&planner);
    bool ok = plan_all(f, field, a, b);
    pthread_mutex_unlock(&planner);
    PH_CHECK(ok, PH_ENOMEM, "FFTW made no plan for %td x %td x %td", f->n[0], f->n[1],
             f->n[2]);
    *out = f;
    f = NULL;
out:
    FFTW(free)(field);
    FFTW(free)(a);
    FFTW(free)(b);
    PH_REAL(ph_i_fft_free)(&f);
    return st;
}

void PH_REAL(ph_i_fft_free)(fft **plans)
{
    if (!plans || !*plans) return;
    fft *f = *plans;
    pthread_mutex_lock(&planner);
    fft_plan all[10] = {f->plane_forward, f->plane_backward};
    for (int s = 0; s < 2; s++)
        for (int o = 0; o < 2; o++) {
            all[2 + 2 * s + o] = f->outer[s][o];
            all[6 + 2 * s + o] = f->rest[s][o];
        }
    for (int i = 0; i < 10; i++)
        if (all[i]) FFTW(destroy_plan)(all[i]);
    pthread_mutex_unlock(&planner);
    free(f);
    *plans = NULL;
}

ptrdiff_t PH_REAL(ph_i_fft_modes)(const fft *f)
{
    return f->modes;
}
ptrdiff_t PH_REAL(ph_i_fft_row)(const fft *f)
{
    return f->row;
}
long PH_REAL(ph_i_fft_count)(const fft *f)
{
    return f->count;
}

/* Along axis 0, from `a` to `b` (which may be the same). */
static void outer_pass(fft *f, int backward, real *a, real *b)
{
    int apart = a != b;
#pragma omp parallel for num_threads(f->threads) schedule(static)
    for (ptrdiff_t j = 0; j < f->blocks; j++) {
        ptrdiff_t start = j * f->block;
        fft_plan plan = start + f->block <= f->plane ? f->outer[backward][apart]
                                                     : f->rest[backward][apart];
        FFTW(execute_dft)(plan, (fft_complex *)a + start, (fft_complex *)b + start);
    }
}

void PH_REAL(ph_i_fft_forward)(fft *f, const real *field, real *hat)
{
    ptrdiff_t plane = f->n[1] * f->n[2];
    f->count++;
    /* FFTW takes a plain pointer but keeps the input of a forward real transform. */
    real *in = (real *)(uintptr_t)field;
#pragma omp parallel for num_threads(f->threads) schedule(static)
    for (ptrdiff_t i = 0; i < f->n[0]; i++)
        FFTW(execute_dft_r2c)
    (f->plane_forward, in + i * plane, (fft_complex *)hat + i * f->plane);
    if (f->n[0] > 1) outer_pass(f, 0, hat, hat);
}

void PH_REAL(ph_i_fft_backward)(fft *f, const real *hat, real *work, real *field)
{
    ptrdiff_t plane = f->n[1] * f->n[2];
    f->count++;
    if (f->n[0] > 1)
        outer_pass(f, 1, (real *)(uintptr_t)hat, work);
    else if (work != hat)
        memcpy(work, hat, 2 * sizeof(real) * (size_t)f->modes);
#pragma omp parallel for num_threads(f->threads) schedule(static)
    for (ptrdiff_t i = 0; i < f->n[0]; i++)
        FFTW(execute_dft_c2r)
    (f->plane_backward, (fft_complex *)work + i * f->plane, field + i * plane);
}
