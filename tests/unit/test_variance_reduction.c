/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Campaigns with cheaper models: what is read, what comes out, and that it is the same however
 * it was computed. */
#define _XOPEN_SOURCE 700 /* nftw */
#include "folder.h"

#include <jansson.h>

#include <perihom_campaign.h>

static ph_campaign *campaign(const char *reduction, const char *realisations)
{
    ph_error err = PH_ERROR_INIT;
    ph_campaign *c = NULL;
    char path[128], text[1024];
    int n = snprintf(text, sizeof text,
                     "campaign: 1\ncase: %s/cases/epoxy-clay.yaml\n"
                     "sweep: {model.horizon: [3, 4, 5]}\noutputs: [E1, G12]\n"
                     "variance_reduction: %s\nrealisations: %s\n",
                     PH_DATA_DIR, reduction, realisations);
    snprintf(path, sizeof path, "%s/c.yaml", folder);
    CHECK_OK(ph_write_file(path, text, (size_t)n, &err));
    CHECK_OK(ph_campaign_read(path, NULL, 0, &c, NULL, &err));
    return c;
}

/* Models are told apart by their tolerance. Mean of E1: 1 + point. */
static ph_status known(void *user, const ph_scenario *s, int point, ph_evaluation *out,
                       ph_error *err)
{
    (void)user, (void)err;
    ph_random r = {.seed = 5, .realisation = s->realisation};
    double z = ph_random_normal(&r), rest = ph_random_normal(&r);
    double t = s->c->solver.tolerance;
    out->n = s->noutputs;
    out->work.iterations = t < 0.05 ? 300 : t < 0.3 ? 60 : 3;
    out->work.iterations +=
        (int)(s->realisation * s->realisation) % 1009; /* only some count */
    out->value[0] = t < 0.05  ? (1 + point) * (1 + 0.1 * z + 0.01 * rest)
                    : t < 0.3 ? 7 + 0.2 * z
                              : z + 0.5 * ph_random_normal(&r);
    out->value[1] = t < 0.3 ? z * z : z;
    return PH_OK;
}

static const char levels[] =
    "{levels: [{solver.tolerance: 0.1}, {solver.tolerance: 0.5}]}";
static const char until[] =
    "{at_most: 5000, until: {quantity: E1, relative_half_width: 0.004}}";

static ph_campaign_result *run(const ph_campaign *c, const char *name,
                               ph_campaign_params p)
{
    ph_error err = PH_ERROR_INIT;
    ph_campaign_result *r = NULL;
    char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    p.folder = path;
    p.evaluate = known;
    CHECK_OK(ph_campaign_run(c, &p, &r, &err));
    return r;
}

static void same_lines(const char *a, const char *b)
{
    char command[256];
    snprintf(command, sizeof command,
             "cmp -s %s/%s/realisations.jsonl %s/%s/realisations.jsonl", folder, a,
             folder, b);
    CHECK(system(command) == 0);
}

static void test_means(void **state)
{
    (void)state;
    ph_campaign *c = campaign(levels, until);
    CHECK(c->nmodels == 3 && c->fillers_model == -1);
    CHECK(c->point[1].model[2]->solver.tolerance == 0.5);
    CHECK(strcmp(c->cheap[0].name, "stretch.E1") == 0);
    ph_campaign_result *r = run(c, "a", (ph_campaign_params){.jobs = 2});
    for (int p = 0; p < 3; p++) {
        const ph_campaign_summary *s = &r->point[p];
        const ph_interval *i = &s->output[0].mean;
        const ph_mean_estimate *e = &s->estimation->estimate;
        CHECK(s->complete && s->reached && s->estimation->method > 0);
        CHECK(fabs(i->mean - 1 - p) < 2 * i->half_width);
        CHECK(i->half_width <= 0.004 * i->mean * (1 + 1e-6));
        CHECK(i->mean == e->mean && s->counted == s->estimation->want[0]);
        CHECK(e->plain_cost > 1.5 * e->cost);
        /* The second output has a mean of its own: E[z^2] = 1. */
        CHECK(fabs(s->output[1].mean.mean - 1) < 3 * s->output[1].mean.half_width);
        CHECK_REL(i->deviation, 0.1005 * (1 + p), 0.6); /* of some twelve values */
    }
    ph_campaign_result_free(&r);
    ph_campaign_free(&c);
    CHECK_END();
}

/* The same as asking the estimators by hand. */
static void test_is_the_estimator(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_campaign *c = campaign(levels, until);
    ph_campaign_result *r = run(c, "hand", (ph_campaign_params){.jobs = 1});
    const ph_estimation *e = r->point[2].estimation;
    static double value[3][6000];
    ph_model_samples models[3];
    for (int m = 0; m < 3; m++) {
        for (ptrdiff_t k = 0; k < e->want[m]; k++) {
            ph_evaluation v;
            const ph_scenario s = {.c = m ? c->point[2].model[m] : c->point[2].c,
                                   .realisation = (uint64_t)k,
                                   .noutputs = 2};
            known(NULL, &s, 2, &v, NULL);
            value[m][k] = v.value[0];
        }
        models[m] = (ph_model_samples){1, e->want[m], value[m], 1};
    }
    ph_mean_estimate mean;
    CHECK_OK(ph_estimation_mean(e, 0.95, 3, models, &mean, &err));
    CHECK(mean.mean == r->point[2].output[0].mean.mean);
    ph_campaign_result_free(&r);
    ph_campaign_free(&c);
    CHECK_END();
}

static bool stop_early(void *user, const ph_campaign_progress *now)
{
    (void)user;
    return now->realisations < 60;
}

static void test_workers_shards_and_interruptions(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_campaign *c = campaign(levels, until);
    ph_campaign_result *one = run(c, "one", (ph_campaign_params){.jobs = 1}), *r = NULL;
    char x[128], y[128], z[128], *a = NULL, *b = NULL;
    r = run(c, "three", (ph_campaign_params){.jobs = 3});
    ph_campaign_result_free(&r);
    same_lines("one", "three");
    for (int k = 1; k <= 2; k++) {
        r = run(c, k == 1 ? "s1" : "s2", (ph_campaign_params){.shard = k, .shards = 2});
        CHECK(!r->complete);
        ph_campaign_result_free(&r);
    }
    snprintf(x, sizeof x, "%s/s1", folder);
    snprintf(y, sizeof y, "%s/s2", folder);
    snprintf(z, sizeof z, "%s/merged", folder);
    CHECK_OK(ph_campaign_merge(c, z, (const char *const[]){y, x}, 2, &r, &err));
    same_lines("one", "merged");
    CHECK_OK(ph_campaign_to_json(c, one, &a, &err));
    CHECK_OK(ph_campaign_to_json(c, r, &b, &err));
    CHECK(strcmp(a, b) == 0 && strstr(a, "\"variance_reduction\""));
    ph_campaign_result_free(&r);
    snprintf(x, sizeof x, "%s/stopped", folder);
    ph_campaign_params p = {.folder = x, .evaluate = known, .progress = stop_early};
    ph_status st = ph_campaign_run(c, &p, &r, &err);
    CHECK(st == PH_ECANCELLED || st == PH_OK); /* it may be faster than the first look */
    ph_campaign_result_free(&r);
    r = run(c, "stopped", (ph_campaign_params){.jobs = 2});
    same_lines("one", "stopped");
    free(a);
    free(b);
    ph_campaign_result_free(&r);
    ph_campaign_result_free(&one);
    ph_campaign_free(&c);
    CHECK_END();
}

/* Lines half gone: they are computed again, and no others. */
static void test_goes_on_from_any_file(void **state)
{
    (void)state;
    ph_campaign *c = campaign(levels, until);
    ph_campaign_result *r = run(c, "whole", (ph_campaign_params){.jobs = 2});
    ph_campaign_result_free(&r);
    char command[512], name[16];
    for (int part = 1; part < 6; part++) {
        snprintf(command, sizeof command,
                 "mkdir -p %s/part%d && awk 'NR == 1 || (NR * 7919) %% 6 < %d' "
                 "%s/whole/realisations.jsonl > %s/part%d/realisations.jsonl",
                 folder, part, part, folder, folder, part);
        CHECK(system(command) == 0);
        snprintf(name, sizeof name, "part%d", part);
        r = run(c, name, (ph_campaign_params){.jobs = 2});
        ph_campaign_result_free(&r);
        same_lines("whole", name);
    }
    ph_campaign_free(&c);
    CHECK_END();
}

/* One in seventeen fails on every model, one in twenty-nine on the case only. */
static ph_status troubled(void *user, const ph_scenario *s, int point, ph_evaluation *out,
                          ph_error *err)
{
    known(user, s, point, out, err);
    bool here = s->c->solver.tolerance < 0.05 && s->realisation % 29 == 7;
    return s->realisation % 17 == 5 || here ? ph_error_set(err, PH_ENOCONV, "-", 1, "no")
                                            : PH_OK;
}

static void test_failures(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_campaign *c = campaign(levels, until);
    ph_campaign_result *r = NULL;
    char path[128];
    snprintf(path, sizeof path, "%s/troubled", folder);
    const ph_campaign_params p = {.folder = path, .jobs = 2, .evaluate = troubled};
    CHECK(ph_campaign_run(c, &p, &r, &err) == PH_EPARTIAL);
    for (int k = 0; k < 3; k++) {
        const ph_interval *i = &r->point[k].output[0].mean;
        CHECK(r->point[k].failed > 0 && r->point[k].reached);
        CHECK(fabs(i->mean - 1 - k) < 2 * i->half_width);
    }
    ph_campaign_result_free(&r);
    ph_campaign_free(&c);
    CHECK_END();
}

static void test_none(void **state)
{
    (void)state;
    ph_campaign *c = campaign("none", "20");
    CHECK(c->nmodels == 1 && !c->cheap);
    ph_campaign_result *r = run(c, "none", (ph_campaign_params){.jobs = 1});
    CHECK(r->realisations == 60 && !r->estimation && !r->point[0].estimation);
    ph_campaign_result_free(&r);
    ph_campaign_free(&c);
    CHECK_END();
}

/* Models that follow from the case: same horizon in length, same fillers. */
static void test_derived_models(void **state)
{
    (void)state;
    ph_campaign *c = campaign("auto", "100");
    const ph_case *half = c->point[2].model[2];
    CHECK(c->nmodels == 4 && c->fillers_model == 3);
    CHECK(c->point[2].model[1]->solver.tolerance == 0.1);
    CHECK(c->point[2].model[1]->nodes[0] == 150);
    CHECK(half->nodes[0] == 75 && half->drawn_on[1] == 150);
    CHECK(half->model.horizon == 2.5 && half->solver.tolerance == 0.1);
    CHECK(c->point[0].model[2]->model.horizon == 2); /* 3 / 2 would be too few */
    ph_campaign_free(&c);
    CHECK_END();
}

/* Linear in the spacing, with a slope of 1/2 % of the mean a spacing of 5 nm; the models solved
 * less accurately are off by something of their own. */
static ph_status on_grids(void *user, const ph_scenario *s, int point, ph_evaluation *out,
                          ph_error *err)
{
    (void)user, (void)err;
    ph_random r = {.seed = 6, .realisation = s->realisation};
    double z = ph_random_normal(&r), own = ph_random_normal(&r);
    double h = 300.0 / (double)s->c->nodes[0];
    bool loose = s->c->solver.tolerance > 0.05;
    out->n = s->noutputs;
    out->work.iterations = loose ? 60 : 300;
    out->value[0] = (1 + point) * (1 + 0.03 * z + 0.005 * h * (1 + 0.1 * own));
    if (loose) out->value[0] += 0.02 + 0.002 * ph_random_normal(&r);
    out->value[1] = 2 + 0.01 * z - 0.1 * h;
    return s->realisation % 19 == 3 ? ph_error_set(err, PH_ENOCONV, "-", 1, "no") : PH_OK;
}

static const char two_grids[] =
    "{levels: [{solver.tolerance: 0.1}, {solver.tolerance: 0.1, "
    "microstructure.nodes: [150, 150]}]}";
static const char total[] =
    "{at_most: 5000, until: {quantity: E1, relative_error: 0.012}}\n"
    "set: {microstructure.nodes: [300, 300], microstructure.drawn_on: [150, 150]}";

static ph_campaign_result *run_on_grids(const ph_campaign *c, const char *name, int jobs)
{
    ph_error err = PH_ERROR_INIT;
    ph_campaign_result *r = NULL;
    char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    const ph_campaign_params p = {.folder = path, .jobs = jobs, .evaluate = on_grids};
    CHECK(ph_campaign_run(c, &p, &r, &err) == PH_EPARTIAL);
    return r;
}

static void test_total_error(void **state)
{
    (void)state;
    ph_campaign *c = campaign(two_grids, total);
    const ph_grid_pair *grid = &c->point[1].grid;
    CHECK(grid->fine == 1 && grid->coarse == 2 && grid->ratio == 2);
    ph_campaign_result *r = run_on_grids(c, "total", 2);
    for (int p = 0; p < 3; p++) {
        const ph_campaign_summary *s = &r->point[p];
        const ph_campaign_mean *E = &s->output[0], *G = &s->output[1];
        CHECK(s->complete && s->reached);
        CHECK(fabs(E->bias.estimate) + E->bias.half_width + E->mean.half_width <=
              0.012 * E->mean.mean * (1 + 1e-9));
        CHECK(fabs(E->mean.mean - 1 - p) <= 0.012 * E->mean.mean);
        CHECK(fabs(E->bias.estimate - 0.005 * (1 + p)) < 2 * E->bias.half_width);
        CHECK(E->bias.n >= 11 && E->bias.estimate == s->estimation->bias.estimate);
        CHECK_REL(G->bias.estimate, -0.1, 1e-12); /* the same in every realisation */
    }
    ph_campaign_result_free(&r);
    ph_campaign_free(&c);
    CHECK_END();
}

/* The error bar of a mean: sampling and grid in full, relative. */
static void check_error_bar(const char *text, const char *name, const ph_campaign_mean *m)
{
    json_t *document = json_loads(text, 0, NULL), *parts;
    json_t *point = json_array_get(json_object_get(document, "points"), 0);
    double sampling = m->mean.half_width / m->mean.mean,
           grid = (fabs(m->bias.estimate) + m->bias.half_width) / m->mean.mean;
    CHECK(m->bias.n > 0 && sampling > 0);
    CHECK_REL(
        json_number_value(json_object_get(json_object_get(point, "error_bar"), name)),
        sampling + grid, 1e-14);
    parts = json_object_get(point, "error_parts");
    CHECK_REL(
        json_number_value(json_object_get(json_object_get(parts, "sampling"), name)),
        sampling, 1e-14);
    CHECK_REL(json_number_value(
                  json_object_get(json_object_get(parts, "discretisation"), name)),
              grid, 1e-14);
    json_decref(document);
}

/* The same bits from three workers, and from a file of which half is gone. */
static void test_total_error_is_pure(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_campaign *c = campaign(two_grids, total);
    ph_campaign_result *r[3] = {run_on_grids(c, "grids1", 1),
                                run_on_grids(c, "grids3", 3), NULL};
    char command[512], *text[3];
    same_lines("grids1", "grids3");
    snprintf(command, sizeof command,
             "mkdir -p %s/grids && awk 'NR == 1 || (NR * 7919) %% 6 < 3' "
             "%s/grids1/realisations.jsonl > %s/grids/realisations.jsonl",
             folder, folder, folder);
    CHECK(system(command) == 0);
    r[2] = run_on_grids(c, "grids", 2);
    same_lines("grids1", "grids");
    for (int k = 0; k < 3; k++)
        CHECK_OK(ph_campaign_to_json(c, r[k], &text[k], &err));
    CHECK(strcmp(text[0], text[1]) == 0 && strcmp(text[0], text[2]) == 0);
    CHECK(strstr(text[0], "\"discretisation\"") && strstr(text[0], "\"relative_error\""));
    CHECK(strstr(text[0], "\"ratio\": 2.0"));
    check_error_bar(text[0], c->output[0].name, &r[0]->point[0].output[0]);
    for (int k = 0; k < 3; k++) {
        free(text[k]);
        ph_campaign_result_free(&r[k]);
    }
    ph_campaign_free(&c);
    CHECK_END();
}

/* Ten times less than what the grid adds: pilots only. */
static void test_grid_is_too_coarse(void **state)
{
    (void)state;
    ph_campaign *c = campaign(two_grids, total);
    c->relative_error = 0.0005;
    ph_campaign_result *r = run_on_grids(c, "coarse", 2);
    for (int p = 0; p < 3; p++) {
        const ph_estimation *e = r->point[p].estimation;
        CHECK(r->point[p].complete && !r->point[p].reached && e->want[0] == 12);
        CHECK_REL(e->finer, 20, 0.2);
        CHECK(strstr(e->reason, "finer"));
    }
    ph_campaign_result_free(&r);
    ph_campaign_free(&c);
    CHECK_END();
}

/* Which models are two grids of one thing. */
static void test_grid_pairs(void **state)
{
    (void)state;
    static const struct {
        const char *levels;
        int fine, coarse;
    } cases[] = {
        {"{levels: [{microstructure.nodes: [200, 200]}]}", 0, 0}, /* stretch.E1 for E1 */
        {"{levels: [{solver.tolerance: 0.1}, {microstructure.nodes: [150, 150]}]}", 0, 0},
        {"{levels: [{solver.tolerance: 0.1}, {solver.tolerance: 0.1, "
         "microstructure.nodes: [75, 75]}]}",
         0, 0}, /* does not show the platelets */
        {"{levels: [{solver.tolerance: 0.1}, {solver.tolerance: 0.1, "
         "microstructure.nodes: [150, 200]}]}",
         0, 0},
        {"{levels: [{solver.tolerance: 0.1}, {solver.tolerance: 0.1, model.horizon: 2, "
         "microstructure.nodes: [150, 150]}]}",
         0, 0},
        {"{levels: [{solver.tolerance: 0.1}, {solver.tolerance: 0.1, "
         "microstructure.drawn_on: [100, 100], microstructure.nodes: [150, 150]}]}",
         0, 0},
        {"{levels: [{materials.epoxy.E: 3}, {materials.epoxy.E: 3, "
         "microstructure.nodes: [150, 150]}]}",
         0, 0},
        {"{levels: [{solver.tolerance: 0.1}, {solver.tolerance: 0.1, "
         "microstructure.nodes: [150, 150]}, {solver.tolerance: 0.1, "
         "microstructure.nodes: [200, 200]}, fillers]}",
         1, 3},
        {"auto", 1, 2},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        ph_campaign *c = campaign(
            cases[i].levels,
            "100\nset: {microstructure.nodes: [300, 300], microstructure.drawn_on: [150, "
            "150]}");
        const ph_grid_pair *g = &c->point[2].grid;
        CHECK(g->fine == cases[i].fine && g->coarse == cases[i].coarse);
        CHECK((g->ratio > 1) == (cases[i].coarse > 0));
        CHECK(!ph_campaign_no_grid(c, 2, 0) == (cases[i].coarse > 0));
        CHECK(ph_campaign_no_grid(c, 3, 0) && ph_campaign_no_grid(c, -1, 0));
        CHECK(ph_campaign_no_grid(c, 2, 2) && ph_campaign_no_grid(NULL, 0, 0));
        ph_campaign_free(&c);
    }
    CHECK_END();
}

static void complains(const char *reduction, const char *realisations, const char *text)
{
    ph_error err = PH_ERROR_INIT;
    ph_campaign *c = NULL;
    char path[128], file[1024];
    int n = snprintf(file, sizeof file,
                     "campaign: 1\ncase: %s/cases/epoxy-clay.yaml\noutputs: [E1]\n"
                     "variance_reduction: %s\nrealisations: %s\n",
                     PH_DATA_DIR, reduction, realisations);
    snprintf(path, sizeof path, "%s/bad.yaml", folder);
    CHECK_OK(ph_write_file(path, file, (size_t)n, &err));
    ph_status st = ph_campaign_read(path, NULL, 0, &c, NULL, &err);
    CHECK((st == PH_EINVAL || st == PH_EUNPHYSICAL) && !c);
    if (!strstr(err.msg, text)) print_error("%s: %s\n", reduction, err.msg);
    CHECK(strstr(err.msg, text));
}

static void test_complaints(void **state)
{
    (void)state;
    complains("magic", "100", "variance_reduction");
    complains("[auto]", "100", "variance_reduction");
    complains("{method: multilevl}", "100", "multilevel");
    complains("{metod: auto}", "100", "method");
    complains("{pilot: 3}", "100", "from 4");
    complains("{pilot: nan}", "100", "from 4");
    complains("{levels: []}", "100", "1 to 7 models");
    complains("{levels: cheaper}", "100", "levels");
    complains("{levels: [fillers, {solver.tolerance: 0.1}]}", "100", "last");
    complains("{levels: [12]}", "100", "cheaper models");
    complains("{levels: [{solver.tolerance: 7}]}", "100", "tolerance");
    complains("{levels: [{solver.tolerence: 0.1}]}", "100", "tolerance");
    complains("auto", "23", "at_most is 23");
    complains("{pilot: 60}", "100", "below 120");
#define UNTIL(error) "{at_most: 100, until: {quantity: E1, " error "}}"
    complains("auto", UNTIL("relative_error: 0.01, half_width: 1"),
              "half_width is given");
    complains("auto", UNTIL("relative_error: 0.01, relative_half_width: 0.1"),
              "relative_half_width is given");
    complains("auto", UNTIL("relative_error: 0"), "between 0 and 1");
    complains("auto", UNTIL("relative_error: -0.1"), "between 0 and 1");
    complains("auto", UNTIL("relative_error: 1"), "between 0 and 1");
    complains("auto", UNTIL("relative_error: .nan"), "relative_error");
    complains("auto", UNTIL("relative_error: 1e400"), "relative_error");
    complains("auto", UNTIL("relative_error: 0.01"), "nodes >= drawn_on");
    complains("none", UNTIL("relative_error: 0.01"),
              "no cheaper model on a coarser grid");
    complains("{levels: [{microstructure.nodes: [75, 75]}]}",
              UNTIL("relative_error: 0.1"), "nothing but their nodes");
#undef UNTIL
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_means),
        cmocka_unit_test(test_is_the_estimator),
        cmocka_unit_test(test_workers_shards_and_interruptions),
        cmocka_unit_test(test_goes_on_from_any_file),
        cmocka_unit_test(test_failures),
        cmocka_unit_test(test_none),
        cmocka_unit_test(test_derived_models),
        cmocka_unit_test(test_total_error),
        cmocka_unit_test(test_total_error_is_pure),
        cmocka_unit_test(test_grid_is_too_coarse),
        cmocka_unit_test(test_grid_pairs),
        cmocka_unit_test(test_complaints),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
