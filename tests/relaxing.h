/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random phases that relax, and cells of them; include after check.h. */
#ifndef TESTS_RELAXING_H
#define TESTS_RELAXING_H

#include "random_cases.h"
#include "solve.h"

enum { MOST_TERMS = 8 };

/* nterms moduli that add up to `total`, a share of it at rest, times over `decades`. */
static inline ph_modulus random_series(uint64_t *seed, int nterms, double total,
                                       double rest, double decades, ph_modulus_term *term)
{
    double sum = 0.0;
    for (int t = 0; t < nterms; t++) {
        term[t].modulus = check_uniform(seed, 0.1, 1.0);
        term[t].time = pow(10.0, decades * (check_random(seed) - 0.5));
        sum += term[t].modulus;
    }
    for (int t = 0; t < nterms; t++)
        term[t].modulus *= total * (1.0 - rest) / sum;
    return (ph_modulus){total * rest, nterms, term};
}

/* A random series of any tensors. */
static inline ph_material random_tensor_phase(const char *name, uint64_t *seed,
                                              int nterms, double rest, double decades)
{
    ph_error err = PH_ERROR_INIT;
    ph_prony_term term[MOST_TERMS];
    ph_prony series = {.nterms = nterms, .term = term};
    ph_material m = {0};
    ph_sym4 c = random_stiffness(seed, 6), nothing = {.n = 6};
    series.equilibrium = ph_sym4_combine(rest, &c, 0.0, &nothing);
    for (int t = 0; t < nterms; t++) {
        c = random_stiffness(seed, 6);
        term[t].stiffness = ph_sym4_combine(1.0 / nterms, &c, 0.0, &nothing);
        term[t].time = pow(10.0, decades * (check_random(seed) - 0.5));
    }
    for (int t = 1; t < nterms; t++) /* ascending */
        for (int k = t; k > 0 && term[k].time < term[k - 1].time; k--) {
            ph_prony_term swap = term[k];
            term[k] = term[k - 1], term[k - 1] = swap;
        }
    CHECK_OK(ph_material_viscoelastic_tensor(name, &series, NULL, &m, &err));
    return m;
}

/* kind 0: elastic; 1: E(t) with constant nu; 2: bulk and shear; 3: any tensors. */
static inline ph_material random_phase(const char *name, uint64_t *seed, int kind,
                                       double E, double rest, double decades)
{
    ph_error err = PH_ERROR_INIT;
    ph_modulus_term t1[MOST_TERMS], t2[MOST_TERMS];
    ph_material m = {0};
    double nu = check_uniform(seed, 0.1, 0.4);
    int n1 = 1 + (int)(3 * check_random(seed)), n2 = 1 + (int)(3 * check_random(seed));
    if (kind == 3) return random_tensor_phase(name, seed, n1, rest, decades);
    ph_modulus a = random_series(seed, n1, kind == 2 ? E / 3 / (1 - 2 * nu) : E,
                                 kind == 2 ? 0.5 * (1 + rest) : rest, decades, t1);
    ph_modulus b = random_series(seed, n2, E / 2 / (1 + nu), rest, decades, t2);
    if (kind == 0)
        CHECK_OK(ph_material_isotropic(name, E, nu, &m, &err));
    else if (kind == 1)
        CHECK_OK(ph_material_viscoelastic_young(name, &a, nu, &m, &err));
    else
        CHECK_OK(ph_material_viscoelastic_bulk_shear(name, &a, &b, &m, &err));
    return m;
}

/* |a - b| / |b| */
static inline double off(const ph_sym4 *a, const ph_sym4 *b)
{
    ph_sym4 d = ph_sym4_combine(1.0, a, -1.0, b);
    return ph_sym4_norm(&d) / ph_sym4_norm(b);
}

#endif
