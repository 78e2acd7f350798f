/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What cracks did: a section of the result document, and a table. */
#include <perihom/output.h>
#include <perihom/table.h>

#include "io/json.h"

#include <math.h>
#include <string.h>

static const char *value_name(ph_sequence_kind kind)
{
    return kind == PH_SEQUENCE_GROWTH    ? "crack_length"
           : kind == PH_SEQUENCE_DENSITY ? "density_asked"
           : kind == PH_SEQUENCE_LOADING ? "load"
                                         : NULL;
}

static ph_status put_voigt(json_t *obj, const char *key, const ph_sym4 *c, ph_error *err)
{
    ph_status st = PH_OK;
    double voigt[36];
    json_t *rows = NULL;
    ph_sym4_to_voigt(c, true, voigt);
    PH_TRY(ph_i_json_matrix(c->n, voigt, &rows, err));
    PH_TRY(ph_i_json_put(obj, key, rows, err));
out:
    return st;
}

static ph_status put_integer(json_t *obj, const char *key, ptrdiff_t x, ph_error *err)
{
    return ph_i_json_put(obj, key, json_integer((json_int_t)x), err);
}

static ph_status put_step(const ph_damage *d, int number, json_t *list, json_t *reasons,
                          ph_error *err)
{
    ph_status st = PH_OK;
    const ph_damage_step *s = &d->step[number];
    json_t *obj = json_object(), *psi = json_array(), *tensor = json_array();
    char path[64];
    int axes = s->stiffness.n == 6 ? 3 : 2;
    snprintf(path, sizeof path, "effective.damage.steps.%d", number);
    PH_CHECK(obj && psi && tensor, PH_ENOMEM, "no memory for the damage");
    PH_TRY(ph_i_json_put(
        obj, "load", d->kind == PH_SEQUENCE_LOADING ? json_real(s->value) : json_null(),
        err));
    if (value_name(d->kind) && d->kind != PH_SEQUENCE_LOADING)
        PH_TRY(ph_i_json_put(obj, value_name(d->kind), json_real(s->value), err));
    PH_TRY(ph_i_json_put(obj, "density", ph_i_json_number(s->density), err));
    if (d->kind != PH_SEQUENCE_LOADING)
        PH_TRY(ph_i_json_put(obj, "crack_surface", ph_i_json_number(s->surface), err));
    PH_TRY(put_voigt(obj, "stiffness", &s->stiffness, err));
    PH_TRY(put_voigt(obj, "tangent", &s->tangent, err));
    if (isnan(s->tangent.m[0][0])) {
        char key[80];
        snprintf(key, sizeof key, "%s.tangent", path);
        PH_TRY(ph_i_json_put(
            reasons, key, ph_i_json_text("strains that zero stress finds turned"), err));
    }
    for (int n = 0; n < axes; n++) {
        PH_TRY(ph_i_json_add(psi, ph_i_json_number(s->psi[n]), err));
        PH_TRY(ph_i_json_add(tensor, ph_i_json_number(s->tensor[n]), err));
    }
    PH_TRY(ph_i_json_put(obj, "psi", json_incref(psi), err));
    PH_TRY(ph_i_json_put(obj, "damage_tensor", json_incref(tensor), err));
    PH_TRY(ph_i_json_put(obj, "damage_tensor_error", ph_i_json_number(s->tensor_error),
                         err));
    PH_TRY(ph_i_json_put_number(obj, path, "anisotropy_index", s->anisotropy, reasons,
                                isnan(s->anisotropy) ? "load cases were not solved"
                                                     : "the stiffness is singular",
                                err));
    PH_TRY(put_integer(obj, "broken_bonds", s->broken_bonds, err));
    PH_TRY(ph_i_json_put(obj, "mean_damage", ph_i_json_number(s->mean_damage), err));
    PH_TRY(put_integer(obj, "damaged_nodes", s->damaged_nodes, err));
    PH_TRY(put_integer(obj, "nodes_without_stress", s->mute_nodes, err));
    PH_TRY(put_integer(obj, "iterations", s->iterations, err));
    PH_TRY(ph_i_json_put(obj, "residual", ph_i_json_number(s->residual), err));
    if (d->error_bars) {
        char key[80];
        snprintf(key, sizeof key, "%s.error_bar", path);
        PH_TRY(ph_i_json_error_list(&d->error_bars[number], key, false, obj, "error_bar",
                                    reasons, err));
    }
    PH_TRY(ph_i_json_add(list, json_incref(obj), err));
out:
    json_decref(obj);
    json_decref(psi);
    json_decref(tensor);
    return st;
}

ph_status ph_i_json_damage(const ph_result *result, json_t *effective, json_t *reasons,
                           ph_error *err)
{
    ph_status st = PH_OK;
    const ph_damage *d = result->damage;
    json_t *damage = json_object(), *steps = json_array();
    PH_CHECK(damage && steps, PH_ENOMEM, "no memory for the damage");
    PH_TRY(put_voigt(damage, "pristine", &d->pristine, err));
    if (d->pristine_error_bar)
        PH_TRY(ph_i_json_error_list(d->pristine_error_bar,
                                    "effective.damage.pristine_error_bar", false, damage,
                                    "pristine_error_bar", reasons, err));
    for (int i = 0; i < d->nsteps; i++)
        PH_TRY(put_step(d, i, steps, reasons, err));
    PH_TRY(ph_i_json_put(damage, "steps", json_incref(steps), err));
    PH_TRY(ph_i_json_damage_law(result, damage, reasons, err));
    PH_TRY(ph_i_json_put(effective, "damage", json_incref(damage), err));
out:
    json_decref(damage);
    json_decref(steps);
    return st;
}

/* ---- table ------------------------------------------------------------------------------- */

enum { COLUMNS = 40, NAME = 24 };

typedef struct column_names {
    int count;
    char text[COLUMNS][NAME];
    const char *name[COLUMNS];
} column_names;

static void add_name(column_names *c, const char *fmt, int i, int j)
{
    snprintf(c->text[c->count], NAME, fmt, i, j);
    c->name[c->count] = c->text[c->count];
    c->count++;
}

static void name_columns(const ph_damage *d, int n, column_names *c)
{
    static const int voigt[6] = {1, 2, 3, 4, 5, 6}, plane[3] = {1, 2, 6};
    const int *index = n == 6 ? voigt : plane;
    c->count = 0;
    add_name(c, value_name(d->kind) ? value_name(d->kind) : "step", 0, 0);
    add_name(c, "density", 0, 0);
    for (int i = 0; i < n; i++)
        for (int j = i; j < n; j++)
            add_name(c, "C%d%d", index[i], index[j]);
    for (int i = 0; i < (n == 6 ? 3 : 2); i++)
        add_name(c, "psi%d", i + 1, 0);
    add_name(c, "anisotropy_index", 0, 0);
    add_name(c, "mean_damage", 0, 0);
    add_name(c, "broken_bonds", 0, 0);
    add_name(c, "damaged_nodes", 0, 0);
    add_name(c, "nodes_without_stress", 0, 0);
    add_name(c, "iterations", 0, 0);
}

static void fill_row(const ph_damage *d, int row, double *x)
{
    const ph_damage_step *s = &d->step[row];
    int n = s->stiffness.n, k = 0;
    double voigt[36];
    ph_sym4_to_voigt(&s->stiffness, true, voigt);
    x[k++] = value_name(d->kind) ? s->value : row + 1.0;
    x[k++] = s->density;
    for (int i = 0; i < n; i++)
        for (int j = i; j < n; j++)
            x[k++] = voigt[i * n + j];
    for (int i = 0; i < (n == 6 ? 3 : 2); i++)
        x[k++] = s->psi[i];
    x[k++] = s->anisotropy;
    x[k++] = s->mean_damage;
    x[k++] = (double)s->broken_bonds;
    x[k++] = (double)s->damaged_nodes;
    x[k++] = (double)s->mute_nodes;
    x[k++] = s->iterations;
}

ph_status ph_damage_to_csv(const ph_damage *d, char **text, ph_error *err)
{
    ph_status st = PH_OK;
    ph_table *table = NULL;
    column_names names;
    double x[COLUMNS];
    PH_CHECK(d && text && d->nsteps > 0, PH_EINVAL, "no damage to write");
    name_columns(d, d->pristine.n, &names);
    PH_TRY(ph_table_new(names.count, names.name, d->nsteps, &table, err));
    for (int i = 0; i < d->nsteps; i++) {
        fill_row(d, i, x);
        for (int k = 0; k < names.count; k++)
            table->value[(ptrdiff_t)k * d->nsteps + i] = x[k];
    }
    PH_TRY(ph_table_to_csv(table, text, err));
out:
    ph_table_free(&table);
    return st;
}
