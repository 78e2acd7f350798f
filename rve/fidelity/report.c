/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Automatic fidelity in the result document. */
#include "fidelity/fidelity.h"
#include "io/json.h"

#include <math.h>

static json_t *nodes_json(const ph_fidelity *f, const ptrdiff_t nodes[3], bool *good)
{
    json_t *list = json_array();
    int axes = ph_i_fidelity_axes(&f->settings);
    for (int a = 0; a < axes; a++)
        ph_i_json_append(list, json_integer(nodes[a]), good);
    return list;
}

static json_t *step_json(const ph_fidelity *f, const ph_fidelity_step *s, bool *good)
{
    json_t *map = json_object(), *values = json_object();
    for (int k = 0; k < f->plan.nconstants; k++)
        ph_i_json_set(values, f->plan.constant[k].name, ph_i_json_number(s->value[k]),
                      good);
    ph_i_json_set(map, "nodes", nodes_json(f, s->nodes, good), good);
    ph_i_json_set(map, "tolerance", json_real(s->tolerance), good);
    ph_i_json_set(map, "values", values, good);
    ph_i_json_set(map, "error", ph_i_json_number(s->estimate), good);
    ph_i_json_set(map, "improved", json_boolean(s->improved), good);
    ph_i_json_set(map, "iterations", json_integer(s->work.iterations), good);
    ph_i_json_set(map, "applications", json_integer(s->work.applications), good);
    ph_i_json_set(map, "ffts", json_integer(s->work.ffts), good);
    ph_i_json_set(map, "peak_bytes", json_integer((json_int_t)s->work.peak_bytes), good);
    ph_i_json_set(map, "operations", json_real(s->operations), good);
    ph_i_json_set(map, "seconds", json_real(s->seconds), good);
    ph_i_json_set(map, "cpu_seconds", json_real(s->cpu), good);
    return map;
}

static json_t *chosen_json(const ph_fidelity *f, bool *good)
{
    json_t *map = json_object();
    const ph_result *r = f->result;
    ph_i_json_set(map, "microstructure.nodes", nodes_json(f, f->nodes, good), good);
    ph_i_json_set(map, "microstructure.interface",
                  json_string(ph_i_interface_names.name[f->settings.interface]), good);
    ph_i_json_set(map, "model.kind", ph_i_json_text(r->model), good);
    ph_i_json_set(map, "model.points", json_string(ph_i_points_names.name[r->points]),
                  good);
    ph_i_json_set(map, "model.horizon", ph_i_json_number(r->horizon), good);
    ph_i_json_set(map, "solver.tolerance", json_real(f->tolerance), good);
    ph_i_json_set(map, "solver.precision", ph_i_json_text(r->precision), good);
    if (f->plan.energy > 0)
        ph_i_json_set(map, "solver.energy", json_real(f->plan.energy), good);
    ph_i_json_set(map, "extrapolated", json_boolean(f->improved), good);
    return map;
}

static json_t *fidelity_json(const ph_fidelity *f, bool *good)
{
    json_t *map = json_object(), *constants = json_array(), *why = json_array(),
           *steps = json_array();
    for (int k = 0; k < f->plan.nconstants; k++)
        ph_i_json_append(constants, json_string(f->plan.constant[k].name), good);
    for (int k = 0; k < f->plan.nwhy; k++)
        ph_i_json_append(why, ph_i_json_text(f->plan.why[k]), good);
    for (int k = 0; k < f->nsteps; k++)
        ph_i_json_append(steps, step_json(f, &f->step[k], good), good);
    ph_i_json_set(map, "accuracy", json_real(f->plan.accuracy), good);
    ph_i_json_set(map, "constants", constants, good);
    ph_i_json_set(map, "reached", json_boolean(f->reached), good);
    ph_i_json_set(map, "error", ph_i_json_number(f->error), good);
    ph_i_json_set(map, "missing",
                  f->missing[0] ? ph_i_json_text(f->missing) : json_null(), good);
    ph_i_json_set(map, "chosen", chosen_json(f, good), good);
    ph_i_json_set(map, "why", why, good);
    ph_i_json_set(map, "steps", steps, good);
    ph_i_json_set(map, "operations", json_real(f->operations), good);
    ph_i_json_set(map, "seconds", json_real(f->seconds), good);
    ph_i_json_set(map, "cpu_seconds", json_real(f->cpu), good);
    return map;
}

ph_status ph_fidelity_to_json(const ph_fidelity *f, const ph_case *c, const char *command,
                              char **json, ph_error *err)
{
    PH_GIVEN(f && json);
    ph_status st = PH_OK;
    json_t *document = NULL;
    bool good = true;
    PH_CHECK(f->result, PH_EINVAL, "there is no result");
    PH_TRY(ph_i_result_document(f->result, c, command, &document, err));
    ph_i_json_set(document, "fidelity", fidelity_json(f, &good), &good);
    PH_CHECK(good, PH_ENOMEM, "no memory for the result document");
    PH_TRY(ph_i_json_dump(document, json, err));
out:
    json_decref(document);
    return st;
}
