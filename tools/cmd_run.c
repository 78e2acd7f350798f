/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "check.h"
#include "damage.h"
#include "destination.h"
#include "failure.h"
#include "fidelity.h"
#include "interrupt.h"
#include "memory.h"
#include "progress.h"
#include "relaxation.h"
#include "report.h"
#include "tools.h"

#include <perihom_error_bar.h>
#include <string.h>

typedef struct run_options {
    text_list operands, set;
    const char *output;
    int threads;
    bool json, quiet, verbose, progress, force;
} run_options;

static const option_spec options[] = {
    {'o', "output", "DIR", OPTION_TEXT, offsetof(run_options, output), "NAME-results",
     "folder of the result; NAME is the case file without .yaml"},
    OPTION_SET(run_options),
    OPTION_JSON(run_options),
    {'j', "threads", "N", OPTION_INTEGER, offsetof(run_options, threads),
     "all processors", "threads of the solver"},
    {'q', "quiet", NULL, OPTION_FLAG, offsetof(run_options, quiet), NULL,
     "no talk on stderr but errors"},
    {'v', "verbose", NULL, OPTION_FLAG, offsetof(run_options, verbose), NULL,
     "a line an iteration on stderr"},
    {0, "progress", NULL, OPTION_FLAG, offsetof(run_options, progress), "on a terminal",
     "progress bar on stderr even if it is no terminal"},
    {0, "force", NULL, OPTION_FLAG, offsetof(run_options, force), NULL,
     "overwrite the result of another case"},
};

static const verb_spec run_verb = {
    .name = "run",
    .title = "effective properties of a case",
    .operands = "CASE.yaml",
    .operands_min = 1,
    .operands_max = 1,
    .operands_offset = offsetof(run_options, operands),
    .example = {{"perihom run boron-aluminium.yaml",
                 "solve it, print a table, keep boron-aluminium-results/result.json"},
                {"perihom run case.yaml --set microstructure.nodes=[64,64] -o coarse",
                 "the same case on a coarser grid, its result in coarse/"},
                {"perihom run case.yaml --json -q > result.json",
                 "only the result document on stdout, for scripts"}},
    .options = options,
    .noptions = sizeof options / sizeof *options,
    .more = "exit codes: 0 done, 2 usage, 3 case not admissible, 4 not converged (no "
            "result is\n"
            "written), 5 file or memory, 130 interrupted (nothing is written)",
};

/* Everything that a run owns. */
typedef struct run {
    const run_options *options;
    const char *command; /* for the provenance */
    const char *dir;
    ph_case *c;
    char *case_json;
    ph_microstructure *micro;
    ph_crack_plan *plan;
    ph_result *result;     /* of an elastic case, or one that fails in time */
    ph_fidelity *fidelity; /* of one that asks for an accuracy: it owns its result */
    ph_viscoelastic *relaxation; /* of one that relaxes, with what is reported of it */
    ph_relaxation_report *report;
    char *json;
} run;

static void run_free(run *r)
{
    if (r->fidelity)
        ph_fidelity_free(&r->fidelity);
    else
        ph_result_free(&r->result);
    ph_viscoelastic_free(&r->relaxation);
    ph_relaxation_report_free(&r->report);
    ph_microstructure_free(&r->micro);
    ph_crack_plan_free(&r->plan);
    ph_case_free(&r->c);
    free(r->case_json);
    free(r->json);
}

static ph_status solve(run *r, ph_error *err)
{
    const run_options *o = r->options;
    progress p;
    progress_start(&p, progress_choose(o->quiet, o->verbose, o->progress));
    const ph_problem problem = ph_rve_problem(r->c, r->micro, r->plan);
    const ph_ctx ctx = {.progress = progress_step, .user = &p, .threads = o->threads};
    ph_status st =
        ph_case_relaxes(r->c) && !problem.loading
            ? relaxation_solve(r->c, &problem, &ctx, &r->relaxation, &r->report, err)
            : ph_homogenise(&problem, &ctx, &r->result, err);
    if (st == PH_OK && r->result)
        st = ph_rve_error_bar(r->c, &problem, &ctx, r->result, err);
    progress_end(&p);
    return st;
}

static void talk_work(const ph_work *w)
{
    talk("%ld loads, %ld iterations, %ld applications of the operator, %ld transforms; "
         "%td nodes of collar, %zu history variables, %zu bond bits",
         w->loads, w->iterations, w->applications, w->ffts, w->collar,
         w->history_variables, w->bond_bits);
}

/* To an accuracy: the microstructure is that of the grid that was chosen. */
static ph_status solve_to_accuracy(run *r, ph_error *err)
{
    const run_options *o = r->options;
    progress p;
    progress_start(&p, progress_choose(o->quiet, o->verbose, o->progress));
    const ph_ctx ctx = {.progress = progress_step, .user = &p, .threads = o->threads};
    ph_case mine = *r->c; /* borrows the arrays; no grid is larger than the machine */
    if (mine.accuracy.memory == 0) mine.accuracy.memory = memory_here();
    ph_status st = ph_fidelity_solve(&mine, &ctx, &r->fidelity, err);
    progress_end(&p);
    if (!r->fidelity) return st;
    r->result = r->fidelity->result;
    r->micro = r->fidelity->micro;
    r->fidelity->micro = NULL;
    return st;
}

static ph_status stop_if_interrupted(ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(!interrupt_signal(), PH_ECANCELLED, "interrupted");
out:
    return st;
}

static ph_status write_files(const run *r, ph_error *err)
{
    ph_status st = PH_OK;
    destination to = {0};
    char path[DESTINATION_PATH + 64];
    PH_TRY(destination_open(&to, r->dir, err));
    destination_file(&to, "phases.png", path, sizeof path);
    PH_TRY(ph_write_phases_png(path, r->micro, 3, r->c->title, err));
    if (r->c->fields) {
        destination_file(&to, "fields", path, sizeof path);
        PH_TRY(ph_write_fields(path, r->micro,
                               r->relaxation ? r->relaxation->elastic : r->result, r->c,
                               err));
    }
    if (r->report) PH_TRY(relaxation_write(&to, r->c, r->report, err));
    if (r->result && r->result->damage) PH_TRY(damage_write(&to, r->result, err));
    if (r->result && r->result->failure) PH_TRY(failure_write(&to, r->c, r->result, err));
    destination_file(&to, "result.json", path, sizeof path);
    PH_TRY(ph_write_file(path, r->json, strlen(r->json), err));
    PH_TRY(stop_if_interrupted(err));
    /* Another run may have ended in the same folder meanwhile. */
    PH_TRY(destination_check(r->dir, r->case_json, r->options->force, err));
    PH_TRY(destination_commit(&to, err));
out:
    destination_discard(&to);
    return st;
}

/* The data: the document, or a table. */
static ph_status print_result(run *r, ph_error *err)
{
    ph_status st = PH_OK;
    if (r->relaxation)
        PH_TRY(
            ph_viscoelastic_to_json(r->relaxation, r->report, r->c, NULL, &r->json, err));
    else if (r->fidelity)
        PH_TRY(ph_fidelity_to_json(r->fidelity, r->c, NULL, &r->json, err));
    else
        PH_TRY(ph_result_to_json(r->result, r->c, NULL, &r->json, err));
    if (r->options->json)
        printf("%s\n", r->json);
    else if (r->relaxation)
        relaxation_print(stdout, r->c, r->relaxation, r->report);
    else
        report_result(stdout, r->c, r->result);
    if (r->fidelity && !r->options->json) fidelity_print(stdout, r->fidelity);
out:
    return st;
}

/* The grid that the case gives. */
static ph_status solve_as_given(run *r, ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(ph_rve_build(r->c, &r->micro, err));
    PH_TRY(stop_if_interrupted(err));
    PH_TRY(ph_rve_cracks(r->c, &r->plan, err));
    const ph_problem problem = ph_rve_problem(r->c, r->micro, r->plan);
    PH_TRY(memory_check_problem(&problem, err));
    st = solve(r, err);
out:
    return st;
}

static ph_status run_case(run *r, ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(ph_case_to_json(r->c, &r->case_json, err));
    PH_TRY(destination_check(r->dir, r->case_json, r->options->force, err));
    interrupt_install();
    PH_TRY(memory_check_cells(r->c, case_solves(r->c), err));
    st = r->c->accuracy.relative > 0 ? solve_to_accuracy(r, err) : solve_as_given(r, err);
    if (st == PH_ENOCONV && r->result) {
        /* The report says how far it got; the exit code and stderr say that it failed. */
        ph_error ignored = PH_ERROR_INIT;
        print_result(r, &ignored);
    }
    PH_TRY(st);
    PH_TRY(stop_if_interrupted(err));
    if (r->options->verbose)
        talk_work(r->relaxation ? &r->relaxation->elastic->work : &r->result->work);
    PH_TRY(print_result(r, err));
    PH_TRY(write_files(r, err));
    if (!r->options->quiet) talk("result in %s/", r->dir);
out:
    return st;
}

static int run_with(const run_options *o, const char *command)
{
    ph_error err = PH_ERROR_INIT;
    run r = {.options = o, .command = command};
    const char *path = o->operands.item[0];
    int code = case_load(path, &o->set, &r.c);
    if (code == 0) {
        char beside[DESTINATION_PATH];
        destination_default(path, beside);
        r.dir = o->output ? o->output : beside;
        ph_status st = run_case(&r, &err);
        code = ph_status_exit_code(st);
        if (st == PH_ECANCELLED)
            talk("interrupted; no result is written");
        else if (st != PH_OK)
            talk_case_error(path, &o->set, &err);
    }
    run_free(&r);
    return code;
}

/* The words again, quoted where a shell would need it, cut at `size`. */
static void command_line(int argc, char **argv, char *text, size_t size)
{
    size_t at = (size_t)snprintf(text, size, "perihom");
    for (int i = 0; i < argc && at < size; i++) {
        bool plain = argv[i][0] && !strpbrk(argv[i], " \t\n'\"\\$`*?[]{}()<>|&;#~!");
        at += (size_t)snprintf(text + at, size - at, plain ? " %s" : " '%s'", argv[i]);
    }
}

int cmd_run(int argc, char **argv)
{
    run_options o = {0};
    int code = options_parse(&run_verb, argc, argv, &o);
    char command[2048];
    if (code < 0) {
        command_line(argc, argv, command, sizeof command);
        code = run_with(&o, command);
    }
    free(o.operands.item);
    free(o.set.item);
    return code;
}
