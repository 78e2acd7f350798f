/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A cell of one material is that material, to rounding, without an iteration: over every
 * kinematics, constraint, influence function, volume weight, kind of points. keep_fields
 * forces the equations to be set up where a homogeneous cell would be answered without. */
#include "solve.h"

static const ph_kinematics kinematics[] = {PH_SPACE, PH_GENERALISED_STRAIN,
                                           PH_PLANE_STRAIN, PH_PLANE_STRESS};

/* Two phases of the same stiffness, unequal spacing. */
static ph_microstructure *one_material(ph_kinematics kin, ph_material material,
                                       uint64_t *seed)
{
    ph_material twins[2] = {material, material};
    snprintf(twins[1].name, sizeof twins[1].name, "twin");
    ph_grid g = box_grid(kin, 9, 8, kin == PH_SPACE ? 10 : 1, 1.0, 0.8,
                         kin == PH_SPACE ? 1.1 : 1.0);
    return voxel_cell(g, 2, twins, seed);
}

static void check_answer(ph_problem *p, bool solved)
{
    ph_error err = PH_ERROR_INIT;
    ph_sym4 want;
    ph_result *res = homogenise(p);
    if (!res) return;
    CHECK_OK(ph_sym4_reduce(&p->micro->materials[0].stiffness, p->micro->grid.kinematics,
                            &want, &err));
    /* sums over 1e3 cells of round-off 1e-16, and the inversions of plane stress */
    double tol = solved ? 1e-9 : 1e-12;
    CHECK(difference(&res->stiffness, &want) < tol);
    CHECK(difference(&res->voigt, &want) < 1e-12 &&
          difference(&res->reuss, &want) < 1e-12);
    CHECK(res->converged);
    CHECK(res->asymmetry < tol && res->hill_mandel < tol && res->strain_average < tol);
    if (!solved) CHECK(most_iterations(res) == 0);
    if (p->keep_fields && res->nloads)
        CHECK(res->nfields == ph_strains(res->grid.kinematics));
    ph_result_free(&res);
}

/* Influence functions and weights, one random material after the other. */
static void test_families(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int k = 0; k < 4; k++)
        for (size_t i = 0; i < ph_ninfluences; i++)
            for (size_t w = 0; w < ph_nvolume_weights; w++)
                for (int points = 0; points < 4; points++) {
                    ph_microstructure *m =
                        one_material(kinematics[k], anisotropic("m", &seed), &seed);
                    ph_problem p = {.micro = m, .keep_fields = true};
                    p.model.influence = ph_influences[i].info.name;
                    p.model.weights = ph_volume_weights[w].info.name;
                    p.model.points = points < 2 ? PH_POINTS_NODES : PH_POINTS_STRESS;
                    p.model.horizon = points % 2 ? 2.0 : 1.2;
                    p.model.stabilisation =
                        w % 2 ? PH_STABILISE_SUBPOINT : PH_STABILISE_SPECTRAL;
                    check_answer(&p, false);
                    ph_microstructure_free(&m);
                }
    CHECK_END();
}

/* Constraints and models, isotropic and not, with and without the solver's path. A block
 * pulled at its faces has a displacement to be found: there the solver's tolerance counts. */
static void test_constraints(void **state)
{
    (void)state;
    static const struct {
        const char *constraint;
        ph_collar collar;
        bool solved;
    } closing[] = {{"periodic", 0, false},
                   {"linear_displacement", PH_COLLAR_INSIDE, false},
                   {"linear_displacement", PH_COLLAR_PERIODIC, false},
                   {"linear_displacement", PH_COLLAR_MATRIX, false},
                   {"uniform_traction", 0, true},
                   {"voigt", 0, false},
                   {"reuss", 0, false}};
    uint64_t seed = check_seed();
    for (int k = 0; k < 4; k++)
        for (size_t i = 0; i < sizeof closing / sizeof *closing; i++)
            for (int model = 0; model < 3; model++)
                for (int fields = 0; fields < 2; fields++) {
                    if (closing[i].solved && model == 2) continue;
                    ph_material material = (i + (size_t)model) % 2
                                               ? anisotropic("crystal", &seed)
                                               : isotropic("glass", 3.0, 0.2);
                    ph_microstructure *m = one_material(kinematics[k], material, &seed);
                    ph_problem p = {.micro = m, .keep_fields = fields};
                    p.constraint.kind = closing[i].constraint;
                    p.constraint.collar = closing[i].collar;
                    p.model.kind = model == 0 ? "local" : "nosb";
                    p.model.points = model == 2 ? PH_POINTS_NODES : PH_POINTS_STRESS;
                    p.solver.tolerance = 1e-11;
                    check_answer(&p, closing[i].solved);
                    ph_microstructure_free(&m);
                }
    CHECK_END();
}

/* The displacement of a homogeneous cell is eps x, at nodes and at stress points. */
static void test_fields(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int points = 0; points < 2; points++) {
        ph_microstructure *m = one_material(PH_SPACE, anisotropic("m", &seed), &seed);
        ph_problem p = {.micro = m, .keep_fields = true};
        p.model.points = points ? PH_POINTS_STRESS : PH_POINTS_NODES;
        ph_result *res = homogenise(&p);
        if (res) {
            const ph_fields *f = &res->fields[0];
            const ph_grid *g = &res->grid;
            ptrdiff_t cells = ph_grid_cells(g);
            double off = 0.0;
            for (ptrdiff_t x = 0; x < cells; x++) {
                double at =
                    ((double)(x / (g->n[1] * g->n[2])) + (points ? 0.0 : 0.5)) * g->h[0];
                off = fmax(off, fabs(f->displacement[x] - at));
                off = fmax(off, fabs(f->displacement[cells + x]));
                off = fmax(off, fabs(f->strain[x] - 1.0));
                off = fmax(off, fabs(f->stress[x] / res->stiffness.m[0][0] - 1.0));
            }
            CHECK(off < 1e-13);
        }
        ph_result_free(&res);
        ph_microstructure_free(&m);
    }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_families),
                                       cmocka_unit_test(test_constraints),
                                       cmocka_unit_test(test_fields)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
