/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effective/patch.h"

#include <math.h>
#include <string.h>

enum { OUTSIDE, FEELS, MOVES, BREAKS };

/* Nodes whose bonds break at up to so many times the least load are in the middle of the
 * patch. */
static const double about_to_break = 1.2;
/* A patch that is a larger part of the box saves nothing. */
static const double most_of_box = 0.25;
/* Loose pieces within a patch: the part of the largest diagonal entry that holds them. */
static const double hold = 1e-10;
/* A bond that broke carried all but this share of what holds its ends. */
static const double loose = 1e-6;

/* ---- making ------------------------------------------------------------------------------ */

ph_status ph_i_patch_new(ph_run *r, ph_patch **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_patch *p = NULL;
    ptrdiff_t cells = r->op->layout.cells;
    int reach = 0;
    PH_ALLOC(p, 1, "a patch");
    p->run = r;
    PH_ALLOC(p->part, cells, "a patch");
    PH_ALLOC(p->unknown, r->op->layout.nd * cells, "a patch");
    PH_ALLOC(p->node, cells, "a patch");
    for (ptrdiff_t i = 0; i < r->op->layout.nd * cells; i++)
        p->unknown[i] = -1;
    for (int d = 0; d < 3; d++)
        if (r->family->reach[d] > reach) reach = (int)r->family->reach[d];
    bool space = r->result->grid.kinematics == PH_SPACE;
    p->reach = (space ? 2 : 4) * reach;
    p->most = space ? 1000 : 2000;
    *out = p;
    p = NULL;
out:
    ph_i_patch_free(&p);
    return st;
}

void ph_i_patch_forget(ph_patch *p)
{
    if (!p) return;
    for (ptrdiff_t i = 0; i < p->count; i++)
        p->part[p->node[i]] = OUTSIDE;
    for (int i = 0; i < p->n; i++)
        p->unknown[p->at[i]] = -1;
    ph_i_factor_free(&p->factor);
    p->count = p->nbonds = p->nsolved = p->nold = p->n = 0;
    p->made = false;
}

static void free_unknowns(ph_patch *p)
{
    free(p->at);
    p->at = NULL;
    ph_i_doubles_free(&p->run->meter, &p->start, p->room);
    ph_i_doubles_free(&p->run->meter, &p->c, PH_PATCH_BONDS * p->room);
    ph_i_doubles_free(&p->run->meter, &p->z, PH_PATCH_BONDS * p->room);
    p->room = 0;
}

void ph_i_patch_free(ph_patch **patch)
{
    if (!patch || !*patch) return;
    ph_patch *p = *patch;
    ph_i_factor_free(&p->factor);
    free_unknowns(p);
    free(p->part);
    free(p->unknown);
    free(p->node);
    free(p);
    *patch = NULL;
}

/* ---- nodes ------------------------------------------------------------------------------- */

typedef struct seed {
    double load;
    ptrdiff_t x;
} seed;

static int by_load(const void *a, const void *b)
{
    const seed *p = a, *q = b;
    if (p->load != q->load) return p->load < q->load ? -1 : 1;
    return (p->x > q->x) - (p->x < q->x);
}

static void take_in(ph_patch *p, ptrdiff_t x, uint8_t part)
{
    if (!p->part[x]) p->node[p->count++] = (int32_t)x;
    if (p->part[x] < part) p->part[x] = part;
}

/* Nodes around a seed. */
static void add_ball(ph_patch *p, ptrdiff_t x)
{
    const ptrdiff_t *n = p->run->setting.box.n;
    ptrdiff_t at[3] = {x / n[2] / n[1], x / n[2] % n[1], x % n[2]}, r[3], k[3];
    for (int d = 0; d < 3; d++) {
        r[d] = n[d] == 1 ? 0 : p->reach;
        if (r[d] > n[d] / 2) r[d] = n[d] / 2;
    }
    for (k[0] = -r[0]; k[0] <= r[0]; k[0]++)
        for (k[1] = -r[1]; k[1] <= r[1]; k[1]++)
            for (k[2] = -r[2]; k[2] <= r[2]; k[2]++) {
                ptrdiff_t far = k[0] * k[0] + k[1] * k[1] + k[2] * k[2], y = 0;
                if (far > (ptrdiff_t)p->reach * p->reach) continue;
                for (int d = 0; d < 3; d++)
                    y = y * n[d] + ((at[d] + k[d]) % n[d] + n[d]) % n[d];
                take_in(p, y, 4 * far <= (ptrdiff_t)p->reach * p->reach ? BREAKS : MOVES);
            }
}

static ph_status add_seeds(ph_patch *p, const ph_scan *scan, double least, ph_error *err)
{
    ph_status st = PH_OK;
    seed *list = NULL;
    ptrdiff_t count = 0;
    for (ptrdiff_t x = 0; x < scan->cells; x++)
        count += scan->least[x] <= about_to_break * least;
    PH_ALLOC(list, count, "a patch");
    count = 0;
    for (ptrdiff_t x = 0; x < scan->cells; x++)
        if (scan->least[x] <= about_to_break * least)
            list[count++] = (seed){scan->least[x], x};
    qsort(list, (size_t)count, sizeof *list, by_load);
    for (ptrdiff_t i = 0; i < count && p->count < p->most; i++)
        add_ball(p, list[i].x);
out:
    free(list);
    return st;
}

static int by_number(const void *a, const void *b)
{
    int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
    return (x > y) - (x < y);
}

static void add_neighbours(ph_patch *p)
{
    const ph_broken *br = p->run->broken;
    ptrdiff_t own = p->count;
    for (ptrdiff_t i = 0; i < own; i++)
        for (ptrdiff_t b = 0; b < br->family->count; b++)
            take_in(p, ph_i_broken_end(br, p->node[i], b), FEELS);
    qsort(p->node, (size_t)p->count, sizeof *p->node, by_number);
}

/* ---- the small system -------------------------------------------------------------------- */

static bool is_held(const ph_patch *p, ptrdiff_t x)
{
    const ph_springs *s = p->run->op->springs;
    const uint8_t *fixed = p->run->setting.fixed;
    if (fixed && fixed[x]) return true;
    for (ptrdiff_t b = 0; b < s->family->count; b++) {
        ptrdiff_t y = ph_i_springs_end(s, x, b);
        if (y != x && ph_i_springs_modulus(s, x, b, y) != 0.0) return false;
    }
    return true; /* by nothing */
}

static ph_status number(ph_patch *p, const double *u, ph_error *err)
{
    ph_status st = PH_OK;
    const ptrdiff_t cells = p->run->op->layout.cells;
    const int nd = p->run->op->layout.nd;
    size_t need = (size_t)(nd * p->count);
    if (p->room < need) {
        free_unknowns(p);
        p->room = need;
        PH_ALLOC(p->at, need, "a patch");
        PH_DOUBLES(p->start, &p->run->meter, need, "a patch");
        PH_DOUBLES(p->c, &p->run->meter, PH_PATCH_BONDS * need, "a patch");
        PH_DOUBLES(p->z, &p->run->meter, PH_PATCH_BONDS * need, "a patch");
    }
    for (ptrdiff_t i = 0; i < p->count; i++) {
        ptrdiff_t x = p->node[i];
        if (p->part[x] < MOVES || is_held(p, x)) continue;
        for (int a = 0; a < nd; a++) {
            p->at[p->n] = a * cells + x;
            p->start[p->n] = u[a * cells + x];
            p->unknown[a * cells + x] = p->n++;
        }
    }
out:
    return st;
}

static ph_status factorise(ph_patch *p, ph_error *err)
{
    ph_status st = PH_OK;
    ph_csc m = {0};
    double most = 0.0;
    if (p->n == 0) return PH_OK;
    PH_TRY(ph_i_springs_matrix(p->run->op->springs, p->unknown, p->n, &m, err));
    for (int c = 0; c < p->n; c++)
        for (int i = m.start[c]; i < m.start[c + 1]; i++)
            if (m.row[i] == c) most = fmax(most, m.value[i]);
    for (int c = 0; c < p->n; c++)
        for (int i = m.start[c]; i < m.start[c + 1]; i++)
            if (m.row[i] == c) m.value[i] += hold * most;
    st = ph_i_factor_new(&m, false, &p->factor, err);
    p->made = st == PH_OK;
    if (st == PH_ESINGULAR) {
        if (err) *err = (ph_error)PH_ERROR_INIT;
        st = PH_OK;
    }
out:
    ph_i_csc_clear(&m);
    return st;
}

ph_status ph_i_patch_make(ph_patch *p, const ph_scan *scan, double least, const double *u,
                          ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_patch_forget(p);
    PH_TRY(add_seeds(p, scan, least, err));
    if (most_of_box * (double)scan->cells < (double)p->count) return PH_OK;
    add_neighbours(p);
    PH_TRY(number(p, u, err));
    PH_TRY(factorise(p, err));
out:
    return st;
}

/* ---- breaking ---------------------------------------------------------------------------- */

bool ph_i_patch_takes(const ph_patch *p, ptrdiff_t x, ptrdiff_t y)
{
    return p->part[x] == BREAKS && p->part[y] == BREAKS;
}

/* c . v of a field of the patch. */
static double elongation(const ph_patch *p, const ph_patch_bond *b, const double *v)
{
    const ptrdiff_t cells = p->run->op->layout.cells;
    double sum = 0.0;
    for (int a = 0; a < p->run->op->layout.nd; a++) {
        int to = p->unknown[a * cells + b->y], from = p->unknown[a * cells + b->x];
        sum += b->xi[a] * ((to < 0 ? 0.0 : v[to]) - (from < 0 ? 0.0 : v[from]));
    }
    return sum;
}

void ph_i_patch_go_on(ph_patch *p, const double *u)
{
    if (!p || !p->made) return;
    for (int i = 0; i < p->n; i++)
        p->start[i] = u[p->at[i]];
    for (int i = 0; i < p->nbonds; i++)
        p->bond[i].e = 0.0;
    p->nold = p->nbonds;
}

double ph_i_patch_break(ph_patch *p, const double *u, const ph_picked *pick, double k)
{
    const ptrdiff_t cells = p->run->op->layout.cells;
    double *c = p->c + (ptrdiff_t)p->nbonds * p->n;
    ph_patch_bond *b = &p->bond[p->nbonds++];
    *b = (ph_patch_bond){pick->x, pick->y, p->run->family->xi[pick->b], k, pick->pull};
    memset(c, 0, (size_t)p->n * sizeof *c);
    for (int a = 0; a < p->run->op->layout.nd; a++)
        for (int end = 0; end < 2; end++) {
            double xi = end ? b->xi[a] : -b->xi[a];
            int i = p->unknown[a * cells + (end ? b->y : b->x)];
            if (i < 0) continue;
            c[i] += xi;
            b->e -= xi * (u[p->at[i]] - p->start[i]);
        }
    return b->e;
}

/* z and give of the bonds that have none. */
static ph_status solve_open(ph_patch *p, ph_error *err)
{
    ph_status st = PH_OK;
    ptrdiff_t from = (ptrdiff_t)p->nsolved * p->n;
    if (p->nsolved == p->nbonds) return PH_OK;
    PH_TRY(ph_i_factor_solve_all(p->factor, p->nbonds - p->nsolved, p->c + from,
                                 p->z + from, err));
    for (int i = p->nsolved; i < p->nbonds; i++)
        for (int j = 0; j <= i; j++)
            p->give[i][j] = p->give[j][i] =
                elongation(p, &p->bond[j], p->z + (ptrdiff_t)i * p->n);
    p->nsolved = p->nbonds;
out:
    return st;
}

/* t of the bonds: Cholesky factors of 1/k - give, in units of 1/k. */
static bool forces(const ph_patch *p, double *t)
{
    double L[PH_PATCH_BONDS][PH_PATCH_BONDS];
    int n = p->nbonds;
    for (int i = 0; i < n; i++) {
        double ki = sqrt(p->bond[i].k);
        t[i] = ki * p->bond[i].e;
        for (int j = 0; j <= i; j++) {
            double sum = (i == j) - ki * sqrt(p->bond[j].k) * p->give[i][j];
            for (int l = 0; l < j; l++)
                sum -= L[i][l] * L[j][l];
            if (i == j && !(sum > loose)) return false;
            L[i][j] = i == j ? sqrt(sum) : sum / L[j][j];
        }
        for (int j = 0; j < i; j++)
            t[i] -= L[i][j] * t[j];
        t[i] /= L[i][i];
    }
    for (int i = n - 1; i >= 0; i--) {
        for (int j = i + 1; j < n; j++)
            t[i] -= L[j][i] * t[j];
        t[i] /= L[i][i];
    }
    for (int i = 0; i < n; i++)
        t[i] *= sqrt(p->bond[i].k);
    return true;
}

ph_status ph_i_patch_relax(ph_patch *p, double *u, bool *held, ph_error *err)
{
    ph_status st = PH_OK;
    double t[PH_PATCH_BONDS];
    PH_TRY(solve_open(p, err));
    *held = forces(p, t);
    for (int i = 0; *held && i < p->n; i++)
        u[p->at[i]] = p->start[i];
    for (int b = 0; *held && b < p->nbonds; b++)
        for (int i = 0; i < p->n; i++)
            u[p->at[i]] += t[b] * p->z[(ptrdiff_t)b * p->n + i];
out:
    return st;
}
