/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The reduced route against elastic problems of their own at random Carson variables, on
 * random cells of every kinematics, model and constraint: it agrees within the error that it
 * states, which is within the tolerance asked for. */
#include <perihom.h>

#include "check.h"
#include "effective/visco.h"
#include "relaxing.h"

enum { VALUES = 3 };

static void compare(const ph_problem *p, double decades, double tolerance, uint64_t *seed)
{
    ph_error err = PH_ERROR_INIT;
    double s[VALUES];
    for (int i = 0; i < VALUES; i++)
        s[i] = pow(10.0, (decades + 1) * (check_random(seed) - 0.5));
    ph_relaxation_params params = {
        .tolerance = tolerance, .carson = s, .ncarson = VALUES};
    ph_viscoelastic *v = NULL, *full = NULL;
    ph_problem sharp = *p;
    sharp.solver.tolerance = 1e-9;
    CHECK_OK(ph_viscoelastic_solve(p, &params, &one_thread, &v, &err));
    params.route = "carson";
    CHECK_OK(ph_viscoelastic_solve(&sharp, &params, &one_thread, &full, &err));
    if (v) CHECK_OK(ph_prony_validate(v->series, &err));
    if (v) CHECK(v->error <= tolerance && v->error >= 0.0);
    for (int i = 0; v && full && i < VALUES; i++) {
        double low, high;
        CHECK(v->values[i].s == s[i] && full->values[i].s == s[i]);
        ph_sym4 d = ph_sym4_combine(1.0, &v->values[i].stiffness, -1.0,
                                    &full->values[i].stiffness);
        ph_i_visco_relative(&d, &v->values[i].stiffness, &low, &high);
        /* below by what the elastic solution itself is off: the average of stress, 1e-9
         * times the contrast */
        CHECK(high <= v->error + 1e-7);
        CHECK(low >= -1e-7);
    }
    if (v && full) { /* the elastic report is that at once, of both */
        const ph_result *report = full->elastic;
        CHECK(off(&full->instantaneous, &report->stiffness) == 0.0);
        CHECK(off(&v->instantaneous, &report->stiffness) < 2.0 * tolerance);
        CHECK(off(&v->instantaneous, &v->elastic->stiffness) == 0.0);
        CHECK(!report->unchecked && report->hill_mandel < 1e-6);
        CHECK(report->residual[0] <= 1e-9);
        CHECK(v->elastic->unchecked && isnan(v->elastic->residual[0]));
        CHECK(isnan(v->elastic->hill_mandel) && isnan(v->elastic->asymmetry));
    }
    ph_viscoelastic_free(&v);
    ph_viscoelastic_free(&full);
}

static void routes_agree(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    static const char *const model[] = {"nosb", "nosb", "local", "bond"};
    static const char *const constraint[] = {"periodic", "linear_displacement",
                                             "uniform_traction"};
    for (int k = 0; k < 4; k++)
        for (int m = 0; m < 4; m++)
            for (int c = 0; c < 3; c++) {
                /* one constraint a model, unless there is time for all */
                if ((k == 0 || check_trials(1) == 1) && c != (k + m) % 3) continue;
                int kinds[3], before = check_failures;
                bool bond = m == 3;
                if (bond && (c == 2 || k == 1)) continue; /* refused */
                for (int i = 0; i < 3; i++)
                    kinds[i] = (int)((bond ? 2 : 4) * check_random(&seed));
                double decades = check_uniform(&seed, 0, 6),
                       contrast = pow(10.0, check_uniform(&seed, -1, 1));
                ph_kinematics kin = (ph_kinematics)k;
                ph_microstructure *micro =
                    blocks_cell(&seed, kin, kin == PH_SPACE ? (bond ? 6 : 5) : 9, kinds,
                                contrast, decades, 3, bond);
                ph_problem p = {.micro = micro};
                p.model.kind = model[m];
                if (m == 1) p.model.points = PH_POINTS_NODES;
                if (bond) p.model.horizon = 2.0;
                p.constraint.kind = constraint[c];
                compare(&p, decades, 1e-4, &seed);
                if (check_failures > before)
                    print_error("  ... kinematics %d, %s (%d), %s, kinds %d %d %d\n", k,
                                model[m], m, constraint[c], kinds[0], kinds[1], kinds[2]);
                ph_microstructure_free(&micro);
            }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(routes_agree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
