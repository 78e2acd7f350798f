/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The sizes of the RVE that were weighed, in campaign.json: no clock in them. */
#include "campaign/sizes.h"
#include "fidelity/fidelity.h"
#include "io/json.h"

#include <math.h>

static json_t *nodes_json(const ptrdiff_t *nodes, int axes, bool *good)
{
    json_t *list = json_array();
    for (int a = 0; a < axes; a++)
        ph_i_json_append(list, json_integer(nodes[a]), good);
    return list;
}

/* A size: what it is, and why it was left out. */
static json_t *size_json(const ph_campaign_size *e, int axes, bool *good)
{
    json_t *map = json_object();
    ph_i_json_set(map, "edge", json_real(e->factor), good);
    ph_i_json_set(map, "size", ph_i_json_numbers(e->size, axes, good), good);
    ph_i_json_set(map, "nodes", nodes_json(e->nodes[0], axes, good), good);
    ph_i_json_set(map, "pilots", json_integer(e->pilots), good);
    ph_i_json_set(map, "left_out", e->reason[0] ? ph_i_json_text(e->reason) : json_null(),
                  good);
    return map;
}

/* What the pilots of a size said of every point. */
static json_t *points_json(const ph_campaign *c, int size, bool *good)
{
    json_t *list = json_array();
    for (int p = 0; p < c->npoints; p++) {
        const ph_split_size *s = &c->sizes->answer->point[size * c->npoints + p];
        json_t *map = json_object();
        ph_i_json_set(map, "pilots", json_integer(s->n), good);
        ph_i_json_set(map, "mean", ph_i_json_number(s->mean), good);
        ph_i_json_set(map, "std", ph_i_json_number(s->deviation), good);
        ph_i_json_set(map, "scatter", ph_i_json_number(s->scatter), good);
        ph_i_json_set(map, "bias", ph_i_json_number(s->bias), good);
        ph_i_json_set(map, "bias_half_width", ph_i_json_number(s->bias_half_width), good);
        ph_i_json_append(list, map, good);
    }
    return list;
}

static json_t *candidate_json(const ph_campaign *c, const ph_split_candidate *x,
                              bool *good)
{
    const ph_campaign_sizes *r = c->sizes;
    const ph_campaign_size *e = &r->size[r->tried[x->size]];
    int axes = ph_i_fidelity_axes(c->point[0].c);
    json_t *map = json_object();
    ph_i_json_set(map, "edge", json_real(e->factor), good);
    ph_i_json_set(map, "nodes", nodes_json(e->nodes[x->grid], axes, good), good);
    ph_i_json_set(map, "meets", json_boolean(x->meets), good);
    ph_i_json_set(map, "bias", ph_i_json_number(x->bias), good);
    ph_i_json_set(map, "bias_half_width", ph_i_json_number(x->bias_half_width), good);
    ph_i_json_set(map, "grid_error", json_real(r->grid_error[x->grid]), good);
    ph_i_json_set(map, "half_width", ph_i_json_number(x->half_width), good);
    ph_i_json_set(map, "error", ph_i_json_number(x->error), good);
    ph_i_json_set(map, "needed", ph_i_json_number(x->needed), good);
    ph_i_json_set(map, "work", ph_i_json_number(x->cost), good);
    ph_i_json_set(map, "work_to_go", ph_i_json_number(x->to_go), good);
    return map;
}

static json_t *answer_json(const ph_campaign *c, json_t *map, int axes, bool *good)
{
    const ph_campaign_sizes *r = c->sizes;
    json_t *pilots = json_array(), *candidates = json_array();
    for (int i = 0; i < r->ntried; i++) {
        json_t *one = size_json(&r->size[r->tried[i]], axes, good);
        ph_i_json_set(one, "points", points_json(c, i, good), good);
        ph_i_json_append(pilots, one, good);
    }
    for (int i = 0; i < r->answer->ncandidates; i++)
        ph_i_json_append(candidates, candidate_json(c, &r->answer->candidate[i], good),
                         good);
    ph_i_json_set(map, "one_scatter", json_boolean(r->answer->one_scatter), good);
    ph_i_json_set(map, "pilots", pilots, good);
    ph_i_json_set(map, "pilot_work", ph_i_json_number(r->answer->pilot_cost), good);
    ph_i_json_set(map, "candidates", candidates, good);
    ph_i_json_set(map, "chosen",
                  r->answer->chosen < 0 ? json_null() : json_integer(r->answer->chosen),
                  good);
    return map;
}

json_t *ph_i_sizes_json(const ph_campaign *c, bool *good)
{
    const ph_campaign_sizes *r = c->sizes;
    int axes = ph_i_fidelity_axes(c->point[0].c);
    json_t *map = json_object(), *out = json_array();
    ph_i_json_set(map, "accuracy", json_real(r->accuracy), good);
    ph_i_json_set(map, "absolute", json_boolean(r->absolute), good);
    ph_i_json_set(map, "exponent", json_real(r->exponent), good);
    for (int i = 0; i < r->n; i++)
        if (r->size[i].reason[0])
            ph_i_json_append(out, size_json(&r->size[i], axes, good), good);
    ph_i_json_set(map, "left_out", out, good);
    ph_i_json_set(map, "why", ph_i_json_text(r->why), good);
    return r->answer ? answer_json(c, map, axes, good) : map;
}
