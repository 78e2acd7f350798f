/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cholesky factors of sparse matrices: the only file that knows CHOLMOD [Chen2008]. */
#ifndef PH_SOLVE_FACTOR_H
#define PH_SOLVE_FACTOR_H

#include "model/bondlist.h"

typedef struct ph_factor ph_factor;

/** A = L L^T after a fill-reducing permutation (AMD, or METIS where AMD does badly).
 *  @param changes keep it as L D L^T by columns, so that ph_i_factor_take may follow
 *  @return PH_OK; PH_ESINGULAR if A is not positive definite; PH_EINVAL if L would have
 *          more than PH_MATRIX_MOST entries; PH_ENOMEM */
ph_status ph_i_factor_new(const ph_csc *matrix, bool changes, ph_factor **out,
                          ph_error *err);
/** A -= C C^T by downdating L D L^T [Davis1999], C [n] by columns, whose entries are where A
 *  has some, so that nothing fills in. A that is singular then, or nearly, shows in the
 *  condition, which may be negative: such a factor is of no use.
 *  @return PH_OK; PH_ENOMEM. Cost: for every column the columns of L on its way to the root. */
ph_status ph_i_factor_take(ph_factor *factor, const ph_csc *columns, int count,
                           ph_error *err);
/** Floating-point operations of the factorisation, and of all that was taken since. */
double ph_i_factor_flops(const ph_factor *factor, double *taken);
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
