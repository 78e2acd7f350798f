/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The effective material: from a result, and back from its document. */
#include <perihom.h>

#include "check.h"

static const char good[] =
    "{\"schema\": \"perihom.result/1\", \"title\": \"T\","
    " \"units\": {\"length\": \"um\", \"stress\": \"GPa\", \"time\": \"s\"},"
    " \"case\": {\"materials\": {\"a\": {\"E\": 1, \"density\": 2}, \"b\": {\"density\": "
    "4}}},"
    " \"fractions\": {\"a\": 0.25, \"b\": 0.75}, \"grid\": {\"kinematics\": \"stress\"},"
    " \"effective\": {\"stiffness\": [[2, 1, 0], [1, 2, 0], [0, 0, 0.5]]},"
    " \"provenance\": {\"git\": \"abc\"}}";

static void from_a_document(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_effective *e = NULL;
    CHECK_OK(ph_effective_parse(good, strlen(good), "r.json", &e, &err));
    if (e) {
        CHECK(e->stiffness.n == 3 && e->kinematics == PH_PLANE_STRESS);
        CHECK_REL(e->stiffness.m[2][2], 1.0, 1e-15); /* Mandel: twice the shear modulus */
        CHECK_REL(e->stiffness.m[0][1], 1.0, 1e-15);
        CHECK_REL(e->density, 0.25 * 2 + 0.75 * 4, 1e-15);
        CHECK(strcmp(e->unit_stress, "GPa") == 0 && strcmp(e->title, "T") == 0);
        CHECK(strcmp(e->revision, "abc") == 0);
    }
    ph_effective_free(&e);
    ph_effective_free(&e);
    CHECK_END();
}

/* The relaxation series of a viscoelastic result; the stiffness is then its sum. */
static void relaxation(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    static const char more[] =
        "\"viscoelastic\": {\"stiffness_infinity\": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],"
        " \"terms\": [{\"time\": 5, \"stiffness\": [[2, 1, 0], [1, 2, 0], [0, 0, "
        "3]]}]}, ";
    const char *at = strstr(good, "\"stiffness\"");
    const struct {
        const char *from, *to;
    } wrong[] = {
        {"\"time\": 5", "\"time\": -5"}, {"\"time\": 5", "\"time\": null"},
        {"[2, 1, 0]", "[2, 9, 0]"},      {"[0, 0, 3]", "[0, 0]"},
        {"\"terms\"", "\"teams\""},      {"stiffness_infinity", "stiffness_zero"}};
    for (int i = -1; i < 6; i++) {
        char text[2048], block[512];
        ph_effective *e = NULL;
        snprintf(block, sizeof block, "%s", more);
        if (i >= 0) {
            const char *p = strstr(more, wrong[i].from);
            snprintf(block, sizeof block, "%.*s%s%s", (int)(p - more), more, wrong[i].to,
                     p + strlen(wrong[i].from));
        }
        snprintf(text, sizeof text, "%.*s%s%s", (int)(at - good), good, block, at);
        ph_status st =
            ph_effective_parse(text, strlen(text), "r.json", &e, i < 0 ? &err : NULL);
        if (i >= 0) {
            CHECK(st != PH_OK && e == NULL);
            continue;
        }
        CHECK_OK(st);
        CHECK(e && e->relaxation && e->relaxation->nterms == 1);
        if (e) CHECK_REL(e->stiffness.m[2][2], 2 * (1 + 3), 1e-15); /* Mandel */
        if (e) CHECK_REL(e->stiffness.m[0][0], 1 + 2, 1e-15);
        ph_effective_free(&e);
    }
    CHECK_END();
}

/* A result that was solved and the document of it say the same. */
static void from_a_result(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    static const char text[] =
        "perihom: 1\ntitle: two\nunits: {stress: MPa}\n"
        "materials: {a: {E: 1, nu: 0.3, density: 1}, b: {E: 5, nu: 0.2, density: 3}}\n"
        "microstructure: {dimension: 2, plane: strain, size: [1, 1], nodes: [8, 8], "
        "matrix: a}\n";
    ph_case *c = NULL;
    ph_microstructure *micro = NULL;
    ph_result *r = NULL;
    ph_effective *one = NULL, *two = NULL;
    char *json = NULL;
    CHECK_OK(ph_case_parse(text, strlen(text), "two.yaml", NULL, 0, &c, NULL, &err));
    ph_grid grid;
    CHECK_OK(ph_grid_init(&grid, PH_PLANE_STRAIN, (ptrdiff_t[]){8, 8}, (double[]){1, 1},
                          &err));
    CHECK_OK(ph_microstructure_new(&grid, 2, c->materials, &micro, &err));
    for (int x = 0; x < 16; x++)
        micro->phase[x] = 1;
    ph_problem problem = {.micro = micro};
    CHECK_OK(ph_homogenise(&problem, NULL, &r, &err));
    CHECK_OK(ph_effective_from_result(r, c, &one, &err));
    CHECK_OK(ph_result_to_json(r, c, NULL, &json, &err));
    CHECK_OK(ph_effective_parse(json, strlen(json), "r.json", &two, &err));
    if (one && two) {
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) /* to Voigt and back: one rounding each */
                CHECK_ABS(one->stiffness.m[i][j], two->stiffness.m[i][j], 1e-15);
        CHECK_REL(one->density, 0.75 * 1 + 0.25 * 3, 1e-14);
        CHECK_REL(two->density, one->density, 1e-14);
        CHECK(strcmp(one->unit_stress, two->unit_stress) == 0);
        CHECK(strcmp(one->revision, two->revision) == 0);
    }
    r->loads = 1;
    ph_effective *none = NULL;
    CHECK(ph_effective_from_result(r, c, &none, &err) == PH_EINVAL && !none);
    CHECK(ph_effective_from_result(NULL, c, &none, NULL) == PH_EINVAL);
    free(json);
    ph_effective_free(&one);
    ph_effective_free(&two);
    ph_result_free(&r);
    ph_microstructure_free(&micro);
    ph_case_free(&c);
    CHECK_END();
}

/* A document with one thing replaced is refused with the word that is wrong. */
static void refuses(void **state)
{
    (void)state;
    const struct {
        const char *from, *to, *word;
    } row[] = {
        {"perihom.result/1", "perihom.result/9", "perihom.result/9"},
        {"\"schema\"", "\"skema\"", "(missing)"},
        {"\"stress\"},", "\"sress\"},", "sress"},
        {"[0, 0, 0.5]", "[0, 0, null]", "effective.stiffness"},
        {"[0, 0, 0.5]", "[0, 0, -0.5]", "positive"},
        {"[0, 0, 0.5]", "[0, 0]", "effective.stiffness"},
        {"\"effective\"", "\"other\"", "effective.stiffness"},
        {"{\"schema\"", "[\"schema\"", "not JSON"},
        {"\"T\",", "\"T\", \"title\": 1,", "not JSON"},
    };
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        char text[1024];
        ph_error err = PH_ERROR_INIT;
        ph_effective *e = NULL;
        const char *at = strstr(good, row[i].from);
        snprintf(text, sizeof text, "%.*s%s%s", (int)(at - good), good, row[i].to,
                 at + strlen(row[i].from));
        CHECK(ph_effective_parse(text, strlen(text), "r.json", &e, &err) == PH_EINVAL);
        CHECK(e == NULL && strstr(err.msg, row[i].word) && strstr(err.msg, "r.json"));
    }
    ph_effective *e = NULL;
    CHECK(ph_effective_read("/nowhere/at/all", &e, NULL) == PH_EIO && !e);
    CHECK(ph_effective_read("", &e, NULL) == PH_EINVAL && !e);
    CHECK(ph_effective_parse("", 0, "r.json", &e, NULL) == PH_EINVAL && !e);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(from_a_document),
        cmocka_unit_test(from_a_result),
        cmocka_unit_test(relaxation),
        cmocka_unit_test(refuses),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
