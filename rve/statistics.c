/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Statistics of the picture: correlation by FFT, lineal path, scatter of the fraction. */
#include "statistics.h"

#include "core/check.h"
#include "space/fft.h"

#include <math.h>
#include <string.h>

void ph_statistics_free(ph_statistics **statistics)
{
    if (!statistics || !*statistics) return;
    for (int a = 0; a < 3; a++) {
        free((*statistics)->two_point[a]);
        free((*statistics)->lineal_path[a]);
    }
    free((*statistics)->correlation);
    free(*statistics);
    *statistics = NULL;
}

/* S2(r) = 1/N sum_x I(x) I(x + r) = F^-1 |F I|^2 / N^2; counts of pairs are whole numbers,
 * to which the result is rounded, so that it is exact. */
static ph_status correlate(const ph_grid *g, const uint8_t *filler, double *s2,
                           ph_error *err)
{
    ph_status st = PH_OK;
    ph_layout layout = ph_i_layout(g);
    ph_fft *fft = NULL;
    double *hat = NULL, *work = NULL, N = (double)layout.cells;
    PH_TRY(ph_i_fft_new(&layout, 1, &fft, err));
    ptrdiff_t modes = ph_i_fft_modes(fft);
    PH_ALLOC(hat, 2 * modes, "a transform");
    PH_ALLOC(work, 2 * modes, "a transform");
    for (ptrdiff_t i = 0; i < layout.cells; i++)
        s2[i] = filler[i];
    ph_i_fft_forward(fft, s2, hat);
    for (ptrdiff_t k = 0; k < modes; k++) {
        hat[2 * k] = hat[2 * k] * hat[2 * k] + hat[2 * k + 1] * hat[2 * k + 1];
        hat[2 * k + 1] = 0;
    }
    ph_i_fft_backward(fft, hat, work, s2);
    for (ptrdiff_t i = 0; i < layout.cells; i++)
        s2[i] = floor(s2[i] / N + 0.5) / N;
out:
    ph_i_fft_free(&fft);
    free(hat);
    free(work);
    return st;
}

static ptrdiff_t stride_of(const ph_grid *g, int a)
{
    return a == 2 ? 1 : a == 1 ? g->n[2] : g->n[1] * g->n[2];
}

static ph_status two_point(const ph_grid *g, const uint8_t *filler, ph_statistics *s,
                           ph_error *err)
{
    ph_status st = PH_OK;
    double *s2 = NULL;
    const ptrdiff_t *n = g->n;
    PH_ALLOC(s2, ph_grid_cells(g), "the correlation");
    PH_ALLOC(s->correlation, ph_grid_cells(g), "the correlation");
    PH_TRY(correlate(g, filler, s2, err));
    for (int a = 0; a < s->dimensions; a++)
        for (ptrdiff_t k = 0; k < s->nlags[a]; k++)
            s->two_point[a][k] = s2[k * stride_of(g, a)];
    for (ptrdiff_t i = 0; i < n[0]; i++)
        for (ptrdiff_t j = 0; j < n[1]; j++)
            for (ptrdiff_t k = 0; k < n[2]; k++) {
                ptrdiff_t to =
                    ((i + n[0] / 2) % n[0] * n[1] + (j + n[1] / 2) % n[1]) * n[2] +
                    (k + n[2] / 2) % n[2];
                s->correlation[to] = s2[(i * n[1] + j) * n[2] + k];
            }
out:
    free(s2);
    return st;
}

/* Runs of filler along the axis, round the box: a run of r cells holds r - lag segments of
 * lag + 1 cells; a line that is filler throughout holds n of every length. */
static void add_runs(const uint8_t *filler, ptrdiff_t start, ptrdiff_t stride,
                     ptrdiff_t n, double *path, ptrdiff_t nlags)
{
    ptrdiff_t first = 0, run = 0;
    while (first < n && filler[start + first * stride])
        first++;
    if (first == n) {
        for (ptrdiff_t k = 0; k < nlags; k++)
            path[k] += (double)n;
        return;
    }
    for (ptrdiff_t i = 1; i <= n; i++) {
        if (filler[start + (first + i) % n * stride]) {
            run++;
            continue;
        }
        for (ptrdiff_t k = 0; k < nlags && k < run; k++)
            path[k] += (double)(run - k);
        run = 0;
    }
}

static void lineal_path(const ph_grid *g, const uint8_t *filler, int a, ph_statistics *s)
{
    ptrdiff_t stride = stride_of(g, a), cells = ph_grid_cells(g);
    for (ptrdiff_t c = 0; c < cells; c++)
        if (c / stride % g->n[a] == 0)
            add_runs(filler, c, stride, g->n[a], s->lineal_path[a], s->nlags[a]);
    for (ptrdiff_t k = 0; k < s->nlags[a]; k++)
        s->lineal_path[a][k] /= (double)cells;
}

static double correlation_length(const ph_grid *g, const ph_statistics *s, int a)
{
    double f = s->fraction, level = exp(-1.0), last = 1;
    if (!(f > 0) || f >= 1) return NAN;
    for (ptrdiff_t k = 1; k < s->nlags[a]; k++) {
        double now = (s->two_point[a][k] - f * f) / (f - f * f);
        if (now <= level)
            return g->h[a] * ((double)(k - 1) + (last - level) / (last - now));
        last = now;
    }
    return g->h[a] * (double)(s->nlags[a] - 1);
}

/* Fractions of the 2^d half boxes (a middle cell of an odd axis belongs to the upper). */
static double half_scatter(const ph_grid *g, const uint8_t *filler, double f)
{
    double in[8] = {0}, all[8] = {0}, sum = 0;
    int boxes = 0;
    ptrdiff_t c = 0;
    for (ptrdiff_t i = 0; i < g->n[0]; i++)
        for (ptrdiff_t j = 0; j < g->n[1]; j++)
            for (ptrdiff_t k = 0; k < g->n[2]; k++, c++) {
                int b =
                    (i >= g->n[0] / 2) + 2 * (j >= g->n[1] / 2) + 4 * (k >= g->n[2] / 2);
                all[b] += 1;
                in[b] += filler[c] != 0;
            }
    for (int b = 0; b < 8; b++) {
        if (all[b] == 0) continue;
        sum += pow(in[b] / all[b] - f, 2);
        boxes++;
    }
    return f > 0 ? sqrt(sum / boxes) / f : (double)NAN;
}

static void mark_filler(const ph_microstructure *m, const ph_packing *p, int matrix,
                        uint8_t *filler)
{
    ptrdiff_t cells = ph_grid_cells(&m->grid);
    bool owners = false;
    for (ptrdiff_t c = 0; p && m->owner && c < cells && !owners; c++)
        owners = m->owner[c] > 0;
    for (ptrdiff_t c = 0; c < cells; c++)
        filler[c] = owners ? m->owner[c] > 0 : m->phase[c] != matrix;
}

static ph_status fill(const ph_microstructure *m, const ph_packing *p,
                      const uint8_t *filler, ph_statistics *s, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_grid *g = &m->grid;
    ptrdiff_t cells = ph_grid_cells(g), in = 0;
    for (ptrdiff_t c = 0; c < cells; c++)
        in += filler[c];
    s->fraction = (double)in / (double)cells;
    for (int a = 0; a < s->dimensions; a++) {
        s->nlags[a] = g->n[a] / 2 + 1;
        PH_ALLOC(s->two_point[a], s->nlags[a], "the correlation");
        PH_ALLOC(s->lineal_path[a], s->nlags[a], "the lineal path");
        lineal_path(g, filler, a, s);
    }
    PH_TRY(two_point(g, filler, s, err));
    s->size_indicator = INFINITY;
    for (int a = 0; a < s->dimensions; a++) {
        s->correlation_length[a] = correlation_length(g, s, a);
        double length = s->correlation_length[a];
        for (ptrdiff_t i = 0; p && i < p->n; i++)
            length = fmax(length, p->filler[i].length);
        s->size_indicator = fmin(s->size_indicator, g->size[a] / length);
    }
    if (isinf(s->size_indicator)) s->size_indicator = NAN;
    s->half_scatter = half_scatter(g, filler, s->fraction);
    PH_TRY(ph_i_percolation(g, filler, s, err));
    PH_TRY(ph_i_filler_statistics(m, p, filler, s, err));
out:
    return st;
}

ph_status ph_rve_statistics(const ph_microstructure *m, const ph_packing *p, int matrix,
                            ph_statistics **out, ph_error *err)
{
    PH_GIVEN(m && out);
    ph_status st = PH_OK;
    ph_statistics *s = NULL;
    uint8_t *filler = NULL;
    *out = NULL;
    PH_CHECK(matrix >= 0 && matrix < m->nmaterials, PH_EINVAL, "matrix %d is no material",
             matrix);
    PH_ALLOC(s, 1, "the statistics");
    PH_ALLOC(filler, ph_grid_cells(&m->grid), "the statistics");
    s->dimensions = m->grid.kinematics == PH_SPACE ? 3 : 2;
    mark_filler(m, p, matrix, filler);
    PH_TRY(fill(m, p, filler, s, err));
    *out = s;
    s = NULL;
out:
    ph_statistics_free(&s);
    free(filler);
    return st;
}
