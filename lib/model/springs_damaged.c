/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows of nodes that have lost springs: sums over those that are intact. */
#include "model/springs.h"

#include <math.h>
#include <string.h>

#define R2 0.70710678118654752440

double ph_i_springs_modulus(const ph_springs *s, ptrdiff_t x, ptrdiff_t b, ptrdiff_t y)
{
    ptrdiff_t place = s->broken ? ph_i_broken_place(s->broken, x) : -1;
    if (place >= 0 && ph_i_is_broken(s->broken, place, b)) return 0.0;
    return ph_i_bond_modulus(s->classes, x, y);
}

/* One intact spring of the damaged node at a place. */
typedef struct spring {
    ptrdiff_t x, y;
    const double *xi;
    double k; /* modulus included */
} spring;

static bool intact(const ph_springs *s, ptrdiff_t place, ptrdiff_t b, spring *out)
{
    if (ph_i_is_broken(s->broken, place, b)) return false;
    out->x = s->broken->node[place];
    out->y = ph_i_springs_end(s, out->x, b);
    out->xi = s->family->xi[b];
    out->k = s->family->w[b] * ph_i_bond_modulus(s->classes, out->x, out->y);
    return out->k != 0.0;
}

/* xi . (u(y) - u(x)) */
static double elongation(const ph_springs *s, const spring *p, const double *u)
{
    double t = 0.0;
    for (int a = 0; a < s->layout.nd; a++)
        t += p->xi[a] * (u[a * s->layout.cells + p->y] - u[a * s->layout.cells + p->x]);
    return t;
}

static ptrdiff_t damaged(const ph_springs *s)
{
    return s->broken ? s->broken->damaged : 0;
}

/* f(x) = sum k (scale xi . (u(x) - u(y)) + xi . macro . xi) xi; u or macro NULL. */
static void forces(const ph_springs *s, const double *u, double scale,
                   const double *macro, double *f)
{
    const int nd = s->layout.nd;
#pragma omp parallel for num_threads(s->threads) schedule(static)
    for (ptrdiff_t place = 0; place < damaged(s); place++) {
        double sum[3] = {0};
        spring p;
        for (ptrdiff_t b = 0; b < s->family->count; b++) {
            if (!intact(s, place, b, &p)) continue;
            double t = u ? -scale * elongation(s, &p, u) : 0.0;
            if (macro) t += ph_i_springs_stretch(nd, p.xi, macro);
            for (int a = 0; a < nd; a++)
                sum[a] += p.k * t * p.xi[a];
        }
        for (int a = 0; a < nd; a++)
            f[a * s->layout.cells + s->broken->node[place]] = sum[a];
    }
}

void ph_i_springs_damaged_apply(const ph_springs *s, const double *u, double scale,
                                double *f)
{
    forces(s, u, scale, NULL, f);
}

void ph_i_springs_damaged_load(const ph_springs *s, const double *macro, double *f)
{
    forces(s, NULL, 0.0, macro, f);
}

/* The gradient of the intact springs, weights k |xi|^2 of unit moduli as elsewhere; false
 * where they do not span space. */
static bool gradient(const ph_springs *s, ptrdiff_t place, const double *u,
                     double G[3][3])
{
    const int nd = s->layout.nd;
    ph_sym4 K = {.n = 3}, inverse; /* a symmetric 3 x 3 matrix, as a 2D tensor */
    ph_error ignored = PH_ERROR_INIT;
    double y[3][3] = {{0}}, trace = 0.0, least = INFINITY;
    spring p;
    for (ptrdiff_t b = 0; b < s->family->count; b++) {
        if (!intact(s, place, b, &p)) continue;
        double w = s->family->w[b], r2 = 0.0;
        for (int a = 0; a < nd; a++)
            r2 += p.xi[a] * p.xi[a];
        for (int a = 0; a < nd; a++) {
            double du = u[a * s->layout.cells + p.y] - u[a * s->layout.cells + p.x];
            for (int d = 0; d < nd; d++) {
                y[a][d] += w * r2 * du * p.xi[d];
                K.m[a][d] += w * r2 * p.xi[a] * p.xi[d];
            }
        }
    }
    for (int a = 0; a < nd; a++)
        trace += K.m[a][a];
    if (nd == 2) K.m[2][2] = trace;
    if (!(trace > 0.0) || ph_sym4_inverse(&K, &inverse, &ignored) != PH_OK) return false;
    for (int a = 0; a < nd; a++)
        for (int d = 0; d < nd; d++) {
            G[a][d] = 0.0;
            for (int e = 0; e < nd; e++)
                G[a][d] += y[a][e] * inverse.m[e][d];
            least = fmin(least, fabs(G[a][d]));
        }
    return isfinite(least);
}

static void node_strain(const ph_springs *s, ptrdiff_t place, const double *u,
                        const double *macro, double *strain)
{
    const int nd = s->layout.nd, ns = s->layout.ns;
    const ptrdiff_t cells = s->layout.cells, x = s->broken->node[place];
    double G[3][3];
    bool spans = gradient(s, place, u, G);
    for (int c = 0; c < ns; c++)
        strain[c * cells + x] = macro && spans ? macro[c] : 0.0;
    for (int a = 0; spans && a < nd; a++)
        for (int d = 0; d < nd; d++) {
            int c = a == d ? a : nd == 3 ? 6 - a - d : 2;
            strain[c * cells + x] += G[a][d] * (a == d ? 1.0 : R2);
        }
}

static void node_stress(const ph_springs *s, ptrdiff_t place, const double *u,
                        const double *macro, double *stress, double *energy)
{
    const int nd = s->layout.nd, ns = s->layout.ns;
    const ptrdiff_t cells = s->layout.cells, x = s->broken->node[place];
    double sum[6] = {0}, work = 0.0;
    spring p;
    for (ptrdiff_t b = 0; b < s->family->count; b++) {
        if (!intact(s, place, b, &p)) continue;
        double e = elongation(s, &p, u);
        if (macro) e += ph_i_springs_stretch(nd, p.xi, macro);
        double t = 0.5 * p.k * e;
        work += t * e;
        for (int a = 0; a < nd; a++)
            for (int d = a; d < nd; d++) {
                int c = a == d ? a : nd == 3 ? 6 - a - d : 2;
                sum[c] += t * p.xi[a] * p.xi[d] * (a == d ? 1.0 : 2.0 * R2);
            }
    }
    for (int c = 0; stress && c < ns; c++)
        stress[c * cells + x] = sum[c];
    if (energy) energy[x] = work;
}

void ph_i_springs_damaged_fields(const ph_springs *s, const double *u,
                                 const double *macro, double *stress, double *strain,
                                 double *energy)
{
#pragma omp parallel for num_threads(s->threads) schedule(static)
    for (ptrdiff_t place = 0; place < damaged(s); place++) {
        if (strain) node_strain(s, place, u, macro, strain);
        if (stress || energy) node_stress(s, place, u, macro, stress, energy);
    }
}
