/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Creep compliance, plane stress and engineering constants of a Prony series: exact. */
#include "core/jacobi.h"
#include "material/prony_network.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Times so close are one: rounding of a multiple eigenvalue. */
static const double same_time = 1e-10;

static int by_time(const void *a, const void *b)
{
    double s = ((const ph_prony_term *)a)->time, t = ((const ph_prony_term *)b)->time;
    return (s > t) - (s < t);
}

/* Sorts, merges equal times, drops terms that are nothing. Returns how many are left. */
static int tidy(int count, ph_prony_term *term, double scale)
{
    int left = 0;
    qsort(term, (size_t)count, sizeof *term, by_time);
    for (int k = 0; k < count; k++) {
        ph_prony_term *last = left ? &term[left - 1] : NULL;
        if (ph_sym4_norm(&term[k].stiffness) <= 1e-16 * scale) continue;
        if (last && term[k].time <= last->time * (1 + same_time))
            last->stiffness = ph_sym4_combine(1, &last->stiffness, 1, &term[k].stiffness);
        else
            term[left++] = term[k];
    }
    return left;
}

/* One term for each rate > 0: w w^T / rate, w = (rows of `P`, n x q) T^-1/2 v; what the
 * rates that are zero give is added to `flow` as w w^T. */
static int residues(const ph_i_network *w, int n, const double *P, ph_prony_term *term,
                    ph_sym4 *flow)
{
    int count = 0;
    for (int k = 0; k < w->q; k++) {
        double x[6], rate = w->rate[k];
        ph_i_network_project(w, k, n, P, x);
        ph_sym4 *sum = rate > 0 ? &term[count].stiffness : flow;
        sum->n = n;
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++)
                sum->m[i][j] += rate > 0 ? x[i] * (x[j] / rate) : x[i] * x[j];
        if (rate > 0) term[count++].time = 1 / rate;
    }
    return count;
}

/* ---- creep: every component eliminated ---- */

ph_status ph_prony_creep(const ph_prony *p, ph_creep **out, ph_error *err)
{
    PH_GIVEN(p && out);
    static const int all[6] = {0, 1, 2, 3, 4, 5};
    ph_status st = PH_OK;
    ph_i_network w = {0};
    ph_creep *creep = NULL;
    double *P = NULL;
    *out = NULL;
    PH_TRY(ph_i_network_new(&w, p, p->equilibrium.n, all, err));
    PH_ALLOC(creep, 1, "a creep compliance");
    PH_ALLOC(creep->term, w.q, "a creep compliance");
    PH_ALLOC(P, 6 * (size_t)w.q, "a creep compliance");
    ph_sym4 now = ph_prony_instantaneous(p);
    PH_TRY(ph_sym4_inverse(&now, &creep->instantaneous, err));
    creep->fluidity.n = w.n;
    for (int k = 0; k < w.q; k++)
        ph_i_network_dropped(&w, k, &P[6 * k]);
    int count = residues(&w, w.n, P, creep->term, &creep->fluidity);
    creep->nterms = tidy(count, creep->term, ph_sym4_norm(&creep->instantaneous));
    *out = creep;
    creep = NULL;
out:
    ph_i_network_free(&w);
    free(P);
    ph_creep_free(&creep);
    return st;
}

void ph_creep_free(ph_creep **creep)
{
    if (!creep || !*creep) return;
    free((*creep)->term);
    free(*creep);
    *creep = NULL;
}

static ph_sym4 creep_sum(const ph_creep *creep, double t, bool carson)
{
    ph_sym4 sum =
        ph_sym4_combine(1, &creep->instantaneous, carson ? 1 / t : t, &creep->fluidity);
    for (int m = 0; m < creep->nterms; m++) {
        double tau = creep->term[m].time;
        double f = carson ? 1 / (1 + t * tau) : -expm1(-t / tau);
        sum = ph_sym4_combine(1, &sum, f, &creep->term[m].stiffness);
    }
    return sum;
}

ph_sym4 ph_creep_at_time(const ph_creep *creep, double t)
{
    if (!creep) return (ph_sym4){0};
    return creep_sum(creep, t, false);
}

ph_sym4 ph_creep_carson(const ph_creep *creep, double s)
{
    if (!creep) return (ph_sym4){0};
    return creep_sum(creep, s, true);
}

/* ---- some components eliminated ---- */

typedef struct split {
    int nk, nd, keep[6], drop[6];
} split;

/* C_kk - C_kd C_dd^+ C_dk of a positive semidefinite tensor. */
static ph_sym4 condense_semidefinite(const ph_sym4 *c, const split *s)
{
    ph_sym4 r = {.n = s->nk};
    double a[6][6] = {{0}}, v[6][6], most = 0;
    for (int i = 0; i < s->nk; i++)
        for (int j = 0; j < s->nk; j++)
            r.m[i][j] = c->m[s->keep[i]][s->keep[j]];
    for (int i = 0; i < s->nd; i++)
        for (int j = 0; j < s->nd; j++)
            a[i][j] = c->m[s->drop[i]][s->drop[j]];
    ph_i_jacobi(s->nd, 6, &a[0][0], &v[0][0]);
    for (int k = 0; k < s->nd; k++)
        most = fmax(most, a[k][k]);
    for (int k = 0; k < s->nd; k++) {
        double x[6] = {0};
        if (!(a[k][k] > PH_I_NOTHING * most)) continue;
        for (int i = 0; i < s->nk; i++)
            for (int d = 0; d < s->nd; d++)
                x[i] += c->m[s->keep[i]][s->drop[d]] * v[d][k];
        for (int i = 0; i < s->nk; i++)
            for (int j = 0; j < s->nk; j++)
                r.m[i][j] -= x[i] * x[j] / a[k][k];
    }
    return r;
}

/* L_k - C_0kd C_0dd^-1 L_d. */
static void condensed_columns(const ph_i_network *w, const split *s, const ph_sym4 *now,
                              double *P)
{
    for (int k = 0; k < w->q; k++) {
        double x[6];
        ph_i_network_dropped(w, k, x);
        for (int i = 0; i < s->nk; i++) {
            P[6 * k + i] = w->L[6 * k + s->keep[i]];
            for (int d = 0; d < s->nd; d++)
                P[6 * k + i] -= now->m[s->keep[i]][s->drop[d]] * x[d];
        }
    }
}

static ph_status condense(const ph_prony *p, ph_prony **out, ph_error *err)
{
    static const split plane = {3, 3, {0, 1, 5}, {2, 3, 4}};
    ph_status st = PH_OK;
    ph_i_network w = {0};
    ph_prony_term *term = NULL;
    double *P = NULL;
    ph_sym4 now = ph_prony_instantaneous(p), flow = {.n = 3};
    PH_TRY(ph_i_network_new(&w, p, 3, plane.drop, err));
    PH_ALLOC(term, w.q, "a plane Prony series");
    PH_ALLOC(P, 6 * (size_t)w.q, "a plane Prony series");
    condensed_columns(&w, &plane, &now, P);
    int count = residues(&w, 3, P, term, &flow); /* a pole at zero has no residue */
    count = tidy(count, term, ph_sym4_norm(&now));
    ph_sym4 equilibrium = condense_semidefinite(&p->equilibrium, &plane);
    PH_TRY(ph_prony_new(&equilibrium, count, term, out, err));
out:
    ph_i_network_free(&w);
    free(term);
    free(P);
    return st;
}

ph_status ph_prony_reduce(const ph_prony *p, ph_kinematics kin, ph_prony **out,
                          ph_error *err)
{
    PH_GIVEN(p && out);
    ph_status st = PH_OK;
    *out = NULL;
    if (p->equilibrium.n == 6 && kin == PH_PLANE_STRESS) {
        PH_TRY(condense(p, out, err));
        goto out;
    }
    PH_TRY(ph_prony_copy(p, out, err));
    PH_TRY(ph_sym4_reduce(&p->equilibrium, kin, &(*out)->equilibrium, err));
    for (int m = 0; m < p->nterms; m++)
        PH_TRY(
            ph_sym4_reduce(&p->term[m].stiffness, kin, &(*out)->term[m].stiffness, err));
out:
    if (st != PH_OK) ph_prony_free(out);
    return st;
}

/* ---- one component kept ---- */

void ph_curve_free(ph_curve *curve)
{
    if (!curve) return;
    free(curve->term);
    *curve = (ph_curve){0};
}

double ph_curve_at_time(const ph_curve *curve, double t)
{
    if (!curve) return NAN;
    double x = curve->infinity;
    for (int m = 0; m < curve->nterms; m++)
        x += curve->term[m].modulus * exp(-t / curve->term[m].time);
    return x;
}

void ph_curve_complex(const ph_curve *curve, double omega, double *re, double *im)
{
    if (!curve || !re || !im) return;
    *re = curve->infinity;
    *im = 0;
    for (int m = 0; m < curve->nterms; m++) {
        double x = omega * curve->term[m].time, inverse = 1 / x;
        *re += curve->term[m].modulus / (1 + inverse * inverse);
        *im += curve->term[m].modulus / (x + inverse);
    }
}

static int by_curve_time(const void *a, const void *b)
{
    double s = ((const ph_modulus_term *)a)->time, t = ((const ph_modulus_term *)b)->time;
    return (s > t) - (s < t);
}

static void tidy_curve(ph_curve *curve)
{
    int left = 0;
    double sum = fabs(curve->infinity);
    ph_modulus_term *term = curve->term;
    for (int k = 0; k < curve->nterms; k++)
        sum += fabs(term[k].modulus);
    qsort(term, (size_t)curve->nterms, sizeof *term, by_curve_time);
    for (int k = 0; k < curve->nterms; k++) {
        if (fabs(term[k].modulus) <= 1e-16 * sum) continue;
        if (left && term[k].time <= term[left - 1].time * (1 + same_time))
            term[left - 1].modulus += term[k].modulus;
        else
            term[left++] = term[k];
    }
    curve->nterms = left;
}

static split keep_one(int n, int component)
{
    split s = {.nk = 1, .nd = n - 1, .keep = {component}};
    for (int i = 0, d = 0; i < n; i++)
        if (i != component) s.drop[d++] = i;
    return s;
}

/* Place of `component` among the dropped ones. */
static int place(const split *s, int component)
{
    int d = 0;
    while (d < s->nd && s->drop[d] != component)
        d++;
    return d;
}

/* -(C_0dd^-1 C_0dk) of row d: the strain there at once. */
static ph_status instant_ratio(const ph_sym4 *now, const split *s, int d, double *ratio,
                               ph_error *err)
{
    ph_status st = PH_OK;
    ph_sym4 inverse = {.n = now->n};
    PH_TRY(ph_sym4_inverse(now, &inverse, err));
    *ratio = inverse.m[s->drop[d]][s->keep[0]] / inverse.m[s->keep[0]][s->keep[0]];
out:
    return st;
}

ph_status ph_prony_uniaxial(const ph_prony *p, int component, int lateral, ph_curve *out,
                            ph_error *err)
{
    PH_GIVEN(p && out);
    ph_status st = PH_OK;
    ph_i_network w = {0};
    ph_curve curve = {0};
    double *P = NULL, *Z = NULL, ratio = 0;
    const int n = p->equilibrium.n;
    PH_CHECK(component >= 0 && component < n && lateral < n && lateral != component,
             PH_EINVAL, "components %d and %d of a tensor of %d", component, lateral, n);
    ph_sym4 now = ph_prony_instantaneous(p);
    split s = keep_one(n, component);
    int d = lateral >= 0 ? place(&s, lateral) : 0;
    PH_TRY(ph_i_network_new(&w, p, s.nd, s.drop, err));
    PH_ALLOC(curve.term, w.q, "a curve");
    PH_ALLOC(P, 6 * (size_t)w.q, "a curve");
    PH_ALLOC(Z, 6 * (size_t)w.q, "a curve");
    condensed_columns(&w, &s, &now, P);
    for (int k = 0; k < w.q; k++)
        ph_i_network_dropped(&w, k, &Z[6 * k]);
    if (lateral >= 0) PH_TRY(instant_ratio(&now, &s, d, &ratio, err));
    curve.infinity =
        lateral >= 0 ? -ratio : condense_semidefinite(&p->equilibrium, &s).m[0][0];
    for (int k = 0; k < w.q; k++) {
        double x[6], z[6], rate = w.rate[k];
        if (!(rate > 0)) continue;
        ph_i_network_project(&w, k, 1, P, x);
        ph_i_network_project(&w, k, s.nd, Z, z);
        double residue = lateral >= 0 ? x[0] * (z[d] / rate) : x[0] * (x[0] / rate);
        curve.term[curve.nterms++] = (ph_modulus_term){1 / rate, residue};
        if (lateral >= 0) curve.infinity -= residue;
    }
    tidy_curve(&curve);
    *out = curve;
    curve.term = NULL;
out:
    ph_i_network_free(&w);
    free(curve.term);
    free(P);
    free(Z);
    return st;
}
