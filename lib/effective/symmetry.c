/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effective/symmetry.h"

#include "core/check.h"

#include <math.h>
#include <string.h>

/* Cells count as equal up to this share of their stiffness, and the answer is off by no more;
 * cut cells also up to what this share of the stiffest phase makes: they are cut to about that. */
static const double same = 1e-9, share_off = 1e-10;
/* Comparisons of cells that a candidate may take, in passes over the box. */
enum { PASSES = 8 };

/* ---- turns ------------------------------------------------------------------------------ */

static const int pair6[6][2] = {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};
static const int pair3[3][2] = {{0, 0}, {1, 1}, {0, 1}};

static int component(int ns, int i, int j)
{
    if (i == j) return i;
    return ns == 3 ? 2 : 6 - i - j;
}

static ph_turn make_turn(int ns, const int to[3], const int sign[3])
{
    ph_turn t = {.shift = {0}};
    memcpy(t.to, to, sizeof t.to);
    memcpy(t.sign, sign, sizeof t.sign);
    for (int a = 0; a < ns; a++) {
        const int *p = ns == 3 ? pair3[a] : pair6[a];
        t.place[a] = component(ns, to[p[0]], to[p[1]]);
        t.flip[a] = sign[p[0]] * sign[p[1]];
    }
    return t;
}

static bool equal(const ph_turn *a, const ph_turn *b)
{
    return memcmp(a->to, b->to, sizeof a->to) == 0 &&
           memcmp(a->sign, b->sign, sizeof a->sign) == 0;
}

static ptrdiff_t wrapped(ptrdiff_t i, ptrdiff_t n)
{
    return i < 0 ? i + n : i < n ? i : i - n;
}

/* First b, then a, on a box of n cells. */
static ph_turn product(int ns, const ptrdiff_t n[3], const ph_turn *a, const ph_turn *b)
{
    int to[3], sign[3];
    for (int d = 0; d < 3; d++) {
        to[d] = a->to[b->to[d]];
        sign[d] = b->sign[d] * a->sign[b->to[d]];
    }
    ph_turn t = make_turn(ns, to, sign);
    for (int d = 0; d < 3; d++) {
        int e = b->to[d], f = a->to[e];
        t.shift[f] = wrapped(a->sign[e] * b->shift[e] + a->shift[f], n[f]);
    }
    return t;
}

static bool has(const ph_cell_symmetry *s, const ph_turn *t)
{
    for (int k = 0; k < s->count; k++)
        if (equal(&s->turn[k], t)) return true;
    return false;
}

/* The group that the turns found so far make with one more. */
static void add(ph_cell_symmetry *s, const ptrdiff_t n[3], const ph_turn *t)
{
    s->turn[s->count++] = *t;
    for (int a = 0; a < s->count; a++)
        for (int b = 0; b < s->count; b++) {
            ph_turn p = product(s->ns, n, &s->turn[a], &s->turn[b]);
            if (!has(s, &p) && s->count < PH_TURNS) {
                s->turn[s->count++] = p;
                a = b = 0;
            }
        }
}

ph_cell_symmetry ph_i_symmetry_none(int ns)
{
    static const int axes[3] = {0, 1, 2}, ones[3] = {1, 1, 1};
    ph_cell_symmetry s = {.count = 1, .ns = ns};
    s.turn[0] = make_turn(ns, axes, ones);
    return s;
}

/* ---- does a turn leave the cells as they are? ------------------------------------------------ */

typedef struct search {
    const ph_grid *box;
    const ph_stiffness_map *map;
    ptrdiff_t count, *cell; /* of the rarest kind */
    ph_turn *turn;
    bool *whole;      /* [materials] the turn leaves this material as it is */
    double stiffest;  /* entry of a phase */
    ptrdiff_t budget; /* comparisons left */
} search;

/* Where a turn takes the cell, or the lower corner of the cell, at `at`. */
static ptrdiff_t turned_place(const ph_turn *t, const ptrdiff_t n[3],
                              const ptrdiff_t at[3], bool corner)
{
    ptrdiff_t y[3];
    for (int d = 0; d < 3; d++) {
        int e = t->to[d];
        ptrdiff_t last = corner ? n[d] : n[d] - 1;
        y[e] = wrapped((t->sign[d] > 0 ? at[d] : last - at[d]) + t->shift[e], n[e]);
    }
    return (y[0] * n[1] + y[1]) * n[2] + y[2];
}

static ptrdiff_t turned(const search *s, ptrdiff_t x)
{
    const ptrdiff_t *n = s->box->n;
    const ptrdiff_t at[3] = {x / n[2] / n[1], x / n[2] % n[1], x % n[2]};
    return turned_place(s->turn, n, at, false);
}

static bool turns_into(const search *s, int from, int to)
{
    const int ns = s->map->ns;
    const double *a = s->map->c + (ptrdiff_t)from * ns * ns,
                 *b = s->map->c + (ptrdiff_t)to * ns * ns;
    double off = 0.0, size = 0.0;
    for (int i = 0; i < ns; i++)
        for (int j = 0; j < ns; j++) {
            const ph_turn *t = s->turn;
            double v = b[t->place[i] * ns + t->place[j]];
            off = fmax(off, fabs(t->flip[i] * t->flip[j] * a[i * ns + j] - v));
            size = fmax(size, fabs(v));
        }
    bool cut = from >= s->map->materials && to >= s->map->materials;
    return off <= same * size + (cut ? share_off * s->stiffest : 0.0);
}

static bool cell_fits(search *s, ptrdiff_t x)
{
    int from = s->map->index[x], to = s->map->index[turned(s, x)];
    s->budget--;
    if (from == to && from < s->map->materials) return s->whole[from];
    return turns_into(s, from, to);
}

static bool fits(search *s)
{
    for (ptrdiff_t i = 0; i < s->count; i++)
        if (!cell_fits(s, s->cell[i])) return false;
    for (ptrdiff_t x = 0; x < s->map->cells; x++)
        if (!cell_fits(s, x)) return false;
    return true;
}

/* Some cell of the rarest kind must come to lie on one of them: that finds the shift. */
static bool is_symmetry(search *s, ph_turn *turn)
{
    const ptrdiff_t *n = s->box->n;
    s->turn = turn;
    s->budget = PASSES * s->map->cells;
    for (int d = 0; d < 3; d++) {
        int e = turn->to[d];
        bool alike = fabs(s->box->h[d] - s->box->h[e]) <= 1e-12 * s->box->h[d];
        if (n[d] != n[e] || (n[d] > 1 && !alike)) return false;
    }
    for (int m = 0; m < s->map->materials; m++)
        s->whole[m] = turns_into(s, m, m);
    memset(turn->shift, 0, sizeof turn->shift);
    ptrdiff_t x = turned(s, s->cell[0]);
    for (ptrdiff_t i = 0; i < s->count && s->budget > 0; i++) {
        ptrdiff_t y = s->cell[i];
        ptrdiff_t shift[3] = {y / n[2] / n[1] - x / n[2] / n[1],
                              y / n[2] % n[1] - x / n[2] % n[1], y % n[2] - x % n[2]};
        for (int d = 0; d < 3; d++)
            turn->shift[d] = wrapped(shift[d], n[d]);
        if (fits(s)) return true;
    }
    return false;
}

/* ---- search ------------------------------------------------------------------------------- */

/* Cells of the rarest kind: a material, or cut. */
static ph_status rarest(search *s, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_stiffness_map *map = s->map;
    ptrdiff_t *of = NULL;
    int kind = 0;
    PH_ALLOC(of, map->materials + 1, "cells of a kind");
    for (ptrdiff_t x = 0; x < map->cells; x++)
        of[map->index[x] < map->materials ? map->index[x] : map->materials]++;
    while (of[kind] == 0)
        kind++;
    for (int m = kind + 1; m <= map->materials; m++)
        if (of[m] > 0 && of[m] < of[kind]) kind = m;
    PH_ALLOC(s->cell, of[kind], "cells of a kind");
    for (ptrdiff_t x = 0; x < map->cells; x++)
        if ((map->index[x] < map->materials ? map->index[x] : map->materials) == kind)
            s->cell[s->count++] = x;
out:
    free(of);
    return st;
}

ph_status ph_i_symmetry_find(const ph_grid *box, const ph_stiffness_map *map,
                             ph_cell_symmetry *out, ph_error *err)
{
    static const int order[6][3] = {{0, 1, 2}, {1, 0, 2}, {2, 1, 0},
                                    {0, 2, 1}, {1, 2, 0}, {2, 0, 1}};
    ph_status st = PH_OK;
    search s = {.box = box, .map = map};
    ph_cell_symmetry found = ph_i_symmetry_none(map->ns);
    PH_ALLOC(s.whole, map->materials, "phase flags");
    PH_TRY(rarest(&s, err));
    for (int i = 0; i < map->ns * map->ns * map->materials; i++)
        s.stiffest = fmax(s.stiffest, fabs(map->c[i]));
    for (int k = 0; k < 6; k++)
        for (int signs = 0; signs < 8; signs++) {
            bool plane = map->ns == 3;
            if (plane && (order[k][2] != 2 || signs & 4)) continue;
            int sign[3] = {signs & 1 ? -1 : 1, signs & 2 ? -1 : 1, signs & 4 ? -1 : 1};
            ph_turn t = make_turn(map->ns, order[k], sign);
            if (!has(&found, &t) && is_symmetry(&s, &t)) add(&found, box->n, &t);
        }
    *out = found;
out:
    free(s.whole);
    free(s.cell);
    return st;
}

/* ---- what follows ----------------------------------------------------------------------- */

const ph_turn *ph_i_symmetry_source(const ph_cell_symmetry *s, unsigned loads, int a,
                                    int *from)
{
    for (int b = 0; b < s->ns; b++)
        for (int k = 0; loads >> b & 1 && k < s->count; k++)
            if (s->turn[k].place[b] == a) {
                *from = b;
                return &s->turn[k];
            }
    return NULL;
}

unsigned ph_i_symmetry_loads(const ph_cell_symmetry *s, unsigned wanted)
{
    unsigned loads = 0;
    int from;
    for (int a = 0; a < s->ns; a++)
        if (wanted >> a & 1 && !ph_i_symmetry_source(s, loads, a, &from))
            loads |= 1u << a;
    return loads;
}

/* Entry ab of a symmetric tensor is zero: turned by all of them it cancels. */
static bool cancels(const ph_cell_symmetry *s, int a, int b)
{
    int sum[6][6] = {{0}};
    for (int k = 0; k < s->count; k++) {
        const ph_turn *t = &s->turn[k];
        int i = t->place[a], j = t->place[b];
        sum[i < j ? i : j][i < j ? j : i] += t->flip[a] * t->flip[b];
    }
    for (int i = 0; i < s->ns; i++)
        for (int j = 0; j < s->ns; j++)
            if (sum[i][j]) return false;
    return true;
}

unsigned ph_i_symmetry_block(const ph_cell_symmetry *s, int a)
{
    unsigned block = 1u << a, before = 0;
    while (block != before) {
        before = block;
        for (int i = 0; i < s->ns; i++)
            for (int j = 0; before >> i & 1 && j < s->ns; j++)
                if (!cancels(s, i, j)) block |= 1u << j;
    }
    return block;
}

/* Mean of a column over the symmetries that keep its load, sums of whole numbers of entries
 * so that what cancels is exactly zero. */
static void average_column(const ph_cell_symmetry *s, int b, ph_sym4 *c)
{
    int times[6][6] = {{0}}, many = 0;
    double mean[6] = {0};
    for (int k = 0; k < s->count; k++) {
        const ph_turn *t = &s->turn[k];
        if (t->place[b] != b) continue;
        many++;
        for (int i = 0; i < s->ns; i++)
            times[t->place[i]][i] += t->flip[i] * t->flip[b];
    }
    for (int i = 0; i < s->ns; i++)
        for (int j = 0; j < s->ns; j++)
            mean[i] += times[i][j] * c->m[j][b];
    for (int i = 0; i < s->ns; i++)
        c->m[i][b] = mean[i] / many;
}

unsigned ph_i_symmetry_complete(const ph_cell_symmetry *s, unsigned solved, ph_sym4 *c)
{
    unsigned there = 0;
    for (int b = 0; b < s->ns; b++) {
        if (!(solved >> b & 1)) continue;
        average_column(s, b, c);
        there |= 1u << b;
        for (int k = 0; k < s->count; k++) {
            const ph_turn *t = &s->turn[k];
            int a = t->place[b];
            if (there >> a & 1) continue;
            for (int i = 0; i < s->ns; i++)
                c->m[t->place[i]][a] = t->flip[i] * t->flip[b] * c->m[i][b];
            there |= 1u << a;
        }
    }
    return there;
}

void ph_i_symmetry_average(const ph_cell_symmetry *s, ph_sym4 *c)
{
    bool done[6][6] = {{false}};
    const ph_sym4 was = *c;
    for (int a = 0; a < s->ns; a++)
        for (int b = a; b < s->ns; b++) {
            double sum = 0.0, known = 0.0;
            if (done[a][b]) continue;
            for (int k = 0; k < s->count; k++) {
                const ph_turn *t = &s->turn[k];
                double v = was.m[t->place[a]][t->place[b]];
                if (isnan(v)) continue;
                sum += t->flip[a] * t->flip[b] * v;
                known++;
            }
            double mean = cancels(s, a, b) ? 0.0 : sum / known; /* NaN: none is known */
            for (int k = 0; k < s->count; k++) {
                const ph_turn *t = &s->turn[k];
                int i = t->place[a], j = t->place[b];
                c->m[i][j] = c->m[j][i] =
                    t->flip[a] * t->flip[b] * mean + 0.0; /* no -0 */
                done[i][j] = done[j][i] = true;
            }
        }
}

void ph_i_symmetry_turn_field(const ph_turn *t, const ph_grid *box, int nd, bool corners,
                              const double *u, double *out)
{
    const ptrdiff_t *n = box->n, cells = ph_grid_cells(box);
    ptrdiff_t x = 0, at[3];
    for (at[0] = 0; at[0] < n[0]; at[0]++)
        for (at[1] = 0; at[1] < n[1]; at[1]++)
            for (at[2] = 0; at[2] < n[2]; at[2]++, x++) {
                ptrdiff_t y = turned_place(t, n, at, corners);
                for (int d = 0; d < nd; d++)
                    out[t->to[d] * cells + y] = t->sign[d] * u[d * cells + x];
            }
}
