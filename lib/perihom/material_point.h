/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The effective material at one integration point of a macroscale code. */
#ifndef PERIHOM_MATERIAL_POINT_H
#define PERIHOM_MATERIAL_POINT_H

#include <perihom/effective.h>

#ifdef __cplusplus
extern "C" {
#endif

/** An effective material made ready for many calls. Never changes after it is made, so any
 *  number of threads may use one. */
typedef struct ph_point_material ph_point_material;

/** Elastic; viscoelastic where the effective material has a relaxation series:
 *
 *      sigma(t) = C_inf eps(t) + sum_m h_m(t),   h_m' = C_m eps' - h_m / tau_m
 *
 *  or failing where it has a damage law that a load drives: sigma = C(d) eps, damage_law.h.
 *  @return PH_OK; PH_EINVAL (no stiffness; both a series and a damage law); PH_ENOMEM.
 *  Copies what it needs. */
PH_API ph_status ph_point_material_new(const ph_effective *effective,
                                       ph_point_material **out, ph_error *err);
PH_API void ph_point_material_free(ph_point_material **material);
/** Components of strain and stress: 6 (Voigt 11 22 33 23 13 12), or 3 (11 22 12). */
PH_API int ph_point_components(const ph_point_material *material);
/** Doubles of state that one point needs: the elastic stress and one stress per term,
 *  n (1 + terms); with a damage law the strain and d, n + 1. The caller keeps them; all zero
 *  is the virgin state. Saving them is a restart: what follows has the same bits. */
PH_API size_t ph_point_state_size(const ph_point_material *material);
/** Tangents that ph_points_update writes for so many points: 1, or as many as there are
 *  points where a damage law makes them differ. */
PH_API ptrdiff_t ph_point_tangents(const ph_point_material *material, ptrdiff_t points);

/** One increment. The strain grows linearly over dt, which the recursion integrates exactly
 *  (a jump: dt = 0), whatever dt is of the relaxation times:
 *
 *      h_m <- exp(-x) h_m + C_m deps (1 - exp(-x)) / x,   x = dt / tau_m
 *
 *  With a damage law dt does nothing: d goes as far as the strain at the end drives it, the
 *  same in one increment or many of one direction.
 *
 *  @param[in,out] state   [ph_point_state_size] of this point
 *  @param[in]  dstrain    [n] strain increment, Voigt, engineering shear
 *  @param[in]  dt         [time, >= 0, finite]
 *  @param[out] stress     [n] at the end of the increment, Voigt
 *  @param[out] tangent    [n * n] d stress / d dstrain, row-major, symmetric; NULL: not wanted.
 *                         It depends on dt alone, so one call serves all points of a step;
 *                         with a damage law on the point, and it is not symmetric where
 *                         damage grows under a strain that is partly against the recorded one.
 *  @return PH_OK; PH_EINVAL (dt or dstrain not finite, dt < 0): state and stress untouched.
 *  Cost: O(n^2 terms), no allocation, no lock. No solve of the RVE.
 *  Ref: [Taylor1970], [Simo1998] ch. 10. Tested: tests/laws/test_material_point.c,
 *  tests/laws/test_damage_law.c */
PH_API ph_status ph_point_update(const ph_point_material *material, double *state,
                                 const double *dstrain, double dt, double *stress,
                                 double *tangent);

/** The same increment at many points of one material, with the bits of as many calls of
 *  ph_point_update; the exponentials are computed once.
 *  @param[in] points >= 0
 *  @param[in,out] state [points][ph_point_state_size]
 *  @param[in]  dstrain [points][n]
 *  @param[out] stress  [points][n]; does not overlap dstrain
 *  @param[out] tangent [ph_point_tangents][n * n]; or NULL
 *  @return as ph_point_update; one increment that is not finite and no point is touched */
PH_API ph_status ph_points_update(const ph_point_material *material, ptrdiff_t points,
                                  double *state, const double *dstrain, double dt,
                                  double *stress, double *tangent);

#ifdef __cplusplus
}
#endif
#endif
