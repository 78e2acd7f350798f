/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Material cards: projections, classes, and numbers that come back as they went in. */
#include <perihom.h>

#include "tensors.h"

static ph_effective material(const ph_sym4 *c)
{
    ph_effective e = {.kinematics = PH_SPACE, .stiffness = *c, .density = 1.25};
    snprintf(e.title, sizeof e.title, "A \"title\" \\ with marks");
    return e;
}

/* The nearest tensor of a class: a projection, orthogonal, that leaves the class alone. */
static void projections(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int t = 0; t < check_trials(50); t++)
        for (int n = 3; n <= 6; n += 3)
            for (int s = PH_SYMMETRY_ISOTROPIC; s <= PH_SYMMETRY_ANISOTROPIC; s++) {
                ph_sym4 c = random_stiffness(&seed, n), p, q;
                double distance = ph_symmetry_project(&c, (ph_symmetry)s, &p);
                double again = ph_symmetry_project(&p, (ph_symmetry)s, &q);
                ph_sym4 rest = ph_sym4_combine(1, &c, -1, &p);
                /* |C|^2 = |P|^2 + |C - P|^2: round-off of sums of 36 terms */
                double norm = ph_sym4_norm(&c), inside = ph_sym4_norm(&p);
                CHECK_REL(inside * inside + ph_sym4_norm(&rest) * ph_sym4_norm(&rest),
                          norm * norm, 1e-13);
                CHECK_REL(distance, ph_sym4_norm(&rest) / norm, 1e-13);
                CHECK(again < 1e-14 && difference(&p, &q) < 1e-14);
                CHECK(ph_sym4_is_stiffness(&p));
            }
    CHECK_END();
}

/* The isotropic projection does not depend on the axes, and is what ph_nearest_isotropic says. */
static void isotropic_is_isotropic(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int t = 0; t < check_trials(20); t++) {
        double R[9];
        random_rotation(&seed, R);
        ph_sym4 c = random_stiffness(&seed, 6), turned = ph_sym4_rotate(&c, R), p, q;
        ph_symmetry_project(&c, PH_SYMMETRY_ISOTROPIC, &p);
        ph_symmetry_project(&turned, PH_SYMMETRY_ISOTROPIC, &q);
        ph_isotropic iso = ph_nearest_isotropic(&c, PH_SPACE);
        ph_sym4 want = ph_sym4_isotropic_kg(iso.K, iso.G);
        CHECK(difference(&p, &q) < 1e-13); /* two rotations of 81 terms */
        CHECK(difference(&p, &want) < 1e-13);
    }
    CHECK_END();
}

/* Numbers after `mark` in a text, commas and brackets passed over. */
static int numbers_after(const char *text, const char *mark, int most, double *out)
{
    const char *p = strstr(text, mark);
    int n = 0;
    if (!p) return 0;
    for (p += strlen(mark); *p && n < most;) {
        char *end;
        double x = strtod(p, &end);
        if (end == p) {
            p++;
            continue;
        }
        out[n++] = x;
        p = end;
    }
    return n;
}

static char *card_of(const ph_sym4 *c, const char *format, ph_symmetry symmetry)
{
    ph_error err = PH_ERROR_INIT;
    ph_effective e = material(c);
    ph_card_params params = {.symmetry = symmetry, .name = "rve", .nearest = true};
    char *text = NULL;
    CHECK_OK(ph_card_write(&e, format, &params, &text, NULL, &err));
    return text;
}

/* Eleven digits: a number that begins with 1 is off by 5e-11 of itself at most. */
static void tensors_come_back(void **state)
{
    (void)state;
    static const int keyword[6] = {0, 1, 2, 5, 4, 3}, ansys[6] = {0, 1, 2, 5, 3, 4};
    uint64_t seed = check_seed();
    ph_sym4 c = random_stiffness(&seed, 6);
    double D[36], v[40];
    ph_sym4_to_voigt(&c, true, D);
    char *text = card_of(&c, "calculix", PH_SYMMETRY_ANISOTROPIC);
    CHECK(numbers_after(text ? text : "", "ANISO\n", 21, v) == 21);
    for (int j = 0, n = 0; j < 6; j++)
        for (int i = 0; i <= j; i++)
            CHECK_REL(v[n++], D[6 * keyword[i] + keyword[j]], 5e-11);
    free(text);
    text = card_of(&c, "ansys", PH_SYMMETRY_ANISOTROPIC);
    const char *p = text ? text : "";
    for (int j = 0, n = 0; j < 6; j++)
        for (int i = j; i < 6; i++, n++) {
            if (n % 6 == 0) { /* "TBDATA,first,six values" */
                p = strstr(p, "TBDATA,");
                CHECK(p && numbers_after(p, "TBDATA,", 7, v) >= 4);
                CHECK(p && v[0] == n + 1);
                p += p ? 7 : 0;
            }
            CHECK_REL(v[1 + n % 6], D[6 * ansys[i] + ansys[j]], 5e-11);
        }
    free(text);
    text = card_of(&c, "json", PH_SYMMETRY_AUTO);
    CHECK(numbers_after(text ? text : "", "\"stiffness\"", 36, v) == 36);
    for (int k = 0; k < 36; k++)
        CHECK(v[k] == D[k]); /* 17 digits */
    free(text);
    text = card_of(&c, "sfepy", PH_SYMMETRY_AUTO);
    CHECK(numbers_after(text ? text : "", "np.array(", 36, v) == 36);
    for (int k = 0; k < 36; k++)
        CHECK(v[k] == D[6 * keyword[k / 6] + keyword[k % 6]]);
    free(text);
    CHECK_END();
}

/* LS-DYNA: a field has ten characters, seven digits or more of an ordinary number. */
static void fields_of_ten(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_sym4 c = random_stiffness(&seed, 6), p;
    ph_engineering e;
    ph_error err = PH_ERROR_INIT;
    ph_symmetry_project(&c, PH_SYMMETRY_ORTHOTROPIC, &p);
    CHECK_OK(ph_engineering_constants(&p, &e, &err));
    char *text = card_of(&c, "ls_dyna", PH_SYMMETRY_ORTHOTROPIC);
    const char *line = text ? strstr(text, "prcb\n") : NULL;
    CHECK(line != NULL);
    const double want[8] = {1,      1.25,       e.E[0],     e.E[1],
                            e.E[2], e.nu[1][0], e.nu[2][0], e.nu[2][1]};
    for (int i = 0; line && i < 8; i++) {
        char field[11] = "";
        memcpy(field, line + 5 + 10 * i, 10);
        CHECK_REL(strtod(field, NULL), want[i], 1e-5);
    }
    free(text);
    CHECK_END();
}

/* The class is the simplest that holds the tensor. */
static void classes(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    ph_sym4 c = random_stiffness(&seed, 6), p;
    ph_symmetry_project(&c, PH_SYMMETRY_ORTHOTROPIC, &p);
    ph_sym4 iso = ph_sym4_isotropic(3.5, 0.35);
    const struct {
        const ph_sym4 *c;
        const char *word;
    } row[] = {
        {&iso, "TYPE=ISO\n"}, {&p, "TYPE=ENGINEERING CONSTANTS"}, {&c, "TYPE=ANISO"}};
    for (int i = 0; i < 3; i++) {
        ph_effective e = material(row[i].c);
        char *text = NULL;
        double distance = 1.0;
        CHECK_OK(ph_card_write(&e, "abaqus", NULL, &text, &distance, &err));
        CHECK(text && strstr(text, row[i].word));
        CHECK(distance < 1e-14);
        free(text);
    }
    CHECK_END();
}

/* An isotropic series in the words of the codes that have one; one of full tensors only as
 * JSON; elsewhere its states. */
static void series(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_prony_term term[2] = {{2.0, ph_sym4_isotropic_kg(1, 0.4)},
                             {30.0, ph_sym4_isotropic_kg(0.5, 0.6)}};
    ph_sym4 infinity = ph_sym4_isotropic_kg(2.5, 0.25);
    ph_effective e = {.density = NAN};
    CHECK_OK(ph_prony_new(&infinity, 2, term, &e.relaxation, &err));
    e.stiffness = ph_prony_instantaneous(e.relaxation);
    const struct {
        const char *format, *mark;
        double want[6];
    } row[] = {
        {"abaqus", "TIME=PRONY\n", {0.4 / 1.25, 1.0 / 4, 2, 0.6 / 1.25, 0.5 / 4, 30}},
        {"ansys", "SHEAR\nTBDATA,1,", {0.4 / 1.25, 2, 0.6 / 1.25, 30}},
        {"ansys", "BULK\nTBDATA,1,", {1.0 / 4, 2, 0.5 / 4, 30}},
        {"ls_dyna", "betaki\n", {0.25, 0, 2.5, 0, 0.4, 0.5}},
    };
    for (int i = 0; i < 4; i++) {
        char *text = NULL;
        double v[6];
        int n = row[i].want[4] > 0 ? 6 : 4;
        CHECK_OK(ph_card_write(&e, row[i].format, NULL, &text, NULL, &err));
        CHECK(text && numbers_after(text, row[i].mark, n, v) == n);
        for (int k = 0; k < n; k++)
            CHECK_ABS(v[k], row[i].want[k], 5e-11);
        free(text);
    }
    char *text = NULL;
    double v[2] = {0};
    ph_card_params old = {.state = PH_CARD_EQUILIBRIUM};
    CHECK_OK(ph_card_write(&e, "calculix", &old, &text, NULL, &err));
    CHECK(text && numbers_after(text, "TYPE=ISO\n", 2, v) == 2);
    CHECK_REL(v[0], 9 * 2.5 * 0.25 / (3 * 2.5 + 0.25), 5e-11);
    free(text);
    text = NULL;
    CHECK(ph_card_write(&e, "calculix", NULL, &text, NULL, NULL) == PH_EUNPHYSICAL);
    e.relaxation->term[0].stiffness.m[0][0] *= 2; /* no longer isotropic */
    CHECK(ph_card_write(&e, "abaqus", NULL, &text, NULL, NULL) == PH_EUNPHYSICAL &&
          !text);
    CHECK_OK(ph_card_write(&e, "json", NULL, &text, NULL, &err));
    free(text);
    ph_prony_free(&e.relaxation);
    CHECK_END();
}

static void refuses(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_sym4 c = random_stiffness(&seed, 6), flat = random_stiffness(&seed, 3);
    ph_effective e = material(&c), plane = material(&flat), bad = material(&c);
    plane.kinematics = PH_PLANE_STRESS;
    bad.stiffness.m[0][0] = NAN;
    const struct {
        const ph_effective *e;
        const char *format;
        ph_card_params params;
        ph_status st;
        const char *word;
    } row[] = {
        {&e, "abacus", {0}, PH_EINVAL, "abacus"},
        {&e, NULL, {0}, PH_EINVAL, "format"},
        {NULL, "abaqus", {0}, PH_EINVAL, "material"},
        {&bad, "abaqus", {0}, PH_EINVAL, "positive"},
        {&plane, "abaqus", {0}, PH_EINVAL, "generalised_strain"},
        {&e, "openradioss", {0}, PH_EUNPHYSICAL, "norm"},
        {&e, "code_aster", {0}, PH_EUNPHYSICAL, "orthotropic"},
        {&e,
         "openradioss",
         {.symmetry = PH_SYMMETRY_ORTHOTROPIC},
         PH_EUNPHYSICAL,
         "isotropic"},
        {&e, "abaqus", {.symmetry = PH_SYMMETRY_ISOTROPIC}, PH_EUNPHYSICAL, "isotropic"},
        {&e, "abaqus", {.symmetry = (ph_symmetry)9}, PH_EINVAL, "9"},
        {&e, "abaqus", {.name = "1st"}, PH_EINVAL, "1st"},
        {&e, "abaqus", {.name = ""}, PH_EINVAL, "letter"},
        {&e, "abaqus", {.name = "a\n*INCLUDE"}, PH_EINVAL, "letter"},
        {&e, "abaqus", {.tolerance = NAN}, PH_EINVAL, "tolerance"},
        {&e, "abaqus", {.tolerance = 2}, PH_EINVAL, "tolerance"},
    };
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        ph_error err = PH_ERROR_INIT;
        char *text = NULL;
        CHECK(ph_card_write(row[i].e, row[i].format, &row[i].params, &text, NULL, &err) ==
              row[i].st);
        CHECK(text == NULL);
        CHECK(strstr(err.msg, row[i].word) != NULL);
    }
    ph_error err = PH_ERROR_INIT;
    char *text = NULL;
    CHECK_OK(ph_card_write(&plane, "json", NULL, &text, NULL, &err));
    free(text);
    CHECK_END();
}

/* Every format writes every class it has, and says where the numbers come from. */
static void every_format(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_sym4 c = random_stiffness(&seed, 6);
    const ph_catalogue *formats = ph_card_formats();
    for (size_t i = 0; i < *formats->count; i++) {
        const ph_entry *f = ph_catalogue_entry(formats, i);
        char *text = card_of(&c, f->name, PH_SYMMETRY_AUTO);
        CHECK(text && strlen(text) > 100 && strstr(text, "rve"));
        CHECK(text && !strstr(text, "nan") && !strstr(text, "inf"));
        CHECK(ph_card_ending(f->name) && ph_card_ending(f->name)[0] == '.');
        free(text);
    }
    CHECK(ph_card_ending("none") == NULL);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(projections),       cmocka_unit_test(isotropic_is_isotropic),
        cmocka_unit_test(tensors_come_back), cmocka_unit_test(fields_of_ten),
        cmocka_unit_test(classes),           cmocka_unit_test(series),
        cmocka_unit_test(refuses),           cmocka_unit_test(every_format),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
