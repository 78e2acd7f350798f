/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "slope.h"

#include <math.h>

/* Error of a grid over ln(Voigt / Reuss) boundary / n: docs/accuracy-costs.md. */
static const double slope_2d = 0.065, slope_3d = 0.13;
static const double node_centre = 2.4; /* error of node centres over that of cut cells */
static const double most_spread = 6.9; /* ln 1000: voids have no Reuss bound */

/* Cells with a neighbour of another phase, or cut: share of all, times n. */
static double boundary_of(const ph_microstructure *m)
{
    const ph_grid *g = &m->grid;
    double cells = (double)ph_grid_cells(g), n = 1.0;
    ptrdiff_t cut = 0, faces = 0, last = -1;
    for (int a = 0; a < 3; a++)
        n = fmax(n, (double)g->n[a]);
    for (ptrdiff_t k = 0; k < m->ncuts; k++) {
        cut += m->cuts[k].cell != last;
        last = m->cuts[k].cell;
    }
    for (ptrdiff_t i = 0; i < g->n[0]; i++)
        for (ptrdiff_t j = 0; j < g->n[1]; j++)
            for (ptrdiff_t k = 0; k < g->n[2]; k++) {
                const ptrdiff_t at[3] = {i, j, k};
                for (int a = 0; a < 3; a++) {
                    ptrdiff_t to[3] = {i, j, k};
                    to[a] = (at[a] + 1) % g->n[a];
                    faces += m->phase[(i * g->n[1] + j) * g->n[2] + k] !=
                             m->phase[(to[0] * g->n[1] + to[1]) * g->n[2] + to[2]];
                }
            }
    return (double)(cut > faces ? cut : faces) / cells * n;
}

static double log_ratio(double upper, double lower)
{
    return upper > 0 && lower > 0 ? fmin(log(upper / lower), most_spread) : most_spread;
}

ph_i_slope ph_i_slope_of(const ph_microstructure *m, ph_interface interface,
                         const ph_result *bounds)
{
    ph_i_slope s = {.boundary = boundary_of(m)};
    for (int i = 0; i < bounds->stiffness.n; i++) {
        double low = bounds->reuss_is_zero ? 0 : bounds->reuss.m[i][i];
        s.spread = fmax(s.spread, log_ratio(bounds->voigt.m[i][i], low));
    }
    double k = m->grid.kinematics == PH_SPACE ? slope_3d : slope_2d;
    if (interface == PH_INTERFACE_NODE_CENTRE) k *= node_centre;
    s.slope = k * s.spread * s.boundary;
    return s;
}
