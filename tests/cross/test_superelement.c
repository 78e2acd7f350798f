/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The RVE condensed to its faces: what it must leave alone, and ph_homogenise. */
#include <perihom/superelement.h>

#include "check.h"
#include "io/hdf5.h"
#include "solve.h"

#include <unistd.h>

#define S .stabilisation = PH_STABILISE_SPECTRAL, .stabilisation_value = 1e-2
#define P .stabilisation = PH_STABILISE_SUBPOINT, .stabilisation_value = 0.1

/* Every kind of family, and of plane. */
static const struct way {
    ph_kinematics kin;
    ptrdiff_t n;
    double stiff, fraction;
    ph_model_params model;
} ways[] = {
    {PH_PLANE_STRAIN, 12, 20, 0.4, {.kind = "local"}},
    {PH_PLANE_STRESS, 9, 0.05, 0.3, {.kind = "local"}},
    {PH_SPACE, 5, 20, 0.2, {.kind = "local"}},
    {PH_GENERALISED_STRAIN, 9, 20, 0.3, {.kind = "local"}},
    {PH_PLANE_STRAIN, 9, 20, 0.3, {.points = PH_POINTS_STRESS, P}},
    {PH_PLANE_STRESS, 8, 20, 0.3, {.points = PH_POINTS_STRESS, .horizon = 2.0, S}},
    {PH_PLANE_STRAIN, 10, 20, 0.3, {.points = PH_POINTS_NODES, .horizon = 2.0, S}},
    {PH_GENERALISED_STRAIN, 9, 5, 0.3, {.points = PH_POINTS_NODES, .horizon = 1.5, P}},
    {PH_SPACE, 5, 5, 0.2, {.points = PH_POINTS_NODES, .horizon = 1.0, S}},
    {PH_PLANE_STRESS, 11, 20, 0.3, {.kind = "bond", .horizon = 3.0}},
    {PH_PLANE_STRAIN, 9, 0.1, 0.3, {.kind = "bond", .horizon = 2.0, .kappa = 3.0}},
    {PH_SPACE, 5, 5, 0.2, {.kind = "bond", .horizon = 1.5}},
};
enum { WAYS = sizeof ways / sizeof *ways };

static ph_superelement *condensed(ph_microstructure *m, const ph_model_params *model)
{
    ph_error err = PH_ERROR_INIT;
    ph_problem p = {.micro = m, .model = *model};
    ph_superelement *e = NULL;
    CHECK_OK(ph_superelement_new(&p, &one_thread, &e, &err));
    assert_non_null(e);
    return e;
}

static ph_microstructure *cell_of(const struct way *w)
{
    const bool bond = w->model.kind && strcmp(w->model.kind, "bond") == 0;
    const double nu = bond ? ph_bond_poisson(w->kin) : 0.3;
    return round_cell(w->kin, w->n, w->fraction, isotropic("one", 1, nu),
                      isotropic("other", w->stiff, bond ? nu : 0.2));
}

static ptrdiff_t size_of(const ph_superelement *e)
{
    return e->nd * e->nodes + e->strains;
}

/* The same elements by conjugate gradients to 1e-10: their error is its square. */
static void stiffness_is_that_of_homogenise(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    for (int which = 0; which < WAYS; which++) {
        ph_microstructure *m = cell_of(&ways[which]);
        ph_superelement *e = condensed(m, &ways[which].model);
        ph_problem p = {
            .micro = m, .model = ways[which].model, .solver.tolerance = 1e-10};
        ph_result *r = NULL;
        CHECK_OK(ph_homogenise(&p, &one_thread, &r, &err));
        const double size = ph_sym4_norm(&r->stiffness);
        ph_sym4 gap = ph_sym4_combine(1, &e->periodic, -1, &r->stiffness);
        CHECK_ABS(ph_sym4_norm(&gap), 0, 1e-9 * size);
        ph_result_free(&r);
        p.constraint.kind = "linear_displacement";
        CHECK_OK(ph_homogenise(&p, &one_thread, &r, &err));
        gap = ph_sym4_combine(1, &e->linear, -1, &r->stiffness);
        CHECK_ABS(ph_sym4_norm(&gap), 0, 1e-9 * size);
        /* Held faces are stiffer than paired ones: the difference is positive semidefinite. */
        double least, most;
        gap = ph_sym4_combine(1, &e->linear, -1, &e->periodic);
        ph_sym4_eigenvalues(&gap, &least, &most);
        CHECK(least > -1e-12 * size && most > 1e-3 * size);
        ph_result_free(&r);
        ph_superelement_free(&e);
        ph_microstructure_free(&m);
    }
    CHECK_END();
}

/* Symmetric, rigid motions without force, no negative energy of random displacements. */
static void rigid_motions_cost_nothing(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int which = 0; which < WAYS; which++) {
        ph_microstructure *m = cell_of(&ways[which]);
        ph_superelement *e = condensed(m, &ways[which].model);
        const ptrdiff_t n = size_of(e);
        double *u = calloc((size_t)n, sizeof *u), worst = 0, largest = 0;
        for (int mode = 0; mode < e->nd + 1; mode++) {
            memset(u, 0, sizeof *u * (size_t)n);
            for (ptrdiff_t k = 0; k < e->nodes; k++) {
                for (int a = 0; a < e->nd; a++)
                    u[k * e->nd + a] = a == mode;
                if (mode == e->nd) { /* turn about axis 3 */
                    u[k * e->nd] = -e->position[k][1];
                    u[k * e->nd + 1] = e->position[k][0];
                }
            }
            for (ptrdiff_t i = 0; i < n; i++) {
                double f = 0;
                for (ptrdiff_t j = 0; j < n; j++) {
                    f += e->stiffness[i * n + j] * u[j];
                    largest = fmax(largest, fabs(e->stiffness[i * n + j]));
                    CHECK(e->stiffness[i * n + j] == e->stiffness[j * n + i]);
                }
                worst = fmax(worst, fabs(f));
            }
        }
        CHECK_ABS(worst, 0, 1e-12 * largest * (double)n);
        for (int trial = 0; trial < 5; trial++) {
            double energy = 0;
            for (ptrdiff_t i = 0; i < n; i++)
                u[i] = check_uniform(&seed, -1, 1);
            for (ptrdiff_t i = 0; i < n; i++)
                for (ptrdiff_t j = 0; j < n; j++)
                    energy += u[i] * e->stiffness[i * n + j] * u[j];
            CHECK(energy > 0);
        }
        free(u);
        ph_superelement_free(&e);
        ph_microstructure_free(&m);
    }
    CHECK_END();
}

/* Of a homogeneous cell both stiffnesses are that of its material, whatever the sides. */
static void homogeneous(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    ph_material m = anisotropic("m", &seed);
    ph_microstructure *micro = NULL;
    ph_grid g = box_grid(PH_SPACE, 4, 3, 2, 1.0, 2.0, 0.7);
    CHECK_OK(ph_microstructure_new(&g, 1, &m, &micro, &err));
    ph_superelement *e = condensed(micro, &ways[0].model);
    CHECK(e->nodes == 5 * 4 * 3 - 3 * 2 * 1 && e->condensed == 3 * 3 * 2 * 1);
    ph_sym4 gap = ph_sym4_combine(1, &e->linear, -1, &m.stiffness);
    CHECK_ABS(ph_sym4_norm(&gap), 0, 1e-12 * ph_sym4_norm(&m.stiffness));
    gap = ph_sym4_combine(1, &e->periodic, -1, &m.stiffness);
    CHECK_ABS(ph_sym4_norm(&gap), 0, 1e-12 * ph_sym4_norm(&m.stiffness));
    char *text = NULL;
    CHECK_OK(ph_superelement_to_mtx(e, &text, &err));
    CHECK(text && strncmp(text, "%%MatrixMarket matrix array real symmetric\n", 43) == 0);
    free(text);
    ph_superelement_free(&e);
    ph_superelement_free(&e);
    ph_microstructure_free(&micro);
    CHECK_END();
}

/* ---- assembly ---------------------------------------------------------------------------- */

/* Number of a node among those of `list`, or a new one. */
static ptrdiff_t find_node(double (*list)[3], ptrdiff_t *count, const double at[3])
{
    for (ptrdiff_t k = 0; k < *count; k++)
        if (fabs(list[k][0] - at[0]) + fabs(list[k][1] - at[1]) < 1e-9) return k;
    memcpy(list[*count], at, sizeof *list);
    return (*count)++;
}

/* Eliminate the displacements from `first` on, in place. */
static void eliminate(double *K, ptrdiff_t n, ptrdiff_t first)
{
    for (ptrdiff_t k = n - 1; k >= first; k--)
        for (ptrdiff_t i = 0; i < k; i++) {
            const double f = K[i * n + k] / K[k * n + k];
            for (ptrdiff_t j = 0; f != 0.0 && j < k; j++)
                K[i * n + j] -= f * K[k * n + j];
        }
}

/* S of the pair, of `kept` displacements: those of the whole come first. */
static double *join(const ph_superelement *a, const ph_superelement *whole,
                    ptrdiff_t *size)
{
    const int nd = a->nd;
    ptrdiff_t room = whole->nodes + 2 * a->nodes, nodes = whole->nodes;
    double(*at)[3] = calloc((size_t)room, sizeof *at);
    const ptrdiff_t N = nd * room;
    double *K = calloc((size_t)(N * N), sizeof *K);
    ptrdiff_t *to = calloc((size_t)a->nodes, sizeof *to);
    assert_true(at && K && to);
    memcpy(at, whole->position, sizeof *at * (size_t)nodes);
    for (int part = 0; part < 2; part++) {
        for (ptrdiff_t k = 0; k < a->nodes; k++) {
            const double x[3] = {a->position[k][0] + part, a->position[k][1], 0};
            to[k] = find_node(at, &nodes, x);
        }
        for (ptrdiff_t i = 0; i < nd * a->nodes; i++)
            for (ptrdiff_t j = 0; j < nd * a->nodes; j++)
                K[(nd * to[i / nd] + i % nd) * N + nd * to[j / nd] + j % nd] +=
                    a->stiffness[i * nd * a->nodes + j];
    }
    *size = nd * nodes;
    double *tight = calloc((size_t)(*size * *size), sizeof *tight);
    assert_non_null(tight);
    for (ptrdiff_t i = 0; i < *size; i++)
        memcpy(tight + i * *size, K + i * N, sizeof *K * (size_t)*size);
    free(at);
    free(K);
    free(to);
    return tight;
}

/* Two RVEs side by side are one of twice the length: their superelements, added up where they
 * share nodes, and what the pair encloses eliminated, are its superelement. Energies of points
 * and bonds at the common face are counted once. */
static void two_are_one(void **state)
{
    (void)state;
    for (int which = 0; which < WAYS; which++) {
        const struct way *w = &ways[which];
        if (w->kin == PH_SPACE || w->kin == PH_GENERALISED_STRAIN) continue;
        ph_error err = PH_ERROR_INIT;
        ph_microstructure *half = cell_of(w), *whole = NULL;
        ph_grid g = box_grid(w->kin, 2 * w->n, w->n, 1, 2, 1, 1);
        CHECK_OK(ph_microstructure_new(&g, 2, half->materials, &whole, &err));
        half->ncuts = 0;
        for (ptrdiff_t x = 0; x < 2 * w->n * w->n; x++)
            whole->phase[x] = half->phase[x % (w->n * w->n)];
        ph_superelement *a = condensed(half, &w->model), *c = condensed(whole, &w->model);
        ptrdiff_t n, kept = size_of(c);
        double *K = join(a, c, &n), most = 0.0, off = 0.0;
        eliminate(K, n, kept);
        for (ptrdiff_t i = 0; i < kept; i++)
            for (ptrdiff_t j = 0; j < kept; j++) {
                most = fmax(most, fabs(c->stiffness[i * kept + j]));
                off = fmax(off, fabs(c->stiffness[i * kept + j] - K[i * n + j]));
            }
        CHECK(n > kept);
        CHECK_ABS(off, 0, 1e-11 * most); /* round-off of two eliminations */
        free(K);
        ph_superelement_free(&a);
        ph_superelement_free(&c);
        ph_microstructure_free(&half);
        ph_microstructure_free(&whole);
    }
    CHECK_END();
}

/* The HDF5 file holds the same doubles. */
static void rows_in_hdf5(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    char folder[] = "/tmp/perihom-superelement-XXXXXX", path[64];
    ph_microstructure *m = cell_of(&ways[9]); /* bonds: not every pair of nodes */
    ph_superelement *e = condensed(m, &ways[9].model);
    const ptrdiff_t n = size_of(e);
    ptrdiff_t count = 0;
    for (ptrdiff_t i = 0; i < n * n; i++)
        count += e->stiffness[i] != 0.0;
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/s.h5", folder);
    CHECK_OK(ph_superelement_write_h5(e, path, &err));
    const hsize_t ends = (hsize_t)n + 1, all = (hsize_t)count,
                  where[2] = {(hsize_t)e->nodes, 3};
    int64_t *start = calloc((size_t)n + 1, sizeof *start);
    int32_t *column = calloc((size_t)count, sizeof *column);
    double *value = calloc((size_t)count, sizeof *value),
           *position = calloc((size_t)e->nodes, 3 * sizeof *position);
    assert_true(start && column && value && position);
    hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
    CHECK_OK(ph_i_hdf5_get_array(file, "stiffness/indptr", H5T_NATIVE_INT64, 1, &ends,
                                 start, path, &err));
    CHECK_OK(ph_i_hdf5_get_array(file, "stiffness/indices", H5T_NATIVE_INT32, 1, &all,
                                 column, path, &err));
    CHECK_OK(ph_i_hdf5_get_array(file, "stiffness/data", H5T_NATIVE_DOUBLE, 1, &all,
                                 value, path, &err));
    CHECK_OK(ph_i_hdf5_get_array(file, "position", H5T_NATIVE_DOUBLE, 2, where, position,
                                 path, &err));
    H5Fclose(file);
    CHECK(memcmp(position, e->position, sizeof *e->position * (size_t)e->nodes) == 0);
    CHECK(start[n] == count && count < n * n);
    for (ptrdiff_t i = 0; i < n; i++)
        for (int64_t k = start[i]; k < start[i + 1]; k++)
            CHECK(value[k] == e->stiffness[i * n + column[k]]);
    snprintf(path, sizeof path, "%s/nowhere/s.h5", folder);
    CHECK(ph_superelement_write_h5(e, path, NULL) == PH_EIO);
    snprintf(path, sizeof path, "%s/s.h5", folder);
    unlink(path);
    rmdir(folder);
    free(start);
    free(column);
    free(value);
    free(position);
    ph_superelement_free(&e);
    ph_microstructure_free(&m);
    CHECK_END();
}

static void refusals(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_superelement *e = NULL;
    ph_material m = isotropic("m", 1, 1.0 / 3);
    ph_microstructure *plane = round_cell(PH_PLANE_STRESS, 6, 0.3, m, m);
    ph_microstructure *row = NULL;
    ph_grid g = box_grid(PH_PLANE_STRESS, 6, 1, 1, 1, 1, 1);
    ph_cracks cracks = {0};
    const double line[2][3] = {{0.2, 0.5, 0}, {0.6, 0.5, 0}};
    CHECK_OK(ph_microstructure_new(&g, 1, &m, &row, &err));
    CHECK_OK(ph_cracks_add_line(&cracks, 2, line, &err));
    ph_problem p = {.micro = NULL, .model.kind = "local"};
    CHECK(ph_superelement_new(&p, NULL, &e, &err) == PH_EINVAL && !e && err.msg[0]);
    p.micro = row;
    CHECK(ph_superelement_new(&p, NULL, &e, NULL) == PH_EINVAL && !e);
    p.micro = plane;
    p.model = (ph_model_params){.kind = "bond", .horizon = 3.0};
    CHECK(ph_superelement_new(&p, NULL, &e, NULL) == PH_EINVAL &&
          !e); /* no node inside */
    p.model.horizon = 2.0;
    p.cracks = &cracks;
    CHECK(ph_superelement_new(&p, NULL, &e, NULL) == PH_EINVAL && !e);
    p.cracks = NULL;
    CHECK_OK(ph_superelement_new(&p, NULL, &e, &(ph_error)PH_ERROR_INIT));
    ph_superelement_free(&e);
    ph_cracks_free(&cracks);
    ph_microstructure_free(&plane);
    ph_microstructure_free(&row);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stiffness_is_that_of_homogenise),
        cmocka_unit_test(rigid_motions_cost_nothing),
        cmocka_unit_test(homogeneous),
        cmocka_unit_test(two_are_one),
        cmocka_unit_test(rows_in_hdf5),
        cmocka_unit_test(refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
