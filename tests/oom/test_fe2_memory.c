/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A life with FE2 with every one of its own allocations failing once: an RVE, points, steps
 * that are tried, accepted, saved and restored; elastic, relaxing (cut cells, bonds), failing. */
#include "oom/countdown.h"
#include "relaxing.h"

typedef struct world {
    ph_problem problem;
    double de[3];
    ph_fe2 *fe2;
    char memory[1 << 16];
} world;

static ph_status live(world *w, ph_fe2_point *p[2], ph_error *err)
{
    ph_status st;
    double stress[6], C[18], both[6];
    for (int i = 0; i < 6; i++)
        both[i] = w->de[i % 3] * (i < 3 ? 1.0 : 0.7);
    for (int k = 0; k < 2; k++) {
        st = ph_fe2_update_all(p, 2, both, 0.5 * k, stress, C, &one_thread, err);
        for (int i = 0; st == PH_OK && i < 2; i++)
            st = ph_fe2_accept(p[i], err);
        if (st != PH_OK) return st;
    }
    assert_true(ph_fe2_point_bytes(p[0]) <= sizeof w->memory);
    st = ph_fe2_point_save(p[0], w->memory, sizeof w->memory, err);
    if (st == PH_OK)
        st = ph_fe2_point_restore(p[1], w->memory, ph_fe2_point_bytes(p[0]), err);
    return st;
}

static ph_status call(void *user, ph_error *err)
{
    world *w = user;
    ph_fe2_point *p[2] = {NULL, NULL};
    ph_status st = ph_fe2_new(&w->problem, &(ph_fe2_params){.cache_bytes = 1},
                              &one_thread, &w->fe2, err);
    for (int i = 0; st == PH_OK && i < 2; i++)
        st = ph_fe2_point_new(w->fe2, &p[i], err);
    if (st == PH_OK) st = live(w, p, err);
    ph_fe2_point_free(&p[0]);
    ph_fe2_point_free(&p[1]);
    ph_fe2_free(&w->fe2);
    return st;
}

static void run(const char *what, world *w)
{
    ph_error err = PH_ERROR_INIT;
    w->problem.solver.tolerance = 1e-3;
    CHECK_OK(call(w, &err)); /* FFTW's and OpenMP's own are made here */
    if (check_failures == 0) countdown_run(what, call, NULL, NULL, w);
}

static void relaxing(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    static const ph_model_params model[3] = {
        {.kind = "local"},
        {.points = PH_POINTS_NODES, .horizon = 1.0, .weights = "none"},
        {.kind = "bond", .horizon = 1.5}};
    for (int i = 0; i < 3; i++) {
        const int kinds[3] = {1, 0, i < 2 ? 2 : 1};
        world w = {.de = {1e-3, 2e-3, 1e-3}};
        ph_microstructure *m =
            blocks_cell(&seed, PH_PLANE_STRESS, i < 2 ? 4 : 6, kinds, 10, 2, 2, i == 2);
        w.problem = (ph_problem){.micro = m, .model = model[i]};
        run("relaxing", &w);
        ph_microstructure_free(&m);
    }
    CHECK_END();
}

static void others(void **state)
{
    (void)state;
    static const char *const kinds[] = {"bond", "nosb", "local"};
    for (int i = 0; i < 3; i++) {
        ph_error err = PH_ERROR_INIT;
        double v[2][3] = {{0.2, 0.55, 0}, {0.6, 0.55, 0}};
        ph_cracks c = {0};
        ph_microstructure *m =
            round_cell(PH_PLANE_STRESS, 6, 0.2, isotropic("soft", 1, 1.0 / 3),
                       isotropic("stiff", 2, 1.0 / 3));
        CHECK_OK(ph_cracks_add_line(&c, 2, (const double(*)[3])v, &err));
        const ph_failure_rule rule[2] = {{.given = true,
                                          .value = (double)NAN,
                                          .fracture_energy = 1e-4,
                                          .weibull = 9.0},
                                         {.given = false}};
        const ph_failure f = {.material = rule};
        world w = {.de = {0, 0.2, 0.02}};
        w.problem = (ph_problem){.micro = m, .model = {.kind = kinds[i]}};
        if (i < 2) {
            w.problem.model.horizon = 1.5;
            w.problem.cracks = &c;
            w.problem.failure = &f;
        }
        run(i < 2 ? "failing" : "elastic", &w);
        ph_microstructure_free(&m);
        ph_cracks_free(&c);
    }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(relaxing),
                                       cmocka_unit_test(others)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
