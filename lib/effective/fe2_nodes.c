/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tree of histories: who stands where, what is kept, what is forgotten. */
#include "effective/fe2.h"

#include <string.h>

static size_t field_bytes(const ph_fe2 *f)
{
    return f->unknowns * sizeof(double);
}

static size_t step_bytes(const ph_fe2 *f)
{
    return sizeof(ph_fe2_step) + field_bytes(f);
}

static size_t damage_bytes(const ph_fe2 *f, const ph_fe2_damage *d)
{
    return sizeof *d + (size_t)d->nbonds * sizeof *d->bond +
           (size_t)f->ns * field_bytes(f);
}

/* Shared parts are counted where they were made: a step where it starts, bonds where they
 * broke. */
static size_t bytes_of(const ph_fe2 *f, const ph_fe2_node *n)
{
    size_t bytes = sizeof *n;
    if (n->block) bytes += f->block * sizeof *n->block;
    if (n->step) bytes += step_bytes(f);
    if (n->damage && n->broke) bytes += damage_bytes(f, n->damage);
    return bytes;
}

void ph_i_fe2_recount(ph_fe2 *f, ph_fe2_node *n)
{
    const size_t now = bytes_of(f, n);
    f->bytes += now - n->bytes;
    if (n->holds == 0) f->idle += now - n->bytes;
    n->bytes = now;
}

/* ---- what is shared ---------------------------------------------------------------------- */

static void free_fields(double *u[6])
{
    for (int a = 0; a < 6; a++)
        ph_i_doubles_free(NULL, &u[a], 0);
}

void ph_i_fe2_drop_tangent(ph_fe2 *f, ph_fe2_tangent **tangent)
{
    (void)f;
    ph_fe2_tangent *t = *tangent;
    *tangent = NULL;
    if (!t || --t->holds > 0) return;
    free_fields(t->u);
    free(t);
}

void ph_i_fe2_drop_step(ph_fe2 *f, ph_fe2_step **step)
{
    ph_fe2_step *s = *step;
    *step = NULL;
    if (!s || --s->holds > 0) return;
    ph_i_fe2_drop_tangent(f, &s->tangent);
    ph_i_doubles_free(NULL, &s->du, 0);
    free(s);
}

void ph_i_fe2_drop_damage(ph_fe2 *f, ph_fe2_damage **damage)
{
    (void)f;
    ph_fe2_damage *d = *damage;
    *damage = NULL;
    if (!d || --d->holds > 0) return;
    free_fields(d->u);
    free(d->bond);
    free(d);
}

/* ---- a node ------------------------------------------------------------------------------ */

ph_status ph_i_fe2_node_new(ph_fe2 *f, const ph_fe2_node *parent, const double *dstrain,
                            double dt, ph_fe2_node **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_fe2_node *n = NULL;
    PH_ALLOC(n, 1, "the state of a point");
    n->holds = 1;
    if (parent) {
        n->s = parent->s;
        n->s.time += dt;
        n->s.increments++;
        n->dt = dt;
        for (int i = 0; i < f->ns; i++) {
            n->dstrain[i] = dstrain[i];
            n->s.strain[i] += dstrain[i];
        }
    }
    *out = n;
out:
    return st;
}

static void unlink_by_use(ph_fe2 *f, ph_fe2_node *n)
{
    *(n->older ? &n->older->newer : &f->oldest) = n->newer;
    *(n->newer ? &n->newer->older : &f->newest) = n->older;
    n->older = n->newer = NULL;
}

static void link_newest(ph_fe2 *f, ph_fe2_node *n)
{
    n->older = f->newest;
    *(f->newest ? &f->newest->newer : &f->oldest) = n;
    f->newest = n;
}

static bool is_listed(const ph_fe2 *f, const ph_fe2_node *n)
{
    return n->older || n->newer || f->oldest == n;
}

static void unlink_from_parent(ph_fe2_node *n)
{
    if (!n->parent) return;
    ph_fe2_node **at = &n->parent->child;
    while (*at != n)
        at = &(*at)->sibling;
    *at = n->sibling;
    n->parent = n->sibling = NULL;
}

static void free_node(ph_fe2 *f, ph_fe2_node *n)
{
    if (is_listed(f, n)) {
        unlink_by_use(f, n);
        f->counts.states--;
    }
    ph_i_fe2_drop_step(f, &n->step);
    ph_i_fe2_drop_step(f, &n->from);
    ph_i_fe2_drop_damage(f, &n->damage);
    ph_i_doubles_free(NULL, &n->block, 0);
    free(n);
}

/* Take a node that nobody holds out of the tree, and what only it led to. A chain may be
 * long: no recursion. */
static void forget(ph_fe2 *f, ph_fe2_node *n)
{
    ph_fe2_node *list = n;
    unlink_from_parent(n);
    while (list) {
        n = list;
        list = n->sibling;
        f->idle -= n->bytes;
        f->bytes -= n->bytes;
        for (ph_fe2_node *c = n->child, *next; c; c = next) {
            next = c->sibling;
            c->parent = c->sibling = NULL;
            if (c->holds > 0) continue;
            c->sibling = list;
            list = c;
        }
        free_node(f, n);
    }
}

static void trim(ph_fe2 *f)
{
    ph_fe2_node *n = f->oldest;
    while (n && f->idle > f->budget) {
        while (n && (n->holds > 0 || n == f->root))
            n = n->newer;
        if (!n) return;
        forget(f, n);
        n = f->oldest; /* what followed may be gone too */
    }
}

/* ---- holding ----------------------------------------------------------------------------- */

void ph_i_fe2_hold(ph_fe2 *f, ph_fe2_node *n)
{
    if (n->holds++ == 0) f->idle -= n->bytes;
    if (f->newest == n) return;
    unlink_by_use(f, n);
    link_newest(f, n);
}

void ph_i_fe2_drop(ph_fe2 *f, ph_fe2_node **node)
{
    ph_fe2_node *n = *node;
    *node = NULL;
    if (!n || --n->holds > 0) return;
    if (!is_listed(f, n)) { /* never was in the tree */
        free_node(f, n);
        return;
    }
    f->idle += n->bytes;
    if (!n->parent && n != f->root)
        forget(f, n);
    else
        trim(f);
}

/* Into the lists, under a parent or on its own. */
void ph_i_fe2_plant(ph_fe2 *f, ph_fe2_node *n, ph_fe2_node *parent)
{
    n->parent = parent;
    if (parent) {
        n->sibling = parent->child;
        parent->child = n;
    }
    link_newest(f, n);
    f->counts.states++;
    ph_i_fe2_recount(f, n);
}

static ph_fe2_node *find(const ph_fe2 *f, const ph_fe2_node *parent,
                         const double *dstrain, double dt)
{
    const size_t bytes = sizeof *dstrain * (size_t)f->ns;
    for (ph_fe2_node *c = parent->child; c; c = c->sibling)
        if (c->dt == dt && memcmp(c->dstrain, dstrain, bytes) == 0) return c;
    return NULL;
}

ph_status ph_i_fe2_child(ph_fe2 *f, ph_fe2_node *parent, const double *dstrain, double dt,
                         ph_fe2_node **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_fe2_node *n = NULL, *other;
    pthread_mutex_lock(&f->lock);
    other = find(f, parent, dstrain, dt);
    if (other) ph_i_fe2_hold(f, other);
    pthread_mutex_unlock(&f->lock);
    if (!other) {
        PH_TRY(ph_i_fe2_node_new(f, parent, dstrain, dt, &n, err));
        pthread_mutex_lock(&f->lock);
        other = find(f, parent, dstrain, dt); /* another thread was faster */
        if (other) {
            ph_i_fe2_hold(f, other);
            ph_i_fe2_drop(f, &n);
        } else {
            ph_i_fe2_plant(f, n, parent);
            other = n;
        }
        pthread_mutex_unlock(&f->lock);
    }
    *out = other;
out:
    return st;
}

void ph_i_fe2_fell(ph_fe2 *f)
{
    while (f->oldest)
        free_node(f, f->oldest);
}
