/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Smooth shapes: the share of each pixel that they cover. */
#include "io/picture.h"

#include <math.h>
#include <string.h>

ph_status ph_i_mask_new(int width, int height, ph_i_mask *out, ph_error *err)
{
    ph_status st = PH_OK;
    PH_ALLOC(out->cover, (size_t)width * (size_t)height, "the mask of a picture");
    out->width = out->x1 = width;
    out->height = out->y1 = height;
    out->x0 = out->y0 = 0;
    out->left = width;
    out->top = height;
    out->right = out->bottom = 0;
out:
    return st;
}

void ph_i_mask_free(ph_i_mask *mask)
{
    free(mask->cover);
    mask->cover = NULL;
}

/* The pixel is covered by at least this much. */
static void cover(ph_i_mask *m, int x, int y, double share)
{
    if (share <= 0 || x < m->x0 || x >= m->x1 || y < m->y0 || y >= m->y1) return;
    uint8_t *to = &m->cover[(size_t)y * (size_t)m->width + (size_t)x];
    uint8_t much = (uint8_t)(share >= 1 ? 255 : 255 * share + 0.5);
    if (much > *to) *to = much;
    if (x < m->left) m->left = x;
    if (x >= m->right) m->right = x + 1;
    if (y < m->top) m->top = y;
    if (y >= m->bottom) m->bottom = y + 1;
}

static int clamped(double x, int lo, int hi)
{
    return x <= lo ? lo : x >= hi ? hi : (int)x;
}

/* Distance of (x, y) from the segment. */
static double distance(double x, double y, const double from[2], const double d[2],
                       double square)
{
    double t = square > 0 ? ((x - from[0]) * d[0] + (y - from[1]) * d[1]) / square : 0;
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    return hypot(x - from[0] - t * d[0], y - from[1] - t * d[1]);
}

void ph_i_mask_segment(ph_i_mask *m, const double from[2], const double to[2],
                       double width)
{
    /* go along the longer side, across it look only at what the line can touch */
    const double d[2] = {to[0] - from[0], to[1] - from[1]};
    const double square = d[0] * d[0] + d[1] * d[1], half = 0.5 * width;
    const int along = fabs(d[0]) >= fabs(d[1]) ? 0 : 1, across = 1 - along;
    const double slope = d[along] != 0 ? d[across] / d[along] : 0;
    const double reach = half + 1, thick = reach * sqrt(1 + slope * slope) + 1;
    const double least = fmin(from[along], to[along]) - reach;
    const double most = fmax(from[along], to[along]) + reach;
    const int limit[2][2] = {{m->x0, m->x1}, {m->y0, m->y1}};
    const int *la = limit[along], *lc = limit[across];
    for (int a = clamped(floor(least), la[0], la[1]);
         a < clamped(ceil(most) + 1, la[0], la[1]); a++) {
        double s = a + 0.5 - from[along], far = d[along];
        s = far >= 0 ? fmin(fmax(s, 0), far) : fmax(fmin(s, 0), far);
        double centre = from[across] + slope * s;
        for (int c = clamped(floor(centre - thick), lc[0], lc[1]);
             c < clamped(ceil(centre + thick) + 1, lc[0], lc[1]); c++) {
            int x = along == 0 ? a : c, y = along == 0 ? c : a;
            cover(m, x, y, half + 0.5 - distance(x + 0.5, y + 0.5, from, d, square));
        }
    }
}

/* Where the polygon crosses the height y, in order; at most `room` places. */
static int crossings(ptrdiff_t n, const ph_i_point *p, double scale, double y, double *x,
                     int room)
{
    int count = 0;
    for (ptrdiff_t i = 0; i < n; i++) {
        const ph_i_point a = p[i], b = p[i + 1 < n ? i + 1 : 0];
        if ((scale * a.y <= y) == (scale * b.y <= y) || count == room) continue;
        double at = scale * (a.x + (y / scale - a.y) / (b.y - a.y) * (b.x - a.x));
        int k = count++;
        for (; k > 0 && x[k - 1] > at; k--)
            x[k] = x[k - 1];
        x[k] = at;
    }
    return count;
}

/* Share of the pixel x between two places. */
static double overlap(int x, double from, double to)
{
    double share = fmin(to, x + 1) - fmax(from, x);
    return share > 0 ? share : 0;
}

void ph_i_mask_polygon(ph_i_mask *m, ptrdiff_t n, const ph_i_point *p, double scale)
{
    enum { LINES = 4, ROOM = 64 };
    double top = INFINITY, bottom = -INFINITY, x[LINES][ROOM];
    for (ptrdiff_t i = 0; i < n; i++) {
        top = fmin(top, scale * p[i].y);
        bottom = fmax(bottom, scale * p[i].y);
    }
    for (int row = clamped(floor(top), m->y0, m->y1);
         row < clamped(ceil(bottom), m->y0, m->y1); row++) {
        int count[LINES];
        double left = INFINITY, right = -INFINITY;
        for (int k = 0; k < LINES; k++) {
            count[k] = crossings(n, p, scale, row + (k + 0.5) / LINES, x[k], ROOM) & ~1;
            if (count[k] == 0) continue;
            left = fmin(left, x[k][0]);
            right = fmax(right, x[k][count[k] - 1]);
        }
        for (int column = clamped(floor(left), m->x0, m->x1);
             column < clamped(ceil(right), m->x0, m->x1); column++) {
            double share = 0;
            for (int k = 0; k < LINES; k++)
                for (int j = 0; j < count[k]; j += 2)
                    share += overlap(column, x[k][j], x[k][j + 1]) / LINES;
            cover(m, column, row, share);
        }
    }
}

/* (1 - f) a + f b of the codes, as SVG does with an opacity f. */
static ph_i_colour veiled(ph_i_colour a, ph_i_colour b, double f)
{
    return (ph_i_colour){(uint8_t)(a.r + f * (b.r - a.r) + 0.5),
                         (uint8_t)(a.g + f * (b.g - a.g) + 0.5),
                         (uint8_t)(a.b + f * (b.b - a.b) + 0.5)};
}

void ph_i_mask_paint(ph_i_mask *m, ph_i_picture *p, ph_i_colour colour, double opacity)
{
    for (int y = m->top; y < m->bottom; y++)
        for (int x = m->left; x < m->right; x++) {
            size_t at = (size_t)y * (size_t)m->width + (size_t)x;
            if (m->cover[at] == 0) continue;
            ph_i_colour to = veiled(p->pixel[at], colour, opacity);
            p->pixel[at] = m->cover[at] == 255
                               ? to
                               : ph_i_mix_colours(p->pixel[at], to, m->cover[at] / 255.0);
            m->cover[at] = 0;
        }
    m->left = m->width;
    m->top = m->height;
    m->right = m->bottom = 0;
}
