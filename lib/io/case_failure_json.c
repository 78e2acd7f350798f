/* SPDX-License-Identifier: GPL-3.0-or-later */
/* failure and loading of the resolved case; ph_i_read_failure reads them back. */
#include "io/case_internal.h"
#include "io/json.h"

#include <math.h>

static json_t *rule(const ph_failure_rule *k, bool *good)
{
    if (k->criterion == PH_UNBREAKABLE) return json_string("unbreakable");
    const ph_failure_criterion *c = &ph_failure_criteria[k->criterion];
    json_t *map = json_object();
    if (isnan(k->value)) {
        ph_i_json_set(map, "fracture_energy", json_real(k->fracture_energy), good);
        ph_i_json_set(map, "criterion", json_string(c->info.name), good);
    } else {
        ph_i_json_set(map, c->key, json_real(k->value), good);
    }
    if (k->weibull > 0.0) ph_i_json_set(map, "weibull", json_real(k->weibull), good);
    return map;
}

json_t *ph_i_failure_to_json(const ph_case *c, bool *good)
{
    json_t *map = json_object();
    const ph_failure *f = &c->failure;
    for (int i = 0; i < c->nmaterials; i++)
        if (f->material[i].given)
            ph_i_json_set(map, c->materials[i].name, rule(&f->material[i], good), good);
    if (f->interphase.given)
        ph_i_json_set(map, "interphase", rule(&f->interphase, good), good);
    if (f->agglomeration.given)
        ph_i_json_set(map, "agglomeration", rule(&f->agglomeration, good), good);
    return map;
}

static json_t *free_components(const ph_case *c, bool *good)
{
    static const char *const name[2][6] = {{"11", "22", "12"},
                                           {"11", "22", "33", "23", "13", "12"}};
    json_t *list = json_array();
    int ns = ph_strains(c->kinematics);
    for (int i = 0; i < ns; i++)
        if (c->loading.stress_free >> i & 1)
            ph_i_json_append(list, json_string(name[ns == 6][i]), good);
    return list;
}

json_t *ph_i_loading_to_json(const ph_case *c, bool *good)
{
    const ph_loading *l = &c->loading;
    json_t *map = json_object();
    ph_i_json_set(map, l->by_stress ? "stress" : "strain",
                  ph_i_json_numbers(l->strain, ph_strains(c->kinematics), good), good);
    if (l->stress_free) ph_i_json_set(map, "stress_free", free_components(c, good), good);
    ph_i_json_set(map, "to", ph_i_json_numbers(l->to, l->ntargets, good), good);
    if (l->times)
        ph_i_json_set(map, "times", ph_i_json_numbers(l->times, l->ntargets, good), good);
    ph_i_json_set(map, "steps", json_integer(l->steps), good);
    ph_i_json_set(map, "window", json_real(l->window), good);
    ph_i_json_set(map, "break", json_string(l->together ? "together" : "events"), good);
    ph_i_json_set(map, "equilibrium",
                  json_string(l->every_event ? "every_event" : "patches"), good);
    ph_i_json_set(map, "stiffness_every", json_integer(l->stiffness_every), good);
    ph_i_json_set(map, "pictures_every", json_integer(c->pictures_every), good);
    return map;
}
