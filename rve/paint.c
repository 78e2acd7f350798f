/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "paint.h"

#include "core/check.h"

#include <math.h>

/* A cell centre this share of the spacing outside a surface still counts as inside, and a
 * fraction this near to 0 or 1 is 0 or 1: surfaces meant to lie on centres or faces of cells
 * must not depend on rounding. */
static const double touching = 1e-9;
/* An inclusion may reach over this many boxes: more is a slip of the units. */
static const double boxes_max = 64;

void ph_i_canvas_clear(ph_canvas *canvas)
{
    free(canvas->images);
    free(canvas->marks);
    free(canvas->marked);
    *canvas = (ph_canvas){0};
}

void ph_i_cell_box(const ph_grid *grid, ptrdiff_t cell, double lo[3], double hi[3])
{
    ptrdiff_t at[3] = {cell / grid->n[2] / grid->n[1], cell / grid->n[2] % grid->n[1],
                       cell % grid->n[2]};
    for (int a = 0; a < 3; a++) {
        lo[a] = (double)at[a] * grid->h[a];
        hi[a] = (double)(at[a] + 1) * grid->h[a];
    }
}

/* Room for one more in a growing array. */
static ph_status grow(void **p, ptrdiff_t count, ptrdiff_t *held, size_t size,
                      const char *what, ph_error *err)
{
    ph_status st = PH_OK;
    if (count < *held) return st;
    ptrdiff_t more = *held ? 2 * *held : 256;
    void *q = realloc(*p, (size_t)more * size);
    PH_CHECK(q, PH_ENOMEM, "no memory for %s (%td x %zu bytes)", what, more, size);
    *p = q;
    *held = more;
out:
    return st;
}

static ph_status mark(ph_canvas *canvas, ptrdiff_t cell, double fraction, ph_error *err)
{
    ph_status st = PH_OK;
    void *marks = canvas->marks;
    st = grow(&marks, canvas->nmarks, &canvas->marks_held, sizeof *canvas->marks,
              "the cut cells", err);
    canvas->marks = marks;
    if (st != PH_OK) return st;
    canvas->marks[canvas->nmarks++] =
        (ph_mark){cell, canvas->nimages - 1, canvas->micro->phase[cell], fraction};
    canvas->marked[cell / 8] |= (uint8_t)(1u << cell % 8);
    return st;
}

/* The last image on one cell. */
static ph_status paint_cell(ph_canvas *canvas, ptrdiff_t cell, const double x[3],
                            double radius, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_image *im = &canvas->images[canvas->nimages - 1];
    const ph_grid *g = &canvas->micro->grid;
    double level = ph_solid_level(&im->solid, x, NULL), fraction = 1;
    bool marked = canvas->cuts && canvas->marked[cell / 8] >> cell % 8 & 1;
    if (level > (canvas->cuts ? radius : touching * radius)) return st;
    if (canvas->cuts && level > -radius) {
        double lo[3], hi[3];
        ph_i_cell_box(g, cell, lo, hi);
        fraction = ph_solid_overlap(&im->solid, canvas->dimensions, lo, hi) /
                   (g->h[0] * g->h[1] * g->h[2]);
        if (fraction <= touching) return st;
        if (fraction >= 1 - touching) fraction = 1;
    }
    if (fraction < 1 || marked) PH_TRY(mark(canvas, cell, fraction, err));
    if (fraction == 1 || level <= touching * radius) {
        canvas->micro->phase[cell] = (uint16_t)im->material;
        if (canvas->micro->owner) canvas->micro->owner[cell] = canvas->filler;
    }
out:
    return st;
}

/* Cells of axis `a` whose interval the solid can reach: from..to, empty if from > to. */
static void reach(const ph_grid *g, const ph_solid *s, int a, ptrdiff_t *from,
                  ptrdiff_t *to)
{
    double last = (double)(g->n[a] - 1);
    *from = (ptrdiff_t)fmin(
        fmax(floor((s->centre[a] - s->bounds[a]) / g->h[a] - touching), 0), last + 1);
    *to = (ptrdiff_t)fmax(
        fmin(floor((s->centre[a] + s->bounds[a]) / g->h[a] + touching), last), -1);
}

static ph_status paint_image(ph_canvas *canvas, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_grid *g = &canvas->micro->grid;
    const ph_solid *s = &canvas->images[canvas->nimages - 1].solid;
    ptrdiff_t from[3], to[3], i[3];
    double diagonal2 = 0, x[3];
    for (int a = 0; a < 3; a++)
        reach(g, s, a, &from[a], &to[a]);
    for (int a = 0; a < canvas->dimensions; a++)
        diagonal2 += g->h[a] * g->h[a];
    double radius = sqrt(diagonal2) / 2;
    for (i[0] = from[0]; i[0] <= to[0]; i[0]++)
        for (i[1] = from[1]; i[1] <= to[1]; i[1]++)
            for (i[2] = from[2]; i[2] <= to[2]; i[2]++) {
                for (int a = 0; a < 3; a++)
                    x[a] = ((double)i[a] + 0.5) * g->h[a];
                ptrdiff_t cell = (i[0] * g->n[1] + i[1]) * g->n[2] + i[2];
                PH_TRY(paint_cell(canvas, cell, x, radius, err));
            }
out:
    return st;
}

/* Periodic images k = from..to of an interval centre +- bound that reach into (0, size). */
static ph_status images(const ph_grid *g, ph_solid *s, int a, int *from, int *to,
                        ph_error *err)
{
    ph_status st = PH_OK;
    double size = g->size[a], b = s->bounds[a];
    *from = *to = 0;
    if (isinf(b)) return st;
    PH_CHECK(b <= boxes_max * size, PH_EINVAL,
             "reaches %g to each side along axis %d: more than %g boxes", b, a + 1,
             boxes_max);
    s->centre[a] -= floor(s->centre[a] / size) * size;
    *from = (int)floor((-b - s->centre[a]) / size) + 1;
    *to = (int)ceil((size - s->centre[a] + b) / size) - 1;
out:
    return st;
}

ph_status ph_i_paint(ph_canvas *canvas, const ph_solid *solid, int material,
                     ph_error *err)
{
    ph_status st = PH_OK;
    const ph_grid *g = &canvas->micro->grid;
    ph_solid s = *solid;
    int from[3], to[3], k[3];
    for (int a = 0; a < 3; a++)
        PH_TRY(images(g, &s, a, &from[a], &to[a], err));
    if (canvas->cuts && !canvas->marked)
        PH_ALLOC(canvas->marked, ph_grid_cells(g) / 8 + 1, "the marks of the cells");
    for (k[0] = from[0]; k[0] <= to[0]; k[0]++)
        for (k[1] = from[1]; k[1] <= to[1]; k[1]++)
            for (k[2] = from[2]; k[2] <= to[2]; k[2]++) {
                void *p = canvas->images;
                st = grow(&p, canvas->nimages, &canvas->images_held,
                          sizeof *canvas->images, "periodic images", err);
                canvas->images = p;
                if (st != PH_OK) goto out;
                ph_image *im = &canvas->images[canvas->nimages++];
                *im = (ph_image){s, material};
                for (int a = 0; a < 3; a++)
                    im->solid.centre[a] += k[a] * g->size[a];
                PH_TRY(paint_image(canvas, err));
            }
out:
    return st;
}
