/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "check.h"
#include "destination.h"
#include "interrupt.h"
#include "progress.h"
#include "report.h"
#include "tools.h"

#include <math.h>
#include <perihom_trade.h>
#include <string.h>

typedef struct trade_options {
    text_list operands, set;
    const char *output, *constants, *knobs, *reference, *budget;
    int finest, threads;
    bool json, quiet, progress;
} trade_options;

static const option_spec options[] = {
    {'o', "output", "DIR", OPTION_TEXT, offsetof(trade_options, output), "NAME-trade",
     "folder of the tables and the page; NAME is the case file without .yaml"},
    OPTION_SET(trade_options),
    {0, "constants", "LIST", OPTION_TEXT, offsetof(trade_options, constants),
     "E, G and nu", "constants that are judged, e.g. E1,G12; the worst one counts"},
    {0, "reference", "WHAT", OPTION_TEXT, offsetof(trade_options, reference),
     "own finest grid", "a result.json, or values: E1=143.9,G12=45.8"},
    {0, "knobs", "LIST", OPTION_TEXT, offsetof(trade_options, knobs), "all",
     "what is varied: names of 'perihom list knobs'"},
    {0, "finest", "N", OPTION_INTEGER, offsetof(trade_options, finest),
     "twice the case's", "nodes of the longest axis on the finest grid"},
    {0, "budget", "SECONDS", OPTION_TEXT, offsetof(trade_options, budget), "none",
     "CPU seconds for the whole sweep; what does not fit is skipped"},
    {'j', "threads", "N", OPTION_INTEGER, offsetof(trade_options, threads), "1",
     "threads of every solution"},
    OPTION_JSON(trade_options),
    {'q', "quiet", NULL, OPTION_FLAG, offsetof(trade_options, quiet), NULL,
     "no talk on stderr but errors"},
    {0, "progress", NULL, OPTION_FLAG, offsetof(trade_options, progress), "on a terminal",
     "progress on stderr even if it is no terminal"},
};

static const verb_spec trade_verb = {
    .name = "trade",
    .title = "what accuracy costs: settings of a case, their errors and their cost",
    .operands = "CASE.yaml",
    .operands_min = 1,
    .operands_max = 1,
    .operands_offset = offsetof(trade_options, operands),
    .example = {{"perihom trade boron-aluminium.yaml",
                 "sweep the settings; boron-aluminium-trade/trade.html has the figures"},
                {"perihom trade case.yaml --constants E1,G12 --budget 60",
                 "only two constants count, within a minute"},
                {"perihom trade case.yaml --reference E1=143.956,G12=45.824",
                 "errors against known values"}},
    .options = options,
    .noptions = sizeof options / sizeof *options,
    .more = "exit codes: 0 done, 2 usage, 3 case not admissible, 4 no reference, or "
            "the case itself not solved, 5 file or "
            "memory,\n130 interrupted "
            "(rows so far are kept; the same command goes on)",
};

enum { WORDS = 32 };

/* What a run owns. */
typedef struct trade {
    const trade_options *options;
    char dir[DESTINATION_PATH];
    char constant_text[1024], knob_text[512];
    const char *constant[WORDS], *knob[WORDS];
    ph_trade_params params;
    ph_trade *t;
    progress_style style;
    int width;
} trade;

/* "a,b" into words; -1: goes on, else the exit code. */
static int split(const char *list, const char *option, char *text, size_t size,
                 const char **word, size_t *n)
{
    if (!list) return -1;
    if (snprintf(text, size, "%s", list) >= (int)size)
        return options_usage_error(&trade_verb, "--%s: too long", option);
    for (char *at = strtok(text, ","); at; at = strtok(NULL, ",")) {
        if (*n == WORDS)
            return options_usage_error(&trade_verb, "--%s: more than %d", option, WORDS);
        word[(*n)++] = at;
    }
    if (*n == 0) return options_usage_error(&trade_verb, "--%s: nothing in it", option);
    return -1;
}

/* Two rungs of the ladder, and what a case may have. */
enum { LEAST_FINEST = 6, MOST_FINEST = 65536 };

static int read_options(trade *m)
{
    const trade_options *o = m->options;
    ph_trade_params *p = &m->params;
    int code = split(o->constants, "constants", m->constant_text, sizeof m->constant_text,
                     m->constant, &p->nconstants);
    if (code < 0)
        code = split(o->knobs, "knobs", m->knob_text, sizeof m->knob_text, m->knob,
                     &p->nknobs);
    if (code < 0 && o->budget) {
        char *end;
        p->budget = strtod(o->budget, &end);
        if (end == o->budget || *end || !(p->budget > 0) || p->budget > 1e12)
            code = options_usage_error(
                &trade_verb, "--budget: '%s' is not a number of seconds > 0", o->budget);
    }
    if (code < 0 && o->finest && (o->finest < LEAST_FINEST || o->finest > MOST_FINEST))
        code = options_usage_error(&trade_verb, "--finest: %d is not from %d to %d nodes",
                                   o->finest, LEAST_FINEST, MOST_FINEST);
    p->constants = m->constant;
    p->knobs = m->knob;
    return code;
}

static bool step(void *user, const ph_trade_progress *now)
{
    trade *m = user;
    if (now->row && m->style == PROGRESS_BAR) {
        char seconds[32];
        int width = fprintf(stderr, "\rrow %d of about %d, %s, %.40s", now->done,
                            now->rows > now->done ? now->rows : now->done,
                            report_seconds(now->cpu, seconds), now->row->setting);
        if (width < m->width) fprintf(stderr, "%*s", m->width - width, "");
        m->width = width;
        fflush(stderr);
    }
    return interrupt_signal() == 0;
}

static void wipe(trade *m)
{
    if (m->width > 0) fprintf(stderr, "\r%*s\r", m->width, "");
}

/* ---- what is printed ---- */

static int count(const ph_trade *t, ph_trade_state state)
{
    int n = 0;
    for (int i = 0; i < t->nrows; i++)
        n += t->row[i].state == state;
    return n;
}

static void print_front(FILE *to, const ph_trade *t)
{
    char bytes[32];
    double last = -1;
    fprintf(to, "\nfront: nothing cheaper is better\n");
    fprintf(to, "  %10s %10s %10s %9s  %s\n", "error", "operations", "CPU s", "memory",
            "setting");
    for (;;) {
        const ph_trade_row *next = NULL;
        for (int i = 0; i < t->nrows; i++) {
            const ph_trade_row *r = &t->row[i];
            if (r->front && r->work > last && (!next || r->work < next->work)) next = r;
        }
        if (!next) return;
        last = next->work;
        fprintf(to, "  %8.3g %% %10.3g %10.3g %9s  %s\n", 100 * next->error, next->work,
                next->cpu, report_bytes(next->bytes, bytes),
                next->setting[0] ? next->setting : "as the case");
    }
}

static void print_advice(FILE *to, const ph_trade *t)
{
    for (int k = 0; k < PH_TRADE_TARGETS; k++) {
        const ph_trade_advice *a = &t->advice[k];
        if (a->row < 0) {
            fprintf(to, "\n%g %%: nothing of the sweep reaches it\n", 100 * a->target);
            continue;
        }
        const ph_trade_row *r = &t->row[a->row];
        fprintf(to, "\n%g %%: error %.3g %%, %.3g operations, %.3g CPU s\n    %s\n",
                100 * a->target, 100 * r->error, r->work, r->cpu, a->command);
    }
}

static bool has_reference(const ph_trade *t)
{
    return isfinite(t->reference[0]);
}

static void print(FILE *to, const ph_trade *t)
{
    fprintf(to, "%s\n", t->title[0] ? t->title : t->path);
    fprintf(to, "%d settings: %d solved, %d refused, %d failed, %d skipped\n", t->nrows,
            count(t, PH_TRADE_DONE), count(t, PH_TRADE_REFUSED),
            count(t, PH_TRADE_FAILED), count(t, PH_TRADE_SKIPPED));
    fprintf(to, "reference: %s", t->reference_kind);
    if (t->reference_error > 0)
        fprintf(to, "; its own error about %.2g %%", 100 * t->reference_error);
    fputc('\n', to);
    if (!has_reference(t)) return;
    print_front(to, t);
    print_advice(to, t);
}

/* ---- files ---- */

static ph_status write_text(const char *dir, const char *name, const char *text,
                            ph_error *err)
{
    char path[DESTINATION_PATH + 64];
    snprintf(path, sizeof path, "%s/%s", dir, name);
    return ph_write_file(path, text, strlen(text), err);
}

static ph_status write_files(const trade *m, ph_error *err)
{
    static ph_status (*const make[])(const ph_trade *, char **, ph_error *) = {
        ph_trade_to_csv, ph_trade_to_html, ph_trade_to_json};
    static const char *const name[] = {"trade.csv", "trade.html", "trade.json"};
    ph_status st = PH_OK;
    char *text = NULL;
    for (int i = 0; i < 3; i++) {
        PH_TRY(make[i](m->t, &text, err));
        PH_TRY(write_text(m->dir, name[i], text, err));
        if (i == 2 && m->options->json) printf("%s\n", text);
        free(text);
        text = NULL;
    }
    for (int seconds = 0; seconds < 2; seconds++) {
        PH_TRY(ph_trade_plot(m->t, seconds, &text, err));
        PH_TRY(write_text(m->dir, seconds ? "seconds.svg" : "work.svg", text, err));
        free(text);
        text = NULL;
    }
out:
    free(text);
    return st;
}

/* NAME-trade beside the case's name. */
static ph_status choose_folder(trade *m, ph_error *err)
{
    ph_status st = PH_OK;
    const char *given = m->options->output;
    char beside[DESTINATION_PATH];
    destination_default(m->options->operands.item[0], beside);
    char *end = strstr(beside, "-results");
    if (end) *end = 0;
    PH_CHECK(strlen(given ? given : beside) + 8 < sizeof m->dir, PH_EIO,
             "%.80s...: the name is too long", given ? given : beside);
    snprintf(m->dir, sizeof m->dir, "%.*s%s", (int)sizeof m->dir - 8,
             given ? given : beside, given ? "" : "-trade");
    PH_TRY(destination_make(m->dir, err));
out:
    return st;
}

static int run_trade(trade *m)
{
    ph_error err = PH_ERROR_INIT, second = PH_ERROR_INIT;
    ph_case_issues issues = {0};
    const trade_options *o = m->options;
    interrupt_install();
    m->params.path = o->operands.item[0];
    m->params.sets = o->set.item;
    m->params.nsets = o->set.count;
    m->params.reference = o->reference;
    m->params.finest = o->finest;
    m->params.threads = o->threads;
    m->params.folder = m->dir;
    m->params.progress = step;
    m->params.user = m;
    m->style = progress_choose(o->quiet, false, o->progress);
    ph_status st = choose_folder(m, &err);
    if (st == PH_OK) st = ph_trade_run(&m->params, &m->t, &issues, &err);
    wipe(m);
    talk_issues(m->params.path, &issues);
    bool said = issues.count > 0;
    ph_case_issues_free(&issues);
    if (m->t) {
        ph_status written = write_files(m, &second);
        if (written != PH_OK) {
            st = written;
            err = second;
        } else {
            if (!o->json) print(stdout, m->t);
            if (!o->quiet) talk("figures in %s/trade.html", m->dir);
        }
    }
    if (st == PH_OK && !has_reference(m->t))
        st = ph_error_set(&err, PH_ENOCONV, NULL, 0,
                          "there is nothing that errors are relative to; --reference "
                          "or a solvable ladder of grids gives it");
    if (st == PH_OK && m->t->unsolved[0]) /* what others reach says nothing of the case */
        st = ph_error_set(&err, PH_ENOCONV, NULL, 0, "the case itself is not solved: %s",
                          m->t->unsolved);
    if (st == PH_ECANCELLED)
        talk("interrupted; the same command goes on");
    else if (st != PH_OK && !(said && !m->t))
        talk_case_error(m->params.path, &o->set, &err);
    return ph_status_exit_code(st);
}

int cmd_trade(int argc, char **argv)
{
    trade_options o = {0};
    trade m = {.options = &o};
    int code = options_parse(&trade_verb, argc, argv, &o);
    if (code < 0) code = read_options(&m);
    if (code < 0) code = run_trade(&m);
    ph_trade_free(&m.t);
    free(o.operands.item);
    free(o.set.item);
    return code;
}
