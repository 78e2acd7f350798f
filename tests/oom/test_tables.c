/* SPDX-License-Identifier: GPL-3.0-or-later */
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
    return !w.made && !w.text && sample_entries(w.folder, false) == 0;
}

static void done(void *user)
{
    (void)user;
    ph_table_free(&w.made);
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
        cmocka_unit_test(test_tables),
        cmocka_unit_test(test_plots),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
