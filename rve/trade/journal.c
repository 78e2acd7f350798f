/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rows of a trade, one JSON line each, so that none is computed twice. */
#include "io/json.h"
#include "io/read_file.h"
#include "trade/trade.h"

#include <errno.h>
#include <math.h>
#include <string.h>

static const size_t MOST = (size_t)1 << 30; /* bytes of a journal */

static void path_of(const char *folder, char *path, size_t size)
{
    snprintf(path, size, "%s/rows.jsonl", folder);
}

void ph_i_trade_kept_free(ph_i_trade_kept **kept)
{
    if (!kept || !*kept) return;
    free((*kept)->hash);
    free((*kept)->row);
    free(*kept);
    *kept = NULL;
}

static double number_of(const json_t *line, const char *key)
{
    const json_t *x = json_object_get(line, key);
    return json_is_number(x) ? json_number_value(x) : (double)NAN;
}

/* False: not a whole row, which is then computed again. */
static bool parse(const json_t *line, int nconstants, uint64_t *hash, ph_trade_row *row)
{
    const char *text = json_string_value(json_object_get(line, "row"));
    const json_t *values = json_object_get(line, "values");
    const char *reason = json_string_value(json_object_get(line, "reason"));
    *row = (ph_trade_row){.error = number_of(line, "scatter")};
    if (!text || strlen(text) != 16 || !isfinite(number_of(line, "cpu"))) return false;
    *hash = strtoull(text, NULL, 16);
    row->state = (ph_trade_state)number_of(line, "state");
    row->status = (ph_status)number_of(line, "status");
    if (reason) snprintf(row->reason, sizeof row->reason, "%s", reason);
    if (row->state == PH_TRADE_FAILED || row->state == PH_TRADE_REFUSED) return true;
    if (row->state != PH_TRADE_DONE || json_array_size(values) != (size_t)nconstants)
        return false;
    for (int k = 0; k < nconstants; k++)
        row->value[k] = json_number_value(json_array_get(values, (size_t)k));
    row->iterations = (int)number_of(line, "iterations");
    row->applications = (long)number_of(line, "applications");
    row->ffts = (long)number_of(line, "ffts");
    row->bytes = (size_t)number_of(line, "bytes");
    row->nodes = (ptrdiff_t)number_of(line, "nodes");
    row->work = number_of(line, "work");
    row->cpu = number_of(line, "cpu");
    row->seconds = number_of(line, "seconds");
    return isfinite(row->work) && isfinite(row->seconds);
}

static ph_status add_kept(ph_i_trade_kept *k, uint64_t hash, const ph_trade_row *row,
                          ph_error *err)
{
    ph_status st = PH_OK;
    if (k->count == k->capacity) {
        int capacity = 2 * k->capacity + 64;
        ph_trade_row *rows = realloc(k->row, (size_t)capacity * sizeof *rows);
        PH_CHECK(rows, PH_ENOMEM, "no memory for the rows of a journal");
        k->row = rows;
        uint64_t *hashes = realloc(k->hash, (size_t)capacity * sizeof *hashes);
        PH_CHECK(hashes, PH_ENOMEM, "no memory for the rows of a journal");
        k->hash = hashes;
        k->capacity = capacity;
    }
    k->hash[k->count] = hash;
    k->row[k->count++] = *row;
out:
    return st;
}

ph_status ph_i_trade_journal_read(const char *folder, int nconstants,
                                  ph_i_trade_kept **out, ph_error *err)
{
    ph_status st = PH_OK;
    char path[1200], *text = NULL;
    size_t length = 0;
    ph_i_trade_kept *k = NULL;
    PH_ALLOC(k, 1, "a journal");
    path_of(folder, path, sizeof path);
    FILE *there = fopen(path, "r");
    if (there) {
        fclose(there);
        PH_TRY(ph_i_read_file(path, MOST, "journal", &text, &length, err));
    }
    for (char *line = text, *end; line && (end = strchr(line, '\n')); line = end + 1) {
        ph_trade_row row;
        uint64_t hash;
        *end = 0;
        json_t *parsed = json_loads(line, 0, NULL);
        bool good = parsed && parse(parsed, nconstants, &hash, &row);
        json_decref(parsed);
        if (good) PH_TRY(add_kept(k, hash, &row, err));
    }
    *out = k;
    k = NULL;
out:
    free(text);
    ph_i_trade_kept_free(&k);
    return st;
}

bool ph_i_trade_recall(const ph_i_trade_kept *kept, uint64_t hash, ph_trade_row *row)
{
    for (int i = 0; kept && i < kept->count; i++) {
        if (kept->hash[i] != hash) continue;
        const ph_trade_row asked = *row;
        *row = kept->row[i];
        memcpy(row->knob, asked.knob, sizeof row->knob);
        memcpy(row->family, asked.family, sizeof row->family);
        memcpy(row->setting, asked.setting, sizeof row->setting);
        memcpy(row->set, asked.set, sizeof row->set);
        row->nsets = asked.nsets;
        row->threads = asked.threads;
        row->realisations = asked.realisations;
        if (row->nodes == 0) row->nodes = asked.nodes;
        row->kept = true;
        return true;
    }
    return false;
}

static json_t *row_line(int nconstants, uint64_t hash, const ph_trade_row *row,
                        bool *good)
{
    char text[24];
    json_t *line = json_object();
    snprintf(text, sizeof text, "%016llx", (unsigned long long)hash);
    ph_i_json_set(line, "row", json_string(text), good);
    ph_i_json_set(line, "state", json_integer(row->state), good);
    ph_i_json_set(line, "status", json_integer(row->status), good);
    ph_i_json_set(line, "reason", ph_i_json_text(row->reason), good);
    ph_i_json_set(line, "cpu", json_real(row->cpu), good);
    if (row->state != PH_TRADE_DONE) return line;
    ph_i_json_set(line, "values", ph_i_json_numbers(row->value, nconstants, good), good);
    ph_i_json_set(line, "scatter", json_real(row->error), good);
    ph_i_json_set(line, "iterations", json_integer(row->iterations), good);
    ph_i_json_set(line, "applications", json_integer(row->applications), good);
    ph_i_json_set(line, "ffts", json_integer(row->ffts), good);
    ph_i_json_set(line, "bytes", json_integer((json_int_t)row->bytes), good);
    ph_i_json_set(line, "nodes", json_integer((json_int_t)row->nodes), good);
    ph_i_json_set(line, "work", json_real(row->work), good);
    ph_i_json_set(line, "seconds", json_real(row->seconds), good);
    return line;
}

ph_status ph_i_trade_journal_add(const char *folder, int nconstants, uint64_t hash,
                                 const ph_trade_row *row, ph_error *err)
{
    ph_status st = PH_OK;
    char path[1200], *text = NULL;
    bool good = true;
    FILE *file = NULL;
    json_t *line = row_line(nconstants, hash, row, &good);
    PH_CHECK(line && good, PH_ENOMEM, "no memory for a row of the journal");
    text = json_dumps(line, JSON_COMPACT | JSON_REAL_PRECISION(17));
    PH_CHECK(text, PH_ENOMEM, "no memory for a row of the journal");
    path_of(folder, path, sizeof path);
    file = fopen(path, "a");
    PH_CHECK(file, PH_EIO, "%s: cannot be written: %s", path, strerror(errno));
    bool written = fprintf(file, "%s\n", text) > 0;
    written = fclose(file) == 0 && written;
    file = NULL;
    PH_CHECK(written, PH_EIO, "%s: cannot be written: %s", path, strerror(errno));
out:
    free(text);
    json_decref(line);
    return st;
}
