/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Model bond whose moduli relax: sets of springs that take turns in one operator.
 *
 * The modulus of a class of bonds is its first value times a function of time, see
 * visco_bonds.h; with tau_1 < tau_2 < .. the times of all functions it is E_inf + sum_m E_m
 * exp(-t/tau_m), and each part is a medium of springs. No bond remembers anything by itself.
 * Tested: tests/cross/test_viscoelastic_routes.c */
#ifndef PH_EFFECTIVE_RELAXING_BONDS_H
#define PH_EFFECTIVE_RELAXING_BONDS_H

#include "effective/visco_bonds.h"
#include "model/operator.h"

typedef struct ph_relaxing_bonds {
    ph_operator *op;          /* borrowed */
    ph_bond_classes *classes; /* borrowed: the operator's own */
    ph_bond_functions functions;
    int ntimes;
    double *time;            /* [ntimes] increasing */
    double *factor;          /* [functions] work */
    ph_springs *own;         /* the operator's, while another set is shown */
    int slots;               /* other sets: */
    ph_bond_classes *tables; /* [slots] the classes with tables of their own */
    ph_springs **springs;    /* [slots] */
} ph_relaxing_bonds;

/** @param slots sets of springs beside the operator's
 *  @return PH_OK; PH_EUNPHYSICAL (Poisson's ratio of a phase moves); PH_ENOMEM */
ph_status ph_i_relaxing_bonds_new(ph_operator *op, ph_bond_classes *classes,
                                  const ph_microstructure *micro, int slots,
                                  ph_relaxing_bonds **out, ph_error *err);
/** The operator is left with its own springs as they were made last. */
void ph_i_relaxing_bonds_free(ph_relaxing_bonds **bonds);
/** Make a set of the moduli infinity E_inf + sum_m weight_m E_m. @param slot -1: the
 *  operator's own, which is shown then */
ph_status ph_i_relaxing_bonds_make(ph_relaxing_bonds *bonds, int slot, double infinity,
                                   const double *weight, ph_error *err);
/** Let the operator have a set. */
void ph_i_relaxing_bonds_show(ph_relaxing_bonds *bonds, int slot);

#endif
