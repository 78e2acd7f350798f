/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PERIHOM_HOMOGENISE_H
#define PERIHOM_HOMOGENISE_H

#include <perihom/bond.h>
#include <perihom/damage.h>
#include <perihom/failure.h>
#include <perihom/family.h>
#include <perihom/prony.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum ph_stabilisation {
    PH_STABILISE_AUTO,
    PH_STABILISE_SPECTRAL, /* (S): uniform coefficient, diagonal in Fourier space */
    PH_STABILISE_SUBPOINT, /* (P): a share of the energy at sub-points of each cell */
    PH_STABILISE_NONE
} ph_stabilisation;

typedef enum ph_interface {
    PH_INTERFACE_COMPOSITE,
    PH_INTERFACE_NODE_CENTRE
} ph_interface;

/** What a bond does, and where. Zeroed: all defaults. */
typedef struct ph_model_params {
    const char *kind; /* in ph_models[]: "nosb" (NULL), "local", "bond" */
    ph_points points; /* of nosb */
    double horizon;   /* 0: default (2 spacings for nodes, smallest for stress points;
                       * bond: 3 spacings) */
    bool horizon_is_length; /* else in spacings, the widest one */
    const char *influence;  /* in ph_influences[]; NULL: "constant" */
    const char *weights;    /* in ph_volume_weights[]; NULL: "linear", bond: "exact" */
    ph_stabilisation stabilisation;
    double stabilisation_value; /* alpha or theta; 0: default */
    /* Spacings (of the widest axis) by which cracks are cut shorter at every tip, 0 to 2: what
     * a crack seems too long on the lattice, see docs/theory/cracks.md */
    double crack_tips;
    /* of bond */
    double kappa;             /* modulus of interphase bonds over that of the matrix;
                               * 0 or NaN: their modulus is the harmonic mean */
    const char *micromodulus; /* in ph_micromoduli[]; NULL: "constant" */
    double power;             /* alpha of power_law */
    ph_calibration calibration;
} ph_model_params;

/** How the equations are solved. Zeroed: all defaults. */
typedef struct ph_solver_params {
    const char *kind; /* in ph_solvers[]; NULL or "auto" */
    double tolerance; /* relative residual; 0: 1e-6 */
    double energy;    /* > 0: conjugate gradients of periodic loads may stop before, once
                            * their last steps lowered the energy of the error by no more than
                            * this share of that of the effective medium */
    int max_iterations;    /* 0: 2000 */
    const char *precision; /* of the iterates: "double" (NULL), "single" or "auto", as in
                            * `perihom list precisions`; docs/theory/solvers.md */
} ph_solver_params;

/** Where linear_displacement has its boundary volume, two horizons thick. */
typedef enum ph_collar {
    PH_COLLAR_INSIDE, /* one horizon of it inside the RVE, whose averages are then exact */
    PH_COLLAR_PERIODIC, /* all outside, filled by the periodic continuation */
    PH_COLLAR_MATRIX    /* all outside, filled by collar_material */
} ph_collar;

typedef struct ph_constraint_params {
    const char *kind; /* in ph_constraints[]; NULL: "periodic" */
    ph_collar collar;
    int collar_material; /* for PH_COLLAR_MATRIX */
} ph_constraint_params;

/** A problem: what to homogenise and how. Borrows everything it points to. */
typedef struct ph_problem {
    const ph_microstructure *micro;
    ph_interface interface;
    ph_model_params model;
    ph_constraint_params constraint;
    ph_solver_params solver;
    unsigned loads; /* bit a: solve macro strain a; 0: all */
    /* [nconstants] only the loads that these quantities of the result need, instead of
     * `loads`; 0: `loads`. Fewer than ph_quantity_loads in a symmetric cell, and where one mean
     * stress gives a row of the compliance. */
    int nconstants;
    const struct ph_quantity *constants;
    bool keep_fields;        /* keep displacement, strain, stress of each load */
    const ph_cracks *cracks; /* NULL or none: no bond is broken */
    const ph_crack_sequence *sequence; /* of the cracks; NULL: as they are */
    const ph_failure *failure;         /* of the bonds, with a loading */
    const ph_loading *loading;         /* NULL: nothing breaks but what cracks cut */
} ph_problem;

/** The fields of one load case on the RVE, component first: [component][cell], for one unit
 *  of the load's Voigt component (engineering strain; uniform_traction: stress).
 *  Displacement is the total one, eps_bar x + fluctuation, at the cell centres (nodes) or at
 *  the lower corners of the cells (stress points, local). Strain and stress: Voigt order,
 *  engineering shear. */
typedef struct ph_fields {
    int load;
    double macro_strain[6]; /* eps_bar of the load, Voigt order, engineering shear */
    int nu, ns;             /* components of displacement, strain */
    double *displacement;   /* [nu][cells] */
    double *strain;         /* [ns][cells] */
    double *stress;         /* [ns][cells] */
} ph_fields;

#define PH_MAX_NOTES 16

/** What model bond has to say beside. */
typedef struct ph_bond_report {
    bool present;
    const char *micromodulus, *calibration; /* catalogue names */
    double power, kappa;                    /* NaN where not given */
    ph_bond_lattice lattice;
    /* linear_displacement with the frame outside: the stiffness of the RVE from the forces
     * that cross its faces, columns as `stiffness` before it is made symmetric. `stiffness`
     * itself is the bond virial, a bond that leaves the RVE counted by half. */
    bool has_reactions;
    ph_sym4 virial, reactions;
} ph_bond_report;

/** What a solution did and what it held, counted. What a scene does not require is exactly
 *  zero. Tested: tests/verify/test_work.c */
typedef struct ph_work {
    long loads;               /* loads that the equations were solved for */
    long iterations;          /* of them together */
    long applications;        /* of the operator */
    long ffts;                /* scalar real transforms */
    ptrdiff_t collar;         /* nodes that are solved for outside the RVE */
    size_t history_variables; /* numbers that the material remembers from step to step */
    size_t bond_bits;         /* bits that say which bonds are broken */
    size_t peak_bytes;        /* of the solver's own arrays */
} ph_work;

/** What came out, what it cost and what it is worth. Owns its arrays. */
typedef struct ph_result {
    ph_grid grid;
    /* effective, Mandel; column a is load a, zero where not solved; NaN: an entry that takes
     * the fields of a load that was not solved */
    ph_sym4 stiffness;
    unsigned loads;  /* which columns are there */
    unsigned solved; /* of which loads; the other columns follow by symmetry */
    /* Columns of the compliance from loads that are a mean stress (periodic; constants that
     * need no more of the tensor), Mandel; `stresses`: which are there, `solved_stresses`: of
     * which loads. Entries that were not refined where they should be are NaN. */
    ph_sym4 compliance;
    unsigned stresses, solved_stresses;
    ph_sym4 voigt, reuss;
    bool reuss_is_zero; /* a void phase: the lower bound is zero */
    int nmaterials;
    char (*names)[64];
    double *fractions;

    const char *model, *constraint, *solver; /* catalogue names */
    const char *precision; /* of the solver's iterates: "double" or "single" */
    ph_points points;
    double horizon; /* length */
    ph_stabilisation stabilisation;
    double stabilisation_value;
    ph_interface interface;
    const char *route; /* "cells", "stencil", "convolution", "bonds", "analytic" */

    int nloads;
    int iterations[6];
    double residual[6];
    bool converged;
    double hill_mandel;    /* worst load: |<s:e> - <s>:<e>| / |<s:e>|, the energy of
                                  * the stabilisation counted with <s:e> */
    double strain_average; /* worst load: |<e> - eps_bar| / |eps_bar| */
    /* |C - C^T| / |C| before C was made symmetric; where cracks leave less than 1e-3 of the
     * softest phase, over that */
    double asymmetry;
    bool
        second_order; /* entries are energies of pairs of fields, not averages of stress */
    double stabilisation_energy; /* worst load: share of the total energy */
    /* why residuals and the four measures above are NaN; NULL: they were computed */
    const char *unchecked;

    ph_bond_report bond;
    ph_damage *damage; /* with cracks; the stiffness above is that of the last step */

    ph_failure_path
        *failure; /* with a loading; damage and stiffness are those of its steps */

    ph_work work;
    double seconds, seconds_solve;
    int threads;

    int nnotes;
    char notes[PH_MAX_NOTES][256]; /* choices of `auto`, warnings */

    /* error bars, where somebody who solved companions put them; owned, or NULL */
    struct ph_error_bar *error_bar;

    /* effective series, where somebody who solved the relaxation put it; owned, or NULL */
    ph_prony *relaxation;

    int nfields;
    ph_fields *fields; /* [nfields], where keep_fields */
} ph_result;

/** Effective stiffness of a microstructure.
 *
 *  @return PH_OK; PH_ENOCONV (then `out` still holds the report and the columns of the
 *          loads solved before, and err the iteration and residual); PH_EINVAL; PH_ESINGULAR; PH_ENOMEM;
 *          PH_ECANCELLED. Cost: iterations x loads x O(n log n). */
PH_API ph_status ph_homogenise(const ph_problem *problem, const ph_ctx *ctx,
                               ph_result **out, ph_error *err);
PH_API void ph_result_free(ph_result **result);

/** What a problem would take, without solving it: counted operations times what they took on
 *  one thread of the machine of docs/performance.md. */
typedef struct ph_estimate {
    ptrdiff_t nodes, unknowns;
    size_t bytes;
    int loads;           /* that the equations are solved for, in each step */
    double seconds_load; /* of one load of the pristine cell, solved from nothing */
    double seconds; /* of all. Bonds that break: until a crack runs through the cell */
    double seconds_least; /* of all, if no bond breaks; else as `seconds` */
    ptrdiff_t bonds;      /* that such a crack cuts; 0: none breaks */
    char notes[PH_MAX_NOTES][256];
    int nnotes;
} ph_estimate;
PH_API ph_status ph_homogenise_estimate(const ph_problem *problem, ph_estimate *out,
                                        ph_error *err);

#ifdef __cplusplus
}
#endif
#endif
