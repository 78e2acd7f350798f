/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PERIHOM_PRONY_H
#define PERIHOM_PRONY_H

#include <perihom/tensor.h>

#ifdef __cplusplus
extern "C" {
#endif

/** One exponential of a tensor series. */
typedef struct ph_prony_term {
    double time;       /* relaxation time [time, > 0, finite] */
    ph_sym4 stiffness; /* Mandel, symmetric positive semidefinite */
} ph_prony_term;

/** Relaxation tensor as a Prony series (generalised Maxwell chain)
 *
 *      C(t) = C_inf + sum_m C_m exp(-t / tau_m)
 *
 *  n = 6 for a phase, n = 3 or 6 for an effective tensor. Owns `term`.
 *  Every C_m and C_inf is symmetric positive semidefinite, which is what makes the material
 *  dissipate; single components of C_m may be negative (C12 may rise while C11 relaxes).
 *  Ref: [Christensen1982] ch. 1, 3. Tested: tests/unit/test_prony.c */
typedef struct ph_prony {
    ph_sym4 equilibrium; /* C_inf; may be zero or singular (a fluid) */
    int nterms;          /* >= 0 */
    ph_prony_term *term; /* [nterms], times strictly increasing */
} ph_prony;

/** A series from its terms, in any order; copies and sorts them.
 *  @return PH_OK; PH_EUNPHYSICAL as ph_prony_validate; PH_EINVAL; PH_ENOMEM */
PH_API ph_status ph_prony_new(const ph_sym4 *equilibrium, int nterms,
                              const ph_prony_term *term, ph_prony **out, ph_error *err);
/** A deep copy; of NULL it is NULL. */
PH_API ph_status ph_prony_copy(const ph_prony *p, ph_prony **out, ph_error *err);
PH_API void ph_prony_free(ph_prony **p);
/** Times positive, finite, strictly increasing; every tensor of one n, finite, symmetric
 *  and positive semidefinite (smallest eigenvalue >= -1e-9 largest: digits of a file).
 *  @return PH_OK; PH_EUNPHYSICAL with what is admissible; PH_EINVAL (n) */
PH_API ph_status ph_prony_validate(const ph_prony *p, ph_error *err);

/** C(t). @param t [time, >= 0; INFINITY: equilibrium] */
PH_API ph_sym4 ph_prony_at_time(const ph_prony *p, double t);
/** Carson transform C(s) = s L[C](s) = C_inf + sum_m C_m s tau_m / (1 + s tau_m), the
 *  stiffness of the elastic problem at s. No overflow for any s tau.
 *  @param s [1/time, >= 0; 0: equilibrium, INFINITY: instantaneous] */
PH_API ph_sym4 ph_prony_carson(const ph_prony *p, double s);
/** Complex modulus C*(w) = C(s = i w) = C' + i C'':
 *  C' = C_inf + sum C_m x^2/(1+x^2), C'' = sum C_m x/(1+x^2), x = w tau_m.
 *  @param omega angular frequency [rad/time, >= 0] */
PH_API void ph_prony_complex(const ph_prony *p, double omega, ph_sym4 *re, ph_sym4 *im);
/** C(0+) = C_inf + sum_m C_m. */
PH_API ph_sym4 ph_prony_instantaneous(const ph_prony *p);

/** Rotate every tensor, see ph_sym4_rotate. */
PH_API void ph_prony_rotate(ph_prony *p, const double *R);
/** Multiply every time by `factor` > 0 (time-temperature shift). Times that leave
 *  [1e-300, 1e300] are an error: PH_EUNPHYSICAL, and nothing is changed. */
PH_API ph_status ph_prony_scale_times(ph_prony *p, double factor, ph_error *err);

/** What a kinematic assumption leaves of a spatial series, see ph_sym4_reduce: itself, the
 *  in-plane blocks, or (plane stress) the exact series of the condensed tensor
 *  C_pp(s) - C_pd(s) C_dd(s)^-1 C_dp(s), which has times of its own where the phases' bulk
 *  and shear moduli do not relax alike. A copy where there is nothing to do.
 *  @return PH_OK; PH_ESINGULAR where the instantaneous tensor is singular; PH_ENOMEM.
 *  Cost: O((terms n)^3). Tested: tests/unit/test_prony_network.c */
PH_API ph_status ph_prony_reduce(const ph_prony *p, ph_kinematics kin, ph_prony **out,
                                 ph_error *err);

/** Creep compliance J(t) = J_0 + sum_m J_m (1 - exp(-t / tau_m)) + t Phi. Owns `term`. */
typedef struct ph_creep {
    ph_sym4 instantaneous; /* J_0 = C(0+)^-1, Mandel */
    int nterms;
    ph_prony_term *term; /* retardation times, increasing; compliances J_m >= 0 */
    ph_sym4 fluidity;    /* Phi >= 0: zero unless C_inf is singular */
} ph_creep;

/** The exact inverse J(s) C(s) = 1 of a series. Poles of the inverse are the eigenvalues of
 *  a matrix of internal variables, found by one-sided Jacobi to high relative accuracy, so
 *  that times may span 24 decades. Where an eigenvalue of C_inf is below 1e-13 of the
 *  instantaneous tensor it counts as zero: the material flows, with fluidity Phi.
 *  @return PH_OK; PH_ESINGULAR where the instantaneous tensor is singular; PH_ENOMEM.
 *  Cost: O((terms n)^3). Tested: tests/unit/test_prony_network.c */
PH_API ph_status ph_prony_creep(const ph_prony *p, ph_creep **out, ph_error *err);
PH_API void ph_creep_free(ph_creep **creep);
/** J(t). @param t [time, >= 0, finite] */
PH_API ph_sym4 ph_creep_at_time(const ph_creep *creep, double t);
/** J(s) = J_0 + sum_m J_m / (1 + s tau_m) + Phi / s = C(s)^-1. @param s [1/time, > 0] */
PH_API ph_sym4 ph_creep_carson(const ph_creep *creep, double s);

/** Prony series of one modulus: M(t) = infinity + sum_m modulus_m exp(-t / time_m). */
typedef struct ph_modulus_term {
    double time, modulus;
} ph_modulus_term;
typedef struct ph_modulus {
    double infinity; /* [stress, >= 0] */
    int nterms;
    const ph_modulus_term *term; /* borrowed; any order, times distinct */
} ph_modulus;

/** A number that relaxes, x(t) = infinity + sum modulus_m exp(-t / time_m); the coefficients
 *  of a modulus are >= 0, those of a Poisson ratio have any sign. Owns `term`. */
typedef struct ph_curve {
    double infinity;
    int nterms;
    ph_modulus_term *term;
} ph_curve;
PH_API void ph_curve_free(ph_curve *curve);
PH_API double ph_curve_at_time(const ph_curve *curve, double t);
/** x(i omega) = re + i im, see ph_prony_complex. */
PH_API void ph_curve_complex(const ph_curve *curve, double omega, double *re, double *im);

/** Relaxation under stress along one component only (the others' stresses zero), exactly:
 *  the modulus x(s) = 1/J_kk(s) or, with `lateral` = l, the ratio x(s) = -J_lk(s)/J_kk(s).
 *  E1(t): component 0; nu12(t): component 0, lateral 1; in Mandel notation, so that a
 *  shear modulus is half of that of its component.
 *  This is not the modulus of the tensor C(t): a step of strain leaves lateral strains that
 *  change in time.
 *  @param component 0-based; lateral < 0: the modulus
 *  @return PH_OK; PH_EINVAL; PH_ESINGULAR (no instantaneous compliance); PH_ENOMEM
 *  Tested: tests/unit/test_prony_network.c */
PH_API ph_status ph_prony_uniaxial(const ph_prony *p, int component, int lateral,
                                   ph_curve *out, ph_error *err);

#ifdef __cplusplus
}
#endif
#endif
