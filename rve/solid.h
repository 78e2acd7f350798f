/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Geometry of one solid that the painter needs beyond the public part. */
#ifndef PH_RVE_SOLID_H
#define PH_RVE_SOLID_H

#include "perihom_rve.h"

/** Fill bounds, slice and prism from the rest. */
void ph_i_solid_finish(ph_solid *solid);
/** Where the line x + t e_axis is inside: t in [t[0], t[1]]; false if nowhere. */
bool ph_i_solid_chord(const ph_solid *solid, const double x[3], int axis, double t[2]);
/** Area of the section at coordinate `at` of `axis` within the rectangle that lo..hi leaves
 *  of the two other axes. Exact to rounding. */
double ph_i_solid_section(const ph_solid *solid, int axis, double at, const double lo[3],
                          const double hi[3]);

#endif
