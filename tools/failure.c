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
    step = calloc((size_t)(2 * p->nsteps), sizeof *step);
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

static ph_status write_pictures(const destination *to, const ph_case *c,
                                const ph_result *r, ph_error *err)
{
    ph_status st = PH_OK;
    char path[DESTINATION_PATH + 64], name[32], title[64];
    double *field = NULL;
    if (c->pictures_every == 0) return PH_OK; /* damage.png is the last step */
    field = calloc((size_t)ph_grid_cells(&r->grid), sizeof *field);
    PH_CHECK(field, PH_ENOMEM, "no memory for a picture");
    for (int i = 0; i < r->failure->nsteps; i += c->pictures_every) {
        PH_TRY(ph_failure_field(r->failure, i, field, err));
        snprintf(name, sizeof name, "damage-%05d.png", i);
        snprintf(title, sizeof title, "damage, load %.5g", r->failure->step[i].load);
        destination_file(to, name, path, sizeof path);
        PH_TRY(ph_write_png(path, &r->grid, field, 3, title, err));
    }
out:
    free(field);
    return st;
}

ph_status failure_write(const destination *to, const ph_case *c, const ph_result *r,
                        ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(write_table(to, "stress-strain.csv", ph_failure_steps_csv, r->failure, err));
    PH_TRY(write_table(to, "events.csv", ph_failure_events_csv, r->failure, err));
    PH_TRY(write_plot(to, c, r->failure, err));
    PH_TRY(write_pictures(to, c, r, err));
out:
    return st;
}

void failure_print(FILE *to, const ph_case *c, const ph_failure_path *p)
{
    const ph_failure_energy none = {0},
                            *e = p->nevents ? &p->event[p->nevents - 1].energy : &none;
    const char *stress = c->unit_stress;
    fprintf(to, "\nfailure\n");
    if (p->nevents == 0)
        fprintf(to, "  no bond broke\n");
    else
        fprintf(to, "  first break at load %.6g, %td events, %td bonds%s\n",
                p->first_load, p->nevents, p->nbonds,
                p->severed ? "; severed: no stress is left" : "");
    fprintf(to, "  peak stress %.6g %s at load %.6g; toughness %.6g %s\n", p->peak_stress,
            stress, p->peak_load, p->toughness, stress);
    fprintf(to,
            "  from event to event: external work %.6g = stored %.3g + dissipated %.6g "
            "(imbalance %.1e)\n",
            e->external, e->stored, e->dissipated, p->imbalance);
}
