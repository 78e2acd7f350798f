/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The resolved case as JSON. JSON is YAML: ph_case_parse reads it back. */
#include "io/case_internal.h"
#include "io/json.h"

#include <jansson.h>

#include <errno.h>
#include <math.h>
#include <string.h>

static json_t *material_to_json(const ph_material *m, bool *good)
{
    json_t *map = json_object();
    if (m->is_void) {
        ph_i_json_set(map, "void", json_true(), good);
    } else if (m->is_isotropic) {
        ph_i_json_set(map, "E", json_real(m->E), good);
        ph_i_json_set(map, "nu", json_real(m->nu), good);
    } else {
        double voigt[36];
        json_t *rows = json_array();
        ph_sym4_to_voigt(&m->stiffness, true, voigt);
        for (int i = 0; i < 6; i++)
            ph_i_json_append(rows, ph_i_json_numbers(&voigt[6 * i], 6, good), good);
        ph_i_json_set(map, "stiffness", rows, good);
    }
    if (!m->is_void && isfinite(m->density))
        ph_i_json_set(map, "density", json_real(m->density), good);
    return map;
}

static void put_number(json_t *map, const char *key, double x, bool *good)
{
    if (!isnan(x)) ph_i_json_set(map, key, json_real(x), good);
}

static void put_vector(json_t *map, const char *key, const double *x, int n, bool *good)
{
    if (!isnan(x[0])) ph_i_json_set(map, key, ph_i_json_numbers(x, n, good), good);
}

static json_t *inclusion_to_json(const ph_case *c, const ph_inclusion *inc, int dimension,
                                 bool *good)
{
    json_t *map = json_object();
    bool has_angle = strcmp(inc->shape, "ellipse") == 0 || strcmp(inc->shape, "box") == 0;
    ph_i_json_set(map, "shape", json_string(inc->shape), good);
    put_vector(map, "centre", inc->centre, dimension, good);
    put_number(map, "radius", inc->radius, good);
    put_number(map, "fraction", inc->fraction, good);
    put_vector(map, "semi_axes", inc->semi_axes, dimension, good);
    put_vector(map, "size", inc->size, dimension, good);
    if (has_angle) ph_i_json_set(map, "angle", json_real(inc->angle), good);
    if (inc->axis[0] != 0 || inc->axis[1] != 0 || inc->axis[2] != 0)
        ph_i_json_set(map, "axis", ph_i_json_numbers(inc->axis, 3, good), good);
    put_number(map, "length", inc->length, good);
    if (inc->normal) ph_i_json_set(map, "normal", json_integer(inc->normal), good);
    put_number(map, "from", inc->from, good);
    put_number(map, "to", inc->to, good);
    ph_i_json_set(map, "material", json_string(c->materials[inc->material].name), good);
    return map;
}

static json_t *voxels_to_json(const ph_case *c, bool *good)
{
    const ph_voxels *v = &c->voxels;
    json_t *map = json_object(), *materials = json_object();
    ph_i_json_set(map, "file", json_string(v->file), good);
    if (v->dataset[0]) ph_i_json_set(map, "dataset", json_string(v->dataset), good);
    if (v->owners[0]) ph_i_json_set(map, "owners", json_string(v->owners), good);
    if (v->type[0]) ph_i_json_set(map, "type", json_string(v->type), good);
    for (int i = 0; i < v->nmaterials; i++) {
        char value[16];
        snprintf(value, sizeof value, "%d", i);
        if (v->materials[i] >= 0)
            ph_i_json_set(materials, value,
                          json_string(c->materials[v->materials[i]].name), good);
    }
    if (c->unit_temperature[0] && isfinite(c->temperature))
        ph_i_json_set(map, "temperature", json_real(c->temperature), good);
    ph_i_json_set(map, "materials", materials, good);
    return map;
}

static json_t *microstructure_to_json(const ph_case *c, bool *good)
{
    static const char *const plane[] = {"", "generalised_strain", "strain", "stress"};
    int dimension = c->kinematics == PH_SPACE ? 3 : 2;
    json_t *map = json_object(), *nodes = json_array(), *inclusions = json_array(),
           *drawn = json_array();
    ph_i_json_set(map, "dimension", json_integer(dimension), good);
    if (dimension == 2)
        ph_i_json_set(map, "plane", json_string(plane[c->kinematics]), good);
    ph_i_json_set(map, "size", ph_i_json_numbers(c->size, dimension, good), good);
    for (int a = 0; a < dimension; a++)
        ph_i_json_append(nodes, json_integer(c->nodes[a]), good);
    for (int i = 0; i < c->ninclusions; i++)
        ph_i_json_append(inclusions,
                         inclusion_to_json(c, &c->inclusions[i], dimension, good), good);
    if (c->nodes[0] > 0) ph_i_json_set(map, "nodes", json_incref(nodes), good);
    if (c->voxels.file[0]) {
        ph_i_json_set(map, "voxels", voxels_to_json(c, good), good);
    } else {
        ph_i_json_set(map, "matrix", json_string(c->materials[c->matrix].name), good);
        ph_i_json_set(map, "inclusions", json_incref(inclusions), good);
        if (c->nfillers > 0)
            ph_i_json_set(map, "fillers", ph_i_fillers_to_json(c, good), good);
    }
    for (int a = 0; a < dimension; a++)
        ph_i_json_append(drawn, json_integer(c->drawn_on[a]), good);
    if (c->drawn_on[0] > 0) ph_i_json_set(map, "drawn_on", json_incref(drawn), good);
    json_decref(drawn);
    json_decref(nodes);
    json_decref(inclusions);
    ph_i_json_set(map, "interface", json_string(ph_i_interface_names.name[c->interface]),
                  good);
    ph_i_json_set(map, "seed", json_integer((json_int_t)c->seed), good);
    if (c->nfillers > 0)
        ph_i_json_set(map, "realisation", json_integer((json_int_t)c->realisation), good);
    return map;
}

static json_t *one(const char *key, double x, bool *good)
{
    json_t *map = json_object();
    ph_i_json_set(map, key, json_real(x), good);
    return map;
}

static void bond_to_json(const ph_model_params *m, json_t *map, bool *good)
{
    const char *profile = m->micromodulus ? m->micromodulus : "constant";
    ph_i_json_set(map, "weights", json_string(m->weights ? m->weights : "exact"), good);
    ph_i_json_set(map, "micromodulus",
                  strcmp(profile, "power_law") == 0 ? one(profile, m->power, good)
                                                    : json_string(profile),
                  good);
    ph_i_json_set(map, "calibration",
                  json_string(ph_i_calibration_names.name[m->calibration]), good);
    if (m->kappa > 0) ph_i_json_set(map, "kappa", json_real(m->kappa), good);
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
    ph_i_json_set(map, "kind", json_string(m->kind ? m->kind : "nosb"), good);
    if (m->crack_tips > 0)
        ph_i_json_set(map, "crack_tips", json_real(m->crack_tips), good);
    if (m->kind && strcmp(m->kind, "bond") == 0) {
        ph_i_json_set(map, "horizon", horizon, good);
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
    ph_i_json_set(map, "points", json_string(ph_i_points_names.name[m->points]), good);
    ph_i_json_set(map, "horizon", horizon, good);
    ph_i_json_set(map, "influence", json_string(m->influence ? m->influence : "constant"),
                  good);
    ph_i_json_set(map, "weights", json_string(m->weights ? m->weights : "linear"), good);
    ph_i_json_set(map, "stabilisation", stabilisation, good);
    return map;
}

static json_t *constraint_to_json(const ph_case *c, bool *good)
{
    const ph_constraint_params *p = &c->constraint;
    json_t *map = json_object();
    const char *kind = p->kind ? p->kind : "periodic";
    ph_i_json_set(map, "kind", json_string(kind), good);
    const char *collar = p->collar == PH_COLLAR_PERIODIC ? "periodic" : "inside";
    if (p->collar == PH_COLLAR_MATRIX)
        collar = !c->voxels.file[0] && p->collar_material == c->matrix
                     ? "matrix"
                     : c->materials[p->collar_material].name;
    if (strcmp(kind, "linear_displacement") == 0)
        ph_i_json_set(map, "collar", json_string(collar), good);
    return map;
}

static json_t *solver_to_json(const ph_solver_params *s, bool *good)
{
    json_t *map = json_object();
    ph_i_json_set(map, "kind", json_string(s->kind ? s->kind : "auto"), good);
    ph_i_json_set(map, "tolerance", json_real(s->tolerance > 0 ? s->tolerance : 1e-6),
                  good);
    if (s->energy > 0) ph_i_json_set(map, "energy", json_real(s->energy), good);
    ph_i_json_set(map, "max_iterations",
                  json_integer(s->max_iterations > 0 ? s->max_iterations : 2000), good);
    ph_i_json_set(map, "precision", json_string(s->precision ? s->precision : "double"),
                  good);
    return map;
}

static json_t *case_to_json(const ph_case *c, bool *good)
{
    json_t *map = json_object(), *units = json_object(), *materials = json_object();
    ph_i_json_set(units, "length", json_string(c->unit_length), good);
    ph_i_json_set(units, "stress", json_string(c->unit_stress), good);
    ph_i_json_set(units, "time", json_string(c->unit_time), good);
    if (c->unit_temperature[0])
        ph_i_json_set(units, "temperature", json_string(c->unit_temperature), good);
    for (int i = 0; i < c->nmaterials; i++) {
        const ph_material *m = &c->materials[i];
        bool relaxes = c->relaxation && c->relaxation[i].kind != PH_RELAXATION_NONE;
        ph_i_json_set(materials, m->name,
                      relaxes
                          ? ph_i_relaxation_to_json(&c->relaxation[i], m->density, good)
                          : material_to_json(m, good),
                      good);
    }
    ph_i_json_set(map, "perihom", json_integer(1), good);
    ph_i_json_set(map, "title", json_string(c->title), good);
    ph_i_json_set(map, "units", units, good);
    if (c->unit_temperature[0] && isfinite(c->temperature))
        ph_i_json_set(map, "temperature", json_real(c->temperature), good);
    ph_i_json_set(map, "materials", materials, good);
    ph_i_json_set(map, "microstructure", microstructure_to_json(c, good), good);
    ph_i_json_set(map, "model", model_to_json(&c->model, good), good);
    ph_i_json_set(map, "constraint", constraint_to_json(c, good), good);
    ph_i_json_set(map, "solver", solver_to_json(&c->solver, good), good);
    if (c->ncracks > 0) ph_i_json_set(map, "cracks", ph_i_cracks_to_json(c, good), good);
    if (c->sequence.kind != PH_SEQUENCE_NONE)
        ph_i_json_set(map, "sequence", ph_i_sequence_to_json(c, good), good);
    if (c->failure.material)
        ph_i_json_set(map, "failure", ph_i_failure_to_json(c, good), good);
    if (c->loading.ntargets > 0)
        ph_i_json_set(map, "loading", ph_i_loading_to_json(c, good), good);
    if (c->viscoelastic.given || ph_case_relaxes(c))
        ph_i_json_set(map, "viscoelastic",
                      ph_i_viscoelastic_to_json(&c->viscoelastic, good), good);
    ph_i_json_set(map, "output", ph_i_output_to_json(c, good), good);
    ph_i_json_set(map, "error_bar", ph_i_error_bar_to_json(c, good), good);
    ph_i_accuracy_to_json(c, map, good);
    return map;
}

ph_status ph_i_case_json(const ph_case *c, json_t **out, ph_error *err)
{
    ph_status st = PH_OK;
    bool good = true;
    errno = 0; /* jansson gives NULL for either reason; malloc says which */
    json_t *map = case_to_json(c, &good);
    PH_CHECK((good && map) || errno != ENOMEM, PH_ENOMEM,
             "no memory for the JSON of the case");
    PH_CHECK(good && map, PH_EINVAL,
             "this case cannot be written: a number is not finite or a text not UTF-8");
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
