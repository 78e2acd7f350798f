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

static void swap_rows(double *x, double *y)
{
    for (int j = 0; j < 6; j++) {
        double t = x[j];
        x[j] = y[j];
        y[j] = t;
    }
}

/* Gauss-Jordan with row pivoting. */
ph_status ph_i_inverse_general(const ph_sym4 *a, ph_sym4 *inv, ph_error *err)
{
    ph_status st = PH_OK;
    const int n = a->n;
    ph_sym4 w = *a, r = {.n = n};
    double norm = ph_sym4_norm(a);
    for (int i = 0; i < n; i++)
        r.m[i][i] = 1.0;
    for (int k = 0; k < n; k++) {
        int p = k;
        for (int i = k + 1; i < n; i++)
            if (fabs(w.m[i][k]) > fabs(w.m[p][k])) p = i;
        PH_CHECK(fabs(w.m[p][k]) > 1e-14 * norm, PH_ESINGULAR,
                 "strain concentration is singular");
        swap_rows(w.m[k], w.m[p]);
        swap_rows(r.m[k], r.m[p]);
        double pivot = 1.0 / w.m[k][k];
        for (int j = 0; j < n; j++)
            w.m[k][j] *= pivot, r.m[k][j] *= pivot;
        for (int i = 0; i < n; i++) {
            double x = w.m[i][k];
            if (i == k || x == 0.0) continue;
            for (int j = 0; j < n; j++) {
                w.m[i][j] -= x * w.m[k][j];
                r.m[i][j] -= x * r.m[k][j];
            }
        }
    }
    *inv = r;
out:
    return st;
}

ph_status ph_i_concentration(const ph_sym4 *p, const ph_sym4 *c0, const ph_sym4 *c1,
                             ph_sym4 *a, ph_error *err)
{
    ph_sym4 d = ph_sym4_combine(1.0, c1, -1.0, c0), x = ph_sym4_product(p, &d);
    for (int i = 0; i < x.n; i++)
        x.m[i][i] += 1.0;
    return ph_i_inverse_general(&x, a, err);
}

ph_status ph_i_polarise(const ph_composite *composite, const ph_sym4 *c0,
                        ph_sym4 *polarisation, ph_sym4 *mean, ph_error *err)
{
    ph_status st = PH_OK;
    ph_sym4 p, c, a, t = {.n = c0->n}, m = {.n = c0->n};
    PH_TRY(ph_hill_tensor(c0, composite->shape, composite->aspect, &p, err));
    for (int i = 0; i < composite->n; i++) {
        const double f = composite->fraction[i];
        if (f == 0.0) continue;
        PH_TRY(ph_i_phase_stiffness(composite, i, &c, err));
        PH_TRY(ph_i_concentration(&p, c0, &c, &a, err));
        m = ph_sym4_combine(1.0, &m, f, &a);
        c = ph_sym4_combine(1.0, &c, -1.0, c0);
        c = ph_sym4_product(&c, &a);
        t = ph_sym4_combine(1.0, &t, f, &c);
    }
    *polarisation = t;
    if (mean) *mean = m;
out:
    return st;
}

ph_status ph_i_mix(const ph_composite *composite, const ph_sym4 *c0, ph_sym4 *out,
                   ph_error *err)
{
    ph_status st = PH_OK;
    ph_sym4 t, m;
    PH_TRY(ph_i_polarise(composite, c0, &t, &m, err));
    PH_TRY(ph_i_inverse_general(&m, &m, err));
    t = ph_sym4_product(&t, &m);
    t = ph_sym4_combine(1.0, c0, 1.0, &t);
    *out = ph_i_symmetric(&t);
out:
    return st;
}

bool ph_i_has_void(const ph_composite *composite)
{
    for (int i = 0; i < composite->n; i++)
        if (composite->material[i].is_void && composite->fraction[i] > 0.0) return true;
    return false;
}

bool ph_i_all_isotropic(const ph_composite *composite)
{
    for (int i = 0; i < composite->n; i++)
        if (ph_nearest_isotropic(&composite->material[i].stiffness, PH_SPACE).distance >
            1e-9)
            return false;
    return true;
}

const char *ph_i_shape_refusal(const ph_composite *composite)
{
    const ph_inclusion_shape shape = composite->shape;
    const double aspect = composite->aspect;
    const bool round = shape == PH_SHAPE_SPHERE || shape == PH_SHAPE_SPHEROID;
    if (round && composite->kinematics != PH_SPACE)
        return "fields do not vary along axis 3: an inclusion is a cylinder or a layer";
    if (shape == PH_SHAPE_SPHEROID && !(aspect >= 1e-6 && aspect <= 1e6))
        return "the aspect ratio of a spheroid must be in [1e-6, 1e6]";
    if (shape == PH_SHAPE_LAMINATE && ph_i_has_void(composite))
        return "an empty layer leaves nothing that holds the others together";
    return NULL;
}

const char *ph_i_matrix_refusal(const ph_composite *composite)
{
    const char *shape = ph_i_shape_refusal(composite);
    if (shape) return shape;
    if (composite->n < 1) return "there are no phases";
    if (composite->material[0].is_void) return "the matrix is a void";
    return NULL;
}
