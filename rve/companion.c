/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "companion.h"

#include "core/check.h"

#include <math.h>
#include <string.h>

/* Fewer nodes along an axis show no microstructure. */
enum { LEAST_NODES = 2 };
/* Of a companion with more nodes than the case: what is solved within seconds. */
static const double most_finer_cells = 1048576;

void ph_i_companion_clear(ph_i_companion *k)
{
    ph_microstructure_free(&k->micro);
    ph_packing_free(&k->packing);
    ph_crack_plan_free(&k->plan);
}

const char *ph_rve_companion_nodes(const ph_case *c, ptrdiff_t nodes[3], double *ratio)
{
    if (!c || !nodes || !ratio) return "an argument is missing";
    double product = 1.0;
    int axes = 0;
    for (int a = 0; a < 3; a++) {
        ptrdiff_t n = c->nodes[a];
        nodes[a] = n > 1 ? (n + 1) / 2 : n;
        if (n <= 1) continue;
        if (nodes[a] < LEAST_NODES) return "the grid is too coarse to be halved";
        product *= (double)n / (double)nodes[a];
        axes++;
    }
    if (axes == 0) return "the grid has one node";
    *ratio = pow(product, 1.0 / axes);
    return NULL;
}

static bool draws_nodes(const ph_packing *p)
{
    for (int i = 0; p && i < p->nkinds; i++)
        if (p->kind[i].counting == PH_COUNT_NODES) return true;
    return false;
}

/* Fillers drawn node by node are squares of the grid that they were drawn on: grids that
 * divide those squares show them. */
static bool shows_nodes(const ph_case *c)
{
    for (int a = 0; a < 3; a++)
        if (c->drawn_on[a] > 0 && c->nodes[a] % c->drawn_on[a]) return false;
    return true;
}

static bool is_bond(const ph_i_companion *k)
{
    const char *kind = k->problem->model.kind;
    return kind && strcmp(kind, "bond") == 0;
}

/* The horizon keeps its length, which is that of the interphase, and the strength of bonds. */
static void keep_horizon(ph_i_companion *k)
{
    ph_model_params *m = &k->coarse_problem.model;
    bool stands_for_length = m->horizon > 0.0 || is_bond(k) || k->problem->loading;
    if (m->horizon_is_length || !stands_for_length || !(k->horizon > 0.0)) return;
    m->horizon = k->horizon;
    m->horizon_is_length = true;
}

/* Half the spacing. */
static const char *refine(ph_i_companion *k)
{
    const ph_grid *g = &k->problem->micro->grid;
    double cells = 1.0;
    for (int a = 0; a < 3; a++) {
        k->coarse.nodes[a] = g->n[a] > 1 ? 2 * g->n[a] : g->n[a];
        cells *= (double)k->coarse.nodes[a];
    }
    k->ratio = 0.5;
    if (cells > most_finer_cells)
        return "fillers are drawn node by node: no coarser grid shows them, and a finer "
               "one has too many nodes";
    keep_horizon(k);
    return NULL;
}

/* Fillers in voxels are as those that are drawn node by node, where bonds ask which is which.
 * Voxels that a coarser grid mixes are cut cells, whatever the case says of its own. */
static ph_status build_voxels(ph_i_companion *k, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_microstructure *m = k->problem->micro;
    if (m->owner && is_bond(k)) {
        const char *no = refine(k);
        if (no)
            snprintf(k->why, sizeof k->why, "%s", no);
        else
            PH_TRY(ph_i_refine(m, &k->micro, err));
    } else {
        PH_TRY(ph_i_coarsen(m, k->coarse.nodes, &k->micro, err));
        k->coarse_problem.interface = PH_INTERFACE_COMPOSITE;
    }
out:
    return st;
}

static ph_status build_shapes(ph_i_companion *k, ph_error *err)
{
    ph_status st = PH_OK;
    if (k->c->nfillers > 0 && k->c->drawn_on[0] == 0)
        memcpy(k->coarse.drawn_on, k->c->nodes, sizeof k->coarse.drawn_on);
    PH_TRY(ph_rve_generate(&k->coarse, &k->micro, &k->packing, err));
    if (!draws_nodes(k->packing) || shows_nodes(&k->coarse)) return PH_OK;
    ph_microstructure_free(&k->micro);
    ph_packing_free(&k->packing);
    const char *no = refine(k);
    if (no)
        snprintf(k->why, sizeof k->why, "%s", no);
    else
        PH_TRY(ph_rve_generate(&k->coarse, &k->micro, &k->packing, err));
out:
    return st;
}

ph_status ph_i_companion_build(ph_i_companion *k, ph_error *err)
{
    ph_status st = PH_OK;
    ptrdiff_t nodes[3];
    k->coarse = *k->c;
    memcpy(k->coarse.nodes, k->problem->micro->grid.n, sizeof k->coarse.nodes);
    const char *no = ph_rve_companion_nodes(&k->coarse, nodes, &k->ratio);
    if (no) {
        snprintf(k->why, sizeof k->why, "%s", no);
        return PH_OK;
    }
    memcpy(k->coarse.nodes, nodes, sizeof nodes);
    k->coarse_problem = *k->problem;
    k->coarse_problem.keep_fields = false;
    if (k->problem->loading) keep_horizon(k);
    PH_TRY(k->c->voxels.file[0] ? build_voxels(k, err) : build_shapes(k, err));
    PH_TRY(ph_rve_cracks(&k->coarse, &k->plan, err));
    k->coarse_problem.micro = k->micro;
    if (k->problem->cracks) k->coarse_problem.cracks = &k->plan->cracks;
    if (k->problem->sequence) k->coarse_problem.sequence = &k->plan->sequence;
out:
    return st;
}

ph_status ph_i_companion_solve(ph_i_companion *k, const ph_problem *problem,
                               ph_result **out, char why[200], ph_error *err)
{
    ph_error own = PH_ERROR_INIT;
    ph_status st = ph_homogenise(problem, k->ctx, out, &own);
    if (*out) {
        k->seconds += (*out)->seconds;
        k->iterations += (*out)->work.iterations;
        k->applications += (*out)->work.applications;
        k->ffts += (*out)->work.ffts;
    }
    if (st == PH_OK) return st;
    ph_result_free(out);
    if (st == PH_ECANCELLED || st == PH_ENOMEM) {
        if (err) *err = own;
        return st;
    }
    snprintf(why, 200, "coarser grid: %.150s", own.msg);
    return PH_OK;
}
