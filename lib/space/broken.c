/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "space/broken.h"

#include <string.h>

enum { FIRST_ROOM = 256 };

static void count_bytes(ph_broken *br, size_t bytes)
{
    if (br->meter) {
        br->meter->bytes += bytes - br->bytes;
        if (br->meter->bytes > br->meter->peak) br->meter->peak = br->meter->bytes;
    }
    br->bytes = bytes;
}

static ph_status find_mirrors(ph_broken *br, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_family *f = br->family;
    ptrdiff_t span[3], size = 1, *place = NULL;
    for (int d = 0; d < 3; d++)
        size *= span[d] = 2 * f->reach[d] + 1;
    PH_ALLOC(place, size, "opposite bonds");
    PH_ALLOC(br->mirror, f->count, "opposite bonds");
    for (int pass = 0; pass < 2; pass++)
        for (ptrdiff_t b = 0; b < f->count; b++) {
            ptrdiff_t at = 0;
            for (int d = 0; d < 3; d++)
                at = at * span[d] + f->reach[d] +
                     (pass ? -f->offset[b][d] : f->offset[b][d]);
            if (pass == 0)
                place[at] = b + 1;
            else
                br->mirror[b] = place[at] - 1;
            PH_ASSERT(pass == 0 || br->mirror[b] >= 0);
        }
out:
    free(place);
    return st;
}

ph_status ph_i_broken_new(const ph_grid *box, const ph_family *family, ph_meter *meter,
                          ph_broken **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_broken *br = NULL;
    *out = NULL;
    PH_CHECK(family && family->points != PH_POINTS_STRESS, PH_EINVAL,
             "bonds break between nodes: stress points and model local have none");
    PH_CHECK(ph_grid_cells(box) < INT32_MAX, PH_EINVAL, "%td nodes are too many",
             ph_grid_cells(box));
    PH_ALLOC(br, 1, "broken bonds");
    br->family = family;
    br->meter = meter;
    memcpy(br->n, box->n, sizeof br->n);
    br->words = (family->count + 63) / 64;
    PH_TRY(find_mirrors(br, err));
    *out = br;
    br = NULL;
out:
    ph_i_broken_free(&br);
    return st;
}

void ph_i_broken_free(ph_broken **broken)
{
    if (!broken || !*broken) return;
    ph_broken *br = *broken;
    count_bytes(br, 0);
    free(br->mirror);
    free(br->node);
    free(br->bits);
    free(br->fresh);
    free(br->slot);
    free(br->recent);
    free(br);
    *broken = NULL;
}

/* ---- where a node is --------------------------------------------------------------------- */

/* Slot of a node, or the empty one where it would go. Fibonacci hashing, linear probing. */
static ptrdiff_t probe(const ph_broken *br, ptrdiff_t node)
{
    uint64_t hash = (uint64_t)node * UINT64_C(0x9E3779B97F4A7C15);
    ptrdiff_t s = (ptrdiff_t)((hash >> 32) & (uint64_t)(br->slots - 1));
    while (br->slot[s] >= 0 && br->node[br->slot[s]] != node)
        s = (s + 1) & (br->slots - 1);
    return s;
}

static void fill_slots(ph_broken *br)
{
    for (ptrdiff_t s = 0; s < br->slots; s++)
        br->slot[s] = -1;
    for (ptrdiff_t i = 0; i < br->damaged; i++)
        br->slot[probe(br, br->node[i])] = (int32_t)i;
}

ptrdiff_t ph_i_broken_place(const ph_broken *br, ptrdiff_t node)
{
    return br->slots ? br->slot[probe(br, node)] : -1;
}

static ph_status grow(ph_broken *br, ph_error *err)
{
    ph_status st = PH_OK;
    ptrdiff_t room = br->room ? 2 * br->room : FIRST_ROOM;
    size_t n = (size_t)room, word = (size_t)br->words * sizeof *br->bits;
    void *p = realloc(br->node, n * sizeof *br->node);
    if (p) br->node = p;
    void *q = realloc(br->bits, n * word);
    if (q) br->bits = q;
    void *r = realloc(br->fresh, n);
    if (r) br->fresh = r;
    void *s = realloc(br->slot, 2 * n * sizeof *br->slot);
    if (s) br->slot = s;
    PH_CHECK(p && q && r && s, PH_ENOMEM, "no memory for %td damaged nodes", room);
    br->room = room;
    br->slots = 2 * room;
    fill_slots(br);
    count_bytes(br, n * (sizeof *br->node + word + 1 + 2 * sizeof *br->slot));
out:
    return st;
}

static ph_status place_for(ph_broken *br, ptrdiff_t node, ptrdiff_t *place, ph_error *err)
{
    ph_status st = PH_OK;
    *place = ph_i_broken_place(br, node);
    if (*place >= 0) return PH_OK;
    if (br->damaged == br->room) PH_TRY(grow(br, err));
    *place = br->damaged++;
    br->node[*place] = (int32_t)node;
    br->fresh[*place] = 0;
    memset(br->bits + *place * br->words, 0, (size_t)br->words * sizeof *br->bits);
    br->slot[probe(br, node)] = (int32_t)*place;
out:
    return st;
}

ptrdiff_t ph_i_broken_end(const ph_broken *br, ptrdiff_t node, ptrdiff_t b)
{
    const ptrdiff_t *n = br->n;
    ptrdiff_t at[3] = {node / n[2] / n[1], node / n[2] % n[1], node % n[2]}, y = 0;
    for (int d = 0; d < 3; d++) {
        ptrdiff_t i = (at[d] + br->family->offset[b][d]) % n[d];
        y = y * n[d] + (i < 0 ? i + n[d] : i);
    }
    return y;
}

static ph_status remember(ph_broken *br, ptrdiff_t node, ptrdiff_t b, ph_error *err)
{
    ph_status st = PH_OK;
    if (br->nrecent == br->recent_room) {
        ptrdiff_t room = br->recent_room ? 2 * br->recent_room : FIRST_ROOM;
        void *p = realloc(br->recent, (size_t)room * sizeof *br->recent);
        PH_CHECK(p, PH_ENOMEM, "no memory for %td broken bonds", room);
        br->recent = p;
        br->recent_room = room;
    }
    br->recent[br->nrecent++] = (ph_fresh_bond){(int32_t)node, (int32_t)b};
out:
    return st;
}

ph_status ph_i_break(ph_broken *br, ptrdiff_t node, ptrdiff_t b, ph_error *err)
{
    ph_status st = PH_OK;
    ptrdiff_t other = ph_i_broken_end(br, node, b), place;
    PH_TRY(place_for(br, node, &place, err));
    if (ph_i_is_broken(br, place, b)) return PH_OK;
    PH_TRY(remember(br, node, b, err));
    for (int end = 0; end < 2; end++) {
        ptrdiff_t bond = end ? br->mirror[b] : b;
        if (end) PH_TRY(place_for(br, other, &place, err));
        br->bits[place * br->words + bond / 64] |= UINT64_C(1) << (bond % 64);
        br->fresh[place] = 1;
    }
    br->pairs++;
out:
    return st;
}

void ph_i_broken_heal(ph_broken *br)
{
    br->damaged = br->pairs = 0;
    br->healed = true;
    if (br->slots) fill_slots(br);
}

/* ---- order ------------------------------------------------------------------------------- */

typedef struct moved {
    int32_t node, from;
} moved;

static int by_node(const void *a, const void *b)
{
    int32_t x = ((const moved *)a)->node, y = ((const moved *)b)->node;
    return (x > y) - (x < y);
}

ph_status ph_i_broken_settle(ph_broken *br, ph_error *err)
{
    ph_status st = PH_OK;
    moved *order = NULL;
    uint64_t *bits = NULL;
    uint8_t *fresh = NULL;
    bool sorted = true;
    for (ptrdiff_t i = 1; i < br->damaged && sorted; i++)
        sorted = br->node[i - 1] < br->node[i];
    if (sorted) return PH_OK;
    PH_ALLOC(order, br->damaged, "the order of the damaged nodes");
    PH_ALLOC(bits, br->room * br->words, "broken bonds");
    PH_ALLOC(fresh, br->room, "broken bonds");
    for (ptrdiff_t i = 0; i < br->damaged; i++)
        order[i] = (moved){br->node[i], (int32_t)i};
    qsort(order, (size_t)br->damaged, sizeof *order, by_node);
    size_t word = (size_t)br->words * sizeof *bits;
    for (ptrdiff_t i = 0; i < br->damaged; i++) {
        memcpy(bits + i * br->words, br->bits + order[i].from * br->words, word);
        fresh[i] = br->fresh[order[i].from];
        br->node[i] = order[i].node;
    }
    free(br->bits);
    free(br->fresh);
    br->bits = bits;
    br->fresh = fresh;
    bits = NULL;
    fresh = NULL;
    fill_slots(br);
out:
    free(order);
    free(bits);
    free(fresh);
    return st;
}

void ph_i_broken_seen(ph_broken *br)
{
    if (br->damaged) memset(br->fresh, 0, (size_t)br->damaged);
    br->nrecent = 0;
    br->healed = false;
}

double ph_i_broken_damage(const ph_broken *br, ptrdiff_t place)
{
    double lost = 0.0, all = 0.0;
    for (ptrdiff_t b = 0; b < br->family->count; b++) {
        all += br->family->w[b];
        if (ph_i_is_broken(br, place, b)) lost += br->family->w[b];
    }
    return lost / all;
}

/* ---- shape tensors ----------------------------------------------------------------------- */

/* A pivot of K below this share of its trace is round-off. Two bonds of a lattice that are
 * not parallel span a parallelogram of at least one cell: K of weights of one size has
 * eigenvalue ratios of at least 1/(4 m^4) in the plane, 1/(27 m^6) in space (1e-7 for m = 8),
 * and exactly parallel ones leave some 1e-16. As in the bond lists. */
static const double singular = 1e-10;

static const int place[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};

/* Inverse of a symmetric positive matrix on the active axes; false: singular. */
static bool invert(const bool active[3], const double K[6], double inverse[6])
{
    double a[3][3], r[3][3] = {{0}}, trace = K[0] + K[1] + K[2];
    memset(inverse, 0, sizeof(double) * 6);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            a[i][j] = K[place[i][j]];
            r[i][j] = active[i] && i == j ? 1.0 : 0.0;
        }
    for (int i = 0; i < 3; i++) {
        if (!active[i]) continue;
        double pivot = a[i][i];
        if (!(pivot > singular * trace)) return false;
        for (int j = 0; j < 3; j++)
            a[i][j] /= pivot, r[i][j] /= pivot;
        for (int k = 0; k < 3; k++) {
            double f = a[k][i];
            if (k == i || !active[k]) continue;
            for (int j = 0; j < 3; j++)
                a[k][j] -= f * a[i][j], r[k][j] -= f * r[i][j];
        }
    }
    for (int i = 0; i < 3; i++)
        for (int j = i; j < 3; j++)
            inverse[place[i][j]] = 0.5 * (r[i][j] + r[j][i]);
    return true;
}

bool ph_i_broken_shape(const ph_broken *br, ptrdiff_t at, double inverse[6])
{
    const ph_family *f = br->family;
    double K[6] = {0};
    for (ptrdiff_t b = 0; b < f->count; b++) {
        if (at >= 0 && ph_i_is_broken(br, at, b)) continue;
        for (int r = 0; r < 3; r++)
            for (int c = r; c < 3; c++)
                K[place[r][c]] += f->w[b] * f->xi[b][r] * f->xi[b][c];
    }
    if (invert(f->active, K, inverse)) return true;
    memset(inverse, 0, sizeof(double) * 6);
    return false;
}
