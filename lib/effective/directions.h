/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Strains of the form sym(a (x) n), for one direction n. */
#ifndef PH_EFFECTIVE_DIRECTIONS_H
#define PH_EFFECTIVE_DIRECTIONS_H

#include <perihom/tensor.h>

/** N[a][i]: Mandel strain a of sym(e_i (x) n); n = 3 or 6 strains. */
void ph_i_normal_matrix(int n, const double normal[3], double N[6][3]);
/** Inverse of a symmetric positive d x d matrix, d = 2 or 3; false if its determinant is
 *  not positive. Sets M[2][2] where d = 2. */
bool ph_i_invert_small(int d, double M[3][3], double R[3][3]);
/** CN = C N and Z = N^T C N. */
void ph_i_contract(const ph_sym4 *c, double N[6][3], double CN[6][3], double Z[3][3]);
/** Gamma(n) = N (N^T C N)^-1 N^T; false where the medium does not resist. */
bool ph_i_gamma(const ph_sym4 *c, const double normal[3], ph_sym4 *gamma);

#endif
