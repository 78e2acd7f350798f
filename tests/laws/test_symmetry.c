/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Symmetric cells: loads and fields that follow from others are what solving them gives. With one
 * cell off by 1e-7 in all directions there is no symmetry any more, so that every load is
 * solved. */
#include "solve.h"

/* Blocks of voxels that come again under some turns of the axes, moved by a shift. */
typedef enum pattern {
    NO_SYMMETRY,
    POINT,    /* half turn about axis 3 */
    MIRROR_1, /* mirror across axis 1 */
    DIAGONAL, /* mirror that makes axis 1 of minus axis 2 */
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
    if (p == DIAGONAL && n - 1 - j < i) best[0] = n - 1 - j, best[1] = n - 1 - i;
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
                                    const ph_material *three, const ptrdiff_t shift[3],
                                    uint64_t *seed)
{
    ptrdiff_t deep = kin == PH_SPACE ? n : 1;
    ph_microstructure *m = voxel_cell(
        box_grid(kin, n, n, deep, 1, 1, kin == PH_SPACE ? 1 : 1.0 / 3), 3, three, seed);
    uint16_t *phase = malloc((size_t)(n * n * deep) * sizeof *phase);
    for (ptrdiff_t x = 0; x < n * n * deep; x++)
        phase[x] = check_random(seed) < 0.5; /* the third one spoils, later */
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

/* Three materials: the third is the first again, but for 1e-7. */
typedef struct trio {
    ph_material of[3];
} trio;

static trio with_third(ph_material a, ph_material b)
{
    ph_error err = PH_ERROR_INIT;
    trio t = {{a, b, a}};
    double voigt[36];
    uint64_t seed = 7;
    ph_sym4 c = random_stiffness(&seed, 6);
    c = ph_sym4_combine(1, &a.stiffness, 1e-7 / ph_sym4_norm(&c), &c);
    ph_sym4_to_voigt(&c, true, voigt);
    CHECK_OK(ph_material_anisotropic("c", voigt, NULL, &t.of[2], &err));
    return t;
}

static double field_difference(ptrdiff_t n, const double *a, const double *b)
{
    double off = 0, size = 0;
    for (ptrdiff_t x = 0; x < n; x++)
        off += (a[x] - b[x]) * (a[x] - b[x]), size += b[x] * b[x];
    return sqrt(off / size);
}

/* `all` with every load solved: a cell is spoiled for the time of it. */
typedef struct pair {
    ph_result *few, *all;
} pair;

static pair solve_both(ph_problem p, ph_microstructure *m)
{
    pair r = {0};
    ptrdiff_t x = 0;
    while (x < ph_grid_cells(&m->grid) - 1 && m->phase[x] != 0)
        x++;
    p.micro = m;
    r.few = homogenise(&p);
    uint16_t was = m->phase[x];
    m->phase[x] = 2;
    r.all = homogenise(&p);
    m->phase[x] = was;
    return r;
}

static void check_symmetric(const ph_sym4 *c)
{
    for (int i = 0; i < c->n; i++)
        for (int j = 0; j < i; j++)
            CHECK(c->m[i][j] == c->m[j][i]);
}

static void check_loads(const pair *r, int needed)
{
    if (!r->few || !r->all) return;
    const int ns = r->few->stiffness.n;
    CHECK(r->all->work.loads == ns && r->few->work.loads == needed);
    CHECK(r->few->nloads == needed && r->few->loads == r->all->loads);
    check_symmetric(&r->few->stiffness);
}

static void free_both(pair *r)
{
    ph_result_free(&r->few);
    ph_result_free(&r->all);
}

/* All loads solved, and those that are needed; the same number of each pattern. */
static void check_pattern(pattern p, ph_kinematics kin, const ph_model_params *model,
                          const ph_material *two, int needed, uint64_t *seed)
{
    const ptrdiff_t shift[3] = {2, 5, kin == PH_SPACE ? 3 : 0};
    const trio t = with_third(two[0], two[1]);
    ph_microstructure *m = patterned(p, kin, 8, t.of, shift, seed);
    const ph_problem problem = {.model = *model, .solver = {.tolerance = 1e-10}};
    pair r = solve_both(problem, m);
    check_loads(&r, needed);
    /* the residual 1e-10 leaves an error of that times the contrast of 20; one cell of 64 is
     * off by 1e-7, in strains of a few times the mean */
    if (r.few && r.all) CHECK(difference(&r.few->stiffness, &r.all->stiffness) < 1e-8);
    free_both(&r);
    ph_microstructure_free(&m);
}

/* A ball in the middle. */
static ph_microstructure *disk_of_three(ph_kinematics kin, trio *t)
{
    ph_inclusion inc = ball(kin, 1, 0.5, 0.5, 0.5, NAN);
    inc.fraction = 0.2;
    return shapes_cell(box_grid(kin, 10, 10, kin == PH_SPACE ? 10 : 1, 1, 1, 1), 3, t->of,
                       1, &inc);
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
    } need[] = {{NO_SYMMETRY, 3, 6}, {POINT, 3, 6},  {MIRROR_1, 3, 6},
                {DIAGONAL, 2, 4},    {CHIRAL, 2, 4}, {SQUARE, 2, 4}};
    uint64_t seed = check_seed();
    const ph_material two[2] = {isotropic("a", 1, 0.3), isotropic("b", 20, 0.2)};
    for (int i = 0; i < 6; i++)
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
    trio t = with_third(isotropic("a", 1, 0.3), isotropic("b", 20, 0.2));
    for (int i = 0; i < 3; i++) {
        ph_kinematics kin = i == 2 ? PH_SPACE
                            : i    ? PH_GENERALISED_STRAIN
                                   : PH_PLANE_STRESS;
        ph_microstructure *m = disk_of_three(kin, &t);
        pair r = solve_both((ph_problem){.solver = {.tolerance = 1e-10}}, m);
        check_loads(&r, i == 1 ? 4 : 2);
        /* shares of cut cells are computed to 1e-11 */
        if (r.few && r.all)
            CHECK(difference(&r.few->stiffness, &r.all->stiffness) < 1e-8);
        free_both(&r);
        ph_microstructure_free(&m);
    }
    CHECK_END();
}

/* Displacements are those of the load that is solved, turned. */
static void test_fields(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    trio t = with_third(isotropic("a", 1, 0.3), isotropic("b", 20, 0.2));
    const struct {
        pattern p;
        ph_kinematics kin;
        int needed;
    } of[] = {{CHIRAL, PH_PLANE_STRESS, 2},
              {CHIRAL, PH_GENERALISED_STRAIN, 4},
              {DIAGONAL, PH_GENERALISED_STRAIN, 4}, /* 13 is minus 23 */
              {CYCLIC, PH_SPACE, 2},
              {CUBIC, PH_SPACE, 2}};
    for (int i = 0; i < 5; i++)
        for (int k = 0; k < MODELS; k++) {
            const ptrdiff_t shift[3] = {1, 6, of[i].kin == PH_SPACE ? 3 : 0};
            ph_microstructure *m = patterned(of[i].p, of[i].kin, 8, t.of, shift, &seed);
            const ph_problem p = {
                .model = models[k], .solver = {.tolerance = 1e-10}, .keep_fields = true};
            pair r = solve_both(p, m);
            check_loads(&r, of[i].needed);
            CHECK(r.few && r.all && r.few->nfields == r.all->nfields);
            for (int a = 0; r.few && r.all && a < r.all->nfields; a++) {
                const ph_fields *f = &r.few->fields[a], *g = &r.all->fields[a];
                ptrdiff_t n = m->grid.n[0] * m->grid.n[1] * m->grid.n[2];
                CHECK(f->load == g->load);
                /* strains of the residual, and what a cell off by 1e-7 moves; modes that
                 * only (S), 1e-4 of the stiffness, holds are in the displacement alone */
                CHECK(field_difference(n * f->ns, f->strain, g->strain) < 1e-7);
                CHECK(field_difference(n * f->ns, f->stress, g->stress) < 1e-7);
                CHECK(field_difference(n * f->nu, f->displacement, g->displacement) <
                      1e-6);
            }
            free_both(&r);
            ph_microstructure_free(&m);
        }
    CHECK_END();
}

/* Entries that are energies of pairs of fields: above contrast 1000, and at a loose tolerance. Turned loads take the same steps, so that the
 * answers are closer than the tolerance. */
static void test_pairs(void **state)
{
    (void)state;
    const struct {
        double stiffer, tolerance, off;
    } of[] = {{1e5, 1e-7, 1e-6}, {20, 1e-2, 1e-6}};
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 3; k++) {
            trio t =
                with_third(isotropic("a", 1, 0.3), isotropic("b", of[i].stiffer, 0.2));
            ph_kinematics kin = k == 2 ? PH_SPACE
                                : k    ? PH_GENERALISED_STRAIN
                                       : PH_PLANE_STRESS;
            ph_microstructure *m = disk_of_three(kin, &t);
            pair r =
                solve_both((ph_problem){.solver = {.tolerance = of[i].tolerance}}, m);
            check_loads(&r, k == 1 ? 4 : 2);
            CHECK(r.few && r.few->second_order);
            if (r.few && r.all) {
                const ph_sym4 *c = &r.few->stiffness;
                CHECK(c->m[0][0] == c->m[1][1] && c->m[0][c->n - 1] == 0.0);
            }
            if (r.few && r.all)
                CHECK(difference(&r.few->stiffness, &r.all->stiffness) < of[i].off);
            free_both(&r);
            ph_microstructure_free(&m);
        }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_plane),
                                       cmocka_unit_test(test_space),
                                       cmocka_unit_test(test_anisotropic_phases),
                                       cmocka_unit_test(test_drawn),
                                       cmocka_unit_test(test_fields),
                                       cmocka_unit_test(test_pairs)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
