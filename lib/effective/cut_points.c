/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effective/cut_points.h"

#include "effective/directions.h"

#include <math.h>
#include <string.h>

/* ---- the laminate of a cell ------------------------------------------------------------ */

/* Cut j with fraction f over the phases below k = j + 1; jump components from `at` on. */
static void add_jump(ph_cell_laminate *l, int n, int over, double f,
                     const double normal[3], int at)
{
    double N[6][3];
    ph_i_normal_matrix(n, normal, N);
    for (int k = 0; k <= over; k++)
        for (int i = 0; i < n; i++)
            for (int a = 0; a < (n == 6 ? 3 : 2); a++)
                l->G[k][i][at + a] = (k == over ? 1.0 - f : -f) * N[i][a];
}

/* What ph_i_stiffness_map_set makes of the same cuts. */
static void describe(const ph_relaxing_map *r, ptrdiff_t first, ph_cell_laminate *l)
{
    const ph_cut *cut = &r->micro->cuts[first];
    const ph_material *material = r->micro->materials;
    const int ncuts = (int)ph_i_cuts_of_cell(r->micro, first), n = r->map->ns,
              nd = n == 6 ? 3 : 2;
    memset(l->G, 0, sizeof l->G);
    l->nphases = ncuts + 1;
    l->njumps = 0;
    l->phase[0] = cut[0].base;
    l->share[0] = 1.0;
    double solid = material[cut[0].base].is_void ? 0.0 : 1.0;
    for (int j = 0; j < ncuts; j++) {
        bool hole = material[cut[j].material].is_void, empty = solid == 0.0;
        double f = ph_i_cut_fraction(&cut[j], hole, &solid);
        for (int k = 0; k <= j; k++)
            l->share[k] *= 1.0 - f;
        l->phase[j + 1] = cut[j].material;
        l->share[j + 1] = f;
        if (hole || empty) continue;
        double normal[3];
        ph_i_cut_normal(r->map, &r->micro->grid, &cut[j], normal);
        add_jump(l, n, j + 1, f, normal, l->njumps);
        l->njumps += nd;
    }
}

/* y += scale C x */
static void multiply(const ph_sym4 *c, double scale, const double *x, double *y)
{
    for (int i = 0; i < c->n; i++)
        for (int j = 0; j < c->n; j++)
            y[i] += scale * c->m[i][j] * x[j];
}

/* e_k = e + G_k a */
static void phase_strain(const ph_cell_laminate *l, int n, int k, const double *e,
                         const double *a, double *out)
{
    for (int i = 0; i < n; i++) {
        out[i] = e[i];
        for (int j = 0; j < l->njumps; j++)
            out[i] += l->G[k][i][j] * a[j];
    }
}

/* ---- one step at one point ------------------------------------------------------------- */

/* M, H, p and r of the header. */
typedef struct condensed {
    double M[PH_CELL_JUMPS][PH_CELL_JUMPS], H[6][PH_CELL_JUMPS], r[PH_CELL_JUMPS], p[6];
} condensed;

/* M and H from the tangents; M is left as its Cholesky factor. */
static bool condense(const ph_cell_laminate *l, int n, const ph_sym4 *tangent,
                     condensed *c)
{
    const int na = l->njumps;
    memset(c->H, 0, sizeof c->H);
    for (int a = 0; a < na; a++)
        memset(c->M[a], 0, sizeof c->M[a]);
    for (int k = 0; k < l->nphases; k++)
        for (int a = 0; a < na; a++) {
            double column[6], s[6] = {0};
            for (int i = 0; i < n; i++)
                column[i] = l->G[k][i][a];
            multiply(&tangent[l->phase[k]], l->share[k], column, s);
            for (int i = 0; i < n; i++)
                c->H[i][a] += s[i];
            for (int b = 0; b < na; b++)
                for (int i = 0; i < n; i++)
                    c->M[a][b] += s[i] * l->G[k][i][b];
        }
    for (int j = 0; j < na; j++)
        for (int i = j; i < na; i++) {
            double s = c->M[i][j];
            for (int k = 0; k < j; k++)
                s -= c->M[i][k] * c->M[j][k];
            if (i == j && !(s > 0.0)) return false;
            c->M[i][j] = i == j ? sqrt(s) : s / c->M[j][j];
        }
    return true;
}

/* x = M^-1 x */
static void solve(const condensed *c, int na, double *x)
{
    for (int i = 0; i < na; i++) {
        for (int k = 0; k < i; k++)
            x[i] -= c->M[i][k] * x[k];
        x[i] /= c->M[i][i];
    }
    for (int i = na - 1; i >= 0; i--) {
        for (int k = i + 1; k < na; k++)
            x[i] -= c->M[k][i] * x[k];
        x[i] /= c->M[i][i];
    }
}

/* A point: its cell's laminate and the strains that it remembers. */
typedef struct point {
    ph_cell_laminate l;
    ptrdiff_t cell, at; /* first jump */
    int entry;          /* whose laminate l is */
} point;

static void visit(const ph_cut_points *c, ptrdiff_t i, point *p)
{
    int entry = c->relax->mixed.index[c->list->point[i].cell];
    if (entry != p->entry)
        describe(c->relax, c->cut[entry - ph_i_first_mixture(c->relax->map)], &p->l);
    p->entry = entry;
    p->cell = c->list->point[i].cell;
    p->at = c->first[i];
}

/* p_k summed into p and r. `m` -1: the equilibrium part with the total strain. */
static void add_branch(const ph_cut_points *c, ptrdiff_t i, const point *p,
                       const ph_cut_state *s, int m, double scale, condensed *out)
{
    const ph_relaxing_map *r = c->relax;
    const int n = r->map->ns;
    const ptrdiff_t unknowns = c->list->nd * c->list->nodes;
    double e[6], ek[6];
    ph_i_bondlist_point_strain(c->list, i, m < 0 ? s->u : s->memory + m * unknowns,
                               m < 0 ? s->macro : s->macro_memory + 6 * m, e);
    const double *a = (m < 0 ? s->jump : s->jump_memory + m * c->size) + p->at;
    for (int k = 0; k < p->l.nphases; k++) {
        double stress[6] = {0};
        const ph_sym4 *C =
            (m < 0 ? r->infinity : r->branch + m * r->materials) + p->l.phase[k];
        phase_strain(&p->l, n, k, e, a, ek);
        multiply(C, scale * p->l.share[k], ek, stress);
        for (int j = 0; j < n; j++)
            out->p[j] += stress[j];
        for (int b = 0; b < p->l.njumps; b++)
            for (int j = 0; j < n; j++)
                out->r[b] += p->l.G[k][j][b] * stress[j];
    }
}

static ph_status prepare(const ph_cut_points *c, ptrdiff_t i, point *p,
                         const ph_cut_state *s, const ph_sym4 *tangent,
                         const double *decay, condensed *out, ph_error *err)
{
    ph_status st = PH_OK;
    visit(c, i, p);
    PH_CHECK(condense(&p->l, c->relax->map->ns, tangent, out), PH_ESINGULAR,
             "a cut cell (%td) is a laminate of phases that do not resist", p->cell);
    memset(out->p, 0, sizeof out->p);
    memset(out->r, 0, sizeof out->r);
    add_branch(c, i, p, s, -1, 1.0, out);
    for (int m = 0; m < c->relax->ntimes; m++)
        add_branch(c, i, p, s, m, decay[m], out);
out:
    return st;
}

ph_status ph_i_cut_points_load(const ph_cut_points *c, const ph_cut_state *s,
                               const ph_sym4 *tangent, const double *decay,
                               const uint8_t *region, double *f, double *stress,
                               ph_error *err)
{
    ph_status st = PH_OK;
    const int n = c->relax->map->ns;
    point p = {.entry = -1};
    condensed k;
    for (ptrdiff_t i = 0; i < c->list->points; i++) {
        PH_TRY(prepare(c, i, &p, s, tangent, decay, &k, err));
        solve(&k, p.l.njumps, k.r);
        for (int j = 0; j < n; j++)
            for (int b = 0; b < p.l.njumps; b++)
                k.p[j] -= k.H[j][b] * k.r[b];
        ph_i_bondlist_point_force(c->list, i, k.p, -1.0, f);
        for (int j = 0; j < n && (!region || region[p.cell]); j++)
            stress[j] += c->list->point[i].share * k.p[j];
    }
out:
    return st;
}

ph_status ph_i_cut_points_advance(const ph_cut_points *c, const ph_cut_state *s,
                                  const ph_sym4 *tangent, const double *decay,
                                  const double *ramp, const double *du,
                                  const double *dmacro, ph_error *err)
{
    ph_status st = PH_OK;
    const int n = c->relax->map->ns;
    point p = {.entry = -1};
    condensed k;
    for (ptrdiff_t i = 0; i < c->list->points; i++) {
        double e[6];
        PH_TRY(prepare(c, i, &p, s, tangent, decay, &k, err));
        ph_i_bondlist_point_strain(c->list, i, du, dmacro, e);
        for (int b = 0; b < p.l.njumps; b++)
            for (int j = 0; j < n; j++)
                k.r[b] += k.H[j][b] * e[j];
        solve(&k, p.l.njumps, k.r);
        for (int b = 0; b < p.l.njumps; b++) {
            s->jump[p.at + b] -= k.r[b];
            for (int m = 0; m < c->relax->ntimes; m++) {
                double *q = &s->jump_memory[m * c->size + p.at + b];
                *q = decay[m] * *q - ramp[m] * k.r[b];
            }
        }
    }
out:
    return st;
}

void ph_i_cut_points_sums(const ph_cut_points *c, const ph_cut_state *s,
                          const uint8_t *region, double *stress, double *energy,
                          double *dissipation)
{
    const ph_relaxing_map *r = c->relax;
    const ptrdiff_t unknowns = c->list->nd * c->list->nodes;
    const int n = r->map->ns;
    point p = {.entry = -1};
    for (ptrdiff_t i = 0; i < c->list->points; i++) {
        visit(c, i, &p);
        if (region && !region[p.cell]) continue;
        for (int m = -1; m < r->ntimes; m++) {
            double e[6], ek[6], twice = 0.0;
            ph_i_bondlist_point_strain(c->list, i,
                                       m < 0 ? s->u : s->memory + m * unknowns,
                                       m < 0 ? s->macro : s->macro_memory + 6 * m, e);
            const double *a = (m < 0 ? s->jump : s->jump_memory + m * c->size) + p.at;
            for (int k = 0; k < p.l.nphases; k++) {
                double t[6] = {0};
                const ph_sym4 *C =
                    (m < 0 ? r->infinity : r->branch + m * r->materials) + p.l.phase[k];
                phase_strain(&p.l, n, k, e, a, ek);
                multiply(C, c->list->point[i].share * p.l.share[k], ek, t);
                for (int j = 0; j < n; j++) {
                    stress[j] += t[j];
                    twice += t[j] * ek[j];
                }
            }
            *energy += twice;
            if (m >= 0) *dissipation += twice / r->time[m];
        }
    }
}

/* ---- all points ------------------------------------------------------------------------ */

static ph_status find_cuts(ph_cut_points *c, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_microstructure *micro = c->relax->micro;
    int next = 0;
    PH_ALLOC(c->cut, c->relax->map->count, "cut cells");
    for (ptrdiff_t i = 0, n; i < micro->ncuts; i += n) {
        n = ph_i_cuts_of_cell(micro, i);
        PH_CHECK(n <= PH_CELL_CUTS, PH_EINVAL,
                 "cell %td is cut %td times, stepping takes at most %d: take interface "
                 "node_centre",
                 micro->cuts[i].cell, n, PH_CELL_CUTS);
        c->cut[next++] = i;
    }
out:
    return st;
}

static ph_status count_jumps(ph_cut_points *c, ph_error *err)
{
    ph_status st = PH_OK;
    point p = {.entry = -1};
    PH_ALLOC(c->first, c->list->points + 1, "jumps of cut cells");
    for (ptrdiff_t i = 0; i < c->list->points; i++) {
        visit(c, i, &p);
        c->first[i + 1] = c->first[i] + p.l.njumps;
    }
    c->size = c->first[c->list->points];
out:
    return st;
}

ph_status ph_i_cut_points_new(const ph_grid *box, const ph_operator_params *params,
                              ph_relaxing_map *relax, ph_meter *meter,
                              ph_cut_points **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_cut_points *c = NULL;
    ph_operator_params only = *params;
    *out = NULL;
    if (!relax->has_cuts) return PH_OK;
    PH_ALLOC(c, 1, "cut cells");
    c->relax = relax;
    c->meter = meter;
    only.cut_only = true;
    PH_TRY(find_cuts(c, err));
    ph_i_relaxing_map_again(relax);
    PH_TRY(ph_i_bondlist_new(box, relax->map, &only, meter, &c->list, err));
    PH_TRY(count_jumps(c, err));
    meter->bytes += (size_t)(c->list->points + 1) * sizeof *c->first;
    if (meter->bytes > meter->peak) meter->peak = meter->bytes;
    *out = c;
    c = NULL;
out:
    ph_i_cut_points_free(&c);
    return st;
}

void ph_i_cut_points_free(ph_cut_points **points)
{
    if (!points || !*points) return;
    ph_cut_points *c = *points;
    if (c->list && c->first)
        c->meter->bytes -= (size_t)(c->list->points + 1) * sizeof *c->first;
    ph_i_bondlist_free(&c->list);
    free(c->cut);
    free(c->first);
    free(c);
    *points = NULL;
}
