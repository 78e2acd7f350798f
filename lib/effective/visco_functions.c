/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effective/visco_functions.h"

#include <math.h>
#include <string.h>

/* Tensors and functions that differ by less than this are the same: digits of arithmetic. */
static const double same = 1e-12;

double ph_i_decay_at(const ph_decay *d, double s)
{
    double sum = d->rest;
    for (int t = 0; t < d->nterms; t++) {
        double x = s * d->time[t];
        sum += d->weight[t] * (isinf(x) ? 1.0 : x / (1.0 + x));
    }
    return sum;
}

void ph_i_decay_clear(ph_decay *d)
{
    free(d->time);
    free(d->weight);
    *d = (ph_decay){0};
}

/* ---- the functions of one phase --------------------------------------------------------- */

/* |a - t b| <= same |a|, with the t that is nearest. */
static bool is_multiple(const ph_sym4 *a, const ph_sym4 *b, double *t)
{
    double ab = 0.0, bb = 0.0, off = 0.0, aa = 0.0;
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++)
            ab += a->m[i][j] * b->m[i][j], bb += b->m[i][j] * b->m[i][j];
    *t = bb > 0.0 ? ab / bb : 0.0;
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++) {
            double d = a->m[i][j] - *t * b->m[i][j];
            off += d * d;
            aa += a->m[i][j] * a->m[i][j];
        }
    return sqrt(off) <= same * sqrt(aa);
}

ph_status ph_i_decay_of(const ph_prony *p, const double *modulus, ph_decay *out,
                        double *total, ph_error *err)
{
    ph_status st = PH_OK;
    *out = (ph_decay){0};
    *total = 0.0;
    for (int t = 0; t <= p->nterms; t++)
        *total += fmax(0.0, modulus[t]);
    PH_ALLOC(out->time, p->nterms, "relaxation times");
    PH_ALLOC(out->weight, p->nterms, "relaxation weights");
    if (*total == 0.0) return PH_OK;
    out->rest = fmax(0.0, modulus[p->nterms]) / *total;
    for (int t = 0; t < p->nterms; t++) {
        double w = fmax(0.0, modulus[t]) / *total;
        if (w <= 0.0) continue;
        out->time[out->nterms] = p->term[t].time;
        out->weight[out->nterms++] = w;
    }
out:
    if (st != PH_OK) ph_i_decay_clear(out);
    return st;
}

bool ph_i_decay_same(const ph_decay *a, const ph_decay *b)
{
    if (a->nterms != b->nterms || fabs(a->rest - b->rest) > same * b->rest) return false;
    for (int t = 0; t < a->nterms; t++)
        if (fabs(a->time[t] - b->time[t]) > same * b->time[t] ||
            fabs(a->weight[t] - b->weight[t]) > same * b->weight[t])
            return false;
    return true;
}

/* X += scale * shape for the function `d`, which is taken or released. */
static ph_status add(ph_split *s, int material, ph_decay *d, double scale,
                     const ph_sym4 *shape, ph_error *err)
{
    ph_status st = PH_OK;
    int q = 0;
    while (q < s->nfunctions && !ph_i_decay_same(d, &s->function[q]))
        q++;
    if (q == s->nfunctions) {
        size_t n = (size_t)s->nfunctions + 1, m = (size_t)s->nmaterials;
        void *f = realloc(s->function, n * sizeof *s->function);
        PH_CHECK(f, PH_ENOMEM, "no memory for %zu functions", n);
        s->function = f;
        void *x = realloc(s->shape, n * m * sizeof *s->shape);
        PH_CHECK(x, PH_ENOMEM, "no memory for %zu functions", n);
        s->shape = x;
        memset(s->shape + (n - 1) * m, 0, m * sizeof *s->shape);
        for (size_t i = (n - 1) * m; i < n * m; i++)
            s->shape[i].n = 6;
        s->function[s->nfunctions++] = *d;
        *d = (ph_decay){0};
    }
    ph_sym4 *to = &s->shape[q * s->nmaterials + material];
    *to = ph_sym4_combine(1.0, to, scale, shape);
out:
    ph_i_decay_clear(d);
    return st;
}

static const ph_sym4 *part(const ph_prony *p, int t)
{
    return t < p->nterms ? &p->term[t].stiffness : &p->equilibrium;
}

/* Bulk and shear moduli of an isotropic series, [nterms + 1] each. */
static bool is_isotropic(const ph_prony *p, double *K, double *G)
{
    for (int t = 0; t <= p->nterms; t++) {
        const ph_sym4 *c = part(p, t);
        double trace = 0.0, off = 0.0;
        K[t] = G[t] = 0.0;
        for (int i = 0; i < 6; i++)
            trace += c->m[i][i];
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                K[t] += c->m[i][j] / 9.0;
        G[t] = (trace - 3.0 * K[t]) / 10.0;
        ph_sym4 iso = ph_sym4_isotropic_kg(K[t], G[t]);
        ph_sym4 d = ph_sym4_combine(1.0, c, -1.0, &iso);
        off = ph_sym4_norm(&d);
        if (off > same * ph_sym4_norm(c)) return false;
        if (3.0 * K[t] < same * ph_sym4_norm(c)) K[t] = 0.0;
        if (2.0 * G[t] < same * ph_sym4_norm(c)) G[t] = 0.0;
    }
    return true;
}

static ph_status split_terms(ph_split *s, int m, const ph_prony *p, double *one,
                             ph_error *err)
{
    ph_status st = PH_OK;
    double total;
    for (int t = 0; t <= p->nterms; t++) {
        ph_decay d;
        one[t] = 1.0;
        PH_TRY(ph_i_decay_of(p, one, &d, &total, err));
        one[t] = 0.0;
        PH_TRY(add(s, m, &d, 1.0, part(p, t), err));
    }
out:
    return st;
}

static ph_status split_phase(ph_split *s, int m, const ph_prony *p, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_sym4 bulk = ph_sym4_isotropic_kg(1.0, 0.0),
                  shear = ph_sym4_isotropic_kg(0.0, 1.0);
    ph_sym4 whole = ph_prony_instantaneous(p);
    double *K = NULL, *G = NULL, total;
    ph_decay d = {0};
    bool keeps = true;
    PH_ALLOC(K, p->nterms + 1, "moduli");
    PH_ALLOC(G, p->nterms + 1, "moduli");
    for (int t = 0; t <= p->nterms && keeps; t++)
        keeps = is_multiple(part(p, t), &whole, &K[t]);
    if (keeps) {
        PH_TRY(ph_i_decay_of(p, K, &d, &total, err));
        PH_TRY(add(s, m, &d, 1.0, &whole, err));
    } else if (is_isotropic(p, K, G)) {
        PH_TRY(ph_i_decay_of(p, K, &d, &total, err));
        PH_TRY(add(s, m, &d, total, &bulk, err));
        PH_TRY(ph_i_decay_of(p, G, &d, &total, err));
        PH_TRY(add(s, m, &d, total, &shear, err));
    } else {
        memset(K, 0, sizeof *K * (size_t)(p->nterms + 1));
        PH_TRY(split_terms(s, m, p, K, err));
    }
out:
    free(K);
    free(G);
    return st;
}

ph_status ph_i_split_new(int nmaterials, const ph_material *material, ph_split *out,
                         ph_error *err)
{
    ph_status st = PH_OK;
    const ph_prony still = {.equilibrium = {.n = 6}};
    double total, one = 1.0;
    ph_decay d;
    *out = (ph_split){.nmaterials = nmaterials};
    PH_TRY(ph_i_decay_of(&still, &one, &d, &total, err));
    PH_TRY(add(out, 0, &d, 0.0, &still.equilibrium, err));
    for (int m = 0; m < nmaterials; m++) {
        if (material[m].relaxation)
            PH_TRY(split_phase(out, m, material[m].relaxation, err));
        else
            out->shape[m] = material[m].stiffness;
    }
out:
    if (st != PH_OK) ph_i_split_clear(out);
    return st;
}

void ph_i_split_clear(ph_split *s)
{
    for (int q = 0; q < s->nfunctions; q++)
        ph_i_decay_clear(&s->function[q]);
    free(s->function);
    free(s->shape);
    *s = (ph_split){0};
}

int ph_i_split_count(const ph_split *s, int material)
{
    int n = 0;
    for (int q = 0; q < s->nfunctions; q++)
        n += ph_sym4_norm(ph_i_split_shape(s, q, material)) > 0.0;
    return n;
}

ph_sym4 ph_i_split_at(const ph_split *s, int material, double at)
{
    ph_sym4 c = {.n = 6};
    for (int q = 0; q < s->nfunctions; q++)
        c = ph_sym4_combine(1.0, &c, ph_i_decay_at(&s->function[q], at),
                            ph_i_split_shape(s, q, material));
    return c;
}
