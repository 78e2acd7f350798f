/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PH_CORE_NNLS_H
#define PH_CORE_NNLS_H

#include "core/check.h"

/** Solve R x = b with the n x n triangle that ph_i_qr_columns left; entries whose pivot is below
 *  1e-15 of the largest become zero. @param[in] b [n], e.g. the head of a later column */
void ph_i_back_substitute(ptrdiff_t m, int n, const double *a, const double *b,
                          double *x);

/** Least squares with x >= 0: min |A x - b|, by the active-set method of Lawson and Hanson,
 *  columns scaled to length 1. The matrix is first brought to a triangle by ph_i_qr_columns (of
 *  [A b]), so that the condition is that of A, not of A'A.
 *  @param[in,out] a   column k at a + k m, then b as column n: [n + 1][m]; destroyed
 *  @param[out]    x   [n], zeros where the bound holds
 *  @param[out]    rss |A x - b|^2, or NULL
 *  @return PH_OK; PH_ENOMEM; PH_ENOCONV after 30 n steps. Cost: m n^2 once, then n^3 a step.
 *  Ref: [Lawson1974], ch. 23. Tested: tests/unit/test_nnls.c */
ph_status ph_i_nnls(ptrdiff_t m, int n, double *a, double *x, double *rss, ph_error *err);

#endif
