/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cracked cells that relax: every route against the elastic problem of each s. */
#include <perihom/viscoelastic.h>

#include "check.h"
#include "visco_case.h"

typedef struct combination {
    ph_model_params model;
    const char *constraint;
    ph_kinematics kin;
    ptrdiff_t n[3];
    bool cuts;
} combination;

static const combination combinations[] = {
    {{.kind = "bond", .horizon = 2.0}, "periodic", PH_PLANE_STRESS, {9, 8, 1}, false},
    {{.kind = "bond", .horizon = 2.0},
     "linear_displacement",
     PH_PLANE_STRESS,
     {10, 9, 1},
     false},
    {{.points = PH_POINTS_NODES}, "periodic", PH_PLANE_STRAIN, {9, 8, 1}, true},
    {{.points = PH_POINTS_NODES},
     "linear_displacement",
     PH_PLANE_STRAIN,
     {10, 9, 1},
     true},
    {{.points = PH_POINTS_NODES}, "uniform_traction", PH_PLANE_STRESS, {8, 9, 1}, true},
    {{.points = PH_POINTS_NODES}, "periodic", PH_SPACE, {5, 6, 5}, false},
};
enum { COMBINATIONS = sizeof combinations / sizeof *combinations };

/* Springs need one Poisson's ratio: resins and an elastic filler, in rows. */
static ph_microstructure *resins(const combination *c)
{
    ph_error err = PH_ERROR_INIT;
    ph_material m[3];
    ph_grid grid;
    ph_microstructure *micro = NULL;
    const double size[2] = {(double)c->n[0], (double)c->n[1]}, nu = 1.0 / 3.0;
    const ph_modulus_term e[2] = {{0.5, 3.0}, {20.0, 2.0}}, g[1] = {{3.0, 4.0}};
    CHECK_OK(ph_material_isotropic("filler", 20.0, nu, &m[0], &err));
    CHECK_OK(ph_material_viscoelastic_young("resin", &(ph_modulus){1.0, 2, e}, nu, &m[1],
                                            &err));
    CHECK_OK(
        ph_material_viscoelastic_young("gel", &(ph_modulus){2.0, 1, g}, nu, &m[2], &err));
    CHECK_OK(ph_grid_init(&grid, c->kin, c->n, size, &err));
    CHECK_OK(ph_microstructure_new(&grid, 3, m, &micro, &err));
    ph_material_clear(&m[1]);
    ph_material_clear(&m[2]);
    for (ptrdiff_t x = 0; micro && x < c->n[0] * c->n[1]; x++)
        micro->phase[x] = (uint16_t)(x / c->n[1] < 3 ? 0 : x % c->n[1] < 4 ? 1 : 2);
    return micro;
}

static ph_microstructure *cell_of(const combination *c, uint64_t *seed)
{
    return c->model.kind ? resins(c) : viscous_micro(seed, c->kin, c->n, c->cuts);
}

/* A line, or a disk, across the middle; it cuts bonds and leaves the cell in one piece. */
static void crack(const ph_grid *g, ph_cracks *cracks)
{
    ph_error err = PH_ERROR_INIT;
    const double *l = g->size;
    if (g->kinematics == PH_SPACE) {
        double centre[3] = {0.5 * l[0], 0.45 * l[1], 0.5 * l[2]}, up[3] = {0, 1, 0},
               semi[2] = {0.25 * l[0], 0.25 * l[0]};
        CHECK_OK(ph_cracks_add_ellipse(cracks, centre, up, NULL, semi, &err));
        return;
    }
    double v[2][3] = {{0.3 * l[0], 0.45 * l[1], 0}, {0.7 * l[0], 0.55 * l[1], 0}};
    CHECK_OK(ph_cracks_add_line(cracks, 2, (const double(*)[3])v, &err));
}

static ph_viscoelastic *answer(const ph_problem *p, const char *route, double tolerance)
{
    static const double times[] = {0.0, 0.3, 5.0, 300.0}, omega[] = {0.1, 3.0};
    static const double s[] = {0.0, 0.01, 0.3, 2.0, 40.0, INFINITY};
    ph_error err = PH_ERROR_INIT;
    ph_ctx ctx = {.threads = 1};
    ph_viscoelastic *v = NULL;
    ph_relaxation_params how = {.route = route,
                                .tolerance = tolerance,
                                .max_points = 60,
                                .carson = s,
                                .ncarson = 6,
                                .times = times,
                                .ntimes = 4,
                                .omega = omega,
                                .nomega = 2};
    CHECK_OK(ph_viscoelastic_solve(p, &how, &ctx, &v, &err));
    return v;
}

/* Congruence holds with broken bonds as without: the model of a few fields is as good as the
 * elastic problem at each s, and the other routes agree with its series. */
static void routes(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int i = 0; i < COMBINATIONS; i++) {
        const combination *c = &combinations[i];
        ph_microstructure *micro = cell_of(c, &seed);
        ph_cracks cracks = {0};
        ph_problem problem = {.micro = micro,
                              .model = c->model,
                              .constraint = {.kind = c->constraint},
                              .solver = {.tolerance = 1e-8},
                              .cracks = &cracks};
        static const char *const route[] = {"reduced", "carson", "stepping", "frequency"};
        ph_viscoelastic *v[4] = {NULL}, *whole;
        crack(&micro->grid, &cracks);
        /* families cut at the faces are no convolution, which `frequency` needs */
        bool body = strcmp(c->constraint, "uniform_traction") == 0;
        for (int k = 0; k < (body ? 3 : 4); k++)
            v[k] = answer(&problem, route[k], k < 2 ? 1e-5 : 2e-3);
        problem.cracks = NULL;
        whole = answer(&problem, "reduced", 1e-3);
        if (v[0] && v[1] && v[2] && whole) {
            for (int k = 0; k < 6; k++)
                CHECK_ABS(
                    difference(&v[0]->values[k].stiffness, &v[1]->values[k].stiffness),
                    0.0, 3e-5);
            for (int k = 0; k < 4; k++)
                CHECK_ABS(
                    difference(&v[2]->curve[k].stiffness, &v[0]->curve[k].stiffness), 0.0,
                    2e-3);
            for (int k = 0; k < 2 && v[3]; k++)
                CHECK_ABS(
                    difference(&v[3]->dynamic[k].storage, &v[0]->dynamic[k].storage), 0.0,
                    2e-3);
            /* the crack is there: softer by more than all of this, at both ends */
            CHECK(difference(&v[0]->instantaneous, &whole->instantaneous) > 5e-3);
            CHECK(difference(&v[0]->equilibrium, &whole->equilibrium) > 5e-3);
        }
        for (int k = 0; k < 4; k++)
            ph_viscoelastic_free(&v[k]);
        ph_viscoelastic_free(&whole);
        ph_cracks_free(&cracks);
        ph_microstructure_free(&micro);
    }
    CHECK_END();
}

/* What is not computed is refused: steps of cracks, and constraints without equations. */
static void refused(void **state)
{
    (void)state;
    ph_microstructure *micro = resins(&combinations[0]);
    ph_cracks cracks = {0};
    double length = 3.0;
    bool grows = true;
    const ph_crack_sequence sequence = {
        .kind = PH_SEQUENCE_GROWTH, .nsteps = 1, .value = &length, .grows = &grows};
    static const char *const route[] = {"reduced", "carson", "stepping", "frequency"};
    crack(&micro->grid, &cracks);
    for (int k = 0; k < 8; k++) {
        ph_error err = PH_ERROR_INIT;
        double one = 1.0;
        ph_viscoelastic *v = NULL;
        ph_problem p = {.micro = micro,
                        .model = combinations[0].model,
                        .cracks = &cracks,
                        .constraint = {.kind = k < 4 ? "periodic" : "voigt"},
                        .sequence = k < 4 ? &sequence : NULL};
        ph_relaxation_params how = {.route = route[k % 4],
                                    .carson = &one,
                                    .ncarson = 1,
                                    .times = &one,
                                    .ntimes = 1,
                                    .omega = &one,
                                    .nomega = 1};
        CHECK(ph_viscoelastic_solve(&p, &how, NULL, &v, &err) == PH_EINVAL && !v);
    }
    ph_cracks_free(&cracks);
    ph_microstructure_free(&micro);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(routes),
        cmocka_unit_test(refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
