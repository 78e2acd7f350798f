/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Relaxation where arithmetic or the solver could give up: times over 24 decades, nearly
 * incompressible matrices, contrasts that appear late, fluids that percolate or not, long
 * series and short ones. */
#include <perihom.h>

#include "check.h"
#include "relaxing.h"

static ph_viscoelastic *relax(const ph_problem *p, double tolerance)
{
    ph_error err = PH_ERROR_INIT;
    ph_relaxation_params params = {.tolerance = tolerance};
    ph_viscoelastic *v = NULL;
    CHECK_OK(ph_viscoelastic_solve(p, &params, &one_thread, &v, &err));
    if (v) CHECK_OK(ph_prony_validate(v->series, &err));
    if (v && getenv("SAY"))
        for (int i = 0; i < v->npoints; i++)
            printf("   s %g error %.2e its %d added %d\n", v->points[i].s,
                   v->points[i].error, v->points[i].iterations, v->points[i].added);
    if (v && getenv("SAY"))
        printf("est %.1e at %g basis %d terms %d applications %ld %.3f s lost %d\n",
               v->error, v->error_at, v->basis, v->series->nterms, v->applications,
               v->seconds, v->lost);
    return v;
}

/* An elastic problem of its own at each s, with the same discretisation. */
static void compare(const ph_problem *p, const ph_viscoelastic *v, int n, const double *s,
                    double tolerance)
{
    ph_error err = PH_ERROR_INIT;
    ph_relaxation_params params = {.route = "carson", .carson = s, .ncarson = n};
    ph_viscoelastic *full = NULL;
    ph_problem sharp = *p;
    sharp.solver.tolerance = 1e-9;
    sharp.solver.max_iterations = 20000;
    CHECK_OK(ph_viscoelastic_solve(&sharp, &params, &one_thread, &full, &err));
    for (int i = 0; v && full && i < n; i++) {
        ph_sym4 got = ph_prony_carson(v->series, s[i]);
        if (getenv("SAY"))
            printf("   s %g off %.2e\n", s[i], off(&got, &full->values[i].stiffness));
        CHECK(off(&got, &full->values[i].stiffness) < tolerance);
    }
    ph_viscoelastic_free(&full);
}

static ph_material relaxing(const char *name, double rest, int n,
                            const ph_modulus_term *term, double nu)
{
    ph_error err = PH_ERROR_INIT;
    ph_modulus E = {rest, n, term};
    ph_material m = {0};
    CHECK_OK(ph_material_viscoelastic_young(name, &E, nu, &m, &err));
    return m;
}

/* Ten times, 1e-12 to 1e12, in one phase, one more in the other. */
static void times_over_24_decades(void **state)
{
    (void)state;
    ph_modulus_term a[9], b = {1e3, 5.0};
    for (int t = 0; t < 9; t++)
        a[t] = (ph_modulus_term){pow(10.0, -12 + 3 * t), 1.0};
    ph_material m = relaxing("matrix", 0.5, 9, a, 0.35),
                f = relaxing("fibre", 40, 1, &b, 0.2);
    ph_microstructure *micro = round_cell(PH_GENERALISED_STRAIN, 16, 0.4, m, f);
    ph_problem p = {.micro = micro};
    ph_viscoelastic *v = relax(&p, 1e-4);
    const double s[] = {1e-13, 1e-9, 1e-3, 1e1, 1e6, 1e12};
    compare(&p, v, 6, s, 1e-4);
    if (v) {
        CHECK(v->series->term[0].time < 1.1e-12);
        CHECK(v->series->term[v->series->nterms - 1].time > 0.9e12);
    }
    ph_viscoelastic_free(&v);
    ph_microstructure_free(&micro);
    ph_material_clear(&m);
    ph_material_clear(&f);
    CHECK_END();
}

/* nu = 0.4999: bulk modulus 5000 times the shear modulus, as it always was, and as a
 * rubber's shear modulus falls under a bulk modulus that stays. */
static void nearly_incompressible(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_modulus_term e = {1.0, 0.9}, g = {1.0, 0.33};
    ph_modulus K = {1.0, 0, NULL}, G = {2e-4, 1, &g};
    ph_material m[2] = {relaxing("rubber", 0.1, 1, &e, 0.4999), {.E = 0}},
                filler = isotropic("filler", 30, 0.2);
    CHECK_OK(ph_material_viscoelastic_bulk_shear("rubber", &K, &G, &m[1], &err));
    for (int i = 0; i < 2; i++) {
        ph_microstructure *micro = round_cell(PH_PLANE_STRAIN, 16, 0.3, m[i], filler);
        ph_problem p = {.micro = micro};
        ph_viscoelastic *v = relax(&p, 1e-4);
        const double s[] = {0.0, 1e-4, 1e-2, 1.0, 30.0};
        compare(&p, v, 5, s, 1e-4);
        ph_viscoelastic_free(&v);
        ph_microstructure_free(&micro);
        ph_material_clear(&m[i]);
    }
    CHECK_END();
}

/* Equal moduli at first, a million times softer or stiffer at last. */
static void contrast_that_appears_late(void **state)
{
    (void)state;
    ph_modulus_term t = {1.0, 1.0};
    for (int inside = 0; inside < 2; inside++) {
        ph_material a = relaxing("relaxes", 1e-6, 1, &t, 0.3),
                    b = isotropic("stays", 1, 0.3);
        ph_microstructure *micro =
            round_cell(PH_PLANE_STRAIN, 16, 0.3, inside ? b : a, inside ? a : b);
        ph_problem p = {.micro = micro};
        ph_viscoelastic *v = relax(&p, 1e-4);
        const double s[] = {0.0, 1e-7, 1e-5, 1e-3, 0.1, 10.0};
        compare(&p, v, 6, s, 1e-4);
        if (v) CHECK(v->lost == 0);
        ph_viscoelastic_free(&v);
        ph_microstructure_free(&micro);
        ph_material_clear(&a);
    }
    CHECK_END();
}

/* Fluids: an inclusion of it leaves a porous solid; a matrix of it leaves nothing; layers of
 * it carry along and not across. */
static void fluids(void **state)
{
    (void)state;
    ph_modulus_term t = {1.0, 1.0};
    ph_material fluid = relaxing("fluid", 0.0, 1, &t, 0.3),
                solid = isotropic("solid", 2, 0.3);
    const double s[] = {1e-3, 1e-2, 0.1, 10.0};
    static const int lost[] = {0, 3, 2};
    for (int which = 0; which < 3; which++) {
        ph_microstructure *micro =
            round_cell(PH_PLANE_STRAIN, 16, 0.3, which == 1 ? fluid : solid,
                       which == 1 ? solid : fluid);
        for (ptrdiff_t x = 0; which == 2 && x < 256; x++)
            micro->phase[x] = x / 16 < 5; /* layers across axis 1 */
        if (which == 2) micro->ncuts = 0;
        ph_problem p = {.micro = micro};
        ph_viscoelastic *v = relax(&p, 1e-4);
        compare(&p, v, 4, s, 1e-4);
        if (v) CHECK(v->lost == lost[which]);
        ph_viscoelastic_free(&v);
        ph_microstructure_free(&micro);
    }
    ph_material_clear(&fluid);
    CHECK_END();
}

/* Forty terms, 1e-10 to 1e10; one term. */
static void long_series_and_short_ones(void **state)
{
    (void)state;
    ph_modulus_term t[40];
    for (int i = 0; i < 40; i++)
        t[i] = (ph_modulus_term){pow(10.0, -10 + 20 * i / 39.0), 1.0 + 0.5 * sin(i)};
    for (int n = 1; n <= 40; n += 39) {
        ph_material a = relaxing("matrix", 2, n, t, 0.35),
                    b = isotropic("disk", 100, 0.2);
        ph_microstructure *micro = round_cell(PH_PLANE_STRESS, 16, 0.4, a, b);
        ph_problem p = {.micro = micro};
        ph_viscoelastic *v = relax(&p, 1e-4);
        const double s[] = {0.0, 1e-6, 1.0, 1e8};
        compare(&p, v, 4, s, 1e-4);
        ph_viscoelastic_free(&v);
        ph_microstructure_free(&micro);
        ph_material_clear(&a);
    }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(times_over_24_decades),
        cmocka_unit_test(nearly_incompressible),
        cmocka_unit_test(contrast_that_appears_late),
        cmocka_unit_test(fluids),
        cmocka_unit_test(long_series_and_short_ones),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
