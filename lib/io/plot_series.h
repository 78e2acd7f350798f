/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The data of one series on a canvas. */
#ifndef PH_IO_PLOT_SERIES_H
#define PH_IO_PLOT_SERIES_H

#include <perihom/plot.h>

#include "io/plot_canvas.h"

/** Room that drawing a series needs besides: reused from one to the next. */
typedef struct ph_i_series_work {
    ph_i_point *point; /* [2 room] */
    ptrdiff_t room;
    uint8_t *seen; /* [rows][columns], a unit each: there is a mark */
    int rows, columns;
} ph_i_series_work;
ph_status ph_i_series_work_new(int width, int height, ph_i_series_work *out,
                               ph_error *err);
void ph_i_series_work_free(ph_i_series_work *w);

/** Least and greatest x and y that the series shows, NaN where none. */
void ph_i_series_range(const ph_series *s, const ph_i_axis *x, const ph_i_axis *y,
                       double xr[2], double yr[2]);
/** Draw series `k` of a plot. */
void ph_i_series_draw(ph_i_canvas *c, const ph_series *s, int k, const ph_i_axis *x,
                      const ph_i_axis *y, ph_i_box box, ph_i_series_work *w);
/** Its sample in a legend, 24 units wide, in the middle of height y. */
void ph_i_series_sample(ph_i_canvas *c, const ph_series *s, int k, double x, double y);

#endif
