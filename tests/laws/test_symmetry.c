/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Symmetric cells: loads that follow from others are what solving them gives. `keep_fields`
 * has every load solved, whatever the symmetry. */
#include "solve.h"

/* Blocks of voxels that come again under some turns of the axes, moved by a shift. */
typedef enum pattern {
    NO_SYMMETRY,
    POINT,    /* half turn about axis 3 */
    MIRROR_1, /* mirror across axis 1 */
    CHIRAL,   /* quarter turns about axis 3 */
    SQUARE,   /* and mirrors */
    CUBIC,    /* all of them, in space */
    CYCLIC    /* axes 1 2 3 -> 2 3 1, in space */
} pattern;

static ptrdiff_t mirrored(ptrdiff_t i, ptrdiff_t n)
{
    return i < n - 1 - i ? i : n - 1 - i;
}

static void sort(ptrdiff_t *a, ptrdiff_t *b)
{
    if (*a <= *b) return;
    ptrdiff_t swap = *a;
    *a = *b, *b = swap;
}

/* The first of the places that the pattern makes one of (i, j, k). */
static void first_place(pattern p, ptrdiff_t n, ptrdiff_t at[3])
{
    ptrdiff_t i = at[0], j = at[1], k = at[2], best[3] = {i, j, k};
    if (p == MIRROR_1) best[0] = mirrored(i, n);
    if (p == SQUARE || p == CUBIC) {
        best[0] = mirrored(i, n), best[1] = mirrored(j, n);
        sort(&best[0], &best[1]);
    }
    if (p == CUBIC) {
        best[2] = mirrored(k, n);
        sort(&best[1], &best[2]);
        sort(&best[0], &best[1]);
    }
    for (int turn = 0; turn < 4 && (p == CHIRAL || p == POINT || p == CYCLIC); turn++) {
        ptrdiff_t next[3] = {n - 1 - j, i, k};
        if (p == POINT) next[0] = n - 1 - i, next[1] = n - 1 - j;
        if (p == CYCLIC) next[0] = k, next[1] = i, next[2] = j;
        i = next[0], j = next[1], k = next[2];
        if ((i * n + j) * n + k < (best[0] * n + best[1]) * n + best[2])
            best[0] = i, best[1] = j, best[2] = k;
    }
    memcpy(at, best, sizeof best);
}

static ph_microstructure *patterned(pattern p, ph_kinematics kin, ptrdiff_t n,
                                    const ph_material *two, const ptrdiff_t shift[3],
                                    uint64_t *seed)
{
    ptrdiff_t deep = kin == PH_SPACE ? n : 1;
    ph_microstructure *m = voxel_cell(
        box_grid(kin, n, n, deep, 1, 1, kin == PH_SPACE ? 1 : 1.0 / 3), 2, two, seed);
    uint16_t *phase = malloc((size_t)(n * n * deep) * sizeof *phase);
    memcpy(phase, m->phase, (size_t)(n * n * deep) * sizeof *phase);
    for (ptrdiff_t x = 0; x < n * n * deep; x++) {
        ptrdiff_t at[3] = {x / deep / n, x / deep % n, x % deep};
        ptrdiff_t to = ((at[0] + shift[0]) % n * n + (at[1] + shift[1]) % n) * deep +
                       (at[2] + shift[2]) % deep;
        first_place(p, n, at);
        m->phase[to] = phase[(at[0] * n + at[1]) * deep + at[2]];
    }
    free(phase);
    return m;
}

/* All loads solved, and those that are needed; the same number of each pattern. */
static void check_pattern(pattern p, ph_kinematics kin, const ph_model_params *model,
                          const ph_material *two, int needed, uint64_t *seed)
{
    const ptrdiff_t shift[3] = {2, 5, kin == PH_SPACE ? 3 : 0};
    ph_microstructure *m = patterned(p, kin, 8, two, shift, seed);
    ph_problem problem = {.micro = m, .model = *model, .solver = {.tolerance = 1e-10}};
    ph_result *few = homogenise(&problem);
    problem.keep_fields = true;
    ph_result *all = homogenise(&problem);
    if (few && all) {
        const int ns = few->stiffness.n;
        CHECK(all->work.loads == ns && few->work.loads == needed);
        CHECK(few->nloads == needed && few->loads == all->loads);
        /* the residual 1e-10 leaves an error of that times the contrast of 20 */
        CHECK(difference(&few->stiffness, &all->stiffness) < 2e-9);
        for (int i = 0; i < ns; i++)
            for (int j = 0; j < i; j++)
                CHECK(few->stiffness.m[i][j] == few->stiffness.m[j][i]);
    }
    ph_result_free(&few);
    ph_result_free(&all);
    ph_microstructure_free(&m);
}

static const ph_model_params models[] = {
    {.kind = "local"},
    {.kind = "nosb", .points = PH_POINTS_STRESS},
    {.kind = "nosb", .points = PH_POINTS_STRESS, .stabilisation = PH_STABILISE_SUBPOINT},
    {.kind = "nosb", .points = PH_POINTS_NODES, .horizon = 1.5},
    {.kind = "nosb", .points = PH_POINTS_NODES, .horizon = 3},
};
enum { MODELS = sizeof models / sizeof *models };

/* Load 22 follows from 11, 13 from 23, in a plane; mirrors alone only make zeros. */
static void test_plane(void **state)
{
    (void)state;
    static const struct {
        pattern p;
        int plane, generalised;
    } need[] = {{NO_SYMMETRY, 3, 6},
                {POINT, 3, 6},
                {MIRROR_1, 3, 6},
                {CHIRAL, 2, 4},
                {SQUARE, 2, 4}};
    uint64_t seed = check_seed();
    const ph_material two[2] = {isotropic("a", 1, 0.3), isotropic("b", 20, 0.2)};
    for (int i = 0; i < 5; i++)
        for (int k = 0; k < MODELS; k++) {
            ph_kinematics kin = k % 2 ? PH_PLANE_STRAIN : PH_PLANE_STRESS;
            check_pattern(need[i].p, kin, &models[k], two, need[i].plane, &seed);
            check_pattern(need[i].p, PH_GENERALISED_STRAIN, &models[k], two,
                          need[i].generalised, &seed);
        }
    CHECK_END();
}

static void test_space(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    const ph_material two[2] = {isotropic("a", 1, 0.3), isotropic("b", 20, 0.2)};
    for (int k = 0; k < MODELS; k++) {
        check_pattern(CUBIC, PH_SPACE, &models[k], two, 2, &seed);
        check_pattern(CYCLIC, PH_SPACE, &models[k], two, 2, &seed);
        check_pattern(CHIRAL, PH_SPACE, &models[k], two, 4, &seed);
        check_pattern(SQUARE, PH_SPACE, &models[k], two, 4, &seed);
        check_pattern(NO_SYMMETRY, PH_SPACE, &models[k], two, 6, &seed);
    }
    CHECK_END();
}

/* A phase without the symmetry of the geometry takes it away; an orthotropic phase keeps the
 * mirrors, and with equal axes 1 and 2 the quarter turns. */
static void test_anisotropic_phases(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    double c[36] = {0};
    ph_material two[2] = {isotropic("a", 1, 0.3), anisotropic("b", &seed)};
    check_pattern(SQUARE, PH_GENERALISED_STRAIN, &models[1], two, 6, &seed);
    check_pattern(CUBIC, PH_SPACE, &models[1], two, 6, &seed);
    for (int i = 0; i < 6; i++)
        c[7 * i] = i == 2 ? 9 : i < 3 ? 5 : i == 5 ? 1 : 2;
    CHECK_OK(ph_material_anisotropic("tetragonal", c, NULL, &two[1], &err));
    check_pattern(SQUARE, PH_GENERALISED_STRAIN, &models[1], two, 4, &seed);
    check_pattern(CUBIC, PH_SPACE, &models[1], two, 4, &seed);
    c[0] = 6;
    CHECK_OK(ph_material_anisotropic("orthotropic", c, NULL, &two[1], &err));
    check_pattern(SQUARE, PH_GENERALISED_STRAIN, &models[1], two, 6, &seed);
    CHECK_END();
}

/* Drawn shapes, whose interfaces cut the cells. */
static void test_drawn(void **state)
{
    (void)state;
    ph_material a = isotropic("a", 1, 0.3), b = isotropic("b", 20, 0.2);
    for (int i = 0; i < 3; i++) {
        ph_kinematics kin = i == 2 ? PH_SPACE
                            : i    ? PH_GENERALISED_STRAIN
                                   : PH_PLANE_STRESS;
        ph_microstructure *m = round_cell(kin, 10, 0.2, a, b);
        ph_problem p = {.micro = m, .solver = {.tolerance = 1e-10}};
        ph_result *few = homogenise(&p);
        p.keep_fields = true;
        ph_result *all = homogenise(&p);
        CHECK(few && few->work.loads == (i == 1 ? 4 : 2));
        /* shares of cut cells are computed to 1e-11 */
        CHECK(few && all && difference(&few->stiffness, &all->stiffness) < 2e-9);
        ph_result_free(&few);
        ph_result_free(&all);
        ph_microstructure_free(&m);
    }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_plane), cmocka_unit_test(test_space),
        cmocka_unit_test(test_anisotropic_phases), cmocka_unit_test(test_drawn)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
