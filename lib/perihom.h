/* SPDX-License-Identifier: GPL-3.0-or-later */
/* perihom: effective properties of composites from their microstructure.
 *
 * NOTATION
 *   Small strain. Tensor order 11 22 33 23 13 12 (2D: 11 22 12), axes 1 2 3 = x y z.
 *   Results that people see: Voigt, engineering shear (stress = C * engineering strain).
 *   Inside: Mandel (shear times sqrt 2), so that contraction is a matrix product.
 *   Converted only by ph_sym4_from_voigt / ph_sym4_to_voigt.
 *   Grid: cell (i,j,k) has index (i*n1 + j)*n2 + k, z fastest, 2D has one cell along z.
 *   Fields: component first, [component][cell].
 *   Units: one consistent system per case; perihom never converts.
 *
 * SHAPE OF A CALL
 *   ph_status ph_<noun>_<verb>(inputs, params, **out, ph_error *err): PH_OK or what failed,
 *   with the reason in `err` (may be NULL). Inputs are borrowed for the call; what comes
 *   out through ** is the caller's and goes back to _free, which accepts NULL and nulls.
 *   NULL where something must be there: PH_EINVAL, or from what returns a value NaN, 0, false,
 *   NULL or a tensor with n = 0. What may be NULL says so.
 *   No globals, nothing printed, nothing exits; several problems may run at once. */
#ifndef PERIHOM_H
#define PERIHOM_H

#include <perihom/bond.h>
#include <perihom/card.h>
#include <perihom/case.h>
#include <perihom/catalogue.h>
#include <perihom/crack.h>
#include <perihom/damage.h>
#include <perihom/damage_law.h>
#include <perihom/distribution.h>
#include <perihom/effective.h>
#include <perihom/error.h>
#include <perihom/error_bar.h>
#include <perihom/estimates.h>
#include <perihom/failure.h>
#include <perihom/family.h>
#include <perihom/fe2.h>
#include <perihom/fit.h>
#include <perihom/history.h>
#include <perihom/homogenise.h>
#include <perihom/material.h>
#include <perihom/material_point.h>
#include <perihom/microstructure.h>
#include <perihom/output.h>
#include <perihom/plot.h>
#include <perihom/prony.h>
#include <perihom/quantity.h>
#include <perihom/relaxation.h>
#include <perihom/shift.h>
#include <perihom/superelement.h>
#include <perihom/table.h>
#include <perihom/tensor.h>
#include <perihom/version.h>
#include <perihom/viscoelastic.h>

#endif
