/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/sites.h"

#include <string.h>

/* Points of the list in cell `cell`, which stand together: first and one past the last. */
static ptrdiff_t points_of(const ph_bondlist *l, ptrdiff_t cell, ptrdiff_t from,
                           ptrdiff_t *first)
{
    while (from < l->points && l->point[from].cell < cell)
        from++;
    *first = from;
    while (from < l->points && l->point[from].cell == cell)
        from++;
    return from;
}

static ph_status init_bonds(ph_sites *s, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_bondlist *l = s->op->bonds;
    ptrdiff_t next = 0;
    PH_ALLOC(s->point, s->count, "points of cut cells");
    for (ptrdiff_t i = 0; i < s->count; i++) {
        next = points_of(l, s->cell[i], next, &s->point[i]);
        int n = (int)(next - s->point[i]);
        if (n > s->records) s->records = n;
        if (n == 0) s->point[i] = -1;
    }
    PH_ALLOC(s->weight, s->records * s->count, "weights of cut cells");
    for (ptrdiff_t i = 0; i < s->count; i++)
        for (ptrdiff_t p = s->point[i], k = 0;
             p >= 0 && p < l->points && l->point[p].cell == s->cell[i]; p++, k++)
            s->weight[k * s->count + i] = l->point[p].share;
out:
    return st;
}

ph_status ph_i_sites_init(ph_sites *s, ph_operator *op, ptrdiff_t count,
                          const ptrdiff_t *cell, ph_error *err)
{
    ph_status st = PH_OK;
    double weight[9];
    *s = (ph_sites){.op = op, .count = count, .cell = cell};
    if (count == 0 || op->springs) return PH_OK;
    if (op->bonds) return init_bonds(s, err);
    if (op->has_cells) {
        s->records = ph_i_cells_records(&op->cells, weight);
    } else {
        weight[s->records++] = op->share;
        for (int i = 0; i < op->nsub; i++)
            weight[s->records++] = (1.0 - op->share) / op->nsub;
        PH_DOUBLES(s->field, op->meter, (size_t)(op->layout.ns * op->layout.cells),
                   "the strain field");
    }
    PH_ALLOC(s->weight, s->records * count, "weights of cut cells");
    for (int r = 0; r < s->records; r++)
        for (ptrdiff_t i = 0; i < count; i++)
            s->weight[r * count + i] = weight[r];
out:
    return st;
}

void ph_i_sites_clear(ph_sites *s)
{
    free(s->weight);
    free(s->point);
    if (s->field)
        ph_i_doubles_free(s->op->meter, &s->field,
                          (size_t)(s->op->layout.ns * s->op->layout.cells));
    *s = (ph_sites){0};
}

static void pick(const ph_sites *s, int record, double *strain)
{
    int ns = s->op->layout.ns;
    for (ptrdiff_t i = 0; i < s->count; i++)
        for (int a = 0; a < ns; a++)
            strain[(record * s->count + i) * ns + a] =
                s->field[a * s->op->layout.cells + s->cell[i]];
}

static void strain_of_lists(const ph_sites *s, const double *u, const double *macro,
                            double *strain)
{
    const ph_bondlist *l = s->op->bonds;
    for (ptrdiff_t i = 0; i < s->count; i++)
        for (int k = 0; k < s->records; k++)
            if (s->weight[k * s->count + i] > 0.0)
                ph_i_bondlist_point_strain(l, s->point[i] + k, u, macro,
                                           strain + (k * s->count + i) * l->ns);
}

/* No displacement: the macro strain wherever a record feels it. */
static void uniform(const ph_sites *s, const double *macro, double *strain)
{
    int ns = s->op->layout.ns, feel = s->op->has_cells ? 1 : s->records;
    for (ptrdiff_t i = 0; macro && i < feel * s->count; i++)
        memcpy(strain + i * ns, macro, sizeof *macro * (size_t)ns);
}

void ph_i_sites_strain(ph_sites *s, const double *u, const double *macro, double *strain)
{
    ph_operator *op = s->op;
    memset(strain, 0,
           sizeof *strain * (size_t)(s->records * op->layout.ns) * (size_t)s->count);
    if (s->count == 0) return;
    if (!u) {
        uniform(s, macro, strain);
    } else if (op->bonds) {
        strain_of_lists(s, u, macro, strain);
    } else if (op->has_cells) {
        ph_i_cells_records_strain(&op->cells, u, macro, s->count, s->cell, strain);
    } else {
        ph_i_operator_strain(op, u, macro, s->field);
        pick(s, 0, strain);
        for (int i = 0; i < op->nsub; i++) {
            ph_i_stencil_strain(op->sub[i], u, macro, op->pad, s->field);
            pick(s, 1 + i, strain);
        }
    }
}
