/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A canvas that notes where something is drawn, to find a free corner for the legend. */
#include "io/plot_canvas.h"

#include <math.h>

static void take(ph_i_probe *p, double x, double y)
{
    double u = (x - p->box.x) / p->box.width, v = (y - p->box.y) / p->box.height;
    if (!(u >= 0 && u < 1 && v >= 0 && v < 1)) return;
    p->taken[(int)(v * PH_I_PROBE)][(int)(u * PH_I_PROBE)] = 1;
}

static void probe_segment(ph_i_probe *p, ph_i_point a, ph_i_point b)
{
    double step = 0.5 * fmin(p->box.width, p->box.height) / PH_I_PROBE;
    int n = 1 + (int)(hypot(b.x - a.x, b.y - a.y) / step);
    for (int k = 0; k <= n; k++)
        take(p, a.x + (b.x - a.x) * k / n, a.y + (b.y - a.y) * k / n);
}

static void probe_line(ph_i_canvas *c, ptrdiff_t n, const ph_i_point *p, ph_i_pen pen)
{
    (void)pen;
    for (ptrdiff_t i = 0; i + 1 < n; i++)
        probe_segment((ph_i_probe *)c, p[i], p[i + 1]);
}

/* Areas go along a curve and back: what faces each other is joined. */
static void probe_fill(ph_i_canvas *c, ptrdiff_t n, const ph_i_point *p, ph_i_pen pen)
{
    (void)pen;
    for (ptrdiff_t i = 0; i < n / 2; i++)
        probe_segment((ph_i_probe *)c, p[i], p[n - 1 - i]);
}

static void probe_rectangle(ph_i_canvas *c, ph_i_box box, ph_i_pen pen)
{
    (void)pen;
    for (int k = 0; k <= PH_I_PROBE; k++) {
        double x = box.x + box.width * k / PH_I_PROBE;
        probe_segment((ph_i_probe *)c, (ph_i_point){x, box.y},
                      (ph_i_point){x, box.y + box.height});
    }
}

static void probe_marks(ph_i_canvas *c, ptrdiff_t n, const ph_i_point *p, int shape,
                        ph_i_pen pen)
{
    (void)shape;
    (void)pen;
    for (ptrdiff_t i = 0; i < n; i++)
        take((ph_i_probe *)c, p[i].x, p[i].y);
}

static void probe_text(ph_i_canvas *c, const char *text, ph_i_label how)
{
    (void)c;
    (void)text;
    (void)how;
}

static void probe_begin(ph_i_canvas *c, const char *role, const char *name,
                        const ph_i_box *clip)
{
    (void)c;
    (void)role;
    (void)name;
    (void)clip;
}

static void probe_end(ph_i_canvas *c)
{
    (void)c;
}

void ph_i_probe_open(ph_i_probe *probe, ph_i_box box)
{
    *probe = (ph_i_probe){.canvas = {probe_line, probe_fill, probe_rectangle, probe_marks,
                                     probe_text, probe_begin, probe_end},
                          .box = box};
}

int ph_i_probe_count(const ph_i_probe *probe, ph_i_box box)
{
    const ph_i_box *all = &probe->box;
    int count = 0;
    for (int row = 0; row < PH_I_PROBE; row++)
        for (int column = 0; column < PH_I_PROBE; column++) {
            double x = all->x + (column + 0.5) * all->width / PH_I_PROBE;
            double y = all->y + (row + 0.5) * all->height / PH_I_PROBE;
            count += probe->taken[row][column] && x >= box.x && x <= box.x + box.width &&
                     y >= box.y && y <= box.y + box.height;
        }
    return count;
}
