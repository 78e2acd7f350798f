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

/* Uniform traction where points see more than their own cell. */
static bool cut_at_faces(const combination *k)
{
    return strcmp(k->constraint, "uniform_traction") == 0 && !k->model.kind &&
           (k->model.points == PH_POINTS_NODES || k->model.horizon > 0.0);
}

static bool takes(const combination *k, const char *solver)
{
    return strcmp(solver, "fft_cg") != 0 || !cut_at_faces(k);
}

/* Single precision: periodic cells whose points see only their own. */
static bool takes_floats(const combination *k, const char *solver)
{
    if (strcmp(solver, "fft_cg") != 0) return false;
    bool local = k->model.kind && strcmp(k->model.kind, "local") == 0;
    return strcmp(k->constraint, "periodic") == 0 &&
           (local || (!k->model.kind && k->model.points == PH_POINTS_STRESS &&
                      k->model.horizon == 0.0));
}

static ph_result *solve(const combination *k, const ph_microstructure *micro,
                        const char *solver, const char *precision, double tolerance,
                        bool quick)
{
    ph_error err = PH_ERROR_INIT;
    ph_ctx ctx = {.threads = 1};
    ph_result *res = NULL;
    ph_problem p = {
        .micro = micro,
        .model = k->model,
        .constraint = {.kind = k->constraint},
        .solver = {.kind = solver, .tolerance = tolerance, .precision = precision},
        .loads = quick ? 1u : 0u,
        .keep_fields = quick};
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
        ph_result *direct = solve(k, micro, "direct", NULL, 1e-9, false);
        for (size_t m = 0; direct && m < 2 * ph_nsolvers; m++) {
            const char *name = ph_solvers[m / 2].info.name,
                       *precision = m % 2 ? "single" : "double";
            CHECK((strcmp(direct->route, "bonds") == 0) == cut_at_faces(k));
            if (strcmp(name, "direct") == 0 || !takes(k, name)) continue;
            if (m % 2 && !takes_floats(k, name)) continue;
            ph_result *other = solve(k, micro, name, precision, 1e-8, false);
            if (!other) continue;
            double d = difference(&other->stiffness, &direct->stiffness);
            if (!(d < same))
                print_error("  ... %s, %s, %s, %s\n", k->what, k->constraint, name,
                            precision);
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

/* Displacement of one load, by a solver and an operator with this many threads. */
static void solve_with(random_case *c, const ph_solver_method *solver, int threads,
                       double *u)
{
    ph_error err = PH_ERROR_INIT;
    ph_setting setting = {.box = c->micro->grid};
    ph_cg_report report = {.tolerance = 1e-2, .max_iterations = 200};
    ph_system system = {.setting = &setting, .params = &c->params, .meter = &c->meter};
    const double macro[6] = {1.0, 0.3, 0.2, 0.1, 0.5, 0.4};
    void *self = NULL;
    c->params.threads = threads;
    CHECK_OK(
        ph_i_operator_new(&setting.box, c->map, &c->params, &c->meter, &system.op, &err));
    if (!solver->refuses(&system)) {
        CHECK_OK(solver->init(&system, &self, &err));
        ph_i_operator_load(system.op, macro, system.op->f);
        CHECK_OK(solver->solve(self, system.op->f, u, &report, &err));
        solver->free(&self);
    }
    ph_i_operator_free(&system.op);
}

typedef struct threaded {
    ph_kinematics kin;
    ptrdiff_t n[3];
    ph_points points;
    double horizon;
    ph_stabilisation stabilisation;
    double value;
    ph_route route;
} threaded;

/* Sums are taken in the same order whatever the number of threads. */
static void threads_change_nothing(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    static const threaded cases[] = {
        {PH_PLANE_STRAIN,
         {9, 8, 1},
         PH_POINTS_STRESS,
         1.0,
         PH_STABILISE_SPECTRAL,
         0.1,
         0},
        {PH_SPACE, {5, 4, 6}, PH_POINTS_STRESS, 1.0, PH_STABILISE_SUBPOINT, 0.1, 0},
        {PH_SPACE, {5, 6, 4}, PH_POINTS_AUTO, 0.0, PH_STABILISE_NONE, 0.0, 0},
        {PH_PLANE_STRESS,
         {9, 8, 1},
         PH_POINTS_NODES,
         1.6,
         PH_STABILISE_SPECTRAL,
         0.1,
         PH_ROUTE_STENCIL},
        {PH_GENERALISED_STRAIN,
         {9, 8, 1},
         PH_POINTS_NODES,
         1.6,
         PH_STABILISE_SUBPOINT,
         0.1,
         PH_ROUTE_CONVOLUTION},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const threaded *k = &cases[i];
        random_case c = new_case(&seed, k->kin, k->n, false, k->points, k->horizon,
                                 influence_at(0), k->stabilisation, k->value);
        ptrdiff_t n = displacements(&c);
        double *one = random_field(&seed, n), *many = random_field(&seed, n);
        c.params.route = k->route;
        for (size_t m = 0; m < 2 * ph_nsolvers; m++) {
            const ph_solver_method *solver = &ph_solvers[m / 2];
            if (m % 2) solver = solver->single;
            if (!solver) continue;
            solve_with(&c, solver, 1, one);
            for (int t = 2; t <= 3; t++) {
                solve_with(&c, solver, t, many);
                bool same_bits = memcmp(one, many, sizeof *one * (size_t)n) == 0;
                CHECK(same_bits);
                if (!same_bits)
                    print_error("  ... case %zu, %s, %d threads\n", i, solver->info.title,
                                t);
            }
        }
        free(one), free(many);
        free_case(&c);
    }
    CHECK_END();
}

/* What `auto` takes, and that it says why. */
static void automatic(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int i = 0; i < COMBINATIONS; i++) {
        const combination *k = &combinations[i];
        ph_microstructure *micro = random_micro(&seed, k->kin, k->n, k->voids);
        ph_result *res = solve(k, micro, NULL, NULL, 1e-3, true);
        if (res) CHECK(strcmp(res->solver, cut_at_faces(k) ? "direct" : "fft_cg") == 0);
        bool said = false;
        for (int n = 0; res && n < res->nnotes; n++)
            said = said || strncmp(res->notes[n], "solver: ", 8) == 0;
        CHECK(said);
        ph_result_free(&res);
        ph_microstructure_free(&micro);
    }
    combination voids = {
        "stress (S), voids",
        PH_PLANE_STRAIN,
        {16, 16, 1},
        true,
        {.points = PH_POINTS_STRESS, .stabilisation = PH_STABILISE_SPECTRAL},
        "periodic"};
    ph_microstructure *micro = random_micro(&seed, voids.kin, voids.n, true);
    ph_result *res = solve(&voids, micro, NULL, NULL, 1e-6, false);
    if (res) CHECK(strcmp(res->solver, "direct") == 0);
    ph_result_free(&res);
    ph_microstructure_free(&micro);
    CHECK_END();
}

/* A solid square that floats in a void: its rigid motions are no equation's business. */
static void floating_piece(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_material m[2];
    ph_grid grid;
    ptrdiff_t n[2] = {12, 12};
    double size[2] = {1, 1};
    ph_microstructure *micro = NULL;
    CHECK_OK(ph_material_isotropic("solid", 2.0, 0.25, &m[0], &err));
    m[1] = ph_material_void("hole");
    CHECK_OK(ph_grid_init(&grid, PH_PLANE_STRESS, n, size, &err));
    CHECK_OK(ph_microstructure_new(&grid, 2, m, &micro, &err));
    for (int i = 0; i < 12; i++)
        for (int j = 0; j < 12; j++) {
            int r = abs(2 * i - 11) > abs(2 * j - 11) ? abs(2 * i - 11) : abs(2 * j - 11);
            micro->phase[12 * i + j] = r > 3 && r < 8;
        }
    combination k = {"floating piece",
                     PH_PLANE_STRESS,
                     {12, 12, 1},
                     true,
                     {.points = PH_POINTS_STRESS, .stabilisation = PH_STABILISE_SUBPOINT},
                     "periodic"};
    ph_result *cg = solve(&k, micro, "fft_cg", NULL, 1e-9, false);
    ph_result *direct = solve(&k, micro, "direct", NULL, 1e-9, false);
    if (cg && direct)
        CHECK_ABS(difference(&direct->stiffness, &cg->stiffness), 0.0, 1e-8);
    ph_result_free(&cg);
    ph_result_free(&direct);
    ph_microstructure_free(&micro);
    CHECK_END();
}

static bool stop_at_once(void *user, const ph_progress *now)
{
    ++*(int *)user;
    CHECK(now->iteration == 1 && now->loads == 3);
    return false;
}

/* Cancelled, not converged, refused: status, message, and that nothing leaks. */
static void failures(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ptrdiff_t n[3] = {12, 12, 1};
    ph_microstructure *micro = random_micro(&seed, PH_PLANE_STRAIN, n, false);
    for (size_t m = 0; m < 2 * ph_nsolvers; m++) {
        const char *name = ph_solvers[m / 2].info.name;
        if (m % 2 && !ph_solvers[m / 2].single) continue;
        int calls = 0;
        ph_ctx ctx = {stop_at_once, &calls, 1};
        ph_error err = PH_ERROR_INIT;
        ph_result *res = NULL;
        ph_problem p = {.micro = micro,
                        .model = {.points = PH_POINTS_STRESS},
                        .solver = {.kind = name,
                                   .tolerance = 1e-9,
                                   .precision = m % 2 ? "single" : "double"}};
        CHECK(ph_homogenise(&p, &ctx, &res, &err) == PH_ECANCELLED);
        CHECK(calls == 1 && !res && strstr(err.msg, "interrupted"));
        if (strcmp(name, "direct") == 0) continue;
        err = (ph_error)PH_ERROR_INIT;
        p.solver.max_iterations = 1;
        p.solver.tolerance = 1e-13;
        CHECK(ph_homogenise(&p, NULL, &res, &err) == PH_ENOCONV);
        CHECK(res && !res->converged && err.iteration >= 1 && err.residual > 1e-13);
        ph_result_free(&res);
    }
    ph_error err = PH_ERROR_INIT;
    ph_result *res = NULL;
    ph_problem p = {.micro = micro, .solver = {.kind = "gauss"}};
    CHECK(ph_homogenise(&p, NULL, &res, &err) == PH_EINVAL && strstr(err.msg, "gauss"));
    ph_microstructure_free(&micro);
    /* A matrix that no memory holds is refused before anything is assembled. */
    ph_operator op = {.layout = {.nd = 3}};
    ph_setting setting = {.box = {.n = {400, 400, 400}}};
    ph_operator_params params = {.family = NULL};
    ph_system system = {.op = &op, .setting = &setting, .params = &params};
    CHECK(ph_i_direct_refuses(&system) != NULL);
    setting.box.n[0] = setting.box.n[1] = setting.box.n[2] = 10;
    CHECK(ph_i_direct_refuses(&system) == NULL);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(solvers_agree), cmocka_unit_test(threads_change_nothing),
        cmocka_unit_test(automatic),     cmocka_unit_test(floating_piece),
        cmocka_unit_test(failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
