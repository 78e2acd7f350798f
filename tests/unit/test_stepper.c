/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Time steps: what is exact for any step, the order of the rest, energy, restart, extremes. */
#include "check.h"
#include "visco_case.h"

static const ph_model_params stress_points = {.points = PH_POINTS_STRESS,
                                              .stabilisation = PH_STABILISE_SUBPOINT,
                                              .stabilisation_value = 0.1};
static const double pi = 3.14159265358979323846;
static const ptrdiff_t small[3] = {4, 3, 1};

static void test_weights(void **state)
{
    (void)state;
    for (int k = -160; k <= 160; k++) {
        double x = pow(10.0, 0.1 * k);
        long double want = -expm1l(-(long double)x) / (long double)x;
        CHECK_REL(ph_i_step_ramp(x), (double)want, 1e-15);
    }
    CHECK(ph_i_step_ramp(0.0) == 1.0 && ph_i_step_decay(0.0) == 1.0);
    CHECK(ph_i_step_ramp(INFINITY) == 0.0 && ph_i_step_decay(INFINITY) == 0.0);
    CHECK_END();
}

/* Stress of a series after a ramp to `strain` at time t1, at time t >= t1. */
static void ramp_stress(const ph_prony *p, const double *strain, double t1, double t,
                        double *stress)
{
    for (int i = 0; i < p->equilibrium.n; i++) {
        stress[i] = 0.0;
        for (int j = 0; j < p->equilibrium.n; j++) {
            double c = p->equilibrium.m[i][j];
            for (int m = 0; m < p->nterms; m++) {
                double tau = p->term[m].time;
                double q = t1 > 0.0 ? -expm1(-t1 / tau) * tau / t1 : 1.0;
                c += p->term[m].stiffness.m[i][j] * q * exp(-(t - t1) / tau);
            }
            stress[i] += c * strain[j];
        }
    }
}

/* Every step is exact where the strain is straight: one phase, jump or ramp, any steps. */
static void test_homogeneous(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int p = 0; p < VISCO_MATERIALS; p++) {
        ph_error err = PH_ERROR_INIT;
        ph_microstructure *micro =
            viscous_micro(&seed, PH_GENERALISED_STRAIN, small, false);
        for (ptrdiff_t x = 0; x < 12; x++)
            micro->phase[x] = (uint16_t)p;
        visco_case c;
        start_case(&c, micro, &stress_points, "periodic", 1e-9);
        double strain[12] = {0}, time[2] = {0.0, 0.7}, output[3] = {0.7, 3.0, 1e4};
        for (int i = 0; i < 6; i++)
            strain[6 + i] = check_uniform(&seed, -1, 1);
        const ph_prony elastic = {micro->materials[p].stiffness, 0, NULL};
        const ph_prony *series = micro->materials[p].relaxation;
        for (int steps = 0; steps < 3; steps++) {
            ph_stepping_params how = {.fixed = steps == 1   ? 0.31
                                               : steps == 2 ? 1e9
                                                            : 0.0,
                                      .most_steps = 100000};
            ph_step_state st[3];
            ph_stepping_report rep;
            ph_load_history h = {2, time, strain, 0};
            CHECK_OK(ph_i_stepping(c.stepper, &h, 3, output, &how, st, &rep, &err));
            CHECK(rep.solves == 0);
            for (int k = 0; k < 3; k++) {
                double want[6], size = 0.0;
                ramp_stress(series ? series : &elastic, strain + 6, 0.7, output[k], want);
                for (int i = 0; i < 6; i++)
                    size = fmax(size, fabs(want[i]));
                for (int i = 0; i < 6; i++)
                    CHECK_ABS(st[k].stress[i], want[i], 1e-10 * size);
            }
        }
        end_case(&c);
        ph_microstructure_free(&micro);
    }
    CHECK_END();
}

/* All phases relax by one function: the strains stand still, and every step is exact. */
static void test_one_relaxation(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_error err = PH_ERROR_INIT;
    ph_microstructure *micro = viscous_micro(&seed, PH_PLANE_STRAIN, small, true);
    for (int p = 0; p < VISCO_MATERIALS; p++) {
        double E = check_uniform(&seed, 1, 30);
        const ph_modulus_term e[2] = {{0.3, 0.5 * E}, {40.0, 0.3 * E}};
        ph_material_clear(&micro->materials[p]);
        CHECK_OK(ph_material_viscoelastic_young("phase", &(ph_modulus){0.2 * E, 2, e},
                                                0.1 * p, &micro->materials[p], &err));
    }
    visco_case c;
    start_case(&c, micro, &stress_points, "periodic", 1e-11);
    double zero = 0.0, unit[3] = {1.0, 0.5, -0.3}, output[3] = {0.0, 1.0, 100.0};
    ph_load_history h = {1, &zero, unit, 0};
    ph_step_state st[3];
    ph_stepping_report rep;
    CHECK_OK(ph_i_stepping(c.stepper, &h, 3, output, &(ph_stepping_params){.fixed = 7.0},
                           st, &rep, &err));
    for (int k = 1; k < 3; k++) {
        double phi = 0.2 + 0.5 * exp(-output[k] / 0.3) + 0.3 * exp(-output[k] / 40.0);
        for (int i = 0; i < 3; i++) /* the solver's tolerance, and its condition */
            CHECK_ABS(st[k].stress[i], phi * st[0].stress[i],
                      1e-9 * fabs(st[0].stress[0]));
    }
    end_case(&c);
    ph_microstructure_free(&micro);
    CHECK_END();
}

/* One relaxation by n equal steps. */
static double relaxed(visco_case *c, int n, double end)
{
    ph_error err = PH_ERROR_INIT;
    double zero = 0.0, unit[6] = {1.0};
    ph_load_history h = {1, &zero, unit, 0};
    ph_step_state st;
    ph_stepping_report rep;
    CHECK_OK(ph_i_stepping(c->stepper, &h, 1, &end,
                           &(ph_stepping_params){.fixed = end / n}, &st, &rep, &err));
    CHECK(rep.steps == n + 1);
    return st.stress[0];
}

/* Twice the steps, a quarter of the error: dt from 1/4 of the shortest time down. */
static void test_second_order(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_microstructure *micro = viscous_micro(&seed, PH_PLANE_STRESS, small, true);
    visco_case c;
    start_case(&c, micro, &stress_points, "periodic", 1e-11);
    double end = 4.0 * c.stepper->relax->time[0];
    double best = relaxed(&c, 256, end);
    double coarse = relaxed(&c, 16, end) - best, fine = relaxed(&c, 32, end) - best;
    /* (1 - 1/256) / (1/4 - 1/256) = 4.05 of a pure second order against 256 steps */
    CHECK_ABS(coarse / fine, 4.05, 0.1);
    end_case(&c);
    ph_microstructure_free(&micro);
    CHECK_END();
}

/* A medium that has relaxed does not care how it came there, nor how often it is asked. */
static void test_steady(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_microstructure *micro = viscous_micro(&seed, PH_PLANE_STRAIN, small, true);
    visco_case c;
    start_case(&c, micro, &stress_points, "periodic", 1e-10);
    double once = relaxed(&c, 1, 1e13), often = relaxed(&c, 40, 1e13);
    CHECK_REL(often, once, 1e-8);
    end_case(&c);
    ph_microstructure_free(&micro);
    CHECK_END();
}

/* Work of the macro stress = stored + dissipated; the dissipation is never negative. The sum
 * by trapezoids is right to the square of the step: 1/200 of a period. */
static void test_energy(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_error err = PH_ERROR_INIT;
    ph_microstructure *micro = viscous_micro(&seed, PH_PLANE_STRAIN, small, true);
    visco_case c;
    enum { N = 400 };
    static double time[N + 1], value[3 * (N + 1)];
    static ph_step_state st[N + 1];
    ph_stepping_report rep;
    start_case(&c, micro, &stress_points, "periodic", 1e-9);
    for (int k = 0; k <= N; k++) {
        time[k] = k / 200.0;
        value[3 * k] = sin(2.0 * pi * time[k]);
        value[3 * k + 2] = 0.5 * sin(4.0 * pi * time[k]);
    }
    ph_load_history h = {N + 1, time, value, 0};
    CHECK_OK(ph_i_stepping(c.stepper, &h, N + 1, time,
                           &(ph_stepping_params){.fixed = 1.0}, st, &rep, &err));
    double work = 0.0, lost = 0.0, most = 0.0;
    for (int k = 1; k <= N; k++) {
        double w = 0.0;
        for (int i = 0; i < 3; i++)
            w += 0.5 * (st[k].stress[i] + st[k - 1].stress[i]) *
                 (st[k].strain[i] - st[k - 1].strain[i]);
        work += w;
        lost +=
            0.5 * (st[k].dissipation + st[k - 1].dissipation) * (time[k] - time[k - 1]);
        most = fmax(most, st[k].energy);
        CHECK(st[k].dissipation >= 0.0 && st[k].energy >= 0.0);
        CHECK(w - (st[k].energy - st[k - 1].energy) >= -1e-4 * most);
    }
    CHECK_REL(work, st[N].energy + lost, 1e-3);
    end_case(&c);
    ph_microstructure_free(&micro);
    CHECK_END();
}

/* Put aside and taken up again: the same bits. */
static void test_restart(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_error err = PH_ERROR_INIT;
    ph_microstructure *micro = viscous_micro(&seed, PH_PLANE_STRESS, small, true);
    visco_case c;
    start_case(&c, micro, &stress_points, "periodic", 1e-6);
    ph_stepper *s = c.stepper;
    ph_step_state first, second;
    double load[3] = {0.1, 0.0, 0.05};
    double *block = malloc(s->size * sizeof *block),
           *after = malloc(s->size * sizeof *after);
    for (int k = 0; k < 8; k++) {
        if (k == 4) ph_i_stepper_save(s, block);
        CHECK_OK(ph_i_stepper_begin(s, 0.1 * (k % 3), &err));
        CHECK_OK(ph_i_stepper_solve(s, load, &err));
        CHECK_OK(ph_i_stepper_accept(s, &err));
    }
    CHECK_OK(ph_i_stepper_state(s, &first, &err));
    ph_i_stepper_save(s, after);
    ph_i_stepper_restore(s, block);
    for (int k = 4; k < 8; k++) {
        CHECK_OK(ph_i_stepper_begin(s, 0.1 * (k % 3), &err));
        CHECK_OK(ph_i_stepper_solve(s, load, &err));
        CHECK_OK(ph_i_stepper_accept(s, &err));
    }
    CHECK_OK(ph_i_stepper_state(s, &second, &err));
    CHECK(memcmp(after, s->block, s->size * sizeof *after) == 0);
    CHECK(memcmp(&first, &second, sizeof first) == 0);
    free(block);
    free(after);
    end_case(&c);
    ph_microstructure_free(&micro);
    CHECK_END();
}

/* Drops of a fluid with a time of 1e-12 in a solid with one of 1e12: 26 decades in growing
 * steps. In the end the drops are holes: the elastic problem with the equilibrium tensors. */
static void test_extremes(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_error err = PH_ERROR_INIT;
    ph_microstructure *micro = viscous_micro(&seed, PH_PLANE_STRAIN, small, false);
    const ph_modulus_term fast[1] = {{1e-12, 3.0}}, slow[2] = {{1e-3, 2.0}, {1e12, 5.0}};
    for (int p = 1; p < 3; p++)
        ph_material_clear(&micro->materials[p]);
    CHECK_OK(ph_material_viscoelastic_young("oil", &(ph_modulus){0.0, 1, fast}, 0.4999,
                                            &micro->materials[1], &err));
    CHECK_OK(ph_material_viscoelastic_young("pitch", &(ph_modulus){1.0, 2, slow}, 0.1,
                                            &micro->materials[2], &err));
    for (ptrdiff_t x = 0; x < 12; x++)
        micro->phase[x] = x == 1 || x == 8 ? 1 : x == 6 ? 0 : 2;
    visco_case c;
    start_case(&c, micro, &stress_points, "periodic", 1e-8);
    double zero = 0.0, unit[3] = {1.0, 0.0, 0.0},
           output[5] = {0.0, 1e-14, 1e-6, 1.0, 1e14};
    ph_load_history h = {1, &zero, unit, 0};
    ph_step_state st[5];
    ph_stepping_report rep;
    CHECK_OK(ph_i_stepping(c.stepper, &h, 5, output,
                           &(ph_stepping_params){.tolerance = 1e-3}, st, &rep, &err));
    for (int k = 1; k < 5; k++) /* relaxes, never rises */
        CHECK(st[k].stress[0] <= st[k - 1].stress[0] * (1.0 + 1e-6));
    CHECK(rep.steps < 1000);
    end_case(&c);

    ph_material at_rest[VISCO_MATERIALS];
    ph_microstructure rest = *micro;
    ph_result *res = NULL;
    rest.materials = at_rest;
    for (int p = 0; p < VISCO_MATERIALS; p++)
        CHECK_OK(ph_material_at(&micro->materials[p], 0.0, &at_rest[p], &err));
    ph_problem problem = {
        .micro = &rest, .model = stress_points, .solver = {.tolerance = 1e-10}};
    CHECK_OK(ph_homogenise(&problem, NULL, &res, &err));
    if (res) /* what is left after 100 times */
        CHECK_REL(st[4].stress[0], res->stiffness.m[0][0], 1e-6);
    ph_result_free(&res);
    ph_microstructure_free(&micro);
    CHECK_END();
}

static void test_refusals(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_microstructure *micro = viscous_micro(&seed, PH_PLANE_STRAIN, small, true);
    visco_case c;
    ph_step_state st[2];
    ph_stepping_report rep;
    start_case(&c, micro, &stress_points, "periodic", 1e-6);
    const double time[2] = {0.0, 1.0}, back[2] = {1.0, 0.0}, value[6] = {1.0},
                 nan[6] = {(double)NAN};
    const ph_load_history none = {0, time, value, 0}, wrong = {2, back, value, 0},
                          bad = {1, time, nan, 0}, good = {1, time, value, 0},
                          negative = {1, (double[]){-1.0}, value, 0};
    const ph_load_history *refused[] = {&none, &wrong, &bad, &negative, NULL};
    for (int i = 0; i < 5; i++) {
        ph_error err = PH_ERROR_INIT;
        CHECK(ph_i_stepping(c.stepper, refused[i], 1, time, NULL, st, &rep, &err) ==
              PH_EINVAL);
        CHECK(err.msg[0]);
    }
    ph_error err = PH_ERROR_INIT;
    CHECK(ph_i_stepping(c.stepper, &good, 2, back, NULL, st, &rep, &err) == PH_EINVAL);
    err = (ph_error)PH_ERROR_INIT;
    CHECK(ph_i_stepping(c.stepper, &good, 1, time,
                        &(ph_stepping_params){.tolerance = (double)NAN}, st, &rep,
                        &err) == PH_EINVAL);
    err = (ph_error)PH_ERROR_INIT;
    CHECK(ph_i_stepping(c.stepper, &good, 2, time, &(ph_stepping_params){.most_steps = 3},
                        st, &rep, &err) == PH_ENOCONV);
    err = (ph_error)PH_ERROR_INIT;
    CHECK(ph_i_stepper_begin(c.stepper, -1.0, &err) == PH_EINVAL);
    end_case(&c);
    ph_microstructure_free(&micro);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_weights),        cmocka_unit_test(test_homogeneous),
        cmocka_unit_test(test_one_relaxation), cmocka_unit_test(test_second_order),
        cmocka_unit_test(test_steady),         cmocka_unit_test(test_energy),
        cmocka_unit_test(test_restart),        cmocka_unit_test(test_extremes),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
