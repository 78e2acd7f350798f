/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effective/visco_layers.h"

#include <math.h>
#include <string.h>

/* Plane stress: Mandel components in the plane, and out of it. */
static const int in_plane[3] = {0, 1, 5}, out_of_plane[3] = {2, 3, 4};

/* ---- which cells --------------------------------------------------------------------------- */

/* Cuts of the n-th mixture of the map, or NULL. */
static ptrdiff_t *mixtures(const ph_microstructure *m, const ph_stiffness_map *map)
{
    int n = map->count - ph_i_first_mixture(map), k = 0;
    ptrdiff_t *first = calloc((size_t)n + 1, sizeof *first);
    if (!first) return NULL;
    for (ptrdiff_t i = 0; n > 0 && i < m->ncuts; i++)
        if (i == 0 || m->cuts[i].cell != m->cuts[i - 1].cell) first[k++] = i;
    first[n] = n > 0 ? m->ncuts : 0;
    return first;
}

static void add_layer(ph_layers *l, const ph_stiffness_map *map, ptrdiff_t at,
                      int material, const ph_cut *cut)
{
    int size = l->six[material] ? 6 : l->ns;
    l->layer[at] = (ph_layer){material, 1.0, 1.0, size, l->record, cut, {0}};
    if (cut) ph_i_cut_normal(map, &l->micro->grid, cut, l->layer[at].normal);
    l->record += size;
}

/* Shares of the layers of a cell; a void has none. */
static void share_cell(ph_layers *l, ph_layer *layer, ptrdiff_t n)
{
    const ph_material *m = l->micro->materials;
    double solid = m[layer[0].material].is_void ? 0.0 : 1.0;
    for (ptrdiff_t k = 1; k < n; k++) {
        bool hole = m[layer[k].material].is_void;
        double f = ph_i_cut_fraction(layer[k].cut, hole, &solid);
        for (ptrdiff_t j = 0; j < k; j++)
            layer[j].share *= 1.0 - f;
        layer[k].share = layer[k].fraction = f;
    }
}

static bool is_kept(const ph_layers *l, const ph_stiffness_map *map, int entry)
{
    return entry >= ph_i_first_mixture(map) || (entry < map->materials && l->six[entry]);
}

ph_status ph_i_layers_init(ph_layers *l, const ph_microstructure *micro,
                           const ph_split *split, const ph_stiffness_map *map,
                           const uint8_t *region, ph_error *err)
{
    ph_status st = PH_OK;
    ptrdiff_t *first = NULL, layers = 0;
    *l = (ph_layers){.micro = micro, .ns = map->ns};
    PH_ALLOC(l->six, micro->nmaterials, "phase flags");
    for (int p = 0; p < micro->nmaterials; p++)
        l->six[p] =
            micro->grid.kinematics == PH_PLANE_STRESS && ph_i_split_count(split, p) > 1;
    first = mixtures(micro, map);
    PH_CHECK(first, PH_ENOMEM, "no memory for cut cells");
    for (ptrdiff_t x = 0; x < map->cells; x++) {
        int e = map->index[x], m = e - ph_i_first_mixture(map);
        if ((region && !region[x]) || !is_kept(l, map, e)) continue;
        l->count++;
        layers += m < 0 ? 1 : 1 + first[m + 1] - first[m];
    }
    PH_ALLOC(l->cell, l->count, "cut cells");
    PH_ALLOC(l->begin, l->count + 1, "cut cells");
    PH_ALLOC(l->layer, layers, "layers of cut cells");
    ptrdiff_t i = 0, at = 0;
    for (ptrdiff_t x = 0; x < map->cells; x++) {
        int e = map->index[x], m = e - ph_i_first_mixture(map);
        if ((region && !region[x]) || !is_kept(l, map, e)) continue;
        l->begin[i] = at;
        l->cell[i++] = x;
        add_layer(l, map, at++, m < 0 ? e : micro->cuts[first[m]].base, NULL);
        for (ptrdiff_t c = m < 0 ? 0 : first[m]; m >= 0 && c < first[m + 1]; c++)
            add_layer(l, map, at++, micro->cuts[c].material, &micro->cuts[c]);
        share_cell(l, l->layer + l->begin[i - 1], at - l->begin[i - 1]);
        if (at - l->begin[i - 1] > l->deepest) l->deepest = (int)(at - l->begin[i - 1]);
    }
    l->begin[i] = at;
    PH_ALLOC(l->under, l->deepest, "layers of cut cells");
out:
    free(first);
    if (st != PH_OK) ph_i_layers_clear(l);
    return st;
}

void ph_i_layers_clear(ph_layers *l)
{
    free(l->six);
    free(l->cell);
    free(l->begin);
    free(l->layer);
    free(l->under);
    *l = (ph_layers){0};
}

/* ---- strains of the layers ------------------------------------------------------------------ */

/* e += factor sym(a (x) n), Mandel. */
static void add_jump(int ns, const double *a, const double *n, double factor, double *e)
{
    const double r2 = sqrt(0.5);
    int nd = ns == 6 ? 3 : 2;
    for (int d = 0; d < nd; d++)
        e[d] += factor * a[d] * n[d];
    if (nd == 2) {
        e[2] += factor * r2 * (a[0] * n[1] + a[1] * n[0]);
        return;
    }
    for (int d = 0; d < 3; d++) {
        int p = (d + 1) % 3, q = (d + 2) % 3;
        e[3 + d] += factor * r2 * (a[p] * n[q] + a[q] * n[p]);
    }
}

/* t = sigma . n, Mandel. */
static void traction(int ns, const double *s, const double *n, double *t)
{
    const double r2 = sqrt(0.5);
    int nd = ns == 6 ? 3 : 2;
    for (int d = 0; d < nd; d++) {
        t[d] = s[d] * n[d];
        for (int b = 0; b < nd; b++)
            if (b != d) t[d] += r2 * s[nd == 3 ? 6 - d - b : 2] * n[b];
    }
}

static void product(const ph_sym4 *c, const double *e, double *s)
{
    for (int i = 0; i < c->n; i++) {
        s[i] = 0.0;
        for (int j = 0; j < c->n; j++)
            s[i] += c->m[i][j] * e[j];
    }
}

/* Solve the nd x nd system of an acoustic tensor, symmetric positive definite. */
static bool solve_small(int n, double Q[3][3], double *b)
{
    for (int k = 0; k < n; k++) {
        if (!(Q[k][k] > 0.0)) return false;
        for (int i = k + 1; i < n; i++) {
            double f = Q[i][k] / Q[k][k];
            for (int j = k; j < n; j++)
                Q[i][j] -= f * Q[k][j];
            b[i] -= f * b[k];
        }
    }
    for (int k = n - 1; k >= 0; k--) {
        for (int j = k + 1; j < n; j++)
            b[k] -= Q[k][j] * b[j];
        b[k] /= Q[k][k];
    }
    return true;
}

/* The jump a of the displacement gradient between `over` (share f) and `under`:
 * n.(((1-f) O + f U) : sym(a (x) n)) = n.((U - O) : e). */
static bool jump(const ph_sym4 *under, const ph_sym4 *over, double f, const double *n,
                 const double *e, double *a)
{
    int ns = under->n, nd = ns == 6 ? 3 : 2;
    ph_sym4 mean = ph_sym4_combine(1.0 - f, over, f, under);
    ph_sym4 off = ph_sym4_combine(1.0, under, -1.0, over);
    double s[6], Q[3][3], t[3];
    for (int j = 0; j < nd; j++) {
        double unit[3] = {0}, strain[6] = {0};
        unit[j] = 1.0;
        add_jump(ns, unit, n, 1.0, strain);
        product(&mean, strain, s);
        traction(ns, s, n, t);
        for (int i = 0; i < nd; i++)
            Q[i][j] = t[i];
    }
    product(&off, e, s);
    traction(ns, s, n, a);
    return solve_small(nd, Q, a);
}

/* Stiffness under each cut of a cell, and the fraction that the cut gets. */
static ph_status stack(ph_layers *l, const ph_layer *layer, ptrdiff_t n,
                       const ph_sym4 *phase, ph_error *err)
{
    ph_status st = PH_OK;
    l->under[0] = phase[layer[0].material];
    for (ptrdiff_t k = 1; k + 1 < n; k++)
        PH_TRY(ph_sym4_laminate(&l->under[k - 1], &phase[layer[k].material],
                                layer[k].fraction, layer[k].normal, &l->under[k], err));
out:
    return st;
}

static void keep(const ph_layer *layer, int ns, const ph_sym4 *space, const double *e,
                 double *x)
{
    if (layer->size == ns) {
        memcpy(x + layer->first, e, sizeof *e * (size_t)ns);
        return;
    }
    /* sigma = 0 out of the plane: C_oo e_o = - C_oi e_i */
    double Q[3][3], b[3];
    for (int i = 0; i < 3; i++) {
        b[i] = 0.0;
        for (int j = 0; j < 3; j++) {
            Q[i][j] = space->m[out_of_plane[i]][out_of_plane[j]];
            b[i] -= space->m[out_of_plane[i]][in_plane[j]] * e[j];
        }
    }
    bool ok = solve_small(3, Q, b);
    for (int i = 0; i < 3; i++) {
        x[layer->first + in_plane[i]] = e[i];
        x[layer->first + out_of_plane[i]] = ok ? b[i] : 0.0;
    }
}

/* From the last cut down: what lies over it, then what lies under it. */
static ph_status localise_cell(ph_layers *l, const ph_layer *layer, ptrdiff_t n,
                               const ph_sym4 *phase, const ph_sym4 *space,
                               const double *strain, double *x, ph_error *err)
{
    ph_status st = PH_OK;
    double e[6] = {0}, over[6], a[3];
    memcpy(e, strain, sizeof *e * (size_t)l->ns);
    for (ptrdiff_t k = n - 1; k > 0; k--) {
        const ph_sym4 *O = &phase[layer[k].material], *U = &l->under[k - 1];
        double f = layer[k].fraction;
        memcpy(over, e, sizeof over);
        if (ph_sym4_norm(O) > 0.0 && ph_sym4_norm(U) > 0.0) {
            PH_CHECK(jump(U, O, f, layer[k].normal, e, a), PH_ESINGULAR,
                     "a cut cell has layers without stiffness");
            add_jump(l->ns, a, layer[k].normal, 1.0 - f, over);
            add_jump(l->ns, a, layer[k].normal, -f, e);
        }
        keep(&layer[k], l->ns, &space[layer[k].material], over, x);
    }
    keep(&layer[0], l->ns, &space[layer[0].material], e, x);
out:
    return st;
}

ph_status ph_i_layers_localise(ph_layers *l, const ph_sites *sites, const ph_sym4 *phase,
                               const ph_sym4 *space, const double *strain, double *x,
                               ph_error *err)
{
    ph_status st = PH_OK;
    for (ptrdiff_t i = 0; i < l->count; i++) {
        const ph_layer *layer = l->layer + l->begin[i];
        ptrdiff_t n = l->begin[i + 1] - l->begin[i];
        PH_TRY(stack(l, layer, n, phase, err));
        for (int r = 0; r < sites->records; r++)
            PH_TRY(localise_cell(l, layer, n, phase, space,
                                 strain + (r * l->count + i) * l->ns, x + r * l->record,
                                 err));
    }
out:
    return st;
}

void ph_i_layers_spread(const ph_layers *l, const ph_sites *sites, const double *strain,
                        double *x)
{
    memset(x, 0, sizeof *x * (size_t)(sites->records * l->record));
    for (int r = 0; r < sites->records; r++)
        for (ptrdiff_t i = 0; i < l->count; i++)
            for (ptrdiff_t k = l->begin[i]; k < l->begin[i + 1]; k++) {
                const double *e = strain + (r * l->count + i) * l->ns;
                double *to = x + r * l->record + l->layer[k].first;
                for (int a = 0; a < l->ns; a++)
                    to[l->layer[k].size == l->ns ? a : in_plane[a]] = e[a];
            }
}

void ph_i_layers_stress(const ph_layers *l, const ph_sites *sites, const ph_sym4 *shape,
                        const ph_sym4 *space, const double *x, double *y)
{
    for (int r = 0; r < sites->records; r++)
        for (ptrdiff_t i = 0; i < l->count; i++)
            for (ptrdiff_t k = l->begin[i]; k < l->begin[i + 1]; k++) {
                const ph_layer *layer = &l->layer[k];
                double w = layer->share * sites->weight[r * l->count + i];
                ptrdiff_t at = r * l->record + layer->first;
                product(layer->size == l->ns ? &shape[layer->material]
                                             : &space[layer->material],
                        x + at, y + at);
                for (int a = 0; a < layer->size; a++)
                    y[at + a] *= w;
            }
}
