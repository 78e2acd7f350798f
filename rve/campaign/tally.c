/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Statistics of the points. Results come in any order and count in the order of their
 * indices: so the numbers do not depend on who was faster. */
#include "campaign/campaign.h"

#include <string.h>

ph_status ph_i_tally_init(ph_i_tally *t, const ph_campaign *c, ph_error *err)
{
    ph_status st = PH_OK;
    *t = (ph_i_tally){.c = c};
    ph_stopping fixed = {1, c->stopping.at_most, 0, 0, c->stopping.confidence};
    PH_ALLOC(t->point, ph_i_slots(c), "the statistics of the points");
    PH_ALLOC(t->all, (size_t)c->npoints * (size_t)c->noutputs, "the statistics");
    if (c->nmodels > 1) PH_TRY(ph_i_variance_begin(t, err));
    for (int p = 0; p < c->npoints; p++) {
        t->point[p].output = &t->all[(size_t)p * (size_t)c->noutputs];
        for (int k = 0; k < c->noutputs; k++)
            PH_TRY(ph_sequence_start(
                &t->point[p].output[k],
                k == c->judged && c->nmodels <= 1 ? &c->stopping : &fixed, err));
    }
out:
    if (st != PH_OK) ph_i_tally_clear(t);
    return st;
}

void ph_i_tally_clear(ph_i_tally *t)
{
    for (int p = 0; t->point && p < ph_i_slots(t->c); p++) {
        for (size_t k = 0; k < t->point[p].nwaiting; k++)
            free(t->point[p].waiting[k].value);
        free(t->point[p].waiting);
        for (int k = 0; k < PH_MAX_OUTPUTS; k++)
            free(t->point[p].kept[k]);
    }
    free(t->point);
    free(t->all);
    free(t->estimation);
    *t = (ph_i_tally){0};
}

static const ph_sequence *judge(const ph_i_tally *t, int point)
{
    return &t->point[point].output[t->c->judged >= 0 ? t->c->judged : 0];
}

int64_t ph_i_tally_wanted(const ph_i_tally *t, int point)
{
    const ph_i_point_tally *p = &t->point[point];
    int64_t most = t->c->stopping.at_most;
    if (p->done) return p->next;
    if (t->estimation)
        return t->estimation[point % t->c->npoints].want[point / t->c->npoints];
    int64_t wanted = judge(t, point)->target + p->failed;
    return wanted < most ? wanted : most;
}

static ph_status count(ph_i_tally *t, int point, bool failed, int iterations,
                       const double *value, ph_error *err)
{
    ph_i_point_tally *p = &t->point[point];
    p->failed += failed;
    for (int k = 0; k < t->c->noutputs && !failed && p->output; k++)
        ph_sequence_add(&p->output[k], value[k]);
    if (t->estimation) return ph_i_variance_add(t, point, failed, iterations, value, err);
    p->next++;
    p->done = judge(t, point)->done || p->next >= t->c->stopping.at_most;
    return PH_OK;
}

/* ---- those that came early: a heap, least index on top ---- */

static void swap(ph_i_waiting *a, ph_i_waiting *b)
{
    ph_i_waiting c = *a;
    *a = *b;
    *b = c;
}

static ph_status push(ph_i_tally *t, ph_i_point_tally *p, const ph_i_record *r,
                      ph_error *err)
{
    ph_status st = PH_OK;
    if (p->nwaiting == p->room) {
        size_t room = 2 * p->room + 8;
        ph_i_waiting *grown = realloc(p->waiting, room * sizeof *grown);
        PH_CHECK(grown, PH_ENOMEM, "no memory for realisations");
        p->waiting = grown;
        p->room = room;
    }
    double *value;
    size_t width = (size_t)ph_i_slot_values(t->c, r->point);
    PH_ALLOC(value, width, "a realisation");
    memcpy(value, r->value, sizeof *value * width);
    size_t at = p->nwaiting++;
    p->waiting[at] = (ph_i_waiting){r->i, r->status != PH_OK, r->iterations, value};
    while (at > 0 && p->waiting[(at - 1) / 2].i > p->waiting[at].i) {
        swap(&p->waiting[(at - 1) / 2], &p->waiting[at]);
        at = (at - 1) / 2;
    }
out:
    return st;
}

static ph_i_waiting pop(ph_i_point_tally *p)
{
    ph_i_waiting top = p->waiting[0];
    p->waiting[0] = p->waiting[--p->nwaiting];
    for (size_t at = 0;;) {
        size_t least = at;
        for (size_t child = 2 * at + 1; child <= 2 * at + 2; child++)
            if (child < p->nwaiting && p->waiting[child].i < p->waiting[least].i)
                least = child;
        if (least == at) return top;
        swap(&p->waiting[least], &p->waiting[at]);
        at = least;
    }
}

ph_status ph_i_tally_add(ph_i_tally *t, const ph_i_record *r, ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_point_tally *p = &t->point[r->point];
    if (p->done || r->i < p->next) goto out;
    if (r->i > p->next) {
        PH_TRY(push(t, p, r, err));
        goto out;
    }
    PH_TRY(count(t, r->point, r->status != PH_OK, r->iterations, r->value, err));
    while (p->nwaiting > 0 && p->waiting[0].i <= p->next) {
        ph_i_waiting w = pop(p);
        if (w.i == p->next && !p->done)
            st = count(t, r->point, w.failed, w.iterations, w.value, err);
        free(w.value);
        PH_TRY(st);
    }
out:
    return st;
}

ph_status ph_i_tally_load(ph_i_tally *t, ph_i_store *s, bool skip_failed, ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_record r;
    for (size_t k = 0; k < s->count; k++) {
        if (skip_failed && s->entry[k].failed) continue;
        PH_TRY(ph_i_store_get(s, &s->entry[k], &r, err));
        PH_TRY(ph_i_tally_add(t, &r, err));
    }
out:
    return st;
}
