/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cracks and sequence of the resolved case; ph_i_read_cracks reads them back. */
#include "io/case_internal.h"
#include "io/json.h"

#include <math.h>

static void put(json_t *object, const char *key, json_t *value, bool *good)
{
    if (json_object_set_new(object, key, value) != 0) *good = false;
}

static void push(json_t *list, json_t *value, bool *good)
{
    if (json_array_append_new(list, value) != 0) *good = false;
}

static json_t *numbers(const double *x, ptrdiff_t n, bool *good)
{
    json_t *list = json_array();
    for (ptrdiff_t i = 0; i < n; i++)
        push(list, json_real(x[i]), good);
    return list;
}

static json_t *points(const ph_crack_entry *k, int dimension, bool *good)
{
    json_t *list = json_array();
    for (ptrdiff_t i = 0; i < k->npoints; i++)
        push(list, numbers(k->point[i], dimension, good), good);
    return list;
}

static json_t *ellipse(const ph_crack_entry *k, bool *good)
{
    json_t *map = json_object();
    put(map, "centre", numbers(k->centre, 3, good), good);
    put(map, "normal", numbers(k->normal, 3, good), good);
    if (k->disk) {
        put(map, "radius", json_real(k->semi_axes[0]), good);
    } else {
        put(map, "axis", numbers(k->axis, 3, good), good);
        put(map, "semi_axes", numbers(k->semi_axes, 2, good), good);
    }
    return map;
}

static json_t *population(const ph_crack_entry *k, int dimension, bool *good)
{
    json_t *map = json_object();
    if (k->count >= 0)
        put(map, "count", json_integer(k->count), good);
    else
        put(map, "density", json_real(k->density), good);
    put(map, "length", ph_i_distribution_to_json(&k->length, good), good);
    put(map, "orientation", json_string(k->aligned ? "aligned" : "random"), good);
    if (k->aligned && dimension == 2) put(map, "angle", json_real(k->angle), good);
    if (k->aligned && dimension == 3)
        put(map, "normal", numbers(k->normal, 3, good), good);
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
            put(map, "points", points(k, dimension, good), good);
        else if (k->kind == PH_CRACKS_POLYGON)
            put(map, "polygon", points(k, dimension, good), good);
        else if (k->kind == PH_CRACKS_ELLIPSE)
            put(map, k->disk ? "disk" : "ellipse", ellipse(k, good), good);
        else
            put(map, "random", population(k, dimension, good), good);
        push(list, map, good);
    }
    return list;
}

static json_t *growth(const ph_sequence_entry *q, bool *good)
{
    json_t *map = json_object(), *which = json_array(), *list = json_object();
    for (ptrdiff_t i = 0; i < q->nwhich; i++)
        push(which, json_integer(q->which[i]), good);
    put(map, "crack", q->nwhich ? json_incref(which) : json_string("all"), good);
    put(map, "tip", json_string(ph_i_tip_names.name[q->tip]), good);
    if (isnan(q->range[0])) {
        put(list, "list", numbers(q->value, q->nsteps, good), good);
        put(map, "lengths", json_incref(list), good);
    } else {
        put(map, "lengths", numbers(q->range, 3, good), good);
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
        put(map, "crack_growth", growth(q, good), good);
    else
        put(map, "density", numbers(q->value, q->nsteps, good), good);
    return map;
}
