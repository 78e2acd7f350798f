/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which size of the RVE: what the pilots of a few say, and the campaign of the chosen one. */
#include "campaign/sizes.h"
#include "fidelity/fidelity.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

void ph_i_sizes_free(ph_campaign_sizes **sizes)
{
    if (!sizes || !*sizes) return;
    ph_split_answer_free(&(*sizes)->answer);
    free(*sizes);
    *sizes = NULL;
}

/* ---- the choice ---- */

static ph_status ask(ph_i_chooser *s, ph_split_question *q, double **value, double **cost,
                     double factor[PH_SPLIT_SIZES], ph_error *err)
{
    ph_status st = PH_OK;
    const ph_campaign *c = s->c;
    const ph_stopping *rule = &c->stopping;
    size_t each = (size_t)c->npoints * (size_t)s->pilots, points = (size_t)c->npoints;
    free(*value);
    free(*cost);
    *value = *cost = NULL;
    PH_ALLOC(*value, each * (size_t)s->ntried, "the pilots");
    PH_ALLOC(*cost, points * (size_t)s->ntried, "the pilots");
    for (int i = 0; i < s->ntried; i++) {
        const ph_i_option *o = &s->option[s->tried[i]];
        memcpy(*value + each * (size_t)i, o->value, sizeof **value * each);
        memcpy(*cost + points * (size_t)i, o->cost, sizeof **cost * points);
        factor[i] = s->report->size[o->entry].factor;
        s->report->tried[i] = o->entry;
    }
    s->report->ntried = s->ntried;
    int more = s->noptions - s->next;
    for (int i = 0; i < more; i++)
        factor[s->ntried + i] = s->report->size[s->option[s->next + i].entry].factor;
    *q = (ph_split_question){.dimensions = ph_i_fidelity_axes(c->point[0].c),
                             .exponent = s->report->exponent,
                             .accuracy = s->report->accuracy,
                             .absolute = s->report->absolute,
                             .confidence = rule->confidence,
                             .least = rule->at_least,
                             .most = rule->at_most,
                             .npoints = c->npoints,
                             .nsizes = s->ntried,
                             .nmore = more,
                             .factor = factor,
                             .n = s->pilots,
                             .value = *value,
                             .cost = *cost,
                             .ngrids = s->report->ngrids,
                             .grid_error = s->report->grid_error,
                             .grid_cost = s->grid_cost};
out:
    return st;
}

/* Pilots of the next size that can be had. */
static ph_status try_next(ph_i_chooser *s, ph_error *err)
{
    ph_status st = PH_OK;
    bool good = false;
    while (!good && s->next < s->noptions) {
        int k = s->next++;
        PH_TRY(ph_i_pilots_solve(s, &s->option[k], &good, err));
        if (good) s->tried[s->ntried++] = k;
    }
out:
    return st;
}

static ph_status double_pilots(ph_i_chooser *s, ph_error *err)
{
    ph_status st = PH_OK;
    int n = s->ntried;
    s->pilots *= 2;
    s->ntried = 0;
    for (int i = 0; i < n; i++) {
        bool good = false;
        int k = s->tried[i];
        PH_TRY(ph_i_pilots_solve(s, &s->option[k], &good, err));
        if (good) s->tried[s->ntried++] = k;
    }
out:
    return st;
}

static void say_why(ph_campaign_sizes *r)
{
    const ph_split_answer *a = r->answer;
    const ph_split_candidate *c = &a->candidate[a->chosen >= 0 ? a->chosen : a->nearest];
    double per = r->absolute ? 1 : 100;
    const char *unit = r->absolute ? "" : " %";
    const ph_campaign_size *e = &r->size[r->tried[c->size]];
    if (a->chosen >= 0) {
        snprintf(
            r->why, sizeof r->why,
            "%.3g of the edge, %.0f realisations: least work to go of all that meet "
            "%.3g%s; its size adds %.2g +- %.2g%s, its grid %.2g%s, the interval may "
            "be %.2g%s wide to each side",
            e->factor, c->needed, per * r->accuracy, unit, per * c->bias,
            per * c->bias_half_width, unit, per * r->grid_error[c->grid], unit,
            per * c->half_width, unit);
        return;
    }
    size_t at = (size_t)snprintf(r->why, sizeof r->why,
                                 "by the pilots so far no size meets %.3g%s: %.3g of the "
                                 "edge comes nearest, %.2g%s; "
                                 "its size adds %.2g +- %.2g%s",
                                 per * r->accuracy, unit, e->factor, per * c->error, unit,
                                 per * c->bias, per * c->bias_half_width, unit);
    if (a->factor_needed > 0 && at < sizeof r->why)
        snprintf(r->why + at, sizeof r->why - at,
                 "; it takes half of what is left at about %.2g of the edge",
                 a->factor_needed);
}

/* What a size adds shows with two at least. */
static ph_status need_two(ph_i_chooser *s, ph_error *err)
{
    ph_status st = PH_OK;
    ph_campaign_sizes *r = s->report;
    if (s->ntried >= 2) return PH_OK;
    ph_split_answer_free(&r->answer);
    const ph_campaign_size *e = r->size; /* the first that was left out */
    while (e < r->size + r->n && !e->reason[0])
        e++;
    bool any = e < r->size + r->n;
    snprintf(r->why, sizeof r->why, "what a size adds shows with two at least%s%.3g%s%s",
             any ? "; " : ", not with ", any ? e->factor : r->size[0].factor,
             any ? " of the edge: " : " of the edge alone", any ? e->reason : "");
    PH_CHECK(false, PH_EINVAL, "size: %s", r->why);
out:
    return st;
}

/* Pilots until the cheapest plan is to go on with a size, or there is none. */
static ph_status weigh(ph_i_chooser *s, ph_split_question *q, double **value,
                       double **cost, double factor[PH_SPLIT_SIZES], ph_error *err)
{
    ph_status st = PH_OK;
    ph_campaign_sizes *r = s->report;
    ph_split_step step = PH_SPLIT_LARGER;
    while (step == PH_SPLIT_LARGER || step == PH_SPLIT_MORE) {
        if (step == PH_SPLIT_MORE)
            PH_TRY(double_pilots(s, err));
        else
            PH_TRY(try_next(s, err));
        step = PH_SPLIT_LARGER;
        if (s->ntried < 2 && s->next < s->noptions) continue;
        PH_TRY(need_two(s, err));
        PH_TRY(ask(s, q, value, cost, factor, err));
        ph_split_answer_free(&r->answer);
        PH_TRY(ph_split_choose(q, &r->answer, err));
        step = r->answer->step;
        say_why(r);
    }
    PH_CHECK(step == PH_SPLIT_CHOSEN, PH_ENOCONV, "size: %s", r->why);
out:
    return st;
}

/* ---- the campaign of the size that was chosen ---- */

static ph_status make_campaign(const ph_i_chooser *s, ph_campaign **out, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_campaign_sizes *r = s->report;
    const ph_split_candidate *best = &r->answer->candidate[r->answer->chosen];
    const ph_i_option *o = &s->option[s->tried[best->size]];
    const ph_campaign_size *e = &r->size[o->entry];
    char nodes[96];
    const char *more[PH_I_SIZE_SETS];
    size_t n = 0;
    int axes = ph_i_fidelity_axes(s->c->point[0].c);
    ph_i_grid_set("nodes", e->nodes[best->grid], axes, nodes, sizeof nodes);
    more[n++] = o->set[0];
    more[n++] = nodes;
    if (o->set[2][0]) more[n++] = o->set[2];
    PH_TRY(ph_i_campaign_reread(s->c, s->sets, s->nsets, more, n, out, err));
    (*out)->grid_error = r->grid_error[best->grid];
    if (best->grid == 0) (*out)->stopping.at_least = s->pilots;
    if (r->absolute)
        (*out)->stopping.half_width = best->half_width;
    else
        (*out)->stopping.relative_half_width = best->half_width;
out:
    return st;
}

/* How many realisations of the campaign are there already: those of its folder, or the pilots
 * that will be. @param[out] pilots those of its folder that are pilots */
static ph_status count(const ph_i_chooser *s, const ph_campaign *c, int64_t *pilots,
                       double *there, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_split_answer *a = s->report->answer;
    ph_i_store store = {.lock = -1, .fd = -1};
    char path[1200];
    *pilots = 0;
    *there = a->candidate[a->chosen].grid == 0 ? (double)(s->pilots * c->npoints) : 0;
    snprintf(path, sizeof path, "%s/realisations.jsonl", s->params->folder);
    if (access(path, F_OK) != 0) return PH_OK;
    PH_TRY(ph_i_store_open(&store, s->params->folder, c, err));
    for (size_t k = 0; k < store.count; k++)
        *pilots += store.entry[k].i < s->pilots;
    *there = fmax(*there, (double)store.count);
out:
    ph_i_store_close(&store);
    if (st != PH_OK) ph_error_prefix(err, "size: %s: ", s->report->why);
    return st;
}

/* Pilots of the chosen size are realisations of the campaign. */
static ph_status take_pilots(const ph_i_chooser *s, const ph_campaign *c, int64_t pilots,
                             ph_error *err)
{
    const ph_split_answer *a = s->report->answer;
    const ph_split_candidate *best = &a->candidate[a->chosen];
    const char *const from[] = {s->option[s->tried[best->size]].folder};
    ph_campaign_result *r = NULL;
    if (best->grid != 0 || pilots >= s->pilots * c->npoints) return PH_OK;
    ph_status st = ph_campaign_merge(c, s->params->folder, from, 1, &r, err);
    ph_campaign_result_free(&r);
    return st == PH_EPARTIAL ? PH_OK : st;
}

/* Is there time for it, as the pilots took it? Where nothing is known of that, it is begun. */
static ph_status check_time(const ph_i_chooser *s, const ph_split_question *q,
                            const ph_campaign *c, double there, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_campaign_sizes *r = s->report;
    const ph_split_answer *a = r->answer;
    const ph_split_candidate *best = &a->candidate[a->chosen];
    double rate = s->option[s->tried[best->size]].rate, left = ph_i_time_left(s);
    double to_go = best->cost * fmax(best->needed - there, 0) / best->needed;
    int workers, threads;
    if (!isfinite(left) || !isfinite(rate) || to_go == 0) return PH_OK;
    ph_i_crew_choose(c, s->params, &workers, &threads);
    double takes = to_go * rate / workers, per = r->absolute ? 1 : 100;
    PH_CHECK(
        takes <= left, PH_ENOCONV,
        "budget.seconds: %.3g are left after the pilots, and %.3g%s takes about %.2g: "
        "%.0f realisations more; what is left affords about %.2g%s",
        fmax(left, 0), per * r->accuracy, r->absolute ? "" : " %", takes,
        best->needed - there,
        per * ph_split_afforded(q, a, fmax(left, 0) * workers / rate),
        r->absolute ? "" : " %");
out:
    return st;
}

static ph_status begin(ph_i_chooser *s, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_campaign *c = s->c;
    const ph_stopping *rule = &c->stopping;
    PH_CHECK(!(c->relative_error > 0) || rule->relative_half_width > 0, PH_EINVAL, "%s",
             ph_i_grid_words);
    PH_ALLOC(s->report, 1, "the sizes");
    s->report->absolute = rule->half_width > 0;
    s->report->accuracy = rule->half_width > 0    ? rule->half_width
                          : c->relative_error > 0 ? c->relative_error
                                                  : rule->relative_half_width;
    s->report->exponent = ph_i_fidelity_axes(c->point[0].c);
    for (int p = 0; p < c->npoints; p++) {
        const char *kind = c->point[p].c->constraint.kind;
        PH_CHECK(!ph_i_is_open(c->point[p].c), PH_EINVAL, "%s", ph_i_open_words);
        /* what closes the cell is felt in a layer along its faces */
        if (kind && strcmp(kind, "periodic") != 0) s->report->exponent = 1;
    }
    s->pilots = rule->at_least > PH_I_PILOTS ? rule->at_least : PH_I_PILOTS;
    ph_i_options_make(s);
out:
    return st;
}

ph_status ph_campaign_choose_size(ph_campaign **c, const char *const *sets, size_t nsets,
                                  const ph_campaign_params *params, ph_error *err)
{
    PH_GIVEN(c && *c && params && params->folder && (sets || nsets == 0));
    ph_status st = PH_OK;
    ph_split_question q;
    ph_campaign *next = NULL;
    double factor[PH_SPLIT_SIZES], *value = NULL, *cost = NULL, there = 0;
    int64_t pilots = 0;
    ph_i_chooser s = {
        .c = *c, .sets = sets, .nsets = nsets, .params = params, .start = ph_i_clock()};
    if ((*c)->nfactors == 0 || ((*c)->sizes && (*c)->sizes->chosen)) return PH_OK;
    ph_i_sizes_free(&(*c)->sizes);
    PH_TRY(begin(&s, err));
    PH_TRY(weigh(&s, &q, &value, &cost, factor, err));
    PH_TRY(make_campaign(&s, &next, err));
    PH_TRY(count(&s, next, &pilots, &there, err));
    PH_TRY(check_time(&s, &q, next, there, err));
    PH_TRY(take_pilots(&s, next, pilots, err));
    s.report->chosen = true;
    next->sizes = s.report;
    s.report = NULL;
    ph_campaign_free(c);
    *c = next;
    next = NULL;
out:
    if (s.report && s.report->ntried > 0) { /* why it came to nothing */
        (*c)->sizes = s.report;
        s.report = NULL;
    }
    for (int i = 0; i < s.noptions; i++)
        ph_i_option_clear(&s.option[i]);
    free(value);
    free(cost);
    ph_campaign_free(&next);
    ph_i_sizes_free(&s.report);
    return st;
}
