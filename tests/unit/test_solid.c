/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "rve_case.h"

/* By the level alone, an independent route. */
static double sampled_overlap(const ph_solid *s, int dim, const double lo[3],
                              const double hi[3], int n)
{
    double x[3] = {0}, inside = 0;
    int nz = dim == 3 ? n : 1;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            for (int k = 0; k < nz; k++) {
                x[0] = lo[0] + (i + 0.5) / n * (hi[0] - lo[0]);
                x[1] = lo[1] + (j + 0.5) / n * (hi[1] - lo[1]);
                if (dim == 3) x[2] = lo[2] + (k + 0.5) / n * (hi[2] - lo[2]);
                inside += ph_solid_level(s, x, NULL) < 0;
            }
    return inside / n / n / nz;
}

/* A cell somewhere on the surface of the solid, of unequal edges. */
static void cell_on_surface(const ph_solid *s, int dim, double edge, uint64_t *seed,
                            double lo[3], double hi[3])
{
    double d[3] = {0}, x[3], from = 0, to = 8;
    for (int a = 0; a < dim; a++)
        d[a] = check_uniform(seed, -1, 1);
    for (int i = 0; i < 50; i++) {
        double t = (from + to) / 2;
        for (int a = 0; a < 3; a++)
            x[a] = s->centre[a] + t * d[a];
        *(ph_solid_level(s, x, NULL) < 0 ? &from : &to) = t;
    }
    for (int a = 0; a < 3; a++) {
        double h = edge * check_uniform(seed, 0.5, 1.5);
        lo[a] = x[a] - h * check_random(seed);
        hi[a] = lo[a] + h;
    }
    if (dim == 2) lo[2] = 0, hi[2] = 1;
}

static double box_volume(int dim, const double lo[3], const double hi[3])
{
    double v = 1;
    for (int a = 0; a < dim; a++)
        v *= hi[a] - lo[a];
    return v;
}

typedef void solid_test(const ph_solid *s, const ph_shape *shape, int dim,
                        const double lo[3], const double hi[3]);

static void for_every_shape(double edge, int trials, solid_test *test)
{
    uint64_t seed = check_seed();
    const double size[3] = {1, 1, 1};
    const ptrdiff_t n[3] = {8, 8, 8};
    ph_error err = PH_ERROR_INIT;
    for (int dim = 2; dim <= 3; dim++)
        for (size_t i = 0; i < ph_nshapes; i++)
            for (int t = 0; t < check_trials(trials); t++) {
                if (!has_dimension(&ph_shapes[i], dim)) continue;
                ph_grid grid;
                ph_solid s;
                double lo[3], hi[3];
                ph_inclusion inc =
                    random_inclusion(ph_shapes[i].info.name, 1, size, 0.05, 0.45, &seed);
                CHECK_OK(ph_grid_init(&grid, dim == 3 ? PH_SPACE : PH_PLANE_STRAIN, n,
                                      size, &err));
                CHECK_OK(ph_shape_place(&inc, &grid, &s, &err));
                cell_on_surface(&s, dim, edge, &seed, lo, hi);
                test(&s, &ph_shapes[i], dim, lo, hi);
            }
}

/* Midpoint sampling with n points an axis misplaces at most the points of the surface
 * layer: error about area / n^2 by equidistribution, at worst (a flat face along the
 * sampling planes) 1 / n. Half of that, and a corner's worth, is allowed. */
static void overlap_is_sampled_overlap(const ph_solid *s, const ph_shape *shape, int dim,
                                       const double lo[3], const double hi[3])
{
    (void)shape;
    int n = dim == 2 ? 200 : 40;
    double v = box_volume(dim, lo, hi);
    CHECK_ABS(ph_solid_overlap(s, dim, lo, hi) / v, sampled_overlap(s, dim, lo, hi, n),
              dim * 0.5 / n);
}

/* Cutting the cell in two changes nothing: to rounding, in 3D well within the promised 1e-4. */
static void overlap_adds_up(const ph_solid *s, const ph_shape *shape, int dim,
                            const double lo[3], const double hi[3])
{
    (void)shape;
    double v = box_volume(dim, lo, hi);
    for (int a = 0; a < dim; a++) {
        double mid[3] = {hi[0], hi[1], hi[2]}, up[3] = {lo[0], lo[1], lo[2]};
        mid[a] = up[a] = lo[a] + 0.382 * (hi[a] - lo[a]);
        double parts =
            ph_solid_overlap(s, dim, lo, mid) + ph_solid_overlap(s, dim, up, hi);
        CHECK_ABS(parts / v, ph_solid_overlap(s, dim, lo, hi) / v,
                  dim == 2 ? 1e-11 : 5e-5);
    }
}

/* Moving the cell by e along axis a sheds e area[a]: a central difference. Where a curved
 * edge enters a face of the cell its length opens like a square root: error sqrt(2 e). */
static void area_vector_is_derivative(const ph_solid *s, const ph_shape *shape, int dim,
                                      const double lo[3], const double hi[3])
{
    double area[3], v = box_volume(dim, lo, hi);
    if (strcmp(shape->info.name, "box") == 0 || strcmp(shape->info.name, "layer") == 0)
        if (dim == 3 || shape->dimensions == 0)
            return; /* jumps where faces leave the cell */
    ph_solid_area_vector(s, dim, lo, hi, area);
    for (int a = 0; a < dim; a++) {
        double e = 1e-3 * (hi[a] - lo[a]), l[3], h[3], moved[2];
        for (int side = 0; side < 2; side++) {
            for (int b = 0; b < 3; b++) {
                double by = b == a ? (2 * side - 1) * e : 0;
                l[b] = lo[b] + by;
                h[b] = hi[b] + by;
            }
            moved[side] = ph_solid_overlap(s, dim, l, h);
        }
        CHECK_ABS(-(moved[1] - moved[0]) / (2 * e) * (hi[a] - lo[a]) / v,
                  area[a] * (hi[a] - lo[a]) / v, sqrt(2e-3));
    }
}

/* On a cell far smaller than the solid the surface is a plane: the area vector points along
 * the level's normal, but for curvature (edge / radius), unless an edge is in the cell. */
static void area_vector_is_level_normal(const ph_solid *s, const ph_shape *shape, int dim,
                                        const double lo[3], const double hi[3])
{
    (void)shape;
    double area[3], n[3], m[3], x[3], size = 0, cosine = 0;
    double fraction = ph_solid_overlap(s, dim, lo, hi) / box_volume(dim, lo, hi);
    if (fraction < 0.2 || fraction > 0.8)
        return; /* an edge may hide between the corners */
    for (int a = 0; a < 3; a++)
        x[a] = (lo[a] + hi[a]) / 2;
    ph_solid_area_vector(s, dim, lo, hi, area);
    ph_solid_level(s, x, n);
    for (int corner = 0; corner < 8; corner++) {
        for (int a = 0; a < 3; a++)
            x[a] = corner >> a & 1 ? lo[a] : hi[a];
        ph_solid_level(s, x, m);
        if (n[0] * m[0] + n[1] * m[1] + n[2] * m[2] < 0.9) return;
    }
    for (int a = 0; a < dim; a++) {
        size += area[a] * area[a];
        cosine += area[a] * n[a];
    }
    if (size > 0) CHECK_ABS(cosine / sqrt(size), 1, 1e-3);
}

static void test_overlap_is_sampled_overlap(void **state)
{
    (void)state;
    for_every_shape(0.3, 10, overlap_is_sampled_overlap);
    CHECK_END();
}

static void test_overlap_adds_up(void **state)
{
    (void)state;
    for_every_shape(0.2, 100, overlap_adds_up);
    CHECK_END();
}

static void test_area_vector_is_derivative(void **state)
{
    (void)state;
    for_every_shape(0.1, 100, area_vector_is_derivative);
    CHECK_END();
}

static void test_area_vector_is_level_normal(void **state)
{
    (void)state;
    for_every_shape(2e-4, 100, area_vector_is_level_normal);
    CHECK_END();
}

/* The level never exceeds the distance: no step shorter than |level| changes its sign. */
static void level_is_below_distance(const ph_solid *s, const ph_shape *shape, int dim,
                                    const double lo[3], const double hi[3])
{
    (void)shape;
    uint64_t seed = 5;
    for (int t = 0; t < 20; t++) {
        double x[3] = {0}, d[3] = {0}, size = 0, n[3];
        for (int a = 0; a < dim; a++) {
            x[a] = check_uniform(&seed, lo[a], hi[a]);
            d[a] = check_uniform(&seed, -1, 1);
            size += d[a] * d[a];
        }
        double level = ph_solid_level(s, x, n);
        for (int a = 0; a < dim; a++)
            x[a] += d[a] / sqrt(size) * fabs(level) * (1 - 1e-12);
        CHECK(ph_solid_level(s, x, NULL) * level >= 0);
        CHECK_ABS(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1, 1e-12);
    }
}

static void test_level_is_below_distance(void **state)
{
    (void)state;
    for_every_shape(0.5, 30, level_is_below_distance);
    CHECK_END();
}

static ph_solid placed(const ph_inclusion *inc, int dim)
{
    const double size[3] = {1, 1, 1};
    const ptrdiff_t n[3] = {8, 8, 8};
    ph_error err = PH_ERROR_INIT;
    ph_grid grid;
    ph_solid s = {0};
    CHECK_OK(ph_grid_init(&grid, dim == 3 ? PH_SPACE : PH_PLANE_STRAIN, n, size, &err));
    CHECK_OK(ph_shape_place(inc, &grid, &s, &err));
    return s;
}

static void test_whole_volumes(void **state)
{
    (void)state;
    const double lo[3] = {-9, -9, -9}, hi[3] = {9, 9, 9};
    ph_inclusion e = no_inclusion("ellipse", 1);
    e.centre[0] = 0.2, e.centre[1] = 0.3, e.semi_axes[0] = 0.4, e.semi_axes[1] = 1e-4;
    e.angle = 33;
    ph_solid s = placed(&e, 2);
    CHECK_REL(ph_solid_overlap(&s, 2, lo, hi), pi * 0.4e-4, 1e-12);
    ph_inclusion b = no_inclusion("box", 1);
    for (int a = 0; a < 3; a++)
        b.centre[a] = 0.5, b.size[a] = 0.1 * (a + 1);
    b.angle = 71;
    s = placed(&b, 3);
    CHECK_REL(ph_solid_overlap(&s, 3, lo, hi), 0.006, 1e-12);
    /* oblique: quadrature of sections, 1e-5 of the box */
    const double l[3] = {0, 0, 0}, h[3] = {1, 1, 1};
    ph_inclusion c = no_inclusion("cylinder", 1);
    for (int a = 0; a < 3; a++)
        c.centre[a] = 0.5, c.axis[a] = 1 + a;
    c.radius = 0.2, c.length = 0.5;
    s = placed(&c, 3);
    CHECK_ABS(ph_solid_overlap(&s, 3, l, h), pi * 0.04 * 0.5, 1e-6);
    ph_inclusion o = no_inclusion("ellipsoid", 1);
    for (int a = 0; a < 3; a++)
        o.centre[a] = 0.5, o.axis[a] = 3 - a, o.semi_axes[a] = 0.1 * (a + 1);
    s = placed(&o, 3);
    CHECK_ABS(ph_solid_overlap(&s, 3, l, h), 4 * pi / 3 * 0.006, 1e-6);
    CHECK_END();
}

static void test_frames(void **state)
{
    (void)state;
    ph_inclusion o = no_inclusion("ellipsoid", 1);
    const double axis[3][3] = {{2, 0, 0}, {0, 3, 0}, {0, 0, 1}};
    const double second[3][3] = {{0, 1, 0}, {1, 0, 0}, {1, 0, 0}};
    for (int a = 0; a < 3; a++)
        o.centre[a] = 0.5, o.semi_axes[a] = 0.1 * (a + 1);
    for (int k = 0; k < 3; k++) {
        memcpy(o.axis, axis[k], sizeof o.axis);
        ph_solid s = placed(&o, 3);
        CHECK(s.frame[0][k] == 1 && memcmp(s.frame[1], second[k], sizeof second[k]) == 0);
    }
    ph_inclusion b = no_inclusion("box", 1);
    for (int a = 0; a < 2; a++)
        b.centre[a] = 0.5, b.size[a] = 0.1 * (a + 1);
    for (int k = -8; k <= 8; k++) {
        b.angle = 90 * k;
        ph_solid s = placed(&b, 2);
        CHECK_ABS(s.frame[0][0], cos(k * pi / 2), 1e-12);
        CHECK_ABS(s.frame[0][1], sin(k * pi / 2), 1e-12);
        CHECK(s.bounds[0] == (k % 2 ? 0.1 : 0.05));
    }
    CHECK_END();
}

static void test_fraction_gives_radius(void **state)
{
    (void)state;
    ph_inclusion d = no_inclusion("disk", 1), b = no_inclusion("sphere", 1);
    for (int a = 0; a < 3; a++)
        d.centre[a] = b.centre[a] = 0.5;
    d.fraction = 0.47;
    CHECK_REL(placed(&d, 2).half[0], sqrt(0.47 / pi), 1e-15);
    b.fraction = 0.2;
    CHECK_REL(placed(&b, 3).half[1], cbrt(0.2 * 0.75 / pi), 1e-15);
    /* images overlap: a square of side 1 with the corners of a disk cut off */
    double r = 0.6, t = acos(0.5 / r), segment = r * r * (t - 0.5 * sin(2 * t));
    d.fraction = pi * r * r - 4 * segment;
    CHECK_REL(placed(&d, 2).half[0], r, 1e-12);
    d.fraction = 1;
    CHECK(placed(&d, 2).half[0] > sqrt(0.5));
    CHECK_END();
}

static void test_what_is_wrong_is_said(void **state)
{
    (void)state;
    const double size[3] = {1, 1, 1};
    const ptrdiff_t n[3] = {8, 8, 8};
    ph_error err = PH_ERROR_INIT;
    ph_grid flat, space;
    ph_solid s;
    CHECK_OK(ph_grid_init(&flat, PH_PLANE_STRESS, n, size, &err));
    CHECK_OK(ph_grid_init(&space, PH_SPACE, n, size, &err));
    for (size_t i = 0; i < ph_nshapes; i++) { /* nothing given */
        const ph_shape *shape = &ph_shapes[i];
        ph_inclusion inc = no_inclusion(shape->info.name, 1);
        CHECK(ph_shape_place(&inc, shape->dimensions == 2 ? &flat : &space, &s, &err) ==
              PH_EINVAL);
        CHECK(err.msg[0]);
        err = (ph_error)PH_ERROR_INIT;
        if (!shape->dimensions) continue; /* wrong dimension */
        CHECK(ph_shape_place(&inc, shape->dimensions == 2 ? &space : &flat, &s, &err) ==
              PH_EINVAL);
        CHECK(strstr(err.msg, "dimension"));
        err = (ph_error)PH_ERROR_INIT;
    }
    ph_inclusion d = no_inclusion("disk", 1);
    d.centre[0] = d.centre[1] = 0.5;
    d.radius = -0.1;
    CHECK(ph_shape_place(&d, &flat, &s, &err) == PH_EINVAL && strstr(err.msg, "-0.1"));
    d.radius = NAN, d.fraction = 1.2, err = (ph_error)PH_ERROR_INIT;
    CHECK(ph_shape_place(&d, &flat, &s, &err) == PH_EINVAL && strstr(err.msg, "1.2"));
    ph_inclusion c = no_inclusion("cylinder", 1);
    for (int a = 0; a < 3; a++)
        c.centre[a] = c.axis[a] = 0.5;
    c.radius = 0.1, err = (ph_error)PH_ERROR_INIT;
    CHECK(ph_shape_place(&c, &space, &s, &err) == PH_EINVAL && strstr(err.msg, "length"));
    CHECK(ph_shape_place(&(ph_inclusion){.shape = "blob"}, &flat, &s, NULL) == PH_EINVAL);
    CHECK_END();
}

/* A box with two equal edges, and the one that a half turn about a diagonal makes of it: the
 * sphere has the same share of both, to the rounding of sums of some hundred terms. */
static void test_turned_boxes(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    const double size[3] = {1, 1, 1};
    const ptrdiff_t n[3] = {8, 8, 8};
    ph_error err = PH_ERROR_INIT;
    ph_grid grid;
    ph_solid s;
    ph_inclusion inc = no_inclusion("sphere", 1);
    inc.centre[0] = inc.centre[1] = inc.centre[2] = 0.5;
    inc.radius = 0.49;
    CHECK_OK(ph_grid_init(&grid, PH_SPACE, n, size, &err));
    CHECK_OK(ph_shape_place(&inc, &grid, &s, &err));
    for (int t = 0; t < check_trials(60); t++) {
        int odd = t % 3, u = (odd + 1) % 3, v = (odd + 2) % 3;
        double edge[3], lo[3], hi[3], to_lo[3], to_hi[3];
        edge[u] = edge[v] = 0.2;
        edge[odd] = check_uniform(&seed, 0.05, 0.3);
        cell_on_surface(&s, 3, 0.2, &seed, lo, hi);
        for (int a = 0; a < 3; a++)
            hi[a] = lo[a] + edge[a];
        for (int a = 0; a < 3; a++) {
            int b = a == odd ? a : a == u ? v : u;
            to_lo[a] = lo[b], to_hi[a] = hi[b];
        }
        double share = ph_solid_overlap(&s, 3, lo, hi) / box_volume(3, lo, hi);
        CHECK_ABS(ph_solid_overlap(&s, 3, to_lo, to_hi) / box_volume(3, lo, hi), share,
                  1e-13);
    }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_overlap_is_sampled_overlap),
        cmocka_unit_test(test_overlap_adds_up),
        cmocka_unit_test(test_area_vector_is_derivative),
        cmocka_unit_test(test_area_vector_is_level_normal),
        cmocka_unit_test(test_level_is_below_distance),
        cmocka_unit_test(test_turned_boxes),
        cmocka_unit_test(test_whole_volumes),
        cmocka_unit_test(test_frames),
        cmocka_unit_test(test_fraction_gives_radius),
        cmocka_unit_test(test_what_is_wrong_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
