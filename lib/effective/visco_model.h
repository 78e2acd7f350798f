/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The reduced model: energies of macro strains and basis fields, function by function.
 *
 *   2 W(e, c; s) = (e c) . sum_q phi_q(s) K_q . (e c),   C*(s) = min over c
 *
 * Every K_q is a Gram matrix, so that C*(s) is the Carson transform of a Prony series with
 * positive semidefinite terms: the poles of ph_i_reduced_series.
 * Tested: tests/unit/test_visco_model.c */
#ifndef PH_EFFECTIVE_VISCO_MODEL_H
#define PH_EFFECTIVE_VISCO_MODEL_H

#include "effective/visco_functions.h"

typedef struct ph_reduced {
    int ns; /* macro strains, before the basis fields */
    int n;  /* ns + basis fields */
    int room;
    int nfunctions;
    const ph_decay *function; /* borrowed */
    double **K;               /* [nfunctions][room * room] symmetric, rows `room` apart */
} ph_reduced;

ph_status ph_i_reduced_init(ph_reduced *model, int ns, int nfunctions,
                            const ph_decay *function, ph_error *err);
void ph_i_reduced_clear(ph_reduced *model);
/** Room for `more` basis fields, whose entries are zero. model->n grows. */
ph_status ph_i_reduced_grow(ph_reduced *model, int more, ph_error *err);
/** K_q[i][j] and K_q[j][i] += value */
void ph_i_reduced_add(ph_reduced *model, int q, int i, int j, double value);

/** C*(s) and the minimisers.
 *  @param[out] c [ns][n - ns] of unit macro strain a in row a; NULL: not wanted */
ph_status ph_i_reduced_at(const ph_reduced *model, double s, ph_sym4 *C, double *c,
                          ph_error *err);

/** C*(t) with the exact poles of the model.
 *  Cost: cubic in (n - ns) times the number of relaxation times. */
ph_status ph_i_reduced_series(const ph_reduced *model, ph_prony **out, ph_error *err);

#endif
