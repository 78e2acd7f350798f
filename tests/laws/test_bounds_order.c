/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random microstructures (isotropic, anisotropic and stiff phases, a third of the cells cut):
 * the order of the constraints, symmetry, averages, energies, over kinematics, models and
 * stabilisations. */
#include "random_cases.h"
#include "solve.h"

typedef struct plan {
    const char *model;
    ph_points points;
    ph_stabilisation stabilisation;
} plan;
static const plan plans[] = {
    {"local", PH_POINTS_AUTO, PH_STABILISE_AUTO},
    {"nosb", PH_POINTS_STRESS, PH_STABILISE_SPECTRAL},
    {"nosb", PH_POINTS_STRESS, PH_STABILISE_SUBPOINT},
    {"nosb", PH_POINTS_NODES, PH_STABILISE_SPECTRAL},
    {"nosb", PH_POINTS_NODES, PH_STABILISE_SUBPOINT},
};
enum { PLANS = 5 };

static const ph_kinematics kinematics[] = {PH_SPACE, PH_GENERALISED_STRAIN,
                                           PH_PLANE_STRAIN, PH_PLANE_STRESS};

static const double tolerance = 1e-9;

static ph_problem planned(const ph_microstructure *micro, const plan *how)
{
    ph_problem p = {.micro = micro, .solver = {.tolerance = tolerance}};
    p.model.kind = how->model;
    p.model.points = how->points;
    p.model.stabilisation = how->stabilisation;
    return p;
}

static ph_microstructure *random_cell(ph_kinematics kin, uint64_t *seed)
{
    ptrdiff_t n[3] = {7, 8, kin == PH_SPACE ? 7 : 1};
    return random_micro(seed, kin, n, false);
}

/* What every answer has: major symmetry to the solver's tolerance, positive definiteness,
 * exact averages, the lemma of Hill and Mandel. */
static void check_answer(const ph_result *res)
{
    double least;
    ph_sym4_eigenvalues(&res->stiffness, &least, NULL);
    CHECK(least > 0.0);
    CHECK(res->asymmetry < 30 * tolerance);
    CHECK(res->hill_mandel < 30 * tolerance);
    /* an identity of the operator, but for the macro stress, which is solved for */
    CHECK(res->strain_average <
          (strcmp(res->constraint, "uniform_traction") == 0 ? 30 * tolerance : 1e-12));
}

/* Each is a minimum over more fields than the next (or, in stresses, over fewer), so the
 * quadratic forms are in order exactly, to the solver's tolerance. The one of the nodes with
 * one-sided families at the faces is another operator, and not here. */
static void check_order(ph_kinematics kin, const plan *how, uint64_t *seed)
{
    static const char *const chain[] = {"reuss", "uniform_traction", "periodic",
                                        "linear_displacement", "voigt"};
    ph_microstructure *m = random_cell(kin, seed);
    ph_sym4 lower = {.n = 0};
    for (int i = 0; i < 5; i++) {
        if (i == 1 && how->points == PH_POINTS_NODES) continue;
        ph_problem p = planned(m, how);
        p.constraint.kind = chain[i];
        if (i == 1 && how->stabilisation == PH_STABILISE_SPECTRAL) continue;
        ph_result *res = homogenise(&p);
        if (!res) continue;
        check_answer(res);
        if (lower.n) {
            double room = gap(&res->stiffness, &lower);
            if (room < -1e-8)
                print_error("%s, %s points %d\n", chain[i], how->model, how->points);
            CHECK(room > -1e-8);
        }
        lower = res->stiffness;
        ph_result_free(&res);
    }
    ph_microstructure_free(&m);
}

static void test_order(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int trial = 0; trial < check_trials(1); trial++)
        for (int k = 0; k < 4; k++)
            for (int i = 0; i < PLANS; i++)
                check_order(kinematics[k], &plans[i], &seed);
    CHECK_END();
}

/* Points that see only their own cell: the fields outside the RVE are none of its business,
 * so the order holds with a collar outside too, whatever its material. */
static void test_collars(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    static const ph_collar collar[] = {PH_COLLAR_PERIODIC, PH_COLLAR_MATRIX};
    for (int k = 0; k < 4; k++)
        for (int i = 0; i < 3; i++) {
            ph_microstructure *m = random_cell(kinematics[k], &seed);
            ph_problem p = planned(m, &plans[i]);
            ph_sym4 periodic = stiffness_of(&p), held[2], voigt_bound;
            for (int c = 0; c < 2; c++) {
                p.constraint =
                    (ph_constraint_params){"linear_displacement", collar[c], 2};
                held[c] = stiffness_of(&p);
            }
            p.constraint.kind = "voigt";
            voigt_bound = stiffness_of(&p);
            CHECK(gap(&held[0], &periodic) > -1e-8);
            CHECK(gap(&voigt_bound, &held[0]) > -1e-8);
            CHECK(difference(&held[0], &held[1]) < 1e-8);
            ph_microstructure_free(&m);
        }
    CHECK_END();
}

/* [Hashin1963] for the bulk modulus. With a polarisation p 1 the operator of the comparison
 * medium answers with the trace p / (lambda + 2G) at every wave vector, in the continuum and
 * on the grid (odd numbers of cells: no mode is unseen), whatever the geometry. So for any
 * voxels 1:C*:1 / d^2 is not below the lower bound; and 1/(1:S*:1) not above the upper one. */
static void test_hashin_shtrikman(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int trial = 0; trial < check_trials(4); trial++)
        for (int i = 0; i < 4; i++) {
            ph_kinematics kin = i % 2 ? PH_PLANE_STRAIN : PH_SPACE;
            int d = kin == PH_SPACE ? 3 : 2;
            ph_error err = PH_ERROR_INIT;
            double part = kin == PH_SPACE ? 2.0 / 3 : 1.0, K[2], G[2], f[2], bound[2];
            ph_material two[2];
            for (int a = 0; a < 2; a++) { /* both moduli of the second are larger */
                K[a] = check_uniform(&seed, 1, 2) * (a ? 10 : 1);
                G[a] = check_uniform(&seed, 0.3, 1) * (a ? 10 : 1);
                two[a] = isotropic_lame("phase", K[a] - part * G[a], G[a]);
            }
            ph_grid g = box_grid(kin, 7, 9, kin == PH_SPACE ? 5 : 1, 1, 1.1,
                                 kin == PH_SPACE ? 0.9 : 1);
            ph_microstructure *m = voxel_cell(g, 2, two, &seed);
            ph_microstructure_fractions(m, f);
            for (int a = 0; a < 2; a++) {
                double y = 2.0 * (d - 1) / d * G[a];
                bound[a] = 1 / (f[0] / (K[0] + y) + f[1] / (K[1] + y)) - y;
            }
            ph_problem p = {.micro = m, .solver = {.tolerance = tolerance}};
            p.model.points = i < 2 ? PH_POINTS_STRESS : PH_POINTS_NODES;
            p.model.horizon = i < 2 ? 0.0 : 1.0;
            p.model.stabilisation = PH_STABILISE_NONE;
            ph_sym4 c = stiffness_of(&p), s;
            CHECK_OK(ph_sym4_inverse(&c, &s, &err));
            double stiff = 0, soft = 0;
            for (int a = 0; a < d; a++)
                for (int b = 0; b < d; b++) {
                    stiff += c.m[a][b] / (d * d);
                    soft += s.m[a][b];
                }
            CHECK(stiff >= bound[0] * (1 - 1e-8));
            CHECK(1 / soft <= bound[1] * (1 + 1e-8));
            CHECK(1 / soft <= stiff * (1 + 1e-12));
            ph_microstructure_free(&m);
        }
    CHECK_END();
}

/* More stabilisation is more energy: the stiffness grows with alpha and with theta is
 * between the family's alone and that of the simplices alone. */
static void test_stabilisation_stiffens(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int i = 0; i < 2; i++) {
        ph_microstructure *m = random_cell(PH_PLANE_STRAIN, &seed);
        ph_problem p = planned(m, &plans[i ? 3 : 1]);
        ph_sym4 before = {.n = 0};
        for (double alpha = 1e-6; alpha < 2.0; alpha *= 10) {
            p.model.stabilisation_value = fmin(alpha, 1.0);
            ph_sym4 c = stiffness_of(&p);
            if (before.n) CHECK(gap(&c, &before) > -1e-8);
            before = c;
        }
        ph_microstructure_free(&m);
    }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_order),
                                       cmocka_unit_test(test_collars),
                                       cmocka_unit_test(test_hashin_shtrikman),
                                       cmocka_unit_test(test_stabilisation_stiffens)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
