/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The two composites of chapter 8 of [Galadima2023], from their case files, against
 * independent numbers and exact sum rules; what the thesis prints beside. */
#include <perihom_rve.h>

#include "check.h"

static ph_viscoelastic *solve_by(const char *name, const char *const *sets, size_t nsets,
                                 const ph_relaxation_params *params)
{
    ph_error err = PH_ERROR_INIT;
    char path[600];
    ph_case *c = NULL;
    ph_microstructure *micro = NULL;
    ph_viscoelastic *v = NULL;
    snprintf(path, sizeof path, "%s/cases/%s", PH_DATA_DIR, name);
    CHECK_OK(ph_case_read(path, sets, nsets, &c, NULL, &err));
    CHECK_OK(ph_rve_build(c, &micro, &err));
    const ph_problem problem = {.micro = micro,
                                .interface = c->interface,
                                .model = c->model,
                                .solver = c->solver};
    CHECK_OK(ph_viscoelastic_solve(&problem, params, &(ph_ctx){.threads = 1}, &v, &err));
    ph_microstructure_free(&micro);
    ph_case_free(&c);
    return v;
}

static ph_viscoelastic *solve(const char *name, const char *const *sets, size_t nsets)
{
    return solve_by(name, sets, nsets, &(ph_relaxation_params){.tolerance = 1e-6});
}

static ph_curve uniaxial(const ph_prony *p)
{
    ph_error err = PH_ERROR_INIT;
    ph_curve E = {0};
    CHECK_OK(ph_prony_uniaxial(p, 0, -1, &E, &err));
    return E;
}

/* Composite cells on 64^2: 0.1 % in C11 and C66, 0.3 % in C12, as an elastic contrast of 7
 * has it (docs/theory/microstructure.md); the route adds less than 1e-4. */
static void test_elastic_disk(void **state)
{
    (void)state;
    static const char *const sets[] = {"microstructure.nodes=[64,64]"};
    ph_error err = PH_ERROR_INIT;
    ph_table *want = NULL;
    ph_viscoelastic *v = solve("relaxing-matrix.yaml", sets, 1);
    CHECK_OK(ph_table_read(PH_DATA_DIR "/reference/relaxing-matrix.csv", &want, &err));
    CHECK(want->nrows == 7 && want->ncolumns == 4);
    for (ptrdiff_t r = 0; r < want->nrows; r++) {
        double voigt[9];
        ph_sym4 c = ph_prony_at_time(v->series, want->value[r]);
        ph_sym4_to_voigt(&c, true, voigt);
        CHECK_REL(voigt[0], want->value[want->nrows + r], 1e-3);
        CHECK_REL(voigt[1], want->value[2 * want->nrows + r], 3e-3);
        CHECK_REL(voigt[8], want->value[3 * want->nrows + r], 2e-3);
    }
    ph_curve E = uniaxial(v->series);
    CHECK_REL(E.infinity, 6.60249, 2e-3); /* the thesis fits 5.42 */
    /* not below what Hashin and Shtrikman leave: their bulk bound holds for square cells */
    const ph_isotropic iso = ph_nearest_isotropic(&v->equilibrium, PH_PLANE_STRESS);
    CHECK(iso.K >= 4.5004);
    ph_curve_free(&E);
    ph_table_free(&want);
    ph_viscoelastic_free(&v);
    CHECK_END();
}

/* Phases that differ only in their times: E(0) = 20, E(inf) = 3, both homogeneous; and as
 * both phases have C(s) = phi(s) C(1, nu) with moduli equal to first order at both ends,
 * int (E - E_inf) dt = 17 (0.5 1 + 0.5 10) = 93.5 and E'(0) = -17 (0.5/1 + 0.5/10) = -9.35. */
static void test_two_rates(void **state)
{
    (void)state;
    static const char *const sets[] = {"microstructure.nodes=[64,64]"};
    ph_viscoelastic *v = solve("relaxing-phases.yaml", sets, 1);
    ph_curve E = uniaxial(v->series);
    double integral = 0, slope = 0;
    for (int m = 0; m < E.nterms; m++) {
        integral += E.term[m].modulus * E.term[m].time;
        slope -= E.term[m].modulus / E.term[m].time;
    }
    CHECK_REL(ph_curve_at_time(&E, 0), 20, 1e-6);
    CHECK_REL(E.infinity, 3, 1e-6);
    CHECK_REL(integral, 93.5, 1e-3);
    CHECK_REL(slope, -9.35, 1e-3);
    /* the spectrum that phases with times 1 and 10 admit: their poles and zeros bound it */
    for (int m = 0; m < E.nterms; m++)
        CHECK(E.term[m].modulus < 1e-9 ||
              (E.term[m].time > 0.999 && E.term[m].time < 66.8));
    ph_curve_free(&E);
    ph_viscoelastic_free(&v);
    CHECK_END();
}

/* The whole series to 1e-4 against a thousand equal steps to twenty relaxation times, for each
 * of three loads, on the same cell; what both say of the same times. */
static void test_a_thousand_steps(void **state)
{
    (void)state;
    enum { STEPS = 1000 };
    static const char *const sets[] = {"microstructure.nodes=[8,8]"};
    static double times[STEPS];
    for (int k = 0; k < STEPS; k++)
        times[k] = 0.02 * (k + 1);
    ph_relaxation_params params = {.tolerance = 1e-4};
    ph_viscoelastic *series = solve_by("relaxing-matrix.yaml", sets, 1, &params);
    params = (ph_relaxation_params){
        .route = "stepping", .tolerance = 1e-3, .times = times, .ntimes = STEPS};
    ph_viscoelastic *steps = solve_by("relaxing-matrix.yaml", sets, 1, &params);
    if (series && steps) {
        double worst = 0.0;
        for (int k = 0; k < STEPS; k++) {
            ph_sym4 c = ph_prony_at_time(series->series, times[k]);
            ph_sym4 d = ph_sym4_combine(1.0, &steps->curve[k].stiffness, -1.0, &c);
            worst = fmax(worst, ph_sym4_norm(&d) / ph_sym4_norm(&c));
        }
        print_message("%ld steps, %ld applications (reduced %ld), difference %.2g\n",
                      steps->steps, steps->applications, series->applications, worst);
        CHECK(steps->steps >= 3 * STEPS && steps->steps <= 3 * STEPS + 30);
        CHECK(steps->applications >= 100 * series->applications);
        CHECK(series->error <= 1e-4);
        CHECK(worst < 1e-3);
    }
    ph_viscoelastic_free(&series);
    ph_viscoelastic_free(&steps);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_thousand_steps),
        cmocka_unit_test(test_elastic_disk),
        cmocka_unit_test(test_two_rates),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
