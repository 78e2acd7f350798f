/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scalar quantities of a result, by name. */
#include <perihom/quantity.h>

#include "core/check.h"
#include "effective/quantity_relaxation.h"

#include <math.h>
#include <string.h>

static const char *const young_words[] = {"E1", "E2", "E3", NULL};
static const char *const poisson_words[] = {"nu12", "nu13", "nu21", "nu23",
                                            "nu31", "nu32", NULL};
static const char *const shear_words[] = {"G23", "G13", "G12", NULL};
static const char *const isotropic_words[] = {"isotropic.E",        "isotropic.nu",
                                              "isotropic.K",        "isotropic.G",
                                              "isotropic.distance", NULL};
static const char *const stretch_words[] = {"stretch.E1", "stretch.E2", NULL};

static int find_word(const char *const *words, const char *name)
{
    for (int i = 0; words[i]; i++)
        if (strcmp(words[i], name) == 0) return i;
    return -1;
}

/* Index of component 11 22 33 23 13 12 (0..5) in the tensors of a kinematics, or -1. */
static int component(int voigt, ph_kinematics kin)
{
    if (ph_strains(kin) == 6) return voigt;
    return voigt < 2 ? voigt : voigt == 5 ? 2 : -1;
}

static unsigned all_loads(const ph_quantity *q, ph_kinematics kin)
{
    (void)q;
    return (1u << ph_strains(kin)) - 1u;
}

static const char *never_refuses(const ph_quantity *q, ph_kinematics kin)
{
    (void)q, (void)kin;
    return NULL;
}

static const char *refuses_plane(const ph_quantity *q, ph_kinematics kin)
{
    bool in_plane = component(q->row, kin) >= 0 && component(q->column, kin) >= 0;
    return in_plane ? NULL : "plane stress and plane strain have the components 1, 2, 6";
}

/* ---- E, nu, G: the inverse of the whole tensor ---- */

static const char *refuses_axes(const ph_quantity *q, ph_kinematics kin)
{
    return ph_strains(kin) == 6 || (q->row < 2 && q->column < 2)
               ? NULL
               : "plane stress and plane strain have no constants along axis 3";
}

/* Does the inverse of the columns that are there hold row `row` of the compliance? */
static bool stands_alone(const ph_result *r, int row)
{
    if (!(r->loads >> row & 1)) return false;
    for (int a = 0; a < r->stiffness.n; a++)
        for (int b = 0; b < r->stiffness.n; b++)
            if (r->loads >> b & 1 && !(r->loads >> a & 1) && r->stiffness.m[a][b] != 0.0)
                return false;
    return true;
}

/* The stiffness with a place holder for what was not solved and is coupled to nothing. */
static ph_sym4 completed(const ph_result *r)
{
    ph_sym4 c = r->stiffness;
    for (int k = 0; k < c.n * c.n; k++)
        if (!(r->loads >> (k / c.n) & 1) || !(r->loads >> (k % c.n) & 1))
            c.m[k / c.n][k % c.n] = 0.0;
    double size = ph_sym4_norm(&c);
    for (int a = 0; a < c.n; a++)
        if (!(r->loads >> a & 1)) c.m[a][a] = size;
    return c;
}

static ph_status inverse(const ph_result *r, ph_engineering *e, ph_error *err)
{
    ph_sym4 c = completed(r);
    return ph_engineering_constants(&c, e, err);
}

/* Axis row, component row, and the shear of two axes, as places of the tensor. */
static int axis_row(const ph_quantity *q, ph_kinematics kin)
{
    (void)kin;
    return q->row;
}

static int component_row(const ph_quantity *q, ph_kinematics kin)
{
    return component(q->row, kin);
}

static int shear_row(const ph_quantity *q, ph_kinematics kin)
{
    return component(6 - q->row - q->column, kin);
}

/* Column `row` of the compliance from a load that was that mean stress. */
static bool from_stress(const ph_quantity *q, const ph_result *r)
{
    return q->kind->row && r->stresses >> q->kind->row(q, r->grid.kinematics) & 1u;
}

static unsigned bit(int component)
{
    return component < 0 ? 0 : 1u << component;
}

/* Entries ij and jj of the compliance, i and j being axes or components. */
static unsigned axis_fields(const ph_quantity *q, ph_kinematics kin)
{
    (void)kin;
    return bit(q->row) | bit(q->column);
}

static unsigned entry_fields(const ph_quantity *q, ph_kinematics kin)
{
    return bit(component(q->row, kin)) | bit(component(q->column, kin));
}

static unsigned shear_fields(const ph_quantity *q, ph_kinematics kin)
{
    return bit(shear_row(q, kin));
}

static bool parse_young(ph_quantity *q)
{
    q->row = q->column = find_word(young_words, q->name);
    q->stress = 1;
    return q->row >= 0;
}

static const char *young_word(size_t i)
{
    return young_words[i];
}

static ph_status young_value(const ph_quantity *q, const ph_result *r, double *out,
                             ph_error *err)
{
    ph_engineering e;
    if (from_stress(q, r)) {
        *out = 1.0 / r->compliance.m[q->row][q->row];
        return PH_OK;
    }
    ph_status st = inverse(r, &e, err);
    if (st == PH_OK) *out = e.E[q->row];
    return st;
}

static bool parse_poisson(ph_quantity *q)
{
    if (find_word(poisson_words, q->name) < 0) return false;
    q->row = q->name[2] - '1';
    q->column = q->name[3] - '1';
    return true;
}

static const char *poisson_word(size_t i)
{
    return poisson_words[i];
}

static ph_status poisson_value(const ph_quantity *q, const ph_result *r, double *out,
                               ph_error *err)
{
    ph_engineering e;
    if (from_stress(q, r)) {
        const ph_sym4 *c = &r->compliance;
        *out = -c->m[q->column][q->row] / c->m[q->row][q->row];
        return PH_OK;
    }
    ph_status st = inverse(r, &e, err);
    if (st == PH_OK) *out = e.nu[q->row][q->column];
    return st;
}

static bool parse_shear(ph_quantity *q)
{
    if (find_word(shear_words, q->name) < 0) return false;
    q->row = q->name[1] - '1';
    q->column = q->name[2] - '1';
    q->stress = 1;
    return true;
}

static const char *shear_word(size_t i)
{
    return shear_words[i];
}

static ph_status shear_value(const ph_quantity *q, const ph_result *r, double *out,
                             ph_error *err)
{
    ph_engineering e;
    if (from_stress(q, r)) {
        int i = shear_row(q, r->grid.kinematics);
        *out = 0.5 / r->compliance.m[i][i]; /* Mandel */
        return PH_OK;
    }
    ph_status st = inverse(r, &e, err);
    if (st == PH_OK) *out = q->row == 1 ? e.G23 : q->column == 2 ? e.G13 : e.G12;
    return st;
}

/* ---- C and S: Voigt entries ---- */

static bool parse_entry(ph_quantity *q, char letter)
{
    const char *s = q->name;
    if (s[0] != letter || strlen(s) != 3) return false;
    if (s[1] < '1' || s[1] > '6' || s[2] < '1' || s[2] > '6') return false;
    q->row = s[1] - '1';
    q->column = s[2] - '1';
    return true;
}

static bool parse_stiffness(ph_quantity *q)
{
    q->stress = 1;
    return parse_entry(q, 'C');
}

static bool parse_compliance(ph_quantity *q)
{
    q->stress = -1;
    return parse_entry(q, 'S');
}

#define ENTRIES(x)                                                                       \
    x "11", x "12", x "13", x "14", x "15", x "16", x "22", x "23", x "24", x "25",      \
        x "26", x "33", x "34", x "35", x "36", x "44", x "45", x "46", x "55", x "56",  \
        x "66", NULL

static const char *stiffness_word(size_t i)
{
    static const char *const words[] = {ENTRIES("C")};
    return words[i];
}

static const char *compliance_word(size_t i)
{
    static const char *const words[] = {ENTRIES("S")};
    return words[i];
}

static int least(int a, int b)
{
    return a < b ? a : b;
}

static unsigned one_load(const ph_quantity *q, ph_kinematics kin)
{
    int a = component(least(q->row, q->column), kin);
    return a < 0 ? 0 : 1u << a;
}

static ph_status stiffness_value(const ph_quantity *q, const ph_result *r, double *out,
                                 ph_error *err)
{
    ph_status st = PH_OK;
    ph_kinematics kin = r->grid.kinematics;
    double voigt[36];
    int first = component(least(q->row, q->column), kin),
        second = component(q->row + q->column - least(q->row, q->column), kin);
    if (!(r->loads >> first & 1)) {
        int other = first;
        first = second;
        second = other;
    }
    PH_CHECK(r->loads >> first & 1, PH_EINVAL, "%s: its load was not solved", q->name);
    ph_sym4_to_voigt(&r->stiffness, true, voigt);
    *out = voigt[second * r->stiffness.n + first];
out:
    return st;
}

static ph_status compliance_value(const ph_quantity *q, const ph_result *r, double *out,
                                  ph_error *err)
{
    ph_status st = PH_OK;
    ph_kinematics kin = r->grid.kinematics;
    ph_sym4 c = completed(r), s = r->compliance;
    double voigt[36];
    int row = component(q->row, kin), column = component(q->column, kin);
    if (!from_stress(q, r)) PH_TRY(ph_sym4_inverse(&c, &s, err));
    ph_sym4_to_voigt(&s, false, voigt);
    *out = from_stress(q, r) ? voigt[column * s.n + row] : voigt[row * s.n + column];
out:
    return st;
}

/* ---- nearest isotropic tensor ---- */

enum { ISO_E, ISO_NU, ISO_K, ISO_G, ISO_DISTANCE };

static bool parse_isotropic(ph_quantity *q)
{
    q->row = find_word(isotropic_words, q->name);
    q->stress = q->row == ISO_E || q->row == ISO_K || q->row == ISO_G;
    return q->row >= 0;
}

static const char *isotropic_word(size_t i)
{
    return isotropic_words[i];
}

static unsigned isotropic_loads(const ph_quantity *q, ph_kinematics kin)
{
    if (q->row == ISO_K) return ph_strains(kin) == 6 ? 7u : 3u;
    return all_loads(q, kin);
}

static ph_status isotropic_value(const ph_quantity *q, const ph_result *r, double *out,
                                 ph_error *err)
{
    (void)err;
    ph_isotropic i = ph_nearest_isotropic(&r->stiffness, r->grid.kinematics);
    const double all[] = {i.E, i.nu, i.K, i.G, i.distance};
    *out = all[q->row];
    return PH_OK;
}

/* ---- Young's modulus from one stretch: E = C11 (1 - (C21 / C11)^2) ---- */

static bool parse_stretch(ph_quantity *q)
{
    q->row = q->column = find_word(stretch_words, q->name);
    q->stress = 1;
    return q->row >= 0;
}

static const char *stretch_word(size_t i)
{
    return stretch_words[i];
}

static const char *refuses_space(const ph_quantity *q, ph_kinematics kin)
{
    (void)q;
    return kin == PH_PLANE_STRESS ? NULL : "it is defined for plane stress only";
}

static unsigned stretch_fields(const ph_quantity *q, ph_kinematics kin)
{
    (void)q, (void)kin;
    return 3u;
}

static ph_status stretch_value(const ph_quantity *q, const ph_result *r, double *out,
                               ph_error *err)
{
    ph_status st = PH_OK;
    const ph_sym4 *c = &r->stiffness;
    double along = c->m[q->row][q->row], across = c->m[1 - q->row][q->row];
    PH_CHECK(r->loads >> q->row & 1, PH_EINVAL, "%s: its load was not solved", q->name);
    PH_CHECK(along > 0.0, PH_ESINGULAR, "%s: the stiffness along the axis is zero",
             q->name);
    *out = along * (1.0 - (across / along) * (across / along));
out:
    return st;
}

/* ---- volume fractions ---- */

static bool parse_fraction(ph_quantity *q)
{
    static const char prefix[] = "fraction.";
    size_t n = sizeof prefix - 1;
    if (strncmp(q->name, prefix, n) != 0) return false;
    size_t length = strlen(q->name + n);
    if (length == 0 || length >= sizeof q->argument) return false;
    memcpy(q->argument, q->name + n, length + 1);
    return true;
}

static const char *fraction_word(size_t i)
{
    return i == 0 ? "fraction.MATERIAL" : NULL;
}

static unsigned no_load(const ph_quantity *q, ph_kinematics kin)
{
    (void)q, (void)kin;
    return 0;
}

static ph_status fraction_value(const ph_quantity *q, const ph_result *r, double *out,
                                ph_error *err)
{
    ph_status st = PH_OK;
    double sum = 0.0;
    bool there = false;
    for (int i = 0; i < r->nmaterials; i++)
        if (strcmp(r->names[i], q->argument) == 0) sum += r->fractions[i], there = true;
    PH_CHECK(there, PH_EINVAL, "%s: the case has no material '%s'", q->name, q->argument);
    *out = sum;
out:
    return st;
}

const ph_quantity_kind ph_quantity_kinds[] = {
    {{"E1 E2 E3", "Young's moduli: 1 / S_ii", "",
      "needs one mean stress, or all strains"},
     parse_young,
     young_word,
     refuses_axes,
     all_loads,
     young_value,
     axis_row,
     axis_fields},
    {{"nu12 ... nu32", "nuij: minus strain j over strain i under stress i", "",
      "needs one mean stress, or all strains"},
     parse_poisson,
     poisson_word,
     refuses_axes,
     all_loads,
     poisson_value,
     axis_row,
     axis_fields},
    {{"G23 G13 G12", "shear moduli", "", "needs one mean stress, or all strains"},
     parse_shear,
     shear_word,
     refuses_axes,
     all_loads,
     shear_value,
     shear_row,
     shear_fields},
    {{"C11 ... C66", "stiffness, Voigt, engineering shear", "",
      "needs one load; plane stress and strain: components 1, 2, 6"},
     parse_stiffness,
     stiffness_word,
     refuses_plane,
     one_load,
     stiffness_value,
     NULL,
     entry_fields},
    {{"S11 ... S66", "compliance, Voigt, engineering shear", "",
      "needs one mean stress, or all strains"},
     parse_compliance,
     compliance_word,
     refuses_plane,
     all_loads,
     compliance_value,
     component_row,
     entry_fields},
    {{"isotropic.E .nu .K .G .distance", "nearest isotropic tensor and distance to it",
      "", "K needs the normal loads, the others all"},
     parse_isotropic,
     isotropic_word,
     never_refuses,
     isotropic_loads,
     isotropic_value,
     NULL,
     isotropic_loads},
    {{"stretch.E1 stretch.E2", "Young's modulus from one stretch: C11 (1 - (C21/C11)^2)",
      "Ongaro2022", "plane stress, nearly isotropic; needs one load"},
     parse_stretch,
     stretch_word,
     refuses_space,
     one_load,
     stretch_value,
     NULL,
     stretch_fields},
    {{"fraction.MATERIAL", "volume fraction of a material in the realisation", "",
      "needs no load"},
     parse_fraction,
     fraction_word,
     never_refuses,
     no_load,
     fraction_value,
     NULL,
     no_load},
    {{"NAME(t=1) NAME_storage(omega=1) ...",
      "a constant that relaxes at a time; its storage, loss, tan delta at a frequency",
      "", "a material must relax; C, E, nu, G, isotropic.*"},
     ph_i_relaxing_parse,
     ph_i_relaxing_word,
     ph_i_relaxing_refuses,
     ph_i_relaxing_loads,
     ph_i_relaxing_value,
     NULL,
     ph_i_relaxing_loads},
};
const size_t ph_nquantity_kinds = sizeof ph_quantity_kinds / sizeof *ph_quantity_kinds;

enum { MAX_WORDS = 128 };

static const char *nearest(const char *name)
{
    const char *words[MAX_WORDS];
    size_t n = 0;
    for (size_t k = 0; k < ph_nquantity_kinds; k++)
        for (size_t i = 0; n < MAX_WORDS && ph_quantity_kinds[k].word(i); i++)
            words[n++] = ph_quantity_kinds[k].word(i);
    return ph_nearest_name(name, words, n);
}

ph_status ph_quantity_find(const char *name, ph_quantity *out, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(name && out, PH_EINVAL, "NULL quantity");
    for (size_t k = 0; k < ph_nquantity_kinds; k++) {
        ph_quantity q = {.kind = &ph_quantity_kinds[k], .at = NAN};
        if (strlen(name) >= sizeof q.name) break;
        memcpy(q.name, name, strlen(name) + 1);
        if (!q.kind->parse(&q)) continue;
        *out = q;
        goto out;
    }
    const char *near = nearest(name);
    PH_CHECK(false, PH_EINVAL, "'%.60s' is no quantity%s%s%s ('perihom list quantities')",
             name, near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
out:
    return st;
}

const char *ph_quantity_refuses(const ph_quantity *q, ph_kinematics kin)
{
    if (!(q && q->kind)) return "not a quantity";
    return q->kind->refuses(q, kin);
}

unsigned ph_quantity_loads(const ph_quantity *q, ph_kinematics kin)
{
    if (!(q && q->kind)) return 0;
    return q->kind->loads(q, kin);
}

ph_status ph_quantity_value(const ph_quantity *q, const ph_result *result, double *out,
                            ph_error *err)
{
    ph_status st = PH_OK;
    double value = NAN;
    PH_CHECK(q && q->kind && result && out, PH_EINVAL, "NULL quantity, result or value");
    ph_kinematics kin = result->grid.kinematics;
    const char *no = q->kind->refuses(q, kin);
    PH_CHECK(!no, PH_EINVAL, "%s: %s", q->name, no);
    /* a single load is looked for by the kind: C_ij has two columns to come from */
    unsigned need = q->kind->loads(q, kin);
    bool one = (need & (need - 1u)) == 0;
    bool alone = q->kind->row && stands_alone(result, q->kind->row(q, kin));
    PH_CHECK(one || alone || from_stress(q, result) || (result->loads & need) == need,
             PH_EINVAL, "%s: a load that it needs was not solved", q->name);
    PH_TRY(q->kind->value(q, result, &value, err));
    PH_CHECK(isfinite(value), PH_ESINGULAR, "%s is not finite", q->name);
    *out = value;
out:
    return st;
}
