/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `error_bar` of a case file: auto, none, or which parts. */
#include <perihom/error_bar.h>

#include "io/case_internal.h"
#include "io/json.h"

static ph_i_names part_names(const char *name[PH_MAX_ERROR_PARTS])
{
    for (size_t i = 0; i < ph_nerror_parts; i++)
        name[i] = ph_error_parts[i].info.name;
    return (ph_i_names){name, ph_nerror_parts};
}

void ph_i_read_error_bar(ph_i_reader *r, const ph_i_node *node)
{
    static const char rule[] =
        "must be auto, none, or parts to add or leave out, such as {boundary: true}";
    const char *name[PH_MAX_ERROR_PARTS];
    unsigned *parts = &r->c->error_parts;
    *parts = ph_error_parts_auto();
    if (!node || ph_i_is_word(node, "auto")) return;
    if (ph_i_is_word(node, "none")) {
        *parts = 0;
        return;
    }
    if (!ph_i_read_map(r, node, rule)) return;
    ph_i_check_keys(r, node, part_names(name), "error_bar");
    for (size_t i = 0; i < ph_nerror_parts; i++) {
        const ph_i_node *child = ph_i_get(node, name[i]);
        bool wanted = *parts >> i & 1u;
        if (child) ph_i_read_flag(r, child, &wanted);
        *parts = wanted ? *parts | 1u << i : *parts & ~(1u << i);
    }
}

json_t *ph_i_error_bar_to_json(const ph_case *c, bool *good)
{
    if (c->error_parts == 0) return json_string("none");
    if (c->error_parts == ph_error_parts_auto()) return json_string("auto");
    json_t *map = json_object();
    for (size_t i = 0; i < ph_nerror_parts; i++)
        ph_i_json_set(map, ph_error_parts[i].info.name,
                      json_boolean(c->error_parts >> i & 1u), good);
    return map;
}
