/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `output` of a case file. */
#include "io/case_internal.h"
#include "io/json.h"

#include <math.h>
#include <string.h>

static const char *const output_keys[] = {"fields", "constants"};

/* Why a case has no constants of its own, or NULL: what it computes is more than a tensor. */
static const char *no_constants(const ph_case *c)
{
    if (ph_case_relaxes(c))
        return "the constants of materials that relax are curves: leave it out";
    if (c->ncracks > 0 || c->loading.ntargets > 0)
        return "steps of damage are judged by the whole tensor: leave it out";
    return NULL;
}

static void read_constant(ph_i_reader *r, const ph_i_node *node)
{
    ph_case *c = r->c;
    ph_quantity q;
    ph_error why = PH_ERROR_INIT;
    char name[sizeof q.name];
    if (!ph_i_read_text(r, node, sizeof name, name)) return;
    if (ph_quantity_find(name, &q, &why) != PH_OK) {
        ph_i_complain(r, node, PH_EINVAL, "%.300s", why.msg);
        return;
    }
    const char *no = ph_quantity_refuses(&q, c->kinematics);
    if (!no && isfinite(q.at)) no = "only materials that relax have constants at a time";
    if (!no && ph_quantity_loads(&q, c->kinematics) == 0)
        no = "fractions are in every result";
    for (int i = 0; i < c->nconstants; i++)
        if (strcmp(c->constants[i].name, q.name) == 0) no = "is named twice";
    if (no)
        ph_i_reject(r, node, PH_EINVAL, "%s", no);
    else
        c->constants[c->nconstants++] = q;
}

static void read_constants(ph_i_reader *r, const ph_i_node *node)
{
    static const char rule[] =
        "must be a list of constants such as [E1, nu12] ('perihom list quantities')";
    const char *no = no_constants(r->c);
    if (!ph_i_read_list(r, node, 0, rule)) return;
    if (no) {
        ph_i_complain(r, node, PH_EINVAL, "%s", no);
        return;
    }
    if (node->count == 0 || node->count > PH_MAX_CONSTANTS) {
        ph_i_complain(r, node, PH_EINVAL, "%zu constants: 1 to %d are admissible",
                      node->count, PH_MAX_CONSTANTS);
        return;
    }
    for (size_t i = 0; i < node->count; i++)
        read_constant(r, node->child[i]);
    if (r->c->fields)
        ph_i_complain(r, node, PH_EINVAL,
                      "with fields: true every load is solved: ask for one of them");
}

void ph_i_read_output(ph_i_reader *r, const ph_i_node *node)
{
    if (!node || !ph_i_read_map(r, node, "must be a map such as {fields: true}")) return;
    ph_i_check_keys(r, node, (ph_i_names)PH_I_NAMES(output_keys), "output");
    const ph_i_node *fields = ph_i_get(node, "fields"),
                    *constants = ph_i_get(node, "constants");
    if (fields) ph_i_read_flag(r, fields, &r->c->fields);
    if (constants) read_constants(r, constants);
}

json_t *ph_i_output_to_json(const ph_case *c, bool *good)
{
    json_t *map = json_object();
    ph_i_json_set(map, "fields", json_boolean(c->fields), good);
    if (c->nconstants == 0) return map;
    json_t *list = json_array();
    for (int i = 0; i < c->nconstants; i++)
        ph_i_json_append(list, json_string(c->constants[i].name), good);
    ph_i_json_set(map, "constants", list, good);
    return map;
}
