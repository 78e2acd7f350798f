/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What damage did to an RVE, as a law for one integration point. */
#ifndef PERIHOM_DAMAGE_LAW_H
#define PERIHOM_DAMAGE_LAW_H

#include <perihom/homogenise.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Stiffness against one damage variable d, and what drives d.
 *
 *      sigma = C(d) eps,  C(d) linear between the knots:  C_k - s A_k,  A_k = C_k - C_k+1 >= 0
 *
 *  so that C is positive semidefinite and -eps : dC/dd : eps >= 0 for every d and every strain.
 *  With E the direction of the loading that was recorded, in segment k
 *
 *      kappa^2 = (eps : A_k : eps - r) / (E : A_k : E),   c = (E : A_k : eps) / (E : A_k : E)
 *      r = 0 for c >= 0, else c^2 E : A_k : E
 *
 *  is the energy that an increment of damage releases, over that of the strain E: the load
 *  factor of the recorded path for eps = kappa E. The part of eps against E releases nothing
 *  that drives, as bonds break in tension. Damage grows, and never heals, as kappa goes beyond
 *
 *      begin_k + s (end_k - begin_k),   s the part of the segment that is done.
 *
 *  Beyond the last knot nothing is known and d stays. Owns its arrays.
 *  Ref: [Simo1987] (energy release rate as the driving force, irreversible by its maximum). */
typedef struct ph_damage_law {
    int n;              /* strain components, 3 or 6 */
    double strain[6];   /* E, Voigt, engineering shear; zero where nothing drives */
    bool driven;        /* else a table of C(d) alone: damage was prescribed */
    int nknots;         /* >= 1 */
    double *damage;     /* [nknots] d, 0 first, rising */
    ph_sym4 *stiffness; /* [nknots] Mandel, falling in the sense of their energy */
    double *begin,
        *end; /* [nknots - 1] load factors of a segment; 0 where nothing drives */
    /* largest change that made the stiffnesses fall and semidefinite, over the first one's
     * norm; 0: none. A model whose rest stiffens as bonds break (nosb) may need one. */
    double correction;
} ph_damage_law;

PH_API void ph_damage_law_free(ph_damage_law **law);

/** A law from its parts, which it copies.
 *  @param[in] strain [n] direction E, Voigt; NULL: nothing drives, then begin = end = NULL
 *  @param[in] damage, stiffness [nknots]; begin, end [nknots - 1]
 *  @return PH_OK; PH_EINVAL: d does not rise from 0, a stiffness rises or is not
 *          semidefinite (beyond 1e-9 of the first), loads do not rise from >= 0, a segment
 *          releases nothing along E; PH_ENOMEM */
PH_API ph_status ph_damage_law_new(int n, const double *strain, int nknots,
                                   const double *damage, const ph_sym4 *stiffness,
                                   const double *begin, const double *end,
                                   ph_damage_law **out, ph_error *err);
PH_API ph_status ph_damage_law_copy(const ph_damage_law *law, ph_damage_law **out,
                                    ph_error *err);

/** The law of a result with damage.
 *
 *  Of a loading: knots are the steps whose full stiffness is known and in which bonds broke
 *  (stiffness_every: 1 for all), d = 1 - E : C : E over that of the first, a segment begins
 *  at the load of the first event in the step and ends at the load of the step. The law then
 *  gives the recorded stress at every such step.
 *  Of prescribed cracks: knots are the steps, d = 1 - trace C / trace C_0, nothing drives.
 *  @return PH_OK; PH_EINVAL: no damage, columns are missing, bonds broke under loads that
 *          did not rise (no law of one monotone path), the stiffness without damage is not
 *          positive definite; PH_ENOMEM. Tested: tests/laws/test_damage_law.c */
PH_API ph_status ph_damage_law_from_result(const ph_result *result, ph_damage_law **out,
                                           ph_error *err);

/** The law of prescribed cracks in a brittle material [Griffith1921]: cracks go from one step
 *  to the next when that releases the fracture energy of the surface they make,
 *
 *      1/2 lambda^2 E : A_k : E = G (surface_k+1 - surface_k)
 *
 *  A segment begins at this load and ends at that of the next segment; where the load would
 *  fall (cracks that run on) it stays, and the stress drops through the segment.
 *  @param[in] result  of a sequence, all loads
 *  @param[in] strain  [n] direction E, Voigt
 *  @param[in] fracture_energy G > 0, stress times length
 *  @return as ph_damage_law_from_result; PH_EINVAL: no sequence, a step without new surface
 *          that changes C. Tested: tests/laws/test_damage_law.c (a row of cracks, exactly) */
PH_API ph_status ph_damage_law_from_growth(const ph_result *result, const double *strain,
                                           double fracture_energy, ph_damage_law **out,
                                           ph_error *err);

/** C(d), Mandel; d is taken into the range of the knots. n = 0 for NaN. */
PH_API ph_sym4 ph_damage_law_stiffness(const ph_damage_law *law, double damage);
/** Thermodynamic force Y = -1/2 eps : dC/dd : eps >= 0 of the segment that begins at or holds
 *  d. @param[in] strain [n] Voigt. 0 at the last knot; NaN without a law */
PH_API double ph_damage_law_force(const ph_damage_law *law, double damage,
                                  const double *strain);

#ifdef __cplusplus
}
#endif
#endif
