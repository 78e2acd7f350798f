/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Layers: the exact answer is ph_sym4_laminate, for any phases and kinematics. */
#include "solve.h"

typedef struct plan {
    const char *model;
    ph_points points;
    double horizon;
    ph_stabilisation stabilisation;
} plan;

/* A layer from .. to with its normal along one axis, cubic cells, n of them along it. */
static ph_microstructure *layers(ph_kinematics kin, int normal, ptrdiff_t n, double from,
                                 double to, ph_material *two)
{
    ptrdiff_t cells[3] = {4, 4, kin == PH_SPACE ? 4 : 1};
    cells[normal - 1] = n;
    ph_grid g = box_grid(kin, cells[0], cells[1], cells[2], (double)cells[0] / (double)n,
                         (double)cells[1] / (double)n,
                         kin == PH_SPACE ? (double)cells[2] / (double)n : 1.0);
    ph_inclusion inc = blank_inclusion("layer", 1);
    inc.normal = normal;
    inc.from = from;
    inc.to = to;
    return shapes_cell(g, 2, two, 1, &inc);
}

static double error_of(ph_kinematics kin, int normal, ptrdiff_t n, double from, double to,
                       ph_material *two, const plan *how)
{
    ph_error err = PH_ERROR_INIT;
    ph_microstructure *m = layers(kin, normal, n, from, to, two);
    ph_problem p = {.micro = m, .solver = {.kind = "fft_cg", .tolerance = 1e-12}};
    p.model = (ph_model_params){.kind = how->model,
                                .points = how->points,
                                .horizon = how->horizon,
                                .stabilisation = how->stabilisation};
    ph_sym4 got = stiffness_of(&p), a, b, want;
    double along[3] = {normal == 1, normal == 2, normal == 3};
    CHECK_OK(ph_sym4_reduce(&two[0].stiffness, kin, &a, &err));
    CHECK_OK(ph_sym4_reduce(&two[1].stiffness, kin, &b, &err));
    CHECK_OK(ph_sym4_laminate(&a, &b, to - from, along, &want, &err));
    ph_microstructure_free(&m);
    return difference(&got, &want);
}

static const ph_kinematics kinematics[] = {PH_SPACE, PH_GENERALISED_STRAIN,
                                           PH_PLANE_STRAIN, PH_PLANE_STRESS};
enum { KINEMATICS = 4 };

/* Points that see only their own cell are exact, also where an interface cuts the cells: the
 * mixture of a cut cell is the same laminate, and along the normal the displacement of a cell
 * is linear between its faces. What is left is the solver's 1e-12. */
static void test_own_cell(void **state)
{
    (void)state;
    static const plan exact[] = {
        {"local", PH_POINTS_AUTO, 0, PH_STABILISE_AUTO},
        {"nosb", PH_POINTS_STRESS, 0, PH_STABILISE_SPECTRAL},
        {"nosb", PH_POINTS_STRESS, 0, PH_STABILISE_SUBPOINT},
    };
    uint64_t seed = check_seed();
    for (int trial = 0; trial < check_trials(2); trial++)
        for (int k = 0; k < KINEMATICS; k++)
            for (int normal = 1; normal <= (kinematics[k] == PH_SPACE ? 3 : 2); normal++)
                for (int i = 0; i < 3; i++) {
                    ph_material two[2] = {anisotropic("a", &seed),
                                          anisotropic("b", &seed)};
                    double from = check_uniform(&seed, 0, 0.3);
                    double to = check_uniform(&seed, 0.4, 0.9);
                    CHECK(error_of(kinematics[k], normal, 8, 0.25, 0.75, two, &exact[i]) <
                          1e-10);
                    CHECK(error_of(kinematics[k], normal, 7, from, to, two, &exact[i]) <
                          1e-10);
                }
    CHECK_END();
}

/* Nodes with the smallest family, interfaces on cell faces, an even number of cells in each
 * layer: central differences tie even nodes to odd points and odd to even, each half by
 * itself an exact laminate. The sawtooth between them costs the stabilisation its share
 * alpha = 1e-5, and nothing more. */
static void test_nodes_face(void **state)
{
    (void)state;
    const plan smallest = {"nosb", PH_POINTS_NODES, 1.0, PH_STABILISE_SPECTRAL};
    uint64_t seed = check_seed();
    for (int k = 0; k < KINEMATICS; k++) {
        ph_material two[2] = {anisotropic("a", &seed), anisotropic("b", &seed)};
        double e = error_of(kinematics[k], 1, 16, 0.25, 0.625, two, &smallest);
        CHECK(e < 2e-5);
        CHECK(e > 1e-8); /* seen, so the stabilisation is on */
    }
    CHECK_END();
}

/* Nodes otherwise: families reach across the interface, an error of order h. Faces of the
 * cells and interfaces inside them, the worse of both, grids 8..64 (odd and even numbers of
 * cells in a layer). Above the floor that alpha makes, about 1e-4 for horizon 2. */
static void test_nodes_order(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int k = 0; k < KINEMATICS; k++)
        for (int normal = 1; normal <= (kinematics[k] == PH_SPACE ? 3 : 2); normal++) {
            ph_material two[2] = {anisotropic("a", &seed), anisotropic("b", &seed)};
            const plan wider = {"nosb", PH_POINTS_NODES, 2.0, PH_STABILISE_SPECTRAL};
            double h[4], worst[4];
            for (int i = 0; i < 4; i++) {
                h[i] = 1.0 / (8 << i);
                double face =
                    error_of(kinematics[k], normal, 8 << i, 0.25, 0.625, two, &wider);
                double cut =
                    error_of(kinematics[k], normal, 8 << i, 0.28, 0.635, two, &wider);
                worst[i] = fmax(face, cut);
            }
            CHECK(fitted_order(4, h, worst) >= 0.8);
            CHECK(worst[3] < 2e-3);
        }
    CHECK_END();
}

/* What `auto` answers without equations is what the solver comes to where points see only
 * their own cell (its 1e-12), for three materials and cut cells; and the formula for two.
 * Nodes tend to it with the grid, test_nodes_order, unless the horizon is a length. */
static void test_closed_form(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int k = 0; k < KINEMATICS; k++)
        for (int normal = 1; normal <= (kinematics[k] == PH_SPACE ? 3 : 2); normal++) {
            ph_material three[3] = {anisotropic("a", &seed), anisotropic("b", &seed),
                                    anisotropic("c", &seed)};
            ptrdiff_t n[3] = {3, 3, kinematics[k] == PH_SPACE ? 3 : 1};
            n[normal - 1] = 7;
            ph_inclusion inc[2] = {blank_inclusion("layer", 1),
                                   blank_inclusion("layer", 2)};
            for (int i = 0; i < 2; i++) {
                inc[i].normal = normal;
                inc[i].from = check_uniform(&seed, 0.1, 0.4);
                inc[i].to = check_uniform(&seed, 0.5, 0.9);
            }
            ph_microstructure *m = shapes_cell(
                box_grid(kinematics[k], n[0], n[1], n[2], 1, 0.8, 1.2), 3, three, 2, inc);
            ph_problem p = {.micro = m, .solver = {.tolerance = 1e-12}};
            p.model.kind = k % 2 ? "local" : "nosb";
            ph_result *exact = homogenise(&p);
            p.solver.kind = "fft_cg";
            ph_result *solved = homogenise(&p);
            if (exact && solved) {
                CHECK(strcmp(exact->solver, "analytic") == 0);
                CHECK(exact->work.applications == 0 && exact->work.ffts == 0);
                CHECK(solved->work.applications > 0);
                CHECK(difference(&exact->stiffness, &solved->stiffness) < 1e-10);
            }
            ph_result_free(&exact);
            ph_result_free(&solved);
            ph_microstructure_free(&m);
        }
    CHECK_END();
}

/* Where the layers are not all of it: a horizon that is a length, fields, a void layer. */
static void test_no_closed_form(void **state)
{
    (void)state;
    ph_material two[2] = {isotropic("a", 1, 0.3), isotropic("b", 3, 0.2)};
    for (int i = 0; i < 3; i++) {
        if (i == 2) two[1] = ph_material_void("hole");
        ph_microstructure *m = layers(PH_PLANE_STRAIN, 1, 16, 0.25, 0.5, two);
        ph_problem p = {.micro = m, .keep_fields = i == 1};
        if (i == 0)
            p.model = (ph_model_params){.kind = "nosb",
                                        .points = PH_POINTS_NODES,
                                        .horizon = 1.0 / 16,
                                        .horizon_is_length = true};
        ph_result *res = homogenise(&p);
        CHECK(res && strcmp(res->solver, "analytic") != 0 && res->work.loads > 0);
        ph_result_free(&res);
        ph_microstructure_free(&m);
    }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_own_cell), cmocka_unit_test(test_nodes_face),
        cmocka_unit_test(test_nodes_order), cmocka_unit_test(test_closed_form),
        cmocka_unit_test(test_no_closed_form)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
