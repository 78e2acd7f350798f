/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From marks to cuts: what a cell that surfaces pass through is made of. */
#include "core/check.h"
#include "paint.h"

#include <math.h>
#include <string.h>

/* Shares below this, of cells where several images meet, are errors of their quadrature. */
static const double negligible = 1e-6;

/* --- normals ------------------------------------------------------------------------- */

static double norm(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* Own axis along which the solid is thinner than the cell and much thinner than along the
 * others, so that both its faces may be in the cell and their normals cancel; or -1. */
static int thin_axis(const ph_solid *s, int dimensions, const double edge[3])
{
    int k = 0;
    for (int i = 1; i < dimensions; i++)
        if (s->half[i] < s->half[k]) k = i;
    double width = 0, next = INFINITY;
    for (int a = 0; a < dimensions; a++)
        width += fabs(s->frame[k][a]) * edge[a];
    for (int i = 0; i < dimensions; i++)
        if (i != k) next = fmin(next, s->half[i]);
    return 2 * s->half[k] < width && 2 * s->half[k] < next ? k : -1;
}

/* Normal of the laminate that stands for the solid in a cell, and the surface it stands for:
 * the mean outward normal; the short axis of a thin solid; for what lies wholly inside the
 * cell, where the mean vanishes, the direction of its level at the cell's centre. */
static double mean_normal(const ph_solid *s, int dimensions, const double lo[3],
                          const double hi[3], double normal[3])
{
    double edge[3], centre[3], area[3], largest = 0, volume = 1;
    for (int a = 0; a < 3; a++) {
        edge[a] = hi[a] - lo[a];
        centre[a] = (lo[a] + hi[a]) / 2;
        if (a < dimensions) volume *= edge[a];
    }
    for (int a = 0; a < dimensions; a++)
        largest = fmax(largest, volume / edge[a]);
    int thin = thin_axis(s, dimensions, edge);
    if (thin >= 0) {
        memcpy(normal, s->frame[thin], 3 * sizeof *normal);
        return 2 * largest;
    }
    ph_solid_area_vector(s, dimensions, lo, hi, area);
    double size = norm(area);
    if (size < 1e-3 * largest)
        ph_solid_level(s, centre, normal);
    else
        for (int a = 0; a < 3; a++)
            normal[a] = area[a] / size;
    return fmax(size, 1e-3 * largest);
}

/* Axis of several normals, of which the sign does not count: the dominant eigenvector of
 * sum w n (x) n, by squaring that matrix. */
static void common_axis(double m[3][3], double axis[3])
{
    for (int step = 0; step < 12; step++) {
        double square[3][3] = {{0}}, trace = 0;
        for (int i = 0; i < 3; i++)
            trace += m[i][i];
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                for (int k = 0; k < 3; k++)
                    square[i][j] += m[i][k] / trace * (m[k][j] / trace);
        memcpy(m, square, sizeof square);
    }
    int best = 0;
    for (int i = 1; i < 3; i++)
        if (m[i][i] > m[best][best]) best = i;
    double size = norm(m[best]);
    for (int a = 0; a < 3; a++)
        axis[a] = m[best][a] / size;
}

/* --- shares of a cell with several images --------------------------------------------- */

/* A cell and the images on it. Visible is what no later image covers. */
typedef struct crowd {
    const ph_canvas *canvas;
    ptrdiff_t n;
    const ph_mark *mark;
    double lo[3], hi[3];
    double *share;  /* [n] visible share of the cell */
    double *chord;  /* [n][2] */
    double *ends;   /* [2 n + 2] */
    double *breaks; /* [2][BREAKS_PER_IMAGE n + 2] for axes 2 and 3 */
} crowd;

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static ptrdiff_t topmost(const crowd *c, double at)
{
    for (ptrdiff_t k = c->n - 1; k >= 0; k--)
        if (at > c->chord[2 * k] && at < c->chord[2 * k + 1]) return k;
    return -1;
}

/* Adds weight times the visible part of the line along axis 1 through x. */
static void add_line(crowd *c, const double x[3], double weight)
{
    double length = c->hi[0] - c->lo[0];
    size_t n = 0;
    c->ends[n++] = 0;
    c->ends[n++] = length;
    for (ptrdiff_t k = 0; k < c->n; k++) {
        double *t = &c->chord[2 * k];
        if (!ph_i_solid_chord(&c->canvas->images[c->mark[k].image].solid, x, 0, t))
            t[0] = t[1] = -1;
        for (int e = 0; e < 2; e++)
            if (t[e] > 0 && t[e] < length) c->ends[n++] = t[e];
    }
    qsort(c->ends, n, sizeof *c->ends, ascending);
    for (size_t i = 0; i + 1 < n; i++) {
        ptrdiff_t k = topmost(c, (c->ends[i] + c->ends[i + 1]) / 2);
        if (k >= 0) c->share[k] += weight * (c->ends[i + 1] - c->ends[i]) / length;
    }
}

enum { BREAKS_PER_IMAGE = 2 + 8 };

static void add_break(const crowd *c, int axis, double *at, size_t *n, double t)
{
    if (t > c->lo[axis] && t < c->hi[axis]) at[(*n)++] = t;
}

/* Places along an axis where the lines jump or bend, and a quadrature must stop: where an
 * image begins or ends, and where its surface passes the two faces of the cell at which the
 * lines end. x holds what the outer quadrature has chosen. */
static size_t find_breaks(const crowd *c, int axis, const double x[3], double *at)
{
    bool inner = axis == c->canvas->dimensions - 1;
    size_t n = 0;
    at[n++] = c->lo[axis];
    at[n++] = c->hi[axis];
    for (ptrdiff_t k = 0; k < c->n; k++) {
        const ph_solid *s = &c->canvas->images[c->mark[k].image].solid;
        for (int side = -1; side <= 1; side += 2)
            add_break(c, axis, at, &n, s->centre[axis] + side * s->bounds[axis]);
        for (int edge = 0; edge < (inner ? 2 : 4); edge++) {
            double y[3] = {edge & 1 ? c->lo[0] : c->hi[0], x[1], x[2]}, t[2];
            y[axis] = 0;
            if (!inner) y[2] = edge & 2 ? c->lo[2] : c->hi[2];
            if (!ph_i_solid_chord(s, y, axis, t)) continue;
            for (int e = 0; e < 2; e++)
                add_break(c, axis, at, &n, t[e]);
        }
    }
    qsort(at, n, sizeof *at, ascending);
    return n;
}

static const double gauss_node[8] = {
    -0.960289856497536231683560868569473, -0.796666477413626739591553936475831,
    -0.525532409916328985817739049189246, -0.183434642495649804939476142360184,
    0.183434642495649804939476142360184,  0.525532409916328985817739049189246,
    0.796666477413626739591553936475831,  0.960289856497536231683560868569473};
static const double gauss_weight[8] = {
    0.101228536290376259152531354309962, 0.222381034453374470544355994426241,
    0.313706645877887287337962201986601, 0.362683783378361982965150449277196,
    0.362683783378361982965150449277196, 0.313706645877887287337962201986601,
    0.222381034453374470544355994426241, 0.101228536290376259152531354309962};

/* Integrates the lines over the axes `axis`.. of the cell, composite Gauss between breaks. */
static void add_lines(crowd *c, int axis, double x[3], double weight)
{
    if (axis == c->canvas->dimensions || axis == 3) {
        add_line(c, x, weight);
        return;
    }
    int panels = c->canvas->dimensions == 2 ? 32 : 2;
    double *at = c->breaks + (axis - 1) * (BREAKS_PER_IMAGE * c->n + 2);
    size_t n = find_breaks(c, axis, x, at);
    for (size_t i = 0; i + 1 < n; i++) {
        double width = (at[i + 1] - at[i]) / panels, from = at[i];
        double share = weight * width / (c->hi[axis] - c->lo[axis]) / 2;
        for (int p = 0; p < panels && width > 0; p++)
            for (int g = 0; g < 8; g++) {
                x[axis] = from + (p + (1 + gauss_node[g]) / 2) * width;
                add_lines(c, axis + 1, x, share * gauss_weight[g]);
            }
    }
}

/* --- cuts ------------------------------------------------------------------------------ */

static ph_status add_cut(ph_microstructure *m, ptrdiff_t *held, const ph_cut *cut,
                         ph_error *err)
{
    ph_status st = PH_OK;
    if (m->ncuts == *held) {
        ptrdiff_t more = *held ? 2 * *held : 256;
        ph_cut *p = realloc(m->cuts, (size_t)more * sizeof *p);
        PH_CHECK(p, PH_ENOMEM, "no memory for the cuts (%td x %zu bytes)", more,
                 sizeof *p);
        m->cuts = p;
        *held = more;
    }
    m->cuts[m->ncuts++] = *cut;
out:
    return st;
}

/* One image on one material: fraction and normal of its own geometry. */
static ph_status cut_by_one(const ph_canvas *canvas, const ph_mark *mark, int base,
                            ptrdiff_t *held, ph_error *err)
{
    const ph_image *im = &canvas->images[mark->image];
    ph_cut cut = {mark->cell, base, im->material, mark->fraction, {0}};
    double lo[3], hi[3];
    ph_i_cell_box(&canvas->micro->grid, mark->cell, lo, hi);
    mean_normal(&im->solid, canvas->dimensions, lo, hi, cut.normal);
    return add_cut(canvas->micro, held, &cut, err);
}

/* Images in a row of one material and with something to see become one cut, along the axis of
 * their normals weighted by surface and by what is seen of them. The fraction of
 * a cut is its share of what it and all below it are seen to take, so that scaling by the
 * later ones gives back the shares. */
static ph_status cuts_of_shares(const crowd *c, int base, ptrdiff_t *held, ph_error *err)
{
    ph_status st = PH_OK;
    double below = 1;
    for (ptrdiff_t k = 0; k < c->n; k++)
        below -= c->share[k];
    int under = below > negligible ? base : -1; /* -1: nothing yet */
    bool first = true;
    below = under >= 0 ? below : 0;
    for (ptrdiff_t k = 0; k < c->n;) {
        int material = c->canvas->images[c->mark[k].image].material;
        double share = 0, sum[3][3] = {{0}};
        for (; k < c->n; k++) {
            const ph_image *im = &c->canvas->images[c->mark[k].image];
            double n[3];
            if (c->share[k] <= negligible) continue;
            if (im->material != material && share > 0) break;
            material = im->material;
            share += c->share[k];
            double w = c->share[k] *
                       mean_normal(&im->solid, c->canvas->dimensions, c->lo, c->hi, n);
            for (int i = 0; i < 9; i++)
                sum[i / 3][i % 3] += w * n[i / 3] * n[i % 3];
        }
        if (share > 0 && under >= 0 && (!first || material != under)) {
            ph_cut cut = {c->mark->cell,
                          first ? under : -1,
                          material,
                          share / (below + share),
                          {0}};
            common_axis(sum, cut.normal);
            PH_TRY(add_cut(c->canvas->micro, held, &cut, err));
            first = false;
        }
        if (share > 0 && under < 0) under = material;
        below += share;
    }
out:
    return st;
}

static ph_status cut_by_several(const ph_canvas *canvas, const ph_mark *mark, ptrdiff_t n,
                                int base, ptrdiff_t *held, ph_error *err)
{
    ph_status st = PH_OK;
    crowd c = {.canvas = canvas, .n = n, .mark = mark};
    ph_i_cell_box(&canvas->micro->grid, mark->cell, c.lo, c.hi);
    PH_ALLOC(c.share, n + 2 * n + (2 * n + 2) + 2 * (BREAKS_PER_IMAGE * n + 2),
             "a cell of many inclusions");
    c.chord = c.share + n;
    c.ends = c.chord + 2 * n;
    c.breaks = c.ends + 2 * n + 2;
    double x[3] = {c.lo[0], 0, 0};
    add_lines(&c, 1, x, 1);
    PH_TRY(cuts_of_shares(&c, base, held, err));
out:
    free(c.share);
    return st;
}

static int by_cell_then_order(const void *a, const void *b)
{
    const ph_mark *x = a, *y = b;
    if (x->cell != y->cell) return (x->cell > y->cell) - (x->cell < y->cell);
    return (x->image > y->image) - (x->image < y->image);
}

/* The marks of one cell. What lies under a full cover is gone; what is painted on its own
 * material changes nothing. */
static ph_status cut_cell(const ph_canvas *canvas, ptrdiff_t from, ptrdiff_t to,
                          ptrdiff_t *held, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_mark *mark = canvas->marks;
    int base = mark[from].below;
    for (ptrdiff_t k = to - 1; k >= from; k--) {
        if (mark[k].fraction < 1) continue;
        base = canvas->images[mark[k].image].material;
        from = k + 1;
        break;
    }
    while (from < to && canvas->images[mark[from].image].material == base)
        from++;
    if (to - from == 1) PH_TRY(cut_by_one(canvas, &mark[from], base, held, err));
    if (to - from > 1)
        PH_TRY(cut_by_several(canvas, &mark[from], to - from, base, held, err));
out:
    return st;
}

ph_status ph_i_cut_cells(ph_canvas *canvas, ph_error *err)
{
    ph_status st = PH_OK;
    ph_microstructure *m = canvas->micro;
    ptrdiff_t held = m->ncuts;
    if (canvas->nmarks > 1)
        qsort(canvas->marks, (size_t)canvas->nmarks, sizeof *canvas->marks,
              by_cell_then_order);
    for (ptrdiff_t from = 0, to; from < canvas->nmarks; from = to) {
        for (to = from + 1; to < canvas->nmarks; to++)
            if (canvas->marks[to].cell != canvas->marks[from].cell) break;
        PH_TRY(cut_cell(canvas, from, to, &held, err));
    }
out:
    return st;
}
