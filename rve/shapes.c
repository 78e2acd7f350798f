/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The shapes of the case file: each turns its parameters into a ph_solid. */
#include "core/check.h"
#include "solid.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

static int dimensions_of(const ph_grid *grid)
{
    return grid->kinematics == PH_SPACE ? 3 : 2;
}

/* A solid without ends, in the frame of the grid, at the inclusion's centre. */
static ph_status start(const ph_inclusion *inc, const ph_grid *grid, ph_solid *s,
                       ph_error *err)
{
    ph_status st = PH_OK;
    *s = (ph_solid){.frame = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    for (int a = 0; a < 3; a++)
        s->half[a] = INFINITY;
    for (int a = 0; a < dimensions_of(grid); a++) {
        PH_CHECK(isfinite(inc->centre[a]), PH_EINVAL, "centre: number %d is missing",
                 a + 1);
        s->centre[a] = inc->centre[a];
    }
out:
    return st;
}

static ph_status set_half(ph_solid *s, int axis, ph_extent kind, double half,
                          const char *what, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(isfinite(half), PH_EINVAL, "%s: number is missing", what);
    PH_CHECK(half > 0, PH_EINVAL, "%s must be positive, got %g", what, half);
    s->kind[axis] = kind;
    s->half[axis] = half;
out:
    return st;
}

/* Turn the frame about axis 3. Quarter turns come out exact. */
static void turn(ph_solid *s, double degrees)
{
    if (!isfinite(degrees)) return;
    double quarters = degrees / 90, c, d;
    if (quarters == rint(quarters)) {
        static const double cosine[4] = {1, 0, -1, 0};
        int k = (int)(fmod(quarters, 4) + 4) % 4;
        c = cosine[k];
        d = cosine[(k + 3) % 4];
    } else {
        double radians = degrees * (pi / 180);
        c = cos(radians);
        d = sin(radians);
    }
    double frame[2][3] = {{c, d, 0}, {-d, c, 0}};
    memcpy(s->frame, frame, sizeof frame);
}

/* First axis of the frame along `axis`; the second is the grid axis most across it (the
 * lowest of equals), made perpendicular; the third completes a right-handed frame. */
static ph_status point(ph_solid *s, const double axis[3], ph_error *err)
{
    ph_status st = PH_OK;
    double norm = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    PH_CHECK(isfinite(norm) && norm > 0, PH_EINVAL,
             "axis must have three numbers, not all zero, got [%g, %g, %g]", axis[0],
             axis[1], axis[2]);
    double(*f)[3] = s->frame;
    int across = 0;
    for (int a = 0; a < 3; a++) {
        f[0][a] = axis[a] / norm;
        if (fabs(f[0][a]) < fabs(f[0][across]) - 1e-12) across = a;
    }
    double along = f[0][across], length = sqrt(1 - along * along);
    for (int a = 0; a < 3; a++)
        f[1][a] = ((a == across) - along * f[0][a]) / length;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        f[2][i] = f[0][j] * f[1][k] - f[0][k] * f[1][j];
    }
out:
    return st;
}

static void set_ball(ph_solid *s, int dim, double radius)
{
    for (int a = 0; a < dim; a++) {
        s->kind[a] = PH_EXTENT_ROUND;
        s->half[a] = radius;
    }
    ph_i_solid_finish(s);
}

/* Radius at which the periodic array of balls fills `fraction` of the box. A point belongs
 * to its nearest image, so the union of the images is the ball cut by the box about it:
 * bisection on that volume where the images overlap. */
static double radius_for(double fraction, const ph_grid *grid, ph_solid *s)
{
    int dim = dimensions_of(grid);
    double volume = 1, shortest = INFINITY, diagonal2 = 0, hi[3] = {0}, lo[3] = {0};
    for (int a = 0; a < dim; a++) {
        volume *= grid->size[a];
        shortest = fmin(shortest, grid->size[a]);
        diagonal2 += grid->size[a] * grid->size[a];
        lo[a] = s->centre[a] - grid->size[a] / 2;
        hi[a] = s->centre[a] + grid->size[a] / 2;
    }
    double want = fraction * volume;
    double from = dim == 2 ? sqrt(want / pi) : cbrt(want * 3 / (4 * pi));
    if (from <= shortest / 2) return from;
    double to = sqrt(diagonal2) / 2 * (1 + 1e-9);
    for (int i = 0; i < 60 && fraction < 1; i++) {
        set_ball(s, dim, (from + to) / 2);
        *(ph_solid_overlap(s, dim, lo, hi) < want ? &from : &to) = s->half[0];
    }
    return to;
}

static ph_status place_ball(const ph_inclusion *inc, const ph_grid *grid, ph_solid *s,
                            ph_error *err)
{
    ph_status st = PH_OK;
    double r = inc->radius;
    PH_TRY(start(inc, grid, s, err));
    if (isnan(r) && !isnan(inc->fraction)) {
        PH_CHECK(inc->fraction > 0 && inc->fraction <= 1, PH_EINVAL,
                 "fraction must be in (0, 1], got %g", inc->fraction);
        r = radius_for(inc->fraction, grid, s);
    }
    PH_TRY(set_half(s, 0, PH_EXTENT_ROUND, r, "radius (or fraction)", err));
    set_ball(s, dimensions_of(grid), r);
out:
    return st;
}

static ph_status place_ellipse(const ph_inclusion *inc, const ph_grid *grid, ph_solid *s,
                               ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(start(inc, grid, s, err));
    for (int a = 0; a < 2; a++)
        PH_TRY(set_half(s, a, PH_EXTENT_ROUND, inc->semi_axes[a], "semi_axes", err));
    turn(s, inc->angle);
out:
    return st;
}

static ph_status place_ellipsoid(const ph_inclusion *inc, const ph_grid *grid,
                                 ph_solid *s, ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(start(inc, grid, s, err));
    for (int a = 0; a < 3; a++)
        PH_TRY(set_half(s, a, PH_EXTENT_ROUND, inc->semi_axes[a], "semi_axes", err));
    if (!isnan(inc->axis[0])) PH_TRY(point(s, inc->axis, err));
out:
    return st;
}

static ph_status place_box(const ph_inclusion *inc, const ph_grid *grid, ph_solid *s,
                           ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(start(inc, grid, s, err));
    for (int a = 0; a < dimensions_of(grid); a++)
        PH_TRY(set_half(s, a, PH_EXTENT_FLAT, inc->size[a] / 2, "size", err));
    turn(s, inc->angle);
out:
    return st;
}

static ph_status place_layer(const ph_inclusion *inc, const ph_grid *grid, ph_solid *s,
                             ph_error *err)
{
    ph_status st = PH_OK;
    ph_inclusion at = *inc;
    for (int a = 0; a < 3; a++)
        at.centre[a] = 0;
    PH_TRY(start(&at, grid, s, err));
    int a = inc->normal - 1, dim = dimensions_of(grid);
    PH_CHECK(a >= 0 && a < dim, PH_EINVAL, "normal must be an axis 1 to %d, got %d", dim,
             inc->normal);
    PH_CHECK(isfinite(inc->from) && isfinite(inc->to), PH_EINVAL,
             "from and to must both be given");
    PH_CHECK(inc->from < inc->to, PH_EINVAL, "from must be less than to, got %g and %g",
             inc->from, inc->to);
    PH_TRY(set_half(s, a, PH_EXTENT_FLAT, (inc->to - inc->from) / 2, "to - from", err));
    s->centre[a] = (inc->from + inc->to) / 2;
out:
    return st;
}

/* A cylinder along a grid axis that is as long as the box goes through it. */
static ph_status place_cylinder(const ph_inclusion *inc, const ph_grid *grid, ph_solid *s,
                                ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(start(inc, grid, s, err));
    PH_TRY(point(s, inc->axis, err));
    PH_TRY(set_half(s, 1, PH_EXTENT_ROUND, inc->radius, "radius", err));
    s->kind[2] = PH_EXTENT_ROUND;
    s->half[2] = s->half[1];
    double needed = INFINITY;
    for (int a = 0; a < 3; a++)
        if (fabs(s->frame[0][a]) == 1) needed = grid->size[a];
    if (isfinite(needed) && (isnan(inc->length) || inc->length >= needed * (1 - 1e-12)))
        goto out; /* stays free along its axis */
    PH_CHECK(
        !isnan(inc->length), PH_EINVAL,
        "length is missing: only a cylinder along an axis of the box goes through it");
    PH_TRY(set_half(s, 0, PH_EXTENT_FLAT, inc->length / 2, "length", err));
out:
    return st;
}

const ph_shape ph_shapes[] = {
    {{"disk", "disk", "", "2D"}, 2, "centre, radius or fraction", place_ball},
    {{"ellipse", "ellipse", "", "2D"}, 2, "centre, semi_axes (2), angle", place_ellipse},
    {{"box", "rectangle or cuboid, turned by angle about axis 3", "", "2D, 3D"},
     0,
     "centre, size, angle",
     place_box},
    {{"layer", "layer across an axis of the box", "", "2D, 3D"},
     0,
     "normal (1, 2 or 3), from, to",
     place_layer},
    {{"sphere", "sphere", "", "3D"}, 3, "centre, radius or fraction", place_ball},
    {{"ellipsoid", "ellipsoid, first semi-axis along axis", "", "3D"},
     3,
     "centre, semi_axes (3), axis",
     place_ellipsoid},
    {{"cylinder", "cylinder with flat ends, or through the box", "", "3D"},
     3,
     "centre, axis, radius, length",
     place_cylinder},
};
const size_t ph_nshapes = sizeof ph_shapes / sizeof *ph_shapes;

const ph_shape *ph_shape_find(const char *name)
{
    if (!name) return NULL;
    for (size_t i = 0; i < ph_nshapes; i++)
        if (strcmp(ph_shapes[i].info.name, name) == 0) return &ph_shapes[i];
    return NULL;
}

ph_status ph_shape_place(const ph_inclusion *inc, const ph_grid *grid, ph_solid *solid,
                         ph_error *err)
{
    PH_GIVEN(inc && grid && solid);
    ph_status st = PH_OK;
    int dim = dimensions_of(grid);
    const ph_shape *shape = ph_shape_find(inc->shape);
    PH_CHECK(shape, PH_EINVAL, "shape '%s' is not known", inc->shape);
    PH_CHECK(!shape->dimensions || shape->dimensions == dim, PH_EINVAL,
             "shape '%s' needs dimension %d, the case has %d", inc->shape,
             shape->dimensions, dim);
    PH_TRY(shape->place(inc, grid, solid, err));
    ph_i_solid_finish(solid);
out:
    return st;
}
