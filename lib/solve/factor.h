/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cholesky factors of sparse matrices: the only file that knows CHOLMOD [Chen2008]. */
#ifndef PH_SOLVE_FACTOR_H
#define PH_SOLVE_FACTOR_H

#include "model/bondlist.h"

typedef struct ph_factor ph_factor;

/** A = L L^T after a fill-reducing permutation (AMD, or METIS where AMD does badly).
 *  @return PH_OK; PH_ESINGULAR if A is not positive definite; PH_EINVAL if L would have
 *          more than PH_MATRIX_MOST entries; PH_ENOMEM */
ph_status ph_i_factor_new(const ph_csc *matrix, ph_factor **out, ph_error *err);
void ph_i_factor_free(ph_factor **factor);
/** Rough reciprocal condition: (smallest / largest diagonal entry of L)^2. */
double ph_i_factor_condition(const ph_factor *factor);
/** Bytes of L. */
size_t ph_i_factor_bytes(const ph_factor *factor);
/** x = A^-1 b, [n]. @return PH_OK; PH_ENOMEM. */
ph_status ph_i_factor_solve(ph_factor *factor, const double *b, double *x, ph_error *err);
/** The same for several at once, [count][n]. */
ph_status ph_i_factor_solve_all(ph_factor *factor, int count, const double *b, double *x,
                                ph_error *err);

#endif
