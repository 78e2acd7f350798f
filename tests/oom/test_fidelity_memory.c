/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every allocation of automatic fidelity fails once. */
#include "oom/countdown.h"

#include <jansson.h>

#include <perihom_fidelity.h>

static struct {
    ph_case *c;
    ph_fidelity *f, *made;
    char *text;
} w;

static const char text[] =
    "perihom: 1\nmaterials: {m: {E: 1, nu: 0.3}, f: {E: 1.1, nu: 0.3}}\n"
    "microstructure: {dimension: 2, plane: strain, size: [1, 1], matrix: m,\n"
    "  inclusions: [{shape: layer, normal: 1, from: 0, to: 0.5, material: f}]}\n"
    "accuracy: {relative: 0.1}\n";

static ph_status solve(void *user, ph_error *err)
{
    (void)user;
    const ph_ctx ctx = {.threads = 1};
    return ph_fidelity_solve(w.c, &ctx, &w.made, err);
}

static ph_status to_json(void *user, ph_error *err)
{
    (void)user;
    return ph_fidelity_to_json(w.f, NULL, NULL, &w.text, err);
}

static bool untouched(const void *user)
{
    (void)user;
    return !w.made && !w.text;
}

static void done(void *user)
{
    (void)user;
    ph_fidelity_free(&w.made);
    free(w.text);
    w.text = NULL;
}

static void test_every_allocation(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    CHECK_OK(ph_case_parse(text, sizeof text - 1, "case", NULL, 0, &w.c, NULL, &err));
    CHECK_OK(solve(NULL, &err));
    w.f = w.made;
    w.made = NULL;
    countdown_run("ph_fidelity_solve", solve, untouched, done, NULL);
    json_set_alloc_funcs(countdown_malloc, countdown_free);
    countdown_run("ph_fidelity_to_json", to_json, untouched, done, NULL);
    ph_fidelity_free(&w.f);
    ph_case_free(&w.c);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_every_allocation)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
