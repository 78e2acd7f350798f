/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Viscoelastic materials, temperature and the section viscoelastic of case files. */
#include <perihom/case.h>

#include "check.h"
#include "tensors.h"

#define BOX                                                                              \
    "microstructure: {dimension: 3, size: [1, 1, 1], nodes: [4, 4, 4], matrix: a}\n"
#define ROWS(c)                                                                          \
    "[[" c ", 1, 1, 0, 0, 0], [1, " c ", 1, 0, 0, 0], [1, 1, " c                         \
    ", 0, 0, 0], [0, 0, 0, 1, 0, 0], [0, 0, 0, 0, 1, 0], [0, 0, 0, 0, 0, 1]]"
#define MATERIALS                                                                        \
    "perihom: 1\n"                                                                       \
    "units: {time: h, temperature: C}\n"                                                 \
    "temperature: 120\n"                                                                 \
    "materials:\n"                                                                       \
    "  a: {E: {infinity: 3, terms: [{modulus: 17, time: 2}, {modulus: 4, time: 0.1}]}, " \
    "nu: 0.38, density: 1200, shift: {wlf: {C1: 17.44, C2: 51.6, reference: 100}}}\n"    \
    "  b: {bulk: 4, shear: {infinity: 0, terms: [{modulus: 0.8, time: 10}]}, "           \
    "shift: {arrhenius: {activation_energy: 8.0e4, reference: 100}}}\n"                  \
    "  c: {stiffness: {infinity: " ROWS("3") ", terms: [{time: 7, stiffness: " ROWS(     \
        "5") "}]}, euler: [30, 20, 10]}\n"                                               \
             "  d: {E: {infinity: 5, terms: []}, nu: 0.2}\n"

static ph_case *parse(const char *text)
{
    ph_case *c = NULL;
    ph_error err = PH_ERROR_INIT;
    CHECK_OK(ph_case_parse(text, strlen(text), "t.yaml", NULL, 0, &c, NULL, &err));
    return c;
}

static void test_materials(void **state)
{
    (void)state;
    ph_case *c = parse(MATERIALS BOX);
    const ph_material *m = c->materials;
    CHECK(c->nmaterials == 4 && ph_case_relaxes(c));
    CHECK(m[0].relaxation->nterms == 2 && m[0].E == 24 && m[0].density == 1200);
    double wlf = pow(10, -17.44 * 20 / 71.6);
    CHECK_REL(m[0].relaxation->term[1].time, 2 * wlf, 1e-13);
    CHECK_REL(m[0].relaxation->term[0].time, 0.1 * wlf, 1e-13);
    double arrhenius = exp(8.0e4 / 8.31446261815324 * (1 / 393.15 - 1 / 373.15));
    CHECK_REL(m[1].relaxation->term[0].time, 10 * arrhenius, 1e-13);
    ph_sym4 want = ph_sym4_isotropic_kg(4, 0.8);
    CHECK(difference(&m[1].stiffness, &want) < 1e-15);
    CHECK(!m[2].is_isotropic && m[2].relaxation->term[0].time == 7);
    CHECK(fabs(m[2].stiffness.m[0][0] - 8) > 0.01); /* turned */
    CHECK(m[3].relaxation == NULL && m[3].is_isotropic && m[3].E == 5);
    ph_case_free(&c);
    CHECK_END();
}

/* At the reference temperature, and where no temperature is given, nothing shifts. */
static void test_shift(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_shift wlf = {PH_SHIFT_WLF, .c1 = 17.44, .c2 = 51.6, .reference = 100},
             arrhenius = {PH_SHIFT_ARRHENIUS, .activation_energy = 1e5, .reference = 20},
             none = {0};
    double a = 0, b;
    CHECK_OK(ph_shift_factor(&wlf, 100, 273.15, &a, &err));
    CHECK_ABS(a, 1, 0);
    CHECK_OK(ph_shift_factor(&arrhenius, 20, 273.15, &a, &err));
    CHECK_ABS(a, 1, 0);
    CHECK_OK(ph_shift_factor(&none, 20, 0, &a, &err));
    CHECK_ABS(a, 1, 0);
    /* Celsius and Kelvin are the same temperature */
    CHECK_OK(ph_shift_factor(&arrhenius, 35, 273.15, &a, &err));
    arrhenius.reference += 273.15;
    CHECK_OK(ph_shift_factor(&arrhenius, 35 + 273.15, 0, &b, &err));
    CHECK_REL(a, b, 1e-12);
    CHECK(a < 1); /* warmer is faster */
    CHECK(ph_shift_factor(&wlf, 48.4, 273.15, &a, NULL) == PH_EUNPHYSICAL);
    CHECK(ph_shift_factor(&wlf, 48.5, 273.15, &a, NULL) == PH_EUNPHYSICAL); /* 1e8984 */
    CHECK(ph_shift_factor(&wlf, NAN, 273.15, &a, NULL) == PH_EUNPHYSICAL);
    CHECK(ph_shift_factor(&arrhenius, 0, 0, &a, NULL) == PH_EUNPHYSICAL);
    CHECK(ph_shift_factor(&arrhenius, NAN, 0, &a, NULL) == PH_EUNPHYSICAL);
    CHECK_END();
}

#define SECTION                                                                          \
    "viscoelastic:\n"                                                                    \
    "  route: carson\n"                                                                  \
    "  tolerance: 1e-3\n"                                                                \
    "  compression: 0.01\n"                                                              \
    "  times: [0.1, 1, 10]\n"                                                            \
    "  frequencies: [1]\n"

static void test_section(void **state)
{
    (void)state;
    ph_case *c = parse(MATERIALS BOX);
    CHECK(strcmp(c->viscoelastic.route, "reduced") == 0 && !c->viscoelastic.given);
    CHECK(c->viscoelastic.tolerance == 1e-4 && c->viscoelastic.ntimes == 0);
    ph_case_free(&c);
    c = parse(MATERIALS BOX SECTION "  history: {control: stress, component: 12, "
                                    "ramp: {value: 2, rise: 1, hold: 3, rest: 5}}\n");
    const ph_case_viscoelastic *v = &c->viscoelastic;
    CHECK(v->given && strcmp(v->route, "carson") == 0 && v->tolerance == 1e-3);
    CHECK(v->compression == 0.01 && v->terms == 0);
    CHECK(v->ntimes == 3 && v->times[2] == 10 && v->nfrequencies == 1);
    CHECK(v->history->stress && v->history->npoints == 5 && v->history->n == 6);
    CHECK(v->history->value[1][5] == 2 && v->history->value[4][5] == 0);
    CHECK(v->history->time[4] == 10);
    ph_case_free(&c);
    c = parse(MATERIALS BOX "viscoelastic: {terms: 4, history: {component: 22, cycle: "
                            "{amplitude: 1, frequency: 2, cycles: 2, points: 8}}}\n");
    CHECK(c->viscoelastic.terms == 4 && c->viscoelastic.history->npoints == 17);
    CHECK_ABS(c->viscoelastic.history->value[2][1], 1, 1e-15);
    CHECK_REL(c->viscoelastic.history->time[8], acos(-1.0), 1e-15);
    ph_case_free(&c);
    CHECK_END();
}

/* In a plane, components are 11 22 12. */
static void test_history_of_a_plane(void **state)
{
    (void)state;
    static const char plane[] =
        MATERIALS "microstructure: {dimension: 2, plane: stress, size: [1, 1], nodes: "
                  "[4, 4], matrix: a}\n"
                  "viscoelastic: {history: {component: 12, points: [[0, 1], [2, 3]]}}\n";
    ph_case *c = parse(plane);
    const ph_history *h = c->viscoelastic.history;
    CHECK(h->n == 3 && !h->stress && h->value[1][2] == 3 && h->time[1] == 2);
    ph_case_free(&c);
    CHECK_END();
}

/* The resolved case is a case again, and resolves to itself. */
static void test_written_back(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    static const char *const tail[] = {
        "", SECTION,
        SECTION "  history: {component: 11, cycle: {amplitude: 1, frequency: 2}}\n",
        "viscoelastic: {terms: 5, history: {points: [[0, 1, 2, 3, 4, 5, 6]]}}\n"};
    for (size_t i = 0; i < sizeof tail / sizeof *tail; i++) {
        char text[8000], *first = NULL, *second = NULL;
        snprintf(text, sizeof text, "%s%s", MATERIALS BOX, tail[i]);
        ph_case *c = parse(text), *again = NULL;
        CHECK_OK(ph_case_to_json(c, &first, &err));
        again = parse(first);
        CHECK_OK(ph_case_to_json(again, &second, &err));
        /* JSON says 0.1 for 2.0e-1 and so on: the texts agree, not only the values */
        CHECK(strcmp(first, second) == 0);
        for (int m = 0; m < 3; m++) {
            const ph_prony *p = c->materials[m].relaxation,
                           *q = again->materials[m].relaxation;
            CHECK(p->nterms == q->nterms);
            /* Voigt to Mandel and back rounds */
            CHECK(difference(&p->equilibrium, &q->equilibrium) < 1e-15);
            for (int k = 0; k < p->nterms; k++)
                CHECK(p->term[k].time == q->term[k].time &&
                      difference(&p->term[k].stiffness, &q->term[k].stiffness) < 1e-15);
        }
        ph_case_free(&c);
        ph_case_free(&again);
        free(first);
        free(second);
    }
    CHECK_END();
}

static void test_warnings(void **state)
{
    (void)state;
    static const char *const text[] = {
        "perihom: 1\nunits: {temperature: K}\ntemperature: 20\n"
        "materials: {a: {E: 1, nu: 0.3}}\n" BOX,
        "perihom: 1\nmaterials: {a: {E: 1, nu: 0.3}}\n" BOX "viscoelastic: {terms: 3}\n"};
    static const char *const want[] = {"degrees Celsius meant", "no material relaxes"};
    for (int i = 0; i < 2; i++) {
        ph_case *c = NULL;
        ph_case_issues issues = {0};
        ph_error err = PH_ERROR_INIT;
        CHECK_OK(
            ph_case_parse(text[i], strlen(text[i]), "t", NULL, 0, &c, &issues, &err));
        CHECK(issues.count == 1 && issues.item[0].warning &&
              strstr(issues.item[0].message, want[i]));
        ph_case_issues_free(&issues);
        ph_case_free(&c);
    }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_materials),    cmocka_unit_test(test_shift),
        cmocka_unit_test(test_section),      cmocka_unit_test(test_history_of_a_plane),
        cmocka_unit_test(test_written_back), cmocka_unit_test(test_warnings),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
