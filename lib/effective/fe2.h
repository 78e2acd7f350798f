/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inside of FE2. Histories are a tree: a state, and the states that increments lead to. A
 * point stands on a state; equal histories are one state. What computes is a worker (run,
 * operator, solver), as many as threads compute at once.
 *
 * `lock` guards the tree, the lists and the counts. Nothing is computed under it: two threads
 * may make the same thing at once, with the same bits, and the first one's is kept. */
#ifndef PH_EFFECTIVE_FE2_H
#define PH_EFFECTIVE_FE2_H

#include <perihom/fe2.h>

#include "effective/failure_scan.h"
#include "effective/stepper.h"

#include <pthread.h>

/** Algorithmic stiffness of a step of dt and its unit fields. */
typedef struct ph_fe2_tangent {
    struct ph_fe2_tangent *next; /* made before this one */
    int holds;
    double dt;
    ph_sym4 c;
    double *u[6];
} ph_fe2_tangent;

/** A step of dt from a state, without a change of the macro strain. */
typedef struct ph_fe2_step {
    int holds;
    double dt, history[6]; /* stress, Mandel */
    double *du;
    ph_fe2_tangent *tangent; /* held */
} ph_fe2_step;

/** Which bonds are broken, and the RVE without them. */
typedef struct ph_fe2_damage {
    int holds;
    ptrdiff_t nbonds;
    ph_broken_bond *bond;
    ph_sym4 c;
    double *u[6]; /* fields of unit macro strains, Mandel */
} ph_fe2_damage;

typedef struct ph_fe2_node ph_fe2_node;
struct ph_fe2_node {
    ph_fe2_node *parent, *child, *sibling; /* parent NULL: no increment leads here */
    ph_fe2_node *older, *newer;            /* by use */
    int holds;             /* points that stand here, and work under way */
    double dstrain[6], dt; /* from the parent, Voigt */
    bool known;            /* the stress is */
    ph_fe2_state s;
    ph_sym4 tangent;
    double *block;         /* viscoelastic: of the stepper; NULL: not yet */
    ph_fe2_step *step;     /* viscoelastic: held; the last dt that was tried from here */
    ph_fe2_step *from;     /* viscoelastic: held; the parent's, until `block` is made */
    ph_fe2_damage *damage; /* failing: held */
    bool broke;            /* bonds broke on the way here: `damage` is its own */
    size_t bytes;          /* counted for it */
};

typedef struct ph_fe2_worker {
    struct ph_fe2_worker *next;
    ph_run run;
    ph_stepper *stepper;
    ph_strengths *strengths;
    ph_scan *scan;
    ph_fe2_damage *has; /* held: bonds broken in run.broken; NULL: not known */
    bool built;         /* the operator knows them too */
    double macro[6];    /* of the scan */
    double *u, *du;     /* failing: [unknowns] */
} ph_fe2_worker;

struct ph_fe2 {
    ptrdiff_t owners; /* its points, and who made it */
    ph_problem problem;
    ph_loading loading;
    double to;
    ph_fe2_kind kind;
    int ns, threads;
    size_t unknowns, block;  /* doubles of a field, of a stepper's state */
    ptrdiff_t family, cells; /* failing */
    double fingerprint;      /* of the discretisation: a stiffness */
    size_t budget;
    int most_tangents;
    double window;
    pthread_mutex_t lock;
    ph_fe2_node *root, *oldest, *newest;
    ph_fe2_worker *worker; /* at rest */
    ph_fe2_tangent *tangents;
    size_t idle; /* bytes of nodes without points */
    size_t bytes, worker_bytes;
    ph_sym4 first; /* elastic and failing: of the whole cell */
    ph_fe2_counts counts;
};

struct ph_fe2_point {
    ph_fe2 *fe2;
    ph_fe2_node *at, *tried; /* held; tried NULL: nothing */
};

/* ---- fe2_nodes.c ------------------------------------------------------------------------- */

/** A node that is not in the tree, held once. Its time, strain and count follow from the
 *  parent (NULL: virgin). */
ph_status ph_i_fe2_node_new(ph_fe2 *f, const ph_fe2_node *parent, const double *dstrain,
                            double dt, ph_fe2_node **out, ph_error *err);
/** The child of a node for an increment, held; made where it is missing. Takes the lock. */
ph_status ph_i_fe2_child(ph_fe2 *f, ph_fe2_node *parent, const double *dstrain, double dt,
                         ph_fe2_node **out, ph_error *err);
/** With the lock: */
void ph_i_fe2_hold(ph_fe2 *f, ph_fe2_node *node);
void ph_i_fe2_drop(ph_fe2 *f, ph_fe2_node **node);
void ph_i_fe2_drop_step(ph_fe2 *f, ph_fe2_step **step);
void ph_i_fe2_drop_tangent(ph_fe2 *f, ph_fe2_tangent **tangent);
void ph_i_fe2_drop_damage(ph_fe2 *f, ph_fe2_damage **damage);
/** Give back all nodes; no point is left. */
void ph_i_fe2_fell(ph_fe2 *f);
/** Into the tree under a parent, or on its own (NULL). */
void ph_i_fe2_plant(ph_fe2 *f, ph_fe2_node *node, ph_fe2_node *parent);
/** What a planted node has was changed. */
void ph_i_fe2_recount(ph_fe2 *f, ph_fe2_node *node);

/* ---- fe2_worker.c ------------------------------------------------------------------------ */

/** A worker that is at rest, or a new one. Takes the lock. */
ph_status ph_i_fe2_take_worker(ph_fe2 *f, const ph_ctx *ctx, ph_fe2_worker **out,
                               ph_error *err);
void ph_i_fe2_return_worker(ph_fe2 *f, ph_fe2_worker **worker);
void ph_i_fe2_free_worker(ph_fe2 *f, ph_fe2_worker **worker);

/* ---- fe2_viscoelastic.c ------------------------------------------------------------------ */

/** The tangent of dt, held. */
ph_status ph_i_fe2_tangent_of(ph_fe2 *f, double dt, const ph_ctx *ctx,
                              ph_fe2_tangent **out, ph_error *err);
/** See to it that node->step is that of dt, by a solve if it must be. */
ph_status ph_i_fe2_prepare(ph_fe2 *f, ph_fe2_node *node, ph_fe2_tangent *tangent,
                           const ph_ctx *ctx, ph_error *err);
/** Stress of a child from the parent's step. */
ph_status ph_i_fe2_superpose(ph_fe2 *f, ph_fe2_node *child, ph_fe2_tangent *tangent,
                             const ph_ctx *ctx, ph_error *err);
/** The state of a child whose stress is known. */
ph_status ph_i_fe2_advance(ph_fe2 *f, ph_fe2_node *child, ph_error *err);

/* ---- fe2_failure.c ----------------------------------------------------------------------- */

/** The whole cell. */
ph_status ph_i_fe2_whole(ph_fe2 *f, ph_fe2_worker *worker, ph_fe2_node *root,
                         ph_error *err);
/** Walk from the parent to a child, whose stress, damage and energies are then known. */
ph_status ph_i_fe2_walk(ph_fe2 *f, ph_fe2_node *child, const ph_ctx *ctx, ph_error *err);

/* ---- Voigt and Mandel --------------------------------------------------------------------- */

/** Strain (engineering shear) or stress between Voigt and Mandel. */
static inline double ph_i_fe2_scale(int ns, int i, bool strain, bool to_mandel)
{
    const double root = 1.4142135623730951;
    if (i < (ns == 3 ? 2 : 3)) return 1.0;
    return strain == to_mandel ? 1.0 / root : root;
}

#endif
