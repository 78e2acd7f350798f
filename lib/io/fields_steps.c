/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The steps of damage in a fields file: a group each, with the damage of the nodes and the
 * fields; under a loading those at its load, else those of every unit load. */
#include "io/fields_writer.h"
#include "io/hdf5.h"

#include <math.h>
#include <string.h>

bool ph_i_has_steps(const ph_result *r)
{
    return r && r->damage && r->damage->nsteps > 0 && r->damage->step[0].field;
}

/* The fields of a step: the last one's are the result's. */
static const ph_fields *fields_of(const ph_result *r, int number, int *count)
{
    const ph_damage_step *s = &r->damage->step[number];
    bool last = number == r->damage->nsteps - 1;
    *count = last ? r->nfields : s->nfields;
    return last ? r->fields : s->fields;
}

bool ph_i_step_is_loaded(const ph_result *r, int number)
{
    int count;
    fields_of(r, number, &count);
    /* where phases relax the fields of now are not those of the unit loads */
    return r->failure && !r->failure->in_time && count == ph_strains(r->grid.kinematics);
}

bool ph_i_step_has_loads(const ph_result *r, int number, const ph_fields **fields,
                         int *count)
{
    *fields = fields_of(r, number, count);
    return *count > 0 && !ph_i_step_is_loaded(r, number);
}

/* How much of each load is in a step: its strain, or, of loads that are stresses, C times it. */
static void amplitudes(const ph_result *r, const ph_damage_step *s, double *a)
{
    double voigt[36];
    int n = s->stiffness.n;
    memcpy(a, s->strain, sizeof *a * 6);
    if (strcmp(r->constraint, "uniform_traction") != 0) return;
    ph_sym4_to_voigt(&s->stiffness, true, voigt);
    for (int i = 0; i < n; i++) {
        a[i] = 0.0;
        for (int j = 0; j < n; j++)
            a[i] += voigt[i * n + j] * s->strain[j];
    }
}

static void add(ptrdiff_t n, double factor, const double *from, double *to)
{
    for (ptrdiff_t i = 0; i < n; i++)
        to[i] += factor * from[i];
}

static void clear(ph_fields *f)
{
    free(f->displacement);
    free(f->strain);
    free(f->stress);
}

/* The fields at the load of a step. */
static ph_status superpose(const ph_result *r, int number, ph_fields *out, ph_error *err)
{
    ph_status st = PH_OK;
    int count;
    const ph_fields *f = fields_of(r, number, &count);
    ptrdiff_t cells = ph_grid_cells(&r->grid);
    double a[6];
    amplitudes(r, &r->damage->step[number], a);
    out->nu = f->nu;
    out->ns = f->ns;
    memcpy(out->macro_strain, r->damage->step[number].strain, sizeof out->macro_strain);
    PH_ALLOC(out->displacement, f->nu * cells, "the displacement of a step");
    PH_ALLOC(out->strain, f->ns * cells, "the strain of a step");
    PH_ALLOC(out->stress, f->ns * cells, "the stress of a step");
    for (int k = 0; k < count; k++) {
        add(f->nu * cells, a[f[k].load], f[k].displacement, out->displacement);
        add(f->ns * cells, a[f[k].load], f[k].strain, out->strain);
        add(f->ns * cells, a[f[k].load], f[k].stress, out->stress);
    }
out:
    return st;
}

static ph_status write_loads(ph_i_fields_writer *w, hid_t step, const ph_result *r,
                             int number, ph_error *err)
{
    ph_status st = PH_OK;
    const char *path = w->path;
    const ph_fields *f;
    int count;
    hid_t group = -1;
    if (!ph_i_step_has_loads(r, number, &f, &count)) return PH_OK;
    PH_HDF5(group = H5Gcreate2(step, "loads", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
            "write");
    for (int i = 0; i < count; i++)
        PH_TRY(ph_i_write_load(w, group, &f[i], ph_i_displacement_at_nodes(r), err));
out:
    if (group >= 0) H5Gclose(group);
    return st;
}

double ph_i_step_value(const ph_result *r, int number)
{
    double value = r->damage->step[number].value;
    return isfinite(value) ? value : (double)number;
}

static ph_status write_step(ph_i_fields_writer *w, hid_t steps, const ph_result *r,
                            int number, ph_error *err)
{
    ph_status st = PH_OK;
    const char *path = w->path;
    const double value = ph_i_step_value(r, number);
    ph_fields at = {0};
    hid_t group = -1;
    char name[16];
    snprintf(name, sizeof name, PH_I_STEP_NAME, number);
    PH_HDF5(group = H5Gcreate2(steps, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
            "write");
    PH_TRY(ph_i_hdf5_put_doubles(group, "value", 1, &value, path, err));
    PH_TRY(ph_i_write_cells(w, group, "damage", r->damage->step[number].field, err));
    if (ph_i_step_is_loaded(r, number)) {
        PH_TRY(superpose(r, number, &at, err));
        PH_TRY(ph_i_write_field(w, group, &at, ph_i_displacement_at_nodes(r), err));
    }
    PH_TRY(write_loads(w, group, r, number, err));
out:
    clear(&at);
    if (group >= 0) H5Gclose(group);
    return st;
}

ph_status ph_i_write_steps(ph_i_fields_writer *w, const ph_result *r, ph_error *err)
{
    static const char *const names[] = {[PH_SEQUENCE_NONE] = "step",
                                        [PH_SEQUENCE_GROWTH] = "crack_length",
                                        [PH_SEQUENCE_DENSITY] = "density_asked",
                                        [PH_SEQUENCE_LOADING] = "load"};
    ph_status st = PH_OK;
    const char *path = w->path;
    hid_t group = -1;
    PH_HDF5(group = H5Gcreate2(w->file, "steps", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
            "write");
    PH_TRY(ph_i_hdf5_put_ints(group, "count", 1, &r->damage->nsteps, path, err));
    PH_TRY(ph_i_hdf5_put_text(group, "value_is", names[r->damage->kind], path, err));
    for (int i = 0; i < r->damage->nsteps; i++)
        PH_TRY(write_step(w, group, r, i, err));
out:
    if (group >= 0) H5Gclose(group);
    return st;
}
