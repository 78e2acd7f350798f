/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The load of a failure at lambda = 1: a macro strain, of which some components may be found
 * so that they carry no stress, under any constraint that solves equations.
 *
 * The columns are solved, the answer is put together: one column for all strains that are
 * prescribed, one for every free one; under a constraint that loads by stress one traction
 * for every strain that is prescribed. Amplitudes a_c follow from the means that are asked
 * for, <strain>_i = E_i or <stress>_i = 0.
 * Tested: tests/verify/test_failure_constraints.c */
#ifndef PH_EFFECTIVE_UNIT_LOAD_H
#define PH_EFFECTIVE_UNIT_LOAD_H

#include "effective/run.h"

enum { PH_UNIT_COLUMNS = 7 };

typedef struct ph_unit_column {
    int component; /* -1: the prescribed strains together */
    bool by_stress;
    double *u;                   /* [nd][cells] */
    double stress[6], strain[6]; /* means, Mandel */
} ph_unit_column;

typedef struct ph_unit_load {
    ph_run *run;         /* borrowed */
    double direction[6]; /* Mandel; zero where free */
    int columns;
    ph_unit_column column[PH_UNIT_COLUMNS];
    bool single; /* one column of prescribed strains: it is the answer */
    double amplitude[PH_UNIT_COLUMNS];
    size_t size;   /* doubles of a field */
    double *field; /* the answer, but of a single column */
    double scale;  /* largest mean of the first solution: what counts as nothing */
    bool solved;
    /* The answer. */
    const double *u;             /* [nd][cells], beside */
    double macro[6];             /* a uniform strain, Mandel */
    double stress[6], strain[6]; /* means, Mandel */
    double work;                 /* stress : strain */
    double energy;               /* of the medium, twice, per volume */
    bool apart;     /* a body that tractions pull has come apart: it carries nothing */
    int iterations; /* of all columns */
    double residual;
} ph_unit_load;

/** @param[in] strain direction, Voigt order, engineering shear
 *  @param[in] free   bit a: component a is found, its stress is zero */
ph_status ph_i_unit_load_init(ph_unit_load *unit, ph_run *run, const double *strain,
                              unsigned free, ph_error *err);
void ph_i_unit_load_clear(ph_unit_load *unit);
/** Solve, from the columns of the last time. Cost: `columns` solves.
 *  @param[in] energy_most a single column may stop where this is the energy of its error,
 *             u . A u, as far as the last steps tell; 0: the solver's tolerance */
ph_status ph_i_unit_load_solve(ph_unit_load *unit, double energy_most, ph_error *err);
/** Mean stress and strain of u as it is; work and energy stay. */
ph_status ph_i_unit_load_measure(ph_unit_load *unit, ph_error *err);

#endif
