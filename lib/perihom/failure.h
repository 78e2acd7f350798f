/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Progressive failure: bonds break one after the other under a macro strain that grows. */
#ifndef PERIHOM_FAILURE_H
#define PERIHOM_FAILURE_H

#include <perihom/catalogue.h>
#include <perihom/damage.h>

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** What a criterion may know of a bond. */
typedef struct ph_bond_facts {
    double k;      /* spring constant for E = 1, see ph_bond_family_new */
    double length; /* |xi| */
    double share;  /* part of the cell at its end that lies within the horizon, 0 .. 1 */
    double volume; /* of a cell; per unit thickness in 2D */
} ph_bond_facts;

/** Sums over the bonds of a node that cross a plane, means over the axes of the lattice. A
 *  bond that breaks in a whole lattice releases 1/(1 - rho_b) times what it held, where
 *  rho_b = k_b c_b . A^-1 c_b, 2 dimensions / bonds on the mean. */
typedef struct ph_crossing {
    double stretch; /* sum over b of |xi_n| k_b |xi_b|^4 / (1 - rho_b) */
    double count;   /* sum over b of |xi_n| share_b V / (1 - rho_b) */
} ph_crossing;

/** When a bond breaks: at a stretch (elongation over length), always in tension. */
typedef struct ph_failure_criterion {
    ph_entry info;
    const char *key; /* of the case file, for its value */
    /* Critical stretch of a bond of modulus E where the criterion's value is `value`. */
    double (*stretch)(double value, double E, const ph_bond_facts *bond);
    /* The value for which all bonds that cross a plane release the energy G per area when each
     * breaks at its critical stretch: on the lattice, not in the limit of many bonds. */
    double (*from_energy)(double G, double E, const ph_crossing *crossing);
    bool springs; /* means the energy of a spring: model bond only */
} ph_failure_criterion;
PH_API extern const ph_failure_criterion ph_failure_criteria[];
PH_API extern const size_t ph_nfailure_criteria;
enum { PH_CRITICAL_STRETCH, PH_BOND_ENERGY, PH_UNBREAKABLE }; /* their order */

/** The strength of one class of bonds. */
typedef struct ph_failure_rule {
    bool given;
    int criterion;          /* in ph_failure_criteria */
    double value;           /* of the criterion, > 0; NaN: from the fracture energy */
    double fracture_energy; /* stress times length, > 0; NaN: the value is given */
    /* Shape m > 0 of a Weibull distribution of the critical stretch, bond by bond, scaled so
     * that the mean of its square is as without; 0: none */
    double weibull;
} ph_failure_rule;

/** Strengths of all bonds. Borrows its array. */
typedef struct ph_failure {
    const ph_failure_rule
        *material; /* [materials]: both ends in it; not given: never breaks */
    ph_failure_rule
        interphase; /* ends in two materials; not given: the weaker of the two */
    ph_failure_rule
        agglomeration; /* ends in two fillers; not given: as interphase, or matrix */
    uint64_t seed, realisation; /* of the scatter */
} ph_failure;

/** Macro strain lambda times one direction; lambda goes from 0 to `to[0]`, then to `to[1]`
 *  and so on. With `times`, where phases may relax, it does so at these times, straight
 *  between them. Borrows its arrays. */
typedef struct ph_loading {
    double strain[6]; /* direction, Voigt order of the grid, engineering shear */
    int ntargets;
    const double *to; /* [ntargets] finite */
    int steps;        /* from one target to the next, where results are kept; >= 1 */
    /* One event breaks the bonds whose critical load is within this share of the least one;
     * 0: 0.01. */
    double window;
    /* Instead: all bonds that are beyond critical at a step break together. The results then
     * depend on the number of steps. */
    bool together;
    /* Every event is followed by a solution of the whole box to the solver's tolerance.
     * Otherwise model bond brings patches around the events into equilibrium, and the box
     * after every few dozen bonds, to 1 % of the stretch of a bond that breaks. */
    bool every_event;
    int stiffness_every; /* steps between full stiffness tensors; 0: the last step only */
    /* Bit a: component a of the strain is found, so that its macro stress is zero; strain[a]
     * is 0 then. Not all components. */
    unsigned stress_free;
    /* [ntargets] not decreasing, >= 0: when the targets are reached; two of one time, or the
     * first at 0: a jump. NULL: no time passes, nothing relaxes. */
    const double *times;
    bool by_stress; /* with times: `strain` is the direction of a macro stress instead */
} ph_loading;

/** Energies per volume of the RVE (2D: per area), along a path. */
typedef struct ph_failure_energy {
    double external; /* integral of stress : d strain, by the mean stress */
    double stored;   /* by the energy of the bonds */
    double fracture; /* of the broken bonds when they became critical */
    double
        dissipated; /* fracture and what is set free beyond: taken from the bonds that break,
                        * 1/2 k e- e+ each, e- before and e+ after */
    double viscous; /* dissipated by phases that relax */
} ph_failure_energy;

/** One event: bonds became critical at `load` and were taken away there. The path from event
 *  to event follows the load up and down: crack-length control. */
typedef struct ph_failure_event {
    double load;      /* lambda */
    double time;      /* NaN without times */
    double before;    /* stress along the direction, see ph_failure_path, before it */
    double after;     /* and after, at the same load */
    ptrdiff_t broken; /* bonds, the initial cracks' included */
    ph_failure_energy energy; /* after it */
    int iterations;
    double residual;
} ph_failure_event;

/** A step of the loading: the strain is controlled and jumps over snap-backs. */
typedef struct ph_failure_step {
    double load;
    double time;      /* NaN without times */
    double stress[6]; /* mean, Voigt order */
    double strain[6]; /* mean, Voigt order, engineering shear */
    double work; /* conjugate stress: stress : direction; by_stress: strain : direction */
    ptrdiff_t broken, events;
    ph_failure_energy energy;
} ph_failure_step;

typedef struct ph_broken_bond {
    int32_t node, other; /* cells of the RVE */
    int32_t bond;        /* in the family of `node` */
    int32_t event;
} ph_broken_bond;

/** How far the numbers of a path may be off: differences to the same loading on a coarser grid,
 *  over ratio - 1 and relative. Another grid is another path of breaks, and a horizon of so many
 *  spacings another length: the size of the error as two paths see it, no 95 %. NaN: one of the
 *  two paths has no such number. */
typedef struct ph_failure_error {
    double first_load, peak_load, peak_stress, toughness;
    double first_time, end_time;
    char why[200]; /* why there is none; "": there is one */
} ph_failure_error;

/** What came out. Owns its arrays. */
typedef struct ph_failure_path {
    int n; /* strain components */
    double strain[6];
    unsigned stress_free; /* components that are found */
    ptrdiff_t nevents, event_room;
    ph_failure_event *event;
    int nsteps;
    ph_failure_step *step; /* the unloaded cell first */
    ptrdiff_t nbonds, bond_room;
    ph_broken_bond *bond; /* in the order in which they broke */
    double *share;        /* [bonds of a family] weight of a bond over that of all */
    double *initial;      /* [cells] damage of the initial cracks */
    ptrdiff_t cells;
    double window;
    bool together;
    bool severed; /* no stress is left in the direction of the load */
    bool apart;   /* nothing holds a stress that is given: it ends there */
    /* Of the controlled path: */
    double peak_load, peak_stress; /* largest conjugate stress, at an event or a step */
    double first_load;             /* first event; NaN: none */
    bool in_time, by_stress;       /* as the loading */
    double first_time, end_time;   /* of the first event, and when it was severed; NaN */
    double toughness;              /* integral of conjugate stress over the loading */
    /* worst |external - stored - dissipated - viscous| of an event over the largest external
     * work; in time, of a step */
    double imbalance;
    ph_failure_error *error; /* where somebody who solved a companion put it, or NULL */
} ph_failure_path;
PH_API void ph_failure_path_free(ph_failure_path **path);

/** Damage of every cell at a step: weight of its broken bonds over that of all, 0 .. 1.
 *  @param[out] field [cells] @return PH_OK; PH_EINVAL (no such step) */
PH_API ph_status ph_failure_field(const ph_failure_path *path, int step, double *field,
                                  ph_error *err);

#ifdef __cplusplus
}
#endif
#endif
