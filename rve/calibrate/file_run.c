/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A calibration of a case file: the model is the solver, behind the journal. */
#include "calibrate/file.h"
#include "io/text.h"

#include <math.h>
#include <perihom_campaign.h>
#include <string.h>

typedef struct solver {
    const ph_fit_file *file;
    ph_i_fit_journal journal;
    const ph_ctx *ctx;
    long solved;
} solver;

static void put(ph_i_growing *to, const char *key, double value)
{
    ph_i_appendf(to, "%s=", key);
    ph_i_append_exact(to, value);
}

ph_status ph_i_fit_case(const ph_fit_file *f, int point, const double *unknown,
                        ph_case **out, ph_case_issues *issues, ph_error *err)
{
    ph_status st = PH_OK;
    enum { MOST = PH_FIT_KEYS + PH_FIT_UNKNOWNS * (1 + PH_FIT_ALSO) };
    ph_i_growing own[MOST] = {{0}};
    const char **sets = NULL;
    int n = 0;
    PH_ALLOC(sets, f->nsets + MOST, "overrides");
    for (size_t i = 0; i < f->nsets; i++)
        sets[i] = f->sets[i];
    for (int k = 0; k < f->nkeys; k++)
        put(&own[n++], f->key[k], f->place[point][k]);
    for (int j = 0; j < f->nunknowns; j++) {
        put(&own[n++], f->unknown_key[j], unknown[j]);
        for (int a = 0; a < f->nalso[j]; a++)
            put(&own[n++], f->also[j][a], unknown[j]);
    }
    for (int i = 0; i < n; i++) {
        PH_CHECK(!own[i].failed, PH_ENOMEM, "no memory for overrides");
        sets[f->nsets + i] = own[i].text;
    }
    PH_TRY(ph_case_parse(f->case_text, f->case_length, f->case_path, sets, f->nsets + n,
                         out, issues, err));
out:
    for (int i = 0; i < n; i++)
        free(own[i].text);
    free(sets);
    return st;
}

/* Long solves must end when the user says so. */
static bool go_on(void *user, const ph_progress *now)
{
    const solver *s = user;
    bool go = true;
    (void)now;
#pragma omp critical(ph_calibrate)
    if (s->ctx && s->ctx->progress) {
        const ph_progress same = {.stage = NULL};
        go = s->ctx->progress(s->ctx->user, &same);
    }
    return go;
}

static ph_status solve(solver *s, const double *unknown, int point, uint64_t realisation,
                       double *output, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_fit_file *f = s->file;
    ph_case *c = NULL;
    ph_evaluation e;
    const ph_ctx ctx = {.progress = go_on, .user = s, .threads = 1};
    PH_TRY(ph_i_fit_case(f, point, unknown, &c, NULL, err));
    const ph_scenario scenario = {.c = c,
                                  .realisation = realisation + c->realisation,
                                  .noutputs = f->noutputs,
                                  .output = f->output};
    PH_TRY(ph_scenario_evaluate(&scenario, &ctx, &e, err));
    for (int i = 0; i < f->noutputs; i++)
        PH_CHECK(isfinite(e.value[i]), PH_ESINGULAR, "%s is not finite",
                 f->output[i].name);
    memcpy(output, e.value, (size_t)f->noutputs * sizeof *output);
out:
    ph_case_free(&c);
    return st;
}

static ph_status model(void *user, const double *unknown, int point, uint64_t realisation,
                       double *output, ph_error *err)
{
    solver *s = user;
    const ph_fit_file *f = s->file;
    ph_i_fit_record r = {.realisation = realisation};
    memcpy(r.place, f->place[point], (size_t)f->nkeys * sizeof *r.place);
    memcpy(r.place + f->nkeys, unknown, (size_t)f->nunknowns * sizeof *r.place);
    const ph_i_fit_record *known =
        ph_i_fit_journal_find(&s->journal, r.place, realisation);
    if (known) {
        memcpy(output, known->value, (size_t)f->noutputs * sizeof *output);
        return known->status == PH_OK ? PH_OK
                                      : PH_FAIL(err, known->status, "%s", known->message);
    }
    ph_status st = solve(s, unknown, point, realisation, output, err);
    if (st == PH_ECANCELLED || st == PH_ENOMEM || st == PH_EIO || st == PH_EINTERNAL)
        return st;
    r.status = st;
    if (st == PH_OK)
        memcpy(r.value, output, (size_t)f->noutputs * sizeof *output);
    else
        snprintf(r.message, sizeof r.message, "%.250s", err ? err->msg : "");
    ph_status kept;
    ph_error why = PH_ERROR_INIT;
#pragma omp critical(ph_calibrate_journal)
    {
        kept = ph_i_fit_journal_add(&s->journal, &r, &why);
        s->solved++;
    }
    if (kept == PH_OK) return st;
    if (err) *err = why;
    return kept;
}

/* Is a realisation of the case different from the next? */
static bool is_random(const ph_case *c)
{
    for (ptrdiff_t i = 0; i < c->ncracks; i++)
        if (c->cracks[i].kind == PH_CRACKS_RANDOM) return true;
    return c->nfillers > 0;
}

ph_status ph_fit_file_run(const ph_fit_file *file, const char *dir, bool retry,
                          const ph_ctx *ctx, ph_fit **out, long *solved, ph_error *err)
{
    PH_GIVEN(file && file->base && dir && out);
    ph_status st = PH_OK;
    solver s = {.file = file, .ctx = ctx};
    PH_CHECK(file && out, PH_EINVAL, "a calibration needs a file and a place for it");
    PH_TRY(ph_i_fit_journal_open(&s.journal, file, dir, retry, err));
    const ph_fit_problem problem = {.nunknowns = file->nunknowns,
                                    .unknown = file->unknown,
                                    .npoints = file->npoints,
                                    .noutputs = file->noutputs,
                                    .nmeasurements = file->nmeasurements,
                                    .measurement = file->measurement,
                                    .random = is_random(file->base),
                                    .model = model,
                                    .user = &s};
    st = ph_calibrate(&problem, &file->params, ctx, out, err);
    if (solved) *solved = s.solved;
    ph_i_fit_journal_close(&s.journal);
out:
    return st;
}
