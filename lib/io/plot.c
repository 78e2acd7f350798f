/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/plot.h>

#include "io/plot_series.h"

#include <math.h>

/* Where everything is. */
typedef struct layout {
    ph_i_axis x, y;
    ph_i_box axes;
    ph_i_box legend;     /* width 0: none */
    double legend_width; /* wanted */
    int legend_lines;
} layout;

static const double LINE_HEIGHT = 15, SAMPLE = 24, GAP = 6;

static int width_of(const ph_plot *p)
{
    return p->width ? p->width : PH_PLOT_WIDTH;
}

static int height_of(const ph_plot *p)
{
    return p->height ? p->height : PH_PLOT_HEIGHT;
}

static bool is_named(const ph_series *s)
{
    return s->name && s->name[0];
}

static ph_status check_series(const ph_series *s, int k, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(s->style >= PH_PLOT_LINE && s->style <= PH_PLOT_STEPS, PH_EINVAL,
             "series %d: unknown style %d", k + 1, (int)s->style);
    PH_CHECK(s->n >= 0 && s->colour >= 0, PH_EINVAL, "series %d: %td points, colour %d",
             k + 1, s->n, s->colour);
    PH_CHECK(s->n == 0 || s->x, PH_EINVAL, "series %d: no x", k + 1);
    PH_CHECK(s->n == 0 || !s->low == !s->high, PH_EINVAL,
             "series %d: low and high come together", k + 1);
    PH_CHECK(s->n == 0 || (s->style == PH_PLOT_BAND ? s->low : s->y), PH_EINVAL,
             "series %d: no %s", k + 1, s->style == PH_PLOT_BAND ? "low and high" : "y");
    for (ptrdiff_t i = 0; s->style == PH_PLOT_BARS && i < s->n; i++)
        PH_CHECK(isfinite(s->x[i]) && (i == 0 || s->x[i] > s->x[i - 1]), PH_EINVAL,
                 "series %d: x of bars must be finite and rise, at point %td it is %g",
                 k + 1, i + 1, s->x[i]);
out:
    return st;
}

static ph_status check_plot(const ph_plot *p, ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(ph_i_check_size(p->width, p->height, err));
    PH_CHECK(p->nseries >= 0 && p->nseries <= PH_PLOT_SERIES &&
                 (p->nseries == 0 || p->series),
             PH_EINVAL, "%d series: 0 to %d", p->nseries, PH_PLOT_SERIES);
    PH_TRY(ph_i_check_range(p->x_range, p->log_x, "x", err));
    PH_TRY(ph_i_check_range(p->y_range, p->log_y, "y", err));
    for (int k = 0; k < p->nseries; k++)
        PH_TRY(check_series(&p->series[k], k, err));
out:
    return st;
}

/* The ranges; what the data say where the plot does not. True if there is anything. */
static bool set_ranges(const ph_plot *p, layout *l)
{
    double xr[2] = {NAN, NAN}, yr[2] = {NAN, NAN};
    l->x.log = p->log_x;
    l->y.log = p->log_y;
    for (int k = 0; k < p->nseries; k++)
        ph_i_series_range(&p->series[k], &l->x, &l->y, xr, yr);
    ph_i_axis_range(&l->x, xr[0], xr[1], 0.04);
    ph_i_axis_range(&l->y, yr[0], yr[1], 0.04);
    if (p->x_range[0] != p->x_range[1]) {
        l->x.lo = p->x_range[0];
        l->x.hi = p->x_range[1];
    }
    if (p->y_range[0] != p->y_range[1]) {
        l->y.lo = p->y_range[0];
        l->y.hi = p->y_range[1];
    }
    return xr[0] <= xr[1];
}

/* The box of the axes, with room at its right, and the ticks that fit. */
static void set_axes(const ph_plot *p, const ph_i_frame_text *t, double right, layout *l)
{
    const double top = ph_i_title_height(t), width = width_of(p), height = height_of(p);
    const double bottom = p->xlabel && p->xlabel[0] ? 46 : 28;
    l->axes.y = top;
    l->axes.height = fmax(height - top - bottom, 20);
    l->y.from = top + l->axes.height;
    l->y.to = top;
    ph_i_axis_ticks(&l->y, (int)(l->axes.height / 40));
    l->axes.x = ph_i_axis_label_width(&l->y) + 16 + (p->ylabel && p->ylabel[0] ? 20 : 0);
    l->axes.width = fmax(width - l->axes.x - 20 - right, 20);
    l->x.from = l->axes.x;
    l->x.to = l->axes.x + l->axes.width;
    int most = (int)(l->axes.width / 55);
    for (;; most--) { /* fewer where the labels are long */
        ph_i_axis_ticks(&l->x, most);
        double room = l->axes.width / (ph_i_axis_label_width(&l->x) + 8);
        int labels = 0;
        for (int k = 0; k < l->x.nticks; k++)
            labels += l->x.tick[k].label[0] != 0;
        if (labels <= room || most <= 2) break;
    }
}

static void measure_legend(const ph_plot *p, layout *l)
{
    double widest = 0;
    for (int k = 0; k < p->nseries; k++) {
        const ph_series *s = &p->series[k];
        if (!is_named(s)) continue;
        l->legend_lines++;
        widest = fmax(widest, ph_i_label_width(s->name, PH_I_SMALL));
    }
    l->legend_width = fmin(SAMPLE + 3 * GAP + widest, 0.35 * width_of(p));
}

static void draw_data(const ph_plot *p, const layout *l, ph_i_series_work *work,
                      ph_i_canvas *c)
{
    /* areas first, so that lines and marks lie on them */
    for (int pass = 0; pass < 2; pass++)
        for (int k = 0; k < p->nseries; k++) {
            const ph_series *s = &p->series[k];
            bool area = s->style == PH_PLOT_BAND || s->style == PH_PLOT_BARS;
            if (area == (pass == 0))
                ph_i_series_draw(c, s, k, &l->x, &l->y, l->axes, work);
        }
}

/* The corner with the fewest marks under the legend; false if none is free. */
static bool find_corner(const ph_plot *p, layout *l, ph_i_series_work *work)
{
    ph_i_probe probe;
    const double w = l->legend_width, h = l->legend_lines * LINE_HEIGHT + GAP;
    const ph_i_box *a = &l->axes;
    const double left = a->x + 8, right = a->x + a->width - w - 2;
    const double top = a->y + 2, bottom = a->y + a->height - h - 8;
    const ph_i_point corner[] = {
        {right, top}, {left, top}, {right, bottom}, {left, bottom}};
    if (w > 0.6 * a->width || h > 0.6 * a->height) return false;
    ph_i_probe_open(&probe, *a);
    draw_data(p, l, work, &probe.canvas);
    for (int k = 0; k < 4; k++) {
        ph_i_box box = {corner[k].x, corner[k].y, w, h};
        ph_i_box wide = {box.x - 6, box.y - 6, w + 12, h + 12};
        if (ph_i_probe_count(&probe, wide) > 0) continue;
        l->legend = box;
        return true;
    }
    return false;
}

static void draw_legend(const ph_plot *p, const layout *l, ph_i_canvas *c)
{
    const ph_i_colour black = {34, 34, 34}, white = {255, 255, 255};
    char text[512];
    double y = l->legend.y + GAP / 2;
    if (l->legend.width <= 0) return;
    c->begin(c, "legend", NULL, NULL);
    c->rectangle(c, l->legend, (ph_i_pen){white, 0, 0.8, false});
    for (int k = 0; k < p->nseries; k++) {
        const ph_series *s = &p->series[k];
        if (!is_named(s)) continue;
        if (y + LINE_HEIGHT > height_of(p)) break;
        ph_i_series_sample(c, s, k, l->legend.x + GAP, y + LINE_HEIGHT / 2);
        ph_i_label_fit(s->name, PH_I_SMALL, l->legend.width - SAMPLE - 2 * GAP, text);
        ph_i_canvas_text(c, l->legend.x + SAMPLE + 2 * GAP, y + LINE_HEIGHT / 2 + 3.5,
                         text, PH_I_START, black);
        y += LINE_HEIGHT;
    }
    c->end(c);
}

static ph_status draw_plot(const void *what, ph_i_canvas *c, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_plot *p = what;
    const ph_i_frame_text t = {p->title, p->subtitle, p->xlabel, p->ylabel};
    const ph_i_colour grey = {96, 96, 96};
    ph_i_series_work work = {.point = NULL};
    layout l = {.legend_lines = 0};
    bool any = set_ranges(p, &l);
    PH_TRY(ph_i_series_work_new(width_of(p), height_of(p), &work, err));
    set_axes(p, &t, 0, &l);
    measure_legend(p, &l);
    if (l.legend_lines > 0 && !find_corner(p, &l, &work)) {
        set_axes(p, &t, l.legend_width + 4, &l);
        l.legend = (ph_i_box){l.axes.x + l.axes.width + 12, l.axes.y, l.legend_width,
                              l.legend_lines * LINE_HEIGHT + GAP};
    }
    ph_i_draw_grid(c, &l.x, &l.y, l.axes);
    draw_data(p, &l, &work, c);
    ph_i_draw_axes(c, &l.x, &l.y, l.axes);
    draw_legend(p, &l, c);
    if (!any)
        ph_i_canvas_text(c, l.axes.x + l.axes.width / 2, l.axes.y + l.axes.height / 2,
                         "no data", PH_I_MIDDLE, grey);
    ph_i_draw_titles(c, &t, l.axes, width_of(p), height_of(p));
out:
    ph_i_series_work_free(&work);
    return st;
}

ph_status ph_plot_svg(const ph_plot *plot, char **text, ph_error *err)
{
    PH_GIVEN(plot && text);
    ph_status st = PH_OK;
    PH_TRY(check_plot(plot, err));
    const ph_i_drawing d = {width_of(plot), height_of(plot), plot->title, draw_plot,
                            plot};
    PH_TRY(ph_i_drawing_svg(&d, text, err));
out:
    return st;
}

ph_status ph_plot_write(const char *path, const ph_plot *plot, ph_error *err)
{
    PH_GIVEN(path && plot);
    ph_status st = PH_OK;
    PH_TRY(check_plot(plot, err));
    const ph_i_drawing d = {width_of(plot), height_of(plot), plot->title, draw_plot,
                            plot};
    PH_TRY(ph_i_drawing_write(path, &d, err));
out:
    return st;
}
