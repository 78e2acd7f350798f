/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The folder of perihom fit: block, document, table and pictures. */
#include "check.h"
#include "destination.h"
#include "fit.h"

#include <math.h>
#include <string.h>

enum { CURVE = 300, MOST_TEMPERATURES = 8, SERIES = 2 * MOST_TEMPERATURES + 2 };

static ph_status write_text(const char *dir, const char *name, const char *text,
                            ph_error *err)
{
    char path[DESTINATION_PATH + 32];
    snprintf(path, sizeof path, "%s/%s", dir, name);
    return ph_write_file(path, text, strlen(text), err);
}

static ph_status write_table(const fit_options *o, const fit_input *in,
                             const ph_prony_fit *fit, ph_error *err)
{
    ph_status st = PH_OK;
    ph_table *t = NULL;
    char *text = NULL;
    const bool dynamic = fit->kind == PH_PRONY_DYNAMIC;
    const char *const names[3][5] = {
        {"time", "modulus", "fit", NULL, NULL},
        {"time", "compliance", "fit", NULL, NULL},
        {"omega", "storage", "fit storage", "loss", "fit loss"}};
    const double *const column[5] = {in->x, in->value, fit->value, in->loss, fit->loss};
    PH_TRY(ph_table_new(dynamic ? 5 : 3, names[fit->kind], fit->n, &t, err));
    for (int k = 0; k < t->ncolumns; k++)
        memcpy(t->value + k * t->nrows, column[k], (size_t)t->nrows * sizeof(double));
    PH_TRY(ph_table_to_csv(t, &text, err));
    PH_TRY(write_text(o->output, "fit.csv", text, err));
out:
    free(text);
    ph_table_free(&t);
    return st;
}

/* What a picture is made of. */
typedef struct picture {
    double *points; /* [3][n] sorted by temperature: x, value, loss */
    double *curve;  /* [3][CURVE] */
    char name[SERIES][80];
    ph_series series[SERIES];
    int count;
} picture;

/* The points of one temperature (all if `only` is NAN) as series. */
static void add_points(const fit_input *in, double only, const char *label, int colour,
                       ptrdiff_t *used, picture *p)
{
    const ptrdiff_t n = in->data.n, from = *used;
    for (ptrdiff_t i = 0; i < n; i++) {
        if (!isnan(only) && in->temperature[i] != only) continue;
        p->points[*used] = in->x[i];
        p->points[n + *used] = in->value[i];
        if (in->loss) p->points[2 * n + *used] = in->loss[i];
        ++*used;
    }
    for (int part = 0; part < (in->loss ? 2 : 1); part++) {
        /* the loss of a temperature has its colour and no line of its own in the legend */
        snprintf(p->name[p->count], sizeof p->name[0], "%s",
                 part == 0 || isnan(only) ? (part ? "loss" : label) : "");
        p->series[p->count] = (ph_series){.name = p->name[p->count],
                                          .n = *used - from,
                                          .x = p->points + from,
                                          .y = p->points + (part + 1) * n + from,
                                          .style = PH_PLOT_POINTS,
                                          .colour = colour + (isnan(only) ? part : 0)};
        p->count++;
    }
}

static void add_curve(const fit_input *in, const ph_prony_fit *fit, picture *p)
{
    double lo = INFINITY, hi = 0;
    for (ptrdiff_t i = 0; i < in->data.n; i++) {
        lo = fmin(lo, in->x[i]);
        hi = fmax(hi, in->x[i]);
    }
    for (int k = 0; k < CURVE; k++) {
        double x = lo * pow(hi / lo, k / (CURVE - 1.0)), loss = 0;
        p->curve[k] = x;
        p->curve[CURVE + k] = ph_prony_fit_at(fit, x, &loss);
        p->curve[2 * CURVE + k] = loss;
    }
    for (int part = 0; part < (in->loss ? 2 : 1); part++) {
        if (part == 0)
            snprintf(p->name[p->count], sizeof p->name[0], "fit, %d terms",
                     fit->modulus.nterms);
        p->series[p->count] = (ph_series){.name = p->name[p->count],
                                          .n = CURVE,
                                          .x = p->curve,
                                          .y = p->curve + (part + 1) * CURVE,
                                          .style = PH_PLOT_LINE,
                                          .dashed = part == 1,
                                          .colour = 3};
        p->count++;
    }
}

/* Logarithmic where the values span more than a factor of ten. */
static bool spans_decades(const fit_input *in)
{
    double lo = INFINITY, hi = 0;
    for (ptrdiff_t i = 0; i < in->data.n; i++) {
        lo = fmin(lo, in->loss && in->loss[i] > 0 ? fmin(in->loss[i], in->value[i])
                                                  : in->value[i]);
        hi = fmax(hi, in->value[i]);
    }
    return hi > 10 * lo;
}

static ph_status write_pictures(const fit_options *o, const fit_input *in,
                                const ph_prony_fit *fit, ph_error *err)
{
    ph_status st = PH_OK;
    picture p = {.count = 0};
    char path[DESTINATION_PATH + 32], label[80], subtitle[160];
    ptrdiff_t used = 0;
    p.points = calloc(3 * (size_t)in->data.n + 1, sizeof *p.points);
    p.curve = calloc(3 * CURVE, sizeof *p.curve);
    PH_CHECK(p.points && p.curve, PH_ENOMEM, "no memory for the picture");
    if (in->shifted && in->ntemperatures <= MOST_TEMPERATURES) {
        for (int k = 0; k < in->ntemperatures; k++) {
            snprintf(label, sizeof label, "%g %s", in->temperatures[k].temperature,
                     in->kelvin > 0 ? "\xc2\xb0"
                                      "C"
                                    : "K");
            add_points(in, in->temperatures[k].temperature, label, k < 2 ? k + 1 : k + 2,
                       &used, &p);
        }
    } else {
        add_points(in, NAN, in->loss ? "storage" : "measured", 1, &used, &p);
    }
    add_curve(in, fit, &p);
    snprintf(subtitle, sizeof subtitle, "%d terms, misfit %.2g (rms, %s)",
             fit->modulus.nterms, fit->misfit, fit_weights(o, in));
    const ph_plot plot = {.title = in->table->path,
                          .subtitle = subtitle,
                          .xlabel = in->x_name,
                          .ylabel = in->value_name,
                          .log_x = true,
                          .log_y = spans_decades(in),
                          .nseries = p.count,
                          .series = p.series};
    for (int k = 0; k < 2; k++) {
        snprintf(path, sizeof path, "%s/fit.%s", o->output, k ? "png" : "svg");
        PH_TRY(ph_plot_write(path, &plot, err));
    }
out:
    free(p.points);
    free(p.curve);
    return st;
}

ph_status fit_write(const fit_options *o, const fit_input *in, const ph_prony_fit *fit,
                    ph_error *err)
{
    ph_status st = PH_OK;
    char *text = NULL;
    PH_CHECK(strlen(o->output) < DESTINATION_PATH, PH_EIO,
             "the path of the folder is "
             "too long");
    PH_TRY(destination_make(o->output, err));
    PH_TRY(fit_yaml(o, in, fit, &text, err));
    PH_TRY(write_text(o->output, "fit.yaml", text, err));
    free(text);
    text = NULL;
    PH_TRY(fit_json(o, in, fit, &text, err));
    PH_TRY(write_text(o->output, "fit.json", text, err));
    PH_TRY(write_table(o, in, fit, err));
    PH_TRY(write_pictures(o, in, fit, err));
out:
    free(text);
    return st;
}
