/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Increments of many points: which of them are one, who solves, what they answer. */
#include "effective/fe2.h"

#include <math.h>
#include <string.h>

/* As a loading: beyond it the stretches of bonds lose their digits. */
static const double MOST_STRAIN = 1e6;

/* A solve that a point asks for: of its state (viscoelastic), or its increment. */
typedef struct job {
    const ph_fe2_node *of;
    ptrdiff_t point;
} job;

/* Many points at once. */
typedef struct batch {
    ph_fe2 *f;
    ph_fe2_point *const *point;
    ptrdiff_t points;
    const double *dstrain;
    double dt;
    const ph_ctx *ctx;
    ph_fe2_node **child;     /* [points] held */
    ph_fe2_tangent *tangent; /* viscoelastic: held */
    job *job;                /* [njobs] */
    ptrdiff_t njobs;
    ph_status (*work)(struct batch *, ptrdiff_t point, const ph_ctx *, ph_error *);
} batch;

/* One caller's progress for several threads. */
typedef struct turnstile {
    const ph_ctx *ctx;
    pthread_mutex_t lock;
    bool stopped;
} turnstile;

static bool take_turns(void *user, const ph_progress *now)
{
    turnstile *t = user;
    pthread_mutex_lock(&t->lock);
    if (!t->stopped) t->stopped = !t->ctx->progress(t->ctx->user, now);
    bool go = !t->stopped;
    pthread_mutex_unlock(&t->lock);
    return go;
}

static void answer_elastic(ph_fe2 *f, ph_fe2_node *child)
{
    pthread_mutex_lock(&f->lock);
    child->tangent = f->first;
    for (int i = 0; i < f->ns; i++) {
        double sum = 0.0;
        for (int j = 0; j < f->ns; j++)
            sum += f->first.m[i][j] * child->s.strain[j] *
                   ph_i_fe2_scale(f->ns, j, true, true);
        child->s.stress[i] = sum * ph_i_fe2_scale(f->ns, i, false, false);
    }
    child->known = true;
    pthread_mutex_unlock(&f->lock);
}

static int by_work(const void *a, const void *b)
{
    const job *x = a, *y = b;
    const uintptr_t p = (uintptr_t)x->of, q = (uintptr_t)y->of;
    return p != q ? (p > q) - (p < q) : (x->point > y->point) - (x->point < y->point);
}

static int by_point(const void *a, const void *b)
{
    const job *x = a, *y = b;
    return (x->point > y->point) - (x->point < y->point);
}

/* Each job once, by the first point of all that ask for it. */
static void take_first(batch *w)
{
    ptrdiff_t n = 0;
    qsort(w->job, (size_t)w->njobs, sizeof *w->job, by_work);
    for (ptrdiff_t i = 0; i < w->njobs; i++)
        if (n == 0 || w->job[n - 1].of != w->job[i].of) w->job[n++] = w->job[i];
    w->njobs = n;
    qsort(w->job, (size_t)n, sizeof *w->job, by_point);
}

/* With the lock. */
static bool needs_work(const batch *w, ptrdiff_t i)
{
    if (w->child[i]->known) return false;
    const ph_fe2_step *step = w->point[i]->at->step;
    return w->f->kind == PH_FE2_FAILURE || !step || step->dt != w->dt;
}

static ph_status list_solves(batch *w, ph_error *err)
{
    ph_status st = PH_OK;
    const bool states = w->f->kind == PH_FE2_VISCOELASTIC;
    PH_ALLOC(w->job, w->points, "points");
    pthread_mutex_lock(&w->f->lock);
    for (ptrdiff_t i = 0; i < w->points; i++)
        if (needs_work(w, i))
            w->job[w->njobs++] = (job){states ? w->point[i]->at : w->child[i], i};
    pthread_mutex_unlock(&w->f->lock);
    take_first(w);
out:
    return st;
}

static ph_status do_solve(batch *w, ptrdiff_t i, const ph_ctx *ctx, ph_error *err)
{
    if (w->f->kind == PH_FE2_FAILURE) return ph_i_fe2_walk(w->f, w->child[i], ctx, err);
    return ph_i_fe2_prepare(w->f, w->point[i]->at, w->tangent, ctx, err);
}

/* Side by side; the failure of the first point is the one that is told. */
static ph_status do_jobs(batch *w, ph_error *err)
{
    ph_status first = PH_OK;
    ptrdiff_t failed = w->points;
    const int threads = w->ctx && w->ctx->threads > 0 ? w->ctx->threads : w->f->threads;
    turnstile t = {.ctx = w->ctx};
    const ph_ctx ctx = {w->ctx && w->ctx->progress ? take_turns : NULL, &t, threads};
    if (w->njobs == 1) return w->work(w, w->job[0].point, w->ctx, err);
    pthread_mutex_init(&t.lock, NULL);
#pragma omp parallel for num_threads(threads) schedule(dynamic, 1)
    for (ptrdiff_t j = 0; j < w->njobs; j++) {
        ph_error why = PH_ERROR_INIT;
        ph_status st = w->work(w, w->job[j].point, &ctx, &why);
        pthread_mutex_lock(&t.lock);
        if (st != PH_OK && w->job[j].point < failed) {
            failed = w->job[j].point;
            first = st;
            if (err) *err = why;
        }
        pthread_mutex_unlock(&t.lock);
    }
    pthread_mutex_destroy(&t.lock);
    return first;
}

static ph_status find_children(batch *w, ph_error *err)
{
    ph_status st = PH_OK;
    ph_fe2 *f = w->f;
    long hits = 0;
    PH_ALLOC(w->child, w->points, "increments");
    for (ptrdiff_t i = 0; i < w->points; i++)
        PH_TRY(ph_i_fe2_child(f, w->point[i]->at, w->dstrain + i * f->ns, w->dt,
                              &w->child[i], err));
    pthread_mutex_lock(&f->lock);
    for (ptrdiff_t i = 0; i < w->points; i++)
        hits += w->child[i]->known;
    f->counts.updates += (long)w->points;
    f->counts.hits += hits;
    pthread_mutex_unlock(&f->lock);
out:
    return st;
}

static bool is_known(ph_fe2 *f, const ph_fe2_node *child)
{
    pthread_mutex_lock(&f->lock);
    const bool known = child->known;
    pthread_mutex_unlock(&f->lock);
    return known;
}

static ph_status solve_batch(batch *w, ph_error *err)
{
    ph_status st = PH_OK;
    ph_fe2 *f = w->f;
    PH_TRY(find_children(w, err));
    if (f->kind == PH_FE2_VISCOELASTIC)
        PH_TRY(ph_i_fe2_tangent_of(f, w->dt, w->ctx, &w->tangent, err));
    if (f->kind != PH_FE2_ELASTIC) {
        PH_TRY(list_solves(w, err));
        PH_TRY(do_jobs(w, err));
    }
    for (ptrdiff_t i = 0; i < w->points; i++) {
        if (is_known(f, w->child[i])) continue;
        if (f->kind == PH_FE2_ELASTIC)
            answer_elastic(f, w->child[i]);
        else
            PH_TRY(ph_i_fe2_superpose(f, w->child[i], w->tangent, w->ctx, err));
    }
out:
    return st;
}

/* The points try their children; or nothing, where something failed. */
static void end_batch(batch *w, bool good)
{
    ph_fe2 *f = w->f;
    pthread_mutex_lock(&f->lock);
    for (ptrdiff_t i = 0; i < w->points; i++) {
        ph_i_fe2_drop(f, &w->point[i]->tried);
        if (!w->child || !w->child[i]) continue;
        if (good)
            w->point[i]->tried = w->child[i];
        else
            ph_i_fe2_drop(f, &w->child[i]);
    }
    ph_i_fe2_drop_tangent(f, &w->tangent);
    pthread_mutex_unlock(&f->lock);
    free(w->child);
    free(w->job);
}

static void tell(const batch *w, double *stress, double *tangent)
{
    const int ns = w->f->ns;
    for (ptrdiff_t i = 0; i < w->points; i++) {
        memcpy(stress + i * ns, w->child[i]->s.stress, sizeof *stress * (size_t)ns);
        if (tangent) ph_sym4_to_voigt(&w->child[i]->tangent, true, tangent + i * ns * ns);
    }
}

static ph_status check_points(const batch *w, ph_error *err)
{
    ph_status st = PH_OK;
    for (ptrdiff_t i = 0; i < w->points; i++)
        PH_CHECK(w->point[i] && w->point[i]->fe2 == w->f, PH_EINVAL,
                 "point %td is missing, or of another RVE", i);
out:
    return st;
}

static ph_status check_update(const batch *w, ph_error *err)
{
    ph_status st = PH_OK;
    const int ns = w->f->ns;
    PH_CHECK(isfinite(w->dt) && w->dt >= 0.0, PH_EINVAL,
             "dt must be finite and >= 0, got %g", w->dt);
    for (ptrdiff_t i = 0; i < w->points * ns; i++)
        PH_CHECK(isfinite(w->dstrain[i]), PH_EINVAL,
                 "strain increment %d of point %td is %g", (int)(i % ns) + 1, i / ns,
                 w->dstrain[i]);
    PH_TRY(check_points(w, err));
    for (ptrdiff_t i = 0; i < w->points * ns; i++) {
        double strain = w->point[i / ns]->at->s.strain[i % ns] + w->dstrain[i];
        PH_CHECK(fabs(strain) < MOST_STRAIN, PH_EINVAL,
                 "strain %d of point %td would be %g: must be below 1e6 in size",
                 (int)(i % ns) + 1, i / ns, strain);
    }
out:
    return st;
}

ph_status ph_fe2_update_all(ph_fe2_point *const *point, ptrdiff_t points,
                            const double *dstrain, double dt, double *stress,
                            double *tangent, const ph_ctx *ctx, ph_error *err)
{
    PH_GIVEN(point && dstrain && stress && points >= 0);
    if (points == 0) return PH_OK;
    PH_GIVEN(point[0] && point[0]->fe2);
    ph_status st = PH_OK;
    batch w = {.f = point[0]->fe2,
               .point = point,
               .points = points,
               .dstrain = dstrain,
               .dt = dt,
               .ctx = ctx,
               .work = do_solve};
    PH_TRY(check_update(&w, err));
    st = solve_batch(&w, err);
    if (st == PH_OK) tell(&w, stress, tangent);
    end_batch(&w, st == PH_OK);
out:
    return st;
}

ph_status ph_fe2_update(ph_fe2_point *point, const double *dstrain, double dt,
                        double *stress, double *tangent, const ph_ctx *ctx, ph_error *err)
{
    return ph_fe2_update_all(&point, 1, dstrain, dt, stress, tangent, ctx, err);
}

/* ---- accepting --------------------------------------------------------------------------- */

static ph_status list_blocks(batch *w, ph_error *err)
{
    ph_status st = PH_OK;
    PH_ALLOC(w->job, w->points, "points");
    for (ptrdiff_t i = 0; i < w->points; i++)
        if (w->point[i]->tried) w->job[w->njobs++] = (job){w->point[i]->tried, i};
    take_first(w);
out:
    return st;
}

static ph_status do_advance(batch *w, ptrdiff_t i, const ph_ctx *ctx, ph_error *err)
{
    (void)ctx;
    return ph_i_fe2_advance(w->f, w->point[i]->tried, err);
}

ph_status ph_fe2_accept_all(ph_fe2_point *const *point, ptrdiff_t points,
                            const ph_ctx *ctx, ph_error *err)
{
    PH_GIVEN(point && points >= 0);
    if (points == 0) return PH_OK;
    PH_GIVEN(point[0] && point[0]->fe2);
    ph_status st = PH_OK;
    const ph_ctx silent = {.threads = ctx ? ctx->threads : 0};
    ph_fe2 *f = point[0]->fe2;
    batch w = {
        .f = f, .point = point, .points = points, .ctx = &silent, .work = do_advance};
    PH_TRY(check_points(&w, err));
    if (f->kind == PH_FE2_VISCOELASTIC) {
        PH_TRY(list_blocks(&w, err));
        PH_TRY(do_jobs(&w, err));
    }
    pthread_mutex_lock(&f->lock);
    for (ptrdiff_t i = 0; i < points; i++) {
        if (!point[i]->tried) continue;
        ph_i_fe2_drop(f, &point[i]->at);
        point[i]->at = point[i]->tried;
        point[i]->tried = NULL;
    }
    pthread_mutex_unlock(&f->lock);
out:
    free(w.job);
    return st;
}

ph_status ph_fe2_accept(ph_fe2_point *point, ph_error *err)
{
    return ph_fe2_accept_all(&point, 1, NULL, err);
}
