/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plots as pixels, two a unit, edges smoothed. */
#include "io/plot_canvas.h"

#include <math.h>

enum { PIXELS = 2 }; /* a unit */

/* Go on along a dashed line: what of the segment from a to b is drawn. */
static void dash_segment(ph_i_mask *m, const double a[2], const double b[2], double width,
                         double *gone)
{
    const double on = 6 * PIXELS, period = 10 * PIXELS;
    const double d[2] = {b[0] - a[0], b[1] - a[1]}, length = hypot(d[0], d[1]);
    for (double s = 0; s < length;) {
        double phase = fmod(*gone + s, period);
        double next = fmin(length, s + (phase < on ? on : period) - phase + 1e-9);
        const double p[2] = {a[0] + d[0] * s / length, a[1] + d[1] * s / length};
        const double q[2] = {a[0] + d[0] * next / length, a[1] + d[1] * next / length};
        if (phase < on) ph_i_mask_segment(m, p, q, width);
        s = next;
    }
    *gone = fmod(*gone + length, period);
}

static void raster_line(ph_i_canvas *c, ptrdiff_t n, const ph_i_point *p, ph_i_pen pen)
{
    ph_i_raster *r = (ph_i_raster *)c;
    double gone = 0;
    for (ptrdiff_t i = 0; i + 1 < n; i++) {
        const double a[2] = {PIXELS * p[i].x, PIXELS * p[i].y};
        const double b[2] = {PIXELS * p[i + 1].x, PIXELS * p[i + 1].y};
        if (pen.dashed)
            dash_segment(&r->mask, a, b, PIXELS * pen.width, &gone);
        else
            ph_i_mask_segment(&r->mask, a, b, PIXELS * pen.width);
    }
    ph_i_mask_paint(&r->mask, &r->picture, pen.colour, pen.opacity);
}

static void raster_fill(ph_i_canvas *c, ptrdiff_t n, const ph_i_point *p, ph_i_pen pen)
{
    ph_i_raster *r = (ph_i_raster *)c;
    ph_i_mask_polygon(&r->mask, n, p, PIXELS);
    ph_i_mask_paint(&r->mask, &r->picture, pen.colour, pen.opacity);
}

static void raster_rectangle(ph_i_canvas *c, ph_i_box box, ph_i_pen pen)
{
    const double x1 = box.x + box.width, y1 = box.y + box.height;
    const ph_i_point p[4] = {{box.x, box.y}, {x1, box.y}, {x1, y1}, {box.x, y1}};
    raster_fill(c, 4, p, pen);
}

static void raster_marks(ph_i_canvas *c, ptrdiff_t n, const ph_i_point *p, int shape,
                         ph_i_pen pen)
{
    ph_i_raster *r = (ph_i_raster *)c;
    ph_i_point corner[4], at[4];
    const int corners = ph_i_mark_outline(shape, 0.5 * pen.width, corner);
    for (ptrdiff_t i = 0; i < n; i++) {
        const double centre[2] = {PIXELS * p[i].x, PIXELS * p[i].y};
        for (int k = 0; k < corners; k++)
            at[k] = (ph_i_point){p[i].x + corner[k].x, p[i].y + corner[k].y};
        if (corners > 0)
            ph_i_mask_polygon(&r->mask, corners, at, PIXELS);
        else
            ph_i_mask_segment(&r->mask, centre, centre, PIXELS * pen.width);
    }
    ph_i_mask_paint(&r->mask, &r->picture, pen.colour, pen.opacity);
}

static void raster_text(ph_i_canvas *c, const char *text, ph_i_label how)
{
    ph_i_raster *r = (ph_i_raster *)c;
    const int scale = how.size < PH_I_LARGE ? PIXELS : PIXELS + 1;
    const int width = ph_i_text_width(text, scale), height = PH_I_LETTER_HEIGHT * scale;
    const int x = (int)lrint(PIXELS * how.at.x), y = (int)lrint(PIXELS * how.at.y);
    const int back = how.anchor == PH_I_START    ? 0
                     : how.anchor == PH_I_MIDDLE ? width / 2
                                                 : width;
    if (how.up)
        ph_i_text_up(&r->picture, x - height, y + back, scale, text, how.colour);
    else
        ph_i_text(&r->picture, x - back, y - height, scale, text, how.colour);
}

static void raster_begin(ph_i_canvas *c, const char *role, const char *name,
                         const ph_i_box *clip)
{
    ph_i_mask *m = &((ph_i_raster *)c)->mask;
    (void)role;
    (void)name;
    if (!clip) return;
    m->x0 = (int)fmax(0, floor(PIXELS * clip->x));
    m->y0 = (int)fmax(0, floor(PIXELS * clip->y));
    m->x1 = (int)fmin(m->width, ceil(PIXELS * (clip->x + clip->width)));
    m->y1 = (int)fmin(m->height, ceil(PIXELS * (clip->y + clip->height)));
}

static void raster_end(ph_i_canvas *c)
{
    ph_i_mask *m = &((ph_i_raster *)c)->mask;
    m->x0 = m->y0 = 0;
    m->x1 = m->width;
    m->y1 = m->height;
}

ph_status ph_i_raster_open(ph_i_raster *raster, int width, int height, ph_error *err)
{
    ph_status st = PH_OK;
    *raster =
        (ph_i_raster){.canvas = {raster_line, raster_fill, raster_rectangle, raster_marks,
                                 raster_text, raster_begin, raster_end}};
    PH_TRY(ph_i_picture_new(PIXELS * width, PIXELS * height, &raster->picture, err));
    PH_TRY(ph_i_mask_new(PIXELS * width, PIXELS * height, &raster->mask, err));
out:
    return st;
}

void ph_i_raster_close(ph_i_raster *raster)
{
    ph_i_picture_free(&raster->picture);
    ph_i_mask_free(&raster->mask);
}
