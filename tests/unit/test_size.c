/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Campaigns that choose the size of their RVE, and budgets of seconds and bytes. */
#define _XOPEN_SOURCE 700 /* nftw */
#include "folder.h"

#include <perihom_campaign.h>
#include <time.h>

static const char platelets[] =
    "perihom: 1\n"
    "materials: {epoxy: {E: 3.5, nu: 0.3}, clay: {E: 178, nu: 0.3}}\n"
    "microstructure:\n"
    "  dimension: 2\n"
    "  plane: stress\n"
    "  size: [32, 32]\n"
    "  nodes: [32, 32]\n"
    "  matrix: epoxy\n"
    "  interface: node_centre\n"
    "  fillers:\n"
    "    - {shape: platelet, material: clay, volume_fraction: 0.05, thickness: 1,\n"
    "       aspect_ratio: {uniform: {min: 9, max: 15}}, counting: nodes}\n";
static const char disks[] =
    "perihom: 1\n"
    "materials: {m: {E: 1, nu: 0.3}, f: {E: 10, nu: 0.3}}\n"
    "microstructure:\n"
    "  dimension: 2\n"
    "  plane: strain\n"
    "  size: [1, 1]\n"
    "  drawn_on: [24, 24]\n"
    "  matrix: m\n"
    "  fillers: [{shape: particle, material: f, volume_fraction: 0.2, size: 0.15}]\n"
    "accuracy: {relative: 0.05}\n";

static const char *put(const char *name, const char *text)
{
    static char path[128];
    ph_error err = PH_ERROR_INIT;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    CHECK_OK(ph_write_file(path, text, strlen(text), &err));
    return path;
}

static ph_campaign *campaign(const char *microstructure, const char *rest, ph_status want)
{
    ph_error err = PH_ERROR_INIT;
    ph_campaign *c = NULL;
    char text[1024];
    put("case.yaml", microstructure);
    snprintf(text, sizeof text, "campaign: 1\ncase: case.yaml\noutputs: [C11, C66]\n%s",
             rest);
    ph_status st = ph_campaign_read(put("c.yaml", text), NULL, 0, &c, NULL, &err);
    if (st != want) print_error("%s: %s\n", rest, err.msg);
    CHECK(st == want);
    return c;
}

#define UNTIL(width)                                                                     \
    "realisations: {at_most: 5000, at_least: 10, until: {quantity: C11, "                \
    "relative_half_width: " #width "}}\n"

/* Mean 2 (1 + bias / f^2), deviation 2 scatter / f, f the edge over 32; and `common` of it the
 * same at all sizes. */
typedef struct known {
    double bias, scatter, common, smallest; /* below: no room for the fillers */
    double seconds;                         /* that a realisation says it took */
    long nanoseconds;                       /* that it takes */
} known;

static ph_status evaluate(void *user, const ph_scenario *s, int point, ph_evaluation *out,
                          ph_error *err)
{
    const known *k = user;
    double f = s->c->size[0] / 32;
    ph_random r = {.seed = 5, .realisation = s->realisation, .object = (uint64_t)point};
    out->n = s->noutputs;
    out->work.iterations = 30;
    out->seconds = k->seconds;
    out->value[0] = 2 * (1 + k->bias / f / f + k->scatter / f * ph_random_normal(&r));
    out->value[0] += 2 * k->common * ph_random_normal(&r);
    out->value[1] = f;
    if (k->nanoseconds) nanosleep(&(struct timespec){0, k->nanoseconds}, NULL);
    if (f < k->smallest) return ph_error_set(err, PH_EUNPHYSICAL, "here", 1, "no room");
    return PH_OK;
}

/* Choose and run; *result NULL where there is none. */
static ph_status run(ph_campaign **c, const char *name, ph_campaign_params p,
                     ph_campaign_result **result, ph_error *err)
{
    char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    p.folder = path;
    *result = NULL;
    ph_status st = ph_campaign_choose_size(c, NULL, 0, &p, err);
    if (st == PH_OK) st = ph_campaign_run(*c, &p, result, err);
    if (*result) CHECK(ph_campaign_write(*c, path, *result, NULL) == PH_OK);
    return st;
}

static void same_files(const char *a, const char *b)
{
    char command[512];
    snprintf(command, sizeof command,
             "cd %s && cmp -s %s/realisations.jsonl %s/realisations.jsonl && "
             "cmp -s %s/campaign.json %s/campaign.json",
             folder, a, b, a, b);
    CHECK(system(command) == 0);
}

/* Realisations that were computed for a folder, its own and no others. */
static int computed(const char *name)
{
    char path[128];
    int lines = -1; /* the head */
    snprintf(path, sizeof path, "%s/%s/costs.csv", folder, name);
    FILE *file = fopen(path, "r");
    for (int c; file && (c = getc(file)) != EOF;)
        lines += c == '\n';
    if (file) fclose(file);
    return lines;
}

static const ph_split_candidate *chosen(const ph_campaign *c)
{
    return &c->sizes->answer->candidate[c->sizes->answer->chosen];
}

static void test_chosen_and_reached(void **state)
{
    (void)state;
    known k = {.bias = 0.01, .scatter = 0.02};
    ph_campaign *c = campaign(platelets, "size: auto\n" UNTIL(0.01), PH_OK);
    ph_campaign_result *r;
    ph_error err = PH_ERROR_INIT;
    const ph_campaign_params p = {.jobs = 2, .evaluate = evaluate, .evaluate_user = &k};
    CHECK_OK(run(&c, "a", p, &r, &err));
    if (!r) fail();
    const ph_campaign_sizes *s = c->sizes;
    CHECK(s->chosen && s->exponent == 2 && s->accuracy == 0.01 && s->grid_error[0] == 0);
    /* 1 % at the case's edge is all of it: a larger one */
    CHECK(s->ntried >= 4 && s->size[s->tried[chosen(c)->size]].factor > 1);
    for (int i = 0; i < s->n; i++) { /* one spacing, and numbers that transform well */
        CHECK_REL(s->size[i].size[0] / (double)s->size[i].nodes[0][0], 1, 1e-14);
        CHECK(s->size[i].nodes[0][0] == s->size[i].nodes[0][1]);
    }
    CHECK(c->point[0].c->nodes[0] == s->size[s->tried[chosen(c)->size]].nodes[0][0]);
    /* the pilots are realisations of the campaign, and its first stage */
    int64_t pilots = s->size[s->tried[chosen(c)->size]].pilots;
    CHECK(c->stopping.at_least == pilots && r->point[0].output[0].n >= pilots);
    CHECK(computed("a") == (int)(r->point[0].output[0].n - pilots));
    CHECK(r->point[0].reached && r->complete);
    CHECK_REL(r->point[0].output[0].mean.mean, 2, 0.01);
    /* that of a size may be known only to the accuracy: never all of it for the interval */
    CHECK(c->stopping.relative_half_width < 0.01 - fabs(chosen(c)->bias));
    ph_campaign_result_free(&r);
    ph_campaign_free(&c);
    CHECK_END();
}

static bool stop_after(void *user, const ph_campaign_progress *now)
{
    (void)now;
    return --*(int *)user > 0;
}

/* Workers, interruptions anywhere: the same bytes. */
static void test_same_bits(void **state)
{
    (void)state;
    known k = {.bias = 0.002, .scatter = 0.03};
    const char rest[] = "size: [0.5, 0.7, 1, 1.4]\nsweep: {materials.clay.E: [9, 178]}\n"
                        "common_random_numbers: false\n" UNTIL(0.03);
    ph_campaign *c = campaign(platelets, rest, PH_OK), *again;
    ph_campaign_result *r;
    ph_error err = PH_ERROR_INIT;
    ph_campaign_params p = {.jobs = 1, .evaluate = evaluate, .evaluate_user = &k};
    CHECK_OK(run(&c, "one", p, &r, &err));
    CHECK(c->sizes && c->sizes->answer->ncandidates >= 2);
    ph_campaign_result_free(&r);
    again = campaign(platelets, rest, PH_OK);
    p.jobs = 3;
    CHECK_OK(run(&again, "three", p, &r, &err));
    ph_campaign_result_free(&r);
    ph_campaign_free(&again);
    same_files("one", "three");
    k.nanoseconds = 10000000; /* whoever may stop it is asked every tenth of a second */
    for (int runs = 0; runs < 3; runs++) {
        int steps = 1;
        again = campaign(platelets, rest, PH_OK);
        p.progress = stop_after;
        p.user = &steps;
        CHECK(run(&again, "stopped", p, &r, &err) == PH_ECANCELLED);
        ph_campaign_result_free(&r);
        ph_campaign_free(&again);
    }
    k.nanoseconds = 0;
    p.progress = NULL;
    again = campaign(platelets, rest, PH_OK);
    CHECK_OK(run(&again, "stopped", p, &r, &err));
    ph_campaign_result_free(&r);
    same_files("one", "stopped");
    ph_campaign_free(&again);
    ph_campaign_free(&c);
    CHECK_END();
}

/* Sizes at which realisations fail, or that cannot be had, are left out, with the reason. */
static void test_left_out(void **state)
{
    (void)state;
    known k = {.scatter = 0.01, .smallest = 0.6};
    /* platelets of 9 do not fit in 0.25 of the edge; at half of it realisations fail */
    ph_campaign *c =
        campaign(platelets, "size: [0.02, 0.25, 0.5, 1, 2]\n" UNTIL(0.05), PH_OK);
    ph_campaign_result *r;
    ph_error err = PH_ERROR_INIT;
    const ph_campaign_params p = {.jobs = 2, .evaluate = evaluate, .evaluate_user = &k};
    CHECK_OK(run(&c, "a", p, &r, &err));
    if (!c->sizes) fail();
    CHECK(c->sizes->n == 5 && c->sizes->ntried == 2 && c->sizes->chosen);
    CHECK(strstr(c->sizes->size[0].reason, "1/32 of the edge is near") != NULL);
    CHECK(strstr(c->sizes->size[1].reason, "longer than the box") != NULL);
    CHECK(strstr(c->sizes->size[2].reason, "failed") != NULL);
    CHECK(!c->sizes->size[3].reason[0] && c->sizes->size[4].pilots > 0);
    ph_campaign_result_free(&r);
    ph_campaign_free(&c);
    /* not even two: said, nothing is written */
    err = (ph_error)PH_ERROR_INIT;
    c = campaign(platelets, "size: [0.1, 0.2, 1]\n" UNTIL(0.05), PH_OK);
    CHECK(run(&c, "b", p, &r, &err) == PH_EINVAL && !r);
    CHECK(strstr(err.msg, "two at least") && strstr(err.msg, "longer than the box"));
    ph_campaign_free(&c);
    /* a budget of memory that only the smallest sizes meet; and none */
    k.smallest = 0;
    c = campaign(platelets, "size: auto\nbudget: {memory: 6e5}\n" UNTIL(0.05), PH_OK);
    CHECK_OK(run(&c, "c", p, &r, &err));
    ph_campaign_result_free(&r);
    ph_campaign_free(&c);
    err = (ph_error)PH_ERROR_INIT;
    c = campaign(platelets, "size: auto\nbudget: {memory: 1e4}\n" UNTIL(0.05), PH_OK);
    CHECK(run(&c, "d", p, &r, &err) == PH_EINVAL && strstr(err.msg, "budget.memory"));
    ph_campaign_free(&c);
    err = (ph_error)PH_ERROR_INIT;
    c = campaign(platelets, "budget: {memory: 1e4}\n" UNTIL(0.05), PH_OK);
    CHECK(run(&c, "e", p, &r, &err) == PH_ENOCONV && strstr(err.msg, "budget.memory"));
    ph_campaign_free(&c);
    CHECK_END();
}

/* Boxes of any shape; sizes that are no multiple of what their axes have in common. */
static void test_shapes(void **state)
{
    (void)state;
    static const struct {
        const char *set;
        int tried; /* of 0.5, 0.7071, 1 */
        double factor[3];
        ptrdiff_t nodes[3]; /* of the smallest that was tried */
    } row[] = {{"microstructure.size: [32, 48], microstructure.nodes: [32, 48]",
                3,
                {0.5, 0.75, 1},
                {16, 24, 1}},
               {"microstructure.size: [32, 36], microstructure.nodes: [32, 36]",
                3,
                {0.5, 0.75, 1},
                {16, 18, 1}},
               {"microstructure.size: [62, 31], microstructure.nodes: [62, 31]",
                3,
                {15.0 / 31, 21.0 / 31, 1},
                {30, 15, 1}},
               {"microstructure.nodes: [48, 48], microstructure.drawn_on: [32, 32]",
                3,
                {0.5, 24.0 / 32, 1},
                {24, 24, 1}},
               {"microstructure.nodes: [40, 40], microstructure.drawn_on: [32, 32]",
                3,
                {0.5, 24.0 / 32, 1},
                {20, 20, 1}}};
    known k = {.scatter = 0.01};
    ph_campaign_result *r;
    ph_error err = PH_ERROR_INIT;
    const ph_campaign_params p = {.jobs = 2, .evaluate = evaluate, .evaluate_user = &k};
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        char text[512], name[8];
        snprintf(name, sizeof name, "s%zu", i);
        snprintf(text, sizeof text, "set: {%s}\nsize: [0.5, 0.7071, 1]\n%s", row[i].set,
                 UNTIL(0.5));
        ph_campaign *c = campaign(platelets, text, PH_OK);
        CHECK_OK(run(&c, name, p, &r, &err));
        if (!c->sizes) fail();
        CHECK(c->sizes->n == row[i].tried);
        for (int j = 0; j < row[i].tried; j++)
            CHECK_REL(c->sizes->size[j].factor, row[i].factor[j], 1e-15);
        CHECK(memcmp(c->sizes->size[0].nodes[0], row[i].nodes, sizeof row[i].nodes) == 0);
        ph_campaign_result_free(&r);
        ph_campaign_free(&c);
    }
    /* 31 and 37 nodes have nothing in common: whole multiples alone */
    ph_campaign *c =
        campaign(platelets,
                 "set: {microstructure.size: [31, 37], microstructure.nodes: "
                 "[31, 37]}\nsize: auto\n" UNTIL(0.5),
                 PH_OK);
    CHECK_OK(run(&c, "odd", p, &r, &err));
    CHECK(c->sizes && c->sizes->ntried == 2 && c->sizes->tried[0] == 2);
    CHECK(strstr(c->sizes->size[0].reason, "1/1 of the edge") != NULL);
    ph_campaign_result_free(&r);
    ph_campaign_free(&c);
    CHECK_END();
}

static void test_no_plan(void **state)
{
    (void)state;
    known k = {.bias = 0.2, .scatter = 0.01};
    ph_campaign *c = campaign(platelets, "size: auto\n" UNTIL(0.01), PH_OK);
    ph_campaign_result *r;
    ph_error err = PH_ERROR_INIT;
    const ph_campaign_params p = {.jobs = 2, .evaluate = evaluate, .evaluate_user = &k};
    CHECK(run(&c, "a", p, &r, &err) == PH_ENOCONV && !r);
    CHECK(strstr(err.msg, "no size meets 1 %") && strstr(err.msg, "of the edge"));
    /* the case's own edge was tried, larger ones are hopeless */
    CHECK(c->sizes && !c->sizes->chosen && c->sizes->ntried == 3);
    /* 20 % is 0.5 % at 6.3 times the edge */
    CHECK_REL(c->sizes->answer->factor_needed, sqrt(0.2 / 0.005), 0.1);
    /* it is not run at the size that the case happens to have */
    char path[128];
    snprintf(path, sizeof path, "%s/b", folder);
    CHECK(ph_campaign_run(c, &(ph_campaign_params){.folder = path}, &r, &err) ==
          PH_EINVAL);
    ph_campaign_free(&c);
    CHECK_END();
}

/* What the budget does not reach to is said after the pilots, and what was computed counts when
 * there is more. Realisations say how long they took, no clock has to be waited for. */
static void test_seconds(void **state)
{
    (void)state;
    known k = {.scatter = 0.1, .seconds = 1000};
    ph_campaign *c = campaign(platelets, UNTIL(0.002), PH_OK);
    ph_campaign_result *r;
    ph_error err = PH_ERROR_INIT;
    ph_campaign_params p = {
        .jobs = 2, .evaluate = evaluate, .evaluate_user = &k, .seconds = 5e4};
    /* some 10^4 realisations, at_most 5000: 2.5e6 s on two workers; about 100 are affordable */
    CHECK(run(&c, "a", p, &r, &err) == PH_ENOCONV && r);
    CHECK(strstr(err.msg, "affords about") && strstr(err.msg, "0.2 %"));
    CHECK(r && r->point[0].counted >= 10 && !r->point[0].reached && !r->complete);
    ph_campaign_result_free(&r);
    ph_campaign_free(&c);
    /* the clock ends it where nothing can be foreseen; it goes on where it was */
    err = (ph_error)PH_ERROR_INIT;
    k.seconds = 0;
    c = campaign(platelets, "budget: {seconds: 1e-6}\n" UNTIL(0.01), PH_OK);
    p.seconds = 0;
    CHECK(run(&c, "b", p, &r, &err) == PH_ENOCONV && r);
    CHECK(strstr(err.msg, "are over") != NULL);
    ph_campaign_result_free(&r);
    c->seconds = 0;
    CHECK_OK(run(&c, "b", p, &r, &err));
    ph_campaign_result_free(&r);
    CHECK_OK(run(&c, "c", p, &r, &err));
    same_files("b", "c");
    ph_campaign_result_free(&r);
    ph_campaign_free(&c);
    CHECK_END();
}

static bool is_there(const char *name)
{
    char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return access(path, F_OK) == 0;
}

/* Pilots of sizes that the budget does not reach to, and a campaign that it does not: nothing
 * is written but the pilots. */
static void test_seconds_of_sizes(void **state)
{
    (void)state;
    known k = {.scatter = 0.1, .seconds = 1000};
    ph_campaign_result *r;
    ph_error err = PH_ERROR_INIT;
    ph_campaign_params p = {.jobs = 2, .evaluate = evaluate, .evaluate_user = &k};
    ph_campaign *c =
        campaign(platelets, "size: auto\nbudget: {seconds: 300}\n" UNTIL(0.03), PH_OK);
    CHECK(c && c->seconds == 300 && run(&c, "a", p, &r, &err) == PH_ENOCONV && !r);
    CHECK(strstr(err.msg, "pilots at 0.5 of the edge: budget.seconds") != NULL);
    CHECK(!is_there("a/realisations.jsonl"));
    ph_campaign_free(&c);
    /* six pilots to go take 3 s at most; some hundred realisations, 50 s */
    err = (ph_error)PH_ERROR_INIT;
    k = (known){.common = 0.1, .seconds = 1};
    c = campaign(platelets, "size: auto\nbudget: {seconds: 20}\n" UNTIL(0.02), PH_OK);
    CHECK(run(&c, "b", p, &r, &err) == PH_ENOCONV && !r);
    CHECK(strstr(err.msg, "affords about") && strstr(err.msg, "realisations more"));
    CHECK(c->sizes && c->sizes->answer->chosen >= 0 && !c->sizes->chosen);
    CHECK(!is_there("b/realisations.jsonl") && is_there("b/sizes/16x16"));
    /* with more it goes on */
    c->seconds = 1e6;
    CHECK_OK(run(&c, "b", p, &r, &err));
    CHECK(r && r->point[0].reached && c->sizes->chosen);
    ph_campaign_result_free(&r);
    ph_campaign_free(&c);
    CHECK_END();
}

/* Real solutions: the grid is chosen, then size and grid again; the same on two workers. */
static void test_real(void **state)
{
    (void)state;
    const char rest[] =
        "size: [0.5, 0.75, 1]\nrealisations: {at_most: 400, at_least: 12, "
        "until: {quantity: C11, relative_error: 0.15}}\n";
    ph_error err = PH_ERROR_INIT;
    for (int jobs = 1; jobs <= 2; jobs++) {
        ph_campaign *c = campaign(disks, rest, PH_OK);
        ph_campaign_result *r = NULL;
        ph_campaign_split s;
        CHECK_OK(ph_campaign_settle(&c, NULL, 0, NULL, &s, &err));
        CHECK_OK(
            run(&c, jobs == 1 ? "a" : "b", (ph_campaign_params){.jobs = jobs}, &r, &err));
        if (!r) fail();
        const ph_split_candidate *x = chosen(c);
        CHECK(r->point[0].reached && c->sizes->ngrids > 1 && x->error <= 0.15);
        CHECK(c->grid_error == c->sizes->grid_error[x->grid]);
        const ph_case *one = c->point[0].c; /* the drawing has the spacing of the case */
        CHECK_REL(one->size[0] / (double)one->drawn_on[0], 1.0 / 24, 1e-14);
        CHECK(one->nodes[0] >= one->drawn_on[0]);
        CHECK(memcmp(one->nodes, c->sizes->size[c->sizes->tried[x->size]].nodes[x->grid],
                     sizeof one->nodes) == 0);
        ph_campaign_result_free(&r);
        ph_campaign_free(&c);
    }
    same_files("a", "b");
    CHECK_END();
}

static void test_what_is_refused(void **state)
{
    (void)state;
    enum { NUMBERS = 5 }; /* numbers out of their range come first */
    static const char *const bad[] = {
        "size: [0, 1]\n" UNTIL(0.01),
        "size: [-1, .nan]\n" UNTIL(0.01),
        "size: [0.1, 1e9]\n" UNTIL(0.01),
        "budget: {seconds: -1}\n" UNTIL(0.01),
        "budget: {seconds: .inf}\n" UNTIL(0.01),
        "size: large\n" UNTIL(0.01),
        "size: [1]\n" UNTIL(0.01),
        "size: [1, 0.5]\n" UNTIL(0.01),
        "size: [0.5, 0.5]\n" UNTIL(0.01),
        "size: [a, b]\n" UNTIL(0.01),
        "size: {factors: [1, 2]}\n" UNTIL(0.01),
        "size: auto\nrealisations: 20\n",
        "size: auto\nvariance_reduction: auto\n" UNTIL(0.01),
        "size: auto\nsweep: {microstructure.size: [[32, 32], [64, 64]]}\n" UNTIL(0.01),
        "size: auto\nset: {microstructure.fillers: [], microstructure.inclusions: "
        "[{shape: disk, centre: [16, 16], radius: 4, material: clay}]}\n" UNTIL(0.01),
        "budget: 60\n" UNTIL(0.01),
        "budget: {minutes: 3}\n" UNTIL(0.01)};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        CHECK(campaign(platelets, bad[i], i < NUMBERS ? PH_EUNPHYSICAL : PH_EINVAL) ==
              NULL);
    ph_campaign *c = campaign(platelets, "size: given\n" UNTIL(0.01), PH_OK), *same = c;
    const ph_campaign_params p = {.folder = folder};
    CHECK(c && c->nfactors == 0 && !(c->seconds > 0));
    CHECK(ph_campaign_choose_size(&c, NULL, 0, &p, NULL) == PH_OK);
    CHECK(c == same && !c->sizes); /* nothing to choose */
    CHECK(ph_campaign_choose_size(&c, NULL, 0, NULL, NULL) == PH_EINVAL);
    ph_campaign_free(&c);
    /* a total error on a grid that is given: nobody knows what the grid is off */
    ph_error err = PH_ERROR_INIT;
    c = campaign(disks,
                 "size: auto\nset: {microstructure.nodes: [24, 24]}\nrealisations: "
                 "{at_most: 99, until: {quantity: C11, relative_error: 0.1}}\n",
                 PH_OK);
    CHECK(ph_campaign_choose_size(&c, NULL, 0, &p, &err) == PH_EINVAL && !c->sizes);
    CHECK(strstr(err.msg, "what they are off is not known") != NULL);
    CHECK(ph_campaign_choose_size(NULL, NULL, 0, &p, NULL) == PH_EINVAL);
    ph_campaign_free(&c);
    CHECK_END();
}

int main(void)
{
#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        IN_FOLDER(test_chosen_and_reached),
        IN_FOLDER(test_same_bits),
        IN_FOLDER(test_left_out),
        IN_FOLDER(test_no_plan),
        IN_FOLDER(test_shapes),
        IN_FOLDER(test_seconds),
        IN_FOLDER(test_seconds_of_sizes),
        IN_FOLDER(test_real),
        IN_FOLDER(test_what_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
