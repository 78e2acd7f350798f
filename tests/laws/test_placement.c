/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Laws of placing: distances, gaps, the periodic box, order, cost. */
#include "check.h"
#include "filler_case.h"

static void random_solid(int dim, uint64_t *seed, ph_solid *s)
{
    double a[3], b[3], f[3][3], n = 0;
    *s = (ph_solid){.centre = {0}};
    for (int i = 0; i < 3; i++) {
        a[i] = check_uniform(seed, -1, 1) * (i < dim);
        b[i] = check_uniform(seed, -1, 1);
        n += a[i] * a[i];
        if (i < dim) s->centre[i] = check_uniform(seed, -1.5, 1.5);
    }
    for (int i = 0; i < 3; i++)
        f[0][i] = a[i] / sqrt(n);
    if (dim == 2) {
        double flat[2][3] = {{-f[0][1], f[0][0], 0}, {0, 0, 1}};
        memcpy(f[1], flat, sizeof flat);
    } else {
        double along = 0, m = 0;
        for (int i = 0; i < 3; i++)
            along += b[i] * f[0][i];
        for (int i = 0; i < 3; i++)
            m += pow(b[i] - along * f[0][i], 2);
        for (int i = 0; i < 3; i++)
            f[1][i] = (b[i] - along * f[0][i]) / sqrt(m);
        for (int i = 0; i < 3; i++)
            f[2][i] = f[0][(i + 1) % 3] * f[1][(i + 2) % 3] -
                      f[0][(i + 2) % 3] * f[1][(i + 1) % 3];
    }
    memcpy(s->frame, f, sizeof f);
    int round = (int)(4 * check_random(seed)); /* how many round axes: 0, 2 or all */
    for (int i = 0; i < 3; i++) {
        bool is_round = round >= 2 && i >= (round == 2 && dim == 3 ? 1 : 0);
        s->kind[i] = i >= dim   ? PH_EXTENT_FREE
                     : is_round ? PH_EXTENT_ROUND
                                : PH_EXTENT_FLAT;
        s->half[i] = i < dim ? check_uniform(seed, 0.1, 0.8) : (double)INFINITY;
    }
}

/* The point of a solid nearest to x, by bisection of the penalty of leaving it: projected
 * steps on the level function's own coordinates. Alternating projections between two convex
 * bodies converge to their distance: a route that shares nothing with the one tested. */
static void nearest(const ph_solid *s, int dim, const double x[3], double out[3])
{
    double y[3] = {0}, sum = 0;
    for (int i = 0; i < dim; i++)
        for (int a = 0; a < dim; a++)
            y[i] += s->frame[i][a] * (x[a] - s->centre[a]);
    for (int i = 0; i < dim; i++) {
        if (s->kind[i] == PH_EXTENT_FLAT)
            y[i] = fmin(fmax(y[i], -s->half[i]), s->half[i]);
        if (s->kind[i] == PH_EXTENT_ROUND) sum += pow(y[i] / s->half[i], 2);
    }
    if (sum > 1) { /* ellipsoid: y_i = h_i^2 y_i / (h_i^2 + t), t by bisection */
        double lo = 0, hi = 1e3;
        for (int k = 0; k < 100; k++) {
            double t = (lo + hi) / 2, g = 0;
            for (int i = 0; i < dim; i++)
                if (s->kind[i] == PH_EXTENT_ROUND)
                    g += pow(s->half[i] * y[i] / (s->half[i] * s->half[i] + t), 2);
            *(g > 1 ? &lo : &hi) = t;
        }
        for (int i = 0; i < dim; i++)
            if (s->kind[i] == PH_EXTENT_ROUND)
                y[i] *= s->half[i] * s->half[i] / (s->half[i] * s->half[i] + lo);
    }
    for (int a = 0; a < 3; a++) {
        out[a] = a < dim ? s->centre[a] : 0;
        for (int i = 0; i < dim; i++)
            out[a] += s->frame[i][a] * y[i];
    }
}

static double by_projection(const ph_solid *a, const ph_solid *b, int dim)
{
    double x[3] = {0}, y[3] = {0}, r2 = 0;
    memcpy(y, b->centre, sizeof y);
    for (int k = 0; k < 4000; k++) {
        nearest(a, dim, y, x);
        nearest(b, dim, x, y);
    }
    for (int i = 0; i < dim; i++)
        r2 += (x[i] - y[i]) * (x[i] - y[i]);
    return sqrt(r2);
}

static void test_distance(void **state)
{
    (void)state;
    static const double nowhere[3] = {0};
    uint64_t seed = check_seed();
    for (int t = 0; t < check_trials(60); t++) {
        int dim = 2 + t % 2;
        ph_solid a, b;
        random_solid(dim, &seed, &a);
        random_solid(dim, &seed, &b);
        double want = by_projection(&a, &b, dim);
        double got = ph_solid_distance(&a, &b, nowhere, dim, INFINITY);
        /* alternating projections stall as 1/k where surfaces are flat and nearly parallel
         * or touch: they can only be too large */
        CHECK(got <= want + 1e-8);
        CHECK(got >= want - 2e-3);
        double turned = ph_solid_distance(&b, &a, nowhere, dim, INFINITY);
        CHECK_ABS(turned, got, 1e-8);
        CHECK(ph_solid_distance(&a, &b, nowhere, dim, got / 2) >= got / 2);
    }
    CHECK_END();
}

/* Every pair of solids of different fillers, every image, by projection on all of them. */
static void check_gaps(const ph_case *c, const ph_packing *p, double gap)
{
    for (ptrdiff_t i = 0; i < p->n; i++)
        for (ptrdiff_t j = i; j < p->n; j++)
            for (int k = 0; k < (p->dimensions == 3 ? 27 : 9); k++) {
                double r2 = 0, to[3] = {0};
                if (i == j && k == (p->dimensions == 3 ? 13 : 4)) continue;
                for (int a = 0; a < p->dimensions; a++) {
                    int step = a == 0 ? k % 3 - 1 : a == 1 ? k / 3 % 3 - 1 : k / 9 - 1;
                    to[a] = p->filler[j].centre[a] + step * c->size[a];
                    r2 += pow(to[a] - p->filler[i].centre[a], 2);
                }
                double reach = p->filler[i].reach + p->filler[j].reach + gap;
                if (r2 > reach * reach) continue;
                for (ptrdiff_t u = 0; u < p->filler[i].count; u++)
                    for (ptrdiff_t v = 0; v < p->filler[j].count; v++) {
                        ph_solid a = p->solid[p->filler[i].first + u],
                                 b = p->solid[p->filler[j].first + v];
                        for (int d = 0; d < p->dimensions; d++) {
                            a.centre[d] += p->filler[i].centre[d];
                            b.centre[d] += to[d];
                        }
                        double x[3], y[3] = {b.centre[0], b.centre[1], b.centre[2]};
                        for (int s = 0; s < 60; s++) {
                            nearest(&a, p->dimensions, y, x);
                            nearest(&b, p->dimensions, x, y);
                        }
                        double d2 = 0;
                        for (int d = 0; d < p->dimensions; d++)
                            d2 += (x[d] - y[d]) * (x[d] - y[d]);
                        CHECK(sqrt(d2) >= gap * (1 - 1e-9));
                    }
            }
}

static void test_gap(void **state)
{
    (void)state;
    static const struct {
        int dim;
        bool relaxes; /* more than random addition can place */
        const char *filler;
    } packed[] = {
        {2, false,
         "shape: particle, volume_fraction: 0.3, size: 6, placement: {gap: 1.3}"},
        {2, true,
         "shape: particle, volume_fraction: 0.70, size: 7, placement: {gap: 0.1}"},
        {3, true,
         "shape: particle, volume_fraction: 0.45, size: 14, placement: {gap: 0.2}"},
        {2, false,
         "shape: fibre, volume_fraction: 0.2, thickness: 1, length: 30, placement: "
         "{gap: 0.5}"},
        {3, true,
         "shape: fibre, volume_fraction: 0.22, thickness: 7, length: 42, placement: "
         "{gap: 0.3}"},
        {2, false,
         "shape: platelet, volume_fraction: 0.1, thickness: 1, length: 25, curvature: "
         "{arc_angle: 120}, placement: {gap: 1}"},
        {3, false,
         "shape: platelet, volume_fraction: 0.06, thickness: 2, length: 25, "
         "curvature: {arc_angle: 60}, placement: {gap: 0.5}"},
        {2, true,
         "shape: particle, volume_fraction: 0.6, size: 5, aspect_ratio: 2, placement: "
         "{gap: 0.1}"},
    };
    for (size_t k = 0; k < sizeof packed / sizeof *packed; k++) {
        char text[400];
        ph_error err = PH_ERROR_INIT;
        ph_packing *p = NULL;
        snprintf(text, sizeof text, "{%s, material: f}", packed[k].filler);
        ph_case *c = filler_case(packed[k].dim, 32, text, "");
        CHECK_OK(ph_rve_place(c, &p, &err));
        if (p) {
            check_gaps(c, p, c->fillers[0].gap);
            CHECK(fabs(p->kind[0].reached - p->kind[0].target) <= p->kind[0].largest);
            CHECK(!packed[k].relaxes || p->kind[0].relaxed > 0);
        }
        ph_packing_free(&p);
        ph_case_free(&c);
    }
    CHECK_END();
}

/* The box moved by whole cells: the same microstructure, moved. Centres
 * stand on a lattice of 2^-20 spacings, so moving them is exact. */
static void test_shift(void **state)
{
    (void)state;
    static const char *const fillers[] = {
        "{shape: platelet, material: f, volume_fraction: 0.1, thickness: 0.1, length: "
        "25, "
        "curvature: {arc_angle: 90}}",
        "{shape: fibre, material: f, volume_fraction: 0.2, thickness: 5, length: 40}"};
    for (int k = 0; k < 2; k++) {
        ph_error err = PH_ERROR_INIT;
        ph_microstructure *m = NULL, *moved = NULL;
        ph_packing *p = NULL;
        ph_case *c = filler_case(2, 64, fillers[k], "  interface: node_centre\n");
        CHECK_OK(ph_rve_generate(c, &m, &p, &err));
        for (ptrdiff_t i = 0; i < p->n; i++) {
            p->filler[i].centre[0] = fmod(p->filler[i].centre[0] + 13, 64);
            p->filler[i].centre[1] = fmod(p->filler[i].centre[1] + 50, 64);
        }
        CHECK_OK(ph_rve_paint(c, p, &moved, &err));
        for (int i = 0; i < 64; i++)
            for (int j = 0; j < 64; j++) {
                int from = i * 64 + j, to = (i + 13) % 64 * 64 + (j + 50) % 64;
                CHECK(m->phase[from] == moved->phase[to]);
                CHECK(m->owner[from] == moved->owner[to]);
            }
        ph_microstructure_free(&m);
        ph_microstructure_free(&moved);
        ph_packing_free(&p);
        ph_case_free(&c);
    }
    CHECK_END();
}

/* A filler is a function of its own number: asking for more leaves the first ones as they
 * were; another realisation or seed gives others; the same again gives the same. */
static void test_pure(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_packing *p[5] = {NULL};
    static const char *const count[] = {"20", "30", "20", "20", "20"};
    static const char *const more[] = {"", "", "  realisation: 1\n", "  seed: 2\n", ""};
    for (int k = 0; k < 5; k++) {
        char text[300];
        snprintf(
            text, sizeof text,
            "{shape: fibre, material: f, count: %s, thickness: {uniform: {min: 1, max: "
            "2}}, length: {weibull: {shape: 3, scale: 9}}, placement: {gap: 0.5}}",
            count[k]);
        ph_case *c = filler_case(2, 32, text, more[k]);
        CHECK_OK(ph_rve_place(c, &p[k], &err));
        ph_case_free(&c);
    }
    for (int i = 0; i < 20; i++) {
        CHECK(memcmp(&p[0]->filler[i], &p[1]->filler[i], sizeof *p[0]->filler) == 0);
        CHECK(memcmp(&p[0]->filler[i], &p[4]->filler[i], sizeof *p[0]->filler) == 0);
        CHECK(p[0]->filler[i].length != p[2]->filler[i].length);
        CHECK(p[0]->filler[i].centre[0] != p[3]->filler[i].centre[0]);
    }
    for (int k = 0; k < 5; k++)
        ph_packing_free(&p[k]);
    CHECK_END();
}

/* Distance computations per filler stay the same while box and number grow alike. */
static void test_cost(void **state)
{
    (void)state;
    double per_filler[3];
    for (int k = 0; k < 3; k++) {
        ph_error err = PH_ERROR_INIT;
        ph_packing *p = NULL;
        ph_case *c =
            filler_case(2, 32,
                        "{shape: fibre, material: f, volume_fraction: 0.15, thickness: "
                        "1, length: 8, placement: {gap: 0.2}}",
                        "");
        c->size[0] = c->size[1] = 64 << k;
        CHECK_OK(ph_rve_place(c, &p, &err));
        per_filler[k] = (double)p->tests / (double)p->n;
        ph_packing_free(&p);
        ph_case_free(&c);
    }
    /* 77, 307 and 1229 fillers: their scatter is some 10 % */
    CHECK(per_filler[2] < 1.5 * per_filler[0] && per_filler[2] < 1.3 * per_filler[1]);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_distance), cmocka_unit_test(test_gap),
        cmocka_unit_test(test_shift),    cmocka_unit_test(test_pure),
        cmocka_unit_test(test_cost),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
