/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The arithmetic of error bars, on tensors made by hand. */
#include <perihom.h>

#include "check.h"

enum { DISCRETISATION, STABILISATION, GEOMETRY, SOLVER, HORIZON, BOUNDARY, TIME };

/* A result in space whose six loads took 20 iterations to the residual t. */
static ph_result solved(double E, double t)
{
    ph_result r = {
        .stiffness = ph_sym4_isotropic(E, 0.3), .loads = 63, .solved = 63, .nloads = 6};
    r.voigt = ph_sym4_isotropic(2 * E, 0.3);
    r.reuss = ph_sym4_isotropic(E / 2, 0.3);
    for (int a = 0; a < 6; a++) {
        r.iterations[a] = 20;
        r.residual[a] = t;
    }
    return r;
}

static ph_error_bar judged(const ph_error_evidence *e)
{
    ph_error err = PH_ERROR_INIT;
    static ph_error_bar bar;
    memset(&bar, 0, sizeof bar);
    CHECK_OK(ph_error_bar_estimate(e, &bar, &err));
    return bar;
}

static const ph_error_constant *of(const ph_error_bar *bar, const char *name)
{
    static const ph_error_constant none = {.name = "?"};
    const ph_error_constant *k = ph_error_bar_find(bar, name);
    CHECK(k);
    return k ? k : &none;
}

/* The coarser grid is stiffer by a hundredth in every way: every modulus differs by d = 0.01,
 * all energies too, so that the part is (1 + 1/4) d / (ratio - 1), of shear moduli 5/4 of that. A Poisson
 * ratio does not differ at all: 1/4 d / 0.3^0.4, for the worst it could do is d. */
static void test_discretisation_by_hand(void **state)
{
    (void)state;
    ph_result r = solved(10, 1e-9);
    ph_sym4 coarse = ph_sym4_isotropic(10.1, 0.3);
    ph_error_evidence e = {.result = &r, .coarse = &coarse, .ratio = 2};
    ph_error_bar bar = judged(&e);
    static const char *const moduli[] = {"E1",          "E3",  "G12", "isotropic.E",
                                         "isotropic.K", "C11", "C66", "C12"};
    for (int i = 0; i < 7; i++) {
        const ph_error_constant *k = of(&bar, moduli[i]);
        bool shear = i == 2 || i == 6;
        CHECK_REL(k->part[DISCRETISATION], shear ? 0.015625 : 0.0125, 1e-9);
        CHECK_REL(k->richardson, (1 - 0.01 / (exp2(1.7) - 1)) * k->value, 1e-9);
    }
    /* C12 moves with C11: its own size and theirs, geometric mean */
    CHECK_REL(of(&bar, "C12")->part[DISCRETISATION], 0.01 + 0.0025 * sqrt(0.7 / 0.3),
              1e-9);
    CHECK_REL(of(&bar, "nu12")->part[DISCRETISATION], 0.0025 / pow(0.3, 0.4), 1e-9);
    CHECK_REL(of(&bar, "E1")->value, 10, 1e-12);
    /* parts that are not there, and one that nobody asked for */
    CHECK(isnan(of(&bar, "E1")->part[BOUNDARY]) && isnan(of(&bar, "E1")->part[GEOMETRY]));
    CHECK(strcmp(bar.why[BOUNDARY], "not asked for") == 0);
    /* no coupling of an isotropic tensor has a bar */
    CHECK(isnan(of(&bar, "C16")->bar) && of(&bar, "C16")->why);
    /* the spacings one and a half times as wide: twice the error */
    e.ratio = 1.5;
    bar = judged(&e);
    CHECK_REL(of(&bar, "E1")->part[DISCRETISATION], 0.025, 1e-9);
    CHECK_REL(of(&bar, "E1")->richardson, 10 - 0.1 / (pow(1.5, 1.7) - 1), 1e-9);
    /* interfaces that the two grids place anew: half of what the tensor moves */
    e.by_centres = true;
    bar = judged(&e);
    CHECK_REL(of(&bar, "E1")->part[DISCRETISATION], 0.03, 1e-9);
    /* voxels: half of the difference is their mixing */
    e.by_centres = false;
    e.mixed = true;
    bar = judged(&e);
    CHECK_REL(of(&bar, "E1")->part[DISCRETISATION], 0.0125, 1e-9);
    CHECK_END();
}

/* Beside the difference, in squares: what grids are off on the mean, 0.35 of it in space and 0.7
 * in the plane, but nothing where nothing differs; and cracks whose half length of 10 spacings
 * is off by 0.4 of one, that is d 0.04 of what they take from a constant. */
static void test_expected_by_hand(void **state)
{
    (void)state;
    ph_result r = solved(10, 1e-9);
    ph_sym4 coarse = ph_sym4_isotropic(10.1, 0.3), whole = ph_sym4_isotropic(12, 0.3);
    ph_error_evidence e = {
        .result = &r, .coarse = &coarse, .ratio = 1.5, .expected = 0.05};
    ph_error_bar bar = judged(&e);
    CHECK_REL(of(&bar, "E1")->part[DISCRETISATION], hypot(0.025, 0.0175), 1e-9);
    CHECK_REL(of(&bar, "nu12")->part[DISCRETISATION],
              hypot(0.005, 0.0175) / pow(0.3, 0.4), 1e-9);
    e.expected = 100; /* not believed: the grids agree to 0.01 */
    bar = judged(&e);
    CHECK_REL(of(&bar, "E1")->part[DISCRETISATION], hypot(0.025, 0.35 * 30 * 0.01), 1e-9);
    e.coarse = &r.stiffness; /* layers */
    bar = judged(&e);
    CHECK(of(&bar, "E1")->part[DISCRETISATION] == 0.0);
    e = (ph_error_evidence){.result = &r,
                            .coarse = &r.stiffness,
                            .ratio = 2,
                            .uncracked = &whole,
                            .tips = 0.1};
    bar = judged(&e);
    CHECK_REL(of(&bar, "E1")->part[DISCRETISATION], 3 * 0.04 * 0.2, 1e-9);
    CHECK_ABS(of(&bar, "nu12")->part[DISCRETISATION], 0.0, 1e-12);
    CHECK_END();
}

/* Couplings with shears are nearer to the worst than to their own size: in the plane, half the
 * spacing, C16 = 0.02 between C11 = 1 and C66 = 0.25 (Mandel 0.5). */
static void test_couplings(void **state)
{
    (void)state;
    ph_result r = {.stiffness = {.n = 3}, .loads = 7, .solved = 7};
    r.grid.kinematics = PH_PLANE_STRESS;
    r.stiffness.m[0][0] = r.stiffness.m[1][1] = 1;
    r.stiffness.m[2][2] = 0.5;
    r.stiffness.m[0][2] = r.stiffness.m[2][0] = 0.02 * sqrt(2);
    r.voigt = ph_sym4_combine(2, &r.stiffness, 0, &r.stiffness);
    ph_sym4 coarse = ph_sym4_combine(1.01, &r.stiffness, 0, &r.stiffness);
    ph_error_evidence e = {.result = &r, .coarse = &coarse, .ratio = 2, .expected = 0.05};
    ph_error_bar bar = judged(&e);
    double s = pow(0.5, 0.75) * pow(0.02, 0.25) / 0.02;
    CHECK_REL(of(&bar, "C16")->part[DISCRETISATION],
              hypot(0.01 + 0.0025 * s, 0.7 * 0.05 * s), 1e-9);
    CHECK_END();
}

/* Estimates in squares, bounds in full. */
static void test_parts_add_up(void **state)
{
    (void)state;
    ph_result r = solved(10, 1e-9);
    ph_sym4 coarse = ph_sym4_isotropic(10.1, 0.3), other = ph_sym4_isotropic(10.2, 0.3),
            matrix = ph_sym4_isotropic(1, 0.3);
    r.stabilisation_energy = 0.001;
    ph_error_evidence e = {.result = &r,
                           .coarse = &coarse,
                           .ratio = 2,
                           .horizon = &coarse,
                           .half_horizon = &r.stiffness,
                           .constraint = &r.stiffness,
                           .other_constraint = &other,
                           .matrix = &matrix,
                           .share = 0.5,
                           .share_off = 0.01,
                           .time = 0.003,
                           .parts = 127};
    ph_error_bar bar = judged(&e);
    const ph_error_constant *k = of(&bar, "E1");
    CHECK_REL(k->part[STABILISATION], 0.002, 1e-12);
    CHECK_REL(k->part[GEOMETRY], 0.9 / 0.25 * 0.01, 1e-9);
    CHECK_REL(k->part[BOUNDARY], 0.02, 1e-9);
    CHECK_REL(k->part[TIME], 0.003, 1e-12);
    /* twice the difference between the horizon and its half, of tensors 0.01 apart */
    double f = 0.25 * 0.01 / 1.01; /* the spread is relative to the first */
    CHECK_REL(k->part[HORIZON], 2 * (0.01 + f), 1e-9);
    double squares = 0;
    for (int i = 0; i < 6; i++)
        if (i != SOLVER) squares += k->part[i] * k->part[i];
    CHECK_REL(k->bar, sqrt(squares) + k->part[SOLVER] + 0.003, 1e-12);
    CHECK_END();
}

/* The solver's part is quadratic in the residual for what energies say: a hundredth for a
 * tenth, but for the condition number that the same 20 iterations then mean; and it does not
 * depend on units. */
static void test_solver_is_quadratic(void **state)
{
    (void)state;
    ph_result a = solved(10, 1e-2), b = solved(10, 1e-3), c = solved(1e9, 1e-2);
    ph_result *all[] = {&a, &b, &c};
    double part[3];
    for (int i = 0; i < 3; i++) {
        all[i]->second_order = true;
        ph_error_evidence e = {
            .result = all[i], .coarse = &all[i]->stiffness, .ratio = 2};
        ph_error_bar bar = judged(&e);
        part[i] = of(&bar, "C11")->part[SOLVER];
        CHECK_REL(of(&bar, "C11")->bar, part[i], 1e-12); /* nothing else is off */
    }
    double more = log(2e2) / log(2e3);
    CHECK_REL(part[1] / part[0], 0.01 * more * more, 1e-6);
    CHECK_REL(part[2], part[0], 1e-9);
    CHECK_END();
}

/* No bar is wider than the distance to the farther bound; nothing known says so. */
static void test_limits(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_result r = solved(10, 1e-9);
    ph_sym4 coarse = ph_sym4_isotropic(100, 0.3);
    ph_error_evidence e = {.result = &r, .coarse = &coarse, .ratio = 2};
    ph_error_bar bar = judged(&e);
    CHECK_REL(of(&bar, "E1")->bar, 1.0, 1e-9); /* 10 between 5 and 20 */
    CHECK(of(&bar, "nu12")->bar > 1);          /* no bounds of ratios */
    e = (ph_error_evidence){.result = &r, .no_coarse = "for a reason"};
    bar = judged(&e);
    CHECK(isnan(of(&bar, "E1")->bar) && isnan(of(&bar, "E1")->richardson));
    CHECK(of(&bar, "E1")->why && strcmp(of(&bar, "E1")->why, "for a reason") == 0);
    CHECK(isfinite(of(&bar, "E1")->part[SOLVER]));
    /* who does not want that part has a bar of the others */
    e.parts = ph_error_parts_auto() & ~1u;
    bar = judged(&e);
    CHECK(isfinite(of(&bar, "E1")->bar));
    r.loads = 1;
    CHECK(ph_error_bar_estimate(&e, &bar, &err) == PH_EINVAL);
    r.loads = 63;
    r.stiffness.n = 3;
    CHECK(ph_error_bar_estimate(&e, &bar, &err) == PH_EINVAL);
    CHECK(!ph_error_bar_find(&bar, "E7") && !ph_error_bar_find(NULL, "E1"));
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_discretisation_by_hand),
        cmocka_unit_test(test_expected_by_hand),
        cmocka_unit_test(test_couplings),
        cmocka_unit_test(test_parts_add_up),
        cmocka_unit_test(test_solver_is_quadratic),
        cmocka_unit_test(test_limits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
