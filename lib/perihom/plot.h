/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Line plots and heat maps, as SVG (text stays text, one self-contained element that can
 * stand in an HTML page) or PNG (two pixels a unit). Everything in a plot is borrowed. */
#ifndef PERIHOM_PLOT_H
#define PERIHOM_PLOT_H

#include <perihom/error.h>

#ifdef __cplusplus
extern "C" {
#endif

enum {
    PH_PLOT_SERIES = 256,  /* most series of a plot */
    PH_HEATMAP_CELLS = 512 /* most rows and columns of a heat map */
};

typedef enum ph_series_style {
    PH_PLOT_LINE,        /* through the points in their order; NaN is a gap */
    PH_PLOT_POINTS,      /* marks, a different one for each series */
    PH_PLOT_LINE_POINTS, /* both */
    PH_PLOT_BAND,        /* area between low and high, with the line y unless y is NULL */
    PH_PLOT_BARS,        /* histogram: bars from zero, edges half way to the neighbours */
    PH_PLOT_STEPS        /* y[i] from x[i] to x[i+1] */
} ph_series_style;

typedef struct ph_series {
    const char *name;         /* in the legend, UTF-8; NULL or "": not there */
    ptrdiff_t n;              /* >= 0 */
    const double *x;          /* [n] */
    const double *y;          /* [n], or NULL in a band */
    const double *low, *high; /* [n] ends of error bars or of the band, or both NULL */
    ph_series_style style;
    bool dashed;
    int colour; /* 0: by its place among the series; k > 0: the k-th of the palette */
} ph_series;

/** A plot; zero means automatic or absent for every member. */
typedef struct ph_plot {
    const char *title, *subtitle; /* UTF-8 or NULL; so are the labels */
    const char *xlabel, *ylabel;
    bool log_x, log_y;             /* points that are not positive are then left out */
    double x_range[2], y_range[2]; /* both ends equal: from the data */
    int nseries;
    const ph_series *series;
    int width,
        height; /* units (SVG: px at 96 dpi); 0: 720 x 480; else 200 .. 4000, 150 .. 4000 */
} ph_plot;

/** A matrix as coloured cells. */
typedef struct ph_heatmap {
    const char *title, *subtitle, *xlabel, *ylabel;
    const char *value_label;   /* beside the colour bar */
    int nx, ny;                /* 1 .. PH_HEATMAP_CELLS columns and rows */
    const double *value;       /* [ny][nx], first row on top; NaN is grey */
    const char *const *xnames; /* [nx] of the columns, or NULL: 1, 2, ... */
    const char *const *ynames; /* [ny] of the rows, or NULL */
    double range[2];           /* of the colours; both ends equal: from the data */
    bool log_colour;           /* values that are not positive are grey */
    bool cell_text;            /* the numbers in the cells, where they fit */
    int width, height;
} ph_heatmap;

/** The plot as SVG text, malloc'd, the first bytes being "<svg".
 *
 *  - Ticks are at 1, 2 or 5 times a power of ten, on a logarithmic axis at decades (1, 2, 5
 *    where it spans less than two). A range from the data gets a margin of 4 %; data that
 *    are all equal get a range around them; without any point the plot says "no data".
 *  - Values that are not finite are gaps. Text is escaped; bytes that are not UTF-8 become
 *    U+FFFD.
 *  - A line of many points is thinned to first, least, greatest and last point of each
 *    column of half a unit, marks to one a unit in x and y: the picture looks the same, and 1e6 ordered points make a file of some 100 kB.
 *  - The legend goes to a corner that is free, or to the right of the axes.
 *  @param[out] text  untouched on failure
 *  @return PH_OK; PH_EINVAL (sizes, ranges, missing arrays); PH_ENOMEM. Cost: O(points).
 *  Tested: tests/io/test_plot.c */
PH_API ph_status ph_plot_svg(const ph_plot *plot, char **text, ph_error *err);
/** To a file, SVG or PNG by the ending of its name (.svg, .png).
 *  @return PH_OK; PH_EINVAL (also another ending); PH_EIO; PH_ENOMEM */
PH_API ph_status ph_plot_write(const char *path, const ph_plot *plot, ph_error *err);

/** The same for a heat map. Colours run from dark to bright with even steps in lightness;
 *  a linear range with both signs gets blue and red, white at zero.
 *  Tested: tests/io/test_plot.c */
PH_API ph_status ph_heatmap_svg(const ph_heatmap *map, char **text, ph_error *err);
PH_API ph_status ph_heatmap_write(const char *path, const ph_heatmap *map, ph_error *err);

#ifdef __cplusplus
}
#endif
#endif
