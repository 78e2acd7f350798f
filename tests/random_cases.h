/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random microstructures and operators for the tests; include after check.h. */
#ifndef TESTS_RANDOM_CASES_H
#define TESTS_RANDOM_CASES_H

#include "model/operator.h"
#include "tensors.h"

typedef struct random_case {
    ph_microstructure *micro;
    ph_stiffness_map *map;
    ph_family *family;
    ph_operator_params params;
    ph_meter meter;
} random_case;

/* Isotropic, anisotropic, stiff; with `voids` a fourth that is void. */
static inline void random_materials(uint64_t *seed, ph_material m[4])
{
    ph_error err = PH_ERROR_INIT;
    double voigt[36];
    CHECK_OK(ph_material_isotropic("soft", 1.0, 0.3, &m[0], &err));
    ph_sym4 c = random_stiffness(seed, 6);
    ph_sym4_to_voigt(&c, true, voigt);
    CHECK_OK(ph_material_anisotropic("crystal", voigt, NULL, &m[1], &err));
    CHECK_OK(ph_material_isotropic("stiff", 8.0, 0.1, &m[2], &err));
    m[3] = ph_material_void("hole");
}

/* Every cell a random phase, every third cell cut; unequal spacing. */
static inline ph_microstructure *random_micro(uint64_t *seed, ph_kinematics kin,
                                              const ptrdiff_t *n, bool voids)
{
    ph_error err = PH_ERROR_INIT;
    ph_material m[4];
    ph_grid grid;
    ph_microstructure *micro = NULL;
    double size[3];
    int used = voids ? 4 : 3;
    for (int d = 0; d < 3; d++)
        size[d] = (double)n[d] * check_uniform(seed, 0.8, 1.2);
    random_materials(seed, m);
    CHECK_OK(ph_grid_init(&grid, kin, n, size, &err));
    CHECK_OK(ph_microstructure_new(&grid, used, m, &micro, &err));
    if (!micro) return NULL;
    ptrdiff_t cells = ph_grid_cells(&grid);
    for (ptrdiff_t x = 0; x < cells; x++)
        micro->phase[x] = (uint16_t)(used * check_random(seed));
    micro->cuts = calloc((size_t)(cells / 3 + 1), sizeof *micro->cuts);
    for (ptrdiff_t x = 0; micro->cuts && x < cells; x += 3) {
        ph_cut *c = &micro->cuts[micro->ncuts++];
        double phi = check_uniform(seed, 0, 6.28), z = 0.0;
        if (kin == PH_SPACE) z = check_uniform(seed, -0.9, 0.9);
        *c = (ph_cut){x,
                      micro->phase[x],
                      (int)(3 * check_random(seed)),
                      check_uniform(seed, 0.1, 0.9),
                      {sqrt(1 - z * z) * cos(phi), sqrt(1 - z * z) * sin(phi), z}};
    }
    return micro;
}

static inline const ph_influence *influence_at(size_t i)
{
    return &ph_influences[i];
}

/* `points` AUTO: local. Horizon in half diagonals (stress) or widest spacings (nodes). */
static inline random_case new_case(uint64_t *seed, ph_kinematics kin, const ptrdiff_t *n,
                                   bool voids, ph_points points, double horizon,
                                   const ph_influence *influence, ph_stabilisation stab,
                                   double value)
{
    random_case c = {.micro = random_micro(seed, kin, n, voids)};
    ph_error err = PH_ERROR_INIT;
    const ph_grid *g = &c.micro->grid;
    CHECK_OK(ph_i_stiffness_map_new(c.micro, PH_INTERFACE_COMPOSITE, true, NULL,
                                    ph_grid_cells(g), &c.meter, &c.map, &err));
    if (points != PH_POINTS_AUTO) {
        double sum = 0.0, widest = 0.0;
        ptrdiff_t corners = 1;
        for (int d = 0; d < 3; d++) {
            if (g->n[d] == 1) continue;
            sum += g->h[d] * g->h[d];
            widest = fmax(widest, g->h[d]);
            corners *= 2;
        }
        double unit = points == PH_POINTS_STRESS ? 0.5 * sqrt(sum) : widest;
        CHECK_OK(ph_family_new(g, points, horizon * unit, influence,
                               &ph_volume_weights[0], &c.family, &err));
        c.params.smallest =
            points == PH_POINTS_STRESS && c.family && c.family->count == corners;
    }
    c.params.family = c.family;
    c.params.stabilisation = stab;
    c.params.value = value;
    c.params.threads = 1;
    return c;
}

static inline void free_case(random_case *c)
{
    ph_family_free(&c->family);
    ph_i_stiffness_map_free(&c->meter, &c->map);
    ph_microstructure_free(&c->micro);
}

static inline ptrdiff_t displacements(const random_case *c)
{
    return ph_displacements(c->micro->grid.kinematics) * ph_grid_cells(&c->micro->grid);
}

static inline double *random_field(uint64_t *seed, ptrdiff_t n)
{
    double *u = ph_i_doubles_new(NULL, (size_t)n);
    for (ptrdiff_t i = 0; i < n; i++)
        u[i] = check_uniform(seed, -1, 1);
    return u;
}

static inline double field_difference(ptrdiff_t n, const double *a, const double *b)
{
    double d = 0.0, s = 0.0;
    for (ptrdiff_t i = 0; i < n; i++) {
        d += (a[i] - b[i]) * (a[i] - b[i]);
        s += b[i] * b[i];
    }
    return s > 0.0 ? sqrt(d / s) : sqrt(d);
}

#endif
