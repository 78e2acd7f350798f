/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "failure.h"

#include "check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef ph_status (*table_writer)(const ph_failure_path *path, char **text,
                                  ph_error *err);

static ph_status write_table(const destination *to, const char *name, table_writer writer,
                             const ph_failure_path *p, ph_error *err)
{
    ph_status st = PH_OK;
    char path[DESTINATION_PATH + 64], *text = NULL;
    PH_TRY(writer(p, &text, err));
    destination_file(to, name, path, sizeof path);
    PH_TRY(ph_write_file(path, text, strlen(text), err));
out:
    free(text);
    return st;
}

/* Two lines: the strain controlled, with its drops, and the path from event to event. */
static ph_status write_plot(const destination *to, const ph_case *c,
                            const ph_failure_path *p, ph_error *err)
{
    ph_status st = PH_OK;
    char path[DESTINATION_PATH + 64], label[64];
    ptrdiff_t n = 2 * p->nevents + 1;
    double *x = NULL, *step = NULL;
    x = calloc((size_t)(2 * n), sizeof *x);
    step = calloc(2 * (size_t)p->nsteps, sizeof *step);
    PH_CHECK(x && step, PH_ENOMEM, "no memory for the curve");
    for (ptrdiff_t i = 0; i < p->nevents; i++) {
        x[2 * i + 1] = x[2 * i + 2] = p->event[i].load;
        x[n + 2 * i + 1] = p->event[i].before;
        x[n + 2 * i + 2] = p->event[i].after;
    }
    for (int i = 0; i < p->nsteps; i++) {
        step[i] = p->step[i].load;
        step[p->nsteps + i] = p->step[i].work;
    }
    const ph_series series[2] = {
        {.name = "from event to event", .n = n, .x = x, .y = x + n},
        {.name = "strain controlled",
         .n = p->nsteps,
         .x = step,
         .y = step + p->nsteps,
         .style = PH_PLOT_LINE_POINTS}};
    snprintf(label, sizeof label, "stress [%.32s]", c->unit_stress);
    const ph_plot plot = {.title = c->title,
                          .xlabel = "load factor of the macro strain",
                          .ylabel = label,
                          .nseries = 2,
                          .series = series};
    destination_file(to, "stress-strain.svg", path, sizeof path);
    PH_TRY(ph_plot_write(path, &plot, err));
out:
    free(x);
    free(step);
    return st;
}

/* In time: the conjugate of what is given, and where the work has gone. */
static ph_status write_times(const destination *to, const ph_case *c,
                             const ph_failure_path *p, ph_error *err)
{
    ph_status st = PH_OK;
    char path[DESTINATION_PATH + 64], label[64];
    const ptrdiff_t n = p->nsteps;
    double *x = calloc(6 * (size_t)n, sizeof *x);
    PH_CHECK(x, PH_ENOMEM, "no memory for the curve");
    for (ptrdiff_t i = 0; i < n; i++) {
        const ph_failure_step *s = &p->step[i];
        const double row[6] = {s->time,          s->work,           s->energy.external,
                               s->energy.stored, s->energy.viscous, s->energy.dissipated};
        for (int k = 0; k < 6; k++)
            x[k * n + i] = row[k];
    }
    const ph_series one = {.n = n, .x = x, .y = x + n, .style = PH_PLOT_LINE_POINTS};
    static const char *const name[4] = {"external work", "stored", "dissipated by phases",
                                        "dissipated by bonds"};
    ph_series energy[4];
    for (int k = 0; k < 4; k++)
        energy[k] = (ph_series){.name = name[k], .n = n, .x = x, .y = x + (2 + k) * n};
    if (p->by_stress)
        snprintf(label, sizeof label, "strain");
    else
        snprintf(label, sizeof label, "stress [%.32s]", c->unit_stress);
    ph_plot plot = {.title = c->title,
                    .xlabel = "time",
                    .ylabel = label,
                    .nseries = 1,
                    .series = &one};
    destination_file(to, p->by_stress ? "strain-time.svg" : "stress-time.svg", path,
                     sizeof path);
    PH_TRY(ph_plot_write(path, &plot, err));
    snprintf(label, sizeof label, "energy per volume [%.32s]", c->unit_stress);
    plot.nseries = 4;
    plot.series = energy;
    destination_file(to, "energy-time.svg", path, sizeof path);
    PH_TRY(ph_plot_write(path, &plot, err));
out:
    free(x);
    return st;
}

/* Cells of a frame into the sheet: frame 0 above on the left; 3D: the slice in the middle. */
static void put_frame(const ph_grid *g, const ph_grid *sheet, int columns, int rows,
                      int frame, const double *field, double *out)
{
    ptrdiff_t at[2] = {(frame % columns) * (g->n[0] + 1),
                       (rows - 1 - frame / columns) * (g->n[1] + 1)};
    for (ptrdiff_t i = 0; i < g->n[0]; i++)
        for (ptrdiff_t j = 0; j < g->n[1]; j++)
            out[(at[0] + i) * sheet->n[1] + at[1] + j] =
                field[(i * g->n[1] + j) * g->n[2] + g->n[2] / 2];
}

/* One sheet of all pictures, row by row. */
static ph_status write_pictures(const destination *to, const ph_case *c,
                                const ph_result *r, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_failure_path *p = r->failure;
    const ph_grid *g = &r->grid;
    char path[DESTINATION_PATH + 64];
    double *field = NULL, *all = NULL;
    ph_grid sheet;
    if (c->pictures_every == 0) return PH_OK; /* damage.png is the last step */
    int count = (p->nsteps - 1) / c->pictures_every + 1, columns = 1;
    while (columns * columns < count)
        columns++;
    int rows = (count + columns - 1) / columns;
    const ptrdiff_t n[2] = {columns * (g->n[0] + 1) - 1, rows * (g->n[1] + 1) - 1};
    const double size[2] = {(double)n[0], (double)n[1]};
    PH_TRY(ph_grid_init(&sheet, PH_PLANE_STRAIN, n, size, err));
    field = calloc((size_t)ph_grid_cells(g), sizeof *field);
    all = calloc((size_t)ph_grid_cells(&sheet), sizeof *all);
    PH_CHECK(field && all, PH_ENOMEM, "no memory for a picture");
    for (ptrdiff_t x = 0; x < ph_grid_cells(&sheet); x++)
        all[x] = (double)NAN;
    for (int i = 0; i < count; i++) {
        PH_TRY(ph_failure_field(p, i * c->pictures_every, field, err));
        put_frame(g, &sheet, columns, rows, i, field, all);
    }
    destination_file(to, "damage-steps.png", path, sizeof path);
    PH_TRY(ph_write_png(path, &sheet, all, 3, "damage, step by step", err));
out:
    free(field);
    free(all);
    return st;
}

ph_status failure_write(const destination *to, const ph_case *c, const ph_result *r,
                        ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(write_table(to, "stress-strain.csv", ph_failure_steps_csv, r->failure, err));
    PH_TRY(write_table(to, "events.csv", ph_failure_events_csv, r->failure, err));
    if (r->failure->in_time)
        PH_TRY(write_times(to, c, r->failure, err));
    else
        PH_TRY(write_plot(to, c, r->failure, err));
    PH_TRY(write_pictures(to, c, r, err));
out:
    return st;
}

static void print_times(FILE *to, const ph_failure_path *p, const char *unit)
{
    const ph_failure_energy *e = &p->step[p->nsteps - 1].energy;
    if (p->nevents > 0) fprintf(to, "  at time %.6g\n", p->first_time);
    if (p->severed) fprintf(to, "  severed at time %.6g\n", p->end_time);
    fprintf(to, "  largest %s %.6g %s at load %.6g\n", p->by_stress ? "strain" : "stress",
            p->peak_stress, p->by_stress ? "" : unit, p->peak_load);
    fprintf(
        to,
        "  external work %.6g = stored %.3g + dissipated by phases %.6g, by bonds %.6g "
        "(imbalance %.1e)\n",
        e->external, e->stored, e->viscous, e->dissipated, p->imbalance);
}

/* The largest stress is that of the last step, in size above the one before. */
static bool still_rises(const ph_failure_path *p)
{
    const ph_failure_step *last = &p->step[p->nsteps - 1];
    return p->nsteps > 1 && fabs(last->work) >= fabs(p->peak_stress) &&
           fabs(last->work) > fabs(last[-1].work);
}

/* Another path, on half the nodes. */
static void print_error(FILE *to, const ph_failure_error *e)
{
    const char *before = "  on half the nodes off by: ";
    const struct {
        const char *name;
        double value;
    } list[] = {{"first break", e->first_load},  {"peak load", e->peak_load},
                {"peak stress", e->peak_stress}, {"toughness", e->toughness},
                {"first time", e->first_time},   {"end time", e->end_time}};
    if (e->why[0]) {
        fprintf(to, "  no second path: %s\n", e->why);
        return;
    }
    for (size_t i = 0; i < sizeof list / sizeof *list; i++) {
        if (!isfinite(list[i].value)) continue;
        fprintf(to, "%s%s %.2g %%", before, list[i].name, 100 * list[i].value);
        before = ", ";
    }
    if (strcmp(before, ", ") == 0) fputc('\n', to);
}

void failure_print(FILE *to, const ph_case *c, const ph_failure_path *p)
{
    const char *stress = c->unit_stress;
    fprintf(to, "\nfailure\n");
    if (p->nevents == 0)
        fprintf(to, "  no bond broke\n");
    else
        fprintf(to, "  first break at load %.6g, %td events, %td bonds%s\n",
                p->first_load, p->nevents, p->nbonds,
                p->severed ? "; severed: no stress is left" : "");
    if (p->in_time) {
        print_times(to, p, stress);
        if (p->error) print_error(to, p->error);
        return;
    }
    if (still_rises(p))
        fprintf(to,
                "  no peak: stress still rises at the end of the loading, to %.6g %s at "
                "load %.6g",
                p->peak_stress, stress, p->peak_load);
    else
        fprintf(to, "  peak stress %.6g %s at load %.6g", p->peak_stress, stress,
                p->peak_load);
    fprintf(to, "; toughness %.6g %s\n", p->toughness, stress);
    if (p->error) print_error(to, p->error);
    if (p->nevents == 0) return;
    const ph_failure_energy *e = &p->event[p->nevents - 1].energy;
    fprintf(to,
            "  from event to event: external work %.6g = stored %.3g + dissipated %.6g "
            "(imbalance %.1e)\n",
            e->external, e->stored, e->dissipated, p->imbalance);
}
