/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "check.h"
#include "oom/countdown.h"
#include "synthetic.h"

#include <jansson.h>

#include <unistd.h>

typedef struct world {
    synthetic_fit f;
    ph_fit *fit;
    ph_fit_file *file;
    char *json;
    char path[300];
} world;

static ph_status calibrate(void *user, ph_error *err)
{
    world *w = user;
    const ph_fit_params how = {.samples = 40, .at_least = 2, .at_most = 3};
    const ph_ctx ctx = {.threads = 1};
    return ph_calibrate(&w->f.problem, &how, &ctx, &w->fit, err);
}

static bool no_fit(const void *user)
{
    return ((const world *)user)->fit == NULL;
}

static void free_fit(void *user)
{
    ph_fit_free(&((world *)user)->fit);
}

static void setup(world *w)
{
    static const double kappa = 15;
    *w = (world){.fit = NULL};
    synthetic_setup(&w->f, 3, 0.05);
    w->f.problem.user = &w->f.model;
    w->f.problem.unknown = w->f.unknown;
    w->f.problem.measurement = w->f.measurement;
    w->f.problem.random = true;
    w->f.model.noise = 1;
    synthetic_measure(&w->f, &kappa, 0.05, 1);
}

static void test_calibrate(void **state)
{
    world w;
    (void)state;
    setup(&w);
    countdown_run("ph_calibrate", calibrate, no_fit, free_fit, &w);
    CHECK_END();
}

static ph_status read_file(void *user, ph_error *err)
{
    world *w = user;
    static const char *const sets[] = {"model.horizon=2"};
    ph_case_issues issues = {0};
    ph_status st = ph_fit_file_read(w->path, sets, 1, &w->file, &issues, NULL, err);
    ph_case_issues_free(&issues);
    return st;
}

static bool no_file(const void *user)
{
    return ((const world *)user)->file == NULL;
}

static void free_file(void *user)
{
    ph_fit_file_free(&((world *)user)->file);
}

static ph_status to_json(void *user, ph_error *err)
{
    world *w = user;
    return ph_fit_to_json(w->file, w->fit, NULL, &w->json, err);
}

static bool no_json(const void *user)
{
    return ((const world *)user)->json == NULL;
}

static void free_json(void *user)
{
    free(((world *)user)->json);
}

static void test_file(void **state)
{
    world w;
    char folder[] = "/tmp/perihom-oom-XXXXXX", data[300];
    ph_error err = PH_ERROR_INIT;
    (void)state;
    setup(&w);
    assert_non_null(mkdtemp(folder));
    snprintf(w.path, sizeof w.path, "%s/k.yaml", folder);
    snprintf(data, sizeof data, "%s/d.csv", folder);
    FILE *to = fopen(w.path, "w");
    fprintf(to,
            "calibration: 1\ncase: %s/cli/calibrate/tiny-clay.yaml\n"
            "unknowns: {microstructure.fillers.0.interphase.kappa: {from: 0.01, to: 100, "
            "scale: log}}\ndata: {file: d.csv, columns: "
            "{microstructure.fillers.0.weight_fraction: w, E1: E, sigma: s}}\n",
            PH_TEST_DIR);
    fclose(to);
    to = fopen(data, "w");
    fprintf(to, "w,E,s\n0.01,3.5,0.1\n0.02,3.6,0.1\n0.05,3.7,0.1\n");
    fclose(to);
    json_set_alloc_funcs(countdown_malloc, countdown_free);
    countdown_run("ph_fit_file_read", read_file, no_file, free_file, &w);
    CHECK_OK(read_file(&w, &err));
    CHECK_OK(calibrate(&w, &err));
    countdown_run("ph_fit_to_json", to_json, no_json, free_json, &w);
    free_file(&w);
    free_fit(&w);
    unlink(w.path);
    unlink(data);
    rmdir(folder);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_calibrate),
                                       cmocka_unit_test(test_file)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
