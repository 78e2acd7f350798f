/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The routes to the effective relaxation share little but the operator: real problems and a
 * projection (`reduced`), an elastic problem at a time (`carson`), time steps (`stepping`),
 * complex problems (`frequency`). */
#include <perihom/viscoelastic.h>

#include "check.h"
#include "effective/frequency.h"
#include "visco_case.h"

#define S .stabilisation = PH_STABILISE_SPECTRAL, .stabilisation_value = 1e-2
#define P .stabilisation = PH_STABILISE_SUBPOINT, .stabilisation_value = 0.1

typedef struct setup {
    ph_kinematics kin;
    bool cuts;
    ph_model_params model;
    const char *constraint;
    bool dear; /* too dear to step */
} setup;

static const setup setups[] = {
    {PH_PLANE_STRAIN, false, {.points = PH_POINTS_STRESS, P}, "periodic", false},
    {PH_PLANE_STRAIN, true, {.points = PH_POINTS_STRESS, S}, "periodic", false},
    {PH_PLANE_STRESS, true, {.points = PH_POINTS_STRESS, P}, "periodic", false},
    {PH_PLANE_STRESS,
     true,
     {.points = PH_POINTS_NODES, .horizon = 1.3, S},
     "periodic",
     false},
    {PH_PLANE_STRAIN,
     true,
     {.points = PH_POINTS_NODES, .horizon = 1.5, P},
     "periodic",
     false},
    {PH_GENERALISED_STRAIN, true, {.kind = "local"}, "periodic", false},
    {PH_SPACE, true, {.kind = "local"}, "periodic", false},
    {PH_SPACE, true, {.points = PH_POINTS_STRESS, .horizon = 1.6, S}, "periodic", true},
    {PH_SPACE, false, {.points = PH_POINTS_STRESS, S}, "periodic", true},
    {PH_PLANE_STRAIN,
     true,
     {.points = PH_POINTS_STRESS, P},
     "linear_displacement",
     false},
    {PH_PLANE_STRESS, true, {.kind = "local"}, "linear_displacement", false},
    {PH_PLANE_STRAIN, true, {.kind = "local"}, "uniform_traction", false},
};
enum { SETUPS = sizeof setups / sizeof *setups };

static ph_microstructure *cell_of(const setup *s, uint64_t *seed)
{
    static const ptrdiff_t plane[3] = {4, 4, 1}, space[3] = {3, 3, 3},
                           wide[3] = {4, 4, 4};
    return viscous_micro(seed, s->kin,
                         s->kin != PH_SPACE       ? plane
                         : s->model.horizon > 0.0 ? wide
                                                  : space,
                         s->cuts);
}

/* C*(t) of the reduced model, exact but for its projection. */
static ph_viscoelastic *reduced(const ph_problem *problem)
{
    ph_error err = PH_ERROR_INIT;
    ph_viscoelastic *v = NULL;
    ph_ctx ctx = {.threads = 1};
    ph_relaxation_params params = {.tolerance = 1e-8, .max_points = 60};
    CHECK_OK(ph_viscoelastic_solve(problem, &params, &ctx, &v, &err));
    return v;
}

/* Column `a` of C*(t) at some times by steps. */
static void step_column(ph_stepper *s, int a, int n, const double *time,
                        const ph_stepping_params *p, ph_step_state *state)
{
    ph_error err = PH_ERROR_INIT;
    ph_stepping_report report;
    double zero = 0.0, unit[6] = {0};
    unit[a] = 1.0;
    ph_load_history h = {1, &zero, unit, 0};
    CHECK_OK(ph_i_stepping(s, &h, n, time, p, state, &report, &err));
}

/* A tolerance of 2e-4 holds over ten decades and some hundred steps, whose
 * errors fade with the memory of the medium. Beginning and end have none but the solver's. */
static void test_stepping_is_reduced(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    static const double time[] = {0.0, 0.01, 0.3, 1.0, 30.0, 1e6};
    enum { TIMES = sizeof time / sizeof *time };
    for (int i = 0; i < SETUPS; i++) {
        if (setups[i].dear) continue;
        int before = check_failures;
        ph_microstructure *micro = cell_of(&setups[i], &seed);
        visco_case c;
        ph_step_state st[TIMES];
        start_case(&c, micro, &setups[i].model, setups[i].constraint, 1e-9);
        ph_viscoelastic *v = reduced(&c.problem);
        int a = i % c.run.map->ns;
        step_column(c.stepper, a, TIMES, time, &(ph_stepping_params){.tolerance = 2e-4},
                    st);
        for (int k = 0; v && k < TIMES; k++) {
            ph_sym4 want = ph_prony_at_time(v->series, time[k]);
            double off = 0.0, size = 0.0;
            for (int j = 0; j < want.n; j++) {
                off += pow(st[k].stress[j] - want.m[j][a], 2);
                size += pow(want.m[j][a], 2);
            }
            CHECK_ABS(sqrt(off / size), 0.0, k == 0 || k == TIMES - 1 ? 1e-6 : 2e-4);
        }
        if (check_failures > before) print_error("  ... setup %d\n", i);
        ph_viscoelastic_free(&v);
        end_case(&c);
        ph_microstructure_free(&micro);
    }
    CHECK_END();
}

/* No error but those of the solvers and of the projection, whose 1e-8 holds on the real axis
 * of s and is some ten times as large on the imaginary one. */
static void test_frequency_is_reduced(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    static const double omega[] = {1e-8, 0.03, 1.0, 40.0, 1e8};
    enum { OMEGAS = sizeof omega / sizeof *omega };
    for (int i = 0; i < SETUPS; i++) {
        int before = check_failures;
        ph_error err = PH_ERROR_INIT;
        ph_microstructure *micro = cell_of(&setups[i], &seed);
        visco_case c;
        ph_complex_modulus m[OMEGAS];
        start_case(&c, micro, &setups[i].model, setups[i].constraint, 1e-9);
        ph_i_stepper_free(&c.stepper);
        ph_viscoelastic *v = reduced(&c.problem);
        CHECK_OK(ph_i_frequency(&c.run, 1e-9, OMEGAS, omega, m, &err));
        for (int k = 0; v && k < OMEGAS; k++) {
            ph_sym4 re, im;
            double low, high;
            ph_prony_complex(v->series, omega[k], &re, &im);
            ph_sym4 dre = ph_sym4_combine(1.0, &m[k].storage, -1.0, &re),
                    dim = ph_sym4_combine(1.0, &m[k].loss, -1.0, &im);
            CHECK_ABS(hypot(ph_sym4_norm(&dre), ph_sym4_norm(&dim)) / ph_sym4_norm(&re),
                      0.0, 1e-6);
            ph_sym4_eigenvalues(&m[k].loss, &low, &high); /* dissipates */
            CHECK(low >= -1e-8 * ph_sym4_norm(&m[k].storage));
        }
        if (check_failures > before) print_error("  ... setup %d\n", i);
        ph_viscoelastic_free(&v);
        end_case(&c);
        ph_microstructure_free(&micro);
    }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_stepping_is_reduced),
        cmocka_unit_test(test_frequency_is_reduced),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
