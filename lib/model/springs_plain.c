/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Springs one by one, from the definition: the oracle of the fast routes, the assembled
 * matrix, and the forces on the faces of an RVE. */
#include "model/springs.h"

#include <math.h>
#include <string.h>

void ph_i_springs_plain_apply(const ph_springs *s, const double *u, double *f)
{
    const ptrdiff_t n = s->layout.cells;
    const int nd = s->layout.nd;
#pragma omp parallel for num_threads(s->threads) schedule(static, PH_CHUNK)
    for (ptrdiff_t x = 0; x < n; x++) {
        double sum[3] = {0};
        for (ptrdiff_t b = 0; b < s->family->count; b++) {
            ptrdiff_t y = ph_i_springs_end(s, x, b);
            const double *xi = s->family->xi[b];
            double t = 0.0;
            for (int a = 0; a < nd; a++)
                t += xi[a] * (u[a * n + x] - u[a * n + y]);
            t *= s->family->w[b] * ph_i_springs_modulus(s, x, b, y);
            for (int a = 0; a < nd; a++)
                sum[a] += t * xi[a];
        }
        for (int a = 0; a < nd; a++)
            f[a * n + x] = sum[a];
    }
}

/* ---- the matrix ------------------------------------------------------------------------ */

/* The blocks of one column of nodes: slot of a node in `node`, or -1. */
typedef struct column {
    const ph_springs *s;
    int32_t *slot, *node;
    int32_t count;
    double (*block)[9]; /* [count] */
} column;

static void column_clear(column *c)
{
    free(c->slot);
    free(c->node);
    free(c->block);
}

static ph_status column_init(column *c, const ph_springs *s, ph_error *err)
{
    ph_status st = PH_OK;
    memset(c, 0, sizeof *c);
    c->s = s;
    PH_ALLOC(c->slot, s->layout.cells, "the rows of a column");
    PH_ALLOC(c->node, s->family->count + 1, "the rows of a column");
    PH_ALLOC(c->block, s->family->count + 1, "a column of the matrix");
    for (ptrdiff_t x = 0; x < s->layout.cells; x++)
        c->slot[x] = -1;
out:
    return st;
}

static double *block_of(column *c, ptrdiff_t y)
{
    if (c->slot[y] < 0) {
        memset(c->block[c->count], 0, sizeof *c->block);
        c->node[c->count] = (int32_t)y;
        c->slot[y] = c->count++;
    }
    return c->block[c->slot[y]];
}

static void fill_column(column *c, ptrdiff_t x)
{
    const ph_springs *s = c->s;
    const int nd = s->layout.nd;
    for (int32_t i = 0; i < c->count; i++)
        c->slot[c->node[i]] = -1;
    c->count = 0;
    double own[9] = {0};
    for (ptrdiff_t b = 0; b < s->family->count; b++) {
        ptrdiff_t y = ph_i_springs_end(s, x, b);
        double k = s->family->w[b] * ph_i_springs_modulus(s, x, b, y);
        if (k == 0.0 || y == x) continue;
        double *block = block_of(c, y);
        for (int i = 0; i < nd; i++)
            for (int j = 0; j < nd; j++) {
                double t = k * s->family->xi[b][i] * s->family->xi[b][j];
                block[i * nd + j] -= t;
                own[i * nd + j] += t;
            }
    }
    double *block = block_of(c, x);
    for (int i = 0; i < nd * nd; i++)
        block[i] = own[i];
}

static ptrdiff_t copy_column(const column *c, const int *unknown, int a, int col,
                             ph_csc *m, ptrdiff_t used)
{
    const int nd = c->s->layout.nd;
    for (int32_t i = 0; i < c->count; i++)
        for (int r = 0; r < nd; r++) {
            int row = unknown[r * c->s->layout.cells + c->node[i]];
            if (row < col) continue; /* held, or in the upper triangle */
            m->row[used] = row;
            m->value[used++] = c->block[i][r * nd + a];
        }
    return used;
}

ph_status ph_i_springs_matrix(const ph_springs *s, const int *unknown, int n, ph_csc *m,
                              ph_error *err)
{
    ph_status st = PH_OK;
    column c;
    const ptrdiff_t cells = s->layout.cells;
    const int nd = s->layout.nd;
    ptrdiff_t used = 0;
    int next = 0;
    memset(m, 0, sizeof *m);
    PH_TRY(column_init(&c, s, err));
    /* above the diagonal as many as below: half of all, and the diagonal blocks */
    double room = 0.5 * nd * n * (double)(s->family->count + 1) + 0.5 * nd * n + 16.0;
    room = 2.0 * room; /* numbering by nodes does not halve every column */
    PH_CHECK_KEY(room <= 2.0 * PH_MATRIX_MOST, PH_EINVAL, "solver.kind",
                 "the matrix has more than %d entries: take solver fft_cg",
                 PH_MATRIX_MOST);
    PH_ALLOC(m->start, n + 1, "the columns of the matrix");
    PH_ALLOC(m->row, room, "the matrix");
    PH_ALLOC(m->value, room, "the matrix");
    m->n = n;
    for (ptrdiff_t x = 0; x < cells; x++) {
        bool any = false;
        for (int a = 0; a < nd; a++)
            any = any || unknown[a * cells + x] >= 0;
        if (!any) continue;
        fill_column(&c, x);
        for (int a = 0; a < nd; a++) {
            int col = unknown[a * cells + x];
            if (col < 0) continue;
            PH_ASSERT(col == next); /* columns come in the order of the unknowns */
            m->start[next++] = (int)used;
            used = copy_column(&c, unknown, a, col, m, used);
        }
    }
    PH_ASSERT(next == n);
    m->start[n] = (int)used;
out:
    column_clear(&c);
    if (st != PH_OK) ph_i_csc_clear(m);
    return st;
}

ph_status ph_i_springs_row_sums(const ph_springs *s, double *sum, ph_error *err)
{
    ph_status st = PH_OK;
    column c;
    const int nd = s->layout.nd;
    PH_TRY(column_init(&c, s, err));
    for (ptrdiff_t x = 0; x < s->layout.cells; x++) {
        fill_column(&c, x);
        for (int a = 0; a < nd; a++) {
            double t = 0.0;
            for (int32_t i = 0; i < c.count; i++)
                for (int r = 0; r < nd; r++)
                    t += fabs(c.block[i][r * nd + a]);
            sum[a * s->layout.cells + x] = t;
        }
    }
out:
    column_clear(&c);
    return st;
}

/* ---- the faces of an RVE --------------------------------------------------------------- */

/* The part [t[0], t[1]] of the bond from `at` (cells, centres at halves) by o that lies in
 * the RVE; false: none. */
static bool clip(const double at[3], const int o[3], const ptrdiff_t n[3], double t[2])
{
    t[0] = 0.0, t[1] = 1.0;
    for (int d = 0; d < 3; d++) {
        double low = -at[d], high = (double)n[d] - at[d];
        if (o[d] == 0) {
            if (low >= 0.0 || high <= 0.0) return false;
            continue;
        }
        double a = low / o[d], b = high / o[d];
        t[0] = fmax(t[0], fmin(a, b));
        t[1] = fmin(t[1], fmax(a, b));
    }
    return t[1] > t[0];
}

/* Moment arm of a bond's force on the faces: where it leaves minus where it enters, from
 * the middle of the RVE for ends that lie within. */
static bool arm_of(const double at[3], const int o[3], const ptrdiff_t n[3], double t[2],
                   double arm[3])
{
    if (!clip(at, o, n, t) || (t[0] <= 0.0 && t[1] >= 1.0)) return false;
    for (int d = 0; d < 3; d++) {
        double middle = 0.5 * (double)n[d];
        double out = t[1] < 1.0 ? at[d] + t[1] * o[d] - middle : 0.0;
        double in = t[0] > 0.0 ? at[d] + t[0] * o[d] - middle : 0.0;
        arm[d] = out - in;
    }
    return true;
}

void ph_i_springs_reactions(const ph_springs *s, const ptrdiff_t first[3],
                            const ptrdiff_t rve[3], const double *u, const double *macro,
                            double *stress)
{
    const ptrdiff_t *n = s->layout.n, cells = s->layout.cells;
    const int nd = s->layout.nd;
    double sum[3][3] = {{0}}, volume = (double)rve[0] * (double)rve[1] * (double)rve[2];
    ptrdiff_t in_loops[3] = {1, 1, 1};
    for (int a = 0; a < 3; a++)
        if (s->layout.axis[a] >= 0) in_loops[a] = rve[s->layout.axis[a]];
    for (ptrdiff_t x = 0; x < cells; x++) {
        ptrdiff_t i[3] = {x / n[2] / n[1], x / n[2] % n[1], x % n[2]};
        double at[3];
        for (int a = 0; a < 3; a++) {
            int d = s->layout.axis[a];
            at[a] = (double)(i[a] - (d >= 0 ? first[d] : 0)) + 0.5;
        }
        for (ptrdiff_t b = 0; b < s->family->count; b++) {
            double t[2], arm[3], pull;
            if (!arm_of(at, s->o[b], in_loops, t, arm)) continue;
            const double *xi = s->family->xi[b];
            ptrdiff_t y = ph_i_springs_end(s, x, b);
            pull = ph_i_springs_stretch(nd, xi, macro);
            for (int a = 0; a < nd; a++)
                pull += xi[a] * (u[a * cells + y] - u[a * cells + x]);
            pull *= 0.5 * s->family->w[b] * ph_i_springs_modulus(s, x, b, y);
            for (int c = 0; c < nd; c++)
                for (int a = 0; a < 3; a++)
                    if (s->layout.axis[a] >= 0)
                        sum[c][s->layout.axis[a]] +=
                            pull * xi[c] * arm[a] * s->layout.h[a];
        }
    }
    for (int c = 0; c < s->layout.ns; c++)
        stress[c] = 0.0;
    for (int a = 0; a < nd; a++)
        for (int d = 0; d < nd; d++) {
            int c = a == d ? a : nd == 3 ? 6 - a - d : 2;
            stress[c] += sum[a][d] * (a == d ? 1.0 : sqrt(0.5)) / volume;
        }
}
