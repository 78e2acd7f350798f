/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An RVE whose bonds break, along any path of the macro strain.
 *
 * Between two events the RVE is linear: u = sum_a eps_a U_a with the fields U of unit macro
 * strains, which all points with the same broken bonds share. Over an increment the stretch of
 * a bond is s + t ds, 0 <= t <= 1, so that the next event is known without stepping,
 * t_b = (s_c - s_b) / ds_b, least over the intact bonds. There the strain is held, what is
 * beyond critical breaks (the most overloaded first, and those within the window of it), the
 * cell is solved anew, until nothing is; then the strain goes on. On a straight path from rest
 * these are the events of effective/failure_path.c.
 *
 * The stress at the end is C(broken bonds) : eps, and C its derivative. */
#include "effective/fe2.h"

#include <math.h>
#include <string.h>

/* Below this share of the whole cell's energy nothing is left but the solver's tolerance. */
static const double nothing_left = 1e-5;
/* Directions of strain that differ by less are one. */
static const double parallel = 1e-13;

typedef struct walk {
    ph_fe2 *f;
    ph_fe2_worker *w;            /* macro: the strain now, u: its displacement */
    const ph_fe2_damage *before; /* where the increment begins */
    double end[6], de[6];        /* Mandel */
    double left;                 /* share of the increment */
    ph_broken_bond *bond;        /* all that are broken */
    ptrdiff_t nbonds, events;
    double energy; /* stress : strain, NaN: not known */
    double dissipated;
    bool severed;
} walk;

static double energy_of(int ns, const ph_sym4 *c, const double *e)
{
    double sum = 0.0;
    for (int i = 0; i < ns; i++)
        for (int j = 0; j < ns; j++)
            sum += e[i] * c->m[i][j] * e[j];
    return sum;
}

static void superpose(const ph_fe2 *f, double *const u[6], const double *e, double *out)
{
    memset(out, 0, f->unknowns * sizeof *out);
    for (int a = 0; a < f->ns; a++)
        for (size_t x = 0; e[a] != 0.0 && x < f->unknowns; x++)
            out[x] += e[a] * u[a][x];
}

/* ---- bonds of a worker ------------------------------------------------------------------- */

static void set_damage(ph_fe2 *f, ph_fe2_worker *w, ph_fe2_damage *d)
{
    pthread_mutex_lock(&f->lock);
    ph_i_fe2_drop_damage(f, &w->has);
    w->has = d;
    if (d) d->holds++;
    pthread_mutex_unlock(&f->lock);
}

static ph_status break_only(ph_fe2 *f, ph_fe2_worker *w, const ph_broken_bond *bond,
                            ptrdiff_t nbonds, ph_error *err)
{
    ph_status st = PH_OK;
    ph_broken *br = w->run.broken;
    const ph_cracks *cracks = f->problem.cracks;
    set_damage(f, w, NULL);
    ph_i_broken_heal(br);
    w->built = false;
    if (cracks && cracks->count > 0)
        PH_TRY(ph_i_cracks_cut(cracks, &w->run.result->grid, w->run.setting.first, false,
                               br, NULL, err));
    for (ptrdiff_t i = 0; i < nbonds; i++)
        PH_TRY(ph_i_break(br, bond[i].node, bond[i].bond, err));
    PH_TRY(ph_i_broken_settle(br, err));
out:
    return st;
}

static ph_status load_bonds(ph_fe2 *f, ph_fe2_worker *w, ph_fe2_damage *d, ph_error *err)
{
    ph_status st = PH_OK;
    if (w->has == d) return PH_OK;
    PH_TRY(break_only(f, w, d->bond, d->nbonds, err));
    set_damage(f, w, d);
out:
    return st;
}

static ph_status know_bonds(ph_fe2_worker *w, ph_error *err)
{
    ph_status st = PH_OK;
    if (w->built) return PH_OK;
    PH_TRY(ph_i_run_rebuild(&w->run, err));
    w->built = true;
out:
    return st;
}

static ph_status solve(ph_fe2_worker *w, const double *macro, double *u, ph_error *err)
{
    ph_status st = PH_OK;
    ph_cg_report report;
    st = ph_i_run_solve(&w->run, macro, false, u, 0.0, &report, err);
    if (st == PH_OK)
        memcpy(u, w->run.u,
               sizeof *u * (size_t)(w->run.op->layout.nd * w->run.op->layout.cells));
    return st;
}

/* ---- a set of broken bonds --------------------------------------------------------------- */

/* The fields of unit strains and the stiffness, from the fields `guess`; the worker knows the
 * bonds. Takes them over. */
static ph_status new_damage(ph_fe2 *f, ph_fe2_worker *w, double *const *guess,
                            ph_broken_bond **bond, ptrdiff_t nbonds, ph_fe2_damage **out,
                            ph_error *err)
{
    ph_status st = PH_OK;
    ph_fe2_damage *d = NULL;
    ph_result *res = w->run.result;
    const size_t bytes = f->unknowns * sizeof(double);
    PH_ALLOC(d, 1, "broken bonds");
    d->holds = 1;
    for (int a = 0; a < f->ns; a++) {
        PH_DOUBLES(d->u[a], NULL, f->unknowns, "the fields of broken bonds");
        memset(w->run.first[a], 0, bytes);
        if (guess) memcpy(w->run.first[a], guess[a], bytes);
    }
    res->nloads = 0;
    res->loads = 0;
    PH_TRY(ph_i_run_loads(&w->run, err));
    PH_TRY(ph_i_run_stiffness(&w->run, err));
    d->c = res->stiffness;
    ph_i_drop_nothing(&d->c);
    for (int a = 0; a < f->ns; a++)
        memcpy(d->u[a], w->run.first[a], bytes);
    d->bond = *bond;
    d->nbonds = nbonds;
    *bond = NULL;
    *out = d;
    d = NULL;
out:
    ph_i_fe2_drop_damage(f, &d);
    return st;
}

ph_status ph_i_fe2_whole(ph_fe2 *f, ph_fe2_worker *w, ph_fe2_node *root, ph_error *err)
{
    ph_status st = PH_OK;
    ph_broken_bond *none = NULL;
    PH_TRY(break_only(f, w, NULL, 0, err));
    PH_TRY(know_bonds(w, err));
    PH_TRY(new_damage(f, w, NULL, &none, 0, &root->damage, err));
    root->broke = true;
    f->first = root->damage->c;
    set_damage(f, w, root->damage);
out:
    return st;
}

/* ---- an event ---------------------------------------------------------------------------- */

static ph_status keep_bonds(walk *k, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_scan *s = k->w->scan;
    const size_t n = (size_t)(k->nbonds + s->npicked);
    void *p = realloc(k->bond, (n ? n : 1) * sizeof *k->bond);
    PH_CHECK(p, PH_ENOMEM, "no memory for %zu broken bonds", n);
    k->bond = p;
    for (ptrdiff_t i = 0; i < s->npicked; i++)
        k->bond[k->nbonds++] =
            (ph_broken_bond){(int32_t)s->picked[i].x, (int32_t)s->picked[i].y,
                             (int32_t)s->picked[i].b, (int32_t)k->events};
out:
    return st;
}

/* Stress : strain of the displacement as it is. */
static ph_status measure(walk *k, ph_error *err)
{
    ph_status st = PH_OK;
    ph_run *r = &k->w->run;
    double stress[6], strain[6];
    ph_cell_energy e;
    PH_TRY(ph_i_operator_sums(r->op, k->w->u, k->w->macro, r->setting.region, stress,
                              strain, &e, err));
    k->energy = (e.mean + e.modes + e.stabilisation) / (double)r->setting.averaged;
out:
    return st;
}

/* The most overloaded bonds break at the strain that is. */
static ph_status take_event(walk *k, double least, ph_error *err)
{
    ph_status st = PH_OK;
    ph_fe2_worker *w = k->w;
    PH_TRY(ph_i_scan_pick(w->scan, w->u, 1.0, least * (1.0 + k->f->window), err));
    PH_TRY(keep_bonds(k, err));
    PH_TRY(know_bonds(w, err)); /* of those before, if it was not asked yet */
    if (isnan(k->energy)) PH_TRY(measure(k, err));
    const double before = k->energy;
    set_damage(k->f, w, NULL);
    w->built = false;
    for (ptrdiff_t i = 0; i < w->scan->npicked; i++)
        PH_TRY(
            ph_i_break(w->run.broken, w->scan->picked[i].x, w->scan->picked[i].b, err));
    PH_TRY(ph_i_broken_settle(w->run.broken, err));
    PH_TRY(know_bonds(w, err));
    PH_TRY(solve(w, w->macro, w->u, err));
    PH_TRY(measure(k, err));
    k->events++;
    k->dissipated += 0.5 * (before - k->energy);
    k->severed = k->energy <= nothing_left * energy_of(k->f->ns, &k->f->first, w->macro);
out:
    return st;
}

/* ---- the increment ----------------------------------------------------------------------- */

/* Displacement of the rest of the increment, after bonds broke. */
static ph_status solve_ahead(walk *k, ph_error *err)
{
    const int ns = k->f->ns;
    double ee = 0.0, ed = 0.0, dd = 0.0;
    for (int i = 0; i < ns; i++) {
        ee += k->w->macro[i] * k->w->macro[i];
        ed += k->w->macro[i] * k->de[i];
        dd += k->de[i] * k->de[i];
    }
    if (ee == 0.0 || ee * dd - ed * ed > parallel * ee * dd)
        return solve(k->w, k->de, k->w->du, err);
    for (size_t x = 0; x < k->f->unknowns; x++)
        k->w->du[x] = ed / ee * k->w->u[x];
    return PH_OK;
}

static void go_on(walk *k, double t)
{
    k->left -= t;
    k->energy = (double)NAN;
    for (int i = 0; i < k->f->ns; i++)
        k->w->macro[i] = k->end[i] - k->left * k->de[i];
    for (size_t x = 0; x < k->f->unknowns; x++)
        k->w->u[x] += t * k->w->du[x];
}

static ph_status follow(walk *k, ph_error *err)
{
    ph_status st = PH_OK;
    ph_fe2_worker *w = k->w;
    while (!k->severed) {
        double t = ph_i_scan_reach(w->scan, w->u, w->scan->macro, w->du, k->de);
        if (!(t <= k->left)) break;
        go_on(k, t);
        double least = ph_i_scan(w->scan, w->u, 1.0);
        do {
            PH_TRY(take_event(k, least, err));
            least = ph_i_scan(w->scan, w->u, 1.0);
        } while (least <= 1.0 && !k->severed);
        if (k->left > 0.0) PH_TRY(solve_ahead(k, err));
    }
out:
    return st;
}

static ph_status begin(walk *k, const ph_fe2_node *child, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_fe2 *f = k->f;
    const ph_fe2_node *from = child->parent;
    k->before = from->damage;
    k->left = 1.0;
    for (int i = 0; i < f->ns; i++) {
        const double scale = ph_i_fe2_scale(f->ns, i, true, true);
        k->de[i] = child->dstrain[i] * scale;
        k->end[i] = child->s.strain[i] * scale;
        k->w->macro[i] = from->s.strain[i] * scale;
    }
    PH_TRY(load_bonds(k->f, k->w, from->damage, err));
    superpose(f, from->damage->u, k->w->macro, k->w->u);
    superpose(f, from->damage->u, k->de, k->w->du);
    PH_ALLOC(k->bond, k->before->nbonds, "broken bonds");
    if (k->before->nbonds)
        memcpy(k->bond, k->before->bond, sizeof *k->bond * (size_t)k->before->nbonds);
    k->nbonds = k->before->nbonds;
    k->severed =
        from->s.events > 0 && energy_of(f->ns, &from->damage->c, k->end) <=
                                  nothing_left * energy_of(f->ns, &f->first, k->end);
out:
    return st;
}

/* What the walk found, into the child. */
static void publish(walk *k, ph_fe2_node *child, ph_fe2_damage *d)
{
    ph_fe2 *f = k->f;
    pthread_mutex_lock(&f->lock);
    if (!child->known) {
        child->damage = d;
        d->holds++;
        child->broke = k->events > 0;
        child->tangent = d->c;
        for (int i = 0; i < f->ns; i++) {
            double sum = 0.0;
            for (int j = 0; j < f->ns; j++)
                sum += d->c.m[i][j] * k->end[j];
            child->s.stress[i] = sum * ph_i_fe2_scale(f->ns, i, false, false);
        }
        child->s.broken_bonds = d->nbonds;
        child->s.events += k->events;
        child->s.dissipated += k->dissipated;
        child->known = true;
        f->counts.events += (long)k->events;
        ph_i_fe2_recount(f, child);
    }
    pthread_mutex_unlock(&f->lock);
}

ph_status ph_i_fe2_walk(ph_fe2 *f, ph_fe2_node *child, const ph_ctx *ctx, ph_error *err)
{
    ph_status st = PH_OK;
    walk k = {.f = f};
    ph_fe2_damage *d = NULL;
    PH_TRY(ph_i_fe2_take_worker(f, ctx, &k.w, err));
    PH_TRY(begin(&k, child, err));
    PH_TRY(follow(&k, err));
    if (k.events > 0) {
        PH_TRY(
            new_damage(f, k.w, (double *const *)k.before->u, &k.bond, k.nbonds, &d, err));
        set_damage(f, k.w, d);
    }
    publish(&k, child, d ? d : child->parent->damage);
out:
    ph_i_fe2_return_worker(f, &k.w);
    free(k.bond);
    pthread_mutex_lock(&f->lock);
    ph_i_fe2_drop_damage(f, &d);
    pthread_mutex_unlock(&f->lock);
    return st;
}
