/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prony series from measurements. Method, criterion and limits: docs/theory/fit.md. */
#ifndef PERIHOM_FIT_H
#define PERIHOM_FIT_H

#include <perihom/prony.h>
#include <perihom/shift.h>

#ifdef __cplusplus
extern "C" {
#endif

/** What was measured. */
typedef enum ph_prony_kind {
    PH_PRONY_RELAXATION, /* M(t) after a step of strain */
    PH_PRONY_CREEP,      /* J(t) after a step of stress */
    PH_PRONY_DYNAMIC     /* M'(w) and M''(w) */
} ph_prony_kind;

/** Measurements of one modulus at one temperature, in any order; borrowed. */
typedef struct ph_prony_data {
    ph_prony_kind kind;
    ptrdiff_t n;
    const double *x;     /* [n] time, or angular frequency (rad/time); > 0 */
    const double *value; /* [n] modulus, compliance or storage modulus; > 0 */
    const double *loss;  /* [n] loss modulus, >= 0; NULL but for PH_PRONY_DYNAMIC */
    const double *value_sd, *loss_sd; /* [n] standard deviations > 0, or NULL */
} ph_prony_data;

typedef enum ph_prony_rest {
    PH_PRONY_AUTOMATIC, /* an equilibrium modulus if the data need one */
    PH_PRONY_SOLID,     /* an equilibrium modulus (which may come out as zero) */
    PH_PRONY_FLUID      /* none */
} ph_prony_rest;

enum { PH_PRONY_FIT_TERMS = 40 }; /* most terms of a series whose times are sought */

/** How to fit; zero is automatic for every member. */
typedef struct ph_prony_fit_params {
    int terms;         /* so many, 1 .. PH_PRONY_FIT_TERMS; 0: chosen by the criterion */
    double per_decade; /* > 0: times on the grid 10^(k/per_decade) instead of sought */
    int ntimes;        /* > 0: these times */
    const double *times; /* [ntimes], > 0, distinct, any order */
    ph_prony_rest rest;
    bool absolute; /* without standard deviations: equal weights, not relative ones */
} ph_prony_fit_params;

/** One number of terms that was tried. */
typedef struct ph_prony_fit_step {
    int terms;
    double misfit;    /* root mean square of the weighted residuals */
    double criterion; /* BIC */
} ph_prony_fit_step;

typedef struct ph_prony_fit {
    ph_prony_kind kind;
    ph_modulus modulus; /* the series; term is owned, times increasing, moduli > 0 */
    /* Creep only: J(t) = instantaneous + sum compliance (1 - exp(-t/time)) + t fluidity. */
    double instantaneous, fluidity;
    int nretardations;
    ph_modulus_term *retardation; /* [nretardations], `modulus` is the compliance */
    ptrdiff_t n;
    double *value,
        *loss; /* [n] of the fit where the data are; loss NULL if not dynamic */
    ptrdiff_t nresiduals; /* n, or 2 n */
    double misfit;        /* root mean square of the weighted residuals */
    double worst;         /* largest weighted residual */
    int nsteps;           /* numbers of terms that were tried; 0 with given times */
    ph_prony_fit_step *step;
    int chosen; /* index into step */
} ph_prony_fit;

/** Fit a Prony series with non-negative moduli.
 *
 *  Minimises the sum of ((model - measured) / s)^2, s the standard deviation if given, else
 *  the measured value (relative residuals) or, with `absolute`, the largest measured value.
 *  Moduli: non-negative least squares [Lawson1974]. Times: given; or on a grid; or sought:
 *  one more term is placed where it lowers the sum the most, then all times move (conditional
 *  gradient with alternating descent [Boyd2017]; separable least squares [Golub1973]). The
 *  number of terms is the one with the smallest
 *      BIC = m ln(sum/m) + p ln m      (sum + p ln m with standard deviations),
 *  m residuals, p = 2 terms + moduli or compliances without time that are not zero
 *  [Schwarz1978]. Creep is fitted as a series of retardations and inverted exactly.
 *  @return PH_OK; PH_EINVAL (fewer than 3 points, wrong parameters, not finite); PH_EUNPHYSICAL
 *          (values not positive); PH_ESINGULAR (creep data without instantaneous compliance:
 *          the modulus would begin at infinity); PH_ENOMEM. `out` untouched on failure.
 *  Cost: O(m terms^2) a step of the times. Tested: tests/cross/test_fit.c */
PH_API ph_status ph_prony_fit_new(const ph_prony_data *data,
                                  const ph_prony_fit_params *params, ph_prony_fit **out,
                                  ph_error *err);
PH_API void ph_prony_fit_free(ph_prony_fit **fit);

/** M(t), J(t) or M'(w) of the fit, and M''(w) in *loss where dynamic (may be NULL). */
PH_API double ph_prony_fit_at(const ph_prony_fit *fit, double x, double *loss);

/** The series of moduli of a creep compliance
 *      J(s) = instantaneous + sum J_k / (1 + s t_k) + fluidity / s,   M(s) = 1 / J(s)
 *  (Carson transforms): its times are minus the inverse zeros of J(s), which lie between
 *  its poles, found by bisection relative to the nearer pole.
 *  @param[in]  n, retardation  [n], times distinct, any order; compliances (in `modulus`) >= 0
 *  @param[out] term [n + 1] times increasing; *nterms of them
 *  @return PH_OK; PH_EUNPHYSICAL; PH_ESINGULAR where instantaneous is 0; PH_ENOMEM.
 *  Ref: [Tschoegl1989]. Tested: tests/cross/test_fit.c */
PH_API ph_status ph_modulus_of_creep(double instantaneous, int n,
                                     const ph_modulus_term *retardation, double fluidity,
                                     double *infinity, int *nterms, ph_modulus_term *term,
                                     ph_error *err);

/* ---- several temperatures */

/** Shift factors of data at several temperatures by overlap: of neighbouring temperatures
 *  the factor that lets log(value) over log(x) coincide best where they overlap (mean square
 *  of the difference to the straight lines between the other's points; loss likewise).
 *  @param[in]  temperature [n] of each point; points of equal temperature form a curve
 *  @param[in]  reference   one of the temperatures
 *  @param[out] factor      [n] a_T of each point: times at the reference are x / a_T,
 *                          frequencies x a_T
 *  @param[out] gap         root mean square of the differences of ln(value) left, or NULL
 *  @return PH_OK; PH_EINVAL (reference not there, a curve of fewer than 3 points, no overlap
 *          of neighbours however they are shifted); PH_ENOMEM.
 *  Tested: tests/cross/test_fit_shift.c */
PH_API ph_status ph_shift_overlap(const ph_prony_data *data, const double *temperature,
                                  double reference, double *factor, double *gap,
                                  ph_error *err);

/** The WLF or Arrhenius law nearest to shift factors: least squares of ln a_T.
 *  @param[in]  n temperatures besides the reference: at least 2 (WLF), 1 (Arrhenius)
 *  @param[in]  kelvin what makes a temperature absolute, 0 or 273.15
 *  @param[out] misfit root mean square of the differences of ln a_T
 *  @return PH_OK; PH_EINVAL; PH_EUNPHYSICAL where the factors do not fall with temperature
 *  Ref: [Williams1955]. Tested: tests/cross/test_fit_shift.c */
PH_API ph_status ph_shift_fit(ph_shift_kind kind, int n, const double *temperature,
                              const double *factor, double reference, double kelvin,
                              ph_shift *out, double *misfit, ph_error *err);

#ifdef __cplusplus
}
#endif
#endif
