/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Numbers of a realisation that need no solution. */
#include "core/check.h"
#include "fillers.h"

#include <math.h>
#include <string.h>

static bool has_direction(const ph_filler *f)
{
    return strcmp(f->shape, "particle") != 0 || f->aspect_ratio.kind >= 0;
}

/* How many numbers a kind has. */
static int count_of(const ph_filler *f, int dimensions)
{
    if (!has_direction(f)) return 3;
    return dimensions == 3 ? 8 : 5;
}

int ph_rve_descriptor_count(const ph_case *c)
{
    if (!c) return 0;
    int n = 0;
    for (int k = 0; k < c->nfillers; k++)
        n += count_of(&c->fillers[k], c->kinematics == PH_SPACE ? 3 : 2);
    return n < PH_RVE_DESCRIPTORS ? n : PH_RVE_DESCRIPTORS;
}

/* Share of the box that filler i was to have. */
static double content_of(const ph_packing *p, const ph_placed *x)
{
    const ph_grid *g = &p->grid;
    double box = p->dimensions == 3 ? g->size[0] * g->size[1] * g->size[2]
                                    : g->size[0] * g->size[1];
    if (p->kind[x->kind].counting == PH_COUNT_NODES) box = (double)ph_grid_cells(g);
    return x->content / box;
}

/* Moments of the direction of a filler, piece by piece, times `weight`. */
static void add_directions(const ph_packing *p, const ph_placed *x, bool sheet,
                           double weight, double *out)
{
    double all = 0;
    for (ptrdiff_t k = x->first; k < x->first + x->count; k++)
        all += p->solid[k].half[0];
    for (ptrdiff_t k = x->first; k < x->first + x->count; k++) {
        const double *d = p->solid[k].frame[sheet ? 1 : 0];
        double w = weight * p->solid[k].half[0] / all;
        int n = 0;
        for (int a = 0; a + 1 < p->dimensions; a++)
            out[n++] += w * d[a] * d[a];
        for (int a = 0; a < (p->dimensions == 3 ? 3 : 1); a++)
            out[n++] += w * pow(d[a], 4);
    }
}

static void describe_kind(const ph_case *c, const ph_packing *p,
                          const ph_microstructure *m, int kind, double *out)
{
    const ph_filler *f = &c->fillers[kind];
    bool sheet = p->dimensions == 3 && strcmp(f->shape, "platelet") == 0;
    ptrdiff_t cells = ph_grid_cells(&m->grid), painted = 0;
    for (ptrdiff_t i = 0; i < cells; i++)
        painted += m->owner[i] > 0 && p->filler[m->owner[i] - 1].kind == kind;
    out[0] = p->kind[kind].reached;
    out[1] = (double)painted / (double)cells;
    for (ptrdiff_t i = 0; i < p->n; i++) {
        const ph_placed *x = &p->filler[i];
        if (x->kind != kind) continue;
        double weight = content_of(p, x) * x->length / p->grid.size[0];
        out[2] += weight;
        if (has_direction(f)) add_directions(p, x, sheet, weight, out + 3);
    }
}

ph_status ph_rve_describe(const ph_case *c, const ph_packing *p,
                          const ph_microstructure *m, double *out, ph_error *err)
{
    ph_status st = PH_OK;
    int n = 0;
    PH_CHECK(c && p && m && out && m->owner, PH_EINVAL,
             "a description needs the fillers and the cells that they own");
    for (int i = 0; i < PH_RVE_DESCRIPTORS; i++)
        out[i] = 0;
    for (int k = 0; k < c->nfillers; k++) {
        double one[8] = {0};
        describe_kind(c, p, m, k, one);
        for (int i = 0; i < count_of(&c->fillers[k], p->dimensions); i++)
            if (n < PH_RVE_DESCRIPTORS) out[n++] = one[i];
    }
out:
    return st;
}
