/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sizes of the RVE to choose from, and pilot realisations of them. */
#include "campaign/sizes.h"
#include "fidelity/fidelity.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>
#include <time.h>

/* Of the edge: how far a size may be from what is asked for, and what a grid that transforms
 * slowly, or has another spacing, counts for. */
static const double off_by = 0.08, bad = 0.05;
/* Grids over that of the pilots, where the case leaves it open. */
static const double grids[] = {1, 0.5, 0.625, 0.8, 1.25, 1.6, 2};
enum { NGRIDS = sizeof grids / sizeof *grids };

/* ---- the sizes ---- */

static ptrdiff_t common_divisor(ptrdiff_t a, ptrdiff_t b)
{
    while (b) {
        ptrdiff_t c = a % b;
        a = b;
        b = c;
    }
    return a;
}

/* Nothing but 2, 3, 5 and 7: transforms like it. */
static bool is_smooth(ptrdiff_t n)
{
    static const ptrdiff_t primes[] = {2, 3, 5, 7};
    for (int i = 0; i < 4; i++)
        while (n > 1 && n % primes[i] == 0)
            n /= primes[i];
    return n == 1;
}

/* Nodes along an axis of `part` of `whole` parts of the box: as many to the length, or the next
 * more that transform well. */
static ptrdiff_t nodes_of(ptrdiff_t nodes, ptrdiff_t part, ptrdiff_t whole)
{
    if (nodes * part % whole == 0) return nodes * part / whole;
    ptrdiff_t n = nodes * part / whole + 1;
    while (!is_smooth(n))
        n++;
    return n;
}

static const ptrdiff_t *drawing(const ph_case *c)
{
    return c->drawn_on[0] > 0 ? c->drawn_on : c->nodes;
}

/* Parts of which the box has `whole`, such that the fillers are drawn with the same spacing. */
static ptrdiff_t choose_parts(const ph_case *c, int axes, ptrdiff_t whole, double factor)
{
    ptrdiff_t best = 0;
    double least = INFINITY, wanted = factor * (double)whole;
    ptrdiff_t from = (ptrdiff_t)ceil(wanted * (1 - off_by)),
              to = (ptrdiff_t)floor(wanted * (1 + off_by));
    if (factor == 1) return whole;
    for (ptrdiff_t m = from > 1 ? from : 1; m <= to; m++) {
        bool good = true; /* as many nodes to the length, which transform well */
        for (int a = 0; a < axes; a++)
            good &= c->nodes[a] * m % whole == 0 &&
                    is_smooth(nodes_of(c->nodes[a], m, whole));
        double score = fabs((double)m / wanted - 1) + (good ? 0 : bad);
        if (score >= least) continue;
        least = score;
        best = m;
    }
    return best;
}

/* "microstructure.size=[750, 750]" */
static void size_set(const double *size, int axes, char *text, size_t room)
{
    size_t at = (size_t)snprintf(text, room, "microstructure.size=[");
    for (int a = 0; a < axes && at < room; a++)
        at += (size_t)snprintf(text + at, room - at, "%s%.17g", a ? ", " : "", size[a]);
    if (at < room) snprintf(text + at, room - at, "]");
}

/* Parts of a box that all axes have, as the fillers are drawn. */
static ptrdiff_t whole_of(const ph_case *c, int axes)
{
    const ptrdiff_t *drawn = drawing(c);
    ptrdiff_t whole = drawn[0];
    for (int a = 1; a < axes; a++)
        whole = common_divisor(whole, drawn[a]);
    return whole;
}

/* Overrides and folder of a size of `part` of `whole`. */
static void describe(const ph_i_chooser *s, ptrdiff_t part, ptrdiff_t whole,
                     ph_campaign_size *e, ph_i_option *o)
{
    const ph_case *c = s->c->point[0].c;
    int axes = ph_i_fidelity_axes(c);
    ptrdiff_t scaled[3] = {1, 1, 1};
    size_t at =
        (size_t)snprintf(o->folder, sizeof o->folder, "%s/sizes/", s->params->folder);
    for (int a = 0; a < 3; a++) {
        e->size[a] = part == whole || a >= axes ? c->size[a] : c->size[a] * e->factor;
        for (int j = 0; j < s->report->ngrids; j++) {
            ptrdiff_t own = s->report->nodes[j][a];
            e->nodes[j][a] = a < axes ? nodes_of(own, part, whole) : own;
        }
        if (a < axes) scaled[a] = drawing(c)[a] / whole * part;
        if (a < axes && at < sizeof o->folder)
            at += (size_t)snprintf(o->folder + at, sizeof o->folder - at, "%s%td",
                                   a ? "x" : "", e->nodes[0][a]);
    }
    size_set(e->size, axes, o->set[0], sizeof o->set[0]);
    ph_i_grid_set("nodes", e->nodes[0], axes, o->set[1], sizeof o->set[1]);
    if (c->drawn_on[0] > 0)
        ph_i_grid_set("drawn_on", scaled, axes, o->set[2], sizeof o->set[2]);
}

/* One more size; one that cannot be had stays in the report. */
static void add_option(ph_i_chooser *s, double factor)
{
    const ph_case *c = s->c->point[0].c;
    int axes = ph_i_fidelity_axes(c);
    ptrdiff_t whole = whole_of(c, axes), part = choose_parts(c, axes, whole, factor);
    ph_campaign_size *e = &s->report->size[s->report->n];
    ph_i_option *o = &s->option[s->noptions];
    double last = s->noptions ? s->report->size[o[-1].entry].factor : 0;
    *e = (ph_campaign_size){.factor = part > 0 ? (double)part / (double)whole : factor};
    *o = (ph_i_option){.entry = s->report->n++};
    if (part < 1)
        snprintf(e->reason, sizeof e->reason,
                 "the fillers are drawn with the spacing of the case, and no multiple of "
                 "1/%td of the edge is near",
                 whole);
    else if (e->factor <= last)
        snprintf(e->reason, sizeof e->reason, "an earlier edge was moved to it");
    if (e->reason[0]) return;
    describe(s, part, whole, e, o);
    s->noptions++;
}

/* Nodes of the case's own edge on grid j, and what it is off: first order. */
static void add_grid(ph_i_chooser *s, double finer)
{
    const ph_case *c = s->c->point[0].c;
    ph_campaign_sizes *r = s->report;
    int axes = ph_i_fidelity_axes(c), j = r->ngrids;
    double cells = 1;
    ptrdiff_t longest = ph_i_fidelity_longest(c->nodes);
    for (int a = 0; a < 3; a++) {
        ptrdiff_t n = c->nodes[a];
        if (a < axes && finer != 1) n = ph_i_fidelity_round((double)n * finer);
        if (a < axes && n < c->drawn_on[a]) return; /* it would show other fillers */
        r->nodes[j][a] = n;
        cells *= c->nodes[a] > 0 ? (double)n / (double)c->nodes[a] : 1;
    }
    for (int i = 0; i < j; i++)
        if (memcmp(r->nodes[i], r->nodes[j], sizeof r->nodes[i]) == 0) return;
    r->grid_error[j] =
        s->c->grid_error * (double)longest / (double)ph_i_fidelity_longest(r->nodes[j]);
    s->grid_cost[j] = cells;
    r->ngrids++;
}

void ph_i_options_make(ph_i_chooser *s)
{
    for (int j = 0; j < (s->c->grid_error > 0 ? NGRIDS : 1); j++)
        add_grid(s, grids[j]);
    for (int i = 0; i < s->c->nfactors; i++)
        add_option(s, s->c->factor[i]);
}

/* ---- pilots ---- */

void ph_i_option_clear(ph_i_option *o)
{
    ph_campaign_free(&o->c);
    free(o->value);
    free(o->cost);
    o->value = o->cost = NULL;
}

double ph_i_time_left(const ph_i_chooser *s)
{
    double all = s->params->seconds > 0 ? s->params->seconds : s->c->seconds;
    return all > 0 ? all - (ph_i_clock() - s->start) : (double)INFINITY;
}

/* Seconds of a realisation, as costs.csv has them, mean over the points; NaN: not known. */
static double seconds_of_one(const char *folder, int npoints)
{
    char path[1200], line[256];
    double sum = 0;
    snprintf(path, sizeof path, "%s/costs.csv", folder);
    FILE *file = fopen(path, "r");
    double *each = calloc(2 * (size_t)npoints + 1, sizeof *each);
    while (file && each && fgets(line, sizeof line, file)) {
        char *end;
        long p = strtol(line, &end, 10);
        if (end == line || *end != ',' || p < 0 || p >= npoints) continue;
        end = strchr(end + 1, ',');
        double took = end ? strtod(end + 1, NULL) : -1;
        if (!(took >= 0) || isinf(took)) continue;
        each[2 * p] += took;
        each[2 * p + 1] += 1;
    }
    for (int p = 0; each && p < npoints; p++)
        sum += each[2 * p] / each[2 * p + 1]; /* none: NaN */
    if (file) fclose(file);
    bool known = file && each;
    free(each);
    return known ? sum / npoints : (double)NAN;
}

/* Values, costs and seconds of the pilots, read back. */
static ph_status read_pilots(const ph_i_chooser *s, ph_i_option *o, bool *failed,
                             ph_error *err)
{
    ph_status st = PH_OK;
    const ph_campaign *c = o->c;
    ph_i_store store = {.lock = -1, .fd = -1};
    double *iterations = NULL, total = 0;
    *failed = false;
    free(o->value);
    free(o->cost);
    o->value = o->cost = NULL;
    size_t n = (size_t)c->npoints * (size_t)s->pilots;
    PH_ALLOC(o->value, n, "the pilots");
    PH_ALLOC(o->cost, c->npoints, "the costs of the pilots");
    PH_ALLOC(iterations, 2 * (size_t)c->npoints, "the costs of the pilots");
    PH_TRY(ph_i_store_open(&store, o->folder, c, err));
    PH_TRY(ph_i_store_sort(&store, err));
    for (size_t i = 0; i < n; i++)
        o->value[i] = NAN;
    for (size_t k = 0; k < store.count; k++) {
        ph_i_record r;
        if (store.entry[k].i >= s->pilots) continue;
        PH_TRY(ph_i_store_get(&store, &store.entry[k], &r, err));
        *failed |= r.status != PH_OK;
        if (r.status != PH_OK) continue;
        o->value[r.point * s->pilots + r.i] = r.value[s->c->judged];
        iterations[2 * r.point] += r.iterations;
        iterations[2 * r.point + 1] += 1;
    }
    for (int p = 0; p < c->npoints; p++) {
        double count = iterations[2 * p + 1];
        o->cost[p] = ph_i_work_of(c->point[p].c, c->output, c->noutputs,
                                  count > 0 ? iterations[2 * p] / count : (double)NAN);
        total += o->cost[p] / c->npoints;
    }
    o->rate = seconds_of_one(o->folder, c->npoints) / total;
out:
    ph_i_store_close(&store);
    free(iterations);
    return st;
}

static PH_PRINTF(2, 3) void leave_out(ph_campaign_size *e, const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    vsnprintf(e->reason, sizeof e->reason, fmt, args);
    va_end(args);
    e->pilots = 0;
}

/* The campaign of a size, with so many realisations and nothing to reach. */
static ph_status open_option(const ph_i_chooser *s, ph_i_option *o, ph_error *err)
{
    ph_status st = PH_OK;
    const char *more[PH_I_SIZE_SETS];
    size_t n = 0;
    for (int i = 0; i < PH_I_SIZE_SETS; i++)
        if (o->set[i][0]) more[n++] = o->set[i];
    if (!o->c) PH_TRY(ph_i_campaign_reread(s->c, s->sets, s->nsets, more, n, &o->c, err));
    o->c->nfactors = 0;
    o->c->judged = -1;
    o->c->relative_error = 0;
    o->c->stopping = (ph_stopping){
        .at_least = 1, .at_most = s->pilots, .confidence = s->c->stopping.confidence};
out:
    return st;
}

/* Realisations of one size. It is left out where the case cannot be had in this size; its own
 * size may have realisations that fail, as in any campaign. */
ph_status ph_i_pilots_solve(ph_i_chooser *s, ph_i_option *o, bool *good, ph_error *err)
{
    ph_status st = PH_OK;
    ph_error why = PH_ERROR_INIT;
    ph_campaign_result *r = NULL;
    ph_campaign_size *e = &s->report->size[o->entry];
    ph_campaign_params p = *s->params;
    bool failed = false;
    char stage[64];
    *good = false;
    st = open_option(s, o, &why);
    if (st == PH_EINVAL || st == PH_EUNPHYSICAL) {
        leave_out(e, "%.220s", why.msg);
        return PH_OK;
    }
    double bytes =
        s->c->memory > 0 && st == PH_OK ? ph_i_crew_bytes(o->c, s->c->memory) : 0;
    if (bytes > s->c->memory) {
        leave_out(e, "a realisation takes about %.2g bytes, more than budget.memory",
                  bytes);
        return PH_OK;
    }
    p.folder = o->folder;
    p.shard = p.shards = 0;
    snprintf(stage, sizeof stage, "pilots at %.3g of the edge", e->factor);
    p.stage = stage;
    if (isfinite(ph_i_time_left(s))) p.seconds = fmax(ph_i_time_left(s), 1e-3);
    if (st == PH_OK) st = ph_campaign_run(o->c, &p, &r, &why);
    ph_campaign_result_free(&r);
    if (st == PH_OK || st == PH_EPARTIAL) {
        st = read_pilots(s, o, &failed, err);
        *good = !failed || e->factor == 1;
        if (*good) e->pilots = s->pilots;
        if (!*good) leave_out(e, "some of its %lld pilots failed", (long long)s->pilots);
        return st;
    }
    if (st == PH_ENOCONV && s->report->answer)
        ph_error_prefix(&why, "%.160s; pilots at %.3g of the edge: ", s->report->why,
                        e->factor);
    else if (st == PH_ENOCONV)
        ph_error_prefix(&why, "pilots at %.3g of the edge: ", e->factor);
    if (err) *err = why;
    return st;
}
