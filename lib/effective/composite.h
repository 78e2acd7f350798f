/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the analytic bounds and estimates share. */
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

#define PH_I_METHOD(name)                                                                \
    const char *ph_i_##name##_refuses(const ph_composite *composite);                    \
    ph_status ph_i_##name(const ph_composite *composite, ph_sym4 *out, ph_error *err)

PH_I_METHOD(voigt);
PH_I_METHOD(reuss);

#endif
