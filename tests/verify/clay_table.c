/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Means over realisations of a case, and table 3.2 of [Ongaro2022] beside the published
 * numbers.
 *
 *   clay_table                          table 3.2, both constraints
 *   clay_table CASE N [key=value ...]   one JSON line for N realisations of a case file
 *
 * OMP_NUM_THREADS threads; the numbers do not depend on it. */
#include "check.h"
#include "clay.h"

static const char clay_file[] = PH_DATA_DIR "/cases/epoxy-clay.yaml";

static int failed(const char *what, const ph_error *err)
{
    fprintf(stderr, "clay_table: %s: %s\n", what, err->msg);
    return 1;
}

static int one_case(const char *path, int n, const char *const *sets, size_t nsets)
{
    ph_error err = PH_ERROR_INIT;
    ph_case *c = NULL;
    clay_sample s;
    if (ph_case_read(path, sets, nsets, &c, NULL, &err)) return failed(path, &err);
    if (clay_sample_of(c, n, &s, &err)) return failed(path, &err);
    printf("{\"E1\": %.7g, \"E1_std\": %.3g, \"E1_error\": %.3g, \"E2\": %.7g, "
           "\"E2_std\": %.3g, \"E2_error\": %.3g, \"realisations\": %d, \"refused\": %d, "
           "\"fillers\": %.4g, \"fraction\": %.6g, \"iterations\": %.4g}\n",
           s.E1.mean, s.E1.std, s.E1.error, s.E2.mean, s.E2.std, s.E2.error, s.asked,
           s.refused, s.fillers.mean, s.fraction.mean, s.iterations);
    ph_case_free(&c);
    return 0;
}

typedef struct row {
    int nodes, realisations;
    double E1, E1_std, E2, E2_std; /* published */
} row;
/* As many as make the standard error less than 0.15 % of the mean. */
static const row table_3_2[] = {
    {10, 10, 3.50, 0.001, 3.50, 0.001},  {15, 400, 3.50, 0.050, 3.50, 0.050},
    {30, 800, 3.33, 0.073, 3.39, 0.155}, {60, 200, 3.33, 0.048, 3.33, 0.025},
    {100, 40, 3.33, 0.015, 3.29, 0.016}, {150, 16, 3.32, 0.011, 3.30, 0.010},
};

static int print_row(const row *r, const char *constraint)
{
    ph_error err = PH_ERROR_INIT;
    ph_case *c = NULL;
    clay_sample s;
    char size[80], nodes[80];
    snprintf(size, sizeof size, "microstructure.size=[%d,%d]", 10 * r->nodes,
             10 * r->nodes);
    snprintf(nodes, sizeof nodes, "microstructure.nodes=[%d,%d]", r->nodes, r->nodes);
    const char *sets[] = {size, nodes, constraint};
    if (ph_case_read(clay_file, sets, 3, &c, NULL, &err)) return failed("case", &err);
    if (clay_sample_of(c, r->realisations, &s, &err)) return failed("sample", &err);
    printf("| %g | %d | %.1f | %.3f ± %.3f (%.4f) | %.3f ± %.3f (%.4f) | %.2f ± %.3f | "
           "%.2f ± %.3f | %+.2f | %+.2f |\n",
           r->nodes / 100.0, s.asked - s.refused, s.fillers.mean, s.E1.mean, s.E1.std,
           s.E1.error, s.E2.mean, s.E2.std, s.E2.error, r->E1, r->E1_std, r->E2,
           r->E2_std, 100 * (s.E1.mean / r->E1 - 1), 100 * (s.E2.mean / r->E2 - 1));
    fflush(stdout);
    ph_case_free(&c);
    return 0;
}

static int thesis_table(void)
{
    static const char *const constraint[] = {
        "constraint={kind: linear_displacement, collar: matrix}",
        "constraint={kind: periodic}"};
    for (int i = 0; i < 2; i++) {
        printf("\n%s\n\n| L, um | realisations | platelets | E11 ± std (error) | "
               "E22 ± std (error) | thesis E11 | thesis E22 | E11, %% | E22, %% |\n"
               "|---|---|---|---|---|---|---|---|---|\n",
               constraint[i]);
        for (size_t k = 0; k < sizeof table_3_2 / sizeof *table_3_2; k++)
            if (print_row(&table_3_2[k], constraint[i])) return 1;
    }
    return 0;
}

int main(int argc, char **argv)
{
    if (argc == 1) return thesis_table();
    if (argc < 3 || atoi(argv[2]) < 1) {
        fprintf(stderr, "usage: clay_table [CASE N [key=value ...]]\n");
        return 2;
    }
    return one_case(argv[1], atoi(argv[2]), (const char *const *)argv + 3,
                    (size_t)argc - 3);
}
