/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A trade as figures, and as a page that needs nothing beside itself. */
#include <perihom/plot.h>

#include "io/text.h"
#include "trade/trade.h"

#include <math.h>
#include <string.h>

/* ---- figures ---- */

enum { GROUPS = 5 };

/* What a mark is of. */
static int group_of(const ph_trade_row *r)
{
    if (strcmp(r->knob, "grid") != 0) return 4;
    if (strstr(r->family, "kind=local")) return 3;
    if (strstr(r->family, "interface=node_centre")) return 2;
    if (strstr(r->family, "points=nodes")) return 1;
    return 0;
}

static double cost_of(const ph_trade_row *r, bool seconds)
{
    return seconds ? r->cpu : r->work;
}

/* Rows of a group (or of the front) by cost. @return how many */
static ptrdiff_t gather(const ph_trade *t, int group, bool seconds, double *x, double *y)
{
    ptrdiff_t n = 0;
    for (int i = 0; i < t->nrows; i++) {
        const ph_trade_row *r = &t->row[i];
        if (r->state != PH_TRADE_DONE || r->realisations > 1 || !isfinite(r->error))
            continue;
        if (group == GROUPS ? !r->front : group_of(r) != group) continue;
        double cost = cost_of(r, seconds), error = 100 * fmax(r->error, 1e-7);
        ptrdiff_t at = n++;
        for (; at > 0 && x[at - 1] > cost; at--) {
            x[at] = x[at - 1];
            y[at] = y[at - 1];
        }
        x[at] = cost;
        y[at] = error;
    }
    return n;
}

ph_status ph_trade_plot(const ph_trade *t, bool seconds, char **svg, ph_error *err)
{
    static const char *const names[GROUPS + 1] = {
        "as the case",     "at the nodes", "interface by node centre",
        "finite elements", "other knobs",  "front"};
    PH_GIVEN(t && svg);
    ph_status st = PH_OK;
    double *x = NULL;
    size_t n = (size_t)t->nrows + 1;
    ph_series series[GROUPS + 1];
    int used = 0;
    PH_ALLOC(x, 2 * n * (GROUPS + 1), "a figure");
    for (int g = 0; g <= GROUPS; g++) {
        double *xs = x + 2 * n * (size_t)g, *ys = xs + n;
        ptrdiff_t count = gather(t, g, seconds, xs, ys);
        if (count > 0)
            series[used++] =
                (ph_series){.name = names[g],
                            .n = count,
                            .x = xs,
                            .y = ys,
                            .style = g == GROUPS ? PH_PLOT_LINE : PH_PLOT_POINTS,
                            .colour = g + 1};
    }
    char subtitle[sizeof t->reference_kind + 16];
    snprintf(subtitle, sizeof subtitle, "reference: %s", t->reference_kind);
    const ph_plot plot = {.title = t->title[0] ? t->title : t->path,
                          .subtitle = subtitle,
                          .xlabel = seconds ? "CPU seconds" : "operations, counted",
                          .ylabel = "worst error of the constants [%]",
                          .log_x = true,
                          .log_y = true,
                          .nseries = used,
                          .series = series};
    PH_TRY(ph_plot_svg(&plot, svg, err));
out:
    free(x);
    return st;
}

/* ---- the page ---- */

static void put_text(ph_i_growing *g, const char *before, const char *text,
                     const char *after)
{
    ph_i_appendf(g, "%s", before);
    ph_i_append_xml(g, text);
    ph_i_appendf(g, "%s", after);
}

static void put_short(ph_i_growing *g, const char *before, double x, int digits)
{
    ph_i_appendf(g, "%s", before);
    if (isfinite(x)) ph_i_append_number(g, x, digits);
}

static void put_head(ph_i_growing *g, const ph_trade *t)
{
    ph_i_appendf(g, "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/>"
                    "<meta name=\"viewport\" content=\"width=device-width\"/>\n");
    put_text(g, "<title>", t->title[0] ? t->title : t->path, ": what accuracy costs");
    ph_i_appendf(g, "</title>\n<style>body{font-family:sans-serif;max-width:60em;"
                    "margin:auto;padding:1em}table{border-collapse:collapse;"
                    "font-size:.8em}td,th{padding:.15em .5em;border-bottom:1px solid "
                    "#ccc;text-align:left}code{background:#eee}tr.front{font-weight:"
                    "bold}</style></head>\n<body>\n");
    put_text(g, "<h1>", t->title[0] ? t->title : t->path, "</h1>\n<p>");
    put_text(g, "Case <code>", t->path, "</code>; reference: ");
    put_text(g, "", t->reference_kind, "");
    if (t->reference_error > 0) {
        put_short(g, ", its own error about ", 100 * t->reference_error, 2);
        ph_i_appendf(g, " %%");
    }
    ph_i_appendf(g, ".%s</p>\n",
                 t->complete || !ph_i_trade_has_reference(t)
                     ? ""
                     : " The budget ended before the sweep did.");
}

static void put_advice(ph_i_growing *g, const ph_trade *t)
{
    ph_i_appendf(g, "<h2>Which settings</h2>\n<table><tr><th>accuracy</th><th>error"
                    "</th><th>operations</th><th>CPU s</th><th>command</th></tr>\n");
    for (int k = 0; k < PH_TRADE_TARGETS; k++) {
        const ph_trade_advice *a = &t->advice[k];
        const ph_trade_row *r = a->row < 0 ? NULL : &t->row[a->row];
        put_short(g, "<tr><td>", 100 * a->target, 3);
        if (!r) {
            ph_i_appendf(g, " %%</td><td colspan=\"4\">nothing of the sweep reaches it"
                            "</td></tr>\n");
            continue;
        }
        put_short(g, " %</td><td>", 100 * r->error, 3);
        put_short(g, " %</td><td>", r->work, 3);
        put_short(g, "</td><td>", r->cpu, 3);
        put_text(g, "</td><td><code>", a->command, "</code></td></tr>\n");
    }
    ph_i_appendf(g, "</table>\n");
}

static void put_rows(ph_i_growing *g, const ph_trade *t)
{
    ph_i_appendf(g, "<h2>All rows</h2>\n<table><tr><th>knob</th><th>setting</th><th>"
                    "nodes</th><th>error %%</th><th>operations</th><th>CPU s</th><th>"
                    "applications</th><th>FFTs</th><th>bytes</th></tr>\n");
    for (int i = 0; i < t->nrows; i++) {
        const ph_trade_row *r = &t->row[i];
        ph_i_appendf(g, "<tr%s><td>%s</td><td>", r->front ? " class=\"front\"" : "",
                     r->knob);
        put_text(g, "", r->setting[0] ? r->setting : "as the case", "");
        if (r->threads > 1) ph_i_appendf(g, ", %d threads", r->threads);
        if (r->realisations > 1) ph_i_appendf(g, ", %d realisations", r->realisations);
        ph_i_appendf(g, "</td><td>%td</td>", r->nodes);
        if (r->state != PH_TRADE_DONE) {
            put_text(g, "<td colspan=\"6\">", r->reason, "</td></tr>\n");
            continue;
        }
        put_short(g, "<td>", 100 * r->error, 3);
        put_short(g, "</td><td>", r->work, 3);
        put_short(g, "</td><td>", r->cpu, 3);
        ph_i_appendf(g, "</td><td>%ld</td><td>%ld</td><td>%zu</td></tr>\n",
                     r->applications, r->ffts, r->bytes);
    }
    ph_i_appendf(g, "</table>\n");
}

ph_status ph_trade_to_html(const ph_trade *t, char **text, ph_error *err)
{
    PH_GIVEN(t && text);
    ph_status st = PH_OK;
    ph_i_growing g = {0};
    char *svg[2] = {NULL, NULL};
    for (int i = 0; i < 2; i++)
        PH_TRY(ph_trade_plot(t, i == 1, &svg[i], err));
    put_head(&g, t);
    if (ph_i_trade_has_reference(t)) put_advice(&g, t);
    ph_i_appendf(&g, "<h2>Error against cost</h2>\n");
    for (int i = 0; i < 2; i++) {
        ph_i_append(&g, svg[i], strlen(svg[i]));
        ph_i_append(&g, "\n", 1);
    }
    put_rows(&g, t);
    ph_i_appendf(&g, "</body></html>\n");
    PH_CHECK(!g.failed, PH_ENOMEM, "no memory for a page");
    *text = g.text;
    g.text = NULL;
out:
    free(svg[0]);
    free(svg[1]);
    free(g.text);
    return st;
}
