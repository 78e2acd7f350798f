/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/microstructure.h>

#include "core/check.h"

#include <math.h>

ph_status ph_grid_init(ph_grid *grid, ph_kinematics kin, const ptrdiff_t *n,
                       const double *size, ph_error *err)
{
    PH_GIVEN(grid && n && size);
    ph_status st = PH_OK;
    int dim = kin == PH_SPACE ? 3 : 2;
    ph_grid g = {.kinematics = kin, .n = {1, 1, 1}, .size = {1, 1, 1}, .h = {1, 1, 1}};
    ptrdiff_t cells = 1;
    for (int a = 0; a < dim; a++) {
        PH_CHECK(n[a] >= 1, PH_EINVAL, "nodes along axis %d must be at least 1, got %td",
                 a + 1, n[a]);
        PH_CHECK(isfinite(size[a]) && size[a] > 0, PH_EINVAL,
                 "size along axis %d must be positive, got %g", a + 1, size[a]);
        PH_CHECK(n[a] <= PTRDIFF_MAX / 64 / cells, PH_EINVAL,
                 "nodes along axis %d: %td are too many", a + 1, n[a]);
        cells *= n[a];
        g.n[a] = n[a];
        g.size[a] = size[a];
        g.h[a] = size[a] / (double)n[a];
        PH_CHECK(g.h[a] > 0, PH_EINVAL, "size along axis %d is too small: %g", a + 1,
                 size[a]);
    }
    *grid = g;
out:
    return st;
}

ptrdiff_t ph_grid_cells(const ph_grid *grid)
{
    if (!grid) return 0;
    return grid->n[0] * grid->n[1] * grid->n[2];
}

ph_status ph_microstructure_new(const ph_grid *grid, int nmaterials,
                                const ph_material *materials, ph_microstructure **out,
                                ph_error *err)
{
    PH_GIVEN(grid && out && (materials || nmaterials <= 0));
    ph_status st = PH_OK;
    ph_microstructure *m = NULL;
    *out = NULL;
    PH_CHECK(nmaterials >= 1 && nmaterials <= UINT16_MAX, PH_EINVAL,
             "number of materials must be 1 to %d, got %d", UINT16_MAX, nmaterials);
    PH_ALLOC(m, 1, "the microstructure");
    m->grid = *grid;
    PH_ALLOC(m->materials, nmaterials, "materials");
    for (; m->nmaterials < nmaterials; m->nmaterials++)
        PH_TRY(ph_material_copy(&materials[m->nmaterials], &m->materials[m->nmaterials],
                                err));
    PH_ALLOC(m->phase, ph_grid_cells(grid), "the phases of the cells");
    *out = m;
    m = NULL;
out:
    ph_microstructure_free(&m);
    return st;
}

void ph_microstructure_free(ph_microstructure **micro)
{
    if (!micro || !*micro) return;
    ph_microstructure *m = *micro;
    for (int i = 0; i < m->nmaterials; i++)
        ph_material_clear(&m->materials[i]);
    free(m->materials);
    free(m->phase);
    free(m->cuts);
    free(m->owner);
    free(m);
    *micro = NULL;
}

/* Takes cell `cuts[first]` out of the whole cells and adds its shares to `mixed`: seen from
 * the last cut back, each takes its fraction of what the later ones leave.
 * Returns the index of the next cell's first cut. */
static ptrdiff_t add_cut_cell(const ph_microstructure *m, ptrdiff_t first,
                              ptrdiff_t *whole, double *mixed)
{
    const ph_cut *cuts = m->cuts;
    ptrdiff_t end = first + 1;
    while (end < m->ncuts && cuts[end].cell == cuts[first].cell)
        end++;
    double left = 1;
    for (ptrdiff_t k = end - 1; k >= first; k--) {
        mixed[cuts[k].material] += left * cuts[k].fraction;
        left *= 1 - cuts[k].fraction;
    }
    mixed[cuts[first].base] += left;
    whole[m->phase[cuts[first].cell]]--;
    return end;
}

void ph_microstructure_fractions(const ph_microstructure *m, double *fraction)
{
    if (!m || !fraction) return;
    enum { SMALL = 64 };
    ptrdiff_t small[SMALL] = {0};
    ptrdiff_t *whole = small, *big = NULL;
    if (m->nmaterials > SMALL) {
        big = calloc((size_t)m->nmaterials, sizeof *big);
        whole = big;
    }
    for (int i = 0; i < m->nmaterials; i++)
        fraction[i] = whole ? 0 : NAN;
    if (!whole) return; /* out of memory: NaN, the only way to say so */
    ptrdiff_t cells = ph_grid_cells(&m->grid);
    for (ptrdiff_t c = 0; c < cells; c++)
        whole[m->phase[c]]++;
    for (ptrdiff_t k = 0; k < m->ncuts;)
        k = add_cut_cell(m, k, whole, fraction);
    for (int i = 0; i < m->nmaterials; i++)
        fraction[i] = (fraction[i] + (double)whole[i]) / (double)cells;
    free(big);
}

static ph_status check_cut(const ph_microstructure *m, ptrdiff_t k, ptrdiff_t cells,
                           ph_error *err)
{
    ph_status st = PH_OK;
    const ph_cut *c = &m->cuts[k];
    bool first = k == 0 || m->cuts[k - 1].cell != c->cell;
    PH_CHECK(c->cell >= 0 && c->cell < cells, PH_EINVAL,
             "cut %td: cell %td is outside 0..%td", k, c->cell, cells - 1);
    PH_CHECK(k == 0 || m->cuts[k - 1].cell <= c->cell, PH_EINVAL,
             "cut %td: cuts are not sorted by cell", k);
    PH_CHECK(first ? c->base >= 0 && c->base < m->nmaterials : c->base == -1, PH_EINVAL,
             "cut %td: base material %d is not admissible", k, c->base);
    PH_CHECK(c->material >= 0 && c->material < m->nmaterials, PH_EINVAL,
             "cut %td: material %d is outside 0..%d", k, c->material, m->nmaterials - 1);
    PH_CHECK(c->fraction > 0 && c->fraction < 1, PH_EINVAL,
             "cut %td: fraction must be in (0, 1), got %g", k, c->fraction);
    const double *n = c->normal;
    PH_CHECK(fabs(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-9, PH_EINVAL,
             "cut %td: the normal is not a unit vector", k);
    PH_CHECK(m->grid.kinematics == PH_SPACE || n[2] == 0, PH_EINVAL,
             "cut %td: the normal leaves the plane", k);
out:
    return st;
}

ph_status ph_microstructure_check(const ph_microstructure *m, ph_error *err)
{
    PH_GIVEN(m);
    ph_status st = PH_OK;
    ptrdiff_t cells = ph_grid_cells(&m->grid);
    for (ptrdiff_t c = 0; c < cells; c++)
        PH_CHECK(m->phase[c] < m->nmaterials, PH_EINVAL,
                 "cell %td: material %d is outside 0..%d", c, m->phase[c],
                 m->nmaterials - 1);
    for (ptrdiff_t k = 0; k < m->ncuts; k++)
        PH_TRY(check_cut(m, k, cells, err));
out:
    return st;
}
