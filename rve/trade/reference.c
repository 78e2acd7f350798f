/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which constants are judged, and against what. */
#include <perihom/effective.h>

#include "io/text.h"
#include "trade/trade.h"

#include <math.h>
#include <string.h>

static void add_constant(const ph_case *c, const char *name, ph_quantity *out, int *n)
{
    ph_quantity q;
    if (*n >= PH_TRADE_CONSTANTS || ph_quantity_find(name, &q, NULL) != PH_OK) return;
    if (ph_scenario_admits(c, &q, NULL) == PH_OK) out[(*n)++] = q;
}

/* Longest relaxation time of the phases; 0: nothing relaxes. */
static double longest_time(const ph_case *c)
{
    double t = 0;
    for (int m = 0; m < c->nmaterials; m++) {
        const ph_prony *p = c->materials[m].relaxation;
        for (int k = 0; p && k < p->nterms; k++)
            t = fmax(t, p->term[k].time);
    }
    return t;
}

int ph_trade_constants(const ph_case *c, ph_quantity *out)
{
    static const char *const elastic[] = {"E1",   "E2",  "E3",  "nu12", "nu13",
                                          "nu23", "G23", "G13", "G12"};
    static const char *const moduli[] = {"E1", "E2", "G12"};
    int n = 0;
    if (!c || !out) return 0;
    ph_case closed = *c; /* on any grid */
    closed.accuracy.relative = 0;
    double late = longest_time(c);
    for (size_t i = 0; late == 0 && i < sizeof elastic / sizeof *elastic; i++)
        add_constant(&closed, elastic[i], out, &n);
    for (size_t i = 0; late > 0 && i < sizeof moduli / sizeof *moduli; i++) {
        char name[64];
        add_constant(&closed, moduli[i], out, &n);
        snprintf(name, sizeof name, "%s(t=%.12g)", moduli[i], late);
        add_constant(&closed, name, out, &n);
    }
    return n;
}

double ph_trade_error(const ph_quantity *q, double value, double reference)
{
    if (!q) return NAN;
    double size = fabs(reference);
    if (q->stress == 0) size = fmax(size, 0.1);
    return size > 0 ? fabs(value - reference) / size : fabs(value - reference);
}

static ph_status name_constants(ph_i_trade *s, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_trade_params *p = s->params;
    ph_trade *t = s->t;
    PH_CHECK(p->nconstants <= PH_TRADE_CONSTANTS, PH_EINVAL,
             "%zu constants: at most %d are admissible", p->nconstants,
             PH_TRADE_CONSTANTS);
    for (size_t i = 0; i < p->nconstants; i++) {
        ph_quantity *q = &t->constant[t->nconstants];
        PH_TRY(ph_quantity_find(p->constants[i], q, err));
        PH_TRY(ph_scenario_admits(s->c, q, err));
        t->nconstants++;
    }
out:
    return st;
}

/* E1=143.9,G12=45.8: these are then the constants, where none are named. */
static ph_status read_values(ph_i_trade *s, const char *text, ph_error *err)
{
    ph_status st = PH_OK;
    ph_trade *t = s->t;
    bool named = t->nconstants > 0, found[PH_TRADE_CONSTANTS] = {false};
    for (const char *at = text; *at;) {
        char name[96], number[64];
        double x;
        int used = 0;
        ph_quantity q;
        PH_CHECK(sscanf(at, "%95[^=,]=%63[^,]%n", name, number, &used) == 2 && used > 0 &&
                     ph_i_text_to_number(number, &x),
                 PH_EINVAL, "reference: '%.80s' is not NAME=NUMBER,NAME=NUMBER...", at);
        at += used;
        if (*at == ',') at++;
        PH_TRY(ph_quantity_find(name, &q, err));
        PH_TRY(ph_scenario_admits(s->c, &q, err));
        int k = 0;
        while (k < t->nconstants && strcmp(t->constant[k].name, q.name) != 0)
            k++;
        if (k == t->nconstants && named) continue; /* not asked for */
        PH_CHECK(k < PH_TRADE_CONSTANTS, PH_EINVAL, "reference: too many constants");
        if (k == t->nconstants) t->constant[t->nconstants++] = q;
        t->reference[k] = x;
        found[k] = true;
    }
    for (int k = 0; k < t->nconstants; k++)
        PH_CHECK(found[k], PH_EINVAL, "reference: there is no value of %s",
                 t->constant[k].name);
out:
    return st;
}

/* A result document: every constant of its stiffness. */
static ph_status read_result(ph_i_trade *s, const char *path, ph_error *err)
{
    ph_status st = PH_OK;
    ph_trade *t = s->t;
    ph_effective *e = NULL;
    PH_TRY(ph_effective_read(path, &e, err));
    PH_CHECK(e->kinematics == s->c->kinematics, PH_EINVAL,
             "%.200s: a result of another kinematics than that of the case", path);
    if (t->nconstants == 0) t->nconstants = ph_trade_constants(s->c, t->constant);
    const ph_result result = {.stiffness = e->stiffness,
                              .loads = (1u << e->stiffness.n) - 1u,
                              .grid = {.kinematics = e->kinematics},
                              .relaxation = e->relaxation};
    for (int k = 0; k < t->nconstants; k++)
        PH_TRY(ph_quantity_value(&t->constant[k], &result, &t->reference[k], err));
out:
    ph_effective_free(&e);
    return st;
}

/* What errors can be relative to. */
static ph_status check_reference(const ph_trade *t, ph_error *err)
{
    ph_status st = PH_OK;
    for (int k = 0; k < t->nconstants; k++) {
        const ph_quantity *q = &t->constant[k];
        bool good = isfinite(t->reference[k]) && (q->stress == 0 || t->reference[k] != 0);
        PH_CHECK(
            good, PH_EINVAL,
            "reference: %s is %g: no error is relative to that; name other constants",
            q->name, t->reference[k]);
    }
out:
    return st;
}

/* What no sweep can be judged of. */
static ph_status check_case(const ph_case *c, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(
        c->loading.ntargets == 0 && !c->strengths, PH_EINVAL,
        "a trade is of effective constants, not of bonds that break: the case has %s",
        c->loading.ntargets ? "a loading" : "failure");
out:
    return st;
}

ph_status ph_i_trade_begin(ph_i_trade *s, ph_error *err)
{
    ph_status st = PH_OK;
    const char *reference = s->params->reference;
    PH_TRY(check_case(s->c, err));
    PH_TRY(name_constants(s, err));
    if (reference && strchr(reference, '='))
        PH_TRY(read_values(s, reference, err));
    else if (reference)
        PH_TRY(read_result(s, reference, err));
    else if (s->t->nconstants == 0)
        s->t->nconstants = ph_trade_constants(s->c, s->t->constant);
    PH_CHECK(s->t->nconstants > 0, PH_EINVAL, "there is no constant to judge");
    s->given = reference != NULL;
    if (s->given) PH_TRY(check_reference(s->t, err));
    if (reference)
        snprintf(s->t->reference_kind, sizeof s->t->reference_kind, "given: %.150s",
                 reference);
out:
    return st;
}

/* A grid of the case as it is? */
static bool is_base(const ph_trade_row *r)
{
    return !r->family[0] && r->realisations == 1 && strcmp(r->knob, "grid") == 0;
}

/* The solved grid of the case as it is whose cells are nearest to so many. */
static const ph_trade_row *base_row(const ph_trade *t, double cells)
{
    const ph_trade_row *best = NULL;
    for (int i = 0; i < t->nrows; i++) {
        const ph_trade_row *r = &t->row[i];
        if (r->state != PH_TRADE_DONE || !is_base(r)) continue;
        double mine = fabs(log((double)r->nodes / cells));
        if (!best || mine < fabs(log((double)best->nodes / cells))) best = r;
    }
    return best;
}

/* "12 x 12" of microstructure.nodes=[12,12]. */
static void nodes_text(const ph_trade_row *r, char *text, size_t size)
{
    const char *at = NULL;
    size_t n = 0;
    for (int i = 0; i < r->nsets && !at; i++)
        if (strncmp(r->set[i], "microstructure.nodes=[", 22) == 0) at = r->set[i] + 22;
    snprintf(text, size, "%td", r->nodes);
    for (; at && *at && *at != ']' && n + 4 < size; at++)
        n += (size_t)snprintf(text + n, size - n, *at == ',' ? " x " : "%c", *at);
}

bool ph_i_trade_has_reference(const ph_trade *t)
{
    for (int k = 0; k < t->nconstants; k++)
        if (!isfinite(t->reference[k])) return false;
    return true;
}

/* The first grid of the case as it is that has no solution; how many have one. */
static const ph_trade_row *first_unsolved(const ph_trade *t, int *solved)
{
    const ph_trade_row *first = NULL;
    *solved = 0;
    for (int i = 0; i < t->nrows; i++) {
        const ph_trade_row *r = &t->row[i];
        if (!is_base(r)) continue;
        *solved += r->state == PH_TRADE_DONE;
        if (!first && r->state != PH_TRADE_DONE) first = r;
    }
    return first;
}

void ph_i_trade_say_unsolved(ph_trade *t)
{
    int solved;
    const ph_trade_row *first = first_unsolved(t, &solved);
    t->unsolved[0] = 0;
    if (!solved)
        snprintf(t->unsolved, sizeof t->unsolved, "%s",
                 first ? first->reason : "no grid was tried");
}

/* A grid is no reference of itself. */
static void have_none(ph_trade *t)
{
    int solved;
    const ph_trade_row *first = first_unsolved(t, &solved);
    for (int k = 0; k < t->nconstants; k++)
        t->reference[k] = NAN;
    t->complete = false;
    snprintf(t->reference_kind, sizeof t->reference_kind, "none: %s%s%s",
             solved ? "only one grid of the case is solved"
                    : "the case itself is not solved",
             first ? "; " : "", first ? first->reason : "");
}

void ph_i_trade_find_reference(ph_trade *t)
{
    const ph_trade_row *fine = base_row(t, 1e30), *coarse = NULL;
    char fine_text[64], coarse_text[64];
    int axes = t->axes > 0 ? t->axes : 2;
    t->reference_error = NAN;
    if (fine) coarse = base_row(t, (double)fine->nodes * pow(0.5, axes));
    if (!coarse || coarse->nodes >= fine->nodes) {
        have_none(t);
        return;
    }
    double ratio = pow((double)fine->nodes / (double)coarse->nodes, 1.0 / axes);
    nodes_text(fine, fine_text, sizeof fine_text);
    nodes_text(coarse, coarse_text, sizeof coarse_text);
    snprintf(t->reference_kind, sizeof t->reference_kind,
             "own finest grid, %s nodes, extrapolated with %s", fine_text, coarse_text);
    t->reference_error = 0;
    for (int k = 0; k < t->nconstants; k++) {
        t->reference[k] =
            fine->value[k] + (fine->value[k] - coarse->value[k]) / (ratio - 1);
        t->reference_error =
            fmax(t->reference_error,
                 ph_trade_error(&t->constant[k], fine->value[k], t->reference[k]));
    }
}
