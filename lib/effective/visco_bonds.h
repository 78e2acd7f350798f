/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Model bond: functions of the Carson variable for classes of bonds instead of phases. A bond
 * of one material has its modulus, one with kappa that of the matrix times kappa, and a
 * harmonic mean of two moduli is the series of two springs in series. What a minimum chose
 * at first it keeps. Tested: tests/cross/test_relaxation_routes.c */
#ifndef PH_EFFECTIVE_VISCO_BONDS_H
#define PH_EFFECTIVE_VISCO_BONDS_H

#include "effective/visco_functions.h"
#include "model/bond_classes.h"

typedef struct ph_bond_functions {
    bool *there; /* [classes] do cells have it? */
    int count;   /* distinct functions */
    ph_decay *function;
    int *of, *of_apart;          /* [classes^2] function of a table entry, or -1 */
    double *first, *first_apart; /* [classes^2] moduli at s = infinity */
} ph_bond_functions;

/** @return PH_OK; PH_EUNPHYSICAL for a phase whose Poisson's ratio moves */
ph_status ph_i_bond_functions_new(const ph_bond_classes *classes,
                                  const ph_microstructure *micro, ph_bond_functions *out,
                                  ph_error *err);
void ph_i_bond_functions_clear(ph_bond_functions *f);
/** Tables of the classes at s, or (function >= 0) what one function has of them. */
void ph_i_bond_functions_set(const ph_bond_functions *f, double s, int function,
                             ph_bond_classes *classes);
/** Smallest modulus of bonds between classes that are there, as the tables now stand. */
double ph_i_bond_functions_least(const ph_bond_functions *f,
                                 const ph_bond_classes *classes);

#endif
