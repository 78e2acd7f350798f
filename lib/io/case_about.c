/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where in its file stands what an error of the library is about. */
#include "io/case_internal.h"
#include "io/read_file.h"

#include <string.h>

enum { MOST_BYTES = 1 << 26 };

/* The child called by the first `n` bytes of `key`. */
static const ph_i_node *child_of(const ph_i_node *node, const char *key, size_t n)
{
    for (size_t i = 0; node->kind == PH_I_MAP && i < node->count; i++)
        if (strncmp(node->child[i]->key, key, n) == 0 && !node->child[i]->key[n])
            return node->child[i];
    return NULL;
}

/* The node of a key, or the deepest one on the way to it and what of the key is left. */
static const ph_i_node *find(const ph_i_node *root, const char *key, const char **left)
{
    const ph_i_node *at = root, *next;
    while (*key) {
        size_t n = strcspn(key, ".");
        if (!(next = child_of(at, key, n))) break;
        at = next;
        key += n + (key[n] == '.');
    }
    *left = key;
    return at;
}

static void complain(ph_i_reader *r, const ph_i_node *root, const ph_error *about)
{
    const char *left;
    const ph_i_node *at = find(root, about->key, &left);
    /* {length: 3} is the horizon, {spectral: 2} the stabilisation. */
    while (!*left && at->parent != root && at->kind == PH_I_MAP && at->count == 1)
        at = at->child[0];
    if (at->kind == PH_I_SCALAR &&
        !ph_i_is_null(at)) /* `constraint: KIND` has no key kind */
        ph_i_reject(r, at, about->status, "%s", about->msg);
    else if (!*left)
        ph_i_complain(r, at, about->status, "%s", about->msg);
    else
        ph_i_complain_key(r, at, left, about->status, "not given: %s", about->msg);
}

/* Read the file again; the complaint, if there is one, in r->issues. */
static ph_status look_up(ph_i_reader *r, const char *const *sets, size_t nsets,
                         const ph_error *about, ph_error *err)
{
    ph_status st = PH_OK;
    char *text = NULL;
    size_t length = 0;
    ph_i_node *root = NULL;
    PH_TRY(ph_i_read_file(r->file, MOST_BYTES, "case file", &text, &length, err));
    PH_TRY(ph_i_tree_parse(r, text, length, &root, err));
    for (size_t i = 0; root && i < nsets; i++)
        PH_TRY(ph_i_tree_set(r, &root, sets[i], err));
    if (root && r->issues->count == 0) complain(r, root, about);
out:
    ph_i_tree_free(&root);
    free(text);
    return st;
}

bool ph_case_error_text(const char *path, const char *const *sets, size_t nsets,
                        const ph_error *about, char *text, size_t size)
{
    ph_error err = PH_ERROR_INIT;
    ph_case_issues issues = {0};
    if (!(path && (sets || nsets == 0) && about && text && size > 0)) return false;
    ph_i_reader r = {.file = path, .issues = &issues};
    bool is_input = about->status == PH_EINVAL || about->status == PH_EUNPHYSICAL;
    bool found = is_input && about->key[0] &&
                 look_up(&r, sets, nsets, about, &err) == PH_OK && issues.count == 1;
    if (found) ph_case_issue_text(&issues.item[0], path, text, size);
    ph_case_issues_free(&issues);
    return found;
}
