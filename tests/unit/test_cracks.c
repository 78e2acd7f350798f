/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cracks: which bonds they cut, how they grow, what a case draws; numbers of a stiffness. */
#include <perihom_rve.h>

#include "check.h"
#include "space/broken.h"

#include <string.h>

static const ptrdiff_t none[3] = {0, 0, 0};

static ph_grid plane(ptrdiff_t n0, ptrdiff_t n1, double a, double b)
{
    ph_grid g;
    ph_error err = PH_ERROR_INIT;
    CHECK_OK(
        ph_grid_init(&g, PH_PLANE_STRESS, (ptrdiff_t[]){n0, n1}, (double[]){a, b}, &err));
    return g;
}

static ph_grid space(ptrdiff_t n)
{
    ph_grid g;
    ph_error err = PH_ERROR_INIT;
    CHECK_OK(
        ph_grid_init(&g, PH_SPACE, (ptrdiff_t[]){n, n, n}, (double[]){1, 1, 1}, &err));
    return g;
}

static ph_family *family_of(const ph_grid *g, double spacings)
{
    ph_family *f = NULL;
    ph_error err = PH_ERROR_INIT;
    CHECK_OK(ph_family_new(g, PH_POINTS_NODES, spacings * g->h[0], &ph_influences[0],
                           &ph_volume_weights[0], &f, &err));
    return f;
}

static ph_broken *broken_of(const ph_grid *g, const ph_family *f)
{
    ph_broken *br = NULL;
    ph_error err = PH_ERROR_INIT;
    CHECK_OK(ph_i_broken_new(g, f, NULL, &br, &err));
    return br;
}

static ptrdiff_t cut_line(const ph_grid *g, ph_broken *br, double x0, double y0,
                          double x1, double y1)
{
    ph_cracks c = {0};
    ph_error err = PH_ERROR_INIT;
    double v[2][3] = {{x0, y0, 0}, {x1, y1, 0}};
    ptrdiff_t before = br->pairs;
    CHECK_OK(ph_cracks_add_line(&c, 2, (const double(*)[3])v, &err));
    CHECK_OK(ph_i_cracks_cut(&c, g, none, false, br, NULL, &err));
    ph_cracks_free(&c);
    return br->pairs - before;
}

/* Bonds that cross a full line of a lattice along axis 1, per column: sum of |o_2| over the
 * half family. Whatever the line does to the nodes. */
static ptrdiff_t crossing(const ph_family *f)
{
    ptrdiff_t sum = 0;
    for (ptrdiff_t b = 0; b < f->count; b++)
        sum += abs(f->offset[b][1]);
    return sum / 2;
}

/* A crack through the whole cell cuts every bond that crosses it, once, wherever it lies:
 * between rows, on a row of nodes, on the face of the cell, through its corner, beyond it,
 * walked either way, in one piece or in many. */
static void through(void **state)
{
    (void)state;
    static const double heights[] = {0.5, 0.45, 0.0, 1.0, 0.05, 0.512345, 7.5, -3.0};
    ph_grid g = plane(10, 10, 1, 1);
    ph_family *f = family_of(&g, 3.0);
    for (size_t i = 0; i < sizeof heights / sizeof *heights; i++)
        for (int way = 0; way < 2; way++) {
            ph_broken *br = broken_of(&g, f);
            double y = heights[i], shift = 0.05 * (double)i;
            double from = way ? 1 + shift : shift, to = way ? shift : 1 + shift;
            CHECK(cut_line(&g, br, from, y, to, y) == 10 * crossing(f));
            /* the same crack again cuts nothing */
            CHECK(cut_line(&g, br, from, y, to, y) == 0);
            ph_i_broken_free(&br);
            br = broken_of(&g, f);
            ptrdiff_t sum = 0;
            for (int k = 0; k < 7; k++) /* pieces that meet at their tips */
                sum += cut_line(&g, br, k / 7.0, y, (k + 1) / 7.0, y);
            CHECK(sum == 10 * crossing(f));
            ph_i_broken_free(&br);
        }
    ph_family_free(&f);
    CHECK_END();
}

/* Shifting a crack by whole cells, across the corner of the periodic cell too, permutes the
 * broken bonds; doubling a crack of whole cells doubles them. */
static void shifts(void **state)
{
    (void)state;
    ph_grid g = plane(12, 8, 1.2, 0.8);
    ph_family *f = family_of(&g, 2.0);
    double a[4] = {0.31, 0.22, 0.78, 0.54};
    ph_broken *at = broken_of(&g, f);
    ptrdiff_t want = cut_line(&g, at, a[0], a[1], a[2], a[3]);
    for (int i = -13; i <= 13; i += 3)
        for (int j = -9; j <= 9; j += 2) {
            ph_broken *br = broken_of(&g, f);
            double x = 0.1 * i, y = 0.1 * j;
            CHECK(cut_line(&g, br, a[0] + x, a[1] + y, a[2] + x, a[3] + y) == want);
            for (ptrdiff_t k = 0; k < at->damaged; k++) {
                ptrdiff_t p = at->node[k] / 8 + i + 24, q = at->node[k] % 8 + j + 16;
                ptrdiff_t place = ph_i_broken_place(br, p % 12 * 8 + q % 8);
                CHECK(place >= 0 &&
                      memcmp(br->bits + place * br->words, at->bits + k * at->words,
                             sizeof(uint64_t) * (size_t)br->words) == 0);
            }
            ph_i_broken_free(&br);
        }
    ph_i_broken_free(&at);
    ph_broken *br = broken_of(&g, f);
    ptrdiff_t one = cut_line(&g, br, 0.3, 0.4, 0.5, 0.4);
    CHECK(one == 2 * crossing(f)); /* half open: as many columns as it is long */
    CHECK(cut_line(&g, br, 0.5, 0.4, 0.7, 0.4) == one);
    ph_i_broken_free(&br);
    ph_family_free(&f);
    CHECK_END();
}

/* A polyline with its joint on a node, in the middle of bonds, anywhere: no bond slips
 * through. Closed round a fragment it cuts everything between in and out. */
static void closed(void **state)
{
    (void)state;
    ph_grid g = plane(16, 16, 16, 16);
    ph_family *f = family_of(&g, 3.0);
    uint64_t seed = check_seed();
    ph_error err = PH_ERROR_INIT;
    for (int trial = 0; trial < check_trials(50); trial++) {
        double v[5][3] = {{0}};
        ph_cracks c = {0};
        ph_broken *br = broken_of(&g, f);
        bool grid = trial % 2; /* corners on nodes and on corners of cells */
        double x0 = check_uniform(&seed, -8, 24), y0 = check_uniform(&seed, -8, 24);
        double a = check_uniform(&seed, 3, 7), b = check_uniform(&seed, 3, 7);
        if (grid) x0 = floor(2 * x0) / 2, y0 = floor(2 * y0) / 2, a = floor(2 * a) / 2;
        double corner[5][2] = {{0, 0}, {a, 0}, {a, b}, {0, b}, {0, 0}};
        for (int k = 0; k < 5; k++)
            v[k][0] = x0 + corner[k][0], v[k][1] = y0 + corner[k][1];
        CHECK_OK(ph_cracks_add_line(&c, 5, (const double(*)[3])v, &err));
        CHECK_OK(ph_i_cracks_cut(&c, &g, none, false, br, NULL, &err));
        for (ptrdiff_t x = 0; x < 256; x++)
            for (ptrdiff_t k = 0; k < f->count; k++) {
                ptrdiff_t ends[2] = {x, ph_i_broken_end(br, x, k)};
                bool in[2], edge = false;
                for (int e = 0; e < 2; e++) {
                    ptrdiff_t row = ends[e] / 16;
                    double p = (double)row + 0.5 - x0;
                    double q = (double)(ends[e] % 16) + 0.5 - y0;
                    p -= 16 * floor(p / 16), q -= 16 * floor(q / 16);
                    in[e] = p < a && q < b;
                    edge = edge || fabs(p) < 1e-6 || fabs(p - a) < 1e-6 ||
                           fabs(q) < 1e-6 || fabs(q - b) < 1e-6 || p > 16 - 1e-6 ||
                           q > 16 - 1e-6;
                }
                ptrdiff_t place = ph_i_broken_place(br, x);
                bool cut = place >= 0 && ph_i_is_broken(br, place, k);
                if (in[0] != in[1] && !edge) CHECK(cut);
            }
        ph_i_broken_free(&br);
        ph_cracks_free(&c);
    }
    ph_family_free(&f);
    CHECK_END();
}

/* Plane cracks in space: a square and the disk round it, across the periodic box. */
static void planes(void **state)
{
    (void)state;
    ph_grid g = space(8);
    ph_family *f = family_of(&g, 1.5);
    ph_error err = PH_ERROR_INIT;
    ptrdiff_t up = 0;
    for (ptrdiff_t b = 0; b < f->count; b++)
        up += abs(f->offset[b][2]);
    ph_broken *br = broken_of(&g, f);
    ph_cracks c = {0};
    double square[4][3] = {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    CHECK_OK(ph_cracks_add_polygon(&c, 4, (const double(*)[3])square, &err));
    CHECK_OK(ph_i_cracks_cut(&c, &g, none, false, br, NULL, &err));
    CHECK(br->pairs == 64 * up / 2); /* the whole face, once */
    double normal[3] = {0, 0, -2}, centre[3] = {0.5, 0.5, 0}, semi[2] = {0.8, 0.8};
    CHECK_OK(ph_cracks_add_ellipse(&c, centre, normal, NULL, semi, &err));
    CHECK_OK(ph_i_cracks_cut(&c, &g, none, false, br, NULL, &err));
    CHECK(br->pairs ==
          64 * up / 2); /* it is wider than the box: nothing is left to cut */
    ph_i_broken_free(&br);
    ph_cracks_free(&c);
    br = broken_of(&g, f);
    semi[0] = semi[1] = 0.24;
    CHECK_OK(ph_cracks_add_ellipse(&c, centre, normal, NULL, semi, &err));
    CHECK_OK(ph_i_cracks_cut(&c, &g, none, false, br, NULL, &err));
    CHECK(br->pairs > 0);
    for (ptrdiff_t k = 0; k < br->damaged; k++) { /* all near the disk */
        ptrdiff_t x = br->node[k];
        ptrdiff_t i = x / 64, j = x / 8 % 8, l = x % 8;
        double p[3] = {((double)i + 0.5) / 8 - 0.5, ((double)j + 0.5) / 8 - 0.5,
                       ((double)l + 0.5) / 8};
        CHECK(hypot(p[0], p[1]) < 0.24 + 1.5 / 8);
        CHECK(fmin(p[2], 1 - p[2]) < 2.0 / 8);
    }
    ph_i_broken_free(&br);
    ph_cracks_free(&c);
    ph_family_free(&f);
    CHECK_END();
}

/* A crack that fits between the bonds, one that is missed after its tips are drawn back, and
 * one that a second crack has cut already: it meets bonds all the same. */
static void missed(void **state)
{
    (void)state;

    ph_grid g = plane(10, 10, 1, 1);
    ph_family *f = family_of(&g, 1.5);
    ph_error err = PH_ERROR_INIT;
    const double line[3][2][3] = {
        {{0.41, 0.46, 0}, {0.425, 0.46, 0}}, /* off every bond */
        {{0.1, 0.7, 0}, {0.27, 0.7, 0}},
        {{0.1, 0.7, 0}, {0.27, 0.7, 0}}};
    for (int count = 1; count <= 3; count++)
        for (int drawn = 0; drawn < 2; drawn++) {
            ph_broken *br = broken_of(&g, f);
            ph_cracks c = {0};
            ptrdiff_t n = -1;
            br->tips = drawn ? 0.08 : 0.0; /* leaves 0.01 from 0.18 to 0.19 */
            for (int i = 0; i < count; i++)
                CHECK_OK(ph_cracks_add_line(&c, 2, line[i], &err));
            CHECK_OK(ph_i_cracks_cut(&c, &g, none, false, br, &n, &err));
            CHECK(n == (drawn ? count : 1));
            CHECK((br->pairs > 0) == (!drawn && count > 1));
            ph_i_broken_free(&br);
            ph_cracks_free(&c);
        }
    ph_family_free(&f);
    CHECK_END();
}

/* Memory goes with the damage, the order of breaking changes nothing. */
static void bits(void **state)
{
    (void)state;
    ph_grid g = plane(100, 100, 1, 1);
    ph_family *f = family_of(&g, 3.0);
    ph_meter meter = {0};
    ph_error err = PH_ERROR_INIT;
    ph_broken *a = NULL, *b = NULL, *stress = NULL;
    ph_family *points = NULL;
    uint64_t seed = check_seed();
    CHECK_OK(ph_i_broken_new(&g, f, &meter, &a, &err));
    CHECK_OK(ph_i_broken_new(&g, f, NULL, &b, &err));
    enum { MANY = 500 };
    ptrdiff_t node[MANY], bond[MANY];
    for (int i = 0; i < MANY; i++) {
        node[i] = (ptrdiff_t)(10000 * check_random(&seed));
        bond[i] = (ptrdiff_t)((double)f->count * check_random(&seed));
        CHECK_OK(ph_i_break(a, node[i], bond[i], &err));
    }
    for (int i = MANY - 1; i >= 0; i--)
        CHECK_OK(ph_i_break(b, ph_i_broken_end(b, node[i], bond[i]), b->mirror[bond[i]],
                            &err));
    CHECK_OK(ph_i_broken_settle(a, &err));
    CHECK_OK(ph_i_broken_settle(b, &err));
    CHECK(a->pairs == b->pairs && a->damaged == b->damaged && a->pairs > MANY / 2);
    CHECK(memcmp(a->node, b->node, sizeof *a->node * (size_t)a->damaged) == 0);
    CHECK(memcmp(a->bits, b->bits, sizeof *a->bits * (size_t)(a->damaged * a->words)) ==
          0);
    for (ptrdiff_t i = 1; i < a->damaged; i++)
        CHECK(a->node[i - 1] < a->node[i]);
    CHECK(ph_i_broken_place(a, a->node[7]) == 7);
    CHECK(ph_i_broken_damage(a, 7) > 0 && ph_i_broken_damage(a, 7) < 1);
    /* at most: twice the nodes, each with a word of bits, a number, a flag and two slots */
    CHECK(meter.bytes <= 2 * (size_t)a->damaged * (8 + 4 + 1 + 8));
    for (ptrdiff_t k = 0; k < f->count; k++)
        CHECK_OK(ph_i_break(a, 5, k, &err));
    CHECK_REL(ph_i_broken_damage(a, ph_i_broken_place(a, 5)), 1.0, 1e-14);
    double inverse[6];
    CHECK(!ph_i_broken_shape(a, ph_i_broken_place(a, 5), inverse) && inverse[0] == 0.0);
    CHECK(ph_i_broken_shape(a, -1, inverse) && inverse[0] > 0.0);
    ph_i_broken_free(&a);
    ph_i_broken_free(&b);
    CHECK(meter.bytes == 0);
    CHECK_OK(ph_family_new(&g, PH_POINTS_STRESS, 0.01, &ph_influences[0],
                           &ph_volume_weights[0], &points, &err));
    CHECK(ph_i_broken_new(&g, points, NULL, &stress, &err) == PH_EINVAL && !stress);
    ph_family_free(&points);
    ph_family_free(&f);
    CHECK_END();
}

static void growth(void **state)
{
    (void)state;
    ph_cracks c = {0}, to = {0};
    ph_error err = PH_ERROR_INIT;
    double v[3][3] = {{0, 0, 0}, {3, 0, 0}, {3, 4, 0}}; /* an L of length 7 */
    CHECK_OK(ph_cracks_add_line(&c, 3, (const double(*)[3])v, &err));
    CHECK_REL(ph_crack_length(&c, 0), 7.0, 1e-15);
    static const struct {
        ph_crack_tip tip;
        double length;
        int points;
        double first[2], last[2];
    } want[] = {
        {PH_TIP_TO, 2, 2, {0, 0}, {2, 0}},    {PH_TIP_TO, 5, 3, {0, 0}, {3, 2}},
        {PH_TIP_TO, 9, 3, {0, 0}, {3, 6}},    {PH_TIP_FROM, 5, 3, {2, 0}, {3, 4}},
        {PH_TIP_FROM, 8, 3, {-1, 0}, {3, 4}}, {PH_TIP_BOTH, 1, 2, {3, 0}, {3, 1}},
        {PH_TIP_BOTH, 9, 3, {-1, 0}, {3, 5}}, {PH_TIP_BOTH, 7, 3, {0, 0}, {3, 4}},
        {PH_TIP_TO, 3, 2, {0, 0}, {3, 0}},
    };
    for (size_t i = 0; i < sizeof want / sizeof *want; i++) {
        CHECK_OK(ph_cracks_add_grown(&to, &c, 0, want[i].tip, want[i].length, &err));
        const ph_crack *k = &to.crack[to.count - 1];
        CHECK(to.count == (ptrdiff_t)i + 1 && k->count == want[i].points);
        for (int d = 0; d < 2; d++) {
            CHECK_ABS(to.vertex[k->first][d], want[i].first[d], 1e-14);
            CHECK_ABS(to.vertex[k->first + k->count - 1][d], want[i].last[d], 1e-14);
        }
        CHECK_REL(ph_crack_length(&to, to.count - 1), want[i].length, 1e-14);
    }
    ptrdiff_t count = to.count;
    CHECK_OK(ph_cracks_add_grown(&to, &c, 0, PH_TIP_BOTH, 0, &err));
    CHECK(to.count == count);
    CHECK(ph_cracks_add_grown(&to, &c, 0, PH_TIP_TO, -1, &err) == PH_EINVAL);
    CHECK(ph_cracks_add_grown(&to, &c, 0, PH_TIP_TO, NAN, NULL) == PH_EINVAL);
    CHECK(ph_cracks_add_grown(&to, &c, 1, PH_TIP_TO, 1, NULL) == PH_EINVAL);
    double normal[3] = {0, 3, 4}, semi[2] = {0.2, 0.1}, axis[3] = {1, 0, 0};
    CHECK_OK(ph_cracks_add_ellipse(&c, v[1], normal, axis, semi, NULL));
    CHECK_OK(ph_cracks_add_grown(&to, &c, 1, PH_TIP_BOTH, 0.8, NULL));
    CHECK_REL(to.crack[count].semi_axes[1], 0.2, 1e-14);
    CHECK_OK(ph_cracks_add_polygon(&c, 3, (const double(*)[3])v, NULL));
    CHECK(isnan(ph_crack_length(&c, 2)));
    CHECK(ph_cracks_add_grown(&to, &c, 2, PH_TIP_BOTH, 0.8, NULL) == PH_EINVAL);
    ph_cracks_free(&c);
    ph_cracks_free(&to);
    CHECK_END();
}

static void refused(void **state)
{
    ph_error err = PH_ERROR_INIT;
    (void)state;
    ph_cracks c = {0};
    double v[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {2, NAN, 0}}, zero[3] = {0};
    const double(*p)[3] = (const double(*)[3])v;
    CHECK(ph_cracks_add_line(&c, 1, p, NULL) == PH_EINVAL);
    CHECK(ph_cracks_add_line(&c, 3, p, NULL) == PH_EINVAL);
    CHECK(ph_cracks_add_line(&c, 2, p + 2, NULL) == PH_EINVAL);
    CHECK(ph_cracks_add_polygon(&c, 3, p, NULL) == PH_EINVAL);
    CHECK(ph_cracks_add_polygon(&c, 4, p, NULL) == PH_EINVAL);
    CHECK(ph_cracks_add_ellipse(&c, v[0], zero, NULL, (double[]){1, 1}, NULL) ==
          PH_EINVAL);
    CHECK(ph_cracks_add_ellipse(&c, v[0], v[1], NULL, (double[]){1, 0}, NULL) ==
          PH_EINVAL);
    CHECK(ph_cracks_add_ellipse(&c, v[0], v[1], v[1], (double[]){1, 1}, NULL) ==
          PH_EINVAL);
    CHECK(ph_cracks_add_ellipse(&c, v[3], v[1], NULL, (double[]){1, 1}, NULL) ==
          PH_EINVAL);
    CHECK(c.count == 0);
    ph_grid g = plane(8, 8, 1, 1);
    ph_family *f = family_of(&g, 1.5);
    ph_broken *br = broken_of(&g, f);
    double far[2][3] = {{1e9, 0, 0}, {1e9, 1, 0}},
           wide[2][3] = {{0, 0, 0}, {9e3, 9e3, 0}};
    CHECK_OK(ph_cracks_add_line(&c, 2, (const double(*)[3])far, NULL));
    CHECK(ph_i_cracks_cut(&c, &g, none, false, br, NULL, NULL) == PH_EINVAL);
    ph_cracks_free(&c);
    CHECK_OK(ph_cracks_add_line(&c, 2, (const double(*)[3])wide, NULL));
    CHECK(ph_i_cracks_cut(&c, &g, none, false, br, NULL, NULL) == PH_EINVAL);
    ph_cracks_free(&c);
    ph_i_broken_free(&br);
    ph_family_free(&f);
    CHECK_END();
}

/* ---- what a case draws ------------------------------------------------------------------- */

static ph_case *read_case(const char *rest, const char *dimension)
{
    ph_case *c = NULL;
    ph_error err = PH_ERROR_INIT;
    char text[1000];
    int n = snprintf(text, sizeof text,
                     "perihom: 1\nmaterials: {m: {E: 1, nu: 0.3}}\nmicrostructure: "
                     "{%s, matrix: m, seed: 3}\n%s",
                     dimension, rest);
    CHECK_OK(ph_case_parse(text, (size_t)n, "test", NULL, 0, &c, NULL, &err));
    return c;
}

static const char in2[] = "dimension: 2, plane: stress, size: [2, 1], nodes: [8, 8]";
static const char in3[] = "dimension: 3, size: [1, 1, 1], nodes: [8, 8, 8]";

static void populations(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_crack_plan *p = NULL, *more = NULL;
    ph_case *c = read_case("cracks: [{random: {density: 0.1, length: 0.05}}]", in2);
    ph_grid g = plane(8, 8, 2, 1);
    CHECK_OK(ph_rve_cracks(c, &p, &err));
    /* 0.1 * 2 = n 0.025^2, to half a crack */
    CHECK(p->cracks.count == 320);
    CHECK_REL(ph_cracks_density(&p->cracks, &g), 0.1, 1e-12);
    double sum[2] = {0}, centre[2] = {0};
    for (ptrdiff_t i = 0; i < p->cracks.count; i++) {
        const double(*v)[3] =
            (const double(*)[3])(p->cracks.vertex + p->cracks.crack[i].first);
        double d[2] = {v[1][0] - v[0][0], v[1][1] - v[0][1]};
        double phi = 2 * atan2(d[1], d[0]);
        CHECK_REL(hypot(d[0], d[1]), 0.05, 1e-12);
        sum[0] += cos(phi), sum[1] += sin(phi);
        for (int a = 0; a < 2; a++)
            centre[a] += 0.5 * (v[0][a] + v[1][a]) / 320;
    }
    /* directions uniform on the half circle, centres in the box: 4 standard deviations */
    CHECK_ABS(sum[0] / 320, 0, 4 / sqrt(640));
    CHECK_ABS(sum[1] / 320, 0, 4 / sqrt(640));
    CHECK_ABS(centre[0], 1, 4 * 2 / sqrt(12 * 320));
    CHECK_ABS(centre[1], 0.5, 4 / sqrt(12 * 320));
    ph_case_free(&c);
    /* more of the same begins with the same cracks */
    c = read_case("cracks: [{random: {density: 0.1, length: 0.05}}]\n"
                  "sequence: {density: [0, 0.05, 0.2]}",
                  in2);
    CHECK_OK(ph_rve_cracks(c, &more, &err));
    CHECK(more->cracks.count == 640 && more->sequence.first == 0);
    CHECK(memcmp(more->cracks.vertex, p->cracks.vertex,
                 sizeof(double) * 3 * (size_t)p->cracks.nvertices) == 0);
    ph_crack_plan_free(&more);
    ph_crack_plan_free(&p);
    c->realisation = 1;
    CHECK_OK(ph_rve_cracks(c, &p, &err));
    CHECK(p->cracks.count == 640);
    ph_crack_plan_free(&p);
    ph_case_free(&c);
    c = read_case("cracks: [{from: [0, 0], to: [1, 0]}, {random: {count: 7, length: "
                  "{uniform: {min: 0.1, max: 0.2}}, orientation: aligned, angle: 90}}]\n"
                  "sequence: {crack_growth: {crack: 0, tip: to, lengths: [0, 0.3, 1]}}",
                  in2);
    CHECK_OK(ph_rve_cracks(c, &p, &err));
    CHECK(p->cracks.count == 8 && p->sequence.nsteps == 5 && p->grows[0] && !p->grows[1]);
    CHECK_REL(p->sequence.value[3], 0.9, 1e-15);
    CHECK(p->sequence.value[4] == 1.0);
    for (ptrdiff_t i = 1; i < 8; i++) {
        const double(*v)[3] =
            (const double(*)[3])(p->cracks.vertex + p->cracks.crack[i].first);
        CHECK_ABS(v[1][0], v[0][0], 1e-15);
        CHECK(v[1][1] - v[0][1] > 0.1 && v[1][1] - v[0][1] < 0.2);
    }
    ph_crack_plan_free(&p);
    ph_case_free(&c);
    c = read_case(
        "cracks: [{random: {density: 0.2, length: 0.2}}, {disk: {centre: [0, 0, "
        "0], normal: [1, 1, 0], radius: 0.3}}]",
        in3);
    CHECK_OK(ph_rve_cracks(c, &p, &err));
    CHECK(p->cracks.count == 201);
    ph_crack_plan_free(&p);
    ph_case_free(&c);
    /* so small that nobody can count them */
    c = read_case("cracks: [{random: {density: 1, length: 1.0e-9}}]", in2);
    CHECK(ph_rve_cracks(c, &p, &err) == PH_EUNPHYSICAL && !p);
    ph_case_free(&c);
    CHECK_END();
}

/* ---- numbers of a stiffness -------------------------------------------------------------- */

static void numbers(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    for (int i = 0; i < 20; i++) {
        ph_material m;
        ph_sym4 c;
        double E = check_uniform(&seed, 0.1, 9), nu = check_uniform(&seed, -0.9, 0.49);
        CHECK_OK(ph_material_isotropic("m", E, nu, &m, &err));
        CHECK_ABS(ph_anisotropy_index(&m.stiffness), 0, 1e-12 / (0.5 - nu));
        CHECK_REL(ph_axial_modulus(&m.stiffness, i % 3), E, 1e-12 / (0.5 - nu));
        CHECK_OK(ph_sym4_reduce(&m.stiffness, PH_PLANE_STRESS, &c, &err));
        CHECK_ABS(ph_anisotropy_index(&c), 0, 1e-12 / (1 + nu));
        CHECK_REL(ph_axial_modulus(&c, i % 2), E, 1e-12 / (1 + nu));
    }
    /* square symmetry by hand, C11 = C22 = 3, C12 = 1, C66 = 2 (isotropic: 1): the first
     * bracket vanishes, the second is (4 + 8)(1 + 1/2)/16 - 1 = 1/8 */
    double square[9] = {3, 1, 0, 1, 3, 0, 0, 0, 2};
    ph_sym4 c = ph_sym4_from_voigt(3, square, true);
    CHECK_REL(ph_anisotropy_index(&c), sqrt(2.0) / 8, 1e-13);
    /* cubic, C11 = 3, C12 = 1, C44 = 2: bulk parts agree, GV = (2 + 6)/5 = 8/5,
     * 1/GR = (4 S11 - 4 S12 + 3 S44)/5 = (4/2 + 3/2)/5 = 7/10 */
    double cubic[36] = {3, 1, 1, 0, 0, 0, 1, 3, 1, 0, 0, 0, 1, 1, 3, 0, 0, 0,
                        0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 2};
    c = ph_sym4_from_voigt(6, cubic, true);
    CHECK_REL(ph_anisotropy_index(&c), sqrt(5.0) * log(8.0 / 5.0 * 7.0 / 10.0), 1e-13);
    /* cut through */
    double cut[9] = {2, 0, 0, 0, 0, 0, 0, 0, 0};
    c = ph_sym4_from_voigt(3, cut, true);
    CHECK(isinf(ph_anisotropy_index(&c)));
    CHECK_REL(ph_axial_modulus(&c, 0), 2, 1e-15);
    CHECK(ph_axial_modulus(&c, 1) == 0.0);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(through),     cmocka_unit_test(shifts),
        cmocka_unit_test(closed),      cmocka_unit_test(planes),
        cmocka_unit_test(bits),        cmocka_unit_test(missed),
        cmocka_unit_test(growth),      cmocka_unit_test(refused),
        cmocka_unit_test(populations), cmocka_unit_test(numbers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
