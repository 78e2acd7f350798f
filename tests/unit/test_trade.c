/* SPDX-License-Identifier: GPL-3.0-or-later */
#define _XOPEN_SOURCE 700 /* nftw */
#include "folder.h"

#include <jansson.h>

#include <perihom_trade.h>

/* A disk in a matrix: rows that take no time. */
static const char text[] =
    "perihom: 1\n"
    "title: A disk & a half\n"
    "materials: {m: {E: 1, nu: 0.3}, f: {E: 10, nu: 0.2}}\n"
    "microstructure:\n"
    "  dimension: 2\n"
    "  plane: strain\n"
    "  size: [1, 1]\n"
    "  nodes: [12, 12]\n"
    "  matrix: m\n"
    "  inclusions: [{shape: disk, centre: [0.5, 0.5], radius: 0.3, "
    "material: f}]\n";

static const char *write_case(const char *what)
{
    static char path[128];
    snprintf(path, sizeof path, "%s/case.yaml", folder);
    FILE *f = fopen(path, "w");
    CHECK(f != NULL);
    if (f) {
        fputs(what, f);
        fclose(f);
    }
    return path;
}

/* ---- the front and the advice, of rows that nobody solved ---- */

enum { ROWS = 60 };

static ph_trade *random_rows(uint64_t *seed)
{
    ph_trade *t = calloc(1, sizeof *t);
    t->row = calloc(ROWS, sizeof *t->row);
    t->nrows = t->capacity = ROWS;
    t->nconstants = 1;
    t->reference[0] = 100;
    t->constant[0].stress = 1;
    for (int i = 0; i < ROWS; i++) {
        ph_trade_row *r = &t->row[i];
        snprintf(r->knob, sizeof r->knob, "grid");
        snprintf(r->family, sizeof r->family, "%c", 'a' + i % 4);
        r->realisations = 1;
        r->nodes = 1 + i / 4;
        r->work = floor(check_uniform(seed, 1, 20)); /* some are equal */
        r->value[0] = 100 * (1 + check_uniform(seed, -0.05, 0.05));
        if (i % 11 == 0) r->state = PH_TRADE_FAILED;
    }
    return t;
}

static bool is_beaten(const ph_trade *t, int i, bool by_front)
{
    const ph_trade_row *r = &t->row[i];
    for (int j = 0; j < t->nrows; j++) {
        const ph_trade_row *o = &t->row[j];
        if (j == i || o->state != PH_TRADE_DONE || (by_front && !o->front)) continue;
        if (o->work <= r->work && o->error <= r->error &&
            (o->work < r->work || o->error < r->error))
            return true;
    }
    return false;
}

static void test_front_is_what_nothing_beats(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int trial = 0; trial < check_trials(50); trial++) {
        ph_trade *t = random_rows(&seed);
        ph_trade_judge(t);
        for (int i = 0; i < ROWS; i++) {
            const ph_trade_row *r = &t->row[i];
            if (r->state != PH_TRADE_DONE) {
                CHECK(!r->front);
                continue;
            }
            CHECK_ABS(r->error, fabs(r->value[0] / 100 - 1), 1e-15);
            if (r->front) CHECK(!is_beaten(t, i, false));
            /* what is not on it is beaten by a row that is, or stands there twice */
            if (!r->front) CHECK(is_beaten(t, i, true));
        }
        ph_trade_free(&t);
    }
    CHECK_END();
}

static void test_advice_is_the_cheapest_that_stays_good(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int trial = 0; trial < check_trials(50); trial++) {
        ph_trade *t = random_rows(&seed);
        for (int i = 0; i < ROWS; i++) /* errors fall with the grid, some by chance */
            t->row[i].value[0] =
                100 + (t->row[i].value[0] - 100) * 3 / (double)t->row[i].nodes;
        ph_trade_judge(t);
        for (int k = 0; k < PH_TRADE_TARGETS; k++) {
            const ph_trade_advice *a = &t->advice[k];
            double cheapest = HUGE_VAL;
            for (int i = 0; i < ROWS; i++) {
                const ph_trade_row *r = &t->row[i];
                bool good = r->state == PH_TRADE_DONE && r->error <= a->target;
                for (int j = 0; j < ROWS; j++)
                    good &= !(t->row[j].state == PH_TRADE_DONE && j % 4 == i % 4 &&
                              t->row[j].nodes > r->nodes && t->row[j].error > a->target);
                if (good) cheapest = fmin(cheapest, r->work);
            }
            CHECK((a->row >= 0) == (cheapest < HUGE_VAL));
            if (a->row >= 0) CHECK(t->row[a->row].work == cheapest);
            if (a->row >= 0) CHECK(t->row[a->row].error <= a->target);
        }
        ph_trade_free(&t);
    }
    CHECK_END();
}

static void test_error_of_a_small_ratio(void **state)
{
    (void)state;
    const ph_quantity E = {.stress = 1}, nu = {.stress = 0};
    CHECK_REL(ph_trade_error(&E, 1.02, 1), 0.02, 1e-12);
    CHECK_REL(ph_trade_error(&nu, 0.306, 0.3), 0.02, 1e-12);
    CHECK_REL(ph_trade_error(&nu, 0.003, 0.001), 0.02, 1e-12); /* over 0.1 */
    CHECK_END();
}

/* ---- a sweep ---- */

typedef struct stopper {
    int after; /* rows; 0: never */
    int rows;
} stopper;

static bool count_rows(void *user, const ph_trade_progress *now)
{
    stopper *s = user;
    if (now->row) s->rows++;
    return s->after == 0 || s->rows < s->after;
}

static ph_trade *run(const char *path, const char *into, stopper *s, double budget,
                     ph_status want)
{
    ph_error err = PH_ERROR_INIT;
    ph_trade *t = NULL;
    const ph_trade_params p = {.path = path,
                               .folder = into,
                               .finest = 16,
                               .budget = budget,
                               .progress = count_rows,
                               .user = s};
    ph_status st = ph_trade_run(&p, &t, NULL, &err);
    if (st != want) print_error("%s\n", err.msg);
    CHECK(st == want && t);
    return t;
}

static void check_same(const ph_trade *a, const ph_trade *b)
{
    CHECK(a->nrows == b->nrows);
    for (int i = 0; i < a->nrows && i < b->nrows; i++) {
        const ph_trade_row *x = &a->row[i], *y = &b->row[i];
        CHECK(strcmp(x->setting, y->setting) == 0 && x->state == y->state);
        CHECK(x->applications == y->applications && x->ffts == y->ffts);
        CHECK(x->iterations == y->iterations && x->work == y->work);
        CHECK(x->front == y->front && x->nodes == y->nodes);
        CHECK(memcmp(x->value, y->value, sizeof x->value) == 0);
    }
}

/* Counters and values are those of another run; what stopped and went on is the same. */
static void test_sweep_repeats_and_resumes(void **state)
{
    (void)state;
    const char *path = write_case(text);
    stopper s = {0}, few = {.after = 20};
    ph_trade *one = run(path, NULL, &s, 0, PH_OK);
    ph_trade *cut = run(path, folder, &few, 0, PH_ECANCELLED);
    CHECK(cut && cut->nrows >= 19 && cut->nrows <= 20);
    s = (stopper){0};
    ph_trade *on = run(path, folder, &s, 0, PH_OK);
    int kept = 0, refused = 0;
    for (int i = 0; on && i < on->nrows; i++) {
        kept += on->row[i].kept;
        refused += on->row[i].state == PH_TRADE_REFUSED;
    }
    CHECK(kept >= 15);   /* rows that are not refused of those 20 */
    CHECK(refused >= 1); /* bonds want a Poisson's ratio of 1/4 */
    if (one && on) check_same(one, on);
    CHECK(one && one->complete && one->reference_error > 0);
    ph_trade_free(&one);
    ph_trade_free(&cut);
    ph_trade_free(&on);
    CHECK_END();
}

/* The advised settings, solved apart, are as good as promised. */
static void test_advice_holds(void **state)
{
    (void)state;
    const char *path = write_case(text);
    stopper s = {0};
    ph_trade *t = run(path, NULL, &s, 0, PH_OK);
    int given = 0;
    for (int k = 0; t && k < PH_TRADE_TARGETS; k++) {
        const ph_trade_advice *a = &t->advice[k];
        if (a->row < 0) continue;
        ph_error err = PH_ERROR_INIT;
        const ph_trade_row *r = &t->row[a->row];
        const char *sets[PH_TRADE_SETS];
        ph_case *c = NULL;
        ph_evaluation e = {0};
        for (int i = 0; i < r->nsets; i++) {
            sets[i] = r->set[i];
            CHECK(strstr(a->command, r->set[i]) != NULL);
        }
        CHECK_OK(ph_case_read(path, sets, (size_t)r->nsets, &c, NULL, &err));
        const ph_scenario one = {c, 0, t->nconstants, t->constant};
        if (c) CHECK_OK(ph_scenario_evaluate(&one, NULL, &e, &err));
        for (int i = 0; i < t->nconstants; i++)
            CHECK(ph_trade_error(&t->constant[i], e.value[i], t->reference[i]) <=
                  a->target);
        ph_case_free(&c);
        given++;
    }
    CHECK(given >= 1);
    ph_trade_free(&t);
    CHECK_END();
}

static void test_budget_skips(void **state)
{
    (void)state;
    const char *path = write_case(text);
    stopper s = {0};
    ph_trade *t = run(path, NULL, &s, 1e-9, PH_OK);
    int skipped = 0;
    for (int i = 0; t && i < t->nrows; i++)
        skipped += t->row[i].state == PH_TRADE_SKIPPED;
    CHECK(t && !t->complete && skipped > 10);
    /* the one grid that was solved is no reference of itself: no error, no advice */
    CHECK(t && t->row[0].state == PH_TRADE_DONE && isnan(t->row[0].error));
    CHECK(t && isnan(t->reference[0]) && isnan(t->reference_error));
    CHECK(t && strstr(t->reference_kind, "none: only one grid") == t->reference_kind);
    CHECK(t && strstr(t->reference_kind, "would not fit into the budget"));
    for (int k = 0; t && k < PH_TRADE_TARGETS; k++)
        CHECK(t->advice[k].row == -1);
    ph_trade_free(&t);
    CHECK_END();
}

/* No grid that is allowed shows the fillers: the case as it is stays, without an error. */
static void test_no_grid_at_all(void **state)
{
    (void)state;
    static const char fillers[] =
        "perihom: 1\n"
        "materials: {m: {E: 1, nu: 0.3}, f: {E: 10, nu: 0.2}}\n"
        "microstructure: {dimension: 2, plane: strain, size: [1, 1], nodes: [32, 32],\n"
        "  matrix: m, fillers: [{shape: particle, material: f, volume_fraction: 0.1,\n"
        "  size: 0.2, placement: {gap: 0.01}}]}\n";
    static const char *const knob = "nodes";
    ph_error err = PH_ERROR_INIT;
    ph_trade *t = NULL;
    const ph_trade_params p = {
        .path = write_case(fillers), .knobs = &knob, .nknobs = 1, .finest = 6};
    CHECK_OK(ph_trade_run(&p, &t, NULL, &err));
    CHECK(t && t->nrows == 1 && t->row[0].nodes == 32 * 32 && isnan(t->row[0].error));
    CHECK(t && strstr(t->reference_kind, "none: only one grid"));
    ph_trade_free(&t);
    CHECK_END();
}

/* Single beside double, at the tolerance of the case and at 1e-4: the same constants to the
 * tolerance, less memory where nothing is refined (0.65 on 32^2). */
static void test_precision(void **state)
{
    (void)state;
    static const char *const knobs[] = {"nodes", "precision"};
    static const double same[] = {1e-5, 1e-3}; /* tolerance times contrast */
    static const double least[] = {0.8, 0.5}, most[] = {1.0, 0.8};
    ph_error err = PH_ERROR_INIT;
    ph_trade *t = NULL;
    const ph_trade_params p = {
        .path = write_case(text), .knobs = knobs, .nknobs = 2, .finest = 24};
    CHECK_OK(ph_trade_run(&p, &t, NULL, &err));
    const ph_trade_row *row[2][2] = {{NULL}}; /* [loose][single] */
    for (int i = 0; t && i < t->nrows; i++)
        if (strcmp(t->row[i].knob, "precision") == 0)
            row[strstr(t->row[i].setting, "1e-4") != NULL]
               [strstr(t->row[i].setting, "single") != NULL] = &t->row[i];
    for (int loose = 0; loose < 2; loose++) {
        const ph_trade_row *two = row[loose][0], *one = row[loose][1];
        CHECK(one && two && one->state == PH_TRADE_DONE && two->state == PH_TRADE_DONE);
        if (!one || !two) continue;
        for (int k = 0; k < t->nconstants; k++)
            CHECK_REL(one->value[k], two->value[k], same[loose]);
        double ratio = (double)one->bytes / (double)two->bytes;
        CHECK(ratio > least[loose] && ratio < most[loose]);
        CHECK(isfinite(one->error));
        CHECK(one->work >= two->work); /* counted as double is: it can only need more */
    }
    ph_trade_free(&t);
    CHECK_END();
}

static ph_status refuse(ph_trade_params p, ph_error *err)
{
    ph_trade *t = NULL;
    p.path = write_case(text);
    ph_status st = ph_trade_run(&p, &t, NULL, err);
    CHECK(t == NULL);
    return st;
}

static void test_what_is_refused(void **state)
{
    (void)state;
    const char *knob = "nodse", *constant = "E3";
    ph_error err = PH_ERROR_INIT;
    CHECK(refuse((ph_trade_params){.knobs = &knob, .nknobs = 1}, &err) == PH_EINVAL);
    CHECK(strstr(err.msg, "did you mean 'nodes'?") != NULL);
    err = (ph_error)PH_ERROR_INIT;
    CHECK(refuse((ph_trade_params){.constants = &constant, .nconstants = 1}, &err) ==
          PH_EINVAL); /* plane strain has none */
    err = (ph_error)PH_ERROR_INIT;
    CHECK(refuse((ph_trade_params){.reference = "E1=one"}, &err) == PH_EINVAL);
    CHECK(strstr(err.msg, "NAME=NUMBER") != NULL);
    static const char *const senseless[] = {"E1=0", "E1=inf", "E1=nan"};
    for (int i = 0; i < 3; i++) {
        err = (ph_error)PH_ERROR_INIT;
        CHECK(refuse((ph_trade_params){.reference = senseless[i]}, &err) == PH_EINVAL);
        CHECK(strstr(err.msg, "reference") != NULL && err.msg[0]);
    }
    err = (ph_error)PH_ERROR_INIT;
    constant = "E2";
    CHECK(refuse((ph_trade_params){.reference = "E1=1",
                                   .constants = &constant,
                                   .nconstants = 1},
                 &err) == PH_EINVAL);
    CHECK(strstr(err.msg, "no value of E2") != NULL);
    CHECK_END();
}

/* ---- what is written ---- */

static void test_documents(void **state)
{
    (void)state;
    const char *path = write_case(text);
    stopper s = {0};
    ph_error err = PH_ERROR_INIT;
    ph_trade *t = run(path, NULL, &s, 0, PH_OK);
    char *json = NULL, *csv = NULL, *html = NULL;
    if (!t) fail();
    CHECK_OK(ph_trade_to_json(t, &json, &err));
    CHECK_OK(ph_trade_to_csv(t, &csv, &err));
    CHECK_OK(ph_trade_to_html(t, &html, &err));
    json_t *d = json ? json_loads(json, 0, NULL) : NULL;
    CHECK(d && json_array_size(json_object_get(d, "rows")) == (size_t)t->nrows);
    CHECK(d && strcmp(json_string_value(json_object_get(d, "schema")),
                      "perihom.trade/1") == 0);
    json_decref(d);
    int lines = 0;
    for (const char *c = csv; c && *c; c++)
        lines += *c == '\n';
    CHECK(lines == t->nrows + 1);
    CHECK(html && strstr(html, "A disk &amp; a half") && strstr(html, "</html>"));
    CHECK(html && !strstr(html, "src=") && !strstr(html, "href=")); /* nothing beside */
    const char *first = html ? strstr(html, "<svg") : NULL;
    CHECK(first && strstr(first + 1, "<svg"));
    free(json);
    free(csv);
    free(html);
    ph_trade_free(&t);
    CHECK_END();
}

/* Operations grow with what is counted. */
static void test_work_follows_the_counters(void **state)
{
    (void)state;
    ph_result r = {.stiffness = {.n = 6},
                   .grid = {.kinematics = PH_SPACE, .n = {8, 8, 8}},
                   .route = "cells"};
    CHECK(ph_trade_work(NULL) == 0 && ph_trade_work(&r) == 0);
    r.work.ffts = 2;
    CHECK_REL(ph_trade_work(&r), 2 * 2.5 * 512 * 9, 1e-12);
    r.work.ffts = 0;
    r.work.applications = 1; /* 8 corners, 3 x 3 products twice; 6 x 6 */
    CHECK_REL(ph_trade_work(&r), 512 * (8 * 36 + 72), 1e-12);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_front_is_what_nothing_beats),
        cmocka_unit_test(test_advice_is_the_cheapest_that_stays_good),
        cmocka_unit_test(test_error_of_a_small_ratio),
        cmocka_unit_test_setup_teardown(test_sweep_repeats_and_resumes, set_up,
                                        tear_down),
        cmocka_unit_test_setup_teardown(test_advice_holds, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_budget_skips, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_no_grid_at_all, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_precision, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_what_is_refused, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_documents, set_up, tear_down),
        cmocka_unit_test(test_work_follows_the_counters),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
