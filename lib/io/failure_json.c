/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a loading did: a section of the result document, and tables. */
#include <perihom/output.h>
#include <perihom/table.h>

#include "io/json.h"

#include <math.h>
#include <string.h>

static ph_status put_energy(json_t *obj, const char *path, const ph_failure_energy *e,
                            bool in_time, json_t *reasons, ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(ph_i_json_put(obj, "external", ph_i_json_number(e->external), err));
    PH_TRY(ph_i_json_put(obj, "stored", ph_i_json_number(e->stored), err));
    PH_TRY(ph_i_json_put_number(obj, path, "fracture", e->fracture, reasons,
                                "bonds of model nosb hold no energy of their own", err));
    PH_TRY(ph_i_json_put(obj, "dissipated", ph_i_json_number(e->dissipated), err));
    if (in_time) PH_TRY(ph_i_json_put(obj, "viscous", ph_i_json_number(e->viscous), err));
out:
    return st;
}

static ph_status put_step(const ph_failure_path *p, int number, json_t *list,
                          json_t *reasons, ph_error *err)
{
    ph_status st = PH_OK;
    char path[64];
    snprintf(path, sizeof path, "effective.failure.steps.%d", number);
    const ph_failure_step *s = &p->step[number];
    bool good = true;
    json_t *obj = json_object();
    PH_CHECK(obj, PH_ENOMEM, "no memory for the failure");
    PH_TRY(ph_i_json_put(obj, "load", json_real(s->load), err));
    if (p->in_time) PH_TRY(ph_i_json_put(obj, "time", json_real(s->time), err));
    PH_TRY(ph_i_json_put(obj, "strain", ph_i_json_numbers(s->strain, p->n, &good), err));
    PH_TRY(ph_i_json_put(obj, "stress", ph_i_json_numbers(s->stress, p->n, &good), err));
    PH_CHECK(good, PH_ENOMEM, "no memory for the failure");
    PH_TRY(ph_i_json_put(obj, "conjugate_stress", ph_i_json_number(s->work), err));
    PH_TRY(ph_i_json_put(obj, "broken_bonds", json_integer((json_int_t)s->broken), err));
    PH_TRY(ph_i_json_put(obj, "events", json_integer((json_int_t)s->events), err));
    PH_TRY(put_energy(obj, path, &s->energy, p->in_time, reasons, err));
    PH_TRY(ph_i_json_add(list, json_incref(obj), err));
out:
    json_decref(obj);
    return st;
}

/* Energies of the path from event to event, at its end. */
static ph_status put_events(const ph_failure_path *p, json_t *failure, json_t *reasons,
                            ph_error *err)
{
    ph_status st = PH_OK;
    json_t *obj = json_object();
    ph_failure_energy none = {0};
    PH_CHECK(obj, PH_ENOMEM, "no memory for the failure");
    PH_TRY(ph_i_json_put(obj, "count", json_integer((json_int_t)p->nevents), err));
    PH_TRY(ph_i_json_put(obj, "imbalance", ph_i_json_number(p->imbalance), err));
    PH_TRY(put_energy(obj, "effective.failure.event_path",
                      p->nevents ? &p->event[p->nevents - 1].energy : &none, p->in_time,
                      reasons, err));
    PH_TRY(ph_i_json_put(failure, "event_path", json_incref(obj), err));
out:
    json_decref(obj);
    return st;
}

static ph_status put_times(const ph_failure_path *p, json_t *failure, json_t *reasons,
                           ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(ph_i_json_put_number(failure, "effective.failure", "first_time", p->first_time,
                                reasons, "no bond broke", err));
    PH_TRY(ph_i_json_put_number(failure, "effective.failure", "end_time", p->end_time,
                                reasons, "it was not severed", err));
out:
    return st;
}

/* Differences to the companion; {} where nobody solved one. */
static ph_status put_error(const ph_failure_path *p, json_t *failure, json_t *reasons,
                           ph_error *err)
{
    ph_status st = PH_OK;
    const ph_failure_error *e = p->error;
    static const char *const name[] = {"first_load", "peak_load",  "peak_stress",
                                       "toughness",  "first_time", "end_time"};
    json_t *obj = json_object();
    PH_CHECK(obj, PH_ENOMEM, "no memory for the failure");
    if (e) {
        const double value[] = {e->first_load, e->peak_load,  e->peak_stress,
                                e->toughness,  e->first_time, e->end_time};
        for (int i = 0; i < (p->in_time ? 6 : 4); i++)
            PH_TRY(ph_i_json_put_number(
                obj, "effective.failure.difference", name[i], value[i], reasons,
                e->why[0] ? e->why : "one of the two paths has none", err));
    }
    PH_TRY(ph_i_json_put(failure, "difference", json_incref(obj), err));
out:
    json_decref(obj);
    return st;
}

ph_status ph_i_json_failure(const ph_failure_path *p, json_t *effective, json_t *reasons,
                            ph_error *err)
{
    ph_status st = PH_OK;
    json_t *failure = json_object(), *steps = json_array(), *strain = json_array();
    PH_CHECK(failure && steps && strain, PH_ENOMEM, "no memory for the failure");
    for (int i = 0; i < p->n; i++)
        PH_TRY(ph_i_json_add(strain, ph_i_json_number(p->strain[i]), err));
    PH_TRY(ph_i_json_put(failure, p->by_stress ? "stress" : "strain", json_incref(strain),
                         err));
    PH_TRY(ph_i_json_put(failure, "break",
                         json_string(p->together ? "together" : "events"), err));
    PH_TRY(ph_i_json_put(failure, "window", ph_i_json_number(p->window), err));
    PH_TRY(ph_i_json_put_number(failure, "effective.failure", "first_load", p->first_load,
                                reasons, "no bond broke", err));
    if (p->in_time) PH_TRY(put_times(p, failure, reasons, err));
    PH_TRY(ph_i_json_put(failure, "peak_load", ph_i_json_number(p->peak_load), err));
    PH_TRY(ph_i_json_put(failure, "peak_stress", ph_i_json_number(p->peak_stress), err));
    PH_TRY(ph_i_json_put(failure, "toughness", ph_i_json_number(p->toughness), err));
    PH_TRY(ph_i_json_put(failure, "severed", json_boolean(p->severed), err));
    PH_TRY(ph_i_json_put(failure, "came_apart", json_boolean(p->apart), err));
    PH_TRY(put_error(p, failure, reasons, err));
    PH_TRY(put_events(p, failure, reasons, err));
    for (int i = 0; i < p->nsteps; i++)
        PH_TRY(put_step(p, i, steps, reasons, err));
    PH_TRY(ph_i_json_put(failure, "steps", json_incref(steps), err));
    PH_TRY(ph_i_json_put(effective, "failure", json_incref(failure), err));
out:
    json_decref(failure);
    json_decref(steps);
    json_decref(strain);
    return st;
}

/* ---- tables ------------------------------------------------------------------------------ */

static ph_status to_text(ph_table **table, char **text, ph_error *err)
{
    ph_status st = ph_table_to_csv(*table, text, err);
    ph_table_free(table);
    return st;
}

ph_status ph_failure_steps_csv(const ph_failure_path *p, char **text, ph_error *err)
{
    ph_status st = PH_OK;
    static const char *const three[] = {"stress_11", "stress_22", "stress_12",
                                        "strain_11", "strain_22", "strain_12"},
                             *const six[] = {"stress_11", "stress_22", "stress_33",
                                             "stress_23", "stress_13", "stress_12",
                                             "strain_11", "strain_22", "strain_33",
                                             "strain_23", "strain_13", "strain_12"},
                             *const rest[] = {"conjugate_stress", "broken_bonds",
                                              "external",         "stored",
                                              "fracture",         "dissipated"};
    const char *name[21] = {"load"};
    ph_table *t = NULL;
    int k = 1;
    PH_CHECK(p && text && p->nsteps > 0, PH_EINVAL, "no failure to write");
    for (int i = 0; i < p->n; i++)
        name[k++] = p->n == 3 ? three[i] : six[i];
    for (int i = 0; i < 6; i++)
        name[k++] = rest[i];
    for (int i = 0; i < p->n; i++)
        name[k++] = p->n == 3 ? three[3 + i] : six[6 + i];
    if (p->in_time) name[k++] = "time", name[k++] = "viscous";
    PH_TRY(ph_table_new(k, name, p->nsteps, &t, err));
    for (int i = 0; i < p->nsteps; i++) {
        const ph_failure_step *s = &p->step[i];
        const double last[] = {
            s->work,          (double)s->broken,  s->energy.external,
            s->energy.stored, s->energy.fracture, s->energy.dissipated};
        t->value[i] = s->load;
        for (int j = 0; j < p->n; j++)
            t->value[(ptrdiff_t)(1 + j) * p->nsteps + i] = s->stress[j];
        for (int j = 0; j < 6; j++)
            t->value[(ptrdiff_t)(1 + p->n + j) * p->nsteps + i] = last[j];
        for (int j = 0; j < p->n; j++)
            t->value[(ptrdiff_t)(7 + p->n + j) * p->nsteps + i] = s->strain[j];
        if (!p->in_time) continue;
        t->value[(ptrdiff_t)(7 + 2 * p->n) * p->nsteps + i] = s->time;
        t->value[(ptrdiff_t)(8 + 2 * p->n) * p->nsteps + i] = s->energy.viscous;
    }
    PH_TRY(to_text(&t, text, err));
out:
    ph_table_free(&t);
    return st;
}

ph_status ph_failure_events_csv(const ph_failure_path *p, char **text, ph_error *err)
{
    ph_status st = PH_OK;
    static const char *const name[] = {
        "load",     "stress_before", "stress_after", "broken_bonds", "external", "stored",
        "fracture", "dissipated",    "iterations",   "time",         "viscous"};
    enum { COLUMNS = sizeof name / sizeof *name };
    const int columns = p && p->in_time ? COLUMNS : COLUMNS - 2;
    ph_table *t = NULL;
    PH_CHECK(p && text, PH_EINVAL, "no failure to write");
    PH_TRY(ph_table_new(columns, name, p->nevents, &t, err));
    for (ptrdiff_t i = 0; i < p->nevents; i++) {
        const ph_failure_event *e = &p->event[i];
        const double row[COLUMNS] = {e->load,
                                     e->before,
                                     e->after,
                                     (double)e->broken,
                                     e->energy.external,
                                     e->energy.stored,
                                     e->energy.fracture,
                                     e->energy.dissipated,
                                     e->iterations,
                                     e->time,
                                     e->energy.viscous};
        for (int j = 0; j < columns; j++)
            t->value[j * p->nevents + i] = row[j];
    }
    PH_TRY(to_text(&t, text, err));
out:
    ph_table_free(&t);
    return st;
}
