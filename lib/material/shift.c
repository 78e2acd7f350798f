/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/shift.h>

#include "core/check.h"

#include <math.h>

ph_status ph_shift_factor(const ph_shift *shift, double temperature, double kelvin,
                          double *factor, ph_error *err)
{
    PH_GIVEN(shift && factor);
    static const double gas_constant = 8.31446261815324; /* J/(mol K), exact since 2019 */
    ph_status st = PH_OK;
    double exponent = 0, dt = temperature - shift->reference;
    if (shift->kind == PH_SHIFT_WLF) {
        PH_CHECK(
            shift->c2 + dt > 0, PH_EUNPHYSICAL,
            "at %g WLF has no meaning: the temperature must be > reference - C2 = %g",
            temperature, shift->reference - shift->c2);
        exponent = -shift->c1 * dt / (shift->c2 + dt) * log(10);
    } else if (shift->kind == PH_SHIFT_ARRHENIUS) {
        double T = temperature + kelvin, T0 = shift->reference + kelvin;
        PH_CHECK(T > 0 && T0 > 0, PH_EUNPHYSICAL,
                 "absolute temperatures must be > 0, got %g and %g", T, T0);
        exponent = -shift->activation_energy / gas_constant * dt / (T * T0);
    }
    double a = exp(exponent);
    PH_CHECK(a >= 1e-60 && a <= 1e60, PH_EUNPHYSICAL,
             "at %g the times are multiplied by exp(%g): must be 1e-60 to 1e60",
             temperature, exponent);
    *factor = a;
out:
    return st;
}
