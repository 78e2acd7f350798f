/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From the state of a calibration to what people read. */
#include "calibrate/calibrate.h"

#include <gsl/gsl_cdf.h>

#include <math.h>
#include <string.h>

static const double AT_BOUND = 1e-9; /* of the range */

static void report_unknown(ph_i_fit *c, int j)
{
    const ph_fit_unknown *x = &c->problem->unknown[j];
    const ph_i_spread *e = &c->spread;
    ph_fit_estimate *o = &c->out->unknown[j];
    double u = c->best[j], slope = ph_i_unknown_slope(x, u);
    double data = e->data[j][j], sampling = e->sampling[j][j];
    double q = ph_i_spread_quantile(e, c->problem->nmeasurements, c->sigma_known, j,
                                    &o->freedom);
    bool flat = e->unknown[j] == PH_FIT_FLAT;
    double total = sqrt((isnan(data) ? 0 : data) + sampling);
    o->value = ph_i_unknown_value(x, u);
    o->knowledge = e->unknown[j];
    o->error_data = flat ? (double)NAN : slope * sqrt(data);
    o->error_sampling = flat ? (double)NAN : slope * sqrt(sampling);
    o->standard_error = flat ? (double)NAN : slope * total;
    for (int side = 0; side < 2; side++) {
        double end = flat ? side : u + (side ? q : -q) * total;
        o->open[side] = side ? end >= 1 : end <= 0;
        o->local[side] = ph_i_unknown_value(x, end);
        o->profile[side] = NAN;
        o->posterior_quantile[side] = NAN;
    }
    o->posterior_quantile[2] = o->posterior_mean = o->posterior_std = o->autocorrelation =
        NAN;
    double pull = 0; /* of chi2 towards larger u */
    for (int i = 0; i < c->problem->nmeasurements; i++)
        pull -= c->J[i * K + j] * c->f[i];
    o->at_bound =
        !flat && ((u <= AT_BOUND && pull < 0) || (u >= 1 - AT_BOUND && pull > 0));
}

static void report_correlation(ph_i_fit *c)
{
    int k = c->problem->nunknowns;
    const ph_i_spread *e = &c->spread;
    for (int i = 0; i < k; i++)
        for (int j = 0; j < k; j++) {
            bool flat = e->unknown[i] == PH_FIT_FLAT || e->unknown[j] == PH_FIT_FLAT;
            double scale = isnan(e->scale) ? 0 : e->scale;
            double cov = scale * e->inverse[i][j] + e->sampling[i][j];
            double vi = scale * e->inverse[i][i] + e->sampling[i][i];
            double vj = scale * e->inverse[j][j] + e->sampling[j][j];
            c->out->correlation[i * k + j] = flat               ? (double)NAN
                                             : i == j           ? 1
                                             : vi > 0 && vj > 0 ? cov / sqrt(vi * vj)
                                                                : (double)NAN;
        }
}

static void report_directions(ph_i_fit *c)
{
    int k = c->problem->nunknowns;
    for (int a = 0; a < k; a++) {
        ph_fit_direction *d = &c->out->direction[a];
        d->eigenvalue = c->spread.eigenvalue[a];
        memcpy(d->component, c->spread.vector[a], sizeof d->component);
        d->standard_error =
            d->eigenvalue > 0 ? sqrt(c->spread.scale / d->eigenvalue) : (double)INFINITY;
        d->knowledge = c->spread.direction[a];
    }
}

/* Mean and standard error of the model at the best, for measurement i. */
static void report_point(ph_i_fit *c, int i)
{
    const ph_i_samples *s = &c->samples;
    const ph_fit_measurement *m = &c->problem->measurement[i];
    const ph_i_set *set = ph_i_samples_at(s, c->best);
    ph_fit_point *o = &c->out->point[i];
    double unit = c->sigma_known ? 1 : sqrt(c->spread.scale);
    o->measured = m->value;
    o->sigma = s->sigma[i] * (unit > 0 ? unit : 1);
    o->model = m->value + c->f[i] * s->sigma[i];
    o->realisations = ph_i_samples_count(s, m->point, &o->failed);
    o->residual = (o->model - o->measured) / o->sigma;
    double square = 0;
    for (int r = 0; r < s->n[m->point]; r++)
        if (ph_i_samples_uses(s, m->point, r)) {
            double d = ph_i_samples_answer(s, set, m->point, r, m->output) - o->model;
            square += d * d;
        }
    int n = o->realisations;
    o->model_error = n > 1                ? sqrt(square / (n - 1) / n)
                     : c->problem->random ? (double)NAN
                                          : 0;
}

static void report_minima(ph_i_fit *c)
{
    double rise = 0;
    for (int j = 0; j < c->problem->nunknowns; j++)
        rise = fmax(rise, ph_i_rise(c, j));
    c->out->nminima = c->nminima;
    for (int i = 0; i < c->nminima; i++) {
        ph_fit_minimum *m = &c->out->minimum[i];
        for (int j = 0; j < c->problem->nunknowns; j++)
            m->value[j] = ph_i_unknown_value(&c->problem->unknown[j], c->minimum[i][j]);
        m->misfit = c->minimum_chi2[i];
        m->as_good = m->misfit <= c->chi2 + rise;
    }
}

/* Probability of a misfit at least as large by chance. The residuals M (e + s), M = I - H the
 * projection of the fit, have covariance M (I + S) M: chi2 is a chi2 with as much mean and
 * variance, exact where S = 0. */
static ph_status find_probability(ph_i_fit *c, ph_error *err)
{
    ph_status st = PH_OK;
    int n = c->problem->nmeasurements, k = c->problem->nunknowns;
    double *A = NULL, mean = 0, variance = 0;
    c->out->probability = NAN;
    if (!c->sigma_known || c->out->freedom < 1) goto out;
    PH_ALLOC(A, 2 * (size_t)n * n, "a test");
    double *M = A + (size_t)n * n;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            M[i * n + j] = i == j;
            for (int a = 0; a < k; a++)
                for (int b = 0; b < k; b++)
                    M[i * n + j] -=
                        c->J[i * K + a] * c->spread.inverse[a][b] * c->J[j * K + b];
        }
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            A[i * n + j] = M[i * n + j];
            for (int l = 0; l < n; l++)
                A[i * n + j] += M[i * n + l] * c->S[l * n + j];
        }
    for (int i = 0; i < n; i++) {
        mean += A[i * n + i];
        for (int j = 0; j < n; j++)
            variance += 2 * A[i * n + j] * A[j * n + i];
    }
    double unit = variance / (2 * mean);
    c->out->probability = gsl_cdf_chisq_Q(c->chi2 / unit, mean / unit);
out:
    free(A);
    return st;
}

ph_status ph_i_report(ph_i_fit *c, ph_error *err)
{
    ph_status st = PH_OK;
    ph_fit *o = c->out;
    int n = c->problem->nmeasurements;
    double square = 0;
    o->misfit = c->chi2;
    o->freedom = n - c->spread.known;
    o->sigma_scale = c->sigma_known ? 1 : sqrt(c->spread.scale);
    PH_TRY(find_probability(c, err));
    o->surrogate_error = NAN;
    for (int j = 0; j < c->problem->nunknowns; j++)
        report_unknown(c, j);
    report_correlation(c);
    report_directions(c);
    for (int i = 0; i < n; i++) {
        report_point(c, i);
        square += o->point[i].residual * o->point[i].residual;
    }
    o->residual_rms = sqrt(square / n);
    double q = o->freedom > 0 && !c->sigma_known ? gsl_cdf_tdist_Pinv(0.975, o->freedom)
                                                 : gsl_cdf_ugaussian_Pinv(0.975);
    o->misfit_limit = q * q * c->spread.scale;
    report_minima(c);
out:
    return st;
}

static void note_unknown(ph_i_fit *c, int j)
{
    const ph_fit_unknown *x = &c->problem->unknown[j];
    const ph_fit_estimate *o = &c->out->unknown[j];
    bool whole = o->open[0] && o->open[1];
    if (o->knowledge == PH_FIT_FLAT && whole)
        ph_i_fit_note(c->out,
                      "%s is not identifiable: the data do not tell its values from "
                      "%g to %g apart",
                      x->name, o->interval[0], o->interval[1]);
    else if (whole)
        ph_i_fit_note(c->out,
                      "%s is hardly identifiable: its 95 %% interval is the whole range",
                      x->name);
    else if (o->at_bound)
        ph_i_fit_note(c->out,
                      "%s lies at its bound %g and would go beyond: widen the range, or "
                      "doubt the model",
                      x->name, o->value);
    else if (o->open[0] || o->open[1])
        ph_i_fit_note(c->out, "%s: the interval ends at the bound %g, not in the data",
                      x->name, o->interval[o->open[1]]);
    if (o->several)
        ph_i_fit_note(c->out,
                      "%s: the profile has more than one interval below the limit",
                      x->name);
}

static void note_points(ph_i_fit *c)
{
    ph_fit *o = c->out;
    double limit = gsl_cdf_ugaussian_Pinv(0.9995);
    for (int i = 0; i < o->nmeasurements; i++) {
        ph_fit_point *p = &o->point[i];
        double free = 1 - p->leverage;
        p->outlier =
            o->freedom > 0 && free > 1e-9 && fabs(p->residual) / sqrt(free) > limit;
        if (p->outlier)
            ph_i_fit_note(o,
                          "measurement %d (%g) lies %.1f sigma from the fit: an outlier?",
                          i + 1, p->measured, fabs(p->residual) / sqrt(free));
        if (p->failed)
            ph_i_fit_note(o,
                          "data point %d: %d of %d realisations failed and are left out: "
                          "%.120s",
                          c->problem->measurement[i].point + 1, p->failed,
                          p->realisations + p->failed, c->samples.last_failure.msg);
    }
}

static void note_correlation(ph_i_fit *c)
{
    int k = c->problem->nunknowns;
    for (int i = 0; i < k; i++)
        for (int j = 0; j < i; j++)
            if (fabs(c->out->correlation[i * k + j]) > 0.95)
                ph_i_fit_note(c->out,
                              "%s and %s are correlated (%.3f): the data know a "
                              "combination of them far better than each",
                              c->problem->unknown[j].name, c->problem->unknown[i].name,
                              c->out->correlation[i * k + j]);
}

static void note_minima(ph_i_fit *c)
{
    for (int i = 1; i < c->nminima; i++)
        if (c->out->minimum[i].as_good)
            ph_i_fit_note(c->out,
                          "not unique: %s = %.4g fits as well (misfit %.3g against "
                          "%.3g)",
                          c->problem->unknown[0].name, c->out->minimum[i].value[0],
                          c->out->minimum[i].misfit, c->chi2);
}

void ph_i_conclude(ph_i_fit *c)
{
    ph_fit *o = c->out;
    for (int j = 0; j < o->nunknowns; j++) {
        ph_fit_estimate *x = &o->unknown[j];
        bool profile = !isnan(x->profile[0]);
        for (int side = 0; side < 2; side++)
            x->interval[side] = profile ? x->profile[side] : x->local[side];
        /* Flat at the best value, yet not everywhere. */
        if (x->knowledge == PH_FIT_FLAT && profile && !(x->open[0] && x->open[1]))
            x->knowledge = PH_FIT_WEAK;
        note_unknown(c, j);
    }
    note_correlation(c);
    note_minima(c);
    note_points(c);
    if (o->probability < 0.01)
        ph_i_fit_note(
            o,
            "the misfit %.4g is too large for %d degrees of freedom (probability "
            "%.2g): the model cannot follow the data, or sigma is too small",
            o->misfit, o->freedom, o->probability);
    if (o->freedom == 0)
        ph_i_fit_note(o, "as many measurements as unknowns: the misfit checks nothing");
    o->evaluations = c->samples.nsets;
    o->solves = c->samples.solves;
    o->failures = c->samples.failures;
}
