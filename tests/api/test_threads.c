/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Threads of one program that solve different problems at once get the bits that each of them
 * gets alone: the library has no state of its own. */
#include "check.h"
#include "solve.h"

#include <pthread.h>

enum { JOBS = 4, ROUNDS = 2 };

struct job {
    ph_problem problem;
    bool relaxes;
    ph_status status;
    ph_sym4 stiffness, late;
    int iterations;
};

static void *solve(void *argument)
{
    struct job *job = argument;
    ph_result *result = NULL;
    ph_viscoelastic *v = NULL;
    if (job->relaxes) {
        job->status = ph_viscoelastic_solve(&job->problem, NULL, &one_thread, &v, NULL);
        if (job->status != PH_OK) return NULL;
        job->stiffness = ph_prony_instantaneous(v->series);
        job->late = ph_prony_at_time(v->series, 3.0);
        job->iterations = (int)v->iterations;
    } else {
        job->status = ph_homogenise(&job->problem, &one_thread, &result, NULL);
        if (job->status != PH_OK) return NULL;
        job->stiffness = result->stiffness;
        job->iterations = result->iterations[0];
    }
    ph_result_free(&result);
    ph_viscoelastic_free(&v);
    return NULL;
}

static ph_material relaxing(void)
{
    ph_error err = PH_ERROR_INIT;
    ph_material m;
    ph_modulus_term term[2] = {{0.5, 2.0}, {20.0, 1.0}};
    ph_modulus E = {1.0, 2, term};
    CHECK_OK(ph_material_viscoelastic_young("resin", &E, 0.35, &m, &err));
    return m;
}

static void prepare(struct job job[JOBS], ph_microstructure *micro[JOBS])
{
    ph_material soft = isotropic("soft", 1, 0.3), stiff = isotropic("stiff", 20, 0.2);
    ph_material third = isotropic("third", 1, 1.0 / 3),
                hard = isotropic("hard", 9, 1.0 / 3);
    ph_material resin = relaxing();
    micro[0] = round_cell(PH_PLANE_STRAIN, 32, 0.4, soft, stiff);
    micro[1] = round_cell(PH_PLANE_STRESS, 24, 0.3, third, hard);
    micro[2] = round_cell(PH_SPACE, 10, 0.2, soft, stiff);
    micro[3] = round_cell(PH_GENERALISED_STRAIN, 16, 0.5, resin, stiff);
    ph_material_clear(&resin);
    for (int i = 0; i < JOBS; i++)
        job[i] = (struct job){.problem = {.micro = micro[i]}};
    job[1].problem.model.kind = "bond";
    job[1].problem.interface = PH_INTERFACE_NODE_CENTRE;
    job[2].problem.model.kind = "local";
    job[3].relaxes = true;
}

static void together_as_alone(void **state)
{
    (void)state;
    struct job alone[JOBS], job[JOBS];
    ph_microstructure *micro[JOBS];
    prepare(alone, micro);
    memcpy(job, alone, sizeof job);
    for (int i = 0; i < JOBS; i++) {
        solve(&alone[i]);
        CHECK(alone[i].status == PH_OK && ph_sym4_norm(&alone[i].stiffness) > 0);
    }
    for (int round = 0; round < ROUNDS; round++) {
        pthread_t thread[JOBS];
        for (int i = 0; i < JOBS; i++)
            CHECK(pthread_create(&thread[i], NULL, solve, &job[i]) == 0);
        for (int i = 0; i < JOBS; i++)
            pthread_join(thread[i], NULL);
        for (int i = 0; i < JOBS; i++) {
            CHECK(job[i].status == PH_OK && job[i].iterations == alone[i].iterations);
            CHECK(memcmp(&job[i].stiffness, &alone[i].stiffness, sizeof(ph_sym4)) == 0);
            CHECK(memcmp(&job[i].late, &alone[i].late, sizeof(ph_sym4)) == 0);
        }
    }
    for (int i = 0; i < JOBS; i++)
        ph_microstructure_free(&micro[i]);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(together_as_alone)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
