/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ph_viscoelastic_solve with every one of its own allocations failing once. */
#include <perihom.h>

#include "check.h"
#include "oom/countdown.h"
#include "relaxing.h"

typedef struct world {
    ph_problem problem;
    ph_relaxation_params params;
    ph_viscoelastic *result;
} world;

static ph_status call(void *user, ph_error *err)
{
    world *w = user;
    return ph_viscoelastic_solve(&w->problem, &w->params, &one_thread, &w->result, err);
}

static bool untouched(const void *user)
{
    return !((const world *)user)->result;
}

static void done(void *user)
{
    ph_viscoelastic_free(&((world *)user)->result);
}

typedef struct way {
    const char *what;
    ph_kinematics kin;
    int n, kinds[3];
    ph_model_params model;
    const char *constraint, *route;
} way;

static const way ways[] = {
    {"cut cells", PH_PLANE_STRAIN, 4, {1, 0, 2}, {.kind = "local"}, "periodic", NULL},
    {"out of the plane",
     PH_PLANE_STRESS,
     4,
     {2, 0, 3},
     {.points = PH_POINTS_NODES, .horizon = 1.0, .weights = "none"},
     "periodic",
     NULL},
    {"bonds",
     PH_PLANE_STRESS,
     6,
     {1, 0, 1},
     {.kind = "bond", .horizon = 1.5},
     "periodic",
     NULL},
    {"cut families",
     PH_PLANE_STRAIN,
     4,
     {1, 0, 1},
     {.points = PH_POINTS_NODES, .horizon = 1.0},
     "uniform_traction",
     NULL},
    {"reuss", PH_PLANE_STRESS, 4, {2, 0, 1}, {.kind = "local"}, "reuss", NULL},
    {"carson", PH_PLANE_STRAIN, 4, {1, 0, 2}, {.kind = "local"}, "periodic", "carson"},
    {"steps", PH_PLANE_STRESS, 4, {2, 0, 3}, {.kind = "local"}, "periodic", "stepping"},
    {"steps of bonds",
     PH_PLANE_STRESS,
     4,
     {1, 0, 1},
     {.kind = "bond", .horizon = 1.5},
     "periodic",
     "stepping"},
    {"frequency",
     PH_PLANE_STRAIN,
     4,
     {1, 0, 2},
     {.kind = "local"},
     "linear_displacement",
     "frequency"},
    {"frequency of bonds",
     PH_PLANE_STRESS,
     4,
     {1, 0, 1},
     {.kind = "bond", .horizon = 1.5},
     "periodic",
     "frequency"},
};

static void every_allocation_fails(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    static const double s[] = {1.0};
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        const way *k = &ways[i];
        ph_error err = PH_ERROR_INIT;
        ph_history *h = NULL;
        CHECK_OK(ph_history_ramp(3, 0, true, 0.1, 0.1, 1.0, 0.0, &h, &err));
        ph_microstructure *micro = blocks_cell(&seed, k->kin, k->n, k->kinds, 2.0, 1.0, 2,
                                               k->model.kind && k->model.kind[0] == 'b');
        world w = {.problem = {.micro = micro,
                               .model = k->model,
                               .constraint = {.kind = k->constraint},
                               .solver = {.tolerance = 1e-3}},
                   .params = {.route = k->route,
                              .tolerance = 0.9,
                              .carson = s,
                              .ncarson = 1,
                              .times = s,
                              .ntimes = 1,
                              .omega = s,
                              .nomega = 1,
                              .history = k->model.horizon > 0.0 ? NULL : h}};
        CHECK_OK(call(&w, &err)); /* FFTW's and OpenMP's own are made here */
        CHECK(w.result != NULL);
        done(&w);
        if (check_failures == 0) countdown_run(k->what, call, untouched, done, &w);
        ph_history_free(&h);
        ph_microstructure_free(&micro);
    }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_allocation_fails),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
