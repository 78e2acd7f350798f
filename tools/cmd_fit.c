/* SPDX-License-Identifier: GPL-3.0-or-later */
/* perihom fit: Prony series from measurements. */
#include "check.h"
#include "fit.h"

#include <stdlib.h>
#include <string.h>

static const option_spec options[] = {
    {0, "kind", "KIND", OPTION_TEXT, offsetof(fit_options, kind), "by the columns",
     "relaxation, creep or dynamic"},
    {0, "terms", "N", OPTION_INTEGER, offsetof(fit_options, terms), "the least BIC",
     "so many terms; their times are sought"},
    {0, "per-decade", "K", OPTION_TEXT, offsetof(fit_options, per_decade), NULL,
     "times on the grid 10^(i/K) instead of sought ones"},
    {0, "times", "LIST", OPTION_TEXT, offsetof(fit_options, times), NULL,
     "these times, e.g. 0.1,1,10"},
    {0, "fluid", NULL, OPTION_FLAG, offsetof(fit_options, fluid), NULL,
     "no equilibrium modulus"},
    {0, "solid", NULL, OPTION_FLAG, offsetof(fit_options, solid), NULL,
     "an equilibrium modulus; neither: by the BIC"},
    {0, "absolute", NULL, OPTION_FLAG, offsetof(fit_options, absolute), NULL,
     "equal weights instead of relative residuals"},
    {0, "shift", "LAW", OPTION_TEXT, offsetof(fit_options, shift), "overlap",
     "of several temperatures: overlap, wlf:C1,C2 or arrhenius:J/mol"},
    {0, "reference", "T", OPTION_TEXT, offsetof(fit_options, reference), "the middle one",
     "temperature that the series is for"},
    {0, "temperature-unit", "U", OPTION_TEXT, offsetof(fit_options, unit), "C", "C or K"},
    {0, "name", "KEY", OPTION_TEXT, offsetof(fit_options, name), "E",
     "key of the block: E, bulk or shear"},
    {'o', "output", "DIR", OPTION_TEXT, offsetof(fit_options, output), NULL,
     "also write fit.yaml, .json, .csv, .svg and .png there"},
    OPTION_JSON(fit_options),
    {0, "time", "COLUMN", OPTION_TEXT, offsetof(fit_options, time), "time", "times"},
    {0, "frequency", "COLUMN", OPTION_TEXT, offsetof(fit_options, frequency), "frequency",
     "frequencies f; omega is 2 pi f"},
    {0, "omega", "COLUMN", OPTION_TEXT, offsetof(fit_options, omega), "omega",
     "angular frequencies"},
    {0, "modulus", "COLUMN", OPTION_TEXT, offsetof(fit_options, modulus), "modulus, E, G",
     "relaxation moduli"},
    {0, "compliance", "COLUMN", OPTION_TEXT, offsetof(fit_options, compliance),
     "compliance, J, D", "creep compliances"},
    {0, "storage", "COLUMN", OPTION_TEXT, offsetof(fit_options, storage),
     "storage, E', G'", "storage moduli"},
    {0, "loss", "COLUMN", OPTION_TEXT, offsetof(fit_options, loss), "loss, E'', G''",
     "loss moduli"},
    {0, "tan-delta", "COLUMN", OPTION_TEXT, offsetof(fit_options, tan_delta), "tan delta",
     "instead of a loss modulus"},
    {0, "sd", "COLUMN", OPTION_TEXT, offsetof(fit_options, sd), "sd",
     "standard deviations of modulus, compliance or storage"},
    {0, "loss-sd", "COLUMN", OPTION_TEXT, offsetof(fit_options, loss_sd), "loss sd",
     "standard deviations of the loss"},
    {0, "temperature", "COLUMN", OPTION_TEXT, offsetof(fit_options, temperature),
     "temperature, T", "temperatures"},
};

static const verb_spec fit_verb = {
    .name = "fit",
    .title = "Prony series of a modulus from measurements",
    .operands = "DATA.csv",
    .operands_min = 1,
    .operands_max = 1,
    .operands_offset = offsetof(fit_options, operands),
    .example =
        {{"perihom fit resin.csv",
          "a block for the material of a case file, with the misfit of each number "
          "of terms"},
         {"perihom fit dma.csv --reference 20 -o resin-fit",
          "master curve of several temperatures; pictures and tables in a folder"},
         {"perihom fit creep.csv --terms 4 --json | jq .modulus",
          "four terms, for a script"}},
    .options = options,
    .noptions = sizeof options / sizeof *options,
    .more =
        "DATA.csv has a header row; columns are found by name, with or without a unit in "
        "brackets.\n"
        "exit codes: 0 done, 2 usage, 3 data not admissible, 4 not converged, 5 file or "
        "memory",
};

/* A list of numbers separated by commas; malloc'd. */
static ph_status read_times(const char *text, int *count, double **out, ph_error *err)
{
    ph_status st = PH_OK;
    *out = calloc(strlen(text) + 1, sizeof **out);
    PH_CHECK(*out, PH_ENOMEM, "no memory for the times");
    for (const char *at = text;; at++) {
        char *end = NULL;
        (*out)[(*count)++] = strtod(at, &end);
        PH_CHECK(end != at && (*end == ',' || *end == 0), PH_EUSAGE,
                 "--times is a list such as 0.1,1,10, not '%s'", text);
        at = end;
        if (*at == 0) break;
    }
out:
    return st;
}

static ph_status make_params(const fit_options *o, ph_prony_fit_params *p, double **times,
                             ph_error *err)
{
    ph_status st = PH_OK;
    *p = (ph_prony_fit_params){.terms = o->terms, .absolute = o->absolute};
    PH_CHECK(!(o->fluid && o->solid), PH_EUSAGE,
             "--fluid and --solid exclude each other");
    PH_CHECK((o->terms > 0) + (o->per_decade != NULL) + (o->times != NULL) <= 1,
             PH_EUSAGE, "--terms, --per-decade and --times exclude each other");
    PH_CHECK(!o->name || strcmp(o->name, "E") == 0 || strcmp(o->name, "bulk") == 0 ||
                 strcmp(o->name, "shear") == 0,
             PH_EUSAGE, "--name is E, bulk or shear, not '%s'", o->name);
    p->rest = o->fluid ? PH_PRONY_FLUID : o->solid ? PH_PRONY_SOLID : PH_PRONY_AUTOMATIC;
    if (o->per_decade) {
        char *end = NULL;
        p->per_decade = strtod(o->per_decade, &end);
        PH_CHECK(*end == 0 && p->per_decade > 0, PH_EUSAGE,
                 "--per-decade is a number > 0, not '%s'", o->per_decade);
    }
    if (o->times) {
        PH_TRY(read_times(o->times, &p->ntimes, times, err));
        p->times = *times;
    }
out:
    return st;
}

static ph_status fit_with(const fit_options *o, ph_error *err)
{
    ph_status st = PH_OK;
    fit_input in = {.table = NULL};
    ph_prony_fit *fit = NULL;
    double *times = NULL;
    char *text = NULL;
    ph_prony_fit_params params;
    PH_TRY(make_params(o, &params, &times, err));
    PH_TRY(fit_input_read(o, &in, err));
    st = ph_prony_fit_new(&in.data, &params, &fit, err);
    if (st != PH_OK) {
        ph_error_prefix(err, "%s: ", in.table->path);
        goto out;
    }
    if (o->terms > fit->modulus.nterms && in.data.kind != PH_PRONY_CREEP)
        talk("the data support no more than %d terms", fit->modulus.nterms);
    if (o->json)
        PH_TRY(fit_json(o, &in, fit, &text, err));
    else
        PH_TRY(fit_yaml(o, &in, fit, &text, err));
    if (o->output) PH_TRY(fit_write(o, &in, fit, err));
    fputs(text, stdout);
out:
    free(text);
    free(times);
    ph_prony_fit_free(&fit);
    fit_input_free(&in);
    return st;
}

int cmd_fit(int argc, char **argv)
{
    fit_options o = {.terms = 0};
    ph_error err = PH_ERROR_INIT;
    int code = options_parse(&fit_verb, argc, argv, &o);
    if (code < 0) {
        code = 0;
        ph_status st = fit_with(&o, &err);
        if (st == PH_EUSAGE)
            code = options_usage_error(&fit_verb, "%s", err.msg);
        else if (st != PH_OK)
            code = talk_error(&err);
    }
    free(o.operands.item);
    return code;
}
