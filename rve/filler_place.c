/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where the fillers go: anywhere, in agglomerates, at a distance from each other. */
#include "core/check.h"
#include "fillers.h"

#include <math.h>
#include <string.h>

enum { TRIALS = 200, MAX_SWEEPS = 4000, PATIENCE = 50, MAX_PLACED = 1 << 30 };

ph_status ph_i_grow(void **array, ptrdiff_t count, ptrdiff_t *held, size_t size,
                    const char *what, ph_error *err)
{
    ph_status st = PH_OK;
    if (count < *held) return st;
    ptrdiff_t more = *held ? 2 * *held : 256;
    void *q = realloc(*array, (size_t)more * size);
    PH_CHECK(q, PH_ENOMEM, "no memory for %s (%td x %zu bytes)", what, more, size);
    *array = q;
    *held = more;
out:
    return st;
}

void ph_packing_free(ph_packing **packing)
{
    if (!packing || !*packing) return;
    free((*packing)->kind);
    free((*packing)->filler);
    free((*packing)->solid);
    free((*packing)->point);
    free((*packing)->cluster);
    free(*packing);
    *packing = NULL;
}

/* ---- the index: which solids are near a place ---- */

typedef struct entry {
    ptrdiff_t solid, filler, next;
} entry;

typedef struct finder {
    ptrdiff_t n[3];
    double h[3];
    ptrdiff_t *head; /* [cells] first entry or -1 */
    entry *entry;
    ptrdiff_t nentries, held;
    ptrdiff_t *stamp; /* [solids] number of the last question that met it */
    ptrdiff_t stamps_held, question;
} finder;

static void finder_clear(finder *s)
{
    free(s->head);
    free(s->entry);
    free(s->stamp);
    *s = (finder){0};
}

/* Cells about as large as the largest thickness and gap, but not many more than fillers
 * could fill. */
static ph_status finder_init(finder *s, const ph_i_generator *g, double cell,
                             ph_error *err)
{
    ph_status st = PH_OK;
    int dim = g->p->dimensions;
    ptrdiff_t most = dim == 2 ? 1024 : 128, total = 1;
    for (int a = 0; a < 3; a++) {
        double size = g->grid.size[a];
        s->n[a] =
            a < dim ? (ptrdiff_t)fmin(fmax(floor(size / cell), 1), (double)most) : 1;
        s->h[a] = size / (double)s->n[a];
        total *= s->n[a];
    }
    PH_ALLOC(s->head, total, "the index of the fillers");
    for (ptrdiff_t i = 0; i < total; i++)
        s->head[i] = -1;
out:
    return st;
}

static void finder_empty(finder *s)
{
    for (ptrdiff_t i = 0; i < s->n[0] * s->n[1] * s->n[2]; i++)
        s->head[i] = -1;
    s->nentries = 0;
}

/* A walk over the cells that a solid (grown by `margin`) touches: it is cut across its
 * longest axis into pieces no longer than a cell, whose boxes are walked one by one. */
typedef struct walk {
    const finder *s;
    const ph_solid *solid;
    int dim, axis, piece, pieces;
    double centre[3], margin;
    ptrdiff_t from[3], count[3], at[3];
} walk;

static void walk_piece(walk *w)
{
    const ph_solid *s = w->solid;
    double part = s->half[w->axis] / w->pieces;
    double off = (2 * w->piece + 1 - w->pieces) * part;
    for (int a = 0; a < 3; a++) {
        w->from[a] = 0;
        w->count[a] = 1;
        w->at[a] = 0;
        if (a >= w->dim) continue;
        double reach = w->margin, c = w->centre[a] + off * s->frame[w->axis][a];
        for (int i = 0; i < w->dim; i++)
            reach += fabs(s->frame[i][a]) * (i == w->axis ? part : s->half[i]);
        double lo = floor((c - reach) / w->s->h[a]), hi = floor((c + reach) / w->s->h[a]);
        w->from[a] = (ptrdiff_t)lo;
        w->count[a] = (ptrdiff_t)fmin(hi - lo + 1, (double)w->s->n[a]);
    }
}

static void walk_begin(walk *w, const finder *s, const ph_solid *solid,
                       const double centre[3], double margin, int dim)
{
    *w = (walk){.s = s, .solid = solid, .dim = dim, .margin = margin};
    double cell = INFINITY;
    for (int a = 0; a < dim; a++) {
        w->centre[a] = centre[a] + solid->centre[a];
        cell = fmin(cell, s->h[a]);
        if (solid->half[a] > solid->half[w->axis]) w->axis = a;
    }
    w->pieces = (int)fmin(fmax(ceil(2 * solid->half[w->axis] / cell), 1), 4096);
    walk_piece(w);
}

/* Index of the next cell, or -1. */
static ptrdiff_t walk_next(walk *w)
{
    if (w->at[0] == w->count[0]) {
        if (++w->piece == w->pieces) return -1;
        walk_piece(w);
    }
    ptrdiff_t i[3];
    for (int a = 0; a < 3; a++) {
        ptrdiff_t n = w->s->n[a], k = (w->from[a] + w->at[a]) % n;
        i[a] = k < 0 ? k + n : k;
    }
    for (int a = 2; a >= 0; a--) {
        if (++w->at[a] < w->count[a] || a == 0) break;
        w->at[a] = 0;
    }
    return (i[0] * w->s->n[1] + i[1]) * w->s->n[2] + i[2];
}

static ph_status finder_add(finder *s, const ph_packing *p, ptrdiff_t filler,
                            ph_error *err)
{
    ph_status st = PH_OK;
    const ph_placed *x = &p->filler[filler];
    for (ptrdiff_t k = x->first; k < x->first + x->count; k++) {
        walk w;
        walk_begin(&w, s, &p->solid[k], x->centre, 0, p->dimensions);
        for (ptrdiff_t cell; (cell = walk_next(&w)) >= 0;) {
            if (s->head[cell] >= 0 && s->entry[s->head[cell]].solid == k) continue;
            void *array = s->entry;
            st = ph_i_grow(&array, s->nentries, &s->held, sizeof *s->entry,
                           "the index of the fillers", err);
            s->entry = array;
            if (st != PH_OK) return st;
            s->entry[s->nentries] = (entry){k, filler, s->head[cell]};
            s->head[cell] = s->nentries++;
        }
    }
    return st;
}

static ph_status room_for_stamps(finder *s, const ph_packing *p, ph_error *err)
{
    ph_status st = PH_OK;
    if (p->nsolids <= s->stamps_held) return st;
    ptrdiff_t more = 2 * p->nsolids + 64;
    ptrdiff_t *q = realloc(s->stamp, (size_t)more * sizeof *q);
    PH_CHECK(q, PH_ENOMEM, "no memory for the index of the fillers");
    memset(q + s->stamps_held, 0, (size_t)(more - s->stamps_held) * sizeof *q);
    s->stamp = q;
    s->stamps_held = more;
out:
    return st;
}

/* ---- pairs ---- */

/* Calls of a visitor for every periodic image of solid b that may be nearer to a than `gap`.
 * Returns true as soon as the visitor does. */
typedef struct pair {
    const ph_solid *a, *b;
    double shift[3]; /* from the frame of a's filler to b's: where b's solid stands */
    double gap;
    ptrdiff_t i, j; /* fillers */
} pair;
typedef bool visitor(void *context, const pair *q);

static bool visit_images(const ph_i_generator *g, ptrdiff_t i, ptrdiff_t ka, ptrdiff_t j,
                         ptrdiff_t kb, double gap, visitor *visit, void *context)
{
    const ph_packing *p = g->p;
    const ph_solid *a = &p->solid[ka], *b = &p->solid[kb];
    int from[3] = {0}, to[3] = {0}, k[3];
    double base[3] = {0};
    for (int d = 0; d < p->dimensions; d++) {
        double L = g->grid.size[d];
        base[d] = p->filler[j].centre[d] - p->filler[i].centre[d];
        double delta = base[d] + b->centre[d] - a->centre[d];
        double reach = a->bounds[d] + b->bounds[d] + gap;
        from[d] = (int)ceil((-reach - delta) / L);
        to[d] = (int)floor((reach - delta) / L);
    }
    for (k[0] = from[0]; k[0] <= to[0]; k[0]++)
        for (k[1] = from[1]; k[1] <= to[1]; k[1]++)
            for (k[2] = from[2]; k[2] <= to[2]; k[2]++) {
                if (i == j && k[0] == 0 && k[1] == 0 && k[2] == 0) continue;
                pair q = {.a = a, .b = b, .gap = gap, .i = i, .j = j};
                for (int d = 0; d < 3; d++)
                    q.shift[d] = base[d] + k[d] * g->grid.size[d];
                if (visit(context, &q)) return true;
            }
    return false;
}

static double gap_of(const ph_i_generator *g, ptrdiff_t i, ptrdiff_t j)
{
    return fmax(g->c->fillers[g->p->filler[i].kind].gap,
                g->c->fillers[g->p->filler[j].kind].gap);
}

/* Every pair of solids of filler i with those of the index (and with its own images). */
static bool visit_neighbours(const ph_i_generator *g, finder *s, ptrdiff_t i,
                             double largest_gap, visitor *visit, void *context)
{
    const ph_packing *p = g->p;
    const ph_placed *x = &p->filler[i];
    for (ptrdiff_t k = x->first; k < x->first + x->count; k++) {
        walk w;
        s->question++;
        walk_begin(&w, s, &p->solid[k], x->centre, largest_gap, p->dimensions);
        for (ptrdiff_t cell; (cell = walk_next(&w)) >= 0;)
            for (ptrdiff_t e = s->head[cell]; e >= 0; e = s->entry[e].next) {
                ptrdiff_t j = s->entry[e].filler, b = s->entry[e].solid;
                if (j == i || s->stamp[b] == s->question) continue;
                s->stamp[b] = s->question;
                if (visit_images(g, i, k, j, b, gap_of(g, i, j), visit, context))
                    return true;
            }
        for (ptrdiff_t b = x->first; b < x->first + x->count; b++)
            if (visit_images(g, i, k, i, b, gap_of(g, i, i), visit, context)) return true;
    }
    return false;
}

/* Nearer than the gap, or overlapping? What cannot be told counts as too near. */
static bool too_near(void *context, const pair *q)
{
    ph_packing *p = context;
    p->tests++;
    double tiny = 1e-9 * (q->a->half[0] + q->b->half[0]);
    return ph_solid_distance(q->a, q->b, q->shift, p->dimensions, q->gap + tiny) <
           q->gap + tiny;
}

/* ---- positions ---- */

static double largest_gap(const ph_case *c)
{
    double gap = -1;
    for (int k = 0; k < c->nfillers; k++)
        gap = fmax(gap, c->fillers[k].gap); /* NaN: no gap kept */
    return gap;
}

/* Into the box and onto a lattice of 2^-20 spacings, so that moving the box by whole cells
 * moves every number exactly; counting nodes, onto a node. */
static double snap(const ph_i_generator *g, double x, int a, bool nodes)
{
    double fine = nodes ? 1 : 0x1p20, n = (double)g->grid.n[a];
    double t = x / g->grid.h[a];
    t -= floor(t / n) * n;
    t = nodes ? floor(t) + 0.5 : floor(t * fine) / fine;
    return (t >= n ? t - n : t) * g->grid.h[a];
}

static ph_status draw_clusters(ph_i_generator *g, int k, int *first, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_filler *f = &g->c->fillers[k];
    ph_packing *p = g->p;
    *first = p->nclusters;
    if (f->clusters <= 0) return st;
    size_t bytes = (size_t)(p->nclusters + f->clusters) * sizeof *p->cluster;
    double(*q)[4] = realloc(p->cluster, bytes);
    PH_CHECK(q, PH_ENOMEM, "no memory for agglomerates");
    p->cluster = q;
    for (int i = 0; i < f->clusters; i++) {
        ph_random r = {g->c->seed, g->c->realisation, OBJECT_CLUSTER(k) | (uint64_t)i,
                       DRAW_POSITION};
        double *c = p->cluster[p->nclusters++];
        for (int a = 0; a < 3; a++)
            c[a] = a < p->dimensions ? ph_random_uniform(&r) * g->grid.size[a] : 0;
        c[3] = f->cluster_radius;
    }
out:
    return st;
}

/* Trial `t` for the place of a filler, in its agglomerate or anywhere. */
static void position(const ph_i_generator *g, int k, uint64_t number, int t, int first,
                     ph_placed *x)
{
    const ph_filler *f = &g->c->fillers[k];
    const ph_packing *p = g->p;
    int dim = p->dimensions;
    ph_random r = {g->c->seed, g->c->realisation, OBJECT_KIND(k) | number, DRAW_SHARE};
    bool nodes = p->kind[k].counting == PH_COUNT_NODES;
    double u[3] = {0}, c[3] = {0};
    x->cluster = 0;
    if (f->clusters > 0) {
        bool inside = ph_random_uniform(&r) < f->cluster_share;
        int which = (int)(ph_random_uniform(&r) * f->clusters);
        if (inside) x->cluster = 1 + first + (which < f->clusters ? which : 0);
    }
    r.draw = DRAW_POSITION + (uint64_t)t * 64;
    if (x->cluster) {
        const double *ball = p->cluster[x->cluster - 1];
        for (int tries = 0; tries < 16; tries++) { /* uniform in the ball */
            double n2 = 0;
            for (int a = 0; a < dim; a++) {
                u[a] = 2 * ph_random_uniform(&r) - 1;
                n2 += u[a] * u[a];
            }
            if (n2 <= 1) break;
            u[0] = u[1] = u[2] = 0;
        }
        for (int a = 0; a < dim; a++)
            c[a] = ball[a] + ball[3] * u[a];
    } else {
        for (int a = 0; a < dim; a++)
            c[a] = ph_random_uniform(&r) * g->grid.size[a];
    }
    for (int a = 0; a < dim; a++)
        x->centre[a] = snap(g, c[a], a, nodes);
}

/* ---- the relaxation ---- */

typedef struct push {
    const ph_i_generator *g;
    double (*move)[3], (*turn)[3];
    ptrdiff_t touching;
    bool *stuck;         /* which fillers touch */
    const int *clusters; /* [kinds] first agglomerate of each */
} push;

/* Both fillers of a pair that is too near get half of the missing distance. */
static bool add_push(void *context, const pair *q)
{
    push *w = context;
    const ph_packing *p = w->g->p;
    double n[3], at[3];
    if (q->j < q->i) return false; /* the other one has seen it */
    if (!too_near(w->g->p, q)) return false;
    w->touching++;
    w->stuck[q->i] = w->stuck[q->j] = true;
    double apart = ph_i_separation(q->a, q->b, q->shift, p->dimensions, n, at);
    double slack = 1e-3 * fmin(q->a->half[1], q->b->half[1]);
    double missing = fmax(q->gap + slack - apart, slack) / 2;
    if (q->i == q->j) return false; /* its own image: no move helps, a turn may */
    for (int side = 0; side < 2; side++) {
        ptrdiff_t i = side ? q->j : q->i;
        double arm[3], torque[3], sign = side ? 1 : -1;
        for (int a = 0; a < 3; a++) {
            arm[a] = at[a] - (side ? q->shift[a] : 0);
            w->move[i][a] += sign * missing * n[a];
        }
        ph_i_cross3(arm, n, torque);
        double inertia =
            ph_i_dot3(arm, arm) + p->filler[i].reach * p->filler[i].reach / 3;
        for (int a = 0; a < 3; a++)
            w->turn[i][a] += sign * missing * torque[a] / inertia;
    }
    return false;
}

static void rotate(const double axis[3], double angle, double v[3])
{
    double c = cos(angle), s = sin(angle), w[3], along = ph_i_dot3(axis, v);
    ph_i_cross3(axis, v, w);
    for (int a = 0; a < 3; a++)
        v[a] = c * v[a] + s * w[a] + (1 - c) * along * axis[a];
}

static void turn_filler(ph_packing *p, ptrdiff_t i, const double turn[3])
{
    ph_placed *x = &p->filler[i];
    double angle = sqrt(ph_i_dot3(turn, turn));
    if (angle < 1e-12) return;
    double axis[3] = {turn[0] / angle, turn[1] / angle, turn[2] / angle};
    angle = fmin(angle, 0.1);
    for (int k = 0; k < 3; k++)
        rotate(axis, angle, x->frame[k]);
    for (ptrdiff_t k = x->first; k < x->first + x->count; k++) {
        ph_solid *s = &p->solid[k];
        rotate(axis, angle, s->centre);
        for (int r = 0; r < 3; r++)
            rotate(axis, angle, s->frame[r]);
        ph_i_solid_finish(s);
    }
}

static void apply(const push *w)
{
    const ph_i_generator *g = w->g;
    ph_packing *p = g->p;
    for (ptrdiff_t i = 0; i < p->n; i++) {
        ph_placed *x = &p->filler[i];
        const ph_filler *f = &g->c->fillers[x->kind];
        bool nodes = p->kind[x->kind].counting == PH_COUNT_NODES;
        double *m = w->move[i], length = sqrt(ph_i_dot3(m, m));
        if (isnan(f->gap)) continue;
        double most = 0.5 * fmax(x->thickness, g->spacing);
        for (int a = 0; a < p->dimensions; a++)
            x->centre[a] = snap(
                g, x->centre[a] + m[a] * (length > most ? most / length : 1), a, nodes);
        /* only where orientation is free, and no drawn node has to follow */
        if (f->orientation == PH_ORIENT_UNIFORM && x->length > x->thickness && !nodes)
            turn_filler(p, i, w->turn[i]);
    }
}

/* Fillers that cross, or block each other, move to free places where trials find some. */
static ph_status place_anew(const push *w, finder *s, double gap, int sweep,
                            ph_error *err)
{
    ph_status st = PH_OK;
    const ph_i_generator *g = w->g;
    ph_packing *p = g->p;
    for (ptrdiff_t i = 0; i < p->n; i++) {
        ph_placed *x = &p->filler[i], old = *x;
        bool found = false;
        if (!w->stuck[i]) continue;
        for (int t = 0; t < TRIALS && !found; t++) {
            position(g, x->kind, x->number, TRIALS * (sweep + 1) + t,
                     w->clusters[x->kind], x);
            found = !visit_neighbours(g, s, i, gap, too_near, g->p);
        }
        if (found)
            PH_TRY(finder_add(s, p, i, err));
        else
            *x = old;
    }
out:
    return st;
}

static ph_status relax(ph_i_generator *g, finder *s, double gap, const int *clusters,
                       int *sweeps, ph_error *err)
{
    ph_status st = PH_OK;
    ph_packing *p = g->p;
    push w = {.g = g, .clusters = clusters};
    ptrdiff_t best = PTRDIFF_MAX; /* fewest pairs that touched, and when */
    int since = 0;
    PH_ALLOC(w.move, p->n, "the moves of the fillers");
    PH_ALLOC(w.turn, p->n, "the turns of the fillers");
    PH_ALLOC(w.stuck, p->n, "the fillers that touch");
    for (*sweeps = 1; *sweeps <= MAX_SWEEPS; ++*sweeps) {
        finder_empty(s);
        for (ptrdiff_t i = 0; i < p->n; i++)
            if (!isnan(g->c->fillers[p->filler[i].kind].gap))
                PH_TRY(finder_add(s, p, i, err));
        memset(w.move, 0, (size_t)p->n * sizeof *w.move);
        memset(w.turn, 0, (size_t)p->n * sizeof *w.turn);
        memset(w.stuck, 0, (size_t)p->n * sizeof *w.stuck);
        w.touching = 0;
        for (ptrdiff_t i = 0; i < p->n; i++)
            if (!isnan(g->c->fillers[p->filler[i].kind].gap))
                (void)visit_neighbours(g, s, i, gap, add_push, &w);
        if (w.touching == 0) break;
        if (w.touching < best) best = w.touching, since = *sweeps;
        if (*sweeps - since >= PATIENCE) {
            PH_TRY(place_anew(&w, s, gap, *sweeps, err));
            best = PTRDIFF_MAX;
            since = *sweeps;
        } else {
            apply(&w);
        }
    }
    PH_CHECK(w.touching == 0, PH_EUNPHYSICAL,
             "jammed: %td pairs still nearer than the gap", w.touching);
out:
    free(w.move);
    free(w.turn);
    free(w.stuck);
    return st;
}

/* ---- one kind of filler ---- */

/* Volume fraction asked for; NaN for a count. Weight to volume with every filler that is
 * given by weight: v_i = (w_i / rho_i) / (sum_j w_j / rho_j + (1 - sum_j w_j) / rho_m). */
static double target_fraction(const ph_case *c, int k)
{
    const ph_filler *f = &c->fillers[k];
    double weights = 0, volumes = 0;
    if (f->amount == PH_AMOUNT_COUNT) return NAN;
    if (f->amount == PH_AMOUNT_VOLUME) return f->amount_value;
    for (int i = 0; i < c->nfillers; i++) {
        const ph_filler *g = &c->fillers[i];
        if (g->amount != PH_AMOUNT_WEIGHT) continue;
        weights += g->amount_value;
        volumes += g->amount_value / c->materials[g->material].density;
    }
    volumes += (1 - weights) / c->materials[c->matrix].density;
    return f->amount_value / c->materials[f->material].density / volumes;
}

static double box_content(const ph_i_generator *g, ph_counting counting)
{
    const double *L = g->grid.size;
    if (counting == PH_COUNT_NODES) return (double)ph_grid_cells(&g->grid);
    return L[0] * L[1] * (g->p->dimensions == 3 ? L[2] : 1);
}

static ph_status check_length(const ph_i_generator *g, const ph_placed *x, ph_error *err)
{
    ph_status st = PH_OK;
    double box = fmin(g->grid.size[0], g->grid.size[1]);
    if (g->p->dimensions == 3) box = fmin(box, g->grid.size[2]);
    PH_CHECK(
        x->length <= box, PH_EUNPHYSICAL,
        "a filler of length %g is longer than the box (%g): enlarge size, or cut the "
        "distribution with max",
        x->length, box);
out:
    return st;
}

/* Is there content left for the last filler? */
static bool wanted(const ph_i_generator *g, int k)
{
    const ph_filler_report *r = &g->p->kind[k];
    const ph_placed *x = &g->p->filler[g->p->n - 1];
    if (isnan(r->target)) return r->count < (ptrdiff_t)g->c->fillers[k].amount_value;
    double box = box_content(g, r->counting);
    return r->reached * box + x->content / 2 <= r->target * box * (1 + 1e-12);
}

typedef struct placing {
    finder s;
    double gap;    /* largest of all kinds; negative: none is kept */
    double rsa;    /* content that random addition reached, over the box */
    int *clusters; /* [kinds] first agglomerate of each */
    bool jammed;   /* of the present kind: place the rest anywhere and relax */
} placing;

static ph_status place_last(ph_i_generator *g, placing *w, int k, uint64_t number,
                            int clusters, ph_error *err)
{
    ph_status st = PH_OK;
    ph_packing *p = g->p;
    ph_placed *x = &p->filler[p->n - 1];
    position(g, k, number, 0, clusters, x);
    if (isnan(g->c->fillers[k].gap)) goto out;
    PH_TRY(room_for_stamps(&w->s, p, err));
    bool free_place = false;
    for (int t = 0; t < (w->jammed ? 1 : TRIALS) && !free_place; t++) {
        position(g, k, number, t, clusters, x);
        free_place = !visit_neighbours(g, &w->s, p->n - 1, w->gap, too_near, p);
    }
    if (free_place && !w->jammed) {
        w->rsa = p->kind[k].reached;
    } else {
        p->kind[k].relaxed += !free_place; /* some may fail before room is short */
        w->jammed = p->kind[k].relaxed > 10 + p->kind[k].count / 20;
    }
    PH_TRY(finder_add(&w->s, p, p->n - 1, err));
out:
    return st;
}

static ph_status place_kind(ph_i_generator *g, placing *w, int k, ph_error *err)
{
    ph_status st = PH_OK;
    ph_packing *p = g->p;
    ph_filler_report *r = &p->kind[k];
    double map[9];
    w->jammed = false;
    r->target = target_fraction(g->c, k);
    ph_i_tensor_map(&g->c->fillers[k], p->dimensions, map);
    PH_TRY(draw_clusters(g, k, &w->clusters[k], err));
    for (uint64_t number = 0;; number++) {
        PH_CHECK(p->n < MAX_PLACED, PH_EUNPHYSICAL, "more than 2^30 fillers");
        PH_TRY(ph_i_draw_filler(g, k, map, number, err));
        if (!wanted(g, k)) {
            ph_i_drop_filler(p);
            break;
        }
        PH_TRY(check_length(g, &p->filler[p->n - 1], err));
        PH_TRY(place_last(g, w, k, number, w->clusters[k], err));
        double content = p->filler[p->n - 1].content / box_content(g, r->counting);
        r->reached += content;
        r->largest = fmax(r->largest, content);
        r->count++;
    }
    if (r->relaxed > 0) PH_TRY(relax(g, &w->s, w->gap, w->clusters, &r->sweeps, err));
out:
    if (st == PH_EUNPHYSICAL && r->sweeps > MAX_SWEEPS)
        ph_error_prefix(err,
                        "no room: random addition reached the fraction %.4g of %.4g, and "
                        "pushing the fillers apart did not make room for more: ",
                        w->rsa, r->reached);
    return st;
}

static void orientation_tensors(ph_packing *p, const ph_case *c)
{
    for (ptrdiff_t i = 0; i < p->n; i++) {
        const ph_placed *x = &p->filler[i];
        ph_filler_report *r = &p->kind[x->kind];
        bool sheet =
            p->dimensions == 3 && strcmp(c->fillers[x->kind].shape, "platelet") == 0;
        const double *d = x->frame[sheet ? 1 : 0];
        for (int a = 0; a < 9; a++)
            r->tensor[a] += d[a / 3] * d[a % 3] / (double)r->count;
    }
}

ph_status ph_rve_place(const ph_case *c, ph_packing **out, ph_error *err)
{
    PH_GIVEN(c && out);
    ph_status st = PH_OK;
    placing w = {.gap = largest_gap(c)};
    ph_i_generator g = {.c = c};
    int k = 0;
    *out = NULL;
    PH_TRY(ph_grid_init(&g.grid, c->kinematics, c->drawn_on[0] ? c->drawn_on : c->nodes,
                        c->size, err));
    PH_ALLOC(g.p, 1, "the fillers");
    g.p->dimensions = c->kinematics == PH_SPACE ? 3 : 2;
    g.p->nkinds = c->nfillers;
    g.p->grid = g.grid;
    PH_ALLOC(g.p->kind, c->nfillers, "the fillers");
    PH_ALLOC(w.clusters, c->nfillers, "the agglomerates");
    g.spacing = fmin(g.grid.h[0], g.grid.h[1]);
    if (g.p->dimensions == 3) g.spacing = fmin(g.spacing, g.grid.h[2]);
    double cell = g.spacing;
    for (k = 0; k < c->nfillers; k++) {
        const ph_filler *f = &c->fillers[k];
        const ph_distribution *d = f->size.kind >= 0 ? &f->size : &f->thickness;
        cell = fmax(cell, 2 * ph_distribution_mean(d, NULL) + fmax(w.gap, 0));
    }
    PH_TRY(finder_init(&w.s, &g, cell, err));
    for (k = 0; k < c->nfillers; k++)
        PH_TRY(place_kind(&g, &w, k, err));
    orientation_tensors(g.p, c);
    *out = g.p;
    g.p = NULL;
out:
    if (st != PH_OK && k < c->nfillers)
        ph_error_prefix(err, "%s:%d: microstructure.fillers[%d]: ", c->path,
                        c->fillers[k].line, k);
    finder_clear(&w.s);
    free(w.clusters);
    ph_packing_free(&g.p);
    return st;
}
