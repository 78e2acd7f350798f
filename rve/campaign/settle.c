/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How much of an error the grid may have, and which grid has it. */
#include "fidelity/fidelity.h"

#include <math.h>
#include <string.h>

const char ph_i_grid_words[] =
    "realisations.until.relative_error: the case gives its nodes, and what they are off "
    "is "
    "not known: leave them out (ph_campaign_settle), or ask for relative_half_width, of "
    "the mean on this grid";
static const double least_left = 0.2; /* of the error, for the interval */
/* First try: error of what is offered over that of the grid; halved until the grid is enough. */
static const double extrapolated = 0.8;

static bool any_open(const ph_campaign *c)
{
    for (int p = 0; p < c->npoints; p++)
        if (ph_i_is_open(c->point[p].c)) return true;
    return false;
}

static bool same_box(const ph_case *a, const ph_case *b)
{
    for (int d = 0; d < 3; d++)
        if (a->size[d] != b->size[d]) return false;
    return a->kinematics == b->kinematics;
}

static ph_status check(const ph_campaign *c, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_case *first = c->point[0].c;
    PH_CHECK(c->relative_error > 0 && c->nmodels <= 1, PH_EINVAL, "%s", ph_i_open_words);
    for (int p = 0; p < c->npoints; p++)
        PH_CHECK(
            same_box(c->point[p].c, first), PH_EINVAL,
            "points have boxes of different sizes: one grid does not suit them; give "
            "microstructure.nodes");
out:
    return st;
}

/* Nodes along the longest axis and the error there, of realisation 0 of a point. */
static ph_status pilot(const ph_campaign *c, int point, double wanted, const ph_ctx *ctx,
                       ph_fidelity **out, ph_error *err)
{
    ph_case one = *c->point[point].c; /* borrows the arrays */
    const ph_ctx alone = {ctx ? ctx->progress : NULL, ctx ? ctx->user : NULL, 1};
    int judged = c->judged >= 0 ? c->judged : 0;
    one.accuracy.relative = wanted;
    one.accuracy.nconstants = 1;
    snprintf(one.accuracy.constant[0], sizeof one.accuracy.constant[0], "%s",
             c->output[judged].name);
    one.realisation = ph_campaign_realisation(c, point, 0);
    one.error_parts = 0;
    if (c->seconds > 0) one.accuracy.seconds = c->seconds;
    if (c->memory > 0) one.accuracy.memory = c->memory;
    ph_status st = ph_fidelity_solve(&one, &alone, out, err);
    if (st != PH_OK) ph_error_prefix(err, "point %d: ", point);
    return st;
}

/* Pilots of all points: the finest grid, and the largest error on it. */
static ph_status find_grid(const ph_campaign *c, double wanted, const ph_ctx *ctx,
                           ph_campaign_split *s, ph_error *err)
{
    ph_status st = PH_OK;
    ph_fidelity *f = NULL;
    double slope = 0, finest = 0;
    for (int p = 0; p < c->npoints; p++) {
        PH_TRY(pilot(c, p, wanted, ctx, &f, err));
        double n = (double)ph_i_fidelity_longest(f->nodes);
        slope = fmax(slope, f->grid_error * n);
        if (n > finest) memcpy(s->nodes, f->nodes, sizeof s->nodes);
        finest = fmax(finest, n);
        s->pilots++;
        s->seconds += f->seconds;
        ph_fidelity_free(&f);
    }
    s->grid = slope / finest; /* realisations are not extrapolated */
out:
    ph_fidelity_free(&f);
    return st;
}

ph_status ph_i_campaign_reread(const ph_campaign *c, const char *const *sets,
                               size_t nsets, const char *const *more, size_t nmore,
                               ph_campaign **out, ph_error *err)
{
    ph_status st = PH_OK;
    const char **all = NULL;
    PH_ALLOC(all, nsets + nmore, "overrides");
    for (size_t i = 0; i < nsets + nmore; i++)
        all[i] = i < nsets ? sets[i] : more[i - nsets];
    PH_TRY(ph_campaign_read(c->path, all, nsets + nmore, out, NULL, err));
    (*out)->stopping = c->stopping;
    (*out)->grid_error = c->grid_error;
    (*out)->seconds = c->seconds;
    (*out)->memory = c->memory;
out:
    free(all);
    return st;
}

/* "microstructure.nodes=[128, 128]" */
void ph_i_grid_set(const char *key, const ptrdiff_t *nodes, int axes, char *text,
                   size_t size)
{
    size_t at = (size_t)snprintf(text, size, "microstructure.%s=[", key);
    for (int a = 0; a < axes && at < size; a++)
        at += (size_t)snprintf(text + at, size - at, "%s%td", a ? ", " : "", nodes[a]);
    if (at < size) snprintf(text + at, size - at, "]");
}

/* The campaign once more, with these nodes. */
static ph_status read_again(ph_campaign **c, const char *const *sets, size_t nsets,
                            const ph_campaign_split *s, ph_error *err)
{
    ph_status st = PH_OK;
    ph_campaign *next = NULL;
    char nodes[96];
    const char *const more[] = {nodes};
    ph_i_grid_set("nodes", s->nodes, ph_i_fidelity_axes((*c)->point[0].c), nodes,
                  sizeof nodes);
    PH_TRY(ph_i_campaign_reread(*c, sets, nsets, more, 1, &next, err));
    next->stopping.relative_half_width = s->half_width;
    next->grid_error = s->grid;
    ph_campaign_free(c);
    *c = next;
out:
    return st;
}

ph_status ph_campaign_settle(ph_campaign **c, const char *const *sets, size_t nsets,
                             const ph_ctx *ctx, ph_campaign_split *out, ph_error *err)
{
    PH_GIVEN(c && *c && out && (sets || nsets == 0));
    ph_status st = PH_OK;
    ph_campaign_split s = {.accuracy = (*c)->relative_error};
    if (!any_open(*c)) {
        *out = s;
        return PH_OK;
    }
    PH_TRY(check(*c, err));
    int axes = ph_i_fidelity_axes((*c)->point[0].c);
    double share = s.accuracy * axes / (axes + 2);
    /* What a pilot offers is extrapolated; a realisation has the whole error of its grid. */
    double wanted = extrapolated * share;
    do {
        s.pilots = 0;
        PH_TRY(find_grid(*c, wanted, ctx, &s, err));
        wanted *= 0.5;
    } while (s.grid > (1 - least_left) * s.accuracy);
    s.half_width = s.accuracy - s.grid;
    PH_TRY(read_again(c, sets, nsets, &s, err));
    *out = s;
out:
    return st;
}
