/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/catalogue.h>

#include "io/case_internal.h"
#include "io/text.h"

#include <math.h>
#include <string.h>

/* Squares, inverses and cubes of such numbers are still finite. */
static const double SMALLEST = 1e-60, LARGEST = 1e60;

bool ph_i_is_null(const ph_i_node *node)
{
    return node->kind == PH_I_SCALAR && node->plain &&
           (node->text[0] == 0 || strcmp(node->text, "~") == 0 ||
            strcmp(node->text, "null") == 0);
}

bool ph_i_is_word(const ph_i_node *node, const char *word)
{
    return node->kind == PH_I_SCALAR && strcmp(node->text, word) == 0;
}

const ph_i_node *ph_i_get(const ph_i_node *map, const char *key)
{
    for (size_t i = 0; i < map->count; i++)
        if (strcmp(map->child[i]->key, key) == 0)
            return ph_i_is_null(map->child[i]) ? NULL : map->child[i];
    return NULL;
}

const ph_i_node *ph_i_need(ph_i_reader *r, const ph_i_node *map, const char *key,
                           const char *rule)
{
    const ph_i_node *node = ph_i_get(map, key);
    if (!node) ph_i_missing(r, map, key, "%s", rule);
    return node;
}

void ph_i_join_names(ph_i_names names, const char *last, char *out, size_t size)
{
    size_t used = 0;
    out[0] = 0;
    for (size_t i = 0; i < names.count; i++) {
        const char *between = i == 0 ? "" : i + 1 < names.count ? ", " : last;
        size_t need = strlen(between) + strlen(names.name[i]);
        if (used + need + sizeof ", ..." > size) {
            snprintf(out + used, size - used, ", ...");
            return;
        }
        used += (size_t)snprintf(out + used, size - used, "%s%s", between, names.name[i]);
    }
}

void ph_i_check_keys(ph_i_reader *r, const ph_i_node *map, ph_i_names known,
                     const char *what)
{
    for (size_t i = 0; i < map->count; i++) {
        ph_i_node *node = map->child[i];
        char list[200];
        size_t k = 0;
        while (k < known.count && strcmp(known.name[k], node->key) != 0)
            k++;
        if (k < known.count) continue;
        const char *near = ph_nearest_name(node->key, known.name, known.count);
        node->meant = near;
        ph_i_join_names(known, " and ", list, sizeof list);
        ph_i_complain(r, node, PH_EINVAL, "unknown key: %s has %s%s%s%s", what, list,
                      near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
    }
}

bool ph_i_read_map(ph_i_reader *r, const ph_i_node *node, const char *rule)
{
    if (node->kind == PH_I_MAP) return true;
    ph_i_reject(r, node, PH_EINVAL, "%s", rule);
    return false;
}

bool ph_i_read_list(ph_i_reader *r, const ph_i_node *node, size_t count, const char *rule)
{
    if (node->kind == PH_I_LIST && (count == 0 || node->count == count)) return true;
    ph_i_reject(r, node, PH_EINVAL, "%s", rule);
    return false;
}

bool ph_i_read_number(ph_i_reader *r, const ph_i_node *node, double lo, double hi,
                      const char *rule, double *out)
{
    double x = 0;
    if (node->kind != PH_I_SCALAR || !node->plain ||
        !ph_i_text_to_number(node->text, &x)) {
        ph_i_reject(r, node, PH_EINVAL, "%s", rule);
        return false;
    }
    if (!isfinite(x) || x <= lo || x >= hi) {
        ph_i_reject(r, node, PH_EUNPHYSICAL, "%s", rule);
        return false;
    }
    *out = x;
    return true;
}

bool ph_i_read_positive(ph_i_reader *r, const ph_i_node *node, const char *rule,
                        double *out)
{
    double x;
    if (!ph_i_read_number(r, node, 0, INFINITY, rule, &x)) return false;
    if (x < SMALLEST || x > LARGEST) {
        ph_i_reject(r, node, PH_EUNPHYSICAL,
                    "must lie between 1e-60 and 1e60: choose other units");
        return false;
    }
    *out = x;
    return true;
}

bool ph_i_read_integer(ph_i_reader *r, const ph_i_node *node, int64_t lo, int64_t hi,
                       const char *rule, int64_t *out)
{
    double x;
    if (!ph_i_read_number(r, node, -INFINITY, INFINITY, rule, &x)) return false;
    if (x != floor(x) || x < (double)lo || x > (double)hi) {
        ph_i_reject(r, node, PH_EINVAL, "%s", rule);
        return false;
    }
    *out = (int64_t)x;
    return true;
}

bool ph_i_read_numbers(ph_i_reader *r, const ph_i_node *node, size_t count, bool positive,
                       const char *rule, double *out)
{
    if (!ph_i_read_list(r, node, count, rule)) return false;
    bool good = true;
    for (size_t i = 0; i < count; i++) {
        const ph_i_node *x = node->child[i];
        good &= positive ? ph_i_read_positive(r, x, "must be a length > 0", &out[i])
                         : ph_i_read_number(r, x, -LARGEST, LARGEST,
                                            "must be a number (at most 1e60)", &out[i]);
    }
    return good;
}

bool ph_i_read_direction(ph_i_reader *r, const ph_i_node *node, const char *rule,
                         double out[3])
{
    double v[3];
    if (!ph_i_read_numbers(r, node, 3, false, rule, v)) return false;
    if (fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2]))) < SMALLEST) {
        ph_i_complain(r, node, PH_EUNPHYSICAL, "three zeros are no direction");
        return false;
    }
    memcpy(out, v, sizeof v);
    return true;
}

bool ph_i_read_flag(ph_i_reader *r, const ph_i_node *node, bool *out)
{
    bool yes = ph_i_is_word(node, "true"), no = ph_i_is_word(node, "false");
    if (!node->plain || (!yes && !no)) {
        ph_i_reject(r, node, PH_EINVAL, "must be true or false");
        return false;
    }
    *out = yes;
    return true;
}

/* No control characters: one line that every output format can hold. libyaml has already
 * checked that it is UTF-8. */
static bool is_printable(const char *text)
{
    const unsigned char *p = (const unsigned char *)text;
    for (; *p; p++) {
        if (*p < 32 || *p == 127) return false;
        if (p[0] == 0xC2 && p[1] < 0xA0) return false; /* U+0080 to U+009F */
        if (p[0] == 0xE2 && p[1] == 0x80 && (p[2] == 0xA8 || p[2] == 0xA9)) return false;
        if (p[0] == 0xEF && p[1] == 0xBF && p[2] >= 0xBE)
            return false; /* U+FFFE, U+FFFF */
        if (p[0] == 0xEF && p[1] == 0xBB && p[2] == 0xBF)
            return false; /* byte order mark */
    }
    return true;
}

bool ph_i_read_text(ph_i_reader *r, const ph_i_node *node, size_t size, char *out)
{
    if (node->kind != PH_I_SCALAR) {
        ph_i_reject(r, node, PH_EINVAL, "must be a text");
        return false;
    }
    if (strlen(node->text) >= size) {
        ph_i_reject(r, node, PH_EINVAL, "must have less than %zu bytes", size);
        return false;
    }
    if (!is_printable(node->text)) {
        ph_i_reject(r, node, PH_EINVAL, "must be one line without control characters");
        return false;
    }
    memcpy(out, node->text, strlen(node->text) + 1);
    return true;
}

int ph_i_read_name(ph_i_reader *r, const ph_i_node *node, ph_i_names names)
{
    char list[260];
    for (size_t i = 0; i < names.count; i++)
        if (ph_i_is_word(node, names.name[i])) return (int)i;
    const char *near = NULL;
    if (node->kind == PH_I_SCALAR)
        near = ph_nearest_name(node->text, names.name, names.count);
    ph_i_join_names(names, " or ", list, sizeof list);
    ph_i_reject(r, node, PH_EINVAL, "must be %s%s%s%s", list,
                near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
    return -1;
}

int ph_i_read_material(ph_i_reader *r, const ph_i_node *node)
{
    if (r->materials.count == 0) return -1; /* that complaint is enough */
    return ph_i_read_name(r, node, r->materials);
}
