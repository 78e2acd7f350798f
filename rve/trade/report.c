/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A trade as commands, as a table and as a document. */
#include "io/json.h"
#include "io/text.h"
#include "trade/trade.h"

#include <math.h>
#include <string.h>

static const char *const states[] = {"done", "refused", "failed", "skipped"};

static void put_letters(char *text, size_t size, const char *letters)
{
    size_t at = strlen(text);
    snprintf(text + at, size - at, "%s", letters);
}

void ph_i_trade_word(char *text, size_t size, const char *word)
{
    if (word[0] && !strpbrk(word, " \t\n'\"\\$`*?[]{}()<>|&;#~!")) {
        put_letters(text, size, word);
        return;
    }
    put_letters(text, size, "'");
    for (const char *c = word; *c; c++)
        put_letters(text, size, *c == '\'' ? "'\\''" : (char[]){*c, 0});
    put_letters(text, size, "'");
}

/* Does the row set this key, or what it is a part of, anew? */
static bool is_overridden(const ph_trade_row *row, const char *set)
{
    size_t n = strcspn(set, "=");
    for (int i = 0; i < row->nsets; i++) {
        size_t m = strcspn(row->set[i], "=");
        if (m <= n && strncmp(set, row->set[i], m) == 0 && (m == n || set[m] == '.'))
            return true;
    }
    return false;
}

static void put_set(char *text, size_t size, const char *set)
{
    put_letters(text, size, " --set ");
    ph_i_trade_word(text, size, set);
}

void ph_i_trade_command(const ph_trade *t, const ph_trade_row *row, char *text,
                        size_t size)
{
    snprintf(text, size, "perihom run ");
    ph_i_trade_word(text, size, t->path);
    for (const char *set = t->base_sets; *set; set += strlen(set) + 1)
        if (!is_overridden(row, set)) put_set(text, size, set);
    for (int i = 0; i < row->nsets; i++)
        put_set(text, size, row->set[i]);
    size_t at = strlen(text);
    if (row->threads > 0) snprintf(text + at, size - at, " -j %d", row->threads);
}

/* ---- the table ---- */

static void put_cell(ph_i_growing *g, const char *text)
{
    ph_i_append(g, ",\"", 2);
    for (const char *c = text; *c; c++) {
        if (*c == '"') ph_i_append(g, "\"", 1);
        ph_i_append(g, c, 1);
    }
    ph_i_append(g, "\"", 1);
}

static void put_number(ph_i_growing *g, double x, int digits)
{
    ph_i_append(g, ",", 1);
    if (isfinite(x)) ph_i_append_number(g, x, digits);
}

ph_status ph_trade_to_csv(const ph_trade *t, char **text, ph_error *err)
{
    PH_GIVEN(t && text);
    ph_status st = PH_OK;
    ph_i_growing g = {0};
    ph_i_appendf(&g, "knob,state,front,error,work,cpu_s,seconds,nodes,threads,"
                     "realisations,iterations,applications,ffts,bytes");
    for (int k = 0; k < t->nconstants; k++)
        ph_i_appendf(&g, ",%s", t->constant[k].name);
    ph_i_appendf(&g, ",setting,reason\n");
    for (int i = 0; i < t->nrows; i++) {
        const ph_trade_row *r = &t->row[i];
        bool done = r->state == PH_TRADE_DONE;
        ph_i_appendf(&g, "%s,%s,%d", r->knob, states[r->state], r->front);
        put_number(&g, done ? r->error : (double)NAN, 6);
        put_number(&g, done ? r->work : (double)NAN, 6);
        put_number(&g, done ? r->cpu : (double)NAN, 4);
        put_number(&g, done ? r->seconds : (double)NAN, 4);
        ph_i_appendf(&g, ",%td,%d,%d,%d,%ld,%ld,%zu", r->nodes, r->threads,
                     r->realisations, r->iterations, r->applications, r->ffts, r->bytes);
        for (int k = 0; k < t->nconstants; k++)
            put_number(&g, done ? r->value[k] : (double)NAN, 9);
        put_cell(&g, r->setting);
        put_cell(&g, r->reason);
        ph_i_append(&g, "\n", 1);
    }
    PH_CHECK(!g.failed, PH_ENOMEM, "no memory for a table");
    *text = g.text;
    g.text = NULL;
out:
    free(g.text);
    return st;
}

/* ---- the document ---- */

static json_t *values_json(const ph_trade *t, const double *x, bool *good)
{
    json_t *map = json_object();
    for (int k = 0; k < t->nconstants; k++)
        ph_i_json_set(map, t->constant[k].name, ph_i_json_number(x[k]), good);
    return map;
}

static json_t *row_json(const ph_trade *t, const ph_trade_row *r, bool *good)
{
    json_t *map = json_object(), *sets = json_array();
    for (int i = 0; i < r->nsets; i++)
        ph_i_json_append(sets, ph_i_json_text(r->set[i]), good);
    ph_i_json_set(map, "knob", json_string(r->knob), good);
    ph_i_json_set(map, "set", sets, good);
    ph_i_json_set(map, "state", json_string(states[r->state]), good);
    ph_i_json_set(map, "nodes", json_integer(r->nodes), good);
    ph_i_json_set(map, "threads", json_integer(r->threads), good);
    ph_i_json_set(map, "realisations", json_integer(r->realisations), good);
    if (r->state != PH_TRADE_DONE) {
        ph_i_json_set(map, "reason", ph_i_json_text(r->reason), good);
        return map;
    }
    ph_i_json_set(map, "front", json_boolean(r->front), good);
    ph_i_json_set(map, "error", ph_i_json_number(r->error), good);
    ph_i_json_set(map, "values", values_json(t, r->value, good), good);
    json_t *cost = json_object();
    ph_i_json_set(cost, "work", json_real(r->work), good);
    ph_i_json_set(cost, "iterations", json_integer(r->iterations), good);
    ph_i_json_set(cost, "applications", json_integer(r->applications), good);
    ph_i_json_set(cost, "ffts", json_integer(r->ffts), good);
    ph_i_json_set(cost, "peak_bytes", json_integer((json_int_t)r->bytes), good);
    ph_i_json_set(cost, "cpu_seconds", json_real(r->cpu), good);
    ph_i_json_set(cost, "seconds", json_real(r->seconds), good);
    ph_i_json_set(map, "cost", cost, good);
    return map;
}

static json_t *advice_json(const ph_trade *t, bool *good)
{
    json_t *list = json_array();
    for (int k = 0; k < PH_TRADE_TARGETS; k++) {
        const ph_trade_advice *a = &t->advice[k];
        json_t *map = json_object();
        ph_i_json_set(map, "accuracy", json_real(a->target), good);
        ph_i_json_set(map, "row", a->row < 0 ? json_null() : json_integer(a->row), good);
        ph_i_json_set(map, "command",
                      a->row < 0 ? json_null() : ph_i_json_text(a->command), good);
        ph_i_json_append(list, map, good);
    }
    return list;
}

ph_status ph_trade_to_json(const ph_trade *t, char **json, ph_error *err)
{
    PH_GIVEN(t && json);
    ph_status st = PH_OK;
    bool good = true;
    json_t *map = json_object(), *reference = json_object(), *rows = json_array();
    ph_i_json_set(map, "schema", json_string("perihom.trade/1"), &good);
    ph_i_json_set(map, "case", ph_i_json_text(t->path), &good);
    ph_i_json_set(map, "title", ph_i_json_text(t->title), &good);
    ph_i_json_set(reference, "kind", ph_i_json_text(t->reference_kind), &good);
    ph_i_json_set(reference, "values", values_json(t, t->reference, &good), &good);
    ph_i_json_set(reference, "error", ph_i_json_number(t->reference_error), &good);
    ph_i_json_set(map, "reference", reference, &good);
    ph_i_json_set(map, "complete", json_boolean(t->complete), &good);
    ph_i_json_set(map, "cpu_seconds", json_real(t->cpu), &good);
    ph_i_json_set(map, "advice", advice_json(t, &good), &good);
    for (int i = 0; i < t->nrows; i++)
        ph_i_json_append(rows, row_json(t, &t->row[i], &good), &good);
    ph_i_json_set(map, "rows", rows, &good);
    PH_CHECK(map && good, PH_ENOMEM, "no memory for the document");
    PH_TRY(ph_i_json_dump(map, json, err));
out:
    json_decref(map);
    return st;
}
