/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Points with cheaper models: what is kept of them, what comes next, what it comes to. */
#include "campaign/campaign.h"
#include "campaign/estimators.h"

#include <math.h>
#include <string.h>

/* Realisations of every model whose iterations make its cost. */
enum { COSTED = 4 };

static int model_slot(const ph_campaign *c, int point, int m)
{
    return point + m * c->npoints;
}

static double nodes_of(const ptrdiff_t n[3])
{
    return (double)n[0] * (double)n[1] * (double)(n[2] > 0 ? n[2] : 1);
}

/* Operations, in node iterations: those of the solver, and what it takes to begin a case and
 * a load as measured for 2D bond cases (docs/theory/multilevel.md). No clock: numbers of
 * realisations must not depend on the machine. */
double ph_i_work_of(const ph_case *one, const ph_quantity *output, int noutputs,
                    double iterations)
{
    double loads = 0;
    const ph_scenario s = {.c = one, .noutputs = noutputs, .output = output};
    for (unsigned bits = ph_scenario_loads(&s); bits; bits >>= 1)
        loads += bits & 1;
    if (isnan(iterations)) iterations = 20 * loads;
    return nodes_of(one->nodes) * (iterations + 10 * loads + 11);
}

static double cost_of(const ph_i_tally *t, int slot)
{
    const ph_case *one = ph_i_slot_case(t->c, slot);
    const ph_i_point_tally *p = &t->point[slot];
    if (ph_i_is_fillers(t->c, slot)) return 0.5 * nodes_of(one->nodes);
    double iterations = p->costed ? p->iterations / p->costed : (double)NAN;
    return ph_i_work_of(one, ph_i_slot_output(t->c, slot), t->c->noutputs, iterations);
}

/* Room for one more realisation. */
static ph_status grow(ph_i_point_tally *p, int arrays, int width, ph_error *err)
{
    ph_status st = PH_OK;
    if (p->next < p->kept_room) return st;
    int64_t room = 2 * p->kept_room + 32;
    for (int k = 0; k < arrays; k++) {
        size_t bytes = (size_t)room * (size_t)width * sizeof(double);
        double *grown = realloc(p->kept[k], bytes);
        PH_CHECK(grown, PH_ENOMEM, "no memory for %lld realisations", (long long)room);
        p->kept[k] = grown;
    }
    p->kept_room = room;
out:
    return st;
}

static ph_status keep(ph_i_tally *t, int slot, bool failed, const double *value,
                      ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_point_tally *p = &t->point[slot];
    int n = ph_i_slot_values(t->c, slot);
    bool fillers = ph_i_is_fillers(t->c, slot);
    PH_TRY(grow(p, fillers ? 1 : n, fillers ? n : 1, err));
    for (int k = 0; k < n; k++)
        *(fillers ? &p->kept[0][p->next * n + k] : &p->kept[k][p->next]) =
            failed ? (double)NAN : value[k];
out:
    return st;
}

/* Models of output k of a point as far as they are there. */
static void samples_of(const ph_i_tally *t, int point, int k, ph_model_samples *out)
{
    for (int m = 0; m < t->c->nmodels; m++) {
        int slot = model_slot(t->c, point, m);
        const ph_i_point_tally *p = &t->point[slot];
        bool fillers = ph_i_is_fillers(t->c, slot);
        out[m] =
            (ph_model_samples){.dimension = fillers ? ph_i_slot_values(t->c, slot) : 1,
                               .n = p->next,
                               .value = p->kept[fillers ? 0 : k],
                               .cost = cost_of(t, slot)};
    }
}

static void decide(ph_i_tally *t, int point)
{
    const ph_campaign *c = t->c;
    ph_estimation *e = &t->estimation[point];
    ph_model_samples models[PH_MAX_MODELS];
    ph_error why = PH_ERROR_INIT;
    samples_of(t, point, c->judged >= 0 ? c->judged : 0, models);
    ph_estimation_rule rule = {.method = c->method,
                               .half_width = c->stopping.half_width,
                               .confidence = c->stopping.confidence,
                               .pilot = (ptrdiff_t)c->pilot,
                               .budget = (double)c->stopping.at_most * models[0].cost};
    if (c->stopping.relative_half_width > 0) {
        rule.half_width = c->stopping.relative_half_width;
        rule.relative = true;
    }
    rule.grid = c->point[point].grid;
    if (c->relative_error > 0) {
        rule.half_width = c->relative_error;
        rule.relative = rule.total = true;
    }
    ph_status got = ph_estimation_next(&rule, c->nmodels, models, e, &why);
    if (got == PH_EINVAL) { /* the pilots of all models cost more than at_most allows */
        rule.method = "plain";
        why = (ph_error)PH_ERROR_INIT;
        got = ph_estimation_next(&rule, c->nmodels, models, e, &why);
    }
    if (got != PH_OK) { /* all pilots failed: nothing more to learn here */
        e->done = true;
        snprintf(e->reason, sizeof e->reason, "%.250s", why.msg);
    }
    for (int m = 0; m < c->nmodels; m++)
        t->point[model_slot(c, point, m)].done = e->done;
}

ph_status ph_i_variance_begin(ph_i_tally *t, ph_error *err)
{
    ph_status st = PH_OK;
    PH_ALLOC(t->estimation, t->c->npoints, "the estimations");
    for (int p = 0; p < t->c->npoints; p++) {
        t->estimation[p].method = -1;
        for (int m = 0; m < t->c->nmodels; m++)
            t->estimation[p].want[m] = COSTED;
    }
out:
    return st;
}

static bool stage_is_complete(const ph_i_tally *t, int point)
{
    for (int m = 0; m < t->c->nmodels; m++)
        if (t->point[model_slot(t->c, point, m)].next < t->estimation[point].want[m])
            return false;
    return true;
}

/* First a few of every model for its cost, then what the estimation asks for. */
ph_status ph_i_variance_add(ph_i_tally *t, int slot, bool failed, int iterations,
                            const double *value, ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_point_tally *p = &t->point[slot];
    int point = slot % t->c->npoints;
    PH_TRY(keep(t, slot, failed, value, err));
    if (p->next < COSTED && !failed) {
        p->iterations += iterations;
        p->costed++;
    }
    p->next++;
    while (stage_is_complete(t, point) && !t->estimation[point].done)
        decide(t, point);
out:
    return st;
}

bool ph_i_variance_mean(const ph_i_tally *t, int point, int k, ph_interval *out)
{
    ph_model_samples models[PH_MAX_MODELS];
    ph_mean_estimate e;
    const ph_estimation *plan = &t->estimation[point];
    if (plan->method < 0 || plan->nlevels == 0) return false;
    samples_of(t, point, k, models);
    if (ph_estimation_mean(plan, t->c->stopping.confidence, t->c->nmodels, models, &e,
                           NULL) != PH_OK)
        return false;
    out->mean = e.mean;
    out->standard_error = e.standard_error;
    out->half_width = e.half_width;
    return true;
}

ph_discretisation ph_i_variance_bias(const ph_i_tally *t, int point, int k)
{
    ph_model_samples models[PH_MAX_MODELS];
    ph_discretisation out = {NAN, NAN, NAN, NAN, 0};
    const ph_estimation *plan = &t->estimation[point];
    const ph_grid_pair *grid = &t->c->point[point].grid;
    if (ph_campaign_no_grid(t->c, point, k) || plan->method < 0) return out;
    samples_of(t, point, k, models);
    ph_status st = ph_estimation_bias(grid, t->c->stopping.confidence, t->c->nmodels,
                                      models, ph_i_pairs(grid, plan->decided),
                                      ph_i_pairs(grid, plan->want), &out, NULL);
    return st == PH_OK ? out : (ph_discretisation){NAN, NAN, NAN, NAN, 0};
}
