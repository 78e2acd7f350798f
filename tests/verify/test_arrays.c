/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Square and hexagonal arrays of fibres and holes with exact constants from body-fitted
 * spectral elements (relative accuracy 1e-6, printed digits where fewer).
 *
 * Tolerance: interfaces make the method first order, and the length that h has to resolve is
 * the gap between neighbouring fibres, where the strain is concentrated. Over all cases here,
 * nodes with horizon 2 and stress points, grids 32..128, error * gap / h was 1.7 .. 6.9 %:
 * the tolerance is 8 % h / gap, and half of the last digit printed. */
#include "solve.h"

enum constant { E1, E3, NU12, NU31, G12, G13, C11, C12, C66 };

typedef struct known {
    enum constant what;
    double value, half_digit;
} known;

typedef struct array_case {
    const char *title;
    ph_kinematics kinematics;
    double E[2], nu[2]; /* matrix, fibre */
    double fraction;
    bool hexagonal;
    known known[6];
} array_case;

#define BORON_ALUMINIUM                                                                  \
    {68.3, 379.3},                                                                       \
    {                                                                                    \
        0.30, 0.10                                                                       \
    }
#define GLASS_EPOXY                                                                      \
    {3.45, 73.1},                                                                        \
    {                                                                                    \
        0.35, 0.22                                                                       \
    }
#define GLASS_EPOXY_B                                                                    \
    {3.35, 74.0},                                                                        \
    {                                                                                    \
        0.35, 0.20                                                                       \
    }

static const array_case cases[] = {
    {"B/Al plane strain",
     PH_PLANE_STRAIN,
     BORON_ALUMINIUM,
     0.47,
     false,
     {{E1, 147.693, 0}, {NU12, 0.28772, 0}, {G12, 45.824, 0}}},
    {"B/Al plane stress",
     PH_PLANE_STRESS,
     BORON_ALUMINIUM,
     0.47,
     false,
     {{E1, 133.811, 0}, {NU12, 0.20879, 0}, {G12, 45.634, 0}}},
    {"B/Al hexagonal",
     PH_GENERALISED_STRAIN,
     BORON_ALUMINIUM,
     0.47,
     true,
     {{E1, 133.070, 0}, {G13, 54.048, 0}, {G12, 50.790, 0}}},
    {"glass/epoxy 0.1",
     PH_PLANE_STRAIN,
     GLASS_EPOXY,
     0.1,
     false,
     {{C11, 6.31867, 0}, {C12, 3.29365, 0}, {C66, 1.47363, 0}}},
    {"glass/epoxy 0.3",
     PH_PLANE_STRAIN,
     GLASS_EPOXY,
     0.3,
     false,
     {{C11, 8.66113, 0}, {C12, 3.95134, 0}, {C66, 1.92564, 0}}},
    {"glass/epoxy 0.5",
     PH_PLANE_STRAIN,
     GLASS_EPOXY,
     0.5,
     false,
     {{C11, 13.07103, 0}, {C12, 4.63432, 0}, {C66, 2.65428, 0}}},
    {"glass/epoxy 0.7",
     PH_PLANE_STRAIN,
     GLASS_EPOXY,
     0.7,
     false,
     {{C11, 24.25221, 0}, {C12, 6.15085, 0}, {C66, 4.77139, 0}}},
    {"glass/epoxy 0.60 hexagonal",
     PH_GENERALISED_STRAIN,
     GLASS_EPOXY_B,
     0.60,
     true,
     {{E3, 45.763, 5e-4},
      {E1, 11.798, 5e-4},
      {G13, 4.339, 5e-4},
      {NU31, 0.2515, 5e-5},
      {NU12, 0.402, 5e-4},
      {G12, 4.208, 5e-4}}},
    {"glass/epoxy 0.60 square",
     PH_GENERALISED_STRAIN,
     GLASS_EPOXY_B,
     0.60,
     false,
     {{E3, 45.768, 5e-4},
      {E1, 14.912, 5e-4},
      {G13, 4.577, 5e-4},
      {NU31, 0.2497, 5e-5},
      {NU12, 0.265, 5e-4},
      {G12, 3.254, 5e-4}}},
};

static double gap_between(const array_case *c)
{
    const double pi = 3.14159265358979323846;
    double area = c->hexagonal ? 0.5 * sqrt(3.0) : 1.0; /* of one fibre's cell, pitch 1 */
    return 1.0 - 2.0 * sqrt(c->fraction * area / pi);
}

static double constant_of(const ph_sym4 *c, enum constant what)
{
    ph_engineering e = engineering(c);
    switch (what) {
    case E1:
        return e.E[0];
    case E3:
        return e.E[2];
    case NU12:
        return e.nu[0][1];
    case NU31:
        return e.nu[2][0];
    case G12:
        return e.G12;
    case G13:
        return e.G13;
    case C11:
        return voigt(c, 1, 1);
    case C12:
        return voigt(c, 1, 2);
    case C66:
        return voigt(c, c->n, c->n);
    }
    return NAN;
}

static void check_case(const array_case *c, ptrdiff_t n, ph_points points)
{
    ph_material matrix = isotropic("matrix", c->E[0], c->nu[0]);
    ph_material fibre = isotropic("fibre", c->E[1], c->nu[1]);
    ph_microstructure *m =
        c->hexagonal ? hexagonal_cell(c->kinematics, n, c->fraction, matrix, fibre)
                     : round_cell(c->kinematics, n, c->fraction, matrix, fibre);
    ph_problem p = {.micro = m};
    p.model.points = points;
    p.model.horizon = points == PH_POINTS_NODES ? 2.0 : 0.0;
    ph_sym4 stiffness = stiffness_of(&p);
    int before = check_failures;
    for (int i = 0; i < 6 && c->known[i].value > 0.0; i++) {
        double tol = 0.08 / ((double)n * gap_between(c)) * c->known[i].value;
        CHECK_ABS(constant_of(&stiffness, c->known[i].what), c->known[i].value,
                  tol + c->known[i].half_digit);
    }
    if (check_failures > before) print_error("  of %s, %td nodes\n", c->title, n);
    ph_microstructure_free(&m);
}

static void test_stress_points(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (ptrdiff_t n = 64; n <= (cases[i].hexagonal ? 64 : 128); n *= 2)
            check_case(&cases[i], n, PH_POINTS_STRESS);
    CHECK_END();
}

static void test_nodes(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        check_case(&cases[i], 64, PH_POINTS_NODES);
    CHECK_END();
}

/* Square array of holes 0.4, E 1, nu 0.3, plane strain. Solid-fraction cells and theta = 0.05:
 * 0.24 % at 64 x 64 measured, of which half comes from the stabilisation. */
static void test_holes(void **state)
{
    (void)state;
    ph_microstructure *m = round_cell(
        PH_PLANE_STRAIN, 64, 0.4, isotropic("solid", 1.0, 0.3), ph_material_void("hole"));
    ph_problem p = {.micro = m};
    ph_result *res = homogenise(&p);
    if (res) {
        CHECK_REL(voigt(&res->stiffness, 1, 1), 0.4580850, 5e-3);
        CHECK_REL(voigt(&res->stiffness, 1, 2), 0.1108263, 5e-3);
        CHECK_REL(voigt(&res->stiffness, 3, 3), 0.0716596, 5e-3);
        CHECK(res->stabilisation == PH_STABILISE_SUBPOINT);
        CHECK(res->reuss_is_zero);
    }
    ph_result_free(&res);
    ph_microstructure_free(&m);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_stress_points),
                                       cmocka_unit_test(test_nodes),
                                       cmocka_unit_test(test_holes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
