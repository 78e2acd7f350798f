/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solve/green.h"

#include "core/jacobi.h"

#include <math.h>
#include <string.h>

/* Eigenvalues below this share of the largest one at the same k are modes that the
 * operator does not see (hourglass without stabilisation): left alone. */
static const double blind = 1e-12;

static int packed_size(int nd)
{
    return nd * (nd + 1) / 2;
}

/* Pseudo-inverse of a symmetric matrix. a: n x n, destroyed. */
static void pseudo_inverse(int n, double a[3][3], double least, double inv[3][3])
{
    double v[3][3];
    ph_i_jacobi(n, 3, &a[0][0], &v[0][0]);
    double top = least;
    for (int i = 0; i < n; i++)
        top = fmax(top, fabs(a[i][i]));
    memset(inv, 0, sizeof(double) * 9);
    for (int i = 0; i < n; i++) {
        if (a[i][i] <= blind * top) continue;
        for (int r = 0; r < n; r++)
            for (int c = 0; c < n; c++)
                inv[r][c] += v[r][i] * v[c][i] / a[i][i];
    }
}

static const int place3[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
static const int place2[2][2] = {{0, 2}, {2, 1}};

/* By cofactors where the matrix is far from singular, which is nearly everywhere. */
static bool plain_inverse(int n, double a[3][3], double inv[3][3])
{
    double top = fmax(fabs(a[0][0]), fabs(a[1][1]));
    if (n == 2) {
        double det = a[0][0] * a[1][1] - a[0][1] * a[1][0];
        if (!(det > 1e-8 * top * top)) return false;
        inv[0][0] = a[1][1] / det, inv[1][1] = a[0][0] / det;
        inv[0][1] = inv[1][0] = -a[0][1] / det;
        return true;
    }
    top = fmax(top, fabs(a[2][2]));
    double c[3][3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            c[i][j] = a[i1][j1] * a[i2][j2] - a[i1][j2] * a[i2][j1];
        }
    double det = a[0][0] * c[0][0] + a[0][1] * c[0][1] + a[0][2] * c[0][2];
    if (!(det > 1e-8 * top * top * top)) return false;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            inv[i][j] = c[j][i] / det;
    return true;
}

/* In units of `top`, the largest entry of all modes: products of three entries in units of
 * the user may overflow. */
static void invert_mode(double *P, int nd, ptrdiff_t modes, ptrdiff_t k, double top)
{
    double a[3][3] = {{0}}, inv[3][3] = {{0}};
    for (int i = 0; i < nd; i++)
        for (int j = 0; j < nd; j++)
            a[i][j] = P[(nd == 3 ? place3[i][j] : place2[i][j]) * modes + k] / top;
    bool seen = a[0][0] > 1e-14;
    if (!seen || !plain_inverse(nd, a, inv)) pseudo_inverse(nd, a, 1e-14, inv);
    for (int i = 0; i < nd; i++)
        for (int j = i; j < nd; j++)
            P[(nd == 3 ? place3[i][j] : place2[i][j]) * modes + k] = inv[i][j] / top;
}

ph_status ph_i_green_init(ph_green *g, ph_operator *op, const ph_sym4 *C0,
                          double *storage, ph_error *err)
{
    ph_status st = PH_OK;
    g->nd = op->layout.nd;
    g->threads = op->threads;
    g->modes = op->modes;
    g->inverse = storage;
    if (!storage)
        PH_DOUBLES(g->inverse, op->meter, (size_t)(packed_size(g->nd) * g->modes),
                   "the preconditioner");
    PH_TRY(ph_i_operator_symbol(op, C0, g->inverse, err));
    double top = 0.0;
    for (ptrdiff_t k = 0; k < g->nd * g->modes; k++)
        top = fmax(top, g->inverse[k]);
    PH_CHECK(isfinite(top), PH_ESINGULAR, "the reference medium is not finite");
    if (top == 0.0) goto out; /* one cell: nothing to invert */
#pragma omp parallel for num_threads(g->threads) schedule(static, PH_CHUNK)
    for (ptrdiff_t k = 1; k < g->modes; k++)
        invert_mode(g->inverse, g->nd, g->modes, k, top);
    for (int i = 0; i < packed_size(g->nd); i++)
        g->inverse[i * g->modes] = 0.0;
out:
    return st;
}

void ph_i_green_clear(ph_green *g, ph_meter *meter)
{
    ph_i_doubles_free(meter, &g->inverse, (size_t)(packed_size(g->nd) * g->modes));
}

/* One real factor for the two parts of each complex number: two modes at a time. */
typedef double pair4 __attribute__((vector_size(32), aligned(8), may_alias));

static inline pair4 twice(const double *a)
{
    return (pair4){a[0], a[0], a[1], a[1]};
}
static inline pair4 load4(const double *a)
{
    return *(const pair4 *)a;
}
static inline void store4(double *a, pair4 v)
{
    *(pair4 *)a = v;
}

static void apply_one(const ph_green *g, ptrdiff_t k, const double *r, double *z)
{
    const ptrdiff_t n = g->modes;
    for (int part = 0; part < 2; part++) {
        double v[3] = {0};
        for (int i = 0; i < g->nd; i++)
            for (int j = 0; j < g->nd; j++)
                v[i] += g->inverse[(g->nd == 3 ? place3[i][j] : place2[i][j]) * n + k] *
                        r[2 * (j * n + k) + part];
        for (int i = 0; i < g->nd; i++)
            z[2 * (i * n + k) + part] = v[i];
    }
}

static inline void apply_pair(const ph_green *g, ptrdiff_t k, const double *r, double *z)
{
    const ptrdiff_t n = g->modes, y = 2 * n, w = 4 * n;
    const double *a = g->inverse + k; /* 00 11 22 12 02 01, or 00 11 01 */
    pair4 r0 = load4(r + 2 * k), r1 = load4(r + 2 * k + y);
    if (g->nd == 2) {
        pair4 off = twice(a + 2 * n);
        store4(z + 2 * k, twice(a) * r0 + off * r1);
        store4(z + 2 * k + y, off * r0 + twice(a + n) * r1);
        return;
    }
    pair4 r2 = load4(r + 2 * k + w);
    pair4 a12 = twice(a + 3 * n), a02 = twice(a + 4 * n), a01 = twice(a + 5 * n);
    store4(z + 2 * k, twice(a) * r0 + a01 * r1 + a02 * r2);
    store4(z + 2 * k + y, a01 * r0 + twice(a + n) * r1 + a12 * r2);
    store4(z + 2 * k + w, a02 * r0 + a12 * r1 + twice(a + 2 * n) * r2);
}

void ph_i_green_apply(const ph_green *g, const double *r, double *z)
{
#pragma omp parallel for num_threads(g->threads) schedule(static, PH_CHUNK)
    for (ptrdiff_t k = 0; k < g->modes / 2; k++)
        apply_pair(g, 2 * k, r, z);
    if (g->modes % 2) apply_one(g, g->modes - 1, r, z);
}
