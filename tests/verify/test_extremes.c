/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Far ends of every parameter: a right number or a clear error, never a hang or a NaN. The
 * measured table is docs/theory/extremes.md, made by tests/verify/extremes_table.c. */
#include "solve.h"

static ph_material solid(double E)
{
    return isotropic("solid", E, 0.3);
}

/* Runs anything: the status; numbers, if any, are finite and within the bounds. Both bounds
 * are exact laws of the operator, so they are the reference that never runs out. */
static ph_status outcome(ph_microstructure *m, ph_problem p, ph_sym4 *c, int *iterations)
{
    ph_error err = PH_ERROR_INIT;
    ph_result *res = NULL;
    p.micro = m;
    ph_status st = m ? ph_homogenise(&p, &one_thread, &res, &err) : PH_EINTERNAL;
    if (st != PH_OK) CHECK(err.msg[0] != 0);
    if (st == PH_OK) {
        double norm = ph_sym4_norm(&res->voigt);
        *c = res->stiffness;
        *iterations = most_iterations(res);
        CHECK(isfinite(ph_sym4_norm(c)));
        CHECK(gap(&res->voigt, c) > -1e-5);
        if (!res->reuss_is_zero)
            CHECK(gap(c, &res->reuss) * ph_sym4_norm(&res->reuss) >
                  -1e-5 * fmin(norm, ph_sym4_norm(c)));
    }
    ph_result_free(&res);
    ph_microstructure_free(&m);
    return st;
}

/* Contrast 1e-6 .. 1e6 of an inclusion, phases by node centre, all choices automatic: at most
 * 40 iterations on any grid, and beyond 1e4 the numbers are those of a hole or a rigid body
 * (the difference is of the order of the inverse contrast; the tolerance is the solver's
 * 1e-6 times the contrast for what is off the diagonal, so the diagonal is compared). */
static void check_contrast(ph_kinematics kin, ptrdiff_t n, double fraction)
{
    ph_problem p = {.interface = PH_INTERFACE_NODE_CENTRE};
    for (int side = -1; side <= 1; side += 2) {
        double far[2] = {0, 0};
        for (int e = 2; e <= 6; e += 2) {
            ph_sym4 c = {.n = 0};
            int iterations = 1000;
            ph_microstructure *m =
                round_cell(kin, n, fraction, solid(1), solid(pow(10, side * e)));
            CHECK(outcome(m, p, &c, &iterations) == PH_OK);
            CHECK(iterations <= 40);
            if (e > 2) far[e == 6] = c.m[0][0];
        }
        CHECK_REL(far[1], far[0], 2e-3);
    }
}

static void test_contrast(void **state)
{
    (void)state;
    check_contrast(PH_PLANE_STRAIN, 16, 0.4);
    check_contrast(PH_PLANE_STRESS, 64, 0.4);
    check_contrast(PH_PLANE_STRAIN, 128, 0.4);
    check_contrast(PH_SPACE, 16, 0.3);
    CHECK_END();
}

/* Contrast 1e12: what a residual of 1e-6 leaves in the stiff phase hides the answer. Said, not
 * hidden. At 1e6 the energies of pairs of fields give the answer to the square of that, so
 * that 1e-6 and 1e-10 agree to 1e-3; with a tolerance to match 1e6 and 1e8 agree. */
static void test_hidden_error(void **state)
{
    (void)state;
    ph_sym4 c = {.n = 0}, d = {.n = 0};
    int iterations;
    ph_problem p = {.interface = PH_INTERFACE_NODE_CENTRE};
    ph_microstructure *m = round_cell(PH_PLANE_STRAIN, 32, 0.3, solid(1), solid(1e12));
    CHECK(outcome(m, p, &c, &iterations) == PH_ENOCONV);
    m = round_cell(PH_PLANE_STRAIN, 32, 0.3, solid(1), solid(1e6));
    CHECK(outcome(m, p, &c, &iterations) == PH_OK);
    p.solver.tolerance = 1e-10;
    m = round_cell(PH_PLANE_STRAIN, 32, 0.3, solid(1), solid(1e6));
    CHECK(outcome(m, p, &d, &iterations) == PH_OK);
    CHECK(difference(&c, &d) < 1e-3);
    m = round_cell(PH_PLANE_STRAIN, 32, 0.3, solid(1), solid(1e8));
    CHECK(outcome(m, p, &c, &iterations) == PH_OK);
    CHECK(difference(&c, &d) < 1e-4);
    CHECK_END();
}

/* A loose tolerance t costs its square only, in every entry: the energy that is left is at most
 * the condition number, here the contrast 25, times t^2 of that of the fluctuation, which is
 * at most the stiffness. From averages of stress the couplings would be off by t. */
static void test_loose_tolerance(void **state)
{
    (void)state;
    uint64_t seed = 7;
    ph_material material[2] = {solid(1), solid(25)};
    ph_microstructure *m =
        voxel_cell(box_grid(PH_PLANE_STRAIN, 24, 24, 1, 1, 1, 1), 2, material, &seed);
    ph_problem p = {.micro = m, .solver.tolerance = 1e-10};
    ph_sym4 tight = stiffness_of(&p);
    for (double t = 1e-1; t > 5e-4; t *= 0.1) {
        p.solver.tolerance = t;
        ph_sym4 loose = stiffness_of(&p);
        CHECK(difference(&loose, &tight) < 25 * t * t);
    }
    ph_microstructure_free(&m);
    CHECK_END();
}

/* Poisson ratios from -0.9 to 0.499999 of matrix, inclusion or both. Near 1/2 the shear
 * moduli tend to a limit (no locking): 0.499 and 0.499999 differ by 1 % of it at most. */
static void test_poisson(void **state)
{
    (void)state;
    static const double nu[] = {-0.9, -0.5, 0.0, 0.49, 0.499, 0.499999};
    for (int where = 0; where < 3; where++) {
        double shear[2] = {0, 0};
        for (int i = 0; i < 6; i++) {
            ph_sym4 c = {.n = 3};
            int iterations;
            ph_material matrix = isotropic("matrix", 1, where != 1 ? nu[i] : 0.3);
            ph_material inside = isotropic("inside", 10, where != 0 ? nu[i] : 0.3);
            ph_problem p = {.interface = PH_INTERFACE_COMPOSITE};
            ph_microstructure *m = round_cell(PH_PLANE_STRAIN, 32, 0.3, matrix, inside);
            ph_status st = outcome(m, p, &c, &iterations);
            CHECK(st == PH_OK);
            CHECK(iterations <=
                  400); /* 351: incompressible inclusion in an ordinary matrix */
            if (i >= 4) shear[i - 4] = c.m[2][2];
        }
        CHECK_REL(shear[1], shear[0], 0.01);
    }
    CHECK_END();
}

/* Grids of one, two, three, odd and prime numbers of cells, over the models: bounds, or what
 * is wrong with the horizon. Where one axis only varies, the laminate is exact. */
static void test_grids(void **state)
{
    (void)state;
    static const ptrdiff_t n[][3] = {{1, 9, 1}, {9, 1, 1}, {1, 1, 1},  {2, 2, 1},
                                     {2, 9, 1}, {3, 3, 1}, {7, 11, 1}, {13, 2, 1},
                                     {1, 1, 9}, {2, 2, 2}, {1, 7, 3},  {2, 1, 5}};
    uint64_t seed = check_seed();
    ph_material two[2] = {solid(1), solid(10)};
    for (int i = 0; i < 12; i++)
        for (int model = 0; model < 4; model++) {
            ph_sym4 c;
            int iterations;
            ph_problem p = {.micro = NULL};
            if (model == 0) p.model.kind = "local";
            p.model.points = model == 2   ? PH_POINTS_STRESS
                             : model == 3 ? PH_POINTS_NODES
                                          : PH_POINTS_AUTO;
            ph_grid g = box_grid(n[i][2] > 1 ? PH_SPACE : PH_PLANE_STRAIN, n[i][0],
                                 n[i][1], n[i][2], 1, 1, 1);
            ph_status st = outcome(voxel_cell(g, 2, two, &seed), p, &c, &iterations);
            CHECK(st == PH_OK || (model == 3 && st == PH_EINVAL));
        }
    CHECK_END();
}

/* Horizons from one spacing to half the box; more is refused. */
static void test_horizons(void **state)
{
    (void)state;
    for (int points = 0; points < 2; points++)
        for (double horizon = 1; horizon < 10; horizon += 1.75) {
            ph_sym4 c;
            int iterations;
            ph_problem p = {.micro = NULL};
            p.model.points = points ? PH_POINTS_STRESS : PH_POINTS_NODES;
            p.model.horizon = horizon;
            ph_microstructure *m =
                round_cell(PH_PLANE_STRAIN, 16, 0.3, solid(1), solid(10));
            ph_status st = outcome(m, p, &c, &iterations);
            CHECK(st == (horizon > 8 ? PH_EINVAL : PH_OK));
        }
    CHECK_END();
}

/* One cell, or one row of cells, of another phase, at any contrast; fractions 0 and 1. A row
 * is a laminate. */
static void test_small_inclusions(void **state)
{
    (void)state;
    for (int e = -6; e <= 6; e += 3)
        for (int row = 0; row < 2; row++) {
            ph_error err = PH_ERROR_INIT;
            ph_material two[2] = {solid(1), solid(pow(10, e))};
            ph_grid g = box_grid(PH_PLANE_STRAIN, 16, 16, 1, 1, 1, 1);
            ph_microstructure *m = NULL;
            ph_sym4 c = {.n = 3}, a, b, want;
            double normal[3] = {1, 0, 0};
            int iterations;
            CHECK_OK(ph_microstructure_new(&g, 2, two, &m, &err));
            for (int j = 0; j < (row ? 16 : 1); j++)
                m->phase[7 * 16 + j] = 1;
            ph_problem p = {.micro = NULL};
            p.model.points = PH_POINTS_STRESS;
            CHECK(outcome(m, p, &c, &iterations) == PH_OK);
            CHECK(iterations <= 40);
            if (!row) continue;
            CHECK_OK(ph_sym4_reduce(&two[0].stiffness, PH_PLANE_STRAIN, &a, &err));
            CHECK_OK(ph_sym4_reduce(&two[1].stiffness, PH_PLANE_STRAIN, &b, &err));
            CHECK_OK(ph_sym4_laminate(&a, &b, 1.0 / 16, normal, &want, &err));
            CHECK(difference(&c, &want) < 1e-6);
        }
    for (int full = 0; full < 2; full++) {
        ph_sym4 c = {.n = 3}, want;
        ph_error err = PH_ERROR_INIT;
        int iterations = 1;
        ph_material two[2] = {solid(1), solid(5)};
        ph_grid g = box_grid(PH_PLANE_STRAIN, 8, 8, 1, 1, 1, 1);
        ph_inclusion all = blank_inclusion("layer", 1);
        all.normal = 1;
        all.from = 0;
        all.to = 1;
        ph_problem p = {.micro = NULL};
        CHECK(outcome(shapes_cell(g, 2, two, full, &all), p, &c, &iterations) == PH_OK);
        CHECK(iterations == 0);
        CHECK_OK(ph_sym4_reduce(&two[full].stiffness, PH_PLANE_STRAIN, &want, &err));
        CHECK(difference(&c, &want) < 1e-14);
    }
    CHECK_END();
}

/* Voids: a layer of nothing leaves no stiffness across and plane stress along; an isolated
 * body has none at all; nothing anywhere is an error; a torn body cannot be pulled. */
static void test_voids(void **state)
{
    (void)state;
    ph_sym4 c = {.n = 3}, want;
    ph_error err = PH_ERROR_INIT;
    int iterations;
    ph_problem p = {.micro = NULL};
    ph_material two[2] = {solid(1), ph_material_void("void")};
    ph_grid g = box_grid(PH_PLANE_STRAIN, 16, 16, 1, 1, 1, 1);
    ph_inclusion gap_layer = blank_inclusion("layer", 1);
    gap_layer.normal = 1;
    gap_layer.from = 0.25;
    gap_layer.to = 0.5;
    CHECK(outcome(shapes_cell(g, 2, two, 1, &gap_layer), p, &c, &iterations) == PH_OK);
    CHECK_OK(ph_sym4_reduce(&two[0].stiffness, PH_PLANE_STRAIN, &want, &err));
    CHECK_ABS(c.m[0][0], 0.0, 1e-10);
    CHECK_ABS(c.m[2][2], 0.0, 1e-10);
    CHECK_REL(c.m[1][1],
              0.75 * (want.m[1][1] - want.m[0][1] * want.m[0][1] / want.m[0][0]), 1e-10);
    ph_microstructure *alone = round_cell(PH_PLANE_STRAIN, 16, 0.3, two[1], two[0]);
    CHECK(outcome(alone, p, &c, &iterations) == PH_OK);
    CHECK(ph_sym4_norm(&c) < 1e-6);
    ph_microstructure *nothing = round_cell(PH_PLANE_STRAIN, 16, 0.3, two[1], two[1]);
    CHECK(outcome(nothing, p, &c, &iterations) == PH_EUNPHYSICAL);
    p.constraint.kind = "uniform_traction";
    p.solver.max_iterations = 300;
    ph_status st = outcome(shapes_cell(g, 2, two, 1, &gap_layer), p, &c, &iterations);
    CHECK(st == PH_ESINGULAR || st == PH_ENOCONV);
    CHECK_END();
}

/* Cells ten times longer than wide. */
static void test_spacing(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_material two[2] = {solid(1), solid(10)};
    for (int deep = 0; deep < 2; deep++) {
        ph_sym4 c;
        int iterations;
        ph_problem p = {.micro = NULL};
        ph_grid g = deep ? box_grid(PH_SPACE, 6, 7, 5, 1, 10, 3)
                         : box_grid(PH_PLANE_STRAIN, 16, 16, 1, 1, 10, 1);
        CHECK(outcome(voxel_cell(g, 2, two, &seed), p, &c, &iterations) == PH_OK);
        CHECK(iterations <= 40);
    }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_contrast),
                                       cmocka_unit_test(test_hidden_error),
                                       cmocka_unit_test(test_loose_tolerance),
                                       cmocka_unit_test(test_poisson),
                                       cmocka_unit_test(test_grids),
                                       cmocka_unit_test(test_horizons),
                                       cmocka_unit_test(test_small_inclusions),
                                       cmocka_unit_test(test_voids),
                                       cmocka_unit_test(test_spacing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
