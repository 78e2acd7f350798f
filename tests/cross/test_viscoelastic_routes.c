/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The routes of the catalogue by the public call: curves, moduli, responses, bonds, cycles. */
#include <perihom/viscoelastic.h>

#include "check.h"
#include "visco_case.h"

static double off_rows(int n, int ns, double (*a)[6], double (*b)[6])
{
    double most = 0.0, size = 0.0;
    for (int k = 0; k < n; k++)
        for (int i = 0; i < ns; i++) {
            most = fmax(most, fabs(a[k][i] - b[k][i]));
            size = fmax(size, fabs(b[k][i]));
        }
    return most / size;
}

/* The public call: curves, moduli and responses of all routes that give them, to a tolerance
 * of 1e-4 each. Creep with recovery under a macro stress, by loads of strain (periodic) and
 * of stress (uniform_traction); relaxation with recovery under a macro strain. The response
 * to a stress is the inverse of the tensor: its condition, here below 5, is allowed for. */
static void test_responses(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    static const double times[] = {0.0, 0.05, 0.4, 1.0, 1.5, 2.5, 30.0},
                        omega[] = {0.1, 3.0};
    enum { TIMES = sizeof times / sizeof *times };
    static const char *const constraint[] = {"periodic", "periodic", "uniform_traction"};
    for (int i = 0; i < 3; i++) {
        ph_error err = PH_ERROR_INIT;
        static const ptrdiff_t cells[3] = {4, 4, 1};
        ph_microstructure *micro = viscous_micro(&seed, PH_PLANE_STRESS, cells, true);
        ph_problem problem = {.micro = micro,
                              .model = {.kind = "local"},
                              .constraint = {.kind = constraint[i]}};
        ph_ctx ctx = {.threads = 1};
        ph_viscoelastic *v[3] = {NULL, NULL, NULL};
        ph_history *h = NULL;
        CHECK_OK(ph_history_ramp(3, i, i > 0, 0.8, 0.2, 0.8, 1.0, &h, &err));
        for (int k = 0; k < 3; k++) {
            static const char *const route[] = {"reduced", "stepping", "frequency"};
            ph_relaxation_params p = {route[k], 1e-4,  40,    NULL, 0,
                                      times,    TIMES, omega, 2,    h};
            CHECK_OK(ph_viscoelastic_solve(&problem, &p, &ctx, &v[k], &err));
        }
        if (v[0] && v[1] && v[2]) {
            CHECK(v[1]->ncurve == TIMES && v[2]->ndynamic == 2 && v[1]->steps > 0);
            CHECK(difference(&v[1]->instantaneous, &v[0]->instantaneous) < 1e-4);
            for (int k = 0; k < TIMES; k++)
                CHECK_ABS(
                    difference(&v[1]->curve[k].stiffness, &v[0]->curve[k].stiffness), 0.0,
                    2e-4);
            for (int k = 0; k < 2; k++) {
                CHECK_ABS(
                    difference(&v[2]->dynamic[k].storage, &v[0]->dynamic[k].storage), 0.0,
                    1e-3);
                CHECK_ABS(difference(&v[2]->dynamic[k].loss, &v[0]->dynamic[k].loss), 0.0,
                          1e-2);
            }
            CHECK_ABS(off_rows(TIMES, 3, v[1]->response, v[0]->response), 0.0, 1e-3);
        }
        for (int k = 0; k < 3; k++)
            ph_viscoelastic_free(&v[k]);
        ph_history_free(&h);
        ph_microstructure_free(&micro);
    }
    CHECK_END();
}

/* Two matrices whose first moduli are equal, and two fillers that touch. */
static ph_microstructure *bonded_cell(void)
{
    ph_error err = PH_ERROR_INIT;
    ph_material m[3];
    ph_grid grid;
    ph_microstructure *micro = NULL;
    const ptrdiff_t n[2] = {9, 8};
    const double size[2] = {9.0, 8.0}, nu = 1.0 / 3.0;
    const ph_modulus_term e[2] = {{0.5, 3.0}, {20.0, 2.0}}, g[1] = {{3.0, 4.0}};
    CHECK_OK(ph_material_isotropic("filler", 20.0, nu, &m[0], &err));
    CHECK_OK(ph_material_viscoelastic_young("resin", &(ph_modulus){1.0, 2, e}, nu, &m[1],
                                            &err));
    CHECK_OK(
        ph_material_viscoelastic_young("gel", &(ph_modulus){2.0, 1, g}, nu, &m[2], &err));
    CHECK_OK(ph_grid_init(&grid, PH_PLANE_STRESS, n, size, &err));
    CHECK_OK(ph_microstructure_new(&grid, 3, m, &micro, &err));
    ph_material_clear(&m[1]);
    ph_material_clear(&m[2]);
    micro->owner = calloc(72, sizeof *micro->owner);
    for (int x = 0; x < 72; x++) {
        int i = x / 8, j = x % 8, owner = i < 3 ? 0 : i < 5 ? 1 : i < 7 ? 2 : 0;
        micro->owner[x] = j > 1 && j < 5 ? owner : 0;
        micro->phase[x] = micro->owner[x] ? 0 : j < 6 ? 1 : 2;
    }
    return micro;
}

/* Springs: interphase bonds by kappa, or in series with a spectrum of their own. */
static void test_bonds(void **state)
{
    (void)state;
    static const double times[] = {0.0, 0.3, 5.0, 300.0}, omega[] = {0.1, 3.0};
    for (int i = 0; i < 3; i++) {
        ph_error err = PH_ERROR_INIT;
        ph_microstructure *micro = bonded_cell();
        ph_ctx ctx = {.threads = 1};
        ph_viscoelastic *v[3] = {NULL, NULL, NULL};
        ph_problem problem = {
            .micro = micro,
            .model = {.kind = "bond", .horizon = 2.0, .kappa = i == 0 ? 0.0 : 0.4},
            .constraint = {.kind = i == 2 ? "linear_displacement" : "periodic"},
            .solver = {.tolerance = 1e-7}};
        for (int k = 0; k < 3; k++) {
            static const char *const route[] = {"reduced", "stepping", "frequency"};
            ph_relaxation_params p = {route[k], k ? 2e-4 : 1e-7, 60, NULL, 0, times,
                                      4,        omega,           2,  NULL};
            CHECK_OK(ph_viscoelastic_solve(&problem, &p, &ctx, &v[k], &err));
        }
        for (int k = 0; v[0] && v[1] && k < 4; k++)
            CHECK_ABS(difference(&v[1]->curve[k].stiffness, &v[0]->curve[k].stiffness),
                      0.0, 2e-4);
        for (int k = 0; v[0] && v[2] && k < 2; k++) {
            CHECK_ABS(difference(&v[2]->dynamic[k].storage, &v[0]->dynamic[k].storage),
                      0.0, 1e-5);
            CHECK_ABS(difference(&v[2]->dynamic[k].loss, &v[0]->dynamic[k].loss), 0.0,
                      1e-5);
        }
        for (int k = 0; k < 3; k++)
            ph_viscoelastic_free(&v[k]);
        ph_microstructure_free(&micro);
    }
    CHECK_END();
}

/* Stress of a strain sin(omega t) after ten periods: the fundamental of the last one is the
 * complex modulus. 48 straight lines a period and a step for each: (2 pi/48)^2/8 = 2e-3. */
static void test_cycle(void **state)
{
    (void)state;
    enum { POINTS = 48, CYCLES = 10 };
    ph_error err = PH_ERROR_INIT;
    const double omega = 1.3, pi = 3.14159265358979323846;
    double times[POINTS], c[3] = {0}, s[3] = {0};
    ph_microstructure *micro = bonded_cell();
    ph_problem problem = {.micro = micro, .model = {.kind = "local"}};
    ph_ctx ctx = {.threads = 1};
    ph_history *h = NULL;
    const ph_cycle cycle = {
        .amplitude = 1.0, .omega = omega, .cycles = CYCLES, .points = POINTS};
    ph_viscoelastic *steps = NULL, *modulus = NULL;
    /* what remembers longer than the cycles last would still be on its way */
    for (int t = 0; t < micro->materials[1].relaxation->nterms; t++)
        if (micro->materials[1].relaxation->term[t].time > 10.0)
            micro->materials[1].relaxation->term[t].time = 4.0;
    CHECK_OK(ph_history_cycle(3, 0, false, &cycle, &h, &err));
    for (int k = 0; k < POINTS; k++)
        times[k] = 2.0 * pi / omega * (CYCLES - 1 + (double)k / POINTS);
    ph_relaxation_params follow = {.route = "stepping",
                                   .tolerance = 0.9,
                                   .times = times,
                                   .ntimes = POINTS,
                                   .history = h},
                         solve = {.route = "frequency", .omega = &omega, .nomega = 1};
    CHECK_OK(ph_viscoelastic_solve(&problem, &follow, &ctx, &steps, &err));
    CHECK_OK(ph_viscoelastic_solve(&problem, &solve, &ctx, &modulus, &err));
    for (int k = 0; steps && k < POINTS; k++)
        for (int i = 0; i < 3; i++) {
            c[i] += 2.0 / POINTS * steps->response[k][i] * cos(omega * times[k]);
            s[i] += 2.0 / POINTS * steps->response[k][i] * sin(omega * times[k]);
        }
    for (int i = 0; modulus && i < 2; i++) {
        double scale = modulus->dynamic[0].storage.m[0][0];
        CHECK_ABS(s[i], modulus->dynamic[0].storage.m[i][0], 5e-3 * scale);
        CHECK_ABS(c[i], modulus->dynamic[0].loss.m[i][0], 5e-3 * scale);
    }
    ph_viscoelastic_free(&steps);
    ph_viscoelastic_free(&modulus);
    ph_history_free(&h);
    ph_microstructure_free(&micro);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_responses),
        cmocka_unit_test(test_bonds),
        cmocka_unit_test(test_cycle),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
