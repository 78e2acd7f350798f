/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a case would take: what is counted, in ratios; no second is compared with a clock. */
#include "check.h"

#include <perihom_error_bar.h>

#define HEAD                                                                             \
    "perihom: 1\n"                                                                       \
    "materials: {m: {E: 1, nu: 0.3333333333333333}, f: {E: 10, nu: "                     \
    "0.3333333333333333}}\n"                                                             \
    "microstructure:\n"                                                                  \
    "  size: [1, 1]\n"                                                                   \
    "  nodes: [16, 16]\n"                                                                \
    "  dimension: 2\n"                                                                   \
    "  plane: stress\n"                                                                  \
    "  matrix: m\n"
#define DISK                                                                             \
    "  inclusions: [{shape: disk, centre: [0.5, 0.5], radius: 0.3, material: f}]\n"

/* With the companions of the case, or its own equations only. */
static ph_estimate estimate(const char *text, const char *set, bool companions)
{
    ph_error err = PH_ERROR_INIT;
    ph_case *c = NULL;
    ph_microstructure *micro = NULL;
    ph_crack_plan *plan = NULL;
    ph_estimate e = {0};
    CHECK_OK(
        ph_case_parse(text, strlen(text), "case", &set, set != NULL, &c, NULL, &err));
    CHECK_OK(ph_rve_build(c, &micro, &err));
    CHECK_OK(ph_rve_cracks(c, &plan, &err));
    const ph_problem p = ph_rve_problem(c, micro, plan);
    if (companions)
        CHECK_OK(ph_rve_estimate(c, &p, &e, &err));
    else
        CHECK_OK(ph_homogenise_estimate(&p, &e, &err));
    ph_crack_plan_free(&plan);
    ph_microstructure_free(&micro);
    ph_case_free(&c);
    return e;
}

static void test_elastic(void **state)
{
    (void)state;
    static const char disk[] = HEAD DISK;
    ph_estimate own = estimate(disk, NULL, false), all = estimate(disk, NULL, true);
    CHECK(own.loads == 2 && own.nodes == 256 && own.bonds == 0); /* a square cell */
    CHECK_REL(own.seconds, 2 * own.seconds_load, 1e-12);
    CHECK(own.seconds_least == own.seconds);
    CHECK_REL(all.seconds, 1.25 * own.seconds, 1e-12); /* the companion has a quarter */
    ph_estimate none = estimate(disk, "error_bar=none", true);
    CHECK_REL(none.seconds, own.seconds, 1e-12);
    ph_estimate two = estimate(disk, "error_bar={boundary: true}", true);
    CHECK(two.seconds >= 1.5 * own.seconds * (1 - 1e-12)); /* its other constraint too */
    ph_estimate one = estimate(disk, "output.constants=[C11]", true);
    CHECK(one.loads == 1);
    CHECK_REL(one.seconds, own.seconds_load, 1e-12); /* one constant has no error bar */
    CHECK_END();
}

static void test_cracks(void **state)
{
    (void)state;
    static const char growing[] =
        HEAD "cracks: [{from: [0.4, 0.5], to: [0.6, 0.5]}]\n"
             "sequence: {crack_growth: {crack: 0, lengths: {list: [0.1, 0.3, 0.5]}}}\n";
    static const char still[] =
        HEAD "cracks: [{from: [0.4137, 0.4613], to: [0.4138, 0.4613]}]\n";
    ph_estimate three = estimate(growing, NULL, false);
    ph_estimate six = estimate(
        growing, "sequence.crack_growth.lengths.list=[0.1, 0.2, 0.3, 0.4, 0.45, 0.5]",
        false);
    double each = three.loads * three.seconds_load; /* of the pristine cell */
    CHECK_REL(six.seconds - each, 2 * (three.seconds - each), 1e-12);
    CHECK(three.seconds > 4 * each); /* cracked cells take more iterations */
    CHECK(three.nnotes > 0 && !strstr(three.notes[three.nnotes - 1], "no bond"));
    ph_estimate kept = estimate(growing, "output.fields=true", false);
    /* of each step and load 2 displacements, 3 strains, 3 stresses, and the damage */
    CHECK(kept.bytes >= three.bytes + 3 * 256 * 8 * (3 * 8 + 1));
    ph_estimate uncut = estimate(still, NULL, false);
    bool said = false;
    for (int i = 0; i < uncut.nnotes; i++)
        said |= strstr(uncut.notes[i], "1 of 1 cracks cut no bond") != NULL;
    CHECK(said);
    CHECK_END();
}

static void test_failure(void **state)
{
    (void)state;
    static const char pulled[] =
        HEAD DISK "model: {kind: bond, horizon: 2}\n"
                  "failure: {m: {critical_stretch: 0.01}}\n"
                  "loading: {strain: [0, 1, 0], to: 0.01, steps: 10}\n"
                  "error_bar: none\n"; /* no companion, a quarter of all this */
    ph_estimate e = estimate(pulled, NULL, true);
    CHECK(e.bonds > 16 && e.seconds > e.seconds_least);
    /* twice as long: the same section */
    ph_estimate longer = estimate(pulled,
                                  "microstructure={dimension: 2, plane: stress, "
                                  "size: [1, 2], nodes: [16, 32], matrix: m}",
                                  true);
    CHECK(longer.bonds == e.bonds);
    ph_estimate finer = estimate(pulled, "microstructure.nodes=[32, 32]", true);
    CHECK(finer.bonds == 2 * e.bonds);
    ph_estimate every = estimate(pulled, "loading.equilibrium=every_event", true);
    CHECK(every.seconds - every.seconds_least > 3 * (e.seconds - e.seconds_least));
    ph_estimate steps = estimate(pulled, "loading.stiffness_every=1", true);
    CHECK_REL(steps.seconds_least - e.seconds_least, 9 * e.loads * e.seconds_load, 1e-12);
    CHECK_END();
}

/* A laminate is a closed form only as long as nothing relaxes. */
static void test_relaxing(void **state)
{
    (void)state;
    static const char layers[] =
        HEAD "  inclusions: [{shape: layer, normal: 1, from: 0, to: 0.5, material: f}]\n";
    static const char relaxes[] =
        "materials.f={nu: 0.3, E: {infinity: 1, terms: [{modulus: 9, time: 1}]}}";
    CHECK(estimate(layers, NULL, true).seconds == 0);
    CHECK(estimate(layers, relaxes, true).seconds > 0);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_elastic),
        cmocka_unit_test(test_cracks),
        cmocka_unit_test(test_failure),
        cmocka_unit_test(test_relaxing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
