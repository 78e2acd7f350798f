/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Springs: products and a rest, by FFT or directly, against the sum over bonds. */
#include "check.h"
#include "model/operator.h"
#include "random_cases.h"

#include <string.h>

/* Sums of a few hundred terms of both signs, and transforms: round-off only. */
static const double round_off = 1e-12;

typedef struct medium {
    ph_microstructure *micro;
    ph_stiffness_map *map;
    ph_family *family;
    ph_bond_lattice lattice;
    ph_bond_classes *classes;
    ph_operator_params params;
    ph_meter meter;
} medium;

static const struct {
    ph_kinematics kin;
    ptrdiff_t n[3];
    double spacings;
} shapes[] = {
    {PH_PLANE_STRESS, {12, 9, 1}, 3.2}, {PH_PLANE_STRAIN, {7, 8, 1}, 2.0},
    {PH_PLANE_STRESS, {4, 13, 1}, 3.0}, /* families that meet themselves */
    {PH_PLANE_STRESS, {1, 11, 1}, 2.5}, /* bonds to images along an axis of one cell */
    {PH_SPACE, {6, 5, 7}, 2.1},         {PH_SPACE, {1, 6, 5}, 1.5},
};
enum { SHAPES = sizeof shapes / sizeof *shapes };

/* Three solids and a void; fillers of any material, some next to each other. */
static ph_microstructure *random_fillers(uint64_t *seed, ph_kinematics kin,
                                         const ptrdiff_t *n, double share, bool owners)
{
    ph_error err = PH_ERROR_INIT;
    ph_material m[4];
    ph_grid grid;
    ph_microstructure *micro = NULL;
    double size[3], nu = ph_bond_poisson(kin);
    for (int d = 0; d < 3; d++)
        size[d] = (double)n[d] * check_uniform(seed, 0.9, 1.1);
    CHECK_OK(ph_material_isotropic("matrix", 3.5, nu, &m[0], &err));
    CHECK_OK(ph_material_isotropic("clay", 178.0, nu, &m[1], &err));
    CHECK_OK(ph_material_isotropic("rubber", 0.1, nu, &m[2], &err));
    m[3] = ph_material_void("hole");
    CHECK_OK(ph_grid_init(&grid, kin, n, size, &err));
    CHECK_OK(ph_microstructure_new(&grid, 4, m, &micro, &err));
    if (!micro) return NULL;
    ptrdiff_t cells = ph_grid_cells(&grid);
    if (owners) micro->owner = calloc((size_t)cells, sizeof *micro->owner);
    for (ptrdiff_t x = 0; x < cells; x++) {
        if (check_random(seed) > share) continue;
        micro->phase[x] = (uint16_t)(4 * check_random(seed));
        if (owners) micro->owner[x] = (int32_t)(4 * check_random(seed));
    }
    return micro;
}

static medium new_medium(uint64_t *seed, size_t shape, double share, bool owners,
                         double kappa)
{
    ph_error err = PH_ERROR_INIT;
    medium m = {
        .micro = random_fillers(seed, shapes[shape].kin, shapes[shape].n, share, owners)};
    const ph_grid *g = &m.micro->grid;
    size_t profile = (size_t)((double)ph_nmicromoduli * check_random(seed));
    CHECK_OK(ph_i_stiffness_map_new(m.micro, PH_INTERFACE_NODE_CENTRE, false, NULL,
                                    ph_grid_cells(g), &m.meter, &m.map, &err));
    CHECK_OK(ph_bond_family_new(g, shapes[shape].spacings * 1.2, &ph_micromoduli[profile],
                                1.0, &ph_volume_weights[1], PH_CALIBRATE_LATTICE,
                                &m.family, &m.lattice, &err));
    CHECK_OK(
        ph_i_bond_classes_new(m.micro, kappa, NULL, ph_grid_cells(g), &m.classes, &err));
    m.params.family = m.family;
    m.params.classes = m.classes;
    m.params.threads = 1;
    return m;
}

static void free_medium(medium *m)
{
    ph_i_bond_classes_free(&m->classes);
    ph_family_free(&m->family);
    ph_i_stiffness_map_free(&m->meter, &m->map);
    ph_microstructure_free(&m->micro);
}

static ph_operator *new_operator(medium *m, ph_route route)
{
    ph_error err = PH_ERROR_INIT;
    ph_operator *op = NULL;
    m->params.route = route;
    CHECK_OK(
        ph_i_operator_new(&m->micro->grid, m->map, &m->params, &m->meter, &op, &err));
    return op;
}

static double inner(ptrdiff_t n, const double *a, const double *b)
{
    double s = 0.0;
    for (ptrdiff_t i = 0; i < n; i++)
        s += a[i] * b[i];
    return s;
}

static double distance(ptrdiff_t n, const double *a, const double *b)
{
    double s = 0.0;
    for (ptrdiff_t i = 0; i < n; i++)
        s += (a[i] - b[i]) * (a[i] - b[i]);
    return sqrt(s);
}

/* The load from the definition. */
static void plain_load(const ph_springs *s, const double *macro, double *f)
{
    ptrdiff_t n = s->layout.cells;
    memset(f, 0, sizeof(double) * (size_t)(s->layout.nd * n));
    for (ptrdiff_t x = 0; x < n; x++)
        for (ptrdiff_t b = 0; b < s->family->count; b++) {
            const double *xi = s->family->xi[b];
            double t = s->family->w[b] *
                       ph_i_springs_modulus(s, x, b, ph_i_springs_end(s, x, b)) *
                       ph_i_springs_stretch(s->layout.nd, xi, macro);
            for (int a = 0; a < s->layout.nd; a++)
                f[a * n + x] += t * xi[a];
        }
}

static void compare(medium *m, ph_route route, uint64_t *seed)
{
    ph_error err = PH_ERROR_INIT;
    ph_operator *op = new_operator(m, route);
    ptrdiff_t n = op->layout.nd * op->layout.cells;
    double *u = random_field(seed, n), *v = random_field(seed, n);
    double *f = random_field(seed, n), *g = random_field(seed, n), macro[6];
    for (int i = 0; i < 6; i++)
        macro[i] = check_uniform(seed, -1, 1);
    ph_i_operator_apply(op, u, f);
    ph_i_springs_plain_apply(op->springs, u, g);
    CHECK(field_difference(n, f, g) < round_off);
    double uAv = inner(n, v, f);
    ph_i_operator_apply(op, v, g);
    CHECK_ABS(inner(n, u, g), uAv, round_off * sqrt(inner(n, u, u) * inner(n, g, g)));
    CHECK(inner(n, v, g) >= 0.0);
    ph_i_operator_load(op, macro, f);
    plain_load(op->springs, macro, g);
    /* a uniform medium has no load: round-off of a modulus of a few units then */
    CHECK(distance(n, f, g) < round_off * (sqrt(inner(n, g, g)) + sqrt((double)n)));
    /* sums: energy = stress : strain of an affine and a fluctuating part */
    double stress[6], strain[6];
    ph_cell_energy w;
    CHECK_OK(ph_i_operator_sums(op, u, macro, NULL, stress, strain, &w, &err));
    ph_i_operator_apply(op, u, f);
    double work = inner(n, u, f) - 2.0 * inner(n, u, g), affine = 0.0;
    ph_cell_energy rigid;
    double none[6], zero[6];
    double *still = calloc((size_t)n, sizeof *still);
    CHECK_OK(ph_i_operator_sums(op, still, macro, NULL, none, zero, &rigid, &err));
    affine = rigid.mean;
    CHECK_REL(w.mean, work + affine, 1e-10);
    CHECK_REL(inner(op->layout.ns, none, macro), affine, 1e-10);
    CHECK_REL(inner(op->layout.ns, stress, macro), affine - inner(n, u, g),
              1e-10 * (1.0 + fabs(affine / (affine - inner(n, u, g)))));
    free(still);
    free(u), free(v), free(f), free(g);
    ph_i_operator_free(&op);
}

/* The same with springs broken at random, all of them at some nodes. */
static void routes_agree_broken(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_error err = PH_ERROR_INIT;
    for (size_t i = 0; i < SHAPES; i++) {
        medium m = new_medium(&seed, i, 0.5, true, 0.1);
        ph_broken *broken = NULL;
        CHECK_OK(ph_i_broken_new(&m.micro->grid, m.family, &m.meter, &broken, &err));
        for (ptrdiff_t x = 0; broken && x < ph_grid_cells(&m.micro->grid); x++)
            for (ptrdiff_t b = 0; b < m.family->count; b++)
                if (check_random(&seed) < 0.2 || x % 9 == 0)
                    CHECK_OK(ph_i_break(broken, x, b, &err));
        CHECK_OK(ph_i_broken_settle(broken, &err));
        m.params.broken = broken;
        compare(&m, PH_ROUTE_STENCIL, &seed);
        compare(&m, PH_ROUTE_CONVOLUTION, &seed);
        ph_i_broken_free(&broken);
        free_medium(&m);
    }
    CHECK_END();
}

static void routes_agree(void **state)
{
    (void)state;
    static const double kappas[] = {0.0, 0.1, 15.0};
    uint64_t seed = check_seed();
    for (int k = 0; k < check_trials(6); k++)
        for (size_t i = 0; i < SHAPES; i++) {
            double share = k % 2 ? 0.1 : 0.8;
            medium m = new_medium(&seed, i, share, k % 3 != 0, kappas[k % 3]);
            compare(&m, PH_ROUTE_STENCIL, &seed);
            compare(&m, PH_ROUTE_CONVOLUTION, &seed);
            free_medium(&m);
        }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(routes_agree),
                                       cmocka_unit_test(routes_agree_broken)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
