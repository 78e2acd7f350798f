/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ph_viscoelastic_solve: what it refuses, what it says, and the cells without equations. */
#include <perihom.h>

#include "check.h"
#include "relaxing.h"

static ph_material relaxing(const char *name, double rest, double modulus, double nu)
{
    ph_error err = PH_ERROR_INIT;
    ph_modulus_term term = {1.0, modulus};
    ph_modulus E = {rest, 1, &term};
    ph_material m = {0};
    CHECK_OK(ph_material_viscoelastic_young(name, &E, nu, &m, &err));
    return m;
}

static void refused(const ph_problem *p, const ph_relaxation_params *params,
                    ph_status want, const char *word)
{
    ph_error err = PH_ERROR_INIT;
    ph_viscoelastic *v = (ph_viscoelastic *)&err; /* must be set to NULL */
    CHECK(ph_viscoelastic_solve(p, params, &one_thread, &v, &err) == want);
    CHECK(v == NULL);
    CHECK(strstr(err.msg, word) != NULL);
    if (!strstr(err.msg, word)) print_error("  ... %s\n", err.msg);
}

static void wrong_arguments(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_material m = relaxing("m", 1, 2, 0.3);
    ph_microstructure *micro =
        round_cell(PH_PLANE_STRAIN, 8, 0.3, m, isotropic("f", 9, 0.2));
    ph_problem p = {.micro = micro}, none = {0}, kind = p, model = p;
    const double bad[] = {1.0, -1.0}, nan_s[] = {(double)NAN};
    kind.constraint.kind = "sticky";
    model.model.kind = "magic";
    refused(&p, &(ph_relaxation_params){.route = "magic"}, PH_EINVAL, "magic");
    refused(&p, &(ph_relaxation_params){.tolerance = -1.0}, PH_EINVAL, "tolerance");
    refused(&p, &(ph_relaxation_params){.tolerance = (double)NAN}, PH_EINVAL,
            "tolerance");
    refused(&p, &(ph_relaxation_params){.tolerance = 1.0}, PH_EINVAL, "tolerance");
    refused(&p, &(ph_relaxation_params){.max_points = -1}, PH_EINVAL, "max_points");
    refused(&p, &(ph_relaxation_params){.ncarson = 2}, PH_EINVAL, "no array");
    refused(&p, &(ph_relaxation_params){.ncarson = -2}, PH_EINVAL, "no array");
    refused(&p, &(ph_relaxation_params){.ncarson = 2, .carson = bad}, PH_EINVAL, ">= 0");
    refused(&p, &(ph_relaxation_params){.ncarson = 1, .carson = nan_s}, PH_EINVAL,
            ">= 0");
    refused(&p, &(ph_relaxation_params){.route = "carson"}, PH_EINVAL, "needs");
    refused(&none, NULL, PH_EINVAL, "no microstructure");
    refused(NULL, NULL, PH_EINVAL, "no microstructure");
    refused(&kind, NULL, PH_EINVAL, "sticky");
    refused(&model, NULL, PH_EINVAL, "magic");
    refused(&p, &(ph_relaxation_params){.max_points = 2, .tolerance = 1e-9}, PH_ENOCONV,
            "2 values of s");
    CHECK(ph_viscoelastic_solve(&p, NULL, NULL, NULL, &err) == PH_EINVAL);
    ph_viscoelastic_free(NULL);
    ph_microstructure_free(&micro);
    ph_material_clear(&m);
    CHECK_END();
}

/* Model bond: its Poisson's ratio stays, its averages need an energy. */
static void bonds_refuse(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_modulus_term g = {1.0, 0.3};
    ph_modulus K = {0.5, 0, NULL}, G = {0.075, 1, &g};
    ph_material m[2] = {{.E = 0}, relaxing("b", 1, 2, 1.0 / 3)};
    /* nu = 1/3 in plane stress at first: K = 8 G / 3 */
    K.infinity = 8.0 / 3 * 0.375;
    CHECK_OK(ph_material_viscoelastic_bulk_shear("a", &K, &G, &m[0], &err));
    uint64_t seed = 1;
    ph_microstructure *micro =
        voxel_cell(box_grid(PH_PLANE_STRESS, 12, 12, 1, 1, 1, 1), 2, m, &seed);
    ph_problem p = {.micro = micro, .model = {.kind = "bond", .horizon = 2}};
    refused(&p, NULL, PH_EUNPHYSICAL, "Poisson");
    ph_microstructure_free(&micro);
    micro = voxel_cell(box_grid(PH_PLANE_STRESS, 12, 12, 1, 1, 1, 1), 1, &m[1], &seed);
    p.micro = micro;
    p.constraint.kind = "linear_displacement";
    p.constraint.collar = PH_COLLAR_PERIODIC;
    refused(&p, NULL, PH_EINVAL, "collar");
    ph_microstructure_free(&micro);
    for (int i = 0; i < 2; i++)
        ph_material_clear(&m[i]);
    CHECK_END();
}

/* An elastic cell has a series without terms, its stiffness. */
static void elastic_cells(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_microstructure *micro = round_cell(PH_PLANE_STRAIN, 12, 0.3,
                                          isotropic("m", 1, 0.3), isotropic("f", 9, 0.2));
    ph_problem p = {.micro = micro, .solver.tolerance = 1e-9};
    ph_relaxation_params params = {.tolerance = 1e-6};
    ph_viscoelastic *v = NULL;
    CHECK_OK(ph_viscoelastic_solve(&p, &params, &one_thread, &v, &err));
    ph_sym4 want = stiffness_of(&p);
    if (v) {
        CHECK(v->series->nterms == 0 && v->npoints == 1 && v->lost == 0);
        CHECK(off(&v->instantaneous, &want) < 1e-8);
        CHECK(v->elastic && v->elastic->nloads == 3 && v->elastic->iterations[0] > 0);
        CHECK(v->basis == 3 && v->basis_bytes >= 3 * 2 * 144 * sizeof(double));
        CHECK(v->elastic->work.peak_bytes > v->basis_bytes);
    }
    ph_viscoelastic_free(&v);
    ph_microstructure_free(&micro);
    CHECK_END();
}

/* Voigt: the mean of C_p(s). Reuss: the mean of compliances, also where a phase flows. */
static void bounds_without_equations(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    static const double s[] = {1e-3, 0.1, 1.0, 20.0};
    static const char *const kind[] = {"voigt", "reuss"};
    for (int fluid = 0; fluid < 2; fluid++) {
        ph_material m = relaxing("m", fluid ? 0.0 : 1.0, 2, 0.3),
                    f = isotropic("f", 9, 0.2);
        ph_microstructure *micro = round_cell(PH_PLANE_STRESS, 12, 0.3, m, f);
        for (int k = 0; k < 2; k++) {
            ph_problem p = {.micro = micro, .constraint.kind = kind[k]};
            ph_relaxation_params params = {.carson = s, .ncarson = 4};
            ph_viscoelastic *v = NULL;
            CHECK_OK(ph_viscoelastic_solve(&p, &params, &one_thread, &v, &err));
            for (int i = 0; v && i < 4; i++) {
                ph_material at;
                ph_sym4 a, b;
                CHECK_OK(ph_material_at(&m, s[i], &at, &err));
                CHECK_OK(ph_sym4_reduce(&at.stiffness, PH_PLANE_STRESS, &a, &err));
                CHECK_OK(ph_sym4_reduce(&f.stiffness, PH_PLANE_STRESS, &b, &err));
                if (k == 1) {
                    CHECK_OK(ph_sym4_inverse(&a, &a, &err));
                    CHECK_OK(ph_sym4_inverse(&b, &b, &err));
                }
                double c = v->elastic->fractions[1];
                ph_sym4 want = ph_sym4_combine(1 - c, &a, c, &b);
                if (k == 1) CHECK_OK(ph_sym4_inverse(&want, &want, &err));
                CHECK(off(&v->values[i].stiffness, &want) < 1e-12);
            }
            if (v) CHECK(v->lost == (fluid && k == 1 ? 3 : 0));
            if (v && v->lost)
                CHECK(strstr(v->elastic->notes[v->elastic->nnotes - 1], "zero"));
            ph_viscoelastic_free(&v);
        }
        ph_microstructure_free(&micro);
        ph_material_clear(&m);
    }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wrong_arguments),
        cmocka_unit_test(bonds_refuse),
        cmocka_unit_test(elastic_cells),
        cmocka_unit_test(bounds_without_equations),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
