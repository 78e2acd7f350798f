/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Operators with broken bonds, damaged nodes recomputed beside a fast route, against bond
 * lists made from the definition; bonds that break while the operator lives. */
#include "check.h"
#include "random_cases.h"
#include "solve/solver.h"

#include <string.h>

/* Sums of a few hundred products, in another order or by transforms, times the condition of
 * the shape tensors of damaged families, up to a few hundred at these horizons: 1e-16 x 1e2 x
 * 1e2. Measured 1e-14 on most seeds. */
static const double round_off = 2e-12;

static const struct {
    ph_kinematics kin;
    ptrdiff_t n[3];
    double horizon;
} shapes[] = {
    {PH_PLANE_STRAIN, {9, 8, 1}, 2.0},
    {PH_PLANE_STRESS, {11, 12, 1}, 3.0},
    {PH_GENERALISED_STRAIN, {8, 9, 1}, 1.6},
    {PH_SPACE, {6, 7, 5}, 1.5},
    {PH_SPACE, {8, 1, 9}, 2.0},
};
enum { SHAPES = sizeof shapes / sizeof *shapes };

static random_case case_of(int shape, double alpha, uint64_t *seed)
{
    return new_case(seed, shapes[shape].kin, shapes[shape].n, false, PH_POINTS_NODES,
                    shapes[shape].horizon, influence_at((size_t)shape % ph_ninfluences),
                    alpha > 0.0 ? PH_STABILISE_SPECTRAL : PH_STABILISE_NONE, alpha);
}

/* Break a share of all bonds; at every seventh node all of them. */
static void break_some(ph_broken *br, double share, uint64_t *seed)
{
    ph_error err = PH_ERROR_INIT;
    for (ptrdiff_t x = 0; x < br->n[0] * br->n[1] * br->n[2]; x++)
        for (ptrdiff_t b = 0; b < br->family->count; b++)
            if (check_random(seed) < share || (share > 0.3 && x % 7 == 0))
                CHECK_OK(ph_i_break(br, x, b, &err));
    CHECK_OK(ph_i_broken_settle(br, &err));
}

static void check_symmetry(ph_operator *op, ptrdiff_t n, uint64_t *seed)
{
    double *u = random_field(seed, n), *v = random_field(seed, n);
    double *f = random_field(seed, n), uAv = 0.0, vAu = 0.0, uAu = 0.0, size = 0.0;
    ph_i_operator_apply(op, u, f);
    for (ptrdiff_t i = 0; i < n; i++) {
        vAu += v[i] * f[i];
        uAu += u[i] * f[i];
        size += fabs(f[i]);
    }
    ph_i_operator_apply(op, v, f);
    for (ptrdiff_t i = 0; i < n; i++)
        uAv += u[i] * f[i];
    CHECK_ABS(uAv, vAu, 1e-13 * size);
    CHECK(uAu >= 0.0);
    free(u), free(v), free(f);
}

static void compare(random_case *c, ph_operator *op, const ph_broken *broken,
                    uint64_t *seed)
{
    ph_error err = PH_ERROR_INIT;
    ph_bondlist *list = NULL;
    const ph_grid *g = &c->micro->grid;
    ptrdiff_t n = displacements(c), cells = ph_grid_cells(g);
    int ns = c->map->ns;
    double *u = random_field(seed, n), *f = random_field(seed, n);
    double *want = random_field(seed, n), *e = random_field(seed, ns * cells);
    double *e2 = random_field(seed, ns * cells), macro[6], s1[6], s2[6], t1[6], t2[6];
    ph_cell_energy w1, w2;
    for (int i = 0; i < 6; i++)
        macro[i] = check_uniform(seed, -1, 1);
    c->params.broken = broken;
    CHECK_OK(ph_i_bondlist_new(g, c->map, &c->params, NULL, &list, &err));
    if (list) {
        ph_i_operator_apply(op, u, f);
        ph_i_bondlist_apply(list, u, want);
        CHECK_ABS(field_difference(n, f, want), 0.0, round_off);
        ph_i_operator_load(op, macro, f);
        ph_i_bondlist_load(list, macro, want);
        CHECK_ABS(field_difference(n, f, want), 0.0, round_off);
        ph_i_operator_strain(op, u, macro, e);
        ph_i_bondlist_strain(list, u, macro, e2);
        CHECK_ABS(field_difference(ns * cells, e, e2), 0.0, round_off);
        CHECK_OK(ph_i_operator_sums(op, u, macro, NULL, s1, t1, &w1, &err));
        ph_i_bondlist_sums(list, u, macro, NULL, s2, t2, &w2);
        CHECK(field_difference(ns, s1, s2) < 10 * round_off);
        CHECK(field_difference(ns, t1, t2) < 10 * round_off);
        CHECK_REL(w1.mean, w2.mean, 10 * round_off);
        CHECK_ABS(w1.stabilisation, w2.stabilisation, 10 * round_off * w2.mean);
    }
    free(u), free(f), free(want), free(e), free(e2);
    ph_i_bondlist_free(&list);
}

/* The operator is made with the first bonds broken and takes in the others. */
static void nodes_of_route(ph_route route, double alpha)
{
    static const double shares[] = {0.0, 0.02, 0.5};
    uint64_t seed = check_seed();
    ph_error err = PH_ERROR_INIT;
    for (int i = 0; i < SHAPES; i++) {
        random_case c = case_of(i, alpha, &seed);
        ph_broken *broken = NULL;
        ph_operator *op = NULL;
        const ph_grid *g = &c.micro->grid;
        int before = check_failures;
        CHECK_OK(ph_i_broken_new(g, c.family, &c.meter, &broken, &err));
        c.params.broken = broken;
        c.params.route = route;
        CHECK_OK(ph_i_operator_new(g, c.map, &c.params, &c.meter, &op, &err));
        if (op) CHECK_OK(ph_i_operator_in_space(op, &err));
        for (int k = 0; op && k < 3; k++) {
            break_some(broken, shares[k], &seed);
            CHECK_OK(ph_i_operator_update(op, &err));
            ph_i_broken_seen(broken);
            compare(&c, op, broken, &seed);
            check_symmetry(op, displacements(&c), &seed);
            if (k == 2) CHECK(op->damaged->mute >= ph_grid_cells(g) / 7);
        }
        if (check_failures > before) print_error("  ... shape %d\n", i);
        ph_i_operator_free(&op);
        ph_i_broken_free(&broken);
        CHECK(c.meter.peak > c.meter.bytes);
        free_case(&c);
        CHECK(c.meter.bytes == 0);
    }
    CHECK_END();
}

static void nodes(void **state)
{
    (void)state;
    nodes_of_route(PH_ROUTE_STENCIL, 0.0);
    nodes_of_route(PH_ROUTE_CONVOLUTION, 0.0);
}

static void nodes_stabilised(void **state)
{
    (void)state;
    nodes_of_route(PH_ROUTE_STENCIL, 0.1);
    nodes_of_route(PH_ROUTE_CONVOLUTION, 0.1);
}

/* The same bits on one thread and on three. */
static void threads(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_error err = PH_ERROR_INIT;
    for (int i = 0; i < SHAPES; i++) {
        random_case c = case_of(i, 0.1, &seed);
        ptrdiff_t n = displacements(&c);
        ph_broken *broken = NULL;
        double *u = random_field(&seed, n), *f[2] = {NULL, NULL};
        CHECK_OK(ph_i_broken_new(&c.micro->grid, c.family, NULL, &broken, &err));
        break_some(broken, 0.2, &seed);
        c.params.broken = broken;
        c.params.route = i % 2 ? PH_ROUTE_STENCIL : PH_ROUTE_CONVOLUTION;
        for (int k = 0; k < 2; k++) {
            ph_operator *op = NULL;
            c.params.threads = k ? 3 : 1;
            f[k] = random_field(&seed, n);
            CHECK_OK(
                ph_i_operator_new(&c.micro->grid, c.map, &c.params, NULL, &op, &err));
            if (op) CHECK_OK(ph_i_operator_in_space(op, &err));
            if (op) ph_i_operator_apply(op, u, f[k]);
            ph_i_operator_free(&op);
        }
        CHECK(memcmp(f[0], f[1], sizeof(double) * (size_t)n) == 0);
        free(u), free(f[0]), free(f[1]);
        ph_i_broken_free(&broken);
        free_case(&c);
    }
    CHECK_END();
}

/* Half of all bonds gone at random: the periodic problem is still solved, by both solvers. */
static void half_broken(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_error err = PH_ERROR_INIT;
    ptrdiff_t n[3] = {16, 16, 1};
    double energy[2] = {0}, unit[3] = {0, 1, 0};
    random_case c = new_case(&seed, PH_PLANE_STRESS, n, false, PH_POINTS_NODES, 2.0,
                             influence_at(0), PH_STABILISE_SPECTRAL, 0.1);
    ph_broken *broken = NULL;
    ph_operator *op = NULL;
    ph_setting setting = {.box = c.micro->grid, .averaged = 256};
    CHECK_OK(ph_i_broken_new(&c.micro->grid, c.family, NULL, &broken, &err));
    for (ptrdiff_t x = 0; x < 256; x++)
        for (ptrdiff_t b = 0; b < c.family->count / 2; b++) /* each pair once */
            if (check_random(&seed) < 0.5) CHECK_OK(ph_i_break(broken, x, b, &err));
    CHECK_OK(ph_i_broken_settle(broken, &err));
    CHECK_REL((double)broken->pairs, 256 * 10 * 0.5, 0.1);
    c.params.broken = broken;
    CHECK_OK(ph_i_operator_new(&c.micro->grid, c.map, &c.params, &c.meter, &op, &err));
    for (int k = 0; op && k < 2; k++) {
        void *state_of = NULL;
        ph_system system = {
            .op = op, .setting = &setting, .params = &c.params, .meter = &c.meter};
        const ph_solver_method *solver = ph_i_solver_find(k ? "direct" : "fft_cg");
        ph_cg_report report = {.tolerance = 1e-9, .max_iterations = 2000};
        CHECK_OK(solver->init(&system, &state_of, &err));
        ph_i_operator_load(op, unit, op->f);
        CHECK_OK(solver->solve(state_of, op->f, op->u, &report, &err));
        double *u = random_field(&seed, 512), *f = random_field(&seed, 512);
        memcpy(u, op->u, sizeof(double) * 512);
        ph_i_operator_load(op, unit, f);
        for (int i = 0; i < 512; i++)
            energy[k] += u[i] * f[i];
        free(u), free(f);
        solver->free(&state_of);
    }
    CHECK(energy[0] > 0.0);
    CHECK_REL(energy[1], energy[0], 1e-7); /* of second order in what is left */
    ph_i_operator_free(&op);
    ph_i_broken_free(&broken);
    free_case(&c);
    CHECK_END();
}

/* A rigid fragment: moving it costs nothing, nor does a linear field; no forces. */
static void fragment(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_error err = PH_ERROR_INIT;
    ptrdiff_t n[3] = {16, 16, 1};
    random_case c = new_case(&seed, PH_PLANE_STRESS, n, false, PH_POINTS_NODES, 2.0,
                             influence_at(0), PH_STABILISE_SPECTRAL, 0.1);
    ph_broken *broken = NULL;
    ph_operator *op = NULL;
    const ph_grid *g = &c.micro->grid;
    const double *h = g->h;
    double ring[5][3] = {{4 * h[0], 4 * h[1], 0},
                         {11 * h[0], 4 * h[1], 0},
                         {11 * h[0], 12 * h[1], 0},
                         {4 * h[0], 12 * h[1], 0},
                         {4 * h[0], 4 * h[1], 0}};
    ph_cracks cracks = {0};
    ptrdiff_t none[3] = {0, 0, 0};
    CHECK_OK(ph_i_broken_new(g, c.family, &c.meter, &broken, &err));
    CHECK_OK(ph_cracks_add_line(&cracks, 5, (const double(*)[3])ring, &err));
    CHECK_OK(ph_i_cracks_cut(&cracks, g, none, false, broken, NULL, &err));
    c.params.broken = broken;
    CHECK_OK(ph_i_operator_new(g, c.map, &c.params, &c.meter, &op, &err));
    if (op) CHECK_OK(ph_i_operator_in_space(op, &err));
    double *u = random_field(&seed, 512), *f = random_field(&seed, 512);
    for (int rotate = 0; op && rotate < 2; rotate++) {
        double most = 0.0;
        for (int x = 0; x < 256; x++) {
            int i = x / 16, j = x % 16;
            bool in = i >= 4 && i < 11 && j >= 4 && j < 12;
            u[x] = in ? 1.0 + rotate * j * h[1] : 0.0;
            u[256 + x] = in ? 2.0 - rotate * i * h[0] : 0.0;
        }
        ph_i_operator_apply(op, u, f);
        for (int x = 0; x < 512; x++)
            most = fmax(most, fabs(f[x]));
        CHECK_ABS(most, 0.0, 1e-11); /* forces of this field before the cut: some 1e1 */
    }
    free(u), free(f);
    ph_i_operator_free(&op);
    ph_i_broken_free(&broken);
    ph_cracks_free(&cracks);
    free_case(&c);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nodes),       cmocka_unit_test(nodes_stabilised),
        cmocka_unit_test(fragment),    cmocka_unit_test(threads),
        cmocka_unit_test(half_broken),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
