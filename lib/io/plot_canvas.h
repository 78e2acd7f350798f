/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What plots are drawn on. Lengths in units, x to the right, y downwards; three canvases:
 * SVG, a picture with two pixels a unit, and one that only notes where something is. */
#ifndef PH_IO_PLOT_CANVAS_H
#define PH_IO_PLOT_CANVAS_H

#include "io/picture.h"
#include "io/text.h"

typedef struct ph_i_box {
    double x, y, width, height;
} ph_i_box;

typedef struct ph_i_pen {
    ph_i_colour colour;
    double width;   /* of lines and marks */
    double opacity; /* 0 .. 1 */
    bool dashed;
} ph_i_pen;

typedef enum ph_i_anchor { PH_I_START, PH_I_MIDDLE, PH_I_END } ph_i_anchor;
enum { PH_I_MARKS = 4, PH_I_SMALL = 11, PH_I_LARGE = 14 }; /* shapes; letter sizes */

typedef struct ph_i_label {
    ph_i_point at; /* the line that the text stands on, at its anchor */
    int size;      /* PH_I_SMALL or PH_I_LARGE (bold) */
    ph_i_anchor anchor;
    bool up; /* turned, to be read from below to above */
    ph_i_colour colour;
} ph_i_label;

typedef struct ph_i_canvas ph_i_canvas;
struct ph_i_canvas {
    void (*line)(ph_i_canvas *c, ptrdiff_t n, const ph_i_point *p, ph_i_pen pen);
    void (*fill)(ph_i_canvas *c, ptrdiff_t n, const ph_i_point *p, ph_i_pen pen);
    void (*rectangle)(ph_i_canvas *c, ph_i_box box, ph_i_pen pen);
    void (*marks)(ph_i_canvas *c, ptrdiff_t n, const ph_i_point *p, int shape,
                  ph_i_pen pen);
    void (*text)(ph_i_canvas *c, const char *text, ph_i_label how);
    /* What follows belongs together; `clip`: and is seen only inside of this box. */
    void (*begin)(ph_i_canvas *c, const char *role, const char *name,
                  const ph_i_box *clip);
    void (*end)(ph_i_canvas *c);
};

/** Writes SVG into `out`; between open and close it is a canvas. */
typedef struct ph_i_svg {
    ph_i_canvas canvas;
    ph_i_growing out;
    bool nested; /* the group open now is a clipping one */
} ph_i_svg;
void ph_i_svg_open(ph_i_svg *svg, int width, int height, const char *title);
void ph_i_svg_close(ph_i_svg *svg);

/** Draws on a picture of 2 width x 2 height pixels. */
typedef struct ph_i_raster {
    ph_i_canvas canvas;
    ph_i_picture picture;
    ph_i_mask mask;
} ph_i_raster;
ph_status ph_i_raster_open(ph_i_raster *raster, int width, int height, ph_error *err);
void ph_i_raster_close(ph_i_raster *raster);

/** Notes which cells of a box have something in them. */
enum { PH_I_PROBE = 64 };
typedef struct ph_i_probe {
    ph_i_canvas canvas;
    ph_i_box box;
    uint8_t taken[PH_I_PROBE][PH_I_PROBE]; /* [row][column] */
} ph_i_probe;
void ph_i_probe_open(ph_i_probe *probe, ph_i_box box);
/** Cells taken inside of `box`. */
int ph_i_probe_count(const ph_i_probe *probe, ph_i_box box);

/** Width of a text in units, about. */
double ph_i_label_width(const char *text, int size);
/** The text, or its beginning and an ellipsis where it is wider. */
void ph_i_label_fit(const char *text, int size, double width, char out[512]);

/** Corners of a mark around (0, 0), 0 for a disk; all shapes look equally large. */
int ph_i_mark_outline(int shape, double radius, ph_i_point corner[4]);
void ph_i_canvas_segment(ph_i_canvas *c, double x0, double y0, double x1, double y1,
                         ph_i_pen pen);
void ph_i_canvas_text(ph_i_canvas *c, double x, double y, const char *text,
                      ph_i_anchor anchor, ph_i_colour colour);

/** Colour of the k-th series, k >= 0: dark enough for lines on white. */
ph_i_colour ph_i_series_colour(int k);

/* ---- ticks (plot_ticks.c) */

enum { PH_I_TICKS = 128 };
typedef struct ph_i_tick {
    double value;
    char label[32]; /* "" for a minor one */
} ph_i_tick;

/** An axis: where its values are. */
typedef struct ph_i_axis {
    bool log;
    double lo, hi;   /* lo < hi, positive where logarithmic */
    double from, to; /* their places on the canvas */
    int nticks;
    ph_i_tick tick[PH_I_TICKS];
} ph_i_axis;

/** Whether a value has a place on the axis (finite, positive where it must be). */
bool ph_i_axis_has(const ph_i_axis *a, double value);
/** The place of a value. */
double ph_i_axis_place(const ph_i_axis *a, double value);
/** lo and hi from the least and greatest value (least > greatest: there are none), with a
 *  margin as a share of the range. */
void ph_i_axis_range(ph_i_axis *a, double least, double greatest, double margin);
/** Ticks at 1, 2, 5 times powers of ten, about `most` with a label at most. */
void ph_i_axis_ticks(ph_i_axis *a, int most);

/* ---- the way from a plot to a file (plot_write.c) */

enum { PH_PLOT_WIDTH = 720, PH_PLOT_HEIGHT = 480 };

/** 0 or 200 .. 4000 x 150 .. 4000 units. */
ph_status ph_i_check_size(int width, int height, ph_error *err);
/** Both ends equal (automatic), or finite, the less first, positive where logarithmic. */
ph_status ph_i_check_range(const double range[2], bool log, const char *axis,
                           ph_error *err);

typedef struct ph_i_drawing {
    int width, height;
    const char *title;
    ph_status (*draw)(const void *what, ph_i_canvas *c, ph_error *err);
    const void *what;
} ph_i_drawing;
ph_status ph_i_drawing_svg(const ph_i_drawing *d, char **text, ph_error *err);
ph_status ph_i_drawing_write(const char *path, const ph_i_drawing *d, ph_error *err);

/** Axes with ticks, grid, labels and titles around `box` (plot_axes.c). */
typedef struct ph_i_frame_text {
    const char *title, *subtitle, *xlabel, *ylabel;
} ph_i_frame_text;
double ph_i_title_height(const ph_i_frame_text *t);
void ph_i_draw_titles(ph_i_canvas *c, const ph_i_frame_text *t, ph_i_box box, int width,
                      int height);
void ph_i_draw_grid(ph_i_canvas *c, const ph_i_axis *x, const ph_i_axis *y, ph_i_box box);
void ph_i_draw_axes(ph_i_canvas *c, const ph_i_axis *x, const ph_i_axis *y, ph_i_box box);
/** Widest label of an axis, in units. */
double ph_i_axis_label_width(const ph_i_axis *a);

#endif
