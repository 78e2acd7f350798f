/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/damaged.h"

#include <math.h>
#include <string.h>

#define R2 0.70710678118654752440 /* 1/sqrt(2): Mandel shear */

static const int place[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};

/* ---- bonds of a node --------------------------------------------------------------------- */

typedef struct around {
    ptrdiff_t i, j, k;
    const uint64_t *broken;
} around;

static around around_node(const ph_damaged *d, ptrdiff_t at)
{
    const ptrdiff_t *n = d->layout.n, x = d->node[at];
    return (around){x / n[2] / n[1] + d->reach[0], x / n[2] % n[1] + d->reach[1],
                    x % n[2] + d->reach[2], d->broken->bits + at * d->broken->words};
}

static inline ptrdiff_t neighbour(const ph_damaged *d, const around *a, ptrdiff_t b)
{
    const int *o = d->o[b];
    return ((ptrdiff_t)d->wrapped[0][a->i + o[0]] * d->layout.n[1] +
            d->wrapped[1][a->j + o[1]]) *
               d->layout.n[2] +
           d->wrapped[2][a->k + o[2]];
}

static inline bool is_intact(const around *a, ptrdiff_t b)
{
    return !(a->broken[b / 64] >> (b % 64) & 1);
}

bool ph_i_damaged_is_mute(const ph_damaged *d, ptrdiff_t at)
{
    const double *k = d->inverse + 6 * at;
    return k[0] == 0.0 && k[1] == 0.0 && k[2] == 0.0;
}

/* ---- making ------------------------------------------------------------------------------ */

static void count_bytes(ph_damaged *d, size_t bytes)
{
    if (d->meter) {
        d->meter->bytes += bytes - d->bytes;
        if (d->meter->bytes > d->meter->peak) d->meter->peak = d->meter->bytes;
    }
    d->bytes = bytes;
}

static ph_status loops(ph_damaged *d, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_family *f = d->family;
    PH_ALLOC(d->o, f->count, "bond offsets");
    PH_ALLOC(d->wxi, f->count, "bond weights");
    for (ptrdiff_t b = 0; b < f->count; b++)
        for (int a = 0; a < 3; a++) {
            int axis = d->layout.axis[a];
            d->o[b][a] = axis >= 0 ? f->offset[b][axis] : 0;
            if (abs(d->o[b][a]) > d->reach[a]) d->reach[a] = abs(d->o[b][a]);
            d->wxi[b][a] = f->w[b] * f->xi[b][a];
        }
    for (int a = 0; a < 3; a++) {
        ptrdiff_t n = d->layout.n[a], span = n + 2 * d->reach[a];
        PH_ALLOC(d->wrapped[a], span, "line numbers");
        for (ptrdiff_t i = 0; i < span; i++) {
            ptrdiff_t at = (i - d->reach[a]) % n;
            d->wrapped[a][i] = (int32_t)(at < 0 ? at + n : at);
        }
    }
out:
    return st;
}

ph_status ph_i_damaged_new(const ph_layout *layout, const ph_broken *broken, double s,
                           int threads, ph_meter *meter, ph_damaged **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_damaged *d = NULL;
    *out = NULL;
    PH_ALLOC(d, 1, "damaged nodes");
    d->layout = *layout;
    d->broken = broken;
    d->family = broken->family;
    d->meter = meter;
    d->threads = threads > 0 ? threads : 1;
    d->s = s;
    PH_TRY(loops(d, err));
    PH_CHECK(ph_i_broken_shape(broken, -1, d->whole), PH_ESINGULAR,
             "the shape tensor of the family is singular");
    PH_TRY(ph_i_damaged_update(d, err));
    *out = d;
    d = NULL;
out:
    ph_i_damaged_free(&d);
    return st;
}

void ph_i_damaged_free(ph_damaged **damaged)
{
    if (!damaged || !*damaged) return;
    ph_damaged *d = *damaged;
    count_bytes(d, 0);
    free(d->o);
    free(d->wxi);
    for (int a = 0; a < 3; a++)
        free(d->wrapped[a]);
    free(d->node);
    free(d->inverse);
    free(d->stress);
    free(d);
    *damaged = NULL;
}

ph_status ph_i_damaged_update(ph_damaged *d, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_broken *br = d->broken;
    size_t count = (size_t)br->damaged;
    int32_t *node = NULL;
    double *inverse = NULL, *stress = NULL;
    PH_ALLOC(node, count, "damaged nodes");
    PH_ALLOC(inverse, 6 * count, "shape tensors of damaged nodes");
    PH_ALLOC(stress, 6 * count, "stresses of damaged nodes");
    d->mute = 0;
    for (ptrdiff_t i = 0, old = 0; i < br->damaged; i++) {
        node[i] = br->node[i];
        while (old < d->count && d->node[old] < node[i])
            old++;
        bool known = old < d->count && d->node[old] == node[i];
        if (known && !br->fresh[i])
            memcpy(inverse + 6 * i, d->inverse + 6 * old, sizeof(double) * 6);
        else
            ph_i_broken_shape(br, i, inverse + 6 * i);
    }
    free(d->node);
    free(d->inverse);
    free(d->stress);
    d->node = node;
    d->inverse = inverse;
    d->stress = stress;
    d->count = br->damaged;
    node = NULL;
    inverse = stress = NULL;
    for (ptrdiff_t i = 0; i < d->count; i++)
        d->mute += ph_i_damaged_is_mute(d, i);
    count_bytes(d, count * (sizeof *d->node + 12 * sizeof(double)));
out:
    free(node);
    free(inverse);
    free(stress);
    return st;
}

/* ---- strain ------------------------------------------------------------------------------ */

/* y[a][r] = sum over intact b of du_a w_b xi_r, and over all of them in `all`, if wanted. */
static inline void moments(const ph_damaged *d, const around *a, int nd, ptrdiff_t x,
                           const double *u, double y[3][3], double (*all)[3])
{
    const ptrdiff_t cells = d->layout.cells;
    double here[3];
    for (int i = 0; i < nd; i++)
        here[i] = u[i * cells + x];
    for (ptrdiff_t b = 0; b < d->family->count; b++) {
        bool intact = is_intact(a, b);
        if (!intact && !all) continue;
        ptrdiff_t to = neighbour(d, a, b);
        const double *w = d->wxi[b];
        for (int i = 0; i < nd; i++) {
            double du = u[i * cells + to] - here[i];
            for (int r = 0; r < nd; r++) {
                if (intact) y[i][r] += du * w[r];
                if (all) all[i][r] += du * w[r];
            }
        }
    }
}

/* G = y K^-1 */
static void times_inverse(const double y[3][3], const double inverse[6], double G[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int r = 0; r < 3; r++)
            G[i][r] = y[i][0] * inverse[place[0][r]] + y[i][1] * inverse[place[1][r]] +
                      y[i][2] * inverse[place[2][r]];
}

static int component(int nd, int a, int r)
{
    return a == r ? a : nd == 3 ? 6 - a - r : 2;
}

static void strain_at(const ph_damaged *d, ptrdiff_t at, const double *u,
                      const double *macro, double scale, double *strain)
{
    const int nd = d->layout.nd, ns = d->layout.ns;
    const ptrdiff_t cells = d->layout.cells, x = d->node[at];
    double y[3][3] = {{0}}, G[3][3] = {{0}}, e[6] = {0};
    bool mute = ph_i_damaged_is_mute(d, at);
    around a = around_node(d, at);
    if (u && !mute) {
        if (nd == 2)
            moments(d, &a, 2, x, u, y, NULL);
        else
            moments(d, &a, 3, x, u, y, NULL);
        times_inverse((const double(*)[3])y, d->inverse + 6 * at, G);
    }
    for (int i = 0; i < nd; i++)
        for (int r = 0; r < nd; r++)
            e[component(nd, i, r)] += scale * G[i][r] * (i == r ? 1.0 : R2);
    for (int c = 0; c < ns; c++)
        strain[c * cells + x] = e[c] + (macro && !mute ? macro[c] : 0.0);
}

void ph_i_damaged_strain(const ph_damaged *d, const double *u, const double *macro,
                         double scale, double *strain)
{
#pragma omp parallel for num_threads(d->threads) schedule(static)
    for (ptrdiff_t at = 0; at < d->count; at++)
        strain_at(d, at, u, macro, scale, strain);
}

void ph_i_damaged_take(ph_damaged *d, double *stress)
{
    const ptrdiff_t cells = d->layout.cells;
    for (ptrdiff_t at = 0; at < d->count; at++)
        for (int c = 0; c < d->layout.ns; c++) {
            double *s = &stress[c * cells + d->node[at]];
            d->stress[6 * at + c] = *s;
            *s = 0.0;
        }
}

/* ---- force ------------------------------------------------------------------------------- */

/* T = scale * sigma K^-1 */
static void pulls(const ph_damaged *d, ptrdiff_t at, double scale, double T[3][3])
{
    const int nd = d->layout.nd;
    double s[3][3] = {{0}};
    for (int i = 0; i < nd; i++)
        for (int r = 0; r < nd; r++)
            s[i][r] =
                scale * d->stress[6 * at + component(nd, i, r)] * (i == r ? 1.0 : R2);
    times_inverse((const double(*)[3])s, d->inverse + 6 * at, T);
}

/* Gradients of the intact bonds and of all: what the correction of (S) needs. */
static void gradients(const ph_damaged *d, ptrdiff_t at, const around *a, const double *u,
                      double G[3][3], double whole[3][3])
{
    double y[3][3] = {{0}}, all[3][3] = {{0}};
    moments(d, a, d->layout.nd, d->node[at], u, y, all);
    times_inverse((const double(*)[3])y, d->inverse + 6 * at, G);
    times_inverse((const double(*)[3])all, d->whole, whole);
}

/* z = du - G xi of one component. */
static double deviation(double du, const double *G, const double *xi)
{
    return du - G[0] * xi[0] - G[1] * xi[1] - G[2] * xi[2];
}

/* The bonds of one node, with everything: forces on the far ends, their sum on the node. */
static inline void scatter_node(const ph_damaged *d, int nd, ptrdiff_t at, double scale,
                                const double *u, double correction, double *f)
{
    const ptrdiff_t cells = d->layout.cells, x = d->node[at];
    const double s = d->s * correction;
    around a = around_node(d, at);
    double T[3][3] = {{0}}, G[3][3], whole[3][3], sum[3] = {0};
    bool corrected = u && s != 0.0, mute = ph_i_damaged_is_mute(d, at);
    pulls(d, at, scale, T);
    if (corrected) gradients(d, at, &a, u, G, whole);
    for (ptrdiff_t b = 0; b < d->family->count; b++) {
        bool intact = is_intact(&a, b);
        if (!intact && !corrected) continue;
        ptrdiff_t to = neighbour(d, &a, b);
        const double *w = d->wxi[b], *xi = d->family->xi[b];
        for (int i = 0; i < nd; i++) {
            double t = 0.0;
            for (int r = 0; intact && r < nd; r++)
                t += T[i][r] * w[r];
            if (corrected) {
                double du = u[i * cells + to] - u[i * cells + x], z = 0.0;
                if (intact && !mute) z = deviation(du, G[i], xi);
                t += s * d->family->w[b] * (z - deviation(du, whole[i], xi));
            }
            f[i * cells + to] += t;
            sum[i] += t;
        }
    }
    for (int i = 0; i < nd; i++)
        f[i * cells + x] -= sum[i];
}

void ph_i_damaged_scatter(ph_damaged *d, double scale, const double *u, double correction,
                          double *f)
{
    for (ptrdiff_t at = 0; at < d->count; at++)
        if (d->layout.nd == 2)
            scatter_node(d, 2, at, scale, u, correction, f);
        else
            scatter_node(d, 3, at, scale, u, correction, f);
}

double ph_i_damaged_energy(const ph_damaged *d, const double *u)
{
    const ptrdiff_t cells = d->layout.cells;
    double energy = 0.0;
    for (ptrdiff_t at = 0; d->s != 0.0 && at < d->count; at++) {
        around a = around_node(d, at);
        double G[3][3], whole[3][3];
        bool mute = ph_i_damaged_is_mute(d, at);
        gradients(d, at, &a, u, G, whole);
        for (ptrdiff_t b = 0; b < d->family->count; b++) {
            ptrdiff_t to = neighbour(d, &a, b);
            for (int i = 0; i < d->layout.nd; i++) {
                double du = u[i * cells + to] - u[i * cells + d->node[at]], z = 0.0;
                if (is_intact(&a, b) && !mute) z = deviation(du, G[i], d->family->xi[b]);
                double z0 = deviation(du, whole[i], d->family->xi[b]);
                energy += d->s * d->family->w[b] * (z * z - z0 * z0);
            }
        }
    }
    return energy;
}
