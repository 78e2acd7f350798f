/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ph_homogenise with every one of its own allocations failing once: each route, solver and
 * constraint, on grids as small as they get. Allocations within FFTW, CHOLMOD and OpenMP are
 * not ours and are not seen; what CHOLMOD reports is in tests/cross/test_solvers.c. */
#include "check.h"
#include "oom/countdown.h"
#include "random_cases.h"

#include <math.h>

typedef struct world {
    ph_problem problem;
    ph_result *result;
} world;

static ph_status call(void *user, ph_error *err)
{
    world *w = user;
    ph_ctx ctx = {.threads = 1};
    return ph_homogenise(&w->problem, &ctx, &w->result, err);
}

static bool untouched(const void *user)
{
    return !((const world *)user)->result;
}

static void done(void *user)
{
    ph_result_free(&((world *)user)->result);
}

typedef struct way {
    const char *what;
    ptrdiff_t n[3];
    ph_model_params model;
    const char *solver, *constraint, *route;
    const char *precision;
    double tolerance; /* 0: 0.3 */
} way;

#define S .stabilisation = PH_STABILISE_SPECTRAL, .stabilisation_value = 1e-2
#define P .stabilisation = PH_STABILISE_SUBPOINT, .stabilisation_value = 0.1

#define DOUBLE NULL, 0.0

static const way ways[] = {
    {"local", {4, 3, 1}, {.kind = "local"}, "fft_cg", "periodic", "cells", DOUBLE},
    {"cells (S)",
     {4, 3, 1},
     {.points = PH_POINTS_STRESS, S},
     "fft_cg",
     "periodic",
     "cells",
     DOUBLE},
    {"single precision, refined (S)",
     {4, 3, 1},
     {.points = PH_POINTS_STRESS, S},
     "fft_cg",
     "periodic",
     "cells",
     "single",
     1e-6},
    {"single precision (P)",
     {3, 4, 3},
     {.points = PH_POINTS_STRESS, P},
     "fft_cg",
     "periodic",
     "cells",
     "single",
     1e-5},
    {"stencil (P)",
     {5, 5, 1},
     {.points = PH_POINTS_NODES, .horizon = 1.0, .weights = "none", P},
     "fft_cg",
     "periodic",
     "stencil",
     DOUBLE},
    {"convolution (S)",
     {1, 12, 12},
     {.points = PH_POINTS_NODES, .horizon = 4.0, S},
     "fft_cg",
     "periodic",
     "convolution",
     DOUBLE},
    {"convolution (P)",
     {12, 12, 1},
     {.points = PH_POINTS_STRESS, .horizon = 4.0, P},
     "fft_cg",
     "linear_displacement",
     "convolution",
     DOUBLE},
    {"direct",
     {4, 3, 1},
     {.points = PH_POINTS_STRESS, S},
     "direct",
     "periodic",
     "cells",
     DOUBLE},
    {"relaxation",
     {4, 3, 1},
     {.points = PH_POINTS_STRESS, P},
     "relaxation",
     "periodic",
     "cells",
     DOUBLE},
    {"held nodes",
     {4, 4, 1},
     {.points = PH_POINTS_STRESS, S},
     "fft_cg",
     "linear_displacement",
     "cells",
     DOUBLE},
    {"free body",
     {4, 3, 1},
     {.kind = "local"},
     "fft_cg",
     "uniform_traction",
     "cells",
     DOUBLE},
    {"cut families",
     {4, 4, 1},
     {.points = PH_POINTS_NODES, .horizon = 1.0, S},
     "direct",
     "uniform_traction",
     "bonds",
     DOUBLE},
    {"voigt", {4, 3, 1}, {.kind = "local"}, NULL, "voigt", "analytic", DOUBLE},
};

static void every_allocation_fails(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        const way *k = &ways[i];
        for (int collar = 0; collar < 2; collar++) {
            bool held = strcmp(k->constraint, "linear_displacement") == 0;
            if (collar && (!held || strcmp(k->route, "cells") != 0)) continue;
            if (held && strcmp(k->route, "convolution") == 0) collar = 1;
            ph_error err = PH_ERROR_INIT;
            ph_microstructure *micro = random_micro(&seed, PH_SPACE, k->n, false);
            world w = {
                .problem = {.micro = micro,
                            .model = k->model,
                            .constraint = {.kind = k->constraint},
                            .solver = {.kind = k->solver,
                                       .tolerance = k->tolerance > 0 ? k->tolerance : 0.3,
                                       .precision = k->precision},
                            .loads = 2u,
                            .keep_fields = true}};
            if (collar) w.problem.constraint.collar = PH_COLLAR_MATRIX;
            CHECK_OK(call(&w, &err)); /* FFTW's and OpenMP's own are made here */
            CHECK(w.result && strcmp(w.result->route, k->route) == 0);
            if (w.result && strcmp(w.result->route, k->route) != 0)
                print_error("  ... %s: route %s\n", k->what, w.result->route);
            ph_result_free(&w.result);
            if (check_failures == 0) countdown_run(k->what, call, untouched, done, &w);
            ph_microstructure_free(&micro);
        }
    }
    CHECK_END();
}

/* Cracks that grow: bits that are found room for, damaged nodes that are updated, lists and
 * factors that are made anew. */
static void cracks(void **state)
{
    (void)state;
    static const char *const solvers[] = {"fft_cg", "direct", "fft_cg", "direct"};
    static const double lengths[] = {0.3, 0.6};
    for (int i = 0; i < 4; i++) {
        ph_error err = PH_ERROR_INIT;
        uint64_t seed = 1;
        ptrdiff_t n[3] = {8, 8, 1};
        bool grows = true;
        ph_cracks c = {0};
        ph_microstructure *micro = random_micro(&seed, PH_PLANE_STRESS, n, false);
        const double *h = micro->grid.h;
        double v[2][3] = {{2 * h[0], 3 * h[1], 0}, {5 * h[0], 4 * h[1], 0}};
        ph_crack_sequence q = {
            .kind = PH_SEQUENCE_GROWTH, .nsteps = 2, .value = lengths, .grows = &grows};
        CHECK_OK(ph_cracks_add_line(&c, 2, (const double(*)[3])v, &err));
        world w = {.problem = {.micro = micro,
                               .model = {.horizon = 1.5},
                               .constraint = {.kind = i == 3 ? "uniform_traction" : NULL},
                               .solver = {.kind = solvers[i], .tolerance = 0.3},
                               .cracks = &c,
                               .sequence = &q,
                               .keep_fields = i == 0}};
        CHECK_OK(call(&w, &err));
        ph_result_free(&w.result);
        if (check_failures == 0) countdown_run("cracks", call, untouched, done, &w);
        ph_microstructure_free(&micro);
        ph_cracks_free(&c);
    }
    CHECK_END();
}

/* A loading that breaks bonds, with scatter and a crack; springs and states; with strains
 * that are found, under traction, and in time. */
static void failure(void **state)
{
    (void)state;
    static const char *const kinds[] = {"bond", "nosb"};
    static const double to[] = {0.5}, times[] = {1.0}, small[] = {0.036};
    for (int i = 0; i < 7; i++) { /* the last one has room for patches */
        ph_error err = PH_ERROR_INIT;
        ptrdiff_t side = i == 6 ? 24 : 6, n[2] = {side, side};
        double size[2] = {1, 1}, v[2][3] = {{0.2, 0.55, 0}, {0.6, 0.55, 0}};
        ph_grid g;
        ph_material m;
        ph_microstructure *micro = NULL;
        ph_cracks c = {0};
        const ph_modulus_term e = {0.5, 0.4};
        if (i < 4)
            CHECK_OK(ph_material_isotropic("m", 1.0, 1.0 / 3, &m, &err));
        else
            CHECK_OK(ph_material_viscoelastic_young("m", &(ph_modulus){0.6, 1, &e},
                                                    1.0 / 3, &m, &err));
        CHECK_OK(ph_grid_init(&g, PH_PLANE_STRESS, n, size, &err));
        CHECK_OK(ph_microstructure_new(&g, 1, &m, &micro, &err));
        if (i >= 4) ph_material_clear(&m);
        CHECK_OK(ph_cracks_add_line(&c, 2, (const double(*)[3])v, &err));
        const ph_failure_rule rule = {
            .given = true, .value = (double)NAN, .fracture_energy = 1e-4, .weibull = 9.0};
        const ph_failure f = {.material = &rule};
        const ph_loading l = {.strain = {0, 1, 0},
                              .ntargets = 1,
                              .to = i == 6 ? small : to,
                              .steps = 2,
                              .window = i == 6 ? 0.01 : 1.0,
                              .stiffness_every = 1,
                              .stress_free = i == 2 || i == 3 ? 1 : 0,
                              .times = i == 4 || i == 5 ? times : NULL};
        world w = {
            .problem = {.micro = micro,
                        .model = {.kind = kinds[i % 2], .horizon = 1.5},
                        .constraint = {.kind = i == 3 ? "uniform_traction" : "periodic"},
                        .solver = {.tolerance = 1e-3},
                        .cracks = &c,
                        .failure = &f,
                        .loading = &l}};
        CHECK_OK(call(&w, &err));
        CHECK(w.result && w.result->failure->nevents > 1);
        ph_result_free(&w.result);
        if (check_failures == 0) countdown_run("failure", call, untouched, done, &w);
        ph_microstructure_free(&micro);
        ph_cracks_free(&c);
    }
    CHECK_END();
}

/* More materials than the fractions have room for without memory of their own. */
static void many_materials(void **state)
{
    (void)state;
    enum { MANY = 70 };
    ph_error err = PH_ERROR_INIT;
    ph_material *m = calloc(MANY, sizeof *m);
    ph_grid g;
    ph_microstructure *micro = NULL;
    ptrdiff_t n[2] = {10, 7};
    double size[2] = {1, 1};
    for (int i = 0; i < MANY; i++)
        CHECK_OK(ph_material_isotropic("m", 1.0 + i, 0.3, &m[i], &err));
    CHECK_OK(ph_grid_init(&g, PH_PLANE_STRESS, n, size, &err));
    CHECK_OK(ph_microstructure_new(&g, MANY, m, &micro, &err));
    for (int i = 0; micro && i < MANY; i++)
        micro->phase[i] = (uint16_t)i;
    world w = {.problem = {.micro = micro, .constraint = {.kind = "reuss"}}};
    countdown_run("70 materials", call, untouched, done, &w);
    ph_microstructure_free(&micro);
    free(m);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_allocation_fails),
        cmocka_unit_test(cracks),
        cmocka_unit_test(failure),
        cmocka_unit_test(many_materials),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
