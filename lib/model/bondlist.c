/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/bondlist.h"

#include <math.h>
#include <string.h>

typedef struct builder {
    ph_bondlist *list;
    const ph_grid *box;
    const ph_operator_params *params;
    int dims;
    bool active[3];
    ptrdiff_t cells[3]; /* of the body: points are made in these */
    ptrdiff_t last[3];  /* node of the body beyond which there is none, or -1: it wraps */
    ptrdiff_t room_points, room_bonds;
} builder;

static ptrdiff_t wrap(ptrdiff_t i, ptrdiff_t n)
{
    i %= n;
    return i < 0 ? i + n : i;
}

/* Node at an offset from a cell or node; false where the body has ended. */
static bool node_at(const builder *b, const ptrdiff_t at[3], const int o[3],
                    int32_t *node)
{
    ptrdiff_t x = 0;
    for (int d = 0; d < 3; d++) {
        ptrdiff_t i = at[d] + (b->active[d] ? o[d] : 0);
        if (b->last[d] >= 0 && (i < 0 || i > b->last[d])) return false;
        x = x * b->box->n[d] + wrap(i, b->box->n[d]);
    }
    *node = (int32_t)x;
    return true;
}

/* ---- lists that grow ------------------------------------------------------------------ */

static ph_status resize(void **p, ptrdiff_t count, size_t size, ph_error *err)
{
    ph_status st = PH_OK;
    void *more = realloc(*p, (size_t)count * size);
    PH_CHECK(more, PH_ENOMEM, "no memory for the bond list (%td x %zu bytes)", count,
             size);
    *p = more;
out:
    return st;
}

static ph_status start_point(builder *b, int32_t cell, bool family, double share,
                             ph_error *err)
{
    ph_status st = PH_OK;
    ph_bondlist *l = b->list;
    if (l->points + 1 >= b->room_points) {
        void *p = l->point;
        b->room_points = 2 * b->room_points + 1024;
        PH_TRY(resize(&p, b->room_points, sizeof *l->point, err));
        l->point = p;
    }
    l->point[l->points++] = (ph_bond_point){l->bonds, cell, family, share};
    l->point[l->points].first = l->bonds;
out:
    return st;
}

static ph_status add_bond(builder *b, int32_t node, const double g[3], const double xi[3],
                          double w, ph_error *err)
{
    ph_status st = PH_OK;
    ph_bondlist *l = b->list;
    if (l->bonds >= b->room_bonds) {
        void *p = l->bond, *q = l->deviation;
        b->room_bonds = 2 * b->room_bonds + 8192;
        PH_TRY(resize(&p, b->room_bonds, sizeof *l->bond, err));
        l->bond = p;
        PH_TRY(resize(&q, b->room_bonds, sizeof *l->deviation, err));
        l->deviation = q;
    }
    l->bond[l->bonds] = (ph_bond){node, {g[0], g[1], g[2]}};
    l->deviation[l->bonds] = (ph_deviation){{xi[0], xi[1], xi[2]}, w, 0.0};
    l->point[l->points].first = ++l->bonds;
out:
    return st;
}

/* ---- a point of a family -------------------------------------------------------------- */

/* Inverse of the shape tensor on the active axes by Gauss-Jordan; false if it is singular. */
static bool invert_shape(const bool active[3], double K[3][3], double R[3][3])
{
    double trace = K[0][0] + K[1][1] + K[2][2];
    memset(R, 0, sizeof(double) * 9);
    for (int i = 0; i < 3; i++)
        R[i][i] = active[i] ? 1.0 : 0.0;
    for (int i = 0; i < 3; i++) {
        if (!active[i]) continue;
        double pivot = K[i][i];
        if (!(pivot > 1e-10 * trace)) return false;
        for (int j = 0; j < 3; j++)
            K[i][j] /= pivot, R[i][j] /= pivot;
        for (int k = 0; k < 3; k++) {
            double f = K[k][i];
            if (k == i || !active[k]) continue;
            for (int j = 0; j < 3; j++)
                K[k][j] -= f * K[i][j], R[k][j] -= f * R[i][j];
        }
    }
    return true;
}

/* xi from the mean of those that are left, K of those, g = w K^-1 xi. A singular K is an
 * error, or, where `singular` is given, what it says. */
static ph_status weigh_point(builder *b, const ptrdiff_t at[3], ptrdiff_t first,
                             bool centred, bool *singular, ph_error *err)
{
    ph_status st = PH_OK;
    ph_bondlist *l = b->list;
    double mean[3] = {0}, W = 0.0, K[3][3] = {{0}}, R[3][3];
    for (ptrdiff_t i = first; i < l->bonds; i++) {
        W += l->deviation[i].w;
        for (int d = 0; d < 3; d++)
            mean[d] += l->deviation[i].w * l->deviation[i].xi[d];
    }
    for (ptrdiff_t i = first; i < l->bonds; i++) {
        ph_deviation *v = &l->deviation[i];
        for (int d = 0; d < 3 && centred; d++)
            v->xi[d] -= mean[d] / W;
        for (int d = 0; d < 3; d++)
            for (int e = 0; e < 3; e++)
                K[d][e] += v->w * v->xi[d] * v->xi[e];
        if (centred) v->origin = v->w / W;
    }
    bool regular = W > 0.0 && invert_shape(b->active, K, R);
    if (singular) *singular = !regular;
    if (singular && !regular) return PH_OK;
    PH_CHECK(
        regular, PH_ESINGULAR,
        "the family of the point at cell (%td, %td, %td) has too few nodes left for a "
        "gradient: give a larger horizon",
        at[0], at[1], at[2]);
    for (ptrdiff_t i = first; i < l->bonds; i++)
        for (int d = 0; d < 3; d++)
            for (int e = 0; e < 3; e++)
                l->bond[i].g[d] += l->deviation[i].w * R[d][e] * l->deviation[i].xi[e];
out:
    return st;
}

static ph_status add_family_point(builder *b, const ptrdiff_t at[3], int32_t cell,
                                  double share, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_family *fam = b->params->family;
    bool stress = fam->points == PH_POINTS_STRESS;
    static const double nothing[3];
    ph_bondlist *l = b->list;
    int32_t node;
    const ph_broken *broken = b->params->broken;
    ptrdiff_t place = broken ? ph_i_broken_place(broken, cell) : -1;
    PH_TRY(start_point(b, cell, true, share, err));
    ptrdiff_t first = l->bonds;
    for (ptrdiff_t i = 0; i < fam->count; i++) {
        double xi[3];
        if (!node_at(b, at, fam->offset[i], &node)) continue;
        if (place >= 0 && ph_i_is_broken(broken, place, i)) continue;
        for (int d = 0; d < 3; d++)
            xi[d] = b->active[d]
                        ? (fam->offset[i][d] - (stress ? 0.5 : 0.0)) * b->box->h[d]
                        : 0.0;
        PH_TRY(add_bond(b, node, nothing, xi, fam->w[i], err));
    }
    bool singular = false;
    PH_TRY(weigh_point(b, at, first, stress, place >= 0 ? &singular : NULL, err));
    if (singular) { /* it carries no stress: there is no such point */
        l->bonds = first;
        l->points--;
        l->point[l->points].first = first;
        return st;
    }
    if (stress) return st;
    double g0[3] = {0};
    for (ptrdiff_t i = first; i < l->bonds; i++)
        for (int d = 0; d < 3; d++)
            g0[d] -= l->bond[i].g[d];
    PH_TRY(add_bond(b, cell, g0, nothing, 0.0, err));
    l->deviation[l->bonds - 1].origin = 1.0;
out:
    return st;
}

/* ---- points with one finite element each ----------------------------------------------- */

/* Simplex of a node and its neighbours on the side `corner` says, or the other side where
 * the body has ended; of stress points, of a corner of the cell and the ends of its edges. */
static ph_status add_simplex(builder *b, const ptrdiff_t at[3], int32_t cell, int corner,
                             double share, ph_error *err)
{
    ph_status st = PH_OK;
    bool stress = b->params->family->points == PH_POINTS_STRESS;
    static const double nothing[3];
    int base[3] = {0, 0, 0};
    double g0[3] = {0};
    int32_t node;
    for (int d = 0; d < 3; d++)
        if (stress && b->active[d]) base[d] = corner >> d & 1;
    PH_TRY(start_point(b, cell, false, share, err));
    for (int d = 0; d < 3; d++) {
        if (!b->active[d]) continue;
        int o[3] = {base[0], base[1], base[2]}, side = corner >> d & 1 ? 1 : -1;
        if (stress) side = -side; /* towards the other end of the edge */
        o[d] = base[d] + side;
        if (!node_at(b, at, o, &node)) o[d] = base[d] + (side = -side);
        PH_ASSERT(node_at(b, at, o, &node));
        double g[3] = {0};
        g[d] = side / b->box->h[d];
        g0[d] = -g[d];
        PH_TRY(add_bond(b, node, g, nothing, 0.0, err));
    }
    PH_ASSERT(node_at(b, at, base, &node));
    PH_TRY(add_bond(b, node, g0, nothing, 0.0, err));
out:
    return st;
}

/* Gauss point `gauss` of a multilinear element: derivatives of its shape functions. */
static ph_status add_gauss_point(builder *b, const ptrdiff_t at[3], int32_t cell,
                                 int gauss, double share, ph_error *err)
{
    ph_status st = PH_OK;
    static const double nothing[3];
    const double t = 0.57735026918962576451; /* 1/sqrt(3) */
    PH_TRY(start_point(b, cell, true, share, err));
    for (int corner = 0; corner < 8; corner++) {
        int o[3] = {corner & 1, corner >> 1 & 1, corner >> 2 & 1};
        double g[3] = {0};
        int32_t node;
        bool skip = false;
        for (int d = 0; d < 3; d++)
            skip = skip || (o[d] && !b->active[d]);
        if (skip) continue;
        for (int d = 0; d < 3; d++) {
            if (!b->active[d]) continue;
            g[d] = (o[d] ? 1.0 : -1.0) / b->box->h[d];
            for (int e = 0; e < 3; e++) {
                double x = gauss >> e & 1 ? t : -t;
                if (e != d && b->active[e]) g[d] *= 0.5 * (1.0 + (o[e] ? x : -x));
            }
        }
        PH_ASSERT(node_at(b, at, o, &node));
        PH_TRY(add_bond(b, node, g, nothing, 0.0, err));
    }
out:
    return st;
}

/* ---- the box --------------------------------------------------------------------------- */

static ph_status add_cell(builder *b, const ptrdiff_t at[3], int32_t cell, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_stiffness_map *map = b->list->map;
    const ph_operator_params *p = b->params;
    int entry = map->index[cell], corners = 1 << b->dims;
    if (entry == map->materials) return PH_OK; /* outside the body: nothing at all */
    if (p->cut_only && entry < map->materials) return PH_OK;
    bool empty = map->hooke[entry] == PH_HOOKE_ZERO;
    if (empty && b->list->s == 0.0) return PH_OK;
    double theta = p->stabilisation == PH_STABILISE_SUBPOINT ? p->value : 0.0;
    if (p->family) PH_TRY(add_family_point(b, at, cell, 1.0 - theta, err));
    if (p->family && theta == 0.0) return PH_OK;
    for (int corner = 0; corner < 8; corner++) {
        bool skip = false;
        for (int d = 0; d < 3; d++)
            skip = skip || ((corner >> d & 1) && !b->active[d]);
        if (skip) continue;
        if (p->family)
            PH_TRY(add_simplex(b, at, cell, corner, theta / corners, err));
        else
            PH_TRY(add_gauss_point(b, at, cell, corner, 1.0 / corners, err));
    }
out:
    return st;
}

/* s = alpha kappa d / tr K with the K of a whole family. */
static double deviation_coefficient(const builder *b)
{
    const ph_operator_params *p = b->params;
    const ph_family *fam = p->family;
    double mean[3] = {0}, W = 0.0, trace = 0.0;
    if (p->stabilisation != PH_STABILISE_SPECTRAL || !fam || p->cut_only) return 0.0;
    bool stress = fam->points == PH_POINTS_STRESS;
    for (int pass = 0; pass < 2; pass++)
        for (ptrdiff_t i = 0; i < fam->count; i++)
            for (int d = 0; d < 3; d++) {
                double xi = (fam->offset[i][d] - (stress ? 0.5 : 0.0)) * b->box->h[d];
                if (!b->active[d]) continue;
                if (pass == 0)
                    mean[d] += fam->w[i] * xi;
                else
                    trace += fam->w[i] * (xi - mean[d] / W) * (xi - mean[d] / W);
                if (pass == 0 && W == 0.0)
                    for (ptrdiff_t j = 0; j < fam->count; j++)
                        W += fam->w[j];
            }
    return trace > 0.0 ? p->value * b->list->map->softest * b->dims / trace : 0.0;
}

static void set_up(builder *b, const ph_grid *box, const ph_operator_params *p)
{
    bool stress = !p->family || p->family->points == PH_POINTS_STRESS;
    for (int d = 0; d < 3; d++) {
        b->active[d] = box->n[d] > 1;
        b->dims += b->active[d];
        b->cells[d] = p->one_sided ? p->rve[d] : box->n[d];
        b->last[d] = !p->one_sided || !b->active[d] ? -1 : p->rve[d] - (stress ? 0 : 1);
    }
}

static void count_bytes(ph_bondlist *l)
{
    l->bytes =
        (size_t)l->bonds * (sizeof *l->bond + (l->deviation ? sizeof *l->deviation : 0)) +
        (size_t)l->points * sizeof *l->point;
    if (!l->meter) return;
    l->meter->bytes += l->bytes;
    if (l->meter->bytes > l->meter->peak) l->meter->peak = l->meter->bytes;
}

ph_status ph_i_bondlist_new(const ph_grid *box, const ph_stiffness_map *map,
                            const ph_operator_params *params, ph_meter *meter,
                            ph_bondlist **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_bondlist *l = NULL;
    *out = NULL;
    PH_ALLOC(l, 1, "the bond list");
    builder b = {.list = l, .box = box, .params = params};
    l->map = map;
    l->nd = ph_displacements(box->kinematics);
    l->ns = ph_strains(box->kinematics);
    l->nodes = ph_grid_cells(box);
    l->meter = meter;
    PH_CHECK(l->nodes < INT32_MAX, PH_EINVAL, "too many nodes for a bond list (%td)",
             l->nodes);
    set_up(&b, box, params);
    l->s = deviation_coefficient(&b);
    ptrdiff_t at[3];
    for (at[0] = 0; at[0] < b.cells[0]; at[0]++)
        for (at[1] = 0; at[1] < b.cells[1]; at[1]++)
            for (at[2] = 0; at[2] < b.cells[2]; at[2]++) {
                ptrdiff_t cell = (at[0] * box->n[1] + at[1]) * box->n[2] + at[2];
                PH_TRY(add_cell(&b, at, (int32_t)cell, err));
            }
    if (l->s == 0.0) {
        free(l->deviation);
        l->deviation = NULL;
    }
    count_bytes(l);
    *out = l;
    l = NULL;
out:
    ph_i_bondlist_free(&l);
    return st;
}

void ph_i_bondlist_free(ph_bondlist **list)
{
    if (!list || !*list) return;
    ph_bondlist *l = *list;
    if (l->meter) l->meter->bytes -= l->bytes;
    free(l->point);
    free(l->bond);
    free(l->deviation);
    free(l);
    *list = NULL;
}
