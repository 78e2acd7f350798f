/* SPDX-License-Identifier: GPL-3.0-or-later */
/* uniform_traction <= periodic <= linear_displacement for one and the same set of broken bonds,
 * all along a failure; and the peaks of three failures. */
#include "check.h"
#include "failure_case.h"
#include "random_cases.h"

static const char *const constraints[] = {"uniform_traction", "periodic",
                                          "linear_displacement"};

/* Node of the box at a node of the RVE. */
static ptrdiff_t in_box(const ph_run *r, ptrdiff_t node)
{
    const ptrdiff_t *n = r->setting.box.n, *rve = r->result->grid.n;
    ptrdiff_t at[3] = {node / rve[2] / rve[1], node / rve[2] % rve[1], node % rve[2]};
    for (int d = 0; d < 3; d++)
        at[d] += r->setting.first[d];
    return (at[0] * n[1] + at[1]) * n[2] + at[2];
}

/* Stiffness under a constraint with the cracks of the trial and the first `count` bonds of a
 * path broken. */
static ph_sym4 stiffness_with(trial *t, const char *constraint,
                              const ph_failure_path *path, ptrdiff_t count)
{
    ph_error err = PH_ERROR_INIT;
    ph_problem p = t->problem;
    p.failure = &t->failure;
    p.loading = &t->loading;
    t->loading.to = t->to;
    p.cracks = NULL;
    p.constraint.kind = constraint;
    ph_run r = {.problem = &p, .ctx = &one_thread};
    CHECK_OK(ph_i_run_begin(&r, &err));
    CHECK_OK(ph_i_run_prepare(&r, &err));
    CHECK_OK(ph_i_run_build(&r, &err));
    CHECK_OK(ph_i_cracks_cut(&t->cracks, &r.result->grid, r.setting.first, false,
                             r.broken, NULL, &err));
    for (ptrdiff_t i = 0; i < count; i++)
        CHECK_OK(ph_i_break(r.broken, in_box(&r, path->bond[i].node), path->bond[i].bond,
                            &err));
    CHECK_OK(ph_i_broken_settle(r.broken, &err));
    CHECK_OK(ph_i_run_rebuild(&r, &err));
    CHECK_OK(ph_i_run_loads(&r, &err));
    CHECK_OK(ph_i_run_stiffness(&r, &err));
    ph_sym4 c = r.result->stiffness;
    ph_i_run_clear(&r);
    ph_result_free(&r.result);
    return c;
}

/* Each minimises one energy over fields that are fewer than those of the one before, whatever
 * is broken: exact between periodic and linear_displacement, to the solver's 1e-8. Families
 * cut at the faces are other operators there: tests/laws/test_constraints.c, 0.02. The bonds
 * are those of a failure inside the cell, which crosses no face: a face has no bonds. */
static void states(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        trial t;
        ph_failure_rule weak = energy_of(1e-4, PH_CRITICAL_STRETCH);
        set_up(&t, bar(16, 1.0, 3.0, 0.3), weak, weak, 0.03, 4, k ? 2.0 : 3.0);
        t.problem.model.kind = k ? "nosb" : "bond";
        t.problem.constraint.kind = "linear_displacement"; /* breaks inside its frame */
        t.problem.solver.tolerance = 1e-8;
        t.loading.window = 0.3;
        notch(&t, 0.4, 0.6, 0.51);
        ph_result *res = run(&t, 1);
        const ph_failure_path *p = res ? res->failure : NULL;
        CHECK(p && p->nbonds > 40);
        for (int i = 0; p && i <= 3; i++) {
            ph_sym4 c[3];
            for (int j = k ? 0 : 1; j < 3; j++)
                c[j] = stiffness_with(&t, constraints[j], p, i * p->nbonds / 4);
            if (k) CHECK(gap(&c[1], &c[0]) >= -0.02);
            CHECK(gap(&c[2], &c[1]) >= -1e-6);
            CHECK(difference(&c[2], &c[1]) > 1e-3); /* there is something to order */
        }
        tear_down(&t, &res);
    }
    CHECK_END();
}

/* Peaks, no theorem: every constraint has a failure of its own. */
static void peaks(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        double peak[3] = {0};
        for (int j = k ? 0 : 1; j < 3; j++) {
            trial t;
            ph_failure_rule weak = energy_of(1e-4, PH_CRITICAL_STRETCH);
            set_up(&t, bar(16, 1.0, 3.0, 0.3), weak, weak, 0.03, 8, k ? 2.0 : 3.0);
            t.problem.model.kind = k ? "nosb" : "bond";
            t.problem.constraint.kind = constraints[j];
            t.problem.solver.tolerance = 1e-6;
            t.loading.window = 0.1;
            notch(&t, 0.4, 0.6, 0.51);
            ph_result *res = run(&t, 1);
            if (res) peak[j] = res->failure->peak_stress;
            tear_down(&t, &res);
        }
        CHECK(peak[2] > peak[1] && peak[1] > 0.0);
        if (k) CHECK(peak[1] > peak[0] && peak[0] > 0.0);
    }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(states),
        cmocka_unit_test(peaks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
