/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A relaxation series of fewer terms.
 *
 * What relaxes, R(t) = C(t) - C_inf, is written F Y(t) F^T with F F^T = R(0), so that the
 * coefficients Y_m >= 0 add up to 1. For given times the new coefficients X_j >= 0 minimise
 *
 *     sum_k w_k^2 | sum_j X_j exp(-t_k / T_j) - Y(t_k) |^2,    w = 1 / (size of C(t_k))
 *
 * a convex problem: the unconstrained solution where it is admissible, else block coordinate
 * descent, in which each block is a projection on the cone. A last congruence makes the X_j
 * add up to 1. The times come from the same problem for the trace of Y, a scalar with
 * coefficients >= 0: they are moved one by one on a logarithmic scale while that helps. */
#include <perihom/relaxation.h>

#include "core/check.h"
#include "core/jacobi.h"
#include "material/prony_network.h"

#include <math.h>
#include <string.h>

enum { SAMPLES = 240, TENSOR = 36 };

typedef struct fit {
    int r;                /* dimension of what relaxes */
    double F[6][6];       /* columns */
    double inverse[6][6]; /* F^+, rows */
    double lo, hi;        /* log of the times that matter */
    double t[SAMPLES], w2[SAMPLES];
    double *Y;         /* [SAMPLES][TENSOR] */
    double y[SAMPLES]; /* its trace */
    double norm2;      /* of y */
    int nterms;
    double *u;     /* [nterms] log times, the state of the search */
    double *e;     /* [nterms][SAMPLES] */
    double *G, *L; /* [nterms^2] */
    double *B, *X; /* [nterms][TENSOR] */
    double *b;     /* [nterms] */
} fit;

static void fit_free(fit *f)
{
    free(f->Y);
    free(f->u);
    free(f->e);
    free(f->G);
    free(f->L);
    free(f->B);
    free(f->X);
    free(f->b);
}

/* y = a c a^T, rows of a are `rows` */
static void congruence(int rows, int n, double a[6][6], double c[6][6], double y[6][6])
{
    double ac[6][6] = {{0}};
    memset(y, 0, TENSOR * sizeof(double));
    for (int i = 0; i < rows; i++)
        for (int j = 0; j < n; j++)
            for (int k = 0; k < n; k++)
                ac[i][j] += a[i][k] * c[k][j];
    for (int i = 0; i < rows; i++)
        for (int j = 0; j < rows; j++)
            for (int k = 0; k < n; k++)
                y[i][j] += ac[i][k] * a[j][k];
}

/* F and F^+ from the eigenvectors of R(0). */
static void normalise(fit *f, const ph_prony *p)
{
    const int n = p->equilibrium.n;
    double a[6][6] = {{0}}, v[6][6], most = 0;
    for (int m = 0; m < p->nterms; m++)
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++)
                a[i][j] += p->term[m].stiffness.m[i][j];
    ph_i_jacobi(n, 6, &a[0][0], &v[0][0]);
    for (int k = 0; k < n; k++)
        most = fmax(most, a[k][k]);
    for (int k = 0; k < n; k++) {
        if (!(a[k][k] > PH_I_NOTHING * most)) continue;
        for (int i = 0; i < n; i++) {
            f->F[i][f->r] = sqrt(a[k][k]) * v[i][k];
            f->inverse[f->r][i] = v[i][k] / sqrt(a[k][k]);
        }
        f->r++;
    }
}

static double trace(int r, const double *y)
{
    double sum = 0;
    for (int i = 0; i < r; i++)
        sum += y[6 * i + i];
    return sum;
}

/* Sample times, weights and what is to be met. */
static ph_status sample(fit *f, const ph_prony *p, ph_error *err)
{
    ph_status st = PH_OK;
    const int n = p->equilibrium.n;
    PH_ALLOC(f->Y, SAMPLES * TENSOR, "samples of a series");
    f->lo = HUGE_VAL, f->hi = -HUGE_VAL;
    for (int m = 0; m < p->nterms; m++) {
        double y[6][6], c[6][6];
        memcpy(c, p->term[m].stiffness.m, sizeof c);
        congruence(f->r, n, f->inverse, c, y);
        if (trace(f->r, &y[0][0]) < 1e-7) continue;
        f->lo = fmin(f->lo, log(p->term[m].time));
        f->hi = fmax(f->hi, log(p->term[m].time));
    }
    ph_sym4 now = ph_prony_instantaneous(p);
    for (int k = 0; k < SAMPLES; k++) {
        double u = f->lo - log(100) + (f->hi - f->lo + log(3000)) * k / (SAMPLES - 1.0);
        f->t[k] = k ? exp(u) : 0;
        ph_sym4 c = ph_prony_at_time(p, f->t[k]), y;
        double scaled[6][6];
        ph_sym4 whole = ph_sym4_combine(1, &c, 1e-3, &now);
        congruence(f->r, n, f->inverse, whole.m, scaled);
        double size = trace(f->r, &scaled[0][0]) / f->r;
        y = ph_sym4_combine(1, &c, -1, &p->equilibrium);
        congruence(f->r, n, f->inverse, y.m, scaled);
        memcpy(&f->Y[k * TENSOR], scaled, sizeof scaled);
        f->w2[k] = (k ? 1 : 10) / (size * size);
        f->y[k] = trace(f->r, &scaled[0][0]);
        f->norm2 += f->w2[k] * f->y[k] * f->y[k];
    }
out:
    return st;
}

/* B of the times exp(f->u). */
static void right_hand_side(fit *f)
{
    memset(f->B, 0, (size_t)f->nterms * TENSOR * sizeof *f->B);
    for (int j = 0; j < f->nterms; j++)
        for (int k = 0; k < SAMPLES; k++)
            for (int i = 0; i < TENSOR; i++)
                f->B[j * TENSOR + i] +=
                    f->w2[k] * f->e[j * SAMPLES + k] * f->Y[k * TENSOR + i];
}

/* Nearest positive semidefinite tensor; true where it was one. */
static bool project(int r, double *x)
{
    double a[6][6], v[6][6];
    bool good = true;
    memcpy(a, x, sizeof a);
    ph_i_jacobi(r, 6, &a[0][0], &v[0][0]);
    for (int k = 0; k < r; k++)
        good &= a[k][k] >= 0;
    if (good) return true;
    memset(x, 0, TENSOR * sizeof *x);
    for (int k = 0; k < r; k++)
        for (int i = 0; a[k][k] > 0 && i < r; i++)
            for (int j = 0; j < r; j++)
                x[6 * i + j] += a[k][k] * v[i][k] * v[j][k];
    return false;
}

/* X = G^-1 B by Cholesky; a pivot that has lost its digits leaves its term out. */
static void solve_free(fit *f)
{
    const int N = f->nterms;
    memcpy(f->L, f->G, (size_t)N * N * sizeof *f->L);
    memcpy(f->X, f->B, (size_t)N * TENSOR * sizeof *f->X);
    for (int j = 0; j < N; j++) {
        for (int i = j; i < N; i++)
            for (int k = 0; k < j; k++)
                f->L[i * N + j] -= f->L[i * N + k] * f->L[j * N + k];
        double pivot = f->L[j * N + j];
        bool lost = !(pivot > 1e-13 * f->G[j * N + j]);
        for (int i = j; i < N; i++)
            f->L[i * N + j] = lost ? 0 : f->L[i * N + j] / sqrt(pivot);
        for (int c = 0; c < TENSOR; c++) {
            double x = f->X[j * TENSOR + c];
            for (int k = 0; k < j; k++)
                x -= f->L[j * N + k] * f->X[k * TENSOR + c];
            f->X[j * TENSOR + c] = lost ? 0 : x / f->L[j * N + j];
        }
    }
    for (int j = N - 1; j >= 0; j--)
        for (int c = 0; c < TENSOR; c++) {
            double x = f->X[j * TENSOR + c];
            for (int i = j + 1; i < N; i++)
                x -= f->L[i * N + j] * f->X[i * TENSOR + c];
            f->X[j * TENSOR + c] = f->L[j * N + j] > 0 ? x / f->L[j * N + j] : 0;
        }
}

/* One block after the other, each the exact minimum over its cone. */
static void descend(fit *f, int sweeps)
{
    const int N = f->nterms;
    for (int sweep = 0; sweep < sweeps; sweep++) {
        double moved = 0;
        for (int j = 0; j < N; j++) {
            double x[TENSOR];
            for (int c = 0; c < TENSOR; c++) {
                x[c] = f->B[j * TENSOR + c];
                for (int i = 0; i < N; i++)
                    if (i != j) x[c] -= f->G[j * N + i] * f->X[i * TENSOR + c];
                x[c] /= f->G[j * N + j];
            }
            project(f->r, x);
            for (int c = 0; c < TENSOR; c++)
                moved = fmax(moved, fabs(x[c] - f->X[j * TENSOR + c]));
            memcpy(&f->X[j * TENSOR], x, sizeof x);
        }
        if (moved < 1e-12) break;
    }
}

/* X at the times f->u. */
static void fit_tensors(fit *f)
{
    enum { SWEEPS = 400 };
    bool good = true;
    solve_free(f);
    for (int j = 0; j < f->nterms; j++)
        good &= project(f->r, &f->X[j * TENSOR]);
    if (!good) descend(f, SWEEPS);
}

/* exp(-t / T_j) and what of G and of the trace's right-hand side hangs on it. */
static void place(fit *f, int j, double u)
{
    const int N = f->nterms;
    double *e = &f->e[j * SAMPLES], rate = exp(-u);
    f->u[j] = u;
    f->b[j] = 0;
    for (int k = 0; k < SAMPLES; k++) {
        e[k] = exp(-f->t[k] * rate);
        f->b[j] += f->w2[k] * e[k] * f->y[k];
    }
    for (int i = 0; i < N; i++) {
        double sum = 0;
        for (int k = 0; k < SAMPLES; k++)
            sum += f->w2[k] * e[k] * f->e[i * SAMPLES + k];
        f->G[j * N + i] = f->G[i * N + j] = sum;
    }
}

/* Least squares of the trace with coefficients x >= 0, by coordinates. */
static double trace_objective(const fit *f, double *x)
{
    enum { SWEEPS = 200 };
    const int N = f->nterms;
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
        double moved = 0;
        for (int j = 0; j < N; j++) {
            double g = f->b[j];
            for (int i = 0; i < N; i++)
                g -= f->G[j * N + i] * x[i];
            double now = fmax(0, x[j] + g / f->G[j * N + j]);
            moved = fmax(moved, fabs(now - x[j]));
            x[j] = now;
        }
        if (moved < 1e-9 * f->r) break;
    }
    double sum = f->norm2;
    for (int j = 0; j < N; j++) {
        double gx = 0;
        for (int i = 0; i < N; i++)
            gx += f->G[j * N + i] * x[i];
        sum += x[j] * (gx - 2 * f->b[j]);
    }
    return sum;
}

/* Moves one log time at a time by +-step while the objective falls; halves the step. */
static void search(fit *f)
{
    enum { ROUNDS = 60 };
    const int N = f->nterms;
    double *x = f->X, *tried = f->X + N; /* not in use yet */
    double step = N > 1 ? (f->hi - f->lo) / (N - 1) / 3 : 0.5;
    double least = trace_objective(f, x);
    for (int round = 0; round < ROUNDS && step > 0.01; round++) {
        bool better = false;
        for (int j = 0; j < N; j++)
            for (int side = -1; side <= 1; side += 2) {
                double old = f->u[j], now = old + side * step;
                bool apart = (j == 0 || now > f->u[j - 1] + 0.05) &&
                             (j == N - 1 || now < f->u[j + 1] - 0.05);
                if (!apart) continue;
                place(f, j, now);
                memcpy(tried, x, (size_t)N * sizeof *x);
                double value = trace_objective(f, tried);
                if (value < least * (1 - 1e-6)) {
                    least = value, better = true;
                    memcpy(x, tried, (size_t)N * sizeof *x);
                } else {
                    place(f, j, old);
                }
            }
        if (!better) step /= 2;
    }
}

static ph_status allocate(fit *f, int nterms, ph_error *err)
{
    ph_status st = PH_OK;
    const size_t N = (size_t)nterms;
    f->nterms = nterms;
    PH_ALLOC(f->u, N, "a compressed series");
    PH_ALLOC(f->e, N * SAMPLES, "a compressed series");
    PH_ALLOC(f->G, N * N, "a compressed series");
    PH_ALLOC(f->b, N, "a compressed series");
    PH_ALLOC(f->L, N * N, "a compressed series");
    PH_ALLOC(f->B, N * TENSOR, "a compressed series");
    PH_ALLOC(f->X, N * TENSOR, "a compressed series");
    for (int j = 0; j < nterms; j++)
        f->u[j] = nterms == 1 ? (f->lo + f->hi) / 2
                              : f->lo + (f->hi - f->lo) * j / (nterms - 1);
    for (int j = 0; j < nterms; j++)
        place(f, j, f->u[j]);
out:
    return st;
}

/* C_j = F R^-T X_j R^-1 F^T with R^T R = sum X. */
static ph_status assemble(fit *f, const ph_prony *p, ph_prony **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_prony_term *term = NULL;
    const int n = p->equilibrium.n;
    double sum[6][6] = {{0}}, R[6][6];
    int count = 0;
    PH_ALLOC(term, f->nterms, "a compressed series");
    for (int j = 0; j < f->nterms; j++)
        for (int c = 0; c < TENSOR; c++)
            sum[c / 6][c % 6] += f->X[j * TENSOR + c];
    PH_CHECK(ph_i_factor(f->r, sum, R), PH_ENOCONV,
             "%d terms cannot have the instantaneous tensor of the series", f->nterms);
    for (int j = 0; j < f->nterms; j++) {
        double x[6][6];
        memcpy(x, &f->X[j * TENSOR], sizeof x);
        if (trace(f->r, &x[0][0]) < 1e-13) continue;
        ph_i_both_sides(f->r, R, x);
        term[count].time = exp(f->u[j]);
        term[count].stiffness.n = n;
        congruence(n, f->r, f->F, x, term[count].stiffness.m);
        for (int a = 0; a < n; a++)
            for (int b = 0; b < a; b++)
                term[count].stiffness.m[a][b] = term[count].stiffness.m[b][a];
        count++;
    }
    PH_TRY(ph_prony_new(&p->equilibrium, count, term, out, err));
out:
    free(term);
    return st;
}

static ph_status compress_to(const ph_prony *p, int nterms, ph_prony **out, double *error,
                             ph_error *err)
{
    ph_status st = PH_OK;
    fit f = {0};
    if (nterms >= p->nterms) {
        *error = 0;
        return ph_prony_copy(p, out, err);
    }
    normalise(&f, p);
    PH_TRY(sample(&f, p, err));
    PH_TRY(allocate(&f, nterms, err));
    search(&f);
    right_hand_side(&f);
    fit_tensors(&f);
    PH_TRY(assemble(&f, p, out, err));
    *error = ph_prony_difference(*out, p);
out:
    fit_free(&f);
    return st;
}

ph_status ph_prony_compress(const ph_prony *p, int nterms, double tolerance,
                            ph_prony **out, double *error, ph_error *err)
{
    PH_GIVEN(p && out);
    ph_status st = PH_OK;
    *out = NULL;
    PH_CHECK(nterms >= 0, PH_EINVAL, "terms to compress to must be >= 1, got %d", nterms);
    PH_CHECK(nterms > 0 || (tolerance > 0 && tolerance < 1), PH_EINVAL,
             "the error to compress to must be in (0, 1), got %g", tolerance);
    if (nterms > 0) return compress_to(p, nterms, out, error, err);
    for (int n = 1;; n++) {
        PH_TRY(compress_to(p, n, out, error, err));
        if (*error <= tolerance) break;
        ph_prony_free(out);
    }
out:
    return st;
}

/* Largest |x.(a - b).x| / x.(b + floor).x */
static double worst_ratio(const ph_sym4 *a, const ph_sym4 *b, const ph_sym4 *floor_)
{
    const int n = a->n;
    double d[6][6], s[6][6], R[6][6], worst = 0;
    ph_sym4 base = ph_sym4_combine(1, b, 1, floor_), gap = ph_sym4_combine(1, a, -1, b);
    memcpy(d, base.m, sizeof d);
    memcpy(s, gap.m, sizeof s);
    double size = ph_sym4_norm(&base);
    for (int i = 0; i < n; i++)
        d[i][i] += 1e-12 * size;
    if (!ph_i_factor(n, d, R)) return HUGE_VAL;
    ph_i_both_sides(n, R, s);
    ph_i_jacobi(n, 6, &s[0][0], NULL);
    for (int i = 0; i < n; i++)
        worst = fmax(worst, fabs(s[i][i]));
    return worst;
}

double ph_prony_difference(const ph_prony *p, const ph_prony *reference)
{
    if (!p || !reference) return NAN;
    enum { POINTS = 600 };
    ph_sym4 now = ph_prony_instantaneous(reference), zero = {.n = now.n};
    ph_sym4 floor_ = ph_sym4_combine(1e-3, &now, 0, &zero);
    double lo = HUGE_VAL, hi = 0, worst = 0;
    for (int which = 0; which < 2; which++) {
        const ph_prony *q = which ? reference : p;
        if (q->nterms == 0) continue;
        lo = fmin(lo, q->term[0].time);
        hi = fmax(hi, q->term[q->nterms - 1].time);
    }
    if (hi == 0) lo = hi = 1;
    for (int k = -2; k < POINTS; k++) {
        double u = (double)k / (POINTS - 1);
        double t = k == -2   ? 0
                   : k == -1 ? HUGE_VAL
                             : exp(log(lo * 1e-3) + u * log(hi / lo * 5e4));
        ph_sym4 a = ph_prony_at_time(p, t), b = ph_prony_at_time(reference, t);
        worst = fmax(worst, worst_ratio(&a, &b, &floor_));
    }
    return worst;
}
