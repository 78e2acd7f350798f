/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cracks as they are: lines, ellipses, polygons, and how they grow. */
#include <perihom/crack.h>

#include "core/check.h"
#include "core/vec3.h"
#include "space/broken.h"

#include <math.h>
#include <string.h>

void ph_cracks_free(ph_cracks *c)
{
    if (!c) return;
    free(c->crack);
    free(c->vertex);
    memset(c, 0, sizeof *c);
}

static double distance(const double *a, const double *b)
{
    double d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    return sqrt(ph_i_dot3(d, d));
}

static bool finite3(const double *x)
{
    return isfinite(x[0]) && isfinite(x[1]) && isfinite(x[2]);
}

static ph_status make_room(ph_cracks *c, ptrdiff_t vertices, ph_error *err)
{
    ph_status st = PH_OK;
    if (c->count == c->room) {
        ptrdiff_t room = 2 * c->room + 16;
        ph_crack *p = realloc(c->crack, (size_t)room * sizeof *p);
        PH_CHECK(p, PH_ENOMEM, "no memory for %td cracks", room);
        c->crack = p;
        c->room = room;
    }
    if (c->nvertices + vertices > c->vertex_room) {
        ptrdiff_t room = 2 * (c->nvertices + vertices) + 32;
        double(*v)[3] = realloc(c->vertex, (size_t)room * sizeof *v);
        PH_CHECK(v, PH_ENOMEM, "no memory for the vertices of cracks");
        c->vertex = v;
        c->vertex_room = room;
    }
out:
    return st;
}

static ph_status add_vertices(ph_cracks *c, ph_crack_shape shape, ptrdiff_t count,
                              const double (*vertex)[3], ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(make_room(c, count, err));
    c->crack[c->count++] =
        (ph_crack){.shape = shape, .first = c->nvertices, .count = count};
    memcpy(c->vertex + c->nvertices, vertex, (size_t)count * sizeof *vertex);
    c->nvertices += count;
out:
    return st;
}

ph_status ph_cracks_add_line(ph_cracks *c, ptrdiff_t count, const double (*v)[3],
                             ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(c && v && count >= 2, PH_EINVAL, "a crack has two points or more, got %td",
             count);
    for (ptrdiff_t i = 0; i < count; i++) {
        PH_CHECK(finite3(v[i]), PH_EINVAL, "point %td of a crack is not finite", i + 1);
        PH_CHECK(i == 0 || distance(v[i - 1], v[i]) > 0.0, PH_EINVAL,
                 "points %td and %td of a crack are the same", i, i + 1);
    }
    st = add_vertices(c, PH_CRACK_LINE, count, v, err);
out:
    return st;
}

/* Twice the vector area: the normal of a plane polygon (Newell). */
static double vector_area(ptrdiff_t count, const double (*v)[3], double *normal)
{
    memset(normal, 0, sizeof(double) * 3);
    for (ptrdiff_t i = 2; i < count; i++) {
        double a[3], b[3], n[3];
        for (int d = 0; d < 3; d++) {
            a[d] = v[i - 1][d] - v[0][d];
            b[d] = v[i][d] - v[0][d];
        }
        ph_i_cross3(a, b, n);
        for (int d = 0; d < 3; d++)
            normal[d] += n[d];
    }
    return sqrt(ph_i_dot3(normal, normal));
}

ph_status ph_cracks_add_polygon(ph_cracks *c, ptrdiff_t count, const double (*v)[3],
                                ph_error *err)
{
    static const double plane = 1e-6;
    ph_status st = PH_OK;
    double n[3], size = 0.0, area;
    PH_CHECK(c && v && count >= 3, PH_EINVAL,
             "a polygon has three corners or more, got %td", count);
    for (ptrdiff_t i = 0; i < count; i++)
        PH_CHECK(finite3(v[i]), PH_EINVAL, "corner %td of a crack is not finite", i + 1);
    for (ptrdiff_t i = 1; i < count; i++)
        size = fmax(size, distance(v[0], v[i]));
    area = vector_area(count, v, n);
    PH_CHECK(area > plane * size * size, PH_EINVAL, "a crack polygon has no area");
    for (ptrdiff_t i = 1; i < count; i++) {
        double d[3] = {v[i][0] - v[0][0], v[i][1] - v[0][1], v[i][2] - v[0][2]};
        PH_CHECK(fabs(ph_i_dot3(d, n)) <= plane * area * size, PH_EINVAL,
                 "a crack polygon is not plane: corner %td is %g out of it", i + 1,
                 ph_i_dot3(d, n) / area);
    }
    st = add_vertices(c, PH_CRACK_POLYGON, count, v, err);
out:
    return st;
}

/* An orthonormal pair across n, the first along `axis` as far as it goes. */
static bool span_plane(const double normal[3], const double *axis, double out[2][3])
{
    double n[3], size = sqrt(ph_i_dot3(normal, normal)), along[3] = {0, 0, 0};
    if (!(size > 0.0) || !isfinite(size)) return false;
    int least = 0;
    for (int d = 0; d < 3; d++) {
        n[d] = normal[d] / size;
        if (fabs(n[d]) < fabs(n[least])) least = d;
    }
    along[least] = 1.0;
    if (axis) memcpy(along, axis, sizeof along);
    double whole = sqrt(ph_i_dot3(along, along)), part = ph_i_dot3(along, n);
    for (int d = 0; d < 3; d++)
        along[d] -= part * n[d];
    double left = sqrt(ph_i_dot3(along, along));
    if (!(left > 1e-6 * whole) || !isfinite(left)) return false;
    for (int d = 0; d < 3; d++)
        out[0][d] = along[d] / left;
    ph_i_cross3(n, out[0], out[1]);
    return true;
}

ph_status ph_cracks_add_ellipse(ph_cracks *c, const double centre[3],
                                const double normal[3], const double *axis,
                                const double semi_axes[2], ph_error *err)
{
    ph_status st = PH_OK;
    ph_crack e = {.shape = PH_CRACK_ELLIPSE};
    PH_CHECK(c && centre && normal && semi_axes, PH_EINVAL, "NULL argument");
    PH_CHECK(finite3(centre), PH_EINVAL, "the centre of a crack is not finite");
    for (int i = 0; i < 2; i++)
        PH_CHECK(semi_axes[i] > 0.0 && isfinite(semi_axes[i]), PH_EINVAL,
                 "the semi-axes of a crack must be > 0, got %g", semi_axes[i]);
    PH_CHECK(span_plane(normal, axis, e.axis), PH_EINVAL,
             "the normal of a crack must not be zero, nor its axis along the normal");
    memcpy(e.centre, centre, sizeof e.centre);
    memcpy(e.semi_axes, semi_axes, sizeof e.semi_axes);
    PH_TRY(make_room(c, 0, err));
    e.first = c->nvertices;
    c->crack[c->count++] = e;
out:
    return st;
}

/* ---- length and growth ------------------------------------------------------------------- */

double ph_crack_length(const ph_cracks *c, ptrdiff_t which)
{
    if (!(c && which >= 0 && which < c->count)) return NAN;
    const ph_crack *k = &c->crack[which];
    double sum = 0.0;
    if (k->shape == PH_CRACK_ELLIPSE) return 2.0 * k->semi_axes[0];
    if (k->shape == PH_CRACK_POLYGON) return NAN;
    for (ptrdiff_t i = 1; i < k->count; i++)
        sum += distance(c->vertex[k->first + i - 1], c->vertex[k->first + i]);
    return sum;
}

/* Point at the distance s along a polyline; beyond its ends straight on. */
static void point_at(ptrdiff_t count, const double (*v)[3], double s, double *out)
{
    ptrdiff_t i = 1;
    for (; i < count - 1; i++) {
        double step = distance(v[i - 1], v[i]);
        if (s <= step) break;
        s -= step;
    }
    double t = s / distance(v[i - 1], v[i]);
    for (int d = 0; d < 3; d++)
        out[d] = v[i - 1][d] + t * (v[i][d] - v[i - 1][d]);
}

static ph_status add_part(ph_cracks *to, ptrdiff_t count, const double (*v)[3],
                          double from, double until, ph_error *err)
{
    ph_status st = PH_OK;
    double(*part)[3] = NULL, s = 0.0;
    ptrdiff_t n = 0;
    PH_ALLOC(part, count + 2, "a crack");
    point_at(count, v, from, part[n++]);
    for (ptrdiff_t i = 1; i < count - 1; i++) {
        s += distance(v[i - 1], v[i]);
        if (s > from && s < until) memcpy(part[n++], v[i], sizeof *part);
    }
    point_at(count, v, until, part[n++]);
    /* Ends that fall on a point of the line, or lengths below the last digit. */
    ptrdiff_t kept = 1;
    for (ptrdiff_t i = 1; i < n; i++)
        if (distance(part[kept - 1], part[i]) > 0.0)
            memcpy(part[kept++], part[i], sizeof *part);
    if (kept > 1) st = ph_cracks_add_line(to, kept, (const double(*)[3])part, err);
out:
    free(part);
    return st;
}

ph_status ph_cracks_add_grown(ph_cracks *to, const ph_cracks *from, ptrdiff_t which,
                              ph_crack_tip tip, double length, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(to && from && which >= 0 && which < from->count, PH_EINVAL,
             "there is no crack %td", which);
    const ph_crack *k = &from->crack[which];
    PH_CHECK(length >= 0.0 && isfinite(length), PH_EINVAL,
             "the length of a crack must be >= 0, got %g", length);
    PH_CHECK(k->shape != PH_CRACK_POLYGON, PH_EINVAL,
             "crack %td is a polygon: lines, disks and ellipses grow", which);
    if (length == 0.0) return PH_OK;
    double now = ph_crack_length(from, which);
    if (k->shape == PH_CRACK_ELLIPSE) {
        double n[3], semi[2];
        ph_i_cross3(k->axis[0], k->axis[1], n);
        for (int i = 0; i < 2; i++)
            semi[i] = k->semi_axes[i] * length / now;
        return ph_cracks_add_ellipse(to, k->centre, n, k->axis[0], semi, err);
    }
    double begin = tip == PH_TIP_TO     ? 0.0
                   : tip == PH_TIP_FROM ? now - length
                                        : 0.5 * (now - length);
    st = add_part(to, k->count, (const double(*)[3])(from->vertex + k->first), begin,
                  begin + length, err);
out:
    return st;
}

double ph_i_polygon_radius(ptrdiff_t count, const double (*vertex)[3])
{
    static const double pi = 3.14159265358979323846;
    double n[3];
    return sqrt(0.5 * vector_area(count, vertex, n) / pi);
}

static double volume_of(const ph_grid *g)
{
    return g->size[0] * g->size[1] * (g->kinematics == PH_SPACE ? g->size[2] : 1.0);
}

double ph_cracks_surface(const ph_cracks *c, const ph_grid *g)
{
    static const double pi = 3.14159265358979323846;
    double sum = 0.0;
    if (!c || !g) return NAN;
    for (ptrdiff_t i = 0; i < c->count; i++) {
        const ph_crack *k = &c->crack[i];
        double radius = sqrt(k->semi_axes[0] * k->semi_axes[1]);
        if (k->shape == PH_CRACK_POLYGON)
            radius =
                ph_i_polygon_radius(k->count, (const double(*)[3])(c->vertex + k->first));
        sum += k->shape == PH_CRACK_LINE ? ph_crack_length(c, i) : pi * radius * radius;
    }
    return sum / volume_of(g);
}

double ph_cracks_density(const ph_cracks *c, const ph_grid *g)
{
    if (!c || !g) return NAN;
    double sum = 0.0;
    for (ptrdiff_t i = 0; i < c->count; i++) {
        const ph_crack *k = &c->crack[i];
        double a = 0.5 * ph_crack_length(c, i);
        if (k->shape == PH_CRACK_LINE)
            sum += a * a;
        else if (k->shape == PH_CRACK_ELLIPSE)
            sum += pow(k->semi_axes[0] * k->semi_axes[1], 1.5);
        else
            sum += pow(
                ph_i_polygon_radius(k->count, (const double(*)[3])(c->vertex + k->first)),
                3.0);
    }
    return sum / volume_of(g);
}
