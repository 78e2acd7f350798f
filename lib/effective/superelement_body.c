/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effective/superelement.h"

#include <math.h>
#include <string.h>

/* ---- the box ----------------------------------------------------------------------------- */

/* A point of the RVE sees `reach` nodes on each side (nodes), or reach - 1 below and reach
 * above its lower corner (stress points, finite elements). */
static ph_status lay_out(ph_body *b, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_run *r = b->run;
    const ph_grid *rve = &r->problem->micro->grid;
    const ph_family *f = r->family;
    const bool nodes = f && f->points == PH_POINTS_NODES;
    const int axes = rve->kinematics == PH_SPACE ? 3 : 2;
    b->box = *rve;
    for (int d = 0; d < axes; d++) {
        const ptrdiff_t n = rve->n[d], reach = f ? f->reach[d] : 1;
        PH_CHECK(n > 1, PH_EINVAL,
                 "a superelement needs two cells along axis %d, has %td", d + 1, n);
        b->low[d] = nodes ? -reach : 1 - reach;
        b->inner[d][0] = reach;
        b->inner[d][1] = nodes ? n - 1 - reach : n - reach;
        b->box.n[d] = n - 1 + reach - b->low[d] + 1;
        b->box.size[d] = rve->h[d] * (double)b->box.n[d];
    }
out:
    return st;
}

void ph_i_body_at(const ph_body *b, ptrdiff_t x, ptrdiff_t at[3])
{
    const ptrdiff_t *n = b->box.n;
    at[0] = x / n[2] / n[1] + b->low[0];
    at[1] = x / n[2] % n[1] + b->low[1];
    at[2] = x % n[2] + b->low[2];
}

bool ph_i_body_is_kept(const ph_body *b, const ptrdiff_t at[3])
{
    bool kept = false;
    for (int d = 0; d < (b->box.kinematics == PH_SPACE ? 3 : 2); d++)
        kept = kept || at[d] < b->inner[d][0] || at[d] > b->inner[d][1];
    return kept;
}

static bool in_rve(const ph_body *b, const ptrdiff_t at[3])
{
    const ptrdiff_t *n = b->run->problem->micro->grid.n;
    for (int d = 0; d < 3; d++)
        if (at[d] < 0 || at[d] >= n[d]) return false;
    return true;
}

/* Around the RVE: for points nothing, their energy is the neighbour's; for bonds the material
 * that stands there, for the modulus of a bond depends on both its ends. */
static ph_status fill(ph_body *b, bool bonds, ph_error *err)
{
    ph_status st = PH_OK;
    const ptrdiff_t *n = b->run->problem->micro->grid.n;
    const ptrdiff_t cells = ph_grid_cells(&b->box);
    PH_ALLOC(b->source, cells, "the box around the RVE");
    for (ptrdiff_t x = 0; x < cells; x++) {
        ptrdiff_t at[3], from = 0;
        ph_i_body_at(b, x, at);
        for (int d = 0; d < 3; d++)
            from = from * n[d] + (at[d] % n[d] + n[d]) % n[d];
        b->source[x] = bonds || in_rve(b, at) ? from : PH_SOURCE_VOID;
    }
out:
    return st;
}

ph_status ph_i_body_new(ph_run *r, ph_body **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_body *b = NULL;
    const ph_problem *p = r->problem;
    PH_ALLOC(b, 1, "the body of a superelement");
    b->run = r;
    b->meter = &r->meter;
    PH_TRY(lay_out(b, err));
    const ptrdiff_t cells = ph_grid_cells(&b->box);
    PH_TRY(fill(b, r->classes != NULL, err));
    if (r->classes) {
        PH_TRY(ph_i_bond_classes_new(p->micro, p->model.kappa, b->source, cells,
                                     &b->classes, err));
    } else {
        b->params = r->params;
        b->params.one_sided = false;
        b->params.broken = NULL;
        PH_TRY(ph_i_stiffness_map_new(p->micro, p->interface, r->map->apparent, b->source,
                                      cells, b->meter, &b->map, err));
        PH_TRY(ph_i_bondlist_new(&b->box, b->map, &b->params, b->meter, &b->list, err));
    }
    *out = b;
    b = NULL;
out:
    ph_i_body_free(&b);
    return st;
}

void ph_i_body_free(ph_body **body)
{
    if (!body || !*body) return;
    ph_body *b = *body;
    ph_i_bondlist_free(&b->list);
    ph_i_bond_classes_free(&b->classes);
    ph_i_stiffness_map_free(b->meter, &b->map);
    free(b->source);
    free(b);
    *body = NULL;
}

/* ---- bonds: half of each belongs to either end ------------------------------------------- */

/* Node at the other end, or -1: it is not in the box, and no energy of the RVE. */
static ptrdiff_t end_of(const ph_body *b, ptrdiff_t x, ptrdiff_t bond)
{
    ptrdiff_t at[3], y = 0;
    ph_i_body_at(b, x, at);
    for (int d = 0; d < 3; d++) {
        const ptrdiff_t i = at[d] - b->low[d] + b->run->family->offset[bond][d];
        if (i < 0 || i >= b->box.n[d]) return -1;
        y = y * b->box.n[d] + i;
    }
    return y;
}

static double half_at(const ph_body *b, ptrdiff_t x)
{
    ptrdiff_t at[3];
    ph_i_body_at(b, x, at);
    return in_rve(b, at) ? 0.5 : 0.0;
}

static double spring(const ph_body *b, ptrdiff_t x, ptrdiff_t y, ptrdiff_t bond)
{
    const double share = half_at(b, x) + half_at(b, y);
    if (share == 0.0) return 0.0;
    return share * b->run->family->w[bond] * ph_i_bond_modulus(b->classes, x, y);
}

/* Column x, axis a, from its diagonal block down. */
static int bond_column(const ph_body *b, ptrdiff_t x, int a, const int *unknown,
                       ph_csc *out, int used)
{
    const ph_family *f = b->run->family;
    const ptrdiff_t cells = ph_grid_cells(&b->box);
    const int nd = ph_displacements(b->box.kinematics), column = unknown[a * cells + x];
    double own[3] = {0};
    for (ptrdiff_t k = 0; k < f->count; k++) {
        const ptrdiff_t y = end_of(b, x, k);
        const double stiff = y < 0 ? 0.0 : spring(b, x, y, k);
        for (int c = 0; stiff != 0.0 && c < nd; c++) {
            const double v = stiff * f->xi[k][a] * f->xi[k][c];
            const int row = unknown[c * cells + y];
            own[c] += v;
            if (row <= column) continue;
            out->row[used] = row;
            out->value[used++] = -v;
        }
    }
    for (int c = 0; c < nd; c++) {
        if (unknown[c * cells + x] < column) continue;
        out->row[used] = unknown[c * cells + x];
        out->value[used++] = own[c];
    }
    return used;
}

static ph_status bond_matrix(const ph_body *b, const int *unknown, int n, ph_csc *out,
                             ph_error *err)
{
    ph_status st = PH_OK;
    const ptrdiff_t cells = ph_grid_cells(&b->box);
    const int nd = ph_displacements(b->box.kinematics);
    const double room = (double)n * nd * (double)(b->run->family->count + 1);
    int used = 0, next = 0;
    PH_CHECK(room <= PH_MATRIX_MOST, PH_EINVAL,
             "the matrix of the RVE has more than %d entries", PH_MATRIX_MOST);
    PH_ALLOC(out->start, n + 1, "the matrix of the RVE");
    PH_ALLOC(out->row, room, "the matrix of the RVE");
    PH_ALLOC(out->value, room, "the matrix of the RVE");
    out->n = n;
    for (ptrdiff_t x = 0; x < cells; x++)
        for (int a = 0; a < nd; a++) {
            if (unknown[a * cells + x] < 0) continue;
            used = bond_column(b, x, a, unknown, out, used);
            out->start[++next] = used;
        }
out:
    return st;
}

static void bond_sums(const ph_body *b, double *sum)
{
    const ph_family *f = b->run->family;
    const ptrdiff_t cells = ph_grid_cells(&b->box);
    for (ptrdiff_t x = 0; x < cells; x++)
        for (ptrdiff_t k = 0; k < f->count; k++) {
            const ptrdiff_t y = end_of(b, x, k);
            for (int a = 0; y >= 0 && a < ph_displacements(b->box.kinematics); a++)
                sum[a * cells + x] += spring(b, x, y, k) * f->xi[k][a] * f->xi[k][a];
        }
}

/* ---- either ------------------------------------------------------------------------------ */

ph_status ph_i_body_matrix(const ph_body *b, const int *unknown, int n, ph_csc *out,
                           ph_error *err)
{
    return b->list ? ph_i_bondlist_matrix(b->list, unknown, n, out, err)
                   : bond_matrix(b, unknown, n, out, err);
}

ph_status ph_i_body_row_sums(const ph_body *b, double *sum, ph_error *err)
{
    if (b->list) return ph_i_bondlist_row_sums(b->list, sum, err);
    bond_sums(b, sum);
    return PH_OK;
}

ph_status ph_i_body_stretch(const ph_body *b, double *force, double *stiffness,
                            ph_error *err)
{
    ph_status st = PH_OK;
    const double e33[6] = {0, 0, 1, 0, 0, 0};
    const ph_stiffness_map *map = b->map;
    PH_CHECK(b->list, PH_EINVAL, "bonds of a plane have no strain along 3");
    ph_i_bondlist_load(b->list, e33, force);
    for (ptrdiff_t i = 0; i < ph_displacements(b->box.kinematics) * map->cells; i++)
        force[i] = -force[i]; /* the load balances them */
    *stiffness = 0.0;
    for (ptrdiff_t x = 0; x < map->cells; x++)
        if (b->source[x] != PH_SOURCE_VOID)
            *stiffness +=
                map->c[(ptrdiff_t)map->index[x] * map->ns * map->ns + 2 * map->ns + 2];
out:
    return st;
}
