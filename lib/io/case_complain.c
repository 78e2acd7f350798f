/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Complaints: where, what stands there, what is admissible. */
#include "io/case_internal.h"
#include "io/text.h"

#include <stdarg.h>
#include <string.h>

enum { MAX_ISSUES = 200, SHOWN = 40, KEY_SHOWN = 80 };

void ph_case_issues_free(ph_case_issues *issues)
{
    if (!issues) return;
    free(issues->item);
    *issues = (ph_case_issues){0};
}

void ph_case_issue_text(const ph_case_issue *issue, const char *name, char *text,
                        size_t size)
{
    if (!(issue && name && text && size > 0)) return;
    const char *kind = issue->warning ? "warning: " : "";
    if (issue->line > 0)
        snprintf(text, size, "%s:%d: %s%s", name, issue->line, kind, issue->message);
    else
        snprintf(text, size, "%s: %s%s", name, kind, issue->message);
}

/* Bytes 0 to 31 and 127 become '?', and a UTF-8 letter cut at the end goes. */
static void make_printable(char *text)
{
    size_t n = strlen(text), tail = n;
    for (size_t i = 0; i < n; i++)
        if ((unsigned char)text[i] < 32 || text[i] == 127) text[i] = '?';
    while (tail > 0 && ((unsigned char)text[tail - 1] & 0xC0) == 0x80)
        tail--;
    if (tail == 0) return;
    unsigned char lead = (unsigned char)text[tail - 1];
    size_t want = lead < 0xC0 ? 0 : lead < 0xE0 ? 1 : lead < 0xF0 ? 2 : 3;
    if (n - tail < want) text[tail - 1] = 0;
}

/* At most `most` bytes of a text, "..." where it goes on. */
static void shorten(const char *text, size_t most, char *out, size_t size)
{
    snprintf(out, size, "%.*s", (int)most, text);
    make_printable(out);
    size_t n = strlen(out);
    if (strlen(text) > most && n + 4 <= size) memcpy(out + n, "...", 4);
}

static void append(char *out, size_t size, const char *text)
{
    size_t n = strlen(out);
    if (n < size) snprintf(out + n, size - n, "%s", text);
}

static void node_path(const ph_i_reader *r, const ph_i_node *node, char *out, size_t size)
{
    char part[KEY_SHOWN + 8];
    if (!node->parent) {
        out[0] = 0;
        if (r->set) append(out, size, r->set);
        return;
    }
    node_path(r, node->parent, out, size);
    if (out[0]) append(out, size, ".");
    if (node->key)
        shorten(node->key, KEY_SHOWN, part, sizeof part);
    else
        snprintf(part, sizeof part, "%zu", node->index);
    append(out, size, part);
}

static void add(ph_i_reader *r, int line, ph_status status, const char *message)
{
    ph_case_issues *list = r->issues;
    if (status == PH_EUNPHYSICAL)
        r->unphysical++;
    else if (status != PH_OK)
        r->invalid++;
    if (list->count > MAX_ISSUES) return;
    if (list->count == list->capacity) {
        size_t capacity = list->capacity ? 2 * list->capacity : 8;
        ph_case_issue *grown = realloc(list->item, capacity * sizeof *grown);
        if (!grown) {
            r->out_of_memory = true;
            return;
        }
        list->item = grown;
        list->capacity = capacity;
    }
    ph_case_issue *issue = &list->item[list->count++];
    issue->line = line;
    issue->warning = status == PH_OK;
    snprintf(
        issue->message, sizeof issue->message, "%.*s", (int)sizeof issue->message - 1,
        list->count > MAX_ISSUES ? "more complaints than these are not shown" : message);
    make_printable(issue->message);
}

/* "path.key: text", "--set " before it where the value came with an override. */
static void complain(ph_i_reader *r, const ph_i_node *at, const char *key,
                     ph_status status, const char *text)
{
    char path[240] = "", message[1024];
    node_path(r, at, path, sizeof path - 50);
    if (key) {
        if (path[0]) append(path, sizeof path, ".");
        append(path, sizeof path, key);
    }
    snprintf(message, sizeof message, "%s%s%s%s", at->from_set ? "--set " : "", path,
             path[0] ? ": " : "", text);
    add(r, at->line, status, message);
}

void ph_i_complain(ph_i_reader *r, const ph_i_node *at, ph_status status, const char *fmt,
                   ...)
{
    char text[600];
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(text, sizeof text, fmt, ap);
    va_end(ap);
    complain(r, at, NULL, status, text);
}

void ph_i_complain_key(ph_i_reader *r, const ph_i_node *at, const char *key,
                       ph_status status, const char *fmt, ...)
{
    char text[600];
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(text, sizeof text, fmt, ap);
    va_end(ap);
    complain(r, at, key, status, text);
}

void ph_i_complain_line(ph_i_reader *r, int line, const char *fmt, ...)
{
    char text[600], message[1024], set[SHOWN + 8];
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(text, sizeof text, fmt, ap);
    va_end(ap);
    if (r->set) shorten(r->set, SHOWN, set, sizeof set);
    snprintf(message, sizeof message, "%s%s%s%s", r->set ? "--set " : "",
             r->set ? set : "", r->set ? ": " : "", text);
    add(r, line, PH_EINVAL, message);
}

/* What stands there: 0.62, 'word', a list of 3, a map, nothing. */
static void describe(const ph_i_node *node, char *out, size_t size)
{
    char part[SHOWN + 8];
    double ignored;
    if (node->kind == PH_I_LIST) {
        snprintf(out, size, "a list of %zu", node->count);
    } else if (node->kind == PH_I_MAP) {
        snprintf(out, size, "a map");
    } else if (ph_i_is_null(node)) {
        snprintf(out, size, "nothing");
    } else {
        bool number = ph_i_text_to_number(node->text, &ignored);
        const char *quote = number && node->plain ? "" : "'";
        shorten(node->text, SHOWN, part, sizeof part);
        snprintf(out, size, "%s%s%s%s", number && !node->plain ? "the text " : "", quote,
                 part, quote);
    }
}

void ph_i_reject(ph_i_reader *r, const ph_i_node *at, ph_status status, const char *fmt,
                 ...)
{
    char rule[500], value[SHOWN + 24], text[600];
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(rule, sizeof rule, fmt, ap);
    va_end(ap);
    describe(at, value, sizeof value);
    snprintf(text, sizeof text, "%s is not admissible: %s", value, rule);
    complain(r, at, NULL, status, text);
}

void ph_i_missing(ph_i_reader *r, const ph_i_node *map, const char *key, const char *fmt,
                  ...)
{
    char rule[500], text[600];
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(rule, sizeof rule, fmt, ap);
    va_end(ap);
    snprintf(text, sizeof text, "missing: %s", rule);
    const ph_i_node *at = map;
    for (size_t i = 0; i < map->count; i++)
        if (map->child[i]->meant && strcmp(map->child[i]->meant, key) == 0) return;
    for (size_t i = 0; i < map->count; i++)
        if (strcmp(map->child[i]->key, key) == 0) at = map->child[i];
    complain(r, at, at == map ? key : NULL, PH_EINVAL, text);
}

/* Stable: complaints of one line keep their order; insertion sort, they are few and nearly
 * sorted. Those of --set (line 0) come last. */
static void sort_by_line(ph_case_issues *issues)
{
    for (size_t i = 1; i < issues->count; i++) {
        ph_case_issue moved = issues->item[i];
        size_t k = i;
        unsigned line = (unsigned)moved.line - 1u; /* 0 becomes the largest */
        for (; k > 0 && (unsigned)issues->item[k - 1].line - 1u > line; k--)
            issues->item[k] = issues->item[k - 1];
        issues->item[k] = moved;
    }
}

/* What the complaints come to, the first of them in `err`. */
ph_status ph_i_verdict(ph_i_reader *r, ph_error *err)
{
    char text[512];
    sort_by_line(r->issues);
    if (r->out_of_memory) return PH_FAIL(err, PH_ENOMEM, "no memory for complaints");
    if (r->invalid + r->unphysical == 0) return PH_OK;
    const ph_case_issue *first = r->issues->item;
    while (first->warning)
        first++;
    ph_case_issue_text(first, r->file, text, sizeof text);
    return PH_FAIL(err, r->invalid ? PH_EINVAL : PH_EUNPHYSICAL, "%s", text);
}
