/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every allocation of the case reader fails once: the status says so, nothing is handed out,
 * nothing leaks (run under valgrind or ASan). */
#include <perihom/case.h>

#include "check.h"
#include "oom/wrap.h"

static const char text[] =
    "perihom: 1\n"
    "materials: {a: {E: 1, nu: 0}, b: {void: true}}\n"
    "microstructure:\n"
    "  dimension: 2\n"
    "  plane: stress\n"
    "  size: [1, 1]\n"
    "  nodes: [4, 4]\n"
    "  matrix: a\n"
    "  inclusions: [{shape: disk, centre: [0, 0], fraction: 0.9, material: b}]\n";
static const char viscoelastic[] =
    "perihom: 1\n"
    "units: {temperature: C}\n"
    "temperature: 20\n"
    "materials:\n"
    "  a: {E: {infinity: 1, terms: [{modulus: 1, time: 1}]}, nu: 0, shift: {wlf: {C1: "
    "17, "
    "C2: 50, reference: 25}}}\n"
    "  b: {bulk: 4, shear: {infinity: 0, terms: [{modulus: 1, time: 1}]}}\n"
    "  c: {stiffness: {infinity: &m [[3, 1, 1, 0, 0, 0], [1, 3, 1, 0, 0, 0], [1, 1, 3, "
    "0, "
    "0, 0], [0, 0, 0, 1, 0, 0], [0, 0, 0, 0, 1, 0], [0, 0, 0, 0, 0, 1]], terms: "
    "[{stiffness: *m, time: 2}]}}\n"
    "microstructure: {dimension: 2, plane: stress, size: [1, 1], nodes: [4, 4], matrix: "
    "a}\n"
    "viscoelastic: {times: [1, 2], frequencies: [1], history: {component: 11, points: "
    "[[0, 1], [1, 2]]}}\n";
static const char *const sets[] = {"model.horizon.length=0.5", "solver={tolerance: 0.1}"};

static void fail_each(const char *input, bool forever, ph_status good)
{
    long n = 1;
    for (bool came = true; came && n < 10000; n++) {
        ph_case *c = NULL;
        ph_case_issues issues = {0};
        ph_error err = PH_ERROR_INIT;
        oom_after(n, forever);
        ph_status st =
            ph_case_parse(input, strlen(input), "t", sets, 2, &c, &issues, &err);
        came = oom_stop();
        CHECK(st == (came ? PH_ENOMEM : good));
        CHECK((c != NULL) == (st == PH_OK));
        if (came) CHECK(err.status == PH_ENOMEM && strstr(err.msg, "no memory"));
        ph_case_free(&c);
        ph_case_issues_free(&issues);
    }
    print_message("%ld allocations\n", n - 2);
    CHECK(n > 30 && n < 10000);
}

static void test_good_case(void **state)
{
    (void)state;
    fail_each(text, false, PH_OK);
    fail_each(text, true, PH_OK);
    fail_each(viscoelastic, false, PH_OK);
    CHECK_END();
}

static void test_bad_case(void **state)
{
    (void)state;
    char bad[2000];
    snprintf(bad, sizeof bad, "%sone: 1\ntwo: 2\nthree: 3\n", text);
    fail_each(bad, false, PH_EINVAL);
    fail_each(bad, true, PH_EINVAL);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_good_case),
        cmocka_unit_test(test_bad_case),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
