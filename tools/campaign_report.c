/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "campaign_report.h"

#include "interrupt.h"
#include "tools.h"

#include <math.h>
#include <string.h>

static void describe(const campaign_talk *t, const ph_campaign_progress *now, char *text,
                     size_t size)
{
    const ph_campaign *c = t->c;
    char to_go[32], mean[160] = "", failed[48] = "";
    progress_time(to_go, sizeof to_go, now->to_go);
    if (isfinite(now->mean.half_width))
        snprintf(mean, sizeof mean, ", %s %.5g +- %.2g",
                 c->output[c->judged >= 0 ? c->judged : 0].name, now->mean.mean,
                 now->mean.half_width);
    if (now->failed > 0)
        snprintf(failed, sizeof failed, ", %lld failed", (long long)now->failed);
    snprintf(text, size, "%s%spoint %d of %d: %lld of %lld realisations%s%s, %s to go",
             now->stage ? now->stage : "", now->stage ? ": " : "", now->points_done,
             now->points, (long long)now->realisations, (long long)now->wanted, mean,
             failed, to_go);
}

bool campaign_step(void *user, const ph_campaign_progress *now)
{
    campaign_talk *t = user;
    char text[400];
    /* seconds between two lines: none, lines, verbose, bar */
    static const double every[] = {HUGE_VAL, 5.0, 0.0, 0.1};
    if (now->event && t->style != PROGRESS_NONE) {
        campaign_talk_end(t);
        talk("a realisation was lost: %s", now->event);
    }
    if (now->seconds < t->shown)
        t->shown = 0; /* another run: of pilots, of the campaign */
    if (now->seconds - t->shown >= every[t->style]) {
        describe(t, now, text, sizeof text);
        if (t->style == PROGRESS_BAR) {
            int width = fprintf(stderr, "\r%s", text) - 1;
            if (width < t->width) fprintf(stderr, "%*s", t->width - width, "");
            t->width = width;
            fflush(stderr);
        } else {
            fprintf(stderr, "%s\n", text);
        }
        t->shown = now->seconds;
    }
    return interrupt_signal() == 0;
}

void campaign_talk_end(campaign_talk *t)
{
    if (t->width > 0) fprintf(stderr, "\r%*s\r", t->width, "");
    t->width = 0;
}

/* The last part of a dotted key is what varies. */
static const char *short_key(const char *key)
{
    const char *dot = strrchr(key, '.');
    return dot ? dot + 1 : key;
}

/* With the part before it where another key ends alike: clay.E, epoxy.E. */
static const char *name_of_key(const ph_campaign *c, int key)
{
    const char *name = short_key(c->key[key]), *from = name;
    bool alone = true;
    for (int k = 0; k < c->nkeys; k++)
        if (k != key && strcmp(short_key(c->key[k]), name) == 0) alone = false;
    if (alone || name == c->key[key]) return name;
    for (from--; from > c->key[key] && from[-1] != '.';)
        from--;
    return from;
}

static void put_head(FILE *to, const ph_campaign *c)
{
    for (int k = 0; k < c->nkeys; k++)
        fprintf(to, "%16s ", name_of_key(c, k));
    fprintf(to, "%8s ", "n");
    for (int k = 0; k < c->noutputs; k++)
        fprintf(to, "%14s %9s ", c->output[k].name, "+-");
    fprintf(to, "%s\n", c->judged >= 0 ? "reached" : "");
}

/* How many realisations of which model a point took, and what was saved. */
static void put_estimation(FILE *to, const ph_campaign *c, const ph_estimation *e)
{
    const ph_mean_estimate *m = &e->estimate;
    if (!e->reason[0]) return; /* still at the pilots */
    fprintf(to, "  %s\n", e->reason);
    for (int l = 0; l < m->nlevels; l++)
        fprintf(to, "  %7td x %s\n", m->level[l].n,
                m->level[l].model ? c->model_name[m->level[l].model] : "the case");
    if (m->cost > 0 && e->method > 0)
        fprintf(to, "  %.3g times less work than plain realisations for this error\n",
                m->plain_cost / m->cost);
}

/* What the grid adds to the means, where two grids tell. */
static void put_bias(FILE *to, const ph_campaign *c, const ph_campaign_summary *s,
                     const ph_grid_pair *grid)
{
    for (int k = 0; k < c->noutputs; k++) {
        const ph_discretisation *b = &s->output[k].bias;
        if (b->n > 0)
            fprintf(to,
                    "  the grid adds %.3g +- %.2g to %s (first order; %td "
                    "realisations on spacings %.3g times wider)\n",
                    b->estimate, b->half_width, c->output[k].name, b->n, grid->ratio);
    }
}

/* "1060 x 1060" */
static void put_box(FILE *to, const ph_campaign *c, const ph_campaign_size *e)
{
    char text[64] = "";
    size_t at = 0;
    int axes = c->point[0].c->kinematics == PH_SPACE ? 3 : 2;
    for (int a = 0; a < axes && at < sizeof text; a++)
        at += (size_t)snprintf(text + at, sizeof text - at, "%s%.5g", a ? " x " : "",
                               e->size[a]);
    fprintf(to, "%22s ", text);
}

static void put_number(FILE *to, int width, double x)
{
    if (isfinite(x))
        fprintf(to, "%*.3g ", width, x);
    else
        fprintf(to, "%*s ", width, "-");
}

/* A size on a grid; * before the chosen one. */
static void put_candidate(FILE *to, const ph_campaign *c, int i)
{
    const ph_campaign_sizes *r = c->sizes;
    const ph_split_candidate *x = &r->answer->candidate[i];
    const ph_campaign_size *e = &r->size[r->tried[x->size]];
    double per = r->absolute ? 1 : 100;
    fprintf(to, "%c %6.3g ", i == r->answer->chosen ? '*' : ' ', e->factor);
    put_box(to, c, e);
    fprintf(to, "%7lld ", (long long)(x->grid == 0 ? e->pilots : 0));
    put_number(to, 9, per * x->bias);
    put_number(to, 9, per * x->bias_half_width);
    if (r->grid_error[0] > 0) {
        fprintf(to, "%8td ", e->nodes[x->grid][0]);
        put_number(to, 9, per * r->grid_error[x->grid]);
    }
    put_number(to, 9, per * x->half_width);
    put_number(to, 8, x->needed);
    put_number(to, 9, x->to_go);
    fprintf(to, "\n");
}

void campaign_sizes(FILE *to, const ph_campaign *c)
{
    const ph_campaign_sizes *r = c->sizes;
    const char *unit = r->absolute ? " in its unit" : " over its mean, %";
    if (!r->answer) return;
    fprintf(to, "\n  %6s %22s %7s %9s %9s ", "edge", "size", "pilots", "bias", "+-");
    if (r->grid_error[0] > 0) fprintf(to, "%8s %9s ", "nodes", "grid");
    fprintf(to, "%9s %8s %9s\n", "interval", "needed", "work");
    for (int i = 0; i < r->answer->ncandidates; i++)
        put_candidate(to, c, i);
    for (int i = 0; i < r->n; i++)
        if (r->size[i].reason[0])
            fprintf(to, "  %6.3g left out: %s\n", r->size[i].factor, r->size[i].reason);
    fprintf(to,
            "errors of %s%s; interval: half width that may be left; work: "
            "node iterations to go\nsize: %s\n",
            c->output[c->judged].name, unit, r->why);
}

void campaign_table(FILE *to, const ph_campaign *c, const ph_campaign_result *r)
{
    put_head(to, c);
    for (int p = 0; p < r->npoints; p++) {
        const ph_campaign_summary *s = &r->point[p];
        for (int k = 0; k < c->nkeys; k++)
            fprintf(to, "%16.16s ", c->point[p].value[k]);
        fprintf(to, "%8lld ", (long long)s->output[0].n);
        for (int k = 0; k < c->noutputs; k++) {
            const ph_interval *i = &s->output[k].mean;
            if (isnan(i->half_width))
                fprintf(to, "%14.7g %9s ", i->mean, "-");
            else
                fprintf(to, "%14.7g %9.2g ", i->mean, i->half_width);
        }
        fprintf(to, "%s%s\n",
                c->judged < 0 ? ""
                : s->reached  ? "yes"
                              : "no",
                s->complete ? "" : " (incomplete)");
        if (s->estimation) {
            put_estimation(to, c, s->estimation);
            put_bias(to, c, s, &c->point[p].grid);
        }
    }
    fprintf(to, "+-: half width of the %g %% interval of the mean\n",
            100 * c->stopping.confidence);
    if (c->sizes) campaign_sizes(to, c);
}
