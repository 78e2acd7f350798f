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
#include "material/prony_network.h"

#include "core/dense.h"
#include "core/jacobi.h"

#include <float.h>
#include <math.h>
#include <string.h>

void ph_i_network_free(ph_i_network *w)
{
    free(w->L);
    free(w->time);
    free(w->G);
    free(w->X);
    free(w->V);
    free(w->rate);
}

/* The columns of every L_m: eigenvectors times root of eigenvalue. */
static ph_status split_terms(ph_i_network *w, const ph_prony *p, ph_error *err)
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
bool ph_i_factor(int n, double c[6][6], double R[6][6])
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
void ph_i_both_sides(int n, double R[6][6], double S[6][6])
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
static ph_status eliminate(ph_i_network *w, const ph_prony *p, int nd, const int *drop,
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
    PH_CHECK(ph_i_factor(nd, c, w->R), PH_ESINGULAR,
             "the instantaneous tensor of a Prony series is not positive definite");
    ph_i_both_sides(nd, w->R, S);
    PH_ALLOC(w->G, 6 * (size_t)w->q, "internal variables");
    for (int k = 0; k < w->q; k++) {
        for (int i = 0; i < nd; i++)
            w->G[6 * k + i] = w->L[6 * k + drop[i]];
        solve_lower(nd, w->R, &w->G[6 * k]);
    }
    ph_i_jacobi(nd, 6, &S[0][0], &w->U[0][0]);
    for (int i = 0; i < nd; i++)
        w->sigma[i] = S[i][i] > PH_I_NOTHING ? fmin(S[i][i], 1) : 0;
out:
    return st;
}

/* Unit vectors r_i along G^T u_i, orthogonal to those before; returns how many there are.
 * A direction that does not relax has none. @param[out] r [nd][q]; row: sigma of each */
static int relaxing(const ph_i_network *w, double *r, double *sigma)
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
        if (!(norm > PH_I_NOTHING)) continue;
        for (int k = 0; k < w->q; k++)
            x[k] /= sqrt(norm);
        sigma[count++] = w->sigma[u];
    }
    return count;
}

/* X = B T^-1/2, V = 1. */
static ph_status build(ph_i_network *w, ph_error *err)
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

static void turn(int n, double c, double s, double *x, double *y)
{
    for (int i = 0; i < n; i++) {
        double old = x[i];
        x[i] = c * old - s * y[i];
        y[i] = s * old + c * y[i];
    }
}

/* Columns j and k of X made orthogonal; false where they were. */
static bool orthogonalise(ph_i_network *w, int j, int k)
{
    double *x = &w->X[(size_t)j * w->rows], *y = &w->X[(size_t)k * w->rows];
    double a = ph_i_inner(w->rows, x, x), b = ph_i_inner(w->rows, y, y),
           ab = ph_i_inner(w->rows, x, y);
    if (!(fabs(ab) > 4 * DBL_EPSILON * sqrt(a) * sqrt(b))) return false;
    double theta = (b - a) / (2 * ab);
    double t = (theta >= 0 ? 1 : -1) / (fabs(theta) + hypot(theta, 1));
    double c = 1 / hypot(t, 1), s = t * c;
    turn(w->rows, c, s, x, y);
    turn(w->q, c, s, &w->V[(size_t)j * w->q], &w->V[(size_t)k * w->q]);
    return true;
}

/* Rates from the columns' norms; as many of them as S has zeros are zero. */
static ph_status rates(ph_i_network *w, ph_error *err)
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
        w->rate[k] = ph_i_inner(w->rows, x, x);
    }
    for (int i = 0; i < w->nd; i++)
        zeros += w->sigma[i] == 0;
    for (; zeros > 0; zeros--) {
        int least = -1;
        for (int k = 0; k < w->q; k++)
            if (w->rate[k] >= 0 && (least < 0 || w->rate[k] < w->rate[least])) least = k;
        if (least >= 0) w->rate[least] = -1; /* counted, be it exactly zero already */
    }
    for (int k = 0; k < w->q; k++)
        w->rate[k] = fmax(w->rate[k], 0);
out:
    return st;
}

ph_status ph_i_network_new(ph_i_network *w, const ph_prony *p, int nd, const int *drop,
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

void ph_i_network_dropped(const ph_i_network *w, int k, double *x)
{
    double R[6][6];
    memcpy(R, w->R, sizeof R);
    memcpy(x, &w->G[6 * k], (size_t)w->nd * sizeof *x);
    solve_upper(w->nd, R, x);
}

void ph_i_network_project(const ph_i_network *w, int mode, int n, const double *P,
                          double *x)
{
    const double *v = &w->V[(size_t)mode * w->q];
    memset(x, 0, 6 * sizeof *x);
    for (int k = 0; k < w->q; k++)
        for (int i = 0; i < n; i++)
            x[i] += P[6 * k + i] * (v[k] / sqrt(w->time[k]));
}
