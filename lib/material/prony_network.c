/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Strain components eliminated from a Prony series, exactly.
 *
 * With C_m = L_m L_m^T and one internal variable a column of L = [L_1 L_2 ...],
 *
 *     C(s) = C_0 - L (I + s T)^-1 L^T,      T = diag(tau)
 *
 * Eliminating the components d (sigma_d given) changes I to A = I - L_d^T C_0dd^-1 L_d, and
 * the poles are the eigenvalues lambda of T^-1/2 A T^-1/2. A is written as B^T B without
 * cancellation: with C_0dd = R^T R, G = R^-T L_d and S = R^-T C_inf,dd R^-1 it is
 * G G^T = 1 - S, hence with S = U sigma U^T and r_i the unit vectors along G^T u_i
 *
 *     A = (I - sum r_i r_i^T) + sum sigma_i r_i r_i^T,
 *
 * and one-sided Jacobi rotations find the singular values of B T^-1/2 to high relative
 * accuracy although T spans many decades. */
#include <perihom/prony.h>

#include "core/check.h"
#include "core/jacobi.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Equilibrium stiffness over instantaneous stiffness that counts as zero. */
static const double nothing = 1e-13;
/* Times so close are one: rounding of a multiple eigenvalue. */
static const double same_time = 1e-10;

typedef struct network {
    int n, q;  /* strain components, internal variables */
    double *L; /* [q][6] */
    double *time;
    double *G; /* [q][6]: R^-T L_d */
    int nd;    /* eliminated components */
    double R[6][6], sigma[6], U[6][6];
    double *X; /* [q] columns of B T^-1/2, each `rows` long; then X V */
    double *V; /* [q] columns */
    int rows;
    double *rate; /* [q] lambda */
} network;

static void network_free(network *w)
{
    free(w->L);
    free(w->time);
    free(w->G);
    free(w->X);
    free(w->V);
    free(w->rate);
}

/* The columns of every L_m: eigenvectors times root of eigenvalue. */
static ph_status split_terms(network *w, const ph_prony *p, ph_error *err)
{
    ph_status st = PH_OK;
    w->n = p->equilibrium.n;
    PH_ALLOC(w->L, 36 * (size_t)p->nterms, "internal variables");
    PH_ALLOC(w->time, 6 * (size_t)p->nterms, "internal variables");
    for (int m = 0; m < p->nterms; m++) {
        double a[6][6], v[6][6], most = 0;
        memcpy(a, p->term[m].stiffness.m, sizeof a);
        ph_i_jacobi(w->n, 6, &a[0][0], &v[0][0]);
        for (int k = 0; k < w->n; k++)
            most = fmax(most, a[k][k]);
        for (int k = 0; k < w->n; k++) {
            if (!(a[k][k] > 8 * DBL_EPSILON * most)) continue;
            for (int i = 0; i < w->n; i++)
                w->L[6 * w->q + i] = sqrt(a[k][k]) * v[i][k];
            w->time[w->q++] = p->term[m].time;
        }
    }
out:
    return st;
}

/* Upper R with R^T R = c; false where c is not positive definite. */
static bool factor(int n, double c[6][6], double R[6][6])
{
    memset(R, 0, 36 * sizeof(double));
    for (int i = 0; i < n; i++)
        for (int j = i; j < n; j++) {
            double x = c[i][j];
            for (int k = 0; k < i; k++)
                x -= R[k][i] * R[k][j];
            if (i == j && !(x > 16 * DBL_EPSILON * c[i][i])) return false;
            R[i][j] = i == j ? sqrt(x) : x / R[i][i];
        }
    return true;
}

/* x <- R^-T x */
static void solve_lower(int n, double R[6][6], double *x)
{
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < i; k++)
            x[i] -= R[k][i] * x[k];
        x[i] /= R[i][i];
    }
}

/* x <- R^-1 x */
static void solve_upper(int n, double R[6][6], double *x)
{
    for (int i = n - 1; i >= 0; i--) {
        for (int k = i + 1; k < n; k++)
            x[i] -= R[i][k] * x[k];
        x[i] /= R[i][i];
    }
}

/* S <- R^-T S R^-1 */
static void both_sides(int n, double R[6][6], double S[6][6])
{
    for (int side = 0; side < 2; side++) {
        double t[6][6];
        for (int i = 0; i < n; i++)
            solve_lower(n, R, S[i]);
        memcpy(t, S, sizeof t);
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++)
                S[i][j] = t[j][i];
    }
}

/* R, sigma, U and G of the eliminated components. */
static ph_status eliminate(network *w, const ph_prony *p, int nd, const int *drop,
                           ph_error *err)
{
    ph_status st = PH_OK;
    ph_sym4 now = ph_prony_instantaneous(p);
    double c[6][6], S[6][6] = {{0}};
    w->nd = nd;
    for (int i = 0; i < nd; i++)
        for (int j = 0; j < nd; j++) {
            c[i][j] = now.m[drop[i]][drop[j]];
            S[i][j] = p->equilibrium.m[drop[i]][drop[j]];
        }
    PH_CHECK(factor(nd, c, w->R), PH_ESINGULAR,
             "the instantaneous tensor of a Prony series is not positive definite");
    both_sides(nd, w->R, S);
    PH_ALLOC(w->G, 6 * (size_t)w->q, "internal variables");
    for (int k = 0; k < w->q; k++) {
        for (int i = 0; i < nd; i++)
            w->G[6 * k + i] = w->L[6 * k + drop[i]];
        solve_lower(nd, w->R, &w->G[6 * k]);
    }
    ph_i_jacobi(nd, 6, &S[0][0], &w->U[0][0]);
    for (int i = 0; i < nd; i++)
        w->sigma[i] = S[i][i] > nothing ? fmin(S[i][i], 1) : 0;
out:
    return st;
}

/* Unit vectors r_i along G^T u_i, orthogonal to those before; returns how many there are.
 * A direction that does not relax has none. @param[out] r [nd][q]; row: sigma of each */
static int relaxing(const network *w, double *r, double *sigma)
{
    int count = 0;
    for (int u = 0; u < w->nd; u++) {
        double *x = &r[(size_t)count * w->q], norm = 0;
        for (int k = 0; k < w->q; k++) {
            x[k] = 0;
            for (int i = 0; i < w->nd; i++)
                x[k] += w->G[6 * k + i] * w->U[i][u];
        }
        for (int pass = 0; pass < 2; pass++)
            for (int v = 0; v < count; v++) {
                double dot = 0;
                for (int k = 0; k < w->q; k++)
                    dot += x[k] * r[(size_t)v * w->q + k];
                for (int k = 0; k < w->q; k++)
                    x[k] -= dot * r[(size_t)v * w->q + k];
            }
        for (int k = 0; k < w->q; k++)
            norm += x[k] * x[k];
        if (!(norm > nothing)) continue;
        for (int k = 0; k < w->q; k++)
            x[k] /= sqrt(norm);
        sigma[count++] = w->sigma[u];
    }
    return count;
}

/* X = B T^-1/2, V = 1. */
static ph_status build(network *w, ph_error *err)
{
    ph_status st = PH_OK;
    double *r = NULL, sigma[6];
    const int q = w->q;
    PH_ALLOC(r, (size_t)w->nd * q, "internal variables");
    int count = relaxing(w, r, sigma);
    w->rows = q + count;
    PH_ALLOC(w->X, (size_t)q * w->rows, "internal variables");
    PH_ALLOC(w->V, (size_t)q * q, "internal variables");
    PH_ALLOC(w->rate, q, "internal variables");
    for (int k = 0; k < q; k++) {
        double *x = &w->X[(size_t)k * w->rows], root = sqrt(w->time[k]);
        for (int j = 0; j < q; j++) {
            x[j] = j == k;
            for (int i = 0; i < count; i++)
                x[j] -= r[(size_t)i * q + k] * r[(size_t)i * q + j];
            x[j] /= root;
        }
        for (int i = 0; i < count; i++)
            x[q + i] = sqrt(sigma[i]) * r[(size_t)i * q + k] / root;
        w->V[(size_t)k * q + k] = 1;
    }
out:
    free(r);
    return st;
}

static double dot(int n, const double *x, const double *y)
{
    double sum = 0;
    for (int i = 0; i < n; i++)
        sum += x[i] * y[i];
    return sum;
}

static void turn(int n, double c, double s, double *x, double *y)
{
    for (int i = 0; i < n; i++) {
        double old = x[i];
        x[i] = c * old - s * y[i];
        y[i] = s * old + c * y[i];
    }
}

/* Columns j and k of X made orthogonal; false where they were. */
static bool orthogonalise(network *w, int j, int k)
{
    double *x = &w->X[(size_t)j * w->rows], *y = &w->X[(size_t)k * w->rows];
    double a = dot(w->rows, x, x), b = dot(w->rows, y, y), ab = dot(w->rows, x, y);
    if (!(fabs(ab) > 4 * DBL_EPSILON * sqrt(a) * sqrt(b))) return false;
    double theta = (b - a) / (2 * ab);
    double t = (theta >= 0 ? 1 : -1) / (fabs(theta) + hypot(theta, 1));
    double c = 1 / hypot(t, 1), s = t * c;
    turn(w->rows, c, s, x, y);
    turn(w->q, c, s, &w->V[(size_t)j * w->q], &w->V[(size_t)k * w->q]);
    return true;
}

/* Rates from the columns' norms; as many of them as S has zeros are zero. */
static ph_status rates(network *w, ph_error *err)
{
    enum { SWEEPS = 60 };
    ph_status st = PH_OK;
    int sweep = 0, zeros = 0;
    for (bool turned = true; turned && sweep < SWEEPS; sweep++) {
        turned = false;
        for (int j = 0; j < w->q; j++)
            for (int k = j + 1; k < w->q; k++)
                turned |= orthogonalise(w, j, k);
    }
    PH_CHECK(sweep < SWEEPS, PH_ENOCONV,
             "the poles of a Prony series were not found in %d sweeps", SWEEPS);
    for (int k = 0; k < w->q; k++) {
        const double *x = &w->X[(size_t)k * w->rows];
        w->rate[k] = dot(w->rows, x, x);
    }
    for (int i = 0; i < w->nd; i++)
        zeros += w->sigma[i] == 0;
    for (; zeros > 0; zeros--) {
        int least = -1;
        for (int k = 0; k < w->q; k++)
            if (w->rate[k] > 0 && (least < 0 || w->rate[k] < w->rate[least])) least = k;
        if (least >= 0) w->rate[least] = 0;
    }
out:
    return st;
}

static ph_status network_new(network *w, const ph_prony *p, int nd, const int *drop,
                             ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(split_terms(w, p, err));
    PH_TRY(eliminate(w, p, nd, drop, err));
    PH_TRY(build(w, err));
    PH_TRY(rates(w, err));
out:
    return st;
}

static int by_time(const void *a, const void *b)
{
    double s = ((const ph_prony_term *)a)->time, t = ((const ph_prony_term *)b)->time;
    return (s > t) - (s < t);
}

/* Sorts, merges equal times, drops terms that are nothing. Returns how many are left. */
static int tidy(int count, ph_prony_term *term, double scale)
{
    int kept = 0;
    qsort(term, (size_t)count, sizeof *term, by_time);
    for (int k = 0; k < count; k++) {
        ph_prony_term *last = kept ? &term[kept - 1] : NULL;
        if (ph_sym4_norm(&term[k].stiffness) <= 1e-16 * scale) continue;
        if (last && term[k].time <= last->time * (1 + same_time))
            last->stiffness = ph_sym4_combine(1, &last->stiffness, 1, &term[k].stiffness);
        else
            term[kept++] = term[k];
    }
    return kept;
}

/* One term for each rate > 0: w w^T / rate, w = (rows of `P`, n x q) T^-1/2 v; what the
 * rates that are zero give is added to `flow` as w w^T. */
static int residues(const network *w, int n, const double *P, ph_prony_term *term,
                    ph_sym4 *flow)
{
    int count = 0;
    for (int k = 0; k < w->q; k++) {
        double x[6] = {0}, rate = w->rate[k];
        const double *v = &w->V[(size_t)k * w->q];
        for (int j = 0; j < w->q; j++)
            for (int i = 0; i < n; i++)
                x[i] += P[6 * j + i] * (v[j] / sqrt(w->time[j]));
        ph_sym4 *sum = rate > 0 ? &term[count].stiffness : flow;
        sum->n = n;
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++)
                sum->m[i][j] += rate > 0 ? x[i] * (x[j] / rate) : x[i] * x[j];
        if (rate > 0) term[count++].time = 1 / rate;
    }
    return count;
}

static const int all[6] = {0, 1, 2, 3, 4, 5};

ph_status ph_prony_creep(const ph_prony *p, ph_creep **out, ph_error *err)
{
    ph_status st = PH_OK;
    network w = {0};
    ph_creep *creep = NULL;
    double *P = NULL;
    *out = NULL;
    PH_TRY(network_new(&w, p, p->equilibrium.n, all, err));
    PH_ALLOC(creep, 1, "a creep compliance");
    PH_ALLOC(creep->term, w.q, "a creep compliance");
    PH_ALLOC(P, 6 * (size_t)w.q, "a creep compliance");
    ph_sym4 now = ph_prony_instantaneous(p);
    PH_TRY(ph_sym4_inverse(&now, &creep->instantaneous, err));
    creep->fluidity.n = w.n;
    memcpy(P, w.G, 6 * (size_t)w.q * sizeof *P); /* C_0^-1 L = R^-1 G */
    for (int k = 0; k < w.q; k++)
        solve_upper(w.n, w.R, &P[6 * k]);
    creep->nterms = residues(&w, w.n, P, creep->term, &creep->fluidity);
    creep->nterms = tidy(creep->nterms, creep->term, ph_sym4_norm(&creep->instantaneous));
    *out = creep;
    creep = NULL;
out:
    network_free(&w);
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
    return creep_sum(creep, t, false);
}

ph_sym4 ph_creep_carson(const ph_creep *creep, double s)
{
    return creep_sum(creep, s, true);
}

static const int kept[3] = {0, 1, 5}, dropped[3] = {2, 3, 4};

/* C_pp - C_pd C_dd^+ C_dp of a positive semidefinite tensor. */
static ph_sym4 condense_semidefinite(const ph_sym4 *c)
{
    ph_sym4 r = {.n = 3};
    double a[3][3], v[3][3], most = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            r.m[i][j] = c->m[kept[i]][kept[j]];
            a[i][j] = c->m[dropped[i]][dropped[j]];
        }
    ph_i_jacobi(3, 3, &a[0][0], &v[0][0]);
    for (int k = 0; k < 3; k++)
        most = fmax(most, a[k][k]);
    for (int k = 0; k < 3; k++) {
        double x[3] = {0};
        if (!(a[k][k] > nothing * most)) continue;
        for (int i = 0; i < 3; i++)
            for (int d = 0; d < 3; d++)
                x[i] += c->m[kept[i]][dropped[d]] * v[d][k];
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                r.m[i][j] -= x[i] * x[j] / a[k][k];
    }
    return r;
}

/* L_p - C_0pd C_0dd^-1 L_d, C_0dd^-1 L_d = R^-1 G. */
static void condensed_columns(const network *w, const ph_sym4 *now, double *P)
{
    for (int k = 0; k < w->q; k++) {
        double x[3] = {w->G[6 * k], w->G[6 * k + 1], w->G[6 * k + 2]}, R[6][6];
        memcpy(R, w->R, sizeof R);
        solve_upper(3, R, x);
        for (int i = 0; i < 3; i++) {
            P[6 * k + i] = w->L[6 * k + kept[i]];
            for (int d = 0; d < 3; d++)
                P[6 * k + i] -= now->m[kept[i]][dropped[d]] * x[d];
        }
    }
}

static ph_status condense(const ph_prony *p, ph_prony **out, ph_error *err)
{
    ph_status st = PH_OK;
    network w = {0};
    ph_prony_term *term = NULL;
    double *P = NULL;
    ph_sym4 now = ph_prony_instantaneous(p), flow = {.n = 3};
    PH_TRY(network_new(&w, p, 3, dropped, err));
    PH_ALLOC(term, w.q, "a plane Prony series");
    PH_ALLOC(P, 6 * (size_t)w.q, "a plane Prony series");
    condensed_columns(&w, &now, P);
    int count = residues(&w, 3, P, term, &flow); /* a pole at zero has no residue */
    count = tidy(count, term, ph_sym4_norm(&now));
    ph_sym4 equilibrium = condense_semidefinite(&p->equilibrium);
    PH_TRY(ph_prony_new(&equilibrium, count, term, out, err));
out:
    network_free(&w);
    free(term);
    free(P);
    return st;
}

ph_status ph_prony_reduce(const ph_prony *p, ph_kinematics kin, ph_prony **out,
                          ph_error *err)
{
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
