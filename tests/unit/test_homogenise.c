/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What ph_homogenise refuses, and what it hands back when it does not get there. */
#include "check.h"
#include "random_cases.h"

static ph_microstructure *some_micro(void)
{
    uint64_t seed = 7;
    ptrdiff_t n[3] = {6, 5, 1};
    return random_micro(&seed, PH_PLANE_STRAIN, n, false);
}

static void refused(const ph_problem *p, ph_status want, const char *text)
{
    ph_error err = PH_ERROR_INIT;
    ph_result *res = NULL;
    CHECK(ph_homogenise(p, NULL, &res, &err) == want);
    CHECK(!res && strstr(err.msg, text));
    if (res || !strstr(err.msg, text)) print_error("  ... got '%s'\n", err.msg);
    ph_result_free(&res);
}

static void bad_problems(void **state)
{
    (void)state;
    ph_microstructure *micro = some_micro();
    refused(NULL, PH_EINVAL, "no microstructure");
    for (int collar = -1; collar <= 3; collar += 4) {
        ph_problem p = {.micro = micro};
        p.constraint =
            (ph_constraint_params){"linear_displacement", PH_COLLAR_MATRIX, collar};
        refused(&p, PH_EINVAL, "collar");
    }
    ph_problem p = {.micro = micro, .constraint = {.kind = "glue"}};
    refused(&p, PH_EINVAL, "glue");
    p = (ph_problem){.micro = micro, .model = {.kind = "string"}};
    refused(&p, PH_EINVAL, "string");
    p = (ph_problem){.micro = micro, .model = {.horizon = NAN}};
    refused(&p, PH_EINVAL, "horizon");
    p = (ph_problem){.micro = micro, .solver = {.tolerance = NAN}};
    refused(&p, PH_EINVAL, "tolerance");
    p = (ph_problem){.micro = micro};
    for (int i = 0; i < 2; i++) {
        for (int a = 0; a < 6; a++)
            for (int b = 0; b < 6; b++)
                micro->materials[0].stiffness.m[a][b] *= i ? 1e200 : 1e-80;
        refused(&p, PH_EUNPHYSICAL, "units");
    }
    ph_microstructure_free(&micro);
    CHECK_END();
}

static bool slower_at_second(void *user, const ph_progress *now)
{
    int *most = user;
    if (now->load == 1 && now->iteration > *most) *most = now->iteration;
    return true;
}

/* The loads before the one that failed keep their columns; the others are zero. */
static void not_converged(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    int most = 0;
    ph_ctx ctx = {slower_at_second, &most, 1};
    ph_microstructure *micro = some_micro();
    ph_result *all = NULL, *part = NULL;
    ph_problem p = {.micro = micro, .solver = {.tolerance = 1e-10}};
    CHECK_OK(ph_homogenise(&p, &ctx, &all, &err));
    for (int load = 0; all && load < 3; load++) {
        int need = all->iterations[load], before = load ? all->iterations[0] : 0;
        for (int l = 0; l < load; l++)
            before = all->iterations[l] > before ? all->iterations[l] : before;
        if (need <= before && load) continue; /* an earlier one fails first */
        err = (ph_error)PH_ERROR_INIT;
        p.solver.max_iterations = need - 1;
        CHECK(ph_homogenise(&p, NULL, &part, &err) == PH_ENOCONV);
        CHECK(part && !part->converged && part->loads == (1u << load) - 1u);
        for (int a = 0; part && a < 3; a++)
            for (int b = 0; b < 3; b++) /* `all` was made symmetric: tolerance squared */
                CHECK_ABS(part->stiffness.m[b][a],
                          a < load ? all->stiffness.m[b][a] : 0.0, 1e-8);
        ph_result_free(&part);
    }
    CHECK(most > 1);
    err = (ph_error)PH_ERROR_INIT;
    p.constraint.kind = "uniform_traction";
    p.solver.max_iterations = 1;
    p.solver.kind = "fft_cg";
    CHECK(ph_homogenise(&p, NULL, &part, &err) == PH_ENOCONV);
    CHECK(part && part->loads == 0 && ph_sym4_norm(&part->stiffness) == 0.0);
    ph_result_free(&part);
    ph_result_free(&all);
    ph_microstructure_free(&micro);
    CHECK_END();
}

/* A box of one cell, or cells of one material, with fields: nothing to solve, all finite. */
static void one_cell(void **state)
{
    (void)state;
    static const char *const constraint[] = {"periodic", "uniform_traction"};
    for (int i = 0; i < 2; i++)
        for (int local = 0; local < 2; local++) {
            ph_error err = PH_ERROR_INIT;
            ph_material m;
            ph_grid g;
            ph_microstructure *micro = NULL;
            ph_result *res = NULL;
            ptrdiff_t n[3] = {1, 1, 1};
            double size[3] = {1, 2, 3};
            CHECK_OK(ph_material_isotropic("m", 3.0, 0.3, &m, &err));
            CHECK_OK(ph_grid_init(&g, PH_SPACE, n, size, &err));
            CHECK_OK(ph_microstructure_new(&g, 1, &m, &micro, &err));
            ph_problem p = {.micro = micro,
                            .model = {.kind = local ? "local" : "nosb"},
                            .constraint = {.kind = constraint[i]},
                            .keep_fields = true};
            ph_status st = ph_homogenise(&p, NULL, &res, &err);
            CHECK(st == PH_OK);
            if (st != PH_OK) print_error("  ... %s, %s\n", constraint[i], err.msg);
            if (res) {
                ph_sym4 d = ph_sym4_combine(1.0, &res->stiffness, -1.0, &m.stiffness);
                CHECK_ABS(ph_sym4_norm(&d), 0.0, 1e-13);
                CHECK(isfinite(res->hill_mandel) && isfinite(res->stabilisation_energy));
                CHECK_ABS(res->hill_mandel, 0.0, 1e-14);
                CHECK_ABS(res->stabilisation_energy, 0.0, 1e-14);
                CHECK(res->nfields == 6);
            }
            ph_result_free(&res);
            ph_microstructure_free(&micro);
        }
    CHECK_END();
}

/* Plates with nothing between them resist only along themselves: two loads cost no energy,
 * and what is left of it is not measured against itself. */
static void loads_without_energy(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_material m[2];
    ph_grid g;
    ph_microstructure *micro = NULL;
    ph_result *res = NULL;
    ptrdiff_t n[2] = {16, 16};
    double size[2] = {1, 1};
    CHECK_OK(ph_material_isotropic("plate", 3.0, 0.3, &m[0], &err));
    m[1] = ph_material_void("gap");
    CHECK_OK(ph_grid_init(&g, PH_PLANE_STRESS, n, size, &err));
    CHECK_OK(ph_microstructure_new(&g, 2, m, &micro, &err));
    for (int x = 0; x < 256; x++)
        micro->phase[x] = x >= 64 && x < 192;
    ph_problem p = {.micro = micro};
    CHECK_OK(ph_homogenise(&p, NULL, &res, &err));
    if (res) {
        CHECK_ABS(res->stiffness.m[1][1], 1.5, 1e-12); /* half of E */
        CHECK_ABS(res->stiffness.m[0][0], 0.0, 1e-12);
        CHECK(res->hill_mandel < 1e-9 && res->stabilisation_energy < 1e-9);
    }
    ph_result_free(&res);
    ph_microstructure_free(&micro);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bad_problems),
        cmocka_unit_test(not_converged),
        cmocka_unit_test(one_cell),
        cmocka_unit_test(loads_without_energy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
