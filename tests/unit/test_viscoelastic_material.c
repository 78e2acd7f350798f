/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/microstructure.h>

#include "check.h"
#include "tensors.h"

static const ph_modulus_term two[] = {{10, 17}, {0.1, 5}};
static const ph_modulus three_plus_two = {3, 2, two}, fluid = {0, 2, two},
                        constant = {4, 0, NULL};

static void test_E(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_material m, at;
    CHECK_OK(ph_material_viscoelastic_young("resin", &three_plus_two, 0.38, &m, &err));
    CHECK(m.is_isotropic && m.E == 25 && m.nu == 0.38 && m.relaxation->nterms == 2);
    CHECK(m.relaxation->term[0].time == 0.1);
    ph_sym4 want = ph_sym4_isotropic(25, 0.38);
    CHECK(difference(&m.stiffness, &want) < 1e-15);
    CHECK_OK(ph_material_at(&m, 0.2, &at, &err));
    double E = 3 + 17 * 2 / 3.0 + 5 * 0.02 / 1.02;
    want = ph_sym4_isotropic(E, 0.38);
    CHECK(at.relaxation == NULL && at.is_isotropic);
    CHECK(difference(&at.stiffness, &want) < 1e-15);
    CHECK_REL(at.E, E, 1e-14);
    CHECK_REL(at.nu, 0.38, 1e-14);
    CHECK_OK(ph_material_at(&m, 0, &at, &err));
    CHECK_REL(at.E, 3, 1e-14);
    CHECK_OK(ph_material_at(&m, INFINITY, &at, &err));
    CHECK_REL(at.E, 25, 1e-14);
    CHECK(ph_material_at(&m, -1, &at, NULL) == PH_EINVAL);
    CHECK(ph_material_at(&m, NAN, &at, NULL) == PH_EINVAL);
    ph_material_clear(&m);
    ph_material_clear(&m);
    CHECK(m.relaxation == NULL);
    CHECK_END();
}

static void test_bulk_and_shear(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    static const ph_modulus_term shear[] = {{10, 1}, {5, 2}};
    const ph_modulus G = {0.5, 2, shear};
    ph_material m, at;
    CHECK_OK(ph_material_viscoelastic_bulk_shear("gel", &three_plus_two, &G, &m, &err));
    CHECK(m.relaxation->nterms == 3); /* 10 is in both */
    double s = 0.7, K = 3 + 17 * 7 / 8.0 + 5 * 0.07 / 1.07,
           g = 0.5 + 7 / 8.0 + 2 * 3.5 / 4.5;
    CHECK_OK(ph_material_at(&m, s, &at, &err));
    ph_sym4 want = ph_sym4_isotropic_kg(K, g);
    CHECK(difference(&at.stiffness, &want) < 1e-15);
    CHECK_REL(at.E, 9 * K * g / (3 * K + g), 1e-14);
    CHECK_REL(at.nu, (3 * K - 2 * g) / (6 * K + 2 * g), 1e-14);
    ph_material_clear(&m);
    /* shear flows, bulk does not: no elastic equilibrium, yet a material */
    CHECK_OK(ph_material_viscoelastic_bulk_shear("melt", &constant, &fluid, &m, &err));
    CHECK(ph_material_at(&m, 0, &at, &err) == PH_ESINGULAR);
    CHECK(strstr(err.msg, "'melt'") && strstr(err.msg, "s = 0"));
    CHECK(ph_material_at(&m, 1e-6, &at, NULL) == PH_OK);
    ph_material_clear(&m);
    CHECK_END();
}

static void test_series_without_terms_is_elastic(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_material m, at;
    CHECK_OK(ph_material_viscoelastic_young("x", &constant, 0.3, &m, &err));
    CHECK(m.relaxation == NULL && m.E == 4);
    CHECK_OK(ph_material_viscoelastic_bulk_shear("x", &constant, &constant, &m, &err));
    CHECK(m.relaxation == NULL);
    CHECK_REL(m.E, 9, 1e-15);
    CHECK_OK(ph_material_at(&m, 3, &at, &err));
    CHECK(memcmp(&at, &m, sizeof m) == 0);
    CHECK_END();
}

/* A Maxwell fluid: nothing is left at equilibrium, which is a hole. */
static void test_fluid(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_material m, at;
    CHECK_OK(ph_material_viscoelastic_young("pitch", &fluid, 0.4, &m, &err));
    m.density = 7;
    CHECK_OK(ph_material_at(&m, 0, &at, &err));
    CHECK(at.is_void && !at.is_isotropic && at.density == 7 &&
          strcmp(at.name, "pitch") == 0);
    ph_material_clear(&m);
    CHECK_END();
}

static void test_tensor(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    double R[9];
    ph_material m;
    ph_prony_term term = {2, random_stiffness(&seed, 6)};
    const ph_prony series = {random_stiffness(&seed, 6), 1, &term};
    random_rotation(&seed, R);
    CHECK_OK(ph_material_viscoelastic_tensor("ply", &series, R, &m, &err));
    CHECK(!m.is_isotropic && isnan(m.E) && m.relaxation->term != series.term);
    ph_sym4 want = ph_prony_instantaneous(&series);
    want = ph_sym4_rotate(&want, R);
    CHECK(difference(&m.stiffness, &want) < 1e-14);
    ph_material_clear(&m);
    term.stiffness.m[0][0] = -term.stiffness.m[0][0];
    CHECK(ph_material_viscoelastic_tensor("ply", &series, NULL, &m, &err) ==
          PH_EUNPHYSICAL);
    CHECK(strstr(err.msg, "'ply'") && strstr(err.msg, "semidefinite"));
    const ph_prony flat = {{.n = 3}, 0, NULL};
    CHECK(ph_material_viscoelastic_tensor("ply", &flat, NULL, &m, NULL) == PH_EINVAL);
    CHECK_END();
}

static void refuse(double infinity, int n, double modulus, double time, double nu,
                   const char *word)
{
    ph_error err = PH_ERROR_INIT;
    const ph_modulus_term term[] = {{1, 2}, {time, modulus}};
    const ph_modulus bad = {infinity, n, term};
    ph_material m = {.E = 77};
    CHECK(ph_material_viscoelastic_young("x", &bad, nu, &m, &err) != PH_OK);
    if (!strstr(err.msg, word)) print_error("'%s' lacks '%s'\n", err.msg, word);
    CHECK(strstr(err.msg, word) != NULL && strstr(err.msg, "'x'") != NULL);
    if (nu == 0.3) {
        CHECK(ph_material_viscoelastic_bulk_shear("x", &bad, &bad, &m, NULL) != PH_OK);
        CHECK(ph_material_viscoelastic_bulk_shear("x", &constant, &bad, &m, NULL) !=
              PH_OK);
    }
    CHECK(m.E == 77); /* failures leave the output alone */
}

static void test_refusals(void **state)
{
    (void)state;
    static const double nu[] = {0.5, -1, NAN, 0.62};
    static const double time[] = {0, -3, NAN, INFINITY, 1e-305};
    refuse(-1, 2, 1, 3, 0.3, "infinity");
    refuse(NAN, 2, 1, 3, 0.3, "infinity");
    refuse(INFINITY, 2, 1, 3, 0.3, "infinity");
    refuse(1, 2, -1, 3, 0.3, "modulus");
    refuse(1, 2, NAN, 3, 0.3, "modulus");
    refuse(1, 2, 1, 1, 0.3, "twice");
    refuse(1, -2, 1, 1, 0.3, "terms");
    refuse(0, 0, 1, 1, 0.3, "instantaneous");
    for (size_t i = 0; i < sizeof time / sizeof *time; i++)
        refuse(1, 2, 1, time[i], 0.3, "time");
    for (size_t i = 0; i < sizeof nu / sizeof *nu; i++)
        refuse(1, 2, 1, 3, nu[i], "Poisson");
    CHECK_END();
}

/* The series of a microstructure and of a copy are their own. */
static void test_ownership(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_material m[2], copy;
    ph_grid grid;
    ph_microstructure *micro = NULL;
    const ptrdiff_t n[] = {2, 2};
    const double size[] = {1, 1};
    CHECK_OK(ph_material_viscoelastic_young("resin", &three_plus_two, 0.38, &m[0], &err));
    CHECK_OK(ph_material_isotropic("glass", 70, 0.2, &m[1], &err));
    CHECK_OK(ph_grid_init(&grid, PH_PLANE_STRAIN, n, size, &err));
    CHECK_OK(ph_microstructure_new(&grid, 2, m, &micro, &err));
    CHECK_OK(ph_material_copy(&m[0], &copy, &err));
    CHECK(copy.relaxation != m[0].relaxation);
    ph_material_clear(&m[0]);
    CHECK(micro->materials[0].relaxation->term[1].time == 10);
    CHECK(micro->materials[1].relaxation == NULL);
    ph_microstructure_free(&micro);
    CHECK(copy.relaxation->term[1].time == 10);
    ph_material_clear(&copy);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_E),
        cmocka_unit_test(test_bulk_and_shear),
        cmocka_unit_test(test_series_without_terms_is_elastic),
        cmocka_unit_test(test_fluid),
        cmocka_unit_test(test_tensor),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_ownership),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
