/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A superelement and its text with every one of our own allocations failing once; those
 * within CHOLMOD are not seen. */
#include "oom/countdown.h"
#include "solve.h"

#include <unistd.h>

typedef struct world {
    ph_problem problem;
    ph_superelement *element;
    char *text, path[64];
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

static ph_status write_rows(void *user, ph_error *err)
{
    world *w = user;
    return ph_superelement_write_h5(w->element, w->path, err);
}

static void memory_runs_out(void **state)
{
    (void)state;
    static const ph_model_params model[] = {
        {.kind = "local"}, {.kind = "local"}, {.kind = "bond", .horizon = 1.5}};
    for (int i = 0; i < 3; i++) {
        ph_error err = PH_ERROR_INIT;
        const ph_kinematics kin = i == 1 ? PH_GENERALISED_STRAIN : PH_PLANE_STRESS;
        ph_microstructure *m = round_cell(kin, 4, 0.4, isotropic("soft", 1, 1.0 / 3),
                                          isotropic("stiff", 20, 1.0 / 3));
        world w = {.problem = {.micro = m, .model = model[i]}};
        countdown_run("ph_superelement_new", condense, no_element, free_element, &w);
        CHECK_OK(condense(&w, &err));
        countdown_run("ph_superelement_to_mtx", print, no_text, free_text, &w);
        char folder[] = "/tmp/perihom-oom-XXXXXX";
        assert_non_null(mkdtemp(folder));
        snprintf(w.path, sizeof w.path, "%s/s.h5", folder);
        countdown_run("ph_superelement_write_h5", write_rows, NULL, NULL, &w);
        unlink(w.path);
        rmdir(folder);
        free_element(&w);
        ph_microstructure_free(&m);
    }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(memory_runs_out)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
