/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Painting solids on the periodic grid: first every cell is marked (paint.c), then the cells
 * that several marks or one surface share are described by cuts (cut_cells.c). */
#ifndef PH_RVE_PAINT_H
#define PH_RVE_PAINT_H

#include "solid.h"

/* One periodic image of an inclusion. */
typedef struct ph_image {
    ph_solid solid;
    int material;
} ph_image;

/* An image covers `fraction` of a cell, 1 where it covers all of it. Only cells that some
 * surface cuts have marks. */
typedef struct ph_mark {
    ptrdiff_t cell;
    ptrdiff_t image; /* in painting order */
    int below;       /* of the first mark of a cell: the material it had */
    double fraction;
} ph_mark;

/* What is being painted. Zeroed to begin with; released by ph_i_canvas_clear. */
typedef struct ph_canvas {
    ph_microstructure *micro;
    int dimensions;
    bool cuts;      /* mark cut cells */
    int32_t filler; /* owner of what is painted, where micro has owners; 0: nobody */
    ptrdiff_t nimages, images_held;
    ph_image *images;
    ptrdiff_t nmarks, marks_held;
    ph_mark *marks;
    uint8_t *marked; /* one bit a cell: it has marks */
} ph_canvas;

void ph_i_canvas_clear(ph_canvas *canvas);
/* Paint all periodic images of a solid. */
ph_status ph_i_paint(ph_canvas *canvas, const ph_solid *solid, int material,
                     ph_error *err);
/* Turn the marks into the cuts of canvas->micro. Sorts the marks. */
ph_status ph_i_cut_cells(ph_canvas *canvas, ph_error *err);
/* Lower and upper corner of a cell (2D: the third numbers are 0 and 1). */
void ph_i_cell_box(const ph_grid *grid, ptrdiff_t cell, double lo[3], double hi[3]);

#endif
