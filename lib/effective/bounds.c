/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effective/composite.h"

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
