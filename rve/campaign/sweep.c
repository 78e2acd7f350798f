/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which keys of the case vary, and how. */
#include "campaign/campaign.h"

#include <math.h>
#include <string.h>

void ph_i_sweep_clear(ph_i_sweep *s)
{
    for (size_t a = 0; a < s->naxes; a++) {
        for (size_t i = 0; i < s->axis[a].count; i++)
            free(s->axis[a].value[i]);
        free(s->axis[a].value);
        free(s->axis[a].number);
        free(s->axis[a].key);
    }
    free(s->axis);
    free(s->group);
    *s = (ph_i_sweep){0};
}

static size_t group_length(const ph_i_sweep *s, int group)
{
    for (size_t a = 0; a < s->naxes; a++)
        if (s->group[a] == group) return s->axis[a].count;
    return 1;
}

int ph_i_sweep_points(const ph_i_sweep *s)
{
    size_t points = 1;
    for (int g = 0; g < s->ngroups; g++) {
        points *= group_length(s, g);
        if (points > PH_CAMPAIGN_POINTS) return 0;
    }
    return (int)points;
}

size_t ph_i_sweep_at(const ph_i_sweep *s, int point, size_t a)
{
    size_t rest = (size_t)point;
    for (int g = s->ngroups - 1; g > s->group[a]; g--)
        rest /= group_length(s, g);
    return rest % group_length(s, s->group[a]);
}

static bool key_is_taken(const ph_i_sweep *s, const char *key)
{
    for (size_t a = 0; a < s->naxes; a++)
        if (strcmp(s->axis[a].key, key) == 0) return true;
    return false;
}

/* An empty axis at the end, in the newest group. */
static ph_status add_axis(ph_i_sweep *s, const char *key, size_t count, ph_i_axis **out,
                          ph_error *err)
{
    ph_status st = PH_OK;
    if (s->naxes == s->capacity) {
        size_t capacity = 2 * s->capacity + 4;
        ph_i_axis *axis = realloc(s->axis, capacity * sizeof *axis);
        PH_CHECK(axis, PH_ENOMEM, "no memory for a sweep");
        s->axis = axis;
        int *group = realloc(s->group, capacity * sizeof *group);
        PH_CHECK(group, PH_ENOMEM, "no memory for a sweep");
        s->group = group;
        s->capacity = capacity;
    }
    ph_i_axis *a = &s->axis[s->naxes];
    *a = (ph_i_axis){0};
    s->group[s->naxes++] = s->ngroups - 1;
    a->key = strdup(key);
    PH_CHECK(a->key, PH_ENOMEM, "no memory for a sweep");
    PH_ALLOC(a->value, count, "the values of a sweep");
    PH_ALLOC(a->number, count, "the values of a sweep");
    a->count = count;
    *out = a;
out:
    return st;
}

static bool key_is_good(ph_i_reader *r, const ph_i_sweep *s, const ph_i_node *node,
                        const char *key)
{
    if (key[0] == 0 || strlen(key) >= 160 || strchr(key, '=')) {
        ph_i_complain(r, node, PH_EINVAL,
                      "must be a dotted key of the case, as in --set key.path=value");
        return false;
    }
    if (strcmp(key, "microstructure.realisation") == 0) {
        ph_i_complain(r, node, PH_EINVAL, "the campaign itself counts the realisations");
        return false;
    }
    if (key_is_taken(s, key)) {
        ph_i_complain(r, node, PH_EINVAL, "this key varies already");
        return false;
    }
    return true;
}

static ph_status read_axis(ph_i_reader *r, const ph_i_node *list, ph_i_sweep *s,
                           ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_axis *a = NULL;
    if (!ph_i_read_list(r, list, 0, "must be the list of values that the key takes"))
        return PH_OK;
    if (!key_is_good(r, s, list, list->key)) return PH_OK;
    if (list->count == 0) {
        ph_i_reject(r, list, PH_EINVAL, "must have at least one value");
        return PH_OK;
    }
    PH_TRY(add_axis(s, list->key, list->count, &a, err));
    for (size_t i = 0; i < list->count; i++) {
        const ph_i_node *v = list->child[i];
        a->number[i] = NAN;
        a->value[i] = ph_i_tree_text(v);
        PH_CHECK(a->value[i], PH_ENOMEM, "no memory for the values of a sweep");
        if (v->kind == PH_I_SCALAR && v->plain)
            ph_i_text_to_number(v->text, &a->number[i]);
    }
out:
    return st;
}

static ph_status read_grid(ph_i_reader *r, const ph_i_node *map, ph_i_sweep *s,
                           ph_error *err)
{
    ph_status st = PH_OK;
    if (!map || !ph_i_read_map(r, map, "must be a map: key: [values]")) return PH_OK;
    for (size_t i = 0; i < map->count; i++) {
        size_t before = s->naxes;
        s->ngroups++;
        PH_TRY(read_axis(r, map->child[i], s, err));
        if (s->naxes == before) s->ngroups--;
    }
out:
    return st;
}

static ph_status read_zip(ph_i_reader *r, const ph_i_node *map, ph_i_sweep *s,
                          ph_error *err)
{
    ph_status st = PH_OK;
    if (!map || !ph_i_read_map(r, map, "must be a map: key: [values]")) return PH_OK;
    size_t first = s->naxes;
    s->ngroups++;
    for (size_t i = 0; i < map->count; i++) {
        size_t before = s->naxes;
        PH_TRY(read_axis(r, map->child[i], s, err));
        if (s->naxes > before && s->axis[before].count != s->axis[first].count)
            ph_i_complain(r, map->child[i], PH_EINVAL,
                          "%zu values, and %zu of '%.80s': keys of zip vary together",
                          s->axis[before].count, s->axis[first].count,
                          s->axis[first].key);
    }
    if (s->naxes == first) s->ngroups--;
out:
    return st;
}

static ph_status take_column(ph_i_reader *r, const ph_i_node *at, const ph_table *t,
                             ph_i_sweep *s, ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_axis *a = NULL;
    char name[PH_TABLE_NAME];
    if (!ph_i_read_text(r, at, sizeof name, name) || !key_is_good(r, s, at, at->key))
        return PH_OK;
    int column = ph_table_column(t, name);
    if (column < 0) {
        ph_i_reject(r, at, PH_EINVAL, "%.200s has no such column", t->path);
        return PH_OK;
    }
    PH_TRY(add_axis(s, at->key, (size_t)t->nrows, &a, err));
    for (ptrdiff_t i = 0; i < t->nrows; i++) {
        char text[40];
        a->number[i] = t->value[column * t->nrows + i];
        snprintf(text, sizeof text, "%.17g", a->number[i]);
        a->value[i] = strdup(isnan(a->number[i]) ? "null" : text);
        PH_CHECK(a->value[i], PH_ENOMEM, "no memory for the values of a sweep");
    }
out:
    return st;
}

static ph_status read_table(ph_i_reader *r, const ph_i_node *map, const char *folder,
                            ph_i_sweep *s, ph_error *err)
{
    static const char *const keys[] = {"file", "columns"};
    static const char columns_rule[] = "must be a map: key of the case: name of a column";
    ph_status st = PH_OK;
    ph_table *table = NULL;
    ph_error why = PH_ERROR_INIT;
    char file[512], path[1024];
    if (!map || !ph_i_read_map(r, map, "must be a map with file and columns"))
        return PH_OK;
    ph_i_check_keys(r, map, (ph_i_names)PH_I_NAMES(keys), "table");
    const ph_i_node *name = ph_i_need(r, map, "file", "the name of a text table");
    const ph_i_node *columns = ph_i_need(r, map, "columns", columns_rule);
    if (!name || !columns || !ph_i_read_text(r, name, sizeof file, file) ||
        !ph_i_read_map(r, columns, columns_rule))
        goto out;
    ph_i_path_in(folder, file, path, sizeof path);
    if (ph_table_read(path, &table, &why) != PH_OK) {
        ph_i_complain(r, name, PH_EINVAL, "%s", why.msg);
        goto out;
    }
    if (table->nrows == 0) {
        ph_i_complain(r, name, PH_EINVAL, "the table has no rows");
        goto out;
    }
    size_t first = s->naxes;
    s->ngroups++;
    for (size_t i = 0; i < columns->count; i++)
        PH_TRY(take_column(r, columns->child[i], table, s, err));
    if (s->naxes == first) s->ngroups--;
out:
    ph_table_free(&table);
    return st;
}

ph_status ph_i_sweep_read(ph_i_reader *r, const ph_i_node *root, const char *folder,
                          ph_i_sweep *sweep, ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(read_grid(r, ph_i_get(root, "sweep"), sweep, err));
    PH_TRY(read_zip(r, ph_i_get(root, "zip"), sweep, err));
    PH_TRY(read_table(r, ph_i_get(root, "table"), folder, sweep, err));
    if (ph_i_sweep_points(sweep) == 0)
        ph_i_complain_line(r, 0, "the sweep has more than %d points", PH_CAMPAIGN_POINTS);
out:
    return st;
}
