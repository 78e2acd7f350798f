/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The operator of a homogeneous medium, mode by mode. */
#include "model/operator.h"

#include <math.h>
#include <string.h>

#define R2_HALF 0.70710678118654752440 /* Mandel to tensor shear */

/* P += weight * N_d^T C0 N_e Q_de, with Q the real part of conj(g_d) g_e. */
static void add_symbol(const ph_operator *op, double elasticity[3][3][3][3],
                       double Q[3][3], double weight, ptrdiff_t k, double *P)
{
    int nd = op->layout.nd;
    static const int place3[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
    static const int place2[2][2] = {{0, 2}, {2, 1}};
    for (int i = 0; i < nd; i++)
        for (int j = i; j < nd; j++) {
            double p = 0.0;
            for (int d = 0; d < 3; d++)
                for (int e = 0; e < 3; e++)
                    p += elasticity[i][d][j][e] * Q[d][e];
            int at = nd == 3 ? place3[i][j] : place2[i][j];
            P[at * op->modes + k] += weight * p;
        }
}

static void full_tensor(const ph_sym4 *c, double t[3][3][3][3])
{
    static const int place3[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
    static const int place2[2][2] = {{0, 2}, {2, 1}};
    int nd = c->n == 6 ? 3 : 2;
    memset(t, 0, sizeof(double) * 81);
    for (int i = 0; i < nd; i++)
        for (int j = 0; j < nd; j++)
            for (int k = 0; k < nd; k++)
                for (int m = 0; m < nd; m++) {
                    int a = nd == 3 ? place3[i][j] : place2[i][j];
                    int b = nd == 3 ? place3[k][m] : place2[k][m];
                    t[i][j][k][m] =
                        c->m[a][b] * (i == j ? 1.0 : R2_HALF) * (k == m ? 1.0 : R2_HALF);
                }
}

/* Corner cells: |symbols| of the modes are products of sines and cosines of k/2; modes of
 * one energy term share their phase, so that only the moduli matter. */
static void add_cells_symbol(const ph_operator *op, double elasticity[3][3][3][3],
                             double *P)
{
    const ph_layout *l = &op->layout;
    const ph_cells *c = &op->cells;
    ptrdiff_t row = ph_i_fft_row(op->fft);
    const double pi = 3.14159265358979323846;
#pragma omp parallel for num_threads(op->threads) schedule(static, PH_CHUNK)
    for (ptrdiff_t m = 0; m < op->modes; m++) {
        ptrdiff_t at[3] = {m / row / l->n[1], m / row % l->n[1], m % row};
        double sn[3] = {0, 0, 0}, cs[3] = {1, 1, 1}, Q[3][3], g[3];
        for (int a = 0; a < 3; a++) {
            if (l->axis[a] < 0) continue;
            double half = pi * (double)at[a] / (double)l->n[a];
            sn[l->axis[a]] = 2.0 * sin(half);
            cs[l->axis[a]] = 2.0 * cos(half);
        }
        for (int mode = 0; mode < 8; mode++) { /* bit d: the mode is linear along d */
            int linear = (mode & 1) + (mode >> 1 & 1) + (mode >> 2 & 1);
            double w = linear == 0   ? 1.0
                       : linear == 1 ? c->c1
                       : linear == 2 ? c->c2
                                     : 0.0;
            if (w == 0.0) continue;
            for (int d = 0; d < 3; d++) {
                g[d] = (mode >> d & 1) ? 0.0 : c->f[d] * sn[d];
                for (int e = 0; e < 3; e++)
                    if (e != d) g[d] *= (mode >> e & 1) ? sn[e] : cs[e];
            }
            for (int d = 0; d < 3; d++)
                for (int e = 0; e < 3; e++)
                    Q[d][e] = g[d] * g[e];
            add_symbol(op, elasticity, Q, w, m, P);
        }
        if (c->hourglass == 0.0) continue;
        double all = 1.0, one = 1.0, grad = 0.0;
        for (int d = 0; d < 3; d++)
            one *= cs[d] * cs[d];
        for (int d = 0; d < 3; d++)
            all *= cs[d] * cs[d] + sn[d] * sn[d];
        for (int d = 0; d < 3; d++) {
            double v = sn[d] * sn[d];
            for (int e = 0; e < 3; e++)
                if (e != d) v *= cs[e] * cs[e];
            grad += v;
        }
        for (int a = 0; a < l->nd; a++)
            P[a * op->modes + m] += c->hourglass * (all - one - grad);
    }
}

static ph_status add_stencil_symbol(ph_operator *op, double elasticity[3][3][3][3],
                                    ptrdiff_t count, const int (*offset)[3],
                                    const double (*g)[3], double weight, double *P,
                                    ph_error *err)
{
    ph_status st = PH_OK;
    const ph_layout *l = &op->layout;
    double *hat[3] = {NULL, NULL, NULL};
    for (int a = 0; a < 3; a++) {
        int d = l->axis[a];
        if (d < 0) continue;
        PH_DOUBLES(hat[d], op->meter, (size_t)(2 * op->modes), "a gradient symbol");
        ph_i_gradient_symbol(op->fft, l, count, offset, g, d, op->f, hat[d]);
    }
#pragma omp parallel for num_threads(op->threads) schedule(static, PH_CHUNK)
    for (ptrdiff_t k = 0; k < op->modes; k++) {
        double Q[3][3] = {{0}};
        for (int d = 0; d < 3; d++)
            for (int e = 0; e < 3; e++)
                if (hat[d] && hat[e])
                    Q[d][e] = hat[d][2 * k] * hat[e][2 * k] +
                              hat[d][2 * k + 1] * hat[e][2 * k + 1];
        add_symbol(op, elasticity, Q, weight, k, P);
    }
out:
    for (int d = 0; d < 3; d++)
        ph_i_doubles_free(op->meter, &hat[d], (size_t)(2 * op->modes));
    return st;
}

/* A stencil keeps its offsets by loop; the symbol wants them by direction. */
static ph_status add_simplex_symbol(ph_operator *op, double elasticity[3][3][3][3],
                                    const ph_stencil *s, double weight, double *P,
                                    ph_error *err)
{
    int offset[4][3] = {{0}};
    for (ptrdiff_t b = 0; b < s->count; b++)
        for (int a = 0; a < 3; a++)
            if (op->layout.axis[a] >= 0) offset[b][op->layout.axis[a]] = s->offset[b][a];
    return add_stencil_symbol(op, elasticity, s->count, (const int(*)[3])offset,
                              (const double(*)[3])s->g, weight, P, err);
}

ph_status ph_i_operator_symbol(ph_operator *op, const ph_sym4 *C0, double *P,
                               ph_error *err)
{
    ph_status st = PH_OK;
    double elasticity[3][3][3][3];
    int nd = op->layout.nd;
    if (op->springs) /* any multiple is as good a preconditioner */
        return ph_i_springs_symbol(op->springs, C0->m[0][0], P, err);
    full_tensor(C0, elasticity);
    memset(P, 0, sizeof(double) * (size_t)(nd * (nd + 1) / 2 * op->modes));
    if (op->has_cells)
        add_cells_symbol(op, elasticity, P);
    else
        PH_TRY(add_stencil_symbol(op, elasticity, op->family->count,
                                  (const int(*)[3])op->family->offset,
                                  (const double(*)[3])op->family->g, op->share, P, err));
    for (int i = 0; i < op->nsub; i++)
        PH_TRY(add_simplex_symbol(op, elasticity, op->sub[i],
                                  (1.0 - op->share) / op->nsub, P, err));
    for (int a = 0; op->spectral && a < nd; a++)
        for (ptrdiff_t k = 0; k < op->modes; k++)
            P[a * op->modes + k] += op->stabilise * op->spectral[k];
out:
    return st;
}
