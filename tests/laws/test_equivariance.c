/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What does not depend on how a microstructure is looked at: shifts of the periodic cell,
 * turns and mirrors of it with its grid (unequal numbers of cells, unequal spacing), the
 * number of threads. */
#include "random_cases.h"
#include "solve.h"

typedef struct plan {
    const char *model;
    ph_points points;
    double horizon;
    ph_stabilisation stabilisation;
} plan;
static const plan plans[] = {
    {"local", PH_POINTS_AUTO, 0, PH_STABILISE_AUTO},
    {"nosb", PH_POINTS_STRESS, 0, PH_STABILISE_SPECTRAL},
    {"nosb", PH_POINTS_STRESS, 0, PH_STABILISE_SUBPOINT},
    {"nosb", PH_POINTS_STRESS, 1.6, PH_STABILISE_SPECTRAL},
    {"nosb", PH_POINTS_NODES, 1, PH_STABILISE_SPECTRAL},
    {"nosb", PH_POINTS_NODES, 2, PH_STABILISE_SPECTRAL},
    {"nosb", PH_POINTS_NODES, 2, PH_STABILISE_SUBPOINT},
};
enum { PLANS = 7 };

static const ph_kinematics kinematics[] = {PH_SPACE, PH_GENERALISED_STRAIN,
                                           PH_PLANE_STRAIN, PH_PLANE_STRESS};

static ph_problem planned(const ph_microstructure *micro, const plan *how)
{
    ph_problem p = {.micro = micro, .solver = {.tolerance = 1e-9}};
    p.model.kind = how->model;
    p.model.points = how->points;
    p.model.horizon = how->horizon;
    p.model.stabilisation = how->stabilisation;
    return p;
}

static ph_microstructure *random_cell(ph_kinematics kin, uint64_t *seed)
{
    ptrdiff_t n[3] = {7, 8, kin == PH_SPACE ? 6 : 1};
    return random_micro(seed, kin, n, false);
}

/* Axis d goes to sign[d] times axis to[d], cells move by shift[d] first. */
typedef struct motion {
    int to[3];
    int sign[3];
    ptrdiff_t shift[3];
} motion;

static ptrdiff_t moved_cell(const ph_grid *from, const ph_grid *grid, const motion *move,
                            ptrdiff_t x)
{
    ptrdiff_t at[3] = {x / (from->n[1] * from->n[2]), x / from->n[2] % from->n[1],
                       x % from->n[2]};
    ptrdiff_t there[3];
    for (int d = 0; d < 3; d++) {
        ptrdiff_t i = (at[d] + move->shift[d]) % from->n[d];
        there[move->to[d]] = move->sign[d] > 0 ? i : from->n[d] - 1 - i;
    }
    return (there[0] * grid->n[1] + there[1]) * grid->n[2] + there[2];
}

static int by_cell(const void *a, const void *b)
{
    ptrdiff_t i = ((const ph_cut *)a)->cell, j = ((const ph_cut *)b)->cell;
    return (i > j) - (i < j);
}

/* The moved microstructure (one cut a cell), with its materials turned. */
static ph_microstructure *moved(const ph_microstructure *m, const motion *move,
                                double R[9])
{
    ph_error err = PH_ERROR_INIT;
    const ph_grid *g = &m->grid;
    ph_microstructure *out = NULL;
    ptrdiff_t n[3];
    double size[3];
    memset(R, 0, sizeof(double) * 9);
    for (int d = 0; d < 3; d++) {
        n[move->to[d]] = g->n[d];
        size[move->to[d]] = g->size[d];
        R[3 * move->to[d] + d] = move->sign[d];
    }
    ph_grid grid;
    CHECK_OK(ph_grid_init(&grid, g->kinematics, n, size, &err));
    CHECK_OK(ph_microstructure_new(&grid, m->nmaterials, m->materials, &out, &err));
    if (!out) return NULL;
    for (int a = 0; a < m->nmaterials; a++)
        out->materials[a].stiffness = ph_sym4_rotate(&m->materials[a].stiffness, R);
    for (ptrdiff_t x = 0; x < ph_grid_cells(g); x++)
        out->phase[moved_cell(g, &grid, move, x)] = m->phase[x];
    out->cuts = calloc((size_t)m->ncuts, sizeof *out->cuts);
    for (ptrdiff_t i = 0; out->cuts && i < m->ncuts; i++) {
        ph_cut *c = &out->cuts[out->ncuts++];
        *c = m->cuts[i];
        c->cell = moved_cell(g, &grid, move, m->cuts[i].cell);
        for (int d = 0; d < 3; d++)
            c->normal[move->to[d]] = move->sign[d] * m->cuts[i].normal[d];
    }
    qsort(out->cuts, (size_t)out->ncuts, sizeof *out->cuts, by_cell);
    return out;
}

static void check_motion(const ph_microstructure *m, const motion *move, const plan *how)
{
    double R[9], R2[4];
    ph_microstructure *n = moved(m, move, R);
    for (int i = 0; i < 4; i++)
        R2[i] = R[3 * (i / 2) + i % 2];
    ph_problem p = planned(m, how), q = planned(n, how);
    ph_sym4 c = stiffness_of(&p), want = ph_sym4_rotate(&c, c.n == 6 ? R : R2);
    ph_sym4 got = stiffness_of(&q);
    /* the same equations in another order: the solver stops within 1e-9 of the same */
    CHECK(difference(&got, &want) < 1e-8);
    ph_microstructure_free(&n);
}

static void test_shift(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int k = 0; k < 4; k++)
        for (int i = 0; i < PLANS; i++) {
            ph_microstructure *m = random_cell(kinematics[k], &seed);
            motion shift = {
                {0, 1, 2}, {1, 1, 1}, {3, 5, kinematics[k] == PH_SPACE ? 1 : 0}};
            check_motion(m, &shift, &plans[i]);
            ph_microstructure_free(&m);
        }
    CHECK_END();
}

/* In 3D every permutation of the axes, in 2D the one there is, with random mirrors. */
static void test_turns(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    static const int permutation[6][3] = {{1, 0, 2}, {0, 1, 2}, {0, 2, 1},
                                          {2, 1, 0}, {1, 2, 0}, {2, 0, 1}};
    for (int k = 0; k < 4; k++)
        for (int i = 0; i < PLANS; i++)
            for (int a = 0; a < (kinematics[k] == PH_SPACE ? 6 : 2); a++) {
                ph_microstructure *m = random_cell(kinematics[k], &seed);
                motion turn = {.shift = {0, 0, 0}};
                for (int d = 0; d < 3; d++) {
                    turn.to[d] = permutation[a][d];
                    turn.sign[d] = check_random(&seed) < 0.5 ? 1 : -1;
                }
                check_motion(m, &turn, &plans[i]);
                ph_microstructure_free(&m);
            }
    CHECK_END();
}

/* The same bits with 1, 2 and 3 threads, periodic and held. The cells are many enough that
 * the engine takes the threads, and no multiple of anything. One load says all. */
static void test_threads(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int k = 0; k < 4; k += 2)
        for (int i = 1; i < PLANS; i += 2) /* cells, stencil, convolution */
            for (int held = 0; held < (i == 1 ? 2 : 1); held++) {
                bool deep = kinematics[k] == PH_SPACE;
                ptrdiff_t n[3] = {deep ? 27 : 131, deep ? 26 : 127, deep ? 25 : 1};
                ph_microstructure *m = random_micro(&seed, kinematics[k], n, false);
                ph_problem p = planned(m, &plans[i]);
                p.solver.tolerance = 0.3;
                p.loads = 1u;
                ph_sym4 first = {.n = 0};
                if (held) p.constraint.kind = "linear_displacement";
                for (int threads = 1; threads <= 3; threads++) {
                    ph_error err = PH_ERROR_INIT;
                    ph_ctx ctx = {.threads = threads};
                    ph_result *res = NULL;
                    CHECK_OK(ph_homogenise(&p, &ctx, &res, &err));
                    if (!res) continue;
                    if (threads == 1) first = res->stiffness;
                    CHECK(memcmp(&first, &res->stiffness, sizeof first) == 0);
                    CHECK(res->threads == threads); /* it did take them */
                    ;
                    ph_result_free(&res);
                }
                ph_microstructure_free(&m);
            }
    CHECK_END();
}

/* Nonlocal and local on the same cell come together as h -> 0, with first order. */
static void test_local_limit(void **state)
{
    (void)state;
    for (int points = 0; points < 2; points++) {
        double h[4], apart[4];
        for (int i = 0; i < 4; i++) {
            h[i] = 1.0 / (16 << i);
            ph_microstructure *m =
                round_cell(PH_PLANE_STRAIN, 16 << i, 0.3, isotropic("matrix", 1, 0.3),
                           isotropic("fibre", 10, 0.2));
            ph_problem p = {.micro = m}, q = p;
            p.model.points = points ? PH_POINTS_STRESS : PH_POINTS_NODES;
            q.model.kind = "local";
            ph_sym4 a = stiffness_of(&p), b = stiffness_of(&q);
            apart[i] = difference(&a, &b);
            ph_microstructure_free(&m);
        }
        CHECK(fitted_order(4, h, apart) >= 0.8);
        CHECK(apart[3] < 0.01);
    }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shift), cmocka_unit_test(test_turns),
        cmocka_unit_test(test_threads), cmocka_unit_test(test_local_limit)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
