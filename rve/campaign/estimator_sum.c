/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The telescoping sum of a chain of models: fitted coefficients, mean, variance. */
#include "campaign/estimators.h"
#include "core/check.h"

#include <gsl/gsl_cdf.h>

#include <math.h>
#include <string.h>

enum { FOLDS = 8, D = PH_MAX_CONTROLS };

/* Sums over the realisations of one fold for the link from model l to model l + 1. */
typedef struct moments {
    double n, x[D], xx[D][D], y, xy[D], yy;
} moments;

typedef struct work {
    const ph_i_chain *c;
    const ph_model_samples *model[PH_MAX_MODELS];
    int d[PH_MAX_MODELS];            /* numbers of each model of the chain */
    double centre[PH_MAX_MODELS][D]; /* subtracted from the values: cancels in the sum */
    int folds;
    double count[FOLDS][PH_MAX_MODELS]; /* realisations of a fold that have level l */
    double valid[PH_MAX_MODELS];        /* sum of count over the folds */
    double b[FOLDS][PH_MAX_MODELS][D];  /* fitted without the fold */
} work;

static const double *value(const work *w, int l, ptrdiff_t k)
{
    return w->model[l]->value + k * w->d[l];
}

static bool there(const work *w, int l, ptrdiff_t k)
{
    const double *v = value(w, l, k);
    for (int i = 0; i < w->d[l]; i++)
        if (!isfinite(v[i])) return false;
    return true;
}

/* First level of realisation k: from it on every model is there and within `count`. */
static int first_within(const work *w, const ptrdiff_t *count, ptrdiff_t k)
{
    int l = w->c->n;
    while (l > 0 && k < count[l - 1] && there(w, l - 1, k))
        l--;
    return l;
}

static int first_level(const work *w, ptrdiff_t k)
{
    return first_within(w, w->c->count, k);
}

static void centres(work *w)
{
    const ph_i_chain *c = w->c;
    double *n = w->valid;
    for (ptrdiff_t k = 0; k < c->count[c->n - 1]; k++)
        for (int l = first_level(w, k); l < c->n; l++) {
            n[l]++;
            for (int i = 0; i < w->d[l]; i++)
                w->centre[l][i] += (value(w, l, k)[i] - w->centre[l][i]) / n[l];
        }
}

/* Inverse variance, up to a factor, of the finest mean in so many folds; 0: one is empty. */
static double worth_of_folds(const work *w, int folds)
{
    double n[FOLDS] = {0}, sum = 0;
    for (ptrdiff_t k = 0; k < w->c->count[0]; k++)
        n[k % folds] += first_level(w, k) == 0;
    for (int f = 0; f < folds; f++)
        sum += 1 / n[f];
    return folds * folds / sum;
}

/* The number of folds that makes the variance of the finest mean least (folds of one size);
 * of equals the most. */
static bool choose_folds(work *w)
{
    const ph_i_chain *c = w->c;
    bool fits = c->fits && c->n > 1;
    double best = 0;
    for (int n = fits ? FOLDS : 1; n >= (fits ? 2 : 1); n--) {
        double worth = worth_of_folds(w, n);
        if (worth <= best * (1 + 1e-3)) continue;
        best = worth;
        w->folds = n;
    }
    if (best == 0) return false;
    for (ptrdiff_t k = 0; k < c->count[c->n - 1]; k++)
        for (int l = first_level(w, k); l < c->n; l++)
            w->count[k % w->folds][l]++;
    return true;
}

static void add(moments *m, int d, const double *x, const double *cx, double y)
{
    m->n++;
    m->y += y;
    m->yy += y * y;
    for (int i = 0; i < d; i++) {
        double xi = x[i] - cx[i];
        m->x[i] += xi;
        m->xy[i] += xi * y;
        for (int j = 0; j <= i; j++)
            m->xx[i][j] += xi * (x[j] - cx[j]);
    }
}

/* total - part */
static void without(moments *m, const moments *total, const moments *part, int d)
{
    m->n = total->n - part->n;
    m->y = total->y - part->y;
    m->yy = total->yy - part->yy;
    for (int i = 0; i < d; i++) {
        m->x[i] = total->x[i] - part->x[i];
        m->xy[i] = total->xy[i] - part->xy[i];
        for (int j = 0; j <= i; j++)
            m->xx[i][j] = total->xx[i][j] - part->xx[i][j];
    }
}

/* Least squares with a constant: b of y ~ a + b . x by Cholesky; controls that are constant
 * or follow from those before get b = 0. Returns the share of the variance explained. */
static double solve(const moments *m, int d, double *b)
{
    double L[D][D], z[D], syy = m->yy - m->y * m->y / m->n, explained = 0;
    bool used[D];
    for (int i = 0; i < d; i++) {
        double own = m->xx[i][i] - m->x[i] * m->x[i] / m->n, rest = own;
        z[i] = m->xy[i] - m->x[i] * m->y / m->n;
        for (int j = 0; j < i; j++) {
            L[i][j] = 0;
            if (!used[j]) continue;
            double s = m->xx[i][j] - m->x[i] * m->x[j] / m->n;
            for (int k = 0; k < j; k++)
                if (used[k]) s -= L[i][k] * L[j][k];
            L[i][j] = s / L[j][j];
            rest -= L[i][j] * L[i][j];
            z[i] -= L[i][j] * z[j];
        }
        used[i] = rest > 1e-8 * own && rest > 1e-20 * m->xx[i][i];
        L[i][i] = used[i] ? sqrt(rest) : 1;
        z[i] = used[i] ? z[i] / L[i][i] : 0;
        explained += z[i] * z[i];
    }
    for (int i = d - 1; i >= 0; i--) {
        b[i] = z[i];
        for (int j = i + 1; j < d; j++)
            if (used[j]) b[i] -= L[j][i] * b[j];
        b[i] = used[i] ? b[i] / L[i][i] : 0;
    }
    return syy > 0 ? explained / syy : 0;
}

/* b of level l for every fold from the other folds, and what the whole says of the link. */
static ph_status fit(work *w, int l, ph_level_report *report, ph_error *err)
{
    ph_status st = PH_OK;
    int d = w->d[l + 1];
    moments m[FOLDS + 2]; /* of the folds, of all, without one */
    double all[D];
    memset(m, 0, sizeof m);
    moments *total = &m[w->folds], *rest = total + 1;
    for (ptrdiff_t k = 0; k < w->c->count[l]; k++)
        if (first_level(w, k) <= l) {
            double y = value(w, l, k)[0] - w->centre[l][0];
            add(&m[k % w->folds], d, value(w, l + 1, k), w->centre[l + 1], y);
            add(total, d, value(w, l + 1, k), w->centre[l + 1], y);
        }
    report->correlation = sqrt(solve(total, d, all));
    report->coefficient = d > 1 ? d : all[0];
    for (int f = 0; f < w->folds; f++) {
        if (!w->c->fits) {
            w->b[f][l][0] = 1;
            continue;
        }
        without(rest, total, &m[f], d);
        PH_CHECK(rest->n >= d + 2, PH_ESINGULAR,
                 "%g realisations are too few to fit %d coefficients", rest->n, d);
        solve(rest, d, w->b[f][l]);
    }
    if (!w->c->fits) report->coefficient = 1;
out:
    return st;
}

/* B_l (x_l - b_l . x_(l+1)) of realisation k, values less their centres. */
static double term(const work *w, int l, ptrdiff_t k, double B)
{
    int f = (int)(k % w->folds);
    double t = B * (value(w, l, k)[0] - w->centre[l][0]);
    if (l + 1 < w->c->n)
        for (int i = 0; i < w->d[l + 1]; i++)
            t -= B * w->b[f][l][i] * (value(w, l + 1, k)[i] - w->centre[l + 1][i]);
    return t;
}

/* Of the last model with several numbers: B . x. */
static double last_term(const work *w, ptrdiff_t k, double B)
{
    int f = (int)(k % w->folds), l = w->c->n - 1;
    if (w->d[l] == 1) return term(w, l, k, B * (l ? w->b[f][l - 1][0] : 1));
    double t = 0;
    for (int i = 0; i < w->d[l]; i++)
        t += B * w->b[f][l - 1][i] * (value(w, l, k)[i] - w->centre[l][i]);
    return t;
}

/* All terms of realisation k from level `first` on. */
static void terms(const work *w, ptrdiff_t k, int first, double *t)
{
    int f = (int)(k % w->folds), M = w->c->n - 1;
    double B = 1;
    for (int l = 0; l < M; l++) {
        if (l >= first) t[l] = term(w, l, k, B);
        if (l + 1 < M) B *= w->b[f][l][0];
    }
    t[M] = last_term(w, k, B);
}

/* Running mean and sum of squares. */
typedef struct spread {
    double n, mean, m2;
} spread;

static void spread_add(spread *s, double x)
{
    double d = x - s->mean;
    s->n++;
    s->mean += d / s->n;
    s->m2 += d * (x - s->mean);
}

/* What the terms are like, level by level. */
typedef struct scatter {
    spread own[PH_MAX_MODELS]; /* of the terms of the realisations seen */
    spread off[PH_MAX_MODELS]; /* of x_l - x_(l+1) of all */
    spread z[PH_MAX_MODELS];   /* of the contributions of a realisation from level l on */
    double members[PH_MAX_MODELS]; /* realisations whose first level it is */
} scatter;

static void look_at_terms(const work *w, scatter *s)
{
    const ph_i_chain *c = w->c;
    double t[PH_MAX_MODELS] = {0};
    for (ptrdiff_t k = 0; k < c->count[c->n - 1]; k++) {
        int first = first_level(w, k), seen = first_within(w, c->seen, k);
        if (first == c->n) continue;
        s->members[first]++;
        terms(w, k, first, t);
        for (int l = first; l < c->n; l++) {
            if (l >= seen) spread_add(&s->own[l], t[l]);
            if (l + 1 < c->n && w->d[l + 1] == 1)
                spread_add(&s->off[l], value(w, l, k)[0] - value(w, l + 1, k)[0]);
        }
    }
}

/* The sum itself, and the scatter of what one realisation gives to it. Folds weigh alike,
 * whatever their size, for each has its own coefficients; terms are taken from their mean, so
 * that these weights are no scatter. */
static double sum(const work *w, scatter *s)
{
    const ph_i_chain *c = w->c;
    double t[PH_MAX_MODELS] = {0}, mean = 0;
    for (ptrdiff_t k = 0; k < c->count[c->n - 1]; k++) {
        int first = first_level(w, k), seen = first_within(w, c->seen, k);
        double tail = 0;
        if (first == c->n) continue;
        terms(w, k, first, t);
        for (int l = c->n - 1; l >= first; l--) {
            double weight = 1 / (w->folds * w->count[k % w->folds][l]);
            mean += weight * t[l];
            tail += weight * (t[l] - s->own[l].mean);
            if (l >= seen) spread_add(&s->z[l], tail);
        }
    }
    return mean;
}

/* Realisations of the same first level are alike: the variance of the sum is that of
 * independent contributions. */
static ph_status report(const work *w, const scatter *s, ph_mean_estimate *out,
                        ph_error *err)
{
    ph_status st = PH_OK;
    const ph_i_chain *c = w->c;
    double variance = 0, squares = 0;
    for (int l = 0; l < c->n; l++) {
        const spread *own = &s->own[l], *off = &s->off[l];
        double fitted = c->fits && l + 1 < c->n ? w->d[l + 1] : 0;
        ph_level_report *r = &out->level[l];
        r->dof = own->n - 1 - fitted;
        PH_CHECK(r->dof >= 1, PH_ESINGULAR,
                 "level %d of the estimate has only %g realisations that did not fail", l,
                 own->n);
        double part = s->members[l] * s->z[l].m2 / (own->n - 1);
        variance += part;
        squares += part * part / r->dof;
        r->model = c->model[l];
        r->n = c->count[l];
        r->valid = w->valid[l];
        r->cost = w->model[l]->cost;
        r->variance = own->m2 / (own->n - 1);
        bool pair = off->n > 1;
        r->difference = pair ? off->mean : (double)NAN;
        r->difference_error = pair ? sqrt(off->m2 / (off->n - 1) / off->n) : (double)NAN;
    }
    out->standard_error = sqrt(variance);
    out->dof = squares > 0 ? variance * variance / squares : out->level[0].dof;
out:
    return st;
}

ph_status ph_i_chain_sum(const ph_i_chain *chain, const ph_model_samples *models,
                         ph_mean_estimate *out, ph_error *err)
{
    ph_status st = PH_OK;
    work own, *w = &own; /* no memory is asked for: a sum fails for its numbers only */
    scatter s;
    memset(&s, 0, sizeof s);
    memset(out, 0, sizeof *out);
    out->nlevels = chain->n;
    memset(w, 0, sizeof *w);
    w->c = chain;
    for (int l = 0; l < chain->n; l++) {
        w->model[l] = &models[chain->model[l]];
        w->d[l] = w->model[l]->dimension;
    }
    PH_CHECK(choose_folds(w), PH_ESINGULAR,
             "too few of %td realisations did not fail to estimate a mean",
             chain->count[0]);
    centres(w);
    out->level[chain->n - 1].correlation = NAN;
    out->level[chain->n - 1].coefficient = NAN;
    for (int l = 0; l + 1 < chain->n; l++)
        PH_TRY(fit(w, l, &out->level[l], err));
    look_at_terms(w, &s);
    out->mean = w->centre[0][0] + sum(w, &s);
    PH_TRY(report(w, &s, out, err));
out:
    return st;
}

double ph_i_student(double confidence, double dof)
{
    return gsl_cdf_tdist_Pinv(0.5 + 0.5 * confidence, dof);
}
