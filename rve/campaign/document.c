/* SPDX-License-Identifier: GPL-3.0-or-later */
/* campaign.json: nothing in it depends on who computed what when. */
#include "campaign/campaign.h"
#include "campaign/sizes.h"
#include "io/json.h"

#include <math.h>
#include <string.h>

/* The value of a swept key as JSON: number, true, false, null or its YAML text. */
static json_t *value_to_json(const ph_campaign_point *p, int k)
{
    if (isfinite(p->number[k])) return json_real(p->number[k]);
    json_t *parsed = json_loads(p->value[k], JSON_DECODE_ANY, NULL);
    return parsed ? parsed : ph_i_json_text(p->value[k]);
}

static ph_status put_statistic(json_t *map, const char *what, const ph_campaign *c,
                               const ph_campaign_summary *s,
                               double (*take)(const ph_interval *), ph_error *err)
{
    ph_status st = PH_OK;
    json_t *list = json_object();
    PH_TRY(ph_i_json_put(map, what, list, err));
    for (int k = 0; k < c->noutputs; k++)
        PH_TRY(ph_i_json_put(list, c->output[k].name,
                             ph_i_json_number(take(&s->output[k].mean)), err));
out:
    return st;
}

static double mean(const ph_interval *i)
{
    return i->mean;
}

static double deviation(const ph_interval *i)
{
    return i->deviation;
}

static double standard_error(const ph_interval *i)
{
    return i->standard_error;
}

static double half_width(const ph_interval *i)
{
    return i->half_width;
}

static ph_status put_level(json_t *list, const ph_campaign *c, const ph_level_report *l,
                           ph_error *err)
{
    ph_status st = PH_OK;
    json_t *map = json_object();
    PH_TRY(ph_i_json_add(list, map, err));
    PH_TRY(ph_i_json_put(
        map, "model", ph_i_json_text(l->model ? c->model_name[l->model] : "case"), err));
    PH_TRY(ph_i_json_put(map, "level", json_integer(l->model), err));
    PH_TRY(ph_i_json_put(map, "realisations", json_integer(l->n), err));
    PH_TRY(ph_i_json_put(map, "cost", ph_i_json_number(l->cost), err));
    PH_TRY(ph_i_json_put(map, "variance", ph_i_json_number(l->variance), err));
    PH_TRY(ph_i_json_put(map, "coefficient", ph_i_json_number(l->coefficient), err));
    PH_TRY(ph_i_json_put(map, "correlation", ph_i_json_number(l->correlation), err));
    PH_TRY(ph_i_json_put(map, "difference", ph_i_json_number(l->difference), err));
    PH_TRY(ph_i_json_put(map, "difference_error", ph_i_json_number(l->difference_error),
                         err));
out:
    return st;
}

/* How the means of a point were come by. */
static ph_status put_estimation(json_t *point, const ph_campaign *c,
                                const ph_estimation *e, ph_error *err)
{
    ph_status st = PH_OK;
    json_t *map = json_object(), *levels = json_array();
    PH_TRY(ph_i_json_put(point, "variance_reduction", map, err));
    PH_TRY(ph_i_json_put(map, "method",
                         e->method < 0 ? json_null()
                                       : json_string(ph_estimators[e->method].info.name),
                         err));
    PH_TRY(ph_i_json_put(map, "reason", ph_i_json_text(e->reason), err));
    PH_TRY(ph_i_json_put(map, "cost", ph_i_json_number(e->estimate.cost), err));
    PH_TRY(
        ph_i_json_put(map, "plain_cost", ph_i_json_number(e->estimate.plain_cost), err));
    PH_TRY(ph_i_json_put(map, "levels", levels, err));
    for (int l = 0; l < e->estimate.nlevels; l++)
        PH_TRY(put_level(levels, c, &e->estimate.level[l], err));
out:
    return st;
}

/* What the grid adds to the mean of output k, or why that is not known. */
static ph_status put_bias(json_t *list, const ph_campaign *c, int point, int k,
                          const ph_discretisation *b, ph_error *err)
{
    ph_status st = PH_OK;
    json_t *map = json_object();
    const char *no = ph_campaign_no_grid(c, point, k);
    double ratio = b->n ? c->point[point].grid.ratio : (double)NAN;
    PH_TRY(ph_i_json_put(list, c->output[k].name, map, err));
    PH_TRY(ph_i_json_put(map, "estimate", ph_i_json_number(b->estimate), err));
    PH_TRY(
        ph_i_json_put(map, "standard_error", ph_i_json_number(b->standard_error), err));
    PH_TRY(ph_i_json_put(map, "half_width", ph_i_json_number(b->half_width), err));
    PH_TRY(ph_i_json_put(map, "ratio", ph_i_json_number(ratio), err));
    PH_TRY(ph_i_json_put(map, "realisations", json_integer(b->n), err));
    if (b->n == 0)
        PH_TRY(ph_i_json_put(
            map, "reason",
            ph_i_json_text(no ? no : "too few realisations of both grids are there"),
            err));
out:
    return st;
}

static ph_status put_discretisation(json_t *point, const ph_campaign *c, int p,
                                    const ph_campaign_summary *s, ph_error *err)
{
    ph_status st = PH_OK;
    json_t *list = json_object();
    PH_TRY(ph_i_json_put(point, "discretisation", list, err));
    for (int k = 0; k < c->noutputs; k++)
        PH_TRY(put_bias(list, c, p, k, &s->output[k].bias, err));
out:
    return st;
}

/* What the size adds to output k at a point, over the mean: estimate and half width. */
static bool size_adds(const ph_campaign *c, int p, int k, double size, double *bias,
                      double *wide)
{
    const ph_campaign_sizes *r = c->sizes;
    if (!r || !r->chosen || k != c->judged) return false;
    int chosen = r->answer->candidate[r->answer->chosen].size;
    const ph_split_size *s = &r->answer->point[chosen * c->npoints + p];
    *bias = fabs(s->bias) / size;
    *wide = s->bias_half_width / size;
    return true;
}

/* Relative to the mean: what sampling leaves, what the grid and the size add, and all in full,
 * as in `until: {relative_error}`. Where nothing is known of the grid, that is said. */
static ph_status put_error_bar(const ph_campaign *c, int p, int k,
                               const ph_campaign_mean *x, json_t *const map[5],
                               ph_error *err)
{
    ph_status st = PH_OK;
    const char *name = c->output[k].name;
    double size = fabs(x->mean.mean), sampling = x->mean.half_width / size;
    const ph_discretisation *b = &x->bias;
    double grid = b->n ? (fabs(b->estimate) + b->half_width) / size : (double)NAN;
    const char *no = ph_campaign_no_grid(c, p, k);
    double bias = 0, wide = 0;
    if (c->grid_error > 0 && k == c->judged) grid = c->grid_error;
    if (size_adds(c, p, k, size, &bias, &wide))
        PH_TRY(ph_i_json_put(map[4], name, ph_i_json_number(bias + wide), err));
    PH_TRY(ph_i_json_put(map[0], name,
                         ph_i_json_number(grid + bias + hypot(wide, sampling)), err));
    PH_TRY(ph_i_json_put(map[1], name, ph_i_json_number(sampling), err));
    PH_TRY(ph_i_json_put(map[2], name, ph_i_json_number(grid), err));
    if (!isfinite(grid))
        PH_TRY(ph_i_json_put(map[3], name,
                             ph_i_json_text(no ? no : "too few realisations"), err));
out:
    return st;
}

static ph_status put_error_bars(json_t *point, const ph_campaign *c, int p,
                                const ph_campaign_summary *s, ph_error *err)
{
    ph_status st = PH_OK;
    json_t *parts = json_object();
    json_t *const map[] = {json_object(), json_object(), json_object(), json_object(),
                           json_object()};
    PH_TRY(ph_i_json_put(point, "error_bar", json_incref(map[0]), err));
    PH_TRY(ph_i_json_put(point, "error_parts", json_incref(parts), err));
    PH_TRY(ph_i_json_put(parts, "sampling", json_incref(map[1]), err));
    PH_TRY(ph_i_json_put(parts, "discretisation", json_incref(map[2]), err));
    if (c->sizes) PH_TRY(ph_i_json_put(parts, "size", json_incref(map[4]), err));
    PH_TRY(ph_i_json_put(point, "error_reasons", json_incref(map[3]), err));
    for (int k = 0; k < c->noutputs; k++)
        PH_TRY(put_error_bar(c, p, k, &s->output[k], map, err));
out:
    json_decref(parts);
    for (int i = 0; i < 5; i++)
        json_decref(map[i]);
    return st;
}

static ph_status put_point(json_t *list, const ph_campaign *c, int p,
                           const ph_campaign_summary *s, ph_error *err)
{
    ph_status st = PH_OK;
    json_t *map = json_object(), *parameters = json_object();
    PH_TRY(ph_i_json_add(list, map, err));
    PH_TRY(ph_i_json_put(map, "parameters", parameters, err));
    for (int k = 0; k < c->nkeys; k++)
        PH_TRY(ph_i_json_put(parameters, c->key[k], value_to_json(&c->point[p], k), err));
    PH_TRY(ph_i_json_put(map, "realisations", json_integer(s->output[0].n), err));
    PH_TRY(ph_i_json_put(map, "failed", json_integer(s->failed), err));
    PH_TRY(ph_i_json_put(map, "complete", json_boolean(s->complete), err));
    PH_TRY(ph_i_json_put(map, "reached", json_boolean(s->reached), err));
    PH_TRY(put_statistic(map, "mean", c, s, mean, err));
    PH_TRY(put_statistic(map, "std", c, s, deviation, err));
    PH_TRY(put_statistic(map, "standard_error", c, s, standard_error, err));
    PH_TRY(put_statistic(map, "half_width", c, s, half_width, err));
    PH_TRY(put_error_bars(map, c, p, s, err));
    if (s->estimation) {
        PH_TRY(put_estimation(map, c, s->estimation, err));
        PH_TRY(put_discretisation(map, c, p, s, err));
    }
out:
    return st;
}

static ph_status put_rule(json_t *root, const ph_campaign *c, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_stopping *s = &c->stopping;
    json_t *map = json_object();
    PH_TRY(ph_i_json_put(root, "stopping", map, err));
    PH_TRY(ph_i_json_put(map, "at_most", json_integer(s->at_most), err));
    PH_TRY(ph_i_json_put(map, "confidence", json_real(s->confidence), err));
    if (c->judged < 0) goto out;
    PH_TRY(ph_i_json_put(map, "at_least", json_integer(s->at_least), err));
    PH_TRY(
        ph_i_json_put(map, "quantity", ph_i_json_text(c->output[c->judged].name), err));
    if (s->half_width > 0.0)
        PH_TRY(ph_i_json_put(map, "half_width", json_real(s->half_width), err));
    else if (c->relative_error > 0.0)
        PH_TRY(ph_i_json_put(map, "relative_error", json_real(c->relative_error), err));
    if (c->grid_error > 0.0)
        PH_TRY(ph_i_json_put(map, "grid_error", json_real(c->grid_error), err));
    if (s->half_width == 0.0 && s->relative_half_width > 0.0)
        PH_TRY(ph_i_json_put(map, "relative_half_width",
                             json_real(s->relative_half_width), err));
out:
    return st;
}

static ph_status put_head(json_t *root, const ph_campaign *c, const ph_campaign_result *r,
                          ph_error *err)
{
    ph_status st = PH_OK;
    char hash[32];
    const ph_case *first = c->point[0].c;
    json_t *units = json_object(), *outputs = json_array(), *base = NULL;
    snprintf(hash, sizeof hash, "%016llx", (unsigned long long)c->hash);
    PH_TRY(ph_i_json_put(root, "schema", json_string("perihom.campaign/1"), err));
    PH_TRY(ph_i_json_put(root, "title",
                         ph_i_json_text(c->title[0] ? c->title : first->title), err));
    PH_TRY(ph_i_json_put(root, "campaign", json_string(hash), err));
    PH_TRY(ph_i_json_put(root, "units", units, err));
    PH_TRY(ph_i_json_put(units, "length", ph_i_json_text(first->unit_length), err));
    PH_TRY(ph_i_json_put(units, "stress", ph_i_json_text(first->unit_stress), err));
    PH_TRY(ph_i_json_put(units, "time", ph_i_json_text(first->unit_time), err));
    PH_TRY(ph_i_json_put(root, "outputs", outputs, err));
    for (int k = 0; k < c->noutputs; k++)
        PH_TRY(ph_i_json_add(outputs, ph_i_json_text(c->output[k].name), err));
    PH_TRY(put_rule(root, c, err));
    PH_TRY(ph_i_json_put(root, "common_random_numbers",
                         json_boolean(c->common_random_numbers), err));
    PH_TRY(ph_i_json_put(root, "complete", json_boolean(r->complete), err));
    PH_TRY(ph_i_json_put(root, "realisations", json_integer(r->realisations), err));
    PH_TRY(ph_i_json_put(root, "failed", json_integer(r->failed), err));
    PH_TRY(ph_i_case_json(first, &base, err));
    PH_TRY(ph_i_json_put(root, "case", base, err));
out:
    return st;
}

ph_status ph_campaign_to_json(const ph_campaign *c, const ph_campaign_result *r,
                              char **json, ph_error *err)
{
    PH_GIVEN(c && c->point && r && json);
    ph_status st = PH_OK;
    bool good = true;
    json_t *root = json_object(), *points = NULL;
    PH_CHECK(c && r && json, PH_EINVAL, "NULL campaign, result or text");
    PH_CHECK(root, PH_ENOMEM, "no memory for a document");
    PH_TRY(put_head(root, c, r, err));
    if (c->sizes) PH_TRY(ph_i_json_put(root, "split", ph_i_sizes_json(c, &good), err));
    PH_CHECK(good, PH_ENOMEM, "no memory for a document");
    points = json_array();
    PH_TRY(ph_i_json_put(root, "points", points, err));
    for (int p = 0; p < c->npoints; p++)
        PH_TRY(put_point(points, c, p, &r->point[p], err));
    PH_TRY(ph_i_json_dump(root, json, err));
out:
    json_decref(root);
    return st;
}

ph_status ph_campaign_write(const ph_campaign *c, const char *folder,
                            const ph_campaign_result *r, ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_store store = {.lock = -1, .fd = -1};
    char path[1200];
    char *json = NULL;
    PH_CHECK(c && folder && r, PH_EINVAL, "NULL campaign, folder or result");
    PH_TRY(ph_i_store_open(&store, folder, c, err));
    PH_TRY(ph_campaign_to_json(c, r, &json, err));
    snprintf(path, sizeof path, "%s/campaign.json", folder);
    PH_TRY(ph_write_file(path, json, strlen(json), err));
    snprintf(path, sizeof path, "%s/campaign.h5", folder);
    PH_TRY(ph_i_rows_write(&store, path, err));
    PH_TRY(ph_i_plots_write(&store, r, err));
out:
    ph_i_store_close(&store);
    free(json);
    return st;
}
