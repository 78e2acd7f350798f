/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A series in the plane is the plane of the series, at every value of the Carson variable. */
#include <perihom/material.h>

#include "check.h"
#include "tensors.h"

static const double variables[] = {0.0, 1e-9, 1e-3, 0.2, 1.0, 7.0, 1e3, 1e9, INFINITY};
enum { VARIABLES = sizeof variables / sizeof *variables };

/* |reduced C(s) - reduce(C(s))|, relative, worst of all s where C(s) is invertible. */
static double worst(const ph_prony *p, const ph_prony *r, ph_kinematics kin)
{
    double most = 0.0;
    for (int i = 0; i < VARIABLES; i++) {
        ph_sym4 c = ph_prony_carson(p, variables[i]), want;
        if (!ph_sym4_is_stiffness(&c)) continue;
        if (ph_sym4_reduce(&c, kin, &want, NULL) != PH_OK) continue;
        ph_sym4 got = ph_prony_carson(r, variables[i]);
        most = fmax(most, difference(&got, &want));
    }
    return most;
}

static ph_prony *reduced(const ph_prony *p, ph_kinematics kin)
{
    ph_error err = PH_ERROR_INIT;
    ph_prony *r = NULL;
    CHECK_OK(ph_prony_reduce(p, kin, &r, &err));
    if (r) CHECK_OK(ph_prony_validate(r, &err)); /* every term positive semidefinite */
    return r;
}

/* Random tensors condense to 1e-12 of C(s); conditions here are below 1e3. */
static void test_random_series(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    static const ph_kinematics kin[] = {PH_SPACE, PH_GENERALISED_STRAIN, PH_PLANE_STRAIN,
                                        PH_PLANE_STRESS};
    for (int trial = 0; trial < check_trials(20); trial++) {
        ph_prony_term term[3];
        double t = pow(10.0, check_uniform(&seed, -6, 0));
        for (int m = 0; m < 3; m++, t *= check_uniform(&seed, 1.5, 1e4))
            term[m] = (ph_prony_term){t, random_stiffness(&seed, 6)};
        ph_prony p = {random_stiffness(&seed, 6), 3, term};
        for (int k = 0; k < 4; k++) {
            ph_prony *r = reduced(&p, kin[k]);
            if (r) CHECK_ABS(worst(&p, r, kin[k]), 0.0, 1e-12);
            ph_prony_free(&r);
        }
    }
    CHECK_END();
}

/* Bulk and shear apart: their times move. Poisson's ratio fixed: they stay. */
static void test_isotropic(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_material m;
    const ph_modulus_term k[1] = {{2.0, 5.0}}, g[1] = {{0.5, 1.0}},
                          e[2] = {{1e-12, 4.0}, {1e12, 2.0}};
    CHECK_OK(ph_material_viscoelastic_bulk_shear("gel", &(ph_modulus){3.0, 1, k},
                                                 &(ph_modulus){0.2, 1, g}, &m, &err));
    ph_prony *r = reduced(m.relaxation, PH_PLANE_STRESS);
    CHECK_ABS(worst(m.relaxation, r, PH_PLANE_STRESS), 0.0, 1e-13);
    /* 12 and 11-22 relax with G alone; 11+22 with both, coupled by 33: two times more */
    CHECK(r->nterms == 3);
    ph_prony_free(&r);
    ph_material_clear(&m);
    CHECK_OK(ph_material_viscoelastic_young("resin", &(ph_modulus){1.0, 2, e}, 0.4999, &m,
                                            &err));
    r = reduced(m.relaxation, PH_PLANE_STRESS);
    CHECK(r->nterms == 2);
    CHECK_REL(r->term[0].time, 1e-12, 1e-10);
    CHECK_REL(r->term[1].time, 1e12, 1e-10);
    /* E of a plane of constant nu: C_1111 = E/(1-nu^2); the tensor of nu = 0.4999 loses
     * three digits in the condensation */
    CHECK_REL(r->term[0].stiffness.m[0][0], 4.0 / (1.0 - 0.4999 * 0.4999), 1e-11);
    ph_prony_free(&r);
    ph_material_clear(&m);
    CHECK_END();
}

/* A fluid: no shear at rest. In the plane it holds nothing, for 33 yields. */
static void test_fluid(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_material m;
    const ph_modulus_term g[2] = {{0.5, 1.0}, {20.0, 0.1}};
    CHECK_OK(ph_material_viscoelastic_bulk_shear("oil", &(ph_modulus){3.0, 0, NULL},
                                                 &(ph_modulus){0.0, 2, g}, &m, &err));
    ph_prony *r = reduced(m.relaxation, PH_PLANE_STRESS);
    CHECK(ph_sym4_norm(&r->equilibrium) == 0.0);
    /* C(s) itself loses its digits where G(s) is 1e-9 K: held against the closed form */
    for (int i = 1; i < VARIABLES; i++) {
        double s = variables[i], x = isinf(s) ? 1.0 : s * 0.5 / (1.0 + s * 0.5),
               y = isinf(s) ? 1.0 : s * 20.0 / (1.0 + s * 20.0), G = x + 0.1 * y;
        ph_sym4 c = ph_prony_carson(r, s);
        CHECK_REL(c.m[0][0], 4.0 * G * (9.0 + G) / (9.0 + 4.0 * G), 1e-12);
        CHECK_REL(c.m[2][2], 2.0 * G, 1e-12);
    }
    ph_prony_free(&r);
    r = reduced(m.relaxation, PH_PLANE_STRAIN);
    CHECK_REL(r->equilibrium.m[0][1], 3.0, 1e-15);
    ph_prony_free(&r);
    ph_material_clear(&m);
    CHECK_END();
}

/* A fluid of one Poisson's ratio: rates that are exactly zero are those of 33, 23, 13. */
static void test_one_fluid(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_material m;
    const ph_modulus_term e[1] = {{1.0, 20.0}};
    CHECK_OK(ph_material_viscoelastic_young("pitch", &(ph_modulus){0.0, 1, e}, 0.38, &m,
                                            &err));
    ph_prony *r = reduced(m.relaxation, PH_PLANE_STRESS);
    CHECK(r->nterms == 1 && ph_sym4_norm(&r->equilibrium) == 0.0);
    CHECK_REL(r->term[0].stiffness.m[0][0], 20.0 / (1.0 - 0.38 * 0.38), 1e-13);
    CHECK_REL(r->term[0].stiffness.m[2][2], 20.0 / 1.38, 1e-13);
    ph_prony_free(&r);
    ph_material_clear(&m);
    CHECK_END();
}

/* Forty terms over 24 decades. */
static void test_many_terms(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_prony_term term[40];
    for (int m = 0; m < 40; m++) {
        term[m].time = pow(10.0, -12.0 + 24.0 * m / 39.0);
        term[m].stiffness = ph_sym4_isotropic(check_uniform(&seed, 0.1, 1.0),
                                              check_uniform(&seed, 0.0, 0.45));
    }
    ph_prony p = {ph_sym4_isotropic(0.01, 0.3), 40, term};
    ph_prony *r = reduced(&p, PH_PLANE_STRESS);
    CHECK_ABS(worst(&p, r, PH_PLANE_STRESS), 0.0, 1e-11);
    ph_prony_free(&r);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random_series), cmocka_unit_test(test_isotropic),
        cmocka_unit_test(test_fluid),         cmocka_unit_test(test_one_fluid),
        cmocka_unit_test(test_many_terms),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
