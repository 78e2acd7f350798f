/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Convex polygons of a few corners: cutting them, and what of them lies in a disk. */
#ifndef PH_RVE_POLYGON_H
#define PH_RVE_POLYGON_H

enum { PH_POLYGON_MAX = 16 };

/** Corners in anticlockwise order. */
typedef struct ph_polygon {
    int n;
    double x[PH_POLYGON_MAX][2];
} ph_polygon;

ph_polygon ph_i_rectangle(double x0, double x1, double y0, double y1);
/** Keep what satisfies a . x <= b. Adds at most one corner. */
void ph_i_polygon_clip(ph_polygon *p, const double a[2], double b);
double ph_i_polygon_area(const ph_polygon *p);
/** Area of the polygon within the unit disk about the origin: by edges, each the triangle or
 *  the sector that it spans with the origin. Exact to rounding. */
double ph_i_polygon_area_in_disk(const ph_polygon *p);

#endif
