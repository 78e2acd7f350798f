/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A small rasteriser: colours, rectangles, text, PNG. */
#ifndef PH_IO_PICTURE_H
#define PH_IO_PICTURE_H

#include "core/check.h"

#include <stdint.h>

typedef struct ph_i_colour {
    uint8_t r, g, b;
} ph_i_colour;

/** sRGB colour of lightness L, chroma C and hue (degrees) in OKLab, chroma reduced until it
 *  can be shown. Ref: [Ottosson2020]. */
ph_i_colour ph_i_oklch(double L, double C, double hue);
/** Dark violet to bright yellow, even steps in lightness. 0 <= t <= 1. */
ph_i_colour ph_i_sequential(double t);
/** Blue, nearly white at t = 0.5, red; both sides equally light. */
ph_i_colour ph_i_diverging(double t);
/** Colour of material `i`: distinct, the first ones chosen, then by the golden angle. */
ph_i_colour ph_i_material_colour(int i, bool is_void);
/** (1-f) a + f b of the light, not of the codes. */
ph_i_colour ph_i_mix_colours(ph_i_colour a, ph_i_colour b, double f);

typedef struct ph_i_picture {
    int width, height;
    ph_i_colour *pixel; /* [height][width], top row first */
} ph_i_picture;

/** White. */
ph_status ph_i_picture_new(int width, int height, ph_i_picture *out, ph_error *err);
void ph_i_picture_free(ph_i_picture *picture);
/** Filled rectangle, clipped. */
void ph_i_fill(ph_i_picture *p, int x, int y, int width, int height, ph_i_colour colour);
/** One pixel wide frame just outside of a rectangle. */
void ph_i_frame(ph_i_picture *p, int x, int y, int width, int height, ph_i_colour colour);
/** UTF-8 text, top left corner at (x, y), letters 5 x 7 (with 2 below the line) times
 *  `scale`, edges smoothed. ASCII, Greek letters and signs of formulas (font.c) are drawn;
 *  other characters become one '?' each. */
void ph_i_text(ph_i_picture *p, int x, int y, int scale, const char *text,
               ph_i_colour colour);
/** Width in pixels of a text. */
int ph_i_text_width(const char *text, int scale);
enum { PH_I_LETTER_WIDTH = 6, PH_I_LETTER_HEIGHT = 7 };

/** The same read from below to above; (x, y) is the lower left corner. */
void ph_i_text_up(ph_i_picture *p, int x, int y, int scale, const char *text,
                  ph_i_colour colour);

/** Rows of a glyph: bit 4 is the leftmost pixel of 5; rows 7 and 8 lie below the line. */
void ph_i_glyph(uint32_t code, uint8_t rows[9]);

/** How much of each pixel a shape covers, to be painted in one go, so that the parts of a
 *  line do not add up where they meet. */
typedef struct ph_i_mask {
    int width, height;
    uint8_t *cover;               /* [height][width], 255 is all */
    int x0, y0, x1, y1;           /* only here something is drawn */
    int left, top, right, bottom; /* and only here something is covered now */
} ph_i_mask;
ph_status ph_i_mask_new(int width, int height, ph_i_mask *out, ph_error *err);
void ph_i_mask_free(ph_i_mask *mask);
/** A line of this width with round ends. Cost: the pixels it covers. */
void ph_i_mask_segment(ph_i_mask *m, const double from[2], const double to[2],
                       double width);
/** A polygon, closed by itself, even-odd; its corners are `scale` times these points. */
typedef struct ph_i_point {
    double x, y;
} ph_i_point;
void ph_i_mask_polygon(ph_i_mask *m, ptrdiff_t n, const ph_i_point *p, double scale);
/** Paint what is covered and begin anew. 0 <= opacity <= 1. */
void ph_i_mask_paint(ph_i_mask *m, ph_i_picture *p, ph_i_colour colour, double opacity);

/** Write it (through a draft). */
ph_status ph_i_picture_write(const ph_i_picture *p, const char *path, ph_error *err);

#endif
