/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PERIHOM_SHIFT_H
#define PERIHOM_SHIFT_H

#include <perihom/error.h>

#ifdef __cplusplus
extern "C" {
#endif

/** How the times of a phase depend on temperature: they are multiplied by a_T. */
typedef enum ph_shift_kind {
    PH_SHIFT_NONE,
    PH_SHIFT_WLF,      /* log10 a_T = -C1 (T - T_ref) / (C2 + T - T_ref) */
    PH_SHIFT_ARRHENIUS /* ln a_T = E_a / R (1/T - 1/T_ref), T absolute */
} ph_shift_kind;
typedef struct ph_shift {
    ph_shift_kind kind;
    double c1, c2;            /* WLF: -, degrees */
    double activation_energy; /* Arrhenius: J/mol */
    double reference;         /* temperature of the case's unit at which a_T = 1 */
} ph_shift;
/** a_T. @param[in] kelvin what added to a temperature makes it absolute, 0 or 273.15
 *  @return PH_OK; PH_EUNPHYSICAL where a_T is not between 1e-60 and 1e60 or T is at or below
 *  T_ref - C2 or absolute zero. Ref: [Williams1955]. Tested: tests/io/test_case_relaxation.c */
PH_API ph_status ph_shift_factor(const ph_shift *shift, double temperature, double kelvin,
                                 double *factor, ph_error *err);

#ifdef __cplusplus
}
#endif
#endif
