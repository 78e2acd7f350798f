/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The model's answers: one table a value of the unknowns, filled once and kept. */
#include "calibrate/calibrate.h"

#include <math.h>
#include <omp.h>
#include <string.h>

enum { MISSING, ANSWER, FAILED };

double ph_i_unknown_value(const ph_fit_unknown *x, double u)
{
    if (u <= 0) return x->from;
    if (u >= 1) return x->to;
    return x->log ? x->from * pow(x->to / x->from, u) : x->from + (x->to - x->from) * u;
}

double ph_i_unknown_slope(const ph_fit_unknown *x, double u)
{
    return x->log ? ph_i_unknown_value(x, u) * log(x->to / x->from) : x->to - x->from;
}

double ph_i_unknown_place(const ph_fit_unknown *x, double value)
{
    double u = x->log ? log(value / x->from) / log(x->to / x->from)
                      : (value - x->from) / (x->to - x->from);
    return fmin(fmax(u, 0), 1);
}

ph_status ph_i_samples_init(ph_i_samples *s, const ph_fit_problem *problem,
                            const double *sigma, const ph_ctx *ctx, ph_error *err)
{
    ph_status st = PH_OK;
    *s = (ph_i_samples){
        .problem = problem, .sigma = sigma, .ctx = ctx, .stage = "calibration"};
    s->last_failure = (ph_error)PH_ERROR_INIT;
    PH_ALLOC(s->n, problem->npoints, "a calibration");
out:
    return st;
}

static void set_free(ph_i_set *set)
{
    if (!set) return;
    free(set->y);
    free(set->state);
    free(set);
}

void ph_i_samples_free(ph_i_samples *s)
{
    for (int i = 0; i < s->nsets; i++)
        set_free(s->set[i]);
    free(s->set);
    free(s->n);
    free(s->dropped);
    *s = (ph_i_samples){.n = NULL};
}

/* Room for `capacity` realisations; the answers keep their places. */
static ph_status set_grow(ph_i_set *set, const ph_fit_problem *p, int capacity,
                          ph_error *err)
{
    ph_status st = PH_OK;
    double *y = NULL;
    unsigned char *state = NULL;
    if (set->capacity >= capacity) goto out;
    PH_ALLOC(y, (size_t)p->npoints * capacity * p->noutputs, "realisations");
    PH_ALLOC(state, (size_t)p->npoints * capacity, "realisations");
    for (int i = 0; i < p->npoints && set->capacity > 0; i++) {
        memcpy(state + (size_t)i * capacity, set->state + (size_t)i * set->capacity,
               (size_t)set->capacity);
        memcpy(y + (size_t)i * capacity * p->noutputs,
               set->y + (size_t)i * set->capacity * p->noutputs,
               (size_t)set->capacity * p->noutputs * sizeof *y);
    }
    free(set->y);
    free(set->state);
    set->y = y;
    set->state = state;
    set->capacity = capacity;
    y = NULL;
    state = NULL;
out:
    free(y);
    free(state);
    return st;
}

ph_status ph_i_samples_raise(ph_i_samples *s, const int *n, ph_error *err)
{
    ph_status st = PH_OK;
    unsigned char *dropped = NULL;
    int np = s->problem->npoints, capacity = s->capacity;
    for (int p = 0; p < np; p++)
        if (n[p] > capacity) capacity = n[p];
    if (capacity > s->capacity) {
        PH_ALLOC(dropped, (size_t)np * capacity, "realisations");
        for (int p = 0; p < np && s->capacity > 0; p++)
            memcpy(dropped + (size_t)p * capacity, s->dropped + (size_t)p * s->capacity,
                   (size_t)s->capacity);
        free(s->dropped);
        s->dropped = dropped;
        s->capacity = capacity;
    }
    for (int p = 0; p < np; p++)
        if (n[p] > s->n[p]) s->n[p] = n[p];
out:
    return st;
}

static ph_i_set *find(const ph_i_samples *s, const double u[K])
{
    for (int i = s->nsets - 1; i >= 0; i--)
        if (memcmp(s->set[i]->u, u, s->problem->nunknowns * sizeof *u) == 0)
            return s->set[i];
    return NULL;
}

const ph_i_set *ph_i_samples_at(const ph_i_samples *s, const double u[K])
{
    return find(s, u);
}

/* The set at u, made where there is none, with room for what is in use. */
static ph_status need(ph_i_samples *s, const double u[K], ph_i_set **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_set *made = NULL, *set = find(s, u);
    if (!set) {
        if (s->nsets == s->sets_capacity) {
            int capacity = s->sets_capacity ? 2 * s->sets_capacity : 32;
            ph_i_set **grown = realloc(s->set, (size_t)capacity * sizeof *grown);
            PH_CHECK(grown, PH_ENOMEM, "no memory for %d parameter sets", capacity);
            s->set = grown;
            s->sets_capacity = capacity;
        }
        PH_ALLOC(made, 1, "a parameter set");
        memcpy(made->u, u, s->problem->nunknowns * sizeof *u);
        set = s->set[s->nsets++] = made;
    }
    PH_TRY(set_grow(set, s->problem, s->capacity, err));
    *out = set;
out:
    return st;
}

bool ph_i_samples_uses(const ph_i_samples *s, int point, int r)
{
    return r < s->n[point] && !s->dropped[(size_t)point * s->capacity + r];
}

int ph_i_samples_count(const ph_i_samples *s, int point, int *dropped)
{
    int count = 0;
    for (int r = 0; r < s->n[point]; r++)
        count += ph_i_samples_uses(s, point, r);
    if (dropped) *dropped = s->n[point] - count;
    return count;
}

static size_t slot(const ph_i_set *set, int point, int r)
{
    return (size_t)point * set->capacity + r;
}

double ph_i_samples_answer(const ph_i_samples *s, const ph_i_set *set, int point, int r,
                           int output)
{
    return set->y[slot(set, point, r) * s->problem->noutputs + output];
}

/* ---- running the model */

typedef struct task {
    ph_i_set *set;
    int point, r;
} task;

typedef struct batch {
    ph_i_samples *s;
    task *task;
    long ntasks, done;
    ph_status stop; /* PH_OK, or what ended it */
    ph_error stop_err;
    long first_failed; /* so that what is said of failures does not depend on threads */
} batch;

static bool is_answer(const batch *b, const task *t, const double *y)
{
    const ph_fit_problem *p = b->s->problem;
    for (int i = 0; i < p->nmeasurements; i++)
        if (p->measurement[i].point == t->point && !isfinite(y[p->measurement[i].output]))
            return false;
    return true;
}

static bool ends_all(ph_status st)
{
    return st == PH_ECANCELLED || st == PH_ENOMEM || st == PH_EIO || st == PH_EINTERNAL;
}

/* False: stop. */
static bool report(batch *b)
{
    const ph_ctx *ctx = b->s->ctx;
    if (!ctx || !ctx->progress) return true;
    long total = b->ntasks < 1000000000 ? b->ntasks : 1000000000;
    const ph_progress now = {
        .stage = b->s->stage, .load = (int)b->done, .loads = (int)total};
    return ctx->progress(ctx->user, &now);
}

static void settle(batch *b, long i, ph_status st, const ph_error *why)
{
    if (ends_all(st)) {
        if (b->stop == PH_OK) {
            b->stop = st;
            b->stop_err = *why;
        }
        return;
    }
    b->s->solves++;
    b->done++;
    if (st == PH_OK) return;
    b->s->failures++;
    if (b->first_failed >= 0 && b->first_failed < i) return;
    b->first_failed = i;
    b->s->last_failure = *why;
}

static void run_task(batch *b, long i)
{
    const ph_fit_problem *p = b->s->problem;
    task *t = &b->task[i];
    ph_error why = PH_ERROR_INIT;
    double value[K];
    bool go;
#pragma omp critical(ph_calibrate)
    {
        go = b->stop == PH_OK;
        if (go && !report(b)) {
            b->stop = PH_FAIL(&b->stop_err, PH_ECANCELLED, "interrupted");
            go = false;
        }
    }
    if (!go) return;
    for (int j = 0; j < p->nunknowns; j++)
        value[j] = ph_i_unknown_value(&p->unknown[j], t->set->u[j]);
    double *y = t->set->y + slot(t->set, t->point, t->r) * p->noutputs;
    ph_status st = p->model(p->user, value, t->point, (uint64_t)t->r, y, &why);
    if (st == PH_OK && !is_answer(b, t, y))
        st = PH_FAIL(&why, PH_EINVAL, "the model gives no number");
    if (!ends_all(st))
        t->set->state[slot(t->set, t->point, t->r)] = st == PH_OK ? ANSWER : FAILED;
#pragma omp critical(ph_calibrate)
    settle(b, i, st, &why);
}

/* Failed realisations drop out everywhere, or the value of the unknowns is refused. */
static ph_status judge(ph_i_samples *s, ph_i_set *set, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_fit_problem *p = s->problem;
    for (int i = 0; i < p->npoints && !set->refused; i++) {
        int used = 0, failed = 0;
        for (int r = 0; r < s->n[i]; r++) {
            if (!ph_i_samples_uses(s, i, r)) continue;
            used++;
            failed += set->state[slot(set, i, r)] == FAILED;
        }
        set->refused = 2 * failed > used;
    }
    if (set->refused) goto out;
    for (int i = 0; i < p->npoints; i++) {
        int dropped;
        for (int r = 0; r < s->n[i]; r++)
            if (set->state[slot(set, i, r)] == FAILED)
                s->dropped[(size_t)i * s->capacity + r] = 1;
        int used = ph_i_samples_count(s, i, &dropped);
        PH_CHECK(used >= dropped && used > 0, PH_ENOCONV,
                 "data point %d: %d of %d realisations fail: %s", i + 1, dropped,
                 used + dropped, s->last_failure.msg);
    }
out:
    return st;
}

static ph_status collect(batch *b, int m, ph_i_set **set, ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_samples *s = b->s;
    size_t most = 0;
    for (int p = 0; p < s->problem->npoints; p++)
        most += (size_t)s->n[p];
    PH_ALLOC(b->task, most * m, "realisations");
    for (int i = 0; i < m; i++) {
        bool again = false; /* the same set twice in one batch */
        for (int k = 0; k < i; k++)
            again |= set[k] == set[i];
        for (int p = 0; p < s->problem->npoints && !again && !set[i]->refused; p++)
            for (int r = 0; r < s->n[p]; r++)
                if (ph_i_samples_uses(s, p, r) &&
                    set[i]->state[slot(set[i], p, r)] == MISSING)
                    b->task[b->ntasks++] = (task){set[i], p, r};
    }
out:
    return st;
}

static void residuals_of(const ph_i_samples *s, const ph_i_set *set, double *f)
{
    const ph_fit_problem *p = s->problem;
    for (int i = 0; i < p->nmeasurements; i++) {
        const ph_fit_measurement *m = &p->measurement[i];
        double sum = 0;
        int count = 0;
        for (int r = 0; r < s->n[m->point] && !set->refused; r++) {
            if (!ph_i_samples_uses(s, m->point, r)) continue;
            sum += ph_i_samples_answer(s, set, m->point, r, m->output);
            count++;
        }
        f[i] = count ? (sum / count - m->value) / s->sigma[i] : (double)NAN;
    }
}

static int threads(const ph_i_samples *s)
{
    return s->ctx && s->ctx->threads > 0 ? s->ctx->threads : omp_get_max_threads();
}

ph_status ph_i_samples_residuals(void *user, int m, const double *u, double *f,
                                 ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_samples *s = user;
    batch b = {.s = s, .first_failed = -1, .stop_err = PH_ERROR_INIT};
    ph_i_set **set = NULL;
    PH_ALLOC(set, m, "parameter sets");
    for (int i = 0; i < m; i++)
        PH_TRY(need(s, u + (size_t)i * K, &set[i], err));
    PH_TRY(collect(&b, m, set, err));
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads(s)) if (b.ntasks > 1)
    for (long i = 0; i < b.ntasks; i++)
        run_task(&b, i);
    if (b.stop != PH_OK) {
        st = PH_FAIL(err, b.stop, "%s", b.stop_err.msg);
        goto out;
    }
    for (int i = 0; i < m; i++)
        PH_TRY(judge(s, set[i], err));
    for (int i = 0; i < m; i++)
        residuals_of(s, set[i], f + (size_t)i * s->problem->nmeasurements);
out:
    free(b.task);
    free(set);
    return st;
}
