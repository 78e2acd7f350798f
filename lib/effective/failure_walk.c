/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effective/failure_walk.h"

#include <math.h>
#include <string.h>

/* Below this share of the pristine stiffness nothing is left but the solver's tolerance. */
static const double nothing_left = 1e-5;
/* The stretches of all bonds are known to this share of that of a bond that breaks, or to the
 * window: the energy of an error is that of the bonds' errors, sum k (de)^2, so that no bond
 * is off by more than sqrt(energy / k). */
static const double resolution = 0.01;

/* ---- the two paths ----------------------------------------------------------------------- */

static void note_peak(ph_walk *w)
{
    ph_failure_path *p = w->path;
    double stress = w->unit.work * w->load;
    if (fabs(stress) <= fabs(p->peak_stress)) return;
    p->peak_stress = stress;
    p->peak_load = w->load;
}

static void move_controlled(ph_walk *w, double load)
{
    w->controlled.external += 0.5 * w->unit.work * (load * load - w->load * w->load);
    w->load = load;
    w->controlled.stored = 0.5 * w->unit.energy * load * load;
    note_peak(w);
}

static double stiffness_of(const ph_walk *w, const ph_picked *k)
{
    return w->run->classes
               ? w->run->family->w[k->b] * ph_i_bond_modulus(w->run->classes, k->x, k->y)
               : 0.0;
}

/* ---- energies ---------------------------------------------------------------------------- */

/* 1/2 sum k e- e+ per volume over the bonds that broke since the box was settled. */
static double opened(const ph_walk *w, ptrdiff_t from)
{
    double sum = 0.0, cells = (double)w->run->setting.averaged;
    for (ptrdiff_t i = from; i < w->nopen; i++) {
        const ph_open_bond *o = &w->open[i];
        sum += 0.5 * o->k * o->e * ph_i_scan_pull(w->scan, w->unit.u, o->x, o->b, o->y);
    }
    return sum / cells;
}

static ph_failure_event *last_event(const ph_walk *w)
{
    return &w->path->event[w->path->nevents - 1];
}

/* Energy that the unit load has lost at the load of the last event. */
static void release(ph_walk *w, double gone)
{
    ph_failure_event *e = last_event(w);
    double size = e->load * e->load;
    w->released += gone;
    w->events.dissipated += gone * size;
    w->events.stored = 0.5 * w->unit.energy * size;
    w->controlled.dissipated += gone * w->load * w->load;
    w->controlled.stored = 0.5 * w->unit.energy * w->load * w->load;
    e->energy = w->events;
    e->after = w->unit.work * e->load;
}

/* The way to an event, and what its bonds held. */
static void account(ph_walk *w, double load, double fracture)
{
    ph_failure_event *e = last_event(w);
    double size = load * load;
    w->events.external += 0.5 * w->unit.work * (size - w->last * w->last);
    w->last = load;
    w->events.fracture += fracture * size;
    w->controlled.fracture = w->events.fracture;
    e->load = w->load < 0.0 ? -load : load;
    e->time = (double)NAN;
    e->broken = w->run->broken->pairs;
    e->before = w->unit.work * e->load;
    if (w->path->nevents == 1) w->path->first_load = e->load;
}

/* ---- equilibrium ------------------------------------------------------------------------- */

/* The whole box. */
static ph_status settle(ph_walk *w, ph_error *err)
{
    ph_status st = PH_OK;
    ph_run *r = w->run;
    ph_failure_path *p = w->path;
    ph_failure_event *e = last_event(w);
    double share = fmin(resolution, p->window), off;
    double most = share * share * w->critical / (e->load * e->load);
    PH_TRY(ph_i_broken_settle(r->broken, err));
    PH_TRY(ph_i_run_rebuild(r, err));
    PH_TRY(ph_i_unit_load_solve(&w->unit, w->loading->every_event ? 0.0 : most, err));
    release(w, (r->classes ? opened(w, 0) : 0.5 * (w->settled - w->unit.energy)) -
                   w->released);
    w->settled = w->unit.energy;
    w->released = 0.0;
    w->nopen = 0;
    w->stale = false;
    w->scanned = 0.0;
    ph_i_patch_go_on(w->patch, w->unit.u);
    e->iterations = w->unit.iterations;
    e->residual = w->unit.residual;
    off = w->events.external - w->events.stored - w->events.dissipated;
    p->imbalance = fmax(p->imbalance, fabs(off));
    p->apart = w->unit.apart;
    p->severed = w->unit.energy <= nothing_left * w->pristine;
out:
    return st;
}

ph_status ph_i_walk_start(ph_walk *w, ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(ph_i_unit_load_solve(&w->unit, 0.0, err));
    w->pristine = w->settled = w->unit.energy;
    if (w->run->classes && w->unit.single && !w->loading->together &&
        !w->loading->every_event)
        PH_TRY(ph_i_patch_new(w->run, &w->patch, err));
out:
    return st;
}

void ph_i_walk_clear(ph_walk *w)
{
    ph_i_patch_free(&w->patch);
    free(w->open);
}

/* ---- events ------------------------------------------------------------------------------ */

/* Do all bonds that were picked break within the patch? */
static bool patch_takes(const ph_walk *w)
{
    const ph_scan *s = w->scan;
    if (!w->patch || !w->patch->made || !ph_i_patch_has_room(w->patch, s->npicked))
        return false;
    for (ptrdiff_t i = 0; i < s->npicked; i++)
        if (!ph_i_patch_takes(w->patch, s->picked[i].x, s->picked[i].y)) return false;
    return true;
}

static ph_status more_open(ph_walk *w, ptrdiff_t more, ph_error *err)
{
    ph_status st = PH_OK;
    ptrdiff_t need = w->nopen + more;
    if (need > w->open_room) {
        void *q = realloc(w->open, (size_t)(2 * need) * sizeof *w->open);
        PH_CHECK(q, PH_ENOMEM, "no memory for %td open bonds", need);
        w->open = q;
        w->open_room = 2 * need;
    }
out:
    return st;
}

/* Take the bonds away that were picked, from the patch too. */
static ph_status break_picked(ph_walk *w, double load, bool in_patch, double *fracture,
                              ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(more_open(w, w->scan->npicked, err));
    *fracture = 0.0;
    for (ptrdiff_t i = 0; i < w->scan->npicked; i++) {
        const ph_picked *p = &w->scan->picked[i];
        ph_open_bond o = {p->x, p->b, p->y, stiffness_of(w, p), p->pull};
        if (in_patch && o.k > 0.0) o.e = ph_i_patch_break(w->patch, w->unit.u, p, o.k);
        PH_TRY(ph_i_break(w->run->broken, p->x, p->b, err));
        *fracture += 0.5 * o.k * p->pull * p->pull;
        w->critical = fmax(w->critical, o.k * p->pull * p->pull * load * load);
        w->open[w->nopen++] = o;
    }
    *fracture /= (double)w->run->setting.averaged;
out:
    return st;
}

/* What was picked breaks at this load > 0. */
static ph_status take_event(ph_walk *w, double load, double sign, ph_error *err)
{
    ph_status st = PH_OK;
    ph_failure_event *e = NULL;
    double fracture;
    bool in_patch = patch_takes(w);
    if (load > sign * w->load) move_controlled(w, sign * load);
    PH_TRY(ph_i_failure_keep_bonds(w->run, w->scan, err));
    PH_TRY(ph_i_failure_event(w->path, &e, err));
    PH_TRY(break_picked(w, load, in_patch, &fracture, err));
    w->stale = true;
    account(w, load, w->run->classes ? fracture : (double)NAN);
    if (in_patch) PH_TRY(ph_i_patch_relax(w->patch, w->unit.column[0].u, &in_patch, err));
    if (in_patch) {
        double gone = opened(w, 0) - w->released;
        w->unit.work -= 2.0 * gone;
        w->unit.energy -= 2.0 * gone;
        release(w, gone);
        ph_i_scan_cells(w->scan, w->unit.u, sign, w->patch->count, w->patch->node);
        if (w->unit.energy > nothing_left * w->pristine) return PH_OK;
    }
    ph_i_patch_forget(w->patch);
    PH_TRY(settle(w, err));
out:
    return st;
}

ph_status ph_i_walk_to(ph_walk *w, double load, bool last, ph_error *err)
{
    ph_status st = PH_OK;
    double sign = load < 0.0 ? -1.0 : 1.0, most = fabs(load);
    bool together = w->loading->together;
    while (!w->path->severed) {
        if (w->scanned != sign) ph_i_scan(w->scan, w->unit.u, sign);
        w->scanned = sign;
        double least = ph_i_scan_least(w->scan);
        if (!(least <= most)) break;
        double limit = together ? most : least * (1.0 + w->path->window);
        PH_TRY(ph_i_scan_pick(w->scan, w->unit.u, sign, limit, err));
        if (w->patch && !w->stale && !patch_takes(w))
            PH_TRY(ph_i_patch_make(w->patch, w->scan, least, w->unit.u, err));
        if (w->stale && !patch_takes(w))
            PH_TRY(settle(w, err));
        else
            PH_TRY(take_event(w, together ? most : least, sign, err));
    }
    move_controlled(w, load);
    if (w->stale && last) PH_TRY(settle(w, err));
    if (w->stale) PH_TRY(ph_i_unit_load_measure(&w->unit, err));
out:
    return st;
}
