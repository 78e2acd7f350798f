/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An RVE that relaxes is linear in the increment of the macro strain: the step of dt from a
 * state is its step at constant strain, du_0, and deps times the fields of unit loads,
 *
 *     du = du_0 + sum_a deps_a U_a(dt),   sigma = sigma_past + C_alg(dt) deps
 *
 * U and C_alg belong to dt, du_0 and sigma_past to the state and dt. A macroscale iteration
 * that tries another deps solves nothing. */
#include "effective/fe2.h"

#include <string.h>

/* ---- tangents ---------------------------------------------------------------------------- */

static ph_fe2_tangent *find_tangent(ph_fe2 *f, double dt)
{
    for (ph_fe2_tangent **at = &f->tangents; *at; at = &(*at)->next) {
        ph_fe2_tangent *t = *at;
        if (t->dt != dt) continue;
        *at = t->next; /* the latest used is the first */
        t->next = f->tangents;
        f->tangents = t;
        t->holds++;
        return t;
    }
    return NULL;
}

static size_t tangent_bytes(const ph_fe2 *f)
{
    return sizeof(ph_fe2_tangent) + (size_t)f->ns * f->unknowns * sizeof(double);
}

static void keep_tangent(ph_fe2 *f, ph_fe2_tangent *t)
{
    int kept = 0;
    t->next = f->tangents;
    t->holds++;
    f->tangents = t;
    f->bytes += tangent_bytes(f);
    f->counts.tangents++;
    for (ph_fe2_tangent **at = &f->tangents; *at;) {
        if (++kept <= f->most_tangents) {
            at = &(*at)->next;
            continue;
        }
        ph_fe2_tangent *old = *at;
        *at = old->next;
        f->bytes -= tangent_bytes(f);
        ph_i_fe2_drop_tangent(f, &old);
    }
}

static ph_status make_tangent(ph_fe2 *f, double dt, const ph_ctx *ctx,
                              ph_fe2_tangent **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_fe2_tangent *t = NULL;
    ph_fe2_worker *w = NULL;
    PH_ALLOC(t, 1, "a tangent");
    t->holds = 1;
    t->dt = dt;
    for (int a = 0; a < f->ns; a++)
        PH_DOUBLES(t->u[a], NULL, f->unknowns, "the fields of a tangent");
    PH_TRY(ph_i_fe2_take_worker(f, ctx, &w, err));
    ph_i_stepper_reset(w->stepper);
    PH_TRY(ph_i_stepper_tangent(w->stepper, dt, &t->c, t->u, err));
    for (int i = 0; i < f->ns; i++)
        for (int j = 0; j < i; j++)
            t->c.m[i][j] = t->c.m[j][i] = 0.5 * (t->c.m[i][j] + t->c.m[j][i]);
    *out = t;
    t = NULL;
out:
    ph_i_fe2_return_worker(f, &w);
    ph_i_fe2_drop_tangent(f, &t);
    return st;
}

ph_status ph_i_fe2_tangent_of(ph_fe2 *f, double dt, const ph_ctx *ctx,
                              ph_fe2_tangent **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_fe2_tangent *t, *other;
    pthread_mutex_lock(&f->lock);
    t = find_tangent(f, dt);
    pthread_mutex_unlock(&f->lock);
    if (!t) {
        PH_TRY(make_tangent(f, dt, ctx, &t, err));
        pthread_mutex_lock(&f->lock);
        other = find_tangent(f, dt); /* another thread was faster */
        if (other)
            ph_i_fe2_drop_tangent(f, &t);
        else
            keep_tangent(f, t);
        if (other) t = other;
        pthread_mutex_unlock(&f->lock);
    }
    *out = t;
out:
    return st;
}

/* ---- the step at constant strain --------------------------------------------------------- */

static ph_status make_step(ph_fe2 *f, const ph_fe2_node *node, ph_fe2_tangent *t,
                           const ph_ctx *ctx, ph_fe2_step **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_fe2_step *p = NULL;
    ph_fe2_worker *w = NULL;
    double nothing[6] = {0}, response[6];
    PH_ALLOC(p, 1, "a step");
    p->holds = 1;
    p->dt = t->dt;
    PH_DOUBLES(p->du, NULL, f->unknowns, "a step");
    PH_TRY(ph_i_fe2_take_worker(f, ctx, &w, err));
    ph_i_stepper_restore(w->stepper, node->block);
    PH_TRY(ph_i_stepper_begin(w->stepper, t->dt, err));
    PH_TRY(ph_i_stepper_solve(w->stepper, nothing, err));
    PH_TRY(ph_i_stepper_response(w->stepper, response, p->history, err));
    memcpy(p->du, w->stepper->du, f->unknowns * sizeof *p->du);
    *out = p;
    p = NULL;
out:
    ph_i_fe2_return_worker(f, &w);
    ph_i_fe2_drop_step(f, &p);
    return st;
}

/* With the lock: the node's step of dt, held; or NULL. */
static ph_fe2_step *step_of(ph_fe2_node *node, double dt)
{
    if (!node->step || node->step->dt != dt) return NULL;
    node->step->holds++;
    return node->step;
}

static ph_status find_step(ph_fe2 *f, ph_fe2_node *node, ph_fe2_tangent *t,
                           const ph_ctx *ctx, ph_fe2_step **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_fe2_step *p, *other;
    pthread_mutex_lock(&f->lock);
    p = step_of(node, t->dt);
    pthread_mutex_unlock(&f->lock);
    if (!p) {
        PH_TRY(make_step(f, node, t, ctx, &p, err));
        pthread_mutex_lock(&f->lock);
        other = step_of(node, t->dt);
        if (other) {
            ph_i_fe2_drop_step(f, &p);
            p = other;
        } else {
            p->tangent = t;
            t->holds++;
            p->holds++;
            ph_i_fe2_drop_step(f, &node->step);
            node->step = p;
            ph_i_fe2_recount(f, node);
        }
        pthread_mutex_unlock(&f->lock);
    }
    *out = p;
out:
    return st;
}

static void let_go(ph_fe2 *f, ph_fe2_step **p)
{
    pthread_mutex_lock(&f->lock);
    ph_i_fe2_drop_step(f, p);
    pthread_mutex_unlock(&f->lock);
}

ph_status ph_i_fe2_prepare(ph_fe2 *f, ph_fe2_node *node, ph_fe2_tangent *t,
                           const ph_ctx *ctx, ph_error *err)
{
    ph_fe2_step *p = NULL;
    ph_status st = find_step(f, node, t, ctx, &p, err);
    let_go(f, &p);
    return st;
}

/* ---- children ---------------------------------------------------------------------------- */

static void mandel_increment(const ph_fe2 *f, const ph_fe2_node *child, double *out)
{
    for (int i = 0; i < f->ns; i++)
        out[i] = child->dstrain[i] * ph_i_fe2_scale(f->ns, i, true, true);
}

ph_status ph_i_fe2_superpose(ph_fe2 *f, ph_fe2_node *child, ph_fe2_tangent *t,
                             const ph_ctx *ctx, ph_error *err)
{
    ph_status st = PH_OK;
    ph_fe2_step *p = NULL;
    double de[6], stress[6];
    PH_TRY(find_step(f, child->parent, t, ctx, &p, err));
    mandel_increment(f, child, de);
    for (int i = 0; i < f->ns; i++) {
        stress[i] = p->history[i];
        for (int j = 0; j < f->ns; j++)
            stress[i] += t->c.m[i][j] * de[j];
        stress[i] *= ph_i_fe2_scale(f->ns, i, false, false);
    }
    pthread_mutex_lock(&f->lock);
    if (!child->known) {
        memcpy(child->s.stress, stress, sizeof(double) * (size_t)f->ns);
        child->tangent = t->c;
        child->from = p;
        p = NULL;
        child->known = true;
    }
    pthread_mutex_unlock(&f->lock);
out:
    let_go(f, &p);
    return st;
}

/* du_0 + sum_a deps_a U_a; the next first guess is du_0, for it is what the next step asks. */
static ph_status make_block(ph_fe2 *f, const ph_fe2_node *child, const ph_fe2_step *p,
                            ph_fe2_worker *w, double *block, ph_error *err)
{
    ph_status st = PH_OK;
    ph_stepper *s = w->stepper;
    double *du = NULL, de[6];
    PH_DOUBLES(du, NULL, f->unknowns, "an increment");
    mandel_increment(f, child, de);
    memcpy(du, p->du, f->unknowns * sizeof *du);
    for (int a = 0; a < f->ns; a++)
        for (size_t x = 0; de[a] != 0.0 && x < f->unknowns; x++)
            du[x] += de[a] * p->tangent->u[a][x];
    ph_i_stepper_restore(s, child->parent->block);
    PH_TRY(ph_i_stepper_take(s, p->dt, du, de, err));
    memcpy(s->last, p->du, f->unknowns * sizeof *du);
    ph_i_stepper_save(s, block);
out:
    ph_i_doubles_free(NULL, &du, 0);
    return st;
}

ph_status ph_i_fe2_advance(ph_fe2 *f, ph_fe2_node *child, ph_error *err)
{
    ph_status st = PH_OK;
    ph_fe2_worker *w = NULL;
    ph_fe2_step *p = NULL;
    double *block = NULL;
    pthread_mutex_lock(&f->lock);
    bool done = child->block != NULL;
    if (!done) {
        p = child->from;
        p->holds++;
    }
    pthread_mutex_unlock(&f->lock);
    if (done) return PH_OK;
    PH_DOUBLES(block, NULL, f->block, "the state of a point");
    PH_TRY(ph_i_fe2_take_worker(f, NULL, &w, err));
    PH_TRY(make_block(f, child, p, w, block, err));
    pthread_mutex_lock(&f->lock);
    if (!child->block) {
        child->block = block;
        block = NULL;
        ph_i_fe2_drop_step(f, &child->from);
        ph_i_fe2_recount(f, child);
    }
    pthread_mutex_unlock(&f->lock);
out:
    ph_i_fe2_return_worker(f, &w);
    let_go(f, &p);
    ph_i_doubles_free(NULL, &block, 0);
    return st;
}
