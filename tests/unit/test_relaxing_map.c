/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Weighted phases in one map, real and complex. */
#include "check.h"
#include "effective/complex_map.h"
#include "visco_case.h"

typedef struct maps {
    ph_microstructure *micro;
    ph_stiffness_map *map;
    ph_relaxing_map *relax;
    ph_meter meter;
} maps;

static void new_maps(maps *m, uint64_t *seed, ph_kinematics kin)
{
    static const ptrdiff_t n[3] = {5, 4, 1};
    *m = (maps){.micro = viscous_micro(seed, kin, n, true)};
    ph_error err = PH_ERROR_INIT;
    CHECK_OK(ph_i_stiffness_map_new(m->micro, PH_INTERFACE_COMPOSITE, true, NULL, 20,
                                    &m->meter, &m->map, &err));
    CHECK_OK(ph_i_relaxing_map_new(m->map, m->micro, 1, &m->meter, &m->relax, &err));
}

static void free_maps(maps *m)
{
    ph_i_relaxing_map_free(&m->relax);
    ph_i_stiffness_map_free(&m->meter, &m->map);
    ph_microstructure_free(&m->micro);
    CHECK(m->meter.bytes == 0);
}

/* Entry `at` of the map that is shown. */
static ph_sym4 tensor(const ph_stiffness_map *map, int at)
{
    ph_sym4 c = {.n = map->ns};
    for (int i = 0; i < map->ns; i++)
        for (int j = 0; j < map->ns; j++)
            c.m[i][j] = map->c[(at * map->ns + i) * map->ns + j];
    return c;
}

/* With the weights of a Carson variable: the map of the elastic phases at it, cut cells too.
 * Conditions of the random series are below 1e3, of cut cells the square of it. */
static void test_carson(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    static const ph_kinematics kin[] = {PH_PLANE_STRESS, PH_PLANE_STRAIN,
                                        PH_GENERALISED_STRAIN};
    for (int k = 0; k < 3; k++) {
        maps m;
        new_maps(&m, &seed, kin[k]);
        for (int trial = 0; trial < 4; trial++) {
            ph_error err = PH_ERROR_INIT;
            ph_material at[VISCO_MATERIALS];
            ph_microstructure elastic = *m.micro;
            ph_stiffness_map *want = NULL;
            double s = trial == 3 ? 0.0 : pow(10.0, check_uniform(&seed, -3, 3)), w[40];
            for (int i = 0; i < m.relax->ntimes; i++)
                w[i] = s * m.relax->time[i] / (1.0 + s * m.relax->time[i]);
            elastic.materials = at;
            for (int p = 0; p < VISCO_MATERIALS; p++)
                CHECK_OK(ph_material_at(&m.micro->materials[p], s, &at[p], &err));
            CHECK_OK(ph_i_stiffness_map_new(&elastic, PH_INTERFACE_COMPOSITE, true, NULL,
                                            20, &m.meter, &want, &err));
            CHECK_OK(ph_i_relaxing_map_mixed(m.relax, 1.0, w, &err));
            for (int i = 0; want && i < want->count; i++) {
                ph_sym4 a = tensor(m.map, i), b = tensor(want, i);
                if (i != want->materials) CHECK_ABS(difference(&a, &b), 0.0, 1e-10);
            }
            ph_i_stiffness_map_free(&m.meter, &want);
        }
        free_maps(&m);
    }
    CHECK_END();
}

/* Times sorted, those of two phases that are the same counted once; (S) from 1 to its rest;
 * whole tensors leave the cut cells empty, and the mixed ones come back as they were. */
static void test_tables(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    maps m;
    new_maps(&m, &seed, PH_PLANE_STRAIN);
    double ones[40], none[40] = {0};
    for (int i = 0; i < m.relax->ntimes; i++) {
        ones[i] = 1.0;
        CHECK(i == 0 || m.relax->time[i] > m.relax->time[i - 1]);
    }
    CHECK(m.relax->ntimes == 6); /* 2 + 3 + 2, one of them shared */
    CHECK_REL(ph_i_relaxing_stabilisation(m.relax, 1.0, ones), 1.0, 1e-14);
    CHECK_REL(ph_i_relaxing_stabilisation(m.relax, 1.0, none), 1.0 / 6.0, 1e-14);
    ph_sym4 before = tensor(m.map, ph_i_first_mixture(m.map));
    CHECK(ph_sym4_norm(&before) > 0.0 && m.micro->cuts[0].cell == 0);
    ph_i_relaxing_map_whole(m.relax, 1.0, none);
    ph_sym4 cut = tensor(m.map, m.map->index[0]), whole = tensor(m.map, m.map->index[1]);
    CHECK(ph_sym4_norm(&cut) == 0.0 && ph_sym4_norm(&whole) > 0.0);
    ph_i_relaxing_map_again(m.relax);
    ph_sym4 after = tensor(m.map, m.map->index[0]);
    CHECK(difference(&after, &before) == 0.0);
    free_maps(&m);
    CHECK_END();
}

/* Real phases: the real laminate. Both turned by one angle: the laminate turned by it. */
static void test_complex_laminate(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int trial = 0; trial < check_trials(50); trial++) {
        ph_error err = PH_ERROR_INIT;
        int n = trial % 2 ? 3 : 6;
        ph_sym4 a = random_stiffness(&seed, n), b = random_stiffness(&seed, n), want;
        double f = check_uniform(&seed, 0.05, 0.95), phi = check_uniform(&seed, 0, 1.5),
               x = check_uniform(&seed, 0, 6.28);
        const double normal[3] = {cos(x), sin(x), 0.0};
        ph_complex_tensor out,
            c1 = {ph_sym4_combine(cos(phi), &a, 0.0, &a),
                  ph_sym4_combine(sin(phi), &a, 0.0, &a)},
            c2 = {ph_sym4_combine(cos(phi), &b, 0.0, &b),
                  ph_sym4_combine(sin(phi), &b, 0.0, &b)};
        CHECK_OK(ph_sym4_laminate(&a, &b, f, normal, &want, &err));
        CHECK_OK(ph_i_complex_laminate(&c1, &c2, f, normal, &out, &err));
        ph_sym4 re = ph_sym4_combine(cos(phi), &want, 0.0, &want),
                im = ph_sym4_combine(sin(phi), &want, 0.0, &want);
        CHECK_ABS(difference(&out.re, &re), 0.0, 1e-11 / cos(phi));
        CHECK_ABS(difference(&out.im, &im), 0.0, 1e-11 / (1e-3 + sin(phi)));
    }
    CHECK_END();
}

/* Every cell dissipates, and stores between rest and at once. */
static void test_complex_cells(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    maps m;
    new_maps(&m, &seed, PH_PLANE_STRESS);
    ph_error err = PH_ERROR_INIT;
    ph_complex_map *c = NULL;
    CHECK_OK(ph_i_complex_map_new(m.relax, &c, &err));
    for (int k = -2; k <= 2; k++) {
        CHECK_OK(ph_i_complex_map_set(c, pow(10.0, k), false, &err));
        for (int i = 0; i < m.map->count; i++) {
            double low, high, least, most;
            if (i == m.map->materials) continue;
            ph_i_complex_map_show(c, true);
            ph_sym4 loss = tensor(m.map, i);
            ph_i_complex_map_show(c, false);
            ph_sym4 storage = tensor(m.map, i);
            ph_sym4_eigenvalues(&loss, &low, &high);
            ph_sym4_eigenvalues(&storage, &least, &most);
            CHECK(low >= -1e-12 * most && least > 0.0);
        }
    }
    ph_i_complex_map_free(&c);
    free_maps(&m);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_carson),
        cmocka_unit_test(test_tables),
        cmocka_unit_test(test_complex_laminate),
        cmocka_unit_test(test_complex_cells),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
