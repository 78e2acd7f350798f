/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What holds for any microstructure of these phases, and holds for the discrete operator too.
 *
 * A gradient whose symbols D_j(k) are real up to a common phase, as those of every symmetric
 * family are, has D_i D_j* = D_j D_i*. Hence, where no mode but the mean is unseen (all
 * numbers of cells odd) and nothing is added for unseen modes (stabilisation: none),
 *  - a field with equal shear moduli is sym D D~ phi of one potential, and the argument of
 *    Hill holds for sums as for integrals;
 *  - a divergence-free antiplane stress is a turned gradient, and the argument of Keller
 *    holds as well.
 * So both are met to the tolerance of the solver (1e-11), at any contrast, on any grid. */
#include "solve.h"

typedef struct plan {
    ph_points points;
    double horizon;
} plan;
static const plan plans[] = {{PH_POINTS_STRESS, 0},   {PH_POINTS_STRESS, 1.6},
                             {PH_POINTS_STRESS, 2.2}, {PH_POINTS_NODES, 1},
                             {PH_POINTS_NODES, 1.5},  {PH_POINTS_NODES, 2}};
enum { PLANS = 6 };

static ph_problem unstabilised(const ph_microstructure *micro, const plan *how)
{
    ph_problem p = {.micro = micro, .solver = {.tolerance = 1e-11}};
    p.model.points = how->points;
    p.model.horizon = how->horizon;
    p.model.stabilisation = PH_STABILISE_NONE;
    return p;
}

/* [Hill1963]: 1/(lambda* + 2G) = sum f_i / (lambda_i + 2G), G* = G. In 3D and in plane
 * strain; also a phase with negative lambda. */
static void check_hill(ph_kinematics kin, const plan *how, uint64_t *seed)
{
    bool deep = kin == PH_SPACE;
    double lambda[3] = {1.0, check_uniform(seed, 10, 30), check_uniform(seed, -0.5, 0.2)};
    ph_material phases[3];
    for (int i = 0; i < 3; i++)
        phases[i] = isotropic_lame("phase", lambda[i], 1.0);
    ph_grid g = box_grid(kin, 7, 9, deep ? 7 : 1, 1.0, 1.2, deep ? 1.1 : 1.0);
    ph_microstructure *m = voxel_cell(g, 3, phases, seed);
    double f[3], inverse = 0.0;
    ph_microstructure_fractions(m, f);
    for (int i = 0; i < 3; i++)
        inverse += f[i] / (lambda[i] + 2.0);
    ph_problem p = unstabilised(m, how);
    ph_sym4 c = stiffness_of(&p);
    double all = 1.0 / inverse, tol = 1e-10 * all;
    for (int i = 1; i <= (deep ? 3 : 2); i++)
        for (int j = 1; j <= (deep ? 3 : 2); j++)
            CHECK_ABS(voigt(&c, i, j), i == j ? all : all - 2.0, tol);
    for (int i = kin == PH_PLANE_STRAIN ? 3 : 4; i <= c.n; i++)
        CHECK_ABS(voigt(&c, i, i), 1.0, 1e-12);
    ph_microstructure_free(&m);
}

static void test_hill(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    static const ph_kinematics kin[] = {PH_SPACE, PH_PLANE_STRAIN, PH_GENERALISED_STRAIN};
    for (int trial = 0; trial < check_trials(2); trial++)
        for (int k = 0; k < 3; k++)
            for (int i = 0; i < PLANS; i++)
                check_hill(kin[k], &plans[i], &seed);
    CHECK_END();
}

/* Antiplane moduli G11 = C_1313, G12 = C_1323, G22 of a solved cell. */
static void antiplane(const ph_problem *problem, double G[2][2])
{
    ph_problem p = *problem;
    p.loads = 8u | 16u;
    ph_sym4 c = stiffness_of(&p);
    G[0][0] = 0.5 * c.m[4][4];
    G[0][1] = 0.5 * c.m[4][3];
    G[1][0] = 0.5 * c.m[3][4];
    G[1][1] = 0.5 * c.m[3][3];
}

/* Largest entry of G(a,b) R G(b,a) R^T / (a b) - I; R turns by 90 degrees. */
static double keller_error(double G[2][2], double H[2][2], double ab)
{
    double T[2][2] = {{H[1][1], -H[1][0]}, {-H[0][1], H[0][0]}}, worst = 0.0;
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++) {
            double v = (G[i][0] * T[0][j] + G[i][1] * T[1][j]) / ab - (i == j);
            worst = fmax(worst, fabs(v));
        }
    return worst;
}

/* [Keller1964]: exchange the two phases. */
static void test_keller(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int trial = 0; trial < check_trials(3); trial++)
        for (int i = 0; i < PLANS; i++) {
            double b = check_uniform(&seed, 2, 20), G[2][2], H[2][2];
            ph_material there[2] = {isotropic("a", 2.5, 0.25),
                                    isotropic("b", 2.5 * b, 0.25)};
            ph_material back[2] = {there[1], there[0]};
            ph_grid g = box_grid(PH_GENERALISED_STRAIN, 9, 11, 1, 1, 1.3, 1);
            uint64_t same = seed;
            ph_microstructure *m = voxel_cell(g, 2, there, &seed);
            ph_microstructure *n = voxel_cell(g, 2, back, &same);
            ph_problem p = unstabilised(m, &plans[i]), q = unstabilised(n, &plans[i]);
            antiplane(&p, G);
            antiplane(&q, H);
            CHECK(keller_error(G, H, b) < 1e-9);
            ph_microstructure_free(&m);
            ph_microstructure_free(&n);
        }
    CHECK_END();
}

/* All phases times one number: the effective tensor times it. Powers of two are exact in
 * every step, so the numbers are the same bit for bit; units of 1e+-30 to rounding. */
static void test_scaling(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    static const double factor[] = {0x1p100, 0x1p-100, 1e30, 1e-30};
    for (int points = 0; points < 3; points++)
        for (int i = 0; i < 4; i++) {
            ph_material phases[2] = {anisotropic("a", &seed), anisotropic("b", &seed)};
            ph_grid g = box_grid(PH_PLANE_STRAIN, 8, 10, 1, 1, 1, 1);
            ph_microstructure *m = voxel_cell(g, 2, phases, &seed);
            ph_problem p = {.micro = m};
            if (points == 0) p.model.kind = "local";
            p.model.points = points == 1 ? PH_POINTS_STRESS : PH_POINTS_NODES;
            ph_sym4 c = stiffness_of(&p), nothing = {.n = 3};
            for (int a = 0; a < 2; a++)
                m->materials[a].stiffness =
                    ph_sym4_combine(factor[i], &phases[a].stiffness, 0.0, &nothing);
            ph_sym4 scaled = stiffness_of(&p);
            c = ph_sym4_combine(factor[i], &c, 0.0, &nothing);
            CHECK(difference(&scaled, &c) <= (i < 2 ? 0.0 : 1e-9));
            ph_microstructure_free(&m);
        }
    CHECK_END();
}

/* A cell of any size in any unit of length has the same moduli. */
static void test_size(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    static const double factor[] = {0x1p30, 0x1p-30, 1e9, 1e-9};
    for (int points = 0; points < 3; points++)
        for (int i = 0; i < 4; i++) {
            ph_material phases[2] = {anisotropic("a", &seed), anisotropic("b", &seed)};
            uint64_t same = seed;
            double s = factor[i];
            ph_grid g = box_grid(PH_SPACE, 5, 6, 7, 1, 1.5, 1.25);
            ph_grid h = box_grid(PH_SPACE, 5, 6, 7, s, 1.5 * s, 1.25 * s);
            ph_microstructure *m = voxel_cell(g, 2, phases, &seed);
            ph_microstructure *n = voxel_cell(h, 2, phases, &same);
            ph_problem p = {.micro = m}, q;
            if (points == 0) p.model.kind = "local";
            p.model.points = points == 1 ? PH_POINTS_STRESS : PH_POINTS_NODES;
            q = p;
            q.micro = n;
            ph_sym4 c = stiffness_of(&p), d = stiffness_of(&q);
            CHECK(difference(&d, &c) <= (i < 2 ? 0.0 : 1e-9));
            ph_microstructure_free(&m);
            ph_microstructure_free(&n);
        }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_hill), cmocka_unit_test(test_keller),
        cmocka_unit_test(test_scaling), cmocka_unit_test(test_size)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
