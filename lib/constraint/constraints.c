/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "constraint/constraint.h"
#include "model/models.h"

#include <string.h>

static ph_status periodic(const ph_problem *problem, const ph_family *family,
                          ph_setting *s, ph_error *err)
{
    (void)family;
    (void)err;
    s->box = problem->micro->grid;
    s->averaged = ph_grid_cells(&s->box);
    return PH_OK;
}

/* Smallest number >= n whose prime factors transforms are fast for. */
static ptrdiff_t good_length(ptrdiff_t n)
{
    for (;; n++) {
        ptrdiff_t m = n;
        static const int prime[] = {2, 3, 5, 7};
        for (int i = 0; i < 4; i++)
            while (m % prime[i] == 0)
                m /= prime[i];
        if (m == 1) return n;
    }
}

static ptrdiff_t wrap(ptrdiff_t i, ptrdiff_t n)
{
    i %= n;
    return i < 0 ? i + n : i;
}

/* An RVE that stands alone in the box, with layers of cells around it.
 *   layers[d]  cells around the RVE that are averaged with it
 *   margin[d]  more cells behind them, so that no family meets the other side
 * Box index c is RVE index c - layers. */
static ph_status embed(const ph_problem *p, const int layers[3], const int margin[3],
                       bool collar, ph_setting *s, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_grid *rve = &p->micro->grid;
    s->box = *rve;
    for (int d = 0; d < 3; d++) {
        s->first[d] = layers[d];
        if (rve->n[d] == 1) continue;
        s->box.n[d] = good_length(rve->n[d] + 2 * layers[d] + margin[d]);
        s->box.size[d] = rve->h[d] * (double)s->box.n[d];
    }
    ptrdiff_t cells = ph_grid_cells(&s->box), x = 0;
    PH_ALLOC(s->source, cells, "the box around the RVE");
    PH_ALLOC(s->region, cells, "the averaged region");
    s->averaged = 0;
    for (ptrdiff_t i = 0; i < s->box.n[0]; i++)
        for (ptrdiff_t j = 0; j < s->box.n[1]; j++)
            for (ptrdiff_t k = 0; k < s->box.n[2]; k++, x++) {
                ptrdiff_t at[3] = {i, j, k}, from = 0;
                bool inside = true, averaged = true;
                for (int d = 0; d < 3; d++) {
                    ptrdiff_t r = at[d] - s->first[d], n = rve->n[d];
                    inside = inside && r >= 0 && r < n;
                    averaged = averaged && r >= -layers[d] && r < n + layers[d];
                    from = from * n + wrap(r, n);
                }
                bool matrix = !inside && p->constraint.collar == PH_COLLAR_MATRIX;
                s->source[x] = inside                 ? from
                               : !averaged || !collar ? PH_SOURCE_VOID
                               : matrix ? -2 - (ptrdiff_t)p->constraint.collar_material
                                        : from;
                s->region[x] = averaged;
                s->averaged += averaged;
            }
out:
    return st;
}

/* Layers of points that a free node moves, on each side: the reach of the family. */
static int reach_of(const ph_problem *p, const ph_family *family, int d)
{
    return p->micro->grid.n[d] == 1 ? 0 : family ? family->reach[d] : 1;
}

/* Averages over the RVE alone. */
static void average_rve(const ph_problem *p, ph_setting *s)
{
    const ptrdiff_t *n = s->box.n, *rve = p->micro->grid.n;
    s->averaged = ph_grid_cells(&p->micro->grid);
    for (ptrdiff_t x = 0; x < ph_grid_cells(&s->box); x++) {
        ptrdiff_t at[3] = {x / n[2] / n[1], x / n[2] % n[1], x % n[2]};
        for (int d = 0; d < 3; d++)
            if (at[d] < s->first[d] || at[d] >= s->first[d] + rve[d]) s->region[x] = 0;
    }
}

/* Hold the nodes outside [low, high) of the RVE, axis by axis. */
static ph_status hold_nodes(const ph_problem *p, const ptrdiff_t low[3],
                            const ptrdiff_t high[3], ph_setting *s, ph_error *err)
{
    ph_status st = PH_OK;
    ptrdiff_t cells = ph_grid_cells(&s->box), x = 0;
    PH_ALLOC(s->fixed, cells, "the fixed nodes");
    for (ptrdiff_t i = 0; i < s->box.n[0]; i++)
        for (ptrdiff_t j = 0; j < s->box.n[1]; j++)
            for (ptrdiff_t k = 0; k < s->box.n[2]; k++, x++) {
                ptrdiff_t at[3] = {i, j, k};
                for (int d = 0; d < 3; d++) {
                    ptrdiff_t r = at[d] - s->first[d];
                    if (p->micro->grid.n[d] > 1 && (r < low[d] || r >= high[d]))
                        s->fixed[x] = 1;
                }
            }
out:
    return st;
}

/* u = eps x on a boundary volume of two horizons.
 *
 * Inside: a node is free if every point that it moves lies in the RVE. Averages over the
 * RVE are exact, its composition is that of the RVE, and the fields are periodic ones that
 * happen to vanish near the faces, so that periodic <= linear_displacement holds exactly.
 *
 * Outside: every node of the RVE is free, and averages are exact over the RVE and the layer
 * of points around it that its nodes move, with the material that stands there. Bonds
 * between pairs: a frame of one horizon, and averages over the RVE alone. */
static ph_status linear_displacement(const ph_problem *p, const ph_family *family,
                                     ph_setting *s, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_grid *rve = &p->micro->grid;
    const ph_model_method *model = ph_i_model_find(p->model.kind);
    bool pairs = model && model->pairwise;
    bool nodes = family && family->points == PH_POINTS_NODES;
    bool inside = p->constraint.collar == PH_COLLAR_INSIDE;
    int layers[3], margin[3];
    ptrdiff_t low[3], high[3];
    for (int d = 0; d < 3; d++) {
        margin[d] = reach_of(p, family, d);
        layers[d] = nodes || margin[d] == 0 ? margin[d] : margin[d] - 1;
        low[d] = inside ? margin[d] : nodes ? 0 : 1;
        high[d] = inside && nodes ? rve->n[d] - margin[d]
                  : inside        ? rve->n[d] - margin[d] + 1
                                  : rve->n[d];
        PH_CHECK_KEY(
            rve->n[d] == 1 || low[d] < high[d], PH_EINVAL, "constraint.kind",
            "linear_displacement leaves no free node along axis %d: %td nodes and a "
            "boundary volume of %d on each side",
            d + 1, rve->n[d], margin[d]);
    }
    if (pairs) margin[0] = margin[1] = margin[2] = 0; /* the frame is as wide as a bond */
    if (inside)
        PH_TRY(periodic(p, family, s, err));
    else
        PH_TRY(embed(p, layers, margin, true, s, err));
    if (!inside && pairs) average_rve(p, s);
    PH_TRY(hold_nodes(p, low, high, s, err));
out:
    return st;
}

/* The RVE alone in empty space, pulled by sigma.n on its faces. One layer of empty cells
 * keeps the faces apart; families that reach further are cut at them. */
static ph_status uniform_traction(const ph_problem *p, const ph_family *family,
                                  ph_setting *s, ph_error *err)
{
    (void)family;
    int layers[3] = {0, 0, 0}, margin[3] = {1, 1, 1};
    return embed(p, layers, margin, false, s, err);
}

const ph_constraint_method ph_constraints[] = {
    {{"periodic", "periodic boundary-volume constraint: u = eps x + a periodic field",
      "Galadima2023", "always"},
     false,
     false,
     false,
     periodic},
    {{"linear_displacement", "u = eps x on a boundary volume of two horizons",
      "Galadima2023", "an upper estimate of an RVE cut from a material"},
     false,
     false,
     true,
     linear_displacement},
    {{"uniform_traction", "sigma n on the faces, the body free otherwise", "Hazanov1995",
      "a lower estimate of an RVE cut from a material"},
     false,
     true,
     true,
     uniform_traction},
    {{"voigt", "uniform strain: the upper bound", "Voigt1889", "always"},
     true,
     false,
     false,
     periodic},
    {{"reuss", "uniform stress: the lower bound", "Reuss1929", "no void phase"},
     true,
     false,
     false,
     periodic},
};
const size_t ph_nconstraints = sizeof ph_constraints / sizeof *ph_constraints;

const ph_constraint_method *ph_i_constraint_find(const char *name)
{
    for (size_t i = 0; i < ph_nconstraints; i++)
        if (strcmp(name ? name : "periodic", ph_constraints[i].info.name) == 0)
            return &ph_constraints[i];
    return NULL;
}

void ph_i_setting_clear(ph_setting *s)
{
    free(s->source);
    free(s->region);
    free(s->fixed);
    s->source = NULL;
    s->region = s->fixed = NULL;
}
