/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The matrix of the energy of the RVE, condensed to the nodes that its neighbours share. */
#include "effective/superelement.h"

#include "solve/factor.h"

#include <math.h>
#include <string.h>

/* An entry of K_ib: row of the inside, column of the faces. */
typedef struct coupling {
    int row, column;
    double value;
} coupling;

typedef struct condensation {
    ph_run run;
    ph_body *body;
    ph_csc all, inside;
    ph_factor *factor;
    double *sum;  /* [nd][box] absolute row sums: zero where nothing is */
    int *unknown; /* [nd][box] numbers node by node; -1: none */
    int *place;   /* [n] number among the inside, or -1 - number on the faces */
    int n, ninside;
    ptrdiff_t *node; /* [nodes] of the faces, index in the box */
    ptrdiff_t ncouplings;
    coupling *coupling;
    double *x; /* [n] */
    ph_superelement *out;
} condensation;

void ph_superelement_free(ph_superelement **element)
{
    if (!element || !*element) return;
    free((*element)->position);
    free((*element)->stiffness);
    free(*element);
    *element = NULL;
}

static void clear(condensation *c)
{
    ph_i_factor_free(&c->factor);
    ph_i_csc_clear(&c->all);
    ph_i_csc_clear(&c->inside);
    ph_i_body_free(&c->body);
    free(c->sum);
    free(c->unknown);
    free(c->place);
    free(c->node);
    free(c->coupling);
    free(c->x);
    ph_superelement_free(&c->out);
    ph_i_run_clear(&c->run);
    ph_result_free(&c->run.result);
}

static ptrdiff_t size_of(const ph_superelement *e)
{
    return e->nd * e->nodes + e->strains;
}

static ph_status check(const ph_problem *p, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(p->micro, PH_EINVAL, "a superelement needs a microstructure");
    PH_CHECK(!p->cracks || p->cracks->count == 0, PH_EINVAL,
             "a superelement has no cracks");
out:
    return st;
}

/* Nodes of the RVE that are kept, and around it those that its energy depends on. */
static bool is_kept(const condensation *c, ptrdiff_t x)
{
    const ptrdiff_t *n = c->run.problem->micro->grid.n;
    ptrdiff_t at[3];
    double sum = 0.0;
    ph_i_body_at(c->body, x, at);
    if (!ph_i_body_is_kept(c->body, at)) return false;
    if (at[0] >= 0 && at[0] < n[0] && at[1] >= 0 && at[1] < n[1] && at[2] >= 0 &&
        at[2] < n[2])
        return true;
    for (int a = 0; a < c->out->nd; a++)
        sum += c->sum[a * ph_grid_cells(&c->body->box) + x];
    return sum > 0.0;
}

/* Number the displacements, node by node: of the inside where there is material, of the
 * faces all. */
static void number_node(condensation *c, ptrdiff_t x, ptrdiff_t *faces)
{
    const int nd = c->out->nd;
    const ph_grid *rve = &c->run.problem->micro->grid;
    const ptrdiff_t nodes = ph_grid_cells(&c->body->box);
    const ph_family *f = c->run.family;
    const double middle = f && f->points == PH_POINTS_NODES ? 0.5 : 0.0; /* of a cell */
    ptrdiff_t at[3];
    ph_i_body_at(c->body, x, at);
    const bool kept = is_kept(c, x);
    for (int a = 0; a < nd; a++) {
        int *number = &c->unknown[a * nodes + x];
        *number = -1;
        if (!kept && !(c->sum[a * nodes + x] > 0 && !ph_i_body_is_kept(c->body, at)))
            continue;
        c->place[c->n] = kept ? -1 - (int)(nd * *faces + a) : c->ninside++;
        *number = c->n++;
    }
    if (!kept) return;
    for (int a = 0; a < (rve->kinematics == PH_SPACE ? 3 : 2); a++)
        c->out->position[*faces][a] = ((double)at[a] + middle) * rve->h[a];
    c->node[(*faces)++] = x;
}

static ph_status number(condensation *c, ph_error *err)
{
    ph_status st = PH_OK;
    const int nd = c->out->nd;
    const ptrdiff_t nodes = ph_grid_cells(&c->body->box);
    ptrdiff_t faces = 0;
    PH_ALLOC(c->sum, nd * nodes, "row sums");
    PH_TRY(ph_i_body_row_sums(c->body, c->sum, err));
    for (ptrdiff_t x = 0; x < nodes; x++)
        faces += is_kept(c, x);
    PH_CHECK(nd * faces <= PH_SUPERELEMENT_MOST, PH_EINVAL,
             "the faces have %td displacements, more than %d", nd * faces,
             PH_SUPERELEMENT_MOST);
    c->out->nodes = faces;
    PH_ALLOC(c->out->position, faces, "the nodes of the faces");
    PH_ALLOC(c->node, faces, "the nodes of the faces");
    PH_ALLOC(c->unknown, nd * nodes, "the unknowns");
    PH_ALLOC(c->place, nd * nodes, "the unknowns");
    faces = 0;
    for (ptrdiff_t x = 0; x < nodes; x++)
        number_node(c, x, &faces);
    c->out->condensed = c->ninside;
out:
    return st;
}

/* The uniform strain 33 of generalised plane strain, as one more displacement of the faces. */
static ph_status add_stretch(condensation *c, double volume, ph_error *err)
{
    ph_status st = PH_OK;
    const int nd = c->out->nd;
    const ptrdiff_t N = size_of(c->out), nodes = ph_grid_cells(&c->body->box);
    double *S = c->out->stiffness, *force = NULL, own;
    PH_ALLOC(force, nd * nodes, "forces of a strain");
    PH_TRY(ph_i_body_stretch(c->body, force, &own, err));
    S[N * N - 1] = own * volume;
    for (ptrdiff_t i = 0; i < nd * nodes; i++) {
        if (c->unknown[i] < 0) continue;
        const int at = c->place[c->unknown[i]];
        const double v = force[i] * volume;
        if (at >= 0)
            c->coupling[c->ncouplings++] = (coupling){at, (int)N - 1, v};
        else
            S[(-1 - at) * N + N - 1] = S[(N - 1) * N - 1 - at] = v;
    }
out:
    free(force);
    return st;
}

/* The blocks of the matrix: K_ii of its own, K_ib as entries, K_bb into the answer. */
static ph_status take_apart(condensation *c, ph_error *err)
{
    ph_status st = PH_OK;
    const int ni = c->ninside;
    const ptrdiff_t nb = size_of(c->out);
    const ph_grid *rve = &c->run.problem->micro->grid;
    const double volume =
        rve->h[0] * rve->h[1] * rve->h[2]; /* the operator is per volume */
    PH_TRY(ph_i_body_matrix(c->body, c->unknown, c->n, &c->all, err));
    const ptrdiff_t entries = c->all.start[c->n];
    PH_ALLOC(c->out->stiffness, nb * nb, "a superelement");
    PH_ALLOC(c->coupling, entries + ni, "the coupling of the faces");
    PH_ALLOC(c->inside.start, ni + 1, "the matrix of the inside");
    PH_ALLOC(c->inside.row, entries, "the matrix of the inside");
    PH_ALLOC(c->inside.value, entries, "the matrix of the inside");
    c->inside.n = ni;
    int kept = 0;
    for (int j = 0; j < c->n; j++) {
        const int column = c->place[j];
        for (int p = c->all.start[j]; p < c->all.start[j + 1]; p++) {
            const int row = c->place[c->all.row[p]];
            const double v = c->all.value[p] * volume;
            if (row >= 0 && column >= 0) {
                c->inside.row[kept] = row;
                c->inside.value[kept++] = v;
            } else if (row >= 0 || column >= 0) {
                c->coupling[c->ncouplings++] = (coupling){
                    row >= 0 ? row : column, -1 - (row >= 0 ? column : row), v};
            } else {
                const ptrdiff_t i = -1 - row, k = -1 - column;
                c->out->stiffness[i * nb + k] = c->out->stiffness[k * nb + i] = v;
            }
        }
        if (column >= 0) c->inside.start[column + 1] = kept;
    }
    if (c->out->strains) PH_TRY(add_stretch(c, volume, err));
out:
    return st;
}

static int by_column(const void *a, const void *b)
{
    const coupling *x = a, *y = b;
    return x->column != y->column ? (x->column > y->column) - (x->column < y->column)
                                  : (x->row > y->row) - (x->row < y->row);
}

/* S = K_bb - K_bi K_ii^-1 K_ib, a column at a time; then its symmetric part. */
static ph_status condense(condensation *c, ph_error *err)
{
    ph_status st = PH_OK;
    const int ni = c->ninside;
    const ptrdiff_t nb = size_of(c->out);
    double *S = c->out->stiffness, *rhs = NULL;
    if (ni == 0) return PH_OK;
    PH_TRY(ph_i_factor_new(&c->inside, false, &c->factor, err));
    PH_ALLOC(rhs, ni, "a right-hand side");
    PH_ALLOC(c->x, ni, "a solution");
    qsort(c->coupling, (size_t)c->ncouplings, sizeof *c->coupling, by_column);
    for (ptrdiff_t first = 0, last; first < c->ncouplings; first = last) {
        const int column = c->coupling[first].column;
        memset(rhs, 0, sizeof *rhs * (size_t)ni);
        for (last = first; last < c->ncouplings && c->coupling[last].column == column;
             last++)
            rhs[c->coupling[last].row] = c->coupling[last].value;
        PH_TRY(ph_i_factor_solve(c->factor, rhs, c->x, err));
        for (ptrdiff_t k = 0; k < c->ncouplings; k++)
            S[c->coupling[k].column * nb + column] -=
                c->coupling[k].value * c->x[c->coupling[k].row];
    }
    for (ptrdiff_t i = 0; i < nb; i++)
        for (ptrdiff_t j = 0; j < i; j++)
            S[i * nb + j] = S[j * nb + i] = 0.5 * (S[i * nb + j] + S[j * nb + i]);
out:
    free(rhs);
    return st;
}

/* ---- effective stiffness -------------------------------------------------------------- */

/* u = eps x of the unit Mandel strain `load`; nothing varies along an axis 3 without nodes. */
static void affine(const ph_superelement *e, int load, double *u)
{
    static const int pair3[6][2] = {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};
    static const int pair2[3][2] = {{0, 0}, {1, 1}, {0, 1}};
    const int *p = e->nd == 3 ? pair3[load] : pair2[load];
    double half = p[0] == p[1] ? 0.5 : sqrt(0.5);
    if (e->strains && p[0] != p[1] && p[1] == 2) half = sqrt(2.0);
    memset(u, 0, sizeof *u * (size_t)size_of(e));
    if (e->strains) u[size_of(e) - 1] = load == 2;
    for (ptrdiff_t k = 0; k < e->nodes; k++) {
        u[k * e->nd + p[0]] += half * e->position[k][p[1]];
        u[k * e->nd + p[1]] += half * e->position[k][p[0]];
    }
}

/* f = S u */
static void pull(const ph_superelement *e, const double *u, double *f)
{
    const ptrdiff_t n = size_of(e);
    for (ptrdiff_t i = 0; i < n; i++) {
        f[i] = 0;
        for (ptrdiff_t j = 0; j < n; j++)
            f[i] += e->stiffness[i * n + j] * u[j];
    }
}

/* master[k]: the number of the node that node k is an image of, among *count. */
static void find_masters(const condensation *c, int *of_box, int *master, int *count)
{
    const ph_grid *rve = &c->run.problem->micro->grid;
    *count = 0;
    for (int pass = 0; pass < 2; pass++)
        for (ptrdiff_t k = 0; k < c->out->nodes; k++) {
            ptrdiff_t at[3];
            ph_i_body_at(c->body, c->node[k], at);
            bool first = true;
            ptrdiff_t image = 0;
            for (int a = 0; a < 3; a++) {
                const ptrdiff_t n = rve->n[a];
                first = first && at[a] >= 0 && at[a] < n;
                image = image * n + (at[a] % n + n) % n;
            }
            if (pass == 0 && first) of_box[image] = (*count)++;
            if (pass == 1) master[k] = of_box[image];
        }
}

/* P^T S P without its first node, lower triangle by columns; P adds up images. */
static ph_status gather(const ph_superelement *e, const int *master, int n, ph_csc *out,
                        ph_error *err)
{
    ph_status st = PH_OK;
    const ptrdiff_t nb = e->nd * e->nodes, all = size_of(e);
    const ptrdiff_t entries = (ptrdiff_t)n * (n + 1) / 2;
    PH_CHECK(entries <= PH_MATRIX_MOST, PH_EINVAL,
             "too many pairs of nodes on the faces");
    PH_ALLOC(out->start, n + 1, "pairs of the faces");
    PH_ALLOC(out->row, entries, "pairs of the faces");
    PH_ALLOC(out->value, entries, "pairs of the faces");
    out->n = n;
    for (int j = 0, p = 0; j < n; j++) {
        for (int i = j; i < n; i++)
            out->row[p++] = i;
        out->start[j + 1] = p;
    }
    for (ptrdiff_t i = 0; i < nb; i++)
        for (ptrdiff_t j = 0; j < nb; j++) {
            const int r = (master[i / e->nd] - 1) * e->nd + (int)(i % e->nd);
            const int q = (master[j / e->nd] - 1) * e->nd + (int)(j % e->nd);
            if (r >= q && q >= 0)
                out->value[out->start[q] + r - q] += e->stiffness[i * all + j];
        }
out:
    return st;
}

/* The periodic displacement that makes the forces of u on every pair vanish, added to u. */
static ph_status relax_pairs(const ph_superelement *e, const int *master,
                             ph_factor *factor, int n, double *u, double *f,
                             ph_error *err)
{
    ph_status st = PH_OK;
    double *rhs = NULL, *w = NULL;
    PH_ALLOC(rhs, n, "forces of pairs");
    PH_ALLOC(w, n, "displacements of pairs");
    pull(e, u, f);
    for (ptrdiff_t i = 0; i < e->nd * e->nodes; i++)
        if (master[i / e->nd] > 0)
            rhs[(master[i / e->nd] - 1) * e->nd + i % e->nd] -= f[i];
    PH_TRY(ph_i_factor_solve(factor, rhs, w, err));
    for (ptrdiff_t i = 0; i < e->nd * e->nodes; i++)
        if (master[i / e->nd] > 0) u[i] += w[(master[i / e->nd] - 1) * e->nd + i % e->nd];
out:
    free(rhs);
    free(w);
    return st;
}

/* C_ab = u_a . S u_b / V */
static ph_sym4 stiffness_of(const ph_superelement *e, int ns, double *const u[6],
                            double *f, double volume)
{
    ph_sym4 C = {.n = ns};
    for (int b = 0; b < ns; b++) {
        pull(e, u[b], f);
        for (int a = 0; a < ns; a++)
            for (ptrdiff_t i = 0; i < size_of(e); i++)
                C.m[a][b] += u[a][i] * f[i] / volume;
    }
    for (int a = 0; a < ns; a++)
        for (int b = 0; b < a; b++)
            C.m[a][b] = C.m[b][a] = 0.5 * (C.m[a][b] + C.m[b][a]);
    return C;
}

static ph_status both_stiffnesses(condensation *c, ph_error *err)
{
    ph_status st = PH_OK;
    ph_superelement *e = c->out;
    const ph_grid *rve = &c->run.problem->micro->grid;
    const double volume = rve->size[0] * rve->size[1] * rve->size[2];
    const int ns = ph_strains(e->kinematics);
    double *u[6] = {NULL}, *f = NULL;
    int *master = NULL, *of_box = NULL, count = 0;
    ph_csc pairs = {0};
    ph_factor *factor = NULL;
    PH_ALLOC(f, size_of(e), "forces of the faces");
    PH_ALLOC(master, e->nodes, "pairs of the faces");
    PH_ALLOC(of_box, ph_grid_cells(rve), "pairs of the faces");
    for (int a = 0; a < ns; a++) {
        PH_ALLOC(u[a], size_of(e), "displacements of the faces");
        affine(e, a, u[a]);
    }
    e->linear = stiffness_of(e, ns, u, f, volume);
    find_masters(c, of_box, master, &count);
    const int n = e->nd * (count - 1);
    if (n > 0) {
        PH_TRY(gather(e, master, n, &pairs, err));
        PH_TRY(ph_i_factor_new(&pairs, false, &factor, err));
    }
    for (int a = 0; n > 0 && a < ns; a++)
        PH_TRY(relax_pairs(e, master, factor, n, u[a], f, err));
    e->periodic = stiffness_of(e, ns, u, f, volume);
out:
    for (int a = 0; a < 6; a++)
        free(u[a]);
    free(f);
    free(master);
    free(of_box);
    ph_i_csc_clear(&pairs);
    ph_i_factor_free(&factor);
    return st;
}

ph_status ph_superelement_new(const ph_problem *problem, const ph_ctx *ctx,
                              ph_superelement **out, ph_error *err)
{
    PH_GIVEN(problem && out);
    ph_status st = PH_OK;
    ph_problem body = *problem;
    condensation c = {.run = {.problem = &body, .ctx = ctx}};
    *out = NULL;
    body.constraint = (ph_constraint_params){.kind = "linear_displacement"};
    body.solver = (ph_solver_params){0};
    body.keep_fields = false;
    PH_TRY(check(problem, err));
    PH_TRY(ph_i_run_begin(&c.run, err));
    PH_TRY(ph_i_run_prepare(&c.run, err));
    PH_TRY(ph_i_body_new(&c.run, &c.body, err));
    PH_ALLOC(c.out, 1, "a superelement");
    c.out->kinematics = problem->micro->grid.kinematics;
    c.out->nd = ph_displacements(c.out->kinematics);
    c.out->strains = c.out->kinematics == PH_GENERALISED_STRAIN;
    PH_TRY(number(&c, err));
    PH_TRY(take_apart(&c, err));
    PH_TRY(condense(&c, err));
    PH_TRY(both_stiffnesses(&c, err));
    *out = c.out;
    c.out = NULL;
out:
    clear(&c);
    return st;
}
