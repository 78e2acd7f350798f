/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The energy of the operator, cell by cell from the strains of its sites and, in cut cells,
 * layer by layer from strains that meet at the interface: the laminate's own stiffness is
 * the other route. Every kinematics, route and stabilisation without (S). */
#include "check.h"
#include "effective/visco_layers.h"
#include "random_cases.h"

/* Sums of a few thousand products; a laminate is inverted in both ways. */
static const double round_off = 1e-11;

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
    {PH_GENERALISED_STRAIN, {9, 1, 1}},
};
enum { SHAPES = sizeof shapes / sizeof *shapes };

static ph_status phases(const random_case *c, ph_sym4 *reduced, ph_sym4 *space,
                        ph_error *err)
{
    ph_status st = PH_OK;
    for (int p = 0; p < c->micro->nmaterials && st == PH_OK; p++) {
        space[p] = c->micro->materials[p].stiffness;
        st = ph_sym4_reduce(&space[p], c->micro->grid.kinematics, &reduced[p], err);
    }
    return st;
}

/* Twice the energy over V of the cells of the layers. */
static double layered(random_case *c, ph_layers *layers, ph_sites *sites, const double *u,
                      const double *macro)
{
    ph_error err = PH_ERROR_INIT;
    ph_sym4 reduced[4], space[4];
    size_t n = (size_t)(sites->records * layers->record);
    double sum = 0.0, *x = calloc(n + 1, sizeof *x), *y = calloc(n + 1, sizeof *y);
    double *e = calloc((size_t)(sites->records * c->map->ns) * (size_t)layers->count + 1,
                       sizeof *e);
    CHECK_OK(phases(c, reduced, space, &err));
    ph_i_sites_strain(sites, u, macro, e);
    CHECK_OK(ph_i_layers_localise(layers, sites, reduced, space, e, x, &err));
    ph_i_layers_stress(layers, sites, reduced, space, x, y);
    for (size_t i = 0; i < n; i++)
        sum += x[i] * y[i];
    free(x), free(y), free(e);
    return sum;
}

/* The operator with cut cells empty holds the whole cells, the layers the rest. */
static void compare(random_case *c, ph_route route, uint64_t *seed)
{
    ph_error err = PH_ERROR_INIT;
    ph_operator *op = NULL;
    ph_split split = {0};
    ph_layers layers = {0};
    ph_sites sites = {0};
    ph_sym4 reduced[4], space[4];
    double *u = random_field(seed, displacements(c)), macro[6], stress[6], strain[6];
    ph_cell_energy all, whole;
    for (int i = 0; i < 6; i++)
        macro[i] = check_uniform(seed, -1, 1);
    c->params.route = route;
    CHECK_OK(
        ph_i_operator_new(&c->micro->grid, c->map, &c->params, &c->meter, &op, &err));
    CHECK_OK(ph_i_split_new(c->micro->nmaterials, c->micro->materials, &split, &err));
    CHECK_OK(ph_i_layers_init(&layers, c->micro, &split, c->map, NULL, &err));
    CHECK_OK(ph_i_sites_init(&sites, op, layers.count, layers.cell, &err));
    CHECK_OK(ph_i_operator_sums(op, u, macro, NULL, stress, strain, &all, &err));
    CHECK_OK(phases(c, reduced, space, &err));
    CHECK_OK(ph_i_stiffness_map_set(c->map, c->micro, reduced, false, &err));
    CHECK_OK(ph_i_operator_sums(op, u, macro, NULL, stress, strain, &whole, &err));
    CHECK(layers.count == c->micro->ncuts);
    double parts = whole.mean + whole.modes + layered(c, &layers, &sites, u, macro);
    CHECK_REL(parts, all.mean + all.modes, round_off);
    CHECK(whole.mean + whole.modes <
          0.99 * (all.mean + all.modes)); /* both have a part */
    CHECK_OK(ph_i_stiffness_map_set(c->map, c->micro, reduced, true, &err));
    free(u);
    ph_i_sites_clear(&sites);
    ph_i_layers_clear(&layers);
    ph_i_split_clear(&split);
    ph_i_operator_free(&op);
}

static void layers_hold_the_energy_of_laminates(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int i = 0; i < SHAPES; i++)
        for (int voids = 0; voids < 2; voids++) {
            random_case c = new_case(&seed, shapes[i].kin, shapes[i].n, voids,
                                     PH_POINTS_AUTO, 0, NULL, PH_STABILISE_NONE, 0);
            compare(&c, PH_ROUTE_AUTO, &seed);
            free_case(&c);
            for (int p = 0; p < 2; p++) {
                c = new_case(&seed, shapes[i].kin, shapes[i].n, voids, PH_POINTS_STRESS,
                             1.0, influence_at(0),
                             p ? PH_STABILISE_SUBPOINT : PH_STABILISE_NONE, 0.1 * p);
                compare(&c, PH_ROUTE_AUTO, &seed);
                if (!voids) compare(&c, PH_ROUTE_BONDS, &seed);
                free_case(&c);
                c = new_case(&seed, shapes[i].kin, shapes[i].n, voids, PH_POINTS_NODES,
                             1.3, influence_at(0),
                             p ? PH_STABILISE_SUBPOINT : PH_STABILISE_NONE, 0.1 * p);
                compare(&c, PH_ROUTE_STENCIL, &seed);
                compare(&c, PH_ROUTE_CONVOLUTION, &seed);
                free_case(&c);
            }
        }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(layers_hold_the_energy_of_laminates),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
