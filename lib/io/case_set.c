/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/case_internal.h"

#include <string.h>

static ph_i_node *find(const ph_i_node *map, const char *key)
{
    for (size_t i = 0; i < map->count; i++)
        if (strcmp(map->child[i]->key, key) == 0) return map->child[i];
    return NULL;
}

/* List index: decimal digits only. */
static bool to_index(const char *text, size_t *index)
{
    size_t n = strlen(text);
    if (n == 0 || n > 9 || strspn(text, "0123456789") != n) return false;
    *index = (size_t)strtoul(text, NULL, 10);
    return true;
}

/* The step `key` down from `*at`: an existing child, or a new null. NULL after a complaint. */
static ph_status step(ph_i_reader *r, ph_i_node **at, const char *key, ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_node *node = *at, *next = NULL, *made = NULL;
    size_t index = 0;
    *at = NULL;
    if (ph_i_is_null(node)) node->kind = PH_I_MAP; /* creates what is missing */
    if (node->kind == PH_I_SCALAR) {
        ph_i_complain_line(r, 0, "'%.60s' holds one value here, so it has no '%.60s'",
                           node->key ? node->key : "the list entry", key);
        goto out;
    }
    if (node->kind == PH_I_LIST) {
        if (!to_index(key, &index) || index > node->count) {
            ph_i_complain_line(r, 0,
                               "'%.60s' is not admissible: the list has %zu entries, "
                               "counted from 0",
                               key, node->count);
            goto out;
        }
        next = index < node->count ? node->child[index] : NULL;
    } else {
        next = find(node, key);
    }
    if (!next) {
        PH_ALLOC(made, 1, "--set");
        made->from_set = true;
        made->plain = true;
        PH_ALLOC(made->text, 1, "--set");
        PH_TRY(ph_i_tree_append(node, node->kind == PH_I_MAP ? key : NULL, made, err));
        next = made;
        made = NULL;
    }
    *at = next;
out:
    ph_i_tree_free(&made);
    return st;
}

/* What `from` holds moves into `into`, which keeps its place in the tree. */
static void replace(ph_i_node *into, ph_i_node *from)
{
    ph_i_node old = *into;
    *into = *from;
    into->parent = old.parent;
    into->key = old.key;
    into->index = old.index;
    for (size_t i = 0; i < into->count; i++)
        into->child[i]->parent = into;
    old.key = NULL;
    *from = old;
}

ph_status ph_i_tree_set(ph_i_reader *r, ph_i_node **root, const char *set, ph_error *err)
{
    ph_status st = PH_OK;
    char *path = NULL, *steps = NULL;
    ph_i_node *value = NULL, *at = *root;
    size_t before = r->issues->count;
    const char *equals = strchr(set, '=');
    if (!equals || equals == set) {
        r->set = set;
        ph_i_complain_line(r, 0, "must be key.path=value");
        goto out;
    }
    path = strndup(set, (size_t)(equals - set));
    steps = strndup(set, (size_t)(equals - set));
    PH_CHECK(path && steps, PH_ENOMEM, "no memory for --set");
    r->set = path;
    PH_TRY(ph_i_tree_parse(r, equals + 1, strlen(equals + 1), &value, err));
    if (r->issues->count > before) goto out;
    for (char *key = steps, *dot; key && at; key = dot ? dot + 1 : NULL) {
        dot = strchr(key, '.');
        if (dot) *dot = 0;
        PH_TRY(step(r, &at, key, err));
    }
    if (!at) goto out;
    if (!value) { /* nothing after '=': null, as if the key were not there */
        PH_ALLOC(value, 1, "--set");
        PH_ALLOC(value->text, 1, "--set");
        value->plain = value->from_set = true;
    }
    replace(at, value);
out:
    r->set = NULL;
    ph_i_tree_free(&value);
    free(path);
    free(steps);
    return st;
}
