/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One call of ph_homogenise, from the problem to the result. */
#ifndef PH_EFFECTIVE_RUN_H
#define PH_EFFECTIVE_RUN_H

#include "effective/symmetry.h"
#include "model/models.h"
#include "solve/solver.h"

/* Everything that one call makes and has to release. */
typedef struct ph_run {
    const ph_problem *problem;
    ph_problem own; /* model bond: the problem with the material at the nodes */
    const ph_ctx *ctx;
    bool keep_fields; /* of the loads that are solved now */
    int threads;
    ph_meter meter;
    const ph_constraint_method *constraint;
    ph_setting setting;
    ph_stiffness_map *map;
    ph_operator_params params;
    ph_family *family;
    ph_bond_classes *classes;  /* model bond, or NULL */
    ph_broken *broken;         /* with cracks, or NULL */
    ph_cell_symmetry symmetry; /* count 0: not looked for */
    double *first[6];          /* guesses of the loads: the last step's fields, or NULL */
    ph_operator *op;
    ph_system system;
    const ph_solver_method *solver;
    void *state;
    double *load, *u; /* the operator's work fields, see solver.h */
    int soft;         /* phases that relax: the one that (S) follows, */
    double softness;  /* and its softness at once */
    double contrast;  /* `auto` counts on at least this, of phases that
                                           * relax */
    ph_sym4 columns;  /* C or, by_stress, the compliance */
    bool no_stress;   /* mean stresses were tried: strains are to be solved */
    ph_sym4
        compliance; /* of loads that are a mean stress of a periodic cell: its columns, */
    double strain[6][6];         /* and the mean strain of each */
    double *kept[6], *pulled[6]; /* displacements of both kinds of loads, or NULL, */
    double *residual, *product;  /* for the second-order columns */
    ph_sym4 second, second_compliance; /* u_a . r_b per averaged cell, a <= b */
    double stress_left[6];             /* of a mean stress, what the last load has not */
    ph_work work;                      /* counted so far, see ph_i_run_account */
    ph_result *result;
} ph_run;

/** Check the problem and make the result with its fractions and simple bounds. */
ph_status ph_i_run_begin(ph_run *run, ph_error *err);
/** Decide what `auto` leaves open; map and setting of the box that is solved. */
ph_status ph_i_run_prepare(ph_run *run, ph_error *err);
/** PH_EINVAL: cracks, and a constraint that solves no equations. */
ph_status ph_i_run_check_analytic(const ph_run *run, ph_error *err);
/** The relative residual that the problem asks for. */
double ph_i_run_tolerance(const ph_run *run);
/** The solver that a prepared run takes; refuses what no solver can. */
ph_status ph_i_run_choose_solver(ph_run *run, ph_solver_choice *out, ph_error *err);
/** PH_EINVAL where a route that has no other is to be solved in single precision. */
ph_status ph_i_run_in_double(const ph_run *run, const char *route, ph_error *err);
/** The operator and its solver. */
ph_status ph_i_run_build(ph_run *run, ph_error *err);
/** All of these for phases that relax, with the choices of `reduced`: `auto` sees the
 *  contrast of all times, (S) follows the phase that is softest late. Comes with problem and
 *  ctx. Cracks are cut
 *  as they are. @return PH_EINVAL for a constraint without equations, and a sequence */
ph_status ph_i_run_relaxing(ph_run *run, ph_error *err);
/** Time, memory and counts of a run that began at `start`, into its result. */
double ph_i_run_now(void);
void ph_i_run_account(ph_run *run, double start, double solving);
/** Work of two solutions, one after the other. */
void ph_i_work_add(ph_work *sum, const ph_work *more);
/** Release everything but the result. */
void ph_i_run_clear(ph_run *run);
/** The effective tensor of a cell that needs no equations: one stiffness everywhere, or layers
 *  of a periodic cell; false where equations are to be solved. @param[out] why [64] */
bool ph_i_run_closed_form(const ph_run *run, ph_sym4 *stiffness, char *why);
unsigned ph_i_run_all_loads(const ph_result *result);
/** What run->symmetry can be. Needs ph_i_run_prepare. */
ph_status ph_i_run_find_symmetry(ph_run *run, ph_error *err);
/** How many loads equations are solved for: those from which all that is wanted follows. */
int ph_i_run_load_count(const ph_run *run);

/** Node of the RVE at a node of the box that is solved, or -1: it is outside. */
ptrdiff_t ph_i_run_node_of_rve(const ph_run *run, ptrdiff_t node);

/** Take in what has broken since the operator was built. */
ph_status ph_i_run_rebuild(ph_run *run, ph_error *err);
/** All steps of the cracks, the pristine cell first. */
ph_status ph_i_run_damage(ph_run *run, ph_error *err);
/** The parts of it: the pristine cell, and room for the steps; then the damage and the
 *  stiffness of the bonds that are broken now; `apart`: there is none. */
ph_status ph_i_damage_begin(ph_run *run, ph_sequence_kind kind, int nsteps,
                            ph_error *err);
ph_status ph_i_damage_step(ph_run *run, ph_damage_step *step, bool apart, ph_error *err);
/** Cut the bonds that cross the cracks. @param[in] inside those of the collar stay whole
 *  @param[in] note say how many cracks cut none */
ph_status ph_i_run_cut(ph_run *run, const ph_cracks *cracks, bool inside, bool note,
                       ph_error *err);
/** Those of the problem, as they are in its last step, with notes. @param[out] density and
 *  number of them, 0 where there are none */
ph_status ph_i_run_cut_last(ph_run *run, double *density, ptrdiff_t *count,
                            ph_error *err);
/** Is the collar of a material of its own, which cracks do not reach? */
bool ph_i_run_whole_collar(const ph_run *run);
/** Tangents and damage tensors of all steps, when they are there. */
void ph_i_damage_measures(ph_result *result);

/** Take out of a stiffness what a solver leaves of nothing: eigenvalues below 1e-10 of the
 *  largest. */
void ph_i_drop_nothing(ph_sym4 *stiffness);

/** The solver's solution for a load [nd][cells], counted. */
ph_status ph_i_run_iterate(ph_run *run, const double *load, double *u,
                           ph_cg_report *report, ph_error *err);
/** Displacement of a macro strain or, by_stress, of a traction, [ns] Mandel, into run->u, from
 *  a guess [nd][cells] or NULL. @param[in] energy_most see ph_cg_report; 0: the tolerance
 *  alone. @param[out] report iterations and residual */
ph_status ph_i_run_solve(ph_run *run, const double *macro, bool by_stress,
                         const double *guess, double energy_most, ph_cg_report *report,
                         ph_error *err);
/** Are the entries of the tensor refined with the fields of all loads? */
bool ph_i_run_second_order(const ph_run *run);
/** Loads, bit a: unit macro strain a; unit mean stress a of a periodic cell, whose mean strain
 *  is found with its displacement. */
typedef struct ph_load_plan {
    unsigned strain, stress;
} ph_load_plan;
/** The loads whose columns are wanted; ph_i_symmetry_loads of them are to be solved. Constants of the compliance take their row of it, each from one mean stress, where the solver
 *  can do that and it is fewer loads than the strains of their block. */
ph_load_plan ph_i_run_plan(const ph_run *run);
/** Are mean stresses fewer loads, where the solver has them? */
bool ph_i_run_stress_is_less(const ph_run *run);
int ph_i_run_count(unsigned loads);
/** Solve the loads asked for, fill the columns; then the stiffness from the columns. */
ph_status ph_i_run_loads(ph_run *run, ph_error *err);
ph_status ph_i_run_stiffness(ph_run *run, ph_error *err);
/** A load did not converge: the columns of those before it. */
void ph_i_run_solved_columns(ph_run *run);
/** Is component `load` of a by_stress constraint a stress? A macro stress is prescribed, but
 *  for components that no displacement of this grid can produce (33 of generalised plane
 *  strain): there it is the strain. */
bool ph_i_run_by_stress(const ph_run *run, int load);

/** NULL-safe. */
void ph_i_fields_free(int count, ph_fields *fields);
/** Keep displacement, strain and stress of the load just solved, per unit of its Voigt
 *  component. */
ph_status ph_i_run_keep_fields(ph_run *run, int load, const double *macro, ph_error *err);

#endif
