/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/material.h>

#include "core/check.h"

#include <math.h>

static ph_status check_series(const char *name, const char *what, const ph_modulus *s,
                              ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(s->nterms >= 0, PH_EINVAL, "material '%s': %s: number of terms is %d", name,
             what, s->nterms);
    PH_CHECK(s->infinity >= 0 && isfinite(s->infinity), PH_EUNPHYSICAL,
             "material '%s': %s: the modulus at infinity must be >= 0, got %g", name,
             what, s->infinity);
    for (int m = 0; m < s->nterms; m++) {
        const ph_modulus_term *t = &s->term[m];
        PH_CHECK(t->modulus >= 0 && isfinite(t->modulus), PH_EUNPHYSICAL,
                 "material '%s': %s: a modulus must be >= 0, got %g", name, what,
                 t->modulus);
        PH_CHECK(t->time > 0 && isfinite(t->time), PH_EUNPHYSICAL,
                 "material '%s': %s: a relaxation time must be > 0, got %g", name, what,
                 t->time);
        for (int k = 0; k < m; k++)
            PH_CHECK(s->term[k].time != t->time, PH_EUNPHYSICAL,
                     "material '%s': %s: relaxation times must be distinct, got %g twice",
                     name, what, t->time);
    }
out:
    return st;
}

static ph_status check_instantaneous(const char *name, const char *what,
                                     const ph_modulus *s, ph_error *err)
{
    ph_status st = PH_OK;
    double sum = s->infinity;
    for (int m = 0; m < s->nterms; m++)
        sum += s->term[m].modulus;
    PH_CHECK(sum > 0 && isfinite(sum), PH_EUNPHYSICAL,
             "material '%s': the instantaneous %s modulus must be positive, got %g", name,
             what, sum);
out:
    return st;
}

static ph_status new_series(const char *name, const ph_sym4 *equilibrium, int nterms,
                            const ph_prony_term *term, ph_prony **out, ph_error *err)
{
    ph_status st = ph_prony_new(equilibrium, nterms, term, out, err);
    if (st != PH_OK) ph_error_prefix(err, "material '%s': ", name);
    return st;
}

static void moduli(const ph_sym4 *c, double *K, double *G)
{
    *K = (c->m[0][0] + c->m[0][1] + c->m[0][2]) / 3;
    *G = c->m[3][3] / 2;
}

/* Fills what follows from the series, which `m` takes. */
static ph_status settle(ph_material *m, ph_prony **series, ph_error *err)
{
    ph_status st = PH_OK;
    double lo, hi;
    m->stiffness = ph_prony_instantaneous(*series);
    ph_sym4_eigenvalues(&m->stiffness, &lo, &hi);
    PH_CHECK(ph_sym4_is_stiffness(&m->stiffness), PH_EUNPHYSICAL,
             "material '%s': the instantaneous stiffness must be positive definite, its "
             "eigenvalues are %g to %g (Mandel)",
             m->name, lo, hi);
    m->relaxation = *series;
    *series = NULL;
    if (m->relaxation->nterms == 0) ph_material_clear(m);
out:
    return st;
}

static ph_material unnamed(const char *name, bool isotropic)
{
    ph_material m = {.E = NAN, .nu = NAN, .density = NAN, .is_isotropic = isotropic};
    snprintf(m.name, sizeof m.name, "%s", name ? name : "");
    return m;
}

ph_status ph_material_viscoelastic_young(const char *name, const ph_modulus *E, double nu,
                                         ph_material *out, ph_error *err)
{
    PH_GIVEN(name && E && out);
    ph_status st = PH_OK;
    ph_prony_term *term = NULL;
    ph_prony *series = NULL;
    ph_material m = unnamed(name, true);
    PH_TRY(check_series(m.name, "E", E, err));
    PH_CHECK(nu > -1.0 && nu < 0.5, PH_EUNPHYSICAL,
             "material '%s': Poisson ratio nu must be in (-1, 0.5), got %g", m.name, nu);
    ph_sym4 unit = ph_sym4_isotropic(1, nu), nothing = {.n = 6};
    ph_sym4 equilibrium = ph_sym4_combine(E->infinity, &unit, 0, &nothing);
    PH_ALLOC(term, E->nterms, "the terms of a Prony series");
    m.E = E->infinity;
    m.nu = nu;
    for (int k = 0; k < E->nterms; k++) {
        m.E += E->term[k].modulus;
        term[k].time = E->term[k].time;
        term[k].stiffness = ph_sym4_combine(E->term[k].modulus, &unit, 0, &nothing);
    }
    PH_CHECK(m.E > 0 && isfinite(m.E), PH_EUNPHYSICAL,
             "material '%s': the instantaneous modulus E must be positive, got %g",
             m.name, m.E);
    PH_TRY(new_series(m.name, &equilibrium, E->nterms, term, &series, err));
    PH_TRY(settle(&m, &series, err));
    *out = m;
out:
    free(term);
    ph_prony_free(&series);
    return st;
}

/* Young's modulus and Poisson's ratio of an isotropic tensor. */
static void young(ph_material *m)
{
    double K, G;
    moduli(&m->stiffness, &K, &G);
    m->E = 9 * K * G / (3 * K + G);
    m->nu = (3 * K - 2 * G) / (6 * K + 2 * G);
}

/* The terms of K and G in one list; a time that both have is one term. */
static int merge(const ph_modulus *K, const ph_modulus *G, ph_prony_term *term)
{
    int count = 0;
    for (int k = 0; k < K->nterms; k++)
        term[count++] =
            (ph_prony_term){K->term[k].time, ph_sym4_isotropic_kg(K->term[k].modulus, 0)};
    for (int g = 0; g < G->nterms; g++) {
        ph_sym4 shear = ph_sym4_isotropic_kg(0, G->term[g].modulus);
        int k = 0;
        while (k < K->nterms && K->term[k].time != G->term[g].time)
            k++;
        if (k < K->nterms)
            term[k].stiffness = ph_sym4_combine(1, &term[k].stiffness, 1, &shear);
        else
            term[count++] = (ph_prony_term){G->term[g].time, shear};
    }
    return count;
}

ph_status ph_material_viscoelastic_bulk_shear(const char *name, const ph_modulus *K,
                                              const ph_modulus *G, ph_material *out,
                                              ph_error *err)
{
    PH_GIVEN(name && K && G && out);
    ph_status st = PH_OK;
    ph_prony_term *term = NULL;
    ph_prony *series = NULL;
    ph_material m = unnamed(name, true);
    PH_TRY(check_series(m.name, "bulk", K, err));
    PH_TRY(check_series(m.name, "shear", G, err));
    PH_TRY(check_instantaneous(m.name, "bulk", K, err));
    PH_TRY(check_instantaneous(m.name, "shear", G, err));
    PH_ALLOC(term, K->nterms + G->nterms, "the terms of a Prony series");
    int count = merge(K, G, term);
    ph_sym4 equilibrium = ph_sym4_isotropic_kg(K->infinity, G->infinity);
    PH_TRY(new_series(m.name, &equilibrium, count, term, &series, err));
    PH_TRY(settle(&m, &series, err));
    young(&m);
    *out = m;
out:
    free(term);
    ph_prony_free(&series);
    return st;
}

ph_status ph_material_viscoelastic_tensor(const char *name, const ph_prony *series,
                                          const double *R, ph_material *out,
                                          ph_error *err)
{
    PH_GIVEN(name && series && out);
    ph_status st = PH_OK;
    ph_prony *copy = NULL;
    ph_material m = unnamed(name, false);
    PH_CHECK(series->equilibrium.n == 6, PH_EINVAL,
             "material '%s': a phase needs a 6 x 6 series, got n = %d", m.name,
             series->equilibrium.n);
    PH_TRY(new_series(m.name, &series->equilibrium, series->nterms, series->term, &copy,
                      err));
    if (R) ph_prony_rotate(copy, R);
    PH_TRY(settle(&m, &copy, err));
    *out = m;
out:
    ph_prony_free(&copy);
    return st;
}

ph_status ph_material_at(const ph_material *m, double s, ph_material *out, ph_error *err)
{
    PH_GIVEN(m && out);
    ph_status st = PH_OK;
    ph_material at = *m;
    PH_CHECK(s >= 0, PH_EINVAL, "the Carson variable s must be >= 0, got %g", s);
    if (m->relaxation) {
        at.relaxation = NULL;
        at.stiffness = ph_prony_carson(m->relaxation, s);
        if (ph_sym4_norm(&at.stiffness) == 0) {
            at = ph_material_void(m->name);
            at.density = m->density;
        } else {
            PH_CHECK(ph_sym4_is_stiffness(&at.stiffness), PH_ESINGULAR,
                     "material '%s': its stiffness at s = %g is singular", m->name, s);
            if (at.is_isotropic) young(&at);
        }
    }
    *out = at;
out:
    return st;
}

ph_status ph_material_copy(const ph_material *m, ph_material *out, ph_error *err)
{
    PH_GIVEN(m && out);
    ph_material copy = *m;
    ph_status st = ph_prony_copy(m->relaxation, &copy.relaxation, err);
    if (st == PH_OK) *out = copy;
    return st;
}

void ph_material_clear(ph_material *m)
{
    if (!m) return;
    ph_prony_free(&m->relaxation);
}
