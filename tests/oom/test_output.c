/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/sample.h"
#include "oom/countdown.h"

#include <jansson.h>

/* Inputs and outputs of every call under test. */
typedef struct world {
    ph_microstructure *micro;
    ph_result *result;
    ph_case c;
    char folder[256], base[300], png[300], h5[300];
    char *text;
    ph_fields_file *file;
    ph_microstructure *made;
} world;

static world w;

static int set_up(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    w.micro = sample_micro(PH_SPACE);
    w.result = sample_result(w.micro, PH_POINTS_STRESS, 3);
    sample_case(&w.c);
    w.c.nmaterials = w.micro->nmaterials;
    w.c.materials = w.micro->materials;
    sample_folder(w.folder);
    snprintf(w.base, sizeof w.base, "%s/f", w.folder);
    snprintf(w.h5, sizeof w.h5, "%s/old.h5", w.folder);
    snprintf(w.png, sizeof w.png, "%s/a.png", w.folder);
    snprintf(w.base, sizeof w.base, "%s/old", w.folder);
    assert_int_equal(ph_write_fields(w.base, w.micro, w.result, &w.c, &err), PH_OK);
    snprintf(w.base, sizeof w.base, "%s/f", w.folder);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    ph_result_free(&w.result);
    ph_microstructure_free(&w.micro);
    sample_remove_folder(w.folder);
    return 0;
}

static bool outputs_untouched(const void *user)
{
    (void)user;
    return !w.text && !w.file && !w.made && sample_entries(w.folder, false) == 2;
}

static void free_outputs(void *user)
{
    (void)user;
    free(w.text);
    w.text = NULL;
    ph_fields_file_free(&w.file);
    ph_microstructure_free(&w.made);
    remove(w.png);
    char path[400];
    snprintf(path, sizeof path, "%s.h5", w.base);
    remove(path);
    snprintf(path, sizeof path, "%s.xdmf", w.base);
    remove(path);
}

static ph_status result_to_json(void *user, ph_error *err)
{
    (void)user;
    return ph_result_to_json(w.result, NULL, "perihom run", &w.text, err);
}

static ph_status case_to_json(void *user, ph_error *err)
{
    (void)user;
    return ph_case_to_json(&w.c, &w.text, err);
}

static ph_status write_fields(void *user, ph_error *err)
{
    (void)user;
    return ph_write_fields(w.base, w.micro, w.result, &w.c, err);
}

static ph_status read_fields(void *user, ph_error *err)
{
    (void)user;
    return ph_read_fields(w.h5, ~0u, &w.file, err);
}

static ph_status write_phases(void *user, ph_error *err)
{
    (void)user;
    return ph_write_phases_png(w.png, w.micro, 3, "phases", err);
}

static ph_status write_field(void *user, ph_error *err)
{
    (void)user;
    return ph_write_png(w.png, &w.micro->grid, w.result->fields[0].stress, 3, "s", err);
}

static ph_status microstructure_new(void *user, ph_error *err)
{
    (void)user;
    return ph_microstructure_new(&w.micro->grid, 3, w.micro->materials, &w.made, err);
}

static void test_json(void **state)
{
    (void)state;
    json_set_alloc_funcs(countdown_malloc, countdown_free);
    countdown_run("ph_result_to_json", result_to_json, outputs_untouched, free_outputs,
                  NULL);
    countdown_run("ph_case_to_json", case_to_json, outputs_untouched, free_outputs, NULL);
    w.c.solver.tolerance = INFINITY; /* this is no want of memory */
    ph_error err = PH_ERROR_INIT;
    CHECK(ph_case_to_json(&w.c, &w.text, &err) == PH_EINVAL && strstr(err.msg, "finite"));
    w.c.solver.tolerance = 0;
    CHECK_END();
}

static void test_fields(void **state)
{
    (void)state;
    countdown_run("ph_write_fields", write_fields, outputs_untouched, free_outputs, NULL);
    countdown_run("ph_read_fields", read_fields, outputs_untouched, free_outputs, NULL);
    CHECK_END();
}

static void test_pictures(void **state)
{
    (void)state;
    countdown_run("ph_write_phases_png", write_phases, outputs_untouched, free_outputs,
                  NULL);
    countdown_run("ph_write_png", write_field, outputs_untouched, free_outputs, NULL);
    CHECK_END();
}

static void test_microstructure(void **state)
{
    (void)state;
    countdown_run("ph_microstructure_new", microstructure_new, outputs_untouched,
                  free_outputs, NULL);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_json),
        cmocka_unit_test(test_fields),
        cmocka_unit_test(test_pictures),
        cmocka_unit_test(test_microstructure),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
