/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which bonds cross a crack. Every decision is made of the sides of points: on which side of
 * the crack's plane is a node, on which side of the bond is a tip. Points nearer to a plane
 * than `on` are on it and count as its positive side, so that the answer does not hang on
 * the last digit, and a bond, always walked the same way, is cut or whole. */
#include "core/vec3.h"
#include "space/broken.h"

#include <math.h>
#include <string.h>

static const double on = 1e-9; /* of the spacing */

/* A straight piece of line, or a plane figure. */
typedef struct piece {
    const ph_crack *crack;
    const double (*vertex)[3]; /* of the polygon */
    double a[3], b[3];         /* ends of a piece of line */
    double origin[3], normal[3], axis[2][3];
    double low[3], high[3];
} piece;

typedef struct cutter {
    ph_broken *broken;
    const ph_grid *rve;
    const ptrdiff_t *first;
    bool inside;
    ptrdiff_t nhalf, *half; /* bonds that point upwards: each pair once */
    double longest;         /* bond */
    double tolerance;       /* a length */
    double shift[3];        /* of the image */
    bool met;               /* the crack at hand crosses a bond */
} cutter;

/* ---- pieces ------------------------------------------------------------------------------ */

static void extend(piece *p, const double *x)
{
    for (int d = 0; d < 3; d++) {
        p->low[d] = fmin(p->low[d], x[d]);
        p->high[d] = fmax(p->high[d], x[d]);
    }
}

static piece new_piece(const ph_crack *k)
{
    const double far = (double)INFINITY;
    return (piece){.crack = k, .low = {far, far, far}, .high = {-far, -far, -far}};
}

static piece line_piece(const ph_crack *k, const double *a, const double *b)
{
    piece p = new_piece(k);
    memcpy(p.a, a, sizeof p.a);
    memcpy(p.b, b, sizeof p.b);
    memcpy(p.origin, a, sizeof p.origin);
    p.normal[0] = -(b[1] - a[1]); /* to the left */
    p.normal[1] = b[0] - a[0];
    ph_i_normalise3(p.normal);
    extend(&p, a);
    extend(&p, b);
    return p;
}

static piece ellipse_piece(const ph_crack *k)
{
    piece p = new_piece(k);
    memcpy(p.origin, k->centre, sizeof p.origin);
    memcpy(p.axis, k->axis, sizeof p.axis);
    ph_i_cross3(k->axis[0], k->axis[1], p.normal);
    for (int d = 0; d < 3; d++) {
        double r =
            hypot(k->semi_axes[0] * k->axis[0][d], k->semi_axes[1] * k->axis[1][d]);
        p.low[d] = k->centre[d] - r;
        p.high[d] = k->centre[d] + r;
    }
    return p;
}

static piece polygon_piece(const ph_crack *k, const double (*v)[3])
{
    piece p = new_piece(k);
    p.vertex = v;
    memcpy(p.origin, v[0], sizeof p.origin);
    for (ptrdiff_t i = 0; i < k->count; i++)
        extend(&p, v[i]);
    for (ptrdiff_t i = 2; i < k->count; i++) {
        double a[3], b[3], n[3];
        for (int d = 0; d < 3; d++) {
            a[d] = v[i - 1][d] - v[0][d];
            b[d] = v[i][d] - v[0][d];
        }
        ph_i_cross3(a, b, n);
        for (int d = 0; d < 3; d++)
            p.normal[d] += n[d];
    }
    ph_i_normalise3(p.normal);
    for (int d = 0; d < 3; d++)
        p.axis[0][d] = v[1][d] - v[0][d];
    double off = ph_i_dot3(p.axis[0], p.normal);
    for (int d = 0; d < 3; d++)
        p.axis[0][d] -= off * p.normal[d];
    ph_i_normalise3(p.axis[0]);
    ph_i_cross3(p.normal, p.axis[0], p.axis[1]);
    return p;
}

/* ---- a bond ------------------------------------------------------------------------------ */

/* Distance from the plane, zero where the point is on it. */
static double height(const cutter *c, const piece *p, const double *x)
{
    double d[3] = {x[0] - p->origin[0], x[1] - p->origin[1], x[2] - p->origin[2]};
    double s = ph_i_dot3(d, p->normal);
    return fabs(s) <= c->tolerance ? 0.0 : s;
}

/* Is a tip on the left of a bond, or on it? */
static bool tip_on_left(const cutter *c, const double *x, const double *xi,
                        const double *tip)
{
    double s = xi[0] * (tip[1] - x[1]) - xi[1] * (tip[0] - x[0]);
    return s >= -c->tolerance * hypot(xi[0], xi[1]);
}

/* Even-odd rule in the plane of the polygon. */
static bool in_polygon(const piece *p, double u, double v)
{
    bool in = false;
    for (ptrdiff_t i = 0, j = p->crack->count - 1; i < p->crack->count; j = i++) {
        double a[2], b[2];
        for (int e = 0; e < 2; e++) {
            double da[3], db[3];
            for (int d = 0; d < 3; d++) {
                da[d] = p->vertex[i][d] - p->origin[d];
                db[d] = p->vertex[j][d] - p->origin[d];
            }
            a[e] = ph_i_dot3(da, p->axis[e]);
            b[e] = ph_i_dot3(db, p->axis[e]);
        }
        if ((a[1] > v) != (b[1] > v) &&
            u < (b[0] - a[0]) * (v - a[1]) / (b[1] - a[1]) + a[0])
            in = !in;
    }
    return in;
}

/* Does the plane figure hold the point where the bond meets its plane? */
static bool holds(const piece *p, const double *x, const double *xi, double t)
{
    double d[3];
    for (int a = 0; a < 3; a++)
        d[a] = x[a] + t * xi[a] - p->origin[a];
    double u = ph_i_dot3(d, p->axis[0]), v = ph_i_dot3(d, p->axis[1]);
    if (p->crack->shape == PH_CRACK_POLYGON) return in_polygon(p, u, v);
    u /= p->crack->semi_axes[0];
    v /= p->crack->semi_axes[1];
    return u * u + v * v <= 1.0 + on;
}

static bool is_cut(const cutter *c, const piece *p, const double *x, double sx,
                   const double *xi)
{
    double y[3] = {x[0] + xi[0], x[1] + xi[1], x[2] + xi[2]};
    double sy = height(c, p, y);
    if ((sx >= 0.0) == (sy >= 0.0)) return false;
    if (p->crack->shape != PH_CRACK_LINE) return holds(p, x, xi, sx / (sx - sy));
    return tip_on_left(c, x, xi, p->a) != tip_on_left(c, x, xi, p->b);
}

/* ---- a grid ------------------------------------------------------------------------------ */

static bool in_rve(const cutter *c, const ptrdiff_t at[3], const int o[3])
{
    for (int d = 0; d < 3; d++) {
        ptrdiff_t i = at[d] + o[d] - c->first[d];
        if (i < 0 || i >= c->rve->n[d]) return false;
    }
    return true;
}

static ph_status cut_at_node(cutter *c, const piece *p, const ptrdiff_t at[3],
                             ph_error *err)
{
    ph_status st = PH_OK;
    const ph_family *f = c->broken->family;
    const int none[3] = {0, 0, 0};
    double x[3];
    ptrdiff_t node = 0;
    for (int d = 0; d < 3; d++) {
        node = node * c->broken->n[d] + at[d];
        x[d] = ((double)(at[d] - c->first[d]) + 0.5) * c->rve->h[d] - c->shift[d];
    }
    double s = height(c, p, x);
    if (fabs(s) > c->longest) return PH_OK;
    bool here = in_rve(c, at, none);
    for (ptrdiff_t i = 0; i < c->nhalf; i++) {
        ptrdiff_t b = c->half[i];
        if (!is_cut(c, p, x, s, f->xi[b])) continue;
        if (c->inside && !here && !in_rve(c, at, f->offset[b])) continue;
        PH_TRY(ph_i_break(c->broken, node, b, err));
        c->met = true;
    }
out:
    return st;
}

/* Cells of the box whose bonds may reach the image of a piece: [from, to). */
static bool reach_box(const cutter *c, const piece *p, ptrdiff_t from[3], ptrdiff_t to[3])
{
    for (int d = 0; d < 3; d++) {
        double h = c->rve->h[d], zero = (double)c->first[d];
        from[d] = 0;
        to[d] = c->broken->n[d];
        if (c->rve->n[d] == 1) continue;
        double low = floor((p->low[d] + c->shift[d] - c->longest) / h + zero) - 1.0;
        double high = ceil((p->high[d] + c->shift[d] + c->longest) / h + zero) + 1.0;
        if (high <= 0.0 || low >= (double)to[d]) return false;
        if (low > 0.0) from[d] = (ptrdiff_t)low;
        if (high < (double)to[d]) to[d] = (ptrdiff_t)high;
    }
    return true;
}

static ph_status cut_image(cutter *c, const piece *p, ph_error *err)
{
    ph_status st = PH_OK;
    ptrdiff_t from[3], to[3], at[3];
    if (!reach_box(c, p, from, to)) return PH_OK;
    for (at[0] = from[0]; at[0] < to[0]; at[0]++)
        for (at[1] = from[1]; at[1] < to[1]; at[1]++)
            for (at[2] = from[2]; at[2] < to[2]; at[2]++)
                PH_TRY(cut_at_node(c, p, at, err));
out:
    return st;
}

/* Every image of the piece, one period of the RVE apart, that bonds of the box can meet. */
static ph_status cut_piece(cutter *c, const piece *p, ph_error *err)
{
    static const double most = 1e6, periods = 1e4;
    double images = 1.0;
    ph_status st = PH_OK;
    ptrdiff_t low[3] = {0, 0, 0}, high[3] = {0, 0, 0};
    for (int d = 0; d < 3; d++) {
        double L = c->rve->size[d], h = c->rve->h[d];
        if (c->rve->n[d] == 1) continue;
        double begin = -(double)c->first[d] * h - c->longest;
        double end = (double)(c->broken->n[d] - c->first[d]) * h + c->longest;
        double a = ceil((begin - p->high[d]) / L), b = floor((end - p->low[d]) / L);
        PH_CHECK_KEY(fabs(a) < most && fabs(b) < most, PH_EINVAL, "cracks",
                     "a crack lies %g box lengths away", fmax(fabs(a), fabs(b)));
        low[d] = (ptrdiff_t)a;
        high[d] = (ptrdiff_t)b;
        images *= b - a + 1.0;
    }
    PH_CHECK_KEY(images < periods, PH_EINVAL, "cracks",
                 "a crack crosses %g periods of the RVE", images);
    for (ptrdiff_t i = low[0]; i <= high[0]; i++)
        for (ptrdiff_t j = low[1]; j <= high[1]; j++)
            for (ptrdiff_t k = low[2]; k <= high[2]; k++) {
                c->shift[0] = (double)i * c->rve->size[0];
                c->shift[1] = (double)j * c->rve->size[1];
                c->shift[2] = (double)k * c->rve->size[2];
                PH_TRY(cut_image(c, p, err));
            }
out:
    return st;
}

static bool upwards(const int o[3])
{
    return o[0] > 0 || (o[0] == 0 && (o[1] > 0 || (o[1] == 0 && o[2] > 0)));
}

static ph_status cutter_init(cutter *c, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_family *f = c->broken->family;
    double least = INFINITY;
    PH_ALLOC(c->half, f->count, "bonds");
    for (ptrdiff_t b = 0; b < f->count; b++) {
        if (upwards(f->offset[b])) c->half[c->nhalf++] = b;
        c->longest = fmax(c->longest, sqrt(ph_i_dot3(f->xi[b], f->xi[b])));
    }
    for (int d = 0; d < 3; d++)
        if (c->rve->n[d] > 1) least = fmin(least, c->rve->h[d]);
    c->tolerance = isfinite(least) ? on * least : 0.0;
out:
    return st;
}

static ph_status cut_crack(cutter *c, const ph_crack *k, const double (*v)[3],
                           ph_error *err)
{
    ph_status st = PH_OK;
    piece p;
    for (ptrdiff_t s = 1; k->shape == PH_CRACK_LINE && s < k->count; s++) {
        p = line_piece(k, v[s - 1], v[s]);
        PH_TRY(cut_piece(c, &p, err));
    }
    if (k->shape == PH_CRACK_LINE) goto out;
    p = k->shape == PH_CRACK_ELLIPSE ? ellipse_piece(k) : polygon_piece(k, v);
    PH_TRY(cut_piece(c, &p, err));
out:
    return st;
}

/* @param[out] met how many of the cracks cross a bond */
static ph_status cut_all(cutter *c, const ph_cracks *cracks, ptrdiff_t *met,
                         ph_error *err)
{
    ph_status st = PH_OK;
    *met = 0;
    for (ptrdiff_t i = 0; i < cracks->count; i++) {
        const ph_crack *k = &cracks->crack[i];
        c->met = false;
        PH_TRY(cut_crack(c, k, (const double(*)[3])(cracks->vertex + k->first), err));
        *met += c->met;
    }
out:
    return st;
}

ph_status ph_i_cracks_cut(const ph_cracks *cracks, const ph_grid *rve,
                          const ptrdiff_t first[3], bool inside, ph_broken *broken,
                          ptrdiff_t *missed, ph_error *err)
{
    ph_status st = PH_OK;
    ptrdiff_t met;
    cutter c = {.broken = broken, .rve = rve, .first = first, .inside = inside};
    ph_cracks shorter = {0};
    PH_TRY(cutter_init(&c, err));
    if (broken->tips > 0.0)
        PH_TRY(ph_i_cracks_shorten(cracks, broken->tips, &shorter, err));
    PH_TRY(cut_all(&c, broken->tips > 0.0 ? &shorter : cracks, &met, err));
    PH_TRY(ph_i_broken_settle(broken, err));
    if (missed) *missed = cracks->count - met;
out:
    ph_cracks_free(&shorter);
    free(c.half);
    return st;
}
