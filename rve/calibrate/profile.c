/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Profile likelihood on the surrogate [Raue2009]: where the least misfit over the other
 * unknowns has risen by q^2 sigma^2, the 95 % interval ends. */
#include "calibrate/calibrate.h"

#include <math.h>
#include <string.h>

enum { WIDEN = 6, BISECTIONS = 40 };

double ph_i_rise(const ph_i_fit *c, int j)
{
    const ph_i_spread *e = &c->spread;
    int n = c->problem->nmeasurements;
    double freedom, more = 1;
    double q = ph_i_spread_quantile(e, n, c->sigma_known, j, &freedom);
    if (e->data[j][j] > 0) more = 1 + e->sampling[j][j] / e->data[j][j];
    for (int i = 0; i < n && e->unknown[j] == PH_FIT_FLAT && e->scale > 0; i++)
        more = fmax(more, 1 + c->S[i * n + i] / e->scale);
    return q * q * e->scale * more;
}

/* Least misfit with unknown j held at x; u holds the others' start and then their place. */
static ph_status profile_at(const ph_i_fit *c, int j, double x, double u[K],
                            double *misfit, ph_error *err)
{
    ph_i_surrogate *s = c->surrogate;
    ph_i_residuals r = {s->k, s->n, ph_i_surrogate_residuals, s};
    ph_i_search how = {
        .step = 1e-5, .tolerance = 1e-4, .scale = c->spread.scale, .iterations = 50};
    bool converged;
    memcpy(how.lo, s->lo, sizeof how.lo);
    memcpy(how.hi, s->hi, sizeof how.hi);
    for (int i = 0; i < s->k; i++)
        if (c->spread.unknown[i] == PH_FIT_FLAT && i != j) how.lo[i] = how.hi[i] = u[i];
    u[j] = how.lo[j] = how.hi[j] = x;
    return ph_i_minimise(&r, &how, u, misfit, &converged, err);
}

static bool inside(double x, double lo, double hi)
{
    return (x > lo || lo <= 0) && (x < hi || hi >= 1);
}

/* Widen the box where an interval leaves it. *good: nothing had to be. */
static ph_status look_at_edges(const ph_i_fit *c, double lo[K], double hi[K], bool *good,
                               ph_error *err)
{
    ph_status st = PH_OK;
    const ph_i_surrogate *s = c->surrogate;
    double more = c->params.samples > 0 ? 4 : 1; /* chains go farther out */
    *good = true;
    for (int j = 0; j < s->k; j++)
        for (int side = 0; side < 2; side++) {
            double u[K], misfit, edge = side ? s->hi[j] : s->lo[j];
            if (edge <= 0 || edge >= 1) continue;
            memcpy(u, c->best, sizeof u);
            PH_TRY(profile_at(c, j, edge, u, &misfit, err));
            double rise = (misfit - c->chi2) / (more * ph_i_rise(c, j));
            bool risen = rise > 1;
            /* Others at the edge of their box make it rise too soon: where it is well above
             * the limit (a parabola has 1.4^2 there) that does not matter. */
            for (int i = 0; i < s->k && rise < 1.5; i++)
                if (i != j && !inside(u[i], s->lo[i], s->hi[i])) {
                    double w = s->hi[i] - s->lo[i];
                    *good = false;
                    lo[i] = fmax(s->lo[i] - w / 2, 0);
                    hi[i] = fmin(s->hi[i] + w / 2, 1);
                }
            if (risen) continue;
            double w = s->hi[j] - s->lo[j];
            *good = false;
            if (side)
                hi[j] = fmin(s->hi[j] + w, 1);
            else
                lo[j] = fmax(s->lo[j] - w, 0);
        }
out:
    return st;
}

static void first_box(const ph_i_fit *c, double lo[K], double hi[K])
{
    const ph_i_spread *e = &c->spread;
    for (int j = 0; j < c->problem->nunknowns; j++) {
        double freedom;
        double q = ph_i_spread_quantile(e, c->problem->nmeasurements, c->sigma_known, j,
                                        &freedom);
        double half = q * sqrt(e->data[j][j] + e->sampling[j][j]);
        half *= c->params.samples > 0 ? 2.5 : 1.4;
        if (half < 1e-4) half = 1e-4;
        bool known = e->unknown[j] == PH_FIT_KNOWN;
        lo[j] = known ? fmax(c->best[j] - half, 0) : 0;
        hi[j] = known ? fmin(c->best[j] + half, 1) : 1;
    }
}

ph_status ph_i_profile_box(ph_i_fit *c, ph_error *err)
{
    ph_status st = PH_OK;
    double lo[K], hi[K];
    bool built = true, good = false;
    if (c->problem->nunknowns > PH_I_SURROGATE_UNKNOWNS) {
        ph_i_fit_note(c->out, "no profiles: more than %d unknowns; intervals are local",
                      PH_I_SURROGATE_UNKNOWNS);
        goto out;
    }
    if (isnan(c->spread.scale)) {
        ph_i_fit_note(c->out,
                      "no profiles: no sigma is given and there are not more "
                      "measurements than unknowns, so that nothing is known of the "
                      "errors of the data");
        goto out;
    }
    first_box(c, lo, hi);
    for (int i = 0; i < WIDEN && !good; i++) {
        ph_i_surrogate_free(&c->surrogate);
        PH_TRY(ph_i_surrogate_new(&c->residuals, lo, hi, c->best, &c->surrogate, &built,
                                  err));
        if (!built) break;
        PH_TRY(look_at_edges(c, lo, hi, &good, err));
    }
    if (!built)
        ph_i_fit_note(c->out, "no profiles: the model fails near the minimum: %.150s",
                      c->samples.last_failure.msg);
    else if (!good)
        ph_i_fit_note(
            c->out, "an interval may end too early: its box was widened %d times", WIDEN);
out:
    return st;
}

/* Where the profile crosses the limit between a (below) and b (above). */
static ph_status crossing(const ph_i_fit *c, int j, double limit, double a, double b,
                          const double near[K], double *x, ph_error *err)
{
    ph_status st = PH_OK;
    for (int i = 0; i < BISECTIONS; i++) {
        double u[K], misfit, middle = 0.5 * (a + b);
        memcpy(u, near, sizeof u);
        PH_TRY(profile_at(c, j, middle, u, &misfit, err));
        if (misfit < limit)
            a = middle;
        else
            b = middle;
    }
    *x = 0.5 * (a + b);
out:
    return st;
}

typedef struct curve {
    double x[PH_FIT_PROFILE], misfit[PH_FIT_PROFILE], place[PH_FIT_PROFILE][K];
    int start; /* nearest to the best value */
} curve;

/* From the best value outwards, each point started where the last one ended. */
static ph_status trace(const ph_i_fit *c, int j, curve *p, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_i_surrogate *s = c->surrogate;
    enum { N = PH_FIT_PROFILE };
    for (int i = 0; i < N; i++) {
        p->x[i] = s->lo[j] + (s->hi[j] - s->lo[j]) * i / (N - 1);
        if (fabs(p->x[i] - c->best[j]) < fabs(p->x[p->start] - c->best[j])) p->start = i;
    }
    p->x[p->start] = c->best[j];
    for (int direction = 1; direction >= -1; direction -= 2) {
        double u[K];
        memcpy(u, c->best, sizeof u);
        for (int i = p->start; i >= 0 && i < N; i += direction) {
            PH_TRY(profile_at(c, j, p->x[i], u, &p->misfit[i], err));
            memcpy(p->place[i], u, sizeof u);
        }
    }
out:
    return st;
}

static ph_status profile_of(ph_i_fit *c, int j, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_fit_unknown *unknown = &c->problem->unknown[j];
    ph_fit_estimate *o = &c->out->unknown[j];
    curve p = {.start = 0};
    PH_TRY(trace(c, j, &p, err));
    double limit = p.misfit[p.start] + ph_i_rise(c, j);
    for (int side = 0; side < 2; side++) {
        int step = side ? 1 : -1, i = p.start, last = side ? PH_FIT_PROFILE - 1 : 0;
        while (i != last && p.misfit[i + step] < limit)
            i += step;
        double x = p.x[i];
        o->open[side] = i == last && (side ? x >= 1 : x <= 0);
        if (i != last)
            PH_TRY(crossing(c, j, limit, p.x[i], p.x[i + step], p.place[i], &x, err));
        o->profile[side] = ph_i_unknown_value(unknown, x);
        for (i += step; i >= 0 && i < PH_FIT_PROFILE; i += step)
            if (p.misfit[i] < limit) o->several = true;
    }
    o->nprofile = PH_FIT_PROFILE;
    for (int i = 0; i < PH_FIT_PROFILE; i++) {
        o->profile_value[i] = ph_i_unknown_value(unknown, p.x[i]);
        o->profile_misfit[i] = p.misfit[i];
    }
out:
    return st;
}

ph_status ph_i_profile(ph_i_fit *c, ph_error *err)
{
    ph_status st = PH_OK;
    if (!c->surrogate) goto out;
    c->out->surrogate_error = c->surrogate->error;
    if (c->surrogate->error > 0.1)
        ph_i_fit_note(
            c->out,
            "the surrogate misses the model by up to %.2g sigma: the means are no "
            "smooth function of the unknowns, or change too much in the interval",
            c->surrogate->error);
    for (int j = 0; j < c->problem->nunknowns; j++)
        PH_TRY(profile_of(c, j, err));
out:
    return st;
}
