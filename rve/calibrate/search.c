/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From a scan of the whole range to the local minima. */
#include "calibrate/calibrate.h"

#include <math.h>
#include <string.h>

enum { LINE = 11, CLOUD = 8, MOST_STARTS = PH_FIT_MINIMA };

static double square(int n, const double *f)
{
    double sum = 0;
    for (int i = 0; i < n; i++)
        sum += f[i] * f[i];
    return isfinite(sum) ? sum : (double)INFINITY;
}

/* Radical inverse of i in base b: coordinates of a Halton sequence. */
static double halton(int i, int b)
{
    double f = 1, x = 0;
    for (; i > 0; i /= b) {
        f /= b;
        x += f * (i % b);
    }
    return x;
}

/* The start, then equal steps (one unknown) or a Halton sequence. */
static int scan_points(const ph_fit_problem *p, double (*u)[K])
{
    static const int base[K] = {2, 3, 5, 7, 11, 13, 17, 19};
    int k = p->nunknowns, m = k == 1 ? LINE : CLOUD * k;
    for (int j = 0; j < k; j++)
        u[0][j] = isnan(p->unknown[j].start)
                      ? 0.5
                      : ph_i_unknown_place(&p->unknown[j], p->unknown[j].start);
    for (int i = 0; i < m; i++)
        for (int j = 0; j < k; j++)
            u[i + 1][j] = k == 1 ? (double)i / (m - 1) : halton(i + 1, base[j]);
    return m + 1;
}

static double distance(int k, const double a[K], const double b[K])
{
    double d = 0;
    for (int j = 0; j < k; j++)
        d = fmax(d, fabs(a[j] - b[j]));
    return d;
}

/* May a local search from i find what none from a better point does? On a line: it is a
 * local minimum of the scan; else: far from every start so far. */
static bool promising(int k, int m, double (*u)[K], const double *chi2, int i,
                      const int *start, int nstarts)
{
    if (!isfinite(chi2[i])) return false;
    if (k == 1) {
        for (int s = 1; s < m; s++)
            if (s != i && distance(1, u[s], u[i]) < 1.01 / (LINE - 1) &&
                chi2[s] < chi2[i])
                return false;
        return true;
    }
    for (int s = 0; s < nstarts; s++)
        if (distance(k, u[start[s]], u[i]) < 0.2) return false;
    return true;
}

/* Indices of the points to start from; the user's own first. */
static int choose(int k, int m, double (*u)[K], const double *chi2, int most, int *start)
{
    int n = 0;
    if (isfinite(chi2[0])) start[n++] = 0;
    for (bool more = true; more && n < most;) {
        int best = -1;
        for (int i = 1; i < m; i++) {
            bool taken = false;
            for (int s = 0; s < n; s++)
                taken |= start[s] == i;
            if (!taken && promising(k, m, u, chi2, i, start, n) &&
                (best < 0 || chi2[i] < chi2[best]))
                best = i;
        }
        more = best >= 0;
        if (more) start[n++] = best;
    }
    return n;
}

/* One minimum or two? Two if the misfit rises between them. */
static ph_status apart(ph_i_fit *c, const double a[K], double chi2_a, const double b[K],
                       double chi2_b, bool *yes, ph_error *err)
{
    ph_status st = PH_OK;
    double middle[1][K] = {{0}}, *f = NULL;
    *yes = false;
    if (distance(c->problem->nunknowns, a, b) < 1e-2) goto out;
    for (int j = 0; j < c->problem->nunknowns; j++)
        middle[0][j] = 0.5 * (a[j] + b[j]);
    PH_ALLOC(f, c->problem->nmeasurements, "a fit");
    PH_TRY(c->residuals.eval(c->residuals.user, 1, middle[0], f, err));
    double between = square(c->problem->nmeasurements, f), higher = fmax(chi2_a, chi2_b);
    double noise = c->sigma_known ? 1e-3 : 1e-3 * higher;
    *yes = between > higher + noise;
out:
    free(f);
    return st;
}

/* Keep a minimum unless it is one of those that are there; the best comes first. Of two
 * places in a flat valley the one found first stays: that from the user's start. */
static ph_status keep(ph_i_fit *c, const double u[K], double chi2, ph_error *err)
{
    ph_status st = PH_OK;
    int at = 0;
    for (int i = 0; i < c->nminima; i++) {
        bool two;
        PH_TRY(apart(c, c->minimum[i], c->minimum_chi2[i], u, chi2, &two, err));
        if (two) continue;
        if (chi2 >= c->minimum_chi2[i] * (1 - 1e-6)) goto out;
        c->nminima--;
        memmove(&c->minimum[i], &c->minimum[i + 1],
                (size_t)(c->nminima - i) * sizeof c->minimum[0]);
        memmove(&c->minimum_chi2[i], &c->minimum_chi2[i + 1],
                (size_t)(c->nminima - i) * sizeof c->minimum_chi2[0]);
        i--;
    }
    if (c->nminima == PH_FIT_MINIMA) c->nminima--;
    while (at < c->nminima && c->minimum_chi2[at] <= chi2)
        at++;
    memmove(&c->minimum[at + 1], &c->minimum[at],
            (size_t)(c->nminima - at) * sizeof c->minimum[0]);
    memmove(&c->minimum_chi2[at + 1], &c->minimum_chi2[at],
            (size_t)(c->nminima - at) * sizeof c->minimum_chi2[0]);
    memcpy(c->minimum[at], u, sizeof c->minimum[at]);
    c->minimum_chi2[at] = chi2;
    c->nminima++;
out:
    return st;
}

ph_status ph_i_descend(ph_i_fit *c, double u[K], double *chi2, ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_search how = ph_i_search_of(c);
    bool converged;
    PH_TRY(ph_i_minimise(&c->residuals, &how, u, chi2, &converged, err));
    if (!converged)
        ph_i_fit_note(c->out, "a local search was stopped after %d steps",
                      how.iterations);
out:
    return st;
}

ph_status ph_i_search_minima(ph_i_fit *c, ph_error *err)
{
    ph_status st = PH_OK;
    int k = c->problem->nunknowns, n = c->problem->nmeasurements, start[MOST_STARTS];
    double(*u)[K] = NULL, *f = NULL, *chi2 = NULL;
    PH_ALLOC(u, LINE + CLOUD * K + 1, "a scan");
    int m = scan_points(c->problem, u);
    PH_ALLOC(f, (size_t)m * n, "a scan");
    PH_ALLOC(chi2, m, "a scan");
    PH_TRY(c->residuals.eval(c->residuals.user, m, u[0], f, err));
    for (int i = 0; i < m; i++)
        chi2[i] = square(n, f + (size_t)i * n);
    int most = c->params.starts < MOST_STARTS ? c->params.starts : MOST_STARTS;
    int nstarts = choose(k, m, u, chi2, most, start);
    PH_CHECK(
        nstarts > 0, PH_ENOCONV,
        "the model fails at the start and at all %d values of the unknowns that were "
        "tried: %s",
        m - 1, c->samples.last_failure.msg);
    for (int s = 0; s < nstarts; s++) {
        double at[K], least;
        memcpy(at, u[start[s]], sizeof at);
        PH_TRY(ph_i_descend(c, at, &least, err));
        if (isfinite(least)) PH_TRY(keep(c, at, least, err));
    }
    PH_CHECK(c->nminima > 0, PH_ENOCONV, "no local search found a minimum: %s",
             c->samples.last_failure.msg);
out:
    free(u);
    free(f);
    free(chi2);
    return st;
}
