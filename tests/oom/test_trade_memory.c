/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every allocation of a trade fails once. */
#define _XOPEN_SOURCE 700 /* nftw */
#include "folder.h"
#include "oom/countdown.h"

#include <jansson.h>

#include <perihom_trade.h>

static struct {
    char path[128];
    ph_trade *t, *made;
    char *text;
} w;

/* One row that needs no equations, kept in a journal. */
static ph_status sweep(void *user, ph_error *err)
{
    (void)user;
    static const char *const set = "constraint=voigt", *const knob = "nodes",
                             *const constant = "C11";
    const ph_trade_params p = {.path = w.path,
                               .sets = &set,
                               .nsets = 1,
                               .constants = &constant,
                               .nconstants = 1,
                               .knobs = &knob,
                               .nknobs = 1,
                               .finest = 4,
                               .folder = folder};
    char rows[128];
    snprintf(rows, sizeof rows, "%s/rows.jsonl", folder);
    remove(rows);
    return ph_trade_run(&p, &w.made, NULL, err);
}

static ph_status to_json(void *user, ph_error *err)
{
    (void)user;
    return ph_trade_to_json(w.t, &w.text, err);
}

static ph_status to_csv(void *user, ph_error *err)
{
    (void)user;
    return ph_trade_to_csv(w.t, &w.text, err);
}

static ph_status to_html(void *user, ph_error *err)
{
    (void)user;
    return ph_trade_to_html(w.t, &w.text, err);
}

static bool untouched(const void *user)
{
    (void)user;
    return !w.made && !w.text;
}

static void done(void *user)
{
    (void)user;
    ph_trade_free(&w.made);
    free(w.text);
    w.text = NULL;
}

static void test_every_allocation(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    snprintf(w.path, sizeof w.path, "%s/case.yaml", folder);
    FILE *f = fopen(w.path, "w");
    if (!f) fail();
    fputs("perihom: 1\nmaterials: {m: {E: 1, nu: 0.3}, f: {E: 10, nu: 0.2}}\n"
          "microstructure: {dimension: 2, plane: strain, size: [1, 1], nodes: [4, 4],\n"
          "  matrix: m, inclusions: [{shape: layer, normal: 1, from: 0, to: 0.5, "
          "material: f}]}\n",
          f);
    fclose(f);
    CHECK_OK(sweep(NULL, &err));
    w.t = w.made;
    w.made = NULL;
    CHECK(w.t && w.t->nrows == 1 && w.t->row[0].state == PH_TRADE_DONE);
    countdown_run("ph_trade_run", sweep, untouched, done, NULL);
    json_set_alloc_funcs(countdown_malloc, countdown_free);
    countdown_run("ph_trade_to_json", to_json, untouched, done, NULL);
    countdown_run("ph_trade_to_csv", to_csv, untouched, done, NULL);
    countdown_run("ph_trade_to_html", to_html, untouched, done, NULL);
    ph_trade_free(&w.t);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_every_allocation, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
