/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random viscoelastic microstructures, and a stepper on one; include after check.h. */
#ifndef TESTS_VISCO_CASE_H
#define TESTS_VISCO_CASE_H

#include "effective/stepping.h"
#include "tensors.h"

enum { VISCO_MATERIALS = 4 };

/* Elastic; E(t) with nu fixed; K(t) and G(t) on their own; a series of tensors. */
static inline void viscous_materials(uint64_t *seed, ph_material m[VISCO_MATERIALS])
{
    ph_error err = PH_ERROR_INIT;
    double decades = 2.0, t[3];
    for (int i = 0; i < 3; i++)
        t[i] = pow(10.0, check_uniform(seed, -decades, decades));
    CHECK_OK(ph_material_isotropic("filler", 20.0, 0.2, &m[0], &err));
    const ph_modulus_term e[2] = {{t[0], 3.0}, {30.0 * t[0], 2.0}};
    CHECK_OK(ph_material_viscoelastic_young("resin", &(ph_modulus){1.0, 2, e}, 0.35,
                                            &m[1], &err));
    const ph_modulus_term k[1] = {{t[1], 2.0}}, g[2] = {{0.1 * t[1], 1.0}, {t[2], 0.5}};
    CHECK_OK(ph_material_viscoelastic_bulk_shear("gel", &(ph_modulus){4.0, 1, k},
                                                 &(ph_modulus){0.3, 2, g}, &m[2], &err));
    ph_prony_term term[2] = {{t[2], random_stiffness(seed, 6)},
                             {7.0 * t[2], random_stiffness(seed, 6)}};
    ph_prony p = {random_stiffness(seed, 6), 2, term};
    CHECK_OK(ph_material_viscoelastic_tensor("ply", &p, NULL, &m[3], &err));
}

/* Every cell a random phase; with `cuts` every third cell cut, some of them twice. */
static inline ph_microstructure *viscous_micro(uint64_t *seed, ph_kinematics kin,
                                               const ptrdiff_t *n, bool cuts)
{
    ph_error err = PH_ERROR_INIT;
    ph_material m[VISCO_MATERIALS];
    ph_grid grid;
    ph_microstructure *micro = NULL;
    double size[3];
    for (int d = 0; d < 3; d++)
        size[d] = (double)n[d] * check_uniform(seed, 0.9, 1.1);
    viscous_materials(seed, m);
    CHECK_OK(ph_grid_init(&grid, kin, n, size, &err));
    CHECK_OK(ph_microstructure_new(&grid, VISCO_MATERIALS, m, &micro, &err));
    for (int i = 0; i < VISCO_MATERIALS; i++)
        ph_material_clear(&m[i]);
    if (!micro) return NULL;
    const ptrdiff_t cells = n[0] * n[1] * (ph_displacements(kin) == 3 ? n[2] : 1);
    for (ptrdiff_t x = 0; x < cells; x++)
        micro->phase[x] = (uint16_t)(VISCO_MATERIALS * check_random(seed));
    if (!cuts) return micro;
    micro->cuts = calloc((size_t)(cells + 1), sizeof *micro->cuts);
    for (ptrdiff_t x = 0; micro->cuts && x < cells; x += 3) {
        int many = check_random(seed) < 0.3 ? 2 : 1;
        for (int k = 0; k < many; k++) {
            double phi = check_uniform(seed, 0, 6.28), z = 0.0;
            if (ph_displacements(kin) == 3 && grid.n[2] > 1)
                z = check_uniform(seed, -0.9, 0.9);
            micro->cuts[micro->ncuts++] =
                (ph_cut){x,
                         k ? -1 : micro->phase[x],
                         (int)(VISCO_MATERIALS * check_random(seed)),
                         check_uniform(seed, 0.1, 0.9),
                         {sqrt(1 - z * z) * cos(phi), sqrt(1 - z * z) * sin(phi), z}};
        }
    }
    return micro;
}

/* A run that is built and its stepper. */
typedef struct visco_case {
    ph_problem problem;
    ph_ctx ctx;
    ph_run run;
    ph_stepper *stepper;
} visco_case;

static inline void start_case(visco_case *c, const ph_microstructure *micro,
                              const ph_model_params *model, const char *constraint,
                              double tolerance)
{
    ph_error err = PH_ERROR_INIT;
    c->problem = (ph_problem){.micro = micro,
                              .model = *model,
                              .constraint = {.kind = constraint},
                              .solver = {.tolerance = tolerance}};
    c->ctx = (ph_ctx){.threads = 1};
    c->run = (ph_run){.problem = &c->problem, .ctx = &c->ctx};
    c->stepper = NULL;
    CHECK_OK(ph_i_run_relaxing(&c->run, &err));
    if (c->run.op) CHECK_OK(ph_i_stepper_new(&c->run, tolerance, &c->stepper, &err));
    assert_non_null(c->stepper);
}

static inline void end_case(visco_case *c)
{
    ph_i_stepper_free(&c->stepper);
    ph_i_run_clear(&c->run);
    ph_result_free(&c->run.result);
}

#endif
