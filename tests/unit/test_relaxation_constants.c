/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/relaxation.h>

#include "check.h"
#include "series.h"

/* At s = 0 and infinity every constant is that of the elastic tensor. */
static void test_limits(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    for (int n = 3; n <= 6; n += 3) {
        ph_prony *p = random_series(&seed, n, 4, 6, 2, 0.5);
        ph_constants *k = NULL;
        CHECK_OK(ph_constants_new(p, &k, &err));
        CHECK(k->count == (n == 6 ? 21 + 12 + 4 : 6 + 5 + 4) && !k->why[0]);
        for (int end = 0; end < 2; end++) {
            ph_sym4 c = end ? p->equilibrium : ph_prony_instantaneous(p);
            double at = end ? INFINITY : 0, v[36];
            ph_engineering e;
            ph_isotropic iso = ph_nearest_isotropic(&c, PH_SPACE);
            CHECK_OK(ph_engineering_constants(&c, &e, &err));
            ph_sym4_to_voigt(&c, true, v);
            const struct {
                const char *name;
                double want;
            } item[] = {{"E1", e.E[0]},
                        {"E2", e.E[1]},
                        {"nu12", e.nu[0][1]},
                        {"nu21", e.nu[1][0]},
                        {"G12", e.G12},
                        {"C11", v[0]},
                        {"C12", v[1]},
                        {"C66", v[n * n - 1]},
                        {"isotropic.E", iso.E},
                        {"isotropic.nu", iso.nu},
                        {"isotropic.K", iso.K},
                        {"isotropic.G", iso.G},
                        {"G23", e.G23},
                        {"nu31", e.nu[2][0]},
                        {"C44", v[n == 6 ? 21 : 0]}};
            for (size_t i = 0; i < (n == 6 ? 15 : 12); i++) {
                const ph_constant *one = ph_constants_find(k, item[i].name);
                CHECK(one != NULL);
                if (!one) continue;
                CHECK_ABS(ph_curve_at_time(&one->curve, at), item[i].want,
                          1e-9 * fmax(1, fabs(item[i].want)));
                CHECK(one->is_modulus == (strstr(item[i].name, "nu") == NULL));
            }
        }
        CHECK(ph_constants_find(k, "E9") == NULL);
        ph_constants_free(&k);
        ph_prony_free(&p);
    }
    CHECK_END();
}

/* Storage rises with frequency, loss is not negative, and both are one function: C''(w) from
 * C' by the Kramers-Kronig relation
 *     C''(w) = -(2 w / pi) P int_0^inf (C'(x) - C'(w)) / (x^2 - w^2) dx ... with its sign:
 *     C''(w) = (2 w / pi) int_0^inf (C'(x) - C'(w)) / (x^2 - w^2) dx,
 * by the midpoint rule in ln x, whose points lie symmetrically about w; error of the rule
 * with a step h: h^2, here 1e-3. */
static void test_dynamic(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    ph_prony *p = random_series(&seed, 6, 5, 4, 3, 0.3);
    ph_constants *k = NULL;
    const double pi = acos(-1.0);
    CHECK_OK(ph_constants_new(p, &k, &err));
    for (int i = 0; i < k->count; i++) {
        const ph_curve *curve = &k->item[i].curve;
        double last = -HUGE_VAL;
        bool positive = k->item[i].is_modulus && k->item[i].name[0] != 'C';
        for (double u = -6; positive && u < 6; u += 0.25) {
            double re, im;
            ph_curve_complex(curve, pow(10, u), &re, &im);
            CHECK(re >= last * (1 - 1e-14) && im >= 0);
            last = re;
        }
        if (i % 5) continue;
        for (double w = 1e-2; w < 200; w *= 13) {
            double re, im, sum = 0, step = 0.02;
            ph_curve_complex(curve, w, &re, &im);
            for (double u = -30 + step / 2; u < 30; u += step) {
                double x = w * exp(u), other, ignored;
                ph_curve_complex(curve, x, &other, &ignored);
                sum += step * x * (other - re) / (x * x - w * w);
            }
            CHECK_ABS(2 * w / pi * sum, im, 1e-3 * (fabs(im) + fabs(re)));
        }
    }
    ph_constants_free(&k);
    ph_prony_free(&p);
    CHECK_END();
}

static void test_tables(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    ph_prony *p = random_series(&seed, 3, 4, 6, 2, 0.5);
    ph_constants *k = NULL;
    ph_table *curves = NULL, *dynamic = NULL, *terms = NULL;
    double *grid = NULL;
    int count = 0;
    CHECK_OK(ph_constants_new(p, &k, &err));
    CHECK_OK(ph_prony_grid(p, false, 10, &count, &grid, &err));
    CHECK_REL(grid[0], p->term[0].time / 10, 1e-12);
    CHECK_REL(grid[count - 1], p->term[3].time * 10, 1e-12);
    CHECK_OK(ph_constants_curves(k, count, grid, &curves, &err));
    free(grid);
    CHECK_OK(ph_prony_grid(p, true, 10, &count, &grid, &err));
    CHECK_REL(grid[0], 0.1 / p->term[3].time, 1e-12);
    CHECK(grid[1] > grid[0]);
    CHECK_OK(ph_constants_dynamic(k, count, grid, &dynamic, &err));
    free(grid);
    CHECK_OK(ph_prony_table(p, &terms, &err));
    int E1 = ph_table_column(curves, "E1"), loss = ph_table_column(dynamic, "E1_loss"),
        tan = ph_table_column(dynamic, "E1_tan_delta"),
        storage = ph_table_column(dynamic, "E1_storage");
    CHECK(E1 > 0 && loss > 0 && tan > 0 && curves->nrows == count);
    CHECK(ph_table_column(dynamic, "nu12_tan_delta") < 0);
    ptrdiff_t row = 7, N = count;
    CHECK_REL(curves->value[E1 * N + row],
              ph_curve_at_time(&ph_constants_find(k, "E1")->curve, curves->value[row]),
              0);
    CHECK_REL(dynamic->value[tan * N + row],
              dynamic->value[loss * N + row] / dynamic->value[storage * N + row], 1e-15);
    CHECK(terms->nrows == 5 && terms->ncolumns == 7);
    double sum = 0;
    for (int m = 0; m < 5; m++)
        sum += terms->value[5 + m]; /* C11 */
    CHECK_REL(sum, ph_prony_instantaneous(p).m[0][0], 1e-14);
    CHECK(isinf(terms->value[0]));
    ph_table_free(&curves);
    ph_table_free(&dynamic);
    ph_table_free(&terms);
    ph_constants_free(&k);
    ph_prony_free(&p);
    CHECK_END();
}

/* No instantaneous compliance: the components remain and the reason is given. */
static void test_singular(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_prony_term term = {1, ph_sym4_isotropic_kg(1, 0)};
    const ph_prony p = {{.n = 6}, 1, &term};
    ph_constants *k = NULL;
    CHECK_OK(ph_constants_new(&p, &k, &err));
    CHECK(k->count == 21 && strstr(k->why, "positive definite"));
    ph_constants_free(&k);
    const ph_prony elastic = {ph_sym4_isotropic(3, 0.3), 0, NULL};
    CHECK_OK(ph_constants_new(&elastic, &k, &err));
    CHECK_REL(ph_curve_at_time(&ph_constants_find(k, "E2")->curve, 5), 3, 1e-13);
    ph_constants_free(&k);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_limits),
        cmocka_unit_test(test_dynamic),
        cmocka_unit_test(test_tables),
        cmocka_unit_test(test_singular),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
