/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The shapes of random fillers: centrelines and the chains of solids about them. */
#include "core/check.h"
#include "fillers.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;
enum { MAX_SEGMENTS = 4096 };

const ph_filler_shape ph_filler_shapes[] = {
    {{"platelet", "thin sheet, flat or bent to an arc; in 2D a line of some thickness",
      "", "2D and 3D"},
     "thickness, aspect_ratio or length, curvature {arc_angle or radius}, width, "
     "outline"},
    {{"fibre", "straight, an arc, a helix or a worm-like chain, of round section",
      "Kratky1949", "2D and 3D; helix in 3D"},
     "thickness (its diameter), aspect_ratio or length, curvature {arc_angle, radius, "
     "helix or persistence_length}"},
    {{"particle", "disk, sphere, ellipse, ellipsoid of revolution", "", "2D and 3D"},
     "size (the short diameter), aspect_ratio"},
};
const size_t ph_nfiller_shapes = sizeof ph_filler_shapes / sizeof *ph_filler_shapes;

/* Centreline of a filler in its own frame, at equal arc lengths. */
typedef struct line {
    int n;           /* segments */
    double (*at)[3]; /* [n + 1] */
} line;

static void arc_point(double s, double radius, double sign, double out[3])
{
    out[0] = isinf(radius) ? s : radius * sin(s / radius);
    out[1] = isinf(radius) ? 0 : sign * radius * (1 - cos(s / radius));
    out[2] = 0;
}

/* Radius of the arc; infinite for a straight filler. */
static double arc_radius(const ph_filler *f, const ph_placed *x)
{
    if (f->curvature == PH_CURVATURE_ARC_ANGLE)
        return x->bend > 1e-6 ? x->length / (x->bend * pi / 180) : (double)INFINITY;
    return f->curvature == PH_CURVATURE_RADIUS ? x->bend : (double)INFINITY;
}

/* The helix about the first axis: arc length s turns it by s / c, c^2 = r^2 + (pitch/2pi)^2 */
static void helix_point(double s, double radius, double pitch, double out[3])
{
    double b = pitch / (2 * pi), t = s / sqrt(radius * radius + b * b);
    out[0] = b * t;
    out[1] = radius * cos(t);
    out[2] = radius * sin(t);
}

/* Worm-like chain: directions turn by Gaussian angles such that <t(0) . t(s)> =
 * exp(-s / persistence), from the middle to both sides. */
static void worm(const line *l, double step, double persistence, int dim, ph_random r)
{
    double sigma = sqrt((dim == 2 ? 2 : 1) * step / persistence);
    int middle = l->n / 2;
    r.draw = DRAW_CHAIN;
    memset(l->at[middle], 0, sizeof *l->at);
    for (int side = -1; side <= 1; side += 2) {
        double t[3] = {side, 0, 0}, f[3][3];
        for (int i = middle; side > 0 ? i < l->n : i > 0; i += side) {
            for (int a = 0; a < 3; a++)
                l->at[i + side][a] = l->at[i][a] + step * t[a];
            double p = sigma * ph_random_normal(&r), q = sigma * ph_random_normal(&r);
            double angle = dim == 2 ? p : sqrt(p * p + q * q);
            if (dim == 2) {
                double c = cos(angle), s = sin(angle), x = t[0];
                t[0] = c * x - s * t[1];
                t[1] = s * x + c * t[1];
            } else if (angle > 0) {
                ph_i_frame_about(t, atan2(q, p), f);
                for (int a = 0; a < 3; a++)
                    t[a] = cos(angle) * f[0][a] + sin(angle) * f[1][a];
            }
        }
    }
}

/* How many straight segments: their sagitta step^2 / (8 R) stays below 1/50 of what the grid
 * or the thickness can show. */
static int segments(const ph_i_generator *g, const ph_filler *f, const ph_placed *x,
                    double pitch)
{
    double radius = arc_radius(f, x), fine = fmax(x->thickness, g->spacing) / 50;
    if (f->curvature == PH_CURVATURE_WORM) {
        double step = fmin(x->bend / 8, fmax(x->thickness, g->spacing));
        return (int)fmin(fmax(ceil(x->length / step), 2), MAX_SEGMENTS);
    }
    if (f->curvature == PH_CURVATURE_HELIX) {
        double b = pitch / (2 * pi);
        radius = (x->bend * x->bend + b * b) / x->bend;
    }
    if (isinf(radius)) return 1;
    return (int)fmin(fmax(ceil(x->length / sqrt(8 * radius * fine)), 1), MAX_SEGMENTS);
}

static ph_status make_line(const ph_i_generator *g, const ph_filler *f,
                           const ph_placed *x, int n, ph_random r, line *out,
                           ph_error *err)
{
    ph_status st = PH_OK;
    double radius = arc_radius(f, x), step = x->length / n, pitch = 0;
    r.draw = DRAW_SIGN;
    double sign = ph_random_uniform(&r) < 0.5 ? -1 : 1;
    r.draw = DRAW_PITCH;
    if (f->pitch.kind >= 0)
        pitch = ph_distribution_quantile(&f->pitch, ph_random_uniform(&r));
    out->n = n;
    PH_ALLOC(out->at, n + 1, "a centreline");
    if (f->curvature == PH_CURVATURE_WORM) {
        worm(out, step, x->bend, g->p->dimensions, r);
        goto out;
    }
    for (int i = 0; i <= n; i++) {
        double s = (i - 0.5 * n) * step;
        if (f->curvature == PH_CURVATURE_HELIX)
            helix_point(s, x->bend, pitch, out->at[i]);
        else
            arc_point(s, radius, sign, out->at[i]);
    }
out:
    return st;
}

/* From the filler's frame to the axes of the box. */
static void turn(const ph_placed *x, const double local[3], double out[3])
{
    for (int a = 0; a < 3; a++)
        out[a] = local[0] * x->frame[0][a] + local[1] * x->frame[1][a] +
                 local[2] * x->frame[2][a];
}

static ph_status add_solid(ph_i_generator *g, ph_solid *s, ph_error *err)
{
    ph_status st = PH_OK;
    ph_packing *p = g->p;
    void *array = p->solid;
    st = ph_i_grow(&array, p->nsolids, &g->solids_held, sizeof *p->solid,
                   "the solids of the fillers", err);
    p->solid = array;
    if (st != PH_OK) return st;
    ph_i_solid_finish(s);
    p->solid[p->nsolids++] = *s;
    ph_placed *x = &p->filler[p->n - 1];
    double r2 = 0, far = sqrt(ph_i_dot3(s->centre, s->centre));
    for (int a = 0; a < p->dimensions; a++)
        r2 += s->half[a] * s->half[a];
    x->reach = fmax(x->reach, far + sqrt(r2));
    x->count++;
    return st;
}

static ph_status add_point(ph_i_generator *g, const double at[3], ph_error *err)
{
    ph_status st = PH_OK;
    ph_packing *p = g->p;
    void *array = p->point;
    st = ph_i_grow(&array, p->npoints, &g->points_held, sizeof *p->point,
                   "the nodes of the fillers", err);
    p->point = array;
    if (st != PH_OK) return st;
    for (int a = 0; a < 3; a++)
        p->point[p->npoints][a] =
            a < p->dimensions ? (int32_t)floor(at[a] / g->grid.h[a] + 0.5) : 0;
    p->npoints++;
    p->filler[p->n - 1].npoints++;
    return st;
}

/* Unit tangent of segment i and its length. */
static double tangent(const line *l, int i, double t[3])
{
    for (int a = 0; a < 3; a++)
        t[a] = l->at[i + 1][a] - l->at[i][a];
    double length = sqrt(ph_i_dot3(t, t));
    for (int a = 0; a < 3; a++)
        t[a] /= length;
    return length;
}

/* How far the solids of segments i and i + 1 must go on so that they meet on the outside. */
static double mitre(const line *l, int i, double half)
{
    double t[3], u[3];
    if (i < 0 || i + 1 >= l->n) return 0;
    tangent(l, i, t);
    tangent(l, i + 1, u);
    double c = fmin(fmax(ph_i_dot3(t, u), -1), 1);
    return half * fmin(sqrt((1 - c) / fmax(1 + c, 1e-12)), 1); /* tan of half the angle */
}

static double sheet_width(const ph_filler *f, const ph_placed *x, double s)
{
    double r = x->length / 2;
    return f->disc ? 2 * sqrt(fmax(r * r - s * s, 0)) : x->width;
}

static ph_status add_segment(ph_i_generator *g, const ph_filler *f, const line *l, int i,
                             bool sheet, ph_error *err)
{
    const ph_packing *p = g->p;
    const ph_placed *x = &p->filler[p->n - 1];
    double t[3], ends[2], mid[3], world[3], half = x->thickness / 2;
    double length = tangent(l, i, t);
    ends[0] = mitre(l, i - 1, half);
    ends[1] = mitre(l, i, half);
    for (int a = 0; a < 3; a++)
        mid[a] = (l->at[i][a] + l->at[i + 1][a]) / 2 + t[a] * (ends[1] - ends[0]) / 2;
    ph_solid s = {.half = {(length + ends[0] + ends[1]) / 2, half, half},
                  .kind = {PH_EXTENT_FLAT, PH_EXTENT_FLAT, PH_EXTENT_FREE}};
    turn(x, mid, s.centre);
    turn(x, t, world);
    if (p->dimensions == 2) {
        double flat[3][3] = {
            {world[0], world[1], 0}, {-world[1], world[0], 0}, {0, 0, 1}};
        memcpy(s.frame, flat, sizeof flat);
        s.half[2] = INFINITY;
    } else if (sheet) {
        memcpy(s.frame[0], world, sizeof world);
        memcpy(s.frame[2], x->frame[2], sizeof world);
        ph_i_cross3(s.frame[2], s.frame[0], s.frame[1]);
        s.kind[2] = PH_EXTENT_FLAT;
        s.half[2] = sheet_width(f, x, (i + 0.5 - 0.5 * l->n) * x->length / l->n) / 2;
    } else {
        ph_i_frame_about(world, 0, s.frame);
        s.kind[1] = s.kind[2] = PH_EXTENT_ROUND;
    }
    return add_solid(g, &s, err);
}

/* Point of the centreline at arc length s from its middle. */
static void point_of(const line *l, double length, double s, double out[3])
{
    double t = fmin(fmax((s / length + 0.5) * l->n, 0), l->n);
    int i = (int)fmin(floor(t), l->n - 1);
    for (int a = 0; a < 3; a++)
        out[a] = l->at[i][a] + (t - i) * (l->at[i + 1][a] - l->at[i][a]);
}

/* One node per spacing of arc length (and of width), nearest node. */
static ph_status add_nodes(ph_i_generator *g, const ph_filler *f, const line *l,
                           bool sheet, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_placed x = g->p->filler[g->p->n - 1];
    double h = g->spacing, n = fmax(floor(x.length / h + 0.5), 1), across = 1;
    if (sheet && g->p->dimensions == 3) across = fmax(floor(x.width / h + 0.5), 1);
    PH_CHECK(n * across < 1e8, PH_EUNPHYSICAL, "a filler of %g nodes", n * across);
    for (int i = 0; i < (int)n; i++)
        for (int j = 0; j < (int)across; j++) {
            double at[3], world[3], s = (i + 0.5 - 0.5 * n) * x.length / n;
            double b = (j + 0.5 - 0.5 * across) * h;
            if (f->disc && sheet && s * s + b * b > x.length * x.length / 4) continue;
            point_of(l, x.length, s, at);
            at[2] += b;
            turn(&x, at, world);
            PH_TRY(add_point(g, world, err));
        }
    g->p->filler[g->p->n - 1].content = (double)g->p->filler[g->p->n - 1].npoints;
out:
    return st;
}

static double true_content(const ph_filler *f, const ph_placed *x, int dim, bool sheet)
{
    if (dim == 2) return x->length * x->thickness;
    if (!sheet) return pi / 4 * x->thickness * x->thickness * x->length;
    return x->thickness *
           (f->disc ? pi / 4 * x->length * x->length : x->length * x->width);
}

static ph_status shape_particle(ph_i_generator *g, ph_error *err)
{
    int dim = g->p->dimensions;
    ph_placed *x = &g->p->filler[g->p->n - 1];
    ph_solid s = {.half = {x->length / 2, x->thickness / 2, INFINITY}};
    memcpy(s.frame, x->frame, sizeof s.frame);
    for (int a = 0; a < dim; a++)
        s.kind[a] = PH_EXTENT_ROUND;
    if (dim == 3) s.half[2] = s.half[1];
    x->content = dim == 2 ? pi / 4 * x->length * x->thickness
                          : pi / 6 * x->length * x->thickness * x->thickness;
    return add_solid(g, &s, err);
}

ph_status ph_i_shape_filler(ph_i_generator *g, ph_counting counting, ph_random r,
                            ph_error *err)
{
    ph_status st = PH_OK;
    ph_placed *x = &g->p->filler[g->p->n - 1];
    const ph_filler *f = &g->c->fillers[x->kind];
    line l = {0};
    bool sheet = strcmp(f->shape, "platelet") == 0;
    if (strcmp(f->shape, "particle") == 0) return shape_particle(g, err);
    if (x->bend > 0 && f->curvature == PH_CURVATURE_RADIUS)
        PH_CHECK(x->length <= 2 * pi * x->bend, PH_EUNPHYSICAL,
                 "a filler of length %g and radius of curvature %g closes on itself",
                 x->length, x->bend);
    r.draw = DRAW_PITCH;
    double pitch = f->pitch.kind < 0
                       ? 0
                       : ph_distribution_quantile(&f->pitch, ph_random_uniform(&r));
    int n = segments(g, f, x, pitch);
    if (f->disc && sheet && n < 16) n = 16; /* strips of the round outline */
    PH_TRY(make_line(g, f, x, n, r, &l, err));
    for (int i = 0; i < n; i++)
        PH_TRY(add_segment(g, f, &l, i, sheet, err));
    if (counting == PH_COUNT_NODES)
        PH_TRY(add_nodes(g, f, &l, sheet, err));
    else
        x->content = true_content(f, x, g->p->dimensions, sheet);
out:
    free(l.at);
    return st;
}
