/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One mean stress, its mean strain found with the displacement, gives a row of the compliance:
 * that of the whole tensor, over models and kinematics; where the route cannot do it the strains
 * of its block are solved. */
#include "solve.h"

static const ph_model_params models[] = {
    {.kind = "local"},
    {.kind = "nosb", .points = PH_POINTS_STRESS},
    {.kind = "nosb", .points = PH_POINTS_STRESS, .horizon = 2},
    {.kind = "nosb", .points = PH_POINTS_STRESS, .stabilisation = PH_STABILISE_SUBPOINT},
    {.kind = "nosb", .points = PH_POINTS_NODES, .horizon = 1.5},
    {.kind = "nosb", .points = PH_POINTS_NODES, .horizon = 3},
    {.kind = "nosb",
     .points = PH_POINTS_NODES,
     .horizon = 2,
     .stabilisation = PH_STABILISE_SUBPOINT},
};
enum { MODELS = sizeof models / sizeof *models };

static ph_quantity named(const char *name)
{
    ph_error err = PH_ERROR_INIT;
    ph_quantity q = {0};
    CHECK_OK(ph_quantity_find(name, &q, &err));
    return q;
}

static double value_of(const ph_quantity *q, const ph_result *r)
{
    ph_error err = PH_ERROR_INIT;
    double x = NAN;
    CHECK_OK(ph_quantity_value(q, r, &x, &err));
    return x;
}

/* What one constant is when it is asked for alone, and of the whole tensor. */
static void check_constant(ph_problem p, const char *name, int loads, double off)
{
    const ph_quantity q = named(name);
    ph_result *all = homogenise(&p);
    p.nconstants = 1;
    p.constants = &q;
    ph_result *one = homogenise(&p);
    if (one && all) {
        CHECK(one->work.loads == loads && one->nloads == loads);
        CHECK(one->converged && one->residual[0] <= p.solver.tolerance);
        CHECK_REL(value_of(&q, one), value_of(&q, all), off);
        CHECK(!one->solved_stresses || one->second_order ||
              one->work.applications == one->work.iterations);
    }
    ph_result_free(&one);
    ph_result_free(&all);
}

/* Random cells of anisotropic phases: every entry couples with every other one. */
static void test_models(void **state)
{
    (void)state;
    static const char *const thick[] = {"E1", "nu31", "G23", "S35"};
    static const char *const plane[] = {"E1", "nu21", "G12", "S26"};
    static const ph_kinematics kinematics[] = {PH_PLANE_STRESS, PH_PLANE_STRAIN,
                                               PH_GENERALISED_STRAIN, PH_SPACE};
    uint64_t seed = check_seed();
    const ph_material two[2] = {anisotropic("a", &seed), isotropic("b", 5, 0.2)};
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < MODELS; k++) {
            ph_kinematics kin = kinematics[i];
            bool space = kin == PH_SPACE;
            ph_microstructure *m =
                voxel_cell(box_grid(kin, 8, 9, space ? 7 : 1, 1, 1.1, space ? 0.9 : 0.1),
                           2, two, &seed);
            const ph_problem p = {
                .micro = m, .model = models[k], .solver = {.tolerance = 1e-11}};
            /* the residual times contrasts of 10 in the phases and as much in shears */
            check_constant(p, ph_strains(kin) == 6 ? thick[k % 4] : plane[k % 4], 1,
                           2e-8);
            ph_microstructure_free(&m);
        }
    CHECK_END();
}

/* Stiff and soft fillers and voids, at the tolerance of everyday: E is an energy, off by the
 * square of the residual times the contrast; so are pairs, above contrast 1000. */
static void test_contrasts(void **state)
{
    (void)state;
    const struct {
        double contrast, off;
        const char *name;
    } of[] = {{1e2, 1e-6, "E1"},   {1e2, 1e-5, "nu12"}, {1e4, 1e-6, "E1"},
              {1e4, 1e-6, "nu12"}, {1e-2, 1e-6, "E1"},  {1e-2, 1e-5, "nu12"},
              {1e-4, 1e-6, "E1"},  {0, 1e-6, "E1"}};
    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        ph_material two[2] = {isotropic("a", 1, 0.3)};
        if (of[i].contrast > 0)
            two[1] = isotropic("b", of[i].contrast, 0.2);
        else
            two[1] = ph_material_void("b");
        ph_inclusion inc[2] = {ball(PH_PLANE_STRAIN, 1, 0.4, 0.55, NAN, 0.2),
                               ball(PH_PLANE_STRAIN, 1, 0.8, 0.15, NAN, 0.12)};
        ph_microstructure *m =
            shapes_cell(box_grid(PH_PLANE_STRAIN, 16, 16, 1, 1, 1, 1), 2, two, 2, inc);
        const ph_problem p = {.micro = m,
                              .solver = {.kind = "fft_cg", .tolerance = 1e-6}};
        bool pair = of[i].name[0] == 'n' && of[i].contrast > 1e3;
        check_constant(p, of[i].name, pair ? 2 : 1, of[i].off);
        ph_microstructure_free(&m);
    }
    CHECK_END();
}

/* A mean stress costs about the iterations of a strain: the iteration is the same, with a mean
 * strain as one more mode. */
static void test_iterations(void **state)
{
    (void)state;
    const ph_quantity q = named("E1");
    for (int i = 0; i < 3; i++) {
        ph_microstructure *m =
            round_cell(PH_PLANE_STRESS, 16, 0.3, isotropic("a", 1, 0.3),
                       isotropic("b",
                                 i == 0   ? 10
                                 : i == 1 ? 1e5
                                          : 1e-3,
                                 0.2));
        m->phase[0] = m->phase[2] = 1; /* no symmetry: strains would be three loads */
        ph_problem p = {.micro = m, .loads = 1};
        ph_result *strain = homogenise(&p);
        p.nconstants = 1;
        p.constants = &q;
        ph_result *stress = homogenise(&p);
        CHECK(stress && stress->solved_stresses == 1 && stress->solved == 0);
        CHECK(stress && strain && stress->iterations[0] <= 2 * strain->iterations[0]);
        ph_result_free(&strain);
        ph_result_free(&stress);
        ph_microstructure_free(&m);
    }
    CHECK_END();
}

/* Routes without it: all loads of the block, the same value. */
static void test_elsewhere(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    const ph_material two[2] = {isotropic("a", 1, 0.25), isotropic("b", 5, 0.25)};
    ph_microstructure *m =
        voxel_cell(box_grid(PH_PLANE_STRAIN, 6, 7, 1, 1, 1, 1), 2, two, &seed);
    const ph_problem p = {.micro = m, .solver = {.tolerance = 1e-9}};
    ph_problem direct = p, relaxed = p, single = p, held = p, free = p, bonds = p;
    direct.solver.kind = "direct";
    relaxed.solver.kind = "relaxation";
    single.solver.precision = "single";
    single.model = models[0];
    held.constraint.kind = "linear_displacement";
    free.constraint.kind = "uniform_traction";
    bonds.model.kind = "bond";
    const ph_problem *of[] = {&direct, &relaxed, &single, &held, &free, &bonds};
    for (int i = 0; i < 6; i++)
        check_constant(*of[i], "E1", 3, 1e-7); /* the same loads: round-off */
    ph_microstructure_free(&m);
    CHECK_END();
}

/* A body in a void, and layers of voids, hold no stress: strains are solved, and a note says
 * so. */
static void test_in_pieces(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_material two[2] = {isotropic("a", 1, 0.3)};
    two[1] = ph_material_void("b");
    ph_microstructure *m = NULL;
    ph_grid g = box_grid(PH_PLANE_STRAIN, 8, 8, 1, 1, 1, 1);
    CHECK_OK(ph_microstructure_new(&g, 2, two, &m, &err));
    for (int i = 0; m && i < 64; i++)
        m->phase[i] = !(i / 8 > 1 && i / 8 < 5 && i % 8 > 1 && i % 8 < 6);
    const ph_quantity q = named("E1");
    const ph_problem p = {.micro = m,
                          .model = {.kind = "local"},
                          .solver = {.kind = "fft_cg", .tolerance = 1e-6},
                          .nconstants = 1,
                          .constants = &q};
    ph_result *r = homogenise(&p);
    double x = 7;
    if (r) {
        CHECK(r->stresses == 0 && r->solved != 0);
        bool said = false;
        for (int i = 0; i < r->nnotes; i++)
            said |= strncmp(r->notes[i], "loads: strains", 14) == 0;
        CHECK(said);
        /* no stiffness is left: no modulus, or one that is round-off */
        CHECK(ph_quantity_value(&q, r, &x, NULL) != PH_OK || fabs(x) < 1e-6);
    }
    ph_result_free(&r);
    ph_microstructure_free(&m);
    CHECK_END();
}

/* The same bits for any number of threads. */
static void test_threads(void **state)
{
    (void)state;
    const ph_quantity q = named("nu12");
    uint64_t seed = check_seed();
    const ph_material two[2] = {isotropic("a", 1, 0.25), isotropic("b", 50, 0.25)};
    for (int k = 0; k < MODELS; k += 2) {
        ph_microstructure *m =
            voxel_cell(box_grid(PH_PLANE_STRAIN, 128, 192, 1, 1, 1, 1), 2, two, &seed);
        const ph_problem p = {.micro = m,
                              .model = models[k],
                              .solver = {.tolerance = 0.1},
                              .nconstants = 1,
                              .constants = &q};
        double x[2] = {0, 1};
        for (int t = 0; t < 2; t++) {
            ph_error err = PH_ERROR_INIT;
            ph_result *r = NULL;
            CHECK_OK(ph_homogenise(&p, &(ph_ctx){.threads = 1 + 2 * t}, &r, &err));
            if (r) x[t] = value_of(&q, r);
            CHECK(r && r->threads == 1 + 2 * t);
            ph_result_free(&r);
        }
        CHECK(x[0] == x[1]);
        ph_microstructure_free(&m);
    }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_models),     cmocka_unit_test(test_contrasts),
        cmocka_unit_test(test_iterations), cmocka_unit_test(test_elsewhere),
        cmocka_unit_test(test_in_pieces),  cmocka_unit_test(test_threads)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
