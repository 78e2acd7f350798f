/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "rve_case.h"

static ph_error err;
static ph_material materials[TEST_MATERIALS];
static double fractions[TEST_MATERIALS];

/* Built and checked; its fractions in `fractions`. */
static ph_microstructure *built(int dim, ptrdiff_t n, ph_inclusion *inc, int ninclusions)
{
    const ptrdiff_t nodes[3] = {n, n, n};
    const double size[3] = {1, 1, 1};
    ph_case c = shapes_case(dim, nodes, size, inc, ninclusions, materials);
    ph_microstructure *m = NULL;
    err = (ph_error)PH_ERROR_INIT;
    CHECK_OK(ph_rve_build(&c, &m, &err));
    if (!m) fail_msg("not built: %s", err.msg);
    CHECK_OK(ph_microstructure_check(m, &err));
    ph_microstructure_fractions(m, fractions);
    return m;
}

static ph_inclusion disk(double x, double y, double radius, int material)
{
    ph_inclusion d = no_inclusion("disk", material);
    d.centre[0] = x, d.centre[1] = y, d.radius = radius;
    return d;
}

static ph_inclusion layer(int normal, double from, double to, int material)
{
    ph_inclusion l = no_inclusion("layer", material);
    l.normal = normal, l.from = from, l.to = to;
    return l;
}

static double exact_volume(const ph_inclusion *inc, int dim)
{
    const double *s = inc->semi_axes, *e = inc->size;
    const char *name = inc->shape;
    if (strcmp(name, "disk") == 0) return pi * inc->radius * inc->radius;
    if (strcmp(name, "ellipse") == 0) return pi * s[0] * s[1];
    if (strcmp(name, "box") == 0) return e[0] * e[1] * (dim == 3 ? e[2] : 1);
    if (strcmp(name, "layer") == 0) return inc->to - inc->from;
    if (strcmp(name, "sphere") == 0) return 4 * pi / 3 * pow(inc->radius, 3);
    if (strcmp(name, "ellipsoid") == 0) return 4 * pi / 3 * s[0] * s[1] * s[2];
    return pi * inc->radius * inc->radius * inc->length;
}

/* Small enough not to meet its own images; the grid has prime counts and unequal spacings.
 * Exact sections: rounding. 3D: 1e-5 of each cut cell at the worst, of either sign. */
static void test_volume_of_every_shape(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int dim = 2; dim <= 3; dim++)
        for (size_t i = 0; i < ph_nshapes; i++)
            for (int t = 0; t < check_trials(4); t++) {
                if (!has_dimension(&ph_shapes[i], dim)) continue;
                const ptrdiff_t n[3] = {13, 17, 11};
                const double size[3] = {1, 1.2, 1.1};
                ph_inclusion inc =
                    random_inclusion(ph_shapes[i].info.name, 2, size, 0.05, 0.25, &seed);
                ph_case c = shapes_case(dim, n, size, &inc, 1, materials);
                ph_microstructure *m = NULL;
                CHECK_OK(ph_rve_build(&c, &m, &err));
                CHECK_OK(ph_microstructure_check(m, &err));
                ph_microstructure_fractions(m, fractions);
                double v = size[0] * size[1] * (dim == 3 ? size[2] : 1);
                if (strcmp(inc.shape, "layer") == 0) v = size[inc.normal - 1];
                CHECK_REL(fractions[2] * v, exact_volume(&inc, dim),
                          dim == 2 ? 1e-11 : 1e-5);
                CHECK_ABS(fractions[0] + fractions[2], 1, 1e-12);
                ph_microstructure_free(&m);
            }
    CHECK_END();
}

static void test_fraction_is_reached(void **state)
{
    (void)state;
    ph_inclusion d = disk(0.5, 0.5, NAN, 1), s = no_inclusion("sphere", 1);
    const double want[] = {0.01, 0.47, 0.8, 0.95, 1};
    for (int a = 0; a < 3; a++)
        s.centre[a] = 0.3;
    for (int i = 0; i < 5; i++) {
        d.fraction = s.fraction = want[i];
        ph_microstructure *m = built(2, 32, &d, 1);
        /* images overlap above pi/4 (pi/6): quadrature of the cells they share, 1e-4 of
         * each; they are less than a hundredth (in 3D a quarter) of all */
        CHECK_ABS(fractions[1], want[i], want[i] < 0.78 ? 1e-12 : 1e-6);
        ph_microstructure_free(&m);
        m = built(3, 16, &s, 1);
        CHECK_ABS(fractions[1], want[i], want[i] < 0.52 ? 1e-7 : 3e-5);
        ph_microstructure_free(&m);
    }
    CHECK_END();
}

static void test_node_centre_has_no_cuts(void **state)
{
    (void)state;
    const ptrdiff_t n[3] = {7, 8, 1};
    const double size[3] = {1, 1, 1};
    ph_inclusion d = disk(0.5, 0.5, 0.3, 1);
    ph_case c = shapes_case(2, n, size, &d, 1, materials);
    ph_microstructure *m = NULL, *composite = NULL;
    c.interface = PH_INTERFACE_NODE_CENTRE;
    CHECK_OK(ph_rve_build(&c, &m, &err));
    c.interface = PH_INTERFACE_COMPOSITE;
    CHECK_OK(ph_rve_build(&c, &composite, &err));
    CHECK(m->ncuts == 0 && composite->ncuts > 0);
    for (ptrdiff_t i = 0; i < 7 * 8; i++) {
        double x = ((double)(i / 8) + 0.5) / 7 - 0.5,
               y = ((double)(i % 8) + 0.5) / 8 - 0.5;
        CHECK(m->phase[i] == (x * x + y * y < 0.09));
        CHECK(composite->phase[i] == m->phase[i]);
    }
    ph_microstructure_free(&m);
    ph_microstructure_free(&composite);
    CHECK_END();
}

/* Cell centres on the faces of a layer, spacing not a binary fraction: counted as inside
 * wherever the layer is moved to. */
static void test_centre_on_a_face_is_inside(void **state)
{
    (void)state;
    const ptrdiff_t n[3] = {10, 1, 1};
    const double size[3] = {0.7, 0.1, 1};
    for (int shift = 0; shift < 10; shift++) {
        ph_inclusion l = layer(1, 0.07 * (shift + 0.5), 0.07 * (shift + 3.5), 1);
        ph_case c = shapes_case(2, n, size, &l, 1, materials);
        ph_microstructure *m = NULL;
        c.interface = PH_INTERFACE_NODE_CENTRE;
        CHECK_OK(ph_rve_build(&c, &m, &err));
        for (int i = 0; i < 10; i++)
            CHECK(m->phase[(i + shift) % 10] == (i < 4));
        ph_microstructure_free(&m);
    }
    CHECK_END();
}

static void test_small_and_thin(void **state)
{
    (void)state;
    ph_inclusion d = disk(0.51, 0.53, 0.01, 1); /* within one cell of 0.25 */
    ph_microstructure *m = built(2, 4, &d, 1);
    CHECK(m->ncuts == 1 && m->cuts[0].cell == 2 * 4 + 2 && m->cuts[0].base == 0);
    CHECK_REL(m->cuts[0].fraction, pi * 1e-4 * 16, 1e-12);
    ph_microstructure_free(&m);
    ph_inclusion l = layer(2, 0.3, 0.35, 1);
    m = built(3, 4, &l, 1);
    CHECK(m->ncuts == 16);
    for (ptrdiff_t k = 0; k < m->ncuts; k++) {
        CHECK_REL(m->cuts[k].fraction, 0.2, 1e-12);
        CHECK(fabs(m->cuts[k].normal[1]) == 1);
    }
    ph_microstructure_free(&m);
    m = built(2, 1, &l, 1); /* one cell is all there is */
    CHECK(m->ncuts == 1);
    CHECK_REL(m->cuts[0].fraction, 0.05, 1e-12);
    ph_microstructure_free(&m);
    /* a platelet thinner than a cell: its short axis everywhere, its tips too */
    ph_inclusion b = no_inclusion("box", 1);
    b.centre[0] = b.centre[1] = 0.5, b.size[0] = 0.6, b.size[1] = 0.01, b.angle = 30;
    m = built(2, 16, &b, 1);
    CHECK_REL(fractions[1], 0.006, 1e-11);
    for (ptrdiff_t k = 0; k < m->ncuts; k++) {
        CHECK_ABS(fabs(m->cuts[k].normal[0]), 0.5, 1e-12);
        CHECK_ABS(fabs(m->cuts[k].normal[1]), sqrt(0.75), 1e-12);
    }
    ph_microstructure_free(&m);
    CHECK_END();
}

static void test_larger_than_the_box(void **state)
{
    (void)state;
    ph_inclusion d = disk(0.3, 0.4, 0.8, 1);
    ph_microstructure *m = built(2, 9, &d, 1);
    CHECK(m->ncuts == 0 && fractions[1] == 1);
    ph_microstructure_free(&m);
    d.radius = 0.6; /* images overlap */
    m = built(2, 32, &d, 1);
    double t = acos(0.5 / 0.6), want = pi * 0.36 - 4 * 0.36 * (t - 0.5 * sin(2 * t));
    CHECK_ABS(fractions[1], want, 1e-6);
    ph_microstructure_free(&m);
    ph_inclusion l = layer(1, 0.2, 1.7, 1);
    m = built(2, 5, &l, 1);
    CHECK(m->ncuts == 0 && fractions[1] == 1);
    ph_microstructure_free(&m);
    d.radius = 1e9;
    const ptrdiff_t n[3] = {4, 4, 1};
    const double size[3] = {1, 1, 1};
    ph_case c = shapes_case(2, n, size, &d, 1, materials);
    CHECK(ph_rve_build(&c, &m, &err) == PH_EINVAL && !m);
    CHECK(strstr(err.msg, "test.yaml:7") && strstr(err.msg, "inclusions[0]"));
    CHECK_END();
}

static void test_own_material_changes_nothing(void **state)
{
    (void)state;
    ph_inclusion d[2] = {disk(0.5, 0.5, 0.3, 0), disk(0.5, 0.5, 0.3, 1)};
    ph_microstructure *m = built(2, 8, d, 1);
    CHECK(m->ncuts == 0 && fractions[0] == 1);
    ph_microstructure_free(&m);
    ph_microstructure *once = built(2, 8, d + 1, 1);
    d[0] = d[1];
    m = built(2, 8, d, 2); /* twice the same: the union is one */
    CHECK(m->ncuts == once->ncuts);
    CHECK_ABS(fractions[1], pi * 0.09, 1e-5);
    ph_microstructure_free(&m);
    ph_microstructure_free(&once);
    CHECK_END();
}

static void test_full_cover_removes_cuts(void **state)
{
    (void)state;
    ph_inclusion d[2] = {disk(0.5, 0.5, 0.2, 1), layer(1, 0, 1, 2)};
    ph_microstructure *m = built(2, 8, d, 2);
    CHECK(m->ncuts == 0 && fractions[2] == 1);
    ph_microstructure_free(&m);
    d[1] = disk(0.5, 0.5, 0.25, 2);
    m = built(2, 8, d, 2);
    ph_microstructure *alone = built(2, 8, d + 1, 1);
    CHECK_ABS(fractions[1], 0, 1e-6);
    CHECK_ABS(fractions[2], pi / 16, 1e-5);
    ph_microstructure_free(&m);
    ph_microstructure_free(&alone);
    CHECK_END();
}

/* Several inclusions in the only cell there is: what the cuts leave of each is what is seen. */
static void test_shares_are_what_is_seen(void **state)
{
    (void)state;
    ph_inclusion nested[2] = {disk(0.5, 0.5, 0.4, 1), disk(0.5, 0.5, 0.3, 2)};
    ph_microstructure *m = built(2, 1, nested, 2);
    CHECK(m->ncuts == 2 && m->cuts[0].base == 0 && m->cuts[1].base == -1);
    CHECK_ABS(fractions[2], pi * 0.09, 1e-5);
    CHECK_ABS(fractions[1], pi * 0.07, 1e-5);
    ph_microstructure_free(&m);
    ph_inclusion apart[2] = {disk(0.25, 0.5, 0.2, 1), disk(0.75, 0.5, 0.2, 2)};
    m = built(2, 1, apart, 2);
    CHECK_ABS(fractions[1], pi * 0.04, 1e-5);
    CHECK_ABS(fractions[2], pi * 0.04, 1e-5);
    ph_microstructure_free(&m);
    apart[1].material = 1; /* one material: one cut, along the line of the centres */
    m = built(2, 1, apart, 2);
    CHECK(m->ncuts == 1);
    CHECK_ABS(m->cuts[0].fraction, pi * 0.08, 1e-5);
    ph_microstructure_free(&m);
    ph_inclusion hole[3] = {disk(0.5, 0.5, 0.4, 1), disk(0.5, 0.5, 0.3, 0),
                            disk(0.5, 0.5, 0.2, 1)};
    m = built(2, 1, hole, 3);
    CHECK(m->ncuts == 3);
    CHECK_ABS(fractions[1], pi * (0.16 - 0.09 + 0.04), 1e-5);
    ph_microstructure_free(&m);
    CHECK_END();
}

/* Layers whose faces meet inside a cell: exact along every axis, and no matrix left over. */
static void test_layers_that_meet_in_a_cell(void **state)
{
    (void)state;
    for (int normal = 1; normal <= 3; normal++) {
        ph_inclusion l[2] = {layer(normal, 0, 0.3, 1), layer(normal, 0.3, 1, 2)};
        ph_microstructure *m = built(3, 4, l, 2);
        CHECK(m->ncuts == 16 && m->cuts[0].base == 1 && m->cuts[0].material == 2);
        CHECK_ABS(fractions[0], 0, 1e-12);
        CHECK_ABS(fractions[1], 0.3, 1e-12);
        CHECK_ABS(m->cuts[0].fraction, 0.8, 1e-12);
        CHECK(fabs(m->cuts[0].normal[normal - 1]) == 1);
        ph_microstructure_free(&m);
    }
    CHECK_END();
}

/* The normal of a disk's cut is that of the chord; of a box's corner, of both its faces. */
static void test_normals(void **state)
{
    (void)state;
    ph_inclusion d = disk(0.5, 0.5, 0.3, 1);
    ph_microstructure *m = built(2, 64, &d, 1);
    for (ptrdiff_t k = 0; k < m->ncuts; k++) {
        double x = ((double)(m->cuts[k].cell / 64) + 0.5) / 64 - 0.5;
        double y = ((double)(m->cuts[k].cell % 64) + 0.5) / 64 - 0.5,
               r = sqrt(x * x + y * y);
        double cosine = (x * m->cuts[k].normal[0] + y * m->cuts[k].normal[1]) / r;
        /* the chord lies within half a cell's diagonal of the cell's centre */
        CHECK_ABS(cosine, 1, 0.5 * pow(0.71 / 64 / 0.28, 2) * 1.1);
    }
    ph_microstructure_free(&m);
    ph_inclusion b = no_inclusion("box", 1);
    b.centre[0] = b.centre[1] = 0.5, b.size[0] = 0.5, b.size[1] = 0.4;
    m = built(2, 5, &b, 1); /* right upper corner at (0.75, 0.7): cell (3, 3) */
    for (ptrdiff_t k = 0; k < m->ncuts; k++) {
        if (m->cuts[k].cell != 3 * 5 + 3) continue;
        CHECK_REL(m->cuts[k].fraction, 0.75 * 0.5, 1e-12);
        CHECK_REL(m->cuts[k].normal[0], 0.1 / hypot(0.1, 0.15), 1e-9);
        CHECK_REL(m->cuts[k].normal[1], 0.15 / hypot(0.1, 0.15), 1e-9);
    }
    ph_microstructure_free(&m);
    CHECK_END();
}

static void test_cylinder_goes_through(void **state)
{
    (void)state;
    ph_inclusion c = no_inclusion("cylinder", 1);
    for (int a = 0; a < 3; a++)
        c.centre[a] = 0.9, c.axis[a] = a == 1;
    c.radius = 0.3;
    const double lengths[] = {NAN, 1, 5, 0.5};
    for (int i = 0; i < 4; i++) {
        c.length = lengths[i];
        ph_microstructure *m = built(3, 12, &c, 1);
        CHECK_REL(fractions[1], pi * 0.09 * (i == 3 ? 0.5 : 1), 1e-12);
        ph_microstructure_free(&m);
    }
    CHECK_END();
}

static void test_bad_cases(void **state)
{
    (void)state;
    const ptrdiff_t n[3] = {4, 4, 4};
    const double size[3] = {1, 1, 1};
    ph_microstructure *m = NULL;
    ph_inclusion d = disk(0.5, 0.5, 0.3, TEST_MATERIALS);
    ph_case c = shapes_case(2, n, size, &d, 1, materials);
    err = (ph_error)PH_ERROR_INIT;
    CHECK(ph_rve_build(&c, &m, &err) == PH_EINVAL && strstr(err.msg, "material"));
    d.material = 1, c.matrix = -1, err = (ph_error)PH_ERROR_INIT;
    CHECK(ph_rve_build(&c, &m, &err) == PH_EINVAL && strstr(err.msg, "matrix"));
    c.matrix = 0, c.nodes[1] = 0, err = (ph_error)PH_ERROR_INIT;
    CHECK(ph_rve_build(&c, &m, &err) == PH_EINVAL && strstr(err.msg, "axis 2"));
    c.nodes[1] = PTRDIFF_MAX / 2, err = (ph_error)PH_ERROR_INIT;
    CHECK(ph_rve_build(&c, &m, &err) == PH_EINVAL);
    c.nodes[1] = 4, c.size[0] = NAN, err = (ph_error)PH_ERROR_INIT;
    CHECK(ph_rve_build(&c, &m, &err) == PH_EINVAL && !m);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_volume_of_every_shape),
        cmocka_unit_test(test_fraction_is_reached),
        cmocka_unit_test(test_node_centre_has_no_cuts),
        cmocka_unit_test(test_centre_on_a_face_is_inside),
        cmocka_unit_test(test_small_and_thin),
        cmocka_unit_test(test_larger_than_the_box),
        cmocka_unit_test(test_own_material_changes_nothing),
        cmocka_unit_test(test_full_cover_removes_cuts),
        cmocka_unit_test(test_shares_are_what_is_seen),
        cmocka_unit_test(test_layers_that_meet_in_a_cell),
        cmocka_unit_test(test_normals),
        cmocka_unit_test(test_cylinder_goes_through),
        cmocka_unit_test(test_bad_cases),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
