/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "material/prony_reduce.h"

#include "core/check.h"
#include "core/jacobi.h"

#include <math.h>
#include <string.h>

/* In-plane components 11 22 12 and those across, of six. */
static const int keep[3] = {0, 1, 5}, drop[3] = {2, 3, 4};

/* Tensors this close to a multiple of one another are; rates this close are one; a term below
 * this share of the instantaneous tensor is round-off. */
static const double same_shape = 1e-13, same_rate = 1e-12, no_term = 1e-14;

/* Is `c` a multiple of `shape`? */
static bool multiple(const ph_sym4 *c, const ph_sym4 *shape)
{
    double dot = 0.0, size = 0.0;
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++) {
            dot += c->m[i][j] * shape->m[i][j];
            size += shape->m[i][j] * shape->m[i][j];
        }
    ph_sym4 rest = ph_sym4_combine(1.0, c, -dot / size, shape);
    return ph_sym4_norm(&rest) <= same_shape * ph_sym4_norm(c);
}

static bool all_alike(const ph_prony *p)
{
    if (p->nterms == 0) return true;
    bool alike = multiple(&p->equilibrium, &p->term[0].stiffness);
    for (int m = 1; m < p->nterms; m++)
        alike = alike && multiple(&p->term[m].stiffness, &p->term[0].stiffness);
    return alike;
}

static ph_status one_by_one(const ph_prony *p, ph_kinematics kin, ph_prony **out,
                            ph_error *err)
{
    ph_status st = PH_OK;
    ph_prony *r = NULL;
    PH_TRY(ph_prony_copy(p, &r, err));
    PH_TRY(ph_sym4_reduce(&p->equilibrium, kin, &r->equilibrium, err));
    for (int m = 0; m < p->nterms; m++)
        PH_TRY(ph_sym4_reduce(&p->term[m].stiffness, kin, &r->term[m].stiffness, err));
    *out = r;
    r = NULL;
out:
    ph_prony_free(&r);
    return st;
}

/* ---- condensation --------------------------------------------------------------------- */

/* The branches of all terms: columns of L scaled by 1/sqrt(tau), and what becomes of them. */
typedef struct branches {
    int n;
    double *a, *b;  /* [n][3] rows of L^T T^-1/2, in plane and across */
    double *root;   /* [n] 1/sqrt(tau) */
    double *S, *V;  /* [n][n] */
    double R[3][3]; /* C0_bb^-1 */
} branches;

static void clear(branches *w)
{
    free(w->a);
    free(w->b);
    free(w->root);
    free(w->S);
    free(w->V);
}

/* L = V sqrt(eigenvalues), columns that are zero left out. */
static void factor(branches *w, const ph_prony_term *t)
{
    double a[6][6], v[6][6], top = 0.0;
    memcpy(a, t->stiffness.m, sizeof a);
    ph_i_jacobi(6, 6, &a[0][0], &v[0][0]);
    for (int k = 0; k < 6; k++)
        top = fmax(top, a[k][k]);
    for (int k = 0; k < 6; k++) {
        if (a[k][k] <= no_term * top) continue;
        double scale = sqrt(a[k][k]) / sqrt(t->time);
        for (int i = 0; i < 3; i++) {
            w->a[3 * w->n + i] = scale * v[keep[i]][k];
            w->b[3 * w->n + i] = scale * v[drop[i]][k];
        }
        w->root[w->n++] = 1.0 / sqrt(t->time);
    }
}

static ph_status invert_across(const ph_sym4 *c0, double R[3][3], ph_error *err)
{
    ph_status st = PH_OK;
    ph_sym4 bb = {.n = 3};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            bb.m[i][j] = c0->m[drop[i]][drop[j]];
    PH_TRY(ph_sym4_inverse(&bb, &bb, err));
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            R[i][j] = bb.m[i][j];
out:
    return st;
}

/* S, and the rows of a less what the strain across takes up. */
static void eliminate(branches *w, const ph_sym4 *c0)
{
    for (int p = 0; p < w->n; p++) {
        double bR[3] = {0};
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                bR[j] += w->b[3 * p + i] * w->R[i][j];
        for (int q = 0; q < w->n; q++) {
            double h = p == q ? w->root[p] * w->root[p] : 0.0;
            for (int j = 0; j < 3; j++)
                h -= bR[j] * w->b[3 * q + j];
            w->S[p * w->n + q] = h;
        }
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                w->a[3 * p + i] -= bR[j] * c0->m[drop[j]][keep[i]];
    }
    for (int p = 0; p < w->n; p++)
        for (int q = 0; q < p; q++)
            w->S[p * w->n + q] = w->S[q * w->n + p] =
                0.5 * (w->S[p * w->n + q] + w->S[q * w->n + p]);
}

static int by_time(const void *a, const void *b)
{
    double s = ((const ph_prony_term *)a)->time, t = ((const ph_prony_term *)b)->time;
    return (s > t) - (s < t);
}

/* Terms from eigenvalues and vectors; equal times become one. */
static int collect(const branches *w, double size, ph_prony_term *term)
{
    int count = 0, merged = 0;
    for (int k = 0; k < w->n; k++) {
        double lambda = w->S[k * w->n + k], g[3] = {0}, norm = 0.0;
        for (int p = 0; p < w->n; p++)
            for (int i = 0; i < 3; i++)
                g[i] += w->V[p * w->n + k] * w->a[3 * p + i];
        for (int i = 0; i < 3; i++)
            norm += g[i] * g[i];
        /* a rate of zero belongs to branches that the plane does not see */
        if (!(lambda > 0.0) || !(norm / lambda > no_term * size)) continue;
        ph_prony_term *t = &term[count++];
        *t = (ph_prony_term){.time = 1.0 / lambda, .stiffness = {.n = 3}};
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                t->stiffness.m[i][j] = g[i] * g[j] / lambda;
    }
    qsort(term, (size_t)count, sizeof *term, by_time);
    for (int k = 0; k < count; k++) {
        ph_prony_term *last = merged > 0 ? &term[merged - 1] : NULL;
        if (last && term[k].time - last->time <= same_rate * last->time)
            last->stiffness =
                ph_sym4_combine(1.0, &last->stiffness, 1.0, &term[k].stiffness);
        else
            term[merged++] = term[k];
    }
    return merged;
}

/* C_aa - C_ab C_bb^+ C_ba of the equilibrium tensor, whose C_bb may be singular (a fluid). */
static ph_sym4 equilibrium_in_plane(const ph_sym4 *c)
{
    double bb[3][3], v[3][3], top = 0.0;
    ph_sym4 r = {.n = 3};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            r.m[i][j] = c->m[keep[i]][keep[j]];
            bb[i][j] = c->m[drop[i]][drop[j]];
        }
    ph_i_jacobi(3, 3, &bb[0][0], &v[0][0]);
    for (int k = 0; k < 3; k++)
        top = fmax(top, bb[k][k]);
    for (int k = 0; k < 3; k++) {
        double x[3] = {0};
        if (bb[k][k] <= no_term * top) continue;
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                x[i] += c->m[keep[i]][drop[j]] * v[j][k];
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                r.m[i][j] -= x[i] * x[j] / bb[k][k];
    }
    for (int i = 0; i < 3; i++) /* K of a fluid that resists compression only cancels */
        for (int j = 0; j < 3; j++)
            if (fabs(r.m[i][j]) <= no_term * ph_sym4_norm(c)) r.m[i][j] = 0.0;
    return r;
}

static ph_status condense(const ph_prony *p, ph_prony **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_sym4 c0 = ph_prony_instantaneous(p), inf;
    ph_prony_term *term = NULL;
    branches w = {0};
    const int most = 6 * p->nterms;
    PH_ALLOC(w.a, 3 * most, "branches of a series");
    PH_ALLOC(w.b, 3 * most, "branches of a series");
    PH_ALLOC(w.root, most, "branches of a series");
    PH_ALLOC(w.S, most * most, "branches of a series");
    PH_ALLOC(w.V, most * most, "branches of a series");
    PH_ALLOC(term, most, "the terms of a series");
    for (int m = 0; m < p->nterms; m++)
        factor(&w, &p->term[m]);
    PH_TRY(invert_across(&c0, w.R, err));
    eliminate(&w, &c0);
    ph_i_jacobi(w.n, w.n, w.S, w.V);
    int count = collect(&w, ph_sym4_norm(&c0), term);
    inf = equilibrium_in_plane(&p->equilibrium);
    PH_TRY(ph_prony_new(&inf, count, term, out, err));
out:
    clear(&w);
    free(term);
    return st;
}

ph_status ph_i_prony_reduce(const ph_prony *p, ph_kinematics kin, ph_prony **out,
                            ph_error *err)
{
    *out = NULL;
    if (p->equilibrium.n == ph_strains(kin)) return ph_prony_copy(p, out, err);
    if (kin != PH_PLANE_STRESS || p->equilibrium.n != 6 || all_alike(p))
        return one_by_one(p, kin, out, err);
    return condense(p, out, err);
}
