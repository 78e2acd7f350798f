/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the realisations come to. */
#include "campaign/campaign.h"

#include <math.h>
#include <string.h>

void ph_campaign_result_free(ph_campaign_result **result)
{
    if (!result || !*result) return;
    free((*result)->point);
    free((*result)->all);
    free((*result)->estimation);
    free(*result);
    *result = NULL;
}

static bool is_reached(const ph_campaign *c, const ph_i_point_tally *t)
{
    if (c->judged < 0) return t->done;
    ph_interval i = ph_sequence_interval(&t->output[c->judged]);
    double d = c->stopping.half_width > 0.0
                   ? c->stopping.half_width
                   : c->stopping.relative_half_width * fabs(i.mean);
    return t->done && i.half_width <= d;
}

static void take_point(const ph_campaign *c, const ph_i_point_tally *t,
                       ph_campaign_summary *s)
{
    s->counted = t->next;
    s->failed = t->failed;
    s->complete = t->done;
    s->reached = is_reached(c, t);
    for (int k = 0; k < c->noutputs; k++)
        s->output[k] = (ph_campaign_mean){
            t->output[k].n, ph_sequence_interval(&t->output[k]), {NAN, NAN, NAN, NAN, 0}};
}

/* Means by the cheaper models; the deviation stays that of the case itself. */
static void take_estimation(const ph_i_tally *t, int point, ph_campaign_result *r)
{
    ph_campaign_summary *s = &r->point[point];
    r->estimation[point] = t->estimation[point];
    s->estimation = &r->estimation[point];
    s->reached = s->complete && (s->estimation->reached || t->c->judged < 0);
    for (int k = 0; k < t->c->noutputs; k++) {
        ph_i_variance_mean(t, point, k, &s->output[k].mean);
        s->output[k].bias = ph_i_variance_bias(t, point, k);
    }
}

ph_status ph_i_result_make(ph_i_store *store, ph_campaign_result **out, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_campaign *c = store->c;
    ph_campaign_result *r = NULL;
    ph_i_tally tally = {0};
    PH_TRY(ph_i_store_compact(store, err));
    PH_ALLOC(r, 1, "a result");
    PH_ALLOC(r->point, c->npoints, "the statistics of the points");
    PH_ALLOC(r->all, (size_t)c->npoints * (size_t)c->noutputs, "the statistics");
    PH_TRY(ph_i_tally_init(&tally, c, err));
    PH_TRY(ph_i_tally_load(&tally, store, false, err));
    if (c->nmodels > 1) PH_ALLOC(r->estimation, c->npoints, "the estimations");
    r->npoints = c->npoints;
    r->noutputs = c->noutputs;
    r->complete = true;
    for (int p = 0; p < c->npoints; p++) {
        r->point[p].output = &r->all[(size_t)p * (size_t)c->noutputs];
        take_point(c, &tally.point[p], &r->point[p]);
        if (r->estimation) take_estimation(&tally, p, r);
        r->complete = r->complete && r->point[p].complete;
    }
    r->realisations = (int64_t)store->count;
    for (size_t k = 0; k < store->count; k++)
        r->failed += store->entry[k].failed && store->entry[k].point < c->npoints;
    r->dropped = store->dropped;
    r->differing = store->differing;
    *out = r;
    r = NULL;
out:
    ph_i_tally_clear(&tally);
    ph_campaign_result_free(&r);
    return st;
}

ph_status ph_campaign_summarise(const ph_campaign *c, const char *folder,
                                ph_campaign_result **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_store store = {.lock = -1, .fd = -1};
    PH_CHECK(c && folder && out, PH_EINVAL, "NULL campaign, folder or result");
    *out = NULL;
    PH_TRY(ph_i_store_probe(c, folder, err));
    PH_TRY(ph_i_store_open(&store, folder, c, err));
    PH_TRY(ph_i_result_make(&store, out, err));
out:
    ph_i_store_close(&store);
    return st;
}

ph_status ph_campaign_merge(const ph_campaign *c, const char *folder,
                            const char *const *from, size_t nfrom,
                            ph_campaign_result **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_store store = {.lock = -1, .fd = -1};
    PH_CHECK(c && folder && out && (from || nfrom == 0), PH_EINVAL,
             "NULL campaign, folder, sources or result");
    *out = NULL;
    for (size_t k = 0; k < nfrom; k++)
        PH_TRY(ph_i_store_probe(c, from[k], err));
    PH_TRY(ph_i_store_open(&store, folder, c, err));
    for (size_t k = 0; k < nfrom; k++) {
        char path[1100];
        snprintf(path, sizeof path, "%s/realisations.jsonl", from[k]);
        PH_TRY(ph_i_store_merge(&store, path, err));
    }
    PH_TRY(ph_i_result_make(&store, out, err));
    if ((*out)->failed > 0)
        st = PH_FAIL(err, PH_EPARTIAL, "%lld of %lld realisations failed",
                     (long long)(*out)->failed, (long long)(*out)->realisations);
out:
    ph_i_store_close(&store);
    return st;
}
