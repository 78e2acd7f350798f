/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Factors that follow bonds as they break: against factors made anew, and against fft_cg. */
#include "check.h"
#include "failure_case.h"
#include "solve/factor.h"

/* ---- the factor -------------------------------------------------------------------------- */

/* Springs between all pairs of n points of a line that are not further than `reach`, and one
 * to the ground: A = sum k v v^T, lower triangle by columns. */
enum { POINTS = 30, REACH = 4 };

static double stiffness[POINTS][POINTS];

static ph_status factor_of(ph_factor **out, bool changes)
{
    ph_error err = PH_ERROR_INIT;
    int start[POINTS + 1], row[POINTS * (REACH + 1)], used = 0;
    double value[POINTS * (REACH + 1)];
    for (int j = 0; j < POINTS; j++) {
        double sum = j == 0 ? 1.0 : 0.0;
        for (int i = 0; i < POINTS; i++)
            sum += stiffness[i][j];
        start[j] = used;
        row[used] = j, value[used++] = sum;
        for (int i = j + 1; i < POINTS && i <= j + REACH; i++)
            row[used] = i, value[used++] = -stiffness[i][j];
    }
    start[POINTS] = used;
    const ph_csc m = {POINTS, start, row, value};
    return ph_i_factor_new(&m, changes, out, &err);
}

static void take_spring(ph_factor *f, int i, int j)
{
    ph_error err = PH_ERROR_INIT;
    double root = sqrt(stiffness[i][j]), value[2] = {root, -root};
    int start[2] = {0, 2}, row[2] = {j, i};
    const ph_csc column = {POINTS, start, row, value};
    CHECK_OK(ph_i_factor_take(f, &column, 1, &err));
    stiffness[i][j] = stiffness[j][i] = 0.0;
}

/* Springs taken one after the other: the factor of what is left, with no entry that the first
 * one had not, for a share of its operations; when the last spring of a point goes, the
 * condition says so. */
static void factors(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    ph_factor *f = NULL, *fresh = NULL;
    double b[POINTS], x[POINTS], y[POINTS], taken;
    for (int i = 0; i < POINTS; i++) {
        b[i] = check_uniform(&seed, -1, 1);
        for (int j = 0; j < i; j++)
            stiffness[i][j] = stiffness[j][i] =
                i - j <= REACH ? check_uniform(&seed, 0.5, 2.0) : 0.0;
    }
    CHECK(factor_of(&f, true) == PH_OK);
    const size_t bytes = f ? ph_i_factor_bytes(f) : 0;
    for (int k = 0; f && k < 25; k++) {
        int j = (int)(check_random(&seed) * (POINTS - 5)), i = j + 2 + k % 3;
        if (stiffness[i][j] == 0.0) continue;
        take_spring(f, i, j);
        CHECK(factor_of(&fresh, k % 2) == PH_OK);
        CHECK_OK(ph_i_factor_solve(f, b, x, &err));
        CHECK_OK(ph_i_factor_solve(fresh, b, y, &err));
        for (int p = 0; p < POINTS; p++) /* the condition is some 1e3 */
            CHECK_ABS(x[p], y[p], 1e-11 * (1 + fabs(y[p])));
        CHECK(ph_i_factor_condition(f) > 1e-6);
        ph_i_factor_free(&fresh);
    }
    CHECK(f && ph_i_factor_bytes(f) == bytes);
    if (f) CHECK(ph_i_factor_flops(f, &taken) > 0.0 && taken > 0.0);
    for (int j = 0; f && j < POINTS - 1; j++) /* the last point comes off */
        if (stiffness[POINTS - 1][j] > 0.0) take_spring(f, POINTS - 1, j);
    if (f) CHECK(ph_i_factor_condition(f) < 1e-13);
    CHECK(factor_of(&fresh, true) == PH_ESINGULAR ||
          (fresh && ph_i_factor_condition(fresh) < 1e-13));
    ph_i_factor_free(&fresh);
    ph_i_factor_free(&f);
    CHECK_END();
}

/* ---- bonds that break at random ---------------------------------------------------------- */

typedef struct setting {
    ph_kinematics kin;
    ptrdiff_t n[3];
    const char *model, *constraint;
} setting;

static const setting settings[] = {
    {PH_PLANE_STRESS, {11, 10, 1}, "bond", "periodic"},
    {PH_PLANE_STRAIN, {12, 13, 1}, "bond", "linear_displacement"},
    {PH_SPACE, {6, 5, 6}, "bond", "periodic"},
    {PH_PLANE_STRESS, {9, 10, 1}, "nosb", "periodic"},
};
enum { SETTINGS = sizeof settings / sizeof *settings };

typedef struct pair {
    ph_problem problem;
    ph_failure failure;
    ph_failure_rule rule[2];
    ph_loading loading;
    ph_run run[2]; /* direct, fft_cg */
} pair;

static void begin(pair *p, const setting *s, const ph_microstructure *micro)
{
    ph_error err = PH_ERROR_INIT;
    static const double to[1] = {1.0};
    *p = (pair){.loading = {.strain = {0, 1}, .ntargets = 1, .to = to, .steps = 1}};
    p->rule[0] = p->rule[1] = stretch_of(1.0);
    p->failure.material = p->rule;
    p->problem = (ph_problem){.micro = micro,
                              .model = {.kind = s->model, .horizon = 2.0},
                              .constraint = {.kind = s->constraint},
                              .solver = {.kind = "direct", .tolerance = 1e-10},
                              .failure = &p->failure,
                              .loading = &p->loading};
    for (int k = 0; k < 2; k++) {
        p->run[k] = (ph_run){.problem = &p->problem, .ctx = &one_thread};
        CHECK_OK(ph_i_run_begin(&p->run[k], &err));
        CHECK_OK(ph_i_run_prepare(&p->run[k], &err));
        p->problem.solver.kind = k == 0 ? "direct" : "fft_cg";
        CHECK_OK(ph_i_run_build(&p->run[k], &err));
    }
}

static void break_both(pair *p, ptrdiff_t node, ptrdiff_t bond)
{
    ph_error err = PH_ERROR_INIT;
    for (int k = 0; k < 2; k++) {
        CHECK_OK(ph_i_break(p->run[k].broken, node, bond, &err));
        CHECK_OK(ph_i_broken_settle(p->run[k].broken, &err));
    }
}

/* Energies of a macro strain: not moved by pieces that float. */
static void compare(pair *p)
{
    ph_error err = PH_ERROR_INIT;
    double energy[2] = {0};
    for (int k = 0; k < 2; k++) {
        ph_run *r = &p->run[k];
        double macro[6] = {0.3, 1.0, -0.2, 0.1, 0.2, 0.4}, stress[6], strain[6];
        ph_cg_report report;
        ph_cell_energy e;
        CHECK_OK(ph_i_run_rebuild(r, &err));
        CHECK_OK(ph_i_run_solve(r, macro, false, NULL, 0.0, &report, &err));
        CHECK(report.residual <= 1e-10);
        CHECK_OK(ph_i_operator_sums(r->op, r->u, macro, r->setting.region, stress, strain,
                                    &e, &err));
        energy[k] = (e.mean + e.modes + e.stabilisation) / (double)r->setting.averaged;
    }
    CHECK_ABS(energy[0], energy[1], 1e-9); /* of 1: the residual, squared but for (S) */
}

static ph_microstructure *random_halves(const setting *s, uint64_t *seed)
{
    ph_kinematics kin = s->kin;
    ph_material m[2] = {isotropic("soft", 1.0, ph_bond_poisson(kin)),
                        isotropic("stiff", 5.0, ph_bond_poisson(kin))};
    return voxel_cell(box_grid(kin, s->n[0], s->n[1], s->n[2], (double)s->n[0],
                               (double)s->n[1], (double)s->n[2]),
                      2, m, seed);
}

/* Bonds at random, some at a time; then all bonds of one node, and of a piece of 2 x 2: both
 * come off, and the next bonds break in what is left. */
static void at_random(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int i = 0; i < SETTINGS; i++) {
        const setting *s = &settings[i];
        ph_microstructure *micro = random_halves(s, &seed);
        pair p;
        begin(&p, s, micro);
        const ph_broken *br = p.run[0].broken;
        const ptrdiff_t cells = p.run[0].op->layout.cells, count = br->family->count;
        for (int k = 0; k < 12; k++) {
            for (int b = 0; b <= k % 4; b++)
                break_both(&p, (ptrdiff_t)(check_random(&seed) * (double)cells),
                           (ptrdiff_t)(check_random(&seed) * (double)count));
            compare(&p);
            /* one factor has served all of them, without a solution that failed */
            if (s->model[0] == 'b') CHECK(ph_i_direct_factors(p.run[0].state) == 1);
        }
        const ptrdiff_t row = s->n[2],
                        middle = (s->n[0] / 2 * s->n[1] + s->n[1] / 2) * row;
        for (ptrdiff_t b = 0; b < count; b++)
            break_both(&p, middle, b);
        compare(&p);
        const ptrdiff_t piece[4] = {middle + 2 * row, middle + 3 * row,
                                    middle + (s->n[1] + 2) * row,
                                    middle + (s->n[1] + 3) * row};
        for (int x = 0; x < 4; x++)
            for (ptrdiff_t b = 0; b < count; b++) {
                ptrdiff_t y = ph_i_broken_end(br, piece[x], b);
                bool inside = false;
                for (int o = 0; o < 4; o++)
                    inside = inside || y == piece[o];
                if (!inside) break_both(&p, piece[x], b);
            }
        compare(&p);
        for (int k = 0; k < 4; k++) {
            break_both(&p, (ptrdiff_t)(check_random(&seed) * (double)cells), k);
            compare(&p);
        }
        for (int k = 0; k < 2; k++) {
            ph_i_run_clear(&p.run[k]);
            ph_result_free(&p.run[k].result);
        }
        ph_microstructure_free(&micro);
    }
    CHECK_END();
}

/* ---- a failure --------------------------------------------------------------------------- */

/* The same bonds in the same events, the same loads and energies, to the end. */
static void whole_failure(void **state)
{
    (void)state;
    static const struct {
        const char *model, *constraint;
        unsigned stress_free;
    } of[] = {{"bond", "periodic", 0},
              {"bond", "periodic", 5},
              {"bond", "linear_displacement", 1},
              {"nosb", "periodic", 0}};
    for (int i = 0; i < 4; i++) {
        ph_result *res[2] = {NULL};
        bool bond = of[i].model[0] == 'b';
        for (int k = 0; k < 2; k++) {
            trial t;
            ph_failure_rule rule = energy_of(1e-4, PH_CRITICAL_STRETCH);
            rule.weibull = 12.0;
            set_up(&t, bar(12, 1.0, 3.0, 0.3), rule, rule, 0.03, 4, bond ? 3.0 : 2.0);
            t.problem.model.kind = of[i].model;
            t.problem.constraint.kind = of[i].constraint;
            t.problem.solver.kind = k ? "fft_cg" : "direct";
            t.loading.stress_free = of[i].stress_free;
            t.loading.window = bond ? 0.05 : 0.2;
            notch(&t, 0.2, 0.5, 0.51);
            res[k] = run(&t, 1);
            ph_result *no = NULL;
            tear_down(&t, &no);
        }
        const ph_failure_path *a = res[0] ? res[0]->failure : NULL,
                              *b = res[1] ? res[1]->failure : NULL;
        CHECK(a && b && a->nbonds == b->nbonds && a->nevents == b->nevents);
        for (ptrdiff_t e = 0; a && b && e < a->nevents && e < b->nevents; e++) {
            CHECK_REL(a->event[e].load, b->event[e].load, 1e-6);
            CHECK_ABS(a->event[e].energy.dissipated, b->event[e].energy.dissipated,
                      1e-6 * a->toughness);
        }
        for (ptrdiff_t k = 0; a && b && k < a->nbonds && k < b->nbonds; k++)
            CHECK(a->bond[k].node == b->bond[k].node &&
                  a->bond[k].bond == b->bond[k].bond);
        ph_result_free(&res[0]);
        ph_result_free(&res[1]);
    }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(factors),
        cmocka_unit_test(at_random),
        cmocka_unit_test(whole_failure),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
