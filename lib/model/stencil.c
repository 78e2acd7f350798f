/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/stencil.h"

#include <omp.h>
#include <string.h>

enum { BLOCK = 4 }; /* nodes along the last loop that are summed in registers */

static int find_group(const ph_stencil *s, ptrdiff_t n, int a, int b)
{
    for (ptrdiff_t i = 0; i < n; i++)
        if (s->group[i][0] == a && s->group[i][1] == b) return (int)i;
    return -1;
}

ph_status ph_i_stencil_new(const ph_layout *layout, ptrdiff_t count,
                           const int (*offset)[3], const double (*g)[3], int threads,
                           ph_stencil **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_stencil *s = NULL;
    *out = NULL;
    PH_ALLOC(s, 1, "a stencil");
    s->layout = *layout;
    s->threads = threads > 0 ? threads : 1;
    s->count = count;
    PH_ALLOC(s->offset, count, "stencil offsets");
    PH_ALLOC(s->g, count, "stencil weights");
    PH_ALLOC(s->group, count, "stencil groups");
    PH_ALLOC(s->member, count, "stencil groups");
    for (ptrdiff_t b = 0; b < count; b++) {
        for (int a = 0; a < 3; a++)
            s->offset[b][a] = layout->axis[a] >= 0 ? offset[b][layout->axis[a]] : 0;
        memcpy(s->g[b], g[b], sizeof s->g[b]);
        int k = abs(s->offset[b][2]), i = s->offset[b][0], j = s->offset[b][1];
        if (k > s->reach) s->reach = k;
        s->member[b] = find_group(s, s->groups, i, j);
        if (s->member[b] < 0) {
            s->member[b] = (int)s->groups;
            s->group[s->groups][0] = i;
            s->group[s->groups++][1] = j;
        }
    }
    PH_ALLOC(s->start, s->threads * s->groups, "stencil rows");
    *out = s;
    s = NULL;
out:
    ph_i_stencil_free(&s);
    return st;
}

void ph_i_stencil_free(ph_stencil **stencil)
{
    if (!stencil || !*stencil) return;
    free((*stencil)->offset);
    free((*stencil)->g);
    free((*stencil)->group);
    free((*stencil)->member);
    free((*stencil)->start);
    free(*stencil);
    *stencil = NULL;
}

ptrdiff_t ph_i_stencil_row(const ph_stencil *s)
{
    return s->layout.n[2] + 2 * s->reach + BLOCK;
}

static ptrdiff_t wrap(ptrdiff_t i, ptrdiff_t n)
{
    i %= n;
    return i < 0 ? i + n : i;
}

/* Rows with periodic margins, so that bonds along the last loop need no wrapping. */
static void pad_field(const ph_stencil *s, int components, const double *from,
                      double *pad)
{
    ptrdiff_t n = s->layout.n[2], rows = components * s->layout.n[0] * s->layout.n[1];
    ptrdiff_t row = ph_i_stencil_row(s);
#pragma omp parallel for num_threads(s->threads) schedule(static)
    for (ptrdiff_t r = 0; r < rows; r++) {
        double *to = pad + r * row;
        memcpy(to + s->reach, from + r * n, sizeof(double) * (size_t)n);
        for (ptrdiff_t k = 0; k < s->reach; k++)
            to[k] = from[r * n + wrap(k - s->reach, n)];
        for (ptrdiff_t k = n + s->reach; k < row; k++)
            to[k] = from[r * n + wrap(k - s->reach, n)];
    }
}

/* First padded element of the neighbour row of each group, for component 0. */
static void group_rows(const ph_stencil *s, ptrdiff_t i, ptrdiff_t j, int sign,
                       ptrdiff_t *start)
{
    ptrdiff_t row = ph_i_stencil_row(s);
    for (ptrdiff_t g = 0; g < s->groups; g++)
        start[g] = (wrap(i + sign * s->group[g][0], s->layout.n[0]) * s->layout.n[1] +
                    wrap(j + sign * s->group[g][1], s->layout.n[1])) *
                       row +
                   s->reach;
}

#define R2 0.70710678118654752440

/* Mandel strain of a gradient G[a][d], v-th of a block; nd compile-time. */
static inline void to_strain(int nd, double G[3][3][BLOCK], int v, double *e)
{
    e[0] = G[0][0][v];
    e[1] = G[1][1][v];
    if (nd == 2) {
        e[2] = R2 * (G[0][1][v] + G[1][0][v]);
        return;
    }
    e[2] = G[2][2][v];
    e[3] = R2 * (G[1][2][v] + G[2][1][v]);
    e[4] = R2 * (G[0][2][v] + G[2][0][v]);
    e[5] = R2 * (G[0][1][v] + G[1][0][v]);
}

static inline void strain_row(const ph_stencil *s, int nd, const double *pad,
                              const ptrdiff_t *start, const double *macro, ptrdiff_t x,
                              double *strain)
{
    const ph_layout *l = &s->layout;
    const ptrdiff_t stride = l->n[0] * l->n[1] * ph_i_stencil_row(s), n = l->n[2];
    const int ns = nd == 3 ? 6 : 3;
    for (ptrdiff_t k = 0; k < n; k += BLOCK) {
        double G[3][3][BLOCK] = {{{0}}};
        for (ptrdiff_t b = 0; b < s->count; b++) {
            const double *u = pad + start[s->member[b]] + s->offset[b][2] + k;
#pragma GCC unroll 3
            for (int a = 0; a < nd; a++)
#pragma GCC unroll 3
                for (int d = 0; d < nd; d++)
#pragma omp simd
                    for (int v = 0; v < BLOCK; v++)
                        G[a][d][v] += s->g[b][d] * u[a * stride + v];
        }
        ptrdiff_t many = n - k < BLOCK ? n - k : BLOCK;
        for (int v = 0; v < many; v++) {
            double e[6];
            to_strain(nd, G, v, e);
            for (int i = 0; i < ns; i++)
                strain[i * l->cells + x + k + v] = e[i] + (macro ? macro[i] : 0.0);
        }
    }
}

void ph_i_stencil_strain(const ph_stencil *s, const double *u, const double *macro,
                         double *pad, double *strain)
{
    const ph_layout *l = &s->layout;
    pad_field(s, l->nd, u, pad);
#pragma omp parallel for num_threads(s->threads) schedule(static)
    for (ptrdiff_t r = 0; r < l->n[0] * l->n[1]; r++) {
        ptrdiff_t *start = s->start + omp_get_thread_num() * s->groups;
        group_rows(s, r / l->n[1], r % l->n[1], 1, start);
        if (l->nd == 3)
            strain_row(s, 3, pad, start, macro, r * l->n[2], strain);
        else
            strain_row(s, 2, pad, start, macro, r * l->n[2], strain);
    }
}

/* f_a = sum_b sum_d g_bd sigma_ad(x - o_b); sigma from Mandel components. */
static inline void divergence_row(const ph_stencil *s, int nd, const double *pad,
                                  const ptrdiff_t *start, double scale, bool add,
                                  ptrdiff_t x, double *f)
{
    static const int component[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
    const ph_layout *l = &s->layout;
    const ptrdiff_t stride = l->n[0] * l->n[1] * ph_i_stencil_row(s), n = l->n[2];
    for (ptrdiff_t k = 0; k < n; k += BLOCK) {
        double F[3][BLOCK] = {{0}};
        for (ptrdiff_t b = 0; b < s->count; b++) {
            const double *t = pad + start[s->member[b]] - s->offset[b][2] + k;
#pragma GCC unroll 3
            for (int a = 0; a < nd; a++)
#pragma GCC unroll 3
                for (int d = 0; d < nd; d++) {
                    int c = nd == 3 ? component[a][d] : (a == d ? a : 2);
                    double g = s->g[b][d] * (a == d ? 1.0 : R2);
#pragma omp simd
                    for (int v = 0; v < BLOCK; v++)
                        F[a][v] += g * t[c * stride + v];
                }
        }
        ptrdiff_t many = n - k < BLOCK ? n - k : BLOCK;
        for (int a = 0; a < nd; a++)
            for (int v = 0; v < many; v++) {
                double *to = &f[a * l->cells + x + k + v];
                *to = (add ? *to : 0.0) + scale * F[a][v];
            }
    }
}

void ph_i_stencil_divergence(const ph_stencil *s, const double *stress, double scale,
                             bool add, double *pad, double *f)
{
    const ph_layout *l = &s->layout;
    pad_field(s, l->ns, stress, pad);
#pragma omp parallel for num_threads(s->threads) schedule(static)
    for (ptrdiff_t r = 0; r < l->n[0] * l->n[1]; r++) {
        ptrdiff_t *start = s->start + omp_get_thread_num() * s->groups;
        group_rows(s, r / l->n[1], r % l->n[1], -1, start);
        if (l->nd == 3)
            divergence_row(s, 3, pad, start, scale, add, r * l->n[2], f);
        else
            divergence_row(s, 2, pad, start, scale, add, r * l->n[2], f);
    }
}

static inline void hooke_run(int ns, bool isotropic, const double *c, ptrdiff_t cells,
                             const double *e, double *s, ptrdiff_t from, ptrdiff_t to)
{
    const int normal = ns == 6 ? 3 : 2;
#pragma omp simd
    for (ptrdiff_t x = from; x < to; x++) {
        double v[6], tr = 0.0;
        for (int i = 0; i < ns; i++)
            v[i] = e[i * cells + x];
        for (int i = 0; i < normal; i++)
            tr += v[i];
        for (int i = 0; i < ns; i++) {
            double t = 0.0;
            if (isotropic)
                t = c[ns * ns - 1] * v[i] + (i < normal ? c[1] * tr : 0.0);
            else
                for (int j = 0; j < ns; j++)
                    t += c[i * ns + j] * v[j];
            s[i * cells + x] = t;
        }
    }
}

void ph_i_hooke_field(const ph_stiffness_map *map, int threads, const double *strain,
                      double *stress)
{
    static const double nothing[36];
    enum { CHUNK = 4096 };
    ptrdiff_t n = map->cells, chunks = (n + CHUNK - 1) / CHUNK;
#pragma omp parallel for num_threads(threads) schedule(static)
    for (ptrdiff_t q = 0; q < chunks; q++) {
        ptrdiff_t end = (q + 1) * CHUNK < n ? (q + 1) * CHUNK : n, to;
        for (ptrdiff_t from = q * CHUNK; from < end; from = to) {
            int entry = map->index[from];
            for (to = from + 1; to < end && map->index[to] == entry;)
                to++;
            const double *c = map->c + (ptrdiff_t)entry * map->ns * map->ns;
            if (map->hooke[entry] == PH_HOOKE_ZERO) c = nothing;
            bool iso = map->hooke[entry] == PH_HOOKE_ISOTROPIC;
            if (map->ns == 6 && iso)
                hooke_run(6, true, c, n, strain, stress, from, to);
            else if (map->ns == 6)
                hooke_run(6, false, c, n, strain, stress, from, to);
            else if (iso)
                hooke_run(3, true, c, n, strain, stress, from, to);
            else
                hooke_run(3, false, c, n, strain, stress, from, to);
        }
    }
}
