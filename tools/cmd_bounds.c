/* SPDX-License-Identifier: GPL-3.0-or-later */
/* perihom bounds: what analytic bounds and estimates say of a case, without solving it. */
#include "bounds.h"
#include "check.h"
#include "tools.h"

#include <jansson.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct bounds_options {
    text_list operands, set;
    bool json;
} bounds_options;

static const option_spec options[] = {OPTION_SET(bounds_options),
                                      OPTION_JSON(bounds_options)};

static const verb_spec bounds_verb = {
    .name = "bounds",
    .title = "analytic bounds and estimates of a case; solves nothing",
    .operands = "CASE.yaml",
    .operands_min = 1,
    .operands_max = 1,
    .operands_offset = offsetof(bounds_options, operands),
    .example = {{"perihom bounds data/cases/boron-aluminium.yaml",
                 "Voigt, Reuss, Hashin-Shtrikman, Mori-Tanaka and more, as a table"},
                {"perihom bounds case.yaml --set materials.fibre.E=230",
                 "with another fibre"},
                {"perihom bounds case.yaml --json | jq '.methods[] | {name, E1: "
                 ".engineering.E1}'",
                 "the document perihom.bounds/1, for a script"}},
    .options = options,
    .noptions = sizeof options / sizeof *options,
    .more = "Builds the microstructure for its fractions. Inclusions are seen as "
            "cylinders (disks),\n"
            "spheres, spheroids or layers; a method that does not apply says why.\n"
            "Materials that relax: the bounds at once and at equilibrium.\n"
            "exit codes: 0 done, 2 usage, 3 case not admissible, 5 file or memory",
};

/* One method and what came of it. */
typedef struct bounds_row {
    const ph_estimate_method *method;
    bool valid;
    ph_sym4 stiffness;
    ph_engineering engineering; /* NaN where there are none */
    char reason[512];           /* why not valid, or why there are no constants */
} bounds_row;

static bounds_row evaluate(const bounds_composite *b, const ph_estimate_method *m)
{
    bounds_row row = {.method = m};
    ph_error err = PH_ERROR_INIT;
    row.valid = bounds_evaluate(b, m, &row.stiffness, &err) == PH_OK;
    if (!row.valid)
        snprintf(row.reason, sizeof row.reason, "%s", err.msg);
    else if (ph_engineering_constants(&row.stiffness, &row.engineering, NULL) != PH_OK)
        snprintf(row.reason, sizeof row.reason, "%s",
                 ph_sym4_norm(&row.stiffness) == 0.0 ? "zero: there are voids"
                                                     : "no stiffness in some direction");
    return row;
}

static const char *kind_name(ph_estimate_kind kind)
{
    return kind == PH_BOUND_LOWER   ? "lower"
           : kind == PH_BOUND_UPPER ? "upper"
                                    : "estimate";
}

/* The constants that n strain components have, by their names in the result document. */
static int constants(const ph_engineering *e, int n, const char *name[12],
                     double value[12])
{
    static const char *const space[] = {"E1",   "E2",   "E3",   "nu12", "nu13", "nu23",
                                        "nu21", "nu31", "nu32", "G23",  "G13",  "G12"};
    static const char *const flat[] = {"E1", "E2", "nu12", "nu21", "G12"};
    const double s[12] = {e->E[0],     e->E[1],     e->E[2],     e->nu[0][1],
                          e->nu[0][2], e->nu[1][2], e->nu[1][0], e->nu[2][0],
                          e->nu[2][1], e->G23,      e->G13,      e->G12};
    const double f[5] = {e->E[0], e->E[1], e->nu[0][1], e->nu[1][0], e->G12};
    const int count = n == 3 ? 5 : 12;
    for (int i = 0; i < count; i++) {
        name[i] = n == 3 ? flat[i] : space[i];
        value[i] = n == 3 ? f[i] : s[i];
    }
    return count;
}

static void print_table(const ph_case *c, const bounds_composite *b,
                        const bounds_row *rows)
{
    const int n = ph_strains(c->kinematics);
    const char *name[12];
    double value[12];
    printf("%s\n", c->title[0] ? c->title : c->path);
    for (int i = 0; i < b->composite.n; i++)
        printf("  %-20s %.6f%s\n", b->material[i].name, b->fraction[i],
               i ? "" : "  (matrix)");
    printf("  seen as a %s", bounds_shape_name(b->composite.shape));
    if (b->composite.shape == PH_SHAPE_SPHEROID)
        printf(" of aspect %g", b->composite.aspect);
    printf("; moduli in %s\n\n", c->unit_stress[0] ? c->unit_stress : "the case's unit");
    ph_engineering none = {.G12 = NAN};
    const int count = constants(&none, n, name, value);
    printf("%-28s %-8s", "method", "kind");
    for (int k = 0; k < count; k++)
        printf(" %9s", name[k]);
    printf("\n");
    for (size_t i = 0; i < ph_nestimate_methods; i++) {
        const bounds_row *r = &rows[i];
        printf("%-28s %-8s", r->method->info.name, kind_name(r->method->kind));
        if (r->reason[0]) {
            printf("  %s %s", r->valid ? "=" : "-", r->reason);
        } else {
            constants(&r->engineering, n, name, value);
            for (int k = 0; k < count; k++)
                printf(" %9.5g", value[k]);
        }
        printf("\n");
    }
}

static json_t *json_matrix(const ph_sym4 *c)
{
    double v[36];
    json_t *rows = json_array();
    ph_sym4_to_voigt(c, true, v);
    for (int i = 0; i < c->n; i++) {
        json_t *row = json_array();
        for (int j = 0; j < c->n; j++)
            json_array_append_new(row, json_real(v[i * c->n + j]));
        json_array_append_new(rows, row);
    }
    return rows;
}

/* A number, or null where it is none. */
static json_t *json_number(double x)
{
    return isfinite(x) ? json_real(x) : json_null();
}

static json_t *json_row(const bounds_row *r, ph_kinematics kin)
{
    const ph_entry *e = &r->method->info;
    json_t *o = json_pack("{s:s,s:s,s:s,s:s,s:s,s:b}", "name", e->name, "title", e->title,
                          "kind", kind_name(r->method->kind), "reference", e->reference,
                          "valid_for", e->valid, "valid", r->valid);
    if (r->reason[0]) json_object_set_new(o, "reason", json_string(r->reason));
    json_object_set_new(o, "stiffness",
                        r->valid ? json_matrix(&r->stiffness) : json_null());
    if (!r->valid || r->reason[0]) return o;
    const char *name[12];
    double value[12];
    const int count = constants(&r->engineering, r->stiffness.n, name, value);
    json_t *engineering = json_object();
    for (int k = 0; k < count; k++)
        json_object_set_new(engineering, name[k], json_number(value[k]));
    json_object_set_new(o, "engineering", engineering);
    ph_isotropic i = ph_nearest_isotropic(&r->stiffness, kin);
    json_t *iso = json_object();
    json_object_set_new(iso, "E", json_number(i.E));
    json_object_set_new(iso, "nu", json_number(i.nu));
    json_object_set_new(iso, "K", json_number(i.K));
    json_object_set_new(iso, "G", json_number(i.G));
    json_object_set_new(iso, "distance", json_number(i.distance));
    json_object_set_new(o, "isotropic", iso);
    return o;
}

static json_t *json_methods(const ph_case *c, const bounds_row *rows)
{
    json_t *methods = json_array();
    for (size_t i = 0; i < ph_nestimate_methods; i++)
        json_array_append_new(methods, json_row(&rows[i], c->kinematics));
    return methods;
}

static json_t *json_document(const ph_case *c, const bounds_composite *b,
                             const bounds_row *rows)
{
    const char *notation = ph_strains(c->kinematics) == 3
                               ? "voigt 11 22 12, engineering shear"
                               : "voigt 11 22 33 23 13 12, engineering shear";
    json_t *fractions = json_object();
    for (int i = 0; i < b->composite.n; i++)
        json_object_set_new(fractions, b->material[i].name, json_real(b->fraction[i]));
    return json_pack("{s:s,s:s,s:{s:s,s:s,s:s},s:o,s:s,s:s,s:f,s:s,s:s,s:o}", "schema",
                     "perihom.bounds/1", "title", c->title, "units", "length",
                     c->unit_length, "stress", c->unit_stress, "time", c->unit_time,
                     "fractions", fractions, "matrix", b->material[0].name, "shape",
                     bounds_shape_name(b->composite.shape), "aspect", b->composite.aspect,
                     "note", b->note, "notation", notation, "methods",
                     json_methods(c, rows));
}

/* Printed, or put into `*root`: the document itself, or "equilibrium" of one that is there. */
static ph_status bounds_of(const ph_case *c, json_t **root, ph_error *err)
{
    ph_status st = PH_OK;
    bounds_composite b = {0};
    bounds_row *rows = NULL;
    PH_TRY(bounds_composite_init(c, &b, err));
    rows = calloc(ph_nestimate_methods, sizeof *rows);
    PH_CHECK(rows, PH_ENOMEM, "no memory for the table");
    for (size_t i = 0; i < ph_nestimate_methods; i++)
        rows[i] = evaluate(&b, &ph_estimate_methods[i]);
    if (!root)
        print_table(c, &b, rows);
    else if (*root)
        json_object_set_new(*root, "equilibrium",
                            json_pack("{s:o}", "methods", json_methods(c, rows)));
    else
        *root = json_document(c, &b, rows);
    if (b.note[0] && !(root && json_object_get(*root, "equilibrium"))) talk("%s", b.note);
out:
    free(rows);
    bounds_composite_free(&b);
    return st;
}

/* The case with the elastic materials of Carson variable s. */
static ph_status bounds_at(const ph_case *c, double s, json_t **root, ph_error *err)
{
    ph_status st = PH_OK;
    ph_case at = *c; /* borrows everything but the materials */
    at.materials = calloc((size_t)c->nmaterials, sizeof *at.materials);
    PH_CHECK(at.materials, PH_ENOMEM, "no memory for the materials");
    for (int i = 0; i < c->nmaterials; i++)
        PH_TRY(ph_material_at(&c->materials[i], s, &at.materials[i], err));
    PH_TRY(bounds_of(&at, root, err));
out:
    free(at.materials);
    return st;
}

/* Materials that relax: at once, and at equilibrium where that is an elastic material. */
static ph_status bounds_that_relax(const ph_case *c, json_t **root, ph_error *err)
{
    ph_status st = PH_OK;
    ph_error why = PH_ERROR_INIT;
    if (!root) printf("At once (time 0)\n");
    PH_TRY(bounds_at(c, HUGE_VAL, root, err));
    if (!root) printf("\nAt equilibrium (time infinity)\n");
    if (bounds_at(c, 0, root, &why) != PH_OK)
        talk("no bounds at equilibrium: %s", why.msg);
out:
    return st;
}

static ph_status run_bounds(const ph_case *c, bool json, ph_error *err)
{
    ph_status st = PH_OK;
    json_t *root = NULL, **to = json ? &root : NULL;
    if (ph_case_relaxes(c))
        PH_TRY(bounds_that_relax(c, to, err));
    else
        PH_TRY(bounds_of(c, to, err));
    if (!json) goto out;
    PH_CHECK(root &&
                 json_dumpf(root, stdout, JSON_INDENT(1) | JSON_REAL_PRECISION(17)) == 0,
             PH_EIO, "could not write the JSON document");
    printf("\n");
out:
    json_decref(root);
    return st;
}

int cmd_bounds(int argc, char **argv)
{
    bounds_options o = {0};
    ph_case *c = NULL;
    ph_error err = PH_ERROR_INIT;
    int code = options_parse(&bounds_verb, argc, argv, &o);
    if (code < 0) {
        code = case_load(o.operands.item[0], &o.set, &c);
        if (code == 0 && run_bounds(c, o.json, &err) != PH_OK)
            code = talk_case_error(o.operands.item[0], &o.set, &err);
    }
    ph_case_free(&c);
    free(o.operands.item);
    free(o.set.item);
    return code;
}
