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

static const double default_window = 1e-3;
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

/* ---- checks ------------------------------------------------------------------------------ */

static ph_status check_loading(const ph_run *r, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_loading *l = r->problem->loading;
    const ph_crack_sequence *q = r->problem->sequence;
    double size = 0.0;
    PH_CHECK(r->problem->failure && r->problem->failure->material, PH_EINVAL,
             "a loading needs to know when bonds break: give failure");
    PH_CHECK(!q || q->kind == PH_SEQUENCE_NONE, PH_EINVAL,
             "a sequence of cracks and a loading are two: give one of both");
    PH_CHECK(
        !r->classes || !r->setting.source, PH_EINVAL,
        "a loading and model bond take the collar inside: with a frame around the RVE "
        "its energies are not those of its bonds");
    for (int i = 0; i < ph_strains(r->result->grid.kinematics); i++) {
        PH_CHECK(!(l->stress_free >> i & 1) || l->strain[i] == 0.0, PH_EINVAL,
                 "strain %d of a loading is %g and found by zero stress: one of both",
                 i + 1, l->strain[i]);
        PH_CHECK(isfinite(l->strain[i]), PH_EINVAL, "strain %d of a loading is %g", i + 1,
                 l->strain[i]);
        size += fabs(l->strain[i]);
    }
    PH_CHECK(size > 0.0, PH_EINVAL, "the strain of a loading is zero");
    PH_CHECK(!(l->stress_free >> ph_strains(r->result->grid.kinematics)), PH_EINVAL,
             "components %#x of a loading are free of stress, %d are there",
             l->stress_free, ph_strains(r->result->grid.kinematics));
    PH_CHECK(l->ntargets > 0 && l->to && l->steps > 0, PH_EINVAL,
             "a loading has no target or no steps");
    for (int i = 0; i < l->ntargets; i++)
        PH_CHECK(isfinite(l->to[i]), PH_EINVAL, "target %d of a loading is %g", i + 1,
                 l->to[i]);
    PH_CHECK(l->window >= 0.0 && l->window <= 1.0, PH_EINVAL,
             "the window of a loading must be in [0, 1], got %g", l->window);
    PH_CHECK(l->stiffness_every >= 0, PH_EINVAL, "stiffness_every must be >= 0, got %d",
             l->stiffness_every);
out:
    return st;
}

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

static ph_status new_event(ph_failure_path *p, ph_failure_event **out, ph_error *err)
{
    ph_status st = PH_OK;
    if (p->nevents == p->event_room) {
        ptrdiff_t room = p->event_room ? 2 * p->event_room : 256;
        void *q = realloc(p->event, (size_t)room * sizeof *p->event);
        PH_CHECK(q, PH_ENOMEM, "no memory for %td events", room);
        p->event = q;
        p->event_room = room;
    }
    *out = &p->event[p->nevents++];
    memset(*out, 0, sizeof **out);
out:
    return st;
}

static ph_status keep_bonds(ph_walk *w, ph_error *err)
{
    ph_status st = PH_OK;
    ph_failure_path *p = w->path;
    ptrdiff_t need = p->nbonds + w->scan->npicked;
    if (need > p->bond_room) {
        ptrdiff_t room = need + p->bond_room;
        void *q = realloc(p->bond, (size_t)room * sizeof *p->bond);
        PH_CHECK(q, PH_ENOMEM, "no memory for %td broken bonds", room);
        p->bond = q;
        p->bond_room = room;
    }
    for (ptrdiff_t i = 0; i < w->scan->npicked; i++) {
        const ph_picked *k = &w->scan->picked[i];
        p->bond[p->nbonds++] =
            (ph_broken_bond){(int32_t)ph_i_run_node_of_rve(w->run, k->x),
                             (int32_t)ph_i_run_node_of_rve(w->run, k->y), (int32_t)k->b,
                             (int32_t)p->nevents};
    }
out:
    return st;
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
    PH_TRY(keep_bonds(w, err));
    for (ptrdiff_t i = 0; i < w->scan->npicked; i++)
        PH_TRY(ph_i_break(r->broken, w->scan->picked[i].x, w->scan->picked[i].b, err));
    PH_TRY(ph_i_broken_settle(r->broken, err));
    PH_TRY(ph_i_run_rebuild(r, err));
    PH_TRY(ph_i_unit_load_solve(&w->unit, err));
    PH_TRY(new_event(w->path, &e, err));
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

/* Is the stiffness wanted at a step from 1 on? */
static bool wants_stiffness(const ph_loading *l, int step)
{
    int last = l->ntargets * l->steps;
    return step == last || (l->stiffness_every > 0 && step % l->stiffness_every == 0);
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
    return ph_i_damage_step(w->run, s, w->path->apart, err);
}

static ph_status walk_steps(ph_walk *w, bool keep_fields, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_loading *l = w->loading;
    const ph_cracks *cracks = w->run->problem->cracks;
    double density = cracks ? ph_cracks_density(cracks, &w->run->result->grid) : 0.0;
    int last = l->ntargets * l->steps;
    keep_step(w, 0);
    w->run->keep_fields = false;
    if (wants_first(w->run->problem)) PH_TRY(keep_stiffness(w, density, err));
    for (int i = 1; i <= last; i++) {
        int t = (i - 1) / l->steps, k = (i - 1) % l->steps + 1;
        double from = t > 0 ? l->to[t - 1] : 0.0, share = (double)k / l->steps;
        PH_TRY(break_until(w, k == l->steps ? l->to[t] : from + share * (l->to[t] - from),
                           err));
        keep_step(w, i);
        if (!wants_stiffness(l, i)) continue;
        w->run->keep_fields = keep_fields && i == last;
        PH_TRY(keep_stiffness(w, density, err));
    }
out:
    return st;
}

static ph_status new_path(ph_walk *w, ph_error *err)
{
    ph_status st = PH_OK;
    ph_run *r = w->run;
    ph_failure_path *p = NULL;
    const ph_loading *l = w->loading;
    PH_ALLOC(p, 1, "the path of a failure");
    r->result->failure = w->path = p;
    p->n = r->map->ns;
    memcpy(p->strain, l->strain, sizeof p->strain);
    p->window = l->window > 0.0 ? l->window : default_window;
    p->together = l->together;
    p->first_load = (double)NAN;
    p->stress_free = l->stress_free;
    p->cells = ph_grid_cells(&r->result->grid);
    p->nsteps = l->ntargets * l->steps + 1;
    PH_ALLOC(p->step, p->nsteps, "steps of a loading");
    PH_ALLOC(p->share, r->family->count, "weights of bonds");
    PH_ALLOC(p->initial, p->cells, "the damage of cracks");
    for (ptrdiff_t b = 0; b < r->family->count; b++)
        p->share[b] = r->family->w[b] / r->family->weight;
    for (ptrdiff_t i = 0; i < r->broken->damaged; i++) {
        ptrdiff_t x = ph_i_run_node_of_rve(r, r->broken->node[i]);
        if (x >= 0) p->initial[x] = ph_i_broken_damage(r->broken, i);
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
    PH_TRY(new_path(w, err));
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
    const ph_loading *l = p->loading;
    int count = wants_first(p);
    for (int i = 1; i <= l->ntargets * l->steps; i++)
        count += wants_stiffness(l, i);
    return count;
}

ph_status ph_i_run_failure(ph_run *r, ph_error *err)
{
    ph_status st = PH_OK;
    ph_walk w = {.run = r, .loading = r->problem->loading};
    bool keep_fields = r->keep_fields;
    PH_TRY(check_loading(r, err));
    PH_TRY(ph_i_damage_begin(r, PH_SEQUENCE_LOADING, stiffness_steps(r->problem), err));
    PH_TRY(start(&w, err));
    PH_TRY(walk_steps(&w, keep_fields, err));
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
