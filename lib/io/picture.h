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
/** ASCII text, top left corner at (x, y), letters 5 x 7 (with 2 below the line) times
 *  `scale`, edges smoothed. Bytes of other characters become one '?' each character. */
void ph_i_text(ph_i_picture *p, int x, int y, int scale, const char *text,
               ph_i_colour colour);
/** Width in pixels of a text. */
int ph_i_text_width(const char *text, int scale);
enum { PH_I_LETTER_WIDTH = 6, PH_I_LETTER_HEIGHT = 7 };

/** Rows of a glyph: bit 4 is the leftmost pixel of 5; rows 7 and 8 lie below the line. */
void ph_i_glyph(char letter, uint8_t rows[9]);

/** Write it (through a draft). */
ph_status ph_i_picture_write(const ph_i_picture *p, const char *path, ph_error *err);

#endif
