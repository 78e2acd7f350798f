/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The error estimate of route `reduced` against full solves at random s, by hand:
 * ninja tests/relaxation_study && build/tests/relaxation_study [trials] [seed] */
#include <perihom.h>

#include "check.h"
#include "effective/visco.h"
#include "relaxing.h"

int main(int argc, char **argv)
{
    int trials = argc > 1 ? atoi(argv[1]) : 20, bad = 0, total = 0, failed = 0;
    uint64_t seed = argc > 2 ? (uint64_t)atoll(argv[2]) : 1;
    for (int t = 0; t < trials; t++) {
        ph_error err = PH_ERROR_INIT;
        ph_kinematics kin = (ph_kinematics)(4 * check_random(&seed));
        int kinds[3];
        for (int p = 0; p < 3; p++)
            kinds[p] = (int)(4 * check_random(&seed));
        bool bond = check_random(&seed) < 0.15 && kin != PH_GENERALISED_STRAIN;
        for (int p = 0; p < 3 && bond; p++)
            kinds[p] %= 2;
        double contrast = pow(10.0, check_uniform(&seed, -2, 2)),
               decades = check_uniform(&seed, 0, 8);
        ph_microstructure *micro =
            blocks_cell(&seed, kin, kin == PH_SPACE ? (bond ? 8 : 6) : 16, kinds,
                        contrast, decades, 4, bond);
        ph_problem problem = {.micro = micro};
        static const char *model[] = {"nosb", "local"};
        problem.model.kind = model[(int)(2 * check_random(&seed))];
        if (bond) problem.model.kind = "bond";
        if (check_random(&seed) < 0.3) problem.model.points = PH_POINTS_NODES;
        if (strcmp(problem.model.kind, "nosb") != 0)
            problem.model.points = PH_POINTS_AUTO;
        problem.interface =
            check_random(&seed) < 0.7 ? PH_INTERFACE_COMPOSITE : PH_INTERFACE_NODE_CENTRE;
        problem.model.stabilisation = strcmp(problem.model.kind, "nosb") != 0
                                          ? PH_STABILISE_AUTO
                                      : check_random(&seed) < 0.5 ? PH_STABILISE_SUBPOINT
                                                                  : PH_STABILISE_AUTO;
        static const char *constraint[] = {"periodic", "linear_displacement",
                                           "uniform_traction"};
        double dice = check_random(&seed);
        problem.constraint.kind = constraint[dice < 0.6 ? 0 : dice < 0.8 || bond ? 1 : 2];
        problem.solver.tolerance = 1e-9;
        ph_relaxation_params params = {.tolerance =
                                           pow(10.0, check_uniform(&seed, -6, -2))};
        ph_viscoelastic *v = NULL;
        ph_visco full = {0};
        ph_viscoelastic sink = {0};
        if (argc > 3 && atoi(argv[3]) != t) {
            for (int i = 0; i < 4; i++)
                check_random(&seed), check_random(&seed);
            ph_microstructure_free(&micro);
            continue;
        }
        if (ph_viscoelastic_solve(&problem, &params, &one_thread, &v, &err) != PH_OK) {
            for (int i = 0; i < 4; i++)
                check_random(&seed), check_random(&seed);
            printf("trial %d kin %d %s %s: %s\n", t, kin, problem.model.kind,
                   problem.constraint.kind, err.msg);
            failed++;
            ph_microstructure_free(&micro);
            continue;
        }
        /* the same discretisation with an empty basis: a visit is a full solve */
        for (int i = 0; getenv("SAY") && i < v->npoints; i++)
            printf("   point %g error %.2e its %d added %d\n", v->points[i].s,
                   v->points[i].error, v->points[i].iterations, v->points[i].added);
        ph_relaxation_params tight = {.tolerance = 1e-9};
        if (ph_i_visco_begin(&full, &problem, &tight, &one_thread, &sink, &err) != PH_OK)
            printf("begin: %s\n", err.msg);
        double worst = 0.0;
        for (int i = 0; i < 4; i++) {
            double s = pow(10.0, decades * (check_random(&seed) - 0.5) +
                                     check_uniform(&seed, -1, 1));
            if (i == 0) s = INFINITY;
            double error, left, low, high;
            int added;
            ph_sym4 C;
            if (ph_i_visco_visit(&full, s, 0.01, 0.0, &error, &left, &added, &err) !=
                PH_OK) {
                printf("visit: %s\n", err.msg);
                break;
            }
            ph_i_reduced_at(&full.model, s, &C, NULL, &err);
            ph_sym4 mine = ph_prony_carson(v->series, s),
                    d = ph_sym4_combine(1.0, &mine, -1.0, &C);
            ph_i_visco_relative(&d, &mine, &low, &high);
            worst = fmax(worst, fmax(fabs(low), fabs(high)));
            if (getenv("SAY"))
                printf(
                    "   s %g: visit %.2e left %.2e added %d, model - full %.2e .. %.2e\n",
                    s, error, left, added, low, high);
        }
        total++;
        bad += worst > v->error + 1e-12; /* digits of arithmetic */
        printf("%3d kin %d %-5s %s %-19s %s kinds %d%d%d contrast %-8.2g decades %.1f "
               "tol %.1e "
               "est %.1e true %.1e %s points %d basis %d its %ld app %ld terms %d q %d\n",
               t, kin, problem.model.kind,
               problem.model.points == PH_POINTS_NODES ? "nodes " : "stress",
               problem.constraint.kind,
               problem.interface == PH_INTERFACE_COMPOSITE ? "comp" : "node", kinds[0],
               kinds[1], kinds[2], contrast, decades, params.tolerance, v->error, worst,
               worst > v->error + 1e-12 ? "BAD" : "", v->npoints, v->basis, v->iterations,
               v->applications, v->series->nterms, v->functions);
        ph_viscoelastic_free(&v);
        ph_i_visco_clear(&full);
        free(sink.points);
        ph_microstructure_free(&micro);
    }
    printf("estimate below the error in %d of %d, failed %d\n", bad, total, failed);
    return 0;
}
