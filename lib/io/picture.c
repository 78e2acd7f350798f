/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/picture.h"

#include "io/draft.h"
#include "io/text.h"

#include <png.h>

#include <errno.h>
#include <string.h>

ph_status ph_i_picture_new(int width, int height, ph_i_picture *out, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(width > 0 && height > 0 && width <= 1 << 16 && height <= 1 << 16, PH_EINVAL,
             "a picture of %d x %d pixels", width, height);
    PH_ALLOC(out->pixel, (size_t)width * (size_t)height, "the picture");
    out->width = width;
    out->height = height;
    memset(out->pixel, 255, (size_t)width * (size_t)height * sizeof *out->pixel);
out:
    return st;
}

void ph_i_picture_free(ph_i_picture *picture)
{
    free(picture->pixel);
    picture->pixel = NULL;
}

void ph_i_fill(ph_i_picture *p, int x, int y, int width, int height, ph_i_colour colour)
{
    int right = x + width < p->width ? x + width : p->width;
    int bottom = y + height < p->height ? y + height : p->height;
    for (int row = y > 0 ? y : 0; row < bottom; row++)
        for (int column = x > 0 ? x : 0; column < right; column++)
            p->pixel[(size_t)row * (size_t)p->width + (size_t)column] = colour;
}

void ph_i_frame(ph_i_picture *p, int x, int y, int width, int height, ph_i_colour colour)
{
    ph_i_fill(p, x - 1, y - 1, width + 2, 1, colour);
    ph_i_fill(p, x - 1, y + height, width + 2, 1, colour);
    ph_i_fill(p, x - 1, y, 1, height, colour);
    ph_i_fill(p, x + width, y, 1, height, colour);
}

static bool ink(const uint8_t rows[9], int row, int column)
{
    return row >= 0 && row < 9 && column >= 0 && column < 5 &&
           (rows[row] >> (4 - column) & 1u);
}

/* Ink at the point (u, v) in glyph pixels: where two dots touch only by a corner, the gap is
 * bridged by a diagonal, and the free corner of a step is cut. */
static bool smooth_ink(const uint8_t rows[9], double u, double v)
{
    int column = (int)u, row = (int)v;
    double du = u - column - 0.5, dv = v - row - 0.5;
    int dc = du < 0 ? -1 : 1, dr = dv < 0 ? -1 : 1;
    double corner = (du < 0 ? -du : du) + (dv < 0 ? -dv : dv);
    bool here = ink(rows, row, column);
    bool beside = ink(rows, row, column + dc), above = ink(rows, row + dr, column);
    bool diagonal = ink(rows, row + dr, column + dc);
    if (here) return !(corner > 0.75 && !beside && !above && !diagonal);
    return corner > 0.55 && beside && above && !diagonal;
}

static void put_letter(ph_i_picture *p, int x, int y, int scale, uint32_t code, bool up,
                       ph_i_colour colour)
{
    enum { SAMPLES = 4 };
    uint8_t rows[9];
    ph_i_glyph(code, rows);
    for (int b = 0; b < 9 * scale; b++)
        for (int a = 0; a < 5 * scale; a++) {
            int hits = 0, px = up ? x + b : x + a, py = up ? y - a - 1 : y + b;
            for (int s = 0; s < SAMPLES * SAMPLES; s++) {
                int sx = s % SAMPLES, sy = s / SAMPLES;
                hits += smooth_ink(rows, (a + (sx + 0.5) / SAMPLES) / scale,
                                   (b + (sy + 0.5) / SAMPLES) / scale);
            }
            if (hits == 0 || px < 0 || py < 0 || px >= p->width || py >= p->height)
                continue;
            ph_i_colour *to = &p->pixel[(size_t)py * (size_t)p->width + (size_t)px];
            *to = ph_i_mix_colours(*to, colour, hits / (double)(SAMPLES * SAMPLES));
        }
}

static void put_text(ph_i_picture *p, int x, int y, int scale, const char *text, bool up,
                     ph_i_colour colour)
{
    for (uint32_t code; ph_i_utf8_next(&text, &code);) {
        put_letter(p, x, y, scale, code, up, colour);
        *(up ? &y : &x) += (up ? -1 : 1) * PH_I_LETTER_WIDTH * scale;
    }
}

void ph_i_text(ph_i_picture *p, int x, int y, int scale, const char *text,
               ph_i_colour colour)
{
    put_text(p, x, y, scale, text, false, colour);
}

void ph_i_text_up(ph_i_picture *p, int x, int y, int scale, const char *text,
                  ph_i_colour colour)
{
    put_text(p, x, y, scale, text, true, colour);
}

int ph_i_text_width(const char *text, int scale)
{
    int letters = ph_i_utf8_letters(text);
    return letters > 0 ? (letters * PH_I_LETTER_WIDTH - 1) * scale : 0;
}

ph_status ph_i_picture_write(const ph_i_picture *p, const char *path, ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_draft draft = {.open = false};
    FILE *file = NULL;
    png_image image;
    memset(&image, 0, sizeof image);
    image.version = PNG_IMAGE_VERSION;
    image.width = (png_uint_32)p->width;
    image.height = (png_uint_32)p->height;
    image.format = PNG_FORMAT_RGB;
    PH_TRY(ph_i_draft_begin(&draft, path, err));
    file = fopen(draft.path, "wb");
    if (!file) {
        st = ph_i_io_error(err, "write", path, errno);
        goto out;
    }
    errno = 0;
    if (!png_image_write_to_stdio(&image, file, 0, p->pixel, 0, NULL)) {
        st = errno == ENOMEM || strstr(image.message, "memory")
                 ? PH_FAIL(err, PH_ENOMEM, "no memory to write '%.300s'", path)
             : errno
                 ? ph_i_io_error(err, "write", path, errno)
                 : PH_FAIL(err, PH_EIO, "cannot write '%.300s': %s", path, image.message);
        goto out;
    }
    bool failed = fclose(file) != 0;
    file = NULL;
    if (failed) {
        st = ph_i_io_error(err, "write", path, errno);
        goto out;
    }
    PH_TRY(ph_i_draft_commit(&draft, err));
out:
    if (file) fclose(file);
    png_image_free(&image);
    ph_i_draft_discard(&draft);
    return st;
}
