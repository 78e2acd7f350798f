/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A macro strain lambda E that grows, bonds that break.
 *
 * While no bond breaks the displacement is lambda times that of the unit load, so that the
 * load of the next break is known without stepping: lambda_b = s_c / s_b(1), least over the
 * intact bonds. An event takes these bonds away at that load and solves anew, from the last
 * displacement. Which bonds break next does not depend on the load, so that one sequence of
 * events serves two paths: the load follows every event, up and down (crack-length control),
 * or it only grows and bonds break at once that would break at less (controlled strain).
 *
 * With u- before and u+ after, both in equilibrium, the energies of the unit load differ by
 * W- - W+ = 1/2 sum k e- e+ over the bonds that went: what was dissipated, known from the
 * bonds alone, where the mean stress and the stored energy are known from all others. */
#include "effective/failure_scan.h"
#include "effective/unit_load.h"

#include <math.h>
#include <string.h>

/* Below this share of the pristine stiffness nothing is left but the solver's tolerance. */
static const double nothing_left = 1e-5;

typedef struct ph_walk {
    ph_run *run;
    const ph_loading *loading;
    ph_failure_path *path;
    ph_strengths *strengths;
    ph_scan *scan;
    ph_unit_load unit;
    double pristine; /* energy of the unit load at the beginning */
    int stiffnesses; /* that were solved */
    double load;     /* controlled strain */
    double last;     /* load of the last event, by its size */
    ph_failure_energy events, controlled;
} ph_walk;

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

/* Of the bonds picked, per volume and unit load: their energy, and what goes with them. */
static void energies_of_picked(const ph_walk *w, double *fracture, double *gone)
{
    double cells = (double)w->run->setting.averaged;
    *fracture = *gone = 0.0;
    for (ptrdiff_t i = 0; i < w->scan->npicked; i++) {
        const ph_picked *k = &w->scan->picked[i];
        double half = 0.5 * stiffness_of(w, k) * k->pull / cells;
        *fracture += half * k->pull;
        *gone += half * ph_i_scan_pull(w->scan, w->unit.u, k->x, k->b, k->y);
    }
}

static void account(ph_walk *w, double load, double before, double energy_before,
                    ph_failure_event *e)
{
    ph_failure_path *p = w->path;
    double fracture, gone, size = load * load;
    energies_of_picked(w, &fracture, &gone);
    if (!w->run->classes) { /* no springs: what the energies say */
        gone = 0.5 * (energy_before - w->unit.energy);
        fracture = NAN;
    }
    w->events.external += 0.5 * before * (size - w->last * w->last);
    w->last = load;
    w->events.stored = 0.5 * w->unit.energy * size;
    w->events.fracture += fracture * size;
    w->events.dissipated += gone * size;
    w->controlled.fracture = w->events.fracture;
    w->controlled.dissipated += gone * w->load * w->load;
    w->controlled.stored = 0.5 * w->unit.energy * w->load * w->load;
    *e = (ph_failure_event){.load = w->load < 0.0 ? -load : load,
                            .time = (double)NAN,
                            .broken = w->run->broken->pairs,
                            .energy = w->events,
                            .iterations = w->unit.iterations,
                            .residual = w->unit.residual};
    e->before = before * e->load;
    e->after = w->unit.work * e->load;
    double off = w->events.external - w->events.stored - w->events.dissipated;
    p->imbalance = fmax(p->imbalance, fabs(off));
    if (p->nevents == 1) p->first_load = e->load;
}

/* Take away what was picked at this load > 0 and solve anew. */
static ph_status take_event(ph_walk *w, double load, double sign, ph_error *err)
{
    ph_status st = PH_OK;
    ph_run *r = w->run;
    ph_failure_event *e = NULL;
    double before = w->unit.work, energy = w->unit.energy;
    if (load > sign * w->load) move_controlled(w, sign * load);
    PH_TRY(ph_i_failure_keep_bonds(r, w->scan, err));
    for (ptrdiff_t i = 0; i < w->scan->npicked; i++)
        PH_TRY(ph_i_break(r->broken, w->scan->picked[i].x, w->scan->picked[i].b, err));
    PH_TRY(ph_i_broken_settle(r->broken, err));
    PH_TRY(ph_i_run_rebuild(r, err));
    PH_TRY(ph_i_unit_load_solve(&w->unit, err));
    PH_TRY(ph_i_failure_event(w->path, &e, err));
    account(w, load, before, energy, e);
    w->path->apart = w->unit.apart;
    w->path->severed = w->unit.energy <= nothing_left * w->pristine;
out:
    return st;
}

/* Everything that breaks on the way to a load. */
static ph_status break_until(ph_walk *w, double load, ph_error *err)
{
    ph_status st = PH_OK;
    double sign = load < 0.0 ? -1.0 : 1.0, most = fabs(load);
    double window = w->path->window;
    while (!w->path->severed) {
        double least = ph_i_scan_least(w->scan, w->unit.u, sign);
        if (!(least <= most)) break;
        double limit = w->loading->together ? most : least * (1.0 + window);
        PH_TRY(ph_i_scan_pick(w->scan, w->unit.u, sign, limit, err));
        PH_TRY(take_event(w, w->loading->together ? most : least, sign, err));
    }
    move_controlled(w, load);
out:
    return st;
}

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
        PH_TRY(break_until(w, k == l->steps ? l->to[t] : from + share * (l->to[t] - from),
                           err));
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
    if (p->cracks && p->cracks->count > 0) {
        PH_TRY(ph_i_cracks_cut(p->cracks, &r->result->grid, r->setting.first, false,
                               r->broken, err));
        PH_TRY(ph_i_run_rebuild(r, err));
    }
    PH_TRY(ph_i_failure_path_new(r, err));
    w->path = r->result->failure;
    if (!r->classes)
        ph_i_note(r->result, "failure: strengths from a fracture energy are those of "
                             "springs; model nosb dissipates less, see the manual");
    PH_TRY(ph_i_strengths_new(r, p->failure, &w->strengths, err));
    PH_TRY(ph_i_scan_new(r, w->strengths, w->unit.macro, &w->scan, err));
    PH_TRY(ph_i_unit_load_solve(&w->unit, err));
    w->pristine = w->unit.energy;
out:
    return st;
}

static int stiffness_steps(const ph_problem *p)
{
    return wants_first(p) + ph_i_stiffness_steps(p->loading);
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
out:
    ph_i_scan_free(&w.scan);
    ph_i_strengths_free(&w.strengths);
    ph_i_unit_load_clear(&w.unit);
    return st;
}
