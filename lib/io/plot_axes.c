/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Titles, grid, ticks and their labels. */
#include "io/plot_canvas.h"

#include <math.h>

static const ph_i_colour BLACK = {34, 34, 34}, GREY = {96, 96, 96},
                         PALE = {228, 228, 228}, FRAME = {90, 90, 90};

double ph_i_axis_label_width(const ph_i_axis *a)
{
    double widest = 0;
    for (int k = 0; k < a->nticks; k++)
        widest = fmax(widest, ph_i_label_width(a->tick[k].label, PH_I_SMALL));
    return widest;
}

static bool has_text(const char *text)
{
    return text && text[0];
}

double ph_i_title_height(const ph_i_frame_text *t)
{
    return 12 + (has_text(t->title) ? 18 : 0) + (has_text(t->subtitle) ? 15 : 0);
}

void ph_i_draw_titles(ph_i_canvas *c, const ph_i_frame_text *t, ph_i_box box, int width,
                      int height)
{
    char text[512];
    double y = 4;
    c->begin(c, "titles", NULL, NULL);
    if (has_text(t->title)) {
        y += 18;
        ph_i_label_fit(t->title, PH_I_LARGE, width - box.x - 8, text);
        c->text(c, text,
                (ph_i_label){.at = {box.x, y}, .size = PH_I_LARGE, .colour = BLACK});
    }
    if (has_text(t->subtitle)) {
        y += 15;
        ph_i_label_fit(t->subtitle, PH_I_SMALL, width - box.x - 8, text);
        ph_i_canvas_text(c, box.x, y, text, PH_I_START, GREY);
    }
    if (has_text(t->xlabel)) {
        ph_i_label_fit(t->xlabel, PH_I_SMALL, width - 16, text);
        ph_i_canvas_text(c, box.x + 0.5 * box.width, height - 10, text, PH_I_MIDDLE,
                         BLACK);
    }
    if (has_text(t->ylabel)) {
        ph_i_label_fit(t->ylabel, PH_I_SMALL, height - 16, text);
        c->text(c, text,
                (ph_i_label){.at = {18, box.y + 0.5 * box.height},
                             .size = PH_I_SMALL,
                             .anchor = PH_I_MIDDLE,
                             .up = true,
                             .colour = BLACK});
    }
    c->end(c);
}

void ph_i_draw_grid(ph_i_canvas *c, const ph_i_axis *x, const ph_i_axis *y, ph_i_box box)
{
    const ph_i_pen pen = {PALE, 1, 1, false};
    c->begin(c, "grid", NULL, NULL);
    for (int k = 0; k < x->nticks; k++) {
        double at = ph_i_axis_place(x, x->tick[k].value);
        if (x->tick[k].label[0])
            ph_i_canvas_segment(c, at, box.y, at, box.y + box.height, pen);
    }
    for (int k = 0; k < y->nticks; k++) {
        double at = ph_i_axis_place(y, y->tick[k].value);
        if (y->tick[k].label[0])
            ph_i_canvas_segment(c, box.x, at, box.x + box.width, at, pen);
    }
    c->end(c);
}

/* Ticks and labels of one axis: below the box, or at its left. */
static void draw_ticks(ph_i_canvas *c, const ph_i_axis *a, bool below, double edge)
{
    const ph_i_pen pen = {FRAME, 1, 1, false};
    double last = -INFINITY;
    c->begin(c, below ? "x-axis" : "y-axis", NULL, NULL);
    for (int k = 0; k < a->nticks; k++) {
        const ph_i_tick *t = &a->tick[k];
        double at = ph_i_axis_place(a, t->value), length = t->label[0] ? 5 : 3;
        if (below)
            ph_i_canvas_segment(c, at, edge, at, edge + length, pen);
        else
            ph_i_canvas_segment(c, edge - length, at, edge, at, pen);
        if (!t->label[0]) continue;
        double half = 0.5 * ph_i_label_width(t->label, PH_I_SMALL);
        if (below && at - half < last + 4) continue; /* would touch the one before */
        last = below ? at + half : last;
        if (below)
            ph_i_canvas_text(c, at, edge + 17, t->label, PH_I_MIDDLE, BLACK);
        else
            ph_i_canvas_text(c, edge - 8, at + 3.5, t->label, PH_I_END, BLACK);
    }
    c->end(c);
}

void ph_i_draw_axes(ph_i_canvas *c, const ph_i_axis *x, const ph_i_axis *y, ph_i_box box)
{
    const ph_i_pen pen = {FRAME, 1, 1, false};
    const ph_i_point corner[3] = {{box.x, box.y},
                                  {box.x, box.y + box.height},
                                  {box.x + box.width, box.y + box.height}};
    draw_ticks(c, x, true, box.y + box.height);
    draw_ticks(c, y, false, box.x);
    c->begin(c, "frame", NULL, NULL);
    c->line(c, 3, corner, pen);
    c->end(c);
}
