/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/output.h>

#include "io/plot_canvas.h"

#include <math.h>
#include <string.h>

ph_status ph_i_check_size(int width, int height, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK((width == 0 || (width >= 200 && width <= 4000)) &&
                 (height == 0 || (height >= 150 && height <= 4000)),
             PH_EINVAL, "a plot of %d x %d: width 200 to 4000, height 150 to 4000", width,
             height);
out:
    return st;
}

ph_status ph_i_check_range(const double range[2], bool log, const char *axis,
                           ph_error *err)
{
    ph_status st = PH_OK;
    if (range[0] == range[1]) goto out;
    double size = fmax(fabs(range[0]), fabs(range[1]));
    PH_CHECK(size <= 1e300 && range[1] - range[0] > 1e-12 * size &&
                 range[1] - range[0] > 1e-300,
             PH_EINVAL,
             "range of the %s axis from %g to %g: two finite numbers, the less "
             "first",
             axis, range[0], range[1]);
    PH_CHECK(!log || range[0] >= 1e-300, PH_EINVAL,
             "range of the logarithmic %s axis from %g: must be positive", axis,
             range[0]);
out:
    return st;
}

ph_status ph_i_drawing_svg(const ph_i_drawing *d, char **text, ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_svg svg;
    ph_i_svg_open(&svg, d->width, d->height, d->title);
    PH_TRY(d->draw(d->what, &svg.canvas, err));
    ph_i_svg_close(&svg);
    PH_CHECK(!svg.out.failed, PH_ENOMEM, "no memory for the text of a plot");
    *text = svg.out.text;
    svg.out.text = NULL;
out:
    free(svg.out.text);
    return st;
}

static ph_status write_svg(const char *path, const ph_i_drawing *d, ph_error *err)
{
    ph_status st = PH_OK;
    char *text = NULL;
    PH_TRY(ph_i_drawing_svg(d, &text, err));
    PH_TRY(ph_write_file(path, text, strlen(text), err));
out:
    free(text);
    return st;
}

static ph_status write_png(const char *path, const ph_i_drawing *d, ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_raster raster = {.picture = {.pixel = NULL}};
    PH_TRY(ph_i_raster_open(&raster, d->width, d->height, err));
    PH_TRY(d->draw(d->what, &raster.canvas, err));
    PH_TRY(ph_i_picture_write(&raster.picture, path, err));
out:
    ph_i_raster_close(&raster);
    return st;
}

static bool ends_with(const char *path, const char *ending)
{
    size_t n = strlen(path), m = strlen(ending);
    if (n < m) return false;
    for (size_t k = 0; k < m; k++)
        if ((path[n - m + k] | 0x20) != (ending[k] | 0x20)) return false;
    return true;
}

ph_status ph_i_drawing_write(const char *path, const ph_i_drawing *d, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(path && path[0], PH_EINVAL, "no file name for a plot");
    if (ends_with(path, ".svg"))
        PH_TRY(write_svg(path, d, err));
    else if (ends_with(path, ".png"))
        PH_TRY(write_png(path, d, err));
    else
        st = PH_FAIL(err, PH_EINVAL, "'%.300s': a plot ends with .svg or .png", path);
out:
    return st;
}
