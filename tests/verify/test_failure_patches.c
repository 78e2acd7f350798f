/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Patches: equilibrium of their nodes, and failures with them beside those with a solution of
 * the whole box at every event. */
#include "check.h"
#include "effective/patch.h"
#include "failure_case.h"

static const double no_work[6] = {0.0};

/* A sheet with a random displacement; a patch where the scan says so; bonds break in it, a
 * few at a time, and also after the box has been "settled" once. */
typedef struct sheet {
    trial t;
    ph_run run;
    ph_strengths strengths;
    ph_scan scan;
    ph_patch *patch;
    ptrdiff_t cells;
    double *u, *least;
} sheet;

static void open_sheet(sheet *s, uint64_t *seed)
{
    ph_error err = PH_ERROR_INIT;
    memset(s, 0, sizeof *s);
    set_up(&s->t, bar(40, 1.0, 5.0, 0.2), none(), none(), 1.0, 1, 2.0);
    s->t.problem.failure = &s->t.failure;
    s->t.problem.loading = &s->t.loading;
    s->run = (ph_run){.problem = &s->t.problem, .ctx = &one_thread};
    CHECK_OK(ph_i_run_begin(&s->run, &err));
    CHECK_OK(ph_i_run_prepare(&s->run, &err));
    CHECK_OK(ph_i_run_build(&s->run, &err));
    s->cells = s->run.op->layout.cells;
    s->u = calloc((size_t)(2 * s->cells), sizeof *s->u);
    s->least = calloc((size_t)s->cells, sizeof *s->least);
    for (ptrdiff_t i = 0; i < 2 * s->cells; i++)
        s->u[i] = check_uniform(seed, -1, 1);
    for (ptrdiff_t x = 0; x < s->cells; x++)
        s->least[x] = x == 20 * 40 + 9 ? 1.0 : 2.0; /* row 9: where the materials meet */
    s->strengths.broken = s->run.broken;
    s->scan = (ph_scan){.run = &s->run,
                        .strengths = &s->strengths,
                        .macro = no_work,
                        .cells = s->cells,
                        .least = s->least};
    CHECK_OK(ph_i_patch_new(&s->run, &s->patch, &err));
    CHECK_OK(ph_i_patch_make(s->patch, &s->scan, 1.0, s->u, &err));
}

static void close_sheet(sheet *s)
{
    ph_result *no = NULL;
    ph_i_patch_free(&s->patch);
    free(s->u);
    free(s->least);
    ph_result_free(&s->run.result);
    ph_i_run_clear(&s->run);
    tear_down(&s->t, &no);
}

/* Forces A u at the nodes of the patch, bond by bond, beside those when it was made. */
static double worst_force(const sheet *s, const double *before)
{
    double *f = calloc((size_t)(2 * s->cells), sizeof *f), worst = 0.0, most = 0.0;
    ph_i_springs_plain_apply(s->run.op->springs, s->u, f);
    for (int i = 0; i < s->patch->n; i++) {
        ptrdiff_t at = s->patch->at[i];
        worst = fmax(worst, fabs(f[at] - before[at]));
        most = fmax(most, fabs(before[at]));
    }
    free(f);
    return worst / most;
}

/* The nodes of the patch feel the forces that they felt when it was made, whatever they were,
 * without the broken bonds. What holds loose pieces, 1e-10 of the stiffness, pulls at a node
 * that hangs by its last two bonds and has moved a hundred times as far as the others. */
static void equilibrium(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_error err = PH_ERROR_INIT;
    sheet s;
    open_sheet(&s, &seed);
    CHECK(s.patch->made && s.patch->n > 2 * 150);
    double *before = calloc((size_t)(2 * s.cells), sizeof *before);
    ph_i_springs_plain_apply(s.run.op->springs, s.u, before);
    for (int round = 0; round < 6; round++) {
        bool held = false;
        for (int i = 0; i < 3; i++) {
            ptrdiff_t x = 20 * 40 + 9, b = 3 * round + i;
            ph_picked p = {x, b, ph_i_broken_end(s.run.broken, x, b), 0.0};
            CHECK(ph_i_patch_takes(s.patch, p.x, p.y));
            p.pull = ph_i_scan_pull(&s.scan, s.u, p.x, p.b, p.y);
            double k = s.run.family->w[b] * ph_i_bond_modulus(s.run.classes, p.x, p.y);
            ph_i_patch_break(s.patch, s.u, &p, k);
            CHECK_OK(ph_i_break(s.run.broken, p.x, b, &err));
        }
        CHECK_OK(ph_i_patch_relax(s.patch, s.u, &held, &err));
        CHECK(held);
        CHECK_ABS(worst_force(&s, before), 0.0, 1e-7);
        if (round == 2) ph_i_patch_go_on(s.patch, s.u);
    }
    free(before);
    close_sheet(&s);
    CHECK_END();
}

/* A node that loses its last bonds is held by nothing: the patch says so and leaves u. */
static void loose(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_error err = PH_ERROR_INIT;
    sheet s;
    open_sheet(&s, &seed);
    double *u = calloc((size_t)(2 * s.cells), sizeof *u);
    memcpy(u, s.u, sizeof(double) * (size_t)(2 * s.cells));
    for (ptrdiff_t b = 0; b < s.run.family->count; b++) {
        ptrdiff_t x = 20 * 40 + 9;
        ph_picked p = {x, b, ph_i_broken_end(s.run.broken, x, b), 0.0};
        p.pull = ph_i_scan_pull(&s.scan, s.u, p.x, p.b, p.y);
        ph_i_patch_break(s.patch, s.u, &p,
                         s.run.family->w[b] * ph_i_bond_modulus(s.run.classes, p.x, p.y));
    }
    bool held = true;
    CHECK_OK(ph_i_patch_relax(s.patch, s.u, &held, &err));
    CHECK(!held);
    CHECK(memcmp(u, s.u, sizeof(double) * (size_t)(2 * s.cells)) == 0);
    free(u);
    close_sheet(&s);
    CHECK_END();
}

static void notched(trial *t, ptrdiff_t n, bool every_event)
{
    ph_failure_rule rule = energy_of(1e-4, PH_CRITICAL_STRETCH);
    set_up(t, bar(n, 1.0, 1.0, 0.5), rule, rule, 0.03, 4, 2.0);
    t->problem.solver.tolerance = 1e-6;
    t->loading.window = 0.02;
    t->loading.every_event = every_event;
    notch(t, 0.0, 0.5, 0.51);
}

/* The same peak, nearly the same bonds, less work. The crack's roughness is not the same. */
static void beside_every_event(void **state)
{
    (void)state;
    ph_result *res[2] = {NULL};
    for (int i = 0; i < 2; i++) {
        trial t;
        notched(&t, 40, i);
        res[i] = run(&t, 1);
        ph_result *no = NULL;
        tear_down(&t, &no);
    }
    if (res[0] && res[1]) {
        const ph_failure_path *p = res[0]->failure, *q = res[1]->failure;
        CHECK(p->severed && q->severed);
        CHECK_REL(p->first_load, q->first_load, 1e-9);
        CHECK_REL(p->peak_stress, q->peak_stress, 2e-3);
        CHECK_REL(last_event(p)->energy.dissipated, last_event(q)->energy.dissipated,
                  0.05);
        CHECK_REL((double)p->nbonds, (double)q->nbonds, 0.03);
        CHECK(p->imbalance < 1e-3); /* stretches to 1 %, energies to its square */
        CHECK(2 * res[0]->work.iterations < res[1]->work.iterations);
    }
    ph_result_free(&res[0]);
    ph_result_free(&res[1]);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equilibrium),
        cmocka_unit_test(loose),
        cmocka_unit_test(beside_every_event),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
