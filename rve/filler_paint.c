/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fillers onto the grid: as solids (area) or as chains of nodes (nodes). */
#include "core/check.h"
#include "fillers.h"

#include <math.h>

/* Solids of filler i, each axis that ends made longer by `more` at both ends. */
static ph_status paint_solids(const ph_packing *p, ph_canvas *canvas, ptrdiff_t i,
                              double more, int material, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_placed *x = &p->filler[i];
    canvas->filler = more > 0 ? 0 : (int32_t)(i + 1);
    for (ptrdiff_t k = x->first; k < x->first + x->count; k++) {
        ph_solid s = p->solid[k];
        for (int a = 0; a < p->dimensions; a++) {
            s.centre[a] += x->centre[a];
            s.half[a] += more;
        }
        ph_i_solid_finish(&s);
        PH_TRY(ph_i_paint(canvas, &s, material, err));
    }
out:
    return st;
}

static ptrdiff_t wrap(ptrdiff_t i, ptrdiff_t n)
{
    i %= n;
    return i < 0 ? i + n : i;
}

/* Cells first .. first + count - 1 of an axis that node i of the grid of the fillers covers:
 * those with their centre in it, and where there is none the one that holds its centre. */
static ptrdiff_t covered(ptrdiff_t i, double ratio, ptrdiff_t *count)
{
    double lo = ceil((double)i * ratio - 0.5), hi = ceil((double)(i + 1) * ratio - 0.5);
    if (hi <= lo) lo = floor(((double)i + 0.5) * ratio), hi = lo + 1;
    *count = (ptrdiff_t)(hi - lo);
    return (ptrdiff_t)lo;
}

static void paint_node(ph_microstructure *m, const ph_grid *drawn,
                       const ptrdiff_t node[3], int material, int32_t owner)
{
    const ptrdiff_t *n = m->grid.n;
    ptrdiff_t first[3], count[3], k[3];
    for (int a = 0; a < 3; a++)
        first[a] = covered(node[a], (double)n[a] / (double)drawn->n[a], &count[a]);
    for (k[0] = 0; k[0] < count[0]; k[0]++)
        for (k[1] = 0; k[1] < count[1]; k[1]++)
            for (k[2] = 0; k[2] < count[2]; k[2]++) {
                ptrdiff_t cell = 0;
                for (int a = 0; a < 3; a++)
                    cell = cell * n[a] + wrap(first[a] + k[a], n[a]);
                m->phase[cell] = (uint16_t)material;
                m->owner[cell] = owner;
            }
}

static void paint_nodes(const ph_packing *p, ptrdiff_t i, int material,
                        ph_microstructure *m)
{
    const ph_placed *x = &p->filler[i];
    ptrdiff_t centre[3] = {0}, node[3];
    for (int a = 0; a < p->dimensions; a++)
        centre[a] = (ptrdiff_t)floor(x->centre[a] / p->grid.h[a]);
    for (ptrdiff_t k = x->first_point; k < x->first_point + x->npoints; k++) {
        for (int a = 0; a < 3; a++)
            node[a] = wrap(centre[a] + p->point[k][a], p->grid.n[a]);
        paint_node(m, &p->grid, node, material, (int32_t)(i + 1));
    }
}

/* Layers first, so that no layer covers a filler. */
ph_status ph_i_paint_packing(const ph_case *c, const ph_packing *p, ph_canvas *canvas,
                             ph_error *err)
{
    ph_status st = PH_OK;
    for (ptrdiff_t i = 0; i < p->n; i++) {
        const ph_filler *f = &c->fillers[p->filler[i].kind];
        if (f->interphase_thickness > 0)
            PH_TRY(paint_solids(p, canvas, i, f->interphase_thickness,
                                f->interphase_material, err));
    }
    for (ptrdiff_t i = 0; i < p->n; i++) {
        int k = p->filler[i].kind;
        if (p->kind[k].counting == PH_COUNT_NODES) continue;
        PH_TRY(paint_solids(p, canvas, i, 0, c->fillers[k].material, err));
    }
    canvas->filler = 0;
    for (ptrdiff_t i = 0; i < p->n; i++) {
        int k = p->filler[i].kind;
        if (p->kind[k].counting == PH_COUNT_NODES)
            paint_nodes(p, i, c->fillers[k].material, canvas->micro);
    }
out:
    return st;
}
