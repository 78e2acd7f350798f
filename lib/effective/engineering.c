/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/tensor.h>

#include "core/check.h"

#include <math.h>

static ph_engineering no_constants(void)
{
    ph_engineering e = {.G23 = NAN, .G13 = NAN, .G12 = NAN};
    for (int i = 0; i < 3; i++) {
        e.E[i] = NAN;
        for (int j = 0; j < 3; j++)
            e.nu[i][j] = NAN;
    }
    return e;
}

ph_status ph_engineering_constants(const ph_sym4 *c, ph_engineering *out, ph_error *err)
{
    PH_GIVEN(c && out);
    ph_status st = PH_OK;
    const int axes = c->n == 3 ? 2 : 3;
    ph_sym4 s;
    PH_CHECK(c->n == 3 || c->n == 6, PH_EINVAL, "the tensor has n = %d, not 3 or 6",
             c->n);
    *out = no_constants();
    PH_TRY(ph_sym4_inverse(c, &s, err));
    for (int i = 0; i < axes; i++) {
        out->E[i] = 1.0 / s.m[i][i];
        for (int j = 0; j < axes; j++)
            if (i != j) out->nu[i][j] = -s.m[i][j] / s.m[i][i];
    }
    /* A Mandel shear compliance is half the engineering one. */
    out->G12 = 0.5 / s.m[c->n - 1][c->n - 1];
    if (axes == 3) {
        out->G23 = 0.5 / s.m[3][3];
        out->G13 = 0.5 / s.m[4][4];
    }
out:
    return st;
}

/* Isotropic tensor d K J + 2 G (I - J) of d axes, J = 1 (x) 1 / d. */
static ph_sym4 isotropic(int n, int d, double K, double G)
{
    ph_sym4 c = {.n = n};
    for (int a = 0; a < d; a++)
        for (int b = 0; b < d; b++)
            c.m[a][b] = K - 2.0 * G / d;
    for (int a = 0; a < n; a++)
        c.m[a][a] += 2.0 * G;
    return c;
}

ph_isotropic ph_nearest_isotropic(const ph_sym4 *c, ph_kinematics kin)
{
    if (!c) return (ph_isotropic){NAN, NAN, NAN, NAN, NAN};
    (void)kin; /* both plane kinematics share the 2D constants; the tensor says which d */
    ph_isotropic r;
    const int n = c->n, d = n == 3 ? 2 : 3;
    double block = 0.0, trace = 0.0;
    for (int a = 0; a < n; a++) {
        trace += c->m[a][a];
        if (a < d)
            for (int b = 0; b < d; b++)
                block += c->m[a][b];
    }
    /* C::J = d K and C::(I - J) = (n - 1) 2 G: the projections are orthogonal. */
    r.K = block / (d * d);
    r.G = (trace - d * r.K) / (2.0 * (n - 1));
    if (d == 2) {
        r.E = 4.0 * r.K * r.G / (r.K + r.G);
        r.nu = (r.K - r.G) / (r.K + r.G);
    } else {
        r.E = 9.0 * r.K * r.G / (3.0 * r.K + r.G);
        r.nu = (3.0 * r.K - 2.0 * r.G) / (2.0 * (3.0 * r.K + r.G));
    }
    ph_sym4 iso = isotropic(n, d, r.K, r.G), rest = ph_sym4_combine(1.0, c, -1.0, &iso);
    double norm = ph_sym4_norm(c);
    r.distance = norm > 0.0 ? ph_sym4_norm(&rest) / norm : 0.0;
    return r;
}
