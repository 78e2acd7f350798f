/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/output.h>

#include "core/check.h"

#include <math.h>
#include <string.h>

void ph_relaxation_report_free(ph_relaxation_report **report)
{
    if (!report || !*report) return;
    ph_relaxation_report *r = *report;
    ph_prony_free(&r->series);
    ph_constants_free(&r->constants);
    ph_table_free(&r->curves);
    ph_table_free(&r->dynamic);
    ph_table_free(&r->terms);
    ph_table_free(&r->response);
    free(r);
    *report = NULL;
}

static const char *const axis[2][6] = {{"11", "22", "12"},
                                       {"11", "22", "33", "23", "13", "12"}};

static ph_status response_table(int n, int rows, ph_table **out, ph_error *err)
{
    char text[13][16] = {"time"};
    const char *name[13] = {text[0]};
    for (int k = 0; k < 2 * n; k++) {
        snprintf(text[1 + k], sizeof text[0], "%s_%s", k < n ? "strain" : "stress",
                 axis[n == 6][k % n]);
        name[1 + k] = text[1 + k];
    }
    return ph_table_new(1 + 2 * n, name, rows, out, err);
}

/* The times of the points and, between two of them, PIECES - 1 more, so that the curve of
 * the response is one. A jump shows its two sides through a point just before it. */
static ph_status response_times(const ph_history *h, int *count, double **times,
                                ph_error *err)
{
    enum { PIECES = 60 };
    ph_status st = PH_OK;
    int each = h->npoints > 200 ? 1 : PIECES, n = 0;
    double *t = NULL;
    PH_ALLOC(t, (size_t)h->npoints * (PIECES + 1), "times of the response");
    for (int p = 0; p < h->npoints; p++) {
        double from = h->time[p], to = p + 1 < h->npoints ? h->time[p + 1] : from;
        if (p > 0 && from == h->time[p - 1]) n--; /* after the jump */
        for (int k = 0; k < each && (k == 0 || to > from); k++)
            t[n++] = from + (to - from) * k / each;
        bool jump = p + 2 < h->npoints && h->time[p + 2] == to && to > from;
        if (jump) t[n++] = to - 1e-9 * (to - from);
    }
    *count = n;
    *times = t;
out:
    return st;
}

static ph_status respond(const ph_prony *p, const ph_history *h, ph_table **out,
                         ph_error *err)
{
    ph_status st = PH_OK;
    double *times = NULL, (*answer)[6] = NULL;
    int count = 0;
    PH_TRY(response_times(h, &count, &times, err));
    PH_ALLOC(answer, count, "the response");
    PH_TRY(ph_prony_response(p, h, count, times, answer, err));
    PH_TRY(response_table(h->n, count, out, err));
    for (int k = 0; k < count; k++) {
        double given[6];
        ph_history_at(h, times[k], given);
        (*out)->value[k] = times[k];
        for (int i = 0; i < h->n; i++) {
            const double *strain = h->stress ? answer[k] : given,
                         *stress = h->stress ? given : answer[k];
            (*out)->value[(ptrdiff_t)(1 + i) * count + k] = strain[i];
            (*out)->value[(ptrdiff_t)(1 + h->n + i) * count + k] = stress[i];
        }
    }
out:
    free(times);
    free(answer);
    return st;
}

static ph_status tabulate(ph_relaxation_report *r, const ph_case_viscoelastic *wanted,
                          bool dynamic, ph_error *err)
{
    ph_status st = PH_OK;
    double *grid = NULL;
    const double *at = !wanted ? NULL : dynamic ? wanted->frequencies : wanted->times;
    int count = !wanted ? 0 : dynamic ? wanted->nfrequencies : wanted->ntimes;
    if (!at) {
        PH_TRY(ph_prony_grid(r->series, dynamic, 10, &count, &grid, err));
        at = grid;
    }
    if (dynamic)
        PH_TRY(ph_constants_dynamic(r->constants, count, at, &r->dynamic, err));
    else
        PH_TRY(ph_constants_curves(r->constants, count, at, &r->curves, err));
out:
    free(grid);
    return st;
}

/* ---- routes without a series: what they computed, component by component ---- */

/* Columns `first` and C11 ... (upper triangle) with each suffix. */
static ph_status component_table(int n, const char *first, int each,
                                 const char *const *suffix, int rows, ph_table **out,
                                 ph_error *err)
{
    enum { MOST = 1 + 21 * 3 };
    char text[MOST][24];
    const char *name[MOST];
    int columns = 1;
    snprintf(text[0], sizeof text[0], "%s", first);
    for (int i = 0; i < n; i++)
        for (int j = i; j < n; j++)
            for (int k = 0; k < each; k++)
                snprintf(text[columns++], sizeof text[0], "C%c%c%s",
                         n == 3 && i == 2 ? '6' : '1' + i,
                         n == 3 && j == 2 ? '6' : '1' + j, suffix[k]);
    for (int k = 0; k < columns; k++)
        name[k] = text[k];
    return ph_table_new(columns, name, rows, out, err);
}

/* Part `part` of `parts` of every component into row `row`. */
static void put_components(ph_table *t, int row, const ph_sym4 *c, int part, int parts)
{
    double voigt[36];
    int column = 1 + part;
    ph_sym4_to_voigt(c, true, voigt);
    for (int i = 0; i < c->n; i++)
        for (int j = i; j < c->n; j++, column += parts)
            t->value[(ptrdiff_t)column * t->nrows + row] = voigt[c->n * i + j];
}

static ph_status curve_of(const ph_viscoelastic *v, ph_table **out, ph_error *err)
{
    static const char *const suffix[] = {""};
    ph_status st =
        component_table(v->curve[0].stiffness.n, "time", 1, suffix, v->ncurve, out, err);
    for (int k = 0; st == PH_OK && k < v->ncurve; k++) {
        (*out)->value[k] = v->curve[k].time;
        put_components(*out, k, &v->curve[k].stiffness, 0, 1);
    }
    return st;
}

static ph_status dynamic_of(const ph_viscoelastic *v, ph_table **out, ph_error *err)
{
    static const char *const suffix[] = {"_storage", "_loss"};
    ph_status st = component_table(v->dynamic[0].storage.n, "omega", 2, suffix,
                                   v->ndynamic, out, err);
    for (int k = 0; st == PH_OK && k < v->ndynamic; k++) {
        (*out)->value[k] = v->dynamic[k].omega;
        put_components(*out, k, &v->dynamic[k].storage, 0, 2);
        put_components(*out, k, &v->dynamic[k].loss, 1, 2);
    }
    return st;
}

/* Both sides of the history at the times of the curve. */
static ph_status response_of(const ph_viscoelastic *v, const ph_history *h,
                             ph_table **out, ph_error *err)
{
    ph_status st = response_table(h->n, v->ncurve, out, err);
    for (int k = 0; st == PH_OK && k < v->ncurve; k++) {
        double given[6];
        ph_history_at(h, v->curve[k].time, given);
        (*out)->value[k] = v->curve[k].time;
        for (int i = 0; i < h->n; i++) {
            const double *strain = h->stress ? v->response[k] : given,
                         *stress = h->stress ? given : v->response[k];
            (*out)->value[(ptrdiff_t)(1 + i) * v->ncurve + k] = strain[i];
            (*out)->value[(ptrdiff_t)(1 + h->n + i) * v->ncurve + k] = stress[i];
        }
    }
    return st;
}

static ph_status without_series(const ph_viscoelastic *v,
                                const ph_case_viscoelastic *wanted,
                                ph_relaxation_report *r, ph_error *err)
{
    ph_status st = PH_OK;
    if (v->ncurve > 0) PH_TRY(curve_of(v, &r->curves, err));
    if (v->ndynamic > 0) PH_TRY(dynamic_of(v, &r->dynamic, err));
    if (v->ncurve > 0 && v->response && wanted && wanted->history)
        PH_TRY(response_of(v, wanted->history, &r->response, err));
out:
    return st;
}

ph_status ph_relaxation_report_new(const ph_viscoelastic *v,
                                   const ph_case_viscoelastic *wanted,
                                   ph_relaxation_report **out, ph_error *err)
{
    PH_GIVEN(v && out);
    ph_status st = PH_OK;
    ph_relaxation_report *r = NULL;
    *out = NULL;
    PH_CHECK(v && (v->series || v->ncurve > 0 || v->ndynamic > 0), PH_EINVAL,
             "route %s gives no series and no curve", v && v->route ? v->route : "-");
    PH_ALLOC(r, 1, "a report of the relaxation");
    if (!v->series) {
        PH_TRY(without_series(v, wanted, r, err));
        *out = r;
        r = NULL;
        goto out;
    }
    if (wanted && (wanted->terms > 0 || wanted->compression > 0))
        PH_TRY(ph_prony_compress(v->series, wanted->terms, wanted->compression,
                                 &r->series, &r->fit_error, err));
    else
        PH_TRY(ph_prony_copy(v->series, &r->series, err));
    PH_TRY(ph_constants_new(r->series, &r->constants, err));
    PH_TRY(tabulate(r, wanted, false, err));
    PH_TRY(tabulate(r, wanted, true, err));
    PH_TRY(ph_prony_table(r->series, &r->terms, err));
    if (wanted && wanted->history)
        PH_TRY(respond(r->series, wanted->history, &r->response, err));
    *out = r;
    r = NULL;
out:
    ph_relaxation_report_free(&r);
    return st;
}
