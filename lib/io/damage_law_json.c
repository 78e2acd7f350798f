/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A damage law: a section of the result document, back from it, and a table. */
#include <perihom/output.h>
#include <perihom/table.h>

#include "io/json.h"

#include <math.h>
#include <string.h>

enum { MOST_KNOTS = 1000000 };

/* ---- writing ----------------------------------------------------------------------------- */

static json_t *stiffness_rows(const ph_sym4 *c, bool *good)
{
    double voigt[36];
    json_t *rows = json_array();
    ph_sym4_to_voigt(c, true, voigt);
    for (int i = 0; i < c->n; i++)
        ph_i_json_append(rows, ph_i_json_numbers(voigt + i * c->n, c->n, good), good);
    return rows;
}

static json_t *law_to_json(const ph_damage_law *l, bool *good)
{
    json_t *law = json_object(), *list = json_array();
    const ptrdiff_t segments = l->driven ? l->nknots - 1 : 0;
    ph_i_json_set(law, "strain",
                  l->driven ? ph_i_json_numbers(l->strain, l->n, good) : json_null(),
                  good);
    ph_i_json_set(law, "damage", ph_i_json_numbers(l->damage, l->nknots, good), good);
    ph_i_json_set(law, "begin", ph_i_json_numbers(l->begin, segments, good), good);
    ph_i_json_set(law, "end", ph_i_json_numbers(l->end, segments, good), good);
    for (int k = 0; k < l->nknots; k++)
        ph_i_json_append(list, stiffness_rows(&l->stiffness[k], good), good);
    ph_i_json_set(law, "stiffness", list, good);
    ph_i_json_set(law, "correction", ph_i_json_number(l->correction), good);
    return law;
}

ph_status ph_i_json_damage_law(const ph_result *result, json_t *damage, json_t *reasons,
                               ph_error *err)
{
    ph_status st = PH_OK;
    ph_damage_law *law = NULL;
    ph_error why = PH_ERROR_INIT;
    bool good = true;
    st = ph_damage_law_from_result(result, &law, &why);
    if (st == PH_EINVAL) {
        PH_TRY(
            ph_i_json_put(reasons, "effective.damage.law", ph_i_json_text(why.msg), err));
        st = ph_i_json_put(damage, "law", json_null(), err);
        goto out;
    }
    PH_CHECK(st == PH_OK, st, "%s", why.msg);
    PH_TRY(ph_i_json_put(damage, "law", law_to_json(law, &good), err));
    PH_CHECK(good, PH_ENOMEM, "no memory for the damage law");
out:
    ph_damage_law_free(&law);
    return st;
}

/* ---- reading ----------------------------------------------------------------------------- */

static bool read_numbers(const json_t *list, size_t n, double *out)
{
    if (json_array_size(list) != n) return false;
    for (size_t i = 0; i < n; i++) {
        const json_t *v = json_array_get(list, i);
        if (!json_is_number(v)) return false;
        out[i] = json_number_value(v);
    }
    return true;
}

static bool read_stiffness(const json_t *rows, int n, ph_sym4 *out)
{
    double voigt[36];
    if ((int)json_array_size(rows) != n) return false;
    for (int i = 0; i < n; i++)
        if (!read_numbers(json_array_get(rows, (size_t)i), (size_t)n, voigt + i * n))
            return false;
    *out = ph_sym4_from_voigt(n, voigt, true);
    return true;
}

ph_status ph_i_json_read_damage_law(const json_t *from, int n, ph_damage_law **out,
                                    ph_error *err)
{
    static const char where[] = "effective.damage.law";
    ph_status st = PH_OK;
    double *d = NULL, *begin = NULL, *end = NULL, strain[6];
    ph_sym4 *stiffness = NULL;
    const json_t *along = json_object_get(from, "strain");
    const json_t *tensors = json_object_get(from, "stiffness");
    if (!json_is_array(along)) return PH_OK; /* nothing drives: a table for people */
    size_t knots = json_array_size(json_object_get(from, "damage"));
    PH_CHECK(knots >= 1 && knots <= MOST_KNOTS && json_array_size(tensors) == knots,
             PH_EINVAL, "%s: damage and stiffness must be lists of one length", where);
    PH_ALLOC(d, knots, "damage");
    PH_ALLOC(begin, knots, "loads");
    PH_ALLOC(end, knots, "loads");
    PH_ALLOC(stiffness, knots, "stiffnesses");
    PH_CHECK(read_numbers(along, (size_t)n, strain) &&
                 read_numbers(json_object_get(from, "damage"), knots, d) &&
                 read_numbers(json_object_get(from, "begin"), knots - 1, begin) &&
                 read_numbers(json_object_get(from, "end"), knots - 1, end),
             PH_EINVAL,
             "%s: strain, damage, begin and end must be %d, %zu, %zu and %zu "
             "numbers",
             where, n, knots, knots - 1, knots - 1);
    for (size_t k = 0; k < knots; k++)
        PH_CHECK(read_stiffness(json_array_get(tensors, k), n, &stiffness[k]), PH_EINVAL,
                 "%s.stiffness[%zu]: must be %d rows of %d numbers", where, k, n, n);
    st = ph_damage_law_new(n, strain, (int)knots, d, stiffness, begin, end, out, err);
    if (st != PH_OK) {
        ph_error_prefix(err, "%s: ", where);
        goto out;
    }
    (*out)->correction = json_number_value(json_object_get(from, "correction"));
out:
    free(d);
    free(begin);
    free(end);
    free(stiffness);
    return st;
}

/* ---- table ------------------------------------------------------------------------------- */

enum { COLUMNS = 25, NAME = 8 };

/* Names of d, the loads of the segment that ends here, and the upper triangle. */
static int name_columns(int n, char text[COLUMNS][NAME], const char **name)
{
    static const int voigt[6] = {1, 2, 3, 4, 5, 6}, plane[3] = {1, 2, 6};
    const int *index = n == 6 ? voigt : plane;
    static const char *const first[] = {"damage", "begin", "end"};
    int count = 0;
    for (; count < 3; count++)
        snprintf(text[count], NAME, "%s", first[count]);
    for (int i = 0; i < n; i++)
        for (int j = i; j < n; j++)
            snprintf(text[count++], NAME, "C%d%d", index[i], index[j]);
    for (int i = 0; i < count; i++)
        name[i] = text[i];
    return count;
}

ph_status ph_damage_law_to_csv(const ph_damage_law *l, char **text, ph_error *err)
{
    ph_status st = PH_OK;
    ph_table *table = NULL;
    char names[COLUMNS][NAME];
    const char *name[COLUMNS];
    PH_GIVEN(l && text);
    PH_CHECK(l->nknots >= 1, PH_EINVAL, "no damage law to write");
    int columns = name_columns(l->n, names, name);
    PH_TRY(ph_table_new(columns, name, l->nknots, &table, err));
    for (int k = 0; k < l->nknots; k++) {
        double row[COLUMNS], voigt[36];
        int c = 0;
        bool first = k == 0 || !l->driven;
        ph_sym4_to_voigt(&l->stiffness[k], true, voigt);
        row[c++] = l->damage[k];
        row[c++] = first ? (double)NAN : l->begin[k - 1];
        row[c++] = first ? (double)NAN : l->end[k - 1];
        for (int i = 0; i < l->n; i++)
            for (int j = i; j < l->n; j++)
                row[c++] = voigt[i * l->n + j];
        for (c = 0; c < columns; c++)
            table->value[(ptrdiff_t)c * l->nknots + k] = row[c];
    }
    PH_TRY(ph_table_to_csv(table, text, err));
out:
    ph_table_free(&table);
    return st;
}
