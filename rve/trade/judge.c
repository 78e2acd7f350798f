/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Errors, the front of settings that nothing cheaper beats, and which one to take. */
#include "trade/trade.h"

#include <math.h>
#include <string.h>

static const double targets[PH_TRADE_TARGETS] = {0.03, 0.01, 0.003};

/* Rows that answer the question of the case: means over realisations answer another. */
static bool counts(const ph_trade_row *r)
{
    return r->state == PH_TRADE_DONE && r->realisations == 1 && isfinite(r->error) &&
           strcmp(r->knob, "threads") != 0;
}

/* Means over realisations: their scatter, and how far they are from the largest RVE. */
static void judge_means(ph_trade *t, ph_trade_row *row)
{
    const ph_trade_row *largest = NULL;
    for (int i = 0; i < t->nrows; i++) {
        const ph_trade_row *r = &t->row[i];
        if (r->realisations > 1 && r->state == PH_TRADE_DONE &&
            (!largest || r->nodes > largest->nodes))
            largest = r;
    }
    double off = 0;
    for (int k = 0; largest && k < t->nconstants; k++)
        off =
            fmax(off, ph_trade_error(&t->constant[k], row->value[k], largest->value[k]));
    row->error += off;
}

static void find_errors(ph_trade *t)
{
    bool known = ph_i_trade_has_reference(t);
    for (int i = 0; i < t->nrows; i++) {
        ph_trade_row *r = &t->row[i];
        r->front = false;
        if (r->state != PH_TRADE_DONE || r->realisations > 1) continue;
        r->error = known ? 0 : (double)NAN;
        for (int k = 0; known && k < t->nconstants; k++)
            r->error = fmax(
                r->error, ph_trade_error(&t->constant[k], r->value[k], t->reference[k]));
    }
}

static void find_front(ph_trade *t)
{
    for (int i = 0; i < t->nrows; i++) {
        ph_trade_row *r = &t->row[i];
        r->front = counts(r);
        for (int j = 0; r->front && j < t->nrows; j++) {
            const ph_trade_row *o = &t->row[j];
            if (i == j || !counts(o)) continue;
            bool no_worse = o->work <= r->work && o->error <= r->error;
            bool better = o->work < r->work || o->error < r->error || j < i;
            r->front = !(no_worse && better);
        }
    }
}

/* Every finer grid with the same settings is good too. */
static bool is_reliable(const ph_trade *t, const ph_trade_row *row, double target)
{
    if (row->error > target) return false;
    for (int i = 0; i < t->nrows; i++) {
        const ph_trade_row *r = &t->row[i];
        if (counts(r) && strcmp(r->family, row->family) == 0 &&
            strcmp(r->knob, row->knob) == 0 && r->nodes > row->nodes && r->error > target)
            return false;
    }
    return true;
}

void ph_trade_judge(ph_trade *t)
{
    if (!t) return;
    find_errors(t);
    find_front(t);
    for (int k = 0; k < PH_TRADE_TARGETS; k++) {
        ph_trade_advice *a = &t->advice[k];
        *a = (ph_trade_advice){.target = targets[k], .row = -1};
        for (int i = 0; i < t->nrows; i++) {
            const ph_trade_row *r = &t->row[i];
            if (!counts(r) || !is_reliable(t, r, targets[k])) continue;
            if (a->row < 0 || r->work < t->row[a->row].work) a->row = i;
        }
        if (a->row >= 0)
            ph_i_trade_command(t, &t->row[a->row], a->command, sizeof a->command);
    }
}

void ph_i_trade_judge_means(ph_trade *t)
{
    for (int i = 0; i < t->nrows; i++)
        if (t->row[i].realisations > 1 && t->row[i].state == PH_TRADE_DONE)
            judge_means(t, &t->row[i]);
}
