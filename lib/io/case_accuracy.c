/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `accuracy` and `budget` of a case file, in place of settings. */
#include <perihom/quantity.h>

#include "io/case_internal.h"
#include "io/json.h"

#include <math.h>
#include <string.h>

/* Which key of which section each setting is. */
static const struct {
    unsigned bit;
    const char *section, *key;
} settings[] = {
    {PH_SETTING_NODES, "microstructure", "nodes"},
    {PH_SETTING_INTERFACE, "microstructure", "interface"},
    {PH_SETTING_POINTS, "model", "points"},
    {PH_SETTING_HORIZON, "model", "horizon"},
    {PH_SETTING_MODEL, "model", "kind"},
    {PH_SETTING_TOLERANCE, "solver", "tolerance"},
    {PH_SETTING_PRECISION, "solver", "precision"},
};
enum { SETTINGS = sizeof settings / sizeof *settings };

static const ph_i_node *find(const ph_i_node *root, const char *section, const char *key)
{
    const ph_i_node *map = ph_i_get(root, section);
    return map && map->kind == PH_I_MAP ? ph_i_get(map, key) : NULL;
}

static void read_constants(ph_i_reader *r, const ph_i_node *list)
{
    static const char rule[] = "must be a list of 1 to 16 quantities such as [E1, G12]";
    ph_case_accuracy *a = &r->c->accuracy;
    if (!ph_i_read_list(r, list, 0, rule)) return;
    if (list->count < 1 || list->count > PH_ACCURACY_CONSTANTS) {
        ph_i_reject(r, list, PH_EINVAL, "%s", rule);
        return;
    }
    for (size_t i = 0; i < list->count; i++) {
        const ph_i_node *name = list->child[i];
        ph_error why = PH_ERROR_INIT;
        ph_quantity q;
        if (name->kind != PH_I_SCALAR) {
            ph_i_reject(r, name, PH_EINVAL, "must be the name of a quantity");
            continue;
        }
        if (ph_quantity_find(name->text, &q, &why) != PH_OK) {
            ph_i_complain(r, name, PH_EINVAL, "%s", why.msg);
            continue;
        }
        const char *no = ph_quantity_refuses(&q, r->c->kinematics);
        if (!no && isfinite(q.at)) no = "constants at once only";
        if (!no && ph_quantity_loads(&q, r->c->kinematics) == 0)
            no = "nothing is solved for it";
        if (no)
            ph_i_complain(r, name, PH_EINVAL, "%s: %s", q.name, no);
        else
            snprintf(a->constant[a->nconstants++], sizeof a->constant[0], "%s", q.name);
    }
}

static void read_budget(ph_i_reader *r, const ph_i_node *map)
{
    static const char *const keys[] = {"seconds", "memory"};
    ph_case_accuracy *a = &r->c->accuracy;
    if (!ph_i_read_map(r, map, "must be a map such as {seconds: 60, memory: 8e9}"))
        return;
    ph_i_check_keys(r, map, (ph_i_names)PH_I_NAMES(keys), "budget");
    const ph_i_node *seconds = ph_i_get(map, "seconds"),
                    *memory = ph_i_get(map, "memory");
    if (seconds)
        ph_i_read_positive(r, seconds, "must be a number of seconds > 0", &a->seconds);
    if (memory)
        ph_i_read_positive(r, memory, "must be a number of bytes > 0", &a->memory);
}

/* What no accuracy can be promised of. */
static void refuse(ph_i_reader *r, const ph_i_node *at, const ph_i_node *root)
{
    const ph_case *c = r->c;
    const char *kind = c->constraint.kind ? c->constraint.kind : "";
    if (c->voxels.file[0])
        ph_i_complain(
            r, at, PH_EINVAL,
            "a voxel file is its own grid: there is no finer one to judge it by");
    else if (ph_i_get(root, "loading") || ph_i_get(root, "failure"))
        ph_i_complain(r, at, PH_EINVAL,
                      "belongs to effective constants, not to bonds that break");
    else if (ph_case_relaxes(c))
        ph_i_complain(r, at, PH_EINVAL,
                      "belongs to elastic constants: a material relaxes");
    else if (strcmp(kind, "voigt") == 0 || strcmp(kind, "reuss") == 0)
        ph_i_complain(r, at, PH_EINVAL, "constraint %s solves no equations", kind);
    else if (c->nfillers > 0 && !c->drawn_on[0] && !find(root, "microstructure", "nodes"))
        ph_i_complain(r, at, PH_EINVAL,
                      "random fillers are drawn on a grid, which is part of what they "
                      "are: give microstructure.drawn_on");
}

void ph_i_read_accuracy(ph_i_reader *r, const ph_i_node *root)
{
    static const char *const keys[] = {"relative", "constants"};
    static const char rule[] = "must be a relative error > 0 and < 1, e.g. 0.01";
    ph_case_accuracy *a = &r->c->accuracy;
    const ph_i_node *map = ph_i_get(root, "accuracy"), *budget = ph_i_get(root, "budget");
    if (budget && !map)
        ph_i_complain(r, budget, PH_EINVAL, "belongs to accuracy, which is not there");
    if (!map || !ph_i_read_map(r, map, "must be a map such as {relative: 0.01}")) return;
    ph_i_check_keys(r, map, (ph_i_names)PH_I_NAMES(keys), "accuracy");
    const ph_i_node *relative = ph_i_need(r, map, "relative", rule),
                    *constants = ph_i_get(map, "constants");
    if (relative) ph_i_read_number(r, relative, 0, 1, rule, &a->relative);
    if (constants) read_constants(r, constants);
    if (budget) read_budget(r, budget);
    for (int i = 0; i < SETTINGS; i++)
        if (find(root, settings[i].section, settings[i].key)) a->given |= settings[i].bit;
    refuse(r, map, root);
}

void ph_i_accuracy_to_json(const ph_case *c, json_t *map, bool *good)
{
    const ph_case_accuracy *a = &c->accuracy;
    if (!(a->relative > 0)) return;
    json_t *accuracy = json_object(), *constants = json_array(), *budget = json_object();
    ph_i_json_set(accuracy, "relative", json_real(a->relative), good);
    for (int k = 0; k < a->nconstants; k++)
        ph_i_json_append(constants, json_string(a->constant[k]), good);
    if (a->nconstants > 0)
        ph_i_json_set(accuracy, "constants", json_incref(constants), good);
    json_decref(constants);
    ph_i_json_set(map, "accuracy", accuracy, good);
    if (a->seconds > 0) ph_i_json_set(budget, "seconds", json_real(a->seconds), good);
    if (a->memory > 0) ph_i_json_set(budget, "memory", json_real(a->memory), good);
    if (json_object_size(budget) > 0)
        ph_i_json_set(map, "budget", json_incref(budget), good);
    json_decref(budget);
    for (int i = 0; i < SETTINGS; i++)
        if (!(a->given & settings[i].bit))
            json_object_del(json_object_get(map, settings[i].section), settings[i].key);
}
