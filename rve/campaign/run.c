/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A campaign from what is on disk to what is asked for. */
#include "campaign/campaign.h"

#ifdef _OPENMP
#include <omp.h>
#endif

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

typedef struct engine {
    const ph_campaign *c;
    const ph_campaign_params *params;
    ph_i_store store;
    ph_i_tally tally;
    ph_i_pool pool;
    ph_campaign_progress now;
    FILE *costs;     /* what realisations cost, or NULL */
    size_t nknown;   /* entries that were there before, sorted */
    int64_t *issued; /* [npoints] realisations below this are there, or with a worker */
    int *ready;      /* ring of points that may have something to issue */
    int first_ready, nready;
    bool *is_ready;
    ph_i_task
        again[PH_I_WORKERS * PH_I_QUEUE]; /* tasks of dead workers: of all at once */
    int nagain;
    int64_t outstanding, computed;
    double started, synced, shown,
        spent;     /* spent: seconds of all realisations together */
    bool foreseen; /* it was looked whether the budget is enough */
    char event[256];
} engine;

double ph_i_clock(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- in the worker */

/* What can be read off the fillers instead of a solution. */
static ph_status describe(const ph_scenario *s, ph_evaluation *v, ph_error *err)
{
    ph_status st = PH_OK;
    ph_case c = *s->c; /* borrows its arrays */
    ph_microstructure *micro = NULL;
    ph_packing *packing = NULL;
    double start = ph_i_clock();
    c.realisation = s->realisation;
    PH_TRY(ph_rve_generate(&c, &micro, &packing, err));
    PH_TRY(ph_rve_describe(&c, packing, micro, v->value, err));
    v->seconds = ph_i_clock() - start;
out:
    ph_packing_free(&packing);
    ph_microstructure_free(&micro);
    return st;
}

static ph_status work(void *user, const ph_i_task *task, ph_i_record *out)
{
    const engine *e = user;
    const ph_campaign *c = e->c;
    ph_error err = PH_ERROR_INIT;
    ph_evaluation v = {0};
    int point = task->point % c->npoints;
    const ph_scenario s = {.c = ph_i_slot_case(c, task->point),
                           .realisation = ph_campaign_realisation(c, point, task->i),
                           .noutputs = c->noutputs,
                           .output = ph_i_slot_output(c, task->point)};
    const ph_ctx ctx = {.threads = e->now.threads};
#ifdef _OPENMP
    omp_set_num_threads(e->now.threads);
#endif
    ph_status st = ph_i_is_fillers(c, task->point) ? describe(&s, &v, &err)
                   : e->params->evaluate ? e->params->evaluate(e->params->evaluate_user,
                                                               &s, point, &v, &err)
                                         : ph_scenario_evaluate(&s, &ctx, &v, &err);
    memcpy(out->value, v.value, sizeof out->value);
    out->iterations = (int)v.work.iterations;
    out->seconds = v.seconds;
    out->work = v.work;
    for (int k = 0; st == PH_OK && k < c->noutputs && !ph_i_is_fillers(c, task->point);
         k++)
        if (!isfinite(v.value[k]))
            st = PH_FAIL(&err, PH_ESINGULAR, "%s is not finite", c->output[k].name);
    if (st != PH_OK)
        snprintf(out->message, sizeof out->message, "%s",
                 err.msg[0] ? err.msg : ph_status_text(st));
    return st;
}

/* ---- which realisation is next */

static bool is_mine(const engine *e, int point, int64_t i)
{
    int n = e->params->shards, k = e->params->shard - 1;
    if (n <= 1) return true;
    if (e->c->nmodels > 1) return point % e->c->npoints % n == k;
    return e->c->judged >= 0 ? point % n == k : (i * e->c->npoints + point) % n == k;
}

static bool is_known(const engine *e, int point, int64_t i)
{
    size_t lo = 0, hi = e->nknown;
    while (lo < hi) {
        size_t mid = (lo + hi) / 2;
        const ph_i_entry *x = &e->store.entry[mid];
        if (x->point < point || (x->point == point && x->i < i))
            lo = mid + 1;
        else
            hi = mid;
    }
    const ph_i_entry *x = &e->store.entry[lo];
    return lo < e->nknown && x->point == point && x->i == i &&
           !(x->failed && e->params->retry_failed);
}

static void make_ready(engine *e, int point)
{
    if (e->is_ready[point]) return;
    e->is_ready[point] = true;
    e->ready[(e->first_ready + e->nready++) % ph_i_slots(e->c)] = point;
}

/* All its models that want more than was issued. */
static void make_point_ready(engine *e, int point)
{
    for (int s = point; s < ph_i_slots(e->c); s += e->c->npoints)
        if (e->issued[s] < ph_i_tally_wanted(&e->tally, s)) make_ready(e, s);
}

/* The next realisation to compute, or false: nothing is certain now. */
static bool next_task(engine *e, ph_i_task *task)
{
    if (e->nagain > 0) {
        *task = e->again[--e->nagain];
        return true;
    }
    while (e->nready > 0) {
        int p = e->ready[e->first_ready];
        int64_t wanted = ph_i_tally_wanted(&e->tally, p);
        while (e->issued[p] < wanted) {
            int64_t i = e->issued[p]++;
            if (!is_mine(e, p, i) || is_known(e, p, i)) continue;
            *task = (ph_i_task){.point = p, .i = i};
            return true;
        }
        e->is_ready[p] = false;
        e->first_ready = (e->first_ready + 1) % ph_i_slots(e->c);
        e->nready--;
    }
    return false;
}

/* Enough in the queue of a worker to bridge a sync. */
static int queue_depth(const engine *e)
{
    if (e->computed == 0) return 2;
    double each = e->spent / (double)e->computed,
           depth = 2.0 + 2.0 * fmax(e->store.sync_seconds, 1e-3) / fmax(each, 1e-6);
    return depth < PH_I_QUEUE ? (int)depth : PH_I_QUEUE;
}

/* Up to n more tasks for a worker, in one message. False: there are no more. */
static bool give(engine *e, int worker, int n)
{
    ph_i_task task[PH_I_QUEUE];
    int count = 0;
    while (count < n && next_task(e, &task[count]))
        count++;
    if (count > 0 && ph_i_pool_send(&e->pool, worker, task, count))
        e->outstanding += count;
    else /* it is dying; ph_i_pool_wait will say so */
        for (int k = 0; k < count; k++)
            e->again[e->nagain++] = task[k];
    return count == n;
}

/* Queues are filled when they are half empty; short ones one task each in turn, so that the
 * last tasks are spread over all workers. */
static void issue(engine *e)
{
    int depth = queue_depth(e), most = depth > 4 ? depth : 1;
    for (int level = depth > 4 ? depth : 1; level <= depth; level++)
        for (int w = 0; w < e->pool.n; w++) {
            int count = e->pool.worker[w].count, free = level - count;
            if (e->pool.worker[w].pid == 0 || free <= 0 || 2 * free < most) continue;
            if (!give(e, w, free < most ? free : most)) return;
        }
}

/* ---- results */

static ph_status take(engine *e, const ph_i_record *r, ph_error *err)
{
    ph_status st = PH_OK;
    int64_t before = ph_i_tally_wanted(&e->tally, r->point);
    PH_TRY(ph_i_store_add(&e->store, r, err));
    PH_TRY(ph_i_tally_add(&e->tally, r, err));
    if (e->c->nmodels > 1)
        make_point_ready(e, r->point % e->c->npoints);
    else if (ph_i_tally_wanted(&e->tally, r->point) > before)
        make_ready(e, r->point);
    e->computed++;
    e->spent += r->seconds;
    e->now.point = r->point % e->c->npoints;
    e->now.failed += r->status != PH_OK && r->point < e->c->npoints;
    /* buffered, not synced: what is lost of it is not missed */
    if (e->costs)
        fprintf(e->costs, "%d,%lld,%.6g,%ld,%ld,%ld,%zu\n", r->point, (long long)r->i,
                r->seconds, r->work.loads, r->work.applications, r->work.ffts,
                r->work.peak_bytes);
out:
    return st;
}

/* The one it was working on is tried once more; those behind it never began. */
static ph_status take_death(engine *e, int w, const char *how, ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_worker *worker = &e->pool.worker[w];
    snprintf(e->event, sizeof e->event, "%s", how);
    e->now.event = e->event;
    e->outstanding -= worker->count;
    for (int k = worker->count - 1; k >= 0; k--) {
        ph_i_task task = worker->queue[(worker->first + k) % PH_I_QUEUE];
        if (k == 0 && task.attempt > 0) {
            ph_i_record r = {.point = task.point, .i = task.i, .status = PH_EINTERNAL};
            snprintf(r.message, sizeof r.message, "twice %s", how);
            PH_TRY(take(e, &r, err));
            continue;
        }
        task.attempt += k == 0;
        if (e->nagain < (int)(sizeof e->again / sizeof *e->again))
            e->again[e->nagain++] = task;
    }
    PH_TRY(ph_i_pool_renew(&e->pool, w, err));
out:
    return st;
}

/* ---- progress */

/* Realisations of a point that are missing, as far as they can be foreseen. */
static double missing_of(const engine *e, int p)
{
    const ph_stopping *rule = &e->c->stopping;
    const ph_i_point_tally *t = &e->tally.point[p];
    const ph_sequence *s = &t->output[e->c->judged >= 0 ? e->c->judged : 0];
    if (t->done) return 0;
    double n = (double)ph_i_tally_wanted(&e->tally, p);
    ph_interval i = ph_sequence_interval(s);
    if (e->c->judged >= 0 && s->n > 1) {
        double d = rule->half_width > 0 ? rule->half_width
                                        : rule->relative_half_width * fabs(i.mean);
        n = fmax(n, (double)s->n * pow(i.half_width / d, 2));
    }
    return fmin(n, (double)rule->at_most) - (double)t->next;
}

static double missing(const engine *e)
{
    double left = 0.0;
    if (e->params->shards > 1 || e->c->nmodels > 1) return NAN;
    for (int p = 0; p < e->c->npoints; p++)
        left += missing_of(e, p);
    return left;
}

static double time_to_go(const engine *e)
{
    if (e->computed == 0) return NAN;
    return missing(e) * (e->spent / (double)e->computed) / e->pool.n;
}

static bool report(engine *e)
{
    ph_campaign_progress *now = &e->now;
    const ph_i_point_tally *t = &e->tally.point[now->point];
    if (!e->params->progress) return true;
    now->realisations = (int64_t)e->store.count;
    now->wanted = now->points_done = 0;
    for (int p = 0; p < ph_i_slots(e->c); p++) {
        now->wanted += ph_i_tally_wanted(&e->tally, p);
        now->points_done += p < e->c->npoints && e->tally.point[p].done;
    }
    now->seconds = ph_i_clock() - e->started;
    now->to_go = time_to_go(e);
    now->mean = ph_sequence_interval(&t->output[e->c->judged >= 0 ? e->c->judged : 0]);
    bool go_on = e->params->progress(e->params->user, now);
    now->event = NULL;
    e->shown = ph_i_clock();
    return go_on;
}

/* A sync is worth twenty times what it takes. */
static ph_status sync_if_due(engine *e, bool idle, double now, ph_error *err)
{
    double every = fmin(fmax(20.0 * e->store.sync_seconds, 0.05), 2.0);
    if (!idle && now - e->synced < every) return PH_OK;
    ph_status st = ph_i_store_sync(&e->store, err);
    if (e->costs) fflush(e->costs); /* what the next run knows of the time it takes */
    e->synced = ph_i_clock();
    return st;
}

/* ---- the budget */

/* Do the pilots tell how many it takes, and enough of this run how long? */
static bool can_foresee(const engine *e)
{
    if (e->foreseen || e->computed < e->pool.n || e->computed < 4) return false;
    for (int p = 0; p < e->c->npoints && e->c->judged >= 0; p++)
        if (e->tally.point[p].output[e->c->judged].stage == 0 && !e->tally.point[p].done)
            return false;
    return isfinite(time_to_go(e));
}

/* What the rest of the budget makes of the widest interval: share of what is missing. */
static double afforded(const engine *e, double share)
{
    double worst = 0;
    for (int p = 0; p < e->c->npoints; p++) {
        const ph_sequence *s = &e->tally.point[p].output[e->c->judged];
        ph_interval i = ph_sequence_interval(s);
        double n = (double)s->n, scale = e->c->stopping.half_width > 0 ? 1 : fabs(i.mean);
        worst =
            fmax(worst, i.half_width / scale * sqrt(n / (n + share * missing_of(e, p))));
    }
    return worst;
}

static ph_status refuse(const engine *e, double left, ph_error *err)
{
    const ph_stopping *rule = &e->c->stopping;
    double takes = time_to_go(e), more = missing(e);
    bool absolute = rule->half_width > 0;
    double per = absolute ? 1 : 100,
           wanted = absolute ? rule->half_width : rule->relative_half_width;
    const char *unit = absolute ? "" : " %";
    if (e->c->judged < 0)
        return PH_FAIL(
            err, PH_ENOCONV,
            "budget.seconds: %.3g are left, and the %.0f realisations that are "
            "missing take about %.2g; it is enough for about %.0f",
            left, more, takes, floor(more * left / takes));
    return PH_FAIL(
        err, PH_ENOCONV,
        "budget.seconds: %.3g are left, and an interval of %.3g%s to each side "
        "takes about %.2g: %.0f realisations more; what is left affords about "
        "%.2g%s",
        left, per * wanted, unit, takes, more, per * afforded(e, left / takes), unit);
}

/* Is the budget over, or (once, after the pilots) sure to be over too early? */
static ph_status check_budget(engine *e, double now, ph_error *err)
{
    double all = e->params->seconds > 0 ? e->params->seconds : e->c->seconds;
    double left = all - (now - e->started);
    if (!(all > 0)) return PH_OK;
    if (left <= 0)
        return PH_FAIL(
            err, PH_ENOCONV,
            "budget.seconds: %.3g are over; what was computed is kept, the same "
            "command goes on with as many",
            all);
    if (!can_foresee(e)) return PH_OK;
    e->foreseen = true;
    return time_to_go(e) > left ? refuse(e, left, err) : PH_OK;
}

static ph_status loop(engine *e, ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_record r;
    char how[200];
    int worker;
    for (;;) {
        issue(e);
        if (e->outstanding == 0 && e->nagain == 0) break;
        int what = ph_i_pool_wait(&e->pool, 0.05, &worker, &r, how, sizeof how);
        if (what == 1) {
            e->outstanding--;
            PH_TRY(take(e, &r, err));
        } else if (what == 2) {
            PH_TRY(take_death(e, worker, how, err));
        }
        double now = ph_i_clock();
        PH_TRY(sync_if_due(e, what == 0, now, err));
        if (e->outstanding > 0) PH_TRY(check_budget(e, now, err));
        if (now - e->shown > 0.1 || e->now.event)
            PH_CHECK(report(e), PH_ECANCELLED, "interrupted");
    }
out:
    return st;
}

/* ---- the whole */

static ph_status prepare(engine *e, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_campaign *c = e->c;
    char path[1100];
    PH_ALLOC(e->issued, ph_i_slots(c), "the points");
    PH_ALLOC(e->ready, ph_i_slots(c), "the points");
    PH_ALLOC(e->is_ready, ph_i_slots(c), "the points");
    PH_TRY(ph_i_tally_init(&e->tally, c, err));
    PH_TRY(ph_i_tally_load(&e->tally, &e->store, e->params->retry_failed, err));
    e->nknown = e->store.count;
    for (size_t k = 0; k < e->nknown; k++)
        e->now.failed += e->store.entry[k].failed && !e->params->retry_failed;
    for (int p = 0; p < ph_i_slots(c); p++)
        make_ready(e, p);
    snprintf(path, sizeof path, "%s/costs.csv", e->store.folder);
    bool fresh = access(path, F_OK) != 0;
    e->costs = fopen(path, "a");
    if (fresh && e->costs)
        fputs("point,i,seconds,loads,applications,ffts,bytes\n", e->costs);
out:
    return st;
}

static bool anything_to_do(engine *e)
{
    ph_i_task task;
    if (!next_task(e, &task)) return false;
    e->again[e->nagain++] = task;
    return true;
}

static ph_status check_params(const ph_campaign *c, const ph_campaign_params *p,
                              ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(c && p && p->folder, PH_EINVAL, "NULL campaign, parameters or folder");
    PH_CHECK(p->shards == 0 || (p->shard >= 1 && p->shard <= p->shards), PH_EINVAL,
             "shard %d of %d: from 1 to the number of shards", p->shard, p->shards);
    PH_CHECK(p->jobs >= 0 && p->jobs <= 256 && p->threads >= 0, PH_EINVAL,
             "%d jobs of %d threads: 0 to 256 jobs are admissible", p->jobs, p->threads);
    for (int i = 0; i < c->npoints; i++)
        PH_CHECK(!c->point[i].c || !ph_i_is_open(c->point[i].c), PH_EINVAL, "%s",
                 ph_i_open_words);
    PH_CHECK(!(c->relative_error > 0) || c->nmodels > 1 ||
                 c->stopping.relative_half_width > 0,
             PH_EINVAL, "%s", ph_i_grid_words);
    PH_CHECK(c->nfactors == 0 || (c->sizes && c->sizes->chosen), PH_EINVAL,
             "the size of the RVE is not chosen: ph_campaign_choose_size");
out:
    return st;
}

ph_status ph_campaign_run(const ph_campaign *c, const ph_campaign_params *params,
                          ph_campaign_result **out, ph_error *err)
{
    ph_status st = PH_OK;
    engine e = {.c = c, .params = params, .started = ph_i_clock()};
    e.store = (ph_i_store){.lock = -1, .fd = -1};
    PH_CHECK(out, PH_EINVAL, "NULL result");
    *out = NULL;
    PH_TRY(check_params(c, params, err));
    PH_TRY(ph_i_store_open(&e.store, params->folder, c, err));
    PH_TRY(prepare(&e, err));
    e.now.points = c->npoints;
    e.now.stage = params->stage;
    if (anything_to_do(&e)) {
        double bytes = c->memory > 0 ? ph_i_crew_bytes(c, c->memory) : 0;
        PH_CHECK(bytes <= c->memory, PH_ENOCONV,
                 "budget.memory: a realisation takes about %.2g bytes, %.3g are allowed",
                 bytes, c->memory);
        ph_i_crew_choose(c, params, &e.now.workers, &e.now.threads);
        PH_TRY(ph_i_pool_start(&e.pool, e.now.workers, work, &e,
                               (const int[2]){e.store.lock, e.store.fd}, err));
        st = loop(&e, err);
        ph_i_pool_stop(&e.pool);
        ph_status synced = ph_i_store_sync(&e.store, st == PH_OK ? err : NULL);
        if (st == PH_OK) st = synced;
        if (st == PH_OK) report(&e);
        if (st != PH_OK && st != PH_ECANCELLED && st != PH_ENOCONV) goto out;
    }
    ph_status summed = ph_i_result_make(&e.store, out, st == PH_OK ? err : NULL);
    if (st == PH_OK) st = summed;
    if (st == PH_OK && (*out)->failed > 0)
        st = PH_FAIL(err, PH_EPARTIAL, "%lld of %lld realisations failed",
                     (long long)(*out)->failed, (long long)(*out)->realisations);
out:
    if (e.costs) fclose(e.costs);
    ph_i_tally_clear(&e.tally);
    ph_i_store_close(&e.store);
    free(e.issued);
    free(e.ready);
    free(e.is_ready);
    return st;
}
