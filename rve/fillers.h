/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inside of the generator: a filler is drawn (filler_draw.c) as a chain of solids
 * (filler_shapes.c), placed (filler_place.c, distances in filler_contact.c) and painted
 * (filler_paint.c). */
#ifndef PH_RVE_FILLERS_H
#define PH_RVE_FILLERS_H

#include "paint.h"
#include "solid.h"

/* Random numbers of one filler: which draw is what. Fixed places, so that a change of one
 * quantity leaves the numbers of the others alone. */
enum {
    DRAW_THICKNESS,
    DRAW_LENGTH,
    DRAW_WIDTH,
    DRAW_BEND,
    DRAW_PITCH,
    DRAW_SIGN,
    DRAW_SHARE,
    DRAW_ROLL,
    DRAW_DIRECTION = 16,
    DRAW_CHAIN = 1 << 10
};
#define DRAW_POSITION ((uint64_t)1 << 32)
/* Objects that are no filler: agglomerate k of a kind. */
#define OBJECT_KIND(kind)    ((uint64_t)(kind) << 40)
#define OBJECT_CLUSTER(kind) (OBJECT_KIND(kind) | (uint64_t)1 << 39)

/* What is being generated. */
typedef struct ph_i_generator {
    const ph_case *c;
    ph_grid grid;
    ph_packing *p;
    double spacing; /* smallest of the grid */
    ptrdiff_t fillers_held, solids_held, points_held;
} ph_i_generator;

ph_status ph_i_grow(void **array, ptrdiff_t count, ptrdiff_t *held, size_t size,
                    const char *what, ph_error *err);
double ph_i_dot3(const double a[3], const double b[3]);
void ph_i_cross3(const double a[3], const double b[3], double c[3]);
/* Frame whose first row is `axis` (unit), turned about it by `roll` (radians). */
void ph_i_frame_about(const double axis[3], double roll, double frame[3][3]);

/* Unit direction of filler f. @param[in] g_root the square-root map of the tensor, from
 * ph_i_tensor_map */
void ph_i_draw_direction(const ph_filler *f, const double map[9], int dimensions,
                         ph_random r, double out[3]);
/* Linear map B such that normalised B g, g Gaussian, has the second moment of f->tensor. */
void ph_i_tensor_map(const ph_filler *f, int dimensions, double map[9]);
/* Filler `number` of kind k at the end of the packing: everything but its place. */
ph_status ph_i_draw_filler(ph_i_generator *g, int k, const double map[9], uint64_t number,
                           ph_error *err);
/* Chain of solids (and the nodes) of the last filler of the packing. */
ph_status ph_i_shape_filler(ph_i_generator *g, ph_counting counting, ph_random r,
                            ph_error *err);
/* Take the last filler away again. */
void ph_i_drop_filler(ph_packing *p);

/* Direction n from a to b (moved by shift) along which they are nearest, the points where,
 * and how far they are apart along n: negative where they overlap. */
double ph_i_separation(const ph_solid *a, const ph_solid *b, const double shift[3],
                       int dimensions, double n[3], double at[3]);

ph_status ph_i_paint_packing(const ph_case *c, const ph_packing *p, ph_canvas *canvas,
                             ph_error *err);

#endif
