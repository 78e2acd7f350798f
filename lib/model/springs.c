/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Springs set up: the products that make the moduli, the pairs that they miss, the kernel. */
#include "model/springs.h"

#include "core/jacobi.h"
#include "model/convolution.h"

#include <math.h>
#include <string.h>

/* A modulus that differs by less than this share of the largest is the same. */
static const double same_modulus = 1e-13;
/* Nanoseconds, measured (docs/theory/bond.md): a bond of the direct sum and a transform per
 * component and cell, a pair of the rest. Fixed, so that the choice does not depend on the
 * load of the machine. */
static const double ns_bond = 0.07, ns_transform = 4.5, ns_pair = 3.0;

/* ---- the products ---------------------------------------------------------------------- */

typedef struct census {
    ptrdiff_t *cells; /* [classes] */
    int *used;        /* [nused] solid classes that are there */
    int nused, main;  /* main: of most cells */
    ptrdiff_t solid;
    double stiffest;
    bool fillers; /* more than one */
} census;

static ph_status count_classes(const ph_bond_classes *c, census *out, ph_error *err)
{
    ph_status st = PH_OK;
    memset(out, 0, sizeof *out);
    out->main = -1;
    int32_t first = 0;
    PH_ALLOC(out->cells, c->count, "cells of the classes");
    PH_ALLOC(out->used, c->count, "classes");
    for (ptrdiff_t x = 0; x < c->cells; x++) {
        out->cells[c->class[x]]++;
        if (c->owner[x] == 0) continue;
        if (first == 0) first = c->owner[x];
        out->fillers = out->fillers || c->owner[x] != first;
    }
    for (int i = 0; i < c->count; i++) {
        if (out->cells[i] == 0 || c->E[i / 2] == 0.0) continue;
        out->used[out->nused++] = i;
        out->solid += out->cells[i];
        if (out->main < 0 || out->cells[i] > out->cells[out->main]) out->main = i;
        for (int j = 0; j < out->nused; j++)
            out->stiffest = fmax(out->stiffest, c->pair[i * c->count + out->used[j]]);
    }
out:
    return st;
}

/* One product: exact for every bond that has an end in the main class. */
static int one_product(const ph_bond_classes *c, const census *n, double *lambda,
                       double *v)
{
    if (n->main < 0) return 0;
    const double *row = c->pair + (ptrdiff_t)n->main * c->count;
    lambda[0] = row[n->main];
    if (lambda[0] == 0.0) return 0; /* one part of the moduli may have no bonds here */
    for (int i = 0; i < n->nused; i++)
        v[n->used[i]] = row[n->used[i]] / lambda[0];
    return 1;
}

/* Eigenvalues and vectors of the symmetric table of the used classes. */
static int eigen_products(const ph_bond_classes *c, const census *n, double *lambda,
                          double *v)
{
    enum { M = PH_SPRING_TERMS };
    int m = n->nused, terms = 0;
    double a[M][M] = {{0}}, q[M][M] = {{0}};
    for (int i = 0; i < m; i++)
        for (int j = 0; j < m; j++)
            a[i][j] = c->pair[(ptrdiff_t)n->used[i] * c->count + n->used[j]];
    ph_i_jacobi(m, M, &a[0][0], &q[0][0]);
    for (int r = 0; r < m; r++) {
        if (fabs(a[r][r]) <= same_modulus * n->stiffest) continue;
        lambda[terms] = a[r][r];
        for (int i = 0; i < m; i++)
            v[terms * c->count + n->used[i]] = q[i][r];
        terms++;
    }
    return terms;
}

static double sweep_cost(const ph_springs *s, double terms)
{
    double nd = s->layout.nd, cells = (double)s->layout.cells;
    double direct = ns_bond * nd * nd * (double)s->family->count;
    double fft = 2.0 * nd * ns_transform;
    return terms * cells * (s->by_fft ? fft : direct);
}

/* Terms by class: v[r * classes + class]. */
static int choose_products(ph_springs *s, const census *n, double *v)
{
    const ph_bond_classes *c = s->classes;
    double rest = (double)(n->solid - (n->main < 0 ? 0 : n->cells[n->main]));
    double pairs = rest * rest / (double)c->cells * (double)s->family->count;
    bool small = n->nused <= PH_SPRING_TERMS;
    /* a part of the moduli that the main class has nothing of */
    if (n->main >= 0 && c->pair[(ptrdiff_t)n->main * (c->count + 1)] == 0.0)
        return small ? eigen_products(c, n, s->lambda, v) : 0;
    double one = sweep_cost(s, 1.0) + ns_pair * pairs;
    /* bonds between fillers are in the rest of either: counted in full, from above */
    double all = sweep_cost(s, n->nused) + (n->fillers ? ns_pair * pairs : 0.0);
    return small && all < one ? eigen_products(c, n, s->lambda, v)
                              : one_product(c, n, s->lambda, v);
}

static ph_status new_products(ph_springs *s, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_bond_classes *c = s->classes;
    census n;
    double *v = NULL;
    PH_TRY(count_classes(c, &n, err));
    PH_ALLOC(v, PH_SPRING_TERMS * c->count, "products");
    s->terms = choose_products(s, &n, v);
    for (int r = 0; r < s->terms; r++) {
        PH_DOUBLES(s->v[r], s->meter, (size_t)c->cells, "a factor of the moduli");
        for (ptrdiff_t x = 0; x < c->cells; x++)
            s->v[r][x] = v[r * c->count + c->class[x]];
    }
out:
    free(n.cells);
    free(n.used);
    free(v);
    return st;
}

/* ---- the rest -------------------------------------------------------------------------- */

ptrdiff_t ph_i_springs_end(const ph_springs *s, ptrdiff_t x, ptrdiff_t b)
{
    const ptrdiff_t *n = s->layout.n;
    ptrdiff_t at[3] = {x / n[2] / n[1], x / n[2] % n[1], x % n[2]}, y = 0;
    for (int a = 0; a < 3; a++) {
        ptrdiff_t i = (at[a] + s->o[b][a]) % n[a];
        y = y * n[a] + (i < 0 ? i + n[a] : i);
    }
    return y;
}

/* Classes whose bonds the products may miss: those with an entry of either table off. */
static void missed_classes(const ph_springs *s, double tolerance, const ptrdiff_t *sample,
                           bool *missed)
{
    const ph_bond_classes *c = s->classes;
    for (int i = 0; i < c->count; i++)
        for (int j = 0; j < c->count; j++) {
            if (sample[i] < 0 || sample[j] < 0) continue;
            double G = 0.0;
            for (int r = 0; r < s->terms; r++)
                G += s->lambda[r] * s->v[r][sample[i]] * s->v[r][sample[j]];
            bool off = fabs(c->pair[i * c->count + j] - G) > tolerance;
            off = off ||
                  (i % 2 && j % 2 && fabs(c->apart[i * c->count + j] - G) > tolerance);
            missed[i] = missed[i] || off;
        }
}

static ptrdiff_t rest_of_cell(const ph_springs *s, ptrdiff_t x, const bool *missed,
                              double tolerance, ph_spring_pair *out)
{
    const ph_bond_classes *c = s->classes;
    ptrdiff_t count = 0;
    for (ptrdiff_t b = 0; b < s->family->count; b++) {
        ptrdiff_t y = ph_i_springs_end(s, x, b);
        if (!missed[c->class[y]]) continue;
        double dE = ph_i_bond_modulus(c, x, y);
        for (int r = 0; r < s->terms; r++)
            dE -= s->lambda[r] * s->v[r][x] * s->v[r][y];
        if (fabs(dE) <= tolerance) continue;
        if (out) out[count] = (ph_spring_pair){(int32_t)y, (int32_t)b, dE};
        count++;
    }
    return count;
}

static ph_status new_rest(ph_springs *s, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_bond_classes *c = s->classes;
    bool *missed = NULL, any = false;
    ptrdiff_t *sample = NULL;
    double stiffest = 0.0;
    PH_ALLOC(missed, c->count, "classes");
    PH_ALLOC(sample, c->count, "classes");
    for (int i = 0; i < c->count; i++)
        sample[i] = -1;
    for (ptrdiff_t x = 0; x < c->cells; x++)
        sample[c->class[x]] = x;
    for (int i = 0; i < c->count; i++)
        if (sample[i] >= 0) stiffest = fmax(stiffest, c->E[i / 2]);
    double tolerance = same_modulus * stiffest;
    missed_classes(s, tolerance, sample, missed);
    for (int i = 0; i < c->count; i++)
        any = any || missed[i];
    if (!any) goto out;
    PH_ALLOC(s->first, c->cells + 1, "the rest of the moduli");
    for (ptrdiff_t x = 0; x < c->cells; x++)
        s->first[x + 1] =
            missed[c->class[x]] ? rest_of_cell(s, x, missed, tolerance, NULL) : 0;
    for (ptrdiff_t x = 0; x < c->cells; x++)
        s->first[x + 1] += s->first[x];
    s->npairs = s->first[c->cells];
    PH_ALLOC(s->pair, s->npairs, "the rest of the moduli");
    s->meter->bytes += (size_t)s->npairs * sizeof *s->pair;
    if (s->meter->bytes > s->meter->peak) s->meter->peak = s->meter->bytes;
    for (ptrdiff_t x = 0; x < c->cells; x++)
        if (s->first[x + 1] > s->first[x])
            rest_of_cell(s, x, missed, tolerance, s->pair + s->first[x]);
out:
    free(missed);
    free(sample);
    return st;
}

/* ---- the kernel ------------------------------------------------------------------------ */

/* Component m of k xi xi, packed. */
static double kernel(const ph_springs *s, ptrdiff_t b, int m)
{
    static const int row3[6] = {0, 1, 2, 1, 0, 0}, column3[6] = {0, 1, 2, 2, 2, 1};
    static const int row2[3] = {0, 1, 0}, column2[3] = {0, 1, 1};
    const double *xi = s->family->xi[b];
    int i = s->layout.nd == 3 ? row3[m] : row2[m];
    int j = s->layout.nd == 3 ? column3[m] : column2[m];
    return s->family->w[b] * xi[i] * xi[j];
}

static ph_status new_symbol(ph_springs *s, ph_error *err)
{
    ph_status st = PH_OK;
    ptrdiff_t count = s->family->count;
    double *real = NULL, *hat = NULL, (*g)[3] = NULL;
    int packed = ph_i_springs_packed(s);
    PH_DOUBLES(real, s->meter, (size_t)s->layout.cells, "one field");
    PH_DOUBLES(hat, s->meter, (size_t)(2 * s->modes), "one transform");
    PH_DOUBLES(s->symbol, s->meter, (size_t)(packed * s->modes), "the kernel");
    PH_ALLOC(g, count, "the kernel");
    for (int m = 0; m < packed; m++) {
        for (ptrdiff_t b = 0; b < count; b++)
            g[b][0] = kernel(s, b, m);
        ph_i_gradient_symbol(s->fft, &s->layout, count,
                             (const int(*)[3])s->family->offset, (const double(*)[3])g, 0,
                             real, hat);
        for (ptrdiff_t k = 0; k < s->modes; k++)
            s->symbol[m * s->modes + k] = hat[2 * k]; /* K is even */
    }
out:
    free(g);
    ph_i_doubles_free(s->meter, &real, (size_t)s->layout.cells);
    ph_i_doubles_free(s->meter, &hat, (size_t)(2 * s->modes));
    return st;
}

static bool upper(const int o[3])
{
    return o[0] > 0 || (o[0] == 0 && (o[1] > 0 || (o[1] == 0 && o[2] > 0)));
}

/* Distinct offsets, one of o and -o; springs that lead to the node itself do nothing. */
static ph_status new_half(ph_springs *s, ph_error *err)
{
    ph_status st = PH_OK;
    ptrdiff_t span[3], size = 1, *place = NULL;
    for (int a = 0; a < 3; a++)
        size *= span[a] = 2 * s->reach[a] + 1;
    PH_ALLOC(place, size, "offsets");
    PH_ALLOC(s->half, s->family->count, "offsets");
    for (ptrdiff_t b = 0; b < s->family->count; b++) {
        const int *o = s->o[b];
        if (!upper(o)) continue;
        ptrdiff_t at = ((o[0] + s->reach[0]) * span[1] + o[1] + s->reach[1]) * span[2] +
                       o[2] + s->reach[2];
        if (place[at] == 0) {
            memcpy(s->half[s->nhalf].o, o, sizeof s->half->o);
            place[at] = ++s->nhalf;
        }
        for (int m = 0; m < ph_i_springs_packed(s); m++)
            s->half[place[at] - 1].K[m] += kernel(s, b, m);
    }
out:
    free(place);
    return st;
}

static size_t pad_size(const ph_springs *s)
{
    return (size_t)((s->layout.nd + s->terms) * s->layout.n[0] * s->layout.n[1] * s->row);
}

static ph_status new_pads(ph_springs *s, ph_error *err)
{
    ph_status st = PH_OK;
    const ptrdiff_t *n = s->layout.n;
    s->row = n[2] + 2 * s->reach[2];
    for (int a = 0; a < 2; a++) {
        ptrdiff_t span = n[a] + 2 * s->reach[a];
        PH_ALLOC(s->wrapped[a], span, "line numbers");
        for (ptrdiff_t i = 0; i < span; i++) {
            ptrdiff_t at = (i - s->reach[a]) % n[a];
            s->wrapped[a][i] = (int32_t)(at < 0 ? at + n[a] : at);
        }
    }
    PH_DOUBLES(s->pad, s->meter, pad_size(s), "padded lines");
    PH_DOUBLES(s->lines, s->meter, (size_t)(s->threads * PH_SPRING_LINES * n[2]),
               "work lines");
out:
    return st;
}

/* D(x) = what A does to a displacement of one node, seen at the node: the sum of all its
 * springs. By plain sums for each distinct surrounding? No two are alike: one pass. */
static void add_rest_diagonal(ph_springs *s)
{
    int packed = ph_i_springs_packed(s);
    ptrdiff_t cells = s->layout.cells;
    for (ptrdiff_t x = 0; s->first && x < cells; x++)
        for (ptrdiff_t p = s->first[x]; p < s->first[x + 1]; p++)
            for (int m = 0; m < packed; m++)
                s->D[m * cells + x] += s->pair[p].dE * kernel(s, s->pair[p].bond, m);
}

static void diagonal_directly(ph_springs *s)
{
    const ptrdiff_t *n = s->layout.n;
    int packed = ph_i_springs_packed(s);
    for (int r = 0; r < s->terms; r++) {
        ph_i_springs_pad(s, 0, s->v[r]);
#pragma omp parallel for collapse(2) num_threads(s->threads) schedule(static)
        for (ptrdiff_t i = 0; i < n[0]; i++)
            for (ptrdiff_t j = 0; j < n[1]; j++)
                for (ptrdiff_t b = 0; b < s->nhalf; b++) {
                    const ph_spring_offset *h = &s->half[b];
                    int minus[3] = {-h->o[0], -h->o[1], -h->o[2]};
                    const double *p = ph_i_springs_line(s, 0, i, j, h->o),
                                 *q = ph_i_springs_line(s, 0, i, j, minus),
                                 *v = s->v[r] + (i * n[1] + j) * n[2];
                    for (int m = 0; m < packed; m++) {
                        double *D = s->D + m * s->layout.cells + (i * n[1] + j) * n[2];
                        double K = s->lambda[r] * h->K[m];
                        for (ptrdiff_t x = 0; x < n[2]; x++)
                            D[x] += K * v[x] * (p[x] + q[x]);
                    }
                }
    }
}

static void diagonal_by_fft(ph_springs *s)
{
    ptrdiff_t cells = s->layout.cells, modes = s->modes;
    double *vhat = s->hat, *work = s->hat + 2 * modes;
    for (int r = 0; r < s->terms; r++) {
        ph_i_fft_forward(s->fft, s->v[r], vhat);
        for (int m = 0; m < ph_i_springs_packed(s); m++) {
            const double *K = s->symbol + m * modes;
            for (ptrdiff_t k = 0; k < modes; k++) {
                work[2 * k] = K[k] * vhat[2 * k];
                work[2 * k + 1] = K[k] * vhat[2 * k + 1];
            }
            ph_i_fft_backward(s->fft, work, work, s->w);
            double *D = s->D + m * cells, scale = s->lambda[r] / (double)cells;
            for (ptrdiff_t x = 0; x < cells; x++)
                D[x] += scale * s->v[r][x] * s->w[x];
        }
    }
}

/* ---- all of it ------------------------------------------------------------------------- */

static ph_status loop_offsets(ph_springs *s, ph_error *err)
{
    ph_status st = PH_OK;
    PH_ALLOC(s->o, s->family->count, "bond offsets");
    for (ptrdiff_t b = 0; b < s->family->count; b++)
        for (int a = 0; a < 3; a++) {
            int d = s->layout.axis[a];
            s->o[b][a] = d >= 0 ? s->family->offset[b][d] : 0;
            if (abs(s->o[b][a]) > s->reach[a]) s->reach[a] = abs(s->o[b][a]);
        }
out:
    return st;
}

static bool fft_is_faster(const ph_springs *s)
{
    double nd = s->layout.nd;
    return 2.0 * nd * ns_transform < ns_bond * nd * nd * (double)s->family->count;
}

ph_status ph_i_springs_new(const ph_layout *layout, ph_fft *fft, const ph_family *family,
                           const ph_bond_classes *classes, ph_route route, int threads,
                           ph_meter *meter, ph_springs **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_springs *s = NULL;
    size_t nd = (size_t)layout->nd, cells = (size_t)layout->cells;
    *out = NULL;
    PH_ALLOC(s, 1, "springs");
    s->layout = *layout;
    s->meter = meter;
    s->fft = fft;
    s->threads = threads > 0 ? threads : 1;
    s->modes = ph_i_fft_modes(fft);
    s->family = family;
    s->classes = classes;
    s->plain = route == PH_ROUTE_BONDS;
    s->by_fft =
        route == PH_ROUTE_CONVOLUTION || (route == PH_ROUTE_AUTO && fft_is_faster(s));
    PH_CHECK(layout->cells <= INT32_MAX, PH_EINVAL, "too many nodes (%td)",
             layout->cells);
    PH_TRY(loop_offsets(s, err));
    PH_TRY(new_products(s, err));
    PH_TRY(new_rest(s, err));
    PH_TRY(new_pads(s, err));
    PH_DOUBLES(s->w, meter, nd * cells, "a weighted displacement");
    PH_DOUBLES(s->D, meter, (size_t)ph_i_springs_packed(s) * cells, "the diagonal");
    if (s->by_fft) {
        PH_DOUBLES(s->hat, meter, 2 * nd * (size_t)s->modes, "a transformed field");
        PH_TRY(new_symbol(s, err));
        diagonal_by_fft(s);
    } else {
        PH_TRY(new_half(s, err));
        diagonal_directly(s);
    }
    add_rest_diagonal(s);
    *out = s;
    s = NULL;
out:
    ph_i_springs_free(&s);
    return st;
}

void ph_i_springs_free(ph_springs **out)
{
    if (!out || !*out) return;
    ph_springs *s = *out;
    size_t nd = (size_t)s->layout.nd, cells = (size_t)s->layout.cells;
    size_t packed = (size_t)ph_i_springs_packed(s), modes = (size_t)s->modes;
    if (s->pair) s->meter->bytes -= (size_t)s->npairs * sizeof *s->pair;
    ph_i_doubles_free(s->meter, &s->lines,
                      (size_t)(s->threads * PH_SPRING_LINES * s->layout.n[2]));
    ph_i_doubles_free(s->meter, &s->pad, pad_size(s));
    for (int r = 0; r < PH_SPRING_TERMS; r++)
        ph_i_doubles_free(s->meter, &s->v[r], cells);
    ph_i_doubles_free(s->meter, &s->D, packed * cells);
    ph_i_doubles_free(s->meter, &s->w, nd * cells);
    ph_i_doubles_free(s->meter, &s->symbol, packed * modes);
    ph_i_doubles_free(s->meter, &s->hat, 2 * nd * modes);
    free(s->o);
    free(s->first);
    free(s->pair);
    free(s->half);
    free(s->wrapped[0]);
    free(s->wrapped[1]);
    free(s);
    *out = NULL;
}

ph_route ph_i_springs_route(const ph_springs *s)
{
    return s->plain    ? PH_ROUTE_BONDS
           : s->by_fft ? PH_ROUTE_CONVOLUTION
                       : PH_ROUTE_STENCIL;
}

ph_status ph_i_springs_symbol(ph_springs *s, double E0, double *P, ph_error *err)
{
    ph_status st = PH_OK;
    if (!s->symbol) PH_TRY(new_symbol(s, err));
    for (int m = 0; m < ph_i_springs_packed(s); m++) {
        const double *K = s->symbol + m * s->modes;
        for (ptrdiff_t k = 0; k < s->modes; k++)
            P[m * s->modes + k] = E0 * (K[0] - K[k]);
    }
out:
    return st;
}
