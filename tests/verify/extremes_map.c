/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes docs/extremes.md and its heat maps: every cell of contrast, Poisson's ratio, horizon,
 * grid, size and fraction solved, flagged or refused, with iterations and true error.
 * usage: extremes_map DOCS (`ninja -C build extremes`) */
#include <perihom/plot.h>

#include "extremes.h"

enum { MOST = 16 };

/* An axis of a map: its values and their names. */
typedef struct axis {
    const char *label;
    int n;
    double value[MOST];
    void (*set)(extreme *x, double value);
    char name[MOST][16];
} axis;

static void set_contrast(extreme *x, double v)
{
    x->contrast = v;
}
static void set_nu(extreme *x, double v)
{
    x->nu_matrix = x->nu_disk = v;
}
static void set_nu_matrix(extreme *x, double v)
{
    x->nu_matrix = v;
}
static void set_nu_disk(extreme *x, double v)
{
    x->nu_disk = v;
}
static void set_horizon(extreme *x, double v)
{
    x->horizon = v;
}
static void set_nodes(extreme *x, double v)
{
    x->nodes = (ptrdiff_t)v;
}
static void set_fraction(extreme *x, double v)
{
    x->fraction = v;
}

static axis contrasts = {"contrast (0: a hole)",
                         11,
                         {0, 1e-6, 1e-4, 1e-2, 0.1, 2, 10, 100, 1e3, 1e4, 1e6},
                         set_contrast,
                         {""}};
static axis ratios = {"Poisson's ratio of both phases",
                      8,
                      {-0.9, -0.5, 0, 0.3, 0.45, 0.49, 0.499, 0.4999},
                      set_nu,
                      {""}};
static axis of_matrix = {"Poisson's ratio of the matrix",
                         8,
                         {-0.9, -0.5, 0, 0.3, 0.45, 0.49, 0.499, 0.4999},
                         set_nu_matrix,
                         {""}};
static axis of_disk = {"Poisson's ratio of the disk",
                       8,
                       {-0.9, -0.5, 0, 0.3, 0.45, 0.49, 0.499, 0.4999},
                       set_nu_disk,
                       {""}};
static axis horizons = {"horizon of nodes in spacings (0: stress points)",
                        8,
                        {0, 1, 1.5, 2, 3, 4, 8, 16},
                        set_horizon,
                        {""}};
static axis grids = {
    "nodes along an edge", 11, {1, 2, 3, 4, 5, 7, 8, 13, 16, 32, 64}, set_nodes, {""}};
static axis fractions = {"fraction (0: one node)",
                         9,
                         {0, 1e-4, 1e-3, 0.01, 0.1, 0.3, 0.5, 0.7, 0.78},
                         set_fraction,
                         {""}};

/* Relative error of an answer, or NaN. */
typedef double (*error_of)(const extreme *x, const answer *a);

/* The exact plane bulk modulus of equal shear moduli. */
static double against_exact(const extreme *x, const answer *a)
{
    (void)x;
    return fabs(a->bulk / a->exact_bulk - 1);
}

/* The same cell with four times the nodes, to a residual of 1e-9. */
static double against_fine(const extreme *x, const answer *a)
{
    extreme fine = *x;
    fine.nodes *= 4;
    fine.block = 4;
    fine.tolerance = 1e-9;
    fine.max_iterations = 20000;
    answer b = ask(&fine);
    if (b.stiffness.n == 0) return (double)NAN;
    return difference(&a->stiffness, &b.stiffness);
}

static void draw(const char *docs, const char *file, const char *title, const char *what,
                 axis *x, axis *y, const double *value)
{
    ph_error err = PH_ERROR_INIT;
    char path[1024];
    const char *xnames[MOST], *ynames[MOST];
    for (int i = 0; i < MOST; i++) {
        xnames[i] = x->name[i];
        ynames[i] = y->name[i];
    }
    snprintf(path, sizeof path, "%s/pictures/extremes-%s.svg", docs, file);
    const ph_heatmap map = {.title = title,
                            .subtitle = "grey: no answer, or nothing to compare with",
                            .xlabel = x->label,
                            .ylabel = y->label,
                            .value_label = what,
                            .nx = x->n,
                            .ny = y->n,
                            .value = value,
                            .xnames = xnames,
                            .ynames = ynames,
                            .log_colour = true,
                            .cell_text = true,
                            .width = 760,
                            .height = 420};
    CHECK_OK(ph_heatmap_write(path, &map, &err));
}

static const char *const outcome_name[] = {"solved", "flagged", "refused", "WRONG"};

static void name_axis(axis *a)
{
    for (int i = 0; i < a->n; i++)
        snprintf(a->name[i], sizeof a->name[i], "%g", a->value[i]);
}

static void map(FILE *page, const char *docs, const char *file, const char *title,
                const char *text, const extreme *rest, axis *x, axis *y, error_of error)
{
    double errors[MOST * MOST], iterations[MOST * MOST], worst = 0;
    int count[4] = {0};
    char name[64], refusal[256] = "";
    name_axis(x);
    name_axis(y);
    for (int j = 0; j < y->n; j++)
        for (int i = 0; i < x->n; i++) {
            extreme cell = *rest;
            x->set(&cell, x->value[i]);
            y->set(&cell, y->value[j]);
            answer a = ask(&cell);
            bool there = a.stiffness.n > 0;
            double e = there ? error(&cell, &a) : (double)NAN;
            count[a.outcome]++;
            errors[j * x->n + i] = e < 1e-16 ? 1e-16 : e; /* NaN stays */
            iterations[j * x->n + i] = there ? fmax(a.iterations, 1) : (double)NAN;
            if (a.outcome == SOLVED && e > worst) worst = e;
            if (a.outcome == REFUSED) snprintf(refusal, sizeof refusal, "%s", a.message);
        }
    snprintf(name, sizeof name, "%s-error", file);
    draw(docs, name, title, "relative error", x, y, errors);
    snprintf(name, sizeof name, "%s-iterations", file);
    draw(docs, name, title, "iterations (1: none)", x, y, iterations);
    fprintf(page, "\n## %s\n\n%s\n\n", title, text);
    for (int k = 0; k < 4; k++)
        fprintf(page, "%s%d %s", k ? ", " : "", count[k], outcome_name[k]);
    fprintf(page, "; largest error of those solved %.2g.\n", worst);
    if (refusal[0]) fprintf(page, "A refusal: \"%s\".\n", refusal);
    fprintf(page, "\n![%s](pictures/extremes-%s-error.svg)\n", "errors", file);
    fprintf(page, "![%s](pictures/extremes-%s-iterations.svg)\n", "iterations", file);
}

/* Every combination on small grids: what became of it, by the value of each axis. */
static void all_together(FILE *page)
{
    axis all[5] = {contrasts, ratios, horizons, grids, fractions};
    int count[5][MOST][4] = {{{0}}}, total[4] = {0}, at[5];
    all[2].n = 5; /* to horizon 3 */
    all[3].n = 7; /* to 8 nodes */
    int cells = 1;
    for (int k = 0; k < 5; k++) {
        name_axis(&all[k]);
        cells *= all[k].n;
    }
    for (int c = 0; c < cells; c++) {
        extreme x = {.nodes = 8};
        for (int k = 0, rest = c; k < 5; rest /= all[k].n, k++) {
            at[k] = rest % all[k].n;
            all[k].set(&x, all[k].value[at[k]]);
        }
        answer a = ask(&x);
        total[a.outcome]++;
        for (int k = 0; k < 5; k++)
            count[k][at[k]][a.outcome]++;
        if (a.outcome == WRONG)
            fprintf(stderr,
                    "WRONG: contrast %g nu %g horizon %g nodes %td fraction %g: %s\n",
                    x.contrast, x.nu_matrix, x.horizon, x.nodes, x.fraction, a.message);
    }
    fprintf(
        page,
        "\n## Everything with everything\n\n%d cells on small grids: %d solved, %d "
        "flagged, %d refused, %d wrong.\n\n| axis | value | solved | flagged | refused "
        "| wrong |\n|---|---|---|---|---|---|\n",
        cells, total[SOLVED], total[FLAGGED], total[REFUSED], total[WRONG]);
    for (int k = 0; k < 5; k++)
        for (int i = 0; i < all[k].n; i++)
            fprintf(page, "| %s | %s | %d | %d | %d | %d |\n", all[k].label,
                    all[k].name[i], count[k][i][SOLVED], count[k][i][FLAGGED],
                    count[k][i][REFUSED], count[k][i][WRONG]);
}

static const char head[] = "# The extremes, mapped\n\n"
                           "Made by `ninja -C build extremes` "
                           "(`tests/verify/extremes_map.c`); what the numbers mean "
                           "and why: [far ends](theory/extremes.md).\n\n"
                           "One disk in a square cell, plane strain, defaults but for "
                           "what a map says. *Solved*: an "
                           "answer within the bounds of Voigt and Reuss whose checks "
                           "pass; *flagged*: an answer that "
                           "says of itself that it is not good (not converged, more than "
                           "1 % of the energy in the "
                           "stabilisation, a Hill-Mandel residual above 1e-3); "
                           "*refused*: an error that says why; "
                           "*wrong*: anything else.\n";

int main(int argc, char **argv)
{
    char path[1024];
    const char *docs = argc > 1 ? argv[1] : ".";
    snprintf(path, sizeof path, "%s/extremes.md", docs);
    FILE *page = fopen(path, "w");
    if (!page) return 1;
    fputs(head, page);
    const extreme disk = {
        .contrast = 10, .nu_matrix = 0.3, .nu_disk = 0.3, .fraction = 0.3, .nodes = 32};
    extreme shear = disk;
    shear.equal_shear = true;
    map(page, docs, "contrast", "Contrast and Poisson's ratio",
        "Disk of 0.3 on 32 x 32, against 128 x 128 solved to 1e-9.", &disk, &contrasts,
        &ratios, against_fine);
    map(page, docs, "ratio", "Poisson's ratios of equal shear moduli",
        "Disk of 0.3 on 32 x 32; the plane bulk modulus is known exactly [Hill1964].",
        &shear, &of_disk, &of_matrix, against_exact);
    shear.nu_matrix = -0.5;
    shear.nu_disk = 0.45;
    map(page, docs, "grid", "Grid and horizon",
        "Equal shear moduli, Poisson's ratios -0.5 and 0.45, disk of 0.3; exact plane "
        "bulk "
        "modulus.",
        &shear, &grids, &horizons, against_exact);
    extreme small = disk;
    small.nodes = 16;
    map(page, docs, "fraction", "Fraction and contrast",
        "16 x 16 against 64 x 64 solved to 1e-9; a disk of 1e-4 is a fortieth of a cell, "
        "one "
        "node a square voxel (of 4 x 4 nodes on the fine grid). "
        "Between disks of 0.7 the matrix is 0.9 cells thick, which is where the large "
        "errors "
        "are.",
        &small, &contrasts, &fractions, against_fine);
    all_together(page);
    fclose(page);
    return check_failures != 0;
}
