/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cells that fail; include after check.h. */
#ifndef TESTS_FAILURE_CASE_H
#define TESTS_FAILURE_CASE_H

#include "effective/failure.h"
#include "solve.h"

static const double tight = 1e-9;

static inline ph_failure_rule stretch_of(double value)
{
    return (ph_failure_rule){.given = true,
                             .criterion = PH_CRITICAL_STRETCH,
                             .value = value,
                             .fracture_energy = NAN};
}

static inline ph_failure_rule energy_of(double G, int criterion)
{
    return (ph_failure_rule){
        .given = true, .criterion = criterion, .value = NAN, .fracture_energy = G};
}

static inline ph_failure_rule none(void)
{
    return (ph_failure_rule){.given = true, .criterion = PH_UNBREAKABLE};
}

/* A bar of material 0 with one row of cells of material 1, across axis 2. */
static inline ph_microstructure *bar(ptrdiff_t n, double height, double E1,
                                     double thickness)
{
    ph_material m[2] = {isotropic("matrix", 1.0, 1.0 / 3),
                        isotropic("weak", E1, 1.0 / 3)};
    ph_inclusion inc = blank_inclusion("layer", 1);
    inc.normal = 2;
    inc.from = 0.5 * height - 0.5 * thickness;
    inc.to = 0.5 * height + 0.5 * thickness;
    return shapes_cell(
        box_grid(PH_PLANE_STRESS, n, (ptrdiff_t)((double)n * height), 1, 1, height, 1), 2,
        m, 1, &inc);
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
static inline void set_up(trial *t, ph_microstructure *micro, ph_failure_rule first,
                          ph_failure_rule second, double to, int steps, double horizon)
{
    memset(t, 0, sizeof *t);
    t->micro = micro;
    t->rule[0] = first;
    t->rule[1] = second;
    t->failure.material = t->rule;
    t->to[0] = to;
    t->loading = (ph_loading){
        .strain = {0, 1, 0}, .ntargets = 1, .steps = steps, .every_event = true};
    t->problem = (ph_problem){.micro = micro,
                              .model = {.kind = "bond", .horizon = horizon},
                              .solver = {.tolerance = tight},
                              .loads = 0};
}

static inline ph_result *run(trial *t, int threads)
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

static inline void notch(trial *t, double x0, double x1, double y)
{
    ph_error err = PH_ERROR_INIT;
    double v[2][3] = {{x0, y, 0}, {x1, y, 0}};
    CHECK_OK(ph_cracks_add_line(&t->cracks, 2, (const double(*)[3])v, &err));
}

static inline void tear_down(trial *t, ph_result **res)
{
    ph_result_free(res);
    ph_microstructure_free(&t->micro);
    ph_cracks_free(&t->cracks);
}

static inline const ph_failure_event *last_event(const ph_failure_path *p)
{
    return &p->event[p->nevents - 1];
}

/* External work is stored or dissipated: the mean stress, the energy of the bonds and what
 * the broken ones held are three sums that know nothing of each other, each exact to the
 * square of the residual or to the residual. */
static inline void check_balance(const ph_failure_path *p, double tolerance)
{
    double most = 0.0;
    for (ptrdiff_t i = 0; i < p->nevents; i++) {
        const ph_failure_energy *e = &p->event[i].energy;
        most = fmax(most, e->external);
        CHECK_ABS(e->external - e->stored - e->dissipated, 0.0, tolerance * most);
        if (!isnan(e->fracture)) CHECK(e->fracture <= e->dissipated * (1 + tolerance));
    }
    CHECK(p->imbalance <= tolerance);
}

static inline ph_status status_of(trial *t)
{
    ph_error err = PH_ERROR_INIT;
    ph_result *res = NULL;
    t->loading.to = t->to;
    t->problem.failure = &t->failure;
    t->problem.loading = &t->loading;
    ph_status st = ph_homogenise(&t->problem, &one_thread, &res, &err);
    ph_result_free(&res);
    return st;
}

#endif
