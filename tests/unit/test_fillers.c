/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The generator: amounts, shapes, orientation, files, complaints. */
#include "check.h"
#include "filler_case.h"

#include <unistd.h>

static ph_packing *place(const ph_case *c)
{
    ph_packing *p = NULL;
    ph_error err = PH_ERROR_INIT;
    CHECK_OK(ph_rve_place(c, &p, &err));
    if (!p) fail_msg("nothing was placed");
    return p;
}

/* Whole fillers only: the content is within half of the largest of what was asked for. */
static void test_amount(void **state)
{
    (void)state;
    static const char *const fillers[] = {
        "{shape: platelet, material: f, volume_fraction: 0.05, thickness: 0.1, "
        "aspect_ratio: {normal: {mean: 150, std: 30, min: 10}}, curvature: {arc_angle: "
        "60}}",
        "{shape: platelet, material: f, volume_fraction: 0.1, thickness: 2, length: "
        "{uniform: "
        "{min: 8, max: 20}}, curvature: {radius: 30}}",
        "{shape: fibre, material: f, volume_fraction: 0.06, thickness: 3, aspect_ratio: "
        "6}",
        "{shape: particle, material: f, volume_fraction: 0.3, size: {lognormal: {mean: "
        "6, "
        "std: 2}}, aspect_ratio: 1.5}"};
    for (int dim = 2; dim <= 3; dim++)
        for (int k = 0; k < 4; k++) {
            ph_case *c = filler_case(dim, 32, fillers[k], "");
            ph_packing *p = place(c);
            const ph_filler_report *r = &p->kind[0];
            CHECK(r->count > 0 && r->count == p->n);
            CHECK(fabs(r->reached - r->target) <= r->largest);
            CHECK(r->counting == (k == 0 ? PH_COUNT_NODES : PH_COUNT_AREA));
            ph_packing_free(&p);
            ph_case_free(&c);
        }
    CHECK_END();
}

/* Equation 3.2 of the thesis: 5 % of clay by weight are 0.03537076 by volume. */
static void test_weight(void **state)
{
    (void)state;
    ph_case *c =
        filler_case(2, 64,
                    "{shape: fibre, material: f, weight_fraction: 0.05, thickness: "
                    "0.5, length: 5}",
                    "");
    ph_packing *p = place(c);
    CHECK_REL(p->kind[0].target, 0.03537076, 1e-6);
    ph_packing_free(&p);
    ph_case_free(&c);
    CHECK_END();
}

/* The painted solids hold the true content: one filler alone, cut cells counted. A chain of
 * mitred segments misses the arc by its sagitta, 1/50 of the thickness. */
static void test_area(void **state)
{
    (void)state;
    static const struct {
        int dim, n;
        double tolerance;
        const char *filler;
    } one[] = {
        {2, 64, 1e-9, "shape: particle, size: 20, aspect_ratio: 1.7"},
        {2, 64, 1e-9, "shape: platelet, thickness: 5, length: 30"},
        {2, 64, 2e-2,
         "shape: platelet, thickness: 5, length: 40, curvature: {arc_angle: 180}"},
        {3, 32, 1e-3, "shape: fibre, thickness: 9, length: 30"},
        {3, 32, 2e-2, "shape: fibre, thickness: 9, length: 40, curvature: {radius: 25}"},
        {3, 32, 2e-2,
         "shape: platelet, thickness: 5, length: 30, width: 20, curvature: {arc_angle: "
         "90}"},
        {3, 32, 2e-2, "shape: platelet, thickness: 5, length: 30, outline: disc"},
    };
    for (size_t k = 0; k < sizeof one / sizeof *one; k++) {
        char text[300];
        double f[3];
        ph_error err = PH_ERROR_INIT;
        ph_microstructure *m = NULL;
        ph_packing *p = NULL;
        snprintf(text, sizeof text, "{%s, material: f, count: 1}", one[k].filler);
        ph_case *c = filler_case(one[k].dim, one[k].n, text, "");
        CHECK_OK(ph_rve_generate(c, &m, &p, &err));
        CHECK_OK(ph_microstructure_check(m, &err));
        ph_microstructure_fractions(m, f);
        CHECK_REL(f[1], p->kind[0].reached, one[k].tolerance);
        ph_packing_free(&p);
        ph_microstructure_free(&m);
        ph_case_free(&c);
    }
    CHECK_END();
}

/* Mean of direction (x) direction of many fillers against what was asked for: each entry is
 * a mean of N numbers of variance below 1/4, so within 4.5 / (2 sqrt N). */
static void check_tensor(int dim, const char *shape, const char *orientation,
                         const double want[9])
{
    enum { N = 20000 };
    char text[400];
    snprintf(
        text, sizeof text,
        "{shape: %s, material: f, count: %d, thickness: 1, length: 1.5, orientation: "
        "%s}",
        shape, N, orientation);
    ph_case *c = filler_case(dim, 8, text, "");
    ph_packing *p = place(c);
    for (int a = 0; a < 9; a++)
        CHECK_ABS(p->kind[0].tensor[a], want[a], 2.25 / sqrt(N));
    ph_packing_free(&p);
    ph_case_free(&c);
}

static void test_orientation(void **state)
{
    (void)state;
    const double third = 1.0 / 3, e = exp(-2 * pow(10 * 3.14159265358979 / 180, 2));
    check_tensor(2, "fibre", "uniform", (double[9]){0.5, 0, 0, 0, 0.5});
    check_tensor(3, "fibre", "uniform",
                 (double[9]){third, 0, 0, 0, third, 0, 0, 0, third});
    check_tensor(2, "fibre", "{aligned: {angle: 0, spread: 10}}",
                 (double[9]){(1 + e) / 2, 0, 0, 0, (1 - e) / 2});
    check_tensor(3, "platelet", "{aligned: {axis: [0, 0, 2]}}",
                 (double[9]){0, 0, 0, 0, 0, 0, 0, 0, 1});
    /* sphere: <cos^2> = 1 - 2 (coth k - 1/k) / k; circle: (1 + I2(k)/I0(k)) / 2 */
    double k = 5, z = 1 - 2 * (1 / tanh(k) - 1 / k) / k;
    check_tensor(3, "fibre", "{von_mises_fisher: {axis: [1, 0, 0], concentration: 5}}",
                 (double[9]){z, 0, 0, 0, (1 - z) / 2, 0, 0, 0, (1 - z) / 2});
    double y = (1 + 17.505614966624235 / 27.239871823604442) / 2;
    check_tensor(2, "fibre", "{von_mises_fisher: {angle: 90, concentration: 5}}",
                 (double[9]){1 - y, 0, 0, 0, y});
    check_tensor(2, "fibre", "{tensor: [[0.7, 0.2], [0.2, 0.3]]}",
                 (double[9]){0.7, 0.2, 0, 0.2, 0.3});
    check_tensor(3, "fibre",
                 "{tensor: [[0.6, 0.1, 0], [0.1, 0.3, 0.05], [0, 0.05, 0.1]]}",
                 (double[9]){0.6, 0.1, 0, 0.1, 0.3, 0.05, 0, 0.05, 0.1});
    CHECK_END();
}

/* The worm-like chain: mean square end-to-end distance 2 P L (1 - P/L (1 - exp(-L/P))). */
static void test_worm(void **state)
{
    (void)state;
    for (int dim = 2; dim <= 3; dim++) {
        enum { N = 400 };
        const double P = 8, L = 40;
        double sum = 0, squares = 0, want = 2 * P * L * (1 - P / L * (1 - exp(-L / P)));
        ph_case *c =
            filler_case(dim, 16,
                        "{shape: fibre, material: f, count: 400, thickness: 0.5, "
                        "length: 40, curvature: {persistence_length: 8}, counting: "
                        "area}",
                        "");
        ph_packing *p = place(c);
        for (ptrdiff_t i = 0; i < p->n; i++) {
            const ph_solid *a = &p->solid[p->filler[i].first],
                           *b = a + p->filler[i].count - 1;
            double r2 = 0;
            for (int x = 0; x < dim; x++)
                r2 += pow(b->centre[x] + b->half[0] * b->frame[0][x] - a->centre[x] +
                              a->half[0] * a->frame[0][x],
                          2);
            sum += r2 / N;
            squares += r2 * r2 / N;
        }
        /* 4.5 standard errors, and 3 % for steps of P / 8 */
        CHECK_ABS(sum, want, 4.5 * sqrt((squares - sum * sum) / N) + 0.03 * want);
        ph_packing_free(&p);
        ph_case_free(&c);
    }
    CHECK_END();
}

static void test_layer_and_clusters(void **state)
{
    (void)state;
    double f[3];
    ph_error err = PH_ERROR_INIT;
    ph_microstructure *m = NULL;
    ph_packing *p = NULL;
    ph_statistics *s = NULL;
    ph_case *c = filler_case(2, 64,
                             "{shape: particle, material: f, count: 1, size: 20, "
                             "interphase: {thickness: 5, material: i}}",
                             "");
    CHECK_OK(ph_rve_generate(c, &m, &p, &err));
    ph_microstructure_fractions(m, f);
    CHECK_REL(f[1], 3.14159265358979 * 100 / 4096, 1e-9);
    CHECK_REL(f[2], 3.14159265358979 * 125 / 4096, 1e-9);
    ph_packing_free(&p);
    ph_microstructure_free(&m);
    ph_case_free(&c);
    c = filler_case(
        2, 128,
        "{shape: particle, material: f, volume_fraction: 0.1, size: 1, placement: "
        "{clusters: {count: 3, radius: 8, share: 0.7}}}",
        "  interface: node_centre\n");
    CHECK_OK(ph_rve_generate(c, &m, &p, &err));
    CHECK_OK(ph_rve_statistics(m, p, c->matrix, &s, &err));
    /* all 3 balls hold at most 3 pi 64 / 4096 = 0.147 of the box; 0.7 of 520 fillers and
     * what falls in by chance are in them, less what the balls' overlaps hide */
    CHECK(s->agglomerate_volume > 0.05 && s->agglomerate_volume < 0.15);
    CHECK(s->agglomerate_share > 0.5 && s->agglomerate_share < 0.85);
    ph_statistics_free(&s);
    ph_packing_free(&p);
    ph_microstructure_free(&m);
    ph_case_free(&c);
    CHECK_END();
}

/* What is written is the same microstructure again, bit for bit; the picture is written. */
static void test_files(void **state)
{
    (void)state;
    char h5[64], png[64], text[400];
    ph_error err = PH_ERROR_INIT;
    ph_microstructure *m = NULL, *back = NULL;
    ph_case *again = NULL;
    snprintf(h5, sizeof h5, "/tmp/test_fillers_%d.h5", (int)getpid());
    snprintf(png, sizeof png, "/tmp/test_fillers_%d.png", (int)getpid());
    ph_case *c =
        filler_case(3, 24,
                    "{shape: fibre, material: f, volume_fraction: 0.1, thickness: 6, "
                    "length: 30}",
                    "  interface: node_centre\n");
    CHECK_OK(ph_rve_build(c, &m, &err));
    CHECK_OK(ph_rve_write_owners(h5, m, &err));
    CHECK_OK(ph_rve_write_picture(png, m, 0, "Fibres", &err));
    CHECK(access(png, R_OK) == 0);
    snprintf(text, sizeof text,
             "perihom: 1\nmaterials: {m: {E: 1, nu: 0.3}, f: {E: 9, nu: 0.3}}\n"
             "microstructure: {dimension: 3, size: [64, 64, 64], voxels: {file: %s, "
             "materials: [m, f], owners: /owner}}\n",
             h5);
    CHECK_OK(ph_case_parse(text, strlen(text), "t.yaml", NULL, 0, &again, NULL, &err));
    CHECK_OK(ph_rve_build(again, &back, &err));
    CHECK(memcmp(m->phase, back->phase, sizeof *m->phase * 24 * 24 * 24) == 0);
    CHECK(memcmp(m->owner, back->owner, sizeof *m->owner * 24 * 24 * 24) == 0);
    const ptrdiff_t wrong[3] = {24, 24, 23};
    ph_error why = PH_ERROR_INIT;
    CHECK(ph_rve_read_owners(h5, "/owner", 3, wrong, m->owner, &why) == PH_EINVAL);
    remove(h5);
    remove(png);
    ph_case_free(&c);
    ph_case_free(&again);
    ph_microstructure_free(&m);
    ph_microstructure_free(&back);
    CHECK_END();
}

/* A resolved case says the same again. */
static void test_round_trip(void **state)
{
    (void)state;
    char *first = NULL, *second = NULL;
    ph_error err = PH_ERROR_INIT;
    ph_case *again = NULL;
    ph_case *c = filler_case(3, 16,
                             "{shape: fibre, material: f, weight_fraction: 0.01, "
                             "thickness: {normal: {mean: 1, "
                             "std: 0.1}}, length: {table: {values: [3, 5], weights: [1, "
                             "2]}}, curvature: {helix: "
                             "{radius: 2, pitch: 3}}, orientation: {tensor: [[1, 0, 0], "
                             "[0, 0, 0], [0, 0, 0]]}, "
                             "placement: {gap: 1, clusters: {count: 2, radius: 9, share: "
                             "0.5}}, interphase: {kappa: "
                             "0.1}}",
                             "  realisation: 7\n");
    CHECK_REL(c->model.kappa, 0.1, 0);
    CHECK_OK(ph_case_to_json(c, &first, &err));
    CHECK_OK(ph_case_parse(first, strlen(first), "t.yaml", NULL, 0, &again, NULL, &err));
    CHECK_OK(ph_case_to_json(again, &second, &err));
    CHECK(strcmp(first, second) == 0);
    free(first);
    free(second);
    ph_case_free(&c);
    ph_case_free(&again);
    CHECK_END();
}

static void test_complaints(void **state)
{
    (void)state;
    static const struct {
        const char *filler, *says;
    } bad[] = {
        {"shape: platelt, material: f", "did you mean 'platelet'"},
        {"shape: particle, material: f, size: 3", "give weight_fraction"},
        {"shape: particle, material: f, size: 3, count: 2, volume_fraction: 0.1",
         "exclude"},
        {"shape: particle, material: f, size: 3, volume_fraction: 1.2", "fraction >= 0"},
        {"shape: particle, material: i, size: 3, weight_fraction: 0.1",
         "materials.i.density (the filler) is missing"},
        {"shape: particle, material: f, size: 3, count: 2, thickness: 1", "unknown key"},
        {"shape: fibre, material: f, thickness: 0, length: 5, count: 1",
         "never gives|> 0"},
        {"shape: fibre, material: f, thickness: 1, length: 5, aspect_ratio: 3, count: 1",
         "one of both"},
        {"shape: fibre, material: f, thickness: 1, length: 500, count: 1",
         "longer than the box (64)"},
        {"shape: fibre, material: f, thickness: 1, length: {uniform: {min: 9, max: 3}}, "
         "count: 1",
         "must not be larger than max"},
        {"shape: fibre, material: f, thickness: 1, length: {normal: {mean: -90, std: "
         "1}}, "
         "count: 1",
         "never gives an admissible length"},
        {"shape: fibre, material: f, thickness: 1, length: {gauss: {mean: 9}}, count: 1",
         "unknown key: a distribution has constant"},
        {"shape: fibre, material: f, thickness: 1, length: 9, count: 1, curvature: "
         "{arc_angle: 400}",
         "not above 360"},
        {"shape: fibre, material: f, thickness: 1, length: 9, count: 1, curvature: "
         "{arc_angle: 4, radius: 3}",
         "one of arc_angle"},
        {"shape: fibre, material: f, thickness: 1, length: 9, count: 1, curvature: "
         "{helix: "
         "{radius: 1, pitch: 2}}",
         "dimension 3 only"},
        {"shape: fibre, material: f, thickness: 1, length: 9, count: 1, orientation: "
         "{tensor: "
         "[[0.7, 0], [0, 0.7]]}",
         "trace 1"},
        {"shape: fibre, material: f, thickness: 1, length: 9, count: 1, placement: "
         "{overlap: "
         "true, gap: 2}",
         "one of both"},
        {"shape: fibre, material: f, thickness: 1, length: 9, count: 1, interphase: "
         "{kappa: 2, "
         "thickness: 2}",
         "not both"},
    };
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        char text[400], says[100];
        ph_error err = PH_ERROR_INIT;
        ph_case *c = NULL;
        bool found = false;
        snprintf(text, sizeof text, "{%s}", bad[k].filler);
        CHECK(filler_parse(2, 16, text, "", &c, &err) != PH_OK && c == NULL);
        snprintf(says, sizeof says, "%s", bad[k].says);
        for (char *s = strtok(says, "|"); s; s = strtok(NULL, "|"))
            found |= strstr(err.msg, s) != NULL;
        found &= strstr(err.msg, "microstructure.fillers") != NULL;
        if (!found) print_error("%s: got '%s'\n", bad[k].says, err.msg);
        CHECK(found);
    }
    CHECK_END();
}

/* What only shows while placing. */
static void test_placing_errors(void **state)
{
    (void)state;
    static const struct {
        const char *filler, *says;
    } bad[] = {
        {"shape: particle, material: f, volume_fraction: 0.95, size: 12, placement: "
         "{gap: 0}",
         "random addition reached the fraction"},
        {"shape: fibre, material: f, count: 50, thickness: 1, length: {uniform: {min: "
         "20, max: "
         "90}}",
         "longer than the box"},
        {"shape: fibre, material: f, count: 1, thickness: 1, length: 40, curvature: "
         "{radius: "
         "3}",
         "closes on itself"},
    };
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        char text[400];
        ph_error err = PH_ERROR_INIT;
        ph_microstructure *m = NULL;
        snprintf(text, sizeof text, "{%s}", bad[k].filler);
        ph_case *c = filler_case(2, 16, text, "");
        CHECK(ph_rve_build(c, &m, &err) == PH_EUNPHYSICAL && m == NULL);
        CHECK(strstr(err.msg, bad[k].says) != NULL);
        CHECK(strstr(err.msg, "t.yaml:") == err.msg);
        if (!strstr(err.msg, bad[k].says)) print_error("got '%s'\n", err.msg);
        ph_case_free(&c);
    }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_amount),     cmocka_unit_test(test_weight),
        cmocka_unit_test(test_area),       cmocka_unit_test(test_orientation),
        cmocka_unit_test(test_worm),       cmocka_unit_test(test_layer_and_clusters),
        cmocka_unit_test(test_files),      cmocka_unit_test(test_round_trip),
        cmocka_unit_test(test_complaints), cmocka_unit_test(test_placing_errors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
