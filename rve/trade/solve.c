/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One row of a trade: the case with its overrides, solved as `perihom run` would. */
#include "trade/trade.h"

#include <math.h>
#include <string.h>
#include <time.h>

/* Short solutions are repeated for their seconds: clocks tick. */
static const double short_time = 0.02;
enum { REPEATS = 3 };

double ph_i_cpu_seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double wall_seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

ph_status ph_i_trade_add_set(ph_trade_row *row, const char *set, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(row->nsets < PH_TRADE_SETS && strlen(set) < sizeof row->set[0], PH_EINVAL,
             "%.80s: too many or too long overrides", set);
    snprintf(row->set[row->nsets++], sizeof row->set[0], "%s", set);
    size_t at = strlen(row->setting);
    snprintf(row->setting + at, sizeof row->setting - at, "%s%s", at ? " " : "", set);
out:
    return st;
}

/* ---- operations ---- */

/* Bonds of a family: cells in the ball, or the corners of a cell. */
static double bonds_of(const ph_result *r, int axes)
{
    double ball = axes == 3 ? 4.18879 : axes == 2 ? 3.14159 : 2.0;
    for (int a = 0; a < 3; a++)
        if (r->grid.n[a] > 1) ball *= r->horizon / r->grid.h[a];
    return fmax(ball, ldexp(1, axes));
}

/* Strain from the bonds, force to them: a multiplication and an addition each. */
static double cell_operations(const ph_result *r)
{
    int ns = r->stiffness.n, nd = ph_displacements(r->grid.kinematics), axes = 0;
    const char *route = r->route ? r->route : "";
    for (int a = 0; a < 3; a++)
        axes += r->grid.n[a] > 1;
    double stress = 2.0 * ns * ns, each = 4.0 * nd * axes;
    if (strcmp(route, "stencil") == 0) return each * bonds_of(r, axes) + stress;
    if (strcmp(route, "bonds") == 0) return 8.0 * axes * bonds_of(r, axes);
    if (strcmp(route, "convolution") == 0) return each + stress; /* the rest is FFTs */
    return each * ldexp(1, axes) + stress;
}

double ph_trade_work(const ph_result *r)
{
    if (!r) return 0;
    double n = (double)(ph_grid_cells(&r->grid) + r->work.collar);
    int nd = ph_displacements(r->grid.kinematics);
    double transform = 2.5 * n * fmax(1, log2(n));
    return (double)r->work.ffts * transform +
           n * ((double)r->work.applications * cell_operations(r) +
                (double)r->work.iterations * (10.0 * nd + 4.0 * nd * nd));
}

/* ---- one row ---- */

static bool keep_going(void *user, const ph_progress *now)
{
    const ph_i_trade *s = user;
    const ph_trade_progress p = {s->t->nrows, s->planned, s->t->cpu, NULL};
    (void)now;
    return !s->params->progress || s->params->progress(s->params->user, &p);
}

static void account(const ph_result *r, ph_trade_row *row)
{
    row->iterations += (int)r->work.iterations;
    row->applications += r->work.applications;
    row->ffts += r->work.ffts;
    if (r->work.peak_bytes > row->bytes) row->bytes = r->work.peak_bytes;
    row->work += ph_trade_work(r);
    row->nodes = ph_grid_cells(&r->grid);
}

/* One realisation, its values added to those of the row. */
static ph_status solve_once(ph_i_trade *s, const ph_case *c, uint64_t realisation,
                            ph_trade_row *row, double *values, ph_error *err)
{
    ph_status st = PH_OK;
    ph_result *result = NULL;
    const ph_scenario one = {c, realisation, s->t->nconstants, s->t->constant};
    const ph_ctx ctx = {keep_going, s, row->threads};
    PH_TRY(ph_i_scenario_solve(&one, &ctx, &result, err));
    for (int k = 0; k < one.noutputs; k++)
        PH_TRY(ph_quantity_value(&one.output[k], result, &values[k], err));
    account(result, row);
out:
    ph_result_free(&result);
    return st;
}

/* Mean over the realisations; their scatter in `error` until the row is judged. */
static ph_status solve_row(ph_i_trade *s, const ph_case *c, ph_trade_row *row,
                           ph_error *err)
{
    ph_status st = PH_OK;
    double value[PH_TRADE_CONSTANTS], square[PH_TRADE_CONSTANTS] = {0};
    int n = row->realisations;
    double cpu = ph_i_cpu_seconds(), wall = wall_seconds();
    memset(row->value, 0, sizeof row->value);
    for (int i = 0; i < n; i++) {
        uint64_t which = n == 1 ? c->realisation : (uint64_t)i;
        PH_TRY(solve_once(s, c, which, row, value, err));
        for (int k = 0; k < s->t->nconstants; k++) {
            double d = value[k] - row->value[k];
            row->value[k] += d / (i + 1);
            square[k] += d * (value[k] - row->value[k]);
        }
    }
    row->cpu = ph_i_cpu_seconds() - cpu;
    row->seconds = wall_seconds() - wall;
    row->error = 0;
    for (int k = 0; k < s->t->nconstants && n > 1; k++) {
        double se = sqrt(square[k] / (n - 1) / n) / fabs(row->value[k]);
        row->error = fmax(row->error, se);
    }
out:
    return st;
}

/* The least of a few runs where one takes no time at all. */
static ph_status solve_timed(ph_i_trade *s, const ph_case *c, ph_trade_row *row,
                             ph_error *err)
{
    ph_status st = PH_OK;
    ph_trade_row again = *row;
    PH_TRY(solve_row(s, c, row, err));
    for (int i = 1; i < REPEATS && row->cpu < short_time; i++) {
        ph_trade_row next = again;
        PH_TRY(solve_row(s, c, &next, err));
        row->cpu = fmin(row->cpu, next.cpu);
        row->seconds = fmin(row->seconds, next.seconds);
    }
out:
    return st;
}

/* What a row computes: the resolved case, the constants, how often. */
static ph_status hash_row(const ph_i_trade *s, const ph_case *c, const ph_trade_row *row,
                          uint64_t *hash, ph_error *err)
{
    ph_status st = PH_OK;
    char *json = NULL;
    PH_TRY(ph_case_to_json(c, &json, err));
    *hash = ph_i_hash(PH_I_HASH_START, json, strlen(json) + 1);
    for (int k = 0; k < s->t->nconstants; k++)
        *hash =
            ph_i_hash(*hash, s->t->constant[k].name, strlen(s->t->constant[k].name) + 1);
    *hash = ph_i_hash(*hash, &row->threads, sizeof row->threads);
    *hash = ph_i_hash(*hash, &row->realisations, sizeof row->realisations);
out:
    free(json);
    return st;
}

static void refuse(ph_trade_row *row, ph_trade_state state, const ph_error *why)
{
    row->state = state;
    row->status = why->status;
    row->error = NAN;
    snprintf(row->reason, sizeof row->reason, "%s",
             why->msg[0] ? why->msg : ph_status_text(why->status));
}

/* The case of a row; NULL where it is not admissible, which the row then says. */
static ph_status read_case(const ph_i_trade *s, ph_trade_row *row, ph_case **out,
                           ph_error *err)
{
    ph_status st = PH_OK;
    const ph_trade_params *p = s->params;
    size_t n = p->nsets + (size_t)row->nsets;
    const char **sets = NULL;
    ph_error why = PH_ERROR_INIT;
    PH_ALLOC(sets, n, "overrides");
    for (size_t i = 0; i < n; i++)
        sets[i] = i < p->nsets ? p->sets[i] : row->set[i - p->nsets];
    st = ph_case_read(p->path, sets, n, out, NULL, &why);
    if (st == PH_EINVAL || st == PH_EUNPHYSICAL) {
        refuse(row, PH_TRADE_REFUSED, &why);
        st = PH_OK;
    } else if (st != PH_OK && err) {
        *err = why;
    }
out:
    free(sets);
    return st;
}

/* Seconds that a row will take, from the last one with the same settings on another grid. */
static double foreseen(const ph_i_trade *s, const ph_trade_row *row, double cells)
{
    double most = 0;
    for (int i = 0; i < s->t->nrows; i++) {
        const ph_trade_row *r = &s->t->row[i];
        if (r->state == PH_TRADE_DONE && r->nodes > 0 && r->realisations == 1)
            most = r->cpu / (double)r->nodes;
    }
    return most * cells * row->realisations;
}

static ph_status put_row(ph_i_trade *s, const ph_trade_row *row, uint64_t hash,
                         ph_error *err)
{
    ph_status st = PH_OK;
    ph_trade *t = s->t;
    if (t->nrows == t->capacity) {
        int capacity = 2 * t->capacity + 64;
        ph_trade_row *grown = realloc(t->row, (size_t)capacity * sizeof *grown);
        PH_CHECK(grown, PH_ENOMEM, "no memory for %d rows", capacity);
        t->row = grown;
        uint64_t *more = realloc(s->hash, (size_t)capacity * sizeof *more);
        PH_CHECK(more, PH_ENOMEM, "no memory for %d rows", capacity);
        s->hash = more;
        t->capacity = capacity;
    }
    s->hash[t->nrows] = hash;
    t->row[t->nrows++] = *row;
    t->cpu += row->cpu;
    const ph_trade_progress now = {t->nrows, s->planned, t->cpu, row};
    PH_CHECK(!s->params->progress || s->params->progress(s->params->user, &now),
             PH_ECANCELLED, "interrupted");
out:
    return st;
}

/* Failures of the setting are an answer; those of the machine are not. */
static bool is_answer(ph_status st)
{
    return st == PH_ENOCONV || st == PH_ESINGULAR || st == PH_EINVAL ||
           st == PH_EUNPHYSICAL;
}

ph_status ph_i_trade_take(ph_i_trade *s, const ph_trade_row *wanted, ph_error *err)
{
    ph_status st = PH_OK;
    ph_trade_row row = *wanted;
    ph_case *c = NULL;
    ph_error why = PH_ERROR_INIT;
    uint64_t hash = ph_i_hash(PH_I_HASH_START, row.setting, strlen(row.setting) + 1);
    double budget = s->params->budget;
    PH_TRY(read_case(s, &row, &c, err));
    if (c) PH_TRY(hash_row(s, c, &row, &hash, err));
    for (int i = 0; i < s->t->nrows; i++)
        if (s->hash[i] == hash) goto out; /* asked already */
    if (!c) {
        PH_TRY(put_row(s, &row, hash, err));
        goto out;
    }
    double cells = 1;
    for (int a = 0; a < 3; a++)
        cells *= c->nodes[a] > 0 ? (double)c->nodes[a] : 1;
    row.nodes = (ptrdiff_t)cells;
    if (ph_i_trade_recall(s->kept, hash, &row)) {
        PH_TRY(put_row(s, &row, hash, err));
        goto out;
    }
    if (budget > 0 && s->t->cpu + foreseen(s, &row, cells) > budget) {
        snprintf(why.msg, sizeof why.msg, "would not fit into the budget of %g s",
                 budget);
        refuse(&row, PH_TRADE_SKIPPED, &why);
        s->t->complete = false;
        PH_TRY(put_row(s, &row, hash, err));
        goto out;
    }
    st = solve_timed(s, c, &row, &why);
    if (is_answer(st)) {
        bool tried = st == PH_ENOCONV || st == PH_ESINGULAR;
        refuse(&row, tried ? PH_TRADE_FAILED : PH_TRADE_REFUSED, &why);
        st = PH_OK;
    } else if (st != PH_OK && err) {
        *err = why;
    }
    PH_TRY(st);
    if (s->params->folder)
        PH_TRY(
            ph_i_trade_journal_add(s->params->folder, s->t->nconstants, hash, &row, err));
    PH_TRY(put_row(s, &row, hash, err));
out:
    ph_case_free(&c);
    return st;
}
