/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Springs at work: forces, loads, and what every node holds. */
#include "model/springs.h"

#include <omp.h>
#include <string.h>

#define R2 1.41421356237309504880

void ph_i_springs_pad(ph_springs *s, int field, const double *u)
{
    const ptrdiff_t *n = s->layout.n, lines = n[0] * n[1], reach = s->reach[2];
#pragma omp parallel for num_threads(s->threads) schedule(static)
    for (ptrdiff_t l = 0; l < lines; l++) {
        const double *from = u + l * n[2];
        double *to = s->pad + (field * lines + l) * s->row;
        memcpy(to + reach, from, sizeof(double) * (size_t)n[2]);
        for (ptrdiff_t i = 1; i <= reach; i++) { /* may wrap more than once */
            to[reach - i] = from[(n[2] - i % n[2]) % n[2]];
            to[reach + n[2] + i - 1] = from[(i - 1) % n[2]];
        }
    }
}

double ph_i_springs_stretch(int nd, const double *xi, const double *macro)
{
    if (!macro) return 0.0;
    if (nd == 2)
        return macro[0] * xi[0] * xi[0] + macro[1] * xi[1] * xi[1] +
               R2 * macro[2] * xi[0] * xi[1];
    return macro[0] * xi[0] * xi[0] + macro[1] * xi[1] * xi[1] +
           macro[2] * xi[2] * xi[2] +
           R2 * (macro[3] * xi[1] * xi[2] + macro[4] * xi[0] * xi[2] +
                 macro[5] * xi[0] * xi[1]);
}

/* ---- K * w ----------------------------------------------------------------------------- */

static void sweep_line2(const ph_springs *s, ptrdiff_t i, ptrdiff_t j, double *f)
{
    const ptrdiff_t n = s->layout.n[2], line = (i * s->layout.n[1] + j) * n;
    double *restrict f0 = f + line, *restrict f1 = f + s->layout.cells + line;
    memset(f0, 0, sizeof(double) * (size_t)n);
    memset(f1, 0, sizeof(double) * (size_t)n);
    for (ptrdiff_t b = 0; b < s->nhalf; b++) {
        const ph_spring_offset *h = &s->half[b];
        int minus[3] = {-h->o[0], -h->o[1], -h->o[2]};
        const double *p0 = ph_i_springs_line(s, 0, i, j, h->o),
                     *q0 = ph_i_springs_line(s, 0, i, j, minus),
                     *p1 = ph_i_springs_line(s, 1, i, j, h->o),
                     *q1 = ph_i_springs_line(s, 1, i, j, minus);
        double K00 = h->K[0], K11 = h->K[1], K01 = h->K[2];
#pragma omp simd
        for (ptrdiff_t x = 0; x < n; x++) {
            double a = p0[x] + q0[x], c = p1[x] + q1[x];
            f0[x] += K00 * a + K01 * c;
            f1[x] += K01 * a + K11 * c;
        }
    }
}

static void sweep_line3(const ph_springs *s, ptrdiff_t i, ptrdiff_t j, double *f)
{
    const ptrdiff_t n = s->layout.n[2], line = (i * s->layout.n[1] + j) * n;
    double *restrict f0 = f + line, *restrict f1 = f0 + s->layout.cells,
                     *restrict f2 = f1 + s->layout.cells;
    for (int a = 0; a < 3; a++)
        memset(f0 + a * s->layout.cells, 0, sizeof(double) * (size_t)n);
    for (ptrdiff_t b = 0; b < s->nhalf; b++) {
        const ph_spring_offset *h = &s->half[b];
        int minus[3] = {-h->o[0], -h->o[1], -h->o[2]};
        const double *p0 = ph_i_springs_line(s, 0, i, j, h->o),
                     *q0 = ph_i_springs_line(s, 0, i, j, minus),
                     *p1 = ph_i_springs_line(s, 1, i, j, h->o),
                     *q1 = ph_i_springs_line(s, 1, i, j, minus),
                     *p2 = ph_i_springs_line(s, 2, i, j, h->o),
                     *q2 = ph_i_springs_line(s, 2, i, j, minus);
        const double *K = h->K; /* 00 11 22 12 02 01 */
#pragma omp simd
        for (ptrdiff_t x = 0; x < n; x++) {
            double a = p0[x] + q0[x], c = p1[x] + q1[x], d = p2[x] + q2[x];
            f0[x] += K[0] * a + K[5] * c + K[4] * d;
            f1[x] += K[5] * a + K[1] * c + K[3] * d;
            f2[x] += K[4] * a + K[3] * c + K[2] * d;
        }
    }
}

/* w <- K * w, directly. */
static void sweep(ph_springs *s, double *w)
{
    const ptrdiff_t *n = s->layout.n;
    for (int a = 0; a < s->layout.nd; a++)
        ph_i_springs_pad(s, a, w + a * s->layout.cells);
#pragma omp parallel for collapse(2) num_threads(s->threads) schedule(static)
    for (ptrdiff_t i = 0; i < n[0]; i++)
        for (ptrdiff_t j = 0; j < n[1]; j++)
            if (s->layout.nd == 2)
                sweep_line2(s, i, j, w);
            else
                sweep_line3(s, i, j, w);
}

static void multiply(const ph_springs *s, double *hat)
{
    const ptrdiff_t n = s->modes;
    const double *K = s->symbol;
#pragma omp parallel for num_threads(s->threads) schedule(static, PH_CHUNK)
    for (ptrdiff_t k = 0; k < n; k++)
        for (int part = 0; part < 2; part++) {
            double *z = hat + 2 * k + part, a = z[0], b = z[2 * n];
            if (s->layout.nd == 2) {
                z[0] = K[k] * a + K[2 * n + k] * b;
                z[2 * n] = K[2 * n + k] * a + K[n + k] * b;
                continue;
            }
            double c = z[4 * n];
            z[0] = K[k] * a + K[5 * n + k] * b + K[4 * n + k] * c;
            z[2 * n] = K[5 * n + k] * a + K[n + k] * b + K[3 * n + k] * c;
            z[4 * n] = K[4 * n + k] * a + K[3 * n + k] * b + K[2 * n + k] * c;
        }
}

/* w <- cells * K * w, by FFT. */
static void convolve(ph_springs *s, double *w)
{
    for (int a = 0; a < s->layout.nd; a++)
        ph_i_fft_forward(s->fft, w + a * s->layout.cells, s->hat + 2 * a * s->modes);
    multiply(s, s->hat);
    for (int a = 0; a < s->layout.nd; a++)
        ph_i_fft_backward(s->fft, s->hat + 2 * a * s->modes, s->hat + 2 * a * s->modes,
                          w + a * s->layout.cells);
}

/* ---- forces ---------------------------------------------------------------------------- */

/* f = scale D u */
static void diagonal(const ph_springs *s, const double *u, double scale, double *f)
{
    const ptrdiff_t n = s->layout.cells;
    const double *D = s->D;
#pragma omp parallel for simd num_threads(s->threads) schedule(static, PH_CHUNK)
    for (ptrdiff_t x = 0; x < n; x++) {
        double a = scale * u[x], b = scale * u[n + x];
        if (s->layout.nd == 2) {
            f[x] = D[x] * a + D[2 * n + x] * b;
            f[n + x] = D[2 * n + x] * a + D[n + x] * b;
        } else {
            double c = scale * u[2 * n + x];
            f[x] = D[x] * a + D[5 * n + x] * b + D[4 * n + x] * c;
            f[n + x] = D[5 * n + x] * a + D[n + x] * b + D[3 * n + x] * c;
            f[2 * n + x] = D[4 * n + x] * a + D[3 * n + x] * b + D[2 * n + x] * c;
        }
    }
}

/* f -= scale sum dE k xi xi . u(y) */
static void rest(const ph_springs *s, const double *u, double scale, double *f)
{
    const ptrdiff_t n = s->layout.cells;
    const int nd = s->layout.nd;
    if (!s->first) return;
#pragma omp parallel for num_threads(s->threads) schedule(static, PH_CHUNK)
    for (ptrdiff_t x = 0; x < n; x++) {
        double sum[3] = {0};
        for (ptrdiff_t p = s->first[x]; p < s->first[x + 1]; p++) {
            const ph_spring_pair *q = &s->pair[p];
            const double *xi = s->family->xi[q->bond];
            double t = 0.0;
            for (int a = 0; a < nd; a++)
                t += xi[a] * u[a * n + q->node];
            t *= q->dE * s->family->w[q->bond];
            for (int a = 0; a < nd; a++)
                sum[a] += t * xi[a];
        }
        for (int a = 0; a < nd; a++)
            f[a * n + x] -= scale * sum[a];
    }
}

void ph_i_springs_apply(ph_springs *s, const double *u, double scale, double *f)
{
    const ptrdiff_t n = s->layout.cells;
    const int nd = s->layout.nd;
    if (s->plain) {
        ph_i_springs_plain_apply(s, u, f);
        for (ptrdiff_t i = 0; i < nd * n; i++)
            f[i] *= scale;
        return;
    }
    diagonal(s, u, scale, f);
    for (int r = 0; r < s->terms; r++) {
        const double *v = s->v[r];
        double back = scale * s->lambda[r] / (s->by_fft ? (double)n : 1.0);
        for (int a = 0; a < nd; a++)
#pragma omp parallel for simd num_threads(s->threads) schedule(static, PH_CHUNK)
            for (ptrdiff_t x = 0; x < n; x++)
                s->w[a * n + x] = v[x] * u[a * n + x];
        if (s->by_fft)
            convolve(s, s->w);
        else
            sweep(s, s->w);
        for (int a = 0; a < nd; a++)
#pragma omp parallel for simd num_threads(s->threads) schedule(static, PH_CHUNK)
            for (ptrdiff_t x = 0; x < n; x++)
                f[a * n + x] -= back * v[x] * s->w[a * n + x];
    }
    rest(s, u, scale, f);
    ph_i_springs_damaged_apply(s, u, scale, f);
}

/* ---- loads ----------------------------------------------------------------------------- */

/* Work lines of the thread that asks. */
static double *work_line(const ph_springs *s, int which)
{
    return s->lines +
           (omp_get_thread_num() * (ptrdiff_t)PH_SPRING_LINES + which) * s->layout.n[2];
}

static void load_line(const ph_springs *s, ptrdiff_t i, ptrdiff_t j, const double *macro,
                      double *f)
{
    const ptrdiff_t n = s->layout.n[2], cells = s->layout.cells,
                    line = (i * s->layout.n[1] + j) * n;
    const int nd = s->layout.nd;
    for (int r = 0; r < s->terms; r++) {
        const double *v = s->v[r] + line;
        double *sum = work_line(s, 0);
        memset(sum, 0, sizeof(double) * (size_t)(nd * n));
        for (ptrdiff_t b = 0; b < s->family->count; b++) {
            const double *xi = s->family->xi[b];
            const double *p = ph_i_springs_line(s, nd + r, i, j, s->o[b]);
            double t =
                s->lambda[r] * s->family->w[b] * ph_i_springs_stretch(nd, xi, macro);
            for (int a = 0; a < nd; a++) {
                double g = t * xi[a], *restrict to = sum + a * n;
#pragma omp simd
                for (ptrdiff_t x = 0; x < n; x++)
                    to[x] += g * p[x];
            }
        }
        for (int a = 0; a < nd; a++)
            for (ptrdiff_t x = 0; x < n; x++)
                f[a * cells + line + x] += v[x] * sum[a * n + x];
    }
}

/* Products of the moduli into the pads behind the displacement. */
static void pad_products(ph_springs *s)
{
    for (int r = 0; r < s->terms; r++)
        ph_i_springs_pad(s, s->layout.nd + r, s->v[r]);
}

void ph_i_springs_load(ph_springs *s, const double *macro, double *f)
{
    const ptrdiff_t *n = s->layout.n, cells = s->layout.cells;
    const int nd = s->layout.nd;
    memset(f, 0, sizeof(double) * (size_t)(nd * cells));
    pad_products(s);
#pragma omp parallel for collapse(2) num_threads(s->threads) schedule(static)
    for (ptrdiff_t i = 0; i < n[0]; i++)
        for (ptrdiff_t j = 0; j < n[1]; j++)
            load_line(s, i, j, macro, f);
    for (ptrdiff_t x = 0; s->first && x < cells; x++)
        for (ptrdiff_t p = s->first[x]; p < s->first[x + 1]; p++) {
            const ph_spring_pair *q = &s->pair[p];
            const double *xi = s->family->xi[q->bond];
            double t =
                q->dE * s->family->w[q->bond] * ph_i_springs_stretch(nd, xi, macro);
            for (int a = 0; a < nd; a++)
                f[a * cells + x] += t * xi[a];
        }
    ph_i_springs_damaged_load(s, macro, f);
}

/* ---- what every node holds ------------------------------------------------------------- */

/* Mandel components of xi (x) xi. */
static void dyad(int nd, const double *xi, double *m)
{
    if (nd == 2) {
        m[0] = xi[0] * xi[0], m[1] = xi[1] * xi[1], m[2] = R2 * xi[0] * xi[1];
        return;
    }
    for (int a = 0; a < 3; a++)
        m[a] = xi[a] * xi[a];
    m[3] = R2 * xi[1] * xi[2], m[4] = R2 * xi[0] * xi[2], m[5] = R2 * xi[0] * xi[1];
}

static void stress_line(const ph_springs *s, ptrdiff_t i, ptrdiff_t j,
                        const double *macro, double *stress, double *energy)
{
    const ptrdiff_t n = s->layout.n[2], cells = s->layout.cells,
                    line = (i * s->layout.n[1] + j) * n;
    const int nd = s->layout.nd, ns = s->layout.ns, none[3] = {0, 0, 0};
    double *restrict t = work_line(s, 0), *sum = work_line(s, 1);
    for (int r = 0; r < s->terms; r++) {
        const double *v = s->v[r] + line;
        memset(sum, 0, sizeof(double) * (size_t)((ns + 1) * n));
        double *restrict work = sum + ns * n;
        for (ptrdiff_t b = 0; b < s->family->count; b++) {
            const double *xi = s->family->xi[b];
            const double *p = ph_i_springs_line(s, nd + r, i, j, s->o[b]);
            double e = ph_i_springs_stretch(nd, xi, macro), m[6];
            double k = 0.5 * s->lambda[r] * s->family->w[b];
            dyad(nd, xi, m);
            for (ptrdiff_t x = 0; x < n; x++)
                t[x] = e;
            for (int a = 0; a < nd; a++) {
                const double *far = ph_i_springs_line(s, a, i, j, s->o[b]),
                             *near = ph_i_springs_line(s, a, i, j, none);
#pragma omp simd
                for (ptrdiff_t x = 0; x < n; x++)
                    t[x] += xi[a] * (far[x] - near[x]);
            }
#pragma omp simd
            for (ptrdiff_t x = 0; x < n; x++) {
                double pull = k * p[x] * t[x];
                work[x] += pull * t[x];
                t[x] = pull;
            }
            for (int c = 0; c < ns; c++) {
                double *restrict to = sum + c * n;
#pragma omp simd
                for (ptrdiff_t x = 0; x < n; x++)
                    to[x] += m[c] * t[x];
            }
        }
        for (ptrdiff_t x = 0; x < n; x++) {
            for (int c = 0; stress && c < ns; c++)
                stress[c * cells + line + x] += v[x] * sum[c * n + x];
            if (energy) energy[line + x] += v[x] * work[x];
        }
    }
}

static void stress_rest(const ph_springs *s, const double *u, const double *macro,
                        double *stress, double *energy)
{
    const ptrdiff_t cells = s->layout.cells;
    const int nd = s->layout.nd;
    for (ptrdiff_t x = 0; s->first && x < cells; x++)
        for (ptrdiff_t p = s->first[x]; p < s->first[x + 1]; p++) {
            const ph_spring_pair *q = &s->pair[p];
            const double *xi = s->family->xi[q->bond];
            double e = ph_i_springs_stretch(nd, xi, macro), m[6];
            for (int a = 0; a < nd; a++)
                e += xi[a] * (u[a * cells + q->node] - u[a * cells + x]);
            double t = 0.5 * q->dE * s->family->w[q->bond] * e;
            dyad(nd, xi, m);
            for (int c = 0; stress && c < s->layout.ns; c++)
                stress[c * cells + x] += m[c] * t;
            if (energy) energy[x] += t * e;
        }
}

/* g_b = w_b K^-1 xi_b, w_b = k_b |xi_b|^2. */
static ph_status gradient_weights(const ph_springs *s, double (**out)[3], ph_error *err)
{
    ph_status st = PH_OK;
    const ph_family *f = s->family;
    ph_sym4 K = {.n = 3}, inverse; /* a symmetric 3 x 3 matrix, as a 2D tensor */
    double(*g)[3] = NULL;
    int nd = s->layout.nd;
    PH_ALLOC(g, f->count, "gradient weights");
    for (ptrdiff_t b = 0; b < f->count; b++)
        for (int i = 0; i < nd; i++)
            for (int j = 0; j < nd; j++) {
                const double *x = f->xi[b];
                double r2 = x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
                K.m[i][j] += f->w[b] * r2 * x[i] * x[j];
            }
    if (nd == 2) K.m[2][2] = K.m[0][0];
    PH_TRY(ph_sym4_inverse(&K, &inverse, err));
    for (ptrdiff_t b = 0; b < f->count; b++)
        for (int i = 0; i < nd; i++)
            for (int j = 0; j < nd; j++) {
                const double *x = f->xi[b];
                double r2 = x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
                g[b][i] += f->w[b] * r2 * inverse.m[i][j] * x[j];
            }
    *out = g;
    g = NULL;
out:
    free(g);
    return st;
}

static void strain_line(const ph_springs *s, ptrdiff_t i, ptrdiff_t j,
                        const double (*g)[3], const double *macro, double *strain)
{
    const ptrdiff_t n = s->layout.n[2], line = (i * s->layout.n[1] + j) * n;
    const int nd = s->layout.nd;
    for (int c = 0; c < s->layout.ns; c++)
        for (ptrdiff_t x = 0; x < n; x++)
            strain[c * s->layout.cells + line + x] = macro ? macro[c] : 0.0;
    for (ptrdiff_t b = 0; b < s->family->count; b++)
        for (int a = 0; a < nd; a++) {
            /* the family is symmetric: the node itself has no weight */
            const double *far = ph_i_springs_line(s, a, i, j, s->o[b]);
            for (int d = 0; d < nd; d++) {
                int c = a == d ? a : nd == 3 ? 6 - a - d : 2;
                double *restrict to = strain + c * s->layout.cells + line;
                double t = g[b][d] * (a == d ? 1.0 : 1.0 / R2);
#pragma omp simd
                for (ptrdiff_t x = 0; x < n; x++)
                    to[x] += t * far[x];
            }
        }
}

ph_status ph_i_springs_fields(ph_springs *s, const double *u, const double *macro,
                              double *stress, double *strain, double *energy,
                              ph_error *err)
{
    ph_status st = PH_OK;
    const ptrdiff_t *n = s->layout.n, cells = s->layout.cells;
    double(*g)[3] = NULL;
    if (strain) PH_TRY(gradient_weights(s, &g, err));
    if (stress) memset(stress, 0, sizeof(double) * (size_t)(s->layout.ns * cells));
    if (energy) memset(energy, 0, sizeof(double) * (size_t)cells);
    for (int a = 0; a < s->layout.nd; a++)
        ph_i_springs_pad(s, a, u + a * cells);
    pad_products(s);
#pragma omp parallel for collapse(2) num_threads(s->threads) schedule(static)
    for (ptrdiff_t i = 0; i < n[0]; i++)
        for (ptrdiff_t j = 0; j < n[1]; j++) {
            if (stress || energy) stress_line(s, i, j, macro, stress, energy);
            if (strain) strain_line(s, i, j, (const double(*)[3])g, macro, strain);
        }
    if (stress || energy) stress_rest(s, u, macro, stress, energy);
    ph_i_springs_damaged_fields(s, u, macro, stress, strain, energy);
out:
    free(g);
    return st;
}
