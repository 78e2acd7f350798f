/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "calibrate/calibrate.h"

#include <gsl/gsl_cdf.h>

#include <math.h>
#include <stdarg.h>
#include <string.h>
#include <time.h>

enum { ROUNDS = 12, PILOT = 4 };

const char *ph_fit_knowledge_text(ph_fit_knowledge k)
{
    static const char *const text[] = {"known", "weak", "flat"};
    return (unsigned)k <= PH_FIT_FLAT ? text[k] : "unknown";
}

void ph_i_fit_note(ph_fit *fit, const char *fmt, ...)
{
    char text[sizeof fit->notes[0]];
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(text, sizeof text, fmt, ap);
    va_end(ap);
    for (int i = 0; i < fit->nnotes; i++)
        if (strcmp(fit->notes[i], text) == 0) return;
    if (fit->nnotes < PH_FIT_NOTES) memcpy(fit->notes[fit->nnotes++], text, sizeof text);
}

void ph_fit_free(ph_fit **fit)
{
    if (!fit || !*fit) return;
    free((*fit)->unknown);
    free((*fit)->correlation);
    free((*fit)->direction);
    free((*fit)->point);
    free((*fit)->sample);
    free(*fit);
    *fit = NULL;
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- what is admissible */

static ph_status check_unknowns(const ph_fit_problem *p, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(p->nunknowns >= 1 && p->nunknowns <= PH_FIT_UNKNOWNS, PH_EINVAL,
             "%d unknowns: must be 1 to %d", p->nunknowns, PH_FIT_UNKNOWNS);
    for (int j = 0; j < p->nunknowns; j++) {
        const ph_fit_unknown *x = &p->unknown[j];
        PH_CHECK(isfinite(x->from) && isfinite(x->to) && x->from < x->to, PH_EINVAL,
                 "unknown '%s': from %g to %g: from must be less than to, both finite",
                 x->name, x->from, x->to);
        PH_CHECK(!x->log || x->from > 0, PH_EINVAL,
                 "unknown '%s': scale log needs from > 0, not %g", x->name, x->from);
        PH_CHECK(isnan(x->start) || (x->start >= x->from && x->start <= x->to), PH_EINVAL,
                 "unknown '%s': start %g lies outside of %g to %g", x->name, x->start,
                 x->from, x->to);
    }
out:
    return st;
}

static ph_status check_measurement(const ph_fit_problem *p, int i, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_fit_measurement *m = &p->measurement[i];
    bool known = !isnan(p->measurement[0].sigma);
    PH_CHECK(m->point >= 0 && m->point < p->npoints && m->output >= 0 &&
                 m->output < p->noutputs,
             PH_EINVAL, "measurement %d: no such point or output", i + 1);
    PH_CHECK(isfinite(m->value), PH_EINVAL, "measurement %d: %g is not admissible", i + 1,
             m->value);
    PH_CHECK(isnan(m->sigma) != known, PH_EINVAL,
             "measurement %d: either all measurements have a sigma or none", i + 1);
    PH_CHECK(!known || (m->sigma > 0 && isfinite(m->sigma)), PH_EINVAL,
             "measurement %d: sigma %g is not admissible: must be > 0", i + 1, m->sigma);
    PH_CHECK(known || m->value != 0, PH_EINVAL,
             "measurement %d is 0: it has no relative error, give a sigma", i + 1);
out:
    return st;
}

static ph_status check_problem(const ph_fit_problem *p, const ph_fit_params *o,
                               ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(p && p->model && p->unknown && p->measurement, PH_EINVAL,
             "a calibration needs a model, unknowns and measurements");
    PH_TRY(check_unknowns(p, err));
    PH_CHECK(p->npoints >= 1 && p->noutputs >= 1 && p->noutputs <= PH_FIT_OUTPUTS &&
                 p->nmeasurements >= 1,
             PH_EINVAL, "no measurements");
    PH_CHECK(p->nmeasurements >= p->nunknowns, PH_EINVAL,
             "%d unknowns and %d measurement%s: there must be at least as many "
             "measurements as unknowns",
             p->nunknowns, p->nmeasurements, p->nmeasurements == 1 ? "" : "s");
    for (int i = 0; i < p->nmeasurements; i++)
        PH_TRY(check_measurement(p, i, err));
    PH_CHECK(o->relative_error > 0 && o->at_least >= 1 && o->at_most >= o->at_least &&
                 o->seconds >= 0 && o->starts >= 1 && o->samples >= 0 &&
                 o->samples <= 10000000,
             PH_EINVAL,
             "the budget of a calibration must be positive numbers, and "
             "at_most no less than at_least");
out:
    return st;
}

static ph_fit_params with_defaults(const ph_fit_params *given, bool random)
{
    ph_fit_params p = given ? *given : (ph_fit_params){.seed = 1};
    if (p.relative_error == 0) p.relative_error = 0.01;
    if (p.at_most == 0) p.at_most = p.at_least > 1000 ? p.at_least : 1000;
    if (p.at_least == 0) p.at_least = p.at_most < 8 ? p.at_most : 8;
    if (p.starts == 0) p.starts = 4;
    if (!random) p.at_least = p.at_most = 1;
    return p;
}

/* ---- the stages */

ph_i_search ph_i_search_of(const ph_i_fit *c)
{
    ph_i_search how = {
        .step = 0.005, .tolerance = 0.01, .scale = c->scale, .iterations = 40};
    for (int j = 0; j < c->problem->nunknowns; j++)
        how.hi[j] = 1;
    return how;
}

static ph_status raise_all(ph_i_fit *c, int to, ph_error *err)
{
    ph_status st = PH_OK;
    int *n = NULL;
    PH_ALLOC(n, c->problem->npoints, "realisations");
    for (int i = 0; i < c->problem->npoints; i++)
        n[i] = to;
    PH_TRY(ph_i_samples_raise(&c->samples, n, err));
out:
    free(n);
    return st;
}

/* All minima again with the realisations of now; the best first. */
static ph_status refit(ph_i_fit *c, ph_error *err)
{
    ph_status st = PH_OK;
    for (int i = 0; i < c->nminima; i++)
        PH_TRY(ph_i_descend(c, c->minimum[i], &c->minimum_chi2[i], err));
    for (int i = 1; i < c->nminima; i++)
        for (int k = i; k > 0 && c->minimum_chi2[k] < c->minimum_chi2[k - 1]; k--) {
            double u[K], chi2 = c->minimum_chi2[k];
            memcpy(u, c->minimum[k], sizeof u);
            memcpy(c->minimum[k], c->minimum[k - 1], sizeof u);
            memcpy(c->minimum[k - 1], u, sizeof u);
            c->minimum_chi2[k] = c->minimum_chi2[k - 1];
            c->minimum_chi2[k - 1] = chi2;
        }
    PH_CHECK(isfinite(c->minimum_chi2[0]), PH_ENOCONV,
             "the model fails at the minimum with more realisations: %s",
             c->samples.last_failure.msg);
out:
    return st;
}

/* Jacobian and errors at the best minimum. */
static ph_status spread(ph_i_fit *c, ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_search how = ph_i_search_of(c);
    bool known;
    memcpy(c->best, c->minimum[0], sizeof c->best);
    c->chi2 = c->minimum_chi2[0];
    PH_TRY(ph_i_jacobian(&c->residuals, &how, c->best, c->f, c->J, &known, err));
    PH_CHECK(known, PH_ENOCONV, "the model fails beside the minimum: %s",
             c->samples.last_failure.msg);
    PH_TRY(ph_i_spread_covariance(&c->samples, c->best, c->S, err));
    PH_TRY(ph_i_spread_find(&c->samples, c->best, c->f, c->J, c->scale, &c->spread,
                            c->part, err));
out:
    return st;
}

/* Sampling standard error that is small enough, in u. */
static void targets(const ph_i_fit *c, double target[K])
{
    for (int j = 0; j < c->problem->nunknowns; j++) {
        const ph_fit_unknown *x = &c->problem->unknown[j];
        double slope = ph_i_unknown_slope(x, c->best[j]);
        double size = fabs(ph_i_unknown_value(x, c->best[j])) / slope;
        double data = sqrt(c->spread.data[j][j]);
        target[j] = fmax(c->params.relative_error * size, isnan(data) ? 0 : data / 3);
        if (c->spread.unknown[j] == PH_FIT_FLAT) target[j] = INFINITY;
        if (target[j] < 1e-12) target[j] = 1e-12;
    }
}

/* Flat at the best is not flat over the range: what do the ends say? */
static ph_status find_bent(ph_i_fit *c, ph_error *err)
{
    ph_status st = PH_OK;
    int n = c->problem->nmeasurements;
    double *f = NULL;
    PH_ALLOC(f, 2 * (size_t)n, "a calibration");
    for (int j = 0; j < c->problem->nunknowns; j++) {
        double u[2][K], unit = c->spread.scale > 0 ? sqrt(c->spread.scale) : 1;
        c->bent[j] = false;
        if (c->spread.unknown[j] != PH_FIT_FLAT) continue;
        for (int side = 0; side < 2; side++) {
            memcpy(u[side], c->best, sizeof u[side]);
            u[side][j] = side;
        }
        PH_TRY(c->residuals.eval(c->residuals.user, 2, u[0], f, err));
        for (int i = 0; i < 2 * n; i++)
            if (fabs(f[i] - c->f[i % n]) > 0.1 * unit) c->bent[j] = true;
    }
out:
    free(f);
    return st;
}

/* Where an unknown is flat at the best only, what is known of it is how far its other values
 * miss the data: every mean must be as sharp as a third of sigma. */
static void sharpen(const ph_i_fit *c, int *n, bool *enough)
{
    const ph_fit_problem *p = c->problem;
    bool any = false;
    for (int j = 0; j < p->nunknowns; j++)
        any |= c->bent[j];
    double limit =
        c->sigma_known ? 1.0 / 9 : c->params.relative_error * c->params.relative_error;
    for (int i = 0; i < p->nmeasurements && any; i++) {
        int point = p->measurement[i].point, has = c->samples.n[point];
        double more = c->S[i * p->nmeasurements + i] / limit;
        if (more <= 1) continue;
        *enough = false;
        int want = (int)fmin(fmin(ceil(1.1 * more * has), 4.0 * has), c->params.at_most);
        if (want > n[point]) n[point] = want;
    }
}

static bool more_than_before(const ph_i_fit *c, const int *n)
{
    for (int i = 0; i < c->problem->npoints; i++)
        if (n[i] > c->samples.n[i]) return true;
    return false;
}

static ph_status rounds(ph_i_fit *c, ph_error *err)
{
    ph_status st = PH_OK;
    int *n = NULL;
    double target[K];
    PH_ALLOC(n, c->problem->npoints, "realisations");
    for (c->out->rounds = 0;; c->out->rounds++) {
        PH_TRY(spread(c, err));
        targets(c, target);
        ph_i_spread_allocate(&c->samples, &c->spread, (const double(*)[K])c->part, target,
                             c->params.at_most, n, &c->out->reached);
        PH_TRY(find_bent(c, err));
        sharpen(c, n, &c->out->reached);
        if (c->out->reached || !more_than_before(c, n)) break;
        bool late = c->params.seconds > 0 && now() - c->began > c->params.seconds;
        if (late || c->out->rounds == ROUNDS) break;
        PH_TRY(ph_i_samples_raise(&c->samples, n, err));
        PH_TRY(refit(c, err));
    }
    if (!c->out->reached)
        ph_i_fit_note(c->out,
                      "the sampling error is larger than asked for: the budget of "
                      "realisations or seconds is used up");
out:
    free(n);
    return st;
}

static ph_status prepare(ph_i_fit *c, const ph_ctx *ctx, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_fit_problem *p = c->problem;
    ph_fit *out = c->out;
    int n = p->nmeasurements, k = p->nunknowns;
    c->sigma_known = !isnan(p->measurement[0].sigma);
    c->scale = c->sigma_known ? 1 : (double)NAN;
    PH_ALLOC(c->sigma, n, "a calibration");
    PH_ALLOC(c->f, n, "a calibration");
    PH_ALLOC(c->J, (size_t)n * K, "a calibration");
    PH_ALLOC(c->S, (size_t)n * n, "a calibration");
    PH_ALLOC(c->part, p->npoints, "a calibration");
    for (int i = 0; i < n; i++)
        c->sigma[i] =
            c->sigma_known ? p->measurement[i].sigma : fabs(p->measurement[i].value);
    out->nunknowns = k;
    out->nmeasurements = n;
    out->sigma_known = c->sigma_known;
    PH_ALLOC(out->unknown, k, "a calibration");
    PH_ALLOC(out->correlation, (size_t)k * k, "a calibration");
    PH_ALLOC(out->direction, k, "a calibration");
    PH_ALLOC(out->point, n, "a calibration");
    PH_TRY(ph_i_samples_init(&c->samples, p, c->sigma, ctx, err));
    c->residuals = (ph_i_residuals){k, n, ph_i_samples_residuals, &c->samples};
out:
    return st;
}

static ph_status stages(ph_i_fit *c, ph_error *err)
{
    ph_status st = PH_OK;
    int least = c->params.at_least;
    c->samples.stage = "scan";
    PH_TRY(raise_all(c, least < PILOT ? least : PILOT, err));
    PH_TRY(ph_i_search_minima(c, err));
    c->samples.stage = "fit";
    PH_TRY(raise_all(c, least, err));
    PH_TRY(refit(c, err));
    PH_TRY(rounds(c, err));
    c->samples.stage = "profiles";
    PH_TRY(ph_i_profile_box(c, err));
    PH_TRY(ph_i_report(c, err));
    PH_TRY(ph_i_profile(c, err));
    PH_TRY(ph_i_left_out(c, err));
    PH_TRY(ph_i_posterior(c, err));
    ph_i_conclude(c);
out:
    return st;
}

ph_status ph_calibrate(const ph_fit_problem *problem, const ph_fit_params *params,
                       const ph_ctx *ctx, ph_fit **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_fit c = {.problem = problem, .began = now()};
    PH_CHECK(problem && out, PH_EINVAL,
             "a calibration needs a problem and a place for it");
    c.params = with_defaults(params, problem->random);
    PH_TRY(check_problem(problem, &c.params, err));
    PH_ALLOC(c.out, 1, "a calibration");
    PH_TRY(prepare(&c, ctx, err));
    PH_TRY(stages(&c, err));
    c.out->seconds = now() - c.began;
    *out = c.out;
    c.out = NULL;
out:
    ph_i_surrogate_free(&c.surrogate);
    ph_i_samples_free(&c.samples);
    free(c.sigma);
    free(c.f);
    free(c.J);
    free(c.S);
    free(c.part);
    ph_fit_free(&c.out);
    return st;
}
