/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Laws of bond-based effective stiffness on random microstructures of fillers. */
#include <perihom/bond.h>

#include "check.h"
#include "solve.h"
#include "tensors.h"

#include <string.h>

static const struct {
    ph_kinematics kin;
    ptrdiff_t n;
    double m;
} shapes[] = {{PH_PLANE_STRESS, 12, 2.5}, {PH_PLANE_STRAIN, 10, 3.0}, {PH_SPACE, 6, 1.5}};
enum { SHAPES = sizeof shapes / sizeof *shapes };

/* Square cells; about a fifth is filler, in runs that share an owner. */
static ph_microstructure *random_fillers(uint64_t *seed, size_t shape, bool hole)
{
    ph_error err = PH_ERROR_INIT;
    ph_kinematics kin = shapes[shape].kin;
    ptrdiff_t n = shapes[shape].n;
    double nu = ph_bond_poisson(kin), L = (double)n;
    ph_material m[3];
    ph_grid g = box_grid(kin, n, n, kin == PH_SPACE ? n : 1, L, L, L);
    ph_microstructure *micro = NULL;
    CHECK_OK(ph_material_isotropic("matrix", 1.0, nu, &m[0], &err));
    CHECK_OK(ph_material_isotropic("filler", 20.0, nu, &m[1], &err));
    m[2] = ph_material_void("hole");
    CHECK_OK(ph_microstructure_new(&g, 3, m, &micro, &err));
    ptrdiff_t cells = ph_grid_cells(&g);
    micro->owner = calloc((size_t)cells, sizeof *micro->owner);
    for (int32_t id = 1; id <= 6; id++) {
        ptrdiff_t at = (ptrdiff_t)((double)cells * check_random(seed));
        for (ptrdiff_t k = 0; k < cells / 30 + 1; k++) {
            ptrdiff_t x = (at + k) % cells;
            micro->phase[x] = 1;
            micro->owner[x] = id;
        }
    }
    for (ptrdiff_t x = 0; hole && x < cells / 12; x++)
        micro->phase[x] = 2, micro->owner[x] = 0;
    return micro;
}

static ph_problem problem(const ph_microstructure *micro, size_t shape, double kappa)
{
    return (ph_problem){
        .micro = micro,
        .interface = PH_INTERFACE_NODE_CENTRE,
        .model = {.kind = "bond", .horizon = shapes[shape].m, .kappa = kappa},
        .solver = {.tolerance = 1e-9}};
}

static const double kappas[] = {0.1, 0.0, 15.0};

/* C symmetric and positive definite, Hill's lemma, energy = virial, strain average. */
static void symmetric(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int k = 0; k < check_trials(3); k++)
        for (size_t i = 0; i < SHAPES; i++) {
            ph_microstructure *micro = random_fillers(&seed, i, k == 1);
            ph_problem p = problem(micro, i, kappas[k % 3]);
            ph_result *res = homogenise(&p);
            if (res) {
                CHECK_ABS(res->asymmetry, 0.0, 1e-7);   /* the solver's 1e-9 */
                CHECK_ABS(res->hill_mandel, 0.0, 1e-7); /* energy and virial meet there */
                CHECK_ABS(res->strain_average, 0.0, 1e-15);
                CHECK(ph_sym4_is_stiffness(&res->stiffness));
            }
            ph_result_free(&res);
            ph_microstructure_free(&micro);
        }
    CHECK_END();
}

/* Turned by +90 degrees about axis 3, then shifted: out(x, y) = in(y, -x). */
static ph_microstructure *moved(const ph_microstructure *in, int turns, const int *shift)
{
    ph_error err = PH_ERROR_INIT;
    ph_microstructure *out = NULL;
    const ptrdiff_t *n = in->grid.n;
    CHECK_OK(ph_microstructure_new(&in->grid, in->nmaterials, in->materials, &out, &err));
    out->owner = calloc((size_t)ph_grid_cells(&in->grid), sizeof *out->owner);
    for (ptrdiff_t x = 0; x < ph_grid_cells(&in->grid); x++) {
        ptrdiff_t at[3] = {x / n[2] / n[1], x / n[2] % n[1], x % n[2]}, y = 0;
        for (int t = 0; t < turns; t++) {
            ptrdiff_t a = at[0];
            at[0] = at[1], at[1] = n[1] - 1 - a;
        }
        for (int d = 0; d < 3; d++)
            y = y * n[d] + (at[d] + shift[d]) % n[d];
        out->phase[x] = in->phase[y];
        out->owner[x] = in->owner[y];
    }
    return out;
}

/* The box moved or turned by 90 degrees: the same C, turned. */
static void moved_boxes(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (size_t i = 0; i < SHAPES; i++) {
        static const int none[3] = {0, 0, 0}, shift[3] = {3, 5, 0};
        ph_microstructure *a = random_fillers(&seed, i, false), *b = moved(a, 0, shift),
                          *c = moved(a, 1, none);
        ph_problem p = problem(a, i, 0.1), q = problem(b, i, 0.1), r = problem(c, i, 0.1);
        ph_sym4 Ca = stiffness_of(&p), Cb = stiffness_of(&q), Cc = stiffness_of(&r);
        static const double quarter3[9] = {0, -1, 0, 1, 0, 0, 0, 0, 1},
                            quarter2[4] = {0, -1, 1, 0};
        ph_sym4 turned = ph_sym4_rotate(&Ca, Ca.n == 6 ? quarter3 : quarter2);
        CHECK(difference(&Cb, &Ca) < 1e-7);
        CHECK(difference(&Cc, &turned) < 1e-7);
        ph_microstructure_free(&a);
        ph_microstructure_free(&b);
        ph_microstructure_free(&c);
    }
    CHECK_END();
}

/* Nodes held inside the RVE are a smaller set of fields than periodic ones. A frame outside,
 * filled by the periodic continuation, is stiffer than that in the cases here, and tends to
 * it; both estimates of its stress agree in a homogeneous RVE, and are near in any. */
static void constraints(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (size_t i = 0; i < SHAPES; i++) {
        ph_microstructure *micro = random_fillers(&seed, i, false);
        ph_problem p = problem(micro, i, 0.1), q = p;
        q.constraint.kind = "linear_displacement";
        ph_sym4 periodic = stiffness_of(&p), inside = stiffness_of(&q);
        CHECK(gap(&inside, &periodic) > -1e-7);
        for (int collar = 1; collar < 3; collar++) {
            q.constraint.collar = (ph_collar)collar;
            ph_result *res = homogenise(&q);
            if (!res) continue;
            CHECK(res->bond.has_reactions);
            CHECK(difference(&res->bond.reactions, &res->bond.virial) < 0.1);
            CHECK(difference(&res->bond.virial, &res->stiffness) < 0.05);
            ph_result_free(&res);
        }
        memset(micro->phase, 0,
               sizeof *micro->phase * (size_t)ph_grid_cells(&micro->grid));
        memset(micro->owner, 0,
               sizeof *micro->owner * (size_t)ph_grid_cells(&micro->grid));
        ph_sym4 one = stiffness_of(&p);
        ph_result *res = homogenise(&q);
        if (res) {
            CHECK(difference(&res->stiffness, &one) < 1e-12);
            CHECK(difference(&res->bond.reactions, &one) < 1e-12);
            CHECK_ABS(res->strain_average, 0.0, 1e-12);
        }
        ph_result_free(&res);
        ph_microstructure_free(&micro);
    }
    CHECK_END();
}

/* Every solver, one answer. */
static void solvers(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    static const char *const name[] = {"fft_cg", "direct", "relaxation"};
    for (size_t i = 0; i < SHAPES; i++)
        for (int held = 0; held < 2; held++) {
            ph_microstructure *micro = random_fillers(&seed, i, i == 1);
            ph_problem p = problem(micro, i, 0.1);
            if (held) {
                p.constraint.kind = "linear_displacement";
                p.constraint.collar = PH_COLLAR_MATRIX;
            }
            ph_sym4 first = {0};
            for (int s = 0; s < 3; s++) {
                p.solver.kind = name[s];
                ph_sym4 c = stiffness_of(&p);
                if (s == 0) first = c;
                CHECK(difference(&c, &first) < 1e-6);
            }
            ph_microstructure_free(&micro);
        }
    CHECK_END();
}

/* The same bits for any number of threads: enough cells that more than one is taken. */
static void threads(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    ph_grid g = box_grid(PH_PLANE_STRESS, 150, 150, 1, 150, 150, 1);
    ph_material m[2];
    CHECK_OK(ph_material_isotropic("matrix", 3.5, 1.0 / 3, &m[0], &err));
    CHECK_OK(ph_material_isotropic("clay", 178, 1.0 / 3, &m[1], &err));
    ph_microstructure *micro = NULL;
    CHECK_OK(ph_microstructure_new(&g, 2, m, &micro, &err));
    for (ptrdiff_t x = 0; x < ph_grid_cells(&g); x++)
        micro->phase[x] = check_random(&seed) < 0.04;
    for (int k = 0; k < 2; k++) {
        ph_problem p = {.micro = micro,
                        .model = {.kind = "bond", .horizon = k ? 4 : 2, .kappa = 0.5},
                        .solver = {.tolerance = 1e-3},
                        .loads = 1};
        ph_sym4 c[2];
        for (int t = 0; t < 2; t++) {
            ph_ctx ctx = {.threads = 1 + t};
            ph_result *res = NULL;
            CHECK_OK(ph_homogenise(&p, &ctx, &res, &err));
            if (res) c[t] = res->bond.virial;
            ph_result_free(&res);
        }
        CHECK(memcmp(&c[0], &c[1], sizeof *c) == 0);
    }
    ph_microstructure_free(&micro);
    CHECK_END();
}

static void refuses(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    ph_microstructure *micro = random_fillers(&seed, 0, false);
    for (int k = 0; k < 8; k++) {
        ph_problem p = problem(micro, 0, 0.1);
        const char *word = NULL;
        switch (k) {
        case 0:
            p.constraint.kind = "uniform_traction", word = "linear_displacement";
            break;
        case 1:
            p.model.points = PH_POINTS_STRESS, word = "nodes";
            break;
        case 2:
            p.model.stabilisation = PH_STABILISE_SPECTRAL, word = "stabilisation";
            break;
        case 3:
            p.model.influence = "cubic", word = "micromodulus";
            break;
        case 4:
            p.model.micromodulus = "wrong", word = "micromodulus";
            break;
        case 5:
            p.model.horizon = 100, word = "larger than the box";
            break;
        case 6:
            p.model.calibration = (ph_calibration)7, word = "calibration";
            break;
        default:
            micro->grid.kinematics = PH_GENERALISED_STRAIN, word = "nosb";
        }
        ph_result *res = NULL;
        err = (ph_error)PH_ERROR_INIT;
        ph_status st = ph_homogenise(&p, &one_thread, &res, &err);
        CHECK(st == PH_EINVAL && res == NULL);
        CHECK(strstr(err.msg, word) != NULL);
    }
    ph_microstructure_free(&micro);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(symmetric),   cmocka_unit_test(moved_boxes),
        cmocka_unit_test(constraints), cmocka_unit_test(solvers),
        cmocka_unit_test(threads),     cmocka_unit_test(refuses),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
