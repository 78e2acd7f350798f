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

static void paint_nodes(const ph_packing *p, ptrdiff_t i, int material,
                        ph_microstructure *m)
{
    const ph_placed *x = &p->filler[i];
    const ptrdiff_t *n = m->grid.n;
    ptrdiff_t centre[3] = {0};
    for (int a = 0; a < p->dimensions; a++)
        centre[a] = (ptrdiff_t)floor(x->centre[a] / m->grid.h[a]);
    for (ptrdiff_t k = x->first_point; k < x->first_point + x->npoints; k++) {
        ptrdiff_t at[3];
        for (int a = 0; a < 3; a++)
            at[a] = wrap(centre[a] + p->point[k][a], n[a]);
        ptrdiff_t cell = (at[0] * n[1] + at[1]) * n[2] + at[2];
        m->phase[cell] = (uint16_t)material;
        m->owner[cell] = (int32_t)(i + 1);
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
