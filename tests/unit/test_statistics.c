/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Statistics of pictures whose answers are known. */
#include <perihom_rve.h>

#include "check.h"

static ph_microstructure *empty(int dim, ptrdiff_t n)
{
    const ptrdiff_t nodes[3] = {n, n, n};
    const double size[3] = {(double)n, (double)n, (double)n};
    ph_material materials[2] = {{.name = "m"}, {.name = "f"}};
    ph_microstructure *m = NULL;
    ph_grid g;
    ph_error err = PH_ERROR_INIT;
    CHECK_OK(ph_grid_init(&g, dim == 3 ? PH_SPACE : PH_PLANE_STRAIN, nodes, size, &err));
    CHECK_OK(ph_microstructure_new(&g, 2, materials, &m, &err));
    return m;
}

static ph_statistics *measure(const ph_microstructure *m, const ph_packing *p)
{
    ph_statistics *s = NULL;
    ph_error err = PH_ERROR_INIT;
    CHECK_OK(ph_rve_statistics(m, p, 0, &s, &err));
    return s;
}

/* Checkerboard of single cells: S2 along an axis is 1/2, 0, 1/2, ...; no run is longer than
 * one cell; the corners touch, so it goes through. */
static void test_checkerboard(void **state)
{
    (void)state;
    ph_microstructure *m = empty(2, 16);
    for (int i = 0; i < 256; i++)
        m->phase[i] = (uint16_t)((i / 16 + i % 16) % 2);
    ph_statistics *s = measure(m, NULL);
    CHECK(s->fraction == 0.5);
    for (int a = 0; a < 2; a++) {
        for (ptrdiff_t k = 0; k < s->nlags[a]; k++) {
            CHECK(s->two_point[a][k] == (k % 2 ? 0 : 0.5));
            CHECK(s->lineal_path[a][k] == (k ? 0 : 0.5));
        }
        CHECK(s->percolates[a]);
    }
    CHECK(s->correlation[8 * 16 + 8] == 0.5 && s->correlation[8 * 16 + 9] == 0);
    CHECK(s->half_scatter == 0);
    ph_statistics_free(&s);
    ph_microstructure_free(&m);
    CHECK_END();
}

/* Layer of 4 of 16 cells across axis 1, in 3D: along 1 S2 and the lineal path fall as
 * (4 - k) / 16, along the others both stay 1/4. S2 - f^2 over f - f^2 is (1 - k / 4 - 1/4) /
 * (3/4), which is 1/e at k = 3 (1 - 1/e). */
static void test_laminate(void **state)
{
    (void)state;
    ph_microstructure *m = empty(3, 16);
    for (int c = 0; c < 4096; c++)
        m->phase[c] = (uint16_t)((c / 256 + 1) % 16 < 4); /* round the box: 15, 0, 1, 2 */
    ph_statistics *s = measure(m, NULL);
    for (ptrdiff_t k = 0; k <= 8; k++) {
        CHECK(s->two_point[0][k] == (k < 4 ? (4.0 - (double)k) / 16 : 0));
        CHECK(s->lineal_path[0][k] == (k < 4 ? (4.0 - (double)k) / 16 : 0));
        for (int a = 1; a < 3; a++) {
            CHECK(s->two_point[a][k] == 0.25);
            CHECK(s->lineal_path[a][k] == 0.25);
        }
    }
    CHECK(!s->percolates[0] && s->percolates[1] && s->percolates[2]);
    CHECK_REL(s->correlation_length[0], 3 * (1 - exp(-1.0)), 1e-12);
    CHECK_ABS(s->correlation_length[1], 8, 0);
    /* halves 0 .. 7 and 8 .. 15 hold 3/8 and 1/8 */
    CHECK_REL(s->half_scatter, 0.5, 1e-12);
    ph_statistics_free(&s);
    ph_microstructure_free(&m);
    CHECK_END();
}

/* A staircase that winds round both axes before it closes; a bar that goes round one. */
static void test_percolation(void **state)
{
    (void)state;
    ph_microstructure *m = empty(2, 12);
    for (int i = 0; i < 12; i++)
        m->phase[i * 12 + i] = 1;
    ph_statistics *s = measure(m, NULL);
    CHECK(s->percolates[0] && s->percolates[1]);
    ph_statistics_free(&s);
    m->phase[0] = m->phase[13] = 0; /* cut: with a gap of two nothing winds */
    s = measure(m, NULL);
    CHECK(!s->percolates[0] && !s->percolates[1]);
    ph_statistics_free(&s);
    ph_microstructure_free(&m);
    CHECK_END();
}

/* Four fillers by hand: 1 and 2 touch by a corner across the edge of the box, 3 and 4 stand
 * alone. Centres at known distances. */
static void test_clusters(void **state)
{
    (void)state;
    ph_microstructure *m = empty(2, 20);
    ph_placed f[4] = {{.centre = {0.5, 0.5}},
                      {.centre = {19.5, 19.5}},
                      {.centre = {10.5, 10.5}},
                      {.centre = {10.5, 14.5}}};
    double ball[1][4] = {{10.5, 10.5, 0, 2.2}};
    ph_packing p = {
        .dimensions = 2, .n = 4, .filler = f, .nclusters = 1, .cluster = ball};
    m->owner = calloc(400, sizeof *m->owner);
    for (int i = 0; i < 4; i++)
        m->owner[(int)f[i].centre[0] * 20 + (int)f[i].centre[1]] = i + 1;
    ph_statistics *s = measure(m, &p);
    CHECK(s->clusters == 3 && s->largest == 2 && s->fillers == 4);
    CHECK_REL(s->nearest_min, sqrt(2.0), 1e-12);
    CHECK_REL(s->nearest_mean, (2 * sqrt(2.0) + 2 * 4) / 4, 1e-12);
    CHECK_REL(s->nearest_std, (4 - sqrt(2.0)) / 2, 1e-12);
    /* cell centres within 2.2 of a cell centre: 1 + 4 + 4 + 4 = 13 (to 2), none at sqrt 5 */
    CHECK_REL(s->agglomerate_volume, 13.0 / 400, 1e-12);
    CHECK_REL(s->agglomerate_share, 1.0 / 4, 1e-12);
    ph_statistics_free(&s);
    ph_microstructure_free(&m);
    CHECK_END();
}

/* One phase only: no correlation length; a matrix that does not exist is refused. */
static void test_edges(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_statistics *s = NULL;
    ph_microstructure *m = empty(2, 5);
    CHECK(ph_rve_statistics(m, NULL, 2, &s, &err) == PH_EINVAL && !s);
    s = measure(m, NULL);
    CHECK(s->fraction == 0 && isnan(s->correlation_length[0]) && isnan(s->half_scatter));
    ph_statistics_free(&s);
    for (int i = 0; i < 25; i++)
        m->phase[i] = 1;
    s = measure(m, NULL);
    CHECK(s->fraction == 1 && s->lineal_path[0][2] == 1 && s->percolates[1]);
    ph_statistics_free(&s);
    ph_microstructure_free(&m);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_checkerboard), cmocka_unit_test(test_laminate),
        cmocka_unit_test(test_percolation),  cmocka_unit_test(test_clusters),
        cmocka_unit_test(test_edges),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
