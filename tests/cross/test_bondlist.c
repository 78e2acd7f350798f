/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The fast routes of the operator against bond lists made from the definition, on random
 * microstructures and random fields. */
#include "check.h"
#include "random_cases.h"

/* Sums of up to a few hundred products of order one, in another order, some of them by
 * transforms: round-off of some 1e-15 times the condition of the sums (about 1e1). */
static const double round_off = 2e-13;

typedef struct shape {
    ph_kinematics kin;
    ptrdiff_t n[3];
} shape;

static const shape shapes[] = {
    {PH_PLANE_STRAIN, {9, 8, 1}},
    {PH_PLANE_STRESS, {7, 10, 1}},
    {PH_GENERALISED_STRAIN, {8, 7, 1}},
    {PH_SPACE, {6, 5, 7}},
    {PH_SPACE, {6, 1, 8}},
    {PH_SPACE, {5, 9, 1}},
    {PH_SPACE, {1, 1, 8}},
    {PH_PLANE_STRAIN, {1, 9, 1}},
    {PH_GENERALISED_STRAIN, {9, 1, 1}},
    {PH_PLANE_STRESS, {2, 5, 1}},
    {PH_SPACE, {2, 6, 3}},
};
enum { SHAPES = sizeof shapes / sizeof *shapes };

/* Total of an energy, however the routes split it. */
static double total(const ph_cell_energy *e)
{
    return e->mean + e->modes + e->stabilisation;
}

static void compare_sums(ph_operator *op, const ph_bondlist *list, const double *u,
                         const double *macro, const uint8_t *region, uint64_t id)
{
    double s1[6], e1[6], s2[6], e2[6];
    ph_cell_energy w1, w2;
    ph_error err = PH_ERROR_INIT;
    int ns = list->ns;
    CHECK_OK(ph_i_operator_sums(op, u, macro, region, s1, e1, &w1, &err));
    ph_i_bondlist_sums(list, u, macro, region, s2, e2, &w2);
    CHECK(field_difference(ns, s1, s2) < round_off * 10); /* sums of both signs */
    CHECK(field_difference(ns, e1, e2) < round_off * 10);
    /* The spectral energy is of the whole box, whatever the region. */
    if (!region || !op->spectral) CHECK_REL(total(&w1), total(&w2), round_off * 10);
    (void)id;
}

/* One operator against its bond list: forces, loads, strains, sums, symmetry. */
static void compare(random_case *c, ph_route route, uint64_t *seed, const char *what)
{
    ph_error err = PH_ERROR_INIT;
    ph_operator *op = NULL;
    ph_bondlist *list = NULL;
    const ph_grid *g = &c->micro->grid;
    ptrdiff_t n = displacements(c), cells = ph_grid_cells(g);
    int before = check_failures, ns = c->map->ns;
    double *u = random_field(seed, n), *v = random_field(seed, n);
    double *f = random_field(seed, n), *want = random_field(seed, n);
    double *e = random_field(seed, ns * cells), *e2 = random_field(seed, ns * cells);
    double macro[6], uAv = 0.0, vAu = 0.0;
    uint8_t *region = calloc((size_t)cells, 1);
    for (int i = 0; i < 6; i++)
        macro[i] = check_uniform(seed, -1, 1);
    for (ptrdiff_t x = 0; x < cells; x++)
        region[x] = check_random(seed) < 0.5;
    c->params.route = route;
    CHECK_OK(ph_i_operator_new(g, c->map, &c->params, &c->meter, &op, &err));
    if (op) CHECK_OK(ph_i_operator_in_space(op, &err));
    CHECK_OK(ph_i_bondlist_new(g, c->map, &c->params, &c->meter, &list, &err));
    if (op) CHECK_OK(ph_i_operator_in_space(op, &err));
    if (op && list) {
        ph_i_operator_apply(op, u, f);
        ph_i_bondlist_apply(list, u, want);
        CHECK_ABS(field_difference(n, f, want), 0.0, round_off);
        for (ptrdiff_t i = 0; i < n; i++)
            vAu += v[i] * f[i];
        ph_i_operator_apply(op, v, f);
        for (ptrdiff_t i = 0; i < n; i++)
            uAv += u[i] * f[i];
        CHECK_ABS(uAv, vAu, 1e-12 * (fabs(vAu) + (double)n));
        ph_i_operator_load(op, macro, f);
        ph_i_bondlist_load(list, macro, want);
        CHECK_ABS(field_difference(n, f, want), 0.0, round_off);
        if (!c->map->has_void) { /* the list has no points in voids */
            ph_i_operator_strain(op, u, macro, e);
            ph_i_bondlist_strain(list, u, macro, e2);
            CHECK_ABS(field_difference(ns * cells, e, e2), 0.0, round_off);
            compare_sums(op, list, u, macro, NULL, 0);
            compare_sums(op, list, u, macro, region, 0);
        }
    }
    if (check_failures > before)
        print_error("  ... %s, route %s, grid %td x %td x %td, kinematics %d\n", what,
                    op ? ph_i_route_name(op->route) : "?", g->n[0], g->n[1], g->n[2],
                    (int)g->kinematics);
    free(u), free(v), free(f), free(want), free(e), free(e2), free(region);
    ph_i_operator_free(&op);
    ph_i_bondlist_free(&list);
}

static void stress_points_smallest(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int i = 0; i < SHAPES; i++)
        for (int k = 0; k < 6; k++) {
            static const ph_stabilisation stab[] = {
                PH_STABILISE_NONE,     PH_STABILISE_SUBPOINT, PH_STABILISE_SUBPOINT,
                PH_STABILISE_SPECTRAL, PH_STABILISE_SPECTRAL, PH_STABILISE_SPECTRAL};
            static const double value[] = {0, 0.05, 1.0, 1e-2, 1e-2, 1e-2};
            random_case c =
                new_case(&seed, shapes[i].kin, shapes[i].n, k == 2 || k == 5,
                         PH_POINTS_STRESS, 1.0, influence_at(0), stab[k], value[k]);
            c.params.hourglass_in_space = k == 4;
            compare(&c, PH_ROUTE_AUTO, &seed, "smallest family");
            free_case(&c);
        }
    CHECK_END();
}

static void local(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int i = 0; i < SHAPES; i++)
        for (int voids = 0; voids < 2; voids++) {
            random_case c = new_case(&seed, shapes[i].kin, shapes[i].n, voids,
                                     PH_POINTS_AUTO, 0, NULL, PH_STABILISE_NONE, 0);
            compare(&c, PH_ROUTE_AUTO, &seed, "local");
            free_case(&c);
        }
    CHECK_END();
}

static void families(ph_points points, double horizon, ph_stabilisation stab,
                     double value)
{
    uint64_t seed = check_seed();
    for (int i = 0; i < SHAPES; i++)
        for (int r = 0; r < 2; r++) {
            size_t which = (size_t)(i + r) % ph_ninfluences;
            bool few = false;
            for (int d = 0; d < 3; d++)
                few =
                    few || (shapes[i].n[d] > 1 && (double)shapes[i].n[d] < 3.0 * horizon);
            if (few && points == PH_POINTS_NODES) continue; /* may be refused: images */
            if (few && shapes[i].n[0] == 2) continue;
            random_case c = new_case(&seed, shapes[i].kin, shapes[i].n, r == 1, points,
                                     horizon, influence_at(which), stab, value);
            if (c.family) {
                compare(&c, PH_ROUTE_STENCIL, &seed, ph_influences[which].info.name);
                compare(&c, PH_ROUTE_CONVOLUTION, &seed, ph_influences[which].info.name);
            }
            free_case(&c);
        }
    CHECK_END();
}

static void nodes_without(void **state)
{
    (void)state;
    families(PH_POINTS_NODES, 1.3, PH_STABILISE_NONE, 0);
}
static void nodes_spectral(void **state)
{
    (void)state;
    families(PH_POINTS_NODES, 1.6, PH_STABILISE_SPECTRAL, 1e-2);
}
static void nodes_subpoint(void **state)
{
    (void)state;
    families(PH_POINTS_NODES, 2.0, PH_STABILISE_SUBPOINT, 0.1);
}
static void stress_without(void **state)
{
    (void)state;
    families(PH_POINTS_STRESS, 2.3, PH_STABILISE_NONE, 0);
}
static void stress_spectral(void **state)
{
    (void)state;
    families(PH_POINTS_STRESS, 2.3, PH_STABILISE_SPECTRAL, 1e-2);
}
static void stress_subpoint(void **state)
{
    (void)state;
    families(PH_POINTS_STRESS, 2.3, PH_STABILISE_SUBPOINT, 0.1);
}

/* The matrix, lower triangle mirrored, does what the list does; so do its row sums. */
static void matrix(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_error err = PH_ERROR_INIT;
    for (int i = 0; i < 3 * SHAPES; i++) {
        const shape *s = &shapes[i / 3];
        bool cut = i % 3 == 2; /* at its faces: no family is symmetric */
        if (cut && s->n[0] == 2) continue;
        random_case c = new_case(&seed, s->kin, s->n, false,
                                 i % 3 == 1 ? PH_POINTS_STRESS : PH_POINTS_NODES, 1.5,
                                 influence_at(0), PH_STABILISE_SPECTRAL, 1e-1);
        c.params.one_sided = cut;
        memcpy(c.params.rve, s->n, sizeof c.params.rve);
        ptrdiff_t n = displacements(&c), cells = ph_grid_cells(&c.micro->grid);
        ph_bondlist *list = NULL;
        ph_csc m = {0};
        int *unknown = calloc((size_t)n, sizeof *unknown), next = 0;
        double *u = random_field(&seed, n), *f = random_field(&seed, n);
        double *want = random_field(&seed, n), *sum = random_field(&seed, n);
        for (ptrdiff_t x = 0; x < cells; x++)
            for (ptrdiff_t a = 0; a < n / cells; a++) {
                bool held = check_random(&seed) < 0.2;
                unknown[a * cells + x] = held ? -1 : next++;
                if (held) u[a * cells + x] = 0.0;
            }
        CHECK_OK(ph_i_bondlist_new(&c.micro->grid, c.map, &c.params, NULL, &list, &err));
        CHECK_OK(ph_i_bondlist_matrix(list, unknown, next, &m, &err));
        CHECK_OK(ph_i_bondlist_row_sums(list, sum, &err));
        ph_i_bondlist_apply(list, u, want);
        double *x = calloc((size_t)next + 1, sizeof *x),
               *y = calloc((size_t)next + 1, sizeof *y);
        for (ptrdiff_t k = 0; k < n; k++)
            if (unknown[k] >= 0) x[unknown[k]] = u[k];
        for (int j = 0; j < m.n; j++)
            for (int p = m.start[j]; p < m.start[j + 1]; p++) {
                CHECK(m.row[p] >= j);
                y[m.row[p]] += m.value[p] * x[j];
                if (m.row[p] != j) y[j] += m.value[p] * x[m.row[p]];
            }
        memset(f, 0, sizeof(double) * (size_t)n);
        for (ptrdiff_t k = 0; k < n; k++) {
            if (unknown[k] >= 0)
                f[k] = y[unknown[k]];
            else
                want[k] = 0.0;
            CHECK(sum[k] >= fabs(want[k])); /* |u| <= 1 */
        }
        CHECK_ABS(field_difference(n, f, want), 0.0, round_off);
        free(unknown), free(u), free(f), free(want), free(sum), free(x), free(y);
        ph_i_csc_clear(&m);
        ph_i_bondlist_free(&list);
        free_case(&c);
    }
    CHECK_END();
}

/* Linear fields have their gradient at every point, cut families among them, and no force
 * inside; a body cut at its faces has no force under a rigid motion. */
static void one_sided(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_error err = PH_ERROR_INIT;
    for (int k = 0; k < 4; k++) {
        bool stress = k >= 2;
        ptrdiff_t n[3] = {7, 8, 1};
        random_case c =
            new_case(&seed, PH_PLANE_STRAIN, n, false,
                     stress ? PH_POINTS_STRESS : PH_POINTS_NODES, 2.0, influence_at(2),
                     k % 2 ? PH_STABILISE_SUBPOINT : PH_STABILISE_SPECTRAL, 0.1);
        const ph_grid *g = &c.micro->grid;
        /* The body is the first cells of the box: the last row along each axis is nodes
         * only, or nothing. */
        c.params.one_sided = true;
        for (int d = 0; d < 3; d++)
            c.params.rve[d] = n[d] > 1 ? n[d] - 1 : 1;
        ph_bondlist *list = NULL;
        CHECK_OK(ph_i_bondlist_new(g, c.map, &c.params, NULL, &list, &err));
        ptrdiff_t cells = ph_grid_cells(g);
        double *u = random_field(&seed, 2 * cells), *e = random_field(&seed, 3 * cells);
        double *f = random_field(&seed, 2 * cells), G[4], size = 0.0;
        for (int i = 0; i < 4; i++)
            G[i] = check_uniform(&seed, -1, 1);
        for (int rigid = 0; rigid < 2; rigid++) {
            if (rigid) G[0] = G[3] = 0.0, G[1] = -G[2];
            for (ptrdiff_t x = 0; x < cells; x++) {
                double X = (double)(x / n[1]) * g->h[0], Y = (double)(x % n[1]) * g->h[1];
                u[x] = G[0] * X + G[1] * Y;
                u[cells + x] = G[2] * X + G[3] * Y;
            }
            ph_i_bondlist_strain(list, u, NULL, e);
            for (ptrdiff_t x = 0; x < cells; x++) {
                bool in = x / n[1] < n[0] - 1 && x % n[1] < n[1] - 1;
                CHECK_ABS(e[x], in ? G[0] : 0.0, 1e-13);
                CHECK_ABS(e[cells + x], in ? G[3] : 0.0, 1e-13);
                CHECK_ABS(e[2 * cells + x], in ? (G[1] + G[2]) / sqrt(2) : 0.0, 1e-13);
            }
            ph_i_bondlist_apply(list, u, f);
            for (ptrdiff_t x = 0; x < 2 * cells; x++)
                size = fmax(size, fabs(f[x]));
            if (rigid) CHECK_ABS(size, 0.0, 1e-12);
            size = 0.0;
        }
        free(u), free(e), free(f);
        ph_i_bondlist_free(&list);
        free_case(&c);
    }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stress_points_smallest),
        cmocka_unit_test(local),
        cmocka_unit_test(nodes_without),
        cmocka_unit_test(nodes_spectral),
        cmocka_unit_test(nodes_subpoint),
        cmocka_unit_test(stress_without),
        cmocka_unit_test(stress_spectral),
        cmocka_unit_test(stress_subpoint),
        cmocka_unit_test(matrix),
        cmocka_unit_test(one_sided),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
