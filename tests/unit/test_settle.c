/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A campaign whose case asks for an accuracy: the grid's share, and what is left. */
#define _XOPEN_SOURCE 700 /* nftw */
#include "folder.h"

#include <perihom_campaign.h>

static const char disks[] =
    "perihom: 1\n"
    "materials: {m: {E: 1, nu: 0.3}, f: {E: 10, nu: 0.3}}\n"
    "microstructure:\n"
    "  dimension: 2\n"
    "  plane: strain\n"
    "  size: [1, 1]\n"
    "  drawn_on: [16, 16]\n"
    "  matrix: m\n"
    "  fillers: [{shape: particle, material: f, volume_fraction: 0.2, size: 0.25,\n"
    "             placement: {gap: 0.01}}]\n"
    "accuracy: {relative: 0.05}\n";

static void put(const char *name, const char *text)
{
    ph_error err = PH_ERROR_INIT;
    char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    CHECK_OK(ph_write_file(path, text, strlen(text), &err));
}

static ph_campaign *campaign(const char *rest, ph_status want)
{
    ph_error err = PH_ERROR_INIT;
    ph_campaign *c = NULL;
    char path[128], text[1024];
    put("disks.yaml", disks);
    snprintf(text, sizeof text, "campaign: 1\ncase: disks.yaml\noutputs: [C11, G12]\n%s",
             rest);
    put("c.yaml", text);
    snprintf(path, sizeof path, "%s/c.yaml", folder);
    CHECK(ph_campaign_read(path, NULL, 0, &c, NULL, &err) == want);
    return c;
}

#define TOTAL                                                                            \
    "realisations: {at_most: 99, at_least: 9, until: {quantity: C11, relative_error: "   \
    "0.04}}\n"
#define SWEEP "sweep: {materials.f.E: [3, 30]}\n"

static double value(const ph_case *c, const char *nodes)
{
    ph_error err = PH_ERROR_INIT;
    ph_case *one = NULL;
    ph_quantity C11;
    ph_evaluation e = {0};
    char set[2][96];
    snprintf(set[0], sizeof set[0], "microstructure.nodes=%s", nodes);
    snprintf(set[1], sizeof set[1], "materials.f.E=%.17g", c->materials[1].E);
    const char *const sets[] = {set[0], set[1]};
    CHECK_OK(ph_case_parse(disks, sizeof disks - 1, "case", sets, 2, &one, NULL, &err));
    CHECK_OK(ph_quantity_find("C11", &C11, &err));
    const ph_scenario s = {one, 0, 1, &C11};
    if (one) CHECK_OK(ph_scenario_evaluate(&s, NULL, &e, &err));
    ph_case_free(&one);
    return e.value[0];
}

static void test_split(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_campaign *c = campaign(SWEEP TOTAL, PH_OK);
    ph_campaign_split s = {0};
    if (!c) fail();
    uint64_t before = c->hash;
    CHECK_OK(ph_campaign_settle(&c, NULL, 0, NULL, &s, &err));
    CHECK(s.accuracy == 0.04 && s.pilots == 2);
    CHECK_ABS(s.grid + s.half_width, 0.04, 1e-15);
    CHECK(s.grid > 0 && s.half_width >= 0.2 * 0.04);
    CHECK(c->stopping.relative_half_width == s.half_width && c->grid_error == s.grid);
    CHECK(c->npoints == 2 && c->hash != before);
    for (int p = 0; p < c->npoints; p++) { /* one grid, as fine as the drawing at least */
        const ph_case *one = c->point[p].c;
        CHECK(memcmp(one->nodes, s.nodes, sizeof s.nodes) == 0 && one->nodes[0] >= 16);
        char nodes[64];
        snprintf(nodes, sizeof nodes, "[%td, %td]", s.nodes[0], s.nodes[1]);
        /* the pilot itself, against a grid four times as fine or more */
        CHECK_REL(value(one, nodes), value(one, "[160, 160]"), s.grid);
    }
    /* nothing is open any more: again it does nothing */
    ph_campaign *same = c;
    CHECK_OK(ph_campaign_settle(&c, NULL, 0, NULL, &s, &err));
    CHECK(c == same && s.pilots == 0 && s.half_width == 0);
    ph_campaign_free(&c);
    CHECK_END();
}

static void test_what_is_refused(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_campaign_split s = {0};
    /* without a total error there is nothing to split */
    CHECK(campaign("realisations: 9\n", PH_EINVAL) == NULL);
    CHECK(campaign("realisations: {at_most: 9, at_least: 5, until: {quantity: C11,\n"
                   "  relative_half_width: 0.1}}\n",
                   PH_EINVAL) == NULL);
    /* without a number it is the accuracy of the case */
    ph_campaign *c =
        campaign("realisations: {at_most: 99, until: {quantity: C11}}\n", PH_OK);
    CHECK(c && c->relative_error == 0.05);
    ph_campaign_free(&c);
    /* not before it is settled */
    c = campaign(TOTAL, PH_OK);
    ph_campaign_result *r = NULL;
    const ph_campaign_params params = {.folder = folder};
    CHECK(c && ph_campaign_run(c, &params, &r, &err) == PH_EINVAL && !r);
    CHECK(strstr(err.msg, "give microstructure.nodes") != NULL);
    ph_campaign_free(&c);
    /* one grid for boxes of two sizes */
    err = (ph_error)PH_ERROR_INIT;
    c = campaign("sweep: {microstructure.size: [[1, 1], [2, 2]]}\n" TOTAL, PH_OK);
    ph_campaign *same = c;
    CHECK(c && ph_campaign_settle(&c, NULL, 0, NULL, &s, &err) == PH_EINVAL && c == same);
    ph_campaign_free(&c);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_split, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_what_is_refused, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
