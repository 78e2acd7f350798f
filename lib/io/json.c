/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/json.h"

#include "io/text.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#define NO_MEMORY(err, what) PH_FAIL(err, PH_ENOMEM, "no memory for the JSON of %s", what)

ph_status ph_i_json_put(json_t *obj, const char *key, json_t *value, ph_error *err)
{
    /* A NULL value comes from a constructor that had no memory. */
    if (!value || json_object_set_new(obj, key, value) != 0) return NO_MEMORY(err, key);
    return PH_OK;
}

ph_status ph_i_json_add(json_t *array, json_t *value, ph_error *err)
{
    if (!value || json_array_append_new(array, value) != 0)
        return NO_MEMORY(err, "an array");
    return PH_OK;
}

json_t *ph_i_json_text(const char *text)
{
    if (!text) return json_null();
    json_t *value = json_string(text);
    if (value) return value;
    size_t length = strlen(text), odd = 0;
    for (size_t i = 0; i < length; i++)
        odd += (unsigned char)text[i] >= 0x80;
    if (odd == 0) return NULL; /* ASCII is always admissible: no memory */
    char *plain = malloc(length + 1);
    if (!plain) return NULL;
    for (size_t i = 0; i <= length; i++)
        plain[i] = (char)((unsigned char)text[i] < 0x80 ? text[i] : '?');
    value = json_string(plain);
    free(plain);
    return value;
}

json_t *ph_i_json_number(double x)
{
    return isfinite(x) ? json_real(x) : json_null();
}

ph_status ph_i_json_matrix(int n, const double *a, json_t **out, ph_error *err)
{
    ph_status st = PH_OK;
    json_t *rows = json_array(), *row = NULL;
    PH_CHECK(rows, PH_ENOMEM, "no memory for a matrix");
    for (int i = 0; i < n; i++) {
        row = json_array();
        PH_CHECK(row, PH_ENOMEM, "no memory for a row of a matrix");
        for (int j = 0; j < n; j++)
            PH_TRY(ph_i_json_add(row, ph_i_json_number(a[i * n + j]), err));
        json_t *full = row;
        row = NULL;
        PH_TRY(ph_i_json_add(rows, full, err));
    }
    *out = rows;
    rows = NULL;
out:
    json_decref(row);
    json_decref(rows);
    return st;
}

ph_status ph_i_json_put_number(json_t *obj, const char *path, const char *key, double x,
                               json_t *reasons, const char *why, ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(ph_i_json_put(obj, key, ph_i_json_number(x), err));
    if (isfinite(x)) goto out;
    char full[256];
    snprintf(full, sizeof full, "%s.%s", path, key);
    PH_TRY(ph_i_json_put(reasons, full, ph_i_json_text(why), err));
out:
    return st;
}

/* jansson (2.14) overlooks a failure while it writes a key and would go on: the growing text
 * remembers. */
static int append(const char *piece, size_t size, void *user)
{
    return ph_i_append(user, piece, size) ? 0 : -1;
}

ph_status ph_i_json_dump(const json_t *document, char **text, ph_error *err)
{
    ph_i_growing g = {.text = NULL};
    int failed = json_dump_callback(document, append, &g,
                                    JSON_INDENT(1) | JSON_REAL_PRECISION(17));
    if (failed || g.failed || !g.text) {
        free(g.text);
        return NO_MEMORY(err, "the document");
    }
    *text = g.text;
    return PH_OK;
}

/* ---- parsing ---- */

typedef struct source {
    const char *text;
    size_t left;
    bool failed; /* memory ran out */
} source;

/* One byte a call: jansson (2.14) goes on with a byte less where its buffer of a token cannot
 * grow, and reads the number or the name that is left. The next byte that it wants tells. */
static size_t next_byte(void *to, size_t size, void *user)
{
    source *s = user;
    s->failed = s->failed || errno == ENOMEM;
    if (s->failed) return (size_t)-1;
    if (size == 0 || s->left == 0) return 0;
    *(char *)to = *s->text++;
    s->left--;
    return 1;
}

ph_status ph_i_json_parse(const char *text, size_t length, const char *name,
                          json_t **document, ph_error *err)
{
    ph_status st = PH_OK;
    source s = {text, length, false};
    json_error_t why;
    errno = 0; /* jansson does not tell want of memory from a mistake; malloc does */
    json_t *root = json_load_callback(next_byte, &s, JSON_REJECT_DUPLICATES, &why);
    PH_CHECK(!s.failed && (root || errno != ENOMEM), PH_ENOMEM,
             "%s: no memory for the document", name);
    PH_CHECK(root, PH_EINVAL, "%s:%d: not JSON: %s", name, why.line, why.text);
    *document = root;
    root = NULL;
out:
    json_decref(root);
    return st;
}

void ph_i_json_set(json_t *object, const char *key, json_t *value, bool *good)
{
    if (json_object_set_new(object, key, value) != 0) *good = false;
}

void ph_i_json_append(json_t *list, json_t *value, bool *good)
{
    if (json_array_append_new(list, value) != 0) *good = false;
}

json_t *ph_i_json_numbers(const double *x, ptrdiff_t n, bool *good)
{
    json_t *list = json_array();
    for (ptrdiff_t i = 0; i < n; i++)
        ph_i_json_append(list, json_real(x[i]), good);
    return list;
}
