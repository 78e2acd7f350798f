/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/sample.h"

#include <jansson.h>

/* Value at a dotted path, array entries by number: "effective.stiffness.0.3". */
static json_t *at(json_t *root, const char *path)
{
    char copy[200], *save = NULL;
    snprintf(copy, sizeof copy, "%s", path);
    json_t *now = root;
    for (char *part = strtok_r(copy, ".", &save); part; part = strtok_r(NULL, ".", &save))
        now = json_is_array(now) ? json_array_get(now, (size_t)atoi(part))
                                 : json_object_get(now, part);
    return now;
}

/* 17 digits bring a double back as it was: no tolerance. */
static void check_number(json_t *root, const char *path, double want)
{
    json_t *value = at(root, path);
    double got = json_number_value(value);
    if (json_is_number(value) && memcmp(&got, &want, sizeof got) == 0) return;
    check_failures++;
    print_error("%s: got %.17g (type %d), want %.17g\n", path, got,
                value ? (int)json_typeof(value) : -1, want);
}

static void check_text(json_t *root, const char *path, const char *want)
{
    const char *got = json_string_value(at(root, path));
    if (got && strcmp(got, want) == 0) return;
    check_failures++;
    print_error("%s: got '%s', want '%s'\n", path, got ? got : "(none)", want);
}

static void check_matrix(json_t *root, const char *path, const ph_sym4 *c, bool stiffness)
{
    double voigt[36];
    char entry[200];
    ph_sym4_to_voigt(c, stiffness, voigt);
    CHECK((int)json_array_size(at(root, path)) == c->n);
    for (int k = 0; k < c->n * c->n; k++) {
        snprintf(entry, sizeof entry, "%s.%d.%d", path, k / c->n, k % c->n);
        check_number(root, entry, voigt[k]);
    }
}

/* Every null has its reason: under its own path or the path of what holds it. */
static void check_reasons(json_t *root, json_t *value, const char *path)
{
    char below[300], up[300];
    const char *key;
    json_t *item;
    size_t i;
    if (json_is_null(value)) {
        snprintf(up, sizeof up, "%s", path);
        bool found = false;
        for (char *dot = up; dot && !found; dot = strrchr(up, '.')) {
            if (dot != up) *dot = 0;
            found = json_is_string(json_object_get(json_object_get(root, "reasons"), up));
        }
        if (!found) {
            check_failures++;
            print_error("%s is null without a reason\n", path);
        }
    }
    json_object_foreach(value, key, item)
    {
        snprintf(below, sizeof below, "%s%s%s", path, path[0] ? "." : "", key);
        check_reasons(root, item, below);
    }
    json_array_foreach(value, i, item)
    {
        snprintf(below, sizeof below, "%s.%zu", path, i);
        check_reasons(root, item, below);
    }
}

static json_t *document(const ph_result *r, const ph_case *c, const char *command)
{
    ph_error err = PH_ERROR_INIT;
    char *text = NULL;
    CHECK_OK(ph_result_to_json(r, c, command, &text, &err));
    json_t *root = text ? json_loads(text, 0, NULL) : NULL;
    free(text);
    assert_non_null(root);
    check_reasons(root, root, "");
    return root;
}

static void test_numbers_come_back_as_they_were(void **state)
{
    (void)state;
    ph_microstructure *micro = sample_micro(PH_SPACE);
    ph_result *r = sample_result(micro, PH_POINTS_NODES, 0);
    ph_sym4 inverse;
    ph_engineering e;
    ph_error err = PH_ERROR_INIT;
    CHECK_OK(ph_sym4_inverse(&r->stiffness, &inverse, &err));
    CHECK_OK(ph_engineering_constants(&r->stiffness, &e, &err));
    json_t *root = document(r, NULL, "perihom run \"a b\".yaml");
    check_text(root, "schema", "perihom.result/1");
    check_text(root, "effective.notation", "voigt 11 22 33 23 13 12, engineering shear");
    check_matrix(root, "effective.stiffness", &r->stiffness, true);
    check_matrix(root, "effective.compliance", &inverse, false);
    check_matrix(root, "bounds.voigt.stiffness", &r->voigt, true);
    check_matrix(root, "bounds.reuss.stiffness", &r->reuss, true);
    check_number(root, "effective.engineering.E3", e.E[2]);
    check_number(root, "effective.engineering.nu21", e.nu[1][0]);
    check_number(root, "effective.engineering.G13", e.G13);
    CHECK(json_object_size(at(root, "effective.engineering")) == 12);
    CHECK(json_object_size(at(root, "effective.isotropic")) == 5);
    CHECK_REL(json_number_value(at(root, "effective.isotropic.E")), 13.0 / 7, 1e-14);
    for (int i = 0; i < 3; i++) {
        char path[100];
        snprintf(path, sizeof path, "fractions.%s", r->names[i]);
        check_number(root, path, r->fractions[i]);
    }
    check_text(root, "provenance.command", "perihom run \"a b\".yaml");
    check_text(root, "provenance.perihom", ph_version());
    CHECK(json_object_size(at(root, "provenance.libraries")) > 0);
    CHECK(strlen(json_string_value(at(root, "provenance.date"))) == 20);
    CHECK(json_object_size(at(root, "reasons")) == 3); /* units, case, seed */
    json_decref(root);
    ph_result_free(&r);
    ph_microstructure_free(&micro);
    CHECK_END();
}

static void test_solver_quality_cost_notes(void **state)
{
    (void)state;
    ph_microstructure *micro = sample_micro(PH_SPACE);
    ph_result *r = sample_result(micro, PH_POINTS_STRESS, 0);
    json_t *root = document(r, NULL, NULL);
    check_text(root, "solver.kind", "fft_cg");
    check_text(root, "solver.precision", "single");
    check_text(root, "solver.route", "cells");
    check_text(root, "solver.loads.5", "12");
    check_number(root, "solver.iterations.2", 16);
    check_number(root, "solver.residual.5", r->residual[5]);
    CHECK(json_array_size(at(root, "solver.residual")) == 6);
    CHECK(json_is_true(at(root, "solver.converged")));
    check_number(root, "quality.hill_mandel", r->hill_mandel);
    check_number(root, "quality.stabilisation_energy", r->stabilisation_energy);
    CHECK(json_is_object(at(root, "quality.error_bar")));
    check_number(root, "cost.seconds", r->seconds);
    check_number(root, "cost.seconds_solve", r->seconds_solve);
    check_number(root, "cost.peak_bytes", 12345678);
    check_number(root, "cost.threads", 2);
    check_number(root, "cost.applications", 101);
    check_number(root, "cost.ffts", 1212);
    check_text(root, "notes.0", "chose \"nosb\"");
    check_text(root, "model.points", "stress");
    check_number(root, "model.stabilisation.spectral", 1e-4);
    check_number(root, "grid.nodes.2", 4);
    CHECK(at(root, "provenance.command") == NULL);
    json_decref(root);
    ph_result_free(&r);
    ph_microstructure_free(&micro);
    CHECK_END();
}

static void test_case_title_units_seed(void **state)
{
    (void)state;
    ph_microstructure *micro = sample_micro(PH_PLANE_STRAIN);
    ph_result *r = sample_result(micro, PH_POINTS_NODES, 0);
    ph_case c;
    ph_material material = micro->materials[0];
    sample_case(&c);
    c.nmaterials = 1;
    c.materials = &material;
    json_t *root = document(r, &c, NULL);
    check_text(root, "title", "Sample & <test>");
    check_text(root, "units.length", "um");
    check_text(root, "units.stress", "GPa");
    check_text(root, "units.time", "s");
    check_number(root, "seed", 42);
    CHECK(json_is_object(at(root, "case")));
    CHECK(json_object_size(at(root, "reasons")) == 0);
    json_decref(root);
    ph_result_free(&r);
    ph_microstructure_free(&micro);
    CHECK_END();
}

static void test_plane_has_only_its_own_constants(void **state)
{
    (void)state;
    ph_microstructure *micro = sample_micro(PH_PLANE_STRESS);
    ph_result *r = sample_result(micro, PH_POINTS_NODES, 0);
    json_t *root = document(r, NULL, NULL);
    static const char *const keys[] = {"E1", "E2", "nu12", "nu21", "G12"};
    for (size_t i = 0; i < 5; i++)
        CHECK(json_is_real(json_object_get(at(root, "effective.engineering"), keys[i])));
    CHECK(json_object_size(at(root, "effective.engineering")) == 5);
    check_text(root, "effective.notation", "voigt 11 22 12, engineering shear");
    check_matrix(root, "effective.stiffness", &r->stiffness, true);
    CHECK(json_array_size(at(root, "grid.nodes")) == 2);
    json_decref(root);
    ph_result_free(&r);
    ph_microstructure_free(&micro);
    CHECK_END();
}

static void test_unsolved_loads_are_null(void **state)
{
    (void)state;
    ph_microstructure *micro = sample_micro(PH_SPACE);
    ph_result *r = sample_result(micro, PH_POINTS_NODES, 0);
    r->loads = r->solved = 1u << 0 | 1u << 5;
    r->nloads = 2;
    for (int k = 0; k < 36; k++)
        if (!(r->loads >> k % 6 & 1u)) r->stiffness.m[k / 6][k % 6] = 0;
    json_t *root = document(r, NULL, NULL);
    double voigt[36];
    char path[64];
    ph_sym4_to_voigt(&r->stiffness, true, voigt);
    for (int k = 0; k < 36; k++) {
        snprintf(path, sizeof path, "effective.stiffness.%d.%d", k / 6, k % 6);
        if (k % 6 == 0 || k % 6 == 5)
            check_number(root, path, voigt[k]);
        else if (k / 6 == 0 || k / 6 == 5) /* C16 beside C61: the tensor is symmetric */
            check_number(root, path, voigt[k % 6 * 6 + k / 6]);
        else
            CHECK(json_is_null(at(root, path)));
    }
    CHECK(json_is_null(at(root, "effective.compliance")));
    CHECK(json_is_null(at(root, "effective.engineering.E1")));
    CHECK(json_is_null(at(root, "effective.isotropic.K")));
    CHECK(json_array_size(at(root, "solver.loads")) == 2);
    const char *why = json_string_value(
        json_object_get(json_object_get(root, "reasons"), "effective.stiffness"));
    CHECK(why && strstr(why, "22 33 23 13"));
    json_decref(root);
    ph_result_free(&r);
    ph_microstructure_free(&micro);
    CHECK_END();
}

static void test_what_is_not_a_number_is_null_with_a_reason(void **state)
{
    (void)state;
    ph_microstructure *micro = sample_micro(PH_SPACE);
    ph_result *r = sample_result(micro, PH_POINTS_NODES, 0);
    memset(r->stiffness.m, 0, sizeof r->stiffness.m); /* all void: no compliance */
    r->hill_mandel = NAN;
    r->residual[1] = INFINITY;
    r->reuss_is_zero = true;
    r->converged = false;
    snprintf(r->names[1], sizeof r->names[1], "fibre \xff"); /* not UTF-8 */
    json_t *root = document(r, NULL, NULL);
    CHECK(json_is_null(at(root, "quality.hill_mandel")));
    CHECK(json_is_null(at(root, "solver.residual.1")));
    CHECK(json_is_null(at(root, "effective.compliance")));
    CHECK(json_is_null(at(root, "effective.engineering.nu23")));
    CHECK(json_is_false(at(root, "solver.converged")));
    check_number(root, "bounds.reuss.stiffness.0.0", 0);
    check_number(root, "fractions.fibre ?", r->fractions[1]);
    json_decref(root);
    ph_result_free(&r);
    ph_microstructure_free(&micro);
    CHECK_END();
}

static void test_refuses_what_it_cannot_write(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_result empty = {.nloads = 0};
    char *text = (char *)&empty;
    CHECK(ph_result_to_json(NULL, NULL, NULL, &text, &err) == PH_EINVAL);
    CHECK(ph_result_to_json(&empty, NULL, NULL, &text, NULL) == PH_EINVAL);
    CHECK(text == (char *)&empty);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_numbers_come_back_as_they_were),
        cmocka_unit_test(test_solver_quality_cost_notes),
        cmocka_unit_test(test_case_title_units_seed),
        cmocka_unit_test(test_plane_has_only_its_own_constants),
        cmocka_unit_test(test_unsolved_loads_are_null),
        cmocka_unit_test(test_what_is_not_a_number_is_null_with_a_reason),
        cmocka_unit_test(test_refuses_what_it_cannot_write),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
