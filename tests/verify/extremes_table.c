/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prints the tables of docs/theory/extremes.md: what the defaults do at the far ends.
 * usage: extremes_table */
#include "solve.h"

static void print_row(const char *what, ph_microstructure *m, ph_problem p,
                      ph_sym4 *exact)
{
    ph_error err = PH_ERROR_INIT;
    ph_result *res = NULL;
    p.micro = m;
    ph_status st = ph_homogenise(&p, &one_thread, &res, &err);
    if (st != PH_OK) {
        printf("| %s | - | %s: %s |\n", what, ph_status_text(st), err.msg);
    } else if (exact && exact->n == 0) {
        *exact = res->stiffness;
        printf("| %s | %d | reference |\n", what, most_iterations(res));
    } else if (exact) {
        printf("| %s | %d | %.2g |\n", what, most_iterations(res),
               difference(&res->stiffness, exact));
    } else {
        printf("| %s | %d | C11 %.6g, C12 %.6g, C66 %.6g |\n", what, most_iterations(res),
               voigt(&res->stiffness, 1, 1), voigt(&res->stiffness, 1, 2),
               voigt(&res->stiffness, res->stiffness.n, res->stiffness.n));
    }
    ph_result_free(&res);
    ph_microstructure_free(&m);
}

static void heading(const char *title, const char *first, const char *last)
{
    printf("\n## %s\n\n| %s | iterations | %s |\n|---|---|---|\n", title, first, last);
}

static ph_material solid(double E, double nu)
{
    return isotropic("solid", E, nu);
}

/* Error of a solution to 1e-6 against the same equations to 1e-11. */
static void contrasts(ph_kinematics kin, ptrdiff_t n, ph_interface interface)
{
    for (int e = -6; e <= 6; e += 2) {
        char what[80];
        ph_sym4 exact = {.n = 0};
        ph_problem p = {.interface = interface, .solver = {.tolerance = 1e-11}};
        if (e == 0) continue;
        ph_microstructure *m =
            round_cell(kin, n, 0.3, solid(1, 0.3), solid(pow(10, e), 0.3));
        p.micro = m;
        exact = stiffness_of(&p);
        ph_microstructure_free(&m);
        p.solver.tolerance = 0;
        snprintf(what, sizeof what, "%s %td, %s, 1e%+d",
                 kin == PH_SPACE ? "sphere" : "disk", n,
                 interface == PH_INTERFACE_COMPOSITE ? "composite" : "node centre", e);
        print_row(what, round_cell(kin, n, 0.3, solid(1, 0.3), solid(pow(10, e), 0.3)), p,
                  &exact);
    }
}

static void random_voxels(void)
{
    ph_material two[2] = {solid(1, 0.3), solid(1, 0.3)};
    for (int deep = 0; deep < 2; deep++)
        for (int e = -6; e <= 6; e += 3) {
            char what[80];
            uint64_t seed = 1;
            if (e == 0) continue;
            two[1] = solid(pow(10, e), 0.3);
            ph_grid g = deep ? box_grid(PH_SPACE, 16, 16, 16, 1, 1, 1)
                             : box_grid(PH_PLANE_STRAIN, 32, 32, 1, 1, 1, 1);
            ph_problem p = {.micro = NULL};
            snprintf(what, sizeof what, "random voxels 0.5, %s, 1e%+d",
                     deep ? "3D" : "2D", e);
            print_row(what, voxel_cell(g, 2, two, &seed), p, NULL);
        }
}

static void poisson(void)
{
    static const double nu[] = {-0.99, -0.9, -0.5, 0.0, 0.49, 0.499, 0.49999, 0.499999};
    static const char *const where[] = {"matrix", "inclusion", "both"};
    for (int w = 0; w < 3; w++)
        for (int i = 0; i < 8; i++) {
            char what[80];
            ph_problem p = {.micro = NULL};
            snprintf(what, sizeof what, "%s, nu %g", where[w], nu[i]);
            print_row(what,
                      round_cell(PH_PLANE_STRAIN, 64, 0.3, solid(1, w != 1 ? nu[i] : 0.3),
                                 solid(10, w != 0 ? nu[i] : 0.3)),
                      p, NULL);
        }
}

static void horizons(void)
{
    for (int points = 0; points < 2; points++)
        for (double horizon = 1; horizon < 20; horizon *= 2) {
            char what[80];
            ph_problem p = {.micro = NULL};
            p.model.points = points ? PH_POINTS_STRESS : PH_POINTS_NODES;
            p.model.horizon = horizon;
            snprintf(what, sizeof what, "%s, horizon %g of 16",
                     points ? "stress points" : "nodes", horizon);
            print_row(what,
                      round_cell(PH_PLANE_STRAIN, 16, 0.3, solid(1, 0.3), solid(10, 0.3)),
                      p, NULL);
        }
}

static void fractions(void)
{
    for (int hole = 0; hole < 2; hole++)
        for (double f = 1e-4; f < 1; f *= f < 0.01 ? 10 : 2.6) {
            char what[80];
            ph_problem p = {.micro = NULL};
            snprintf(what, sizeof what, "%s, fraction %.3g", hole ? "hole" : "E 1e4", f);
            print_row(what,
                      round_cell(PH_PLANE_STRAIN, 64, f, solid(1, 0.3),
                                 hole ? ph_material_void("hole") : solid(1e4, 0.3)),
                      p, NULL);
        }
    ph_problem p = {.micro = NULL};
    ph_material v = ph_material_void("void");
    print_row("solid disk alone in void",
              round_cell(PH_PLANE_STRAIN, 64, 0.3, v, solid(1, 0.3)), p, NULL);
    print_row("nothing but void", round_cell(PH_PLANE_STRAIN, 64, 0.3, v, v), p, NULL);
}

static void holes_by_grid(void)
{
    for (ptrdiff_t n = 16; n <= 256; n *= 2) {
        char what[80];
        double c[9] = {0.4580850, 0.1108263, 0, 0.1108263, 0.4580850, 0, 0, 0, 0.0716596};
        ph_sym4 exact = ph_sym4_from_voigt(3, c, true);
        ph_problem p = {.micro = NULL};
        snprintf(what, sizeof what, "%td x %td", n, n);
        print_row(
            what,
            round_cell(PH_PLANE_STRAIN, n, 0.4, solid(1, 0.3), ph_material_void("hole")),
            p, &exact);
    }
}

int main(void)
{
    heading("Contrast", "inclusion 0.3, contrast", "solver's error");
    contrasts(PH_PLANE_STRAIN, 64, PH_INTERFACE_NODE_CENTRE);
    contrasts(PH_PLANE_STRAIN, 64, PH_INTERFACE_COMPOSITE);
    contrasts(PH_SPACE, 16, PH_INTERFACE_NODE_CENTRE);
    heading("Random voxels", "cell", "effective");
    random_voxels();
    heading("Poisson ratio", "disk 0.3, E 1 and 10, plane strain, 64 x 64", "effective");
    poisson();
    heading("Horizon", "disk 0.3, contrast 10, 16 x 16", "effective");
    horizons();
    heading("Size and fraction", "disk, 64 x 64", "effective");
    fractions();
    heading("Holes 0.4 by grid", "grid", "error against the exact tensor");
    holes_by_grid();
    return check_failures ? 1 : 0;
}
