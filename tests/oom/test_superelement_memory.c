/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A superelement and its text with every one of our own allocations failing once; those
 * within CHOLMOD are not seen. */
#include "oom/countdown.h"
#include "solve.h"

typedef struct world {
    ph_problem problem;
    ph_superelement *element;
    char *text;
} world;

static ph_status condense(void *user, ph_error *err)
{
    world *w = user;
    return ph_superelement_new(&w->problem, &one_thread, &w->element, err);
}

static bool no_element(const void *user)
{
    return !((const world *)user)->element;
}

static void free_element(void *user)
{
    ph_superelement_free(&((world *)user)->element);
}

static ph_status print(void *user, ph_error *err)
{
    world *w = user;
    return ph_superelement_to_mtx(w->element, &w->text, err);
}

static bool no_text(const void *user)
{
    return !((const world *)user)->text;
}

static void free_text(void *user)
{
    free(((world *)user)->text);
    ((world *)user)->text = NULL;
}

static void memory_runs_out(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_material soft = isotropic("soft", 1, 0.3), stiff = isotropic("stiff", 20, 0.2);
    ph_microstructure *m = round_cell(PH_PLANE_STRAIN, 4, 0.4, soft, stiff);
    world w = {.problem = {.micro = m, .model.kind = "local"}};
    countdown_run("ph_superelement_new", condense, no_element, free_element, &w);
    CHECK_OK(condense(&w, &err));
    countdown_run("ph_superelement_to_mtx", print, no_text, free_text, &w);
    free_element(&w);
    ph_microstructure_free(&m);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(memory_runs_out)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
