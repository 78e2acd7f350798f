/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Numbers read off the fillers, and fillers drawn on another grid than the nodes. */
#include <perihom_rve.h>

#include "check.h"

static ph_case *parse(const char *fillers, int dimension, int nodes, int drawn)
{
    ph_error err = PH_ERROR_INIT;
    ph_case *c = NULL;
    char text[1024], grid[64] = "", rest[64];
    snprintf(rest, sizeof rest, dimension == 3 ? "%d, %d, %d" : "%d, %d", nodes, nodes,
             nodes);
    if (drawn)
        snprintf(grid, sizeof grid,
                 dimension == 3 ? "drawn_on: [%d, %d, %d], " : "drawn_on: [%d, %d], ",
                 drawn, drawn, drawn);
    snprintf(text, sizeof text,
             "perihom: 1\nmaterials: {m: {E: 1, nu: 0.25}, f: {E: 10, nu: 0.25}}\n"
             "microstructure: {dimension: %d, %s size: [%s], nodes: [%s], %smatrix: m, "
             "interface: node_centre, fillers: [%s]}\n",
             dimension, dimension == 3 ? "" : "plane: stress,",
             dimension == 3 ? "100, 100, 100" : "100, 100", rest, grid, fillers);
    CHECK_OK(ph_case_parse(text, strlen(text), "case", NULL, 0, &c, NULL, &err));
    return c;
}

static void generate(ph_case *c, ph_packing **p, ph_microstructure **m)
{
    ph_error err = PH_ERROR_INIT;
    CHECK_OK(ph_rve_generate(c, m, p, &err));
}

/* Two straight fibres at 30 degrees: sums in closed form. */
static void fibres_of_one_direction(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_case *c =
        parse("{shape: fibre, material: f, count: 2, thickness: 4, length: 40, "
              "orientation: {aligned: {axis: [0.8660254037844387, 0.5], spread: 0}}, "
              "counting: area}",
              2, 50, 0);
    ph_packing *p = NULL;
    ph_microstructure *m = NULL;
    double x[PH_RVE_DESCRIPTORS], v = 40.0 * 4 / 1e4;
    generate(c, &p, &m);
    CHECK(ph_rve_descriptor_count(c) == 5);
    CHECK_OK(ph_rve_describe(c, p, m, x, &err));
    ptrdiff_t painted = 0;
    for (int i = 0; i < 2500; i++)
        painted += m->phase[i] == 1;
    CHECK_REL(x[0], 2 * v, 1e-12);
    CHECK_REL(x[1], (double)painted / 2500, 1e-12);
    CHECK_REL(x[2], 2 * v * 0.4, 1e-12);
    CHECK_REL(x[3], 2 * v * 0.4 * 0.75, 1e-9);
    CHECK_REL(x[4], 2 * v * 0.4 * 0.5625, 1e-9);
    CHECK(x[5] == 0 && x[15] == 0);
    CHECK(ph_rve_describe(c, NULL, m, x, &err) == PH_EINVAL);
    ph_packing_free(&p);
    ph_microstructure_free(&m);
    ph_case_free(&c);
    CHECK_END();
}

/* Arcs of 90 degrees about axis 1: <cos^2> = 1/2 + sin(a) / (2 a), a = pi / 2. Their pieces
 * turn by less than 10 degrees: the polygon is within 1 %. */
static void arcs(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_case *c =
        parse("{shape: platelet, material: f, count: 3, thickness: 1, length: 60, "
              "curvature: {arc_angle: 90}, orientation: {aligned: {axis: [1, 0], "
              "spread: 0}}, counting: area}",
              2, 100, 0);
    ph_packing *p = NULL;
    ph_microstructure *m = NULL;
    double x[PH_RVE_DESCRIPTORS];
    generate(c, &p, &m);
    CHECK_OK(ph_rve_describe(c, p, m, x, &err));
    CHECK(p->nsolids > 3 * 4);
    CHECK_REL(x[3] / x[2], 0.5 + 1 / 3.14159265358979, 0.01);
    ph_packing_free(&p);
    ph_microstructure_free(&m);
    ph_case_free(&c);
    CHECK_END();
}

/* Disks have no direction; in 3D the traces of the moments are one. */
static void counts_and_traces(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_packing *p = NULL;
    ph_microstructure *m = NULL;
    double x[PH_RVE_DESCRIPTORS];
    ph_case *c = parse("{shape: particle, material: f, count: 3, size: 10}", 2, 20, 0);
    CHECK(ph_rve_descriptor_count(c) == 3);
    ph_case_free(&c);
    c = parse("{shape: fibre, material: f, count: 5, thickness: 6, length: 50}, {shape: "
              "particle, material: f, count: 2, size: 10}",
              3, 20, 0);
    CHECK(ph_rve_descriptor_count(c) == 11);
    generate(c, &p, &m);
    CHECK_OK(ph_rve_describe(c, p, m, x, &err));
    double n1 = x[3] / x[2], n2 = x[4] / x[2], quartic = (x[5] + x[6] + x[7]) / x[2];
    CHECK(n1 > 0 && n2 > 0 && n1 + n2 < 1);
    CHECK(quartic <= 1 && quartic >= 1.0 / 3 - 1e-12);
    CHECK_REL(x[8], 2 * 3.14159265358979 / 6 * 1e-3, 1e-9); /* content of two balls */
    ph_packing_free(&p);
    ph_microstructure_free(&m);
    ph_case_free(&c);
    CHECK_END();
}

static const char chains[] =
    "{shape: platelet, material: f, volume_fraction: 0.06, thickness: 1, length: "
    "{uniform: "
    "{min: 20, max: 60}}, curvature: {arc_angle: {uniform: {min: 0, max: 90}}}, "
    "placement: {overlap: true}, counting: nodes}";

/* Half the grid: a cell is filler where one of its four nodes is; twice the grid: every node
 * is four cells. The fillers are the same bit for bit. */
static void the_same_fillers_on_other_grids(void **state)
{
    (void)state;
    ph_case *c = parse(chains, 2, 100, 0), *half = parse(chains, 2, 50, 100),
            *twice = parse(chains, 2, 200, 100);
    for (int r = 0; r < 20; r++) {
        ph_packing *p = NULL, *q = NULL, *s = NULL;
        ph_microstructure *m = NULL, *h = NULL, *t = NULL;
        int wrong = 0;
        c->realisation = half->realisation = twice->realisation = (uint64_t)r;
        generate(c, &p, &m);
        generate(half, &q, &h);
        generate(twice, &s, &t);
        CHECK(p->n == q->n && p->npoints == q->npoints && p->n > 0);
        CHECK(memcmp(p->filler, q->filler, sizeof *p->filler * (size_t)p->n) == 0);
        CHECK(memcmp(p->filler, s->filler, sizeof *p->filler * (size_t)p->n) == 0);
        for (int i = 0; i < 200; i++)
            for (int j = 0; j < 200; j++) {
                int fine = m->phase[i / 2 * 100 + j / 2];
                wrong += t->phase[i * 200 + j] != fine;
                wrong += fine && !h->phase[i / 4 * 50 + j / 4];
            }
        for (int i = 0; i < 50; i++)
            for (int j = 0; j < 50; j++) {
                const uint16_t *at = &m->phase[2 * i * 100 + 2 * j];
                wrong += h->phase[i * 50 + j] != (at[0] || at[1] || at[100] || at[101]);
            }
        CHECK(wrong == 0);
        ph_packing_free(&p);
        ph_packing_free(&q);
        ph_packing_free(&s);
        ph_microstructure_free(&m);
        ph_microstructure_free(&h);
        ph_microstructure_free(&t);
    }
    ph_case_free(&c);
    ph_case_free(&half);
    ph_case_free(&twice);
    CHECK_END();
}

/* Written and read again; refused where it means nothing. */
static void the_key(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_case *c = parse(chains, 2, 50, 100), *again = NULL;
    char *json = NULL;
    CHECK(c->drawn_on[0] == 100 && c->drawn_on[1] == 100 && c->drawn_on[2] == 1);
    CHECK_OK(ph_case_to_json(c, &json, &err));
    CHECK_OK(ph_case_parse(json, strlen(json), "again", NULL, 0, &again, NULL, &err));
    CHECK(memcmp(c->drawn_on, again->drawn_on, sizeof c->drawn_on) == 0);
    free(json);
    ph_case_free(&again);
    ph_case_free(&c);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fibres_of_one_direction),
        cmocka_unit_test(arcs),
        cmocka_unit_test(counts_and_traces),
        cmocka_unit_test(the_same_fillers_on_other_grids),
        cmocka_unit_test(the_key),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
