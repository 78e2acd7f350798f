/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Companions of a case: the same geometry on a coarser grid, and what they say. */
#include "core/check.h"
#include "perihom_error_bar.h"

#include <math.h>
#include <string.h>

/* Fewer nodes along an axis show no microstructure. */
enum { LEAST_NODES = 2 };

/* What is made for one set of error bars. */
typedef struct companions {
    const ph_case *c;
    const ph_problem *problem; /* of the case, on its grid */
    const ph_ctx *ctx;
    ph_result *result;
    ph_case coarse; /* borrows the arrays of the case */
    ph_microstructure *micro;
    ph_packing *packing;
    ph_crack_plan *plan;
    ph_problem coarse_problem;
    double ratio;
    ph_sym4 matrix;
    char why[200];
    ph_error_bar *bar;
} companions;

static void clear(companions *k)
{
    ph_microstructure_free(&k->micro);
    ph_packing_free(&k->packing);
    ph_crack_plan_free(&k->plan);
    free(k->bar);
}

/* ---- the coarser grid ---- */

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

/* Why no coarser grid shows the same, or NULL. */
static const char *no_companion(const companions *k)
{
    const ph_case *c = k->c;
    if (c->loading.ntargets > 0)
        return "bonds break: on another grid they take another path";
    if (c->voxels.file[0])
        return "voxels are as they are: no coarser grid shows the same";
    if (strcmp(k->result->route ? k->result->route : "", "analytic") == 0)
        return NULL; /* nothing is solved there either */
    return NULL;
}

static bool draws_nodes(const ph_packing *p)
{
    for (int i = 0; p && i < p->nkinds; i++)
        if (p->kind[i].counting == PH_COUNT_NODES) return true;
    return false;
}

static void borrow_problem(companions *k)
{
    k->coarse_problem = *k->problem;
    k->coarse_problem.micro = k->micro;
    k->coarse_problem.cracks = &k->plan->cracks;
    k->coarse_problem.sequence = &k->plan->sequence;
    k->coarse_problem.keep_fields = false;
}

/* The same shapes, fillers and cracks on the coarser grid. */
static ph_status build(companions *k, ph_error *err)
{
    ph_status st = PH_OK;
    const char *no = no_companion(k);
    k->coarse = *k->c;
    memcpy(k->coarse.nodes, k->problem->micro->grid.n, sizeof k->coarse.nodes);
    if (!no) no = ph_rve_companion_nodes(&k->coarse, k->coarse.nodes, &k->ratio);
    if (no) {
        snprintf(k->why, sizeof k->why, "%s", no);
        return PH_OK;
    }
    if (k->c->nfillers > 0 && k->c->drawn_on[0] == 0)
        memcpy(k->coarse.drawn_on, k->c->nodes, sizeof k->coarse.drawn_on);
    PH_TRY(ph_rve_generate(&k->coarse, &k->micro, &k->packing, err));
    if (draws_nodes(k->packing)) {
        snprintf(k->why, sizeof k->why,
                 "fillers are drawn node by node: a coarser grid does not show them");
        goto out;
    }
    PH_TRY(ph_rve_cracks(&k->coarse, &k->plan, err));
    borrow_problem(k);
out:
    return st;
}

/* A companion that cannot be solved is a reason, not a failure; an interruption and a lack of
 * memory are. */
static ph_status solve(companions *k, const ph_problem *problem, const char *what,
                       ph_result **out, ph_error *err)
{
    ph_error own = PH_ERROR_INIT;
    ph_status st = ph_homogenise(problem, k->ctx, out, &own);
    if (*out) {
        k->bar->seconds += (*out)->seconds;
        k->bar->iterations += (*out)->work.iterations;
        k->bar->applications += (*out)->work.applications;
        k->bar->ffts += (*out)->work.ffts;
    }
    if (st == PH_OK) return st;
    ph_result_free(out);
    if (st == PH_ECANCELLED || st == PH_ENOMEM) {
        if (err) *err = own;
        return st;
    }
    snprintf(k->why, sizeof k->why, "%s: %.150s", what, own.msg);
    return PH_OK;
}

/* ---- fractions: reached, and asked for ---- */

/* What is painted by node centres against what cut cells hold, which is exact. */
static ph_status painted_off(companions *k, double *off, ph_error *err)
{
    ph_status st = PH_OK;
    ph_case exact = k->coarse;
    ph_microstructure *micro = NULL;
    double *fraction = NULL;
    exact.interface = PH_INTERFACE_COMPOSITE;
    PH_TRY(ph_rve_paint(&exact, k->packing, &micro, err));
    PH_ALLOC(fraction, micro->nmaterials, "fractions");
    ph_microstructure_fractions(micro, fraction);
    for (int m = 0; m < micro->nmaterials; m++)
        if (m != k->c->matrix) *off += fabs(fraction[m] - k->result->fractions[m]);
out:
    ph_microstructure_free(&micro);
    free(fraction);
    return st;
}

static ph_status fractions(companions *k, ph_error_evidence *e, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_case *c = k->c;
    if (c->voxels.file[0]) return PH_OK;
    PH_TRY(ph_sym4_reduce(&c->materials[c->matrix].stiffness, c->kinematics, &k->matrix,
                          err));
    e->matrix = &k->matrix;
    e->share = 1.0 - k->result->fractions[c->matrix];
    for (int i = 0; k->packing && i < k->packing->nkinds; i++) {
        const ph_filler_report *r = &k->packing->kind[i];
        if (isfinite(r->target)) e->share_off += fabs(r->target - r->reached);
    }
    if (k->result->interface == PH_INTERFACE_NODE_CENTRE && k->micro)
        PH_TRY(painted_off(k, &e->share_off, err));
out:
    return st;
}

/* ---- all of it ---- */

static ph_status judge(companions *k, ph_error *err)
{
    ph_status st = PH_OK;
    ph_result *coarse = NULL;
    ph_error_evidence e = {.result = k->result, .parts = k->c->error_parts};
    PH_TRY(build(k, err));
    if (!k->why[0]) PH_TRY(solve(k, &k->coarse_problem, "coarser grid", &coarse, err));
    if (coarse) {
        e.coarse = &coarse->stiffness;
        e.ratio = k->ratio;
    }
    e.no_coarse = k->why;
    PH_TRY(fractions(k, &e, err));
    PH_TRY(ph_error_bar_estimate(&e, k->bar, err));
    if (coarse) memcpy(k->bar->nodes, coarse->grid.n, sizeof k->bar->nodes);
out:
    ph_result_free(&coarse);
    return st;
}

ph_status ph_rve_error_bar(const ph_case *c, const ph_problem *problem, const ph_ctx *ctx,
                           ph_result *result, ph_error *err)
{
    PH_GIVEN(c && problem && problem->micro && result);
    ph_status st = PH_OK;
    companions k = {.c = c, .problem = problem, .ctx = ctx, .result = result};
    unsigned all = (1u << ph_strains(result->grid.kinematics)) - 1u;
    bool whole = (result->loads & all) == all && problem->nconstants == 0;
    if (c->error_parts == 0 || !result->converged || !whole) return PH_OK;
    PH_ALLOC(k.bar, 1, "error bars");
    PH_TRY(judge(&k, err));
    free(result->error_bar);
    result->error_bar = k.bar;
    k.bar = NULL;
out:
    clear(&k);
    return st;
}
