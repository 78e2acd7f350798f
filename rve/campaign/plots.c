/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures of a campaign: outputs against swept keys, running means, histograms. */
#include "campaign/campaign.h"

#include <math.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* A picture of every point is for campaigns of few points. */
enum { POINTS_DRAWN = 24, SERIES = 12, BINS = 60, CURVE = 200 };

static const char *short_key(const char *key)
{
    const char *dot = strrchr(key, '.');
    return dot ? dot + 1 : key;
}

/* Its last word, or all of it where another key has the same one. */
static const char *name_of_key(const ph_campaign *c, int key)
{
    const char *name = short_key(c->key[key]);
    for (int k = 0; k < c->nkeys; k++)
        if (k != key && strcmp(short_key(c->key[k]), name) == 0) return c->key[key];
    return name;
}

static void axis_label(const ph_campaign *c, int output, char *text, size_t size)
{
    const ph_quantity *q = &c->output[output];
    const char *unit = c->point[0].c->unit_stress;
    if (q->stress == 0 || strcmp(unit, "-") == 0)
        snprintf(text, size, "%s", q->name);
    else
        snprintf(text, size, "%s (%s%s)", q->name, q->stress < 0 ? "1/" : "", unit);
}

/* "weight_fraction 0.05, kappa 15", the key `but` left out. */
static void point_name(const ph_campaign *c, int p, int but, char *text, size_t size)
{
    size_t n = 0;
    text[0] = 0;
    for (int k = 0; k < c->nkeys && n < size; k++)
        if (k != but)
            n += (size_t)snprintf(text + n, size - n, "%s%s %.20s", n ? ", " : "",
                                  name_of_key(c, k), c->point[p].value[k]);
}

/* ---- an output against a swept key ---- */

typedef struct curve {
    char name[160];
    ptrdiff_t n;
    double *x, *y, *low, *high;
} curve;

static bool same_but(const ph_campaign *c, int p, int q, int key)
{
    for (int k = 0; k < c->nkeys; k++)
        if (k != key && strcmp(c->point[p].value[k], c->point[q].value[k]) != 0)
            return false;
    return true;
}

static bool is_numeric(const ph_campaign *c, int key)
{
    bool varies = false;
    for (int p = 0; p < c->npoints; p++) {
        if (!isfinite(c->point[p].number[key])) return false;
        varies |= c->point[p].number[key] != c->point[0].number[key];
    }
    return varies;
}

static ph_status new_curve(curve *v, ptrdiff_t n, ph_error *err)
{
    ph_status st = PH_OK;
    PH_ALLOC(v->x, 4 * n, "a curve");
    v->y = v->x + n;
    v->low = v->y + n;
    v->high = v->low + n;
out:
    return st;
}

static void add_to_curve(curve *v, double x, const ph_interval *i)
{
    ptrdiff_t at = v->n++;
    double half = isfinite(i->half_width) ? i->half_width : 0.0;
    for (; at > 0 && v->x[at - 1] > x; at--) {
        v->x[at] = v->x[at - 1];
        v->y[at] = v->y[at - 1];
        v->low[at] = v->low[at - 1];
        v->high[at] = v->high[at - 1];
    }
    v->x[at] = x;
    v->y[at] = i->mean;
    v->low[at] = i->mean - half;
    v->high[at] = i->mean + half;
}

/* The points that differ from point p in the key only. */
static ph_status gather_curve(const ph_campaign *c, const ph_campaign_result *r, int key,
                              int output, int p, curve *v, ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(new_curve(v, c->npoints, err));
    point_name(c, p, key, v->name, sizeof v->name);
    for (int q = 0; q < c->npoints; q++)
        if (same_but(c, p, q, key))
            add_to_curve(v, c->point[q].number[key], &r->point[q].output[output].mean);
out:
    return st;
}

static ph_status gather_data(const ph_campaign *c, int key, int output, curve *v,
                             ph_error *err)
{
    ph_status st = PH_OK;
    const ph_campaign_data *d = &c->data;
    ph_table *t = NULL;
    char path[1024];
    if (!d->file[0] || strcmp(d->key, c->key[key]) != 0 ||
        strcmp(d->quantity, c->output[output].name) != 0)
        return PH_OK;
    ph_i_path_in(c->folder, d->file, path, sizeof path);
    PH_TRY(ph_table_read(path, &t, err));
    int x = ph_table_column(t, d->x), y = ph_table_column(t, d->y),
        s = d->sigma[0] ? ph_table_column(t, d->sigma) : -1;
    PH_CHECK(x >= 0 && y >= 0 && (s >= 0 || !d->sigma[0]), PH_EINVAL,
             "%s has no column '%s', '%s' or '%s'", path, d->x, d->y, d->sigma);
    PH_TRY(new_curve(v, t->nrows, err));
    snprintf(v->name, sizeof v->name, "measured");
    for (ptrdiff_t i = 0; i < t->nrows; i++) {
        double sd = s >= 0 ? t->value[s * t->nrows + i] : 0.0;
        add_to_curve(
            v, t->value[x * t->nrows + i],
            &(ph_interval){.mean = t->value[y * t->nrows + i], .half_width = sd});
    }
out:
    ph_table_free(&t);
    return st;
}

static ph_status draw_against(const ph_campaign *c, const ph_campaign_result *r, int key,
                              int output, const char *folder, ph_error *err)
{
    ph_status st = PH_OK;
    curve curves[SERIES + 1] = {0};
    ph_series series[SERIES + 1] = {0};
    char path[1200], label[160], name[300];
    int n = 0;
    for (int p = 0; p < c->npoints && n < SERIES; p++) {
        bool seen = false;
        for (int q = 0; q < p; q++)
            seen |= same_but(c, p, q, key);
        if (!seen) PH_TRY(gather_curve(c, r, key, output, p, &curves[n++], err));
    }
    PH_TRY(gather_data(c, key, output, &curves[n], err));
    if (curves[n].n > 0) n++;
    for (int k = 0; k < n; k++)
        series[k] = (ph_series){.name = curves[k].name,
                                .n = curves[k].n,
                                .x = curves[k].x,
                                .y = curves[k].y,
                                .low = curves[k].low,
                                .high = curves[k].high,
                                .style = strcmp(curves[k].name, "measured") == 0
                                             ? PH_PLOT_POINTS
                                             : PH_PLOT_LINE_POINTS};
    axis_label(c, output, label, sizeof label);
    snprintf(name, sizeof name, "%s-against-%.160s.svg", c->output[output].name,
             name_of_key(c, key));
    for (char *p = name; *p; p++)
        if (*p == '/') *p = '_'; /* of a material */
    snprintf(path, sizeof path, "%.800s/%s", folder, name);
    const ph_plot plot = {.title = c->title[0] ? c->title : c->point[0].c->title,
                          .xlabel = c->key[key],
                          .ylabel = label,
                          .nseries = n,
                          .series = series};
    PH_TRY(ph_plot_write(path, &plot, err));
out:
    for (int k = 0; k <= SERIES; k++)
        free(curves[k].x);
    return st;
}

/* ---- one point ---- */

/* The values of an output at a point, in order, those that count. */
static ph_status gather_values(ph_i_store *s, int point, int output, int64_t counted,
                               double **out, ptrdiff_t *n, ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_record r;
    double *x = NULL;
    PH_ALLOC(x, counted, "the values of a point");
    *n = 0;
    for (size_t k = 0; k < s->count; k++) {
        const ph_i_entry *e = &s->entry[k];
        if (e->point != point || e->i >= counted || e->failed) continue;
        PH_TRY(ph_i_store_get(s, e, &r, err));
        x[(*n)++] = r.value[output];
    }
    *out = x;
    x = NULL;
out:
    free(x);
    return st;
}

static ph_status draw_running(const ph_campaign *c, int output, const double *value,
                              ptrdiff_t n, const char *name, const char *path,
                              ph_error *err)
{
    ph_status st = PH_OK;
    ph_sequence s;
    double *x = NULL;
    char label[160];
    ph_stopping rule = {1, n, 0, 0, c->stopping.confidence};
    PH_TRY(ph_sequence_start(&s, &rule, err));
    PH_ALLOC(x, 4 * n, "a running mean");
    double *mean = x + n, *low = mean + n, *high = low + n;
    for (ptrdiff_t i = 0; i < n; i++) {
        ph_sequence_add(&s, value[i]);
        ph_interval now = ph_sequence_interval(&s);
        x[i] = (double)(i + 1);
        mean[i] = now.mean;
        low[i] = i < 2 ? (double)NAN : now.mean - now.half_width;
        high[i] = i < 2 ? (double)NAN : now.mean + now.half_width;
    }
    const ph_series series[] = {{.name = "interval of the mean",
                                 .n = n,
                                 .x = x,
                                 .low = low,
                                 .high = high,
                                 .style = PH_PLOT_BAND,
                                 .colour = 1},
                                {.name = "mean so far",
                                 .n = n,
                                 .x = x,
                                 .y = mean,
                                 .style = PH_PLOT_LINE,
                                 .colour = 1}};
    axis_label(c, output, label, sizeof label);
    const ph_plot plot = {.title = c->title[0] ? c->title : c->point[0].c->title,
                          .subtitle = name,
                          .xlabel = "realisations",
                          .ylabel = label,
                          .nseries = 2,
                          .series = series};
    PH_TRY(ph_plot_write(path, &plot, err));
out:
    free(x);
    return st;
}

static int bins_of(ptrdiff_t n)
{
    int bins = (int)ceil(2.0 * cbrt((double)n)); /* Rice's rule */
    return bins < BINS ? bins : BINS;
}

static ph_status draw_histogram(const ph_campaign *c, int output, const double *value,
                                ptrdiff_t n, const ph_interval *fit, const char *name,
                                const char *path, ph_error *err)
{
    ph_status st = PH_OK;
    double lo = value[0], hi = value[0], x[BINS], y[BINS] = {0}, t[CURVE], g[CURVE];
    char label[160];
    int bins = bins_of(n);
    for (ptrdiff_t i = 0; i < n; i++) {
        lo = fmin(lo, value[i]);
        hi = fmax(hi, value[i]);
    }
    double width = (hi - lo) / bins;
    for (ptrdiff_t i = 0; i < n; i++) {
        int b = (int)((value[i] - lo) / width);
        y[b < bins ? b : bins - 1] += 1.0 / ((double)n * width);
    }
    for (int b = 0; b < bins; b++)
        x[b] = lo + (b + 0.5) * width;
    for (int i = 0; i < CURVE; i++) {
        double z = -4.0 + 8.0 * i / (CURVE - 1.0);
        t[i] = fit->mean + z * fit->deviation;
        g[i] = exp(-0.5 * z * z) / (fit->deviation * sqrt(2.0 * 3.14159265358979323846));
    }
    const ph_series series[] = {
        {.name = "realisations", .n = bins, .x = x, .y = y, .style = PH_PLOT_BARS},
        {.name = "normal, same mean and deviation",
         .n = CURVE,
         .x = t,
         .y = g,
         .style = PH_PLOT_LINE}};
    axis_label(c, output, label, sizeof label);
    const ph_plot plot = {.title = c->title[0] ? c->title : c->point[0].c->title,
                          .subtitle = name,
                          .xlabel = label,
                          .ylabel = "density",
                          .nseries = 2,
                          .series = series};
    PH_TRY(ph_plot_write(path, &plot, err));
out:
    return st;
}

static ph_status draw_point(ph_i_store *s, const ph_campaign_result *r, int point,
                            const char *folder, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_campaign *c = s->c;
    const int output = c->judged >= 0 ? c->judged : 0;
    const ph_interval *fit = &r->point[point].output[output].mean;
    double *value = NULL;
    ptrdiff_t n = 0;
    char path[1200], name[200];
    PH_TRY(gather_values(s, point, output, r->point[point].counted, &value, &n, err));
    if (n < 3 || !(fit->deviation > 0.0)) goto out;
    point_name(c, point, -1, name, sizeof name);
    snprintf(path, sizeof path, "%s/point-%d-running-mean.svg", folder, point);
    PH_TRY(draw_running(c, output, value, n, name, path, err));
    snprintf(path, sizeof path, "%s/point-%d-histogram.svg", folder, point);
    PH_TRY(draw_histogram(c, output, value, n, fit, name, path, err));
out:
    free(value);
    return st;
}

ph_status ph_i_plots_write(ph_i_store *s, const ph_campaign_result *r, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_campaign *c = s->c;
    char folder[1100];
    snprintf(folder, sizeof folder, "%s/plots", s->folder);
    if (mkdir(folder, 0777) != 0 && access(folder, W_OK) != 0)
        PH_CHECK(false, PH_EIO, "%s: cannot be written", folder);
    for (int k = 0; k < c->nkeys; k++)
        for (int o = 0; is_numeric(c, k) && o < c->noutputs; o++)
            PH_TRY(draw_against(c, r, k, o, folder, err));
    for (int p = 0; p < c->npoints && c->npoints <= POINTS_DRAWN; p++)
        PH_TRY(draw_point(s, r, p, folder, err));
out:
    return st;
}
