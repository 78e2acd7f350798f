/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/material.h>

#include "core/check.h"

#include <math.h>

static ph_material unnamed(const char *name)
{
    ph_material m = {.E = NAN, .nu = NAN, .density = NAN, .stiffness = {.n = 6}};
    snprintf(m.name, sizeof m.name, "%s", name ? name : "");
    return m;
}

ph_status ph_material_isotropic(const char *name, double E, double nu, ph_material *out,
                                ph_error *err)
{
    PH_GIVEN(name && out);
    ph_status st = PH_OK;
    ph_material m = unnamed(name);
    PH_CHECK(E > 0.0 && isfinite(E), PH_EUNPHYSICAL,
             "material '%s': Young's modulus E must be positive, got %g", m.name, E);
    PH_CHECK(nu > -1.0 && nu < 0.5, PH_EUNPHYSICAL,
             "material '%s': Poisson ratio nu must be in (-1, 0.5), got %g", m.name, nu);
    m.is_isotropic = true;
    m.E = E;
    m.nu = nu;
    m.stiffness = ph_sym4_isotropic(E, nu);
    *out = m;
out:
    return st;
}

ph_status ph_material_anisotropic(const char *name, const double voigt[36],
                                  const double *R, ph_material *out, ph_error *err)
{
    PH_GIVEN(name && voigt && out);
    ph_status st = PH_OK;
    ph_material m = unnamed(name);
    double largest = 0.0, lo, hi;
    for (int i = 0; i < 36; i++) {
        PH_CHECK(isfinite(voigt[i]), PH_EUNPHYSICAL,
                 "material '%s': stiffness C%d%d is not a number", m.name, i / 6 + 1,
                 i % 6 + 1);
        largest = fmax(largest, fabs(voigt[i]));
    }
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < i; j++)
            PH_CHECK(
                fabs(voigt[6 * i + j] - voigt[6 * j + i]) <= 1e-6 * largest,
                PH_EUNPHYSICAL,
                "material '%s': stiffness must be symmetric, got C%d%d = %g and C%d%d "
                "= %g",
                m.name, j + 1, i + 1, voigt[6 * j + i], i + 1, j + 1, voigt[6 * i + j]);
    m.stiffness = ph_sym4_from_voigt(6, voigt, true);
    ph_sym4_eigenvalues(&m.stiffness, &lo, &hi);
    PH_CHECK(ph_sym4_is_stiffness(&m.stiffness), PH_EUNPHYSICAL,
             "material '%s': stiffness must be positive definite, its eigenvalues are %g "
             "to %g (Mandel)",
             m.name, lo, hi);
    if (R) m.stiffness = ph_sym4_rotate(&m.stiffness, R);
    *out = m;
out:
    return st;
}

ph_material ph_material_void(const char *name)
{
    ph_material m = unnamed(name);
    m.is_void = true;
    return m;
}
