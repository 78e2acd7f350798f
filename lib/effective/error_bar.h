/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PH_EFFECTIVE_ERROR_BAR_H
#define PH_EFFECTIVE_ERROR_BAR_H

#include <perihom/error_bar.h>

/** The tensor that is judged. */
const ph_sym4 *ph_i_error_tensor(const ph_error_evidence *e);
/** Row of a component 0 .. 5 (11 22 33 23 13 12) in this tensor. */
int ph_i_error_component(const ph_error_evidence *e, int component);
/** sqrt(C_ii C_jj) of an entry C_ij, Voigt. */
double ph_i_error_beside(const ph_error_evidence *e, const ph_quantity *q);
/** A constant of another tensor of the same kinematics, or NaN. */
double ph_i_error_value(const ph_error_evidence *e, const ph_quantity *q,
                        const ph_sym4 *stiffness);

#endif
