/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Statistics of single fillers: neighbours, clusters, percolation, agglomerates. */
#include "core/check.h"
#include "statistics.h"

#include <math.h>
#include <string.h>

ptrdiff_t ph_i_beside(const ph_grid *g, const ptrdiff_t at[3], const int step[3])
{
    ptrdiff_t i[3];
    for (int a = 0; a < 3; a++)
        i[a] = (at[a] + step[a] + g->n[a]) % g->n[a];
    return (i[0] * g->n[1] + i[1]) * g->n[2] + i[2];
}

static void place_of(const ph_grid *g, ptrdiff_t cell, ptrdiff_t at[3])
{
    at[0] = cell / g->n[2] / g->n[1];
    at[1] = cell / g->n[2] % g->n[1];
    at[2] = cell % g->n[2];
}

/* Step k of the 27 (9 in 2D) to neighbours, corners too; false for the cell itself. */
static bool step_of(int k, int dim, int step[3])
{
    step[0] = k % 3 - 1;
    step[1] = k / 3 % 3 - 1;
    step[2] = dim == 3 ? k / 9 - 1 : 0;
    return step[0] || step[1] || step[2];
}

/* Each connected region is walked with coordinates that do not wrap: a cell that is met
 * again with other ones has been reached round the box. */
ph_status ph_i_percolation(const ph_grid *g, const uint8_t *filler, ph_statistics *s,
                           ph_error *err)
{
    ph_status st = PH_OK;
    ptrdiff_t cells = ph_grid_cells(g), *stack = NULL;
    int32_t(*turns)[3] = NULL; /* how often the way to a cell went round the box */
    uint8_t *seen = NULL;
    int steps = s->dimensions == 3 ? 27 : 9;
    PH_ALLOC(stack, cells, "the connected regions");
    PH_ALLOC(turns, cells, "the connected regions");
    PH_ALLOC(seen, cells, "the connected regions");
    for (ptrdiff_t c = 0; c < cells; c++) {
        ptrdiff_t n = 0;
        if (!filler[c] || seen[c]) continue;
        seen[c] = 1;
        stack[n++] = c;
        while (n > 0) {
            ptrdiff_t now = stack[--n], at[3];
            place_of(g, now, at);
            for (int k = 0, step[3]; k < steps; k++) {
                int32_t t[3];
                if (!step_of(k, s->dimensions, step)) continue;
                ptrdiff_t next = ph_i_beside(g, at, step);
                if (!filler[next]) continue;
                for (int a = 0; a < 3; a++) {
                    ptrdiff_t x = at[a] + step[a];
                    t[a] = turns[now][a] + (x >= g->n[a]) - (x < 0);
                }
                if (!seen[next]) {
                    seen[next] = 1;
                    memcpy(turns[next], t, sizeof t);
                    stack[n++] = next;
                }
                for (int a = 0; a < s->dimensions; a++)
                    s->percolates[a] |= turns[next][a] != t[a];
            }
        }
    }
out:
    free(stack);
    free(turns);
    free(seen);
    return st;
}

/* ---- clusters ---- */

static ptrdiff_t root(ptrdiff_t *parent, ptrdiff_t i)
{
    while (parent[i] != i)
        i = parent[i] = parent[parent[i]];
    return i;
}

static ph_status clusters(const ph_microstructure *m, const ph_packing *p,
                          ph_statistics *s, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_grid *g = &m->grid;
    ptrdiff_t *parent = NULL, *members = NULL, cells = ph_grid_cells(g), at[3];
    int steps = s->dimensions == 3 ? 27 : 9;
    PH_ALLOC(parent, p->n, "the clusters");
    PH_ALLOC(members, p->n, "the clusters");
    for (ptrdiff_t i = 0; i < p->n; i++)
        parent[i] = i;
    for (ptrdiff_t c = 0; c < cells; c++) {
        if (m->owner[c] <= 0) continue;
        place_of(g, c, at);
        for (int k = 0, step[3]; k < steps; k++) {
            if (!step_of(k, s->dimensions, step)) continue;
            int32_t other = m->owner[ph_i_beside(g, at, step)];
            if (other > 0 && other != m->owner[c])
                parent[root(parent, m->owner[c] - 1)] = root(parent, other - 1);
        }
    }
    for (ptrdiff_t i = 0; i < p->n; i++) {
        ptrdiff_t r = root(parent, i);
        s->clusters += r == i;
        if (++members[r] > s->largest) s->largest = members[r];
    }
out:
    free(parent);
    free(members);
    return st;
}

/* ---- nearest neighbours: centres sorted into buckets, rings of buckets searched ---- */

typedef struct buckets {
    ptrdiff_t n[3], *head, *next;
    double h[3], smallest;
} buckets;

static void bucket_of(const buckets *b, const double x[3], ptrdiff_t at[3])
{
    for (int a = 0; a < 3; a++) {
        ptrdiff_t i = (ptrdiff_t)floor(x[a] / b->h[a]);
        at[a] = i < 0 ? 0 : i >= b->n[a] ? b->n[a] - 1 : i;
    }
}

static ph_status buckets_init(buckets *b, const ph_grid *g, const ph_packing *p,
                              ph_error *err)
{
    ph_status st = PH_OK;
    double per_axis = floor(pow((double)p->n, 1.0 / p->dimensions));
    ptrdiff_t at[3], total = 1;
    b->smallest = INFINITY;
    for (int a = 0; a < 3; a++) {
        b->n[a] = a < p->dimensions ? (ptrdiff_t)fmax(per_axis, 1) : 1;
        b->h[a] = g->size[a] / (double)b->n[a];
        if (a < p->dimensions) b->smallest = fmin(b->smallest, b->h[a]);
        total *= b->n[a];
    }
    PH_ALLOC(b->head, total, "the neighbours");
    PH_ALLOC(b->next, p->n, "the neighbours");
    for (ptrdiff_t i = 0; i < p->n; i++) { /* heads hold index + 1 */
        bucket_of(b, p->filler[i].centre, at);
        ptrdiff_t *head = &b->head[(at[0] * b->n[1] + at[1]) * b->n[2] + at[2]];
        b->next[i] = *head;
        *head = i + 1;
    }
out:
    return st;
}

static double distance(const ph_grid *g, const ph_packing *p, ptrdiff_t i, ptrdiff_t j)
{
    double r2 = 0;
    for (int a = 0; a < p->dimensions; a++) {
        double d = fabs(p->filler[i].centre[a] - p->filler[j].centre[a]);
        d = fmin(d, g->size[a] - d);
        r2 += d * d;
    }
    return sqrt(r2);
}

/* Buckets at the ring distance `ring` from that of filler i. */
static double search_ring(const ph_grid *g, const ph_packing *p, const buckets *b,
                          ptrdiff_t i, ptrdiff_t ring, double best)
{
    ptrdiff_t at[3], d[3], r2 = p->dimensions == 3 ? ring : 0;
    bucket_of(b, p->filler[i].centre, at);
    for (d[0] = -ring; d[0] <= ring; d[0]++)
        for (d[1] = -ring; d[1] <= ring; d[1]++)
            for (d[2] = -r2; d[2] <= r2; d[2]++) {
                ptrdiff_t c[3], far = 0;
                for (int a = 0; a < 3; a++) {
                    far = d[a] > far ? d[a] : -d[a] > far ? -d[a] : far;
                    c[a] = ((at[a] + d[a]) % b->n[a] + b->n[a]) % b->n[a];
                }
                if (far != ring) continue;
                ptrdiff_t j = b->head[(c[0] * b->n[1] + c[1]) * b->n[2] + c[2]];
                for (; j > 0; j = b->next[j - 1])
                    if (j - 1 != i) best = fmin(best, distance(g, p, i, j - 1));
            }
    return best;
}

static ph_status neighbours(const ph_grid *g, const ph_packing *p, ph_statistics *s,
                            ph_error *err)
{
    ph_status st = PH_OK;
    buckets b = {.head = NULL};
    double sum = 0, squares = 0, n = (double)p->n;
    s->nearest_mean = s->nearest_std = s->nearest_min = NAN;
    if (p->n < 2) return st;
    PH_TRY(buckets_init(&b, g, p, err));
    s->nearest_min = INFINITY;
    ptrdiff_t most = b.n[0] > b.n[1] ? b.n[0] : b.n[1];
    for (ptrdiff_t i = 0; i < p->n; i++) {
        double best = INFINITY;
        for (ptrdiff_t r = 0; r <= most && best > (double)(r - 1) * b.smallest; r++)
            best = search_ring(g, p, &b, i, r, best);
        sum += best;
        squares += best * best;
        s->nearest_min = fmin(s->nearest_min, best);
    }
    s->nearest_mean = sum / n;
    s->nearest_std = sqrt(fmax(squares / n - sum * sum / n / n, 0));
out:
    free(b.head);
    free(b.next);
    return st;
}

/* xi = V_agglomerates / V and zeta = V_filler in them / V_filler [Shi2004], by cells. */
static ph_status agglomerates(const ph_grid *g, const ph_packing *p,
                              const uint8_t *filler, ph_statistics *s, ph_error *err)
{
    ph_status st = PH_OK;
    uint8_t *inside = NULL;
    ptrdiff_t cells = ph_grid_cells(g), in = 0, both = 0, all = 0;
    s->agglomerate_volume = s->agglomerate_share = 0;
    if (p->nclusters == 0) return st;
    PH_ALLOC(inside, cells, "the agglomerates");
    for (int b = 0; b < p->nclusters; b++) {
        const double *ball = p->cluster[b];
        ptrdiff_t from[3] = {0}, count[3] = {1, 1, 1}, i[3];
        for (int a = 0; a < p->dimensions; a++) {
            from[a] = (ptrdiff_t)floor((ball[a] - ball[3]) / g->h[a]);
            ptrdiff_t to = (ptrdiff_t)floor((ball[a] + ball[3]) / g->h[a]) + 1;
            count[a] = to - from[a];
        }
        for (i[0] = 0; i[0] < count[0]; i[0]++)
            for (i[1] = 0; i[1] < count[1]; i[1]++)
                for (i[2] = 0; i[2] < count[2]; i[2]++) {
                    double r2 = 0;
                    ptrdiff_t c[3];
                    for (int a = 0; a < 3; a++) {
                        ptrdiff_t k = from[a] + i[a];
                        c[a] = (k % g->n[a] + g->n[a]) % g->n[a];
                        if (a < p->dimensions)
                            r2 += pow(((double)k + 0.5) * g->h[a] - ball[a], 2);
                    }
                    if (r2 <= ball[3] * ball[3])
                        inside[(c[0] * g->n[1] + c[1]) * g->n[2] + c[2]] = 1;
                }
    }
    for (ptrdiff_t c = 0; c < cells; c++) {
        in += inside[c];
        all += filler[c];
        both += inside[c] && filler[c];
    }
    s->agglomerate_volume = (double)in / (double)cells;
    s->agglomerate_share = all > 0 ? (double)both / (double)all : 0;
out:
    free(inside);
    return st;
}

ph_status ph_i_filler_statistics(const ph_microstructure *m, const ph_packing *p,
                                 const uint8_t *filler, ph_statistics *s, ph_error *err)
{
    ph_status st = PH_OK;
    s->nearest_mean = s->nearest_std = s->nearest_min = NAN;
    if (!p || !m->owner) return st;
    s->fillers = p->n;
    PH_TRY(clusters(m, p, s, err));
    PH_TRY(neighbours(&m->grid, p, s, err));
    PH_TRY(agglomerates(&m->grid, p, filler, s, err));
out:
    return st;
}
