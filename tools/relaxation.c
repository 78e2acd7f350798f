/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "relaxation.h"

#include "check.h"
#include "report.h"

#include <jansson.h>

#include <math.h>
#include <perihom_error_bar.h>
#include <string.h>
#include <sys/stat.h>

/* Where the routes that have no series are asked: over the relaxation times of the phases
 * and one decade beyond; `rates`: their inverses. */
enum { MOST_POINTS = 256 };
static int phase_grid(const ph_case *c, int per_decade, bool rates, double *x)
{
    double first = HUGE_VAL, last = 0;
    for (int i = 0; i < c->nmaterials; i++) {
        const ph_prony *p = c->materials[i].relaxation;
        if (!p) continue;
        first = fmin(first, p->term[0].time);
        last = fmax(last, p->term[p->nterms - 1].time);
    }
    double lo = log10(first) - 1, hi = log10(last) + 1;
    int n = (int)fmin(MOST_POINTS, ceil(per_decade * (hi - lo)) + 1);
    for (int k = 0; k < n; k++) {
        double u = lo + (hi - lo) * k / (n - 1);
        x[rates ? n - 1 - k : k] = pow(10, rates ? -u : u);
    }
    return n;
}

ph_status relaxation_solve(const ph_case *c, const ph_problem *problem, const ph_ctx *ctx,
                           ph_viscoelastic **v, ph_relaxation_report **report,
                           ph_error *err)
{
    ph_status st = PH_OK;
    double x[MOST_POINTS];
    const ph_case_viscoelastic *w = &c->viscoelastic;
    ph_relaxation_params params = {.route = w->route,
                                   .tolerance = w->tolerance,
                                   .times = w->times,
                                   .ntimes = w->ntimes,
                                   .omega = w->frequencies,
                                   .nomega = w->nfrequencies};
    if (strcmp(w->route, "carson") == 0) {
        params.carson = x;
        params.ncarson = phase_grid(c, 4, true, x);
    } else if (strcmp(w->route, "stepping") == 0) {
        params.history = w->history;
        if (!w->times) {
            params.times = x;
            params.ntimes = phase_grid(c, 10, false, x);
        }
    } else if (strcmp(w->route, "frequency") == 0 && !w->frequencies) {
        params.omega = x;
        params.nomega = phase_grid(c, 4, true, x);
    }
    PH_TRY(ph_viscoelastic_solve(problem, &params, ctx, v, err));
    PH_TRY(ph_rve_relaxation_error_bar(c, problem, &params, ctx, *v, err));
    if ((*v)->series || (*v)->ncurve > 0 || (*v)->ndynamic > 0)
        PH_TRY(ph_relaxation_report_new(*v, w, report, err));
out:
    return st;
}

/* ---- files ---- */

static ph_status write_table(const destination *to, const char *name, const ph_table *t,
                             ph_error *err)
{
    ph_status st = PH_OK;
    char path[DESTINATION_PATH + 64], *text = NULL;
    destination_file(to, name, path, sizeof path);
    PH_TRY(ph_table_to_csv(t, &text, err));
    PH_TRY(ph_write_file(path, text, strlen(text), err));
out:
    free(text);
    return st;
}

/* What the plots of a result need to know. */
typedef struct frame {
    const char *folder, *ending; /* "svg" or "png" */
    const char *title, *time, *stress;
    bool given_stress; /* of the history */
    bool talk;         /* print the paths */
} frame;

/* Columns of a table against its first one; names that it lacks are left out. */
static ph_status plot_columns(const frame *f, const char *name, const ph_plot *what,
                              const ph_table *t, const char *const *names, int nnames,
                              ph_error *err)
{
    ph_series series[16];
    ph_plot plot = *what;
    char path[2 * DESTINATION_PATH];
    snprintf(path, sizeof path, "%s/%s.%s", f->folder, name, f->ending);
    plot.subtitle = f->title;
    plot.series = series;
    plot.nseries = 0;
    for (int i = 0; i < nnames && i < 16; i++) {
        int column = ph_table_column(t, names[i]);
        if (column < 0) continue;
        series[plot.nseries++] = (ph_series){.name = t->name[column],
                                             .n = t->nrows,
                                             .x = t->value,
                                             .y = t->value + column * t->nrows};
    }
    ph_status st = ph_plot_write(path, &plot, err);
    if (st == PH_OK && f->talk) puts(path);
    return st;
}

#define COUNT(list) ((int)(sizeof(list) / sizeof *(list)))

static ph_status plot_curves(const frame *f, const ph_table *t, ph_error *err)
{
    static const char *const moduli[] = {"E1",  "E2",  "E3",  "G23",
                                         "G13", "G12", "C11", "C12"};
    char time[64], stress[64];
    snprintf(time, sizeof time, "time [%s]", f->time);
    snprintf(stress, sizeof stress, "modulus [%s]", f->stress);
    const ph_plot plot = {
        .title = "Relaxation", .xlabel = time, .ylabel = stress, .log_x = true};
    return plot_columns(f, "relaxation", &plot, t, moduli, COUNT(moduli), err);
}

static ph_status plot_dynamic(const frame *f, const ph_table *t, ph_error *err)
{
    static const char *const parts[] = {"E1_storage",  "E2_storage", "G12_storage",
                                        "E1_loss",     "E2_loss",    "G12_loss",
                                        "C11_storage", "C11_loss"};
    static const char *const loss[] = {"E1_tan_delta",  "E2_tan_delta",  "E3_tan_delta",
                                       "G23_tan_delta", "G13_tan_delta", "G12_tan_delta"};
    char omega[64], stress[64];
    snprintf(omega, sizeof omega, "angular frequency [rad/%s]", f->time);
    snprintf(stress, sizeof stress, "modulus [%s]", f->stress);
    ph_plot plot = {.title = "Storage and loss",
                    .xlabel = omega,
                    .ylabel = stress,
                    .log_x = true,
                    .log_y = true};
    ph_status st = plot_columns(f, "dynamic", &plot, t, parts, COUNT(parts), err);
    if (st != PH_OK || ph_table_column(t, loss[0]) < 0) return st;
    plot.title = "Loss tangent";
    plot.ylabel = "tan delta";
    plot.log_y = false;
    return plot_columns(f, "tan-delta", &plot, t, loss, COUNT(loss), err);
}

/* What answers, against time. */
static ph_status plot_response(const frame *f, const ph_table *t, ph_error *err)
{
    static const char *const strain[] = {"strain_11", "strain_22", "strain_33",
                                         "strain_23", "strain_13", "strain_12"};
    static const char *const stress[] = {"stress_11", "stress_22", "stress_33",
                                         "stress_23", "stress_13", "stress_12"};
    char time[64], label[64];
    snprintf(time, sizeof time, "time [%s]", f->time);
    snprintf(label, sizeof label, "stress [%s]", f->stress);
    const ph_plot plot = {.title = f->given_stress ? "Strain" : "Stress",
                          .xlabel = time,
                          .ylabel =
                              f->given_stress ? "strain (engineering shear)" : label};
    return plot_columns(f, "response", &plot, t, f->given_stress ? strain : stress, 6,
                        err);
}

ph_status relaxation_write(const destination *to, const ph_case *c,
                           const ph_relaxation_report *r, ph_error *err)
{
    ph_status st = PH_OK;
    char path[DESTINATION_PATH + 64], *text = NULL;
    const frame f = {.folder = to->stage,
                     .ending = "svg",
                     .title = c->title,
                     .time = c->unit_time,
                     .stress = c->unit_stress,
                     .given_stress =
                         c->viscoelastic.history && c->viscoelastic.history->stress};
    if (r->terms) PH_TRY(write_table(to, "prony.csv", r->terms, err));
    if (r->curves) {
        PH_TRY(write_table(to, "relaxation.csv", r->curves, err));
        PH_TRY(plot_curves(&f, r->curves, err));
    }
    if (r->dynamic) {
        PH_TRY(write_table(to, "dynamic.csv", r->dynamic, err));
        PH_TRY(plot_dynamic(&f, r->dynamic, err));
    }
    if (r->response) {
        PH_TRY(write_table(to, "response.csv", r->response, err));
        PH_TRY(plot_response(&f, r->response, err));
    }
    if (r->series && r->series->equilibrium.n == 6) {
        destination_file(to, "prony.yaml", path, sizeof path);
        PH_TRY(ph_prony_to_yaml(r->series, "effective", &text, err));
        PH_TRY(ph_write_file(path, text, strlen(text), err));
    }
out:
    free(text);
    return st;
}

/* ---- pictures of a result that is there ---- */

static const char *text_of(const json_t *map, const char *section, const char *key)
{
    const char *text =
        json_string_value(json_object_get(json_object_get(map, section), key));
    return text ? text : "-";
}

/* The table of a result, NULL where the result has none. */
static ph_status read_table(const char *result, const char *name, ph_table **out,
                            ph_error *err)
{
    char path[2 * DESTINATION_PATH];
    struct stat about;
    *out = NULL;
    snprintf(path, sizeof path, "%s/%s", result, name);
    return stat(path, &about) == 0 ? ph_table_read(path, out, err) : PH_OK;
}

ph_status relaxation_view(const char *result, const char *folder, bool quiet, int *drawn,
                          ph_error *err)
{
    ph_status st = PH_OK;
    ph_table *curves = NULL, *dynamic = NULL, *response = NULL;
    char path[2 * DESTINATION_PATH];
    snprintf(path, sizeof path, "%s/result.json", result);
    json_t *document = json_load_file(path, 0, NULL);
    const json_t *wanted =
        json_object_get(json_object_get(document, "case"), "viscoelastic");
    const char *title = json_string_value(json_object_get(document, "title"));
    const frame f = {.folder = folder,
                     .ending = "png",
                     .title = title ? title : "",
                     .time = text_of(document, "units", "time"),
                     .stress = text_of(document, "units", "stress"),
                     .given_stress =
                         strcmp(text_of(wanted, "history", "control"), "stress") == 0,
                     .talk = !quiet};
    PH_TRY(read_table(result, "relaxation.csv", &curves, err));
    PH_TRY(read_table(result, "dynamic.csv", &dynamic, err));
    PH_TRY(read_table(result, "response.csv", &response, err));
    if (curves) PH_TRY(plot_curves(&f, curves, err));
    if (dynamic) PH_TRY(plot_dynamic(&f, dynamic, err));
    if (response) PH_TRY(plot_response(&f, response, err));
    *drawn = (curves != NULL) + 2 * (dynamic != NULL) + (response != NULL);
out:
    json_decref(document);
    ph_table_free(&curves);
    ph_table_free(&dynamic);
    ph_table_free(&response);
    return st;
}

/* ---- table ---- */

/* At once, at the end, and the time at which half of the difference is gone. */
static void put_constant(FILE *to, const ph_constant *k)
{
    double now = ph_curve_at_time(&k->curve, 0), end = k->curve.infinity;
    double lo = -300 * log(10), hi = 300 * log(10);
    for (int i = 0; i < 60; i++) {
        double mid = (lo + hi) / 2, x = ph_curve_at_time(&k->curve, exp(mid));
        if (fabs(x - now) < fabs(end - now) / 2)
            lo = mid;
        else
            hi = mid;
    }
    fprintf(to, "  %-13s %12.5g %12.5g", k->name, now, end);
    if (fabs(end - now) > 1e-9 * fabs(now)) fprintf(to, " %12.4g", exp(lo));
    fputc('\n', to);
}

static void put_constants(FILE *to, const ph_case *c, const ph_relaxation_report *r)
{
    fprintf(to, "\nrelaxation [%s]%*s at once     at last    half at [%s]\n",
            c->unit_stress,
            (int)(8 - strlen(c->unit_stress) > 20 ? 0 : 8 - strlen(c->unit_stress)), "",
            c->unit_time);
    for (int i = 0; i < r->constants->count; i++)
        if (r->constants->item[i].name[0] != 'C' || r->constants->why[0])
            put_constant(to, &r->constants->item[i]);
    if (r->constants->why[0])
        fprintf(to, "  no engineering constants: %s\n", r->constants->why);
}

static void put_terms(FILE *to, const ph_case *c, const ph_viscoelastic *v,
                      const ph_relaxation_report *r)
{
    enum { MOST = 12 };
    const ph_prony *p = r->series;
    fprintf(to, "\nseries      %d terms", p->nterms);
    if (p->nterms != v->series->nterms)
        fprintf(to, " of %d, compressed with error %.2g", v->series->nterms,
                r->fit_error);
    fprintf(to, "\n%12s", c->unit_time);
    int columns = r->terms->ncolumns < 4 ? r->terms->ncolumns : 4;
    for (int k = 1; k < columns; k++)
        fprintf(to, " %12s", r->terms->name[k]);
    fputc('\n', to);
    for (int m = 0; m <= p->nterms && m <= MOST; m++) {
        if (m)
            fprintf(to, "%12.5g", p->term[m - 1].time);
        else
            fprintf(to, "%12s", "infinity");
        for (int k = 1; k < columns; k++)
            fprintf(to, " %12.5g", r->terms->value[(ptrdiff_t)k * r->terms->nrows + m]);
        fputc('\n', to);
    }
    if (p->nterms > MOST) fprintf(to, "%12s (all in prony.csv)\n", "...");
}

/* Of a route without series: first row of the tensor at every Carson variable. */
static void put_values(FILE *to, const ph_case *c, const ph_viscoelastic *v)
{
    for (int k = 0; k < v->ncurve; k++) {
        if (k == 0)
            fprintf(to, "\n%12s %12s %12s   [%s]\n", "time", "C11", "C12",
                    c->unit_stress);
        fprintf(to, "%12.5g %12.6g %12.6g\n", v->curve[k].time,
                v->curve[k].stiffness.m[0][0], v->curve[k].stiffness.m[0][1]);
    }
    for (int k = 0; k < v->ndynamic; k++) {
        if (k == 0)
            fprintf(to, "\n%12s %12s %12s   [%s]\n", "omega", "C11'", "C11''",
                    c->unit_stress);
        fprintf(to, "%12.5g %12.6g %12.6g\n", v->dynamic[k].omega,
                v->dynamic[k].storage.m[0][0], v->dynamic[k].loss.m[0][0]);
    }
    if (v->nvalues == 0) return;
    fprintf(to, "\n%12s %12s %12s   [%s]\n", "s", "C11", "C12", c->unit_stress);
    for (int k = 0; k < v->nvalues; k++)
        fprintf(to, "%12.5g %12.6g %12.6g\n", v->values[k].s,
                v->values[k].stiffness.m[0][0], v->values[k].stiffness.m[0][1]);
}

static void put_cost(FILE *to, const ph_viscoelastic *v)
{
    char bytes[32], seconds[32];
    fprintf(to, "\nroute       %s, %d values of s, %ld iterations, %ld applications",
            v->route, v->npoints, v->iterations, v->applications);
    if (v->basis)
        fprintf(to, ", basis of %d fields (%s)", v->basis,
                report_bytes(v->basis_bytes, bytes));
    if (v->steps) fprintf(to, ", %ld steps", v->steps);
    fprintf(to, "\n            %s", report_seconds(v->seconds, seconds));
    if (isfinite(v->error) && v->error > 0)
        fprintf(to, ", estimated relative error %.1e", v->error);
    fputc('\n', to);
    if (v->lost)
        fprintf(
            to,
            "note        the equilibrium tensor is singular: %d direction%s of strain "
            "carr%s no stress at last\n",
            v->lost, v->lost == 1 ? "" : "s", v->lost == 1 ? "ies" : "y");
}

void relaxation_print(FILE *to, const ph_case *c, const ph_viscoelastic *v,
                      const ph_relaxation_report *r)
{
    report_result(to, c, v->elastic);
    if (r && r->series) {
        put_constants(to, c, r);
        put_terms(to, c, v, r);
    } else {
        put_values(to, c, v);
    }
    put_cost(to, v);
}
