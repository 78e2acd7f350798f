/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The stiffness of every phase as a sum of scalar functions of the Carson variable times
 * fixed tensors,
 *
 *   C_p(s) = sum_q phi_q(s) X_qp,   phi_q(infinity) = 1,  X_qp positive semidefinite
 *
 * with as few functions as there can be: one for a phase whose tensor keeps its shape, two
 * (bulk, shear) for an isotropic one, one a term for any other; phases share functions that
 * are equal. Function 0 is constant. Tested: tests/unit/test_visco_model.c */
#ifndef PH_EFFECTIVE_VISCO_FUNCTIONS_H
#define PH_EFFECTIVE_VISCO_FUNCTIONS_H

#include <perihom/microstructure.h>

#include "core/check.h"

/** phi(s) = rest + sum_t weight_t s tau_t / (1 + s tau_t), rest + sum weight = 1. */
typedef struct ph_decay {
    double rest;
    int nterms;
    double *time, *weight; /* [nterms] times strictly increasing */
} ph_decay;

/** @param s [1/time, >= 0, INFINITY] */
double ph_i_decay_at(const ph_decay *d, double s);
void ph_i_decay_clear(ph_decay *d);
/** Moduli [p->nterms + 1] at the times of p, the last at rest, as total times a function.
 *  @param[out] total their sum; zero: the function is zero too */
ph_status ph_i_decay_of(const ph_prony *p, const double *modulus, ph_decay *out,
                        double *total, ph_error *err);
/** The same function, to the digits of arithmetic. */
bool ph_i_decay_same(const ph_decay *a, const ph_decay *b);

typedef struct ph_split {
    int nmaterials, nfunctions;
    ph_decay *function; /* [nfunctions] */
    ph_sym4 *shape;     /* [nfunctions][nmaterials], n = 6 */
} ph_split;

ph_status ph_i_split_new(int nmaterials, const ph_material *material, ph_split *out,
                         ph_error *err);
void ph_i_split_clear(ph_split *split);
static inline const ph_sym4 *ph_i_split_shape(const ph_split *s, int function,
                                              int material)
{
    return &s->shape[function * s->nmaterials + material];
}
/** Functions of one material whose tensor is not zero. */
int ph_i_split_count(const ph_split *split, int material);
/** C_p(s), n = 6. */
ph_sym4 ph_i_split_at(const ph_split *split, int material, double s);

#endif
