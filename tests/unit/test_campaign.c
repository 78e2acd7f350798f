/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The engine, with realisations whose distribution is known. */
#define _XOPEN_SOURCE 700 /* nftw */
#include "folder.h"

#include <perihom_campaign.h>
#include <signal.h>
#include <time.h>

/* A campaign of two points on a case that is never solved. */
static ph_campaign *campaign(const char *realisations)
{
    ph_error err = PH_ERROR_INIT;
    ph_campaign *c = NULL;
    char path[128], text[1024];
    int n = snprintf(text, sizeof text,
                     "campaign: 1\ncase: %s/cases/epoxy-clay.yaml\n"
                     "sweep: {model.horizon: [3, 4]}\noutputs: [E1, G12]\n"
                     "realisations: %s\n",
                     PH_DATA_DIR, realisations);
    snprintf(path, sizeof path, "%s/c.yaml", folder);
    CHECK_OK(ph_write_file(path, text, (size_t)n, &err));
    CHECK_OK(ph_campaign_read(path, NULL, 0, &c, NULL, &err));
    return c;
}

/* Mean 1 + point, deviation 0.05 (1 + point); each value a pure function of its index. */
static ph_status normal(void *user, const ph_scenario *s, int point, ph_evaluation *out,
                        ph_error *err)
{
    (void)user, (void)err;
    ph_random r = {.seed = 5, .realisation = s->realisation};
    double u = ph_random_uniform(&r), v = ph_random_uniform(&r);
    double z = sqrt(-2 * log(u)) * cos(6.283185307179586 * v);
    out->n = s->noutputs;
    out->value[0] = (1 + point) * (1 + 0.05 * z);
    out->value[1] = z;
    return PH_OK;
}

static ph_campaign_result *run(const ph_campaign *c, const char *name,
                               ph_campaign_params p, ph_status want)
{
    ph_error err = PH_ERROR_INIT;
    ph_campaign_result *r = NULL;
    char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    p.folder = path;
    if (!p.evaluate) p.evaluate = normal;
    ph_status st = ph_campaign_run(c, &p, &r, &err);
    if (st != want) print_error("%s\n", err.msg);
    CHECK(st == want);
    return r;
}

static char *text_of(const ph_campaign *c, const ph_campaign_result *r)
{
    char *json = NULL;
    ph_error err = PH_ERROR_INIT;
    CHECK_OK(ph_campaign_to_json(c, r, &json, &err));
    return json;
}

static void test_fixed_number(void **state)
{
    (void)state;
    ph_campaign *c = campaign("50");
    ph_campaign_result *r = run(c, "a", (ph_campaign_params){.jobs = 2}, PH_OK);
    double sum = 0, square = 0;
    for (int i = 0; i < 50; i++) {
        ph_evaluation e;
        normal(NULL, &(ph_scenario){.realisation = (uint64_t)i, .noutputs = 2}, 1, &e,
               NULL);
        sum += e.value[0];
        square += e.value[0] * e.value[0];
    }
    const ph_campaign_mean *m = &r->point[1].output[0];
    CHECK(r->npoints == 2 && r->realisations == 100 && r->failed == 0 && r->complete);
    CHECK(m->n == 50 && r->point[1].counted == 50);
    CHECK_REL(m->mean.mean, sum / 50, 1e-14);
    CHECK_REL(m->mean.deviation, sqrt((square - sum * sum / 50) / 49), 1e-12);
    /* common random numbers: the second output does not know the point */
    CHECK(r->point[0].output[1].mean.mean == r->point[1].output[1].mean.mean);
    ph_campaign_result_free(&r);
    ph_campaign_free(&c);
    CHECK_END();
}

static void test_stops_where_the_rule_says(void **state)
{
    (void)state;
    ph_campaign *c =
        campaign("{at_most: 5000, until: {quantity: E1, relative_half_width: 0.01}}");
    ph_campaign_result *r = run(c, "b", (ph_campaign_params){.jobs = 3}, PH_OK);
    ph_sequence s;
    ph_error err = PH_ERROR_INIT;
    CHECK_OK(ph_sequence_start(&s, &c->stopping, &err));
    while (!s.done) {
        ph_evaluation e;
        normal(NULL, &(ph_scenario){.realisation = (uint64_t)s.n, .noutputs = 2}, 0, &e,
               NULL);
        ph_sequence_add(&s, e.value[0]);
    }
    CHECK(r->point[0].output[0].n == s.n && r->point[0].reached);
    CHECK(r->point[0].output[0].mean.mean == s.mean);
    CHECK(r->realisations == r->point[0].counted + r->point[1].counted);
    ph_campaign_result_free(&r);
    ph_campaign_free(&c);
    CHECK_END();
}

/* Index 7 of point 0 fails once in every life of its worker, index 9 of point 1 kills it,
 * index 3 of point 1 is no number, index 4 is slow. */
static ph_status troubled(void *user, const ph_scenario *s, int point, ph_evaluation *out,
                          ph_error *err)
{
    normal(user, s, point, out, err);
    if (point == 0 && s->realisation == 7)
        return ph_error_set(err, PH_ENOCONV, "here", 1, "line one\nand \"two\"");
    if (point == 1 && s->realisation == 3) out->value[1] = NAN;
    if (point == 1 && s->realisation == 9) raise(SIGKILL);
    if (s->realisation == 4) nanosleep(&(struct timespec){0, 20000000}, NULL);
    return PH_OK;
}

static void test_failures(void **state)
{
    (void)state;
    ph_campaign *c = campaign("30");
    ph_campaign_params p = {.jobs = 2, .evaluate = troubled};
    ph_campaign_result *r = run(c, "c", p, PH_EPARTIAL);
    CHECK(r->failed == 3 && r->realisations == 60 && r->complete);
    CHECK(r->point[0].failed == 1 && r->point[1].failed == 2);
    CHECK(r->point[0].output[0].n == 29 && r->point[1].output[0].n == 28);
    char *first = text_of(c, r);
    ph_campaign_result_free(&r);
    /* the same on another number of workers; not tried again */
    r = run(c, "d", (ph_campaign_params){.jobs = 4, .evaluate = troubled}, PH_EPARTIAL);
    char *second = text_of(c, r);
    CHECK(strcmp(first, second) == 0);
    ph_campaign_result_free(&r);
    r = run(c, "c", (ph_campaign_params){.jobs = 1}, PH_EPARTIAL);
    CHECK(r->failed == 3);
    ph_campaign_result_free(&r);
    /* tried again where it works, they are as if they had never failed */
    r = run(c, "c", (ph_campaign_params){.retry_failed = true, .jobs = 1}, PH_OK);
    CHECK(r->failed == 0);
    char *third = text_of(c, r);
    ph_campaign_result_free(&r);
    r = run(c, "e", (ph_campaign_params){.jobs = 1}, PH_OK);
    char *fourth = text_of(c, r);
    CHECK(strcmp(third, fourth) == 0);
    ph_campaign_result_free(&r);
    free(first);
    free(second);
    free(third);
    free(fourth);
    ph_campaign_free(&c);
    CHECK_END();
}

static bool stop_after_some(void *user, const ph_campaign_progress *now)
{
    *(ph_campaign_progress *)user = *now;
    return false;
}

static ph_status slow(void *user, const ph_scenario *s, int point, ph_evaluation *out,
                      ph_error *err)
{
    nanosleep(&(struct timespec){0, 5000000}, NULL);
    return normal(user, s, point, out, err);
}

static void test_stop_and_go_on(void **state)
{
    (void)state;
    ph_campaign *c = campaign("40");
    ph_campaign_progress last = {0};
    ph_campaign_params p = {
        .jobs = 2, .evaluate = slow, .progress = stop_after_some, .user = &last};
    ph_campaign_result *r = run(c, "f", p, PH_ECANCELLED);
    CHECK(r && !r->complete && r->realisations < 80);
    CHECK(last.points == 2 && last.wanted == 80 && last.workers == 2);
    ph_campaign_result_free(&r);
    r = run(c, "f", (ph_campaign_params){.jobs = 2}, PH_OK);
    char *mine = text_of(c, r);
    ph_campaign_result_free(&r);
    r = run(c, "g", (ph_campaign_params){.jobs = 1}, PH_OK);
    char *whole = text_of(c, r);
    CHECK(strcmp(mine, whole) == 0);
    ph_campaign_result_free(&r);
    free(mine);
    free(whole);
    ph_campaign_free(&c);
    CHECK_END();
}

static bool watch(void *user, const ph_campaign_progress *now)
{
    *(ph_campaign_progress *)user = *now;
    return true;
}

/* Where memory allows fewer workers than processors, they get the rest as threads. */
static void test_crew(void **state)
{
    (void)state;
    ph_campaign *c = campaign("3");
    const struct {
        ph_campaign_params p;
        int workers, threads;
    } row[] = {{{.jobs = 4, .memory = 1}, 1, 4},
               {{.jobs = 4}, 4, 1},
               {{.jobs = 4, .threads = 2}, 2, 2},
               {{.jobs = 2, .threads = 8}, 1, 8},
               /* 150 x 150 nodes, below the number that is asked about: 1 kB each */
               {{.jobs = 4, .memory = 2 * 22500 * 1000}, 2, 2}};
    for (int i = 0; i < 5; i++) {
        ph_campaign_progress last = {0};
        ph_campaign_params p = row[i].p;
        char name[8];
        snprintf(name, sizeof name, "crew%d", i);
        p.progress = watch;
        p.user = &last;
        ph_campaign_result *r = run(c, name, p, PH_OK);
        CHECK(last.workers == row[i].workers && last.threads == row[i].threads);
        CHECK(last.realisations == 6 && last.points_done == 2);
        ph_campaign_result_free(&r);
    }
    ph_campaign_free(&c);
    CHECK_END();
}

static void test_shards(void **state)
{
    (void)state;
    static const char *const rules[] = {
        "31", "{at_most: 500, until: {quantity: E1, relative_half_width: 0.02}}"};
    for (int k = 0; k < 2; k++) {
        ph_campaign *c = campaign(rules[k]);
        ph_error err = PH_ERROR_INIT;
        char name[8][32], path[8][128], to[128];
        const char *from[8];
        ph_campaign_result *r = NULL;
        for (int s = 0; s < 3; s++) {
            snprintf(name[s], sizeof name[s], "s%d-%d", k, s);
            snprintf(path[s], sizeof path[s], "%s/%s", folder, name[s]);
            from[s] = path[s];
            r = run(c, name[s],
                    (ph_campaign_params){.jobs = 1, .shard = s + 1, .shards = 3}, PH_OK);
            ph_campaign_result_free(&r);
        }
        snprintf(to, sizeof to, "%s/m%d", folder, k);
        CHECK_OK(ph_campaign_merge(c, to, from, 3, &r, &err));
        CHECK(r->complete && r->differing == 0);
        char *merged = text_of(c, r);
        ph_campaign_result_free(&r);
        r = run(c, k ? "w1" : "w0", (ph_campaign_params){.jobs = 1}, PH_OK);
        char *whole = text_of(c, r);
        CHECK(strcmp(merged, whole) == 0);
        ph_campaign_result_free(&r);
        free(merged);
        free(whole);
        ph_campaign_free(&c);
    }
    CHECK_END();
}

static void test_refusals(void **state)
{
    (void)state;
    ph_campaign *c = campaign("3");
    ph_campaign_result *r = NULL;
    const ph_campaign_params wrong[] = {
        {.folder = NULL},
        {.folder = folder, .shard = 3, .shards = 2},
        {.folder = folder, .shard = 0, .shards = 2},
        {.folder = folder, .jobs = -1},
        {.folder = folder, .jobs = 1000},
        {.folder = folder, .threads = -1},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        CHECK(ph_campaign_run(c, &wrong[i], &r, NULL) == PH_EINVAL && !r);
    CHECK(ph_campaign_run(NULL, &wrong[1], &r, NULL) == PH_EINVAL);
    CHECK(ph_campaign_run(c, NULL, &r, NULL) == PH_EINVAL);
    CHECK(ph_campaign_run(c, &wrong[1], NULL, NULL) == PH_EINVAL);
    CHECK(ph_campaign_run(c, &(ph_campaign_params){.folder = ""}, &r, NULL) == PH_EIO);
    CHECK(ph_campaign_merge(c, folder, (const char *const[]){"/nowhere"}, 1, &r, NULL) ==
          PH_EIO);
    CHECK(ph_campaign_merge(NULL, folder, NULL, 0, &r, NULL) == PH_EINVAL);
    CHECK(ph_campaign_summarise(c, NULL, &r, NULL) == PH_EINVAL);
    ph_campaign_free(&c);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_fixed_number),
        cmocka_unit_test(test_stops_where_the_rule_says),
        cmocka_unit_test(test_failures),
        cmocka_unit_test(test_stop_and_go_on),
        cmocka_unit_test(test_crew),
        cmocka_unit_test(test_shards),
        cmocka_unit_test(test_refusals),
    };
    signal(SIGPIPE, SIG_IGN);
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
