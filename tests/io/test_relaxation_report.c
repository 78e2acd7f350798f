/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The block effective.viscoelastic, its tables, and the series as YAML. */
#include <perihom_rve.h>

#include "check.h"
#include "tensors.h"

#include <jansson.h>

#define CASE                                                                             \
    "perihom: 1\n"                                                                       \
    "units: {length: mm, stress: GPa, time: s}\n"                                        \
    "materials:\n"                                                                       \
    "  resin: {nu: 0.38, E: {infinity: 3, terms: [{modulus: 17, time: 1}]}}\n"           \
    "  glass: {E: 20, nu: 0.21}\n"                                                       \
    "microstructure: {dimension: 2, plane: generalised_strain, size: [1, 1], nodes: "    \
    "[16, 16], matrix: resin, inclusions: [{shape: disk, centre: [0.5, 0.5], fraction: " \
    "0.4, material: glass}]}\n"

typedef struct solved {
    ph_case *c;
    ph_microstructure *micro;
    ph_viscoelastic *v;
    ph_relaxation_report *report;
    json_t *document;
} solved;

static solved solve(const char *text)
{
    ph_error err = PH_ERROR_INIT;
    solved s = {0};
    char *json = NULL;
    const ph_ctx one = {.threads = 1};
    CHECK_OK(ph_case_parse(text, strlen(text), "t", NULL, 0, &s.c, NULL, &err));
    CHECK_OK(ph_rve_build(s.c, &s.micro, &err));
    const ph_problem problem = {.micro = s.micro};
    const ph_relaxation_params params = {.route = s.c->viscoelastic.route};
    CHECK_OK(ph_viscoelastic_solve(&problem, &params, &one, &s.v, &err));
    CHECK_OK(ph_relaxation_report_new(s.v, &s.c->viscoelastic, &s.report, &err));
    CHECK_OK(ph_viscoelastic_to_json(s.v, s.report, s.c, "test", &json, &err));
    s.document = json_loads(json, 0, NULL);
    CHECK(s.document != NULL);
    free(json);
    return s;
}

static void done(solved *s)
{
    json_decref(s->document);
    ph_relaxation_report_free(&s->report);
    ph_relaxation_report_free(&s->report);
    ph_viscoelastic_free(&s->v);
    ph_microstructure_free(&s->micro);
    ph_case_free(&s->c);
}

static const json_t *block(const solved *s)
{
    return json_object_get(json_object_get(s->document, "effective"), "viscoelastic");
}

static double at(const json_t *rows, size_t i, size_t j)
{
    return json_number_value(json_array_get(json_array_get(rows, i), j));
}

static void test_block(void **state)
{
    (void)state;
    solved s = solve(CASE);
    const json_t *b = block(&s), *terms = json_object_get(b, "terms"), *term;
    size_t k, n = json_array_size(terms);
    CHECK(n == (size_t)s.v->series->nterms && n > 1);
    CHECK(json_number_value(json_object_get(b, "fit_error")) == 0);
    CHECK(strcmp(json_string_value(json_object_get(b, "route")), "reduced") == 0);
    double sum = at(json_object_get(b, "stiffness_infinity"), 0, 1), last = 0;
    json_array_foreach((json_t *)(uintptr_t)terms, k, term)
    {
        double time = json_number_value(json_object_get(term, "time"));
        CHECK(time > last);
        last = time;
        sum += at(json_object_get(term, "stiffness"), 0, 1);
    }
    CHECK_REL(sum, at(json_object_get(b, "instantaneous"), 0, 1), 1e-9);
    /* the elastic part of the document is the instantaneous one */
    const json_t *effective = json_object_get(s.document, "effective");
    CHECK_REL(at(json_object_get(effective, "stiffness"), 0, 1), sum, 1e-3);
    static const char *const curve[] = {"time", "C11", "E1",
                                        "nu12", "G23", "isotropic.K"};
    static const char *const dynamic[] = {"omega", "E1_storage", "E1_loss",
                                          "E1_tan_delta"};
    const json_t *curves = json_object_get(b, "curves"),
                 *dyn = json_object_get(b, "dynamic");
    for (int i = 0; i < 6; i++)
        CHECK(json_array_size(json_object_get(curves, curve[i])) ==
              (size_t)s.report->curves->nrows);
    for (int i = 0; i < 4; i++)
        CHECK(json_array_size(json_object_get(dyn, dynamic[i])) ==
              (size_t)s.report->dynamic->nrows);
    done(&s);
    CHECK_END();
}

/* Times, frequencies, compression and history as the case asks. */
static void test_wanted(void **state)
{
    (void)state;
    solved s =
        solve(CASE "viscoelastic: {terms: 2, times: [0.5, 1, 2], frequencies: [3], "
                   "history: {component: 11, ramp: {value: 0.01, hold: 4, rest: 2}}}\n");
    const json_t *b = block(&s);
    CHECK(json_array_size(json_object_get(b, "terms")) == 2);
    CHECK(json_integer_value(json_object_get(b, "exact_terms")) == s.v->series->nterms);
    double fit = json_number_value(json_object_get(b, "fit_error"));
    CHECK(fit > 0 && fit < 0.05);
    CHECK_REL(fit, ph_prony_difference(s.report->series, s.v->series), 1e-12);
    CHECK(s.report->curves->nrows == 3 && s.report->curves->value[1] == 1);
    CHECK(s.report->dynamic->nrows == 1 && s.report->dynamic->value[0] == 3);
    const ph_table *r = s.report->response;
    int column = ph_table_column(r, "stress_11");
    CHECK(column > 0 && json_object_get(b, "response") != NULL);
    /* a step of strain: the stress at its first moment is that of the elastic tensor, its
     * sign turns when the strain goes back */
    ph_sym4 now = ph_prony_instantaneous(s.report->series);
    CHECK_REL(r->value[column * r->nrows], 0.01 * now.m[0][0], 1e-12);
    bool turned = false;
    for (ptrdiff_t k = 0; k < r->nrows; k++)
        turned |= r->value[k] >= 4 && r->value[column * r->nrows + k] < 0;
    CHECK(turned);
    done(&s);
    CHECK_END();
}

/* prony.yaml is materials of a case file. */
static void test_yaml(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    solved s = solve(CASE);
    char *yaml = NULL, text[1 << 16];
    ph_case *c = NULL;
    CHECK_OK(ph_prony_to_yaml(s.report->series, "effective", &yaml, &err));
    snprintf(
        text, sizeof text,
        "perihom: 1\n%smicrostructure: {dimension: 3, size: [1, 1, 1], nodes: [2, 2, "
        "2], matrix: effective}\n",
        yaml);
    CHECK_OK(ph_case_parse(text, strlen(text), "t", NULL, 0, &c, NULL, &err));
    if (c) {
        const ph_prony *p = c->materials[0].relaxation, *q = s.report->series;
        CHECK(p->nterms == q->nterms);
        for (double u = -3; u < 3; u++) {
            ph_sym4 a = ph_prony_carson(p, pow(10, u)),
                    b = ph_prony_carson(q, pow(10, u));
            CHECK(difference(&a, &b) < 1e-14);
        }
    }
    const ph_prony flat = {{.n = 3}, 0, NULL};
    free(yaml);
    CHECK(ph_prony_to_yaml(&flat, "x", &yaml, NULL) == PH_EINVAL && !yaml);
    ph_case_free(&c);
    done(&s);
    CHECK_END();
}

static void test_without_series(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    solved s = solve(CASE);
    char *json = NULL;
    ph_relaxation_report *none = NULL;
    ph_viscoelastic bare = *s.v;
    bare.series = NULL;
    CHECK(ph_relaxation_report_new(&bare, NULL, &none, &err) == PH_EINVAL && !none);
    CHECK(strstr(err.msg, "no series") != NULL);
    err = (ph_error)PH_ERROR_INIT;
    CHECK_OK(ph_viscoelastic_to_json(&bare, NULL, s.c, NULL, &json, &err));
    json_decref(s.document);
    s.document = json_loads(json, 0, NULL);
    free(json);
    CHECK(json_is_null(json_object_get(block(&s), "terms")));
    CHECK(json_object_get(json_object_get(s.document, "reasons"),
                          "effective.viscoelastic.terms") != NULL);
    CHECK(ph_viscoelastic_to_json(NULL, NULL, s.c, NULL, &json, NULL) == PH_EINVAL);
    done(&s);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_block),
        cmocka_unit_test(test_wanted),
        cmocka_unit_test(test_yaml),
        cmocka_unit_test(test_without_series),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
