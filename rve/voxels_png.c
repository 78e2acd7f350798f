/* SPDX-License-Identifier: GPL-3.0-or-later */
/* .png: gray values or palette indices; the top row of the picture is the end of axis 2. */
#include "core/check.h"
#include "voxels.h"

#include <png.h>

#include <setjmp.h>
#include <string.h>

/* Deflate makes data at most about 1032 times smaller: a picture that would need more than
 * that of its file is a bomb or damaged. */
enum { DEFLATE_MOST = 1100 };

typedef struct reader {
    ph_bytes left;
    char message[128];
    png_structp png;
    png_infop info;
    unsigned char *pixels;
    png_bytep *rows;
    size_t width, height, stride;
    int depth;
} reader;

static void on_error(png_structp png, png_const_charp message)
{
    reader *r = png_get_error_ptr(png);
    snprintf(r->message, sizeof r->message, "%s", message);
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp message)
{
    (void)png, (void)message;
}

static void on_read(png_structp png, png_bytep out, size_t count)
{
    reader *r = png_get_io_ptr(png);
    if (count > r->left.size) png_error(png, "is cut off");
    memcpy(out, r->left.data, count);
    r->left.data += count;
    r->left.size -= count;
}

/* Runs under the long jump: allocates only into the reader, which the caller releases. */
static void read_pixels(reader *r)
{
    size_t file = r->left.size;
    png_set_read_fn(r->png, r, on_read);
    png_read_info(r->png, r->info);
    int colour = png_get_color_type(r->png, r->info);
    if (colour != PNG_COLOR_TYPE_GRAY && colour != PNG_COLOR_TYPE_PALETTE)
        png_error(r->png, "is a colour picture; gray values or a palette are wanted");
    png_set_packing(r->png);
    png_set_interlace_handling(r->png);
    png_read_update_info(r->png, r->info);
    r->width = png_get_image_width(r->png, r->info);
    r->height = png_get_image_height(r->png, r->info);
    r->depth = png_get_bit_depth(r->png, r->info) == 16 ? 2 : 1;
    r->stride = png_get_rowbytes(r->png, r->info);
    if (r->stride > file * DEFLATE_MOST / r->height)
        png_error(r->png, "is larger than its file can hold");
    r->pixels = calloc(r->height, r->stride);
    r->rows = calloc(r->height, sizeof *r->rows);
    if (!r->pixels || !r->rows) png_error(r->png, "no memory for the picture");
    for (size_t y = 0; y < r->height; y++)
        r->rows[y] = r->pixels + y * r->stride;
    png_read_image(r->png, r->rows);
    png_read_end(r->png, NULL);
}

static bool run(reader *r)
{
    if (setjmp(png_jmpbuf(r->png))) return false;
    read_pixels(r);
    return true;
}

ph_status ph_i_png_parse(ph_bytes file, ph_voxel_data *v, ph_error *err)
{
    ph_status st = PH_OK;
    reader r = {.left = file};
    PH_CHECK(file.size >= 8 && png_sig_cmp(file.data, 0, 8) == 0, PH_EINVAL,
             "is not a .png file");
    r.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &r, on_error, on_warning);
    PH_CHECK(r.png, PH_ENOMEM, "no memory for reading a picture");
    r.info = png_create_info_struct(r.png);
    PH_CHECK(r.info, PH_ENOMEM, "no memory for reading a picture");
    PH_CHECK(run(&r), PH_EINVAL, "%s", r.message);
    v->rank = 2;
    v->n[0] = (ptrdiff_t)r.width;
    v->n[1] = (ptrdiff_t)r.height;
    v->n[2] = 1;
    PH_TRY(ph_i_voxels_alloc(v, 1, r.width * r.height, err));
    for (size_t x = 0; x < r.width; x++)
        for (size_t y = 0; y < r.height; y++) {
            const unsigned char *p = r.rows[r.height - 1 - y] + x * (size_t)r.depth;
            v->values[x * r.height + y] =
                (uint16_t)(r.depth == 2 ? p[0] << 8 | p[1] : p[0]);
        }
out:
    if (r.png) png_destroy_read_struct(&r.png, &r.info, NULL);
    free(r.pixels);
    free(r.rows);
    return st;
}
