/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What must not matter: the units, the names of the axes, the number of threads. */
#include "check.h"
#include "random_cases.h"
#include "solve/space.h"

typedef struct setup {
    const char *what;
    ph_model_params model;
    const char *constraint;
} setup;

#define S .stabilisation = PH_STABILISE_SPECTRAL, .stabilisation_value = 1e-2
#define P .stabilisation = PH_STABILISE_SUBPOINT, .stabilisation_value = 0.1

/* Every route, with the constraints that change it. */
static const setup setups[] = {
    {"local", {.kind = "local"}, "periodic"},
    {"stress (S)", {.points = PH_POINTS_STRESS, S}, "periodic"},
    {"stress (P)", {.points = PH_POINTS_STRESS, P}, "periodic"},
    {"nodes (S)", {.points = PH_POINTS_NODES, .horizon = 1.3, S}, "periodic"},
    {"nodes (P)", {.points = PH_POINTS_NODES, .horizon = 1.5, P}, "periodic"},
    {"wide stress (S)", {.points = PH_POINTS_STRESS, .horizon = 1.6, S}, "periodic"},
    {"wide stress (P)", {.points = PH_POINTS_STRESS, .horizon = 1.6, P}, "periodic"},
    {"local", {.kind = "local"}, "linear_displacement"},
    {"stress (S)", {.points = PH_POINTS_STRESS, S}, "linear_displacement"},
    {"nodes (S)", {.points = PH_POINTS_NODES, .horizon = 1.0, S}, "linear_displacement"},
    {"local", {.kind = "local"}, "uniform_traction"},
    {"stress (S)", {.points = PH_POINTS_STRESS, S}, "uniform_traction"},
    {"nodes (S)", {.points = PH_POINTS_NODES, .horizon = 1.3, S}, "uniform_traction"},
    {"voigt", {.kind = "local"}, "voigt"},
    {"reuss", {.kind = "local"}, "reuss"},
};
enum { SETUPS = sizeof setups / sizeof *setups };

static ph_result *solve_loads(const setup *s, const ph_microstructure *micro, int threads,
                              double tolerance, unsigned loads, const char *solver)
{
    ph_error err = PH_ERROR_INIT;
    ph_ctx ctx = {.threads = threads};
    ph_result *res = NULL;
    ph_problem p = {.micro = micro,
                    .model = s->model,
                    .constraint = {.kind = s->constraint},
                    .solver = {.kind = solver, .tolerance = tolerance},
                    .loads = loads};
    int before = check_failures;
    CHECK_OK(ph_homogenise(&p, &ctx, &res, &err));
    if (check_failures > before) print_error("  ... %s, %s\n", s->what, s->constraint);
    return res;
}

static ph_result *solve(const setup *s, const ph_microstructure *micro, double tolerance)
{
    return solve_loads(s, micro, 1, tolerance, 0, NULL);
}

/* Three isotropic phases of modulus times `unit`, random cells, some of them cut. */
static ph_microstructure *cell(uint64_t *seed, const ptrdiff_t *n, const double *edge,
                               double unit, bool voids)
{
    ph_error err = PH_ERROR_INIT;
    ph_material m[3];
    ph_grid g;
    ph_microstructure *micro = NULL;
    CHECK_OK(ph_material_isotropic("a", unit, 0.3, &m[0], &err));
    CHECK_OK(ph_material_isotropic("b", 4.0 * unit, 0.15, &m[1], &err));
    if (voids)
        m[2] = ph_material_void("c");
    else
        CHECK_OK(ph_material_isotropic("c", 9.0 * unit, 0.4, &m[2], &err));
    CHECK_OK(ph_grid_init(&g, PH_SPACE, n, edge, &err));
    CHECK_OK(ph_microstructure_new(&g, 3, m, &micro, &err));
    ptrdiff_t cells = ph_grid_cells(&g);
    micro->cuts = calloc((size_t)cells, sizeof *micro->cuts);
    for (ptrdiff_t x = 0; x < cells; x++) {
        double r = check_random(seed);
        micro->phase[x] = (uint16_t)(r < 0.5 ? 0 : r < 0.8 ? 1 : 2);
        if (check_random(seed) > 0.3) continue;
        double phi = check_uniform(seed, 0, 6.28), z = check_uniform(seed, -0.9, 0.9);
        micro->cuts[micro->ncuts++] =
            (ph_cut){x,
                     micro->phase[x],
                     (int)(2 * check_random(seed)),
                     check_uniform(seed, 0.1, 0.9),
                     {sqrt(1 - z * z) * cos(phi), sqrt(1 - z * z) * sin(phi), z}};
    }
    return micro;
}

/* Moduli of 1e-60 .. 1e60 and lengths of 1e-30 .. 1e30 (what case files admit) give the same
 * iterations and the same digits. Round-off is amplified by the conditions of the systems,
 * below 1e6: 1e-9. */
static void units(void **state)
{
    (void)state;
    static const double unit[][2] = {
        {1e20, 1e-9}, {1e-20, 1e9}, {1e60, 1e-30}, {1e-60, 1e30}};
    uint64_t seed = check_seed();
    ptrdiff_t n[3] = {6, 5, 5};
    for (int i = 0; i < SETUPS; i++) {
        for (int v = 0; v < 2; v++) {
            uint64_t same = seed, again;
            double edge[3] = {6.0, 5.5, 4.9};
            if (v && setups[i].model.points == PH_POINTS_NODES) continue;
            if (v && strcmp(setups[i].constraint, "periodic") != 0) continue;
            again = same;
            ph_microstructure *base = cell(&again, n, edge, 1.0, v);
            ph_result *want = solve(&setups[i], base, 1e-8);
            for (size_t k = 0; want && k < sizeof unit / sizeof *unit; k++) {
                double size[3] = {edge[0] * unit[k][1], edge[1] * unit[k][1],
                                  edge[2] * unit[k][1]};
                again = same;
                ph_microstructure *micro = cell(&again, n, size, unit[k][0], v);
                ph_result *got = solve(&setups[i], micro, 1e-8);
                int before = check_failures;
                for (int a = 0; got && a < 6; a++)
                    for (int b = 0; b < 6; b++)
                        CHECK_ABS(got->stiffness.m[a][b] / unit[k][0],
                                  want->stiffness.m[a][b], 1e-9 * 10.0);
                bool direct = got && strcmp(got->solver, "direct") == 0; /* refines */
                for (int a = 0; got && !direct && a < got->nloads; a++)
                    CHECK(abs(got->iterations[a] - want->iterations[a]) <=
                          1 + want->iterations[a] / 10);
                if (got) CHECK_ABS(got->hill_mandel, want->hill_mandel, 1e-9);
                if (check_failures > before)
                    print_error("  ... %s, %s, E %g, L %g\n", setups[i].what,
                                setups[i].constraint, unit[k][0], unit[k][1]);
                ph_result_free(&got);
                ph_microstructure_free(&micro);
            }
            ph_result_free(&want);
            ph_microstructure_free(&base);
        }
        check_random(&seed);
    }
    CHECK_END();
}

static int by_cell(const void *a, const void *b)
{
    ptrdiff_t x = ((const ph_cut *)a)->cell, y = ((const ph_cut *)b)->cell;
    return (x > y) - (x < y);
}

/* The same cell with axis d called axis to[d]. */
static ph_microstructure *renamed(const ph_microstructure *m, const int to[3])
{
    ph_error err = PH_ERROR_INIT;
    ph_grid g;
    ptrdiff_t n[3];
    double size[3];
    ph_microstructure *out = NULL;
    for (int d = 0; d < 3; d++)
        n[to[d]] = m->grid.n[d], size[to[d]] = m->grid.size[d];
    CHECK_OK(ph_grid_init(&g, PH_SPACE, n, size, &err));
    CHECK_OK(ph_microstructure_new(&g, m->nmaterials, m->materials, &out, &err));
    ptrdiff_t cells = ph_grid_cells(&g), k = 0;
    ptrdiff_t *where = calloc((size_t)cells, sizeof *where);
    for (ptrdiff_t x = 0; x < cells; x++) {
        ptrdiff_t at[3] = {x / m->grid.n[2] / m->grid.n[1],
                           x / m->grid.n[2] % m->grid.n[1], x % m->grid.n[2]};
        ptrdiff_t new[3];
        for (int d = 0; d < 3; d++)
            new[to[d]] = at[d];
        where[x] = (new[0] * n[1] + new[1]) * n[2] + new[2];
        out->phase[where[x]] = m->phase[x];
    }
    out->cuts = calloc((size_t)m->ncuts + 1, sizeof *out->cuts);
    for (out->ncuts = m->ncuts; k < m->ncuts; k++) {
        out->cuts[k] = m->cuts[k];
        out->cuts[k].cell = where[m->cuts[k].cell];
        for (int d = 0; d < 3; d++)
            out->cuts[k].normal[to[d]] = m->cuts[k].normal[d];
    }
    qsort(out->cuts, (size_t)out->ncuts, sizeof *out->cuts, by_cell);
    free(where);
    return out;
}

/* Names of the axes, with one cell, an odd and an even number of them along each: the last
 * axis is that of the half spectrum, and axes of one cell are walked in another order.
 * Solved to 1e-9, so that C is good to 1e-9 times the root of a condition of 1e4. */
static void axes(void **state)
{
    (void)state;
    static const ptrdiff_t grid[][3] = {{4, 5, 6}, {1, 5, 6}, {4, 1, 5}, {5, 4, 1},
                                        {7, 1, 1}, {1, 1, 6}, {2, 5, 3}, {3, 3, 8}};
    static const int turn[][3] = {{1, 2, 0}, {2, 0, 1}, {0, 2, 1}};
    static const int voigt[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
    static const int axis[6][2] = {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};
    uint64_t seed = check_seed();
    for (int i = 0; i < SETUPS; i++)
        for (size_t k = 0; k < sizeof grid / sizeof *grid; k++) {
            double edge[3];
            bool small = false;
            for (int d = 0; d < 3; d++) {
                edge[d] = (double)grid[k][d] * check_uniform(&seed, 0.9, 1.1);
                small = small || (grid[k][d] > 1 && grid[k][d] < 4);
            }
            if (small && (setups[i].model.horizon > 0.0 ||
                          strcmp(setups[i].constraint, "linear_displacement") == 0))
                continue;
            if (setups[i].model.points == PH_POINTS_NODES &&
                strcmp(setups[i].constraint, "linear_displacement") == 0)
                continue; /* no free node on grids as small as these */
            ph_microstructure *micro = cell(&seed, grid[k], edge, 1.0, false);
            ph_result *want = solve(&setups[i], micro, 1e-9);
            for (size_t t = 0; want && t < sizeof turn / sizeof *turn; t++) {
                const int *to = turn[t];
                ph_microstructure *other = renamed(micro, to);
                ph_result *got = solve(&setups[i], other, 1e-9);
                int before = check_failures;
                for (int a = 0; got && a < 6; a++)
                    for (int b = 0; b < 6; b++) {
                        int A = voigt[to[axis[a][0]]][to[axis[a][1]]];
                        int B = voigt[to[axis[b][0]]][to[axis[b][1]]];
                        CHECK_ABS(got->stiffness.m[A][B], want->stiffness.m[a][b], 1e-6);
                    }
                if (check_failures > before)
                    print_error("  ... %s, %s, %td x %td x %td, turn %zu\n",
                                setups[i].what, setups[i].constraint, grid[k][0],
                                grid[k][1], grid[k][2], t);
                ph_result_free(&got);
                ph_microstructure_free(&other);
            }
            ph_result_free(&want);
            ph_microstructure_free(&micro);
        }
    CHECK_END();
}

/* a.b of half spectra is n times that of the fields (Parseval). */
static void half_spectra(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    for (ptrdiff_t code = 0; code < 64; code++) {
        static const ptrdiff_t length[4] = {1, 2, 5, 6};
        ptrdiff_t n[3] = {length[code % 4], length[code / 4 % 4], length[code / 16]};
        double size[3] = {1, 1, 1};
        ph_grid g;
        CHECK_OK(ph_grid_init(&g, PH_SPACE, n, size, &err));
        ph_layout l = ph_i_layout(&g);
        ph_fft *fft = NULL;
        ph_space real = {0}, half = {0};
        CHECK_OK(ph_i_fft_new(&l, 1, &fft, &err));
        CHECK_OK(ph_i_space_init(&real, &l, NULL, 1, &err));
        CHECK_OK(ph_i_space_init(&half, &l, fft, 1, &err));
        double *u[2], *hat[2];
        for (int i = 0; i < 2; i++) {
            u[i] = random_field(&seed, 3 * l.cells);
            hat[i] = ph_i_doubles_new(NULL, ph_i_space_size(&half));
            for (int a = 0; a < 3; a++)
                ph_i_fft_forward(fft, u[i] + a * l.cells,
                                 hat[i] + 2 * a * ph_i_fft_modes(fft));
        }
        /* sums of 540 products below 1: round-off far below 1e-12 */
        CHECK_ABS(ph_i_dot(&half, hat[0], hat[1]) / (double)l.cells,
                  ph_i_dot(&real, u[0], u[1]), 1e-12);
        for (int i = 0; i < 2; i++) {
            free(u[i]);
            free(hat[i]);
        }
        ph_i_space_clear(&real);
        ph_i_space_clear(&half);
        ph_i_fft_free(&fft);
    }
    CHECK_END();
}

/* ---- threads ----------------------------------------------------------------------------- */

/* Everything that runs in parallel, once: A u, A u in space, the symbol, sums of vectors. */
static double *all_of_it(const random_case *c, ph_route route, int threads,
                         const double *u, size_t *count)
{
    ph_error err = PH_ERROR_INIT;
    ph_meter meter = {0};
    ph_operator *op = NULL;
    ph_operator_params params = c->params;
    params.threads = threads;
    params.route = route;
    CHECK_OK(ph_i_operator_new(&c->micro->grid, c->map, &params, &meter, &op, &err));
    CHECK_OK(ph_i_operator_in_space(op, &err));
    size_t cells = (size_t)op->layout.cells, nd = (size_t)op->layout.nd;
    size_t modes = (size_t)op->modes, ns = (size_t)op->layout.ns;
    *count = 2 * nd * cells + ns * cells + 6 * nd * modes + nd * (nd + 1) / 2 * modes + 2;
    double *out = ph_i_doubles_new(NULL, *count), *at = out;
    double macro[6] = {0.3, -0.2, 0.5, 0.1, 0.7, -0.4};
    ph_i_operator_apply(op, u, at);
    ph_i_operator_load(op, macro, at += nd * cells);
    ph_i_operator_strain(op, u, macro, at += nd * cells);
    double *hat = at += ns * cells, *f = at += 2 * nd * modes, *x = at += 2 * nd * modes;
    ph_i_operator_forward(op, u, hat);
    ph_i_operator_apply_hat(op, hat, f);
    memcpy(x, f, sizeof(double) * 2 * nd * modes);
    at += 2 * nd * modes;
    if (route != PH_ROUTE_BONDS)
        CHECK_OK(ph_i_operator_symbol(op, &c->map->middle, at, &err));
    at += nd * (nd + 1) / 2 * modes;
    ph_space space = {0};
    CHECK_OK(ph_i_space_init(&space, &op->layout, op->fft, threads, &err));
    ph_i_direction(&space, 0.37, hat, x);
    at[0] = ph_i_dot(&space, hat, f);
    at[1] = ph_i_step(&space, 0.41, hat, x, f, x);
    ph_i_space_clear(&space);
    ph_i_operator_free(&op);
    return out;
}

/* One thread or five give the same bits: operators of every route on grids whose planes,
 * rows and spectra no number of threads divides. ph_homogenise takes one thread for cells
 * as small as tests can afford, so the parts are compared themselves. */
static void threads_of_operators(void **state)
{
    (void)state;
    static const struct {
        ph_points points;
        double horizon;
        ph_route route;
        ph_stabilisation stab;
    } part[] = {
        {PH_POINTS_AUTO, 0.0, PH_ROUTE_AUTO, PH_STABILISE_NONE},
        {PH_POINTS_STRESS, 1.0, PH_ROUTE_AUTO, PH_STABILISE_SPECTRAL},
        {PH_POINTS_STRESS, 1.0, PH_ROUTE_AUTO, PH_STABILISE_SUBPOINT},
        {PH_POINTS_NODES, 1.3, PH_ROUTE_STENCIL, PH_STABILISE_SUBPOINT},
        {PH_POINTS_NODES, 2.2, PH_ROUTE_CONVOLUTION, PH_STABILISE_SPECTRAL},
        {PH_POINTS_STRESS, 2.2, PH_ROUTE_CONVOLUTION, PH_STABILISE_SUBPOINT},
        {PH_POINTS_NODES, 1.3, PH_ROUTE_BONDS, PH_STABILISE_SPECTRAL},
    };
    static const ptrdiff_t grid[][3] = {{9, 7, 11}, {13, 10, 1}, {1, 11, 14}, {6, 1, 9}};
    uint64_t seed = check_seed();
    for (size_t i = 0; i < sizeof part / sizeof *part; i++)
        for (size_t k = 0; k < sizeof grid / sizeof *grid; k++) {
            random_case c = new_case(&seed, PH_SPACE, grid[k], true, part[i].points,
                                     part[i].horizon, influence_at(0), part[i].stab, 0.1);
            double *u = random_field(&seed, displacements(&c));
            size_t count, same;
            double *one = all_of_it(&c, part[i].route, 1, u, &count);
            for (int t = 2; t <= 5; t++) {
                double *many = all_of_it(&c, part[i].route, t, u, &same);
                bool equal = memcmp(one, many, count * sizeof *one) == 0;
                CHECK(equal);
                if (!equal)
                    print_error("  ... part %zu, grid %zu, %d threads\n", i, k, t);
                free(many);
            }
            free(one);
            free(u);
            free_case(&c);
        }
    CHECK_END();
}

/* And the whole of it, on a cell that is large enough for three threads. */
static void threads_of_a_run(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ptrdiff_t n[3] = {1, 129, 131};
    double edge[3] = {1, 129, 131};
    ph_microstructure *micro = cell(&seed, n, edge, 1.0, false);
    static const int some[] = {2, 3, 8, 1};
    for (size_t i = 0; i < sizeof some / sizeof *some; i++) {
        const char *solver = some[i] == 1 ? "relaxation" : "fft_cg";
        ph_result *one = solve_loads(&setups[some[i]], micro, 1, 0.3, 2, solver);
        for (int t = 2; one && t <= 3; t++) {
            ph_result *many = solve_loads(&setups[some[i]], micro, t, 0.3, 2, solver);
            CHECK(many && many->threads == t);
            CHECK(many &&
                  memcmp(&one->stiffness, &many->stiffness, sizeof one->stiffness) == 0);
            ph_result_free(&many);
        }
        ph_result_free(&one);
    }
    ph_microstructure_free(&micro);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(units),
        cmocka_unit_test(axes),
        cmocka_unit_test(half_spectra),
        cmocka_unit_test(threads_of_operators),
        cmocka_unit_test(threads_of_a_run),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
