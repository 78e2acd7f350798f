/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which chain of models, how many realisations of each, and when to stop. */
#include "campaign/estimators.h"

#include "core/check.h"

#include <math.h>
#include <string.h>

const ph_estimator ph_estimators[] = {
    {{"plain", "mean over realisations of the case itself", "", "always"}, false, false},
    {{"control_variate",
      "cheaper models of the same realisations, each fitted to the one before by least "
      "squares",
      "Peherstorfer2016", "models that correlate with the case"},
     true,
     true},
    {{"multilevel",
      "differences of models as they are: multilevel Monte Carlo with shared "
      "realisations",
      "Giles2008", "models that come near to the case"},
     true,
     false},
};
const size_t ph_nestimators = sizeof ph_estimators / sizeof *ph_estimators;
enum { PLAIN, FITTED };

enum { DEFAULT_PILOT = 12 };
/* A chain has to be cheaper than plain by this to be worth it. */
static const double worth = 0.9;

/* Reads the members of the rule with their defaults filled in. */
typedef struct plan {
    ph_estimation_rule rule;
    int method; /* -1: auto */
    int nmodels;
    const ph_model_samples *models;
    ph_i_chain chain;
    ph_discretisation bias; /* with rule.total */
    double doubt;           /* that much less it may be: at the pilots its half-width */
    double pairs;           /* realisations of both grids that it takes */
} plan;

/* ---- one decision ------------------------------------------------------------------------ */

static double cost_of(const plan *p, const double *n)
{
    double cost = 0;
    for (int i = 0; i < p->nmodels; i++)
        cost += n[i] * p->models[i].cost;
    return cost;
}

/* What is asked for: of the interval, or of all errors together. */
static double asked_for(const plan *p, const ph_mean_estimate *e)
{
    return p->rule.half_width * (p->rule.relative ? fabs(e->mean) : 1);
}

static double total_error(const plan *p, const ph_mean_estimate *e)
{
    return fabs(p->bias.estimate) + p->bias.half_width + e->half_width;
}

/* Both grids get the pairs, and no model of the chain fewer than the one before. */
static void add_pairs(const plan *p, const ph_i_chain *c, double *n)
{
    const ph_grid_pair *g = &p->rule.grid;
    if (!p->rule.total) return;
    n[g->fine] = fmax(n[g->fine], p->pairs);
    n[g->coarse] = fmax(n[g->coarse], p->pairs);
    for (int l = 1; l < c->n; l++)
        n[c->model[l]] = fmax(n[c->model[l]], n[c->model[l - 1]]);
}

/* Real numbers n of the models for half-width h, where no number may fall below `have` and the
 * scatter is as in e: that of `have` realisations, whose degrees of freedom the interval has. */
static void numbers(const plan *p, const ph_i_chain *c, const ph_mean_estimate *e,
                    const ptrdiff_t *have, double h, double *n)
{
    double V[PH_MAX_MODELS], cost[PH_MAX_MODELS], least[PH_MAX_MODELS],
        out[PH_MAX_MODELS];
    double dof = e->dof, sum = 0;
    for (int i = 0; i < p->nmodels; i++)
        n[i] = (double)have[i];
    for (int l = 0; l < c->n; l++) {
        cost[l] = p->models[c->model[l]].cost;
        least[l] = (double)have[c->model[l]];
        V[l] = e->level[l].variance * least[l] / e->level[l].valid;
        sum += V[l] / least[l];
    }
    /* Terms of one realisation may correlate: by as much as they do now. */
    double together = sum > 0 ? e->standard_error * e->standard_error / sum : 1;
    for (int round = 0; round < 8; round++) {
        double t = h / ph_i_student(p->rule.confidence, dof), squares = 0;
        ph_i_allocate(c->n, V, cost, least, t * t / together, out);
        sum = 0;
        for (int l = 0; l < c->n; l++) {
            double part = V[l] / out[l];
            sum += part;
            squares += part * part / e->level[l].dof;
        }
        if (squares > 0) dof = sum * sum / squares;
    }
    for (int l = 0; l < c->n; l++)
        n[c->model[l]] = out[l];
    add_pairs(p, c, n);
}

/* Half-width for the mean. Of all errors together: what |bias| leaves is parted between the
 * half-widths of bias and mean where it costs least; not > 0: nothing is left. Pilots have
 * seen |bias| badly, and what is left enters the numbers squared: they take its lower end. */
static double aim(plan *p, const ph_i_chain *c, const ph_mean_estimate *e,
                  const ptrdiff_t *have, double asked)
{
    enum { PARTS = 64 };
    const ph_discretisation *b = &p->bias;
    double left = asked - fmax(fabs(b->estimate) - p->doubt, 0), best = INFINITY;
    double n[PH_MAX_MODELS], h = 0, pairs = 0;
    if (!p->rule.total || !(left > 0)) return p->rule.total ? left : asked;
    ptrdiff_t both = ph_i_pairs(&p->rule.grid, have);
    for (int i = 1; i < PARTS; i++) {
        double share = left * i / PARTS, ratio = b->half_width / share;
        p->pairs = (double)both * ratio * ratio;
        numbers(p, c, e, have, left - share, n);
        if (!(cost_of(p, n) < best)) continue;
        best = cost_of(p, n);
        pairs = p->pairs;
        h = left - share;
    }
    p->pairs = pairs;
    return h;
}

/* The smallest half-width whose numbers cost no more than the budget. */
static void within_budget(const plan *p, const ph_i_chain *c, const ph_mean_estimate *e,
                          const ptrdiff_t *have, double h, double *n)
{
    double lo = h > 0 ? h : 1e-6 * e->standard_error, hi = lo;
    numbers(p, c, e, have, lo, n);
    if (!(p->rule.budget > 0) || cost_of(p, n) <= p->rule.budget) return;
    for (int i = 0; i < 200 && cost_of(p, n) > p->rule.budget; i++)
        numbers(p, c, e, have, hi *= 2, n);
    for (int i = 0; i < 60; i++) {
        double mid = sqrt(lo * hi);
        numbers(p, c, e, have, mid, n);
        *(cost_of(p, n) > p->rule.budget ? &lo : &hi) = mid;
    }
    numbers(p, c, e, have, hi, n);
}

/* Every subset of the models that begins with model 0. */
static void subset(const plan *p, unsigned bits, bool fits, const ptrdiff_t *have,
                   ph_i_chain *c)
{
    *c = (ph_i_chain){.n = 1, .fits = fits, .count = {have[0]}, .seen = {have[0]}};
    for (int i = 1; i < p->nmodels; i++)
        if (bits >> (i - 1) & 1) {
            c->model[c->n] = i;
            c->count[c->n] = c->seen[c->n] = have[i];
            c->n++;
        }
}

static bool may_use(const plan *p, const ph_i_chain *c)
{
    const ph_estimator *m = p->method < 0 ? NULL : &ph_estimators[p->method];
    if (c->n == 1 || p->method == PLAIN) return c->n == 1;
    if (m && m->fits != c->fits) return false;
    return c->fits || p->models[c->model[c->n - 1]].dimension == 1;
}

/* What a chain would cost in all: to the half-width, or (budget) the error it would have. */
static bool merit(plan *p, const ph_i_chain *c, const ptrdiff_t *have, double *out)
{
    ph_mean_estimate e;
    double n[PH_MAX_MODELS], v = 0;
    if (!may_use(p, c) || ph_i_chain_sum(c, p->models, &e, NULL)) return false;
    double h = aim(p, c, &e, have, asked_for(p, &e));
    if (p->rule.total && !(h > 0)) return false;
    if (h > 0) {
        numbers(p, c, &e, have, h, n);
        *out = cost_of(p, n);
        return true;
    }
    within_budget(p, c, &e, have, 0, n);
    for (int l = 0; l < c->n; l++)
        v += e.level[l].variance / n[c->model[l]];
    *out = v;
    return true;
}

static ph_status choose(plan *p, const ptrdiff_t *have, ph_estimation *out, ph_error *err)
{
    ph_status st = PH_OK;
    double plain = INFINITY, best = INFINITY;
    ph_i_chain c;
    ph_mean_estimate e;
    subset(p, 0, false, have, &p->chain);
    PH_TRY(ph_i_chain_sum(&p->chain, p->models, &e, err));
    merit(p, &p->chain, have, &plain);
    best = worth * plain;
    out->method = PLAIN;
    for (int fits = 1; fits >= 0 && isfinite(plain); fits--)
        for (unsigned bits = 1; bits < 1u << (p->nmodels - 1); bits++) {
            double m;
            subset(p, bits, fits, have, &c);
            if (!merit(p, &c, have, &m) || !(m < best)) continue; /* NaN: no scatter */
            best = m;
            p->chain = c;
            out->method = fits ? FITTED : FITTED + 1;
        }
    if (p->nmodels == 1)
        snprintf(out->reason, sizeof out->reason, "plain: there is no other model");
    else if (p->method == PLAIN)
        snprintf(out->reason, sizeof out->reason, "plain, as asked for");
    else if (out->method == PLAIN && !isfinite(plain))
        snprintf(out->reason, sizeof out->reason, "plain");
    else if (out->method == PLAIN)
        snprintf(out->reason, sizeof out->reason,
                 "plain: by the pilots no cheaper model helps (correlate too little with "
                 "the case, or cost too much)");
    else
        snprintf(
            out->reason, sizeof out->reason, "%s: by the pilots %.3g times %s",
            ph_estimators[out->method].info.name, worth * plain > 0 ? plain / best : 1,
            p->rule.half_width > 0 ? "cheaper than plain" : "the variance of plain less");
out:
    return st;
}

static void pilots(const plan *p, ptrdiff_t *want)
{
    int last = p->nmodels - 1, d = p->models[last].dimension;
    double first = (double)p->rule.pilot, fit = 2 * d + 4;
    memset(want, 0, PH_MAX_MODELS * sizeof *want);
    if (last == 1 && d > 1) first = fmax(first, fit);
    want[0] = (ptrdiff_t)first;
    for (int i = 1; i <= last; i++) {
        bool grids =
            p->rule.total && (i == p->rule.grid.fine || i == p->rule.grid.coarse);
        if (p->method == PLAIN && !grids) continue;
        double ratio = p->models[0].cost / (4 * p->models[i].cost);
        double n = ceil(first * fmin(fmax(ratio, 1), 8));
        if (d > 1) n = fmax(n, fit);
        for (int j = 0; j < i; j++)
            n = fmax(n, (double)want[j]);
        want[i] = (ptrdiff_t)n;
    }
}

/* ---- stages ------------------------------------------------------------------------------ */

/* Cost so far, and that of plain for the same standard error: the variance of model 0 is the
 * sum over the levels where coefficients are fitted, for residuals do not correlate with what
 * they were fitted to. */
static void account(const plan *p, const ptrdiff_t *want, ph_mean_estimate *e)
{
    double variance = 0;
    ph_mean_estimate plain;
    ph_i_chain c = {.n = 1, .count = {p->chain.count[0]}, .seen = {p->chain.seen[0]}};
    e->cost = 0;
    for (int i = 0; i < p->nmodels; i++)
        e->cost += (double)want[i] * p->models[i].cost;
    for (int l = 0; l < e->nlevels; l++)
        variance += e->level[l].variance;
    if (!p->chain.fits && !ph_i_chain_sum(&c, p->models, &plain, NULL))
        variance = plain.level[0].variance;
    double s2 = e->standard_error * e->standard_error;
    e->plain_cost = s2 > 0 ? variance / s2 * p->models[0].cost : 0;
    e->half_width = ph_i_student(p->rule.confidence, e->dof) * e->standard_error;
}

/* Whole numbers for half-width h (0: what the budget gives); `part` of the way to them. */
static void raise_numbers(const plan *p, const ph_mean_estimate *e, double h, double part,
                          ptrdiff_t *want)
{
    double n[PH_MAX_MODELS], have[PH_MAX_MODELS], budget = p->rule.budget;
    within_budget(p, &p->chain, e, want, h, n);
    for (int i = 0; i < p->nmodels; i++)
        have[i] = (double)want[i];
    for (int i = p->nmodels - 1; i >= 0; i--) {
        double whole = h > 0 ? ceil(part * n[i] - 1e-9) : floor(part * n[i] + 1e-9);
        double cost = cost_of(p, have) + (whole - have[i]) * p->models[i].cost;
        if (budget > 0 && cost > budget * (1 + 1e-12))
            whole = have[i] + floor((budget - cost_of(p, have)) / p->models[i].cost);
        if (whole > have[i]) have[i] = whole;
    }
    for (int i = 0; i < p->nmodels; i++)
        want[i] = (ptrdiff_t)have[i];
}

static bool have_all(const plan *p, const ptrdiff_t *want)
{
    for (int i = 0; i < p->nmodels; i++)
        if (p->models[i].n < want[i]) return false;
    return true;
}

/* The estimate from `want` realisations, its variance from those `decided`. */
static ph_status estimate(plan *p, const ph_estimation *e, ph_mean_estimate *out,
                          ph_error *err)
{
    ph_status st = PH_OK;
    for (int l = 0; l < p->chain.n; l++) {
        p->chain.count[l] = e->want[p->chain.model[l]];
        p->chain.seen[l] = e->decided[p->chain.model[l]];
    }
    PH_TRY(ph_i_chain_sum(&p->chain, p->models, out, err));
    account(p, e->want, out);
out:
    return st;
}

/* The scatter of the bias is that of the pairs decided, like that of the mean. */
static ph_status look_at_bias(plan *p, ph_estimation *out, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_grid_pair *g = &p->rule.grid;
    if (!p->rule.total) goto out;
    PH_TRY(ph_estimation_bias(g, p->rule.confidence, p->nmodels, p->models,
                              ph_i_pairs(g, out->decided), ph_i_pairs(g, out->want),
                              &p->bias, err));
    out->bias = p->bias;
    p->doubt = out->stage < 2 ? p->bias.half_width : 0;
out:
    return st;
}

static void finish(const plan *p, double h, ph_estimation *out)
{
    size_t used = strlen(out->reason), size = sizeof out->reason - used;
    char *end = out->reason + used;
    double asked = asked_for(p, &out->estimate), error = total_error(p, &out->estimate);
    out->done = true;
    out->reached = p->rule.total ? error <= asked * (1 + 1e-9)
                                 : h > 0 && out->estimate.half_width <= h * (1 + 1e-9);
    if (p->rule.total && !out->reached && 2 * fabs(p->bias.estimate) > asked)
        out->finer = 2 * fabs(p->bias.estimate) / asked;
    if (out->reached)
        snprintf(end, size, "; the %s is reached",
                 p->rule.total ? "total error" : "half-width");
    else if (p->rule.total && !(asked > fabs(p->bias.estimate)))
        snprintf(
            end, size,
            "; the grid alone is off by about %.3g +- %.2g, of %.3g asked for in all: "
            "spacings %.3g times finer would leave half of that to sampling",
            p->bias.estimate, p->bias.half_width, asked, out->finer);
    else
        snprintf(end, size, "; the budget is spent");
    if (out->finer > 0 && asked > fabs(p->bias.estimate)) {
        used = strlen(out->reason);
        snprintf(out->reason + used, sizeof out->reason - used,
                 " (the grid is off by about %.3g of %.3g asked for in all)",
                 p->bias.estimate, asked);
    }
}

/* What the last look leaves to be computed, where it is not yet enough. */
static bool is_missing(const plan *p, double h, const ph_mean_estimate *e)
{
    if (p->rule.total) return total_error(p, e) > asked_for(p, e);
    return h > 0 && e->half_width > h;
}

/* The plan takes coefficients (and the bias) as known: what is missing. False: wait. */
static ph_status complete(plan *p, double h, ph_estimation *out, bool *wait,
                          ph_error *err)
{
    ph_status st = PH_OK;
    for (int round = 0; is_missing(p, h, &out->estimate); round++) {
        ptrdiff_t before[PH_MAX_MODELS];
        double factor = pow(0.99, round), less = h * factor;
        if (p->rule.total)
            less = aim(p, &p->chain, &out->estimate, out->want,
                       factor * asked_for(p, &out->estimate));
        if (!(less > 0) || factor < 0.5) break; /* the grid, or the budget, forbids */
        memcpy(before, out->want, sizeof before);
        raise_numbers(p, &out->estimate, less, 1, out->want);
        if (memcmp(before, out->want, sizeof before) == 0) continue;
        *wait = !have_all(p, out->want);
        if (*wait) break;
        PH_TRY(estimate(p, out, &out->estimate, err));
        PH_TRY(look_at_bias(p, out, err));
    }
out:
    return st;
}

/* Pilots, then half of what they ask for, then what these ask for: [Stein1945] with the
 * first sample enlarged as in [Hall1981]. The last numbers depend on the scatter of the
 * realisations decided[], and so the interval is made with that scatter. */
static ph_status stages(plan *p, ph_estimation *out, ph_error *err)
{
    ph_status st = PH_OK;
    double h = 0;
    bool wait = false;
    if (!have_all(p, out->want)) goto out;
    memcpy(out->decided, out->want, sizeof out->want);
    PH_TRY(look_at_bias(p, out, err));
    PH_TRY(choose(p, out->want, out, err));
    out->nlevels = p->chain.n;
    memcpy(out->model, p->chain.model, sizeof out->model);
    for (out->stage = 1; out->stage <= 3; out->stage++) {
        if (!have_all(p, out->want)) goto out;
        if (out->stage < 3) memcpy(out->decided, out->want, sizeof out->want);
        PH_TRY(estimate(p, out, &out->estimate, err));
        PH_TRY(look_at_bias(p, out, err));
        if (out->stage == 3) break;
        h = aim(p, &p->chain, &out->estimate, out->want, asked_for(p, &out->estimate));
        if (p->rule.total && !(h > 0)) break; /* nothing is left for sampling */
        raise_numbers(p, &out->estimate, h, out->stage == 1 ? 0.5 : 1, out->want);
    }
    PH_TRY(complete(p, h, out, &wait, err));
    if (!wait) finish(p, h, out);
out:
    return st;
}

/* ---- arguments --------------------------------------------------------------------------- */

static ph_status check_models(int n, const ph_model_samples *models, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(models && n >= 1 && n <= PH_MAX_MODELS, PH_EINVAL,
             "an estimate has 1 to %d models, got %d", PH_MAX_MODELS, n);
    for (int i = 0; i < n; i++) {
        int most = n > 1 && i == n - 1 ? PH_MAX_CONTROLS : 1;
        PH_CHECK(models[i].dimension >= 1 && models[i].dimension <= most, PH_EINVAL,
                 "model %d has 1 to %d numbers a realisation, got %d", i, most,
                 models[i].dimension);
        PH_CHECK(models[i].n >= 0 && (models[i].value || models[i].n == 0), PH_EINVAL,
                 "model %d: %td realisations", i, models[i].n);
        PH_CHECK(models[i].cost > 0 && isfinite(models[i].cost), PH_EINVAL,
                 "model %d: the cost of a realisation must be > 0, got %g", i,
                 models[i].cost);
    }
out:
    return st;
}

static ph_status read_rule(const ph_estimation_rule *rule, plan *p, ph_error *err)
{
    ph_status st = PH_OK;
    ph_estimation_rule *r = &p->rule;
    *r = *rule;
    p->method = -1;
    for (size_t i = 0; r->method && i < ph_nestimators; i++)
        if (strcmp(r->method, ph_estimators[i].info.name) == 0) p->method = (int)i;
    PH_CHECK(!r->method || p->method >= 0 || strcmp(r->method, "auto") == 0, PH_EINVAL,
             "unknown estimator '%s'", r->method);
    if (r->confidence == 0) r->confidence = 0.95;
    if (r->pilot == 0) r->pilot = DEFAULT_PILOT;
    PH_CHECK(r->confidence > 0 && r->confidence < 1, PH_EINVAL,
             "the confidence must be in (0, 1), got %g", r->confidence);
    PH_CHECK(r->pilot >= 4 && r->pilot <= 1000000, PH_EINVAL,
             "pilot realisations must be 4 to 1000000, got %td", r->pilot);
    PH_CHECK(r->half_width >= 0 && isfinite(r->half_width) && r->budget >= 0 &&
                 isfinite(r->budget) && (r->half_width > 0 || r->budget > 0),
             PH_EINVAL, "half-width %g and budget %g: one of them must be > 0",
             r->half_width, r->budget);
    if (r->total)
        PH_CHECK(r->half_width > 0 && ph_i_is_pair(&r->grid, p->nmodels), PH_EINVAL,
                 "a total error takes half-width > 0 and two models that differ in their "
                 "grid only, got %g, models %d and %d of %d, ratio %g",
                 r->half_width, r->grid.fine, r->grid.coarse, p->nmodels, r->grid.ratio);
out:
    return st;
}

ph_status ph_estimation_next(const ph_estimation_rule *rule, int nmodels,
                             const ph_model_samples *models, ph_estimation *out,
                             ph_error *err)
{
    ph_status st = PH_OK;
    plan p = {.nmodels = nmodels, .models = models};
    double cost = 0;
    PH_CHECK(rule && out, PH_EINVAL, "an estimate without a rule or a place to go");
    PH_TRY(check_models(nmodels, models, err));
    PH_TRY(read_rule(rule, &p, err));
    memset(out, 0, sizeof *out);
    out->method = -1;
    pilots(&p, out->want);
    for (int i = 0; i < nmodels; i++)
        cost += (double)out->want[i] * models[i].cost;
    PH_CHECK(!(p.rule.budget > 0) || cost <= p.rule.budget, PH_EINVAL,
             "the pilots alone cost %g of a budget of %g", cost, p.rule.budget);
    PH_TRY(stages(&p, out, err));
out:
    return st;
}

ph_status ph_estimation_mean(const ph_estimation *e, double confidence, int nmodels,
                             const ph_model_samples *models, ph_mean_estimate *out,
                             ph_error *err)
{
    ph_status st = PH_OK;
    plan p = {.nmodels = nmodels, .models = models, .rule.confidence = confidence};
    PH_CHECK(e && out, PH_EINVAL, "a mean without an estimation or a place to go");
    PH_CHECK(confidence > 0 && confidence < 1, PH_EINVAL,
             "the confidence must be in (0, 1), got %g", confidence);
    PH_TRY(check_models(nmodels, models, err));
    PH_CHECK(e->method >= 0 && e->nlevels <= nmodels, PH_EINVAL,
             "the estimation has no chain of these models yet");
    p.chain.n = e->nlevels;
    p.chain.fits = ph_estimators[e->method].fits;
    memcpy(p.chain.model, e->model, sizeof p.chain.model);
    for (int l = 0; l < e->nlevels; l++) {
        const ph_level_report *r = &e->estimate.level[l];
        p.chain.count[l] = r->n;
        p.chain.seen[l] = e->decided[e->model[l]];
        PH_CHECK(p.chain.model[l] < nmodels && models[p.chain.model[l]].n >= r->n,
                 PH_EINVAL, "model %d: fewer than the %td realisations of the estimation",
                 p.chain.model[l], r->n);
    }
    PH_TRY(ph_i_chain_sum(&p.chain, models, out, err));
    account(&p, e->want, out);
out:
    return st;
}
