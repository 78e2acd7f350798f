/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plots as SVG: no style sheet, no identifier, so that several can stand in one page. */
#include "io/plot_canvas.h"

#include <math.h>
#include <string.h>

static ph_i_growing *out_of(ph_i_canvas *c)
{
    return &((ph_i_svg *)c)->out;
}

/* A length with two decimals. */
static void put_length(ph_i_growing *g, double x)
{
    ph_i_append_number(g, rint(x * 100) / 100 + 0.0, 8);
}

static void put_point(ph_i_growing *g, const char *before, ph_i_point p)
{
    ph_i_append(g, before, strlen(before));
    put_length(g, p.x);
    ph_i_append(g, " ", 1);
    put_length(g, p.y);
}

static void put_attribute(ph_i_growing *g, const char *name, double x)
{
    ph_i_appendf(g, " %s=\"", name);
    put_length(g, x);
    ph_i_append(g, "\"", 1);
}

static void put_colour(ph_i_growing *g, const char *name, ph_i_colour c)
{
    ph_i_appendf(g, " %s=\"#%02x%02x%02x\"", name, c.r, c.g, c.b);
}

static void put_path(ph_i_growing *g, ptrdiff_t n, const ph_i_point *p)
{
    ph_i_appendf(g, "<path d=\"");
    for (ptrdiff_t i = 0; i < n; i++)
        put_point(g, i == 0 ? "M" : i == 1 ? "L" : " ", p[i]);
}

static void svg_line(ph_i_canvas *c, ptrdiff_t n, const ph_i_point *p, ph_i_pen pen)
{
    ph_i_growing *g = out_of(c);
    put_path(g, n, p);
    ph_i_appendf(g, "\" fill=\"none\"");
    put_colour(g, "stroke", pen.colour);
    put_attribute(g, "stroke-width", pen.width);
    if (pen.opacity < 1) put_attribute(g, "stroke-opacity", pen.opacity);
    if (pen.dashed) ph_i_appendf(g, " stroke-dasharray=\"6 4\"");
    ph_i_appendf(g, " stroke-linejoin=\"round\"/>\n");
}

static void svg_fill(ph_i_canvas *c, ptrdiff_t n, const ph_i_point *p, ph_i_pen pen)
{
    ph_i_growing *g = out_of(c);
    put_path(g, n, p);
    ph_i_appendf(g, "Z\"");
    put_colour(g, "fill", pen.colour);
    if (pen.opacity < 1) put_attribute(g, "fill-opacity", pen.opacity);
    ph_i_appendf(g, "/>\n");
}

static void svg_rectangle(ph_i_canvas *c, ph_i_box box, ph_i_pen pen)
{
    ph_i_growing *g = out_of(c);
    ph_i_appendf(g, "<rect");
    put_attribute(g, "x", box.x);
    put_attribute(g, "y", box.y);
    put_attribute(g, "width", box.width);
    put_attribute(g, "height", box.height);
    put_colour(g, "fill", pen.colour);
    if (pen.opacity < 1) put_attribute(g, "fill-opacity", pen.opacity);
    ph_i_appendf(g, "/>\n");
}

/* What comes after the centre of each mark: a disk is a line of no length with round ends. */
static void put_outline(ph_i_growing *g, int shape, double radius)
{
    ph_i_point corner[4], at = {0, 0};
    int n = ph_i_mark_outline(shape, radius, corner);
    if (n == 0) ph_i_append(g, "h0", 2);
    for (int k = 0; k < n; k++) {
        put_point(g,
                  k == 0   ? "m"
                  : k == 1 ? "l"
                           : " ",
                  (ph_i_point){corner[k].x - at.x, corner[k].y - at.y});
        at = corner[k];
    }
    if (n > 0) ph_i_append(g, "z", 1);
}

static void svg_marks(ph_i_canvas *c, ptrdiff_t n, const ph_i_point *p, int shape,
                      ph_i_pen pen)
{
    ph_i_growing *g = out_of(c), outline = {.text = NULL};
    put_outline(&outline, shape, 0.5 * pen.width);
    ph_i_appendf(g, "<path d=\"");
    for (ptrdiff_t i = 0; i < n && !outline.failed; i++) {
        put_point(g, "M", p[i]);
        ph_i_append(g, outline.text, outline.length);
    }
    if (outline.failed) g->failed = true;
    free(outline.text);
    ph_i_append(g, "\"", 1);
    if (shape == 0) {
        put_colour(g, "stroke", pen.colour);
        put_attribute(g, "stroke-width", pen.width);
        ph_i_appendf(g, " stroke-linecap=\"round\"/>\n");
    } else {
        put_colour(g, "fill", pen.colour);
        ph_i_appendf(g, "/>\n");
    }
}

static void svg_text(ph_i_canvas *c, const char *text, ph_i_label how)
{
    static const char *const anchors[] = {"start", "middle", "end"};
    ph_i_growing *g = out_of(c);
    ph_i_appendf(g, "<text");
    put_attribute(g, "x", how.at.x);
    put_attribute(g, "y", how.at.y);
    if (how.up) {
        put_point(g, " transform=\"rotate(-90 ", how.at);
        ph_i_appendf(g, ")\"");
    }
    if (how.anchor != PH_I_START)
        ph_i_appendf(g, " text-anchor=\"%s\"", anchors[how.anchor]);
    if (how.size != PH_I_SMALL) ph_i_appendf(g, " font-size=\"%d\"", how.size);
    if (how.size == PH_I_LARGE) ph_i_appendf(g, " font-weight=\"bold\"");
    put_colour(g, "fill", how.colour);
    ph_i_append(g, ">", 1);
    ph_i_append_xml(g, text);
    ph_i_appendf(g, "</text>\n");
}

/* An inner <svg> clips without an identifier. */
static void svg_begin(ph_i_canvas *c, const char *role, const char *name,
                      const ph_i_box *clip)
{
    ph_i_growing *g = out_of(c);
    ((ph_i_svg *)c)->nested = clip != NULL;
    ph_i_appendf(g, "<g class=\"%s\"", role);
    if (name && name[0]) {
        ph_i_appendf(g, " data-name=\"");
        ph_i_append_xml(g, name);
        ph_i_append(g, "\"", 1);
    }
    ph_i_appendf(g, ">\n");
    if (!clip) return;
    ph_i_appendf(g, "<svg");
    put_attribute(g, "x", clip->x);
    put_attribute(g, "y", clip->y);
    put_attribute(g, "width", clip->width);
    put_attribute(g, "height", clip->height);
    put_point(g, " viewBox=\"", (ph_i_point){clip->x, clip->y});
    put_point(g, " ", (ph_i_point){clip->width, clip->height});
    ph_i_appendf(g, "\">\n");
}

static void svg_end(ph_i_canvas *c)
{
    ph_i_svg *svg = (ph_i_svg *)c;
    ph_i_appendf(&svg->out, svg->nested ? "</svg>\n</g>\n" : "</g>\n");
    svg->nested = false;
}

void ph_i_svg_open(ph_i_svg *svg, int width, int height, const char *title)
{
    *svg = (ph_i_svg){.canvas = {svg_line, svg_fill, svg_rectangle, svg_marks, svg_text,
                                 svg_begin, svg_end}};
    ph_i_growing *g = &svg->out;
    ph_i_appendf(g,
                 "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" "
                 "viewBox=\"0 0 %d %d\" role=\"img\" font-family=\"Helvetica, Arial, "
                 "sans-serif\" font-size=\"%d\">\n",
                 width, height, width, height, PH_I_SMALL);
    if (title && title[0]) {
        ph_i_appendf(g, "<title>");
        ph_i_append_xml(g, title);
        ph_i_appendf(g, "</title>\n");
    }
    ph_i_appendf(g, "<rect width=\"%d\" height=\"%d\" fill=\"#ffffff\"/>\n", width,
                 height);
}

void ph_i_svg_close(ph_i_svg *svg)
{
    ph_i_appendf(&svg->out, "</svg>\n");
}
