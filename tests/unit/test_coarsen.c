/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Voxels by twos: nothing of any phase is lost, and normals point out of it. */
#include "check.h"
#include "companion.h"

enum { PHASES = 3 };

static ph_microstructure *voxels(ph_kinematics kin, const ptrdiff_t n[3])
{
    ph_error err = PH_ERROR_INIT;
    ph_material m[PHASES];
    ph_microstructure *micro = NULL;
    ph_grid grid;
    const double size[3] = {1, 2, 3};
    for (int i = 0; i < PHASES; i++)
        CHECK_OK(ph_material_isotropic("m", 1 + i, 0.3, &m[i], &err));
    CHECK_OK(ph_grid_init(&grid, kin, n, size, &err));
    CHECK_OK(ph_microstructure_new(&grid, PHASES, m, &micro, &err));
    return micro;
}

/* Shares of every phase, cuts counted, are the same: exactly eighths, to rounding. */
static void test_shares(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    for (int trial = 0; trial < 8; trial++) {
        ph_kinematics kin = trial % 2 ? PH_SPACE : PH_PLANE_STRAIN;
        const ptrdiff_t n[3] = {8, 6, kin == PH_SPACE ? 4 : 1};
        ph_microstructure *fine = voxels(kin, n), *coarse = NULL;
        double before[PHASES], after[PHASES];
        for (ptrdiff_t x = 0; x < ph_grid_cells(&fine->grid); x++)
            fine->phase[x] = (uint16_t)(PHASES * check_random(&seed));
        CHECK_OK(ph_i_coarsen(fine, &coarse, &err));
        CHECK_OK(ph_microstructure_check(coarse, &err));
        CHECK(coarse->grid.n[0] == 4 && coarse->grid.n[1] == 3 && coarse->ncuts > 0);
        CHECK(coarse->grid.n[2] == (kin == PH_SPACE ? 2 : 1));
        ph_microstructure_fractions(fine, before);
        ph_microstructure_fractions(coarse, after);
        for (int i = 0; i < PHASES; i++)
            CHECK_ABS(after[i], before[i], 1e-14);
        ph_microstructure_free(&fine);
        ph_microstructure_free(&coarse);
    }
    CHECK_END();
}

/* A face of phase 1 in the middle of a block, and the corner of a checkerboard. */
static void test_normals(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    const ptrdiff_t n[3] = {4, 2, 1};
    ph_microstructure *fine = voxels(PH_PLANE_STRAIN, n), *coarse = NULL;
    /* [x][y]: the columns x = 0 | 0 1 | and a corner: 1 at x = 2, y = 0 */
    fine->phase[2] = fine->phase[3] = 1;
    fine->phase[4] = 1;
    CHECK_OK(ph_i_coarsen(fine, &coarse, &err));
    CHECK(coarse->ncuts == 2);
    if (coarse->ncuts == 2) {
        const ph_cut *a = &coarse->cuts[0], *b = &coarse->cuts[1];
        CHECK(a->cell == 0 && a->base == 0 && a->material == 1 && a->fraction == 0.5);
        CHECK_ABS(a->normal[0], -1, 1e-15); /* 1 lies to the right */
        CHECK_ABS(a->normal[1], 0, 1e-15);
        CHECK(b->cell == 1 && b->base == 0 && b->fraction == 0.25);
        CHECK_ABS(b->normal[0], sqrt(0.5), 1e-15); /* 1 lies below, to the left */
        CHECK_ABS(b->normal[1], sqrt(0.5), 1e-15);
    }
    ph_microstructure_free(&fine);
    ph_microstructure_free(&coarse);
    CHECK_END();
}

static void test_odd_numbers(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    const ptrdiff_t n[3] = {4, 5, 1};
    ph_microstructure *fine = voxels(PH_PLANE_STRAIN, n), *coarse = NULL;
    CHECK(ph_i_coarsen(fine, &coarse, &err) == PH_EINVAL && !coarse);
    CHECK(strstr(err.msg, "5 voxels along axis 2"));
    ph_microstructure_free(&fine);
    ph_case c = {.nodes = {5, 2, 1}};
    ptrdiff_t nodes[3];
    double ratio = 0;
    /* of shapes it is the nearest: 3 of 5; 1 of 2 shows nothing */
    CHECK(ph_rve_companion_nodes(&c, nodes, &ratio));
    c.nodes[1] = 6;
    CHECK(!ph_rve_companion_nodes(&c, nodes, &ratio));
    CHECK(nodes[0] == 3 && nodes[1] == 3 && nodes[2] == 1);
    CHECK_REL(ratio, sqrt(5.0 / 3 * 2), 1e-14);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shares),
        cmocka_unit_test(test_normals),
        cmocka_unit_test(test_odd_numbers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
