/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Automatic fidelity beside the cheapest grid that would have been enough, which only a known
 * answer tells; accuracies in percent on the command line. One JSON object a line: error over
 * accuracy, operations and CPU seconds (least of three) over those of that grid. */
#include <math.h>
#include <perihom_fidelity.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const char *const cells[] = {
    "disk", "2, plane: strain, size: [1, 1]",
    "10",   "shape: disk, centre: [0.34, 0.22], radius: 0.31",
    "box",  "2, plane: stress, size: [1, 1]",
    "30",   "shape: box, centre: [0.34, 0.22], size: [0.5, 0.3], angle: 25",
    "soft", "2, plane: strain, size: [1, 1]",
    "0.05", "shape: ellipse, centre: [0.34, 0.22], semi_axes: [0.38, 0.15], angle: 25",
    "ball", "3, size: [1, 1, 1]",
    "10",   "shape: sphere, centre: [0.34, 0.22, 0.61], radius: 0.36"};
enum { FIELDS = 4, CELLS = sizeof cells / sizeof *cells / FIELDS };
static const ptrdiff_t ladder[] = {4,  6,  8,  10, 12, 16, 20, 24,
                                   32, 40, 48, 64, 80, 96, 128};
enum { GRIDS = sizeof ladder / sizeof *ladder };

static void die(const char *what, const ph_error *err)
{
    fprintf(stderr, "bench: %s: %s\n", what, err->msg);
    exit(1);
}

static double cpu(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static ph_case *cell(int i, double accuracy)
{
    ph_error err = PH_ERROR_INIT;
    char text[800];
    const char *const *x = cells + FIELDS * i;
    snprintf(
        text, sizeof text,
        "perihom: 1\nmaterials: {m: {E: 1, nu: 0.3}, f: {E: %s, nu: 0.25}}\n"
        "microstructure: {dimension: %s, matrix: m, inclusions: [{%s, material: f}]}\n"
        "accuracy: {relative: %g}\n",
        x[2], x[1], x[3], accuracy);
    ph_case *c = NULL;
    if (ph_case_parse(text, strlen(text), x[0], NULL, 0, &c, NULL, &err) != PH_OK)
        die(x[0], &err);
    return c;
}

static void constants_of(const ph_fidelity_plan *p, const ph_result *r, double *x)
{
    for (int k = 0; k < p->nconstants; k++)
        ph_quantity_value(&p->constant[k], r, &x[k], NULL);
}

static double worst(const ph_fidelity_plan *p, const double *x, const double *y)
{
    double most = 0;
    for (int k = 0; k < p->nconstants; k++)
        most = fmax(most, ph_trade_error(&p->constant[k], x[k], y[k]));
    return most;
}

/* One grid with its microstructure, to a tolerance of 0.01, which is what `trade` advises. */
static double on_grid(const ph_case *c, const ph_fidelity_plan *p, ptrdiff_t n, double *x,
                      double *seconds)
{
    ph_error err = PH_ERROR_INIT;
    ph_case one = *c;
    ph_microstructure *m = NULL;
    ph_result *r = NULL;
    const ph_ctx ctx = {.threads = 1};
    double start = cpu();
    for (int a = 0; a < 3; a++)
        one.nodes[a] = c->nodes[a] > 1 ? n : 1;
    one.solver.tolerance = 1e-2;
    if (ph_rve_build(&one, &m, &err) != PH_OK) die("build", &err);
    const ph_problem problem = ph_rve_problem(&one, m, NULL);
    if (ph_homogenise(&problem, &ctx, &r, &err) != PH_OK) die("solve", &err);
    *seconds = cpu() - start;
    double work = ph_trade_work(r);
    constants_of(p, r, x);
    ph_result_free(&r);
    ph_microstructure_free(&m);
    return work;
}

static void compare(int i, double accuracy)
{
    ph_error err = PH_ERROR_INIT;
    const ph_ctx ctx = {.threads = 1};
    ph_case *c = cell(i, accuracy), *exact = cell(i, i == CELLS - 1 ? 1e-3 : 3e-4);
    ph_fidelity *f = NULL, *reference = NULL;
    double x[PH_TRADE_CONSTANTS], y[PH_TRADE_CONSTANTS], z[PH_TRADE_CONSTANTS],
        mine = INFINITY, best = INFINITY, seconds, work = NAN;
    int g = i == CELLS - 1 ? 9 : GRIDS - 1, enough = -1;
    if (ph_fidelity_solve(exact, &ctx, &reference, &err) != PH_OK) die("reference", &err);
    const ph_fidelity_plan *p = &reference->plan;
    constants_of(p, reference->result, x);
    for (; g >= 0; g--) {
        on_grid(c, p, ladder[g], y, &seconds);
        if (worst(p, y, x) > accuracy) break;
        enough = g;
    }
    for (int run = 0; run < 3; run++) {
        ph_fidelity_free(&f);
        double start = cpu();
        if (ph_fidelity_solve(c, &ctx, &f, &err) != PH_OK) die("accuracy", &err);
        mine = fmin(mine, cpu() - start);
        if (enough < 0) continue;
        work = on_grid(c, p, ladder[enough], y, &seconds);
        best = fmin(best, seconds);
    }
    constants_of(p, f->result, z);
    printf(
        "{\"bench\": \"fidelity\", \"cell\": \"%s\", \"accuracy\": %g, \"nodes\": %td, "
        "\"error_over_accuracy\": %.3f, \"enough\": %td, \"operations_ratio\": %.2f, "
        "\"cpu\": %.4g, \"cpu_ratio\": %.2f}\n",
        cells[FIELDS * i], accuracy, f->nodes[0], worst(p, z, x) / accuracy,
        enough < 0 ? 0 : ladder[enough], f->operations / work, mine, mine / best);
    fflush(stdout);
    ph_fidelity_free(&f);
    ph_fidelity_free(&reference);
    ph_case_free(&c);
    ph_case_free(&exact);
}

int main(int argc, char **argv)
{
    for (int a = 1; a < argc; a++)
        for (int i = 0; i < CELLS; i++)
            compare(i, 0.01 * strtod(argv[a], NULL));
    return 0;
}
