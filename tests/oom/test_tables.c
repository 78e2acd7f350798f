/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/fit.h>
#include <perihom/plot.h>
#include <perihom/table.h>

#include "io/sample.h"
#include "oom/countdown.h"

static struct {
    ph_table *table, *made;
    char *text;
    char folder[256], svg[300], png[300];
    double x[3];
    ph_series series[6];
    ph_plot plot;
    ph_heatmap map;
    ph_prony_fit *fit;
} w;

static int set_up(void **state)
{
    (void)state;
    static const char *const name[] = {"time (s)", "E"};
    sample_folder(w.folder);
    snprintf(w.svg, sizeof w.svg, "%s/a.svg", w.folder);
    snprintf(w.png, sizeof w.png, "%s/a.png", w.folder);
    for (int i = 0; i < 3; i++)
        w.x[i] = i + 1;
    for (int k = 0; k < 6; k++) /* every style */
        w.series[k] =
            (ph_series){"s", 3, w.x, w.x, w.x, w.x, (ph_series_style)k, false, 0};
    w.plot = (ph_plot){
        .title = "t", .nseries = 6, .series = w.series, .width = 200, .height = 150};
    w.map = (ph_heatmap){
        .nx = 3, .ny = 1, .value = w.x, .width = 200, .height = 150, .cell_text = true};
    return ph_table_new(2, name, 2, &w.table, NULL) == PH_OK ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    ph_table_free(&w.table);
    sample_remove_folder(w.folder);
    return 0;
}

static bool untouched(const void *user)
{
    (void)user;
    return !w.made && !w.text && !w.fit && sample_entries(w.folder, false) == 0;
}

static void done(void *user)
{
    (void)user;
    ph_table_free(&w.made);
    ph_prony_fit_free(&w.fit);
    free(w.text);
    w.text = NULL;
    remove(w.svg);
    remove(w.png);
}

static ph_status parse(void *user, ph_error *err)
{
    (void)user;
    return ph_table_parse("a,b\n1,2\n", 8, "t", &w.made, err);
}

static ph_status make(void *user, ph_error *err)
{
    (void)user;
    static const char *const name[] = {"a"};
    return ph_table_new(1, name, 5, &w.made, err);
}

static ph_status to_csv(void *user, ph_error *err)
{
    (void)user;
    return ph_table_to_csv(w.table, &w.text, err);
}

static ph_status plot_svg(void *user, ph_error *err)
{
    (void)user;
    return ph_plot_svg(&w.plot, &w.text, err);
}

static ph_status write_svg(void *user, ph_error *err)
{
    (void)user;
    return ph_plot_write(w.svg, &w.plot, err);
}

static ph_status write_png(void *user, ph_error *err)
{
    (void)user;
    return ph_plot_write(w.png, &w.plot, err);
}

static ph_status map_svg(void *user, ph_error *err)
{
    (void)user;
    return ph_heatmap_svg(&w.map, &w.text, err);
}

static ph_status map_png(void *user, ph_error *err)
{
    (void)user;
    return ph_heatmap_write(w.png, &w.map, err);
}

/* Six points, one term: the search of its time takes few steps. */
static const double x6[] = {0.1, 0.3, 1, 3, 10, 30}, y6[] = {3, 2.8, 2.4, 1.5, 1.1, 1};

static ph_status fit_sought(void *user, ph_error *err)
{
    (void)user;
    const ph_prony_data d = {.n = 6, .x = x6, .value = y6};
    return ph_prony_fit_new(&d, &(ph_prony_fit_params){.terms = 1}, &w.fit, err);
}

static ph_status fit_creep(void *user, ph_error *err)
{
    (void)user;
    const double rising[] = {1, 1.1, 1.3, 1.7, 2.4, 2.5};
    const ph_prony_data d = {.kind = PH_PRONY_CREEP, .n = 6, .x = x6, .value = rising};
    return ph_prony_fit_new(&d, &(ph_prony_fit_params){.per_decade = 1}, &w.fit, err);
}

static ph_status overlap(void *user, ph_error *err)
{
    (void)user;
    double x[12], y[12], temperature[12], factor[12];
    for (int i = 0; i < 12;
         i++) { /* twice the same curve, moved by a third of its length */
        x[i] = 1 + i % 6;
        y[i] = 1 / (x[i] + (i < 6 ? 0 : 2));
        temperature[i] = i < 6 ? 20 : 30;
    }
    const ph_prony_data d = {.n = 12, .x = x, .value = y};
    return ph_shift_overlap(&d, temperature, 20, factor, NULL, err);
}

static ph_status shift_law(void *user, ph_error *err)
{
    (void)user;
    const double temperature[] = {110, 130}, factor[] = {20, 0.1};
    ph_shift law;
    return ph_shift_fit(PH_SHIFT_WLF, 2, temperature, factor, 120, 273.15, &law, NULL,
                        err);
}

static void test_fits(void **state)
{
    (void)state;
    countdown_run("ph_prony_fit_new, sought", fit_sought, untouched, done, NULL);
    countdown_run("ph_prony_fit_new, creep", fit_creep, untouched, done, NULL);
    countdown_run("ph_shift_overlap", overlap, untouched, done, NULL);
    countdown_run("ph_shift_fit", shift_law, untouched, done, NULL);
    CHECK_END();
}

static void test_tables(void **state)
{
    (void)state;
    countdown_run("ph_table_parse", parse, untouched, done, NULL);
    countdown_run("ph_table_new", make, untouched, done, NULL);
    countdown_run("ph_table_to_csv", to_csv, untouched, done, NULL);
    CHECK_END();
}

static void test_plots(void **state)
{
    (void)state;
    countdown_run("ph_plot_svg", plot_svg, untouched, done, NULL);
    countdown_run("ph_plot_write svg", write_svg, untouched, done, NULL);
    countdown_run("ph_plot_write png", write_png, untouched, done, NULL);
    countdown_run("ph_heatmap_svg", map_svg, untouched, done, NULL);
    countdown_run("ph_heatmap_write png", map_png, untouched, done, NULL);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_fits),
        cmocka_unit_test(test_tables),
        cmocka_unit_test(test_plots),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
