/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A program as others write it, small enough to be watched by valgrind: a case from text, its
 * result and card, relaxation and material point, FE2 with and without a history, a
 * superelement, and mistakes on the way. Everything is given back. */
#include <perihom_rve.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int failures;

static void expect(int good, const char *what)
{
    if (good) return;
    failures++;
    fprintf(stderr, "not as expected: %s\n", what);
}

static const char text[] =
    "perihom: 1\n"
    "materials: {resin: {nu: 0.35, E: {infinity: 1, terms: [{modulus: 2, time: 1}]}},\n"
    "            glass: {E: 70, nu: 0.22}}\n"
    "microstructure:\n"
    "  {dimension: 2, plane: generalised_strain, size: [1, 1], nodes: [8, 8], matrix: "
    "resin,\n"
    "   inclusions: [{shape: disk, centre: [0.5, 0.5], fraction: 0.3, material: "
    "glass}]}\n";

static ph_microstructure *build(ph_case **c)
{
    ph_error err = PH_ERROR_INIT;
    ph_case_issues issues = {0};
    ph_microstructure *micro = NULL;
    expect(ph_case_parse("nonsense: [", 11, "bad", NULL, 0, c, &issues, &err) != PH_OK,
           "a case that is none");
    ph_case_issues_free(&issues);
    err = (ph_error)PH_ERROR_INIT;
    expect(ph_case_parse(text, sizeof text - 1, "text", NULL, 0, c, NULL, &err) ==
                   PH_OK &&
               ph_rve_build(*c, &micro, &err) == PH_OK,
           err.msg);
    return micro;
}

static void elastic(const ph_case *c, const ph_microstructure *micro)
{
    ph_error err = PH_ERROR_INIT;
    ph_result *result = NULL;
    ph_effective *effective = NULL;
    char *json = NULL, *card = NULL;
    const ph_problem problem = {.micro = micro, .keep_fields = true};
    const ph_card_params name = {.name = "ply", .id = 1};
    expect(ph_homogenise(&problem, NULL, &result, &err) == PH_OK &&
               ph_result_to_json(result, c, "", &json, &err) == PH_OK &&
               ph_effective_from_result(result, c, &effective, &err) == PH_OK &&
               ph_card_write(effective, "abaqus", &name, &card, NULL, &err) == PH_OK,
           err.msg);
    expect(ph_card_write(effective, "nonsense", &name, &card, NULL, NULL) == PH_EINVAL,
           "a card that there is not");
    free(json);
    free(card);
    ph_effective_free(&effective);
    ph_result_free(&result);
}

static void relaxing(const ph_microstructure *micro)
{
    ph_error err = PH_ERROR_INIT;
    ph_viscoelastic *v = NULL;
    ph_point_material *point = NULL;
    const ph_problem problem = {.micro = micro};
    const double de[6] = {1e-3};
    double state[256] = {0}, stress[6], tangent[36];
    ph_effective effective = {.stiffness = {.n = 0}};
    expect(ph_viscoelastic_solve(&problem, NULL, NULL, &v, &err) == PH_OK, err.msg);
    if (v) {
        effective.stiffness = v->instantaneous;
        effective.relaxation = v->series;
        expect(ph_point_material_new(&effective, &point, &err) == PH_OK &&
                   ph_point_state_size(point) <= 256 &&
                   ph_point_update(point, state, de, 0.1, stress, tangent) == PH_OK,
               err.msg);
    }
    ph_point_material_free(&point);
    ph_viscoelastic_free(&v);
}

/* Two points, two increments, one of them rejected; a state there and back. */
static void live(const ph_problem *problem, double size)
{
    ph_error err = PH_ERROR_INIT;
    ph_fe2 *rve = NULL;
    ph_fe2_point *p[2] = {NULL, NULL};
    const double de[12] = {0, size, 0, 0, 0.5 * size, 0, 0, size};
    double stress[12], tangent[72];
    void *saved = NULL;
    int good = ph_fe2_new(problem, NULL, NULL, &rve, &err) == PH_OK &&
               ph_fe2_point_new(rve, &p[0], &err) == PH_OK &&
               ph_fe2_point_new(rve, &p[1], &err) == PH_OK;
    for (int k = 0; good && k < 2; k++)
        good = ph_fe2_update_all(p, 2, de, 0.5, stress, tangent, NULL, &err) == PH_OK &&
               ph_fe2_accept_all(p, 2, NULL, &err) == PH_OK;
    if (good) {
        const size_t bytes = ph_fe2_point_bytes(p[0]);
        saved = malloc(bytes);
        good = saved && ph_fe2_point_save(p[0], saved, bytes, &err) == PH_OK &&
               ph_fe2_point_restore(p[1], saved, bytes, &err) == PH_OK &&
               ph_fe2_update(p[1], de, 1.0, stress, NULL, NULL, &err) == PH_OK;
        ph_fe2_reject(p[1]);
    }
    expect(good, err.msg);
    free(saved);
    ph_fe2_free(&rve);
    ph_fe2_point_free(&p[0]);
    ph_fe2_point_free(&p[1]);
}

static void failing(void)
{
    ph_error err = PH_ERROR_INIT;
    ph_grid grid;
    ph_material m[2];
    ph_microstructure *micro = NULL;
    const ph_failure_rule rule[2] = {{.given = true, .value = 0.01}, {.given = false}};
    const ph_failure failure = {.material = rule};
    if (ph_grid_init(&grid, PH_PLANE_STRESS, (ptrdiff_t[]){8, 8}, (double[]){1, 1},
                     &err) ||
        ph_material_isotropic("soft", 1, 1.0 / 3, &m[0], &err) ||
        ph_material_isotropic("stiff", 10, 1.0 / 3, &m[1], &err) ||
        ph_microstructure_new(&grid, 2, m, &micro, &err)) {
        expect(0, err.msg);
        return;
    }
    for (int i = 2; i < 6; i++)
        for (int j = 2; j < 6; j++)
            micro->phase[i * 8 + j] = 1;
    ph_problem problem = {
        .micro = micro, .model = {.kind = "bond", .horizon = 2.0}, .failure = &failure};
    live(&problem, 0.008);
    ph_superelement *element = NULL;
    char *mtx = NULL;
    expect(ph_superelement_new(&problem, NULL, &element, &err) == PH_OK &&
               ph_superelement_to_mtx(element, &mtx, &err) == PH_OK,
           err.msg);
    free(mtx);
    ph_superelement_free(&element);
    ph_microstructure_free(&micro);
}

int main(void)
{
    ph_case *c = NULL;
    ph_microstructure *micro = build(&c);
    if (micro) {
        const ph_problem problem = {.micro = micro};
        elastic(c, micro);
        relaxing(micro);
        live(&problem, 1e-3);
        failing();
    }
    ph_microstructure_free(&micro);
    ph_case_free(&c);
    printf(failures ? "%d failures\n" : "all as expected\n", failures);
    return failures != 0;
}
