/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bonds that break while phases relax.
 *
 * A time step is tried; the first bond that becomes critical on its way ends it there, and the
 * shorter step is taken instead. At that instant bonds break one event after the other, each
 * followed by a jump (dt = 0) to the equilibrium of what is left, with the instantaneous
 * moduli, until no bond is beyond critical; then time goes on. Branches remember the strains
 * of the bonds that are there: what has broken has no history.
 *
 * With x_m the fields of the branches and of C_inf, W = 1/2 sum_m A_m(x_m, x_m), an event in
 * equilibrium before and after dissipates 1/2 sum over its bonds and m of k_m q_m- q_m+, the
 * work of prescribed stresses at the event included: all x_m move by the same displacement. */
#include "effective/failure_scan.h"
#include "effective/step_control.h"

#include <math.h>
#include <string.h>

enum { LOCATE = 8 };
/* An event is where a stretch is critical to this share of it. */
static const double precision = 1e-5;
/* After an event: of the shortest time of relaxation; steps double from there. */
static const double first_step = 0.05;
/* Stresses below this share of the largest so far need not be met relative to themselves. */
static const double least_stress = 0.05;
/* Stored energy below this share of the largest: nothing is left. */
static const double nothing_left = 1e-5;
/* Macro strain under prescribed stress that grows by more than this in one event. */
static const double runs_away = 100.0;

typedef struct ph_course {
    ph_run *run;
    const ph_loading *loading;
    ph_failure_path *path;
    ph_strengths *strengths;
    ph_scan *scan;
    ph_stepper *s;
    ph_step_control control;
    double direction[6]; /* Mandel: strain or stress */
    double load;
    double ladder; /* the next step is not longer: after an event, what is left relaxes */
    double *end;   /* [nd][cells] displacement at the end of a step that is tried */
    double end_macro[6]; /* beside it */
    double *pull;        /* [picked][ntimes + 1] elongations of branches before */
    ptrdiff_t pull_room;
    ph_failure_energy energy;
    double stress[6], strain[6]; /* means, Mandel */
    double most_stored;
} ph_course;

/* ---- bonds at the end of a step ---------------------------------------------------------- */

static void look_at_end(ph_course *c)
{
    const ph_stepper *s = c->s;
    for (ptrdiff_t x = 0; x < s->unknowns; x++)
        c->end[x] = s->u[x] + s->du[x];
    for (int i = 0; i < s->ns; i++)
        c->end_macro[i] = s->macro[i] + s->dmacro[i];
}

/* Largest stretch over critical stretch of the intact bonds. */
static double worst_bond(ph_course *c)
{
    double least = ph_i_scan(c->scan, c->end, 1.0);
    return isfinite(least) ? 1.0 / least : 0.0;
}

/* Share of the step at which the first bond becomes critical. */
static double first_crossing(ph_course *c)
{
    const ph_stepper *s = c->s;
    return fmin(1.0, ph_i_scan_reach(c->scan, s->u, s->macro, s->du, s->dmacro));
}

/* ---- a step ------------------------------------------------------------------------------ */

static ph_status try_step(ph_course *c, double dt, double load, ph_error *err)
{
    ph_status st = PH_OK;
    double stress[6];
    for (int i = 0; i < c->s->ns; i++)
        c->control.target[i] = load * c->direction[i];
    PH_TRY(ph_i_step_attempt(&c->control, dt, stress, err));
    look_at_end(c);
out:
    return st;
}

static void note(ph_course *c)
{
    ph_failure_path *p = c->path;
    double conjugate = 0.0, size = 0.0;
    for (int i = 0; i < c->s->ns; i++)
        size += c->stress[i] * c->stress[i];
    c->control.least = fmax(c->control.least, least_stress * sqrt(size));
    for (int i = 0; i < c->s->ns; i++)
        conjugate += (p->by_stress ? c->strain : c->stress)[i] * c->direction[i];
    if (fabs(conjugate) > fabs(p->peak_stress)) {
        p->peak_stress = conjugate;
        p->peak_load = c->load;
    }
}

/* Take the step that is tried, which ends at `load`. Of an event the stress before the jump
 * is not that of the medium, which is out of balance: what is given does not change. */
static ph_status take_step(ph_course *c, double load, bool event, ph_error *err)
{
    ph_status st = PH_OK;
    ph_stepper *s = c->s;
    ph_step_work work;
    ph_step_state now;
    if (!event) PH_TRY(ph_i_stepper_work(s, &work, err));
    PH_TRY(ph_i_stepper_accept(s, err));
    PH_TRY(ph_i_stepper_state(s, &now, err));
    c->load = load;
    if (event) work = (ph_step_work){0};
    for (int i = 0; i < s->ns; i++) {
        double strain = ph_i_run_by_stress(c->run, i) ? now.strain[i] : s->macro[i];
        if (event) work.external += now.stress[i] * (strain - c->strain[i]);
        c->stress[i] = now.stress[i];
        c->strain[i] = strain;
    }
    c->energy.external += work.external;
    c->energy.viscous += work.viscous;
    c->energy.stored = now.energy;
    c->most_stored = fmax(c->most_stored, now.energy);
    note(c);
out:
    return st;
}

/* ---- an event ---------------------------------------------------------------------------- */

/* Stiffness of a bond in branch m, or in C_inf; 0 of a medium without springs. */
static double stiffness_of(const ph_course *c, const ph_picked *k, int m)
{
    const ph_relaxing_bonds *b = c->s->bonds;
    return b ? c->run->family->w[k->b] * ph_i_bond_modulus(&b->tables[m], k->x, k->y)
             : 0.0;
}

static double pull_of(const ph_course *c, const ph_picked *k, int m)
{
    const ph_stepper *s = c->s;
    bool total = m == s->ntimes;
    return ph_i_scan_pull_of(c->scan, total ? s->u : s->memory + m * s->unknowns,
                             total ? s->macro : s->macro_memory + 6 * m, k->x, k->b,
                             k->y);
}

/* What the picked bonds hold, per volume; their elongations are kept. */
static ph_status look_before(ph_course *c, double *fracture, ph_error *err)
{
    ph_status st = PH_OK;
    const int parts = c->s->ntimes + 1;
    *fracture = 0.0;
    if (c->scan->npicked > c->pull_room) {
        free(c->pull);
        c->pull = NULL;
        PH_ALLOC(c->pull, parts * c->scan->npicked, "elongations of breaking bonds");
        c->pull_room = c->scan->npicked;
    }
    for (ptrdiff_t i = 0; i < c->scan->npicked; i++)
        for (int m = 0; m < parts; m++) {
            const ph_picked *k = &c->scan->picked[i];
            double q = pull_of(c, k, m);
            c->pull[i * parts + m] = q;
            *fracture += 0.5 * stiffness_of(c, k, m) * q * q;
        }
    *fracture /= (double)c->run->setting.averaged;
out:
    return st;
}

/* 1/2 sum k q- q+ of the bonds that went. */
static double gone_with(const ph_course *c)
{
    const int parts = c->s->ntimes + 1;
    double sum = 0.0;
    for (ptrdiff_t i = 0; i < c->scan->npicked; i++)
        for (int m = 0; m < parts; m++) {
            const ph_picked *k = &c->scan->picked[i];
            sum +=
                0.5 * stiffness_of(c, k, m) * c->pull[i * parts + m] * pull_of(c, k, m);
        }
    return sum / (double)c->run->setting.averaged;
}

/* What is left carries no stress: the body has come apart under a stress that is given. */
static void come_apart(ph_course *c)
{
    c->path->severed = c->path->apart = true;
    c->energy.dissipated += c->energy.stored;
    c->energy.stored = 0.0;
    memset(c->stress, 0, sizeof c->stress);
}

static bool has_run_away(const ph_course *c, double before)
{
    double now = 0.0;
    for (int i = 0; i < c->s->ns; i++)
        now += c->end_macro[i] * c->end_macro[i];
    return c->control.stress != 0 && before > 0.0 && sqrt(now) > runs_away * before;
}

/* The jump after bonds have gone; false in *holds: nothing holds the stress that is given. */
static ph_status jump(ph_course *c, bool *holds, ph_error *err)
{
    ph_status st = PH_OK;
    double before = 0.0;
    for (int i = 0; i < c->s->ns; i++)
        before += c->s->macro[i] * c->s->macro[i];
    PH_TRY(ph_i_stepper_broken(c->s, err));
    st = try_step(c, 0.0, c->load, err);
    bool given = c->control.stress != 0 || c->run->constraint->by_stress;
    *holds = st == PH_OK && !has_run_away(c, sqrt(before));
    if (given && (st == PH_ENOCONV || st == PH_ESINGULAR)) {
        if (err) *err = (ph_error)PH_ERROR_INIT;
        st = PH_OK;
    }
    if (st != PH_OK || !*holds) goto out;
    PH_TRY(take_step(c, c->load, true, err));
out:
    return st;
}

static double conjugate_stress(const ph_course *c)
{
    double sum = 0.0;
    for (int i = 0; i < c->s->ns; i++)
        sum += c->stress[i] * c->direction[i];
    return sum;
}

static ph_status record(ph_course *c, double before, long iterations, ph_error *err)
{
    ph_status st = PH_OK;
    ph_failure_path *p = c->path;
    ph_failure_event *e = NULL;
    PH_TRY(ph_i_failure_event(p, &e, err));
    e->load = c->load;
    e->time = *c->s->time;
    e->before = before;
    e->after = conjugate_stress(c);
    e->broken = c->run->broken->pairs;
    e->energy = c->energy;
    e->iterations = (int)(c->s->iterations - iterations);
    e->residual = c->s->tolerance;
    if (p->nevents > 1) goto out;
    p->first_load = e->load;
    p->first_time = e->time;
out:
    return st;
}

/* Break the bonds whose critical stretch is reached by `worst`, as last scanned. */
static ph_status take_event(ph_course *c, double worst, ph_error *err)
{
    ph_status st = PH_OK;
    ph_run *r = c->run;
    ph_failure_path *p = c->path;
    double most =
        c->loading->together ? fmax(1.0, 1.0 / worst) : (1.0 + p->window) / worst;
    double fracture, stored = c->energy.stored, external = c->energy.external;
    double before = conjugate_stress(c);
    long iterations = c->s->iterations;
    bool holds;
    PH_TRY(ph_i_scan_pick(c->scan, c->end, 1.0, most, err));
    PH_TRY(look_before(c, &fracture, err));
    PH_TRY(ph_i_failure_keep_bonds(r, c->scan, err));
    for (ptrdiff_t i = 0; i < c->scan->npicked; i++)
        PH_TRY(ph_i_break(r->broken, c->scan->picked[i].x, c->scan->picked[i].b, err));
    PH_TRY(ph_i_broken_settle(r->broken, err));
    PH_TRY(jump(c, &holds, err));
    c->energy.fracture += c->s->bonds ? fracture : (double)NAN;
    if (!holds)
        come_apart(c);
    else if (c->s->bonds)
        c->energy.dissipated += gone_with(c);
    else /* no springs: what the energies say */
        c->energy.dissipated += stored - c->energy.stored + c->energy.external - external;
    PH_TRY(record(c, before, iterations, err));
    if (c->energy.stored <= nothing_left * c->most_stored) p->severed = true;
    if (p->severed) p->end_time = *c->s->time;
out:
    return st;
}

/* Events at this instant, until no bond is beyond critical. */
static ph_status break_now(ph_course *c, double worst, ph_error *err)
{
    ph_status st = PH_OK;
    do {
        PH_TRY(take_event(c, worst, err));
        if (c->path->severed) break;
        worst = worst_bond(c);
    } while (worst > 1.0);
    ph_i_stepper_corner(c->s);
out:
    return st;
}

/* ---- on the way -------------------------------------------------------------------------- */

/* Shorten the step that is tried until its end is where the first bond becomes critical; most
 * bonds are on straight ways. @param[in,out] share of the step; worst: of its end */
static ph_status locate(ph_course *c, double dt, double load, double *share,
                        double *worst, ph_error *err)
{
    ph_status st = PH_OK;
    const double begin = c->load;
    int tries = 0;
    while (*worst > 1.0 + precision && tries++ < LOCATE) {
        double part = first_crossing(c);
        part = fmin(part, 1.0 - 0x1p-20);
        *share *= part;
        PH_TRY(try_step(c, *share * dt, begin + *share * (load - begin), err));
        *worst = worst_bond(c);
    }
out:
    return st;
}

/* One step on the way to a time and a load, straight, and what breaks at its end. */
static ph_status step_towards(ph_course *c, double time, double load, ph_error *err)
{
    ph_status st = PH_OK;
    ph_stepper *s = c->s;
    const double left = time - *s->time, begin = c->load;
    const double dt = 1.5 * c->ladder < left ? c->ladder : left;
    const double end = dt < left ? begin + dt / left * (load - begin) : load;
    double share = 1.0;
    PH_TRY(try_step(c, dt, end, err));
    double worst = worst_bond(c);
    /* all at once breaks at the ends of steps */
    if (!c->loading->together) PH_TRY(locate(c, dt, end, &share, &worst, err));
    PH_TRY(take_step(c, share < 1.0 ? begin + share * (end - begin) : end, false, err));
    if (share >= 1.0 && dt >= left) *s->time = time;
    c->ladder *= 2.0;
    if (worst < 1.0 - (share < 1.0 ? precision : 0.0)) return PH_OK;
    PH_TRY(break_now(c, worst, err));
    if (s->ntimes > 0) c->ladder = first_step * s->tau[0];
out:
    return st;
}

static ph_status go_to(ph_course *c, double time, double load, ph_error *err)
{
    ph_status st = PH_OK;
    while ((*c->s->time < time || c->load != load) && !c->path->severed)
        PH_TRY(step_towards(c, time, load, err));
    if (c->path->severed) { /* nothing is left to be stepped */
        *c->s->time = time;
        c->load = load;
    }
out:
    return st;
}

static void keep_step(ph_course *c, int number)
{
    ph_failure_step *s = &c->path->step[number];
    int ns = c->s->ns;
    double conjugate = 0.0;
    s->load = c->load;
    s->time = *c->s->time;
    for (int i = 0; i < ns; i++) { /* Mandel to Voigt */
        double shear = i < (ns == 3 ? 2 : 3) ? 1.0 : sqrt(0.5);
        s->stress[i] = c->stress[i] * shear;
        s->strain[i] = c->strain[i] / shear;
        conjugate += (c->path->by_stress ? c->strain : c->stress)[i] * c->direction[i];
    }
    s->work = conjugate;
    s->broken = c->run->broken->pairs;
    s->events = c->path->nevents;
    s->energy = c->energy;
    double off =
        c->energy.external - c->energy.stored - c->energy.dissipated - c->energy.viscous;
    c->path->imbalance = fmax(c->path->imbalance, fabs(off));
}

static ph_status keep_stiffness(ph_course *c, int number, int *done, ph_error *err)
{
    ph_status st = PH_OK;
    ph_damage *d = c->run->result->damage;
    const ph_cracks *cracks = c->run->problem->cracks;
    if (!ph_i_wants_stiffness(c->loading, number)) return PH_OK;
    if (!c->path->apart) PH_TRY(ph_i_stepper_instantaneous(c->s, err));
    d->step[*done].value = c->load;
    d->step[*done].density =
        cracks ? ph_cracks_density(cracks, &c->run->result->grid) : 0.0;
    PH_TRY(ph_i_damage_step(c->run, &d->step[(*done)++], c->path->apart, err));
out:
    return st;
}

static ph_status walk(ph_course *c, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_loading *l = c->loading;
    int done = 0;
    keep_step(c, 0);
    for (int i = 1; i <= l->ntargets * l->steps; i++) {
        int t = (i - 1) / l->steps, k = (i - 1) % l->steps + 1;
        double share = (double)k / l->steps;
        double from = t > 0 ? l->to[t - 1] : 0.0, since = t > 0 ? l->times[t - 1] : 0.0;
        bool last = k == l->steps;
        double time = last ? l->times[t] : since + share * (l->times[t] - since);
        double load = last ? l->to[t] : from + share * (l->to[t] - from);
        if (k == 1) ph_i_stepper_corner(c->s);
        PH_TRY(go_to(c, time, load, err));
        keep_step(c, i);
        PH_TRY(keep_stiffness(c, i, &done, err));
    }
out:
    return st;
}

static ph_status start(ph_course *c, ph_error *err)
{
    ph_status st = PH_OK;
    ph_run *r = c->run;
    const ph_problem *p = r->problem;
    const ph_loading *l = c->loading;
    int ns = r->map->ns;
    unsigned stress = l->by_stress ? (1u << ns) - 1u : l->stress_free;
    double own = p->solver.tolerance;
    PH_TRY(ph_i_failure_begin(r, err));
    c->path = r->result->failure;
    for (int i = 0; i < ns; i++) {
        bool shear = i >= (ns == 3 ? 2 : 3);
        double to_mandel = !shear ? 1.0 : l->by_stress ? sqrt(2.0) : sqrt(0.5);
        c->direction[i] = l->strain[i] * to_mandel;
    }
    PH_TRY(ph_i_strengths_new(r, p->failure, &c->strengths, err));
    PH_TRY(ph_i_scan_new(r, c->strengths, c->end_macro, &c->scan, err));
    PH_TRY(ph_i_stepper_new(r, own > 0.0 ? own : 1e-6, &c->s, err));
    PH_DOUBLES(c->end, &r->meter, (size_t)c->s->unknowns, "the end of a step");
    c->control = ph_i_step_control(c->s, stress);
    c->control.tolerance *= 10.0; /* pieces that hang by a few bonds amplify residuals */
    ph_i_stepper_reset(c->s);
out:
    return st;
}

ph_status ph_i_run_failure_in_time(ph_run *r, ph_error *err)
{
    ph_status st = PH_OK;
    ph_course c = {.run = r, .loading = r->problem->loading, .ladder = INFINITY};
    PH_TRY(ph_i_check_loading(r, err));
    PH_TRY(
        ph_i_damage_begin(r, PH_SEQUENCE_LOADING, ph_i_stiffness_steps(c.loading), err));
    PH_TRY(start(&c, err));
    PH_TRY(walk(&c, err));
    ph_i_damage_measures(r->result);
    c.path->toughness = c.energy.external;
    if (c.energy.external > 0.0) c.path->imbalance /= c.energy.external;
out:
    ph_i_scan_free(&c.scan);
    ph_i_strengths_free(&c.strengths);
    if (c.s) ph_i_doubles_free(&r->meter, &c.end, (size_t)c.s->unknowns);
    ph_i_stepper_free(&c.s);
    free(c.pull);
    return st;
}
