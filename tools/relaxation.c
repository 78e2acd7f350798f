/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "relaxation.h"

#include "check.h"
#include "report.h"

#include <math.h>
#include <string.h>

ph_status relaxation_solve(const ph_case *c, const ph_problem *problem, const ph_ctx *ctx,
                           ph_viscoelastic **v, ph_relaxation_report **report,
                           ph_error *err)
{
    ph_status st = PH_OK;
    const ph_relaxation_params params = {.route = c->viscoelastic.route,
                                         .tolerance = c->viscoelastic.tolerance};
    PH_TRY(ph_viscoelastic_solve(problem, &params, ctx, v, err));
    if ((*v)->series) PH_TRY(ph_relaxation_report_new(*v, &c->viscoelastic, report, err));
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

/* Columns of a table against its first one; names that it lacks are left out. */
static ph_status plot_columns(const destination *to, const char *file,
                              const ph_plot *frame, const ph_table *t,
                              const char *const *names, int nnames, ph_error *err)
{
    ph_series series[16];
    ph_plot plot = *frame;
    char path[DESTINATION_PATH + 64];
    destination_file(to, file, path, sizeof path);
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
    return ph_plot_write(path, &plot, err);
}

#define COUNT(list) ((int)(sizeof(list) / sizeof *(list)))

static ph_status plot_all(const destination *to, const ph_case *c,
                          const ph_relaxation_report *r, ph_error *err)
{
    static const char *const moduli[] = {"E1",  "E2",  "E3",  "G23",
                                         "G13", "G12", "C11", "C12"};
    static const char *const parts[] = {"E1_storage", "E2_storage", "G12_storage",
                                        "E1_loss",    "E2_loss",    "G12_loss"};
    static const char *const loss[] = {"E1_tan_delta",  "E2_tan_delta",  "E3_tan_delta",
                                       "G23_tan_delta", "G13_tan_delta", "G12_tan_delta"};
    ph_status st = PH_OK;
    char time[64], stress[64], omega[64];
    snprintf(time, sizeof time, "time [%s]", c->unit_time);
    snprintf(stress, sizeof stress, "modulus [%s]", c->unit_stress);
    snprintf(omega, sizeof omega, "angular frequency [rad/%s]", c->unit_time);
    ph_plot plot = {.title = "Relaxation",
                    .subtitle = c->title,
                    .xlabel = time,
                    .ylabel = stress,
                    .log_x = true};
    PH_TRY(
        plot_columns(to, "relaxation.svg", &plot, r->curves, moduli, COUNT(moduli), err));
    plot.title = "Storage and loss";
    plot.xlabel = omega;
    plot.log_y = true;
    PH_TRY(plot_columns(to, "dynamic.svg", &plot, r->dynamic, parts, COUNT(parts), err));
    plot.title = "Loss tangent";
    plot.ylabel = "tan delta";
    plot.log_y = false;
    PH_TRY(plot_columns(to, "tan-delta.svg", &plot, r->dynamic, loss, COUNT(loss), err));
out:
    return st;
}

/* The component that moves most, of what answers. */
static ph_status plot_response(const destination *to, const ph_case *c,
                               const ph_relaxation_report *r, ph_error *err)
{
    static const char *const strain[] = {"strain_11", "strain_22", "strain_33",
                                         "strain_23", "strain_13", "strain_12"};
    static const char *const stress[] = {"stress_11", "stress_22", "stress_33",
                                         "stress_23", "stress_13", "stress_12"};
    bool given_stress = c->viscoelastic.history->stress;
    char time[64], label[64];
    snprintf(time, sizeof time, "time [%s]", c->unit_time);
    snprintf(label, sizeof label, "stress [%s]", c->unit_stress);
    const ph_plot plot = {.title = given_stress ? "Strain" : "Stress",
                          .subtitle = c->title,
                          .xlabel = time,
                          .ylabel = given_stress ? "strain (engineering shear)" : label};
    return plot_columns(to, "response.svg", &plot, r->response,
                        given_stress ? strain : stress, 6, err);
}

ph_status relaxation_write(const destination *to, const ph_case *c,
                           const ph_relaxation_report *r, ph_error *err)
{
    ph_status st = PH_OK;
    char path[DESTINATION_PATH + 64], *text = NULL;
    PH_TRY(write_table(to, "prony.csv", r->terms, err));
    PH_TRY(write_table(to, "relaxation.csv", r->curves, err));
    PH_TRY(write_table(to, "dynamic.csv", r->dynamic, err));
    PH_TRY(plot_all(to, c, r, err));
    if (r->response) {
        PH_TRY(write_table(to, "response.csv", r->response, err));
        PH_TRY(plot_response(to, c, r, err));
    }
    if (r->series->equilibrium.n == 6) {
        destination_file(to, "prony.yaml", path, sizeof path);
        PH_TRY(ph_prony_to_yaml(r->series, "effective", &text, err));
        PH_TRY(ph_write_file(path, text, strlen(text), err));
    }
out:
    free(text);
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

static void put_cost(FILE *to, const ph_viscoelastic *v)
{
    char bytes[32], seconds[32];
    fprintf(to, "\nroute       %s, %d values of s, %ld iterations, %ld applications",
            v->route, v->npoints, v->iterations, v->applications);
    if (v->basis)
        fprintf(to, ", basis of %d fields (%s)", v->basis,
                report_bytes(v->basis_bytes, bytes));
    fprintf(to, "\n            %s", report_seconds(v->seconds, seconds));
    if (isfinite(v->error)) fprintf(to, ", estimated relative error %.1e", v->error);
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
    if (r) {
        put_constants(to, c, r);
        put_terms(to, c, v, r);
    }
    put_cost(to, v);
}
