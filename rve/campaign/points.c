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

/* `set` of the campaign file. */
static ph_status take_common_sets(ph_i_reader *r, const ph_i_node *root, set_list *s,
                                  ph_error *err)
{
    ph_status st = PH_OK;
    const ph_i_node *map = ph_i_get(root, "set");
    if (!map || !ph_i_read_map(r, map, "must be a map: key of the case: value")) goto out;
    for (size_t i = 0; i < map->count; i++) {
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

/* Complaints of the case of a point become complaints of the campaign. */
static void hand_on(ph_i_reader *r, const ph_case_issues *issues, const ph_campaign *c,
                    int point)
{
    for (size_t i = 0; i < issues->count; i++) {
        char text[1024];
        if (issues->item[i].warning) continue;
        ph_case_issue_text(&issues->item[i], c->case_path, text, sizeof text);
        ph_i_complain_line(r, 0, "point %d: %s", point, text);
    }
}

static void check_outputs(ph_i_reader *r, const ph_campaign *c, int point)
{
    const ph_case *one = c->point[point].c;
    for (int i = 0; i < c->noutputs; i++) {
        const ph_quantity *q = &c->output[i];
        const char *no = ph_quantity_refuses(q, one->kinematics);
        bool known = !q->argument[0];
        for (int m = 0; m < one->nmaterials; m++)
            known |= strcmp(one->materials[m].name, q->argument) == 0;
        if (no) ph_i_complain_line(r, 0, "outputs: %s: %s", q->name, no);
        if (!known)
            ph_i_complain_line(r, 0, "outputs: %s: the case has no material '%s'",
                               q->name, q->argument);
    }
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
    ph_case *one = c->point[point].c;
    PH_TRY(ph_case_to_json(one, &json, err));
    c->hash = ph_i_hash(c->hash, json, strlen(json) + 1);
    PH_TRY(hash_voxels(c, one, err));
out:
    free(json);
    return st;
}

static ph_status resolve(ph_i_reader *r, const ph_i_sweep *sweep, int point,
                         const ph_i_levels *levels, set_list *sets, ph_campaign *c,
                         ph_error *err)
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
        int judged = c->judged >= 0 ? c->judged : 0;
        check_outputs(r, c, point);
        PH_TRY(hash_point(c, point, err));
        PH_TRY(ph_i_levels_resolve(levels, point, (const char *const *)sets->item,
                                   sets->count, c, &issues, err));
        const char *no = ph_campaign_no_grid(c, point, judged);
        if (c->relative_error > 0 && issues.count == 0 && no)
            ph_i_complain_line(r, 0, "point %d: realisations.until.relative_error: %s",
                               point, no);
    }
    hand_on(r, &issues, c, point);
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
    PH_TRY(take_common_sets(r, root, &all, err));
    for (size_t i = 0; i < nsets; i++) {
        const char *equals = strchr(sets[i], '=');
        char key[256];
        PH_CHECK(equals && equals - sets[i] < (ptrdiff_t)sizeof key, PH_EINVAL,
                 "--set %.100s: must be key.path=value", sets[i]);
        snprintf(key, sizeof key, "%.*s", (int)(equals - sets[i]), sets[i]);
        PH_TRY(add_set(&all, key, equals + 1, err));
    }
    int npoints = ph_i_sweep_points(sweep);
    PH_ALLOC(c->point, npoints, "the points of a sweep");
    c->npoints = npoints;
    for (int p = 0; p < npoints && r->invalid + r->unphysical < 20; p++)
        PH_TRY(resolve(r, sweep, p, &levels, &all, c, err));
    for (int i = 0; i < c->noutputs; i++)
        c->hash = ph_i_hash(c->hash, c->output[i].name, strlen(c->output[i].name) + 1);
    c->hash = ph_i_hash(c->hash, &c->common_random_numbers, 1);
out:
    ph_i_levels_clear(&levels);
    clear_sets(&all);
    return st;
}
