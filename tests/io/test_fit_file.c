/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Calibration files: what is read, what is refused, and what the journal keeps. */
#include "io/sample.h"

#include <jansson.h>

#include <perihom_calibrate.h>

typedef struct world {
    char folder[256], path[300], data[300];
} world;

static void put(const char *path, const char *text)
{
    FILE *to = fopen(path, "w");
    assert_non_null(to);
    fputs(text, to);
    fclose(to);
}

static const char good_data[] = "w,E,s,nu\n1,3.6,0.05,0.33\n2.5,3.8,0.05,\n2.5,3.9,0.06,"
                                "0.32\n5,4.1,0.06,0.31\n";
static const char good_rest[] =
    "unknowns:\n  microstructure.fillers.0.interphase.kappa: {from: 0.01, to: 100, "
    "scale: "
    "log, start: 2}\n  materials.epoxy.E: {from: 3, to: 4, name: matrix}\n"
    "data:\n  file: d.csv\n  columns:\n"
    "    microstructure.fillers.0.weight_fraction: {column: w, factor: 0.01}\n"
    "    E1: E\n    nu12: nu\n    sigma: {E1: s, nu12: {relative: 0.1}}\n"
    "budget: {relative_error: 0.05, at_least: 4, realisations: 50, seconds: 9}\n"
    "posterior: {samples: 100, seed: 7}\nstarts: 2\n";

static ph_status read_text(const world *w, const char *rest, const char *data,
                           ph_fit_file **out, ph_case_issues *issues, ph_error *err)
{
    char text[4096];
    snprintf(text, sizeof text,
             "calibration: 1\ncase: %s/cli/calibrate/tiny-clay.yaml\n%s", PH_TEST_DIR,
             rest);
    put(w->path, text);
    put(w->data, data);
    return ph_fit_file_read(w->path, NULL, 0, out, issues, NULL, err);
}

static void set_up(world *w)
{
    sample_folder(w->folder);
    snprintf(w->path, sizeof w->path, "%s/k.yaml", w->folder);
    snprintf(w->data, sizeof w->data, "%s/d.csv", w->folder);
}

static void test_read(void **state)
{
    world w;
    ph_error err = PH_ERROR_INIT;
    ph_fit_file *f = NULL;
    (void)state;
    set_up(&w);
    CHECK_OK(read_text(&w, good_rest, good_data, &f, NULL, &err));
    CHECK(f->nunknowns == 2 && f->noutputs == 2 && f->nkeys == 1);
    CHECK(strcmp(f->unknown[0].name, "kappa") == 0 && f->unknown[0].log);
    CHECK(strcmp(f->unknown[1].name, "matrix") == 0 && !f->unknown[1].log);
    CHECK(f->unknown[0].start == 2 && isnan(f->unknown[1].start));
    CHECK(strcmp(f->unknown_key[1], "materials.epoxy.E") == 0);
    /* two rows agree in their key and are one point; an empty cell is no measurement */
    CHECK(f->npoints == 3 && f->nmeasurements == 7);
    CHECK(f->place[1][0] == 0.01 * 2.5 && f->line[1] == 3 && f->line[2] == 5);
    CHECK(f->measurement[3].point == 1 && f->measurement[3].value == 3.9);
    CHECK(f->measurement[3].sigma == 0.06);
    CHECK_REL(f->measurement[4].sigma, 0.032, 1e-15);
    CHECK(f->params.at_least == 4 && f->params.at_most == 50 && f->params.seconds == 9 &&
          f->params.relative_error == 0.05 && f->params.samples == 100 &&
          f->params.seed == 7 && f->params.starts == 2);
    ph_fit_file_free(&f);
    CHECK(f == NULL);
    ph_fit_file_free(NULL);
    sample_remove_folder(w.folder);
    CHECK_END();
}

/* One change of the good file each: what the complaint must say. */
static void test_bad(void **state)
{
    static const struct {
        const char *from, *to, *says;
    } bad[] = {
        {"from: 0.01", "from: 0", "0 is not admissible: must be > 0 with scale: log"},
        {"to: 100", "to: .nan", "must be a number"},
        {"scale: log", "scale: logarithmic", "must be linear or log"},
        {"start: 2", "start: 200", "must lie between from and to, 0.01 to 100"},
        {"start: 2", "begin: 2", "unknown key"},
        {"unknowns:", "unknown:", "did you mean 'unknowns'"},
        {"unknowns:\n", "unknowns: {}\nu:\n", "0 unknowns: must be 1 to 8"},
        {"materials.epoxy.E", "materials.epoxi.E", "epoxi"},
        {"materials.epoxy.E: {", "materials.epoxy.nu: {", "is not admissible"},
        {"  file: d.csv\n", "", "data.file: missing"},
        {"file: d.csv", "file: e.csv", "e.csv"},
        {"    E1: E\n", "    E7: E\n", "data.columns.E7"},
        {"    E1: E\n", "    E3: E\n", "E3"},
        {"    E1: E\n", "    E1: F\n", "d.csv has the columns w, E, s and nu"},
        {"{relative: 0.1}", "{relative: -1}", "must be a standard deviation > 0"},
        {"E1: s, ", "", "every measured quantity needs its sigma"},
        {"relative_error: 0.05", "relative_error: 5", "between 0 and 1"},
        {"at_least: 4", "at_least: 0", "k.yaml"},
        {"samples: 100", "samples: 1.5", "must be an integer"},
        {"starts: 2", "starts: 99", "from 1 to 8"},
    };
    world w;
    (void)state;
    set_up(&w);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char text[2048];
        const char *at = strstr(good_rest, bad[i].from);
        assert_non_null(at);
        snprintf(text, sizeof text, "%.*s%s%s", (int)(at - good_rest), good_rest,
                 bad[i].to, at + strlen(bad[i].from));
        ph_error err = PH_ERROR_INIT;
        ph_case_issues issues = {0};
        ph_fit_file *f = NULL;
        ph_status st = read_text(&w, text, good_data, &f, &issues, &err);
        bool said = false;
        for (size_t k = 0; k < issues.count; k++)
            said |= strstr(issues.item[k].message, bad[i].says) != NULL;
        said |= strstr(err.msg, bad[i].says) != NULL;
        if (!said) print_error("'%s': %s\n", bad[i].to, err.msg);
        CHECK(said);
        CHECK(st != PH_OK && f == NULL);
        ph_case_issues_free(&issues);
        ph_fit_file_free(&f);
    }
    sample_remove_folder(w.folder);
    CHECK_END();
}

static void test_bad_data(void **state)
{
    static const char *const bad[][2] = {
        {"w,E,s,nu\n1,nan,0.05,0.33\n", "2 unknowns and 1 measurement"},
        {"w,E,s,nu\n1,,0.05,\n", "no measured value"},
        {"w,E,s,nu\nnan,3,0.05,0.3\n", "d.csv:2: column 'w': no number"},
        {"w,E,s,nu\n1,3,0,0.3\n", "d.csv:2: sigma of E1 is 0"},
        {"w,E,s,nu\n1,3,-1,0.3\n", "sigma of E1 is -1"},
        {"w,E,s,nu\n1,inf,1,0.3\n", "d.csv:2"},
        {"w,E,s,nu\n1,3,0.05\n", "d.csv:2"},
        {"w,E,s,nu\n", "no measured value"},
        {"", "d.csv"},
        {"w,E,s,nu\n-5,3,0.1,0.3\n", "weight_fraction"},
    };
    world w;
    (void)state;
    set_up(&w);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        ph_error err = PH_ERROR_INIT;
        ph_fit_file *f = NULL;
        ph_status st = read_text(&w, good_rest, bad[i][0], &f, NULL, &err);
        if (!strstr(err.msg, bad[i][1])) print_error("'%s': %s\n", bad[i][0], err.msg);
        CHECK(st != PH_OK && f == NULL && strstr(err.msg, bad[i][1]));
    }
    sample_remove_folder(w.folder);
    CHECK_END();
}

/* The document: what scripts rely on. */
static void test_document(void **state)
{
    static const char rest[] =
        "unknowns: {materials.epoxy.E: {from: 1, to: 10}}\n"
        "data: {file: d.csv, columns: {E1: E, sigma: 0.1}}\nbudget: {realisations: 1}\n";
    world w;
    ph_error err = PH_ERROR_INIT;
    ph_fit_file *f = NULL;
    ph_fit *fit = NULL;
    char *text = NULL;
    long solved = 0;
    const ph_ctx ctx = {.threads = 1};
    (void)state;
    set_up(&w);
    CHECK_OK(read_text(&w, rest, "E\n4\n4.2\n", &f, NULL, &err));
    CHECK(f->npoints == 1 && f->nmeasurements == 2);
    CHECK_OK(ph_fit_file_run(f, w.folder, false, &ctx, &fit, &solved, &err));
    CHECK(solved == fit->solves && solved > 0);
    CHECK_OK(ph_fit_to_json(f, fit, "perihom calibrate", &text, &err));
    json_t *doc = json_loads(text, 0, NULL);
    CHECK(doc != NULL);
    const json_t *x = json_object_get(json_object_get(doc, "unknowns"), "E");
    CHECK(json_number_value(json_object_get(x, "value")) == fit->unknown[0].value);
    CHECK(json_array_size(json_object_get(x, "interval95")) == 2);
    CHECK(json_array_size(json_object_get(doc, "points")) == 2);
    CHECK_ABS(json_number_value(json_object_get(doc, "misfit")), 2, 1e-3);
    /* One realisation: nothing is known of the scatter of the model. */
    CHECK(json_is_null(json_object_get(json_array_get(json_object_get(doc, "points"), 0),
                                       "model_error")));
    ph_fit *again = NULL;
    CHECK_OK(ph_fit_file_run(f, w.folder, false, &ctx, &again, &solved, &err));
    CHECK(solved == 0 && again->unknown[0].value == fit->unknown[0].value);
    json_decref(doc);
    free(text);
    ph_fit_free(&fit);
    ph_fit_free(&again);
    ph_fit_file_free(&f);
    sample_remove_folder(w.folder);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_read), cmocka_unit_test(test_bad),
        cmocka_unit_test(test_bad_data), cmocka_unit_test(test_document)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
