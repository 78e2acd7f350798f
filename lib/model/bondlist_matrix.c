/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The matrix of a bond list, one column of nodes at a time: no sorting, no duplicates. */
#include "core/vec3.h"
#include "model/bondlist.h"

#include <math.h>
#include <string.h>

#define R2 0.70710678118654752440

/* What a column needs: the points that see a node, and the blocks of one column. */
typedef struct columns {
    const ph_bondlist *list;
    ptrdiff_t *first; /* [nodes + 1] */
    ptrdiff_t *seen;  /* [bonds] bond number, by node */
    int32_t *owner;   /* [bonds] point of a bond */
    int32_t *slot;    /* [nodes] place of a node in `touched`, or -1 */
    int32_t *touched; /* [nodes] */
    int32_t count;
    double *block; /* [count][nd * nd] */
    ptrdiff_t room;
} columns;

static void columns_clear(columns *c)
{
    free(c->first);
    free(c->seen);
    free(c->owner);
    free(c->slot);
    free(c->touched);
    free(c->block);
}

static ph_status columns_init(columns *c, const ph_bondlist *l, ph_error *err)
{
    ph_status st = PH_OK;
    memset(c, 0, sizeof *c);
    c->list = l;
    PH_ALLOC(c->first, l->nodes + 2, "the points of the nodes");
    PH_ALLOC(c->seen, l->bonds, "the points of the nodes");
    PH_ALLOC(c->owner, l->bonds, "the points of the bonds");
    PH_ALLOC(c->slot, l->nodes, "the rows of a column");
    PH_ALLOC(c->touched, l->nodes, "the rows of a column");
    for (ptrdiff_t x = 0; x < l->nodes; x++)
        c->slot[x] = -1;
    for (ptrdiff_t b = 0; b < l->bonds; b++)
        c->first[l->bond[b].node + 2]++;
    for (ptrdiff_t x = 0; x < l->nodes; x++)
        c->first[x + 2] += c->first[x + 1];
    for (ptrdiff_t p = 0; p < l->points; p++)
        for (ptrdiff_t b = l->point[p].first; b < l->point[p + 1].first; b++) {
            c->owner[b] = (int32_t)p;
            c->seen[c->first[l->bond[b].node + 1]++] = b;
        }
out:
    return st;
}

/* Strain of a unit displacement along axis a at a bond. */
static void unit_strain(const ph_bondlist *l, const ph_bond *b, int a, double *e)
{
    for (int i = 0; i < l->ns; i++)
        e[i] = 0.0;
    for (int d = 0; d < l->nd; d++)
        e[a == d ? a : l->nd == 3 ? 6 - a - d : 2] += b->g[d] * (a == d ? 1.0 : R2);
}

/* Sums over the bonds of a point that the deviations of one of its bonds, j, need. */
typedef struct moments {
    double W, m[3], Kg[3]; /* sum w, sum w xi, sum w xi (xi . g_j) */
} moments;

static moments moments_of(const ph_bondlist *l, const ph_bond_point *p, ptrdiff_t j)
{
    moments s = {0};
    for (ptrdiff_t b = p->first; b < p[1].first; b++) {
        const ph_deviation *v = &l->deviation[b];
        double along = ph_i_dot3(v->xi, l->bond[j].g);
        s.W += v->w;
        for (int d = 0; d < 3; d++) {
            s.m[d] += v->w * v->xi[d];
            s.Kg[d] += v->w * v->xi[d] * along;
        }
    }
    return s;
}

/* s sum_b w_b (dz_b/du_i) (dz_b/du_j), dz_b/du_i = [b = i] - origin_i - g_i . xi_b. */
static double deviation_entry(const ph_bondlist *l, const moments *s, ptrdiff_t i,
                              ptrdiff_t j)
{
    const ph_deviation *vi = &l->deviation[i], *vj = &l->deviation[j];
    const double *gi = l->bond[i].g, *gj = l->bond[j].g;
    double sum = i == j ? vi->w : 0.0;
    sum -= vi->w * (vj->origin + ph_i_dot3(gj, vi->xi)) +
           vj->w * (vi->origin + ph_i_dot3(gi, vj->xi));
    sum += s->W * vi->origin * vj->origin + vi->origin * ph_i_dot3(gj, s->m) +
           vj->origin * ph_i_dot3(gi, s->m) + ph_i_dot3(gi, s->Kg);
    return l->s * sum;
}

static ph_status block_of(columns *c, int32_t node, double **block, ph_error *err)
{
    ph_status st = PH_OK;
    int size = c->list->nd * c->list->nd;
    if (c->slot[node] < 0) {
        if (c->count >= c->room) {
            c->room = 2 * c->room + 64;
            double *more = realloc(c->block, (size_t)(c->room * size) * sizeof *more);
            PH_CHECK(more, PH_ENOMEM, "no memory for a column of the matrix");
            c->block = more;
        }
        memset(c->block + (ptrdiff_t)c->count * size, 0, sizeof(double) * (size_t)size);
        c->touched[c->count] = node;
        c->slot[node] = c->count++;
    }
    *block = c->block + (ptrdiff_t)c->slot[node] * size;
out:
    return st;
}

/* Blocks that one bond of one point adds to the column of its node. */
static ph_status add_point(columns *c, ptrdiff_t j, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_bondlist *l = c->list;
    const ph_bond_point *p = &l->point[c->owner[j]];
    double CB[3][6], e[6], *block = NULL;
    for (int a = 0; a < l->nd; a++) {
        unit_strain(l, &l->bond[j], a, e);
        ph_i_hooke(l->map, l->map->index[p->cell], e, CB[a]);
    }
    bool deviates = l->deviation && p->family;
    moments sums = {0};
    if (deviates) sums = moments_of(l, p, j);
    for (ptrdiff_t i = p->first; i < p[1].first; i++) {
        PH_TRY(block_of(c, l->bond[i].node, &block, err));
        for (int r = 0; r < l->nd; r++) {
            unit_strain(l, &l->bond[i], r, e);
            for (int a = 0; a < l->nd; a++) {
                double t = 0.0;
                for (int k = 0; k < l->ns; k++)
                    t += e[k] * CB[a][k];
                block[r * l->nd + a] += p->share * t;
            }
        }
        if (!deviates) continue;
        double t = deviation_entry(l, &sums, i, j);
        for (int r = 0; r < l->nd; r++)
            block[r * l->nd + r] += t;
    }
out:
    return st;
}

/* The column of a node: c->touched, c->block. */
static ph_status column(columns *c, ptrdiff_t node, ph_error *err)
{
    ph_status st = PH_OK;
    for (int32_t i = 0; i < c->count; i++)
        c->slot[c->touched[i]] = -1;
    c->count = 0;
    for (ptrdiff_t k = c->first[node]; k < c->first[node + 1]; k++)
        PH_TRY(add_point(c, c->seen[k], err));
out:
    return st;
}

static ph_status make_room(ph_csc *m, ptrdiff_t want, ptrdiff_t *room, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK_KEY(want <= PH_MATRIX_MOST, PH_EINVAL, "solver.kind",
                 "the matrix has more than %d entries: take solver fft_cg",
                 PH_MATRIX_MOST);
    if (want <= *room) return PH_OK;
    *room = 2 * want;
    int *row = realloc(m->row, (size_t)*room * sizeof *row);
    if (row) m->row = row;
    double *value = realloc(m->value, (size_t)*room * sizeof *value);
    if (value) m->value = value;
    PH_CHECK(row && value, PH_ENOMEM, "no memory for a matrix of %td entries", *room);
out:
    return st;
}

ph_status ph_i_bondlist_matrix(const ph_bondlist *l, const int *unknown, int n, ph_csc *m,
                               ph_error *err)
{
    ph_status st = PH_OK;
    columns c;
    ptrdiff_t room = 0, used = 0;
    int next = 0, nd = l->nd;
    memset(m, 0, sizeof *m);
    PH_TRY(columns_init(&c, l, err));
    PH_ALLOC(m->start, n + 1, "the columns of the matrix");
    m->n = n;
    for (ptrdiff_t x = 0; x < l->nodes; x++) {
        bool any = false;
        for (int a = 0; a < nd; a++)
            any = any || unknown[a * l->nodes + x] >= 0;
        if (!any) continue;
        PH_TRY(column(&c, x, err));
        PH_TRY(make_room(m, used + (ptrdiff_t)nd * nd * c.count, &room, err));
        for (int a = 0; a < nd; a++) {
            int col = unknown[a * l->nodes + x];
            if (col < 0) continue;
            PH_ASSERT(col == next); /* columns come in the order of the unknowns */
            m->start[next++] = (int)used;
            for (int32_t i = 0; i < c.count; i++)
                for (int r = 0; r < nd; r++) {
                    int row = unknown[r * l->nodes + c.touched[i]];
                    if (row < col) continue; /* held, or in the upper triangle */
                    m->row[used] = row;
                    m->value[used++] = c.block[(ptrdiff_t)i * nd * nd + r * nd + a];
                }
        }
    }
    PH_ASSERT(next == n);
    m->start[n] = (int)used;
out:
    columns_clear(&c);
    if (st != PH_OK) ph_i_csc_clear(m);
    return st;
}

void ph_i_csc_clear(ph_csc *m)
{
    free(m->start);
    free(m->row);
    free(m->value);
    memset(m, 0, sizeof *m);
}

ph_status ph_i_bondlist_row_sums(const ph_bondlist *l, double *sum, ph_error *err)
{
    ph_status st = PH_OK;
    columns c;
    PH_TRY(columns_init(&c, l, err));
    for (ptrdiff_t x = 0; x < l->nodes; x++) {
        PH_TRY(column(&c, x, err));
        for (int a = 0; a < l->nd; a++) {
            double t = 0.0;
            for (int32_t i = 0; i < c.count; i++)
                for (int r = 0; r < l->nd; r++)
                    t += fabs(c.block[(ptrdiff_t)i * l->nd * l->nd + r * l->nd + a]);
            sum[a * l->nodes + x] = t; /* of a column, which is a row: A is symmetric */
        }
    }
out:
    columns_clear(&c);
    return st;
}
