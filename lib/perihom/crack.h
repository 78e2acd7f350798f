/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PERIHOM_CRACK_H
#define PERIHOM_CRACK_H

#include <perihom/microstructure.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum ph_crack_shape {
    PH_CRACK_LINE,    /* 2D: a polyline; it runs through along axis 3 */
    PH_CRACK_ELLIPSE, /* 3D: an ellipse, a disk among them */
    PH_CRACK_POLYGON  /* 3D: a plane polygon */
} ph_crack_shape;

/** One crack: a surface across which nothing is transmitted. Lengths in units of the grid,
 *  which it may leave: like the microstructure it is repeated periodically. */
typedef struct ph_crack {
    ph_crack_shape shape;
    ptrdiff_t first, count; /* vertices of a line or polygon in the set's array */
    double centre[3];       /* ellipse */
    double axis[2][3];      /* ellipse: unit vectors along the semi-axes */
    double semi_axes[2];
} ph_crack;

/** Cracks and their vertices. Owns its arrays. */
typedef struct ph_cracks {
    ptrdiff_t count, room, nvertices, vertex_room;
    ph_crack *crack;
    double (*vertex)[3];
} ph_cracks;

PH_API void ph_cracks_free(ph_cracks *cracks); /* what it holds; NULL-safe */

/** A line through `count` points (2D: third coordinate 0).
 *  @return PH_OK; PH_EINVAL: fewer than two points, a coordinate that is not finite, two
 *  equal neighbours; PH_ENOMEM */
PH_API ph_status ph_cracks_add_line(ph_cracks *cracks, ptrdiff_t count,
                                    const double (*vertex)[3], ph_error *err);
/** A plane polygon, closed by itself.
 *  @return PH_OK; PH_EINVAL: fewer than three points, not plane (to 1e-6 of its size), no
 *  area; PH_ENOMEM */
PH_API ph_status ph_cracks_add_polygon(ph_cracks *cracks, ptrdiff_t count,
                                       const double (*vertex)[3], ph_error *err);
/** An ellipse in the plane with this normal.
 *  @param[in] normal   not zero
 *  @param[in] axis     direction of the first semi-axis, its part along the normal is taken
 *                      away; NULL: any direction in the plane (disks)
 *  @param[in] semi_axes > 0
 *  @return PH_OK; PH_EINVAL; PH_ENOMEM */
PH_API ph_status ph_cracks_add_ellipse(ph_cracks *cracks, const double centre[3],
                                       const double normal[3], const double *axis,
                                       const double semi_axes[2], ph_error *err);

/** Which end of a crack moves when it grows. */
typedef enum ph_crack_tip {
    PH_TIP_BOTH, /* the middle stays */
    PH_TIP_TO,   /* the first point stays */
    PH_TIP_FROM  /* the last point stays */
} ph_crack_tip;

/** Length of a line along its points, or diameter along the first semi-axis.
 *  NaN for polygons. */
PH_API double ph_crack_length(const ph_cracks *cracks, ptrdiff_t which);
/** Add `which` of `from` to `to`, as it is when its length is `length`: lines are cut back
 *  along their points or prolonged straight, ellipses scaled about their centre. A length of
 *  zero adds nothing.
 *  @return PH_OK; PH_EINVAL: length negative or not finite, a polygon; PH_ENOMEM */
PH_API ph_status ph_cracks_add_grown(ph_cracks *to, const ph_cracks *from,
                                     ptrdiff_t which, ph_crack_tip tip, double length,
                                     ph_error *err);
/** Crack density of the set: sum of a^2 over the area in 2D (a half length), of a^3 over the
 *  volume in 3D (ellipses: (a b)^(3/2); polygons: (area/pi)^(3/2)). */
PH_API double ph_cracks_density(const ph_cracks *cracks, const ph_grid *grid);
/** Length of all lines over the area in 2D, area of all figures over the volume in 3D [1/length];
 *  where they overlap, twice. */
PH_API double ph_cracks_surface(const ph_cracks *cracks, const ph_grid *grid);

#ifdef __cplusplus
}
#endif
#endif
