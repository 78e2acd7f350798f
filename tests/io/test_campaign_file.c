/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Campaign files: what they mean, and what is said of bad ones. */
#define _XOPEN_SOURCE 700 /* nftw */
#include "folder.h"

#include <perihom_campaign.h>

static void put(const char *name, const char *text)
{
    ph_error err = PH_ERROR_INIT;
    char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    CHECK_OK(ph_write_file(path, text, strlen(text), &err));
}

/* @return the first complaint or "" */
static const char *read_text(const char *text, ph_campaign **c)
{
    static char first[512];
    ph_error err = PH_ERROR_INIT;
    char path[128];
    put("c.yaml", text);
    snprintf(path, sizeof path, "%s/c.yaml", folder);
    *c = NULL;
    ph_status st = ph_campaign_read(path, NULL, 0, c, NULL, &err);
    CHECK((st == PH_OK) == (*c != NULL));
    snprintf(first, sizeof first, "%s", st == PH_OK ? "" : err.msg);
    return first;
}

#define CASE  "case: " PH_DATA_DIR "/cases/epoxy-clay.yaml\n"
#define HEAD  "campaign: 1\n" CASE
#define PLAIN HEAD "outputs: [E1]\nrealisations: 3\n"

static void test_points(void **state)
{
    (void)state;
    ph_campaign *c;
    put("t.csv", "h,kappa\n3,0.5\n4,0.25\n5,0.125\n");
    const char *why =
        read_text(PLAIN "set: {solver.tolerance: 1e-5}\n"
                        "sweep:\n"
                        "  microstructure.fillers.0.weight_fraction: [0.01, 0.02]\n"
                        "  solver: [{kind: auto, tolerance: 1e-4}, {kind: fft_cg}]\n"
                        "zip: {materials.clay.E: [100, 200], materials.epoxy.E: [1, 2]}\n"
                        "table: {file: t.csv, columns: {model.horizon: h, "
                        "microstructure.fillers.0.interphase.kappa: kappa}}\n",
                  &c);
    if (*why) print_error("%s\n", why);
    assert_non_null(c);
    CHECK(c->npoints == 2 * 2 * 2 * 3 && c->nkeys == 6);
    /* the last group runs fastest */
    CHECK(c->point[0].number[0] == 0.01 && c->point[23].number[0] == 0.02);
    for (int p = 0; p < c->npoints; p++) {
        const ph_campaign_point *at = &c->point[p];
        CHECK(at->number[4] == 3 + p % 3 && at->c->model.horizon == 3 + p % 3);
        CHECK(at->number[5] == 0.5 / (1 << p % 3));
        CHECK(at->number[2] == 100 * (1 + p / 3 % 2));
        CHECK(at->c->materials[at->c->matrix].E == 1 + p / 3 % 2);
        CHECK(isnan(at->number[1])); /* a map */
        CHECK(at->c->solver.tolerance == (p / 6 % 2 ? 1e-6 : 1e-4));
        CHECK(at->c->fillers[0].amount_value == 0.01 * (1 + p / 12));
    }
    ph_campaign_free(&c);
    /* no sweep: one point */
    read_text(PLAIN, &c);
    assert_non_null(c);
    CHECK(c->npoints == 1 && c->nkeys == 0 && c->judged == -1);
    CHECK(c->stopping.at_most == 3 && c->common_random_numbers);
    CHECK(ph_campaign_realisation(c, 5, 7) == 7);
    ph_campaign_free(&c);
    CHECK_END();
}

static uint64_t hash_of(const char *text)
{
    ph_campaign *c;
    const char *why = read_text(text, &c);
    if (*why) print_error("%s\n", why);
    uint64_t hash = c ? c->hash : 0;
    ph_campaign_free(&c);
    return hash;
}

/* The hash knows what makes a realisation, and nothing else. */
static void test_hash(void **state)
{
    (void)state;
    const uint64_t plain = hash_of(PLAIN);
    CHECK(hash_of(PLAIN "# a comment\ntitle: other\n") == plain);
    CHECK(hash_of(HEAD "outputs: [E1]\nrealisations: {at_most: 90, until: {quantity: E1, "
                       "half_width: 1}}\n") == plain);
    CHECK(hash_of(PLAIN "set: {microstructure.seed: 1}\n") == plain); /* the default */
    CHECK(hash_of(PLAIN "set: {microstructure.seed: 2}\n") != plain);
    CHECK(hash_of(PLAIN "set: {materials.clay.E: 178.0000000001}\n") != plain);
    CHECK(hash_of(HEAD "outputs: [E2]\nrealisations: 3\n") != plain);
    CHECK(hash_of(HEAD "outputs: [E1, E2]\nrealisations: 3\n") != plain);
    CHECK(hash_of(PLAIN "common_random_numbers: false\n") != plain);
    CHECK(hash_of(PLAIN "sweep: {model.horizon: [8, 8]}\n") != plain);
    CHECK_END();
}

static void test_independent_points(void **state)
{
    (void)state;
    ph_campaign *c;
    read_text(PLAIN "common_random_numbers: false\n", &c);
    assert_non_null(c);
    CHECK(ph_campaign_realisation(c, 0, 7) == 7);
    CHECK(ph_campaign_realisation(c, 3, 7) == 3 * 4294967296u + 7);
    ph_campaign_free(&c);
    CHECK_END();
}

static void test_complaints(void **state)
{
    (void)state;
    const struct {
        const char *text, *says;
    } row[] = {
        {"", "the file is empty: a campaign begins with campaign: 1"},
        {"- 1\n", "a campaign file is a map"},
        {"campaign: 2\n" CASE, "c.yaml:1: campaign: 2 is not admissible: must be 1"},
        {CASE "outputs: [E1]\nrealisations: 3\n", "campaign: missing"},
        {"campaign: 1\noutputs: [E1]\nrealisations: 3\n", "case: missing"},
        {HEAD "realisations: 3\n", "outputs: missing"},
        {HEAD "outputs: [E1]\n", "realisations: missing"},
        {PLAIN "swep: {}\n", "unknown key: a campaign has"},
        {PLAIN "swep: {}\n", "did you mean 'sweep'?"},
        {HEAD "outputs: E1\nrealisations: 3\n", "c.yaml:3: outputs: 'E1' is not"},
        {HEAD "outputs: []\nrealisations: 3\n", "must have 1 to 64 quantities"},
        {HEAD "outputs: [E1, E1]\nrealisations: 3\n", "'E1' is there twice"},
        {HEAD "outputs: [isotropc.E]\nrealisations: 3\n", "did you mean 'isotropic.E'?"},
        {HEAD "outputs: [[E1]]\nrealisations: 3\n", "must be the name of a quantity"},
        {HEAD "outputs: [E3]\nrealisations: 3\n", "no constants along axis 3"},
        {HEAD "outputs: [fraction.gold]\nrealisations: 3\n", "no material 'gold'"},
        {HEAD "outputs: [E1]\nrealisations: 0\n",
         "0 is not admissible: must be an integer"},
        {HEAD "outputs: [E1]\nrealisations: many\n", "'many' is not admissible"},
        {HEAD "outputs: [E1]\nrealisations: {at_least: 3}\n", "at_most: missing"},
        {HEAD "outputs: [E1]\nrealisations: {at_most: 9, at_least: 3}\n",
         "without until"},
        {HEAD "outputs: [E1]\nrealisations: {at_most: 9, until: {quantity: E1, "
              "half_width: 1}}\n",
         "9 is less than at_least, 20"},
        {HEAD "outputs: [E1]\nrealisations: {at_most: 99, until: {quantity: E2, "
              "half_width: 1}}\n",
         "'E2' is not admissible: must be E1"},
        {HEAD "outputs: [E1]\nrealisations: {at_most: 99, until: {quantity: E1}}\n",
         "relative_half_width: missing"},
        {HEAD "outputs: [E1]\nrealisations: {at_most: 99, until: {quantity: E1, "
              "half_width: 0}}\n",
         "half_width: 0 is not admissible"},
        {HEAD "outputs: [E1]\nrealisations: {at_most: 99, until: {quantity: E1, "
              "half_width: 1, confidence: 95}}\n",
         "95 is not admissible: must lie between 0 and 1"},
        {HEAD "outputs: [E1]\nrealisations: {at_most: 99, until: {quantity: E1, "
              "half_width: 1, relative_half_width: 0.1}}\n",
         "one of them"},
        {PLAIN "sweep: [1]\n", "must be a map"},
        {PLAIN "sweep: {model.horizon: 3}\n", "must be the list of values"},
        {PLAIN "sweep: {model.horizon: []}\n", "at least one value"},
        {PLAIN "sweep: {model.horizn: [3]}\n", "point 0: "},
        {PLAIN "sweep: {model.horizn: [3]}\n", "did you mean 'horizon'?"},
        {PLAIN "sweep: {model.horizon: [3, -1]}\n", "point 1: "},
        {PLAIN "sweep: {microstructure.realisation: [3]}\n", "itself counts"},
        {PLAIN "sweep: {model.horizon: [3]}\nzip: {model.horizon: [3]}\n",
         "varies already"},
        {PLAIN "zip: {materials.clay.E: [1], materials.epoxy.E: [1, 2]}\n",
         "2 values, and 1 of 'materials.clay.E'"},
        {PLAIN "table: {columns: {model.horizon: h}}\n", "table.file: missing"},
        {PLAIN "table: {file: none.csv, columns: {model.horizon: h}}\n", "none.csv"},
        {PLAIN "table: {file: t.csv, columns: {model.horizon: x}}\n",
         "has no such column"},
        {PLAIN "set: [1]\n", "set: a list of 1 is not admissible"},
        {PLAIN "data: {file: t.csv, columns: {E1: h}}\n", "a swept key"},
        {PLAIN "common_random_numbers: yes\n", "must be true or false"},
        {"campaign: 1\ncase: nowhere.yaml\noutputs: [E1]\nrealisations: 3\n",
         "nowhere.yaml: cannot be opened"},
    };
    put("t.csv", "h\n3\n");
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        ph_campaign *c;
        const char *why = read_text(row[i].text, &c);
        bool said = strstr(why, row[i].says) != NULL;
        if (!said) print_error("want '%s'\ngot  '%s'\n", row[i].says, why);
        CHECK(said && !c);
        ph_campaign_free(&c);
    }
    CHECK_END();
}

/* The campaigns that come with the program, and what they vary. */
static void test_shipped(void **state)
{
    (void)state;
    const struct {
        const char *name;
        int points;
    } row[] = {{"ongaro-figure-3-14", 1},
               {"rve-size", 4},
               {"epoxy-clay-exfoliated", 5},
               {"epoxy-clay-agglomerated", 4}};
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        ph_error err = PH_ERROR_INIT;
        ph_campaign *c = NULL;
        char path[512];
        snprintf(path, sizeof path, "%s/campaigns/%s.yaml", PH_DATA_DIR, row[i].name);
        CHECK_OK(ph_campaign_read(path, NULL, 0, &c, NULL, &err));
        CHECK(c && c->npoints == row[i].points && c->judged == 0);
        ph_campaign_free(&c);
    }
    CHECK_END();
}

/* A file of the wrong kind, a folder, a file that is not there. */
static void test_no_file(void **state)
{
    (void)state;
    ph_campaign *c = NULL;
    CHECK(ph_campaign_read("/nowhere/c.yaml", NULL, 0, &c, NULL, NULL) == PH_EIO && !c);
    CHECK(ph_campaign_read(folder, NULL, 0, &c, NULL, NULL) != PH_OK && !c);
    CHECK(ph_campaign_read(PH_DATA_DIR "/cases/epoxy-clay.yaml", NULL, 0, &c, NULL,
                           NULL) == PH_EINVAL);
    ph_campaign_free(&c);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_points),
        cmocka_unit_test(test_hash),
        cmocka_unit_test(test_independent_points),
        cmocka_unit_test(test_complaints),
        cmocka_unit_test(test_no_file),
        cmocka_unit_test(test_shipped),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
