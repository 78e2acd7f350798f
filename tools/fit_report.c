/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The result of perihom fit as a block of a case file and as JSON. */
#include "check.h"
#include "fit.h"

#include <jansson.h>

#include <math.h>
#include <stdarg.h>
#include <string.h>

/* ---- a block for a case file ---- */

/* Comments before the block: what was fitted and how well. */
static void print_comments(FILE *to, const fit_options *o, const fit_input *in,
                           const ph_prony_fit *fit)
{
    fprintf(to, "# %s data of %s: %td points, %s residuals\n", fit_kind_name(fit->kind),
            in->table->path, fit->n, fit_weights(o, in));
    fprintf(to, "# misfit %.3g (root mean square), %.3g (largest), of %td residuals\n",
            fit->misfit, fit->worst, fit->nresiduals);
    if (in->shifted) {
        fprintf(to, "# at the reference temperature %g; a_T:", in->reference);
        for (int k = 0; k < in->ntemperatures; k++)
            fprintf(to, " %g at %g%s", in->temperatures[k].factor,
                    in->temperatures[k].temperature,
                    k + 1 < in->ntemperatures ? "," : "");
        fputc('\n', to);
        if (in->overlap)
            fprintf(to, "# found by overlap, which leaves %.2g of ln(value)\n", in->gap);
        if (in->overlap && in->law.kind != PH_SHIFT_NONE)
            fprintf(to, "# the law below meets the factors to %.2g of ln(a_T)\n",
                    in->law_misfit);
    }
    if (fit->nsteps > 0) fprintf(to, "#   terms    misfit       BIC\n");
    for (int k = 0; k < fit->nsteps; k++)
        fprintf(to, "# %c %5d  %8.2e  %8.1f\n", k == fit->chosen ? '*' : ' ',
                fit->step[k].terms, fit->step[k].misfit, fit->step[k].criterion);
}

static void print_shift(FILE *to, const ph_shift *s)
{
    if (s->kind == PH_SHIFT_WLF)
        fprintf(to, "shift: {wlf: {C1: %.9g, C2: %.9g, reference: %.9g}}\n", s->c1, s->c2,
                s->reference);
    else if (s->kind == PH_SHIFT_ARRHENIUS)
        fprintf(to, "shift: {arrhenius: {activation_energy: %.9g, reference: %.9g}}\n",
                s->activation_energy, s->reference);
}

ph_status fit_yaml(const fit_options *o, const fit_input *in, const ph_prony_fit *fit,
                   char **text, ph_error *err)
{
    ph_status st = PH_OK;
    char *made = NULL;
    size_t length = 0;
    FILE *to = open_memstream(&made, &length);
    PH_CHECK(to, PH_ENOMEM, "no memory for the block");
    print_comments(to, o, in, fit);
    fprintf(to, "%s: {infinity: %.12g, terms: [", o->name ? o->name : "E",
            fit->modulus.infinity);
    for (int k = 0; k < fit->modulus.nterms; k++)
        fprintf(to, "%s\n  {modulus: %.12g, time: %.12g}", k ? "," : "",
                fit->modulus.term[k].modulus, fit->modulus.term[k].time);
    fprintf(to, "]}\n");
    print_shift(to, &in->law);
    bool failed = ferror(to) != 0;
    failed = fclose(to) != 0 || failed;
    to = NULL;
    PH_CHECK(!failed && made, PH_ENOMEM, "no memory for the block");
    *text = made;
    made = NULL;
out:
    free(made);
    return st;
}

/* ---- JSON ---- */

static json_t *number(double x)
{
    return isfinite(x) ? json_real(x) : json_null();
}

static json_t *json_terms(int n, const ph_modulus_term *term, const char *what)
{
    json_t *list = json_array();
    for (int k = 0; k < n; k++)
        json_array_append_new(
            list, json_pack("{s:f,s:f}", what, term[k].modulus, "time", term[k].time));
    return list;
}

static json_t *json_steps(const ph_prony_fit *fit)
{
    json_t *list = json_array();
    for (int k = 0; k < fit->nsteps; k++)
        json_array_append_new(
            list, json_pack("{s:i,s:f,s:f,s:b}", "terms", fit->step[k].terms, "misfit",
                            fit->step[k].misfit, "bic", fit->step[k].criterion, "chosen",
                            k == fit->chosen));
    return list;
}

static json_t *json_law(const ph_shift *s)
{
    if (s->kind == PH_SHIFT_WLF)
        return json_pack("{s:{s:f,s:f,s:f}}", "wlf", "C1", s->c1, "C2", s->c2,
                         "reference", s->reference);
    if (s->kind == PH_SHIFT_ARRHENIUS)
        return json_pack("{s:{s:f,s:f}}", "arrhenius", "activation_energy",
                         s->activation_energy, "reference", s->reference);
    return json_null();
}

static json_t *json_shift(const fit_input *in)
{
    if (!in->shifted) return json_null();
    json_t *list = json_array();
    for (int k = 0; k < in->ntemperatures; k++)
        json_array_append_new(list, json_pack("{s:f,s:f,s:I}", "temperature",
                                              in->temperatures[k].temperature, "factor",
                                              in->temperatures[k].factor, "points",
                                              (json_int_t)in->temperatures[k].points));
    json_t *shift = json_pack("{s:f,s:s,s:o,s:o}", "reference", in->reference, "found_by",
                              in->overlap ? "overlap" : "law", "factors", list, "law",
                              json_law(&in->law));
    if (in->overlap) json_object_set_new(shift, "gap", number(in->gap));
    if (in->overlap && in->law.kind != PH_SHIFT_NONE)
        json_object_set_new(shift, "law_misfit", number(in->law_misfit));
    return shift;
}

static json_t *json_creep(const ph_prony_fit *fit)
{
    if (fit->kind != PH_PRONY_CREEP) return json_null();
    return json_pack("{s:f,s:f,s:o}", "instantaneous", fit->instantaneous, "fluidity",
                     fit->fluidity, "terms",
                     json_terms(fit->nretardations, fit->retardation, "compliance"));
}

ph_status fit_json(const fit_options *o, const fit_input *in, const ph_prony_fit *fit,
                   char **text, ph_error *err)
{
    ph_status st = PH_OK;
    char *made = NULL, *line = NULL;
    json_t *root =
        json_pack("{s:s,s:s,s:s,s:s,s:I,s:{s:f,s:o},s:o,s:{s:f,s:f,s:I,s:s},s:o,s:o}",
                  "schema", "perihom.fit/1", "file", in->table->path, "kind",
                  fit_kind_name(fit->kind), "key", o->name ? o->name : "E", "points",
                  (json_int_t)fit->n, "modulus", "infinity", fit->modulus.infinity,
                  "terms", json_terms(fit->modulus.nterms, fit->modulus.term, "modulus"),
                  "creep", json_creep(fit), "misfit", "rms", fit->misfit, "largest",
                  fit->worst, "residuals", (json_int_t)fit->nresiduals, "weights",
                  fit_weights(o, in), "steps", json_steps(fit), "shift", json_shift(in));
    PH_CHECK(root, PH_ENOMEM, "no memory for the JSON document");
    made = json_dumps(root, JSON_INDENT(1) | JSON_REAL_PRECISION(17));
    PH_CHECK(made, PH_ENOMEM, "no memory for the JSON document");
    line = realloc(made, strlen(made) + 2);
    PH_CHECK(line, PH_ENOMEM, "no memory for the JSON document");
    made = NULL;
    strcat(line, "\n");
    *text = line;
out:
    free(made);
    json_decref(root);
    return st;
}
