/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/case_internal.h"

#include <yaml.h>

#include <string.h>

/* Every value takes a byte of the file; beyond that aliases may add so many. */
enum { MAX_DEPTH = 24, MAX_ALIASED = 100000 };

typedef struct builder {
    ph_i_reader *r;
    yaml_document_t *doc;
    bool stop; /* too deep or too many: one complaint is enough */
    size_t nodes, most;
} builder;

void ph_i_tree_free(ph_i_node **node)
{
    if (!node || !*node) return;
    for (size_t i = 0; i < (*node)->count; i++)
        ph_i_tree_free(&(*node)->child[i]);
    free((*node)->child);
    free((*node)->key);
    free((*node)->text);
    free(*node);
    *node = NULL;
}

ph_status ph_i_tree_append(ph_i_node *parent, const char *key, ph_i_node *child,
                           ph_error *err)
{
    ph_status st = PH_OK;
    char *copy = NULL;
    if (key) {
        copy = strdup(key);
        PH_CHECK(copy != NULL, PH_ENOMEM, "no memory for a case file");
    }
    if (parent->count == parent->capacity) {
        size_t capacity = parent->capacity ? 2 * parent->capacity : 4;
        ph_i_node **grown = realloc(parent->child, capacity * sizeof *grown);
        PH_CHECK(grown != NULL, PH_ENOMEM, "no memory for a case file");
        parent->child = grown;
        parent->capacity = capacity;
    }
    child->parent = parent;
    child->index = parent->count;
    child->key = copy;
    copy = NULL;
    parent->child[parent->count++] = child;
out:
    free(copy);
    return st;
}

static int line_of(const builder *b, const yaml_node_t *node)
{
    return b->r->set ? 0 : (int)node->start_mark.line + 1;
}

static void stop_at(builder *b, const yaml_node_t *node, const char *why)
{
    if (!b->stop) ph_i_complain_line(b->r, line_of(b, node), "%s", why);
    b->stop = true;
}

/* Only the tags that YAML gives by itself. */
static bool has_plain_tag(const yaml_node_t *node)
{
    const char *tag = (const char *)node->tag;
    return !tag || strcmp(tag, YAML_STR_TAG) == 0 || strcmp(tag, YAML_SEQ_TAG) == 0 ||
           strcmp(tag, YAML_MAP_TAG) == 0;
}

static ph_status build(builder *b, int id, int depth, ph_i_node *parent, const char *key,
                       int key_line, ph_i_node **out, ph_error *err);

static ph_status build_scalar(builder *b, const yaml_node_t *from, ph_i_node *node,
                              ph_error *err)
{
    ph_status st = PH_OK;
    const char *value = (const char *)from->data.scalar.value;
    size_t length = from->data.scalar.length;
    node->plain = from->data.scalar.style == YAML_PLAIN_SCALAR_STYLE;
    node->text = strndup(value, length);
    PH_CHECK(node->text != NULL, PH_ENOMEM, "no memory for a case file");
    if (strlen(node->text) != length)
        ph_i_complain(b->r, node, PH_EINVAL, "a text must not contain the character NUL");
out:
    return st;
}

static ph_status build_list(builder *b, const yaml_node_t *from, int depth,
                            ph_i_node *node, ph_error *err)
{
    ph_status st = PH_OK;
    const yaml_node_item_t *item = from->data.sequence.items.start;
    for (; item < from->data.sequence.items.top && !b->stop; item++)
        PH_TRY(build(b, *item, depth + 1, node, NULL, 0, NULL, err));
out:
    return st;
}

static int compare_keys(const void *a, const void *b)
{
    const ph_i_node *x = *(ph_i_node *const *)a, *y = *(ph_i_node *const *)b;
    int order = strcmp(x->key, y->key);
    return order ? order : (x->index > y->index) - (x->index < y->index);
}

static ph_status check_duplicates(builder *b, const ph_i_node *map, ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_node **sorted = NULL;
    if (map->count < 2) goto out;
    PH_ALLOC(sorted, map->count, "a case file");
    memcpy(sorted, map->child, map->count * sizeof *sorted);
    qsort(sorted, map->count, sizeof *sorted, compare_keys);
    for (size_t i = 1, first = 0; i < map->count; i++) {
        if (strcmp(sorted[first]->key, sorted[i]->key) != 0)
            first = i;
        else if (sorted[first]->line > 0)
            ph_i_complain(b->r, sorted[i], PH_EINVAL, "this key is already on line %d",
                          sorted[first]->line);
        else
            ph_i_complain(b->r, sorted[i], PH_EINVAL, "this key is there twice");
    }
out:
    free(sorted);
    return st;
}

static ph_status build_map(builder *b, const yaml_node_t *from, int depth,
                           ph_i_node *node, ph_error *err)
{
    ph_status st = PH_OK;
    const yaml_node_pair_t *pair = from->data.mapping.pairs.start;
    for (; pair < from->data.mapping.pairs.top && !b->stop; pair++) {
        const yaml_node_t *key = yaml_document_get_node(b->doc, pair->key);
        if (key->type != YAML_SCALAR_NODE ||
            strlen((char *)key->data.scalar.value) != key->data.scalar.length) {
            ph_i_complain_line(b->r, line_of(b, key), "a key must be a word");
            continue;
        }
        PH_TRY(build(b, pair->value, depth + 1, node, (char *)key->data.scalar.value,
                     line_of(b, key), NULL, err));
    }
    PH_TRY(check_duplicates(b, node, err));
out:
    return st;
}

/* The node `id` of the document and all below it; hung into `parent`, or given to `out`. */
static ph_status build(builder *b, int id, int depth, ph_i_node *parent, const char *key,
                       int key_line, ph_i_node **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_node *node = NULL, *here = NULL;
    const yaml_node_t *from = yaml_document_get_node(b->doc, id);
    if (depth > MAX_DEPTH)
        stop_at(b, from, "nested too deeply, or an alias that holds itself");
    else if (++b->nodes > b->most)
        stop_at(b, from, "the aliases make more than 100000 values of this");
    if (b->stop) goto out;
    PH_ALLOC(node, 1, "a case file");
    node->from_set = b->r->set != NULL;
    node->line = key ? key_line : line_of(b, from);
    here = node;
    if (parent) {
        PH_TRY(ph_i_tree_append(parent, key, node, err));
        node = NULL; /* the parent's now */
    }
    if (!has_plain_tag(from))
        ph_i_complain(b->r, here, PH_EINVAL,
                      "tags (!word) have no meaning in a case file");
    if (from->type == YAML_SCALAR_NODE) {
        here->kind = PH_I_SCALAR;
        PH_TRY(build_scalar(b, from, here, err));
    } else if (from->type == YAML_SEQUENCE_NODE) {
        here->kind = PH_I_LIST;
        PH_TRY(build_list(b, from, depth, here, err));
    } else {
        here->kind = PH_I_MAP;
        PH_TRY(build_map(b, from, depth, here, err));
    }
    if (out) {
        *out = node;
        node = NULL;
    }
out:
    ph_i_tree_free(&node);
    return st;
}

static int line_of_offset(const char *text, size_t length, size_t offset)
{
    int line = 1;
    for (size_t i = 0; i < offset && i < length; i++)
        line +=
            text[i] == '\n' || (text[i] == '\r' && i + 1 < length && text[i + 1] != '\n');
    return line;
}

/* Is the first thing of this line a tab? */
static bool has_tab_indent(const char *text, size_t length, size_t line)
{
    size_t row = 1, i = 0;
    while (i < length && row < line)
        row += text[i++] == '\n';
    while (i < length && (text[i] == ' ' || text[i] == '-'))
        i++;
    return i < length && text[i] == '\t';
}

/* libyaml's words where it has good ones, ours for the mistakes that people make. */
static void complain_syntax(ph_i_reader *r, const yaml_parser_t *parser, const char *text,
                            size_t length)
{
    const char *problem = parser->problem ? parser->problem : "not understood";
    size_t line = parser->problem_mark.line + 1, begin = parser->context_mark.line + 1;
    char context[100] = "";
    if (parser->error == YAML_READER_ERROR) {
        line = (size_t)line_of_offset(text, length, parser->problem_offset);
        if (strstr(problem, "UTF-8")) problem = "a character is not UTF-8";
    } else if (has_tab_indent(text, length, line)) {
        problem = "a tab cannot indent: use spaces";
    } else if (strstr(problem, "mapping values are not allowed")) {
        problem = "no key can stand here: check the indentation, and the line above for "
                  "a missing ':'";
    } else if (parser->context && begin < line && !r->set) {
        snprintf(context, sizeof context, " (%s that begins on line %zu)",
                 parser->context, begin);
    }
    ph_i_complain_line(r, r->set ? 0 : (int)line, "not valid YAML: %s%s", problem,
                       context);
}

/* A second document after the first, or rubbish: one file, one case. */
static bool check_alone(ph_i_reader *r, yaml_parser_t *parser, const char *text,
                        size_t length)
{
    yaml_document_t next;
    if (!yaml_parser_load(parser, &next)) {
        complain_syntax(r, parser, text, length);
        return false;
    }
    const yaml_node_t *root = yaml_document_get_root_node(&next);
    if (root)
        ph_i_complain_line(r, r->set ? 0 : (int)next.start_mark.line + 1,
                           "a second document begins here: one is admissible");
    yaml_document_delete(&next);
    return !root;
}

ph_status ph_i_tree_parse(ph_i_reader *r, const char *text, size_t length,
                          ph_i_node **root, ph_error *err)
{
    ph_status st = PH_OK;
    yaml_parser_t parser;
    yaml_document_t doc;
    bool loaded = false;
    *root = NULL;
    if (length >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0) text += 3, length -= 3;
    PH_CHECK(yaml_parser_initialize(&parser), PH_ENOMEM, "no memory for a YAML parser");
    yaml_parser_set_encoding(&parser, YAML_UTF8_ENCODING);
    yaml_parser_set_input_string(&parser, (const unsigned char *)text, length);
    loaded = yaml_parser_load(&parser, &doc) != 0;
    if (!loaded) {
        if (parser.error == YAML_MEMORY_ERROR)
            st = PH_FAIL(err, PH_ENOMEM, "no memory for a case file");
        else
            complain_syntax(r, &parser, text, length);
        goto done;
    }
    if (yaml_document_get_root_node(&doc)) {
        builder b = {.r = r, .doc = &doc, .most = length + MAX_ALIASED};
        int id = (int)(yaml_document_get_root_node(&doc) - doc.nodes.start) + 1;
        st = build(&b, id, 0, NULL, NULL, 0, root, err);
        if (st != PH_OK || b.stop || !check_alone(r, &parser, text, length))
            ph_i_tree_free(root);
    }
done:
    if (loaded) yaml_document_delete(&doc);
    yaml_parser_delete(&parser);
out:
    return st;
}
