/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cracks and sequence of the resolved case; ph_i_read_cracks reads them back. */
#include "io/case_internal.h"
#include "io/json.h"

#include <math.h>

static json_t *points(const ph_crack_entry *k, int dimension, bool *good)
{
    json_t *list = json_array();
    for (ptrdiff_t i = 0; i < k->npoints; i++)
        ph_i_json_append(list, ph_i_json_numbers(k->point[i], dimension, good), good);
    return list;
}

static json_t *ellipse(const ph_crack_entry *k, bool *good)
{
    json_t *map = json_object();
    ph_i_json_set(map, "centre", ph_i_json_numbers(k->centre, 3, good), good);
    ph_i_json_set(map, "normal", ph_i_json_numbers(k->normal, 3, good), good);
    if (k->disk) {
        ph_i_json_set(map, "radius", json_real(k->semi_axes[0]), good);
    } else {
        ph_i_json_set(map, "axis", ph_i_json_numbers(k->axis, 3, good), good);
        ph_i_json_set(map, "semi_axes", ph_i_json_numbers(k->semi_axes, 2, good), good);
    }
    return map;
}

static json_t *population(const ph_crack_entry *k, int dimension, bool *good)
{
    json_t *map = json_object();
    if (k->count >= 0)
        ph_i_json_set(map, "count", json_integer(k->count), good);
    else
        ph_i_json_set(map, "density", json_real(k->density), good);
    ph_i_json_set(map, "length", ph_i_distribution_to_json(&k->length, good), good);
    ph_i_json_set(map, "orientation", json_string(k->aligned ? "aligned" : "random"),
                  good);
    if (k->aligned && dimension == 2)
        ph_i_json_set(map, "angle", json_real(k->angle), good);
    if (k->aligned && dimension == 3)
        ph_i_json_set(map, "normal", ph_i_json_numbers(k->normal, 3, good), good);
    return map;
}

json_t *ph_i_cracks_to_json(const ph_case *c, bool *good)
{
    int dimension = c->kinematics == PH_SPACE ? 3 : 2;
    json_t *list = json_array();
    for (ptrdiff_t i = 0; i < c->ncracks; i++) {
        const ph_crack_entry *k = &c->cracks[i];
        json_t *map = json_object();
        if (k->kind == PH_CRACKS_LINE)
            ph_i_json_set(map, "points", points(k, dimension, good), good);
        else if (k->kind == PH_CRACKS_POLYGON)
            ph_i_json_set(map, "polygon", points(k, dimension, good), good);
        else if (k->kind == PH_CRACKS_ELLIPSE)
            ph_i_json_set(map, k->disk ? "disk" : "ellipse", ellipse(k, good), good);
        else
            ph_i_json_set(map, "random", population(k, dimension, good), good);
        ph_i_json_append(list, map, good);
    }
    return list;
}

static json_t *growth(const ph_sequence_entry *q, bool *good)
{
    json_t *map = json_object(), *which = json_array(), *list = json_object();
    for (ptrdiff_t i = 0; i < q->nwhich; i++)
        ph_i_json_append(which, json_integer(q->which[i]), good);
    ph_i_json_set(map, "crack", q->nwhich ? json_incref(which) : json_string("all"),
                  good);
    ph_i_json_set(map, "tip", json_string(ph_i_tip_names.name[q->tip]), good);
    if (isnan(q->range[0])) {
        ph_i_json_set(list, "list", ph_i_json_numbers(q->value, q->nsteps, good), good);
        ph_i_json_set(map, "lengths", json_incref(list), good);
    } else {
        ph_i_json_set(map, "lengths", ph_i_json_numbers(q->range, 3, good), good);
    }
    json_decref(which);
    json_decref(list);
    return map;
}

json_t *ph_i_sequence_to_json(const ph_case *c, bool *good)
{
    const ph_sequence_entry *q = &c->sequence;
    json_t *map = json_object();
    if (q->kind == PH_SEQUENCE_GROWTH)
        ph_i_json_set(map, "crack_growth", growth(q, good), good);
    else
        ph_i_json_set(map, "density", ph_i_json_numbers(q->value, q->nsteps, good), good);
    return map;
}
