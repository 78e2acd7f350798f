/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PH_MATERIAL_PRONY_REDUCE_H
#define PH_MATERIAL_PRONY_REDUCE_H

#include <perihom/prony.h>

/** The series that a kinematic assumption leaves of a spatial one: itself, its in-plane block
 *  (plane strain), or, with sigma33 = sigma23 = sigma13 = 0 at all times (plane stress), the
 *  block condensed at every value of the Carson variable.
 *
 *  Condensation couples the terms: where bulk and shear relax each on their own the reduced
 *  series has relaxation times of its own. With C_m = L_m L_m^T and y_m = L_m^T v_m, v_m the
 *  viscous strain of branch m,
 *      sigma = C0 e - sum L_m y_m,   tau_m dy_m/dt = L_m^T e - y_m
 *  and e_b eliminated by sigma_b = 0, the symmetric matrix
 *      S = T^-1/2 (1 - L_b^T C0_bb^-1 L_b) T^-1/2,   T = diag(tau)
 *  has the rates 1/tau' as eigenvalues lambda, and the terms are g g^T / lambda with
 *  g = (L_a^T - L_b^T C0_bb^-1 C0_ba)^T T^-1/2 v. Exact; positive semidefinite by form.
 *  Where every tensor of the series is a multiple of one, each is reduced by itself.
 *
 *  @param[in] series n = 6, or already reduced (then copied)
 *  @return PH_OK; PH_EINVAL; PH_ESINGULAR (no resistance across the plane); PH_ENOMEM.
 *  Cost: O((6 terms)^3). Tested: tests/unit/test_prony_reduce.c */
ph_status ph_i_prony_reduce(const ph_prony *series, ph_kinematics kin, ph_prony **out,
                            ph_error *err);

#endif
