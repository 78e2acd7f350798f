/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which settings are tried, in which order. */
#include "trade/trade.h"

#include <math.h>
#include <string.h>

/* Cells of the finest grid, where nobody says. */
static const double finest_cells = 3e5;
enum { COARSEST = 4 };

/* What the ladder of grids is crossed with. */
static const char *const crossed[] = {
    "",
    "model.points=nodes",
    "microstructure.interface=node_centre",
    "model.points=nodes;microstructure.interface=node_centre",
    "model.kind=local",
    "model.kind=local;microstructure.interface=node_centre",
    "model.crack_tips=0.42",
};
static const char *const loose[] = {"solver.tolerance=1e-2", "solver.tolerance=1e-3",
                                    "solver.tolerance=1e-4"};

void ph_trade_free(ph_trade **t)
{
    if (!t || !*t) return;
    free((*t)->row);
    free(*t);
    *t = NULL;
}

static bool is_turned(const ph_i_trade *s, const char *knob)
{
    const ph_trade_params *p = s->params;
    for (size_t i = 0; i < p->nknobs; i++)
        if (strcmp(p->knobs[i], knob) == 0) return true;
    return p->nknobs == 0;
}

static const ph_knob *knob_called(const char *name)
{
    for (size_t i = 0; i < ph_nknobs; i++)
        if (strcmp(ph_knobs[i].info.name, name) == 0) return &ph_knobs[i];
    return NULL;
}

static bool applies(const ph_i_trade *s, const char *name)
{
    const ph_knob *knob = knob_called(name);
    return knob && is_turned(s, name) && !knob->refuses(s->c);
}

/* ---- the ladder ---- */

static int longest_axis(const ph_case *c)
{
    int a = 0;
    for (int d = 1; d < 3; d++)
        if (c->nodes[d] > c->nodes[a]) a = d;
    return a;
}

static ptrdiff_t nodes_along(const ph_case *c, int axis, ptrdiff_t n)
{
    double share = (double)c->nodes[axis] / (double)c->nodes[longest_axis(c)];
    ptrdiff_t k = (ptrdiff_t)floor((double)n * share + 0.5);
    return c->nodes[axis] <= 1 ? c->nodes[axis] : k < 2 ? 2 : k;
}

static double cells_at(const ph_case *c, ptrdiff_t n)
{
    double cells = 1;
    for (int a = 0; a < 3; a++)
        cells *= c->nodes[a] > 0 ? (double)nodes_along(c, a, n) : 1;
    return cells;
}

/* 4, 6, 8, 12, 16, 24 ... and the case's own. */
static void make_ladder(ph_i_trade *s)
{
    const ph_case *c = s->c;
    ptrdiff_t own = c->nodes[longest_axis(c)], finest = s->params->finest;
    bool last = false;
    s->nrungs = 1;
    s->rung[0] = s->c->accuracy.relative > 0 ? own : 0;
    if (!applies(s, "nodes") || own < 1) return;
    if (finest < 1) {
        finest = 2 * own;
        while (finest > COARSEST && cells_at(c, finest) > finest_cells)
            finest--;
    }
    ptrdiff_t least = c->nfillers > 0 ? own / 4 : COARSEST;
    s->nrungs = 0;
    for (ptrdiff_t n = COARSEST; !last && s->nrungs + 2 < PH_I_TRADE_RUNGS;
         n = n % 3 == 0 ? n / 3 * 4 : n / 2 * 3) {
        last = n >= finest;
        ptrdiff_t here = last ? finest : n;
        if (here < least) continue;
        bool between = s->nrungs == 0 || s->rung[s->nrungs - 1] < own;
        if (between && own < here) s->rung[s->nrungs++] = own;
        s->rung[s->nrungs++] = here;
    }
    if (s->nrungs == 0) s->nrungs = 1; /* the finest shows no fillers: the case alone */
}

/* "[128, 128]" */
static void grid_text(const ph_case *c, ptrdiff_t n, char *text, size_t size)
{
    int axes = c->kinematics == PH_SPACE ? 3 : 2;
    size_t at = (size_t)snprintf(text, size, "[");
    for (int a = 0; a < axes && at < size; a++)
        at += (size_t)snprintf(text + at, size - at, "%s%td", a ? "," : "",
                               n ? nodes_along(c, a, n) : c->nodes[a]);
    if (at < size) snprintf(text + at, size - at, "]");
}

static ph_status set_grid(const ph_i_trade *s, ptrdiff_t n, ph_trade_row *row,
                          ph_error *err)
{
    ph_status st = PH_OK;
    char grid[64], set[96];
    if (n == 0) goto out;
    grid_text(s->c, n, grid, sizeof grid);
    snprintf(set, sizeof set, "microstructure.nodes=%s", grid);
    PH_TRY(ph_i_trade_add_set(row, set, err));
    if (s->c->nfillers == 0 || s->c->drawn_on[0] > 0) goto out;
    grid_text(s->c, 0, grid, sizeof grid); /* the same fillers on every grid */
    snprintf(set, sizeof set, "microstructure.drawn_on=%s", grid);
    PH_TRY(ph_i_trade_add_set(row, set, err));
out:
    return st;
}

/* Overrides with semicolons between them. */
static ph_status set_words(ph_trade_row *row, const char *words, ph_error *err)
{
    ph_status st = PH_OK;
    char one[160];
    while (*words) {
        size_t n = strcspn(words, ";");
        snprintf(one, sizeof one, "%.*s", (int)n, words);
        PH_TRY(ph_i_trade_add_set(row, one, err));
        words += n + (words[n] == ';');
    }
out:
    return st;
}

/* ---- rows ---- */

static ph_status take(ph_i_trade *s, const char *knob, const char *words, ptrdiff_t n,
                      int threads, ph_error *err)
{
    ph_status st = PH_OK;
    ph_trade_row row = {.threads = threads, .realisations = 1};
    snprintf(row.knob, sizeof row.knob, "%s", knob);
    snprintf(row.family, sizeof row.family, "%s", words);
    PH_TRY(set_grid(s, n, &row, err));
    PH_TRY(set_words(&row, words, err));
    PH_TRY(ph_i_trade_take(s, &row, err));
out:
    return st;
}

static int threads_of(const ph_i_trade *s)
{
    return s->params->threads > 0 ? s->params->threads : 1;
}

/* May this crossing be tried at all? */
static bool is_crossed(const ph_i_trade *s, const char *words)
{
    if (!words[0]) return true;
    if (strstr(words, "points=") && !applies(s, "points")) return false;
    if (strstr(words, "crack_tips=") && !applies(s, "crack_tips")) return false;
    if (strstr(words, "interface=") && !applies(s, "interface")) return false;
    if (strstr(words, "kind=") &&
        (!applies(s, "model") || knob_called("points")->refuses(s->c)))
        return false;
    return true;
}

static ph_status sweep_grids(ph_i_trade *s, ph_error *err)
{
    ph_status st = PH_OK;
    const size_t n = sizeof crossed / sizeof *crossed;
    for (int r = 0; r < s->nrungs; r++)
        for (size_t i = 0; i < n; i++)
            if (is_crossed(s, crossed[i]))
                PH_TRY(take(s, "grid", crossed[i], s->rung[r], threads_of(s), err));
out:
    return st;
}

static ph_status sweep_knobs(ph_i_trade *s, ph_error *err)
{
    ph_status st = PH_OK;
    ptrdiff_t n = s->rung[s->nrungs / 2];
    for (size_t k = 0; k < ph_nknobs; k++) {
        const ph_knob *knob = &ph_knobs[k];
        if (!knob->values || !applies(s, knob->info.name)) continue;
        for (int i = 0; knob->values[i]; i++)
            PH_TRY(take(s, knob->info.name, knob->values[i], n, threads_of(s), err));
    }
    if (applies(s, "threads"))
        for (int threads = 1; threads <= 4; threads *= 2)
            PH_TRY(take(s, "threads", "", s->rung[s->nrungs - 1], threads, err));
out:
    return st;
}

/* The ladder with loose tolerances, for the settings that are on the front. */
static ph_status sweep_tolerances(ph_i_trade *s, ph_error *err)
{
    ph_status st = PH_OK;
    const size_t n = sizeof crossed / sizeof *crossed;
    if (!applies(s, "tolerance")) goto out;
    for (size_t i = 0; i < n; i++) {
        bool on_front = false;
        for (int k = 0; k < s->t->nrows; k++)
            on_front |=
                s->t->row[k].front && strcmp(s->t->row[k].family, crossed[i]) == 0;
        for (int r = 0; on_front && r < s->nrungs; r++)
            for (size_t l = 0; l < sizeof loose / sizeof *loose; l++) {
                char words[160];
                snprintf(words, sizeof words, "%s%s%s", crossed[i],
                         crossed[i][0] ? ";" : "", loose[l]);
                PH_TRY(take(s, "grid", words, s->rung[r], threads_of(s), err));
            }
    }
out:
    return st;
}

/* RVEs of other sizes, together of one volume: many small ones or few large ones. */
static ph_status sweep_rve(ph_i_trade *s, ph_error *err)
{
    static const double share[] = {0.5, 0.7071, 1.0};
    enum { VOLUME = 8 }; /* of all realisations, in those of the case */
    ph_status st = PH_OK;
    int axes = s->c->kinematics == PH_SPACE ? 3 : 2;
    if (!applies(s, "rve")) goto out;
    for (int i = 0; i < 3; i++) {
        char grid[64], size[96] = "microstructure.size=[", set[96];
        ptrdiff_t n =
            (ptrdiff_t)floor(share[i] * (double)s->c->nodes[longest_axis(s->c)] + 0.5);
        double real = (double)n / (double)s->c->nodes[longest_axis(s->c)];
        ph_trade_row row = {.threads = threads_of(s)};
        row.realisations = (int)fmax(2, floor(VOLUME / pow(real, axes) + 0.5));
        snprintf(row.knob, sizeof row.knob, "rve");
        snprintf(row.family, sizeof row.family, "rve");
        for (int a = 0; a < axes; a++) {
            size_t at = strlen(size);
            snprintf(size + at, sizeof size - at, "%s%.9g", a ? "," : "",
                     s->c->size[a] * real);
        }
        strncat(size, "]", sizeof size - strlen(size) - 1);
        grid_text(s->c, n, grid, sizeof grid);
        snprintf(set, sizeof set, "microstructure.nodes=%s", grid);
        PH_TRY(ph_i_trade_add_set(&row, size, err));
        PH_TRY(ph_i_trade_add_set(&row, set, err));
        PH_TRY(ph_i_trade_take(s, &row, err));
    }
    ph_i_trade_judge_means(s->t);
out:
    return st;
}

static ph_status sweep(ph_i_trade *s, ph_error *err)
{
    ph_status st = PH_OK;
    ph_trade *t = s->t;
    s->planned = s->nrungs * (int)(sizeof crossed / sizeof *crossed);
    PH_TRY(sweep_grids(s, err));
    ph_i_trade_say_unsolved(t);
    if (!s->given) ph_i_trade_find_reference(t);
    ph_trade_judge(t);
    if (!ph_i_trade_has_reference(t)) goto out; /* nothing more can be judged */
    s->planned += 40 + s->nrungs * 3;
    PH_TRY(sweep_knobs(s, err));
    PH_TRY(sweep_tolerances(s, err));
    PH_TRY(sweep_rve(s, err));
out:
    if (!s->given && st == PH_ECANCELLED) ph_i_trade_find_reference(t);
    ph_trade_judge(t);
    return st;
}

static ph_status check_knobs(const ph_trade_params *p, ph_error *err)
{
    ph_status st = PH_OK;
    for (size_t i = 0; i < p->nknobs; i++) {
        const char *names[32] = {NULL};
        size_t n = 0;
        for (; n < ph_nknobs; n++)
            names[n] = ph_knobs[n].info.name;
        const char *near = ph_nearest_name(p->knobs[i], names, n);
        PH_CHECK(knob_called(p->knobs[i]), PH_EINVAL, "no knob '%.60s'%s%s%s",
                 p->knobs[i], near ? "; did you mean '" : "", near ? near : "",
                 near ? "'?" : "");
    }
    PH_CHECK(p->budget >= 0 && p->finest >= 0 && p->finest <= 65536, PH_EINVAL,
             "budget and finest: not negative, finest at most 65536");
out:
    return st;
}

static ph_status describe(ph_i_trade *s, ph_error *err)
{
    ph_status st = PH_OK;
    size_t at = 0;
    ph_trade *t = s->t;
    const ph_trade_params *p = s->params;
    snprintf(t->path, sizeof t->path, "%s", p->path);
    snprintf(t->title, sizeof t->title, "%s", s->c->title);
    for (size_t i = 0; i < p->nsets; i++) {
        size_t n = strlen(p->sets[i]) + 1;
        PH_CHECK(at + n < sizeof t->base_sets, PH_EINVAL,
                 "overrides: more than %zu letters together", sizeof t->base_sets - 2);
        memcpy(t->base_sets + at, p->sets[i], n);
        at += n;
    }
    for (int a = 0; a < 3; a++)
        t->axes += s->c->nodes[a] > 1;
    t->complete = true;
out:
    return st;
}

ph_status ph_trade_run(const ph_trade_params *params, ph_trade **out,
                       ph_case_issues *issues, ph_error *err)
{
    PH_GIVEN(params && params->path && out);
    ph_status st = PH_OK;
    ph_i_trade s = {.params = params};
    *out = NULL;
    PH_TRY(check_knobs(params, err));
    PH_ALLOC(s.t, 1, "a trade");
    PH_TRY(ph_case_read(params->path, params->sets, params->nsets, &s.c, issues, err));
    s.c->accuracy.given |= PH_SETTING_NODES; /* every row has its grid */
    PH_TRY(describe(&s, err));
    PH_TRY(ph_i_trade_begin(&s, err));
    make_ladder(&s);
    if (params->folder)
        PH_TRY(ph_i_trade_journal_read(params->folder, s.t->nconstants, &s.kept, err));
    st = sweep(&s, err);
    if (st == PH_OK || st == PH_ECANCELLED) {
        *out = s.t;
        s.t = NULL;
    }
out:
    ph_i_trade_kept_free(&s.kept);
    free(s.hash);
    ph_case_free(&s.c);
    ph_trade_free(&s.t);
    return st;
}
