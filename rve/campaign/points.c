/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The case of every point of a sweep. */
#include "campaign/campaign.h"
#include "io/read_file.h"

#include <string.h>

enum { MAX_SETS = 256 };

/* Overrides as --set has them. */
typedef struct set_list {
    size_t count, owned; /* the last `owned` ones are ours */
    char *item[MAX_SETS];
} set_list;

static void clear_sets(set_list *s)
{
    for (size_t i = s->count - s->owned; i < s->count; i++)
        free(s->item[i]);
    s->count -= s->owned;
    s->owned = 0;
}

static ph_status add_set(set_list *s, const char *key, const char *value, ph_error *err)
{
    ph_status st = PH_OK;
    size_t size = strlen(key) + strlen(value) + 2;
    PH_CHECK(s->count < MAX_SETS, PH_EINVAL, "more than %d overrides of a case",
             MAX_SETS);
    PH_ALLOC(s->item[s->count], size, "an override");
    snprintf(s->item[s->count], size, "%s=%s", key, value);
    s->count++;
    s->owned++;
out:
    return st;
}

/* An override of a key that varies would never be seen. */
static bool varies(ph_i_reader *r, const ph_campaign *c, int line, const char *key)
{
    for (int k = 0; k < c->nkeys; k++)
        if (strcmp(c->key[k], key) == 0) {
            ph_i_complain_line(r, line, "%s %s: this key varies in the campaign",
                               line ? "set:" : "--set", key);
            return true;
        }
    return false;
}

/* `set` of the campaign file. */
static ph_status take_common_sets(ph_i_reader *r, const ph_i_node *root,
                                  const ph_campaign *c, set_list *s, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_i_node *map = ph_i_get(root, "set");
    if (!map || !ph_i_read_map(r, map, "must be a map: key of the case: value")) goto out;
    for (size_t i = 0; i < map->count; i++) {
        if (varies(r, c, map->child[i]->line, map->child[i]->key)) continue;
        char *value = ph_i_tree_text(map->child[i]);
        PH_CHECK(value, PH_ENOMEM, "no memory for an override");
        st = add_set(s, map->child[i]->key, value, err);
        free(value);
        if (st != PH_OK) goto out;
    }
out:
    return st;
}

static ph_status take_values(const ph_i_sweep *sweep, int point, ph_campaign *c,
                             set_list *sets, ph_error *err)
{
    ph_status st = PH_OK;
    ph_campaign_point *p = &c->point[point];
    PH_ALLOC(p->value, c->nkeys, "the values of a point");
    PH_ALLOC(p->number, c->nkeys, "the values of a point");
    for (int k = 0; k < c->nkeys; k++) {
        const ph_i_axis *a = &sweep->axis[k];
        size_t at = ph_i_sweep_at(sweep, point, (size_t)k);
        p->value[k] = strdup(a->value[at]);
        PH_CHECK(p->value[k], PH_ENOMEM, "no memory for the values of a point");
        p->number[k] = a->number[at];
        PH_TRY(add_set(sets, a->key, a->value[at], err));
    }
out:
    return st;
}

/* The line of the key of the map that is, begins or goes on as `path`; 0: none. */
static int line_in(const ph_i_node *map, const char *path, size_t length)
{
    for (size_t i = 0; map && map->kind == PH_I_MAP && i < map->count; i++) {
        size_t n = strlen(map->child[i]->key);
        if (strncmp(map->child[i]->key, path, n < length ? n : length) == 0)
            return map->child[i]->line;
    }
    return 0;
}

/* The line of the campaign file whose key a complaint about an override is about; 0: none. */
static int line_of_override(const ph_i_node *root, const char *complaint)
{
    static const char set[] = "--set ";
    static const char *const maps[] = {"set", "sweep", "zip"};
    int line = 0;
    if (strncmp(complaint, set, sizeof set - 1) != 0) return 0;
    const char *path = complaint + sizeof set - 1;
    size_t length = strcspn(path, ": ");
    for (size_t m = 0; m < sizeof maps / sizeof *maps && !line; m++)
        line = line_in(ph_i_get(root, maps[m]), path, length);
    const ph_i_node *table = ph_i_get(root, "table"),
                    *reduce = ph_i_get(root, "variance_reduction"), *levels = NULL;
    if (!line && table) line = line_in(ph_i_get(table, "columns"), path, length);
    if (reduce && reduce->kind == PH_I_MAP) levels = ph_i_get(reduce, "levels");
    for (size_t i = 0; levels && levels->kind == PH_I_LIST && i < levels->count; i++)
        if (!line) line = line_in(levels->child[i], path, length);
    return line;
}

/* Did an earlier point say the same? Its complaint ends with the text. */
static bool was_said(const ph_i_reader *r, const char *text)
{
    size_t n = strlen(text);
    for (size_t i = 0; i < r->issues->count; i++) {
        size_t length = strlen(r->issues->item[i].message);
        if (length >= n && strcmp(r->issues->item[i].message + length - n, text) == 0)
            return true;
    }
    return false;
}

/* Complaints of the case of a point become complaints of the campaign. */
static void hand_on(ph_i_reader *r, const ph_i_node *root, const ph_case_issues *issues,
                    const ph_campaign *c, int point)
{
    for (size_t i = 0; i < issues->count; i++) {
        char text[560]; /* a complaint has room for it and the point */
        const ph_case_issue *issue = &issues->item[i];
        if (issue->warning) continue;
        ph_case_issue_text(issue, c->case_path, text, sizeof text);
        if (!was_said(r, text))
            ph_i_complain_line(r, line_of_override(root, issue->message), "point %d: %s",
                               point, text);
    }
}

static void check_outputs(ph_i_reader *r, const ph_i_node *root, const ph_campaign *c,
                          int point)
{
    const ph_i_node *list = ph_i_get(root, "outputs");
    bool settled = c->relative_error > 0 && c->nmodels <= 1; /* ph_campaign_settle */
    if (ph_i_is_open(c->point[point].c) && !settled)
        ph_i_complain_line(r, 0,
                           "point %d: %s, or realisations.until.relative_error without "
                           "variance_reduction",
                           point, ph_i_open_words);
    for (int i = 0; i < c->noutputs; i++) {
        ph_error why = PH_ERROR_INIT;
        if (ph_scenario_admits(c->point[point].c, &c->output[i], &why) != PH_OK &&
            !was_said(r, why.msg))
            ph_i_complain(r, list->child[i], PH_EINVAL, "%s", why.msg);
    }
}

/* Is the microstructure a sample, of which a larger or a smaller one can be had? */
static const char *has_own_size(const ph_case *one)
{
    if (one->nfillers == 0 || one->voxels.file[0])
        return "nothing of the microstructure is random: its size is part of what it is";
    if (one->ninclusions > 0 || one->ncracks > 0)
        return "inclusions and cracks have their place in a cell of this size: fillers "
               "alone can be cut larger or smaller";
    return NULL;
}

static void check_size(ph_i_reader *r, const ph_i_node *root, const ph_campaign *c,
                       int point)
{
    static const char *const keys[] = {"microstructure.size", "microstructure.nodes",
                                       "microstructure.drawn_on"};
    const ph_case *one = c->point[point].c, *first = c->point[0].c;
    const ph_i_node *node = ph_i_get(root, "size");
    bool one_box = first && one->size[0] == first->size[0] &&
                   one->size[1] == first->size[1] && one->size[2] == first->size[2] &&
                   memcmp(one->nodes, first->nodes, sizeof one->nodes) == 0 &&
                   memcmp(one->drawn_on, first->drawn_on, sizeof one->nodes) == 0 &&
                   one->kinematics == first->kinematics;
    const char *no = has_own_size(one);
    if (c->nfactors == 0 || !node) return;
    for (int k = 0; k < c->nkeys && !no; k++)
        for (int i = 0; i < 3; i++)
            if (strncmp(c->key[k], keys[i], strlen(keys[i])) == 0)
                no = "the size, nodes or drawn_on vary in the campaign: choose one of "
                     "both";
    if (!no && !one_box)
        no = "points have boxes or grids of their own: one size is chosen";
    if (no && !was_said(r, no)) ph_i_complain(r, node, PH_EINVAL, "%s", no);
}

static ph_status hash_voxels(ph_campaign *c, const ph_case *one, ph_error *err)
{
    ph_status st = PH_OK;
    char path[1100];
    char *bytes = NULL;
    size_t length = 0;
    if (!one->voxels.file[0]) return PH_OK;
    ph_i_path_in(one->folder, one->voxels.file, path, sizeof path);
    PH_TRY(ph_i_read_file(path, (size_t)1 << 34, "voxel file", &bytes, &length, err));
    c->hash = ph_i_hash(c->hash, bytes, length);
out:
    free(bytes);
    return st;
}

static ph_status hash_point(ph_campaign *c, int point, ph_error *err)
{
    ph_status st = PH_OK;
    char *json = NULL;
    ph_case one = *c->point[point].c;     /* borrows its arrays */
    one.accuracy = (ph_case_accuracy){0}; /* not of what a realisation is */
    PH_TRY(ph_case_to_json(&one, &json, err));
    c->hash = ph_i_hash(c->hash, json, strlen(json) + 1);
    PH_TRY(hash_voxels(c, &one, err));
out:
    free(json);
    return st;
}

/* `until` without a number: the accuracy of the case is the total error. */
static void take_accuracy(ph_i_reader *r, const ph_i_node *root, ph_campaign *c,
                          int point)
{
    static const char rule[] = "must be a number > 0, the half width of the interval; or "
                               "the case has an accuracy, the total error";
    const ph_i_node *map = ph_i_get(root, "realisations");
    if (c->relative_error != PH_I_OF_CASE) return;
    c->relative_error = c->point[point].c->accuracy.relative;
    if (map && !(c->relative_error > 0))
        ph_i_missing(r, ph_i_get(map, "until"), "relative_half_width", "%s", rule);
}

/* A total error needs what tells the error of the grid. */
static void check_total(ph_i_reader *r, const ph_case_issues *issues,
                        const ph_campaign *c, int point)
{
    for (size_t i = 0; i < issues->count; i++)
        if (!issues->item[i].warning) return; /* that is enough */
    const char *no = ph_campaign_no_grid(c, point, c->judged >= 0 ? c->judged : 0);
    if (c->nmodels <= 1 && c->point[point].c->accuracy.relative > 0) no = NULL;
    if (c->relative_error > 0 && no)
        ph_i_complain_line(r, 0, "point %d: realisations.until.relative_error: %s", point,
                           no);
}

static ph_status resolve(ph_i_reader *r, const ph_i_node *root, const ph_i_sweep *sweep,
                         int point, const ph_i_levels *levels, set_list *sets,
                         ph_campaign *c, ph_error *err)
{
    ph_status st = PH_OK;
    ph_case_issues issues = {0};
    ph_error why = PH_ERROR_INIT;
    size_t common = sets->owned;
    sets->owned = 0;
    PH_TRY(take_values(sweep, point, c, sets, err));
    ph_case **one = &c->point[point].c;
    ph_status read = ph_case_read(c->case_path, (const char *const *)sets->item,
                                  sets->count, one, &issues, &why);
    if (read == PH_ENOMEM || (read != PH_OK && issues.count == 0)) {
        st = PH_FAIL(err, read, "%s", why.msg);
        goto out;
    }
    if (read == PH_OK) {
        take_accuracy(r, root, c, point);
        check_outputs(r, root, c, point);
        PH_TRY(hash_point(c, point, err));
        PH_TRY(ph_i_levels_resolve(levels, point, (const char *const *)sets->item,
                                   sets->count, c, &issues, err));
        check_total(r, &issues, c, point);
        check_size(r, root, c, point);
    }
    hand_on(r, root, &issues, c, point);
out:
    ph_case_issues_free(&issues);
    clear_sets(sets);
    sets->owned = common;
    return st;
}

static ph_status take_keys(const ph_i_sweep *sweep, ph_campaign *c, ph_error *err)
{
    ph_status st = PH_OK;
    PH_ALLOC(c->key, sweep->naxes, "the keys of a sweep");
    for (; c->nkeys < (int)sweep->naxes; c->nkeys++) {
        c->key[c->nkeys] = strdup(sweep->axis[c->nkeys].key);
        PH_CHECK(c->key[c->nkeys], PH_ENOMEM, "no memory for the keys of a sweep");
    }
out:
    return st;
}

ph_status ph_i_points_resolve(ph_i_reader *r, const ph_i_node *root,
                              const ph_i_sweep *sweep, const char *const *sets,
                              size_t nsets, ph_campaign *c, ph_error *err)
{
    ph_status st = PH_OK;
    set_list all = {0};
    ph_i_levels levels = {0};
    c->hash = PH_I_HASH_START;
    PH_TRY(ph_i_levels_read(r, root, &levels, c, err));
    PH_TRY(take_keys(sweep, c, err));
    PH_TRY(take_common_sets(r, root, c, &all, err));
    for (size_t i = 0; i < nsets; i++) {
        const char *equals = strchr(sets[i], '=');
        char key[256];
        PH_CHECK(equals && equals - sets[i] < (ptrdiff_t)sizeof key, PH_EINVAL,
                 "--set %.100s: must be key.path=value", sets[i]);
        snprintf(key, sizeof key, "%.*s", (int)(equals - sets[i]), sets[i]);
        if (!varies(r, c, 0, key)) PH_TRY(add_set(&all, key, equals + 1, err));
    }
    int npoints = ph_i_sweep_points(sweep);
    PH_ALLOC(c->point, npoints, "the points of a sweep");
    c->npoints = npoints;
    for (int p = 0; p < npoints && r->invalid + r->unphysical < 20; p++)
        PH_TRY(resolve(r, root, sweep, p, &levels, &all, c, err));
    const ph_case *first = npoints > 0 ? c->point[0].c : NULL; /* NULL: complained of */
    if (first && !(c->seconds > 0)) c->seconds = first->accuracy.seconds;
    if (first && !(c->memory > 0)) c->memory = first->accuracy.memory;
    for (int i = 0; i < c->noutputs; i++)
        c->hash = ph_i_hash(c->hash, c->output[i].name, strlen(c->output[i].name) + 1);
    c->hash = ph_i_hash(c->hash, &c->common_random_numbers, 1);
out:
    ph_i_levels_clear(&levels);
    clear_sets(&all);
    return st;
}
