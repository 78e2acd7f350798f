/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cracks that are cut a little shorter than they are. */
#include "space/broken.h"

#include <math.h>
#include <string.h>

/* Towards the mean of its vertices, so that the radius of the disk of its area loses `by`. */
static ph_status add_polygon(ph_cracks *to, const ph_cracks *from, const ph_crack *k,
                             double by, ph_error *err)
{
    ph_status st = PH_OK;
    const double(*v)[3] = (const double(*)[3])(from->vertex + k->first);
    double(*w)[3] = NULL, middle[3] = {0}, radius = ph_i_polygon_radius(k->count, v);
    if (radius <= by) return PH_OK;
    PH_ALLOC(w, k->count, "a crack");
    for (ptrdiff_t i = 0; i < k->count; i++)
        for (int d = 0; d < 3; d++)
            middle[d] += v[i][d] / (double)k->count;
    for (ptrdiff_t i = 0; i < k->count; i++)
        for (int d = 0; d < 3; d++)
            w[i][d] = middle[d] + (1.0 - by / radius) * (v[i][d] - middle[d]);
    PH_TRY(ph_cracks_add_polygon(to, k->count, (const double(*)[3])w, err));
out:
    free(w);
    return st;
}

static ph_status add_ellipse(ph_cracks *to, const ph_crack *k, double by, ph_error *err)
{
    const double *a = k->axis[0], *b = k->axis[1];
    const double n[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                         a[0] * b[1] - a[1] * b[0]};
    const double semi[2] = {k->semi_axes[0] - by, k->semi_axes[1] - by};
    if (!(semi[0] > 0.0 && semi[1] > 0.0)) return PH_OK;
    return ph_cracks_add_ellipse(to, k->centre, n, a, semi, err);
}

ph_status ph_i_cracks_shorten(const ph_cracks *from, double by, ph_cracks *to,
                              ph_error *err)
{
    ph_status st = PH_OK;
    for (ptrdiff_t i = 0; i < from->count; i++) {
        const ph_crack *k = &from->crack[i];
        if (k->shape == PH_CRACK_POLYGON)
            PH_TRY(add_polygon(to, from, k, by, err));
        else if (k->shape == PH_CRACK_ELLIPSE)
            PH_TRY(add_ellipse(to, k, by, err));
        else
            PH_TRY(ph_cracks_add_grown(to, from, i, PH_TIP_BOTH,
                                       fmax(ph_crack_length(from, i) - 2.0 * by, 0.0),
                                       err));
    }
out:
    return st;
}
