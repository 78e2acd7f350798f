/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What every failure begins with, and what it keeps. */
#include "effective/failure_scan.h"

#include <math.h>
#include <string.h>

static const double default_window = 0.01;

static ph_status check_times(const ph_run *r, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_loading *l = r->problem->loading;
    PH_CHECK(l->times || !l->by_stress, PH_EINVAL,
             "a macro stress is a loading in time: give times");
    PH_CHECK(!l->by_stress || l->stress_free == 0, PH_EINVAL,
             "a loading by stress has no strains to be found: leave out stress_free");
    for (int i = 0; l->times && i < l->ntargets; i++)
        PH_CHECK(isfinite(l->times[i]) && l->times[i] >= (i ? l->times[i - 1] : 0.0),
                 PH_EINVAL, "times of a loading must be >= 0 and not decrease, %g is %d",
                 l->times[i], i + 1);
out:
    return st;
}

ph_status ph_i_check_loading(const ph_run *r, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_loading *l = r->problem->loading;
    const ph_crack_sequence *q = r->problem->sequence;
    double size = 0.0;
    PH_CHECK(r->problem->failure && r->problem->failure->material, PH_EINVAL,
             "a loading needs to know when bonds break: give failure");
    PH_CHECK(!q || q->kind == PH_SEQUENCE_NONE, PH_EINVAL,
             "a sequence of cracks and a loading are two: give one of both");
    PH_CHECK_KEY(
        !r->classes || !r->setting.source, PH_EINVAL, "constraint.collar",
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
    PH_TRY(check_times(r, err));
    PH_CHECK(l->window >= 0.0 && l->window <= 1.0, PH_EINVAL,
             "the window of a loading must be in [0, 1], got %g", l->window);
    PH_CHECK(l->stiffness_every >= 0, PH_EINVAL, "stiffness_every must be >= 0, got %d",
             l->stiffness_every);
out:
    return st;
}

ph_status ph_i_failure_event(ph_failure_path *p, ph_failure_event **out, ph_error *err)
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

ph_status ph_i_failure_keep_bonds(const ph_run *r, const ph_scan *scan, ph_error *err)
{
    ph_status st = PH_OK;
    ph_failure_path *p = r->result->failure;
    ptrdiff_t need = p->nbonds + scan->npicked;
    if (need > p->bond_room) {
        ptrdiff_t room = need + p->bond_room;
        void *q = realloc(p->bond, (size_t)room * sizeof *p->bond);
        PH_CHECK(q, PH_ENOMEM, "no memory for %td broken bonds", room);
        p->bond = q;
        p->bond_room = room;
    }
    for (ptrdiff_t i = 0; i < scan->npicked; i++) {
        const ph_picked *k = &scan->picked[i];
        p->bond[p->nbonds++] = (ph_broken_bond){(int32_t)ph_i_run_node_of_rve(r, k->x),
                                                (int32_t)ph_i_run_node_of_rve(r, k->y),
                                                (int32_t)k->b, (int32_t)p->nevents};
    }
out:
    return st;
}

static ph_status new_path(ph_run *r, ph_error *err)
{
    ph_status st = PH_OK;
    ph_failure_path *p = NULL;
    const ph_loading *l = r->problem->loading;
    PH_ALLOC(p, 1, "the path of a failure");
    r->result->failure = p;
    p->n = r->map->ns;
    memcpy(p->strain, l->strain, sizeof p->strain);
    p->window = l->window > 0.0 ? l->window : default_window;
    p->together = l->together;
    p->in_time = l->times != NULL;
    p->by_stress = l->by_stress;
    p->first_load = p->first_time = p->end_time = (double)NAN;
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

ph_status ph_i_failure_begin(ph_run *r, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_cracks *cracks = r->problem->cracks;
    if (cracks && cracks->count > 0) {
        PH_TRY(ph_i_run_cut(r, cracks, false, true, err));
        PH_TRY(ph_i_run_rebuild(r, err));
    }
    PH_TRY(new_path(r, err));
out:
    return st;
}

bool ph_i_wants_stiffness(const ph_loading *l, int step)
{
    int last = l->ntargets * l->steps;
    return step == last || (l->stiffness_every > 0 && step % l->stiffness_every == 0);
}

int ph_i_stiffness_steps(const ph_loading *l)
{
    int count = 0;
    for (int i = 1; i <= l->ntargets * l->steps; i++)
        count += ph_i_wants_stiffness(l, i);
    return count;
}
