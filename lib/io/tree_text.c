/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A tree written back as YAML of one line. */
#include "io/case_internal.h"
#include "io/text.h"

#include <string.h>

static void add_text(ph_i_growing *g, const char *text)
{
    ph_i_append(g, text, strlen(text));
}

/* In double quotes, what YAML would take otherwise escaped. */
static void add_quoted(ph_i_growing *g, const char *text)
{
    ph_i_append(g, "\"", 1);
    for (const char *p = text; *p; p++) {
        char code[8];
        unsigned char c = (unsigned char)*p;
        if (c == '"' || c == '\\') {
            ph_i_append(g, "\\", 1);
            ph_i_append(g, p, 1);
        } else if (c < 32 || c == 127) {
            snprintf(code, sizeof code, "\\x%02x", c);
            add_text(g, code);
        } else {
            ph_i_append(g, p, 1);
        }
    }
    ph_i_append(g, "\"", 1);
}

/* Words and numbers that stay what they are between brackets. */
static bool is_bare(const ph_i_node *node)
{
    static const char safe[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                               "0123456789_.+-";
    return node->plain && node->text[0] && node->text[strspn(node->text, safe)] == 0 &&
           strcmp(node->text, "-") != 0;
}

static void add_node(ph_i_growing *g, const ph_i_node *node)
{
    if (node->kind == PH_I_SCALAR) {
        if (ph_i_is_null(node))
            add_text(g, "null");
        else if (is_bare(node))
            add_text(g, node->text);
        else
            add_quoted(g, node->text);
        return;
    }
    bool map = node->kind == PH_I_MAP;
    add_text(g, map ? "{" : "[");
    for (size_t i = 0; i < node->count; i++) {
        if (i > 0) add_text(g, ", ");
        if (map) {
            add_quoted(g, node->child[i]->key);
            add_text(g, ": ");
        }
        add_node(g, node->child[i]);
    }
    add_text(g, map ? "}" : "]");
}

char *ph_i_tree_text(const ph_i_node *node)
{
    ph_i_growing g = {0};
    add_node(&g, node);
    if (!g.failed) return g.text;
    free(g.text);
    return NULL;
}

void ph_i_folder_of(const char *path, char *folder, size_t size)
{
    const char *slash = strrchr(path, '/');
    if (!slash)
        snprintf(folder, size, ".");
    else
        snprintf(folder, size, "%.*s", slash == path ? 1 : (int)(slash - path), path);
}
