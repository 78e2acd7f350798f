/* SPDX-License-Identifier: GPL-3.0-or-later */
/* FE2: histories that are known, the stepper and the events it is made of, and what it says
 * of itself: bits, restart, rejection, counts. */
#include <perihom/effective.h>
#include <perihom/fe2.h>
#include <perihom/material_point.h>

#include "check.h"
#include "solve.h"
#include "visco_case.h"

static const ph_model_params local = {.kind = "local"};
static const double tight = 1e-11;

static ph_fe2 *new_fe2(const ph_microstructure *micro, const ph_model_params *model,
                       double tolerance, const ph_fe2_params *params)
{
    ph_error err = PH_ERROR_INIT;
    ph_fe2 *f = NULL;
    /* borrowed: the caller's until the end */
    static ph_problem problem;
    problem =
        (ph_problem){.micro = micro, .model = *model, .solver = {.tolerance = tolerance}};
    CHECK_OK(ph_fe2_new(&problem, params, &one_thread, &f, &err));
    assert_non_null(f);
    return f;
}

static ph_fe2_point *new_point(ph_fe2 *f)
{
    ph_error err = PH_ERROR_INIT;
    ph_fe2_point *p = NULL;
    CHECK_OK(ph_fe2_point_new(f, &p, &err));
    assert_non_null(p);
    return p;
}

static ph_fe2_counts counts_of(ph_fe2 *f)
{
    ph_fe2_counts c;
    ph_fe2_counts_get(f, &c);
    return c;
}

/* Try an increment. */
static void try(ph_fe2_point *p, const double *de, double dt, double *stress, double *C)
{
    ph_error err = PH_ERROR_INIT;
    CHECK_OK(ph_fe2_update(p, de, dt, stress, C, &one_thread, &err));
}

static void step(ph_fe2_point *p, const double *de, double dt, double *stress)
{
    ph_error err = PH_ERROR_INIT;
    try(p, de, dt, stress, NULL);
    CHECK_OK(ph_fe2_accept(p, &err));
}

static void random_step(uint64_t *seed, int n, double size, double *de, double *dt)
{
    for (int i = 0; i < n; i++)
        de[i] = size * check_uniform(seed, -1, 1);
    *dt = check_random(seed) < 0.2 ? 0.0 : pow(10.0, check_uniform(seed, -2, 1));
}

static double size_of(int n, const double *x)
{
    double sum = 0.0;
    for (int i = 0; i < n; i++)
        sum += x[i] * x[i];
    return sqrt(sum);
}

static void close_to(int n, const double *got, const double *want, double tolerance,
                     double size)
{
    for (int i = 0; i < n; i++)
        CHECK_ABS(got[i], want[i], tolerance * size);
}

/* ---- elastic ----------------------------------------------------------------------------- */

/* Layers: the stiffness of a laminate; nothing is solved after the RVE was made. */
static void elastic_layers(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_error err = PH_ERROR_INIT;
    const ph_material m[2] = {isotropic("soft", 1, 0.3), isotropic("stiff", 20, 0.2)};
    ph_material both[2] = {m[0], m[1]};
    ph_inclusion inc = blank_inclusion("layer", 1);
    inc.normal = 1, inc.from = 0.25, inc.to = 0.5;
    ph_microstructure *micro =
        shapes_cell(box_grid(PH_GENERALISED_STRAIN, 8, 2, 1, 1, 1, 1), 2, both, 1, &inc);
    ph_fe2 *f = new_fe2(micro, &local, tight, NULL);
    ph_fe2_point *p = new_point(f);
    const ph_fe2_counts before = counts_of(f);
    ph_sym4 want;
    double C[36], exact[36], stress[6], de[6], dt, sum[6] = {0};
    const double normal[3] = {1, 0, 0};
    CHECK_OK(
        ph_sym4_laminate(&m[0].stiffness, &m[1].stiffness, 0.25, normal, &want, &err));
    ph_sym4_to_voigt(&want, true, exact);
    CHECK(ph_fe2_kind_of(f) == PH_FE2_ELASTIC && ph_fe2_components(f) == 6);
    for (int k = 0; k < 5; k++) {
        random_step(&seed, 6, 1e-3, de, &dt);
        try(p, de, dt, stress, C);
        CHECK_OK(ph_fe2_accept(p, &err));
        /* the solver's tolerance, twice its condition */
        close_to(36, C, exact, 1e-9, 20.0);
        for (int i = 0; i < 6; i++)
            sum[i] += de[i];
        for (int i = 0; i < 6; i++) {
            double want_i = 0.0;
            for (int j = 0; j < 6; j++)
                want_i += C[6 * i + j] * sum[j];
            CHECK_ABS(stress[i], want_i, 1e-13 * 20.0);
        }
    }
    const ph_fe2_counts after = counts_of(f);
    CHECK(after.solves == before.solves && after.updates == 5);
    ph_fe2_point_free(&p);
    ph_fe2_free(&f);
    ph_microstructure_free(&micro);
    CHECK_END();
}

/* ---- viscoelastic ------------------------------------------------------------------------ */

/* One phase everywhere: the material point, whatever the increments. */
static void homogeneous_is_the_point(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    const ptrdiff_t n[3] = {4, 3, 1};
    for (int phase = 1; phase < VISCO_MATERIALS; phase++) {
        ph_error err = PH_ERROR_INIT;
        ph_microstructure *micro = viscous_micro(&seed, PH_GENERALISED_STRAIN, n, false);
        for (ptrdiff_t x = 0; x < 12; x++)
            micro->phase[x] = (uint16_t)phase;
        ph_effective e = {.kinematics = PH_GENERALISED_STRAIN,
                          .stiffness = micro->materials[phase].stiffness,
                          .relaxation = micro->materials[phase].relaxation};
        ph_point_material *law = NULL;
        CHECK_OK(ph_point_material_new(&e, &law, &err));
        double memory[64] = {0}, de[6], dt, got[6], want[6], C[36], T[36];
        assert_true(ph_point_state_size(law) <= 64);
        ph_fe2 *f = new_fe2(micro, &local, tight, NULL);
        ph_fe2_point *p = new_point(f);
        for (int k = 0; k < 12; k++) {
            random_step(&seed, 6, 1e-2, de, &dt);
            try(p, de, dt, got, C);
            CHECK_OK(ph_fe2_accept(p, &err));
            CHECK_OK(ph_point_update(law, memory, de, dt, want, T));
            /* round-off of sums over cells and of two orders of the same recursion */
            close_to(6, got, want, 1e-12, 12 * 1e-2 * size_of(36, T));
            close_to(36, C, T, 1e-12, size_of(36, T));
        }
        CHECK(counts_of(f).solves == 0); /* forces of round-off ask for none */
        ph_fe2_point_free(&p);
        ph_fe2_free(&f);
        ph_point_material_free(&law);
        ph_microstructure_free(&micro);
    }
    CHECK_END();
}

/* Layers without Poisson's ratio pulled along themselves: strains are straight in time, so
 * that the mean of the phases' points is exact for any dt. */
static void layers_in_parallel(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_error err = PH_ERROR_INIT;
    const ph_modulus_term fast = {0.3, 4.0}, slow = {20.0, 2.0};
    ph_material m[2];
    CHECK_OK(ph_material_viscoelastic_young("a", &(ph_modulus){1.0, 1, &fast}, 0.0, &m[0],
                                            &err));
    CHECK_OK(ph_material_viscoelastic_young("b", &(ph_modulus){0.5, 1, &slow}, 0.0, &m[1],
                                            &err));
    ph_inclusion inc = blank_inclusion("layer", 1);
    inc.normal = 2, inc.from = 0.0, inc.to = 0.25;
    ph_microstructure *micro =
        shapes_cell(box_grid(PH_PLANE_STRESS, 3, 8, 1, 1, 1, 1), 2, m, 1, &inc);
    ph_fe2 *f = new_fe2(micro, &local, tight, NULL);
    ph_fe2_point *p = new_point(f);
    double h[2] = {0, 0}, eps = 0, de[3] = {0}, dt, stress[3];
    for (int k = 0; k < 15; k++) {
        random_step(&seed, 1, 1e-2, de, &dt);
        step(p, de, dt, stress);
        const double tau[2] = {0.3, 20.0}, E[2] = {4.0, 2.0};
        eps += de[0];
        for (int i = 0; i < 2; i++)
            h[i] = exp(-dt / tau[i]) * h[i] +
                   E[i] * de[0] * (dt > 0 ? -expm1(-dt / tau[i]) * tau[i] / dt : 1.0);
        const double want = 0.75 * (1.0 * eps + h[0]) + 0.25 * (0.5 * eps + h[1]);
        CHECK_ABS(stress[0], want, 1e-11);
        CHECK_ABS(stress[1], 0.0, 1e-11);
    }
    ph_fe2_point_free(&p);
    ph_fe2_free(&f);
    ph_microstructure_free(&micro);
    ph_material_clear(&m[0]);
    ph_material_clear(&m[1]);
    CHECK_END();
}

/* Any cell, cuts and bonds among them: the stepping of a run along the same history. */
static void as_stepping(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    enum { STEPS = 6 };
    const ptrdiff_t n[3] = {5, 4, 1};
    const ph_model_params model[3] = {{.kind = "local"},
                                      {.points = PH_POINTS_STRESS,
                                       .stabilisation = PH_STABILISE_SUBPOINT,
                                       .stabilisation_value = 0.1},
                                      {.points = PH_POINTS_NODES,
                                       .horizon = 1.5,
                                       .stabilisation = PH_STABILISE_SPECTRAL,
                                       .stabilisation_value = 0.01}};
    for (int i = 0; i < 3; i++) {
        ph_error err = PH_ERROR_INIT;
        ph_microstructure *micro = viscous_micro(&seed, PH_PLANE_STRAIN, n, i < 2);
        double time[STEPS + 1] = {0}, value[3 * (STEPS + 1)] = {0}, got[STEPS][3], C[9];
        ph_fe2 *f = new_fe2(micro, &model[i], tight, NULL);
        ph_fe2_point *p = new_point(f);
        for (int k = 1; k <= STEPS; k++) {
            double de[3], dt;
            random_step(&seed, 3, 1e-2, de, &dt);
            dt = k < 3 ? 0.5 : dt + 0.1; /* no jumps; one dt twice */
            try(p, de, dt, got[k - 1], C);
            CHECK_OK(ph_fe2_accept(p, &err));
            time[k] = time[k - 1] + dt;
            for (int a = 0; a < 3; a++)
                value[3 * k + a] =
                    value[3 * k - 3 + a] + de[a] * (a == 2 ? sqrt(0.5) : 1.0);
        }
        visco_case c;
        start_case(&c, micro, &model[i], "periodic", tight);
        ph_load_history h = {STEPS + 1, time, value, 0};
        ph_step_state want[STEPS];
        ph_stepping_report report;
        CHECK_OK(ph_i_stepping(c.stepper, &h, STEPS, time + 1,
                               &(ph_stepping_params){.fixed = 1e9}, want, &report, &err));
        CHECK(report.steps == STEPS + 1); /* and the jump to zero at the beginning */
        for (int k = 0; k < STEPS; k++)
            for (int a = 0; a < 3;
                 a++) /* two solutions of one tolerance, its condition */
                CHECK_ABS(got[k][a], want[k].stress[a] * (a == 2 ? sqrt(0.5) : 1.0),
                          1e-8 * size_of(9, C) * 1e-2);
        end_case(&c);
        ph_fe2_point_free(&p);
        ph_fe2_free(&f);
        ph_microstructure_free(&micro);
    }
    CHECK_END();
}

/* ---- failing ----------------------------------------------------------------------------- */

typedef struct brittle {
    ph_microstructure *micro;
    ph_failure_rule rule[2];
    ph_failure failure;
    ph_problem problem;
} brittle;

static void start_brittle(brittle *b, ptrdiff_t n, double strength, double weibull)
{
    memset(b, 0, sizeof *b);
    b->micro = round_cell(PH_PLANE_STRESS, n, 0.3, isotropic("matrix", 1.0, 1.0 / 3),
                          isotropic("stiff", 10.0, 1.0 / 3));
    b->rule[0] = (ph_failure_rule){.given = true,
                                   .criterion = PH_CRITICAL_STRETCH,
                                   .value = strength,
                                   .fracture_energy = NAN,
                                   .weibull = weibull};
    b->rule[1] = (ph_failure_rule){.given = true, .criterion = PH_UNBREAKABLE};
    b->failure = (ph_failure){.material = b->rule, .seed = 3};
    b->problem = (ph_problem){.micro = b->micro,
                              .model = {.kind = "bond", .horizon = 2.0},
                              .solver = {.tolerance = 1e-9},
                              .failure = &b->failure};
}

static ph_fe2 *brittle_fe2(const brittle *b, int threads)
{
    ph_error err = PH_ERROR_INIT;
    ph_fe2 *f = NULL;
    const ph_ctx ctx = {.threads = threads};
    CHECK_OK(ph_fe2_new(&b->problem, NULL, &ctx, &f, &err));
    assert_non_null(f);
    return f;
}

/* A straight path: the steps of a loading. */
static void as_loading(void **state)
{
    (void)state;
    for (int i = 0; i < 4; i++) { /* springs and states, periodic and with held faces */
        ph_error err = PH_ERROR_INIT;
        enum { STEPS = 5 };
        brittle b;
        start_brittle(&b, 10, 0.01, 0.0);
        if (i % 2) b.problem.model = (ph_model_params){.horizon = 2.0};
        if (i / 2) b.problem.constraint.kind = "linear_displacement";
        const double to = 0.02, de[3] = {0.2 * to / STEPS, to / STEPS, 0.3 * to / STEPS};
        const ph_loading l = {.every_event = true,
                              .strain = {0.2, 1, 0.3},
                              .ntargets = 1,
                              .to = &to,
                              .steps = STEPS};
        ph_problem run = b.problem;
        run.loading = &l;
        ph_result *res = NULL;
        CHECK_OK(ph_homogenise(&run, &one_thread, &res, &err));
        ph_fe2 *f = brittle_fe2(&b, 1);
        ph_fe2_point *p = new_point(f);
        ph_fe2_state s;
        double stress[3], peak = 0.0;
        CHECK(ph_fe2_kind_of(f) == PH_FE2_FAILURE);
        assert_non_null(res);
        for (int k = 1; k <= STEPS; k++) {
            const ph_failure_step *want = &res->failure->step[k];
            step(p, de, 0.0, stress);
            CHECK_OK(ph_fe2_point_state(p, &s, &err));
            CHECK(s.broken_bonds == want->broken && s.events == want->events);
            peak = fmax(peak, size_of(3, stress));
            /* two sums over fields of one tolerance, cut cells of a condition of 1e3 */
            close_to(3, stress, want->stress, 1e-6, peak);
            CHECK_ABS(s.dissipated, want->energy.dissipated,
                      1e-6 * want->energy.external);
        }
        CHECK(s.broken_bonds > 20 && s.events > 3);
        ph_fe2_point_free(&p);
        ph_fe2_free(&f);
        ph_result_free(&res);
        ph_microstructure_free(&b.micro);
    }
    CHECK_END();
}

/* A sheet of one phase: bonds along axis 2 break where eps_22 is their strength, whatever
 * eps_11 was before; then nothing heals, and stress is linear on the way back. */
static void around_a_corner(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    brittle b;
    start_brittle(&b, 8, 0.01, 0.0);
    memset(b.micro->phase, 0, sizeof *b.micro->phase * 64);
    b.micro->ncuts = 0;
    ph_fe2 *f = brittle_fe2(&b, 1);
    ph_fe2_point *p = new_point(f);
    double stress[3], C[9], back[3];
    ph_fe2_state s;
    step(p, (double[3]){0.008, 0, 0}, 1.0, stress);
    step(p, (double[3]){0, 0.01 * (1 - 1e-9), 0}, 1.0, stress);
    CHECK_OK(ph_fe2_point_state(p, &s, &err));
    CHECK(s.broken_bonds == 0 && counts_of(f).solves == 0 && s.time == 2.0);
    step(p, (double[3]){0, 0.01 * 2e-9, 0}, 1.0, stress);
    CHECK_OK(ph_fe2_point_state(p, &s, &err));
    CHECK(s.broken_bonds >= 64 && s.events >= 1 && s.dissipated > 0);
    const long solves = counts_of(f).solves;
    try(p, (double[3]){-0.5 * s.strain[0], -0.5 * s.strain[1], 0}, 1.0, back, C);
    for (int i = 0; i < 3; i++)
        CHECK_ABS(back[i], 0.5 * s.stress[i], 1e-14 * size_of(3, s.stress) + 1e-18);
    CHECK(counts_of(f).solves == solves);
    ph_fe2_point_free(&p);
    ph_fe2_free(&f);
    ph_microstructure_free(&b.micro);
    CHECK_END();
}

/* A bent path of two pieces, each taken at once or in thirds: where the path is cut into
 * increments does not matter, only its events do. */
static void pieces_of_a_path(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    brittle b;
    start_brittle(&b, 10, 0.01, 6.0);
    ph_fe2 *f = brittle_fe2(&b, 1);
    ph_fe2_state s[2];
    const double piece[2][3] = {{0.012, -0.004, 0.0}, {-0.004, 0.012, 0.01}};
    double stress[2][3];
    for (int i = 0; i < 2; i++) {
        ph_fe2_point *p = new_point(f);
        for (int k = 0; k < 2; k++)
            for (int part = 0; part < (i ? 3 : 1); part++) {
                double de[3];
                for (int a = 0; a < 3; a++)
                    de[a] = piece[k][a] / (i ? 3 : 1);
                step(p, de, 0.0, stress[i]);
            }
        CHECK_OK(ph_fe2_point_state(p, &s[i], &err));
        ph_fe2_point_free(&p);
    }
    CHECK(s[0].broken_bonds == s[1].broken_bonds && s[0].events == s[1].events);
    CHECK(s[0].broken_bonds > 10);
    close_to(3, stress[0], stress[1], 1e-6, size_of(3, stress[0]));
    CHECK_ABS(s[0].dissipated, s[1].dissipated, 1e-6 * s[0].dissipated);
    ph_fe2_free(&f);
    ph_microstructure_free(&b.micro);
    CHECK_END();
}

/* ---- what a point promises --------------------------------------------------------------- */

/* An RVE of each kind that has a history. */
typedef struct pair {
    ph_fe2 *f[2];
    ph_microstructure *micro;
    brittle b;
    double size[2]; /* of an increment */
} pair;

static void start_pair(pair *w, uint64_t *seed, const ph_fe2_params *params)
{
    const ptrdiff_t n[3] = {5, 4, 1};
    ph_error err = PH_ERROR_INIT;
    w->micro = viscous_micro(seed, PH_PLANE_STRAIN, n, true);
    w->f[0] = new_fe2(w->micro, &local, 1e-8, params);
    start_brittle(&w->b, 8, 0.01, 0.0);
    CHECK_OK(ph_fe2_new(&w->b.problem, params, &one_thread, &w->f[1], &err));
    w->size[0] = 1.0;
    w->size[1] = 0.012;
}

static void end_pair(pair *w)
{
    ph_fe2_free(&w->f[0]);
    ph_fe2_free(&w->f[1]);
    ph_microstructure_free(&w->micro);
    ph_microstructure_free(&w->b.micro);
}

/* What was tried and rejected leaves no trace, in any order; finite differences of what is
 * tried are the tangent; to the cost of no solve where the RVE is linear in them. */
static void tried_and_rejected(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    pair w;
    start_pair(&w, &seed, NULL);
    for (int i = 0; i < 2; i++) {
        ph_error err = PH_ERROR_INIT;
        ph_fe2_point *p = new_point(w.f[i]), *q = new_point(w.f[i]);
        double de[3], dt, a[3], c[3], C[9], other[3];
        for (int k = 0; k < 4; k++) {
            random_step(&seed, 3, w.size[i], de, &dt);
            try(p, (double[3]){de[1], de[2], de[0]}, 2.0 * dt, other, NULL);
            ph_fe2_reject(p);
            try(p, de, dt, a, C);
            const long solves = counts_of(w.f[i]).solves;
            double worst = 0.0;
            for (int j = 0; j < 3; j++) { /* linear between events: any step is good */
                const double h = (i ? 1e-7 : 1e-2) * w.size[i];
                double more[3] = {de[0], de[1], de[2]}, less[3] = {de[0], de[1], de[2]},
                       up[3], down[3];
                more[j] += h, less[j] -= h;
                try(p, more, dt, up, NULL);
                try(p, less, dt, down, NULL);
                for (int r = 0; r < 3; r++)
                    worst = fmax(worst, fabs((up[r] - down[r]) / (2 * h) - C[3 * r + j]));
            }
            /* failing: its unit fields have a tolerance of 1e-9, and h is 1e-7 */
            CHECK(worst <= (i ? 2e-2 : 1e-10) * size_of(9, C));
            if (i == 0) CHECK(counts_of(w.f[0]).solves == solves);
            try(p, de, dt, c, NULL);
            CHECK(memcmp(a, c, sizeof a) == 0);
            CHECK_OK(ph_fe2_accept(p, &err));
            step(q, de, dt, c); /* without the detours */
            CHECK(memcmp(a, c, sizeof a) == 0);
            try(q, de, 1.0, c, NULL);
            try(q, de, 7.0, a, NULL); /* the same increment, slower, is another */
            CHECK((memcmp(a, c, sizeof a) == 0) == (i == 1));
        }
        ph_fe2_point_free(&p);
        ph_fe2_point_free(&q);
    }
    end_pair(&w);
    CHECK_END();
}

/* The same with a cache of nothing, from a fresh RVE, and from a restart half way. */
static void bits_of_a_history(void **state)
{
    (void)state;
    enum { STEPS = 6 };
    uint64_t seed = check_seed();
    pair w, bare;
    double de[STEPS][3], dt[STEPS];
    uint64_t again = seed;
    start_pair(&w, &seed, NULL);
    start_pair(&bare, &again, &(ph_fe2_params){.cache_bytes = 1, .tangents = 1});
    for (int k = 0; k < STEPS; k++)
        random_step(&seed, 3, 1.0, de[k], &dt[k]);
    for (int i = 0; i < 2; i++) {
        ph_error err = PH_ERROR_INIT;
        ph_fe2_point *p = new_point(w.f[i]), *q = new_point(bare.f[i]),
                     *r = new_point(bare.f[i]);
        double a[3], c[3], inc[3];
        for (int k = 0; k < STEPS; k++) {
            /* Failing: on and on, bonds break before the restart and after it. */
            for (int j = 0; j < 3; j++)
                inc[j] = w.size[i] * (i ? (j == 1 ? 0.35 : 0.1) : de[k][j]);
            step(p, inc, dt[k], a);
            /* leaves nothing */
            try(q, (double[3]){inc[2], inc[0], inc[1]}, dt[k], c, NULL);
            step(q, inc, dt[k], c);
            CHECK(memcmp(a, c, sizeof a) == 0);
            if (k == 2) {
                const size_t bytes = ph_fe2_point_bytes(p);
                char *memory = malloc(bytes);
                assert_non_null(memory);
                CHECK_OK(ph_fe2_point_save(p, memory, bytes, &err));
                CHECK(ph_fe2_point_save(p, memory, bytes - 1, NULL) == PH_EINVAL);
                CHECK(ph_fe2_point_restore(r, memory, bytes - 1, NULL) == PH_EINVAL);
                memory[bytes - 3] ^= 1;
                CHECK(ph_fe2_point_restore(r, memory, bytes, NULL) == PH_EINVAL);
                memory[bytes - 3] ^= 1;
                CHECK_OK(ph_fe2_point_restore(r, memory, bytes, &err));
                free(memory);
            } else if (k > 2) {
                step(r, inc, dt[k], c);
                CHECK(memcmp(a, c, sizeof a) == 0);
            }
        }
        ph_fe2_state s[2];
        CHECK_OK(ph_fe2_point_state(p, &s[0], &err));
        CHECK_OK(ph_fe2_point_state(r, &s[1], &err));
        CHECK(s[0].broken_bonds == s[1].broken_bonds && s[0].events == s[1].events &&
              s[0].dissipated == s[1].dissipated);
        CHECK(i == 0 || s[0].broken_bonds > 20);
        ph_fe2_point_free(&p);
        ph_fe2_point_free(&q);
        ph_fe2_point_free(&r);
        CHECK(counts_of(bare.f[i]).states == 1); /* but the virgin one nothing is left */
    }
    end_pair(&w);
    end_pair(&bare);
    CHECK_END();
}

/* Points of one history cost what one costs; a history that was taken before costs nothing. */
static void known_histories(void **state)
{
    (void)state;
    enum { POINTS = 7, STEPS = 3 };
    uint64_t seed = check_seed();
    pair w;
    start_pair(&w, &seed, NULL);
    for (int i = 0; i < 2; i++) {
        ph_error err = PH_ERROR_INIT;
        ph_fe2 *f = w.f[i];
        long first = 0;
        double de[STEPS][3], dt, stress[3 * POINTS], alone[STEPS][3];
        for (int k = 0; k < STEPS; k++)
            random_step(&seed, 3, w.size[i], de[k], &dt);
        const ph_fe2_counts start = counts_of(f);
        for (int pass = 0; pass < 2; pass++) {
            ph_fe2_point *p[POINTS];
            for (int j = 0; j < POINTS; j++)
                p[j] = new_point(f);
            for (int k = 0; k < STEPS; k++) {
                double many[3 * POINTS];
                for (int j = 0; j < 3 * POINTS; j++)
                    many[j] = de[k][j % 3];
                CHECK_OK(
                    ph_fe2_update_all(p, POINTS, many, 0.5, stress, NULL, NULL, &err));
                for (int j = 0; j < POINTS; j++) {
                    CHECK(memcmp(stress + 3 * j, stress, sizeof *stress * 3) == 0);
                    CHECK_OK(ph_fe2_accept(p[j], &err));
                }
                if (pass == 0) memcpy(alone[k], stress, sizeof alone[k]);
                CHECK(memcmp(alone[k], stress, sizeof alone[k]) == 0);
            }
            if (pass == 0) first = counts_of(f).solves;
            for (int j = 0; j < POINTS; j++)
                ph_fe2_point_free(&p[j]);
        }
        const ph_fe2_counts end = counts_of(f);
        CHECK(end.solves == first && end.updates == start.updates + 2 * STEPS * POINTS);
        CHECK(end.hits == start.hits + STEPS * POINTS);
        /* one dt: n solves of its tangent; nothing to solve at rest, then one a step */
        if (i == 0) CHECK(first - start.solves == 3 + STEPS - 1);
        CHECK(end.bytes >= start.bytes && end.states == STEPS + 1);
    }
    end_pair(&w);
    CHECK_END();
}

/* A step at rest begins with what the one before did, as far as it goes. */
static void warm_start(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    const ph_modulus_term slow = {1.0, 0.9};
    ph_material resin;
    CHECK_OK(ph_material_viscoelastic_young("resin", &(ph_modulus){0.1, 1, &slow}, 0.35,
                                            &resin, &err));
    ph_microstructure *micro =
        round_cell(PH_PLANE_STRAIN, 12, 0.4, resin, isotropic("stiff", 20, 0.2));
    ph_fe2 *f = new_fe2(micro, &local, 1e-8, NULL);
    ph_fe2_point *p = new_point(f), *q = new_point(f);
    long its[3];
    double stress[3];
    const double rest[3] = {0, 0, 0}, ramp[3] = {0.2, 0, 0};
    step(q, rest, 0.05, stress); /* the tangent of this dt */
    step(p, (double[3]){1, 0, 0}, 0.0, stress);
    for (int k = 0; k < 3; k++) {
        const long before = counts_of(f).iterations;
        step(p, ramp, 0.05, stress);
        its[k] = counts_of(f).iterations - before;
    }
    CHECK(its[0] > its[1] && its[1] >= its[2]); /* the first begins from nothing */
    ph_fe2_free(&f);                            /* goes with its last point */
    step(p, rest, 0.05, stress);
    ph_fe2_point_free(&p);
    ph_fe2_point_free(&q);
    ph_microstructure_free(&micro);
    ph_material_clear(&resin);
    CHECK_END();
}

/* ---- threads, cancelling, mistakes ------------------------------------------------------- */

enum { MANY = 8 };

static void many_threads(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    pair w;
    start_pair(&w, &seed, NULL);
    for (int i = 0; i < 2; i++) {
        ph_error err = PH_ERROR_INIT;
        double de[2][3 * MANY], got[2][2][3 * MANY], C[2][9 * MANY], dt;
        ph_fe2_point *p[MANY];
        for (int k = 0; k < 2; k++)
            for (int j = 0; j < MANY; j++)
                random_step(&seed, 3, w.size[i], de[k] + 3 * j, &dt);
        for (int threads = 1; threads <= 4; threads += 3) {
            const ph_ctx ctx = {.threads = threads};
            const int t = threads > 1;
            ph_fe2_counts c;
            for (int j = 0; j < MANY; j++)
                p[j] = new_point(w.f[i]);
            for (int k = 0; k < 2; k++) {
                CHECK_OK(
                    ph_fe2_update_all(p, MANY, de[k], 0.7, got[t][k], C[t], &ctx, &err));
                for (int j = 0; j < MANY; j++)
                    CHECK_OK(ph_fe2_accept(p[j], &err));
            }
            for (int j = 0; j < MANY; j++)
                ph_fe2_point_free(&p[j]);
            c = counts_of(w.f[i]);
            CHECK(c.states > 1);
            if (threads > 1) break;
            ph_fe2_free(&w.f[i]); /* and all that is known */
            if (i == 0) w.f[0] = new_fe2(w.micro, &local, 1e-8, NULL);
            if (i == 1) w.f[1] = brittle_fe2(&w.b, 2);
        }
        CHECK(memcmp(got[0], got[1], sizeof got[0]) == 0);
        CHECK(memcmp(C[0], C[1], sizeof C[0]) == 0);
    }
    end_pair(&w);
    CHECK_END();
}

static bool stop(void *user, const ph_progress *now)
{
    (void)now;
    ++*(int *)user;
    return false;
}

static void cancelled(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    pair w;
    start_pair(&w, &seed, NULL);
    for (int i = 0; i < 2; i++) {
        ph_error err = PH_ERROR_INIT;
        int calls = 0;
        const ph_ctx ctx = {.progress = stop, .user = &calls, .threads = 2};
        ph_fe2_point *p[2] = {new_point(w.f[i]), new_point(w.f[i])};
        const double de[6] = {w.size[i], 2 * w.size[i], 0, 2 * w.size[i], w.size[i], 0};
        double stress[6] = {7, 7, 7, 7, 7, 7};
        ph_fe2_state s;
        CHECK(ph_fe2_update(p[0], de, 1.0, stress, NULL, &ctx, &err) == PH_ECANCELLED);
        CHECK(ph_fe2_update_all(p, 2, de, 1.0, stress, NULL, &ctx, NULL) ==
              PH_ECANCELLED);
        CHECK(calls > 0 && stress[0] == 7 && stress[5] == 7);
        CHECK_OK(ph_fe2_accept(p[0], &err)); /* nothing is tried */
        CHECK_OK(ph_fe2_point_state(p[0], &s, &err));
        CHECK(s.increments == 0 && s.time == 0);
        CHECK_OK(ph_fe2_update_all(p, 2, de, 1.0, stress, NULL, NULL,
                                   &(ph_error)PH_ERROR_INIT));
        CHECK(stress[0] != 7);
        ph_fe2_point_free(&p[0]);
        ph_fe2_point_free(&p[1]);
    }
    end_pair(&w);
    CHECK_END();
}

static void refuse(const ph_problem *p, const ph_fe2_params *params)
{
    ph_error err = PH_ERROR_INIT;
    ph_fe2 *f = NULL;
    CHECK(ph_fe2_new(p, params, NULL, &f, &err) == PH_EINVAL && !f && err.msg[0]);
}

static void mistakes(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    pair w;
    start_pair(&w, &seed, NULL);
    ph_problem relaxing = {.micro = w.micro}, failing = w.b.problem;
    ph_fe2_point *p[2] = {new_point(w.f[0]), new_point(w.f[1])};
    double de[12] = {0}, stress[12];
    char memory[2048];
    relaxing.constraint.kind = "uniform_traction";
    refuse(&relaxing, NULL);
    relaxing.constraint.kind = "voigt";
    refuse(&relaxing, NULL);
    relaxing.constraint.kind = NULL;
    relaxing.failure = &w.b.failure;
    refuse(&relaxing, NULL);
    failing.constraint.kind = "uniform_traction";
    refuse(&failing, NULL);
    refuse(&w.b.problem, &(ph_fe2_params){.window = -1});
    refuse(&w.b.problem, &(ph_fe2_params){.window = NAN});
    refuse(&w.b.problem, &(ph_fe2_params){.tangents = -1});
    CHECK(ph_fe2_update_all(p, 2, de, 1.0, stress, NULL, NULL, NULL) == PH_EINVAL);
    CHECK(ph_fe2_update(p[0], de, -1.0, stress, NULL, NULL, NULL) == PH_EINVAL);
    CHECK(ph_fe2_update(p[0], de, INFINITY, stress, NULL, NULL, NULL) == PH_EINVAL);
    CHECK(ph_fe2_update_all(p, -1, de, 1.0, stress, NULL, NULL, NULL) == PH_EINVAL);
    CHECK(ph_fe2_accept_all(p, 2, NULL, NULL) == PH_EINVAL);
    CHECK(ph_fe2_update_all(p, 0, de, 1.0, stress, NULL, NULL, NULL) == PH_OK);
    de[1] = NAN;
    CHECK(ph_fe2_update(p[0], de, 1.0, stress, NULL, NULL, NULL) == PH_EINVAL);
    de[1] = 1e16;
    CHECK(ph_fe2_update(p[0], de, 1.0, stress, NULL, NULL, NULL) == PH_EINVAL);
    de[1] = -1e6;
    CHECK(ph_fe2_update(p[0], de, 1.0, stress, NULL, NULL, NULL) == PH_EINVAL);
    memset(memory, 0, sizeof memory);
    CHECK(ph_fe2_point_restore(p[0], memory, sizeof memory, NULL) == PH_EINVAL);
    CHECK(ph_fe2_point_restore(p[0], memory, 3, NULL) == PH_EINVAL);
    ph_fe2_point_free(&p[0]);
    ph_fe2_point_free(&p[1]);
    end_pair(&w);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(elastic_layers),     cmocka_unit_test(homogeneous_is_the_point),
        cmocka_unit_test(layers_in_parallel), cmocka_unit_test(as_stepping),
        cmocka_unit_test(as_loading),         cmocka_unit_test(around_a_corner),
        cmocka_unit_test(pieces_of_a_path),   cmocka_unit_test(tried_and_rejected),
        cmocka_unit_test(bits_of_a_history),  cmocka_unit_test(known_histories),
        cmocka_unit_test(warm_start),         cmocka_unit_test(many_threads),
        cmocka_unit_test(cancelled),          cmocka_unit_test(mistakes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
