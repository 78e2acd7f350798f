/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The damage law of a result: steps become knots. */
#include "core/check.h"
#include "core/jacobi.h"
#include "effective/damage_law.h"
#include "effective/run.h"

#include <math.h>
#include <string.h>

/* Knots as they are found. */
typedef struct gathering {
    const ph_damage *damage;
    const ph_failure_path *path; /* NULL: prescribed */
    int count;
    bool loaded; /* along `strain` */
    double *d, *begin, *end;
    ph_sym4 *stiffness;
    double strain[6],
        size; /* of a loading: its direction; measure of the first stiffness */
    double correction;
} gathering;

/* A share of d below which a step is taken together with the next. */
static const double too_small = 1e-6;

/* ---- stiffnesses that fall --------------------------------------------------------------- */

/* The semidefinite part of a tensor: eigenvalues below zero taken away. */
static ph_sym4 positive_part(const ph_sym4 *c)
{
    double a[6][6] = {{0}}, v[6][6] = {{0}};
    ph_sym4 out = {.n = c->n};
    for (int i = 0; i < c->n; i++)
        for (int j = 0; j < c->n; j++)
            a[i][j] = 0.5 * (c->m[i][j] + c->m[j][i]);
    ph_i_jacobi(c->n, 6, &a[0][0], &v[0][0]);
    for (int i = 0; i < c->n; i++)
        for (int j = 0; j < c->n; j++)
            for (int k = 0; k < c->n; k++)
                if (a[k][k] > 0.0) out.m[i][j] += v[i][k] * v[j][k] * a[k][k];
    return out;
}

/* The nearest we know to `c` that is not above `before` and semidefinite: before - s D, D the
 * positive part of the difference, s <= 1 as large as it can be. */
static ph_sym4 fallen(const ph_sym4 *before, const ph_sym4 *c)
{
    ph_sym4 gone = ph_sym4_combine(1.0, before, -1.0, c), out;
    double low = 0.0, high = 1.0, least;
    gone = positive_part(&gone);
    out = ph_sym4_combine(1.0, before, -1.0, &gone);
    ph_sym4_eigenvalues(&out, &least, NULL);
    if (least >= 0.0) return out;
    for (int i = 0; i < 60; i++) {
        double s = 0.5 * (low + high);
        out = ph_sym4_combine(1.0, before, -s, &gone);
        ph_sym4_eigenvalues(&out, &least, NULL);
        if (least >= 0.0)
            low = s;
        else
            high = s;
    }
    return ph_sym4_combine(1.0, before, -low, &gone);
}

/* ---- knots ------------------------------------------------------------------------------- */

/* What d is the loss of. */
static double measure(const gathering *g, const ph_sym4 *c)
{
    double trace = 0.0;
    if (g->loaded) return ph_i_energy(c, g->strain);
    for (int i = 0; i < c->n; i++)
        trace += c->m[i][i];
    return trace;
}

static void begin_with(gathering *g, const ph_sym4 *c)
{
    g->count = 1;
    g->stiffness[0] = *c;
    g->size = measure(g, c);
}

/* Another knot; false where it changes nothing to speak of. */
static bool add_knot(gathering *g, const ph_sym4 *c, double begin, double end)
{
    int k = g->count;
    ph_sym4 next = fallen(&g->stiffness[k - 1], c);
    ph_sym4 off = ph_sym4_combine(1.0, &next, -1.0, c);
    double d = 1.0 - measure(g, &next) / g->size;
    if (!(d > g->d[k - 1] + too_small)) return false;
    g->correction =
        fmax(g->correction, ph_sym4_norm(&off) / ph_sym4_norm(&g->stiffness[0]));
    g->stiffness[k] = next;
    g->d[k] = d;
    g->begin[k - 1] = begin;
    g->end[k - 1] = fmax(end, begin * (1.0 + 1e-6));
    g->count++;
    return true;
}

static void gather_steps(gathering *g)
{
    begin_with(g, &g->damage->pristine);
    for (int i = 0; i < g->damage->nsteps; i++)
        add_knot(g, &g->damage->step[i].stiffness, 0.0, 0.0);
}

/* ---- of a loading ------------------------------------------------------------------------ */

/* Load where the first bond broke on the way to step `to`, by its size. */
static double first_break(const ph_failure_path *p, int from, int to)
{
    int i = from + 1;
    while (i < to && p->step[i].events == p->step[from].events)
        i++;
    double before = fabs(p->step[i - 1].load);
    ptrdiff_t event = p->step[from].events;
    if (p->together || event >= p->nevents) return before;
    return fmax(before, fabs(p->event[event].load));
}

/* The stiffness at load zero: of the pristine cell, or of the first step if nothing broke on
 * the way to it. */
static const ph_sym4 *unloaded(const gathering *g)
{
    const ph_damage *d = g->damage;
    ptrdiff_t cut = g->path->step[0].broken;
    if (cut == 0) return &d->pristine;
    return d->step[0].broken_bonds == cut ? &d->step[0].stiffness : NULL;
}

/* Step of the path that a step of the damage belongs to, not before `from`. */
static int step_of(const ph_failure_path *p, const ph_damage_step *s, int from)
{
    int i = from;
    while (i < p->nsteps - 1 &&
           !(p->step[i].load == s->value && p->step[i].broken == s->broken_bonds))
        i++;
    return i;
}

static ph_status gather_loading(gathering *g, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_failure_path *p = g->path;
    const ph_sym4 *first = unloaded(g);
    double sign = 0.0, most = 0.0, begin = -1.0;
    PH_CHECK(
        !p->stress_free, PH_EINVAL,
        "no damage law: strains that zero stress finds turn with the damage, the law "
        "is one of a strain that keeps its direction");
    PH_CHECK(!p->in_time, PH_EINVAL,
             "no damage law: phases relax while bonds break, the law knows no time");
    PH_CHECK(first, PH_EINVAL,
             "no damage law: the stiffness of the cracked cell before the first bond "
             "breaks is not known (loading: stiffness_every)");
    memcpy(g->strain, p->strain, sizeof g->strain);
    g->loaded = true;
    begin_with(g, first);
    for (int i = 0, from = 0, to; i < g->damage->nsteps; i++, from = to) {
        const ph_damage_step *s = &g->damage->step[i];
        to = step_of(p, s, from);
        if (p->step[to].broken > p->step[from].broken) {
            if (sign == 0.0) sign = s->value < 0.0 ? -1.0 : 1.0;
            PH_CHECK(
                sign * s->value > most, PH_EINVAL,
                "no damage law: bonds broke on the way to load %g after %g, which is "
                "no load that only rises",
                s->value, sign * most);
            if (begin < 0.0) begin = fmax(most, first_break(p, from, to));
            if (add_knot(g, &s->stiffness, begin, sign * s->value)) begin = -1.0;
        }
        most = fmax(most, sign * s->value);
    }
    for (int i = 0; i < 6 && sign < 0.0; i++)
        g->strain[i] = -g->strain[i];
out:
    return st;
}

/* ---- of cracks that grow when they can pay for it --------------------------------------- */

/* Loads at which a segment releases what its surface costs, into begin; then both ends: a
 * segment lasts until the next one can go, and loads do not fall. */
static ph_status gather_growth(gathering *g, double fracture_energy, ph_error *err)
{
    ph_status st = PH_OK;
    double surface = 0.0, last = 0.0;
    begin_with(g, &g->damage->pristine);
    for (int i = 0; i < g->damage->nsteps; i++) {
        const ph_damage_step *s = &g->damage->step[i];
        if (!add_knot(g, &s->stiffness, 0.0, 0.0)) continue;
        int k = g->count - 2; /* the new segment */
        double paid = fracture_energy * (s->surface - surface);
        ph_sym4 gone = ph_sym4_combine(1.0, &g->stiffness[k], -1.0, &g->stiffness[k + 1]);
        PH_CHECK(paid > 0.0, PH_EINVAL,
                 "no damage law: step %d breaks bonds without new crack surface", i + 1);
        g->begin[k] = sqrt(2.0 * paid / ph_i_energy(&gone, g->strain));
        surface = s->surface;
    }
    for (int k = 0; k + 1 < g->count; k++) {
        double next = k + 2 < g->count ? g->begin[k + 1] : 0.0;
        g->begin[k] = fmax(g->begin[k], last);
        g->end[k] = last = fmax(next, g->begin[k] * (1.0 + 1e-6));
    }
out:
    return st;
}

static ph_status make_law(const ph_result *result, gathering g, double fracture_energy,
                          ph_damage_law **out, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(g.damage && g.damage->nsteps > 0, PH_EINVAL,
             "no damage law: the result has no damage");
    PH_CHECK(result->loads == ph_i_run_all_loads(result), PH_EINVAL,
             "no damage law: load cases were not solved");
    PH_CHECK(ph_sym4_is_stiffness(&g.damage->pristine), PH_EINVAL,
             "no damage law: without cracks the stiffness is singular");
    PH_ALLOC(g.d, g.damage->nsteps + 1, "damage");
    PH_ALLOC(g.begin, g.damage->nsteps, "loads");
    PH_ALLOC(g.end, g.damage->nsteps, "loads");
    PH_ALLOC(g.stiffness, g.damage->nsteps + 1, "stiffnesses");
    if (g.path)
        PH_TRY(gather_loading(&g, err));
    else if (g.loaded)
        PH_TRY(gather_growth(&g, fracture_energy, err));
    else
        gather_steps(&g);
    PH_TRY(ph_damage_law_new(result->stiffness.n, g.loaded ? g.strain : NULL, g.count,
                             g.d, g.stiffness, g.begin, g.end, out, err));
    (*out)->correction = g.correction;
out:
    free(g.d);
    free(g.begin);
    free(g.end);
    free(g.stiffness);
    return st;
}

ph_status ph_damage_law_from_result(const ph_result *result, ph_damage_law **out,
                                    ph_error *err)
{
    PH_GIVEN(result && out);
    *out = NULL;
    const gathering g = {.damage = result->damage, .path = result->failure};
    return make_law(result, g, 0.0, out, err);
}

ph_status ph_damage_law_from_growth(const ph_result *result, const double *strain,
                                    double fracture_energy, ph_damage_law **out,
                                    ph_error *err)
{
    ph_status st = PH_OK;
    PH_GIVEN(result && strain && out);
    *out = NULL;
    gathering g = {.damage = result->damage, .loaded = true};
    PH_CHECK(fracture_energy > 0.0 && isfinite(fracture_energy), PH_EINVAL,
             "the fracture energy must be > 0, got %g", fracture_energy);
    PH_CHECK(result->damage && !result->failure, PH_EINVAL,
             "no damage law: the result has no prescribed cracks");
    for (int i = 0; i < result->stiffness.n; i++)
        g.strain[i] = strain[i];
    PH_CHECK(ph_i_energy(&result->damage->pristine, g.strain) > 0.0, PH_EINVAL,
             "no damage law: the strain is zero");
    st = make_law(result, g, fracture_energy, out, err);
out:
    return st;
}
