/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Progressive failure: critical loads and energies that are known, a through crack, paths. */
#include "check.h"
#include "solve.h"

#include "effective/failure.h"

static const double tight = 1e-9;

static ph_failure_rule stretch_of(double value)
{
    return (ph_failure_rule){.given = true,
                             .criterion = PH_CRITICAL_STRETCH,
                             .value = value,
                             .fracture_energy = NAN};
}

static ph_failure_rule energy_of(double G, int criterion)
{
    return (ph_failure_rule){
        .given = true, .criterion = criterion, .value = NAN, .fracture_energy = G};
}

static ph_failure_rule none(void)
{
    return (ph_failure_rule){.given = true, .criterion = PH_UNBREAKABLE};
}

/* A bar of material 0 with one row of cells of material 1, across axis 2. */
static ph_microstructure *bar(ptrdiff_t n, double height, double E1, double thickness)
{
    ph_material m[2] = {isotropic("matrix", 1.0, 1.0 / 3), isotropic("weak", E1, 1.0 / 3)};
    ph_inclusion inc = blank_inclusion("layer", 1);
    inc.normal = 2;
    inc.from = 0.5 * height - 0.5 * thickness;
    inc.to = 0.5 * height + 0.5 * thickness;
    return shapes_cell(box_grid(PH_PLANE_STRESS, n, (ptrdiff_t)((double)n * height), 1, 1,
                                height, 1),
                       2, m, 1, &inc);
}

typedef struct trial {
    ph_microstructure *micro;
    ph_failure_rule rule[2];
    ph_failure failure;
    double to[4];
    ph_loading loading;
    ph_cracks cracks;
    ph_problem problem;
} trial;

/* Pull along axis 2 to `to`. */
static void set_up(trial *t, ph_microstructure *micro, ph_failure_rule first,
                   ph_failure_rule second, double to, int steps, double horizon)
{
    memset(t, 0, sizeof *t);
    t->micro = micro;
    t->rule[0] = first;
    t->rule[1] = second;
    t->failure.material = t->rule;
    t->to[0] = to;
    t->loading = (ph_loading){.strain = {0, 1, 0}, .ntargets = 1, .steps = steps};
    t->problem = (ph_problem){.micro = micro,
                              .model = {.kind = "bond", .horizon = horizon},
                              .solver = {.tolerance = tight},
                              .loads = 0};
}

static ph_result *run(trial *t, int threads)
{
    ph_error err = PH_ERROR_INIT;
    ph_result *res = NULL;
    const ph_ctx ctx = {.threads = threads};
    t->loading.to = t->to;
    t->problem.failure = &t->failure;
    t->problem.loading = &t->loading;
    t->problem.cracks = t->cracks.count ? &t->cracks : NULL;
    CHECK_OK(ph_homogenise(&t->problem, &ctx, &res, &err));
    return res;
}

/* A homogeneous sheet under uniaxial strain: a bond at angle a has the stretch
 * lambda sin^2 a, so that those along axis 2 break first, at lambda = s_c, all together. The
 * stress before is that of the lattice. */
static void one_stretch(void **state)
{
    (void)state;
    trial t;
    ph_microstructure *m = bar(8, 1.0, 1.0, 0.25);
    set_up(&t, m, stretch_of(0.01), stretch_of(0.01), 0.0125, 5, 3.0);
    ph_result *res = run(&t, 1);
    const ph_failure_path *p = res ? res->failure : NULL;
    CHECK(p && p->nevents >= 1);
    if (p && p->nevents >= 1) {
        CHECK_REL(p->first_load, 0.01, 1e-8);
        CHECK_REL(p->event[0].before, 0.01 * res->bond.lattice.C.m[1][1], 1e-8);
        CHECK(p->event[0].broken == 64 * 3); /* of offsets 1, 2 and 3 along axis 2 */
        CHECK_REL(p->step[3].work, 0.0075 * res->bond.lattice.C.m[1][1], 1e-8);
        CHECK(p->step[3].broken == 0 && p->step[5].broken >= 192);
    }
    ph_result_free(&res);
    ph_microstructure_free(&m);
    CHECK_END();
}


static void notch(trial *t, double x0, double x1, double y)
{
    ph_error err = PH_ERROR_INIT;
    double v[2][3] = {{x0, y, 0}, {x1, y, 0}};
    CHECK_OK(ph_cracks_add_line(&t->cracks, 2, (const double(*)[3])v, &err));
}

static void through(void **state)
{
    (void)state;
    int ns[] = {16, 32, 32, 32, 32, 64}; double hs[] = {3, 3, 4, 5, 6, 6}; double win[]={0,0.01,0.1};
    for (int w = 0; w < 3; w++)
    for (int i = 0; i < 5; i++) {
    trial t;
    ph_microstructure *m = bar(ns[i], 1.0, 1.0, 2*hs[i]/ns[i]);
    set_up(&t, m, none(), energy_of(1e-4, PH_CRITICAL_STRETCH), 0.2, 10, hs[i]);
    t.failure.interphase = energy_of(1e-4, PH_CRITICAL_STRETCH);
    t.loading.window=win[w];
    t.problem.solver.tolerance = 1e-7;
    notch(&t, 0, 0.25, 0.5);
    ph_result *res = run(&t, 1);
    const ph_failure_path *p = res ? res->failure : NULL;
    if (p) {
        print_message("n %d m %g win %g events %td bonds %td severed %d peak %g at %g first %g, fracture %g dissipated %g imbalance %g s %g\n",ns[i],hs[i],win[w],
               p->nevents, p->nbonds, p->severed, p->peak_stress, p->peak_load,p->first_load,
               p->event[p->nevents - 1].energy.fracture /0.75e-4,
               p->event[p->nevents - 1].energy.dissipated /.75e-4, p->imbalance, res->seconds);
    }
    ph_result_free(&res);
    ph_microstructure_free(&m);
    ph_cracks_free(&t.cracks);
    }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_stretch),
        cmocka_unit_test(through),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
