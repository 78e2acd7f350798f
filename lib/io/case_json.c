/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The resolved case as JSON. JSON is YAML: ph_case_parse reads it back. */
#include "io/case_internal.h"
#include "io/json.h"

#include <jansson.h>

#include <math.h>
#include <string.h>

/* jansson takes NULL for "that failed" and hands it on; only the last call is checked. */
static void put(json_t *object, const char *key, json_t *value, bool *good)
{
    if (json_object_set_new(object, key, value) != 0) *good = false;
}

static void push(json_t *list, json_t *value, bool *good)
{
    if (json_array_append_new(list, value) != 0) *good = false;
}

static json_t *numbers(const double *x, int n, bool *good)
{
    json_t *list = json_array();
    for (int i = 0; i < n; i++)
        push(list, json_real(x[i]), good);
    return list;
}

static json_t *material_to_json(const ph_material *m, bool *good)
{
    json_t *map = json_object();
    if (m->is_void) {
        put(map, "void", json_true(), good);
    } else if (m->is_isotropic) {
        put(map, "E", json_real(m->E), good);
        put(map, "nu", json_real(m->nu), good);
    } else {
        double voigt[36];
        json_t *rows = json_array();
        ph_sym4_to_voigt(&m->stiffness, true, voigt);
        for (int i = 0; i < 6; i++)
            push(rows, numbers(&voigt[6 * i], 6, good), good);
        put(map, "stiffness", rows, good);
    }
    if (!m->is_void && isfinite(m->density))
        put(map, "density", json_real(m->density), good);
    return map;
}

static void put_number(json_t *map, const char *key, double x, bool *good)
{
    if (!isnan(x)) put(map, key, json_real(x), good);
}

static void put_vector(json_t *map, const char *key, const double *x, int n, bool *good)
{
    if (!isnan(x[0])) put(map, key, numbers(x, n, good), good);
}

static json_t *inclusion_to_json(const ph_case *c, const ph_inclusion *inc, int dimension,
                                 bool *good)
{
    json_t *map = json_object();
    bool has_angle = strcmp(inc->shape, "ellipse") == 0 || strcmp(inc->shape, "box") == 0;
    put(map, "shape", json_string(inc->shape), good);
    put_vector(map, "centre", inc->centre, dimension, good);
    put_number(map, "radius", inc->radius, good);
    put_number(map, "fraction", inc->fraction, good);
    put_vector(map, "semi_axes", inc->semi_axes, dimension, good);
    put_vector(map, "size", inc->size, dimension, good);
    if (has_angle) put(map, "angle", json_real(inc->angle), good);
    if (inc->axis[0] != 0 || inc->axis[1] != 0 || inc->axis[2] != 0)
        put(map, "axis", numbers(inc->axis, 3, good), good);
    put_number(map, "length", inc->length, good);
    if (inc->normal) put(map, "normal", json_integer(inc->normal), good);
    put_number(map, "from", inc->from, good);
    put_number(map, "to", inc->to, good);
    put(map, "material", json_string(c->materials[inc->material].name), good);
    return map;
}

static json_t *voxels_to_json(const ph_case *c, bool *good)
{
    const ph_voxels *v = &c->voxels;
    json_t *map = json_object(), *materials = json_object();
    put(map, "file", json_string(v->file), good);
    if (v->dataset[0]) put(map, "dataset", json_string(v->dataset), good);
    if (v->owners[0]) put(map, "owners", json_string(v->owners), good);
    if (v->type[0]) put(map, "type", json_string(v->type), good);
    for (int i = 0; i < v->nmaterials; i++) {
        char value[16];
        snprintf(value, sizeof value, "%d", i);
        if (v->materials[i] >= 0)
            put(materials, value, json_string(c->materials[v->materials[i]].name), good);
    }
    if (c->unit_temperature[0] && isfinite(c->temperature))
        put(map, "temperature", json_real(c->temperature), good);
    put(map, "materials", materials, good);
    return map;
}

static json_t *microstructure_to_json(const ph_case *c, bool *good)
{
    static const char *const plane[] = {"", "generalised_strain", "strain", "stress"};
    int dimension = c->kinematics == PH_SPACE ? 3 : 2;
    json_t *map = json_object(), *nodes = json_array(), *inclusions = json_array(),
           *drawn = json_array();
    put(map, "dimension", json_integer(dimension), good);
    if (dimension == 2) put(map, "plane", json_string(plane[c->kinematics]), good);
    put(map, "size", numbers(c->size, dimension, good), good);
    for (int a = 0; a < dimension; a++)
        push(nodes, json_integer(c->nodes[a]), good);
    for (int i = 0; i < c->ninclusions; i++)
        push(inclusions, inclusion_to_json(c, &c->inclusions[i], dimension, good), good);
    if (c->nodes[0] > 0) put(map, "nodes", json_incref(nodes), good);
    if (c->voxels.file[0]) {
        put(map, "voxels", voxels_to_json(c, good), good);
    } else {
        put(map, "matrix", json_string(c->materials[c->matrix].name), good);
        put(map, "inclusions", json_incref(inclusions), good);
        if (c->nfillers > 0) put(map, "fillers", ph_i_fillers_to_json(c, good), good);
    }
    for (int a = 0; a < dimension; a++)
        push(drawn, json_integer(c->drawn_on[a]), good);
    if (c->drawn_on[0] > 0) put(map, "drawn_on", json_incref(drawn), good);
    json_decref(drawn);
    json_decref(nodes);
    json_decref(inclusions);
    put(map, "interface", json_string(ph_i_interface_names.name[c->interface]), good);
    put(map, "seed", json_integer((json_int_t)c->seed), good);
    if (c->nfillers > 0)
        put(map, "realisation", json_integer((json_int_t)c->realisation), good);
    return map;
}

static json_t *one(const char *key, double x, bool *good)
{
    json_t *map = json_object();
    put(map, key, json_real(x), good);
    return map;
}

static void bond_to_json(const ph_model_params *m, json_t *map, bool *good)
{
    const char *profile = m->micromodulus ? m->micromodulus : "constant";
    put(map, "weights", json_string(m->weights ? m->weights : "exact"), good);
    put(map, "micromodulus",
        strcmp(profile, "power_law") == 0 ? one(profile, m->power, good)
                                          : json_string(profile),
        good);
    put(map, "calibration", json_string(ph_i_calibration_names.name[m->calibration]),
        good);
    if (m->kappa > 0) put(map, "kappa", json_real(m->kappa), good);
}

static json_t *model_to_json(const ph_model_params *m, bool *good)
{
    json_t *map = json_object(), *horizon, *stabilisation;
    if (m->horizon == 0)
        horizon = json_string("auto");
    else if (m->horizon_is_length)
        horizon = one("length", m->horizon, good);
    else
        horizon = json_real(m->horizon);
    put(map, "kind", json_string(m->kind ? m->kind : "nosb"), good);
    if (m->kind && strcmp(m->kind, "bond") == 0) {
        put(map, "horizon", horizon, good);
        bond_to_json(m, map, good);
        return map;
    }
    if (m->stabilisation == PH_STABILISE_SPECTRAL)
        stabilisation = one("spectral", m->stabilisation_value, good);
    else if (m->stabilisation == PH_STABILISE_SUBPOINT)
        stabilisation = one("subpoint", m->stabilisation_value, good);
    else
        stabilisation =
            json_string(m->stabilisation == PH_STABILISE_NONE ? "none" : "auto");
    put(map, "points", json_string(ph_i_points_names.name[m->points]), good);
    put(map, "horizon", horizon, good);
    put(map, "influence", json_string(m->influence ? m->influence : "constant"), good);
    put(map, "weights", json_string(m->weights ? m->weights : "linear"), good);
    put(map, "stabilisation", stabilisation, good);
    return map;
}

static json_t *constraint_to_json(const ph_case *c, bool *good)
{
    const ph_constraint_params *p = &c->constraint;
    json_t *map = json_object();
    const char *kind = p->kind ? p->kind : "periodic";
    put(map, "kind", json_string(kind), good);
    const char *collar = p->collar == PH_COLLAR_PERIODIC ? "periodic" : "inside";
    if (p->collar == PH_COLLAR_MATRIX)
        collar = !c->voxels.file[0] && p->collar_material == c->matrix
                     ? "matrix"
                     : c->materials[p->collar_material].name;
    if (strcmp(kind, "linear_displacement") == 0)
        put(map, "collar", json_string(collar), good);
    return map;
}

static json_t *solver_to_json(const ph_solver_params *s, bool *good)
{
    json_t *map = json_object();
    put(map, "kind", json_string(s->kind ? s->kind : "auto"), good);
    put(map, "tolerance", json_real(s->tolerance > 0 ? s->tolerance : 1e-6), good);
    put(map, "max_iterations",
        json_integer(s->max_iterations > 0 ? s->max_iterations : 2000), good);
    return map;
}

static json_t *case_to_json(const ph_case *c, bool *good)
{
    json_t *map = json_object(), *units = json_object(), *materials = json_object(),
           *output = json_object();
    put(units, "length", json_string(c->unit_length), good);
    put(units, "stress", json_string(c->unit_stress), good);
    put(units, "time", json_string(c->unit_time), good);
    if (c->unit_temperature[0])
        put(units, "temperature", json_string(c->unit_temperature), good);
    for (int i = 0; i < c->nmaterials; i++) {
        const ph_material *m = &c->materials[i];
        bool relaxes = c->relaxation && c->relaxation[i].kind != PH_RELAXATION_NONE;
        put(materials, m->name,
            relaxes ? ph_i_relaxation_to_json(&c->relaxation[i], m->density, good)
                    : material_to_json(m, good),
            good);
    }
    put(output, "fields", json_boolean(c->fields), good);
    put(map, "perihom", json_integer(1), good);
    put(map, "title", json_string(c->title), good);
    put(map, "units", units, good);
    if (c->unit_temperature[0] && isfinite(c->temperature))
        put(map, "temperature", json_real(c->temperature), good);
    put(map, "materials", materials, good);
    put(map, "microstructure", microstructure_to_json(c, good), good);
    put(map, "model", model_to_json(&c->model, good), good);
    put(map, "constraint", constraint_to_json(c, good), good);
    put(map, "solver", solver_to_json(&c->solver, good), good);
    if (c->ncracks > 0) put(map, "cracks", ph_i_cracks_to_json(c, good), good);
    if (c->sequence.kind != PH_SEQUENCE_NONE)
        put(map, "sequence", ph_i_sequence_to_json(c, good), good);
    if (c->failure.material) put(map, "failure", ph_i_failure_to_json(c, good), good);
    if (c->loading.ntargets > 0) put(map, "loading", ph_i_loading_to_json(c, good), good);
    if (c->viscoelastic.given || ph_case_relaxes(c))
        put(map, "viscoelastic", ph_i_viscoelastic_to_json(&c->viscoelastic, good), good);
    put(map, "output", output, good);
    return map;
}

ph_status ph_i_case_json(const ph_case *c, json_t **out, ph_error *err)
{
    ph_status st = PH_OK;
    bool good = true;
    json_t *map = case_to_json(c, &good);
    PH_CHECK(good && map, PH_EINVAL,
             "this case cannot be written: a number is not finite, a "
             "text not UTF-8, or there is no memory");
    *out = map;
    map = NULL;
out:
    json_decref(map);
    return st;
}

ph_status ph_case_to_json(const ph_case *c, char **json, ph_error *err)
{
    PH_GIVEN(c && json);
    ph_status st = PH_OK;
    json_t *map = NULL;
    *json = NULL;
    PH_CHECK(c->materials && c->nmaterials > 0, PH_EINVAL, "the case has no materials");
    PH_TRY(ph_i_case_json(c, &map, err));
    PH_TRY(ph_i_json_dump(map, json, err));
out:
    json_decref(map);
    return st;
}
