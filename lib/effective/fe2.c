/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effective/fe2.h"

#include <math.h>
#include <omp.h>
#include <string.h>

static const size_t default_cache = (size_t)128 << 20;
static const double default_window = 0.01;
enum { DEFAULT_TANGENTS = 8 };

/* ---- the RVE ----------------------------------------------------------------------------- */

static ph_fe2_kind find_kind(const ph_problem *p)
{
    if (p->failure) return PH_FE2_FAILURE;
    for (int m = 0; m < p->micro->nmaterials; m++)
        if (p->micro->materials[m].relaxation) return PH_FE2_VISCOELASTIC;
    return PH_FE2_ELASTIC;
}

static ph_status check_input(const ph_problem *p, const ph_fe2_params *params,
                             ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(p->micro, PH_EINVAL, "no microstructure");
    PH_TRY(ph_microstructure_check(p->micro, err));
    PH_CHECK(params->tangents >= 0, PH_EINVAL, "tangents must be >= 0, got %d",
             params->tangents);
    PH_CHECK(params->window >= 0.0 && params->window <= 1.0, PH_EINVAL,
             "the window of an event must be in [0, 1], got %g", params->window);
    if (!p->failure) return PH_OK;
    PH_CHECK(p->failure->material, PH_EINVAL, "failure has no strengths");
    for (int m = 0; m < p->micro->nmaterials; m++)
        PH_CHECK(!p->micro->materials[m].relaxation, PH_EINVAL,
                 "material '%s' relaxes: failure takes elastic phases",
                 p->micro->materials[m].name);
out:
    return st;
}

static ph_status solve_elastic(ph_fe2 *f, const ph_ctx *ctx, ph_error *err)
{
    ph_status st = PH_OK;
    ph_result *res = NULL;
    PH_TRY(ph_homogenise(&f->problem, ctx, &res, err));
    f->first = res->stiffness;
    f->counts.iterations = res->work.iterations;
    f->counts.solves = res->work.loads;
out:
    ph_result_free(&res);
    return st;
}

/* The first worker, and what the virgin state has. */
static ph_status make_ready(ph_fe2 *f, ph_fe2_node *root, const ph_ctx *ctx,
                            ph_error *err)
{
    ph_status st = PH_OK;
    ph_fe2_worker *w = NULL;
    PH_TRY(ph_i_fe2_take_worker(f, ctx, &w, err));
    f->unknowns = (size_t)(w->run.op->layout.nd * w->run.op->layout.cells);
    if (f->kind == PH_FE2_VISCOELASTIC) {
        f->block = w->stepper->size;
        f->fingerprint = ph_sym4_norm(&w->run.result->voigt) + w->run.result->horizon;
        PH_DOUBLES(root->block, NULL, f->block, "the virgin state");
    } else {
        PH_TRY(ph_i_fe2_whole(f, w, root, err));
        f->family = w->run.family->count;
        f->cells = w->run.op->layout.cells;
        f->fingerprint = ph_sym4_norm(&f->first) + w->strengths->crossing.stretch;
    }
out:
    ph_i_fe2_return_worker(f, &w);
    return st;
}

ph_status ph_fe2_new(const ph_problem *problem, const ph_fe2_params *params,
                     const ph_ctx *ctx, ph_fe2 **out, ph_error *err)
{
    PH_GIVEN(problem && out);
    ph_status st = PH_OK;
    ph_fe2 *f = NULL;
    ph_fe2_node *root = NULL;
    static const ph_fe2_params defaults;
    *out = NULL;
    if (!params) params = &defaults;
    PH_TRY(check_input(problem, params, err));
    PH_ALLOC(f, 1, "FE2");
    f->owners = 1;
    pthread_mutex_init(&f->lock, NULL);
    f->problem = *problem;
    f->problem.loads = 0;
    f->problem.keep_fields = false;
    f->problem.sequence = NULL;
    f->problem.loading = NULL;
    f->kind = find_kind(problem);
    f->ns = ph_strains(problem->micro->grid.kinematics);
    f->threads = ctx && ctx->threads > 0 ? ctx->threads : omp_get_max_threads();
    f->budget = params->cache_bytes > 0 ? params->cache_bytes : default_cache;
    f->most_tangents = params->tangents > 0 ? params->tangents : DEFAULT_TANGENTS;
    f->window = params->window > 0.0 ? params->window : default_window;
    if (f->kind == PH_FE2_FAILURE) { /* says that bonds will break, no more */
        f->to = 1.0;
        f->loading = (ph_loading){.strain = {1.0},
                                  .ntargets = 1,
                                  .to = &f->to,
                                  .steps = 1,
                                  .window = f->window};
        f->problem.loading = &f->loading;
    }
    PH_TRY(ph_i_fe2_node_new(f, NULL, NULL, 0.0, &root, err));
    PH_TRY(f->kind == PH_FE2_ELASTIC ? solve_elastic(f, ctx, err)
                                     : make_ready(f, root, ctx, err));
    root->known = true;
    f->root = root;
    ph_i_fe2_plant(f, root, NULL);
    root = NULL;
    *out = f;
    f = NULL;
out:
    if (root) ph_i_fe2_drop(f, &root);
    ph_fe2_free(&f);
    return st;
}

/* One owner less; the last one takes all with it. */
static void disown(ph_fe2 *f)
{
    pthread_mutex_lock(&f->lock);
    const bool last = --f->owners <= 0;
    pthread_mutex_unlock(&f->lock);
    if (!last) return;
    while (f->worker) {
        ph_fe2_worker *w = f->worker;
        f->worker = w->next;
        ph_i_fe2_free_worker(f, &w);
    }
    ph_i_fe2_fell(f);
    while (f->tangents) {
        ph_fe2_tangent *t = f->tangents;
        f->tangents = t->next;
        ph_i_fe2_drop_tangent(f, &t);
    }
    pthread_mutex_destroy(&f->lock);
    free(f);
}

void ph_fe2_free(ph_fe2 **fe2)
{
    if (!fe2 || !*fe2) return;
    disown(*fe2);
    *fe2 = NULL;
}

ph_fe2_kind ph_fe2_kind_of(const ph_fe2 *fe2)
{
    return fe2 ? fe2->kind : PH_FE2_ELASTIC;
}

int ph_fe2_components(const ph_fe2 *fe2)
{
    return fe2 ? fe2->ns : 0;
}

void ph_fe2_counts_get(ph_fe2 *fe2, ph_fe2_counts *out)
{
    if (!out) return;
    memset(out, 0, sizeof *out);
    if (!fe2) return;
    pthread_mutex_lock(&fe2->lock);
    *out = fe2->counts;
    out->bytes = fe2->bytes + fe2->worker_bytes;
    pthread_mutex_unlock(&fe2->lock);
}

/* ---- a point ----------------------------------------------------------------------------- */

ph_status ph_fe2_point_new(ph_fe2 *fe2, ph_fe2_point **out, ph_error *err)
{
    PH_GIVEN(fe2 && fe2->root && out);
    ph_status st = PH_OK;
    ph_fe2_point *p = NULL;
    *out = NULL;
    PH_ALLOC(p, 1, "a point");
    p->fe2 = fe2;
    p->at = fe2->root;
    pthread_mutex_lock(&fe2->lock);
    fe2->owners++;
    ph_i_fe2_hold(fe2, p->at);
    pthread_mutex_unlock(&fe2->lock);
    *out = p;
out:
    return st;
}

void ph_fe2_reject(ph_fe2_point *point)
{
    if (!point || !point->fe2) return;
    pthread_mutex_lock(&point->fe2->lock);
    ph_i_fe2_drop(point->fe2, &point->tried);
    pthread_mutex_unlock(&point->fe2->lock);
}

void ph_fe2_point_free(ph_fe2_point **point)
{
    if (!point || !*point) return;
    ph_fe2 *f = (*point)->fe2;
    ph_fe2_reject(*point);
    pthread_mutex_lock(&f->lock);
    ph_i_fe2_drop(f, &(*point)->at);
    pthread_mutex_unlock(&f->lock);
    disown(f);
    free(*point);
    *point = NULL;
}

ph_status ph_fe2_point_state(const ph_fe2_point *point, ph_fe2_state *out, ph_error *err)
{
    PH_GIVEN(point && point->at && out);
    *out = point->at->s;
    return PH_OK;
}
