/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effective/composite.h"

#include <math.h>

ph_status ph_i_composite_check(const ph_composite *composite, const char *refusal,
                               ph_error *err)
{
    ph_status st = PH_OK;
    double sum = 0.0;
    PH_CHECK(composite->n >= 1, PH_EINVAL, "composite: no phases");
    for (int i = 0; i < composite->n; i++) {
        double f = composite->fraction[i];
        PH_CHECK(f >= 0.0 && f <= 1.0, PH_EINVAL,
                 "composite: fraction of '%s' must be in [0, 1], got %g",
                 composite->material[i].name, f);
        sum += f;
    }
    PH_CHECK(fabs(sum - 1.0) <= 1e-6, PH_EINVAL,
             "composite: fractions add up to %.9g, not 1", sum);
    PH_CHECK(refusal == NULL, PH_EINVAL, "%s", refusal);
out:
    return st;
}

ph_status ph_i_phase_stiffness(const ph_composite *composite, int i, ph_sym4 *c,
                               ph_error *err)
{
    return ph_sym4_reduce(&composite->material[i].stiffness, composite->kinematics, c,
                          err);
}

ph_sym4 ph_i_symmetric(const ph_sym4 *c)
{
    ph_sym4 s = {.n = c->n};
    for (int i = 0; i < c->n; i++)
        for (int j = 0; j < c->n; j++)
            s.m[i][j] = 0.5 * (c->m[i][j] + c->m[j][i]);
    return s;
}
