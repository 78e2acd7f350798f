/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which two models of a point tell what its grid adds: they differ in nothing else. */
#include "campaign/campaign.h"
#include "io/json.h"

#include <math.h>
#include <string.h>

/* Ratios of nodes or horizons that differ by less are one: 151 nodes are halved to 76. */
static const double alike = 0.05;

static const ph_case *model_case(const ph_campaign *c, int point, int m)
{
    return m ? c->point[point].model[m] : c->point[point].c;
}

/* One ratio of spacings, coarse over fine, on all axes; 0: there is none above 1. */
static double ratio_of(const ph_case *fine, const ph_case *coarse)
{
    double least = INFINITY, most = 0;
    for (int a = 0; a < 3; a++) {
        if (fine->nodes[a] <= 1 && coarse->nodes[a] <= 1) continue;
        if (coarse->nodes[a] < 1) return 0;
        double r = (double)fine->nodes[a] / (double)coarse->nodes[a];
        least = fmin(least, r);
        most = fmax(most, r);
    }
    bool one = least > 1 + alike && most <= least * (1 + alike);
    return one ? sqrt(least * most) : 0;
}

static bool same_grid(const ph_case *a, const ph_case *b)
{
    return memcmp(a->nodes, b->nodes, sizeof a->nodes) == 0;
}

/* Fillers are drawn on nodes where nothing else is said. */
static bool same_drawing(const ph_case *a, const ph_case *b)
{
    if (a->nfillers == 0 && b->nfillers == 0) return true;
    return memcmp(a->drawn_on[0] ? a->drawn_on : a->nodes,
                  b->drawn_on[0] ? b->drawn_on : b->nodes, sizeof a->nodes) == 0;
}

/* A grid coarser than the drawing shows other fillers: what it is off says nothing of the
 * finer ones (docs/theory/multilevel.md). */
static bool shows_drawing(const ph_case *c)
{
    bool shows = true;
    for (int a = 0; a < 3; a++)
        shows = shows && c->nodes[a] >= c->drawn_on[a];
    return shows || c->nfillers == 0;
}

/* As many spacings, or as long. */
static bool same_horizon(const ph_case *fine, const ph_case *coarse, double ratio)
{
    double a = fine->model.horizon, b = coarse->model.horizon;
    if (fine->model.horizon_is_length != coarse->model.horizon_is_length) return false;
    if (a == b) return true;
    return !fine->model.horizon_is_length && fabs(b * ratio / a - 1) < alike;
}

/* What is left of a case without its grid, and (solver) how it is solved. */
static ph_status rest_of(const ph_case *c, bool solver, json_t **out, ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(ph_i_case_json(c, out, err));
    json_t *micro = json_object_get(*out, "microstructure");
    json_object_del(micro, "nodes");
    json_object_del(micro, "drawn_on");
    json_object_del(json_object_get(*out, "model"), "horizon");
    if (!solver) json_object_del(*out, "solver");
out:
    return st;
}

static ph_status same_rest(const ph_case *a, const ph_case *b, bool solver, bool *same,
                           ph_error *err)
{
    ph_status st = PH_OK;
    json_t *x = NULL, *y = NULL;
    PH_TRY(rest_of(a, solver, &x, err));
    PH_TRY(rest_of(b, solver, &y, err));
    *same = json_equal(x, y);
out:
    json_decref(x);
    json_decref(y);
    return st;
}

/* The case as it is, or solved less accurately. */
static ph_status is_fine(const ph_case *one, const ph_case *fine, bool *yes,
                         ph_error *err)
{
    *yes = same_grid(one, fine) && same_drawing(one, fine) &&
           one->model.horizon == fine->model.horizon &&
           one->model.horizon_is_length == fine->model.horizon_is_length;
    return *yes ? same_rest(one, fine, false, yes, err) : PH_OK;
}

static bool is_replaced(const ph_campaign *c, int k)
{
    return strcmp(c->cheap[k].name, c->output[k].name) != 0;
}

/* The pair nearest to the case, in this order: solved like it, next finer grid. Its models must
 * compute the same: those from 1 on, and the case where nothing is put in place of what is
 * judged. */
ph_status ph_i_grids_find(ph_campaign *c, int point, ph_error *err)
{
    ph_status st = PH_OK;
    ph_grid_pair *best = &c->point[point].grid;
    const ph_case *one = c->point[point].c;
    bool yes = false;
    *best = (ph_grid_pair){0};
    int first = is_replaced(c, c->judged >= 0 ? c->judged : 0);
    for (int f = first; f < c->nmodels && best->ratio == 0; f++) {
        const ph_case *fine = model_case(c, point, f);
        if (!fine || f == c->fillers_model) continue;
        PH_TRY(is_fine(one, fine, &yes, err));
        for (int m = f + 1; yes && m < c->nmodels; m++) {
            const ph_case *coarse = model_case(c, point, m);
            if (!coarse || m == c->fillers_model) continue;
            double ratio = ratio_of(fine, coarse);
            bool same = ratio > 0 && same_drawing(fine, coarse) &&
                        shows_drawing(coarse) && same_horizon(fine, coarse, ratio);
            if (same) PH_TRY(same_rest(fine, coarse, true, &same, err));
            if (same && (best->ratio == 0 || ratio < best->ratio))
                *best = (ph_grid_pair){f, m, ratio};
        }
    }
out:
    return st;
}

const char *ph_campaign_no_grid(const ph_campaign *c, int point, int k)
{
    if (!c || c->nmodels <= 1)
        return "there is no cheaper model on a coarser grid: variance_reduction";
    if (point < 0 || point >= c->npoints || k < 0 || k >= c->noutputs)
        return "there is no such point or output";
    const ph_grid_pair *grid = &c->point[point].grid;
    if (grid->ratio == 0)
        return "no two models differ in nothing but their nodes, the finer of them on "
               "the "
               "grid of the case: fillers drawn_on one grid, which the coarser one must "
               "resolve (nodes >= drawn_on), the horizon the same in length or in "
               "spacings";
    if (grid->fine == 0 && is_replaced(c, k))
        return "cheaper models compute stretch.E in place of E, and none of them has the "
               "grid of the case";
    return NULL;
}
