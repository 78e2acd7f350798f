/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The document perihom.calibration/1. */
#include "calibrate/file.h"
#include "io/json.h"

#include <math.h>
#include <string.h>

/* obj[key] = value, unless something failed before. */
static void put(json_t *obj, const char *key, json_t *value, bool *good)
{
    ph_error ignored = PH_ERROR_INIT;
    if (!*good || !obj)
        json_decref(value);
    else
        *good = ph_i_json_put(obj, key, value, &ignored) == PH_OK;
    if (!obj) *good = false;
}

static void put_number(json_t *obj, const char *key, double x, bool *good)
{
    put(obj, key, ph_i_json_number(x), good);
}

static json_t *list_of(int n, const double *x)
{
    json_t *list = json_array();
    for (int i = 0; i < n && list; i++)
        if (json_array_append_new(list, ph_i_json_number(x[i])) != 0) {
            json_decref(list);
            list = NULL;
        }
    return list;
}

static void add(json_t *list, json_t *value, bool *good)
{
    ph_error ignored = PH_ERROR_INIT;
    if (!*good || !list)
        json_decref(value);
    else
        *good = ph_i_json_add(list, value, &ignored) == PH_OK;
    if (!list) *good = false;
}

static json_t *flags_of(const bool open[2], bool *good)
{
    json_t *list = json_array();
    for (int i = 0; i < 2; i++)
        add(list, json_boolean(open[i]), good);
    return list;
}

/* Why a number of an unknown is null. */
static void put_reasons(json_t *obj, const ph_fit *fit, const ph_fit_estimate *x,
                        bool *good)
{
    json_t *why = json_object();
    if (isnan(x->standard_error))
        put(why, "standard_error",
            ph_i_json_text("the model does not change with it at this value"), good);
    else if (isnan(x->error_data))
        put(why, "error_data",
            ph_i_json_text("no sigma is given, and there are not more measurements than "
                           "unknowns"),
            good);
    if (isnan(x->profile[0]))
        put(why, "interval95_profile",
            ph_i_json_text("no surrogate could be built, see notes"), good);
    if (fit->nsamples == 0)
        put(why, "posterior", ph_i_json_text("not asked for, or no surrogate"), good);
    put(obj, "reasons", why, good);
}

static json_t *profile_json(const ph_fit_estimate *x, bool *good)
{
    json_t *p = json_object();
    put(p, "value", list_of(x->nprofile, x->profile_value), good);
    put(p, "misfit", list_of(x->nprofile, x->profile_misfit), good);
    return p;
}

static json_t *posterior_json(const ph_fit_estimate *x, bool *good)
{
    json_t *p = json_object();
    put_number(p, "mean", x->posterior_mean, good);
    put_number(p, "std", x->posterior_std, good);
    put_number(p, "median", x->posterior_quantile[1], good);
    const double ends[2] = {x->posterior_quantile[0], x->posterior_quantile[2]};
    put(p, "interval95", list_of(2, ends), good);
    put_number(p, "autocorrelation", x->autocorrelation, good);
    return p;
}

static json_t *unknown_json(const ph_fit_file *file, const ph_fit *fit, int j, bool *good)
{
    const ph_fit_estimate *x = &fit->unknown[j];
    const ph_fit_unknown *u = &file->unknown[j];
    json_t *o = json_object();
    put(o, "key", ph_i_json_text(file->unknown_key[j]), good);
    put_number(o, "value", x->value, good);
    put_number(o, "standard_error", x->standard_error, good);
    put_number(o, "error_data", x->error_data, good);
    put_number(o, "error_sampling", x->error_sampling, good);
    put_number(o, "freedom", x->freedom, good); /* null: normal */
    put(o, "interval95", list_of(2, x->interval), good);
    put(o, "interval95_open", flags_of(x->open, good), good);
    put(o, "interval95_local", list_of(2, x->local), good);
    put(o, "interval95_profile",
        isnan(x->profile[0]) ? json_null() : list_of(2, x->profile), good);
    put(o, "at_bound", json_boolean(x->at_bound), good);
    put(o, "several_intervals", json_boolean(x->several), good);
    put(o, "identifiable", ph_i_json_text(ph_fit_knowledge_text(x->knowledge)), good);
    put_number(o, "from", u->from, good);
    put_number(o, "to", u->to, good);
    put(o, "scale", json_string(u->log ? "log" : "linear"), good);
    if (x->nprofile) put(o, "profile", profile_json(x, good), good);
    if (fit->nsamples) put(o, "posterior", posterior_json(x, good), good);
    put_reasons(o, fit, x, good);
    return o;
}

static json_t *point_json(const ph_fit_file *file, const ph_fit *fit, int i, bool *good)
{
    const ph_fit_measurement *m = &file->measurement[i];
    const ph_fit_point *p = &fit->point[i];
    json_t *o = json_object(), *at = json_object();
    for (int k = 0; k < file->nkeys; k++)
        put_number(at, file->key[k], file->place[m->point][k], good);
    put(o, "at", at, good);
    put(o, "line", json_integer(file->line[m->point]), good);
    put(o, "quantity", ph_i_json_text(file->output[m->output].name), good);
    put_number(o, "measured", p->measured, good);
    put_number(o, "sigma", p->sigma, good);
    put_number(o, "model", p->model, good);
    put_number(o, "model_error", p->model_error, good);
    put_number(o, "residual", p->residual, good);
    put_number(o, "leverage", p->leverage, good);
    put_number(o, "left_out", p->left_out, good);
    put(o, "outlier", json_boolean(p->outlier), good);
    put(o, "realisations", json_integer(p->realisations), good);
    put(o, "failed", json_integer(p->failed), good);
    return o;
}

static json_t *identifiability_json(const ph_fit_file *file, const ph_fit *fit,
                                    bool *good)
{
    json_t *list = json_array();
    for (int a = 0; a < fit->nunknowns; a++) {
        const ph_fit_direction *d = &fit->direction[a];
        json_t *o = json_object(), *along = json_object();
        for (int j = 0; j < fit->nunknowns; j++)
            put_number(along, file->unknown[j].name, d->component[j], good);
        put(o, "direction", along, good);
        put_number(o, "eigenvalue", d->eigenvalue, good);
        put_number(o, "standard_error", d->standard_error, good);
        put(o, "identifiable", ph_i_json_text(ph_fit_knowledge_text(d->knowledge)), good);
        add(list, o, good);
    }
    return list;
}

static json_t *minima_json(const ph_fit_file *file, const ph_fit *fit, bool *good)
{
    json_t *list = json_array();
    for (int i = 0; i < fit->nminima; i++) {
        const ph_fit_minimum *m = &fit->minimum[i];
        json_t *o = json_object(), *at = json_object();
        for (int j = 0; j < fit->nunknowns; j++)
            put_number(at, file->unknown[j].name, m->value[j], good);
        put(o, "unknowns", at, good);
        put_number(o, "misfit", m->misfit, good);
        put(o, "as_good", json_boolean(m->as_good), good);
        add(list, o, good);
    }
    return list;
}

static json_t *correlation_json(const ph_fit *fit, bool *good)
{
    int n = fit->nunknowns;
    json_t *rows = json_array();
    for (int i = 0; i < n; i++)
        add(rows, list_of(n, fit->correlation + (size_t)i * n), good);
    return rows;
}

static json_t *notes_json(const ph_fit *fit, bool *good)
{
    json_t *list = json_array();
    for (int i = 0; i < fit->nnotes; i++)
        add(list, ph_i_json_text(fit->notes[i]), good);
    return list;
}

static void put_fit(json_t *doc, const ph_fit_file *file, const ph_fit *fit, bool *good)
{
    json_t *unknowns = json_object(), *points = json_array();
    for (int j = 0; j < fit->nunknowns; j++)
        put(unknowns, file->unknown[j].name, unknown_json(file, fit, j, good), good);
    for (int i = 0; i < fit->nmeasurements; i++)
        add(points, point_json(file, fit, i, good), good);
    put(doc, "unknowns", unknowns, good);
    put(doc, "correlation", correlation_json(fit, good), good);
    put_number(doc, "misfit", fit->misfit, good);
    put(doc, "degrees_of_freedom", json_integer(fit->freedom), good);
    put_number(doc, "probability", fit->probability, good);
    put(doc, "sigma_known", json_boolean(fit->sigma_known), good);
    put_number(doc, "relative_error_found",
               fit->sigma_known ? (double)NAN : fit->sigma_scale, good);
    put_number(doc, "residual_rms", fit->residual_rms, good);
    put_number(doc, "leave_one_out_rms", fit->left_out_rms, good);
    put(doc, "points", points, good);
    put(doc, "identifiability", identifiability_json(file, fit, good), good);
    put(doc, "minima", minima_json(file, fit, good), good);
    put(doc, "sampling_target_reached", json_boolean(fit->reached), good);
    put_number(doc, "surrogate_error", fit->surrogate_error, good);
    put(doc, "evaluations", json_integer(fit->evaluations), good);
    put(doc, "realisations", json_integer(fit->solves), good);
    put(doc, "failed", json_integer(fit->failures), good);
    if (fit->nsamples) {
        put(doc, "samples", json_integer(fit->nsamples), good);
        put(doc, "walkers", json_integer(fit->walkers), good);
        put_number(doc, "acceptance", fit->acceptance, good);
    }
    put(doc, "notes", notes_json(fit, good), good);
}

ph_status ph_fit_to_json(const ph_fit_file *file, const ph_fit *fit, const char *command,
                         char **json, ph_error *err)
{
    PH_GIVEN(file && file->base && fit && json);
    ph_status st = PH_OK;
    bool good = true;
    json_t *doc = json_object(), *part = NULL;
    put(doc, "schema", json_string("perihom.calibration/1"), &good);
    put(doc, "title", ph_i_json_text(file->title), &good);
    put(doc, "case_file", ph_i_json_text(file->case_path), &good);
    put(doc, "data_file", ph_i_json_text(file->data_path), &good);
    put_fit(doc, file, fit, &good);
    PH_CHECK(good, PH_ENOMEM, "no memory for the document of a calibration");
    PH_TRY(ph_i_case_json(file->base, &part, err));
    st = ph_i_json_put(doc, "case", part, err);
    part = NULL;
    PH_TRY(st);
    PH_TRY(ph_i_json_provenance(command, &part, err));
    st = ph_i_json_put(doc, "provenance", part, err);
    part = NULL;
    PH_TRY(st);
    PH_TRY(ph_i_json_dump(doc, json, err));
out:
    json_decref(part);
    json_decref(doc);
    return st;
}
