/* SPDX-License-Identifier: GPL-3.0-or-later */
/* perihom calibrate: unknowns of a case from measurements. */
#include "check.h"
#include "destination.h"
#include "interrupt.h"
#include "tools.h"

#include <math.h>
#include <perihom_calibrate.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

typedef struct calibrate_options {
    text_list operands, set;
    const char *output;
    int threads;
    bool json, quiet, progress, retry;
} calibrate_options;

static const option_spec options[] = {
    {'o', "output", "DIR", OPTION_TEXT, offsetof(calibrate_options, output),
     "NAME-results", "folder of evaluations and result; NAME is the file without .yaml"},
    OPTION_SET(calibrate_options),
    OPTION_JSON(calibrate_options),
    {'j', "threads", "N", OPTION_INTEGER, offsetof(calibrate_options, threads),
     "all processors", "realisations solved at the same time"},
    {'q', "quiet", NULL, OPTION_FLAG, offsetof(calibrate_options, quiet), NULL,
     "no talk on stderr but errors"},
    {0, "progress", NULL, OPTION_FLAG, offsetof(calibrate_options, progress),
     "on a terminal", "a line of progress on stderr even if it is no terminal"},
    {0, "retry-failed", NULL, OPTION_FLAG, offsetof(calibrate_options, retry), NULL,
     "solve again the realisations that failed before"},
};

static const verb_spec calibrate_verb = {
    .name = "calibrate",
    .title = "unknowns of a case from measurements, with their errors",
    .operands = "CALIBRATION.yaml",
    .operands_min = 1,
    .operands_max = 1,
    .operands_offset = offsetof(calibrate_options, operands),
    .example =
        {{"perihom calibrate kappa.yaml",
          "fit, print a table, keep kappa-results/calibration.json; goes on where an "
          "earlier run was stopped"},
         {"perihom calibrate kappa.yaml --set model.horizon=4 -o coarse",
          "the same with another horizon"},
         {"perihom calibrate kappa.yaml --json -q | jq .unknowns",
          "only the document perihom.calibration/1 on stdout"}},
    .options = options,
    .noptions = sizeof options / sizeof *options,
    .more =
        "exit codes: 0 done, 2 usage, 3 file not admissible, 4 the model fails, 5 file "
        "or\n"
        "memory, 130 interrupted (what was solved is kept and not solved again)",
};

/* ---- progress */

typedef struct watch {
    bool shown, bar;
    double begin, last;
} watch;

static double now_seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static bool watch_step(void *user, const ph_progress *now)
{
    watch *w = user;
    if (interrupt_signal()) return false;
    double t = now_seconds();
    if (!w->shown || !now->stage || t - w->last < (w->bar ? 0.2 : 5)) return true;
    w->last = t;
    fprintf(stderr, "%sperihom: %s: %d of %d realisations, %.0f s%s", w->bar ? "\r" : "",
            now->stage, now->load, now->loads, t - w->begin, w->bar ? "   " : "\n");
    return true;
}

static void watch_end(const watch *w)
{
    if (w->shown && w->bar) fprintf(stderr, "\r%*s\r", 78, "");
}

/* ---- the table */

static void print_unknown(const ph_fit_file *file, const ph_fit *fit, int j)
{
    const ph_fit_estimate *x = &fit->unknown[j];
    printf("%s\n  value               %.5g\n", file->unknown[j].name, x->value);
    if (isnan(x->standard_error))
        printf("  standard error      -\n");
    else
        printf("  standard error      %.3g   (data %.3g, sampling %.3g)\n",
               x->standard_error, x->error_data, x->error_sampling);
    printf("  95 %% interval       %s%.5g to %.5g%s\n", x->open[0] ? "<= " : "",
           x->interval[0], x->interval[1], x->open[1] ? " or more" : "");
    printf("  identifiable        %s\n", ph_fit_knowledge_text(x->knowledge));
    if (fit->nsamples)
        printf("  posterior           %.5g (%.5g to %.5g)\n", x->posterior_quantile[1],
               x->posterior_quantile[0], x->posterior_quantile[2]);
}

static void print_points(const ph_fit_file *file, const ph_fit *fit)
{
    printf("\n%-10s", "quantity");
    for (int k = 0; k < file->nkeys; k++) {
        const char *dot = strrchr(file->key[k], '.');
        printf(" %15.15s", dot ? dot + 1 : file->key[k]);
    }
    printf(" %10s %10s %20s %8s %10s %5s\n", "measured", "sigma", "model", "residual",
           "left out", "n");
    for (int i = 0; i < fit->nmeasurements; i++) {
        const ph_fit_measurement *m = &file->measurement[i];
        const ph_fit_point *p = &fit->point[i];
        char model[32];
        snprintf(model, sizeof model, "%.5g +- %.2g", p->model, p->model_error);
        printf("%-10s", file->output[m->output].name);
        for (int k = 0; k < file->nkeys; k++)
            printf(" %15.6g", file->place[m->point][k]);
        printf(" %10.5g %10.3g %20s %+8.2f %10.5g %5d%s\n", p->measured, p->sigma, model,
               p->residual, p->left_out, p->realisations, p->outlier ? "  outlier?" : "");
    }
}

static void print_correlation(const ph_fit_file *file, const ph_fit *fit)
{
    int n = fit->nunknowns;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < i; j++)
            printf("correlation of %s and %s: %.3f\n", file->unknown[j].name,
                   file->unknown[i].name, fit->correlation[i * n + j]);
}

static void print_fit(const ph_fit_file *file, const ph_fit *fit)
{
    if (file->title[0]) printf("%s\n\n", file->title);
    for (int j = 0; j < fit->nunknowns; j++)
        print_unknown(file, fit, j);
    print_correlation(file, fit);
    print_points(file, fit);
    printf("\nmisfit %.4g with %d degrees of freedom", fit->misfit, fit->freedom);
    if (!isnan(fit->probability))
        printf(", probability of a larger one %.2g", fit->probability);
    if (!fit->sigma_known && fit->freedom > 0)
        printf(", relative error of the data %.2g", fit->sigma_scale);
    printf("\nrms of residuals %.3g, of leave-one-out predictions %.3g (in sigma)\n",
           fit->residual_rms, fit->left_out_rms);
    if (fit->nsamples)
        printf("%d samples, acceptance %.2f\n", fit->nsamples, fit->acceptance);
    for (int i = 0; i < fit->nnotes; i++)
        printf("note: %s\n", fit->notes[i]);
}

/* ---- the verb */

static int load(const calibrate_options *o, ph_fit_file **file)
{
    ph_error err = PH_ERROR_INIT;
    ph_case_issues issues = {0};
    char where[1024];
    ph_status st = ph_fit_file_read(o->operands.item[0], o->set.item, o->set.count, file,
                                    &issues, where, &err);
    int code = ph_status_exit_code(st);
    if (!o->quiet || st != PH_OK) talk_issues(where, &issues);
    if (st != PH_OK && issues.count == 0) code = talk_error(&err);
    ph_case_issues_free(&issues);
    return code;
}

static ph_status write_files(const ph_fit_file *file, const ph_fit *fit, const char *dir,
                             const char *json, ph_error *err)
{
    ph_status st = PH_OK;
    char path[DESTINATION_PATH + 64];
    PH_TRY(ph_fit_write_pictures(file, fit, dir, err));
    snprintf(path, sizeof path, "%s/calibration.json", dir);
    PH_TRY(ph_write_file(path, json, strlen(json), err));
out:
    return st;
}

static ph_status calibrate(const calibrate_options *o, const ph_fit_file *file,
                           const char *dir, ph_error *err)
{
    ph_status st = PH_OK;
    ph_fit *fit = NULL;
    char *json = NULL;
    long solved = 0;
    bool bar = isatty(STDERR_FILENO);
    watch w = {.shown = !o->quiet && (bar || o->progress), .bar = bar};
    const ph_ctx ctx = {.progress = watch_step, .user = &w, .threads = o->threads};
    w.begin = w.last = now_seconds();
    PH_TRY(destination_make(dir, err));
    interrupt_install();
    st = ph_fit_file_run(file, dir, o->retry, &ctx, &fit, &solved, err);
    watch_end(&w);
    PH_TRY(st);
    PH_TRY(ph_fit_to_json(file, fit, NULL, &json, err));
    PH_TRY(write_files(file, fit, dir, json, err));
    if (o->json)
        printf("%s\n", json);
    else
        print_fit(file, fit);
    if (!o->quiet)
        talk("%ld realisations solved, %ld read back; result in %s/", solved,
             fit->solves - solved, dir);
out:
    ph_fit_free(&fit);
    free(json);
    return st;
}

static int calibrate_with(const calibrate_options *o)
{
    ph_error err = PH_ERROR_INIT;
    ph_fit_file *file = NULL;
    char beside[DESTINATION_PATH];
    int code = load(o, &file);
    if (code == 0) {
        destination_default(o->operands.item[0], beside);
        ph_status st = calibrate(o, file, o->output ? o->output : beside, &err);
        code = ph_status_exit_code(st);
        if (st == PH_ECANCELLED)
            talk("interrupted; what was solved is kept, run again to go on");
        else if (st != PH_OK)
            talk_error(&err);
    }
    ph_fit_file_free(&file);
    return code;
}

int cmd_calibrate(int argc, char **argv)
{
    calibrate_options o = {0};
    int code = options_parse(&calibrate_verb, argc, argv, &o);
    if (code < 0) code = calibrate_with(&o);
    free(o.operands.item);
    free(o.set.item);
    return code;
}
