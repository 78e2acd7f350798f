/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Creep and plane stress of a Prony series, exactly. */
#include <perihom/material.h>

#include "check.h"
#include "series.h"

enum { MOST = 40 };

/* Largest |J(s) C(s) - 1| over the decades of the times and six beyond. */
static double misfit(const ph_prony *p, const ph_creep *creep, double decades)
{
    double worst = 0;
    for (double u = -decades / 2 - 6; u < decades / 2 + 6; u += 0.3) {
        ph_sym4 c = ph_prony_carson(p, pow(10, u)),
                j = ph_creep_carson(creep, pow(10, u));
        ph_sym4 one = ph_sym4_product(&j, &c);
        for (int i = 0; i < c.n; i++)
            one.m[i][i] -= 1;
        worst = fmax(worst, ph_sym4_norm(&one));
    }
    return worst;
}

static void check_creep(const ph_prony *p, double decades, double tolerance)
{
    ph_error err = PH_ERROR_INIT;
    ph_creep *creep = NULL;
    CHECK_OK(ph_prony_creep(p, &creep, &err));
    if (!creep) return;
    CHECK_ABS(misfit(p, creep, decades), 0, tolerance);
    for (int m = 0; m < creep->nterms; m++) {
        double lo, hi;
        ph_sym4_eigenvalues(&creep->term[m].stiffness, &lo, &hi);
        CHECK(lo >= -1e-14 * hi && hi > 0);
        CHECK(m == 0 || creep->term[m].time > creep->term[m - 1].time);
    }
    ph_creep_free(&creep);
    CHECK(creep == NULL);
}

/* 1e-8 is what is promised; J C - 1 grows with the condition of C (below 1e4 here). */
static void test_creep_is_the_inverse(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int trial = 0; trial < check_trials(40); trial++) {
        int n = trial % 2 ? 3 : 6, nterms = 1 + trial % 7;
        double decades = trial % 3 ? 6 : 24;
        ph_prony *p = random_series(&seed, n, nterms, decades, 1 + trial % n, 1);
        check_creep(p, decades, 1e-10);
        ph_prony_free(&p);
    }
    CHECK_END();
}

static void test_extremes(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_prony *p = random_series(&seed, 6, MOST, 24, 2, 0.1);
    check_creep(p, 24, 1e-8);
    ph_prony_free(&p);
    p = random_series(&seed, 6, 3, 24, 6,
                      1e-9); /* nearly a fluid: contrast 1e9 at last */
    check_creep(p, 24, 1e-8);
    ph_prony_free(&p);
    p = random_series(&seed, 6, 3, 12, 6, 0); /* a fluid */
    check_creep(p, 12, 1e-8);
    ph_prony_free(&p);
    p = random_series(&seed, 3, 1, 0, 3, 0); /* Maxwell's */
    check_creep(p, 0, 1e-12);
    ph_prony_free(&p);
    CHECK_END();
}

/* One Maxwell element: J = 1/E + t/(E tau); the standard solid's retardation time is
 * tau (E_inf + E_1)/E_inf. */
static void test_closed_forms(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    static const ph_modulus_term one[] = {{5, 2}};
    const ph_modulus maxwell = {0, 1, one}, solid = {0.5, 1, one};
    ph_material m;
    ph_creep *creep = NULL;
    CHECK_OK(ph_material_viscoelastic_young("x", &maxwell, 0.3, &m, &err));
    CHECK_OK(ph_prony_creep(m.relaxation, &creep, &err));
    CHECK(creep->nterms == 0);
    CHECK_REL(creep->instantaneous.m[0][0], 0.5, 1e-14);
    CHECK_REL(creep->fluidity.m[0][0], 1 / 10.0, 1e-14);
    CHECK_REL(creep->fluidity.m[0][1], -0.3 / 10.0, 1e-14);
    CHECK_REL(ph_creep_at_time(creep, 30).m[0][0], 0.5 + 3, 1e-14);
    ph_creep_free(&creep);
    ph_material_clear(&m);
    CHECK_OK(ph_material_viscoelastic_young("x", &solid, 0.3, &m, &err));
    CHECK_OK(ph_prony_creep(m.relaxation, &creep, &err));
    CHECK(creep->nterms == 1 && ph_sym4_norm(&creep->fluidity) == 0);
    CHECK_REL(creep->term[0].time, 25, 1e-13);
    CHECK_REL(creep->term[0].stiffness.m[0][0], 1 / 0.5 - 1 / 2.5, 1e-13);
    CHECK_REL(ph_creep_at_time(creep, 25).m[0][0], 0.4 + 1.6 * (1 - exp(-1)), 1e-13);
    ph_creep_free(&creep);
    ph_material_clear(&m);
    CHECK_END();
}

/* Bulk does not relax, shear flows: J of pressure stays elastic, J of shear flows. */
static void test_partly_fluid(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    static const ph_modulus_term term[] = {{1, 2}, {100, 0.1}};
    const ph_modulus K = {4, 0, NULL}, G = {0, 2, term};
    ph_material m;
    CHECK_OK(ph_material_viscoelastic_bulk_shear("melt", &K, &G, &m, &err));
    ph_creep *creep = NULL;
    CHECK_OK(ph_prony_creep(m.relaxation, &creep, &err));
    double eta = 1 * 2 + 100 * 0.1;
    CHECK_REL(creep->fluidity.m[3][3], 1 / (2 * eta), 1e-12);
    double bulk = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            bulk += creep->fluidity.m[i][j];
    CHECK_ABS(bulk, 0, 1e-14);
    CHECK(creep->nterms == 1);
    check_creep(m.relaxation, 4, 1e-8);
    ph_creep_free(&creep);
    ph_material_clear(&m);
    CHECK_END();
}

static void test_plane_stress_is_condensed(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    for (int trial = 0; trial < check_trials(30); trial++) {
        double equilibrium[] = {1, 1e-3, 0};
        ph_prony *p = random_series(&seed, 6, 1 + trial % 6, 12, 1 + trial % 6,
                                    equilibrium[trial % 3]);
        ph_prony *plane = NULL;
        CHECK_OK(ph_prony_reduce(p, PH_PLANE_STRESS, &plane, &err));
        CHECK_OK(ph_prony_validate(plane, &err));
        for (double u = -10; u < 10; u += 0.37) {
            ph_sym4 c = ph_prony_carson(p, pow(10, u)), want,
                    got = ph_prony_carson(plane, pow(10, u));
            if (ph_sym4_reduce(&c, PH_PLANE_STRESS, &want, NULL) != PH_OK) continue;
            CHECK_ABS(difference(&got, &want), 0, 1e-9);
        }
        ph_prony_free(&p);
        ph_prony_free(&plane);
    }
    CHECK_END();
}

/* Constant Poisson ratio: plane stress relaxes with the times of the phase. */
static void test_reductions(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    static const ph_modulus_term two[] = {{10, 17}, {0.1, 5}};
    const ph_modulus E = {3, 2, two};
    static const ph_kinematics kin[] = {PH_SPACE, PH_GENERALISED_STRAIN, PH_PLANE_STRAIN,
                                        PH_PLANE_STRESS};
    ph_material m;
    CHECK_OK(ph_material_viscoelastic_young("x", &E, 0.38, &m, &err));
    for (int k = 0; k < 4; k++) {
        ph_prony *p = NULL;
        CHECK_OK(ph_prony_reduce(m.relaxation, kin[k], &p, &err));
        CHECK(p->nterms == 2 && p->equilibrium.n == ph_strains(kin[k]));
        CHECK_REL(p->term[0].time, 0.1, 1e-12);
        ph_sym4 want, got = ph_prony_at_time(p, 3),
                      c = ph_sym4_isotropic(3 + 17 * exp(-0.3) + 5 * exp(-30), 0.38);
        CHECK_OK(ph_sym4_reduce(&c, kin[k], &want, &err));
        CHECK_ABS(difference(&got, &want), 0, 1e-12);
        if (k >= 2) {
            ph_prony *again = NULL;
            CHECK_OK(ph_prony_reduce(p, kin[k], &again, &err));
            CHECK(again->nterms == 2);
            CHECK(ph_prony_reduce(p, PH_SPACE, &(ph_prony *){NULL}, NULL) == PH_EINVAL);
            ph_prony_free(&again);
        }
        ph_prony_free(&p);
    }
    ph_material_clear(&m);
    CHECK_END();
}

/* E(s) = 1/J_kk(s) and nu(s) = -J_lk/J_kk at every s and in frequency, through the inverse
 * of C(s). */
static void test_uniaxial(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    for (int trial = 0; trial < check_trials(24); trial++) {
        int n = trial % 2 ? 3 : 6, k = trial % n, l = (k + 1) % n;
        ph_prony *p = random_series(&seed, n, 1 + trial % 5, 10, 1 + trial % n, 1e-3);
        ph_curve E = {0}, nu = {0};
        CHECK_OK(ph_prony_uniaxial(p, k, -1, &E, &err));
        CHECK_OK(ph_prony_uniaxial(p, k, l, &nu, &err));
        for (double u = -9; u < 9; u += 0.7) {
            double s = pow(10, u), x = E.infinity, y = nu.infinity;
            ph_sym4 c = ph_prony_carson(p, s), j;
            CHECK_OK(ph_sym4_inverse(&c, &j, &err));
            for (int m = 0; m < E.nterms; m++)
                x += E.term[m].modulus / (1 + 1 / (s * E.term[m].time));
            for (int m = 0; m < nu.nterms; m++)
                y += nu.term[m].modulus / (1 + 1 / (s * nu.term[m].time));
            CHECK_REL(x, 1 / j.m[k][k], 1e-9);
            CHECK_ABS(y, -j.m[l][k] / j.m[k][k], 1e-8);
        }
        for (int m = 0; m < E.nterms; m++)
            CHECK(E.term[m].modulus >= 0);
        ph_curve_free(&E);
        ph_curve_free(&nu);
        ph_prony_free(&p);
    }
    CHECK_END();
}

/* Standard solid of constant nu: E(t) is its series, nu(t) stays. */
static void test_uniaxial_closed_form(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    static const ph_modulus_term two[] = {{10, 17}, {0.1, 5}};
    const ph_modulus series = {3, 2, two};
    ph_material m;
    ph_curve E, nu, G;
    double re, im;
    CHECK_OK(ph_material_viscoelastic_young("x", &series, 0.38, &m, &err));
    CHECK_OK(ph_prony_uniaxial(m.relaxation, 1, -1, &E, &err));
    CHECK_OK(ph_prony_uniaxial(m.relaxation, 1, 2, &nu, &err));
    CHECK_OK(ph_prony_uniaxial(m.relaxation, 4, -1, &G, &err));
    CHECK(E.nterms == 2);
    CHECK_REL(E.infinity, 3, 1e-13);
    CHECK_REL(ph_curve_at_time(&E, 2), 3 + 17 * exp(-0.2) + 5 * exp(-20), 1e-13);
    CHECK_REL(ph_curve_at_time(&nu, 0), 0.38, 1e-12);
    CHECK_REL(ph_curve_at_time(&nu, 5), 0.38, 1e-12);
    CHECK_REL(ph_curve_at_time(&G, 2) / 2, ph_curve_at_time(&E, 2) / 2.76, 1e-12);
    ph_curve_complex(&E, 0.2, &re, &im);
    CHECK_REL(re, 3 + 17 * 4 / 5.0 + 5 * 0.0004 / 1.0004, 1e-12);
    CHECK_REL(im, 17 * 2 / 5.0 + 5 * 0.02 / 1.0004, 1e-12);
    CHECK(ph_prony_uniaxial(m.relaxation, 6, -1, &E, NULL) == PH_EINVAL);
    CHECK(ph_prony_uniaxial(m.relaxation, 1, 1, &E, NULL) == PH_EINVAL);
    ph_curve_free(&E);
    ph_curve_free(&nu);
    ph_curve_free(&G);
    ph_material_clear(&m);
    CHECK_END();
}

static void test_no_inverse(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_prony_term term = {1, ph_sym4_isotropic_kg(1, 0)};
    const ph_prony p = {{.n = 6}, 1, &term}, none = {{.n = 6}, 0, NULL};
    ph_creep *creep = NULL;
    ph_prony *plane = NULL;
    CHECK(ph_prony_creep(&p, &creep, &err) == PH_ESINGULAR && !creep);
    CHECK(ph_prony_creep(&none, &creep, NULL) == PH_ESINGULAR && !creep);
    CHECK(ph_prony_reduce(&p, PH_PLANE_STRESS, &plane, NULL) == PH_ESINGULAR && !plane);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_creep_is_the_inverse),
        cmocka_unit_test(test_extremes),
        cmocka_unit_test(test_closed_forms),
        cmocka_unit_test(test_partly_fluid),
        cmocka_unit_test(test_plane_stress_is_condensed),
        cmocka_unit_test(test_reductions),
        cmocka_unit_test(test_uniaxial),
        cmocka_unit_test(test_uniaxial_closed_form),
        cmocka_unit_test(test_no_inverse),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
