/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reading a campaign and summing it up while memory runs out. */
#define _XOPEN_SOURCE 700 /* nftw */
#include "oom/countdown.h"
#include "split_model.h"

#include <ftw.h>

static struct {
    char folder[64];
    ph_campaign *c, *read;
    ph_campaign_result *result, *made;
    char *text;
    ph_split_question question;
    ph_split_answer *answer;
} w;

static const char text[] =
    "campaign: 1\ncase: random.yaml\nset: {materials.epoxy.E: 3}\n"
    "sweep: {materials.clay.E: [50, 178]}\nzip: {model.horizon: [2, 3]}\n"
    "realisations: {at_most: 50, until: {quantity: C11, half_width: 0.1}}\n"
    "outputs: [C11, fraction.clay]\n"
    "variance_reduction: {levels: [{solver.tolerance: 0.1}, fillers]}\n";

static int remove_one(const char *path, const struct stat *s, int flag, struct FTW *f)
{
    (void)s, (void)flag, (void)f;
    return remove(path);
}

static ph_status no_solution(void *user, const ph_scenario *s, int point,
                             ph_evaluation *out, ph_error *err)
{
    (void)user;
    out->value[0] = (double)(s->realisation % 7) + point;
    out->value[1] = 1;
    return s->realisation == 3 ? ph_error_set(err, PH_ENOCONV, "-", 1, "no") : PH_OK;
}

static ph_status read_campaign(void *user, ph_error *err)
{
    (void)user;
    return ph_campaign_parse(text, sizeof text - 1, PH_TEST_DIR "/cli/campaigns/c.yaml",
                             NULL, 0, &w.read, NULL, err);
}

static ph_status summarise(void *user, ph_error *err)
{
    (void)user;
    return ph_campaign_summarise(w.c, w.folder, &w.made, err);
}

static ph_status to_json(void *user, ph_error *err)
{
    (void)user;
    return ph_campaign_to_json(w.c, w.result, &w.text, err);
}

static ph_status choose(void *user, ph_error *err)
{
    (void)user;
    return ph_split_choose(&w.question, &w.answer, err);
}

static bool untouched(const void *user)
{
    (void)user;
    return !w.read && !w.made && !w.text && !w.answer;
}

static void done(void *user)
{
    (void)user;
    ph_campaign_free(&w.read);
    ph_campaign_result_free(&w.made);
    ph_split_answer_free(&w.answer);
    free(w.text);
    w.text = NULL;
}

static int set_up(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    strcpy(w.folder, "/tmp/perihom-campaign-XXXXXX");
    if (!mkdtemp(w.folder) || read_campaign(NULL, &err) != PH_OK) return 1;
    w.c = w.read;
    w.read = NULL;
    const ph_campaign_params p = {.folder = w.folder, .jobs = 1, .evaluate = no_solution};
    return ph_campaign_run(w.c, &p, &w.result, &err) != PH_EPARTIAL;
}

static int tear_down(void **state)
{
    (void)state;
    ph_campaign_result_free(&w.result);
    ph_campaign_free(&w.c);
    return nftw(w.folder, remove_one, 8, FTW_DEPTH | FTW_PHYS);
}

static void test_memory(void **state)
{
    (void)state;
    countdown_run("ph_campaign_parse", read_campaign, untouched, done, NULL);
    countdown_run("ph_campaign_summarise", summarise, untouched, done, NULL);
    countdown_run("ph_campaign_to_json", to_json, untouched, done, NULL);
    const split_model m = {2, 2, 0.01, 0.02, 0};
    w.question = split_ask(&m, 1, 0.02, 3, 20);
    countdown_run("ph_split_choose", choose, untouched, done, NULL);
    split_clear(&w.question);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_memory)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
