/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/plot.h>

#include "io/plot_canvas.h"

#include <math.h>

static const double BAR_WIDTH = 14, SMALL_CELL = 14, LETTER = 6;

/* A map with its colour scale. */
typedef struct scale {
    ph_i_axis axis; /* of the colour bar */
    bool diverging;
    bool any; /* there are values */
} scale;

/* Where everything is. */
typedef struct layout {
    ph_i_box cells, bar;
    double cell_width, cell_height;
    bool up; /* names of the columns are turned */
} layout;

static int width_of(const ph_heatmap *m)
{
    return m->width ? m->width : PH_PLOT_WIDTH;
}

static int height_of(const ph_heatmap *m)
{
    return m->height ? m->height : PH_PLOT_HEIGHT;
}

static ph_status check_map(const ph_heatmap *m, ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(ph_i_check_size(m->width, m->height, err));
    PH_CHECK(m->nx > 0 && m->ny > 0 && m->nx <= PH_HEATMAP_CELLS &&
                 m->ny <= PH_HEATMAP_CELLS,
             PH_EINVAL, "a heat map of %d x %d cells: 1 to %d each way", m->nx, m->ny,
             PH_HEATMAP_CELLS);
    PH_CHECK(m->value, PH_EINVAL, "a heat map without values");
    PH_TRY(ph_i_check_range(m->range, m->log_colour, "colour", err));
out:
    return st;
}

static scale make_scale(const ph_heatmap *m)
{
    scale s = {.axis = {.log = m->log_colour}};
    double lo = NAN, hi = NAN;
    for (ptrdiff_t i = 0; i < (ptrdiff_t)m->nx * m->ny; i++) {
        if (!ph_i_axis_has(&s.axis, m->value[i])) continue;
        lo = fmin(lo, m->value[i]);
        hi = fmax(hi, m->value[i]);
    }
    s.any = lo <= hi;
    if (m->range[0] != m->range[1]) {
        s.axis.lo = lo = m->range[0];
        s.axis.hi = hi = m->range[1];
    } else {
        ph_i_axis_range(&s.axis, lo, hi, 0);
    }
    s.diverging = !s.axis.log && lo < 0 && hi > 0;
    if (s.diverging) { /* white at zero, equal values equally strong */
        s.axis.hi = fmax(-s.axis.lo, s.axis.hi);
        s.axis.lo = -s.axis.hi;
    }
    return s;
}

static ph_i_colour colour_at(const scale *s, double t)
{
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    return s->diverging ? ph_i_diverging(t) : ph_i_sequential(t);
}

static ph_i_colour colour_of(const scale *s, double value)
{
    const ph_i_colour grey = {200, 200, 200};
    ph_i_axis unit = s->axis;
    unit.from = 0;
    unit.to = 1;
    return ph_i_axis_has(&unit, value) ? colour_at(s, ph_i_axis_place(&unit, value))
                                       : grey;
}

/* Name of a column or row: its own, or its number. */
static const char *name_of(const char *const *names, int k, char number[16])
{
    if (names) return names[k] ? names[k] : "";
    snprintf(number, 16, "%d", k + 1);
    return number;
}

static double widest_name(const char *const *names, int n)
{
    char number[16];
    double widest = 0;
    for (int k = 0; k < n; k++)
        widest = fmax(widest, ph_i_label_width(name_of(names, k, number), PH_I_SMALL));
    return widest;
}

static layout make_layout(const ph_heatmap *m, const ph_i_frame_text *t, scale *s)
{
    layout l = {.up = false};
    const double width = width_of(m), height = height_of(m), top = ph_i_title_height(t);
    const bool has_x = m->xlabel && m->xlabel[0], has_y = m->ylabel && m->ylabel[0];
    const bool has_value = m->value_label && m->value_label[0];
    const double names = fmin(widest_name(m->ynames, m->ny), 0.3 * width);
    ph_i_axis_ticks(&s->axis, (int)((height - top) / 50));
    double bar = BAR_WIDTH + 8 + ph_i_axis_label_width(&s->axis) + (has_value ? 20 : 0);
    l.cells.x = names + 12 + (has_y ? 20 : 0);
    l.cells.y = top;
    l.cells.width = fmax(width - l.cells.x - bar - 28, 20);
    l.cell_width = l.cells.width / m->nx;
    double below = widest_name(m->xnames, m->nx);
    l.up = below > fmax(l.cell_width, 2 * SMALL_CELL) - 4;
    below = l.up ? fmin(below, 0.3 * height) + 8 : 18;
    l.cells.height = fmax(height - top - below - (has_x ? 24 : 8), 20);
    l.cell_height = l.cells.height / m->ny;
    l.bar = (ph_i_box){l.cells.x + l.cells.width + 16, top, BAR_WIDTH, l.cells.height};
    s->axis.from = top + l.cells.height;
    s->axis.to = top;
    return l;
}

static bool is_dark(ph_i_colour c)
{
    return 0.30 * c.r + 0.59 * c.g + 0.11 * c.b < 140;
}

static void draw_cell_text(ph_i_canvas *c, const ph_heatmap *m, const layout *l,
                           const scale *s)
{
    const ph_i_colour black = {20, 20, 20}, white = {255, 255, 255};
    if (!m->cell_text || l->cell_height < SMALL_CELL) return;
    c->begin(c, "numbers", NULL, NULL);
    for (int j = 0; j < m->ny; j++)
        for (int i = 0; i < m->nx; i++) {
            double value = m->value[(ptrdiff_t)j * m->nx + i];
            char text[64];
            ph_i_short_number(text, sizeof text, 3, value + 0.0);
            if (!isfinite(value) ||
                ph_i_label_width(text, PH_I_SMALL) > l->cell_width - 2)
                continue;
            ph_i_canvas_text(c, l->cells.x + (i + 0.5) * l->cell_width,
                             l->cells.y + (j + 0.5) * l->cell_height + 3.5, text,
                             PH_I_MIDDLE, is_dark(colour_of(s, value)) ? white : black);
        }
    c->end(c);
}

static bool same_colour(ph_i_colour a, ph_i_colour b)
{
    return a.r == b.r && a.g == b.g && a.b == b.b;
}

/* A rectangle for every run of cells of one colour in a row. */
static void draw_cells(ph_i_canvas *c, const ph_heatmap *m, const layout *l,
                       const scale *s)
{
    c->begin(c, "cells", NULL, NULL);
    for (int j = 0; j < m->ny; j++)
        for (int i = 0, end; i < m->nx; i = end) {
            const double *row = m->value + (ptrdiff_t)j * m->nx;
            ph_i_colour colour = colour_of(s, row[i]);
            for (end = i + 1; end < m->nx && same_colour(colour, colour_of(s, row[end]));)
                end++;
            /* a little under the next ones, so that there are no seams */
            double right = end < m->nx ? 0.5 : 0, below = j + 1 < m->ny ? 0.5 : 0;
            c->rectangle(c,
                         (ph_i_box){l->cells.x + i * l->cell_width,
                                    l->cells.y + j * l->cell_height,
                                    (end - i) * l->cell_width + right,
                                    l->cell_height + below},
                         (ph_i_pen){colour, 0, 1, false});
        }
    c->end(c);
}

/* 1, 2, 5, 10, ...: at least x. */
static int stride(double x)
{
    static const int step[3] = {1, 2, 5};
    for (int ten = 1;; ten *= 10)
        for (int k = 0; k < 3; k++)
            if (step[k] * ten >= x) return step[k] * ten;
}

static void draw_names(ph_i_canvas *c, const ph_heatmap *m, const layout *l)
{
    const ph_i_colour black = {34, 34, 34};
    const double wide = l->up ? SMALL_CELL : widest_name(m->xnames, m->nx) + LETTER;
    const int xstride = stride(wide / l->cell_width);
    const int ystride = stride(SMALL_CELL / l->cell_height);
    char number[16], text[512];
    c->begin(c, "x-axis", NULL, NULL);
    for (int i = 0; i < m->nx; i += xstride) {
        ph_i_point at = {l->cells.x + (i + 0.5) * l->cell_width,
                         l->cells.y + l->cells.height};
        ph_i_label_fit(name_of(m->xnames, i, number), PH_I_SMALL,
                       l->up ? 0.3 * height_of(m) : 1e6, text);
        at.x += l->up ? 3.5 : 0;
        at.y += l->up ? 6 : 15;
        c->text(c, text,
                (ph_i_label){.at = at,
                             .size = PH_I_SMALL,
                             .up = l->up,
                             .colour = black,
                             .anchor = l->up ? PH_I_END : PH_I_MIDDLE});
    }
    c->end(c);
    c->begin(c, "y-axis", NULL, NULL);
    for (int j = 0; j < m->ny; j += ystride) {
        ph_i_label_fit(name_of(m->ynames, j, number), PH_I_SMALL, 0.3 * width_of(m),
                       text);
        ph_i_canvas_text(c, l->cells.x - 6, l->cells.y + (j + 0.5) * l->cell_height + 3.5,
                         text, PH_I_END, black);
    }
    c->end(c);
}

static void draw_bar(ph_i_canvas *c, const ph_heatmap *m, const layout *l, const scale *s)
{
    enum { STEPS = 128 };
    const ph_i_colour black = {34, 34, 34}, frame = {90, 90, 90};
    const double right = l->bar.x + l->bar.width;
    char text[512];
    c->begin(c, "colour-bar", NULL, NULL);
    for (int k = 0; k < STEPS; k++) {
        double y = l->bar.y + l->bar.height * (STEPS - 1 - k) / STEPS;
        double overlap = k > 0 ? 0.5 : 0; /* no seams between the steps */
        c->rectangle(
            c, (ph_i_box){l->bar.x, y, l->bar.width, l->bar.height / STEPS + overlap},
            (ph_i_pen){colour_at(s, k / (STEPS - 1.0)), 0, 1, false});
    }
    for (int k = 0; k < s->axis.nticks; k++) {
        double y = ph_i_axis_place(&s->axis, s->axis.tick[k].value);
        ph_i_canvas_segment(c, right, y, right + 4, y, (ph_i_pen){frame, 1, 1, false});
        ph_i_canvas_text(c, right + 7, y + 3.5, s->axis.tick[k].label, PH_I_START, black);
    }
    if (m->value_label && m->value_label[0]) {
        ph_i_label_fit(m->value_label, PH_I_SMALL, l->bar.height, text);
        c->text(c, text,
                (ph_i_label){.at = {right + 21 + ph_i_axis_label_width(&s->axis),
                                    l->bar.y + 0.5 * l->bar.height},
                             .size = PH_I_SMALL,
                             .anchor = PH_I_MIDDLE,
                             .up = true,
                             .colour = black});
    }
    c->end(c);
}

static ph_status draw_map(const void *what, ph_i_canvas *c, ph_error *err)
{
    (void)err;
    const ph_heatmap *m = what;
    const ph_i_frame_text t = {m->title, m->subtitle, m->xlabel, m->ylabel};
    scale s = make_scale(m);
    const layout l = make_layout(m, &t, &s);
    draw_cells(c, m, &l, &s);
    draw_cell_text(c, m, &l, &s);
    draw_names(c, m, &l);
    if (s.any) draw_bar(c, m, &l, &s);
    ph_i_draw_titles(c, &t, l.cells, width_of(m), height_of(m));
    return PH_OK;
}

ph_status ph_heatmap_svg(const ph_heatmap *map, char **text, ph_error *err)
{
    PH_GIVEN(map && text);
    ph_status st = PH_OK;
    PH_TRY(check_map(map, err));
    const ph_i_drawing d = {width_of(map), height_of(map), map->title, draw_map, map};
    PH_TRY(ph_i_drawing_svg(&d, text, err));
out:
    return st;
}

ph_status ph_heatmap_write(const char *path, const ph_heatmap *map, ph_error *err)
{
    PH_GIVEN(path && map);
    ph_status st = PH_OK;
    PH_TRY(check_map(map, err));
    const ph_i_drawing d = {width_of(map), height_of(map), map->title, draw_map, map};
    PH_TRY(ph_i_drawing_write(path, &d, err));
out:
    return st;
}
