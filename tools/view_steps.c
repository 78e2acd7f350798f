/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures of every step of damage, with one scale for all of them. */
#include "view_steps.h"

#include "check.h"

#include <math.h>
#include <string.h>

enum { DAMAGE = -2, AT_LOAD = -1 }; /* instead of a load */

/* What is drawn of every step. */
typedef struct series {
    const view_steps_request *q;
    const ph_fields_file *file;
    int load; /* DAMAGE, AT_LOAD, or its number */
    double low, high;
} series;

static const char *component_name(int n, int a)
{
    static const char *const names[2][6] = {{"11", "22", "12"},
                                            {"11", "22", "33", "23", "13", "12"}};
    return names[n == 6][a];
}

/* The scalar that is called `name`, or NULL. */
static const double *scalar_of(const ph_fields *f, const char *name, ptrdiff_t cells)
{
    char text[24];
    for (int a = 0; a < f->nu && f->displacement; a++) {
        snprintf(text, sizeof text, "displacement%d", a + 1);
        if (strcmp(text, name) == 0) return f->displacement + a * cells;
    }
    for (int a = 0; a < f->ns; a++) {
        snprintf(text, sizeof text, "strain%s", component_name(f->ns, a));
        if (f->strain && strcmp(text, name) == 0) return f->strain + a * cells;
        snprintf(text, sizeof text, "stress%s", component_name(f->ns, a));
        if (f->stress && strcmp(text, name) == 0) return f->stress + a * cells;
    }
    return NULL;
}

static const double *value_of(const series *s, const ph_fields_step *step)
{
    if (s->load == DAMAGE) return step->damage;
    for (int i = 0; i < step->nfields; i++)
        if (step->fields[i].load == s->load)
            return scalar_of(&step->fields[i], s->q->field,
                             ph_grid_cells(&s->file->micro->grid));
    return NULL;
}

static ph_status draw_step(const series *s, int number, const ph_fields_step *step,
                           ph_error *err)
{
    ph_status st = PH_OK;
    const view_steps_request *q = s->q;
    char path[4200], load[16] = "", title[160];
    const char *field = s->load == DAMAGE ? "damage" : q->field;
    const double *value = value_of(s, step);
    if (!value) return PH_OK;
    if (s->load >= 0)
        snprintf(load, sizeof load, "-load%s",
                 component_name(ph_strains(s->file->micro->grid.kinematics), s->load));
    snprintf(title, sizeof title, "%s%s, %s %.5g", field, load, s->file->step_value,
             step->value);
    PH_CHECK((size_t)snprintf(path, sizeof path, "%s/%s%s_%04d.png", q->folder, field,
                              load, number) < sizeof path,
             PH_EIO, "the path of a picture is too long");
    PH_TRY(ph_write_png_range(path, &s->file->micro->grid, value, q->axis, title, s->low,
                              s->high, err));
    ++*q->drawn;
    if (!q->quiet) puts(path);
out:
    return st;
}

static void widen(series *s, const double *value)
{
    for (ptrdiff_t x = 0; value && x < ph_grid_cells(&s->file->micro->grid); x++)
        if (isfinite(value[x])) {
            s->low = fmin(s->low, value[x]);
            s->high = fmax(s->high, value[x]);
        }
}

/* Every step twice: for the scale, and for the picture. Damage has its scale. */
static ph_status draw_series(series *s, ph_error *err)
{
    ph_status st = PH_OK;
    ph_fields_step *step = NULL;
    const unsigned loads = s->load == DAMAGE ? 0 : s->load < 0 ? ~0u : 1u << s->load;
    for (int pass = s->load == DAMAGE; pass < 2; pass++) {
        for (int i = 0; i < s->file->nsteps; i++) {
            PH_TRY(ph_read_fields_step(s->q->path, &s->file->micro->grid, i, loads, &step,
                                       err));
            if (pass == 0)
                widen(s, value_of(s, step));
            else
                PH_TRY(draw_step(s, i, step, err));
            ph_fields_step_free(&step);
        }
        if (s->low > s->high) return PH_OK; /* no such field */
        if (!(s->high > s->low)) s->high = s->low + fmax(fabs(s->low), 1.0) * 1e-9;
    }
out:
    ph_fields_step_free(&step);
    return st;
}

ph_status view_steps(const view_steps_request *q, const ph_fields_file *file,
                     ph_error *err)
{
    ph_status st = PH_OK;
    int n = ph_strains(file->micro->grid.kinematics);
    series s = {.q = q, .file = file, .load = DAMAGE, .high = 1.0};
    if (file->nsteps == 0) return PH_OK;
    if (!q->field || strcmp(q->field, "damage") == 0) return draw_series(&s, err);
    for (s.load = AT_LOAD; s.load < n; s.load++) {
        if (s.load >= 0 && !(q->loads >> s.load & 1u)) continue;
        s.low = INFINITY;
        s.high = -INFINITY;
        PH_TRY(draw_series(&s, err));
    }
out:
    return st;
}
