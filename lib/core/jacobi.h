/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PH_CORE_JACOBI_H
#define PH_CORE_JACOBI_H

/** Eigenvalues and eigenvectors of a small symmetric matrix, by cyclic Jacobi rotations:
 *  needs no memory, cannot fail, and finds small eigenvalues to relative accuracy.
 *  @param[in,out] a n x n, rows `stride` apart; ends with the eigenvalues on its diagonal
 *  @param[out]    v eigenvector k in column k, rows `stride` apart; NULL: not wanted */
void ph_i_jacobi(int n, int stride, double *a, double *v);

#endif
