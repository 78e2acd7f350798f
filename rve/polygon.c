/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "polygon.h"

#include <math.h>
#include <stdbool.h>

ph_polygon ph_i_rectangle(double x0, double x1, double y0, double y1)
{
    return (ph_polygon){4, {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}};
}

void ph_i_polygon_clip(ph_polygon *p, const double a[2], double b)
{
    ph_polygon q = {0};
    for (int i = 0; i < p->n && q.n + 2 <= PH_POLYGON_MAX; i++) {
        const double *s = p->x[i], *e = p->x[(i + 1) % p->n];
        double ds = a[0] * s[0] + a[1] * s[1] - b, de = a[0] * e[0] + a[1] * e[1] - b;
        if (ds <= 0) {
            q.x[q.n][0] = s[0];
            q.x[q.n++][1] = s[1];
        }
        if ((ds < 0 && de > 0) || (ds > 0 && de < 0)) {
            double t = ds / (ds - de);
            q.x[q.n][0] = s[0] + t * (e[0] - s[0]);
            q.x[q.n++][1] = s[1] + t * (e[1] - s[1]);
        }
    }
    *p = q;
}

static double cross(const double a[2], const double b[2])
{
    return a[0] * b[1] - a[1] * b[0];
}

double ph_i_polygon_area(const ph_polygon *p)
{
    /* about the first corner: no cancellation for small polygons far from the origin */
    double twice = 0;
    for (int i = 1; i + 1 < p->n; i++) {
        double a[2] = {p->x[i][0] - p->x[0][0], p->x[i][1] - p->x[0][1]};
        double b[2] = {p->x[i + 1][0] - p->x[0][0], p->x[i + 1][1] - p->x[0][1]};
        twice += cross(a, b);
    }
    return twice / 2;
}

/* Half the angle from a to b. Small angles, nearly all of them on a fine grid, by the series
 * of the arc tangent to 1e-17. */
static double sector(const double a[2], const double b[2])
{
    double y = cross(a, b), x = a[0] * b[0] + a[1] * b[1];
    if (fabs(y) > 0.03 * x) return atan2(y, x) / 2;
    double t = y / x, u = t * t;
    return t / 2 *
           (1 - u * (1.0 / 3 - u * (1.0 / 5 - u * (1.0 / 7 - u * (1.0 / 9 - u / 11)))));
}

/* Signed area of the triangle (0, a, b) within the unit disk. */
static double edge_in_disk(const double a[2], const double b[2])
{
    double d[2] = {b[0] - a[0], b[1] - a[1]};
    double A = d[0] * d[0] + d[1] * d[1], B = a[0] * d[0] + a[1] * d[1];
    double C = a[0] * a[0] + a[1] * a[1] - 1, disc = B * B - A * C;
    if (A == 0) return 0;
    if (disc <= 0) return sector(a, b);
    double s = sqrt(disc), t0 = (-B - s) / A, t1 = (-B + s) / A;
    if (t1 <= 0 || t0 >= 1) return sector(a, b);
    t0 = t0 > 0 ? t0 : 0;
    t1 = t1 < 1 ? t1 : 1;
    double p[2] = {a[0] + t0 * d[0], a[1] + t0 * d[1]};
    double q[2] = {a[0] + t1 * d[0], a[1] + t1 * d[1]};
    return (t0 > 0 ? sector(a, p) : 0) + cross(p, q) / 2 + (t1 < 1 ? sector(q, b) : 0);
}

double ph_i_polygon_area_in_disk(const ph_polygon *p)
{
    double sum = 0;
    for (int i = 0; i < p->n; i++)
        sum += edge_in_disk(p->x[i], p->x[(i + 1) % p->n]);
    return sum > 0 ? sum : 0;
}
