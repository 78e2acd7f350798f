/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the loops of cells.c and cells_sums.c share: the lines of one row of cells, and the
 * arithmetic of its modes, a vector of cells at a time. */
#ifndef PH_MODEL_CELLS_KERNEL_H
#define PH_MODEL_CELLS_KERNEL_H

#include "core/real.h"
#include "model/cells.h"

#include <string.h>

/* Mode lines of one cell row, by direction: the gradient g[component][direction], and the
 * raw hourglass sums q[component][pair], pair 0: 23, 1: 13, 2: 12, 3: 123. */
enum { PAIRS = 4, LINES = 3 * 3 + 3 * PAIRS + 3 };

typedef struct row {
    real *g[3][3], *q[3][PAIRS]; /* read; a line of zeros where there is no such mode */
    real *t[3][3], *p[3][PAIRS]; /* written; a waste line where there is none */
    real *tmp;
} row;

/** Does the operator have modes beside the average strain? */
static inline bool ph_i_cells_has_modes(const ph_cells *c)
{
    return c->c1 != 0.0 || c->c2 != 0.0 || c->hourglass != 0.0;
}

/** Point the lines of a thread's workspace at their modes. */
row PH_REAL(ph_i_cells_lines)(const ph_cells *c, int thread);
/** Read the modes of cell row (i, j) of u into the lines g and, if `modes`, q. */
void PH_REAL(ph_i_cells_gather)(const ph_cells *c, const real *u, ptrdiff_t i,
                                ptrdiff_t j, bool modes, row *r);

/* ---- strain and stress of the modes, a vector of cells at a time ---------------------------- */

#define R2 ((real)0.70710678118654752440) /* 1/sqrt(2): Mandel shear */

enum { LANES = 32 / sizeof(real) };
typedef real vec __attribute__((vector_size(32)));
typedef real vec_in_memory
    __attribute__((vector_size(32), aligned(sizeof(real)), may_alias));
typedef real_mask lanes __attribute__((vector_size(32)));

static inline vec load(const real *a)
{
    return *(const vec_in_memory *)a;
}

/* Store the lanes that belong to the run, keep what stands in the others. */
static inline void store(real *a, vec v, lanes own)
{
    *(vec_in_memory *)a = (vec)(((lanes)v & own) | ((lanes)load(a) & ~own));
}

static inline vec all(real x)
{
    vec v;
    for (int i = 0; i < LANES; i++)
        v[i] = x;
    return v;
}

/* Lanes before `end`. */
static inline lanes first_lanes(ptrdiff_t end)
{
    lanes v;
    for (int i = 0; i < LANES; i++)
        v[i] = i < end ? -1 : 0;
    return v;
}

/* e += strain of sym(v (x) axis d). nd, d compile-time. */
static inline void add_column(int nd, vec *e, int d, const vec *v)
{
    e[d] += v[d];
    if (nd == 2) {
        e[2] += R2 * v[1 - d];
        return;
    }
    const int p = (d + 1) % 3, q = (d + 2) % 3;
    e[6 - d - p] += R2 * v[p];
    e[6 - d - q] += R2 * v[q];
}

/* v = w * column d of the stress */
static inline void take_column(int nd, const vec *s, int d, real w, vec *v)
{
    v[d] = w * s[d];
    if (nd == 2) {
        v[1 - d] = w * R2 * s[2];
        return;
    }
    const int p = (d + 1) % 3, q = (d + 2) % 3;
    v[p] = w * R2 * s[6 - d - p];
    v[q] = w * R2 * s[6 - d - q];
}

static inline void hooke(int ns, ph_hooke kind, const real *c, const vec *e, vec *s)
{
    const int normal = ns == 6 ? 3 : 2;
    if (kind == PH_HOOKE_ISOTROPIC) {
        vec tr = c[1] * (ns == 6 ? e[0] + e[1] + e[2] : e[0] + e[1]);
        real mu2 = c[ns * ns - 1];
#pragma GCC unroll 6
        for (int i = 0; i < ns; i++)
            s[i] = i < normal ? mu2 * e[i] + tr : mu2 * e[i];
    } else {
#pragma GCC unroll 6
        for (int i = 0; i < ns; i++) {
            s[i] = c[i * ns] * e[0];
#pragma GCC unroll 6
            for (int j = 1; j < ns; j++)
                s[i] += c[i * ns + j] * e[j];
        }
    }
}

typedef struct weights {
    real f[3], c1, c2, hourglass, scale;
    real macro[6];
} weights;

/* Average strain -> tractions; the stresses are added to `sum`, if that is not NULL. */
static inline void mean_mode(int nd, ph_hooke kind, const real *c, const weights *w,
                             const row *r, ptrdiff_t k, lanes own, vec *sum)
{
    const int ns = nd == 3 ? 6 : 3;
    vec e[6], s[6], v[3];
#pragma GCC unroll 6
    for (int i = 0; i < ns; i++)
        e[i] = all(w->macro[i]);
#pragma GCC unroll 3
    for (int d = 0; d < nd; d++) {
#pragma GCC unroll 3
        for (int a = 0; a < nd; a++)
            v[a] = load(&r->g[a][d][k]);
        add_column(nd, e, d, v);
    }
    hooke(ns, kind, c, e, s);
#pragma GCC unroll 6
    for (int i = 0; sum && i < ns; i++)
        sum[i] += (vec)((lanes)s[i] & own);
#pragma GCC unroll 3
    for (int d = 0; d < nd; d++) {
        take_column(nd, s, d, w->scale * w->f[d], v);
#pragma GCC unroll 3
        for (int a = 0; a < nd; a++)
            store(&r->t[a][d][k], v[a], own);
    }
}

/* p += forces of the modes linear along d, whose gradient has the columns of the other axes. */
static inline void linear_mode(int nd, ph_hooke kind, const real *c, const weights *w,
                               int d, vec q[PAIRS][3], vec p[PAIRS][3])
{
    const int ns = nd == 3 ? 6 : 3;
    vec e[6], s[6], v[3];
#pragma GCC unroll 6
    for (int i = 0; i < ns; i++)
        e[i] = all(0);
#pragma GCC unroll 3
    for (int b = 0; b < nd; b++) {
        if (b == d) continue;
#pragma GCC unroll 3
        for (int a = 0; a < nd; a++)
            v[a] = w->f[b] * q[3 - d - b][a];
        add_column(nd, e, b, v);
    }
    hooke(ns, kind, c, e, s);
#pragma GCC unroll 3
    for (int b = 0; b < nd; b++) {
        if (b == d) continue;
        take_column(nd, s, b, w->scale * w->c1 * w->f[b], v);
#pragma GCC unroll 3
        for (int a = 0; a < nd; a++)
            p[3 - d - b][a] += v[a];
    }
}

/* p += forces of the mode bilinear in the axes other than d: one column. */
static inline void bilinear_mode(ph_hooke kind, const real *c, const weights *w, int d,
                                 vec q[PAIRS][3], vec p[PAIRS][3])
{
    vec e[6], s[6], v[3];
#pragma GCC unroll 6
    for (int i = 0; i < 6; i++)
        e[i] = all(0);
#pragma GCC unroll 3
    for (int a = 0; a < 3; a++)
        v[a] = w->f[d] * q[3][a];
    add_column(3, e, d, v);
    hooke(6, kind, c, e, s);
    take_column(3, s, d, w->scale * w->c2 * w->f[d], v);
#pragma GCC unroll 3
    for (int a = 0; a < 3; a++)
        p[3][a] += v[a];
}

/* The modes beside the average. The lines q and p are the same: read all, then write. */
static inline void other_modes(int nd, ph_hooke kind, const real *c, const weights *w,
                               const row *r, ptrdiff_t k, lanes own)
{
    const int low = nd == 3 ? 0 : 2, high = nd == 3 ? PAIRS : 3;
    vec q[PAIRS][3], p[PAIRS][3];
#pragma GCC unroll 4
    for (int m = low; m < high; m++)
#pragma GCC unroll 3
        for (int a = 0; a < nd; a++) {
            q[m][a] = load(&r->q[a][m][k]);
            p[m][a] = w->scale * w->hourglass * q[m][a];
        }
#pragma GCC unroll 3
    for (int d = 0; d < nd; d++)
        linear_mode(nd, kind, c, w, d, q, p);
    if (nd == 3) {
#pragma GCC unroll 3
        for (int d = 0; d < 3; d++)
            bilinear_mode(kind, c, w, d, q, p);
    }
#pragma GCC unroll 4
    for (int m = low; m < high; m++)
#pragma GCC unroll 3
        for (int a = 0; a < nd; a++)
            store(&r->p[a][m][k], p[m][a], own);
}

/** Weights of one application. @param macro [ns] Mandel, or NULL */
static inline weights ph_i_cells_weights(const ph_cells *c, const double *macro,
                                         double scale)
{
    weights w = {.c1 = (real)c->c1,
                 .c2 = (real)c->c2,
                 .hourglass = (real)c->hourglass,
                 .scale = (real)scale};
    for (int d = 0; d < 3; d++)
        w.f[d] = (real)c->f[d];
    for (int i = 0; macro && i < c->layout.ns; i++)
        w.macro[i] = (real)macro[i];
    return w;
}

#endif
