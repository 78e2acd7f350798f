/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The loading of a failure, step by step. */
#include <perihom/damage_law.h>

#include "effective/failure_walk.h"

#include <math.h>
#include <string.h>

/* ---- results ----------------------------------------------------------------------------- */

static void keep_step(ph_walk *w, int number)
{
    ph_failure_step *s = &w->path->step[number];
    int ns = w->run->map->ns;
    s->load = w->load;
    s->time = (double)NAN;
    for (int i = 0; i < ns; i++) { /* Mandel to Voigt */
        double shear = i < (ns == 3 ? 2 : 3) ? 1.0 : sqrt(0.5);
        s->stress[i] = w->unit.stress[i] * w->load * shear;
        s->strain[i] = w->unit.strain[i] * w->load / shear;
    }
    s->work = w->unit.work * w->load;
    s->broken = w->run->broken->pairs;
    s->events = w->path->nevents;
    s->energy = w->controlled;
}

/* The cell before the loading has a stiffness of its own where cracks cut it. */
static bool wants_first(const ph_problem *p)
{
    return p->loading->stiffness_every > 0 && p->cracks && p->cracks->count > 0;
}

static ph_status keep_stiffness(ph_walk *w, double density, ph_error *err)
{
    ph_damage_step *s = &w->run->result->damage->step[w->stiffnesses++];
    s->value = w->load;
    s->density = density;
    for (int i = 0, n = w->path->n; i < n; i++)
        s->strain[i] =
            w->unit.strain[i] * w->load * (i < (n == 3 ? 2 : 3) ? 1.0 : sqrt(2.0));
    return ph_i_damage_step(w->run, s, w->path->apart, err);
}

static ph_status walk_steps(ph_walk *w, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_loading *l = w->loading;
    const ph_cracks *cracks = w->run->problem->cracks;
    double density = cracks ? ph_cracks_density(cracks, &w->run->result->grid) : 0.0;
    int last = l->ntargets * l->steps;
    keep_step(w, 0);
    if (wants_first(w->run->problem)) PH_TRY(keep_stiffness(w, density, err));
    for (int i = 1; i <= last; i++) {
        int t = (i - 1) / l->steps, k = (i - 1) % l->steps + 1;
        double from = t > 0 ? l->to[t - 1] : 0.0, share = (double)k / l->steps;
        PH_TRY(ph_i_walk_to(w,
                            k == l->steps ? l->to[t] : from + share * (l->to[t] - from),
                            i == last, err));
        keep_step(w, i);
        if (!ph_i_wants_stiffness(l, i)) continue;
        PH_TRY(keep_stiffness(w, density, err));
    }
out:
    return st;
}

static ph_status start(ph_walk *w, ph_error *err)
{
    ph_status st = PH_OK;
    ph_run *r = w->run;
    const ph_problem *p = r->problem;
    PH_TRY(ph_i_unit_load_init(&w->unit, r, w->loading->strain, w->loading->stress_free,
                               err));
    PH_TRY(ph_i_failure_begin(r, err));
    w->path = r->result->failure;
    if (!r->classes)
        ph_i_note(r->result, "failure: strengths from a fracture energy are those of "
                             "springs; model nosb dissipates less, see the manual");
    PH_TRY(ph_i_strengths_new(r, p->failure, &w->strengths, err));
    PH_TRY(ph_i_scan_new(r, w->strengths, w->unit.macro, &w->scan, err));
    PH_TRY(ph_i_walk_start(w, err));
out:
    return st;
}

static int stiffness_steps(const ph_problem *p)
{
    return wants_first(p) + ph_i_stiffness_steps(p->loading);
}

/* A damage law knows what the stiffness was at some steps only, unless all are kept. */
static ph_status note_law(const ph_run *r, ph_error *err)
{
    ph_status st = PH_OK;
    ph_damage_law *law = NULL;
    ph_error why = PH_ERROR_INIT;
    if (r->problem->loading->stiffness_every == 1 || r->result->failure->nevents == 0)
        return PH_OK;
    st = ph_damage_law_from_result(r->result, &law, &why);
    if (st == PH_EINVAL) return PH_OK; /* there is none */
    PH_CHECK(st == PH_OK, st, "%s", why.msg);
    ph_i_note(
        r->result,
        "the damage law has %d knots: loading.stiffness_every: 1 records every step",
        law->nknots);
out:
    ph_damage_law_free(&law);
    return st;
}

ph_status ph_i_run_failure(ph_run *r, ph_error *err)
{
    ph_status st = PH_OK;
    ph_walk w = {.run = r, .loading = r->problem->loading};
    PH_TRY(ph_i_check_loading(r, err));
    PH_TRY(ph_i_damage_begin(r, PH_SEQUENCE_LOADING, stiffness_steps(r->problem), err));
    PH_TRY(start(&w, err));
    PH_TRY(walk_steps(&w, err));
    ph_i_damage_measures(r->result);
    w.path->toughness = w.controlled.external;
    double most = 0.0;
    for (ptrdiff_t i = 0; i < w.path->nevents; i++)
        most = fmax(most, w.path->event[i].energy.external);
    if (most > 0.0) w.path->imbalance /= most;
    PH_TRY(note_law(r, err));
out:
    ph_i_walk_clear(&w);
    ph_i_scan_free(&w.scan);
    ph_i_strengths_free(&w.strengths);
    ph_i_unit_load_clear(&w.unit);
    return st;
}
