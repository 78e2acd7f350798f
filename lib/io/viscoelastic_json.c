/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The block effective.viscoelastic of the result document; a series as YAML. */
#include <perihom/output.h>

#include "io/json.h"

#include <math.h>
#include <string.h>

static ph_status tensor(const ph_sym4 *c, bool stiffness, json_t **out, ph_error *err)
{
    double voigt[36];
    ph_sym4_to_voigt(c, stiffness, voigt);
    return ph_i_json_matrix(c->n, voigt, out, err);
}

static ph_status put_tensor(json_t *map, const char *key, const ph_sym4 *c, ph_error *err)
{
    json_t *rows = NULL;
    ph_status st = tensor(c, true, &rows, err);
    return st == PH_OK ? ph_i_json_put(map, key, rows, err) : st;
}

static ph_status put_terms(json_t *map, const ph_prony *p, ph_error *err)
{
    ph_status st = PH_OK;
    json_t *list = json_array();
    PH_CHECK(list, PH_ENOMEM, "no memory for the terms");
    for (int m = 0; m < p->nterms; m++) {
        json_t *term = json_object();
        PH_TRY(ph_i_json_add(list, term, err));
        PH_TRY(ph_i_json_put(term, "time", ph_i_json_number(p->term[m].time), err));
        PH_TRY(put_tensor(term, "stiffness", &p->term[m].stiffness, err));
    }
    PH_TRY(ph_i_json_put(map, "terms", json_incref(list), err));
out:
    json_decref(list);
    return st;
}

/* Each column of a table under its name. */
static ph_status put_table(json_t *map, const char *key, const ph_table *t, ph_error *err)
{
    ph_status st = PH_OK;
    json_t *columns = json_object();
    PH_TRY(ph_i_json_put(map, key, columns, err));
    for (int c = 0; c < t->ncolumns; c++) {
        json_t *list = json_array();
        PH_TRY(ph_i_json_put(columns, t->name[c], list, err));
        for (ptrdiff_t r = 0; r < t->nrows; r++)
            PH_TRY(
                ph_i_json_add(list, ph_i_json_number(t->value[c * t->nrows + r]), err));
    }
out:
    return st;
}

static ph_status put_points(json_t *map, const ph_viscoelastic *v, ph_error *err)
{
    ph_status st = PH_OK;
    json_t *points = json_array(), *values = json_array();
    PH_CHECK(points && values, PH_ENOMEM, "no memory for the points");
    for (int k = 0; k < v->npoints; k++) {
        const ph_carson_point *p = &v->points[k];
        json_t *item = json_object();
        PH_TRY(ph_i_json_add(points, item, err));
        PH_TRY(ph_i_json_put(item, "s", ph_i_json_number(p->s), err));
        PH_TRY(ph_i_json_put(item, "error", ph_i_json_number(p->error), err));
        PH_TRY(ph_i_json_put(item, "iterations", json_integer(p->iterations), err));
        PH_TRY(ph_i_json_put(item, "added", json_integer(p->added), err));
    }
    PH_TRY(ph_i_json_put(map, "points", json_incref(points), err));
    for (int k = 0; k < v->nvalues; k++) {
        json_t *item = json_object();
        PH_TRY(ph_i_json_add(values, item, err));
        PH_TRY(ph_i_json_put(item, "s", ph_i_json_number(v->values[k].s), err));
        PH_TRY(put_tensor(item, "stiffness", &v->values[k].stiffness, err));
    }
    if (v->nvalues > 0) PH_TRY(ph_i_json_put(map, "carson", json_incref(values), err));
out:
    json_decref(points);
    json_decref(values);
    return st;
}

/* How it was computed. */
static ph_status put_route(json_t *map, const ph_viscoelastic *v, ph_error *err)
{
    ph_status st = PH_OK;
    const struct {
        const char *key;
        json_int_t value;
    } count[] = {{"basis", v->basis},
                 {"basis_bytes", (json_int_t)v->basis_bytes},
                 {"iterations", v->iterations},
                 {"applications", v->applications},
                 {"steps", v->steps}};
    PH_TRY(ph_i_json_put(map, "route", ph_i_json_text(v->route), err));
    PH_TRY(ph_i_json_put(map, "error", ph_i_json_number(v->error), err));
    for (size_t i = 0; i < sizeof count / sizeof *count; i++)
        PH_TRY(ph_i_json_put(map, count[i].key, json_integer(count[i].value), err));
    PH_TRY(ph_i_json_put(map, "seconds", ph_i_json_number(v->seconds), err));
    PH_TRY(ph_i_json_put(map, "lost_directions", json_integer(v->lost), err));
    PH_TRY(put_points(map, v, err));
out:
    return st;
}

/* Bars of what is linear in C(t), a column a constant, between both ends. */
static ph_status put_error_curves(json_t *map, const ph_viscoelastic *v, ph_error *err)
{
    ph_status st = PH_OK;
    json_t *columns = json_object(), *time = json_array();
    PH_TRY(ph_i_json_put(columns, "time", json_incref(time), err));
    for (int i = 1; i < v->nerror_bars - 1; i++)
        PH_TRY(ph_i_json_add(time, ph_i_json_number(v->error_bars[i].time), err));
    for (int k = 0; k < v->error_bars[0].bar.count; k++) {
        const ph_error_constant *first = &v->error_bars[0].bar.constant[k];
        if (!ph_i_is_linear(first) || first->why) continue;
        json_t *list = json_array();
        PH_TRY(ph_i_json_put(columns, first->name, list, err));
        for (int i = 1; i < v->nerror_bars - 1; i++)
            PH_TRY(ph_i_json_add(
                list, ph_i_json_number(v->error_bars[i].bar.constant[k].bar), err));
    }
    PH_TRY(ph_i_json_put(map, "curves", json_incref(columns), err));
out:
    json_decref(columns);
    json_decref(time);
    return st;
}

static ph_status put_error_bars(json_t *map, const ph_viscoelastic *v, json_t *reasons,
                                ph_error *err)
{
    ph_status st = PH_OK;
    json_t *bars = json_object();
    const char *path = "effective.viscoelastic.error_bar.infinity";
    PH_TRY(ph_i_json_put(map, "error_bar", json_incref(bars), err));
    if (v->nerror_bars < 2) goto out;
    PH_TRY(ph_i_json_error_list(&v->error_bars[v->nerror_bars - 1].bar, path, true, bars,
                                "infinity", reasons, err));
    PH_TRY(put_error_curves(bars, v, err));
out:
    json_decref(bars);
    return st;
}

static ph_status put_block(json_t *map, const ph_viscoelastic *v,
                           const ph_relaxation_report *r, json_t *reasons, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_prony *series = r ? r->series : NULL;
    const ph_sym4 *last = series ? &series->equilibrium : &v->equilibrium;
    if (v->instantaneous.n)
        PH_TRY(put_tensor(map, "instantaneous", &v->instantaneous, err));
    if (last->n) PH_TRY(put_tensor(map, "stiffness_infinity", last, err));
    if (series) {
        PH_TRY(put_terms(map, series, err));
        PH_TRY(ph_i_json_put(map, "exact_terms", json_integer(v->series->nterms), err));
        PH_TRY(ph_i_json_put(map, "fit_error", ph_i_json_number(r->fit_error), err));
        if (r->constants->why[0])
            PH_TRY(ph_i_json_put(reasons, "effective.viscoelastic.curves",
                                 ph_i_json_text(r->constants->why), err));
    } else {
        PH_TRY(ph_i_json_put(map, "terms", json_null(), err));
        PH_TRY(ph_i_json_put(reasons, "effective.viscoelastic.terms",
                             ph_i_json_text("this route gives no series"), err));
    }
    if (r && r->curves) PH_TRY(put_table(map, "curves", r->curves, err));
    if (r && r->dynamic) PH_TRY(put_table(map, "dynamic", r->dynamic, err));
    if (r && r->response) PH_TRY(put_table(map, "response", r->response, err));
    PH_TRY(put_error_bars(map, v, reasons, err));
    PH_TRY(put_route(map, v, err));
out:
    return st;
}

ph_status ph_viscoelastic_to_json(const ph_viscoelastic *v, const ph_relaxation_report *r,
                                  const ph_case *c, const char *command, char **json,
                                  ph_error *err)
{
    ph_status st = PH_OK;
    json_t *document = NULL, *block = json_object();
    PH_CHECK(block, PH_ENOMEM, "no memory for the result document");
    PH_CHECK(v && v->elastic && json, PH_EINVAL, "no result to write");
    PH_TRY(ph_i_result_document(v->elastic, c, command, &document, err));
    PH_TRY(put_block(block, v, r, json_object_get(document, "reasons"), err));
    PH_TRY(ph_i_json_put(json_object_get(document, "effective"), "viscoelastic",
                         json_incref(block), err));
    PH_TRY(ph_i_json_dump(document, json, err));
out:
    json_decref(document);
    json_decref(block);
    return st;
}

/* ---- YAML ---- */

static void put_rows(FILE *to, const ph_sym4 *c, int indent)
{
    double voigt[36];
    ph_sym4_to_voigt(c, true, voigt);
    for (int i = 0; i < 6; i++) {
        fprintf(to, "%*s- [", indent, "");
        for (int j = 0; j < 6; j++)
            fprintf(to, "%s%.17g", j ? ", " : "", voigt[6 * i + j]);
        fprintf(to, "]\n");
    }
}

ph_status ph_prony_to_yaml(const ph_prony *p, const char *name, char **text,
                           ph_error *err)
{
    PH_GIVEN(p && text);
    ph_status st = PH_OK;
    size_t size = 0;
    FILE *to = NULL;
    *text = NULL;
    PH_CHECK(p->equilibrium.n == 6, PH_EINVAL,
             "a material of a case file is a 6 x 6 series, this one has n = %d",
             p->equilibrium.n);
    to = open_memstream(text, &size);
    PH_CHECK(to, PH_ENOMEM, "no memory for a series");
    fprintf(to, "materials:\n  %s:\n    stiffness:\n      infinity:\n", name);
    put_rows(to, &p->equilibrium, 8);
    fprintf(to, "      terms:%s\n", p->nterms ? "" : " []");
    for (int m = 0; m < p->nterms; m++) {
        fprintf(to, "        - time: %.17g\n          stiffness:\n", p->term[m].time);
        put_rows(to, &p->term[m].stiffness, 12);
    }
    int failed = ferror(to);
    failed |= fclose(to);
    to = NULL;
    PH_CHECK(!failed, PH_ENOMEM, "no memory for a series");
out:
    if (to) fclose(to);
    if (st != PH_OK) {
        free(*text);
        *text = NULL;
    }
    return st;
}
