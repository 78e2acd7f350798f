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

/* A JSON string: one line, UTF-8; what is none becomes U+FFFD. */
static size_t put_text(char *text, size_t n, const char *from)
{
    uint32_t code;
    text[n++] = '"';
    for (const char *at = from; ph_i_utf8_next(&at, &code) && n + 32 < PH_I_LINE;
         from = at) {
        if (code == '"' || code == '\\') {
            text[n++] = '\\';
            text[n++] = (char)code;
        } else if (code < 32 || code == 0xfffd) {
            n += (size_t)snprintf(text + n, 8, "\\u%04x", code);
        } else {
            memcpy(text + n, from, (size_t)(at - from));
            n += (size_t)(at - from);
        }
    }
    text[n++] = '"';
    text[n] = 0;
    return n;
}

size_t ph_i_record_line(const ph_campaign *c, const ph_i_record *r, char *text)
{
    size_t n = (size_t)snprintf(text, PH_I_LINE, "{\"point\": %d", r->point % c->npoints);
    if (r->point >= c->npoints)
        n += (size_t)snprintf(text + n, PH_I_LINE - n, ", \"level\": %d",
                              r->point / c->npoints);
    n += (size_t)snprintf(text + n, PH_I_LINE - n, ", \"i\": %lld", (long long)r->i);
    if (r->status != PH_OK) {
        n += (size_t)snprintf(text + n, PH_I_LINE - n, ", \"failed\": \"%s\"",
                              ph_status_text(r->status));
        n += (size_t)snprintf(text + n, PH_I_LINE - n, ", \"message\": ");
        return close_line(text, put_text(text, n, r->message));
    }
    for (int k = 0; k < ph_i_slot_values(c, r->point); k++) {
        char name[sizeof c->output->name];
        ph_i_slot_name(c, r->point, k, name);
        n += (size_t)snprintf(text + n, PH_I_LINE - n, ", ");
        n = put_text(text, n, name);
        text[n++] = ':';
        text[n++] = ' ';
        ph_i_short_number(text + n, 40, 17, r->value[k]);
        n += strlen(text + n);
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

/* The rest of a line behind "text"; NULL if it does not go on so. */
static const char *skip(const char *at, const char *text)
{
    size_t n = strlen(text);
    return at && strncmp(at, text, n) == 0 ? at + n : NULL;
}

static const char *skip_integer(const char *at, int64_t most, int64_t *out)
{
    char *end;
    if (!at || *at < '0' || *at > '9') return NULL;
    *out = strtoll(at, &end, 10);
    return *out <= most ? end : NULL;
}

static const char *skip_number(const char *at, double *out)
{
    char number[40];
    size_t n = at ? strcspn(at, ",") : 0;
    if (n == 0 || n >= sizeof number) return NULL;
    memcpy(number, at, n);
    number[n] = 0;
    return ph_i_text_to_number(number, out) && isfinite(*out) ? at + n : NULL;
}

/* The values of a success: exactly what ph_i_record_line writes, the check is known to be
 * right, so nothing more general is needed. */
static bool take_values(const ph_campaign *c, const char *at, ph_i_record *r)
{
    char key[2 * sizeof c->output->name + 8];
    int64_t iterations = 0;
    for (int k = 0; k < ph_i_slot_values(c, r->point); k++) {
        char name[sizeof c->output->name];
        ph_i_slot_name(c, r->point, k, name);
        size_t n = put_text(key, 0, name);
        snprintf(key + n, sizeof key - n, ": ");
        at = skip_number(skip(skip(at, ", "), key), &r->value[k]);
    }
    at = skip_integer(skip(at, ", \"iterations\": "), INT32_MAX, &iterations);
    r->iterations = (int)iterations;
    return skip(at, check_key) != NULL;
}

static bool take_failure(const char *line, size_t length, ph_i_record *r)
{
    json_t *object = json_loadb(line, length, 0, NULL);
    const char *failed = json_string_value(json_object_get(object, "failed")),
               *message = json_string_value(json_object_get(object, "message"));
    if (failed && message) {
        r->status = status_of(failed);
        snprintf(r->message, sizeof r->message, "%s", message);
    }
    json_decref(object);
    return r->status != PH_OK;
}

bool ph_i_record_parse(const ph_campaign *c, const char *line, size_t length,
                       ph_i_record *r)
{
    int64_t point = 0, level = 0, i = 0;
    if (!check_is_right(line, length)) return false;
    const char *at = skip_integer(skip(line, "{\"point\": "), c->npoints - 1, &point);
    if (skip(at, ", \"level\": "))
        at = skip_integer(skip(at, ", \"level\": "), c->nmodels - 1, &level);
    at = skip_integer(skip(at, ", \"i\": "), INT32_MAX, &i);
    if (!at) return false;
    r->point = (int)(point + level * c->npoints);
    r->i = i;
    r->status = PH_OK;
    r->message[0] = 0;
    r->seconds = 0.0;
    r->work = (ph_work){0};
    return skip(at, ", \"failed\"") ? take_failure(line, length, r)
                                    : take_values(c, at, r);
}
