/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lines of realisations.jsonl. */
#include "campaign/campaign.h"

#include <jansson.h>

#include <math.h>
#include <string.h>

static const char check_key[] = ", \"check\": \"";

/* , "check": "89abcdef"} and the end of the line. */
static size_t close_line(char *text, size_t n)
{
    uint64_t hash = ph_i_hash(PH_I_HASH_START, text, n);
    return n + (size_t)snprintf(text + n, PH_I_LINE - n, "%s%08x\"}\n", check_key,
                                (unsigned)(hash ^ hash >> 32));
}

/* The text of an error as a JSON string without its quotes: one line of ASCII or UTF-8. */
static size_t put_text(char *text, size_t n, const char *from)
{
    json_t *string = json_string(from);
    char *dump = string ? json_dumps(string, JSON_ENCODE_ANY) : NULL;
    n += (size_t)snprintf(text + n, PH_I_LINE - n, "%s", dump ? dump : "\"\"");
    free(dump);
    json_decref(string);
    return n;
}

size_t ph_i_record_line(const ph_campaign *c, const ph_i_record *r, char *text)
{
    size_t n = (size_t)snprintf(text, PH_I_LINE, "{\"point\": %d, \"i\": %lld", r->point,
                                (long long)r->i);
    if (r->status != PH_OK) {
        n += (size_t)snprintf(text + n, PH_I_LINE - n, ", \"failed\": \"%s\"",
                              ph_status_text(r->status));
        n += (size_t)snprintf(text + n, PH_I_LINE - n, ", \"message\": ");
        return close_line(text, put_text(text, n, r->message));
    }
    for (int k = 0; k < c->noutputs; k++) {
        n += (size_t)snprintf(text + n, PH_I_LINE - n, ", ");
        n = put_text(text, n, c->output[k].name);
        n += (size_t)snprintf(text + n, PH_I_LINE - n, ": %.17g", r->value[k]);
    }
    n += (size_t)snprintf(text + n, PH_I_LINE - n, ", \"iterations\": %d", r->iterations);
    return close_line(text, n);
}

size_t ph_i_record_header(const ph_campaign *c, char *text)
{
    size_t n = (size_t)snprintf(
        text, PH_I_LINE,
        "{\"schema\": \"perihom.realisations/1\", \"campaign\": \"%016llx\", "
        "\"points\": %d",
        (unsigned long long)c->hash, c->npoints);
    return close_line(text, n);
}

static bool check_is_right(const char *line, size_t length)
{
    char end[64];
    size_t tail = sizeof check_key - 1 + 8 + 3; /* key, digits, "}\n */
    if (length <= tail) return false;
    uint64_t hash = ph_i_hash(PH_I_HASH_START, line, length - tail);
    snprintf(end, sizeof end, "%s%08x\"}\n", check_key, (unsigned)(hash ^ hash >> 32));
    return memcmp(line + length - tail, end, tail) == 0;
}

static ph_status status_of(const char *text)
{
#define PH_I_STATUS(name, number, words, code)                                           \
    if (strcmp(text, words) == 0) return name;
    PH_STATUS_LIST(PH_I_STATUS)
#undef PH_I_STATUS
    return PH_EINTERNAL;
}

static bool take_values(const ph_campaign *c, const json_t *line, ph_i_record *r)
{
    for (int k = 0; k < c->noutputs; k++) {
        const json_t *x = json_object_get(line, c->output[k].name);
        if (!json_is_number(x)) return false;
        r->value[k] = json_number_value(x);
        if (!isfinite(r->value[k])) return false;
    }
    r->iterations = (int)json_integer_value(json_object_get(line, "iterations"));
    return true;
}

static bool take(const ph_campaign *c, const json_t *line, ph_i_record *r)
{
    const json_t *point = json_object_get(line, "point"), *i = json_object_get(line, "i"),
                 *failed = json_object_get(line, "failed");
    if (!json_is_integer(point) || !json_is_integer(i)) return false;
    if (json_integer_value(point) < 0 || json_integer_value(point) >= c->npoints)
        return false;
    if (json_integer_value(i) < 0 || json_integer_value(i) > INT32_MAX) return false;
    *r = (ph_i_record){.point = (int)json_integer_value(point),
                       .i = json_integer_value(i)};
    if (!failed) return take_values(c, line, r);
    const char *message = json_string_value(json_object_get(line, "message"));
    if (!json_is_string(failed) || !message) return false;
    r->status = status_of(json_string_value(failed));
    snprintf(r->message, sizeof r->message, "%s", message);
    return r->status != PH_OK;
}

bool ph_i_record_parse(const ph_campaign *c, const char *line, size_t length,
                       ph_i_record *r)
{
    if (!check_is_right(line, length)) return false;
    json_t *object = json_loadb(line, length, 0, NULL);
    bool good = object && take(c, object, r);
    json_decref(object);
    return good;
}
