/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What perihom fit reads and writes. */
#ifndef TOOLS_FIT_H
#define TOOLS_FIT_H

#include "tools.h"

typedef struct fit_options {
    text_list operands;
    const char *kind, *times, *per_decade, *shift, *reference, *unit, *name, *output;
    /* columns */
    const char *time, *frequency, *omega, *modulus, *compliance, *storage, *loss,
        *tan_delta, *sd, *loss_sd, *temperature;
    int terms;
    bool fluid, solid, absolute, json;
} fit_options;

/** One temperature of the table and its shift factor. */
typedef struct fit_temperature {
    double temperature, factor;
    ptrdiff_t points;
} fit_temperature;

/** The table as data of one modulus at one temperature. */
typedef struct fit_input {
    ph_table *table;
    ph_prony_data data; /* of the arrays below */
    double *x, *value, *loss, *sd, *loss_sd;
    double *temperature;                         /* [n], or NULL */
    const char *x_name, *value_name, *loss_name; /* columns, for labels */
    bool shifted;                                /* more than one temperature */
    bool overlap;                                /* factors were found, not given */
    double reference, kelvin;
    double gap; /* rms of ln(value) between overlapping curves */
    int ntemperatures;
    fit_temperature *temperatures; /* [ntemperatures], rising */
    ph_shift law;                  /* kind PH_SHIFT_NONE: none fits */
    double law_misfit;             /* rms of ln a_T */
} fit_input;

/** Read the table, find its columns, shift to one temperature. */
ph_status fit_input_read(const fit_options *o, fit_input *in, ph_error *err);
void fit_input_free(fit_input *in);

/** The block for a case file, comments before it; malloc'd. */
ph_status fit_yaml(const fit_options *o, const fit_input *in, const ph_prony_fit *fit,
                   char **text, ph_error *err);
/** The document perihom.fit/1; malloc'd. */
ph_status fit_json(const fit_options *o, const fit_input *in, const ph_prony_fit *fit,
                   char **text, ph_error *err);
/** fit.yaml, fit.json, fit.csv, fit.svg and fit.png in the folder o->output. */
ph_status fit_write(const fit_options *o, const fit_input *in, const ph_prony_fit *fit,
                    ph_error *err);

/** "relaxation", "creep" or "dynamic". */
const char *fit_kind_name(ph_prony_kind kind);
/** What the residuals are measured with. */
const char *fit_weights(const fit_options *o, const fit_input *in);

#endif
