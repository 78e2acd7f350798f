/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `data` of a calibration: which columns of a table are keys of the case, which are measured
 * quantities, and how sharp they are. */
#include <perihom/table.h>

#include "calibrate/file.h"
#include "io/text.h"

#include <math.h>
#include <string.h>

static const char *const data_keys[] = {"file", "columns"};
static const char *const column_keys[] = {"column", "factor"};
static const char *const sigma_keys[] = {"column", "factor", "relative"};

/* Where a number comes from: a column times a factor, a constant, or a share of the measured
 * value. */
typedef struct source {
    int column; /* -1: none */
    double factor, constant, relative;
} source;

typedef struct columns {
    const ph_table *table;
    source key[PH_FIT_KEYS];
    source output[PH_FIT_OUTPUTS], sigma[PH_FIT_OUTPUTS];
    bool has_sigma;
} columns;

static bool find_column(ph_i_reader *r, const ph_i_node *node, const ph_table *t,
                        int *column)
{
    char name[PH_TABLE_NAME];
    const char *names[PH_TABLE_COLUMNS];
    if (!ph_i_read_text(r, node, sizeof name, name)) return false;
    *column = ph_table_column(t, name);
    if (*column >= 0) return true;
    for (int i = 0; i < t->ncolumns; i++)
        names[i] = t->name[i];
    const ph_i_names all = {names, (size_t)t->ncolumns};
    char list[300];
    ph_i_join_names(all, " and ", list, sizeof list);
    ph_i_reject(r, node, PH_EINVAL, "%.200s has the columns %s", t->path, list);
    return false;
}

/* A column's name, or {column, factor}. */
static bool read_column(ph_i_reader *r, const ph_i_node *node, const ph_table *t,
                        ph_i_names keys, source *s)
{
    *s = (source){.column = -1, .factor = 1};
    if (node->kind != PH_I_MAP) return find_column(r, node, t, &s->column);
    ph_i_check_keys(r, node, keys, "a column");
    const ph_i_node *column = ph_i_need(r, node, "column", "name of a column"),
                    *factor = ph_i_get(node, "factor");
    if (!column || !find_column(r, column, t, &s->column)) return false;
    return !factor ||
           ph_i_read_number(r, factor, -1e60, 1e60,
                            "must be a number that the column is multiplied by",
                            &s->factor);
}

/* A number, a column, {column, factor} or {relative}. */
static bool read_sigma(ph_i_reader *r, const ph_i_node *node, const ph_table *t,
                       source *s)
{
    static const char rule[] =
        "must be a standard deviation > 0, a column, or {relative: "
        "0.02}";
    double x;
    *s = (source){.column = -1, .factor = 1};
    if (node->kind == PH_I_SCALAR && node->plain && ph_i_text_to_number(node->text, &x))
        return ph_i_read_positive(r, node, rule, &s->constant);
    if (node->kind == PH_I_MAP && ph_i_get(node, "relative")) {
        ph_i_check_keys(r, node, (ph_i_names)PH_I_NAMES(sigma_keys), "sigma");
        return ph_i_read_positive(r, ph_i_get(node, "relative"), rule, &s->relative);
    }
    return read_column(r, node, t, (ph_i_names)PH_I_NAMES(sigma_keys), s);
}

static bool read_sigmas(ph_i_reader *r, const ph_i_node *node, const ph_fit_file *f,
                        columns *c)
{
    bool each = node->kind == PH_I_MAP && !ph_i_get(node, "relative") &&
                !ph_i_get(node, "column");
    c->has_sigma = true;
    for (int o = 0; o < f->noutputs; o++) {
        const ph_i_node *own = each ? ph_i_get(node, f->output[o].name) : node;
        if (!own) {
            ph_i_missing(r, node, f->output[o].name,
                         "every measured quantity needs its sigma, or none has one");
            return false;
        }
        if (!read_sigma(r, own, c->table, &c->sigma[o])) return false;
    }
    return true;
}

static bool is_unknown(const ph_fit_file *f, const char *key)
{
    for (int j = 0; j < f->nunknowns; j++) {
        if (strcmp(f->unknown_key[j], key) == 0) return true;
        for (int a = 0; a < f->nalso[j]; a++)
            if (strcmp(f->also[j][a], key) == 0) return true;
    }
    return false;
}

static bool read_columns(ph_i_reader *r, const ph_i_node *map, ph_fit_file *f, columns *c)
{
    const ph_i_names keys = PH_I_NAMES(column_keys);
    const ph_i_node *sigma = ph_i_get(map, "sigma");
    for (size_t i = 0; i < map->count; i++) {
        const ph_i_node *node = map->child[i];
        ph_error not_one = PH_ERROR_INIT;
        ph_quantity q;
        if (node == sigma) continue;
        if (ph_quantity_find(node->key, &q, &not_one) == PH_OK) {
            if (f->noutputs == PH_FIT_OUTPUTS) {
                ph_i_complain(r, node, PH_EINVAL, "more than %d measured quantities",
                              PH_FIT_OUTPUTS);
                return false;
            }
            f->output[f->noutputs] = q;
            if (!read_column(r, node, c->table, keys, &c->output[f->noutputs++]))
                return false;
        } else if (is_unknown(f, node->key)) {
            ph_i_complain(r, node, PH_EINVAL,
                          "is an unknown: it cannot come from the data too");
            return false;
        } else if (strchr(node->key, '.') && !strchr(node->key, '=') &&
                   strlen(node->key) < PH_FIT_KEY && f->nkeys < PH_FIT_KEYS) {
            snprintf(f->key[f->nkeys], PH_FIT_KEY, "%s", node->key);
            if (!read_column(r, node, c->table, keys, &c->key[f->nkeys++])) return false;
        } else {
            ph_i_complain(r, node, PH_EINVAL,
                          "must be a key path of the case, a quantity, or sigma: %.200s",
                          not_one.msg);
            return false;
        }
    }
    if (f->noutputs == 0) {
        ph_i_complain(r, map, PH_EINVAL, "no measured quantity, such as E1: column");
        return false;
    }
    return !sigma || read_sigmas(r, sigma, f, c);
}

static double cell(const columns *c, const source *s, ptrdiff_t row)
{
    return s->column < 0 ? s->constant
                         : s->factor * c->table->value[s->column * c->table->nrows + row];
}

/* Index of the point at `place`: rows that agree in every key are one point. */
static int point_at(ph_fit_file *f, const double *place, int line)
{
    for (int p = 0; p < f->npoints; p++) {
        bool same = true;
        for (int k = 0; k < f->nkeys; k++)
            same = same && f->place[p][k] == place[k];
        if (same) return p;
    }
    memcpy(f->place[f->npoints], place, sizeof f->place[0]);
    f->line[f->npoints] = line;
    return f->npoints++;
}

static ph_status take_row(ph_fit_file *f, const columns *c, ptrdiff_t row, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_table *t = c->table;
    double place[PH_FIT_KEYS] = {0};
    for (int k = 0; k < f->nkeys; k++) {
        place[k] = cell(c, &c->key[k], row);
        PH_CHECK(isfinite(place[k]), PH_EINVAL,
                 "%s:%d: column '%s': no number, but '%s' of the case comes from it",
                 t->path, t->line[row], t->name[c->key[k].column], f->key[k]);
    }
    for (int o = 0; o < f->noutputs; o++) {
        double y = cell(c, &c->output[o], row), sigma = NAN;
        if (isnan(y)) continue; /* not measured */
        if (c->has_sigma) {
            sigma = cell(c, &c->sigma[o], row) + c->sigma[o].relative * fabs(y);
            PH_CHECK(sigma > 0 && isfinite(sigma), PH_EINVAL,
                     "%s:%d: sigma of %s is %g: must be > 0", t->path, t->line[row],
                     f->output[o].name, sigma);
        }
        PH_CHECK(c->has_sigma || y != 0, PH_EINVAL,
                 "%s:%d: %s is 0: it has no relative error, give a sigma", t->path,
                 t->line[row], f->output[o].name);
        int p = point_at(f, place, t->line[row]);
        f->measurement[f->nmeasurements++] =
            (ph_fit_measurement){.point = p, .output = o, .value = y, .sigma = sigma};
    }
out:
    return st;
}

static ph_status take_rows(ph_fit_file *f, const columns *c, ph_error *err)
{
    ph_status st = PH_OK;
    ptrdiff_t rows = c->table->nrows;
    PH_CHECK(rows <= 10000, PH_EINVAL, "%s: %td rows: at most 10000", c->table->path,
             rows);
    PH_ALLOC(f->place, rows, "data");
    PH_ALLOC(f->line, rows, "data");
    PH_ALLOC(f->measurement, rows * f->noutputs, "data");
    for (ptrdiff_t i = 0; i < rows; i++)
        PH_TRY(take_row(f, c, i, err));
    PH_CHECK(f->nmeasurements > 0, PH_EINVAL, "%s: no measured value", c->table->path);
    PH_CHECK(f->nmeasurements >= f->nunknowns, PH_EINVAL,
             "%s: %d unknowns and %d measurement%s: there must be at least as many "
             "measurements as unknowns",
             c->table->path, f->nunknowns, f->nmeasurements,
             f->nmeasurements == 1 ? "" : "s");
out:
    return st;
}

ph_status ph_i_fit_read_data(ph_i_reader *r, const ph_i_node *node, const char *folder,
                             ph_fit_file *file, ph_error *err)
{
    ph_status st = PH_OK;
    ph_table *table = NULL;
    char name[512];
    columns c = {.has_sigma = false};
    if (!ph_i_read_map(r, node,
                       "must be a map such as {file: data.csv, columns: {E1: E}}"))
        goto out;
    ph_i_check_keys(r, node, (ph_i_names)PH_I_NAMES(data_keys), "data");
    const ph_i_node *path = ph_i_need(r, node, "file", "a table, such as data.csv"),
                    *map = ph_i_need(r, node, "columns",
                                     "keys and quantities, each with its "
                                     "column");
    if (!path || !map || !ph_i_read_text(r, path, sizeof name, name) ||
        !ph_i_read_map(r, map, "must be a map such as {E1: E, sigma: sd}"))
        goto out;
    snprintf(file->data_path, sizeof file->data_path, "%s%s%s",
             name[0] == '/' ? "" : folder, name[0] == '/' ? "" : "/", name);
    PH_TRY(ph_table_read(file->data_path, &table, err));
    c.table = table;
    if (read_columns(r, map, file, &c)) PH_TRY(take_rows(file, &c, err));
out:
    ph_table_free(&table);
    return st;
}
