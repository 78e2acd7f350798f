/* SPDX-License-Identifier: GPL-3.0-or-later */
/* microstructure.fillers of the resolved case; ph_i_read_fillers reads it back. */
#include "io/case_internal.h"
#include "io/json.h"

#include <math.h>
#include <string.h>

json_t *ph_i_distribution_to_json(const ph_distribution *d, bool *good)
{
    const ph_distribution_kind *kind = &ph_distributions[d->kind];
    if (strcmp(kind->info.name, "constant") == 0) return json_real(d->p[0]);
    json_t *map = json_object(), *parameters = json_object();
    if (d->n > 0) {
        ph_i_json_set(parameters, "values", ph_i_json_numbers(d->value, d->n, good),
                      good);
        ph_i_json_set(parameters, "weights", ph_i_json_numbers(d->weight, d->n, good),
                      good);
    } else {
        for (int i = 0; i < PH_DISTRIBUTION_KEYS && kind->keys[i]; i++)
            ph_i_json_set(parameters, kind->keys[i], json_real(d->p[i]), good);
        if (isfinite(d->min) && kind->truncates)
            ph_i_json_set(parameters, "min", json_real(d->min), good);
        if (isfinite(d->max) && kind->truncates)
            ph_i_json_set(parameters, "max", json_real(d->max), good);
    }
    ph_i_json_set(map, kind->info.name, parameters, good);
    return map;
}

static void put_distribution(json_t *map, const char *key, const ph_distribution *d,
                             bool *good)
{
    if (d->kind >= 0) ph_i_json_set(map, key, ph_i_distribution_to_json(d, good), good);
}

static json_t *curvature(const ph_filler *f, bool *good)
{
    static const char *const key[] = {"", "arc_angle", "radius", "helix",
                                      "persistence_length"};
    json_t *map = json_object();
    if (f->curvature == PH_CURVATURE_HELIX) {
        json_t *helix = json_object();
        put_distribution(helix, "radius", &f->bend, good);
        put_distribution(helix, "pitch", &f->pitch, good);
        ph_i_json_set(map, "helix", helix, good);
    } else {
        put_distribution(map, key[f->curvature], &f->bend, good);
    }
    return map;
}

static json_t *orientation(const ph_filler *f, int dimension, bool *good)
{
    if (f->orientation == PH_ORIENT_UNIFORM) return json_string("uniform");
    json_t *map = json_object(), *inner = json_object(), *rows = json_array();
    if (f->orientation == PH_ORIENT_TENSOR) {
        for (int i = 0; i < dimension; i++)
            if (json_array_append_new(
                    rows, ph_i_json_numbers(&f->tensor[3 * i], dimension, good)))
                *good = false;
        ph_i_json_set(map, "tensor", json_incref(rows), good);
    } else {
        bool aligned = f->orientation == PH_ORIENT_ALIGNED;
        ph_i_json_set(inner, "axis", ph_i_json_numbers(f->axis, dimension, good), good);
        ph_i_json_set(inner, aligned ? "spread" : "concentration",
                      json_real(aligned ? f->spread : f->concentration), good);
        ph_i_json_set(map, aligned ? "aligned" : "von_mises_fisher", json_incref(inner),
                      good);
    }
    json_decref(rows);
    json_decref(inner);
    return map;
}

static json_t *placement(const ph_filler *f, bool *good)
{
    json_t *map = json_object();
    if (isnan(f->gap))
        ph_i_json_set(map, "overlap", json_true(), good);
    else
        ph_i_json_set(map, "gap", json_real(f->gap), good);
    if (f->clusters > 0) {
        json_t *clusters = json_object();
        ph_i_json_set(clusters, "count", json_integer(f->clusters), good);
        ph_i_json_set(clusters, "radius", json_real(f->cluster_radius), good);
        ph_i_json_set(clusters, "share", json_real(f->cluster_share), good);
        ph_i_json_set(map, "clusters", clusters, good);
    }
    return map;
}

static json_t *filler(const ph_case *c, const ph_filler *f, int dimension, bool *good)
{
    json_t *map = json_object();
    ph_i_json_set(map, "shape", json_string(f->shape), good);
    ph_i_json_set(map, "material", json_string(c->materials[f->material].name), good);
    ph_i_json_set(map, ph_i_amount_names.name[f->amount],
                  f->amount == PH_AMOUNT_COUNT ? json_integer((json_int_t)f->amount_value)
                                               : json_real(f->amount_value),
                  good);
    ph_i_json_set(map, "counting", json_string(ph_i_counting_names.name[f->counting]),
                  good);
    put_distribution(map, "thickness", &f->thickness, good);
    put_distribution(map, "aspect_ratio", &f->aspect_ratio, good);
    put_distribution(map, "length", &f->length, good);
    put_distribution(map, "size", &f->size, good);
    put_distribution(map, "width", &f->width, good);
    if (f->disc) ph_i_json_set(map, "outline", json_string("disc"), good);
    if (f->curvature != PH_CURVATURE_NONE)
        ph_i_json_set(map, "curvature", curvature(f, good), good);
    ph_i_json_set(map, "orientation", orientation(f, dimension, good), good);
    ph_i_json_set(map, "placement", placement(f, good), good);
    if (f->interphase_kappa > 0 || f->interphase_thickness > 0) {
        json_t *layer = json_object();
        if (f->interphase_kappa > 0) {
            ph_i_json_set(layer, "kappa", json_real(f->interphase_kappa), good);
        } else {
            ph_i_json_set(layer, "thickness", json_real(f->interphase_thickness), good);
            ph_i_json_set(layer, "material",
                          json_string(c->materials[f->interphase_material].name), good);
        }
        ph_i_json_set(map, "interphase", layer, good);
    }
    return map;
}

json_t *ph_i_fillers_to_json(const ph_case *c, bool *good)
{
    json_t *list = json_array();
    int dimension = c->kinematics == PH_SPACE ? 3 : 2;
    for (int i = 0; i < c->nfillers; i++)
        if (json_array_append_new(list, filler(c, &c->fillers[i], dimension, good)) != 0)
            *good = false;
    return list;
}
