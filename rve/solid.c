/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solid.h"

#include "core/vec3.h"
#include "polygon.h"

#include <math.h>

/* Sections of `s` across grid axis `a` do not change between its ends. */
static bool is_prism(const ph_solid *s, int a)
{
    for (int i = 0; i < 3; i++) {
        double along = fabs(s->frame[i][a]);
        if (s->kind[i] == PH_EXTENT_ROUND && along != 0) return false;
        if (s->kind[i] == PH_EXTENT_FLAT && along != 0 && along != 1) return false;
    }
    return true;
}

static double bound(const ph_solid *s, int a)
{
    double round = 0, flat = 0;
    for (int i = 0; i < 3; i++) {
        double along = fabs(s->frame[i][a]);
        if (along == 0) continue;
        if (s->kind[i] == PH_EXTENT_FREE) return INFINITY;
        if (s->kind[i] == PH_EXTENT_FLAT) flat += along * s->half[i];
        if (s->kind[i] == PH_EXTENT_ROUND) round += pow(along * s->half[i], 2);
    }
    return flat + sqrt(round);
}

void ph_i_solid_finish(ph_solid *s)
{
    for (int a = 0; a < 3; a++)
        s->bounds[a] = bound(s, a);
    s->prism = false;
    double best = -1;
    for (int a = 2; a >= 0; a--) {
        double along = 0; /* most across the flat ends: bounded ellipses as sections */
        for (int i = 0; i < 3; i++)
            if (s->kind[i] == PH_EXTENT_FLAT) along = fmax(along, fabs(s->frame[i][a]));
        bool prism = is_prism(s, a);
        if ((prism && !s->prism) || (prism == s->prism && along > best + 1e-12)) {
            s->prism = prism;
            s->slice = a;
            best = along;
        }
    }
}

static void local(const ph_solid *s, const double x[3], double y[3])
{
    double p[3] = {x[0] - s->centre[0], x[1] - s->centre[1], x[2] - s->centre[2]};
    for (int i = 0; i < 3; i++)
        y[i] = ph_i_dot3(s->frame[i], p);
}

/* Level of the round axes: (|y / half| - 1) times the shortest of them is below the distance
 * because |y / half| changes by at most 1 / shortest per length. */
static double round_level(const ph_solid *s, const double y[3], double grad[3])
{
    double sum = 0, shortest = INFINITY;
    for (int i = 0; i < 3; i++) {
        grad[i] = 0;
        if (s->kind[i] != PH_EXTENT_ROUND) continue;
        double q = y[i] / s->half[i];
        sum += q * q;
        grad[i] = q / s->half[i];
        shortest = fmin(shortest, s->half[i]);
    }
    return isfinite(shortest) ? (sqrt(sum) - 1) * shortest : (double)-INFINITY;
}

double ph_solid_level(const ph_solid *s, const double x[3], double normal[3])
{
    if (!s || !x) return NAN;
    double y[3], g[3];
    local(s, x, y);
    double level = round_level(s, y, g);
    int flat = -1;
    for (int i = 0; i < 3; i++) {
        if (s->kind[i] != PH_EXTENT_FLAT) continue;
        double d = fabs(y[i]) - s->half[i];
        if (d <= level) continue;
        level = d;
        flat = i;
    }
    if (!normal) return level;
    if (flat >= 0)
        for (int i = 0; i < 3; i++)
            g[i] = i == flat ? copysign(1, y[i]) : 0.0;
    double norm = sqrt(ph_i_dot3(g, g));
    if (norm == 0) { /* the very centre: any direction, say the shortest axis */
        int k = 0;
        for (int i = 1; i < 3; i++)
            if (s->half[i] < s->half[k]) k = i;
        norm = g[k] = 1;
    }
    for (int a = 0; a < 3; a++)
        normal[a] =
            (g[0] * s->frame[0][a] + g[1] * s->frame[1][a] + g[2] * s->frame[2][a]) /
            norm;
    return level;
}

bool ph_i_solid_chord(const ph_solid *s, const double x[3], int axis, double t[2])
{
    double y[3], A = 0, B = 0, C = -1;
    bool any = false;
    local(s, x, y);
    t[0] = -INFINITY;
    t[1] = INFINITY;
    for (int i = 0; i < 3; i++) {
        double d = s->frame[i][axis], w = s->half[i];
        if (s->kind[i] == PH_EXTENT_ROUND) {
            A += d * d / (w * w);
            B += d * y[i] / (w * w);
            C += y[i] * y[i] / (w * w);
            any = true;
        } else if (s->kind[i] == PH_EXTENT_FLAT && d == 0) {
            if (fabs(y[i]) > w) return false;
        } else if (s->kind[i] == PH_EXTENT_FLAT) {
            t[0] = fmax(t[0], (-y[i] - copysign(w, d)) / d);
            t[1] = fmin(t[1], (-y[i] + copysign(w, d)) / d);
        }
    }
    if (any && A == 0 && C > 0) return false;
    if (any && A > 0) {
        double disc = B * B - A * C;
        if (disc <= 0) return false;
        t[0] = fmax(t[0], (-B - sqrt(disc)) / A);
        t[1] = fmin(t[1], (-B + sqrt(disc)) / A);
    }
    return t[0] < t[1];
}

/* The round axes in a plane with coordinates (x, y): |U x + V y + m|^2 <= 1. */
typedef struct conic {
    bool any;
    double U[3], V[3], m[3];
    double N[3],
        det; /* U cross V and its square, the determinant of the quadratic form */
} conic;

static conic conic_of(const ph_solid *s, int axis, double at)
{
    conic q = {0};
    for (int i = 0; i < 3; i++) {
        if (s->kind[i] != PH_EXTENT_ROUND) continue;
        q.U[i] = s->frame[i][(axis + 1) % 3] / s->half[i];
        q.V[i] = s->frame[i][(axis + 2) % 3] / s->half[i];
        q.m[i] = s->frame[i][axis] * at / s->half[i];
        q.any = true;
    }
    ph_i_cross3(q.U, q.V, q.N);
    q.det = ph_i_dot3(q.N, q.N);
    return q;
}

/* A cylinder cut along its axis: U and V are parallel and the conic is a strip. */
static double strip_area(ph_polygon *p, const conic *q)
{
    double uu = ph_i_dot3(q->U, q->U), vv = ph_i_dot3(q->V, q->V), g = sqrt(uu + vv);
    if (g == 0) return ph_i_dot3(q->m, q->m) <= 1 ? ph_i_polygon_area(p) : 0;
    const double *w = uu > vv ? q->U : q->V;
    double ww = ph_i_dot3(w, w),
           e[2] = {ph_i_dot3(q->U, w) / ww, ph_i_dot3(q->V, w) / ww}; /* U = e0 w, .. */
    double shift = ph_i_dot3(w, q->m) / ww,
           rest = shift * shift - (ph_i_dot3(q->m, q->m) - 1) / ww;
    if (rest <= 0) return 0;
    double back[2] = {-e[0], -e[1]};
    ph_i_polygon_clip(p, e, sqrt(rest) - shift);
    ph_i_polygon_clip(p, back, sqrt(rest) + shift);
    return ph_i_polygon_area(p);
}

/* An ellipse: moved to its centre and mapped to the unit disk by the Cholesky factor of its
 * matrix. Cross products instead of the normal equations: no cancellation. */
static double ellipse_area(ph_polygon *p, const conic *q)
{
    double mV[3], Um[3], off = ph_i_dot3(q->m, q->N);
    ph_i_cross3(q->m, q->V, mV);
    ph_i_cross3(q->U, q->m, Um);
    double x0 = -ph_i_dot3(mV, q->N) / q->det, y0 = -ph_i_dot3(Um, q->N) / q->det;
    double rho2 = 1 - off * off / q->det;
    if (rho2 <= 0) return 0;
    double rho = sqrt(rho2), l11 = sqrt(ph_i_dot3(q->U, q->U)),
           l21 = ph_i_dot3(q->U, q->V) / l11, l22 = sqrt(q->det) / l11;
    for (int i = 0; i < p->n; i++) {
        double x = p->x[i][0] - x0, y = p->x[i][1] - y0;
        p->x[i][0] = (l11 * x + l21 * y) / rho;
        p->x[i][1] = l22 * y / rho;
    }
    return ph_i_polygon_area_in_disk(p) * rho2 / (l11 * l22);
}

double ph_i_solid_section(const ph_solid *s, int axis, double at, const double lo[3],
                          const double hi[3])
{
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const double *c = s->centre;
    double t = at - c[axis];
    ph_polygon p = ph_i_rectangle(lo[u] - c[u], hi[u] - c[u], lo[v] - c[v], hi[v] - c[v]);
    for (int i = 0; i < 3; i++) {
        if (s->kind[i] != PH_EXTENT_FLAT) continue;
        double a[2] = {s->frame[i][u], s->frame[i][v]}, back[2] = {-a[0], -a[1]};
        double y = s->frame[i][axis] * t;
        ph_i_polygon_clip(&p, a, s->half[i] - y);
        ph_i_polygon_clip(&p, back, s->half[i] + y);
    }
    if (p.n < 3) return 0;
    conic q = conic_of(s, axis, t);
    if (!q.any) return ph_i_polygon_area(&p);
    double trace = ph_i_dot3(q.U, q.U) + ph_i_dot3(q.V, q.V);
    return q.det <= 1e-24 * trace * trace ? strip_area(&p, &q) : ellipse_area(&p, &q);
}

/* Gauss-Kronrod 3-7 on [-1, 1]: nodes >= 0, Kronrod and Gauss weights. */
static const double gk_node[4] = {0.960491268708020283423507092629080,
                                  0.774596669241483377035853079956480,
                                  0.434243749346802558002071502844628, 0};
static const double gk_kronrod[4] = {
    0.104656226026467265193823857192073, 0.268488089868333440728569280666710,
    0.401397414775962222905051818618432, 0.450916538658474142345110087045571};
static const double gk_gauss[4] = {0, 0.555555555555555555555555555555556, 0,
                                   0.888888888888888888888888888888889};

typedef struct box {
    const ph_solid *solid;
    int slice; /* axis across which it is cut into sections */
    const double *lo, *hi;
    double tolerance; /* of a piece, per length */
} box;

static double sections(const box *b, double from, double to, int depth)
{
    double half = (to - from) / 2, middle = (to + from) / 2, kronrod = 0, gauss = 0;
    for (int i = 0; i < 4; i++) {
        double f = 0;
        for (int side = -1; side <= (i < 3 ? 1 : -1); side += 2)
            f += ph_i_solid_section(b->solid, b->slice, middle + side * half * gk_node[i],
                                    b->lo, b->hi);
        kronrod += gk_kronrod[i] * f;
        gauss += gk_gauss[i] * f;
    }
    if (depth == 0 || fabs(kronrod - gauss) <= b->tolerance * 2) return kronrod * half;
    return sections(b, from, middle, depth - 1) + sections(b, middle, to, depth - 1);
}

enum { PIECES_MAX = 2 + 8 + 12 };

/* Sorts `t` into at[1..n) if it is within. */
static void add_piece(double *at, int *n, double to, double t)
{
    if (!(t > at[0] && t < to)) return;
    int k = (*n)++;
    for (; k > 1 && at[k - 1] > t; k--)
        at[k] = at[k - 1];
    at[k] = t;
}

/* Sections change their form where an edge of the box along the slicing axis enters or
 * leaves the solid, and where a round flat end begins or stops.
 * @param[out] at [PIECES_MAX] ascending, both ends included. */
static int find_pieces(const box *b, double from, double to, double *at)
{
    const ph_solid *s = b->solid;
    int a = b->slice, u = (a + 1) % 3, v = (a + 2) % 3, n = 0;
    double round = 0;
    at[n++] = from;
    for (int edge = 0; edge < 4; edge++) {
        double x[3], t[2];
        x[a] = 0;
        x[u] = edge & 1 ? b->lo[u] : b->hi[u];
        x[v] = edge & 2 ? b->lo[v] : b->hi[v];
        if (!ph_i_solid_chord(s, x, a, t)) continue;
        for (int e = 0; e < 2; e++)
            add_piece(at, &n, to, t[e]);
    }
    for (int i = 0; i < 3; i++)
        if (s->kind[i] == PH_EXTENT_ROUND) round += pow(s->frame[i][a] * s->half[i], 2);
    for (int i = 0; i < 3; i++) {
        if (s->kind[i] != PH_EXTENT_FLAT) continue;
        for (int e = 0; e < 4; e++)
            add_piece(at, &n, to,
                      s->centre[a] + (e & 1 ? 1 : -1) * s->frame[i][a] * s->half[i] +
                          (e & 2 ? 1 : -1) * sqrt(round));
    }
    at[n++] = to;
    return n;
}

/* A solid without flat ends can be sliced along any axis. Along the odd one of the box its
 * sections know no difference between the two that are alike, and images that a turn about
 * that axis makes of one another get the same share of their cells. */
static int slice_of(const ph_solid *s, const double lo[3], const double hi[3])
{
    int best = s->slice;
    double least = INFINITY;
    for (int i = 0; i < 3; i++)
        if (s->kind[i] != PH_EXTENT_ROUND) return s->slice;
    for (int i = 0; i < 3; i++) {
        int a = (s->slice + i) % 3, u = (a + 1) % 3, v = (a + 2) % 3;
        double p = hi[u] - lo[u], q = hi[v] - lo[v], off = fabs(p - q) / (p + q);
        if (off < least - 1e-9) least = off, best = a;
    }
    return best;
}

double ph_solid_overlap(const ph_solid *s, int dimensions, const double lo[3],
                        const double hi[3])
{
    if (!s || !lo || !hi) return NAN;
    if (dimensions == 2) return ph_i_solid_section(s, 2, s->centre[2], lo, hi);
    int a = slice_of(s, lo, hi), u = (a + 1) % 3, v = (a + 2) % 3;
    double from = fmax(lo[a], s->centre[a] - s->bounds[a]), sum = 0, at[PIECES_MAX];
    double to = fmin(hi[a], s->centre[a] + s->bounds[a]);
    if (from >= to) return 0;
    if (s->prism) return (to - from) * ph_i_solid_section(s, a, s->centre[a], lo, hi);
    box b = {s, a, lo, hi, 2e-7 * (hi[u] - lo[u]) * (hi[v] - lo[v])};
    int n = find_pieces(&b, from, to, at);
    for (int i = 0; i + 1 < n; i++) { /* halves: one rule alone is deceived more easily */
        double mid = (at[i] + at[i + 1]) / 2;
        sum += sections(&b, at[i], mid, 10) + sections(&b, mid, at[i + 1], 10);
    }
    return sum;
}

/* Area of the solid on the face of the box at `at`; 2D: length on the edge. */
static double face(const ph_solid *s, int dimensions, int axis, double at,
                   const double lo[3], const double hi[3])
{
    if (dimensions == 3) return ph_i_solid_section(s, axis, at, lo, hi);
    int u = 1 - axis;
    double x[3] = {s->centre[0], s->centre[1], s->centre[2]}, t[2];
    x[axis] = at;
    if (!ph_i_solid_chord(s, x, u, t)) return 0;
    return fmax(0, fmin(hi[u], x[u] + t[1]) - fmax(lo[u], x[u] + t[0]));
}

void ph_solid_area_vector(const ph_solid *s, int dimensions, const double lo[3],
                          const double hi[3], double area[3])
{
    if (!s || !lo || !hi || !area) return;
    area[2] = 0;
    for (int a = 0; a < dimensions; a++) {
        /* A little inside, so that a surface lying in a face of the box does not count. */
        double in = 1e-9 * (hi[a] - lo[a]);
        area[a] = face(s, dimensions, a, lo[a] + in, lo, hi) -
                  face(s, dimensions, a, hi[a] - in, lo, hi);
    }
}
