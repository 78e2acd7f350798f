/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dense matrices, column by column, whose rows or columns may differ by many orders of
 * magnitude: orthogonal factors with pivoting and singular values by one-sided rotations,
 * which find small ones to relative accuracy [Demmel1992], [Drmac2008].
 * Tested: tests/unit/test_dense.c */
#ifndef PH_CORE_DENSE_H
#define PH_CORE_DENSE_H

#include <stddef.h>

/** a . b, n numbers */
double ph_i_inner(ptrdiff_t n, const double *restrict a, const double *restrict b);

/** A P = Q R by Householder reflections, m x n, k = min(m, n) of them.
 *  @param[in,out] a  columns of m; below and on the diagonal the reflections, above it R
 *  @param[out] diagonal [k] of R
 *  @param[out] beta     [k] factors of the reflections
 *  @param[in,out] order [n] the columns in the order of their pivots, largest first; NULL:
 *             no pivoting. Columns of `a` are swapped with it. */
void ph_i_qr(int m, int n, double *a, double *diagonal, double *beta, int *order);
/** x = Q x, or Q^T x. @param k reflections, x [m] */
void ph_i_qr_apply(int m, int k, const double *a, const double *beta, double *x);
void ph_i_qr_transposed(int m, int k, const double *a, const double *beta, double *x);

/** Householder QR in place: the first n of the columns of `a` become R (an upper triangle,
 *  zeros below), the others what the same reflections make of them: their first n rows are
 *  Q'b, the rows below what is orthogonal to the first n columns. Also for m < n.
 *  @param[in,out] a column k at a + k m, [columns][m] */
void ph_i_qr_columns(ptrdiff_t m, int n, int columns, double *a);

/** A = U S V^T: turns the columns of a until they are orthogonal, so that a ends as U S with
 *  zero columns where S has zeros. @param[in,out] a [n] columns of m, m >= n
 *  @param[out] s [n] singular values, in no order */
void ph_i_singular_values(int m, int n, double *a, double *s);

#endif
