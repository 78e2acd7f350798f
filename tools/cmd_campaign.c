/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "campaign_report.h"
#include "check.h"
#include "destination.h"
#include "interrupt.h"
#include "tools.h"

#include <glob.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct campaign_options {
    text_list operands, set;
    const char *output, *shard, *memory;
    int jobs, threads;
    bool merge, rebuild, retry_failed, json, quiet, verbose, progress;
} campaign_options;

static const option_spec options[] = {
    {'o', "output", "DIR", OPTION_TEXT, offsetof(campaign_options, output),
     "NAME-results", "folder of the campaign; NAME is its file without .yaml"},
    OPTION_SET(campaign_options),
    OPTION_JSON(campaign_options),
    {'j', "jobs", "N", OPTION_INTEGER, offsetof(campaign_options, jobs), "all processors",
     "processors to use: worker processes times threads of each"},
    {0, "threads", "N", OPTION_INTEGER, offsetof(campaign_options, threads),
     "1, or what memory leaves idle", "threads of each worker process"},
    {0, "memory", "SIZE", OPTION_TEXT, offsetof(campaign_options, memory),
     "80 % of the machine",
     "memory of all workers together, e.g. 8G: fewer workers then"},
    {0, "shard", "PART", OPTION_TEXT, offsetof(campaign_options, shard), NULL,
     "K/N: compute only the K-th of N parts, in DIR/shard-K-of-N; see --merge"},
    {0, "merge", NULL, OPTION_FLAG, offsetof(campaign_options, merge), "DIR/shard-*",
     "bring the realisations of other folders together"},
    {0, "rebuild", NULL, OPTION_FLAG, offsetof(campaign_options, rebuild), NULL,
     "compute nothing; make all files anew from realisations.jsonl"},
    {0, "retry-failed", NULL, OPTION_FLAG, offsetof(campaign_options, retry_failed), NULL,
     "compute again what has failed"},
    {'q', "quiet", NULL, OPTION_FLAG, offsetof(campaign_options, quiet), NULL,
     "no talk on stderr but errors"},
    {'v', "verbose", NULL, OPTION_FLAG, offsetof(campaign_options, verbose), NULL,
     "a line on stderr ten times a second"},
    {0, "progress", NULL, OPTION_FLAG, offsetof(campaign_options, progress),
     "on a terminal", "progress line on stderr even if it is no terminal"},
};

static const verb_spec campaign_verb = {
    .name = "campaign",
    .title = "many realisations of a case, sweeps of its keys; resumes",
    .operands = "CAMPAIGN.yaml [FOLDER]...",
    .operands_min = 1,
    .operands_max = 100000,
    .operands_offset = offsetof(campaign_options, operands),
    .example =
        {{"perihom campaign clay.yaml",
          "compute what is missing, keep clay-results/; again after any interruption"},
         {"perihom campaign clay.yaml --shard 3/8",
          "the third of eight parts, e.g. as one task of a job array"},
         {"perihom campaign clay.yaml --merge",
          "put the parts together: the files of a single run, bit for bit"}},
    .options = options,
    .noptions = sizeof options / sizeof *options,
    .more =
        "exit codes: 0 done, 2 usage, 3 campaign or case not admissible, 4 the accuracy "
        "is not\n"
        "reached within the budget (what was computed is kept), 5 file or memory, 6 "
        "some\n"
        "realisations failed (the files are there), 130 interrupted (what was computed "
        "is kept)",
};

/* Everything that a campaign owns. */
typedef struct campaign {
    const campaign_options *options;
    char dir[DESTINATION_PATH];
    ph_campaign *c;
    ph_campaign_params params;
    campaign_talk talk;
    ph_campaign_result *result;
    double used; /* of the budget, before it runs */
    char *json;
} campaign;

static int load(const char *path, const text_list *sets, ph_campaign **out)
{
    ph_error err = PH_ERROR_INIT;
    ph_case_issues issues = {0};
    ph_status st = ph_campaign_read(path, sets->item, sets->count, out, &issues, &err);
    int code = ph_status_exit_code(st);
    talk_issues(path, &issues);
    if (st != PH_OK && issues.count == 0) code = talk_error(&err);
    ph_case_issues_free(&issues);
    return code;
}

/* "3/8" */
static int read_shard(const campaign_options *o, ph_campaign_params *p)
{
    char *slash, *end = NULL;
    if (!o->shard) return -1;
    long k = strtol(o->shard, &slash, 10), n = 0;
    if (*slash == '/') n = strtol(slash + 1, &end, 10);
    if (!end || *end || k < 1 || k > n || n > 1000000)
        return options_usage_error(&campaign_verb,
                                   "--shard: '%s' is not K/N with 1 <= K <= N", o->shard);
    p->shard = (int)k;
    p->shards = (int)n;
    return -1;
}

/* "8G", "500M" */
static int read_memory(const campaign_options *o, ph_campaign_params *p)
{
    char *end;
    if (!o->memory) return -1;
    double x = strtod(o->memory, &end);
    double unit = *end == 'K' ? 0x1p10 : *end == 'M' ? 0x1p20 : *end == 'G' ? 0x1p30 : 1;
    bool good = end != o->memory && (*end == 0 || (unit > 1 && end[1] == 0));
    if (!good || !(x > 0) || x * unit > 0x1p60)
        return options_usage_error(
            &campaign_verb, "--memory: '%s' is not a size such as 500M or 8G", o->memory);
    p->memory = (size_t)(x * unit);
    return -1;
}

static int check_usage(const campaign_options *o, ph_campaign_params *p)
{
    int code = read_shard(o, p);
    if (code < 0) code = read_memory(o, p);
    if (code < 0 && o->merge + o->rebuild + (o->shard != NULL) > 1)
        code = options_usage_error(&campaign_verb,
                                   "only one of --shard, --merge and --rebuild");
    if (code < 0 && (o->jobs > 256 || o->threads > 1024))
        code = options_usage_error(
            &campaign_verb, "--jobs up to 256 and --threads up to 1024 are admissible");
    if (code < 0 && o->operands.count > 1 && !o->merge)
        code = options_usage_error(&campaign_verb, "one campaign at a time");
    return code;
}

static ph_status choose_folder(campaign *m, ph_error *err)
{
    ph_status st = PH_OK;
    const campaign_options *o = m->options;
    char base[DESTINATION_PATH];
    destination_default(o->operands.item[0], base);
    if (o->output) {
        PH_CHECK(strlen(o->output) < sizeof base, PH_EIO,
                 "%.80s...: the name is too long", o->output);
        strcpy(base, o->output);
    }
    int n = m->params.shards > 0 ? snprintf(m->dir, sizeof m->dir, "%s/shard-%d-of-%d",
                                            base, m->params.shard, m->params.shards)
                                 : snprintf(m->dir, sizeof m->dir, "%s", base);
    PH_CHECK(n < (int)sizeof m->dir, PH_EIO, "%.80s...: the name is too long", base);
out:
    return st;
}

/* The folders of the command line, or all shards of this campaign. */
static ph_status merge(campaign *m, ph_error *err)
{
    ph_status st = PH_OK;
    const text_list *operands = &m->options->operands;
    if (operands->count > 1)
        return ph_campaign_merge(m->c, m->dir, operands->item + 1, operands->count - 1,
                                 &m->result, err);
    char pattern[2 * DESTINATION_PATH + 16];
    size_t n = 0;
    glob_t found = {0};
    for (const char *at = m->dir; *at; at++) { /* its letters stand for themselves */
        if (strchr("*?[]\\", *at)) pattern[n++] = '\\';
        pattern[n++] = *at;
    }
    snprintf(pattern + n, sizeof pattern - n, "/shard-*-of-*");
    PH_CHECK(glob(pattern, 0, NULL, &found) == 0, PH_EIO,
             "there is no %s/shard-*-of-* to merge", m->dir);
    PH_TRY(ph_campaign_merge(m->c, m->dir, (const char *const *)found.gl_pathv,
                             found.gl_pathc, &m->result, err));
out:
    globfree(&found);
    return st;
}

/* A case that asks for an accuracy: a pilot chooses its grid. */
static ph_status settle(campaign *m, ph_error *err)
{
    ph_status st = PH_OK;
    const campaign_options *o = m->options;
    ph_campaign_split split = {0};
    progress p;
    progress_start(&p, progress_choose(o->quiet, o->verbose, o->progress));
    const ph_ctx ctx = {.progress = progress_step, .user = &p, .threads = 1};
    st = ph_campaign_settle(&m->c, o->set.item, o->set.count, &ctx, &split, err);
    progress_end(&p);
    PH_TRY(st);
    m->used += split.seconds;
    if (split.pilots > 0 && !o->quiet)
        talk(
            "%g %%: %td nodes along axis 1 are off by about %.2g %%, the interval may be "
            "%.2g %% wide to each side",
            100 * split.accuracy, split.nodes[0], 100 * split.grid,
            100 * split.half_width);
out:
    return st;
}

static void prepare(campaign *m)
{
    const campaign_options *o = m->options;
    m->talk = (campaign_talk){
        .c = m->c, .style = progress_choose(o->quiet, o->verbose, o->progress)};
    m->params.folder = m->dir;
    m->params.jobs = o->jobs;
    m->params.threads = o->threads;
    m->params.retry_failed = o->retry_failed;
    m->params.progress = campaign_step;
    m->params.user = &m->talk;
}

/* What is left of the budget. */
static void take_budget(campaign *m)
{
    if (m->c->seconds > 0) m->params.seconds = fmax(m->c->seconds - m->used, 1e-3);
}

/* A campaign that leaves the size of its RVE open: pilots choose it. */
static ph_status choose_size(campaign *m, ph_error *err)
{
    double start = progress_clock();
    char path[DESTINATION_PATH + 32];
    snprintf(path, sizeof path, "%s/realisations.jsonl", m->dir);
    if (m->c->nfactors > 0 && m->options->rebuild && access(path, F_OK) != 0)
        return ph_error_set(err, PH_EIO, __FILE__, __LINE__, "%s: there is nothing",
                            path);
    take_budget(m);
    ph_status st = ph_campaign_choose_size(&m->c, m->options->set.item,
                                           m->options->set.count, &m->params, err);
    m->talk.c = m->c;
    m->used += progress_clock() - start;
    campaign_talk_end(&m->talk);
    take_budget(m);
    if (m->c->sizes && st == PH_OK && !m->options->quiet)
        talk("size: %s", m->c->sizes->why);
    if (m->c->sizes && st != PH_OK && !m->options->json) campaign_sizes(stdout, m->c);
    return st;
}

static ph_status run(campaign *m, ph_error *err)
{
    ph_status st = PH_OK;
    const campaign_options *o = m->options;
    if (o->merge)
        st = merge(m, err);
    else if (o->rebuild)
        st = ph_campaign_summarise(m->c, m->dir, &m->result, err);
    else
        st = ph_campaign_run(m->c, &m->params, &m->result, err);
    campaign_talk_end(&m->talk);
    return st;
}

static ph_status write_files(campaign *m, ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(ph_campaign_to_json(m->c, m->result, &m->json, err));
    PH_TRY(ph_campaign_write(m->c, m->dir, m->result, err));
    if (m->options->json)
        printf("%s\n", m->json);
    else
        campaign_table(stdout, m->c, m->result);
out:
    return st;
}

static void talk_of_result(const campaign *m)
{
    const ph_campaign_result *r = m->result;
    if (m->options->quiet) return;
    if (r->dropped > 0)
        talk("%lld damaged lines of realisations.jsonl did not count",
             (long long)r->dropped);
    if (r->differing > 0)
        talk(
            "%lld realisations came with two results: not the same program or processor?",
            (long long)r->differing);
    talk("%lld realisations, %lld failed; campaign in %s/", (long long)r->realisations,
         (long long)r->failed, m->dir);
}

static int run_campaign(campaign *m)
{
    ph_error err = PH_ERROR_INIT, second = PH_ERROR_INIT;
    interrupt_install();
    ph_status st = choose_folder(m, &err);
    if (st == PH_OK) st = settle(m, &err);
    prepare(m);
    if (st == PH_OK) st = choose_size(m, &err);
    if (st == PH_OK) st = run(m, &err);
    if (m->result) {
        ph_status written = write_files(m, &second);
        if (written != PH_OK) {
            st = written;
            err = second;
        } else {
            talk_of_result(m);
        }
    }
    if (st == PH_ECANCELLED)
        talk("interrupted; the same command goes on");
    else if (st != PH_OK)
        talk_error(&err);
    return ph_status_exit_code(st);
}

int cmd_campaign(int argc, char **argv)
{
    campaign_options o = {0};
    campaign m = {.options = &o};
    int code = options_parse(&campaign_verb, argc, argv, &o);
    if (code < 0) code = check_usage(&o, &m.params);
    if (code < 0) {
        code = load(o.operands.item[0], &o.set, &m.c);
        if (code == 0) code = run_campaign(&m);
    }
    ph_campaign_result_free(&m.result);
    ph_campaign_free(&m.c);
    free(m.json);
    free(o.operands.item);
    free(o.set.item);
    return code;
}
