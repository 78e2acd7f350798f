/* SPDX-License-Identifier: GPL-3.0-or-later */
/* realisations, outputs and data of a campaign file. */
#include <perihom/table.h>

#include "campaign/campaign.h"

#include <math.h>
#include <string.h>

static const char count_rule[] = "must be an integer from 1 to 2^31 - 1";
static const char size_rule[] =
    "must be given, auto or a list of edges such as [0.5, 0.7, 1]";
enum { PILOT = 20 };

static ph_status read_outputs(ph_i_reader *r, const ph_i_node *root, ph_campaign *c,
                              ph_error *err)
{
    static const char rule[] = "must be a list of quantities such as [E1, nu12, G12]";
    ph_status st = PH_OK;
    const ph_i_node *list = ph_i_need(r, root, "outputs", rule);
    if (!list || !ph_i_read_list(r, list, 0, rule)) return PH_OK;
    if (list->count < 1 || list->count > PH_MAX_OUTPUTS) {
        ph_i_reject(r, list, PH_EINVAL, "must have 1 to %d quantities", PH_MAX_OUTPUTS);
        return PH_OK;
    }
    PH_ALLOC(c->output, list->count, "the outputs");
    for (size_t i = 0; i < list->count; i++) {
        ph_error why = PH_ERROR_INIT;
        ph_quantity *q = &c->output[c->noutputs];
        const ph_i_node *name = list->child[i];
        if (name->kind != PH_I_SCALAR) {
            ph_i_reject(r, name, PH_EINVAL, "must be the name of a quantity");
        } else if (ph_quantity_find(name->text, q, &why) != PH_OK) {
            ph_i_complain(r, name, PH_EINVAL, "%s", why.msg);
        } else {
            for (int k = 0; k < c->noutputs; k++)
                if (strcmp(c->output[k].name, q->name) == 0)
                    ph_i_complain(r, name, PH_EINVAL, "'%s' is there twice", q->name);
            c->noutputs++;
        }
    }
out:
    return st;
}

static int find_output(ph_i_reader *r, const ph_i_node *name, const ph_campaign *c)
{
    const char *names[PH_MAX_OUTPUTS];
    for (int i = 0; i < c->noutputs; i++)
        names[i] = c->output[i].name;
    if (c->noutputs == 0) return -1; /* that complaint is enough */
    return ph_i_read_name(r, name, (ph_i_names){names, (size_t)c->noutputs});
}

static void read_until(ph_i_reader *r, const ph_i_node *map, ph_campaign *c)
{
    static const char *const keys[] = {"quantity", "relative_half_width", "half_width",
                                       "confidence", "relative_error"};
    static const char width[] = "must be a number > 0, the half width of the interval";
    ph_stopping *s = &c->stopping;
    if (!map || !ph_i_read_map(r, map, "must be a map with quantity and a half width"))
        return;
    ph_i_check_keys(r, map, (ph_i_names)PH_I_NAMES(keys), "until");
    const ph_i_node *name = ph_i_need(r, map, "quantity", "one of the outputs"),
                    *rel = ph_i_get(map, keys[1]), *abs = ph_i_get(map, keys[2]),
                    *confidence = ph_i_get(map, keys[3]), *total = ph_i_get(map, keys[4]);
    if (name) c->judged = find_output(r, name, c);
    if (rel)
        ph_i_read_number(r, rel, 0, 1, "must lie between 0 and 1",
                         &s->relative_half_width);
    if (abs) ph_i_read_positive(r, abs, width, &s->half_width);
    if (rel && abs)
        ph_i_complain(r, abs, PH_EINVAL, "relative_half_width is given too: one of them");
    if (total)
        ph_i_read_number(r, total, 0, 1, "must lie between 0 and 1", &c->relative_error);
    if (total && (rel || abs))
        ph_i_complain(r, total, PH_EINVAL, "%s is given too: one of them",
                      rel ? keys[1] : keys[2]);
    if (!rel && !abs && !total) c->relative_error = PH_I_OF_CASE;
    if (confidence)
        ph_i_read_number(r, confidence, 1e-6, 1 - 1e-9,
                         "must lie between 0 and 1 (1e-6 to 1 - 1e-9)", &s->confidence);
}

static void read_realisations(ph_i_reader *r, const ph_i_node *root, ph_campaign *c)
{
    static const char *const keys[] = {"at_most", "at_least", "until"};
    static const char rule[] =
        "must be a number, or a map with at_most, at_least and until";
    const ph_i_node *node = ph_i_need(r, root, "realisations", rule);
    ph_stopping *s = &c->stopping;
    int64_t most = 1, least = PILOT;
    *s = (ph_stopping){.at_least = 1, .at_most = 1, .confidence = 0.95};
    if (!node) return;
    if (node->kind == PH_I_SCALAR) {
        ph_i_read_integer(r, node, 1, INT32_MAX, count_rule, &s->at_most);
        return;
    }
    if (!ph_i_read_map(r, node, rule)) return;
    ph_i_check_keys(r, node, (ph_i_names)PH_I_NAMES(keys), "realisations");
    const ph_i_node *at_most = ph_i_need(r, node, "at_most", count_rule),
                    *at_least = ph_i_get(node, "at_least"),
                    *until = ph_i_get(node, "until");
    if (at_most && !ph_i_read_integer(r, at_most, 1, INT32_MAX, count_rule, &most))
        return;
    if (at_least && !ph_i_read_integer(r, at_least, 2, INT32_MAX,
                                       "must be an integer from 2 on", &least))
        return;
    if (!until) {
        if (at_least)
            ph_i_complain(r, at_least, PH_EINVAL,
                          "without until there are always at_most realisations");
        s->at_most = most;
        return;
    }
    if (at_most && least > most) {
        ph_i_complain(r, at_most, PH_EINVAL,
                      "%lld is less than at_least, %lld: the pilot sample of the rule",
                      (long long)most, (long long)least);
        return;
    }
    s->at_most = most;
    s->at_least = least;
    read_until(r, until, c);
}

/* The key of the case that a column of data is for. */
static void take_data_key(ph_i_reader *r, const ph_i_node *column,
                          const ph_i_sweep *sweep, ph_campaign_data *d)
{
    bool varies = false;
    for (size_t a = 0; a < sweep->naxes; a++)
        varies |= strcmp(sweep->axis[a].key, column->key) == 0;
    if (!varies)
        ph_i_complain(r, column, PH_EINVAL,
                      "must be a key that varies in the campaign, one of its outputs, or "
                      "sigma");
    else if (d->key[0])
        ph_i_complain(r, column, PH_EINVAL, "a picture has one key: '%s' is there too",
                      d->key);
    snprintf(d->key, sizeof d->key, "%.*s", (int)sizeof d->key - 1, column->key);
    ph_i_read_text(r, column, sizeof d->x, d->x);
}

/* Does the table have the columns? Now, not when everything is computed. */
static void check_table(ph_i_reader *r, const ph_i_node *file, const ph_i_node *columns,
                        const ph_campaign *c)
{
    const ph_campaign_data *d = &c->data;
    ph_table *table = NULL;
    ph_error why = PH_ERROR_INIT;
    char path[1024];
    ph_i_path_in(c->folder, d->file, path, sizeof path);
    if (ph_table_read(path, &table, &why) != PH_OK) {
        ph_i_complain(r, file, PH_EINVAL, "%s", why.msg);
        return;
    }
    for (size_t i = 0; i < columns->count; i++)
        if (columns->child[i]->kind == PH_I_SCALAR &&
            ph_table_column(table, columns->child[i]->text) < 0)
            ph_i_reject(r, columns->child[i], PH_EINVAL, "%.200s has no such column",
                        path);
    ph_table_free(&table);
}

void ph_i_data_read(ph_i_reader *r, const ph_i_node *root, const ph_i_sweep *sweep,
                    ph_campaign *c)
{
    static const char *const keys[] = {"file", "columns"};
    static const char rule[] =
        "must be a map: a swept key, an output and sigma: names of columns";
    const ph_i_node *map = ph_i_get(root, "data");
    ph_campaign_data *d = &c->data;
    if (!map || !ph_i_read_map(r, map, "must be a map with file and columns")) return;
    ph_i_check_keys(r, map, (ph_i_names)PH_I_NAMES(keys), "data");
    const ph_i_node *file = ph_i_need(r, map, "file", "the name of a text table"),
                    *columns = ph_i_need(r, map, "columns", rule);
    if (file) ph_i_read_text(r, file, sizeof d->file, d->file);
    if (!columns || !ph_i_read_map(r, columns, rule)) return;
    for (size_t i = 0; i < columns->count; i++) {
        const ph_i_node *column = columns->child[i];
        const char *key = column->key;
        bool output = false;
        for (int k = 0; k < c->noutputs; k++)
            output |= strcmp(c->output[k].name, key) == 0;
        if (strcmp(key, "sigma") == 0) {
            ph_i_read_text(r, column, sizeof d->sigma, d->sigma);
        } else if (output) {
            if (d->quantity[0])
                ph_i_complain(r, column, PH_EINVAL,
                              "a picture has one output: '%s' is there too", d->quantity);
            snprintf(d->quantity, sizeof d->quantity, "%s", key);
            ph_i_read_text(r, column, sizeof d->y, d->y);
        } else {
            take_data_key(r, column, sweep, d);
        }
    }
    if (!d->key[0])
        ph_i_complain(r, columns, PH_EINVAL, "a swept key is missing: the column of x");
    else if (!d->quantity[0])
        ph_i_missing(r, columns, c->output[0].name,
                     "one of the outputs: the column of y");
    else if (file && d->x[0] && d->y[0])
        check_table(r, file, columns, c);
}

static void read_factors(ph_i_reader *r, const ph_i_node *list, ph_campaign *c)
{
    if (!ph_i_read_list(r, list, 0, size_rule)) return;
    if (list->count < 2 || list->count > PH_SPLIT_SIZES) {
        ph_i_reject(r, list, PH_EINVAL, "must have 2 to %d edges over that of the case",
                    PH_SPLIT_SIZES);
        return;
    }
    for (size_t i = 0; i < list->count; i++) {
        const ph_i_node *item = list->child[i];
        double *f = &c->factor[c->nfactors];
        if (!ph_i_read_number(r, item, 0.01, 100, "must lie between 0.01 and 100", f))
            continue;
        if (c->nfactors > 0 && *f <= f[-1])
            ph_i_complain(r, item, PH_EINVAL, "%g: edges must increase", *f);
        c->nfactors++;
    }
}

/* size: given | auto | [0.5, 0.7, 1] */
static void read_size(ph_i_reader *r, const ph_i_node *root, ph_campaign *c)
{
    static const double own[] = {0.5, 0.7071, 1, 1.4142, 2};
    const ph_i_node *node = ph_i_get(root, "size");
    if (!node) return;
    if (node->kind == PH_I_SCALAR) {
        int i = ph_i_read_name(
            r, node, (ph_i_names)PH_I_NAMES(((const char *const[]){"given", "auto"})));
        if (i != 1) return;
        c->nfactors = sizeof own / sizeof *own;
        memcpy(c->factor, own, sizeof own);
    } else {
        read_factors(r, node, c);
    }
    if (c->judged < 0 || c->stopping.at_most < PH_I_PILOTS)
        ph_i_complain(r, node, PH_EINVAL,
                      "needs realisations.until, the accuracy that the size is chosen "
                      "for, and at_most of %d or more",
                      PH_I_PILOTS);
    const ph_i_node *reduce = ph_i_get(root, "variance_reduction");
    if (reduce && !(reduce->kind == PH_I_SCALAR && strcmp(reduce->text, "none") == 0))
        ph_i_complain(r, node, PH_EINVAL,
                      "variance_reduction is there too: one of them, cheaper models are "
                      "of one size");
}

static void read_budget(ph_i_reader *r, const ph_i_node *root, ph_campaign *c)
{
    static const char *const keys[] = {"seconds", "memory"};
    const ph_i_node *map = ph_i_get(root, "budget");
    if (!map ||
        !ph_i_read_map(r, map, "must be a map such as {seconds: 600, memory: 8e9}"))
        return;
    ph_i_check_keys(r, map, (ph_i_names)PH_I_NAMES(keys), "budget");
    const ph_i_node *seconds = ph_i_get(map, "seconds"),
                    *memory = ph_i_get(map, "memory");
    if (seconds)
        ph_i_read_positive(r, seconds, "must be a number of seconds > 0", &c->seconds);
    if (memory)
        ph_i_read_positive(r, memory, "must be a number of bytes > 0", &c->memory);
}

ph_status ph_i_plan_read(ph_i_reader *r, const ph_i_node *root, ph_campaign *c,
                         ph_error *err)
{
    ph_status st = PH_OK;
    c->judged = -1;
    c->nmodels = 1;
    c->fillers_model = -1;
    c->common_random_numbers = true;
    PH_TRY(read_outputs(r, root, c, err));
    read_realisations(r, root, c);
    const ph_i_node *common = ph_i_get(root, "common_random_numbers");
    if (common) ph_i_read_flag(r, common, &c->common_random_numbers);
    read_size(r, root, c);
    read_budget(r, root, c);
out:
    return st;
}
