/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/plot_series.h"

#include <math.h>
#include <string.h>

static const double LINE = 1.6, BAR = 1, MARK = 6, SHADE = 0.25;

/* A place on the canvas that has finite differences with others. */
static double place(const ph_i_axis *a, double value)
{
    return fmin(fmax(ph_i_axis_place(a, value), -1e7), 1e7);
}

/* Vertices on their way to the canvas: thinned to first, least, greatest and last of each
 * column of half a unit, cut at the edge of the box. */
typedef struct stream {
    ph_i_canvas *canvas;
    ph_i_pen pen;
    ph_i_box box;      /* a little more than the axes */
    ph_i_point *out;   /* [room] */
    ptrdiff_t n, room; /* vertices of the path now */
    ph_i_point previous;
    bool started;
    double column; /* the vertices of the column now, and when they came */
    ptrdiff_t count, least_at, greatest_at;
    ph_i_point first, least, greatest, last;
} stream;

static void flush(stream *s)
{
    ph_i_pen dot = s->pen;
    dot.width = 2 * s->pen.width;
    if (s->n > 1) s->canvas->line(s->canvas, s->n, s->out, s->pen);
    if (s->n == 1) s->canvas->marks(s->canvas, 1, s->out, 0, dot); /* all alone */
    s->n = 0;
}

static bool is_inside(ph_i_box b, ph_i_point p)
{
    return p.x >= b.x && p.x <= b.x + b.width && p.y >= b.y && p.y <= b.y + b.height;
}

/* Part of the segment inside of the box as shares of it; false if none (Liang-Barsky). */
static bool inside_part(ph_i_box b, ph_i_point p, ph_i_point q, double part[2])
{
    const double d[2] = {q.x - p.x, q.y - p.y};
    const double below[2] = {b.x - p.x, b.y - p.y};
    const double above[2] = {b.x + b.width - p.x, b.y + b.height - p.y};
    part[0] = 0;
    part[1] = 1;
    for (int k = 0; k < 2; k++) {
        if (d[k] == 0 && (below[k] > 0 || above[k] < 0)) return false;
        if (d[k] == 0) continue;
        double enter = (d[k] > 0 ? below[k] : above[k]) / d[k];
        double leave = (d[k] > 0 ? above[k] : below[k]) / d[k];
        part[0] = fmax(part[0], enter);
        part[1] = fmin(part[1], leave);
    }
    return part[0] < part[1];
}

static void put(stream *s, ph_i_point p)
{
    if (s->n == s->room) { /* go on with a new path from its end */
        ph_i_point end = s->out[s->n - 1];
        flush(s);
        s->out[s->n++] = end;
    }
    s->out[s->n++] = p;
}

/* A segment to p from where the line has come to. */
static void go_to(stream *s, ph_i_point from, ph_i_point p)
{
    double part[2];
    if (!inside_part(s->box, from, p, part)) {
        flush(s);
        return;
    }
    const ph_i_point d = {p.x - from.x, p.y - from.y};
    if (part[0] > 0) flush(s);
    if (s->n == 0) put(s, (ph_i_point){from.x + part[0] * d.x, from.y + part[0] * d.y});
    put(s,
        part[1] < 1 ? (ph_i_point){from.x + part[1] * d.x, from.y + part[1] * d.y} : p);
    if (part[1] < 1) flush(s);
}

static void vertex(stream *s, ph_i_point p)
{
    if (s->started)
        go_to(s, s->previous, p);
    else if (is_inside(s->box, p))
        put(s, p);
    s->started = true;
    s->previous = p;
}

static bool same_point(ph_i_point p, ph_i_point q)
{
    return p.x == q.x && p.y == q.y;
}

static void end_column(stream *s)
{
    if (s->count == 0) return;
    bool up = s->least_at < s->greatest_at;
    const ph_i_point p[4] = {s->first, up ? s->least : s->greatest,
                             up ? s->greatest : s->least, s->last};
    for (int k = 0; k < 4; k++)
        if (k == 0 || !same_point(p[k], p[k - 1])) vertex(s, p[k]);
    s->count = 0;
}

static void add(stream *s, ph_i_point p)
{
    double column = floor(2 * p.x);
    if (column != s->column) end_column(s);
    if (s->count == 0) {
        s->column = column;
        s->first = s->least = s->greatest = p;
        s->least_at = s->greatest_at = 0;
    }
    if (p.y < s->least.y) {
        s->least = p;
        s->least_at = s->count;
    }
    if (p.y > s->greatest.y) {
        s->greatest = p;
        s->greatest_at = s->count;
    }
    s->last = p;
    s->count++;
}

static void gap(stream *s)
{
    end_column(s);
    flush(s);
    s->started = false;
}

/* What all parts of a series share. */
typedef struct painter {
    ph_i_canvas *canvas;
    const ph_series *s;
    const ph_i_axis *x, *y;
    ph_i_box box;
    ph_i_series_work *work;
    ph_i_colour colour;
    int shape;
} painter;

static bool has(const painter *p, ptrdiff_t i, const double *y)
{
    return ph_i_axis_has(p->x, p->s->x[i]) && ph_i_axis_has(p->y, y[i]);
}

static void draw_line(const painter *p, bool steps)
{
    const ph_series *s = p->s;
    stream to = {.canvas = p->canvas,
                 .pen = {p->colour, LINE, 1, s->dashed},
                 .box = {p->box.x - 4, p->box.y - 4, p->box.width + 8, p->box.height + 8},
                 .out = p->work->point,
                 .room = p->work->room};
    for (ptrdiff_t i = 0; i < s->n; i++) {
        if (!has(p, i, s->y)) {
            gap(&to);
            continue;
        }
        ph_i_point at = {place(p->x, s->x[i]), place(p->y, s->y[i])};
        add(&to, at);
        if (!steps || i + 1 == s->n || !ph_i_axis_has(p->x, s->x[i + 1])) continue;
        at.x = place(p->x, s->x[i + 1]);
        add(&to, at);
    }
    gap(&to);
}

/* Whether a unit of the axes has no mark yet; it has one then. */
static bool take_unit(const painter *p, ph_i_point at)
{
    if (!is_inside(p->box, at)) return false;
    int column = (int)(at.x - p->box.x), row = (int)(at.y - p->box.y);
    if (column >= p->work->columns || row >= p->work->rows) return false;
    uint8_t *seen = &p->work->seen[row * p->work->columns + column];
    bool is_new = !*seen;
    *seen = 1;
    return is_new;
}

static void clear_units(const painter *p)
{
    memset(p->work->seen, 0, (size_t)p->work->rows * (size_t)p->work->columns);
}

static void draw_marks(const painter *p)
{
    const ph_series *s = p->s;
    const ph_i_pen pen = {p->colour, MARK, 1, false};
    ptrdiff_t n = 0;
    clear_units(p);
    for (ptrdiff_t i = 0; i < s->n; i++) {
        if (!has(p, i, s->y)) continue;
        ph_i_point at = {place(p->x, s->x[i]), place(p->y, s->y[i])};
        if (!take_unit(p, at)) continue;
        p->work->point[n++] = at;
        if (n < p->work->room) continue;
        p->canvas->marks(p->canvas, n, p->work->point, p->shape, pen);
        n = 0;
    }
    if (n > 0) p->canvas->marks(p->canvas, n, p->work->point, p->shape, pen);
}

/* Place of the end of an error bar, cut at the axes; below a logarithmic axis: its end. */
static double bar_end(const painter *p, double value)
{
    const double top = p->box.y, bottom = p->box.y + p->box.height;
    if (p->y->log && !ph_i_axis_has(p->y, value)) return value <= 0 ? bottom : top;
    return fmin(fmax(place(p->y, value), top), bottom);
}

static void draw_errors(const painter *p)
{
    const ph_series *s = p->s;
    const ph_i_pen pen = {p->colour, BAR, 0.8, false};
    clear_units(p);
    for (ptrdiff_t i = 0; i < s->n; i++) {
        if (!has(p, i, s->y) || isnan(s->low[i]) || isnan(s->high[i])) continue;
        ph_i_point at = {place(p->x, s->x[i]), place(p->y, s->y[i])};
        double low = bar_end(p, s->low[i]), high = bar_end(p, s->high[i]);
        if (at.x < p->box.x || at.x > p->box.x + p->box.width) continue;
        if (is_inside(p->box, at) && !take_unit(p, at)) continue;
        if (low == high) continue; /* nothing to see, or all of it outside */
        ph_i_canvas_segment(p->canvas, at.x, low, at.x, high, pen);
        ph_i_canvas_segment(p->canvas, at.x - 3, low, at.x + 3, low, pen);
        ph_i_canvas_segment(p->canvas, at.x - 3, high, at.x + 3, high, pen);
    }
}

/* The area of the first n places: `room` of low ends, then `room` of high ones. */
static void fill_band(const painter *p, ptrdiff_t n)
{
    ph_i_point *low = p->work->point, *high = low + p->work->room;
    for (ptrdiff_t i = 0; i < n; i++)
        low[n + i] = high[n - 1 - i]; /* the way back, in place: n <= room / 2 */
    if (n > 1)
        p->canvas->fill(p->canvas, 2 * n, low, (ph_i_pen){p->colour, 0, SHADE, false});
}

static void draw_band(const painter *p)
{
    const ph_series *s = p->s;
    ph_i_point *low = p->work->point, *high = low + p->work->room;
    ptrdiff_t n = 0;
    double column = NAN;
    for (ptrdiff_t i = 0; i < s->n; i++) {
        if (!has(p, i, s->low) || !has(p, i, s->high)) {
            fill_band(p, n);
            n = 0;
            column = NAN;
            continue;
        }
        double x = place(p->x, s->x[i]);
        ph_i_point a = {x, place(p->y, s->low[i])}, b = {x, place(p->y, s->high[i])};
        if (floor(2 * x) == column && n > 1) { /* widen what is there */
            low[n - 1] = (ph_i_point){x, fmax(low[n - 1].y, a.y)};
            high[n - 1] = (ph_i_point){x, fmin(high[n - 1].y, b.y)};
            continue;
        }
        if (2 * n == p->work->room) {
            fill_band(p, n);
            n = 0;
        }
        column = floor(2 * x);
        low[n] = a;
        high[n++] = b;
    }
    fill_band(p, n);
}

/* Edges of bar i: half way to its neighbours, on the canvas. */
static void bar_edges(const ph_series *s, const ph_i_axis *x, ptrdiff_t i, double edge[2])
{
    double at = place(x, s->x[i]), alone = 0.05 * fabs(x->to - x->from);
    double before = i > 0 ? 0.5 * (at - place(x, s->x[i - 1])) : (double)NAN;
    double behind = i + 1 < s->n ? 0.5 * (place(x, s->x[i + 1]) - at) : (double)NAN;
    before = isnan(before) ? behind : before;
    behind = isnan(behind) ? before : behind;
    edge[0] = at - (isnan(before) ? alone : before);
    edge[1] = at + (isnan(behind) ? alone : behind);
}

static void draw_bars(const painter *p)
{
    const ph_series *s = p->s;
    const double bottom = p->box.y + p->box.height;
    const double zero = p->y->log ? bottom : place(p->y, 0);
    for (ptrdiff_t i = 0; i < s->n; i++) {
        double edge[2];
        if (!has(p, i, s->y)) continue;
        bar_edges(s, p->x, i, edge);
        double y = place(p->y, s->y[i]), top = fmax(fmin(y, zero), p->box.y);
        double gap_width = edge[1] - edge[0] > 6 ? 0.5 : 0;
        ph_i_box bar = {edge[0] + gap_width, top, edge[1] - edge[0] - 2 * gap_width,
                        fmin(fmax(y, zero), bottom) - top};
        if (bar.height <= 0 || bar.x > p->box.x + p->box.width ||
            bar.x + bar.width < p->box.x)
            continue;
        p->canvas->rectangle(p->canvas, bar, (ph_i_pen){p->colour, 0, 0.7, false});
    }
}

static bool has_line(const ph_series *s)
{
    return s->style == PH_PLOT_LINE || s->style == PH_PLOT_LINE_POINTS ||
           (s->style == PH_PLOT_BAND && s->y);
}

static bool has_marks(const ph_series *s)
{
    return s->style == PH_PLOT_POINTS || s->style == PH_PLOT_LINE_POINTS;
}

static ph_i_colour colour_of(const ph_series *s, int k)
{
    return ph_i_series_colour(s->colour > 0 ? s->colour - 1 : k);
}

static int shape_of(const ph_series *s, int k)
{
    return (s->colour > 0 ? s->colour - 1 : k) % PH_I_MARKS;
}

void ph_i_series_draw(ph_i_canvas *c, const ph_series *s, int k, const ph_i_axis *x,
                      const ph_i_axis *y, ph_i_box box, ph_i_series_work *w)
{
    const painter p = {c, s, x, y, box, w, colour_of(s, k), shape_of(s, k)};
    c->begin(c, "series", s->name, &box);
    if (s->style == PH_PLOT_BAND) draw_band(&p);
    if (s->style == PH_PLOT_BARS) draw_bars(&p);
    if (s->style != PH_PLOT_BAND && s->low) draw_errors(&p);
    if (has_line(s) || s->style == PH_PLOT_STEPS)
        draw_line(&p, s->style == PH_PLOT_STEPS);
    if (has_marks(s)) draw_marks(&p);
    c->end(c);
}

void ph_i_series_sample(ph_i_canvas *c, const ph_series *s, int k, double x, double y)
{
    const ph_i_colour colour = colour_of(s, k);
    const ph_i_point middle = {x + 12, y};
    if (s->style == PH_PLOT_BAND)
        c->rectangle(c, (ph_i_box){x, y - 4, 24, 8}, (ph_i_pen){colour, 0, SHADE, false});
    if (s->style == PH_PLOT_BARS)
        c->rectangle(c, (ph_i_box){x + 6, y - 4, 12, 8},
                     (ph_i_pen){colour, 0, 0.7, false});
    if (has_line(s) || s->style == PH_PLOT_STEPS)
        ph_i_canvas_segment(c, x, y, x + 24, y, (ph_i_pen){colour, LINE, 1, s->dashed});
    if (has_marks(s))
        c->marks(c, 1, &middle, shape_of(s, k), (ph_i_pen){colour, MARK, 1, false});
}

static void widen(double range[2], double value)
{
    if (!(range[0] <= value)) range[0] = value;
    if (!(range[1] >= value)) range[1] = value;
}

/* Half the distance to the neighbour at an end of a histogram, as seen on the axis. */
static double edge_value(const ph_series *s, const ph_i_axis *x, ptrdiff_t end,
                         ptrdiff_t next)
{
    double ratio = s->x[end] / s->x[next];
    return x->log ? s->x[end] * sqrt(ratio) : s->x[end] + 0.5 * (s->x[end] - s->x[next]);
}

void ph_i_series_range(const ph_series *s, const ph_i_axis *x, const ph_i_axis *y,
                       double xr[2], double yr[2])
{
    for (ptrdiff_t i = 0; i < s->n; i++) {
        const double *part[3] = {s->y, s->low, s->high};
        bool shown = false;
        if (!ph_i_axis_has(x, s->x[i])) continue;
        for (int k = s->y && s->style != PH_PLOT_BAND && !ph_i_axis_has(y, s->y[i]) ? 3
                                                                                    : 0;
             k < 3; k++) {
            if (!part[k] || !ph_i_axis_has(y, part[k][i])) continue;
            widen(yr, part[k][i]);
            shown = true;
        }
        if (shown) widen(xr, s->x[i]);
    }
    if (s->style != PH_PLOT_BARS || !(xr[0] <= xr[1])) return;
    if (!y->log) widen(yr, 0);
    if (s->n < 2) return;
    widen(xr, edge_value(s, x, 0, 1));
    widen(xr, edge_value(s, x, s->n - 1, s->n - 2));
}

ph_status ph_i_series_work_new(int width, int height, ph_i_series_work *out,
                               ph_error *err)
{
    ph_status st = PH_OK;
    out->room = 16 * (ptrdiff_t)width; /* four vertices a column of half a unit, twice */
    out->rows = height;
    out->columns = width;
    PH_ALLOC(out->point, 2 * out->room, "the points of a plot");
    PH_ALLOC(out->seen, (ptrdiff_t)width * height, "the marks of a plot");
out:
    return st;
}

void ph_i_series_work_free(ph_i_series_work *w)
{
    free(w->point);
    free(w->seen);
    w->point = NULL;
    w->seen = NULL;
}
