/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "check.h"
#include "fit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_TEMPERATURES = 200 };

static const double pi = 3.14159265358979323846;

const char *fit_kind_name(ph_prony_kind kind)
{
    static const char *const names[] = {"relaxation", "creep", "dynamic"};
    return names[kind];
}

const char *fit_weights(const fit_options *o, const fit_input *in)
{
    return in->data.value_sd ? "standard deviations"
           : o->absolute     ? "absolute"
                             : "relative";
}

void fit_input_free(fit_input *in)
{
    ph_table_free(&in->table);
    free(in->x);
    free(in->value);
    free(in->loss);
    free(in->sd);
    free(in->loss_sd);
    free(in->temperature);
    free(in->temperatures);
}

/* Index of a column: named by its option, or by the usual names; -1 if not there. */
static ph_status find_column(const ph_table *t, const char *option, const char *chosen,
                             const char *const usual[], int *out, ph_error *err)
{
    ph_status st = PH_OK;
    *out = -1;
    for (int k = 0; !chosen && *out < 0 && usual[k]; k++) {
        *out = ph_table_column(t, usual[k]);
        /* one letter: t is not T */
        if (*out >= 0 && !usual[k][1] && t->name[*out][0] != usual[k][0]) *out = -1;
    }
    if (!chosen) goto out;
    *out = ph_table_column(t, chosen);
    const char *names[PH_TABLE_COLUMNS];
    for (int k = 0; k < t->ncolumns; k++)
        names[k] = t->name[k];
    const char *near = ph_nearest_name(chosen, names, (size_t)t->ncolumns);
    PH_CHECK(*out >= 0, PH_EINVAL, "%s: no column '%s' (--%s)%s%s%s", t->path, chosen,
             option, near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
out:
    return st;
}

/* A copy of a column; every cell must have a value. */
static ph_status take_column(const ph_table *t, int column, double **out, ph_error *err)
{
    ph_status st = PH_OK;
    *out = calloc((size_t)t->nrows + 1, sizeof **out);
    PH_CHECK(*out, PH_ENOMEM, "no memory for a column");
    for (ptrdiff_t i = 0; i < t->nrows; i++) {
        (*out)[i] = t->value[column * t->nrows + i];
        PH_CHECK(!isnan((*out)[i]), PH_EINVAL,
                 "%s:%d: column '%s': no value; delete the row, or fill the cell",
                 t->path, t->line[i], t->name[column]);
    }
out:
    return st;
}

/* The columns of a table. */
typedef struct columns {
    int time, frequency, omega, modulus, compliance, storage, loss, tan_delta, sd,
        loss_sd, temperature;
} columns;

static ph_status find_columns(const fit_options *o, const ph_table *t, columns *c,
                              ph_error *err)
{
    ph_status st = PH_OK;
    const struct {
        const char *option, *chosen;
        const char *usual[6];
        int *out;
    } all[] = {
        {"time", o->time, {"time", "t", NULL}, &c->time},
        {"frequency", o->frequency, {"frequency", "f", NULL}, &c->frequency},
        {"omega", o->omega, {"omega", "angular frequency", "w", NULL}, &c->omega},
        {"modulus", o->modulus, {"modulus", "E", "G", NULL}, &c->modulus},
        {"compliance", o->compliance, {"compliance", "J", "D", NULL}, &c->compliance},
        {"storage",
         o->storage,
         {"storage", "storage modulus", "E'", "G'", NULL},
         &c->storage},
        {"loss", o->loss, {"loss", "loss modulus", "E''", "G''", NULL}, &c->loss},
        {"tan-delta",
         o->tan_delta,
         {"tan delta", "tan_delta", "tand", NULL},
         &c->tan_delta},
        {"sd", o->sd, {"sd", "standard deviation", NULL}, &c->sd},
        {"loss-sd", o->loss_sd, {"loss sd", "loss_sd", NULL}, &c->loss_sd},
        {"temperature", o->temperature, {"temperature", "T", NULL}, &c->temperature},
    };
    for (size_t k = 0; k < sizeof all / sizeof *all; k++)
        PH_TRY(
            find_column(t, all[k].option, all[k].chosen, all[k].usual, all[k].out, err));
out:
    return st;
}

static ph_status choose_kind(const fit_options *o, const ph_table *t, const columns *c,
                             ph_prony_kind *out, ph_error *err)
{
    ph_status st = PH_OK;
    const bool dynamic = c->storage >= 0 && (c->frequency >= 0 || c->omega >= 0);
    const bool relaxation = c->time >= 0 && c->modulus >= 0;
    const bool creep = c->time >= 0 && c->compliance >= 0;
    const bool has[3] = {relaxation, creep, dynamic};
    static const char *const needs[3] = {"time and modulus", "time and compliance",
                                         "frequency or omega, storage and loss"};
    if (o->kind) {
        int k = 0;
        while (k < 3 && strcmp(o->kind, fit_kind_name((ph_prony_kind)k)) != 0)
            k++;
        PH_CHECK(k < 3, PH_EUSAGE, "--kind is relaxation, creep or dynamic, not '%s'",
                 o->kind);
        PH_CHECK(has[k], PH_EINVAL,
                 "%s: %s data need the columns %s; name them with --time and so on",
                 t->path, o->kind, needs[k]);
        *out = (ph_prony_kind)k;
        goto out;
    }
    PH_CHECK(dynamic + relaxation + creep > 0, PH_EINVAL,
             "%s: needs the columns time and modulus, time and compliance, or frequency, "
             "storage and loss; options name other ones",
             t->path);
    PH_CHECK(dynamic + relaxation + creep == 1, PH_EINVAL,
             "%s: has columns of more than one kind of data: choose one with --kind",
             t->path);
    *out = dynamic ? PH_PRONY_DYNAMIC : relaxation ? PH_PRONY_RELAXATION : PH_PRONY_CREEP;
out:
    return st;
}

static ph_status take_dynamic(const columns *c, fit_input *in, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_table *t = in->table;
    const int x = c->omega >= 0 ? c->omega : c->frequency;
    PH_CHECK(c->loss >= 0 || c->tan_delta >= 0, PH_EINVAL,
             "%s: dynamic data need a column loss or tan delta", t->path);
    PH_TRY(take_column(t, x, &in->x, err));
    PH_TRY(take_column(t, c->storage, &in->value, err));
    PH_TRY(take_column(t, c->loss >= 0 ? c->loss : c->tan_delta, &in->loss, err));
    in->x_name = c->omega >= 0 ? t->name[x] : "angular frequency";
    in->value_name = t->name[c->storage];
    in->loss_name = c->loss >= 0 ? t->name[c->loss] : "loss";
    for (ptrdiff_t i = 0; i < t->nrows; i++) {
        if (c->omega < 0) in->x[i] *= 2 * pi;
        if (c->loss < 0) in->loss[i] *= in->value[i];
    }
out:
    return st;
}

static ph_status take_columns(const columns *c, fit_input *in, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_table *t = in->table;
    const bool dynamic = in->data.kind == PH_PRONY_DYNAMIC;
    if (dynamic) {
        PH_TRY(take_dynamic(c, in, err));
    } else {
        int y = in->data.kind == PH_PRONY_CREEP ? c->compliance : c->modulus;
        PH_TRY(take_column(t, c->time, &in->x, err));
        PH_TRY(take_column(t, y, &in->value, err));
        in->x_name = t->name[c->time];
        in->value_name = t->name[y];
    }
    if (c->sd >= 0) PH_TRY(take_column(t, c->sd, &in->sd, err));
    if (c->loss_sd >= 0) PH_TRY(take_column(t, c->loss_sd, &in->loss_sd, err));
    if (c->temperature >= 0)
        PH_TRY(take_column(t, c->temperature, &in->temperature, err));
    in->data.n = t->nrows;
    in->data.x = in->x;
    in->data.value = in->value;
    in->data.loss = in->loss;
    in->data.value_sd = in->sd;
    in->data.loss_sd = dynamic ? in->loss_sd : NULL;
out:
    return st;
}

/* ---- temperatures ---- */

static ph_status list_temperatures(fit_input *in, ph_error *err)
{
    ph_status st = PH_OK;
    in->temperatures = calloc((size_t)in->data.n + 1, sizeof *in->temperatures);
    PH_CHECK(in->temperatures, PH_ENOMEM, "no memory for the temperatures");
    for (ptrdiff_t i = 0; i < in->data.n; i++) {
        const double T = in->temperature[i];
        int j = 0;
        while (j < in->ntemperatures && in->temperatures[j].temperature < T)
            j++;
        if (j < in->ntemperatures && in->temperatures[j].temperature == T) {
            in->temperatures[j].points++;
            continue;
        }
        memmove(in->temperatures + j + 1, in->temperatures + j,
                (size_t)(in->ntemperatures - j) * sizeof *in->temperatures);
        in->temperatures[j] =
            (fit_temperature){.temperature = T, .factor = 1, .points = 1};
        in->ntemperatures++;
    }
out:
    return st;
}

static ph_status choose_reference(const fit_options *o, fit_input *in, ph_error *err)
{
    ph_status st = PH_OK;
    if (!o->reference) {
        in->reference = in->temperatures[in->ntemperatures / 2].temperature;
        talk("reference temperature %g (--reference for another)", in->reference);
        goto out;
    }
    char *end = NULL;
    in->reference = strtod(o->reference, &end);
    PH_CHECK(*end == 0 && end != o->reference && isfinite(in->reference), PH_EUSAGE,
             "--reference is a temperature, not '%s'", o->reference);
out:
    return st;
}

/* `count` positive numbers separated by commas, and nothing else. */
static bool read_numbers(const char *text, int count, double *const out[])
{
    for (int k = 0; k < count; k++) {
        char *end = NULL;
        *out[k] = strtod(text, &end);
        if (end == text || !(*out[k] > 0 && isfinite(*out[k]))) return false;
        if (*end != (k + 1 < count ? ',' : 0)) return false;
        text = end + 1;
    }
    return true;
}

/* "wlf:17.44,51.6" or "arrhenius:75000" */
static ph_status read_law(const char *text, double reference, ph_shift *law,
                          ph_error *err)
{
    ph_status st = PH_OK;
    double *const wlf[] = {&law->c1, &law->c2}, *const one[] = {&law->activation_energy};
    bool good = false;
    *law = (ph_shift){.reference = reference};
    if (strncmp(text, "wlf:", 4) == 0) {
        law->kind = PH_SHIFT_WLF;
        good = read_numbers(text + 4, 2, wlf);
    } else if (strncmp(text, "arrhenius:", 10) == 0) {
        law->kind = PH_SHIFT_ARRHENIUS;
        good = read_numbers(text + 10, 1, one);
    }
    PH_CHECK(good, PH_EUSAGE,
             "--shift is overlap, wlf:C1,C2 or arrhenius:ENERGY with positive numbers, "
             "not '%s'",
             text);
out:
    return st;
}

/* The law behind the factors: Arrhenius with one constant, or WLF with two, which contains
 * it; the one with the smaller BIC. */
static void find_law(fit_input *in)
{
    double T[MOST_TEMPERATURES], a[MOST_TEMPERATURES], least = INFINITY;
    int n = 0;
    for (int k = 0; k < in->ntemperatures && n < MOST_TEMPERATURES; k++) {
        if (in->temperatures[k].temperature == in->reference) continue;
        T[n] = in->temperatures[k].temperature;
        a[n++] = in->temperatures[k].factor;
    }
    for (int kind = PH_SHIFT_WLF; kind <= PH_SHIFT_ARRHENIUS; kind++) {
        const int constants = kind == PH_SHIFT_WLF ? 2 : 1;
        ph_shift law;
        double misfit;
        /* as many constants as factors always meet them */
        if (n <= constants || ph_shift_fit((ph_shift_kind)kind, n, T, a, in->reference,
                                           in->kelvin, &law, &misfit, NULL) != PH_OK)
            continue;
        double bic = n * log(misfit * misfit + 1e-20) + constants * log(n);
        if (bic >= least) continue;
        least = bic;
        in->law = law;
        in->law_misfit = misfit;
    }
}

static ph_status shift(const fit_options *o, fit_input *in, ph_error *err)
{
    ph_status st = PH_OK;
    double *factor = calloc((size_t)in->data.n + 1, sizeof *factor);
    PH_CHECK(factor, PH_ENOMEM, "no memory for the shift factors");
    in->overlap = !o->shift || strcmp(o->shift, "overlap") == 0;
    if (in->overlap)
        PH_TRY(ph_shift_overlap(&in->data, in->temperature, in->reference, factor,
                                &in->gap, err));
    else
        PH_TRY(read_law(o->shift, in->reference, &in->law, err));
    for (ptrdiff_t i = 0; i < in->data.n; i++) {
        if (!in->overlap)
            PH_TRY(ph_shift_factor(&in->law, in->temperature[i], in->kelvin, &factor[i],
                                   err));
        in->x[i] *= in->data.kind == PH_PRONY_DYNAMIC ? factor[i] : 1 / factor[i];
        for (int k = 0; k < in->ntemperatures; k++)
            if (in->temperatures[k].temperature == in->temperature[i])
                in->temperatures[k].factor = factor[i];
    }
    if (in->overlap) find_law(in);
out:
    free(factor);
    return st;
}

static ph_status shift_to_reference(const fit_options *o, fit_input *in, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(!o->unit || strcmp(o->unit, "C") == 0 || strcmp(o->unit, "K") == 0,
             PH_EUSAGE, "--temperature-unit is C or K, not '%s'", o->unit);
    in->kelvin = o->unit && o->unit[0] == 'K' ? 0 : 273.15;
    PH_CHECK(in->temperature || !(o->shift || o->reference), PH_EINVAL,
             "%s: has no column temperature to shift by", in->table->path);
    if (!in->temperature || in->data.n == 0) goto out;
    PH_TRY(list_temperatures(in, err));
    in->shifted = in->ntemperatures > 1 || o->shift;
    if (!in->shifted) goto out;
    PH_TRY(choose_reference(o, in, err));
    PH_TRY(shift(o, in, err));
out:
    return st;
}

/* Values that no fit accepts, with their line. */
static ph_status check_values(const fit_input *in, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_table *t = in->table;
    for (ptrdiff_t i = 0; i < in->data.n; i++) {
        PH_CHECK(in->x[i] > 0, PH_EUNPHYSICAL, "%s:%d: column '%s': %g must be > 0",
                 t->path, t->line[i], in->x_name, in->x[i]);
        PH_CHECK(in->value[i] > 0, PH_EUNPHYSICAL, "%s:%d: column '%s': %g must be > 0",
                 t->path, t->line[i], in->value_name, in->value[i]);
        PH_CHECK(!in->loss || in->loss[i] >= 0, PH_EUNPHYSICAL,
                 "%s:%d: column '%s': %g must not be negative", t->path, t->line[i],
                 in->loss_name, in->loss[i]);
        PH_CHECK(!in->sd || in->sd[i] > 0, PH_EUNPHYSICAL,
                 "%s:%d: standard deviation %g must be > 0", t->path, t->line[i],
                 in->sd[i]);
    }
out:
    return st;
}

ph_status fit_input_read(const fit_options *o, fit_input *in, ph_error *err)
{
    ph_status st = PH_OK;
    columns c;
    *in = (fit_input){.table = NULL};
    PH_TRY(ph_table_read(o->operands.item[0], &in->table, err));
    PH_TRY(find_columns(o, in->table, &c, err));
    PH_TRY(choose_kind(o, in->table, &c, &in->data.kind, err));
    PH_TRY(take_columns(&c, in, err));
    PH_TRY(check_values(in, err));
    PH_TRY(shift_to_reference(o, in, err));
out:
    return st;
}
