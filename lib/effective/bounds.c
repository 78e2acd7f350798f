/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effective/composite.h"

#include <math.h>

const char *ph_i_voigt_refuses(const ph_composite *composite)
{
    (void)composite;
    return NULL;
}

ph_status ph_i_voigt(const ph_composite *composite, ph_sym4 *out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_sym4 c, mean = {.n = ph_strains(composite->kinematics)};
    PH_TRY(ph_i_composite_check(composite, ph_i_voigt_refuses(composite), err));
    for (int i = 0; i < composite->n; i++) {
        PH_TRY(ph_i_phase_stiffness(composite, i, &c, err));
        mean = ph_sym4_combine(1.0, &mean, composite->fraction[i], &c);
    }
    *out = mean;
out:
    return st;
}

const char *ph_i_reuss_refuses(const ph_composite *composite)
{
    (void)composite;
    return NULL;
}

/* With any void the lower bound is zero. */
ph_status ph_i_reuss(const ph_composite *composite, ph_sym4 *out, ph_error *err)
{
    ph_status st = PH_OK;
    const int n = ph_strains(composite->kinematics);
    ph_sym4 s, mean = {.n = n};
    PH_TRY(ph_i_composite_check(composite, ph_i_reuss_refuses(composite), err));
    for (int i = 0; i < composite->n; i++) {
        if (composite->fraction[i] == 0.0) continue;
        if (composite->material[i].is_void) {
            *out = (ph_sym4){.n = n};
            goto out;
        }
        PH_TRY(ph_i_phase_stiffness(composite, i, &s, err));
        PH_TRY(ph_sym4_inverse(&s, &s, err));
        mean = ph_sym4_combine(1.0, &mean, composite->fraction[i], &s);
    }
    PH_TRY(ph_sym4_inverse(&mean, out, err));
out:
    return st;
}

/* Is a - b positive semidefinite, to round-off? */
static bool stiffer(const ph_sym4 *a, const ph_sym4 *b)
{
    double lowest;
    ph_sym4 d = ph_sym4_combine(1.0, a, -1.0, b);
    ph_sym4_eigenvalues(&d, &lowest, NULL);
    return lowest >= -1e-12 * (ph_sym4_norm(a) + ph_sym4_norm(b));
}

/* Is phase r the softest (sign = 1) or stiffest (sign = -1) of all in every direction? */
static bool extreme(const ph_composite *composite, int r, int sign)
{
    ph_sym4 a, b;
    if (ph_i_phase_stiffness(composite, r, &b, NULL) != PH_OK) return false;
    for (int i = 0; i < composite->n; i++) {
        if (composite->fraction[i] == 0.0) continue;
        if (ph_i_phase_stiffness(composite, i, &a, NULL) != PH_OK) return false;
        if (sign > 0 ? !stiffer(&a, &b) : !stiffer(&b, &a)) return false;
    }
    return true;
}

static int extreme_phase(const ph_composite *composite, int sign)
{
    for (int r = 0; r < composite->n; r++)
        if (composite->fraction[r] > 0.0 && extreme(composite, r, sign)) return r;
    return -1;
}

static ph_status hashin_shtrikman(const ph_composite *composite, int sign,
                                  const char *refusal, ph_sym4 *out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_sym4 c0;
    PH_TRY(ph_i_composite_check(composite, refusal, err));
    PH_TRY(ph_i_phase_stiffness(composite, extreme_phase(composite, sign), &c0, err));
    if (ph_sym4_norm(&c0) == 0.0)
        *out = c0;
    else
        PH_TRY(ph_i_mix(composite, &c0, out, err));
out:
    return st;
}

const char *ph_i_hashin_shtrikman_lower_refuses(const ph_composite *composite)
{
    const char *shape = ph_i_shape_refusal(composite);
    if (shape) return shape;
    return extreme_phase(composite, 1) >= 0
               ? NULL
               : "no phase is the softest in every direction: see walpole_lower";
}

ph_status ph_i_hashin_shtrikman_lower(const ph_composite *composite, ph_sym4 *out,
                                      ph_error *err)
{
    return hashin_shtrikman(composite, 1, ph_i_hashin_shtrikman_lower_refuses(composite),
                            out, err);
}

const char *ph_i_hashin_shtrikman_upper_refuses(const ph_composite *composite)
{
    const char *shape = ph_i_shape_refusal(composite);
    if (shape) return shape;
    return extreme_phase(composite, -1) >= 0
               ? NULL
               : "no phase is the stiffest in every direction: see walpole_upper";
}

ph_status ph_i_hashin_shtrikman_upper(const ph_composite *composite, ph_sym4 *out,
                                      ph_error *err)
{
    return hashin_shtrikman(composite, -1, ph_i_hashin_shtrikman_upper_refuses(composite),
                            out, err);
}

const char *ph_i_walpole_lower_refuses(const ph_composite *composite)
{
    const char *shape = ph_i_shape_refusal(composite);
    if (shape) return shape;
    return ph_i_all_isotropic(composite) ? NULL : "phases must be isotropic";
}

const char *ph_i_walpole_upper_refuses(const ph_composite *composite)
{
    return ph_i_walpole_lower_refuses(composite);
}

/* The medium with the extreme bulk and shear moduli that any of the phases has. */
static ph_status walpole_medium(const ph_composite *composite, int sign, ph_sym4 *c0,
                                ph_error *err)
{
    ph_status st = PH_OK;
    double K = sign > 0 ? HUGE_VAL : 0.0, G = K;
    for (int i = 0; i < composite->n; i++) {
        if (composite->fraction[i] == 0.0) continue;
        PH_TRY(ph_i_phase_stiffness(composite, i, c0, err));
        ph_isotropic iso = ph_nearest_isotropic(c0, composite->kinematics);
        K = sign > 0 ? fmin(K, iso.K) : fmax(K, iso.K);
        G = sign > 0 ? fmin(G, iso.G) : fmax(G, iso.G);
    }
    if (ph_strains(composite->kinematics) == 6)
        *c0 = ph_sym4_isotropic_kg(K, G);
    else
        *c0 = (ph_sym4){3, {{K + G, K - G}, {K - G, K + G}, {0, 0, 2 * G}}};
out:
    return st;
}

static ph_status walpole(const ph_composite *composite, int sign, ph_sym4 *out,
                         ph_error *err)
{
    ph_status st = PH_OK;
    ph_sym4 c0;
    PH_TRY(ph_i_composite_check(composite, ph_i_walpole_lower_refuses(composite), err));
    PH_TRY(walpole_medium(composite, sign, &c0, err));
    if (ph_sym4_norm(&c0) == 0.0)
        *out = c0;
    else
        PH_TRY(ph_i_mix(composite, &c0, out, err));
out:
    return st;
}

ph_status ph_i_walpole_lower(const ph_composite *composite, ph_sym4 *out, ph_error *err)
{
    return walpole(composite, 1, out, err);
}

ph_status ph_i_walpole_upper(const ph_composite *composite, ph_sym4 *out, ph_error *err)
{
    return walpole(composite, -1, out, err);
}
