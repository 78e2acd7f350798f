/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Voxels on other grids: nothing of any phase is lost, and normals point out of it. */
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

/* Shares of every phase, cuts counted, are the same to rounding: by twos, where odd numbers are
 * halved and rounded up, and on grids between half and all. */
static void test_shares(void **state)
{
    (void)state;
    static const ptrdiff_t sizes[][6] = {
        {8, 6, 4, 4, 3, 2}, {7, 9, 5, 4, 5, 3}, {8, 7, 3, 6, 7, 2}};
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    for (int trial = 0; trial < 12; trial++) {
        ph_kinematics kin = trial % 2 ? PH_SPACE : PH_PLANE_STRAIN;
        const ptrdiff_t *s = sizes[trial / 2 % 3];
        const ptrdiff_t n[3] = {s[0], s[1], kin == PH_SPACE ? s[2] : 1},
                        to[3] = {s[3], s[4], kin == PH_SPACE ? s[5] : 1};
        ph_microstructure *fine = voxels(kin, n), *coarse = NULL;
        double before[PHASES], after[PHASES];
        for (ptrdiff_t x = 0; x < ph_grid_cells(&fine->grid); x++)
            fine->phase[x] = (uint16_t)(PHASES * check_random(&seed));
        CHECK_OK(ph_i_coarsen(fine, to, &coarse, &err));
        if (!coarse) break;
        CHECK_OK(ph_microstructure_check(coarse, &err));
        CHECK(memcmp(coarse->grid.n, to, sizeof to) == 0 && coarse->ncuts > 0);
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
    const ptrdiff_t half[3] = {2, 1, 1};
    CHECK_OK(ph_i_coarsen(fine, half, &coarse, &err));
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

/* Three voxels on two cells: a cell has one and a half, by hand. */
static void test_odd_numbers(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    const ptrdiff_t n[3] = {3, 3, 1}, to[3] = {2, 2, 1}, few[3] = {1, 2, 1};
    ph_microstructure *fine = voxels(PH_PLANE_STRAIN, n), *coarse = NULL;
    fine->phase[0] = 1; /* all of it in the first cell, whose area is 9/4 */
    fine->phase[4] = 2; /* the middle: a quarter in every cell */
    CHECK_OK(ph_i_coarsen(fine, to, &coarse, &err));
    CHECK(coarse && coarse->ncuts == 5);
    if (coarse && coarse->ncuts == 5) {
        const ph_cut *a = &coarse->cuts[0], *b = &coarse->cuts[1], *c = &coarse->cuts[2];
        CHECK(a->cell == 0 && b->cell == 0 && c->cell == 1 && b->base == -1);
        CHECK_REL(b->fraction, 1.0 / 9, 1e-14);
        CHECK_REL(a->fraction * (1 - b->fraction), 4.0 / 9, 1e-14);
        CHECK_REL(c->fraction, 1.0 / 9, 1e-14);
        CHECK_REL(c->normal[0], -sqrt(0.5), 1e-14); /* the middle is right, */
        CHECK_REL(c->normal[1], sqrt(0.5), 1e-14);  /* and below of cell 1 */
    }
    ph_microstructure_free(&coarse);
    CHECK(ph_i_coarsen(fine, few, &coarse, &err) == PH_EINVAL && !coarse);
    CHECK(strstr(err.msg, "3 voxels along axis 1 on 1 cells"));
    ph_microstructure_free(&fine);
    /* grids of cases: the nearest, 3 of 5; 1 of 2 shows nothing */
    ph_case c = {.nodes = {5, 2, 1}};
    ptrdiff_t nodes[3];
    double ratio = 0;
    CHECK(ph_rve_companion_nodes(&c, nodes, &ratio));
    c.nodes[1] = 6;
    CHECK(!ph_rve_companion_nodes(&c, nodes, &ratio));
    CHECK(nodes[0] == 3 && nodes[1] == 3 && nodes[2] == 1);
    CHECK_REL(ratio, sqrt(5.0 / 3 * 2), 1e-14);
    CHECK_END();
}

/* By twos: the same picture, with its owners. */
static void test_refined(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    const ptrdiff_t n[3] = {2, 3, 1}, half[3] = {2, 3, 1};
    ph_microstructure *m = voxels(PH_PLANE_STRAIN, n), *fine = NULL, *back = NULL;
    m->owner = calloc(6, sizeof *m->owner);
    for (int i = 0; i < 6; i++) {
        m->phase[i] = (uint16_t)(i % PHASES);
        if (m->owner) m->owner[i] = i;
    }
    CHECK_OK(ph_i_refine(m, &fine, &err));
    CHECK(fine && fine->grid.n[0] == 4 && fine->grid.n[1] == 6 && fine->grid.n[2] == 1);
    if (fine && fine->owner) {
        CHECK(fine->owner[1 * 6 + 5] == 2 && fine->owner[2 * 6 + 1] == 3);
        CHECK_OK(ph_i_coarsen(fine, half, &back, &err));
        CHECK(back && back->ncuts == 0 && memcmp(back->phase, m->phase, 12) == 0);
    }
    ph_microstructure_free(&back);
    ph_microstructure_free(&fine);
    ph_microstructure_free(&m);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shares),
        cmocka_unit_test(test_normals),
        cmocka_unit_test(test_odd_numbers),
        cmocka_unit_test(test_refined),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
