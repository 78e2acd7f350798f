/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/material_point.h>

#include "core/check.h"
#include "effective/damage_law.h"

#include <math.h>
#include <string.h>

struct ph_point_material {
    int n, terms;
    double elastic[36]; /* C_inf, Voigt: stress of engineering strain */
    double *time;       /* [terms] */
    double *c;          /* [terms][n * n] C_m, Voigt */
    ph_law_points *law; /* or NULL */
};

void ph_point_material_free(ph_point_material **material)
{
    if (!material || !*material) return;
    free((*material)->time);
    free((*material)->c);
    ph_i_law_points_free(&(*material)->law);
    free(*material);
    *material = NULL;
}

ph_status ph_point_material_new(const ph_effective *effective, ph_point_material **out,
                                ph_error *err)
{
    ph_status st = PH_OK;
    ph_point_material *m = NULL;
    PH_CHECK(effective && out, PH_EINVAL, "no effective material");
    *out = NULL;
    const ph_prony *p = effective->relaxation;
    const ph_damage_law *law = effective->damage;
    int n = effective->stiffness.n;
    if (law && !law->driven) law = NULL; /* a table: what there is is the stiffness */
    PH_CHECK(n == 3 || n == 6, PH_EINVAL, "the stiffness has n = %d, not 3 or 6", n);
    if (p)
        PH_TRY(ph_prony_validate(p, err));
    else if (!law)
        PH_CHECK(ph_sym4_is_stiffness(&effective->stiffness), PH_EINVAL,
                 "the stiffness is not symmetric positive definite");
    PH_CHECK(!p || p->equilibrium.n == n, PH_EINVAL,
             "the relaxation has n = %d, the stiffness n = %d", p->equilibrium.n, n);
    PH_CHECK(!law || (!p && law->n == n), PH_EINVAL,
             "a damage law with n = %d beside a %s", law ? law->n : 0,
             p ? "relaxation: one of both" : "stiffness of another size");
    PH_ALLOC(m, 1, "a material point");
    m->n = n;
    m->terms = p ? p->nterms : 0;
    PH_ALLOC(m->time, m->terms, "relaxation times");
    PH_ALLOC(m->c, m->terms * n * n, "relaxation tensors");
    ph_sym4_to_voigt(p ? &p->equilibrium : &effective->stiffness, true, m->elastic);
    for (int k = 0; k < m->terms; k++) {
        m->time[k] = p->term[k].time;
        ph_sym4_to_voigt(&p->term[k].stiffness, true, m->c + (ptrdiff_t)k * n * n);
    }
    if (law) PH_TRY(ph_i_law_points_new(law, &m->law, err));
    *out = m;
    m = NULL;
out:
    ph_point_material_free(&m);
    return st;
}

int ph_point_components(const ph_point_material *material)
{
    if (!material) return 0;
    return material->n;
}

size_t ph_point_state_size(const ph_point_material *material)
{
    if (!material) return 0;
    if (material->law) return (size_t)material->n + 1;
    return (size_t)material->n * (size_t)(1 + material->terms);
}

ptrdiff_t ph_point_tangents(const ph_point_material *material, ptrdiff_t points)
{
    if (!material) return 0;
    return material->law ? points : 1;
}

/* (1 - exp(-x)) / x, and exp(-x) */
static double mean_decay(double x, double *decay)
{
    *decay = exp(-x);
    return x > 0.0 ? -expm1(-x) / x : 1.0;
}

/* h = decay h + g C deps; adds h to the stress. */
static void relax(int n, const double *c, double decay, double g, const double *de,
                  double *h, double *stress)
{
    for (int i = 0; i < n; i++) {
        double s = 0.0;
        for (int j = 0; j < n; j++)
            s += c[i * n + j] * de[j];
        h[i] = decay * h[i] + g * s;
        stress[i] += h[i];
    }
}

ph_status ph_point_update(const ph_point_material *m, double *state,
                          const double *dstrain, double dt, double *stress,
                          double *tangent)
{
    if (!m || !state || !dstrain || !stress) return PH_EINVAL;
    int n = m->n;
    bool good = dt >= 0.0 && isfinite(dt);
    for (int i = 0; i < n; i++)
        good = good && isfinite(dstrain[i]);
    if (!good) return PH_EINVAL;
    double sum[6] = {0}, de[6];
    memcpy(de, dstrain, sizeof(double) * (size_t)n); /* `stress` may be `dstrain` */
    if (m->law) {
        ph_i_law_points_update(m->law, state, de, stress, tangent);
        return PH_OK;
    }
    relax(n, m->elastic, 1.0, 1.0, de, state, sum);
    if (tangent) memcpy(tangent, m->elastic, sizeof(double) * (size_t)(n * n));
    for (int k = 0; k < m->terms; k++) {
        const double *c = m->c + (ptrdiff_t)k * n * n;
        double decay, g = mean_decay(dt / m->time[k], &decay);
        relax(n, c, decay, g, de, state + (ptrdiff_t)(1 + k) * n, sum);
        for (int i = 0; tangent && i < n * n; i++)
            tangent[i] += g * c[i];
    }
    memcpy(stress, sum, sizeof(double) * (size_t)n);
    return PH_OK;
}

ph_status ph_points_update(const ph_point_material *m, ptrdiff_t points, double *state,
                           const double *dstrain, double dt, double *stress,
                           double *tangent)
{
    if (!m || points < 0 || (points > 0 && (!state || !dstrain || !stress)))
        return PH_EINVAL;
    const int n = m->n;
    const ptrdiff_t size = (ptrdiff_t)ph_point_state_size(m);
    bool good = dt >= 0.0 && isfinite(dt);
    for (ptrdiff_t i = 0; good && i < points * n; i++)
        good = isfinite(dstrain[i]);
    if (!good) return PH_EINVAL;
    for (ptrdiff_t p = 0; m->law && p < points; p++)
        ph_i_law_points_update(m->law, state + p * size, dstrain + p * n, stress + p * n,
                               tangent ? tangent + p * n * n : NULL);
    if (m->law) return PH_OK;
    if (points > 0) memset(stress, 0, sizeof(double) * (size_t)(points * n));
    if (tangent) memcpy(tangent, m->elastic, sizeof(double) * (size_t)(n * n));
    for (int k = -1; k < m->terms; k++) { /* -1: the elastic part */
        const double *c = k < 0 ? m->elastic : m->c + (ptrdiff_t)k * n * n;
        double decay = 1.0, g = k < 0 ? 1.0 : mean_decay(dt / m->time[k], &decay);
        for (ptrdiff_t p = 0; p < points; p++)
            relax(n, c, decay, g, dstrain + p * n, state + p * size + (1 + k) * n,
                  stress + p * n);
        for (int i = 0; k >= 0 && tangent && i < n * n; i++)
            tangent[i] += g * c[i];
    }
    return PH_OK;
}
