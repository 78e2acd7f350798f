/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An RVE problem whose phases depend on a Carson variable: one operator, whose stiffness is
 * set to any s, and the basis of fields with the reduced model that they make. */
#ifndef PH_EFFECTIVE_VISCO_H
#define PH_EFFECTIVE_VISCO_H

#include <perihom/viscoelastic.h>

#include "effective/run.h"
#include "effective/visco_bonds.h"
#include "effective/visco_layers.h"
#include "effective/visco_model.h"

/** A field of the basis: fluctuation u, and what the cells hide. */
typedef struct ph_basis_field {
    double *u; /* [nd][cells] */
    double
        macro[6]; /* uniform strain beside u (uniform_traction: so that the mean is 0) */
    double *x;    /* strains of the layers, [records][layers.record] */
} ph_basis_field;

typedef struct ph_visco {
    ph_run run;
    ph_viscoelastic *out;
    double tolerance;
    ph_split split;
    ph_bond_functions bonds; /* model bond */
    int nfunctions;          /* of phases, or of bonds */
    ph_layers layers;
    ph_sites sites;
    ph_sym4 *phase, *space; /* [materials] at s: of the kinematics, and n = 6 */
    ph_sym4 *shape;         /* [functions][materials] of the kinematics; of six: zero */
    int soft;               /* the phase that (S) follows */
    double softness;        /* of it at s = infinity */
    double least;           /* lower bound of the preconditioned operator at s, or 0 */
    bool fluid;             /* a phase whose equilibrium stiffness is singular */
    ph_reduced model;
    double *whole; /* [functions][6][6] macro rows of the model without its layers */
    int nbasis, room;
    ph_basis_field *basis;
    double *r[6], *d[6];    /* [nd][cells] residuals and corrections of the loads */
    double *u, *f;          /* [nd][cells] work */
    double *strain, *x, *y; /* work of the layers */
} ph_visco;

/* ---- visco.c ------------------------------------------------------------------------------ */

/** The run with its operator at s = infinity and an empty basis; or, where no equations are
 *  to be solved (voigt, reuss, a homogeneous cell), no operator and the whole model. */
ph_status ph_i_visco_begin(ph_visco *v, const ph_problem *problem,
                           const ph_relaxation_params *params, const ph_ctx *ctx,
                           ph_viscoelastic *out, ph_error *err);
void ph_i_visco_clear(ph_visco *v);
/** The same as far as it decides on the discretisation, for a route that solves its own
 *  elastic problems: everything but operator and model. */
ph_status ph_i_visco_choose(ph_visco *v, const ph_problem *problem, const ph_ctx *ctx,
                            ph_error *err);
/** How far the phase that (S) follows has relaxed: its mean modulus at s over that at first. */
double ph_i_visco_factor(const ph_visco *v, double s);
/** Mean modulus that (S) takes from a tensor, as ph_stiffness_map.softest. */
double ph_i_visco_softness(const ph_sym4 *c);
/** Phases, operator and solver at s. */
ph_status ph_i_visco_set(ph_visco *v, double s, ph_error *err);
/** Move the elastic result and the counts into the answer. */
void ph_i_visco_end(ph_visco *v, double start);
static inline size_t ph_i_visco_size(const ph_visco *v)
{
    return (size_t)(v->run.op->layout.nd * v->run.op->layout.cells);
}
static inline size_t ph_i_visco_hidden(const ph_visco *v)
{
    return (size_t)(v->sites.records * v->layers.record);
}

/* ---- visco_lumped.c ------------------------------------------------------------------------ */

/** The model of phases of one strain (uniform), or of one stress.
 *  @param[in] fraction [materials] */
ph_status ph_i_visco_lumped(ph_visco *v, bool uniform, const double *fraction,
                            ph_error *err);

/* ---- visco_gram.c -------------------------------------------------------------------------- */

/** The rows of the macro strains in the model. */
ph_status ph_i_visco_macro_rows(ph_visco *v, ph_error *err);
/** The rows of the last `more` fields of the basis. Leaves the operator at no s. */
ph_status ph_i_visco_gram(ph_visco *v, int more, ph_error *err);

/* ---- visco_visit.c ------------------------------------------------------------------------- */

/** Solve at s from the reduced solution, and see how far it was.
 *  @param[in] share  solve until the energy left is this share of the tolerance
 *  @param[in] enough an error that asks for no more fields
 *  @param[out] error relative error of the model at s; left: of the model that follows
 *  @param[out] added fields that the basis took: of the corrections, those worth it */
ph_status ph_i_visco_visit(ph_visco *v, double s, double share, double enough,
                           double *error, double *left, int *added, ph_error *err);

/** Eigenvalues of a in the metric of b (positive definite). */
void ph_i_visco_relative(const ph_sym4 *a, const ph_sym4 *b, double *low, double *high);
/** The softest phase in the metric of the reference medium. A laminate is not below it, and
 *  (S) is the same in both: neither is the preconditioned operator. 0: a void, no bound. */
double ph_i_visco_least(const ph_stiffness_map *map);

/* ---- visco_path.c -------------------------------------------------------------------------- */

/** Values of s along which the contrast of the phases changes, see visco_path.c. */
typedef struct ph_path {
    int n;
    double *s, *t; /* [n] falling s from infinity; t: how far the contrast has moved */
} ph_path;
ph_status ph_i_path_new(const ph_visco *v, double tolerance, ph_path *out, ph_error *err);
void ph_i_path_clear(ph_path *path);

/* ---- viscoelastic.c ------------------------------------------------------------------------ */

/** Series, its ends and the values asked for, from a model.
 *  @param[in] fluid a phase has a singular equilibrium stiffness: what is left of the
 *             effective one below the tolerance is zero */
ph_status ph_i_visco_answer(ph_viscoelastic *out, const ph_reduced *model,
                            const ph_relaxation_params *params, bool fluid,
                            double tolerance, ph_error *err);

/* ---- routes -------------------------------------------------------------------------------- */

#define PH_RELAXATION_ROUTE(name)                                                        \
    ph_status ph_i_relaxation_##name(                                                    \
        const ph_problem *problem, const ph_relaxation_params *params,                   \
        const ph_ctx *ctx, ph_viscoelastic *out, ph_error *err)
PH_RELAXATION_ROUTE(reduced);
PH_RELAXATION_ROUTE(carson);
PH_RELAXATION_ROUTE(stepping);
PH_RELAXATION_ROUTE(frequency);

#endif
