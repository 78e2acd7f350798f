/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Voxels on another grid: cut cells where the phases of a coarser cell differ, and voxels by
 * twos. */
#include "companion.h"
#include "core/check.h"

#include <math.h>
#include <string.h>

/* A coarser cell is at most two voxels wide along an axis: it meets three of them. */
enum { BLOCK = 27 };

/* The phases in one coarser cell, their shares and first moments about its centre. */
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

/* Voxels first .. last - 1 along an axis that a cell meets, and of each the share of the cell
 * and its centre, the width of the cell being one. In whole numbers: n voxels, m cells, cell k
 * is from k n to (k + 1) n, voxel i from i m to (i + 1) m. */
typedef struct reach {
    ptrdiff_t first, last;
    double share[3], at[3];
} reach;

static reach reach_of(ptrdiff_t n, ptrdiff_t m, ptrdiff_t k)
{
    reach r = {.first = k * n / m, .last = ((k + 1) * n + m - 1) / m};
    for (ptrdiff_t i = r.first; i < r.last; i++) {
        ptrdiff_t from = i * m > k * n ? i * m : k * n,
                  to = (i + 1) * m < (k + 1) * n ? (i + 1) * m : (k + 1) * n;
        r.share[i - r.first] = (double)(to - from) / (double)n;
        r.at[i - r.first] = (double)(from + to - (2 * k + 1) * n) / (double)(2 * n);
    }
    return r;
}

static void look(const ph_microstructure *fine, const ptrdiff_t coarse[3],
                 const ptrdiff_t cell[3], block *b)
{
    const ptrdiff_t *n = fine->grid.n;
    reach r[3];
    for (int a = 0; a < 3; a++)
        r[a] = reach_of(n[a], coarse[a], cell[a]);
    b->n = 0;
    for (ptrdiff_t i = r[0].first; i < r[0].last; i++)
        for (ptrdiff_t j = r[1].first; j < r[1].last; j++)
            for (ptrdiff_t k = r[2].first; k < r[2].last; k++) {
                const ptrdiff_t d[3] = {i - r[0].first, j - r[1].first, k - r[2].first};
                const double at[3] = {r[0].at[d[0]], r[1].at[d[1]], r[2].at[d[2]]};
                add_voxel(b, fine->phase[(i * n[1] + j) * n[2] + k], at,
                          r[0].share[d[0]] * r[1].share[d[1]] * r[2].share[d[2]]);
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

/* At most two voxels a cell, and the cells no more than the voxels. */
static ph_status check_nodes(const ph_microstructure *fine, const ptrdiff_t nodes[3],
                             ph_error *err)
{
    ph_status st = PH_OK;
    for (int a = 0; a < 3; a++) {
        ptrdiff_t n = fine->grid.n[a];
        PH_CHECK(nodes[a] <= n && 2 * nodes[a] >= n, PH_EINVAL,
                 "%td voxels along axis %d on %td cells: half of them to all", n, a + 1,
                 nodes[a]);
    }
out:
    return st;
}

/* Every cell once, in order: counted where there is no room for cuts, else put. */
static ptrdiff_t mix(const ph_microstructure *fine, const ptrdiff_t n[3],
                     ph_microstructure *m)
{
    ptrdiff_t c[3], cell = 0, cuts = 0;
    for (c[0] = 0; c[0] < n[0]; c[0]++)
        for (c[1] = 0; c[1] < n[1]; c[1]++)
            for (c[2] = 0; c[2] < n[2]; c[2]++, cell++) {
                block b = {0};
                look(fine, n, c, &b);
                m->phase[cell] = (uint16_t)b.phase[largest(&b)];
                if (m->cuts) put_cuts(&b, cell, m);
                cuts += b.n - 1;
            }
    return cuts;
}

ph_status ph_i_coarsen(const ph_microstructure *fine, const ptrdiff_t nodes[3],
                       ph_microstructure **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_microstructure *m = NULL;
    ph_grid grid;
    PH_TRY(check_nodes(fine, nodes, err));
    PH_TRY(ph_grid_init(&grid, fine->grid.kinematics, nodes, fine->grid.size, err));
    PH_TRY(ph_microstructure_new(&grid, fine->nmaterials, fine->materials, &m, err));
    ptrdiff_t cuts = mix(fine, nodes, m);
    if (cuts > 0) {
        PH_ALLOC(m->cuts, cuts, "the cut cells");
        mix(fine, nodes, m);
    }
    *out = m;
    m = NULL;
out:
    ph_microstructure_free(&m);
    return st;
}

ph_status ph_i_refine(const ph_microstructure *coarse, ph_microstructure **out,
                      ph_error *err)
{
    ph_status st = PH_OK;
    ph_microstructure *m = NULL;
    ph_grid grid;
    const ptrdiff_t *o = coarse->grid.n;
    ptrdiff_t n[3], c[3], cell = 0;
    for (int a = 0; a < 3; a++)
        n[a] = o[a] > 1 ? 2 * o[a] : 1;
    PH_TRY(ph_grid_init(&grid, coarse->grid.kinematics, n, coarse->grid.size, err));
    PH_TRY(ph_microstructure_new(&grid, coarse->nmaterials, coarse->materials, &m, err));
    if (coarse->owner) PH_ALLOC(m->owner, ph_grid_cells(&grid), "the owners");
    for (c[0] = 0; c[0] < n[0]; c[0]++)
        for (c[1] = 0; c[1] < n[1]; c[1]++)
            for (c[2] = 0; c[2] < n[2]; c[2]++, cell++) {
                ptrdiff_t from = 0;
                for (int a = 0; a < 3; a++)
                    from = from * o[a] + c[a] / (n[a] / o[a]);
                m->phase[cell] = coarse->phase[from];
                if (m->owner) m->owner[cell] = coarse->owner[from];
            }
    *out = m;
    m = NULL;
out:
    ph_microstructure_free(&m);
    return st;
}
