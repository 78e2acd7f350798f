/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How a grid lies in memory for the kernels: three loops whose last is the longest
 * contiguous one. Axes of a single cell are moved out of the way, memory stays as it is:
 * nx x ny x 1 is walked as nx x 1 x ny, 1 x 1 x N as 1 x 1 x N. */
#ifndef PH_SPACE_LAYOUT_H
#define PH_SPACE_LAYOUT_H

#include <perihom/microstructure.h>

typedef struct ph_layout {
    ptrdiff_t n[3]; /* loop lengths */
    int axis[3]; /* direction 0..2 that a loop walks along, -1 for a dummy of length 1 */
    double h[3]; /* spacing along it; 1 for a dummy */
    ptrdiff_t cells;
    int nd, ns; /* displacement and strain components */
} ph_layout;

static inline ph_layout ph_i_layout(const ph_grid *grid)
{
    ph_layout l = {{1, 1, 1}, {-1, -1, -1}, {1.0, 1.0, 1.0}, 1, 0, 0};
    int active[3], n = 0;
    for (int d = 0; d < 3; d++)
        if (grid->n[d] > 1) active[n++] = d;
    static const int place[4][3] = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 1, 2}};
    for (int a = 0; a < n; a++) {
        int to = place[n][a];
        l.n[to] = grid->n[active[a]];
        l.axis[to] = active[a];
        l.h[to] = grid->h[active[a]];
    }
    l.cells = l.n[0] * l.n[1] * l.n[2];
    l.nd = ph_displacements(grid->kinematics);
    l.ns = ph_strains(grid->kinematics);
    return l;
}

#endif
