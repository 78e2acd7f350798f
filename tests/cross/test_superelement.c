/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The RVE condensed to its faces: what it must leave alone, and ph_homogenise. */
#include <perihom/superelement.h>

#include "check.h"
#include "solve.h"

static ph_superelement *condensed(ph_microstructure *m)
{
    ph_error err = PH_ERROR_INIT;
    ph_problem p = {.micro = m, .model.kind = "local"};
    ph_superelement *e = NULL;
    CHECK_OK(ph_superelement_new(&p, &one_thread, &e, &err));
    return e;
}

static ph_microstructure *cell_of(int which)
{
    ph_material soft = isotropic("soft", 1, 0.3), stiff = isotropic("stiff", 20, 0.2);
    return which == 0   ? round_cell(PH_PLANE_STRAIN, 12, 0.4, soft, stiff)
           : which == 1 ? round_cell(PH_PLANE_STRESS, 9, 0.3, stiff, soft)
                        : round_cell(PH_SPACE, 5, 0.2, soft, stiff);
}

/* The same elements by conjugate gradients to 1e-10: their error is its square. */
static void stiffness_is_that_of_homogenise(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    for (int which = 0; which < 3; which++) {
        ph_microstructure *m = cell_of(which);
        ph_superelement *e = condensed(m);
        ph_problem p = {.micro = m, .model.kind = "local", .solver.tolerance = 1e-10};
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
    for (int which = 0; which < 3; which++) {
        ph_microstructure *m = cell_of(which);
        ph_superelement *e = condensed(m);
        const ptrdiff_t n = e->nd * e->nodes;
        double *u = calloc((size_t)n, sizeof *u), worst = 0, largest = 0;
        for (int mode = 0; mode < e->nd + 1; mode++) {
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
    ph_superelement *e = condensed(micro);
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

static void refusals(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_superelement *e = NULL;
    ph_material m = isotropic("m", 1, 0.3);
    ph_microstructure *flat = round_cell(PH_GENERALISED_STRAIN, 8, 0.3, m, m);
    ph_microstructure *plane = round_cell(PH_PLANE_STRAIN, 8, 0.3, m, m);
    ph_problem p = {.micro = flat, .model.kind = "local"};
    CHECK(ph_superelement_new(&p, NULL, &e, &err) == PH_EINVAL && !e);
    p = (ph_problem){.micro = plane};
    CHECK(ph_superelement_new(&p, NULL, &e, NULL) == PH_EINVAL && !e);
    p = (ph_problem){.micro = NULL, .model.kind = "local"};
    CHECK(ph_superelement_new(&p, NULL, &e, NULL) == PH_EINVAL && !e);
    ph_microstructure_free(&flat);
    ph_microstructure_free(&plane);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stiffness_is_that_of_homogenise),
        cmocka_unit_test(rigid_motions_cost_nothing),
        cmocka_unit_test(homogeneous),
        cmocka_unit_test(refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
