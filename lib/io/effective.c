/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The effective material: from a result, or from its document. */
#include <perihom/effective.h>
#include <perihom/version.h>

#include "io/json.h"
#include "io/read_file.h"

#include <math.h>
#include <string.h>
#include <sys/stat.h>

enum { MOST_BYTES = 256 << 20 };

void ph_effective_free(ph_effective **effective)
{
    if (!effective || !*effective) return;
    ph_prony_free(&(*effective)->relaxation);
    ph_damage_law_free(&(*effective)->damage);
    free(*effective);
    *effective = NULL;
}

static void copy_text(char *to, size_t size, const char *from)
{
    snprintf(to, size, "%s", from ? from : "");
}

/* Mean density of the phases that are there. */
static double mean_density(const ph_result *result, const ph_case *c)
{
    double sum = 0.0;
    for (int i = 0; i < result->nmaterials && i < c->nmaterials; i++)
        if (result->fractions[i] > 0.0 && !c->materials[i].is_void)
            sum += result->fractions[i] * c->materials[i].density;
    return sum;
}

ph_status ph_effective_from_result(const ph_result *result, const ph_case *c,
                                   ph_effective **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_effective *e = NULL;
    PH_CHECK(result && out, PH_EINVAL, "no result");
    *out = NULL;
    unsigned all = (1u << result->stiffness.n) - 1u;
    PH_CHECK((result->loads & all) == all, PH_EINVAL,
             "the result has not all columns of the stiffness: solve all loads");
    PH_ALLOC(e, 1, "the effective material");
    e->kinematics = result->grid.kinematics;
    e->stiffness = result->stiffness;
    e->density = c ? mean_density(result, c) : (double)NAN;
    if (c) {
        copy_text(e->title, sizeof e->title, c->title);
        copy_text(e->unit_length, sizeof e->unit_length, c->unit_length);
        copy_text(e->unit_stress, sizeof e->unit_stress, c->unit_stress);
        copy_text(e->unit_time, sizeof e->unit_time, c->unit_time);
    }
    copy_text(e->revision, sizeof e->revision, ph_git_revision());
    if (result->failure) { /* no law of this path: what there is is the last stiffness */
        ph_error why = PH_ERROR_INIT;
        st = ph_damage_law_from_result(result, &e->damage, &why);
        if (st == PH_EINVAL) st = PH_OK;
        PH_CHECK(st == PH_OK, st, "%s", why.msg);
    }
    *out = e;
    e = NULL;
out:
    ph_effective_free(&e);
    return st;
}

/* ---- from a document ---- */

static void take_text(const json_t *map, const char *key, char *to, size_t size)
{
    copy_text(to, size, json_string_value(json_object_get(map, key)));
}

/* Row-major matrix, whole and finite. */
static bool read_matrix(const json_t *rows, int n, double *a)
{
    if ((int)json_array_size(rows) != n) return false;
    for (int i = 0; i < n; i++) {
        const json_t *row = json_array_get(rows, (size_t)i);
        if ((int)json_array_size(row) != n) return false;
        for (int j = 0; j < n; j++) {
            const json_t *v = json_array_get(row, (size_t)j);
            if (!json_is_number(v)) return false;
            a[i * n + j] = json_number_value(v);
        }
    }
    return true;
}

static ph_status read_kinematics(const json_t *root, ph_kinematics *kin, ph_error *err)
{
    static const char *const names[] = {[PH_SPACE] = "space",
                                        [PH_GENERALISED_STRAIN] = "generalised_strain",
                                        [PH_PLANE_STRAIN] = "strain",
                                        [PH_PLANE_STRESS] = "stress"};
    ph_status st = PH_OK;
    const char *word =
        json_string_value(json_object_get(json_object_get(root, "grid"), "kinematics"));
    int found = -1;
    for (int k = 0; word && k < 4; k++)
        if (strcmp(word, names[k]) == 0) found = k;
    PH_CHECK(found >= 0, PH_EINVAL,
             "grid.kinematics: %s is none of space, "
             "generalised_strain, strain, stress",
             word ? word : "(missing)");
    *kin = (ph_kinematics)found;
out:
    return st;
}

/* The densities stand in the case, the fractions in the result. */
static double density_of(const json_t *root)
{
    const json_t *fractions = json_object_get(root, "fractions");
    const json_t *materials = json_object_get(json_object_get(root, "case"), "materials");
    const char *name;
    json_t *value;
    double sum = 0.0;
    if (!json_is_object(materials)) return (double)NAN;
    json_object_foreach((json_t *)(uintptr_t)fractions, name, value)
    {
        const json_t *m = json_object_get(materials, name);
        const json_t *rho = json_object_get(m, "density");
        if (json_number_value(value) <= 0.0 || json_is_true(json_object_get(m, "void")))
            continue;
        sum += json_number_value(value) *
               (json_is_number(rho) ? json_number_value(rho) : (double)NAN);
    }
    return sum > 0.0 ? sum : (double)NAN;
}

/* effective.viscoelastic, where it is there: the series that people get. */
static ph_status read_relaxation(const json_t *v, int n, ph_prony **out, ph_error *err)
{
    static const char where[] = "effective.viscoelastic";
    ph_status st = PH_OK;
    double voigt[36];
    ph_prony_term *term = NULL;
    if (!json_is_object(v)) return PH_OK;
    const json_t *terms = json_object_get(v, "terms");
    size_t count = json_array_size(terms);
    PH_CHECK(json_is_array(terms) && count <= 100000, PH_EINVAL,
             "%s.terms: must be a list of {time, stiffness}", where);
    PH_CHECK(read_matrix(json_object_get(v, "stiffness_infinity"), n, voigt), PH_EINVAL,
             "%s.stiffness_infinity: must be %d rows of %d numbers", where, n, n);
    ph_sym4 equilibrium = ph_sym4_from_voigt(n, voigt, true);
    PH_ALLOC(term, count, "relaxation terms");
    for (size_t i = 0; i < count; i++) {
        const json_t *t = json_array_get(terms, i), *time = json_object_get(t, "time");
        PH_CHECK(json_is_number(time) &&
                     read_matrix(json_object_get(t, "stiffness"), n, voigt),
                 PH_EINVAL, "%s.terms[%zu]: must be {time, stiffness: %d x %d}", where, i,
                 n, n);
        term[i].time = json_number_value(time);
        term[i].stiffness = ph_sym4_from_voigt(n, voigt, true);
    }
    PH_TRY(ph_prony_new(&equilibrium, (int)count, term, out, err));
out:
    free(term);
    return st;
}

static ph_status take_document(const json_t *root, ph_effective *e, ph_error *err)
{
    ph_status st = PH_OK;
    double voigt[36];
    const char *schema = json_string_value(json_object_get(root, "schema"));
    PH_CHECK(schema && strcmp(schema, "perihom.result/1") == 0, PH_EINVAL,
             "schema: %.40s is not perihom.result/1", schema ? schema : "(missing)");
    const json_t *effective = json_object_get(root, "effective");
    PH_TRY(read_kinematics(root, &e->kinematics, err));
    int n = ph_strains(e->kinematics);
    PH_CHECK(read_matrix(json_object_get(effective, "stiffness"), n, voigt), PH_EINVAL,
             "effective.stiffness: must be %d rows of %d numbers (a result that solved "
             "only some loads has no whole tensor)",
             n, n);
    e->stiffness = ph_sym4_from_voigt(n, voigt, true);
    PH_TRY(ph_i_json_read_damage_law(
        json_object_get(json_object_get(effective, "damage"), "law"), n, &e->damage,
        err));
    PH_CHECK(e->damage || ph_sym4_is_stiffness(&e->stiffness), PH_EINVAL,
             "effective.stiffness: is not symmetric positive definite");
    PH_TRY(read_relaxation(json_object_get(effective, "viscoelastic"), n, &e->relaxation,
                           err));
    if (e->relaxation) e->stiffness = ph_prony_instantaneous(e->relaxation);
    const json_t *units = json_object_get(root, "units");
    take_text(root, "title", e->title, sizeof e->title);
    take_text(units, "length", e->unit_length, sizeof e->unit_length);
    take_text(units, "stress", e->unit_stress, sizeof e->unit_stress);
    take_text(units, "time", e->unit_time, sizeof e->unit_time);
    take_text(json_object_get(root, "provenance"), "git", e->revision,
              sizeof e->revision);
    e->density = density_of(root);
out:
    return st;
}

ph_status ph_effective_parse(const char *text, size_t length, const char *name,
                             ph_effective **out, ph_error *err)
{
    ph_status st = PH_OK;
    json_t *root = NULL;
    ph_effective *e = NULL;
    PH_CHECK(text && out, PH_EINVAL, "no document");
    *out = NULL;
    PH_TRY(ph_i_json_parse(text, length, name, &root, err));
    PH_ALLOC(e, 1, "the effective material");
    st = take_document(root, e, err);
    if (st != PH_OK) {
        ph_error_prefix(err, "%s: ", name);
        goto out;
    }
    *out = e;
    e = NULL;
out:
    json_decref(root);
    ph_effective_free(&e);
    return st;
}

ph_status ph_effective_read(const char *path, ph_effective **out, ph_error *err)
{
    ph_status st = PH_OK;
    char file[4200];
    struct stat about;
    char *text = NULL;
    size_t length = 0;
    PH_CHECK(path && path[0], PH_EINVAL, "no path");
    bool folder = stat(path, &about) == 0 && S_ISDIR(about.st_mode);
    PH_CHECK((size_t)snprintf(file, sizeof file, folder ? "%s/result.json" : "%s", path) <
                 sizeof file,
             PH_EIO, "'%.100s...': the path is too long", path);
    PH_TRY(ph_i_read_file(file, MOST_BYTES, "result document", &text, &length, err));
    PH_TRY(ph_effective_parse(text, length, file, out, err));
out:
    free(text);
    return st;
}
