/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The matrix of the bond lists, factorised once for all loads. What the equations leave
 * open is held: a node (periodic), as many displacements as there are rigid motions (a free
 * body), and every node without stiffness. The loads are in equilibrium, so that the forces
 * on what is held are zero and the solution is one of the whole system, whose residual is
 * taken with the operator itself.
 *
 * A spring that breaks is a change of rank one, A - k v v^T with v = xi at one end and -xi at
 * the other: the factor is downdated. It is made anew where the downdate has left no safe
 * pivot, as when a piece comes off, and where that costs less. Of `nosb` a bond that breaks
 * changes the gradients of both ends, and all that they hold: always anew. */
#include "solve/factor.h"
#include "solve/solver.h"

#include <math.h>
#include <string.h>

enum { MOTIONS = 6, STEPS = 40 };
/* Below this the factor has pivots of round-off: pieces that float in voids, modes that
 * the operator does not see. Then it is made of A + shift * diag A, and what the shift
 * spoils is refined. */
static const double singular = 1e-13, shift = 1e-9;
/* An operation of a downdate takes as long as so many of a factorisation, which works on
 * blocks. Measured, docs/performance.md; a fixed number, so that no bit of a result depends on
 * the load of the machine. */
static const double slower = 3.0;

typedef struct direct {
    ph_operator *op;
    ph_meter *meter;
    const ph_setting *setting;
    const ph_operator_params *params;
    const ph_broken *broken; /* of springs that may break, or NULL */
    ph_factor *factor;
    double downdates; /* springs taken out of this factor */
    int factors;      /* made so far */
    size_t factor_bytes;
    int *unknown; /* [nd][nodes], or -1 */
    int n;
    double *x, *r, *q;  /* fields */
    double *rhs, *step; /* [n] */
} direct;

static ptrdiff_t field_size(const direct *s)
{
    return s->op->layout.nd * s->op->layout.cells;
}

/* ---- what is held ---------------------------------------------------------------------- */

/* Translations; of a free body its rotations too, in planes in which the fields vary. */
static int rigid_motions(const direct *s, double *mode)
{
    const ph_grid *g = &s->setting->box;
    int nd = s->op->layout.nd, count = 0;
    ptrdiff_t n = g->n[0] * g->n[1] * g->n[2], size = nd * n;
    bool body = s->setting->source != NULL;
    for (int a = 0; a < nd; a++, count++)
        for (ptrdiff_t x = 0; x < n; x++)
            mode[count * size + a * n + x] = 1.0;
    for (int a = 0; body && a < nd; a++)
        for (int b = a + 1; b < nd; b++) {
            if (g->n[a] == 1 || g->n[b] == 1) continue;
            for (ptrdiff_t x = 0; x < n; x++) {
                ptrdiff_t at[3] = {x / g->n[2] / g->n[1], x / g->n[2] % g->n[1],
                                   x % g->n[2]};
                double scale = fmax(g->size[a], g->size[b]);
                mode[count * size + a * n + x] = -(double)at[b] * g->h[b] / scale;
                mode[count * size + b * n + x] = (double)at[a] * g->h[a] / scale;
            }
            count++;
        }
    return count;
}

/* Hold the displacements that no rigid motion leaves at zero: elimination with complete
 * pivoting over the modes. */
static void hold_motions(direct *s, int count, double *mode)
{
    ptrdiff_t size = field_size(s);
    bool done[MOTIONS] = {false};
    for (int step = 0; step < count; step++) {
        ptrdiff_t at = -1;
        int from = 0;
        double best = 1e-9;
        for (int m = 0; m < count; m++)
            for (ptrdiff_t i = 0; !done[m] && i < size; i++)
                if (s->unknown[i] >= 0 && fabs(mode[m * size + i]) > best)
                    best = fabs(mode[m * size + i]), at = i, from = m;
        if (at < 0) return;
        done[from] = true;
        s->unknown[at] = -1;
        for (int m = 0; m < count; m++) {
            double f = mode[m * size + at] / mode[from * size + at];
            if (done[m]) continue;
            for (ptrdiff_t i = 0; i < size; i++)
                mode[m * size + i] -= f * mode[from * size + i];
        }
    }
}

/* Number the displacements, node by node. */
static ph_status number(direct *s, const ph_assembly *list, ph_error *err)
{
    ph_status st = PH_OK;
    ptrdiff_t size = field_size(s), nodes = s->op->layout.cells;
    const uint8_t *fixed = s->setting->fixed;
    double *mode = NULL;
    PH_ALLOC(s->unknown, size, "the unknowns");
    PH_TRY(ph_i_assembly_row_sums(list, s->r, err));
    for (ptrdiff_t i = 0; i < size; i++)
        s->unknown[i] = s->r[i] > 0.0 && !(fixed && fixed[i % nodes]) ? 0 : -1;
    if (!fixed) {
        PH_ALLOC(mode, MOTIONS * size, "the rigid motions");
        hold_motions(s, rigid_motions(s, mode), mode);
    }
    for (ptrdiff_t x = 0; x < nodes; x++)
        for (int a = 0; a < s->op->layout.nd; a++)
            if (s->unknown[a * nodes + x] >= 0) s->unknown[a * nodes + x] = s->n++;
out:
    free(mode);
    return st;
}

/* ---- the factor ------------------------------------------------------------------------ */

static ph_status factorise(direct *s, const ph_assembly *list, ph_error *err)
{
    ph_status st = PH_OK;
    ph_csc m = {0};
    ph_error first = PH_ERROR_INIT;
    PH_TRY(ph_i_assembly_matrix(list, s->unknown, s->n, &m, err));
    st = ph_i_factor_new(&m, s->broken != NULL, &s->factor, &first);
    if (st == PH_ESINGULAR ||
        (st == PH_OK && ph_i_factor_condition(s->factor) < singular)) {
        ph_i_factor_free(&s->factor);
        for (int j = 0; j < m.n; j++)
            for (int p = m.start[j]; p < m.start[j + 1]; p++)
                if (m.row[p] == j) m.value[p] *= 1.0 + shift;
        st = ph_i_factor_new(&m, s->broken != NULL, &s->factor, err);
    } else if (st != PH_OK && err) {
        *err = first;
    }
    if (st != PH_OK) goto out;
    s->factors++;
    s->factor_bytes = ph_i_factor_bytes(s->factor);
    s->meter->bytes += s->factor_bytes;
    if (s->meter->bytes > s->meter->peak) s->meter->peak = s->meter->bytes;
out:
    ph_i_csc_clear(&m);
    return st;
}

static void forget(direct *s)
{
    s->meter->bytes -= s->factor_bytes;
    s->factor_bytes = 0;
    ph_i_factor_free(&s->factor);
    ph_i_doubles_free(s->meter, &s->rhs, (size_t)s->n);
    ph_i_doubles_free(s->meter, &s->step, (size_t)s->n);
    free(s->unknown);
    s->unknown = NULL;
    s->n = 0;
    s->downdates = 0.0;
}

void ph_i_direct_free(void **state)
{
    direct *s = *state;
    if (!s) return;
    size_t size = (size_t)field_size(s);
    forget(s);
    ph_i_doubles_free(s->meter, &s->x, size);
    ph_i_doubles_free(s->meter, &s->r, size);
    ph_i_doubles_free(s->meter, &s->q, size);
    free(s);
    *state = NULL;
}

/* Number, assemble and factorise what is there now. */
static ph_status make(direct *s, ph_error *err)
{
    ph_status st = PH_OK;
    ph_assembly list = {0};
    PH_TRY(ph_i_assembly_init(&list, s->op, &s->setting->box, s->params, s->meter, err));
    PH_TRY(number(s, &list, err));
    PH_DOUBLES(s->rhs, s->meter, (size_t)s->n, "the right-hand side");
    PH_DOUBLES(s->step, s->meter, (size_t)s->n, "the correction");
    PH_TRY(factorise(s, &list, err));
out:
    ph_i_assembly_clear(&list);
    return st;
}

ph_status ph_i_direct_init(const ph_system *system, void **state, ph_error *err)
{
    ph_status st = PH_OK;
    direct *s = NULL;
    void *self = NULL;
    PH_ALLOC(s, 1, "the solver");
    self = s;
    s->op = system->op;
    s->meter = system->meter;
    s->setting = system->setting;
    s->params = system->params;
    s->broken = s->op->springs ? system->params->broken : NULL;
    PH_TRY(ph_i_operator_in_space(s->op, err));
    size_t size = (size_t)field_size(s);
    PH_DOUBLES(s->x, s->meter, size, "the solution");
    PH_DOUBLES(s->r, s->meter, size, "the residual");
    PH_DOUBLES(s->q, s->meter, size, "the product");
    PH_TRY(make(s, err));
    *state = self;
    self = NULL;
out:
    ph_i_direct_free(&self);
    return st;
}

/* ---- bonds that break ------------------------------------------------------------------ */

/* sqrt(k) (xi at x, -xi at y) on the unknowns, in the order of their numbers. */
static void spring_column(const direct *s, const ph_fresh_bond *bond, int column,
                          ph_csc *c)
{
    const ph_springs *springs = s->op->springs;
    const ptrdiff_t nodes = s->op->layout.cells, x = bond->node,
                    y = ph_i_broken_end(s->broken, x, bond->bond);
    const double *xi = springs->family->xi[bond->bond];
    double k = springs->family->w[bond->bond] * ph_i_bond_modulus(springs->classes, x, y);
    int used = c->start[column];
    for (int end = 0; end < 2 && x != y; end++)
        for (int a = 0; a < s->op->layout.nd; a++) {
            int row = s->unknown[a * nodes + ((end == 0) == (x < y) ? x : y)];
            bool first = (end == 0) == (x < y);
            if (row < 0 || xi[a] == 0.0) continue;
            c->row[used] = row;
            c->value[used++] = first ? sqrt(k) * xi[a] : -sqrt(k) * xi[a];
        }
    c->start[column + 1] = used;
}

/* Would it be less work to begin again? By what downdates of this factor have taken so far; of
 * the first as if each took an operation for every entry of the factor. */
static bool begins_again(const direct *s, double springs)
{
    double taken, all = ph_i_factor_flops(s->factor, &taken);
    double each = s->downdates > 0.0 ? taken / s->downdates
                                     : (double)s->factor_bytes / sizeof(double);
    return slower * each * springs > all;
}

int ph_i_direct_factors(const void *state)
{
    return ((const direct *)state)->factors;
}

ph_status ph_i_direct_broke(void *state, bool *done, ph_error *err)
{
    ph_status st = PH_OK;
    direct *s = state;
    ph_csc c = {0};
    *done = false;
    if (!s->broken || s->broken->healed) return PH_OK;
    const ptrdiff_t count = s->broken->nrecent;
    if (count == 0 || begins_again(s, (double)count)) return PH_OK;
    PH_ALLOC(c.start, count + 1, "columns of broken springs");
    PH_ALLOC(c.row, 6 * count, "columns of broken springs");
    PH_ALLOC(c.value, 6 * count, "columns of broken springs");
    for (ptrdiff_t i = 0; i < count; i++)
        spring_column(s, &s->broken->recent[i], (int)i, &c);
    PH_TRY(ph_i_factor_take(s->factor, &c, (int)count, err));
    s->downdates += (double)count;
    *done = ph_i_factor_condition(s->factor) >= singular;
out:
    ph_i_csc_clear(&c);
    return st;
}

/* ---- a load ---------------------------------------------------------------------------- */

/* Norm over what is not fixed by the constraint. */
static double norm(const direct *s, const double *r)
{
    const uint8_t *fixed = s->setting->fixed;
    ptrdiff_t cells = s->op->layout.cells;
    double sum = 0.0;
    for (ptrdiff_t i = 0; i < field_size(s); i++)
        if (!fixed || !fixed[i % cells]) sum += r[i] * r[i];
    return sqrt(sum);
}

static ph_status correct(direct *s, ph_error *err)
{
    ph_status st = PH_OK;
    ptrdiff_t size = field_size(s);
    for (ptrdiff_t i = 0; i < size; i++)
        if (s->unknown[i] >= 0) s->rhs[s->unknown[i]] = s->r[i];
    PH_TRY(ph_i_factor_solve(s->factor, s->rhs, s->step, err));
    for (ptrdiff_t i = 0; i < size; i++)
        if (s->unknown[i] >= 0) s->x[i] += s->step[s->unknown[i]];
out:
    return st;
}

/* Mean displacement to zero, where nothing says what it is. Nodes without stiffness stay. */
static void centre(const direct *s, double *u)
{
    ptrdiff_t cells = s->op->layout.cells;
    for (int a = 0; a < s->op->layout.nd && !s->setting->fixed; a++) {
        double sum = 0.0;
        for (ptrdiff_t x = 0; x < cells; x++)
            sum += u[a * cells + x];
        for (ptrdiff_t x = 0; x < cells; x++)
            u[a * cells + x] -= sum / (double)cells;
    }
}

/* Refine x, from zero, until the residual of keep - A x meets the tolerance, or as far as it
 * goes. */
static ph_status refine(direct *s, const double *keep, double b2, ph_cg_report *report,
                        ph_error *err)
{
    ph_status st = PH_OK;
    ptrdiff_t size = field_size(s);
    double before = INFINITY;
    memcpy(s->r, keep, sizeof(double) * (size_t)size);
    memset(s->x, 0, sizeof(double) * (size_t)size);
    report->residual = b2 > 0.0 ? 1.0 : 0.0;
    for (int i = 0; report->residual > report->tolerance && i < STEPS; i++) {
        PH_TRY(correct(s, err));
        ph_i_operator_apply(s->op, s->x, s->q);
        for (ptrdiff_t k = 0; k < size; k++)
            s->r[k] = keep[k] - s->q[k];
        before = report->residual;
        report->residual = norm(s, s->r) / b2;
        report->iterations++;
        if (ph_i_told_to_stop(report)) {
            st = ph_i_give_up(PH_ECANCELLED, report, "interrupted", err);
            goto out;
        }
        if (!(report->residual < 0.9 * before)) break; /* as far as it goes */
    }
out:
    return st;
}

ph_status ph_i_direct_solve(void *state, const double *load, double *u,
                            ph_cg_report *report, ph_error *err)
{
    ph_status st = PH_OK;
    direct *s = state;
    ptrdiff_t size = field_size(s);
    double *keep = NULL, b2 = norm(s, load);
    PH_ALLOC(keep, size, "the load");
    memcpy(keep, load, sizeof(double) * (size_t)size);
    report->iterations = 0;
    PH_TRY(refine(s, keep, b2, report, err));
    if (!(report->residual <= report->tolerance) && s->downdates > 0.0) {
        forget(s); /* what downdates have left is not good enough */
        PH_TRY(make(s, err));
        PH_TRY(refine(s, keep, b2, report, err));
    }
    memcpy(u, s->x, sizeof(double) * (size_t)size);
    centre(s, u);
    if (!(report->residual <= report->tolerance))
        st = ph_i_give_up(isfinite(report->residual) ? PH_ENOCONV : PH_ESINGULAR, report,
                          "the direct solution does not meet the tolerance", err);
out:
    free(keep);
    return st;
}

/* Entries of the matrix, from above: a row couples with all that a common point sees. */
static double entries(const ph_system *system)
{
    const ph_grid *g = &system->setting->box;
    const ph_family *fam = system->params->family;
    int nd = ph_displacements(g->kinematics);
    double row = 0.5 * nd * nd;
    if (system->params->classes) /* a node couples with its family alone */
        return row * (double)ph_grid_cells(g) * (double)(fam->count + 1);
    for (int d = 0; d < 3; d++) {
        double span = !fam || system->params->smallest ? 3.0 : 4.0 * fam->reach[d] + 1.0;
        row *= (double)g->n[d] * fmin(span, (double)g->n[d]);
    }
    return row;
}

const char *ph_i_direct_refuses(const ph_system *system)
{
    return entries(system) > (double)PH_MATRIX_MOST
               ? "its matrix would have more than 2e8 entries; take fft_cg"
               : NULL;
}
