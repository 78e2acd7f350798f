/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures of a calibration: model against measurement, profiles; samples as a table. */
#include <perihom/output.h>
#include <perihom/plot.h>
#include <perihom/table.h>

#include "calibrate/file.h"

#include <math.h>
#include <string.h>

/* Numbers of one quantity, in the order of the horizontal axis. */
typedef struct curve {
    int n;
    double *x, *y, *low, *high, *model, *model_low, *model_high;
} curve;

static void curve_free(curve *c)
{
    free(c->x);
    *c = (curve){.n = 0};
}

static ph_status curve_new(curve *c, int n, ph_error *err)
{
    ph_status st = PH_OK;
    PH_ALLOC(c->x, 7 * (size_t)n, "a plot");
    double **const part[] = {&c->y,     &c->low,       &c->high,
                             &c->model, &c->model_low, &c->model_high};
    for (int i = 0; i < 6; i++)
        *part[i] = c->x + (size_t)(i + 1) * n;
out:
    return st;
}

/* Insert measurement i, by x. */
static void curve_add(curve *c, double x, const ph_fit_point *p, bool known)
{
    int at = c->n++;
    double *const all[] = {c->x,     c->y,         c->low,       c->high,
                           c->model, c->model_low, c->model_high};
    double half = known ? p->sigma : 0;
    double error = isnan(p->model_error) ? 0 : 2 * p->model_error;
    const double value[] = {
        x,        p->measured,      p->measured - half, p->measured + half,
        p->model, p->model - error, p->model + error};
    for (; at > 0 && c->x[at - 1] > x; at--)
        for (int k = 0; k < 7; k++)
            all[k][at] = all[k][at - 1];
    for (int k = 0; k < 7; k++)
        all[k][at] = value[k];
}

static ph_status plot_quantity(const ph_fit_file *file, const ph_fit *fit, int output,
                               const char *path, ph_error *err)
{
    ph_status st = PH_OK;
    curve c = {.n = 0};
    char label[PH_FIT_KEY + 16], title[400];
    PH_TRY(curve_new(&c, fit->nmeasurements, err));
    for (int i = 0; i < fit->nmeasurements; i++) {
        const ph_fit_measurement *m = &file->measurement[i];
        if (m->output != output) continue;
        double x = file->nkeys ? file->place[m->point][0] : i + 1;
        curve_add(&c, x, &fit->point[i], fit->sigma_known);
    }
    snprintf(label, sizeof label, "%s", file->nkeys ? file->key[0] : "measurement");
    snprintf(title, sizeof title, "%.250s", file->title[0] ? file->title : file->path);
    const ph_series series[] = {
        {.name = "model, 2 standard errors",
         .n = c.n,
         .x = c.x,
         .y = c.model,
         .low = c.model_low,
         .high = c.model_high,
         .style = file->nkeys == 1 ? PH_PLOT_LINE_POINTS : PH_PLOT_POINTS},
        {.name = "measured, 1 sigma",
         .n = c.n,
         .x = c.x,
         .y = c.y,
         .low = c.low,
         .high = c.high,
         .style = PH_PLOT_POINTS}};
    const ph_plot plot = {.title = title,
                          .xlabel = label,
                          .ylabel = file->output[output].name,
                          .nseries = 2,
                          .series = series};
    PH_TRY(ph_plot_write(path, &plot, err));
out:
    curve_free(&c);
    return st;
}

static ph_status plot_profile(const ph_fit_file *file, const ph_fit *fit, int j,
                              const char *path, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_fit_estimate *x = &fit->unknown[j];
    double limit = fit->misfit + fit->misfit_limit;
    double ends[2] = {x->profile_value[0], x->profile_value[x->nprofile - 1]};
    double limits[2] = {limit, limit}, value[1] = {x->value}, misfit[1] = {fit->misfit};
    double top = fit->misfit + 4 * fit->misfit_limit;
    const ph_series series[] = {
        {.name = "least misfit",
         .n = x->nprofile,
         .x = x->profile_value,
         .y = x->profile_misfit,
         .style = PH_PLOT_LINE},
        {.name = "95 %, errors of the data",
         .n = 2,
         .x = ends,
         .y = limits,
         .style = PH_PLOT_LINE,
         .dashed = true},
        {.name = "estimate", .n = 1, .x = value, .y = misfit, .style = PH_PLOT_POINTS}};
    ph_plot plot = {.title = file->title,
                    .subtitle = "profile",
                    .xlabel = file->unknown[j].name,
                    .ylabel = "misfit",
                    .log_x = file->unknown[j].log,
                    .nseries = 3,
                    .series = series};
    if (top > fit->misfit) {
        plot.y_range[0] = fmax(fit->misfit - 0.2 * fit->misfit_limit, 0);
        plot.y_range[1] = top;
    }
    PH_TRY(ph_plot_write(path, &plot, err));
out:
    return st;
}

static ph_status write_samples(const ph_fit_file *file, const ph_fit *fit,
                               const char *path, ph_error *err)
{
    ph_status st = PH_OK;
    ph_table *table = NULL;
    char *text = NULL, names[PH_FIT_UNKNOWNS][PH_TABLE_NAME];
    const char *name[PH_FIT_UNKNOWNS];
    int k = fit->nunknowns;
    for (int j = 0; j < k; j++) {
        snprintf(names[j], sizeof names[j], "%.60s", file->unknown[j].name);
        name[j] = names[j];
    }
    PH_TRY(ph_table_new(k, name, fit->nsamples, &table, err));
    for (int i = 0; i < fit->nsamples; i++)
        for (int j = 0; j < k; j++)
            table->value[(ptrdiff_t)j * fit->nsamples + i] =
                fit->sample[(size_t)i * k + j];
    PH_TRY(ph_table_to_csv(table, &text, err));
    PH_TRY(ph_write_file(path, text, strlen(text), err));
out:
    free(text);
    ph_table_free(&table);
    return st;
}

/* Words of a name that may stand in a file's name. */
static void file_name(const char *dir, const char *what, const char *name, char *path,
                      size_t size)
{
    size_t at = (size_t)snprintf(path, size, "%s/%s-%s.svg", dir, what, name),
           n = strlen(dir);
    for (size_t i = n + 1; i < at && i < size; i++)
        if (path[i] == '/') path[i] = '_';
}

ph_status ph_fit_write_pictures(const ph_fit_file *file, const ph_fit *fit,
                                const char *dir, ph_error *err)
{
    PH_GIVEN(file && fit && dir);
    ph_status st = PH_OK;
    char path[2048];
    for (int o = 0; o < file->noutputs; o++) {
        file_name(dir, "model", file->output[o].name, path, sizeof path);
        PH_TRY(plot_quantity(file, fit, o, path, err));
    }
    for (int j = 0; j < fit->nunknowns; j++) {
        if (fit->unknown[j].nprofile == 0) continue;
        file_name(dir, "profile", file->unknown[j].name, path, sizeof path);
        PH_TRY(plot_profile(file, fit, j, path, err));
    }
    if (fit->nsamples) {
        snprintf(path, sizeof path, "%s/samples.csv", dir);
        PH_TRY(write_samples(file, fit, path, err));
    }
out:
    return st;
}
