/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The exact poles of the reduced model.
 *
 * Write every term of the model as springs and dashpots in series. With M_inf = F F^T and a
 * column l of L for each dashpot of time tau_l, so that M_0 = Z Z^T with Z = [F L],
 *
 *   2 W = |F^T q|^2 + |L^T q - y|^2,   y' = (L^T q - y) / tau,   q = (e, c)
 *
 * and c in equilibrium, the forces Z^T q - (0, y) lie in the complement of the rows of Z_c.
 * With an orthonormal basis Q of it, in which (g, 0) with F_c g = 0 never relaxes and is
 * split off, C*(s) is
 *
 *   C*(s) = C_inf + sum_k r_k r_k^T s / (s + sigma_k^2),   C_inf = |F_m Q_0|^2,
 *   r_k = Z_m Q u_k,   sigma_k, u_k: singular values and right vectors of tau^(-1/2) Q_L
 *
 * with Q_L the rows of Q that belong to L. Nothing is subtracted: every term is positive
 * semidefinite, times may span any number of decades, and M_inf may be singular. */
#include "core/dense.h"
#include "effective/visco_model.h"

#include <math.h>
#include <string.h>

/* Squared columns of the factors: digits of arithmetic. Rank of F_c: their root. Terms below
 * the last share of the whole, or with times this near, are one. */
static const double negligible = 1e-15, dependent = 1e-13, rank_tolerance = 1e-7,
                    no_term = 1e-15, same_time = 1e-9;

/* Columns [n] each, of one relaxation time. */
typedef struct columns {
    int count, room;
    double *a, *rate; /* [count][n], [count] */
} columns;

typedef struct poles {
    int ns, n, nb; /* macro strains, rows, independent basis fields */
    double *basis; /* [nb][nbasis] combinations of fields that are orthonormal in M_0 */
    columns F, L;
} poles;

static ph_status append(columns *c, int n, const double *v, double scale, double rate,
                        ph_error *err)
{
    ph_status st = PH_OK;
    if (c->count == c->room) {
        int room = 2 * c->room + 16;
        double *a = realloc(c->a, sizeof *a * (size_t)room * (size_t)n);
        PH_CHECK(a, PH_ENOMEM, "no memory for the poles");
        c->a = a;
        double *r = realloc(c->rate, sizeof *r * (size_t)room);
        PH_CHECK(r, PH_ENOMEM, "no memory for the poles");
        c->rate = r;
        c->room = room;
    }
    for (int i = 0; i < n; i++)
        c->a[(size_t)c->count * n + i] = scale * v[i];
    c->rate[c->count++] = rate;
out:
    return st;
}

/* ---- factors ------------------------------------------------------------------------------ */

/* Columns of a Gram matrix, K = G G^T, by Cholesky with diagonal pivoting in the scale of its
 * diagonal. G [n][n] column by column; returns the rank. */
static int gram_columns(int n, const double *K, int stride, double least, double *work,
                        double *G)
{
    double *d = work; /* what is left of the diagonal */
    int rank = 0;
    double most = 0.0;
    for (int i = 0; i < n; i++)
        most = fmax(most, d[i] = K[(size_t)i * stride + i]);
    while (rank < n) {
        int best = 0;
        double share = 0.0;
        for (int i = 0; i < n; i++) {
            double whole = K[(size_t)i * stride + i];
            if (whole > least && d[i] / whole > share) share = d[i] / whole, best = i;
        }
        if (!(share > dependent)) break;
        double *g = G + (size_t)rank * n, pivot = sqrt(d[best]);
        for (int i = 0; i < n; i++) {
            g[i] = K[(size_t)i * stride + best];
            for (int k = 0; k < rank; k++)
                g[i] -= G[(size_t)k * n + i] * G[(size_t)k * n + best];
            g[i] /= pivot;
        }
        for (int i = 0; i < n; i++)
            d[i] = i == best ? 0.0 : d[i] - g[i] * g[i];
        rank++;
    }
    return rank;
}

/* Rows of G that belong to basis fields -> rows of combinations orthonormal in M_0. */
static void change_basis(const poles *p, const double *g, double *to)
{
    int nbasis = p->n - p->ns;
    memcpy(to, g, sizeof *to * (size_t)p->ns);
    for (int k = 0; k < p->nb; k++) {
        const double *b = p->basis + (size_t)k * nbasis;
        to[p->ns + k] = 0.0;
        for (int i = 0; i < nbasis; i++)
            to[p->ns + k] += b[i] * g[p->ns + i];
    }
}

/* Orthonormal combinations: Gram-Schmidt in the scale of the fields, largest rest first, on
 * the rows of Cholesky. */
static ph_status orthonormal_basis(poles *p, const ph_reduced *m, ph_error *err)
{
    ph_status st = PH_OK;
    int nb = m->n - m->ns, rank = 0;
    double *A = NULL, *scale = NULL, *x = NULL;
    PH_ALLOC(A, nb * nb, "the poles");
    PH_ALLOC(scale, nb, "the poles");
    PH_ALLOC(x, nb, "the poles");
    PH_ALLOC(p->basis, nb * nb, "the poles");
    for (int q = 0; q < m->nfunctions; q++)
        for (int i = 0; i < nb; i++)
            for (int j = 0; j < nb; j++)
                A[i * nb + j] += m->K[q][(m->ns + i) * m->room + m->ns + j];
    for (int i = 0; i < nb; i++)
        scale[i] = A[i * nb + i] > 0.0 ? 1.0 / sqrt(A[i * nb + i]) : 0.0;
    for (int i = 0; i < nb; i++) {
        double *v = p->basis + rank * nb, size = 0.0;
        if (scale[i] == 0.0) continue;
        memset(v, 0, sizeof *v * (size_t)nb);
        v[i] = scale[i];
        for (int twice = 0; twice < 2; twice++) {
            for (int k = 0; k <= rank; k++) { /* the last one is v itself */
                const double *b = p->basis + k * nb;
                double sum = 0.0;
                for (int r = 0; r < nb; r++)
                    for (int c = 0; c < nb; c++)
                        sum += b[r] * A[r * nb + c] * v[c];
                if (k == rank)
                    size = sum;
                else
                    for (int r = 0; r < nb; r++)
                        v[r] -= sum * b[r];
            }
            if (!(size > dependent)) break;
        }
        if (!(size > dependent)) continue;
        for (int r = 0; r < nb; r++)
            v[r] /= sqrt(size);
        rank++;
    }
    p->nb = rank;
out:
    free(A);
    free(scale);
    free(x);
    return st;
}

/* Columns of all terms: first those at rest, then by relaxation time. */
static ph_status make_columns(poles *p, const ph_reduced *m, ph_error *err)
{
    ph_status st = PH_OK;
    int n = m->n, rows = p->ns + p->nb;
    double *G = NULL, *work = NULL, *row = NULL, most = 0.0;
    PH_ALLOC(G, n * n, "the poles");
    PH_ALLOC(work, n, "the poles");
    PH_ALLOC(row, n, "the poles");
    for (int q = 0; q < m->nfunctions; q++)
        for (int i = 0; i < n; i++)
            most = fmax(most, m->K[q][i * m->room + i]);
    for (int q = 0; q < m->nfunctions; q++) {
        const ph_decay *f = &m->function[q];
        int rank = gram_columns(n, m->K[q], m->room, most * negligible, work, G);
        for (int k = 0; k < rank; k++) {
            change_basis(p, G + (size_t)k * n, row);
            if (f->rest > 0.0) PH_TRY(append(&p->F, rows, row, sqrt(f->rest), 0.0, err));
            for (int t = 0; t < f->nterms; t++)
                PH_TRY(
                    append(&p->L, rows, row, sqrt(f->weight[t]), 1.0 / f->time[t], err));
        }
    }
out:
    free(G);
    free(work);
    free(row);
    return st;
}

/* More columns than rows make no more than rows: A A^T = R^T R of A^T = Q R.
 * Columns [first, first + count) of c; returns how many are left at the front of them. */
static ph_status compress(columns *c, int n, int first, int count, int *left,
                          ph_error *err)
{
    ph_status st = PH_OK;
    double *T = NULL, *d = NULL, *beta = NULL;
    *left = count;
    if (count <= n) return PH_OK;
    PH_ALLOC(T, count * n, "the poles");
    PH_ALLOC(d, n, "the poles");
    PH_ALLOC(beta, n, "the poles");
    for (int i = 0; i < n; i++)
        for (int k = 0; k < count; k++)
            T[(size_t)i * count + k] = c->a[(size_t)(first + k) * n + i];
    ph_i_qr(count, n, T, d, beta, NULL);
    for (int k = 0; k < n; k++)
        for (int i = 0; i < n; i++)
            c->a[(size_t)(first + k) * n + i] = i < k    ? 0.0
                                                : i == k ? d[k]
                                                         : T[(size_t)i * count + k];
    *left = n;
out:
    free(T);
    free(d);
    free(beta);
    return st;
}

typedef struct key {
    double rate;
    int at;
} key;

static int by_rate(const void *a, const void *b)
{
    const key *x = a, *y = b;
    if (x->rate != y->rate) return x->rate < y->rate ? 1 : -1;
    return (x->at > y->at) - (x->at < y->at);
}

/* Relaxing columns by falling rate, those of one rate compressed. */
static ph_status sort_columns(poles *p, int n, ph_error *err)
{
    ph_status st = PH_OK;
    columns *L = &p->L;
    key *keys = NULL;
    double *a = NULL;
    int count = 0, left;
    PH_ALLOC(keys, L->count, "the poles");
    PH_ALLOC(a, L->count * n, "the poles");
    for (int k = 0; k < L->count; k++)
        keys[k] = (key){L->rate[k], k};
    qsort(keys, (size_t)L->count, sizeof *keys, by_rate);
    if (L->count > 0) memcpy(a, L->a, sizeof *a * (size_t)L->count * (size_t)n);
    for (int k = 0; k < L->count; k++) {
        memcpy(L->a + (size_t)k * n, a + (size_t)keys[k].at * n, sizeof *a * (size_t)n);
        L->rate[k] = keys[k].rate;
    }
    for (int i = 0, j; i < L->count; i = j) {
        for (j = i + 1; j < L->count && L->rate[j] == L->rate[i];)
            j++;
        PH_TRY(compress(L, n, i, j - i, &left, err));
        for (int k = 0; k < left; k++, count++) {
            memmove(L->a + (size_t)count * n, L->a + (size_t)(i + k) * n,
                    sizeof *a * (size_t)n);
            L->rate[count] = L->rate[i];
        }
    }
    L->count = count;
    PH_TRY(compress(&p->F, n, 0, p->F.count, &p->F.count, err));
out:
    free(keys);
    free(a);
    return st;
}

/* ---- equilibrium --------------------------------------------------------------------------- */

/* Turn the columns of F so that the last ones have F_c = 0: their macro part is C_inf, and
 * they are dropped. */
static ph_status split_equilibrium(poles *p, ph_sym4 *rest, ph_error *err)
{
    ph_status st = PH_OK;
    int f = p->F.count, nb = p->nb, n = p->ns + nb, k = nb < f ? nb : f, rank = 0;
    double *T = NULL, *d = NULL, *beta = NULL, *turned = NULL, *e = NULL, most = 0.0;
    int *order = NULL;
    *rest = (ph_sym4){.n = p->ns};
    PH_ALLOC(T, f * nb, "the poles");
    PH_ALLOC(d, k, "the poles");
    PH_ALLOC(beta, k, "the poles");
    PH_ALLOC(order, nb, "the poles");
    PH_ALLOC(turned, f * n, "the poles");
    PH_ALLOC(e, f, "the poles");
    for (int i = 0; i < nb; i++)
        for (int j = 0; j < f; j++)
            T[(size_t)i * f + j] = p->F.a[(size_t)j * n + p->ns + i];
    ph_i_qr(f, nb, T, d, beta, order);
    for (int i = 0; i < k; i++)
        most = fmax(most, fabs(d[i]));
    while (rank < k && fabs(d[rank]) > rank_tolerance * most)
        rank++;
    for (int i = 0; i < n; i++) { /* row i of F times Q */
        for (int j = 0; j < f; j++)
            e[j] = p->F.a[(size_t)j * n + i];
        ph_i_qr_transposed(f, k, T, beta, e);
        for (int j = 0; j < f; j++)
            turned[(size_t)j * n + i] = e[j];
    }
    for (int j = rank; j < f; j++)
        for (int a = 0; a < p->ns; a++)
            for (int b = 0; b < p->ns; b++)
                rest->m[a][b] += turned[(size_t)j * n + a] * turned[(size_t)j * n + b];
    if (rank > 0) memcpy(p->F.a, turned, sizeof *turned * (size_t)rank * (size_t)n);
    p->F.count = rank;
out:
    free(T);
    free(d);
    free(beta);
    free(order);
    free(turned);
    free(e);
    return st;
}

/* ---- poles ----------------------------------------------------------------------------------- */

/* Y = Z_m Q [count][ns] and A = rate^(1/2) Q_L [count][R], column by column. */
static ph_status relaxing_part(const poles *p, int *count, double **Y, double **A,
                               ph_error *err)
{
    ph_status st = PH_OK;
    int f = p->F.count, R = p->L.count, m = f + R, nb = p->nb, n = p->ns + nb;
    double *T = NULL, *d = NULL, *beta = NULL, *e = NULL;
    *count = m - nb;
    PH_ASSERT(*count >= 0);
    PH_ALLOC(T, m * nb, "the poles");
    PH_ALLOC(d, nb, "the poles");
    PH_ALLOC(beta, nb, "the poles");
    PH_ALLOC(e, m, "the poles");
    PH_ALLOC(*Y, *count * p->ns, "the poles");
    PH_ALLOC(*A, (size_t)*count * (size_t)R, "the poles");
    for (int i = 0; i < nb; i++)
        for (int j = 0; j < m; j++)
            T[(size_t)i * m + j] = (j < f ? p->F.a + (size_t)j * n
                                          : p->L.a + (size_t)(j - f) * n)[p->ns + i];
    ph_i_qr(m, nb, T, d, beta, NULL);
    for (int k = 0; k < *count; k++) {
        memset(e, 0, sizeof *e * (size_t)m);
        e[nb + k] = 1.0;
        ph_i_qr_apply(m, nb, T, beta, e);
        double *y = *Y + (size_t)k * p->ns;
        for (int j = 0; j < m; j++)
            for (int a = 0; a < p->ns; a++)
                y[a] += e[j] * (j < f ? p->F.a + (size_t)j * n
                                      : p->L.a + (size_t)(j - f) * n)[a];
        for (int j = 0; j < R; j++)
            (*A)[(size_t)k * R + j] = sqrt(p->L.rate[j]) * e[f + j];
    }
out:
    free(T);
    free(d);
    free(beta);
    free(e);
    return st;
}

/* Right singular vectors [count][count] in the columns of U, with the order of the rows. */
static ph_status singular(int count, int R, double *A, double *U, double *sigma,
                          int *order, ph_error *err)
{
    ph_status st = PH_OK;
    double *d = NULL, *beta = NULL;
    PH_ASSERT(R >= count);
    PH_ALLOC(d, count, "the poles");
    PH_ALLOC(beta, count, "the poles");
    ph_i_qr(R, count, A, d, beta, order);
    for (int k = 0; k < count; k++) /* column k of R^T */
        for (int i = 0; i < count; i++)
            U[(size_t)k * count + i] = i < k ? 0.0 : i == k ? d[k] : A[(size_t)i * R + k];
    ph_i_singular_values(count, count, U, sigma);
out:
    free(d);
    free(beta);
    return st;
}

static int by_time(const void *a, const void *b)
{
    double s = ((const ph_prony_term *)a)->time, t = ((const ph_prony_term *)b)->time;
    return (s > t) - (s < t);
}

static double trace(const ph_sym4 *c)
{
    double t = 0.0;
    for (int i = 0; i < c->n; i++)
        t += c->m[i][i];
    return t;
}

/* Sorted terms, those of one time joined. Returns their number. */
static int join(int count, ph_prony_term *term, double whole)
{
    int n = 0;
    qsort(term, (size_t)count, sizeof *term, by_time);
    for (int k = 0; k < count; k++) {
        double w = trace(&term[k].stiffness);
        if (!(w > no_term * whole)) continue;
        if (n > 0 && term[k].time - term[n - 1].time <= same_time * term[k].time) {
            double v = trace(&term[n - 1].stiffness);
            term[n - 1].time += (term[k].time - term[n - 1].time) * (w / (v + w));
            term[n - 1].stiffness =
                ph_sym4_combine(1.0, &term[n - 1].stiffness, 1.0, &term[k].stiffness);
        } else
            term[n++] = term[k];
    }
    return n;
}

static ph_status terms_of(const poles *p, const ph_sym4 *rest, ph_prony **out,
                          ph_error *err)
{
    ph_status st = PH_OK;
    double *Y = NULL, *A = NULL, *U = NULL, *sigma = NULL, whole = trace(rest);
    ph_prony_term *term = NULL;
    int *order = NULL, count = 0, ns = p->ns;
    PH_TRY(relaxing_part(p, &count, &Y, &A, err));
    PH_ALLOC(U, (size_t)count * (size_t)count, "the poles");
    PH_ALLOC(sigma, count, "the poles");
    PH_ALLOC(order, count, "the poles");
    PH_ALLOC(term, count, "the poles");
    PH_TRY(singular(count, p->L.count, A, U, sigma, order, err));
    int n = 0;
    for (int k = 0; k < count; k++) {
        double r[6] = {0};
        if (!(sigma[k] > 0.0)) continue;
        for (int i = 0; i < count; i++)
            for (int a = 0; a < ns; a++)
                r[a] +=
                    Y[(size_t)order[i] * ns + a] * U[(size_t)k * count + i] / sigma[k];
        term[n] = (ph_prony_term){1.0 / sigma[k] / sigma[k], {.n = ns}};
        for (int a = 0; a < ns; a++)
            for (int b = 0; b < ns; b++)
                term[n].stiffness.m[a][b] = r[a] * r[b];
        whole += trace(&term[n++].stiffness);
    }
    n = join(n, term, whole);
    PH_TRY(ph_prony_new(rest, n, term, out, err));
out:
    free(Y);
    free(A);
    free(U);
    free(sigma);
    free(order);
    free(term);
    return st;
}

ph_status ph_i_reduced_series(const ph_reduced *m, ph_prony **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_sym4 rest;
    poles p = {.ns = m->ns, .n = m->n};
    PH_TRY(orthonormal_basis(&p, m, err));
    PH_TRY(make_columns(&p, m, err));
    PH_TRY(sort_columns(&p, p.ns + p.nb, err));
    PH_TRY(split_equilibrium(&p, &rest, err));
    PH_TRY(terms_of(&p, &rest, out, err));
out:
    free(p.basis);
    free(p.F.a);
    free(p.F.rate);
    free(p.L.a);
    free(p.L.rate);
    return st;
}
