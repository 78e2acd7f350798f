/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Preconditioned conjugate gradients on any vectors. */
#ifndef PH_SOLVE_CG_H
#define PH_SOLVE_CG_H

#include "solve/space.h"

/** A symmetric positive semidefinite system with its preconditioner, in precision R:
 *  apply q = A p, precondition z = M r. */
#define PH_LINEAR(R, suffix)                                                             \
    typedef struct ph_linear##suffix {                                                   \
        const ph_space *space;                                                           \
        void *self;                                                                      \
        void (*apply)(void *self, const R *p, R *q);                                     \
        void (*precondition)(void *self, const R *r, R *z);                              \
    } ph_linear##suffix
PH_LINEAR(double, );
PH_LINEAR(float, _single);

enum { PH_CG_LOOK_BACK = 8 };

/** Where to stop, what to tell, what came out. */
typedef struct ph_cg_report {
    double tolerance; /* in: relative residual |r| <= tolerance |b|, 2-norms */
    int max_iterations;
    const ph_ctx *ctx;
    int load, loads; /* for the progress callback */
    bool guessed;    /* in: the solution holds a first guess; solvers may ignore it */
    int iterations;  /* out */
    double residual; /* out: relative */
    /* Energy of the error, (x - x_k).A.(x - x_k). Conjugate gradients lower it by
     * alpha r.z a step, and with a lower bound `least` of the eigenvalues of M A the rule of
     * Gauss-Radau bounds what is left from above [Golub2010] ch. 12, [Meurant2013]. */
    double least;       /* in: 0: no bound is known, and energy_left is not set */
    double energy_most; /* in: stop as well once energy_left is not above; 0: do not */
    /* in: > 0, where no bound is known: stop as well once so many steps have lowered the
     * energy of the error by no more than energy_most, which was then all that was left
     * before them but for what later ones would add [Golub2010]; at most
     * PH_CG_LOOK_BACK */
    int look_back;
    /* in: > 0: energy_most is this share of energy_start - x_k.A.x_k, with the energy at x = 0
     * that of the effective medium */
    double energy_share, energy_start;
    double energy; /* out: x_k.A.x_k = x.A.x - energy_left, where nothing is guessed */
    double energy_left; /* out: upper bound, or 0 where a solver is not this one */
} ph_cg_report;

/** Tell the caller where the solver is; true if it is to stop. */
bool ph_i_told_to_stop(const ph_cg_report *report);
/** A failure with load, iterations and residual in the message and in `err`. */
ph_status ph_i_give_up(ph_status status, const ph_cg_report *report, const char *why,
                       ph_error *err);

/** Solve A x = b from x = 0, or from the x given where the report says `guessed`.
 *  @param[in,out] r  the right-hand side b; ends as the residual
 *  @param[in,out] x  solution
 *  @param p, q       work vectors
 *  @return PH_OK; PH_ENOCONV with the best iterate in x; PH_ESINGULAR if A is not
 *          positive semidefinite or b does not belong to it; PH_ECANCELLED. */
#define PH_CG(R, suffix)                                                                 \
    ph_status ph_i_cg##suffix(const ph_linear##suffix *system, R *x, R *r, R *p, R *q,   \
                              ph_cg_report *report, ph_error *err)
PH_CG(double, );
PH_CG(float, _single);

#endif
