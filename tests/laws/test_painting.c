/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "rve_case.h"

enum { INCLUSIONS = 5 };

typedef struct scene {
    int dim;
    ptrdiff_t n[3];
    double size[3];
    ph_inclusion inc[INCLUSIONS];
} scene;

/* Inclusions of random shapes, some overlapping, some over the faces of the box. */
static scene random_scene(int dim, uint64_t *seed)
{
    scene s = {
        .dim = dim, .n = {12, 12, dim == 3 ? 9 : 1}, .size = {1, 1, dim == 3 ? 0.8 : 1}};
    for (int i = 0; i < INCLUSIONS; i++) {
        const ph_shape *shape;
        do {
            shape = &ph_shapes[(size_t)(check_random(seed) * (double)ph_nshapes)];
        } while (!has_dimension(shape, dim));
        int material = (int)(check_random(seed) * TEST_MATERIALS);
        s.inc[i] = random_inclusion(shape->info.name, material, s.size, 0.03, 0.3, seed);
    }
    return s;
}

static ph_microstructure *build(scene *s)
{
    ph_material materials[TEST_MATERIALS];
    ph_error err = PH_ERROR_INIT;
    ph_microstructure *m = NULL;
    ph_case c = shapes_case(s->dim, s->n, s->size, s->inc, INCLUSIONS, materials);
    CHECK_OK(ph_rve_build(&c, &m, &err));
    if (!m) fail_msg("not built: %s", err.msg);
    CHECK_OK(ph_microstructure_check(m, &err));
    return m;
}

/* Cell of one microstructure -> cell of the other; the rotation of the normals. */
typedef struct map {
    ptrdiff_t shift[3];
    bool quarter;
} map;

static ptrdiff_t moved(const ph_grid *g, ptrdiff_t cell, const map *by)
{
    ptrdiff_t at[3] = {cell / g->n[2] / g->n[1], cell / g->n[2] % g->n[1],
                       cell % g->n[2]};
    if (by->quarter) { /* (x, y) -> (size - y, x) */
        ptrdiff_t x = at[0];
        at[0] = g->n[0] - 1 - at[1];
        at[1] = x;
    }
    for (int a = 0; a < 3; a++)
        at[a] = (at[a] + by->shift[a]) % g->n[a];
    return (at[0] * g->n[1] + at[1]) * g->n[2] + at[2];
}

/* First cut of a cell, their number, and the shares of the materials in the cell. */
static const ph_cut *cell_shares(const ph_microstructure *m, ptrdiff_t cell, ptrdiff_t *n,
                                 double share[TEST_MATERIALS])
{
    ptrdiff_t from = 0, to;
    while (from < m->ncuts && m->cuts[from].cell < cell)
        from++;
    for (to = from; to < m->ncuts && m->cuts[to].cell == cell;)
        to++;
    *n = to - from;
    for (int i = 0; i < TEST_MATERIALS; i++)
        share[i] = 0;
    double left = 1;
    for (ptrdiff_t k = to - 1; k >= from; k--) {
        share[m->cuts[k].material] += left * m->cuts[k].fraction;
        left *= 1 - m->cuts[k].fraction;
    }
    share[*n ? m->cuts[from].base : m->phase[cell]] += left;
    return &m->cuts[from];
}

static void check_normals(const ph_cut *p, const ph_cut *q, bool quarter,
                          double tolerance)
{
    double x = p->normal[0], y = p->normal[1];
    double dot = quarter ? x * q->normal[1] - y * q->normal[0]
                         : x * q->normal[0] + y * q->normal[1];
    CHECK_ABS(fabs(dot + p->normal[2] * q->normal[2]), 1, tolerance);
}

/* Phases and shares alike; one normal up to its sign. Under a shift all is the same but for
 * rounding, which in 3D may end an adaptive quadrature elsewhere (1e-5). Under a turn the
 * lines of a cell with several inclusions run across: panels of 1/32 (3D: 1/6) of the cell
 * with a kink or a vertical tangent in them, errors about panel^2 / 10 or panel^1.5 / 20, and that in the weights of the normals. */
static void check_moved(const ph_microstructure *a, const ph_microstructure *b,
                        const map *by)
{
    bool space = a->grid.kinematics == PH_SPACE;
    double tolerance = by->quarter ? (space ? 3e-3 : 3e-4) : (space ? 1e-5 : 1e-10);
    CHECK(by->quarter || a->ncuts == b->ncuts);
    for (ptrdiff_t c = 0; c < ph_grid_cells(&a->grid); c++) {
        ptrdiff_t d = moved(&a->grid, c, by), na, nb;
        double sa[TEST_MATERIALS], sb[TEST_MATERIALS];
        const ph_cut *p = cell_shares(a, c, &na, sa), *q = cell_shares(b, d, &nb, sb);
        CHECK(a->phase[c] == b->phase[d]);
        CHECK(by->quarter || na == nb);
        for (int i = 0; i < TEST_MATERIALS; i++)
            CHECK_ABS(sa[i], sb[i], tolerance);
        if (na == 1 && nb == 1) check_normals(p, q, by->quarter, fmax(tolerance, 1e-6));
    }
}

static void test_shift_by_cells_moves_cells(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int t = 0; t < check_trials(10); t++) {
        scene s = random_scene(2 + t % 2, &seed), r = s;
        map by = {{5, 7, s.dim == 3 ? 4 : 0}, false};
        for (int i = 0; i < INCLUSIONS; i++) {
            for (int a = 0; a < 3; a++)
                r.inc[i].centre[a] += (double)by.shift[a] * s.size[a] / (double)s.n[a];
            int a = r.inc[i].normal - 1;
            r.inc[i].from += (double)by.shift[a] * s.size[a] / (double)s.n[a];
            r.inc[i].to += (double)by.shift[a] * s.size[a] / (double)s.n[a];
        }
        ph_microstructure *m = build(&s), *k = build(&r);
        check_moved(m, k, &by);
        ph_microstructure_free(&m);
        ph_microstructure_free(&k);
    }
    CHECK_END();
}

static void turn_quarter(ph_inclusion *inc)
{
    double x = inc->centre[0], ax = inc->axis[0];
    inc->centre[0] = 1 - inc->centre[1];
    inc->centre[1] = x;
    inc->axis[0] = -inc->axis[1];
    inc->axis[1] = ax;
    inc->angle += 90;
    if (inc->normal == 2) {
        double from = inc->from;
        inc->from = 1 - inc->to;
        inc->to = 1 - from;
    }
    inc->normal = 3 - inc->normal;
}

/* Not the ellipsoid of three axes: its second axis is found from the grid. */
static void test_quarter_turn_turns_cells(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int t = 0; t < check_trials(10); t++) {
        scene s = random_scene(2 + t % 2, &seed);
        for (int i = 0; i < INCLUSIONS; i++)
            s.inc[i].semi_axes[2] = s.inc[i].semi_axes[1];
        scene r = s;
        for (int i = 0; i < INCLUSIONS; i++)
            turn_quarter(&r.inc[i]);
        ph_microstructure *m = build(&s), *k = build(&r);
        check_moved(m, k, &(map){{0, 0, 0}, true});
        ph_microstructure_free(&m);
        ph_microstructure_free(&k);
    }
    CHECK_END();
}

/* Material on top at a point, by the levels of all images: the picture itself. */
static int painted_at(const scene *s, const ph_solid *solids, const double x[3])
{
    for (int i = INCLUSIONS - 1; i >= 0; i--)
        for (int image = 0; image < 27; image++) {
            double y[3];
            const int k[3] = {image % 3 - 1, image / 3 % 3 - 1, image / 9 - 1};
            for (int a = 0; a < 3; a++)
                y[a] = x[a] + (a < s->dim ? k[a] * s->size[a] : 0);
            if (ph_solid_level(&solids[i], y, NULL) < 0) return s->inc[i].material;
        }
    return 0;
}

/* Fractions against the picture sampled at the points of Roberts' additive sequence, which
 * are as even along every direction: an error of
 * about N^-(d+1)/2d (3e-4 in 2D, 7e-4 in 3D) from each of ten surfaces. */
static void test_fractions_are_those_of_the_picture(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    const double step[2][3] = {
        {0.7548776662466927, 0.5698402909980532, 0},
        {0.8191725133961645, 0.6710436067037893, 0.5497004779019703}};
    const int points = 60000;
    for (int t = 0; t < check_trials(4); t++) {
        scene s = random_scene(2 + t % 2, &seed);
        double f[TEST_MATERIALS], want[TEST_MATERIALS] = {0};
        ph_microstructure *m = build(&s);
        ph_solid solids[INCLUSIONS];
        for (int i = 0; i < INCLUSIONS; i++)
            CHECK(ph_shape_place(&s.inc[i], &m->grid, &solids[i], NULL) == PH_OK);
        for (int i = 0; i < points; i++) {
            double x[3] = {0};
            for (int a = 0; a < s.dim; a++)
                x[a] = fmod(0.5 + (i + 1) * step[s.dim - 2][a], 1) * s.size[a];
            want[painted_at(&s, solids, x)] += 1.0 / points;
        }
        ph_microstructure_fractions(m, f);
        for (int i = 0; i < TEST_MATERIALS; i++)
            CHECK_ABS(f[i], want[i], s.dim == 2 ? 3e-3 : 8e-3);
        ph_microstructure_free(&m);
    }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shift_by_cells_moves_cells),
        cmocka_unit_test(test_quarter_turn_turns_cells),
        cmocka_unit_test(test_fractions_are_those_of_the_picture),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
