/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures in which fillers can be told apart. */
#include "core/check.h"
#include "io/picture.h"
#include "perihom_rve.h"

#include <math.h>

enum { MARGIN = 24, PANEL = 560, HEAD = 34 };

/* Hue by the golden angle, so that neighbours in number differ most. */
static ph_i_colour colour_of(const ph_microstructure *m, ptrdiff_t cell, int matrix)
{
    int32_t owner = m->owner ? m->owner[cell] : 0;
    int phase = m->phase[cell];
    if (owner > 0) {
        static const double light[] = {0.62, 0.52, 0.70};
        return ph_i_oklch(light[owner % 3], 0.14, fmod(137.50776405 * owner, 360));
    }
    if (phase == matrix) return ph_i_oklch(0.95, 0.012, 85);
    return ph_i_material_colour(phase, m->materials[phase].is_void);
}

static ptrdiff_t cell_at(const ph_grid *g, const ptrdiff_t i[3])
{
    return (i[0] * g->n[1] + i[1]) * g->n[2] + i[2];
}

/* Slice through layer `layer` of axis `through`, at most PANEL pixels wide. */
static void draw_slice(ph_i_picture *p, int x, int y, const ph_microstructure *m,
                       int matrix, int through, int width, int height)
{
    const ph_grid *g = &m->grid;
    int right = through == 0 ? 1 : 0, up = through == 2 ? 1 : 2;
    for (int b = 0; b < height; b++)
        for (int a = 0; a < width; a++) {
            ptrdiff_t i[3];
            i[through] = g->n[through] / 2;
            i[right] = (ptrdiff_t)((a + 0.5) / width * (double)g->n[right]);
            i[up] = (ptrdiff_t)((height - b - 0.5) / height * (double)g->n[up]);
            p->pixel[(size_t)(y + b) * (size_t)p->width + (size_t)(x + a)] =
                colour_of(m, cell_at(g, i), matrix);
        }
    ph_i_frame(p, x, y, width, height, (ph_i_colour){60, 60, 60});
}

/* Parameter interval in which the ray o + t d is in the box; the face where it enters. */
static bool enter_box(const double size[3], const double o[3], const double d[3],
                      double *from, double *to)
{
    *from = -INFINITY;
    *to = INFINITY;
    for (int a = 0; a < 3; a++) {
        if (d[a] == 0 && (o[a] < 0 || o[a] > size[a])) return false;
        if (d[a] == 0) continue;
        double t0 = -o[a] / d[a], t1 = (size[a] - o[a]) / d[a];
        *from = fmax(*from, fmin(t0, t1));
        *to = fmin(*to, fmax(t0, t1));
    }
    return *to > *from;
}

/* First cell along the ray that is not matrix, or -1; its depth, and the light on the face
 * or on the surface through which the ray enters it. */
static ptrdiff_t march(const ph_microstructure *m, int matrix, const double o[3],
                       const double d[3], double step, double *depth)
{
    const ph_grid *g = &m->grid;
    double from, to;
    if (!enter_box(g->size, o, d, &from, &to)) return -1;
    ptrdiff_t steps = (ptrdiff_t)ceil((to - from) / step);
    for (ptrdiff_t s = 0; s < steps; s++) {
        double t = from + (1e-6 + (double)s) * step;
        ptrdiff_t i[3];
        for (int a = 0; a < 3; a++) {
            double x = floor((o[a] + t * d[a]) / g->h[a]);
            i[a] = (ptrdiff_t)fmin(fmax(x, 0), (double)(g->n[a] - 1));
        }
        ptrdiff_t cell = cell_at(g, i);
        if (m->phase[cell] == matrix && !(m->owner && m->owner[cell])) continue;
        *depth = t;
        return cell;
    }
    return -1;
}

typedef struct view {
    double right[3], up[3], into[3], scale;
    int size;
    double *depth; /* [size][size], NaN: nothing */
    ph_i_colour *colour;
} view;

static void view_init(view *v, const ph_grid *g)
{
    const double s = sqrt(0.5), t = sqrt(1.0 / 6), u = sqrt(1.0 / 3);
    const double right[3] = {-s, s, 0}, up[3] = {-t, -t, 2 * t}, into[3] = {-u, -u, -u};
    for (int a = 0; a < 3; a++) {
        v->right[a] = right[a];
        v->up[a] = up[a];
        v->into[a] = into[a];
    }
    v->size = PANEL;
    v->scale = 1.05 *
               sqrt(g->size[0] * g->size[0] + g->size[1] * g->size[1] +
                    g->size[2] * g->size[2]) /
               PANEL;
}

static void cast(view *v, const ph_microstructure *m, int matrix)
{
    const ph_grid *g = &m->grid;
    double step = 0.4 * fmin(g->h[0], fmin(g->h[1], g->h[2]));
    for (int b = 0; b < v->size; b++)
        for (int a = 0; a < v->size; a++) {
            double o[3], x = (a + 0.5 - v->size / 2.0) * v->scale;
            double y = (v->size / 2.0 - b - 0.5) * v->scale;
            size_t k = (size_t)b * (size_t)v->size + (size_t)a;
            for (int c = 0; c < 3; c++)
                o[c] = g->size[c] / 2 + x * v->right[c] + y * v->up[c];
            v->depth[k] = NAN;
            ptrdiff_t cell = march(m, matrix, o, v->into, step, &v->depth[k]);
            if (cell >= 0) v->colour[k] = colour_of(m, cell, matrix);
        }
}

/* Light from the upper left on the surface whose slope is that of the depths around. */
static double light_at(const view *v, int a, int b)
{
    double slope[2] = {0, 0}, here = v->depth[(size_t)b * (size_t)v->size + (size_t)a];
    for (int k = 0; k < 2; k++) {
        double sum = 0;
        int used = 0;
        for (int side = -2; side <= 2; side++) {
            int x = a + (k == 0 ? side : 0), y = b + (k == 1 ? side : 0);
            if (side == 0 || x < 0 || y < 0 || x >= v->size || y >= v->size) continue;
            double d = v->depth[(size_t)y * (size_t)v->size + (size_t)x];
            if (isnan(d) || fabs(d - here) > 12 * v->scale) continue;
            sum += (d - here) / (side * v->scale);
            used++;
        }
        if (used) slope[k] = sum / used;
    }
    double n = sqrt(1 + slope[0] * slope[0] + slope[1] * slope[1]);
    return fmax(0, (1 + 0.5 * slope[0] + 0.8 * slope[1]) / n / sqrt(1.89));
}

static ph_status draw_view(ph_i_picture *p, int x, int y, const ph_microstructure *m,
                           int matrix, ph_error *err)
{
    ph_status st = PH_OK;
    view v = {.depth = NULL};
    view_init(&v, &m->grid);
    PH_ALLOC(v.depth, (size_t)v.size * (size_t)v.size, "the view");
    PH_ALLOC(v.colour, (size_t)v.size * (size_t)v.size, "the view");
    cast(&v, m, matrix);
    double reach = v.scale * v.size / 2;
    for (int b = 0; b < v.size; b++)
        for (int a = 0; a < v.size; a++) {
            size_t k = (size_t)b * (size_t)v.size + (size_t)a;
            if (isnan(v.depth[k])) continue;
            double fog = 0.22 * (v.depth[k] + reach) / (2 * reach);
            ph_i_colour c = ph_i_mix_colours((ph_i_colour){12, 12, 16}, v.colour[k],
                                             0.25 + 0.75 * light_at(&v, a, b));
            p->pixel[(size_t)(y + b) * (size_t)p->width + (size_t)(x + a)] =
                ph_i_mix_colours(c, (ph_i_colour){255, 255, 255}, fog);
        }
out:
    free(v.depth);
    free(v.colour);
    return st;
}

/* Pixels of a length; whole pixels a cell where they are few. */
static void panel_size(const ph_grid *g, int right, int up, int most, int out[2])
{
    double longest = fmax(g->size[right], g->size[up]);
    double cells = (double)(g->n[right] > g->n[up] ? g->n[right] : g->n[up]);
    double pixels = fmax(floor(most / cells), 1) * cells;
    if (pixels > 2 * most) pixels = most;
    out[0] = (int)fmax(rint(pixels * g->size[right] / longest), 1);
    out[1] = (int)fmax(rint(pixels * g->size[up] / longest), 1);
}

static ph_status picture_3d(ph_i_picture *p, const ph_microstructure *m, int matrix,
                            ph_error *err)
{
    static const char *const names[3] = {"axis 2 right, 3 up", "axis 1 right, 3 up",
                                         "axis 1 right, 2 up"};
    ph_status st = PH_OK;
    PH_TRY(ph_i_picture_new(2 * PANEL + 3 * MARGIN, 2 * (PANEL + HEAD) + 2 * MARGIN, p,
                            err));
    for (int k = 0; k < 3; k++) {
        int size[2], x = MARGIN + (k % 2) * (PANEL + MARGIN);
        int y = MARGIN + HEAD + (k / 2) * (PANEL + HEAD);
        panel_size(&m->grid, k == 0 ? 1 : 0, k == 2 ? 1 : 2, PANEL, size);
        if (size[0] > PANEL || size[1] > PANEL) size[0] = size[1] = PANEL;
        draw_slice(p, x, y, m, matrix, k, size[0], size[1]);
        ph_i_text(p, x, y - 20, 2, names[k], (ph_i_colour){110, 110, 110});
    }
    PH_TRY(
        draw_view(p, 2 * MARGIN + PANEL, MARGIN + HEAD + PANEL + HEAD, m, matrix, err));
out:
    return st;
}

ph_status ph_rve_write_picture(const char *path, const ph_microstructure *m, int matrix,
                               const char *title, ph_error *err)
{
    PH_GIVEN(path && m);
    ph_status st = PH_OK;
    ph_i_picture p = {0};
    int size[2];
    PH_CHECK(matrix >= 0 && matrix < m->nmaterials, PH_EINVAL, "matrix %d is no material",
             matrix);
    if (m->grid.kinematics == PH_SPACE) {
        PH_TRY(picture_3d(&p, m, matrix, err));
    } else {
        panel_size(&m->grid, 0, 1, 900, size);
        PH_TRY(
            ph_i_picture_new(size[0] + 2 * MARGIN, size[1] + 2 * MARGIN + HEAD, &p, err));
        draw_slice(&p, MARGIN, MARGIN + HEAD, m, matrix, 2, size[0], size[1]);
    }
    if (title) ph_i_text(&p, MARGIN, MARGIN / 2, 2, title, (ph_i_colour){34, 34, 34});
    PH_TRY(ph_i_picture_write(&p, path, err));
out:
    ph_i_picture_free(&p);
    return st;
}
