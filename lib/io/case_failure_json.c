/* SPDX-License-Identifier: GPL-3.0-or-later */
/* failure and loading of the resolved case; ph_i_read_failure reads them back. */
#include "io/case_internal.h"
#include "io/json.h"

#include <math.h>

static void put(json_t *object, const char *key, json_t *value, bool *good)
{
    if (json_object_set_new(object, key, value) != 0) *good = false;
}

static json_t *rule(const ph_failure_rule *k, bool *good)
{
    if (k->criterion == PH_UNBREAKABLE) return json_string("unbreakable");
    const ph_failure_criterion *c = &ph_failure_criteria[k->criterion];
    json_t *map = json_object();
    if (isnan(k->value)) {
        put(map, "fracture_energy", json_real(k->fracture_energy), good);
        put(map, "criterion", json_string(c->info.name), good);
    } else {
        put(map, c->key, json_real(k->value), good);
    }
    if (k->weibull > 0.0) put(map, "weibull", json_real(k->weibull), good);
    return map;
}

json_t *ph_i_failure_to_json(const ph_case *c, bool *good)
{
    json_t *map = json_object();
    const ph_failure *f = &c->failure;
    for (int i = 0; i < c->nmaterials; i++)
        if (f->material[i].given)
            put(map, c->materials[i].name, rule(&f->material[i], good), good);
    if (f->interphase.given) put(map, "interphase", rule(&f->interphase, good), good);
    if (f->agglomeration.given)
        put(map, "agglomeration", rule(&f->agglomeration, good), good);
    return map;
}

static json_t *numbers(const double *x, int n, bool *good)
{
    json_t *list = json_array();
    for (int i = 0; i < n; i++)
        if (json_array_append_new(list, json_real(x[i])) != 0) *good = false;
    return list;
}

json_t *ph_i_loading_to_json(const ph_case *c, bool *good)
{
    const ph_loading *l = &c->loading;
    json_t *map = json_object();
    put(map, "strain", numbers(l->strain, ph_strains(c->kinematics), good), good);
    put(map, "to", numbers(l->to, l->ntargets, good), good);
    put(map, "steps", json_integer(l->steps), good);
    put(map, "window", json_real(l->window), good);
    put(map, "break", json_string(l->together ? "together" : "events"), good);
    put(map, "stiffness_every", json_integer(l->stiffness_every), good);
    put(map, "pictures_every", json_integer(c->pictures_every), good);
    return map;
}
