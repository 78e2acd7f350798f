/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random phases that relax, and cells of them; include after check.h. */
#ifndef TESTS_RELAXING_H
#define TESTS_RELAXING_H

#include <perihom/bond.h>

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

/* kind 0: elastic; 1: E(t) with constant nu; 2: bulk and shear; 3: any tensors. nu NaN: random. */
static inline ph_material random_phase(const char *name, uint64_t *seed, int kind,
                                       double E, double nu, double rest, double decades)
{
    ph_error err = PH_ERROR_INIT;
    ph_modulus_term t1[MOST_TERMS], t2[MOST_TERMS];
    ph_material m = {0};
    if (isnan(nu)) nu = check_uniform(seed, 0.1, 0.4);
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

/* Blocks of three phases of these kinds in a box of n nodes an axis, every third cell cut.
 * lattice: Poisson's ratio of bonds, and no cuts. */
static inline ph_microstructure *blocks_cell(uint64_t *seed, ph_kinematics kin,
                                             ptrdiff_t n, const int kinds[3],
                                             double contrast, double decades, int blocks,
                                             bool lattice)
{
    ph_error err = PH_ERROR_INIT;
    ph_grid grid;
    ph_microstructure *micro = NULL;
    ph_material m[3];
    ptrdiff_t size[3] = {n, n, n};
    double length[3] = {1, 1, 1};
    double rest = pow(10.0, check_uniform(seed, -2, -0.1));
    double nu = lattice ? ph_bond_poisson(kin) : (double)NAN;
    m[0] = random_phase("a", seed, kinds[0], 1.0, nu, rest, decades);
    m[1] = random_phase("b", seed, kinds[1], contrast, nu, rest, decades);
    m[2] = random_phase("c", seed, kinds[2], sqrt(contrast), nu, rest, decades);
    CHECK_OK(ph_grid_init(&grid, kin, size, length, &err));
    CHECK_OK(ph_microstructure_new(&grid, 3, m, &micro, &err));
    ptrdiff_t cells = ph_grid_cells(&grid), deep = kin == PH_SPACE ? n : 1;
    int pick[512];
    for (int i = 0; i < 512; i++)
        pick[i] = (int)(3 * check_random(seed));
    for (ptrdiff_t x = 0; x < cells; x++) {
        ptrdiff_t i = x / deep / n * blocks / n, j = x / deep % n * blocks / n,
                  k = kin == PH_SPACE ? x % n * blocks / n : 0;
        micro->phase[x] = (uint16_t)pick[((i * blocks + j) * blocks + k) % 512];
    }
    micro->cuts = calloc((size_t)(cells / 3 + 1), sizeof *micro->cuts);
    for (ptrdiff_t x = 0; !lattice && x < cells; x += 3) {
        ph_cut *c = &micro->cuts[micro->ncuts++];
        double phi = check_uniform(seed, 0, 6.28);
        *c = (ph_cut){x,
                      micro->phase[x],
                      (int)(3 * check_random(seed)),
                      check_uniform(seed, 0.1, 0.9),
                      {cos(phi), sin(phi), 0}};
    }
    for (int p = 0; p < 3; p++)
        ph_material_clear(&m[p]);
    return micro;
}

#endif
