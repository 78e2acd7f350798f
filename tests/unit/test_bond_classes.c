/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The modulus of a bond from its two ends. */
#include "check.h"
#include "model/bond_classes.h"
#include "model/stiffness_map.h"

#include <math.h>
#include <string.h>

/* Cells: matrix, matrix, clay of filler 1 (twice), clay of filler 2, tube of filler 3,
 * clay painted without an owner, a hole. */
enum { M0, M1, A0, A1, B, T, C, H, CELLS };

static ph_microstructure *cells(void)
{
    ph_error err = PH_ERROR_INIT;
    ph_grid g;
    ph_material m[4];
    ph_microstructure *micro = NULL;
    ptrdiff_t n[2] = {CELLS, 1};
    double size[2] = {CELLS, 1};
    static const uint16_t phase[CELLS] = {0, 0, 1, 1, 1, 2, 1, 3};
    static const int32_t owner[CELLS] = {0, 0, 1, 1, 2, 3, 0, 0};
    CHECK_OK(ph_grid_init(&g, PH_PLANE_STRESS, n, size, &err));
    CHECK_OK(ph_material_isotropic("epoxy", 3.5, 1.0 / 3, &m[0], &err));
    CHECK_OK(ph_material_isotropic("clay", 178, 0.3334, &m[1], &err));
    CHECK_OK(ph_material_isotropic("tube", 1000, 1.0 / 3, &m[2], &err));
    m[3] = ph_material_void("hole");
    CHECK_OK(ph_microstructure_new(&g, 4, m, &micro, &err));
    if (!micro) return NULL;
    memcpy(micro->phase, phase, sizeof phase);
    micro->owner = calloc(CELLS, sizeof *micro->owner);
    memcpy(micro->owner, owner, sizeof owner);
    return micro;
}

static void check_table(double kappa, double mf, double mt, double apart, double painted)
{
    ph_error err = PH_ERROR_INIT;
    ph_microstructure *micro = cells();
    ph_bond_classes *c = NULL;
    CHECK_OK(ph_i_bond_classes_new(micro, kappa, NULL, CELLS, &c, &err));
    CHECK(c->matrix == 0);
    CHECK_REL(ph_i_bond_modulus(c, M0, M1), 3.5, 0.0);
    CHECK_REL(ph_i_bond_modulus(c, A0, A1), 178, 0.0);
    CHECK_REL(ph_i_bond_modulus(c, C, C), 178, 0.0);
    CHECK_REL(ph_i_bond_modulus(c, A0, C), 178, 0.0); /* one material, not two fillers */
    CHECK_REL(ph_i_bond_modulus(c, M0, A0), mf, 1e-15);
    CHECK_REL(ph_i_bond_modulus(c, M0, T), mt, 1e-15);
    CHECK_REL(ph_i_bond_modulus(c, A0, B), apart, 1e-15);
    CHECK_REL(ph_i_bond_modulus(c, B, T), apart, 1e-15);
    CHECK_REL(ph_i_bond_modulus(c, C, T), painted, 1e-15);
    for (int x = 0; x < CELLS; x++) {
        CHECK_ABS(ph_i_bond_modulus(c, H, x), 0.0, 0.0);
        for (int y = 0; y < CELLS; y++)
            CHECK_ABS(ph_i_bond_modulus(c, x, y), ph_i_bond_modulus(c, y, x), 0.0);
    }
    ph_i_bond_classes_free(&c);
    ph_microstructure_free(&micro);
}

static void rules(void **state)
{
    (void)state;
    check_table(0.1, 0.35, 0.35, 0.35, 17.8); /* painted clay is what the tube lies in */
    check_table(15, 52.5, 52.5, 3.5, 15 * 178.0);
    double h1 = 2 * 3.5 * 178 / 181.5, h2 = 2 * 3.5 * 1000 / 1003.5;
    check_table(0, h1, h2, 3.5, 2 * 178.0 * 1000 / 1178);
    check_table(NAN, h1, h2, 3.5, 2 * 178.0 * 1000 / 1178);
    CHECK_END();
}

/* Sources: the collar is a copy, a material, or nothing. */
static void sources(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_microstructure *micro = cells();
    ph_bond_classes *c = NULL;
    ptrdiff_t source[5] = {A0, A1, B, -2 - 1, PH_SOURCE_VOID};
    CHECK_OK(ph_i_bond_classes_new(micro, 0.1, source, 5, &c, &err));
    CHECK_ABS(ph_i_bond_modulus(c, 0, 1), 178, 0.0);
    CHECK_ABS(ph_i_bond_modulus(c, 0, 2), 0.35, 1e-15);
    CHECK_ABS(ph_i_bond_modulus(c, 2, 3), 178, 0.0); /* the material, in no filler */
    CHECK_ABS(ph_i_bond_modulus(c, 3, 4), 0.0, 0.0);
    CHECK(c->owner[2] == 2 && c->owner[3] == 0);
    ph_i_bond_classes_free(&c);
    ph_microstructure_free(&micro);
    CHECK_END();
}

/* Phases that bonds cannot be; only those that are there count. */
static void refused(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_microstructure *micro = cells();
    ph_bond_classes *c = NULL;
    ph_material odd, crystal;
    double voigt[36] = {0};
    for (int i = 0; i < 6; i++)
        voigt[7 * i] = i < 3 ? 3 : 1;
    CHECK_OK(ph_material_isotropic("odd", 1, 0.3, &odd, &err));
    CHECK_OK(ph_material_anisotropic("crystal", voigt, NULL, &crystal, &err));
    for (int k = 0; k < 2; k++) {
        err = (ph_error)PH_ERROR_INIT;
        micro->materials[2] = k ? crystal : odd;
        CHECK(ph_i_bond_classes_new(micro, 1, NULL, CELLS, &c, &err) == PH_EUNPHYSICAL);
        CHECK(strstr(err.msg, k ? "anisotropic" : "nu = 0.3,") != NULL);
        CHECK(strstr(err.msg, "nosb") && strstr(err.msg, "local"));
        CHECK(c == NULL);
    }
    micro->phase[T] = 1;
    CHECK_OK(ph_i_bond_classes_new(micro, 1, NULL, CELLS, &c, &err));
    ph_i_bond_classes_free(&c);
    CHECK(ph_i_bond_classes_new(micro, -1, NULL, CELLS, &c, &err) == PH_EINVAL);
    ph_microstructure_free(&micro);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rules),
        cmocka_unit_test(sources),
        cmocka_unit_test(refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
