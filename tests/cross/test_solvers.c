/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every solver of the catalogue finds the same effective stiffness, whatever the model and
 * the constraint; threads do not change a bit. */
#include "check.h"
#include "random_cases.h"
#include "solve/solver.h"

typedef struct combination {
    const char *what;
    ph_kinematics kin;
    ptrdiff_t n[3];
    bool voids;
    ph_model_params model;
    const char *constraint;
} combination;

static const combination combinations[] = {
    {"stress (S)",
     PH_PLANE_STRAIN,
     {12, 9, 1},
     false,
     {.points = PH_POINTS_STRESS,
      .stabilisation = PH_STABILISE_SPECTRAL,
      .stabilisation_value = 1e-2},
     "periodic"},
    {"stress (P), voids",
     PH_PLANE_STRAIN,
     {12, 9, 1},
     true,
     {.points = PH_POINTS_STRESS, .stabilisation = PH_STABILISE_SUBPOINT},
     "periodic"},
    {"stress (P), 3D",
     PH_SPACE,
     {5, 6, 4},
     false,
     {.points = PH_POINTS_STRESS, .stabilisation = PH_STABILISE_SUBPOINT},
     "periodic"},
    {"nodes (S)",
     PH_GENERALISED_STRAIN,
     {9, 10, 1},
     false,
     {.points = PH_POINTS_NODES,
      .stabilisation = PH_STABILISE_SPECTRAL,
      .stabilisation_value = 1e-2},
     "periodic"},
    {"nodes (P)",
     PH_PLANE_STRESS,
     {9, 10, 1},
     false,
     {.points = PH_POINTS_NODES,
      .stabilisation = PH_STABILISE_SUBPOINT,
      .stabilisation_value = 0.1},
     "periodic"},
    {"large stress families",
     PH_PLANE_STRESS,
     {10, 11, 1},
     false,
     {.points = PH_POINTS_STRESS,
      .horizon = 2.0,
      .stabilisation = PH_STABILISE_SUBPOINT,
      .stabilisation_value = 0.1},
     "periodic"},
    {"local", PH_PLANE_STRAIN, {9, 12, 1}, false, {.kind = "local"}, "periodic"},
    {"local, voids", PH_SPACE, {5, 4, 4}, true, {.kind = "local"}, "periodic"},
    {"stress (S)",
     PH_PLANE_STRAIN,
     {9, 8, 1},
     false,
     {.points = PH_POINTS_STRESS,
      .stabilisation = PH_STABILISE_SPECTRAL,
      .stabilisation_value = 1e-2},
     "linear_displacement"},
    {"nodes (S)",
     PH_PLANE_STRAIN,
     {12, 12, 1},
     false,
     {.points = PH_POINTS_NODES,
      .stabilisation = PH_STABILISE_SPECTRAL,
      .stabilisation_value = 1e-2},
     "linear_displacement"},
    {"local, 3D", PH_SPACE, {4, 5, 4}, false, {.kind = "local"}, "linear_displacement"},
    {"stress (S)",
     PH_PLANE_STRAIN,
     {9, 8, 1},
     false,
     {.points = PH_POINTS_STRESS,
      .stabilisation = PH_STABILISE_SPECTRAL,
      .stabilisation_value = 1e-2},
     "uniform_traction"},
    {"stress (P)",
     PH_GENERALISED_STRAIN,
     {9, 8, 1},
     false,
     {.points = PH_POINTS_STRESS, .stabilisation = PH_STABILISE_SUBPOINT},
     "uniform_traction"},
    {"local, 3D", PH_SPACE, {4, 5, 4}, false, {.kind = "local"}, "uniform_traction"},
    {"nodes (S)",
     PH_PLANE_STRAIN,
     {9, 8, 1},
     false,
     {.points = PH_POINTS_NODES,
      .stabilisation = PH_STABILISE_SPECTRAL,
      .stabilisation_value = 1e-2},
     "uniform_traction"},
    {"large stress families (P)",
     PH_PLANE_STRESS,
     {9, 8, 1},
     false,
     {.points = PH_POINTS_STRESS,
      .horizon = 1.6,
      .stabilisation = PH_STABILISE_SUBPOINT,
      .stabilisation_value = 0.1},
     "uniform_traction"},
};
enum { COMBINATIONS = sizeof combinations / sizeof *combinations };

static ph_result *solve(const combination *k, const ph_microstructure *micro,
                        const char *solver, int threads, bool fields)
{
    ph_error err = PH_ERROR_INIT;
    ph_ctx ctx = {.threads = threads};
    ph_result *res = NULL;
    ph_problem p = {.micro = micro,
                    .model = k->model,
                    .constraint = {.kind = k->constraint},
                    .solver = {.kind = solver, .tolerance = 1e-9, .max_iterations = 5000},
                    .keep_fields = fields};
    int before = check_failures;
    CHECK_OK(ph_homogenise(&p, &ctx, &res, &err));
    if (check_failures > before)
        print_error("  ... %s, %s, solver %s\n", k->what, k->constraint,
                    solver ? solver : "auto");
    return res;
}

/* Residuals of 1e-9 leave errors of C of their square times a condition below 1e6; where
 * the constraint is by stress, of their first power (the averages are not at a minimum). */
static const double same = 1e-6;

static void solvers_agree(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int i = 0; i < COMBINATIONS; i++) {
        const combination *k = &combinations[i];
        ph_microstructure *micro = random_micro(&seed, k->kin, k->n, k->voids);
        ph_result *direct = solve(k, micro, "direct", 1, false);
        for (size_t m = 0; direct && m < ph_nsolvers; m++) {
            const char *name = ph_solvers[m].info.name;
            bool cut = strcmp(direct->route, "bonds") == 0;
            if (strcmp(name, "direct") == 0 || (cut && strcmp(name, "fft_cg") == 0))
                continue;
            ph_result *other = solve(k, micro, name, 1, false);
            if (!other) continue;
            double d = difference(&other->stiffness, &direct->stiffness);
            if (!(d < same))
                print_error("  ... %s, %s, %s\n", k->what, k->constraint, name);
            CHECK_ABS(d, 0.0, same);
            CHECK_ABS(other->hill_mandel, 0.0, 1e-6);
            ph_result_free(&other);
        }
        if (direct) CHECK_ABS(direct->hill_mandel, 0.0, 1e-8);
        if (direct) CHECK_ABS(direct->asymmetry, 0.0, 1e-8);
        if (direct && !(direct->hill_mandel < 1e-8))
            print_error("  ... %s, %s, direct, %d steps\n", k->what, k->constraint,
                        direct->iterations[0]);
        ph_result_free(&direct);
        ph_microstructure_free(&micro);
    }
    CHECK_END();
}

static void threads_change_nothing(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int i = 0; i < COMBINATIONS; i++)
        for (size_t m = 0; m < ph_nsolvers; m++) {
            const combination *k = &combinations[i];
            ph_microstructure *micro = random_micro(&seed, k->kin, k->n, k->voids);
            ph_result *one = solve(k, micro, NULL, 1, false);
            bool cut = one && strcmp(one->route, "bonds") == 0;
            ph_result_free(&one);
            if (cut && strcmp(ph_solvers[m].info.name, "fft_cg") == 0) {
                ph_microstructure_free(&micro);
                continue;
            }
            one = solve(k, micro, ph_solvers[m].info.name, 1, true);
            for (int t = 2; one && t <= 3; t++) {
                ph_result *many = solve(k, micro, ph_solvers[m].info.name, t, true);
                if (!many) continue;
                CHECK(memcmp(&one->stiffness, &many->stiffness, sizeof one->stiffness) ==
                      0);
                for (int f = 0; f < one->nfields; f++)
                    CHECK(memcmp(one->fields[f].strain, many->fields[f].strain,
                                 sizeof(double) * (size_t)(one->fields[f].ns *
                                                           ph_grid_cells(&one->grid))) ==
                          0);
                ph_result_free(&many);
            }
            ph_result_free(&one);
            ph_microstructure_free(&micro);
        }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(solvers_agree),
        cmocka_unit_test(threads_change_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
