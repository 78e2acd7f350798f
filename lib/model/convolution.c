/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/convolution.h"

#include <string.h>

#define R2 0.70710678118654752440

static ptrdiff_t wrap(ptrdiff_t i, ptrdiff_t n)
{
    i %= n;
    return i < 0 ? i + n : i;
}

void ph_i_gradient_symbol(ph_fft *fft, const ph_layout *layout, ptrdiff_t count,
                          const int (*offset)[3], const double (*g)[3], int direction,
                          double *real, double *hat)
{
    memset(real, 0, sizeof(double) * (size_t)layout->cells);
    for (ptrdiff_t b = 0; b < count; b++) {
        ptrdiff_t x =
            0; /* the kernel at -o, so that the sum over bonds is a convolution */
        for (int a = 0; a < 3; a++) {
            int o = layout->axis[a] >= 0 ? offset[b][layout->axis[a]] : 0;
            x = x * layout->n[a] + wrap(-o, layout->n[a]);
        }
        real[x] += g[b][direction];
    }
    ph_i_fft_forward(fft, real, hat);
}

ph_status ph_i_convolution_init(ph_convolution *conv, const ph_layout *layout,
                                ph_fft *fft, const ph_family *family, int threads,
                                ph_meter *meter, ph_error *err)
{
    ph_status st = PH_OK;
    double *real = NULL;
    memset(conv, 0, sizeof *conv);
    conv->layout = *layout;
    conv->fft = fft;
    conv->threads = threads;
    conv->modes = ph_i_fft_modes(fft);
    PH_DOUBLES(conv->work, meter, (size_t)(2 * conv->modes), "one transform");
    PH_DOUBLES(real, meter, (size_t)layout->cells, "one field");
    for (int a = 0; a < 3; a++) {
        int d = layout->axis[a];
        if (d < 0) continue;
        PH_DOUBLES(conv->g[d], meter, (size_t)(2 * conv->modes), "a gradient symbol");
        ph_i_gradient_symbol(fft, layout, family->count, (const int(*)[3])family->offset,
                             (const double(*)[3])family->g, d, real, conv->g[d]);
    }
out:
    ph_i_doubles_free(meter, &real, (size_t)layout->cells);
    if (st != PH_OK) ph_i_convolution_clear(conv, meter);
    return st;
}

void ph_i_convolution_clear(ph_convolution *conv, ph_meter *meter)
{
    for (int d = 0; d < 3; d++)
        ph_i_doubles_free(meter, &conv->g[d], (size_t)(2 * conv->modes));
    ph_i_doubles_free(meter, &conv->work, (size_t)(2 * conv->modes));
}

/* The two (displacement, direction) pairs whose gradients make a Mandel component. */
typedef struct pairing {
    int n, a[2], d[2];
    double factor;
} pairing;

static pairing component_pairs(const ph_convolution *c, int i)
{
    static const int shear[3][2] = {{1, 2}, {0, 2}, {0, 1}};
    int normal = c->layout.nd;
    pairing p = {0, {0, 0}, {0, 0}, 1.0};
    int first = i, second = i;
    if (i >= normal) {
        int s = normal == 3 ? i - 3 : 2;
        first = shear[s][0], second = shear[s][1];
        p.factor = R2;
    }
    if (c->g[second]) p.a[p.n] = first, p.d[p.n++] = second;
    if (first != second && c->g[first]) p.a[p.n] = second, p.d[p.n++] = first;
    return p;
}

/* w = factor * (g1 u1 [+ g2 u2]), complex */
static void multiply(const ph_convolution *c, const pairing *p, const double *uhat,
                     double scale, double *w)
{
    const double *g1 = c->g[p->d[0]], *u1 = uhat + 2 * c->modes * p->a[0];
    const double *g2 = p->n == 2 ? c->g[p->d[1]] : NULL;
    const double *u2 = uhat + 2 * c->modes * p->a[1];
    double s = p->factor * scale;
#pragma omp parallel for num_threads(c->threads) schedule(static, PH_CHUNK)
    for (ptrdiff_t k = 0; k < c->modes; k++) {
        double re = g1[2 * k] * u1[2 * k] - g1[2 * k + 1] * u1[2 * k + 1];
        double im = g1[2 * k] * u1[2 * k + 1] + g1[2 * k + 1] * u1[2 * k];
        if (g2) {
            re += g2[2 * k] * u2[2 * k] - g2[2 * k + 1] * u2[2 * k + 1];
            im += g2[2 * k] * u2[2 * k + 1] + g2[2 * k + 1] * u2[2 * k];
        }
        w[2 * k] = s * re;
        w[2 * k + 1] = s * im;
    }
}

void ph_i_convolution_strain(ph_convolution *c, const double *uhat, double scale,
                             double *strain)
{
    for (int i = 0; i < c->layout.ns; i++) {
        double *to = strain + i * c->layout.cells;
        pairing p = component_pairs(c, i);
        if (p.n == 0) {
            memset(to, 0, sizeof(double) * (size_t)c->layout.cells);
            continue;
        }
        multiply(c, &p, uhat, scale, c->work);
        ph_i_fft_backward(c->fft, c->work, c->work, to);
    }
}

/* f += factor * conj(g) w */
static void accumulate(const ph_convolution *c, const double *g, double s,
                       const double *w, double *f)
{
#pragma omp parallel for num_threads(c->threads) schedule(static, PH_CHUNK)
    for (ptrdiff_t k = 0; k < c->modes; k++) {
        f[2 * k] += s * (g[2 * k] * w[2 * k] + g[2 * k + 1] * w[2 * k + 1]);
        f[2 * k + 1] += s * (g[2 * k] * w[2 * k + 1] - g[2 * k + 1] * w[2 * k]);
    }
}

void ph_i_convolution_divergence(ph_convolution *c, const double *stress, double *fhat)
{
    memset(fhat, 0, sizeof(double) * (size_t)(2 * c->modes * c->layout.nd));
    for (int i = 0; i < c->layout.ns; i++) {
        pairing p = component_pairs(c, i);
        if (p.n == 0) continue;
        ph_i_fft_forward(c->fft, stress + i * c->layout.cells, c->work);
        for (int q = 0; q < p.n; q++)
            accumulate(c, c->g[p.d[q]], p.factor, c->work, fhat + 2 * c->modes * p.a[q]);
    }
}
