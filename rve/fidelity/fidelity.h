/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inside of automatic fidelity. */
#ifndef RVE_FIDELITY_H
#define RVE_FIDELITY_H

#include "trade/trade.h"

#include <perihom_fidelity.h>

/** Error expected on n nodes along the longest axis, by the plan. */
double ph_i_fidelity_expected(const ph_fidelity_plan *plan, double n);
/* ---- plan.c */

/** A reason, at the end of the list. */
void ph_i_fidelity_say(ph_fidelity_plan *p, const char *fmt, ...) PH_PRINTF(2, 3);
/** Axes of the box: 2 or 3. */
int ph_i_fidelity_axes(const ph_case *c);
/** Nodes of the longest axis. */
ptrdiff_t ph_i_fidelity_longest(const ptrdiff_t nodes[3]);
/** The next even number of nodes that is 4, 5 or 6 times a power of two: transforms like it. */
ptrdiff_t ph_i_fidelity_round(double n);
/** The grid with so many nodes along its longest axis, its shape that of the case's. */
void ph_i_fidelity_grid(const ph_case *c, ptrdiff_t n, ptrdiff_t nodes[3]);
/** Stiffest over softest eigenvalue of the phases; infinite with a void. */
double ph_i_fidelity_contrast(const ph_case *c);

#endif
