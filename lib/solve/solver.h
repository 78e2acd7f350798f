/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A solver is a value: what it is called, when it may be used, and three functions. */
#ifndef PH_SOLVE_SOLVER_H
#define PH_SOLVE_SOLVER_H

#include "constraint/constraint.h"
#include "solve/cg.h"
#include "solve/green.h"

/** What is to be solved: the operator on a box, some of its nodes held. */
typedef struct ph_system {
    ph_operator *op;
    const ph_setting *setting;
    const ph_operator_params *params; /* what `op` is made of */
    const ph_stiffness_map *map;
    ph_meter *meter;
    bool one_sided; /* families end at the faces of the RVE */
    bool relaxes;   /* phases relax: solved many times */
    bool few;       /* mean stresses, which only double precision has, are fewer loads */
} ph_system;

typedef struct ph_solver_method {
    ph_entry info;
    bool keeps_matrix; /* init looks at the entries: again when bonds have broken */
    /* NULL, or why this solver cannot take this system, whose `op` need not be there */
    const char *(*refuses)(const ph_system *system);
    ph_status (*init)(const ph_system *system, void **state, ph_error *err);
    /* A u = load on the free nodes, u = 0 on the others; real space [nd][cells]. `load` may
     * be op->f and `u` op->u, the operator's own work fields: take what is needed of `load`
     * before the operator is applied, and write `u` last. Where report->guessed, u holds a
     * first guess, which may be taken or ignored. */
    ph_status (*solve)(void *state, const double *load, double *u, ph_cg_report *report,
                       ph_error *err);
    void (*free)(void **state);
    /* Take in the bonds of system->params->broken that broke since `init` or the last call;
     * *done: false, init is to be called instead. NULL: always init. */
    ph_status (*broke)(void *state, bool *done, ph_error *err);
    /* The load is that of a mean strain [ns] Mandel, -B^T C strain, which is free to change:
     * u and strain with no force on the nodes and the mean stress of the strain it had,
     *   A u + B^T C strain = 0,  mean of C (B u + strain) = mean of C strain_before.
     * The residual is relative to the load of the strain that is found. Periodic boxes with
     * points that have a strain, nothing broken. NULL: no such route. */
    ph_status (*solve_free)(void *state, const double *load, double *u, double *strain,
                            ph_cg_report *report, ph_error *err);
    const struct ph_solver_method *single; /* the same in single precision, or NULL */
} ph_solver_method;

extern const ph_solver_method ph_solvers[];
extern const size_t ph_nsolvers;

/* The four functions of a solver NAME are ph_i_NAME_refuses, _init, _solve and _free. */
#define PH_SOLVER_FUNCTIONS(name)                                                        \
    const char *ph_i_##name##_refuses(const ph_system *system);                          \
    ph_status ph_i_##name##_init(const ph_system *system, void **state, ph_error *err);  \
    ph_status ph_i_##name##_solve(void *state, const double *load, double *u,            \
                                  ph_cg_report *report, ph_error *err);                  \
    void ph_i_##name##_free(void **state)
PH_SOLVER_FUNCTIONS(fft_cg);
ph_status ph_i_fft_cg_solve_free(void *state, const double *load, double *u,
                                 double *strain, ph_cg_report *report, ph_error *err);
PH_SOLVER_FUNCTIONS(fft_cg_single);
PH_SOLVER_FUNCTIONS(direct);
PH_SOLVER_FUNCTIONS(relaxation);
ph_status ph_i_direct_broke(void *state, bool *done, ph_error *err);
/** Factors that it has made since `init`. */
int ph_i_direct_factors(const void *state);

/** Green's operator of the reference medium of fft_cg, as ph_i_green_init. */
ph_status ph_i_reference_green(const ph_system *system, ph_green *green, double *storage,
                               ph_error *err);
/** What fft_cg works with, for other iterations on the same system: the system, whose vectors
 *  are half spectra or, where nodes are held, fields; and its vectors x, r, p, q. */
void ph_i_fft_cg_parts(void *state, ph_linear *system, double *vector[4]);
/** A load as a vector of the system, and the field of a vector (`work` as large, or x). */
void ph_i_fft_cg_enter(void *state, const double *load, double *r);
void ph_i_fft_cg_leave(void *state, const double *x, double *work, double *u);

/** Residuals below this are refined in double: docs/theory/solvers.md. */
#define PH_SINGLE_LIMIT 1e-5

extern const ph_entry ph_precisions[]; /* double, single, auto */
extern const size_t ph_nprecisions;

/** A name of ph_precisions[], or NULL? */
bool ph_i_precision_is_known(const char *name);

/** Which solver takes a system, in which precision, and why `auto` said so, or "". */
typedef struct ph_solver_choice {
    const ph_solver_method *method;
    const char *precision;
    char why[2][256]; /* of the solver, of the precision */
} ph_solver_choice;

/** The solver that `params` name, or that `auto` takes; the operator need not be there.
 *  @return PH_OK; PH_EINVAL: unknown names, or that solver or precision cannot take it */
ph_status ph_i_solver_choose(const ph_solver_params *params, const ph_system *system,
                             ph_solver_choice *out, ph_error *err);
/** The solver called `name`, in double, or NULL. */
const ph_solver_method *ph_i_solver_find(const char *name);

#endif
