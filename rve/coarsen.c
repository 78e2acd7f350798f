/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Voxels by twos: cut cells where the phases of a block differ. */
#include "companion.h"
#include "core/check.h"

#include <math.h>
#include <string.h>

enum { BLOCK = 8 };

/* A block of up to eight voxels: its phases in order of size, their shares and centroids. */
typedef struct block {
    int n, phase[BLOCK];
    double share[BLOCK], centre[BLOCK][3];
} block;

static void add_voxel(block *b, int phase, const double at[3], double share)
{
    int k = 0;
    while (k < b->n && b->phase[k] != phase)
        k++;
    if (k == b->n) {
        b->phase[b->n++] = phase;
        b->share[k] = 0.0;
        memset(b->centre[k], 0, sizeof b->centre[k]);
    }
    b->share[k] += share;
    for (int a = 0; a < 3; a++)
        b->centre[k][a] += share * at[a];
}

static void look(const ph_microstructure *fine, const ptrdiff_t step[3],
                 const ptrdiff_t cell[3], block *b)
{
    const ptrdiff_t *n = fine->grid.n;
    double share = 1.0 / (double)(step[0] * step[1] * step[2]);
    ptrdiff_t d[3];
    b->n = 0;
    for (d[0] = 0; d[0] < step[0]; d[0]++)
        for (d[1] = 0; d[1] < step[1]; d[1]++)
            for (d[2] = 0; d[2] < step[2]; d[2]++) {
                ptrdiff_t x = 0;
                double at[3];
                for (int a = 0; a < 3; a++) {
                    x = x * n[a] + cell[a] * step[a] + d[a];
                    at[a] = step[a] > 1 ? (double)d[a] - 0.5 : 0.0;
                }
                add_voxel(b, fine->phase[x], at, share);
            }
}

static int largest(const block *b)
{
    int best = 0;
    for (int k = 1; k < b->n; k++)
        if (b->share[k] > b->share[best]) best = k;
    return best;
}

/* From the centroid of a phase to that of the rest, whose first moments cancel. */
static void normal_of(const block *b, int k, double normal[3])
{
    double size = 0.0;
    for (int a = 0; a < 3; a++)
        size += b->centre[k][a] * b->centre[k][a];
    size = sqrt(size);
    for (int a = 0; a < 3; a++)
        normal[a] = size > 1e-9 ? -b->centre[k][a] / size : (double)(a == 0);
}

/* Cuts in painting order: the last one keeps its share, those before are scaled by it. */
static void put_cuts(const block *b, ptrdiff_t cell, ph_microstructure *m)
{
    int base = largest(b);
    double left = 1.0;
    ptrdiff_t first = m->ncuts;
    for (int k = b->n - 1, put = b->n - 1; k >= 0; k--) {
        if (k == base) continue;
        ph_cut *cut = &m->cuts[first + --put];
        *cut = (ph_cut){
            cell, put == 0 ? b->phase[base] : -1, b->phase[k], b->share[k] / left, {0}};
        normal_of(b, k, cut->normal);
        left -= b->share[k];
    }
    m->ncuts += b->n - 1;
}

ph_status ph_i_coarsen(const ph_microstructure *fine, ph_microstructure **out,
                       ph_error *err)
{
    ph_status st = PH_OK;
    ph_microstructure *m = NULL;
    ph_grid grid;
    ptrdiff_t step[3], n[3], c[3], voxels = ph_grid_cells(&fine->grid);
    for (int a = 0; a < 3; a++) {
        step[a] = fine->grid.n[a] > 1 ? 2 : 1;
        PH_CHECK(fine->grid.n[a] % step[a] == 0, PH_EINVAL,
                 "%td voxels along axis %d are no even number", fine->grid.n[a], a + 1);
        n[a] = fine->grid.n[a] / step[a];
    }
    PH_TRY(ph_grid_init(&grid, fine->grid.kinematics, n, fine->grid.size, err));
    PH_TRY(ph_microstructure_new(&grid, fine->nmaterials, fine->materials, &m, err));
    PH_ALLOC(m->cuts, voxels, "the cut cells"); /* less than one a voxel */
    ptrdiff_t cell = 0;
    for (c[0] = 0; c[0] < n[0]; c[0]++)
        for (c[1] = 0; c[1] < n[1]; c[1]++)
            for (c[2] = 0; c[2] < n[2]; c[2]++, cell++) {
                block b = {0};
                look(fine, step, c, &b);
                m->phase[cell] = (uint16_t)b.phase[largest(&b)];
                put_cuts(&b, cell, m);
            }
    *out = m;
    m = NULL;
out:
    ph_microstructure_free(&m);
    return st;
}
