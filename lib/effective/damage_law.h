/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inside of damage laws. */
#ifndef PH_EFFECTIVE_DAMAGE_LAW_H
#define PH_EFFECTIVE_DAMAGE_LAW_H

#include <perihom/damage_law.h>

/** strain : c : strain, Voigt. */
double ph_i_energy(const ph_sym4 *c, const double *strain);
/** Segment that holds d: knot[k] <= d < knot[k+1]; nknots - 1 at and beyond the last knot. */
int ph_i_damage_segment(int nknots, const double *knot, double damage);

/** Segments of a law as one integration point wants them. */
typedef struct ph_law_points ph_law_points;
ph_status ph_i_law_points_new(const ph_damage_law *law, ph_law_points **out,
                              ph_error *err);
void ph_i_law_points_free(ph_law_points **points);
/** One increment, see ph_point_update. @param[in,out] state [n + 1]: strain, d */
void ph_i_law_points_update(const ph_law_points *points, double *state,
                            const double *dstrain, double *stress, double *tangent);

#endif
