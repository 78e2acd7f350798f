/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the analytic bounds and estimates share. All of the shape-dependent ones are
 *
 *  C = C0 + sum_i f_i (C_i - C0) A_i (sum_i f_i A_i)^-1,  A_i = [I + P(C0) (C_i - C0)]^-1
 *
 * with one or another medium C0, or the differential form of it. */
#ifndef PH_EFFECTIVE_COMPOSITE_H
#define PH_EFFECTIVE_COMPOSITE_H

#include <perihom/estimates.h>

#include "core/check.h"

/** Entry of every method: is the composite well formed, and does the method take it?
 *  `refusal` is what the method's `refuses` said of it. */
ph_status ph_i_composite_check(const ph_composite *composite, const char *refusal,
                               ph_error *err);
/** Stiffness of phase i in the composite's kinematics; a void is zero. */
ph_status ph_i_phase_stiffness(const ph_composite *composite, int i, ph_sym4 *c,
                               ph_error *err);
/** Symmetric part: what is left of a product that is symmetric but for round-off. */
ph_sym4 ph_i_symmetric(const ph_sym4 *c);
/** Inverse of a tensor without major symmetry; PH_ESINGULAR. `inv` may be `a`. */
ph_status ph_i_inverse_general(const ph_sym4 *a, ph_sym4 *inv, ph_error *err);
/** Strain concentration A = [I + P (C1 - C0)]^-1. */
ph_status ph_i_concentration(const ph_sym4 *p, const ph_sym4 *c0, const ph_sym4 *c1,
                             ph_sym4 *a, ph_error *err);
/** sum_i f_i (C_i - C0) A_i and, where not NULL, sum_i f_i A_i, in the medium c0. */
ph_status ph_i_polarise(const ph_composite *composite, const ph_sym4 *c0,
                        ph_sym4 *polarisation, ph_sym4 *mean, ph_error *err);
/** The formula above for the medium c0. */
ph_status ph_i_mix(const ph_composite *composite, const ph_sym4 *c0, ph_sym4 *out,
                   ph_error *err);

/** Reasons of refusal, NULL if there is none. */
const char *ph_i_shape_refusal(const ph_composite *composite);
const char *ph_i_matrix_refusal(const ph_composite *composite);
/** Is any phase with a fraction above zero a void? */
bool ph_i_has_void(const ph_composite *composite);
/** Are all phases isotropic (voids are)? */
bool ph_i_all_isotropic(const ph_composite *composite);

#define PH_I_METHOD(name)                                                                \
    const char *ph_i_##name##_refuses(const ph_composite *composite);                    \
    ph_status ph_i_##name(const ph_composite *composite, ph_sym4 *out, ph_error *err)

PH_I_METHOD(voigt);
PH_I_METHOD(reuss);
PH_I_METHOD(hashin_shtrikman_lower);
PH_I_METHOD(hashin_shtrikman_upper);
PH_I_METHOD(walpole_lower);
PH_I_METHOD(walpole_upper);
PH_I_METHOD(laminate);
PH_I_METHOD(dilute);
PH_I_METHOD(mori_tanaka);
PH_I_METHOD(self_consistent);
PH_I_METHOD(differential);
PH_I_METHOD(generalised_self_consistent);

#endif
