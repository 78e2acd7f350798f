/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "space/fft.h"

#include <fftw3.h>

#include <pthread.h>
#include <string.h>

/* FFTW's planner is one for the whole process; execution is not locked. */
static pthread_mutex_t planner = PTHREAD_MUTEX_INITIALIZER;

enum { COLUMNS = 16 }; /* columns of a 2D grid transformed at once along axis 0 */

struct ph_fft {
    ptrdiff_t n[3], row, modes,
        plane; /* row: complex per line; plane: complex per plane */
    int threads;
    long count;
    fftw_plan plane_forward, plane_backward; /* axes 1 and 2 of one plane */
    ptrdiff_t block, blocks;                 /* columns per outer transform */
    fftw_plan outer[2][2]; /* [forward, backward][in place, out of place] */
    fftw_plan rest[2][2];  /* the last block, if it is narrower */
};

static fftw_plan plan_outer(const ph_fft *f, ptrdiff_t howmany, int sign, double *a,
                            double *b)
{
    int n[1] = {(int)f->n[0]};
    return fftw_plan_many_dft(1, n, (int)howmany, (fftw_complex *)a, NULL, (int)f->plane,
                              1, (fftw_complex *)b, NULL, (int)f->plane, 1, sign,
                              FFTW_ESTIMATE);
}

static bool plan_all(ph_fft *f, double *real, double *a, double *b)
{
    int rank = f->n[1] > 1 ? 2 : 1;
    int dims[2] = {(int)f->n[1], (int)f->n[2]};
    const int *n = rank == 2 ? dims : dims + 1;
    unsigned flags = FFTW_ESTIMATE;
    /* Planes of an odd number of reals start at odd addresses. */
    if ((f->n[1] * f->n[2]) % 2) flags |= FFTW_UNALIGNED;
    f->plane_forward = fftw_plan_dft_r2c(rank, n, real, (fftw_complex *)a, flags);
    f->plane_backward = fftw_plan_dft_c2r(rank, n, (fftw_complex *)a, real, flags);
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

ph_status ph_i_fft_new(const ph_layout *layout, int threads, ph_fft **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_fft *f = NULL;
    double *real = NULL, *a = NULL, *b = NULL;
    *out = NULL;
    PH_ALLOC(f, 1, "transform plans");
    for (int d = 0; d < 3; d++)
        f->n[d] = layout->n[d];
    f->row = f->n[2] / 2 + 1;
    f->plane = f->n[1] * f->row;
    f->modes = f->n[0] * f->plane;
    f->threads = threads > 0 ? threads : 1;
    f->block = f->n[1] > 1 ? f->row : (f->plane < COLUMNS ? f->plane : COLUMNS);
    f->blocks = (f->plane + f->block - 1) / f->block;
    PH_CHECK(f->modes < (ptrdiff_t)1 << 30 && f->plane < (ptrdiff_t)1 << 30, PH_EINVAL,
             "the grid of %td cells is too large for one transform", layout->cells);
    real = fftw_malloc(sizeof(double) * (size_t)layout->cells);
    a = fftw_malloc(sizeof(fftw_complex) * (size_t)f->modes);
    b = fftw_malloc(sizeof(fftw_complex) * (size_t)f->modes);
    PH_CHECK(real && a && b, PH_ENOMEM, "no memory to plan transforms of %td cells",
             layout->cells);
    pthread_mutex_lock(&planner);
    bool ok = plan_all(f, real, a, b);
    pthread_mutex_unlock(&planner);
    PH_CHECK(ok, PH_ENOMEM, "FFTW made no plan for %td x %td x %td", f->n[0], f->n[1],
             f->n[2]);
    *out = f;
    f = NULL;
out:
    fftw_free(real);
    fftw_free(a);
    fftw_free(b);
    ph_i_fft_free(&f);
    return st;
}

void ph_i_fft_free(ph_fft **fft)
{
    if (!fft || !*fft) return;
    ph_fft *f = *fft;
    pthread_mutex_lock(&planner);
    fftw_plan all[10] = {f->plane_forward, f->plane_backward};
    for (int s = 0; s < 2; s++)
        for (int o = 0; o < 2; o++) {
            all[2 + 2 * s + o] = f->outer[s][o];
            all[6 + 2 * s + o] = f->rest[s][o];
        }
    for (int i = 0; i < 10; i++)
        if (all[i]) fftw_destroy_plan(all[i]);
    pthread_mutex_unlock(&planner);
    free(f);
    *fft = NULL;
}

ptrdiff_t ph_i_fft_modes(const ph_fft *fft)
{
    return fft->modes;
}
ptrdiff_t ph_i_fft_row(const ph_fft *fft)
{
    return fft->row;
}
long ph_i_fft_count(const ph_fft *fft)
{
    return fft->count;
}

/* Along axis 0, from `a` to `b` (which may be the same). */
static void outer_pass(ph_fft *f, int backward, double *a, double *b)
{
    int apart = a != b;
#pragma omp parallel for num_threads(f->threads) schedule(static)
    for (ptrdiff_t j = 0; j < f->blocks; j++) {
        ptrdiff_t start = j * f->block;
        fftw_plan plan = start + f->block <= f->plane ? f->outer[backward][apart]
                                                      : f->rest[backward][apart];
        fftw_execute_dft(plan, (fftw_complex *)a + start, (fftw_complex *)b + start);
    }
}

void ph_i_fft_forward(ph_fft *f, const double *real, double *hat)
{
    ptrdiff_t plane = f->n[1] * f->n[2];
    f->count++;
    /* FFTW takes a plain pointer but keeps the input of a forward real transform. */
    double *in = (double *)(uintptr_t)real;
#pragma omp parallel for num_threads(f->threads) schedule(static)
    for (ptrdiff_t i = 0; i < f->n[0]; i++)
        fftw_execute_dft_r2c(f->plane_forward, in + i * plane,
                             (fftw_complex *)hat + i * f->plane);
    if (f->n[0] > 1) outer_pass(f, 0, hat, hat);
}

void ph_i_fft_backward(ph_fft *f, const double *hat, double *work, double *real)
{
    ptrdiff_t plane = f->n[1] * f->n[2];
    f->count++;
    if (f->n[0] > 1)
        outer_pass(f, 1, (double *)(uintptr_t)hat, work);
    else if (work != hat)
        memcpy(work, hat, 2 * sizeof(double) * (size_t)f->modes);
#pragma omp parallel for num_threads(f->threads) schedule(static)
    for (ptrdiff_t i = 0; i < f->n[0]; i++)
        fftw_execute_dft_c2r(f->plane_backward, (fftw_complex *)work + i * f->plane,
                             real + i * plane);
}
