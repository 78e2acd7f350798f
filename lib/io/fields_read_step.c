/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One step of damage out of a fields file. */
#include "io/fields_reader.h"
#include "io/hdf5.h"

void ph_fields_step_free(ph_fields_step **step)
{
    if (!step || !*step) return;
    free((*step)->damage);
    ph_i_read_fields_free((*step)->nfields, (*step)->fields);
    free(*step);
    *step = NULL;
}

static ph_status read_damage(ph_i_fields_reader *r, hid_t group, double **damage,
                             ph_error *err)
{
    ph_status st = PH_OK;
    PH_ALLOC(*damage, ph_grid_cells(&r->grid), "the damage");
    PH_TRY(ph_i_read_cells(r, group, "damage", *damage, err));
out:
    return st;
}

static ph_status read_step(ph_i_fields_reader *r, int step, unsigned loads,
                           ph_fields_step *out, ph_error *err)
{
    ph_status st = PH_OK;
    const char *path = r->path;
    char name[32], where[48];
    unsigned there = 0;
    int extra;
    hid_t group = -1;
    snprintf(name, sizeof name, "steps/" PH_I_STEP_NAME, step);
    snprintf(where, sizeof where, "%s/loads", name);
    PH_CHECK(H5Lexists(r->file, "steps", H5P_DEFAULT) > 0 &&
                 H5Lexists(r->file, name, H5P_DEFAULT) > 0,
             PH_EINVAL, "'%.300s' has no step %d", path, step);
    PH_HDF5(group = H5Gopen2(r->file, name, H5P_DEFAULT), "read");
    PH_TRY(ph_i_hdf5_get_attribute(group, "value", H5T_NATIVE_DOUBLE, 1, &out->value,
                                   path, err));
    PH_TRY(read_damage(r, group, &out->damage, err));
    if (!loads) goto out;
    PH_TRY(ph_i_read_extra(r, &extra, err));
    if (H5Lexists(group, "loads", H5P_DEFAULT) > 0)
        PH_TRY(ph_i_read_loads(r, where, loads, extra, &there, &out->nfields,
                               &out->fields, err));
    else if (H5Lexists(group, "displacement", H5P_DEFAULT) > 0) {
        PH_ALLOC(out->fields, 1, "the fields");
        out->nfields = 1;
        PH_TRY(ph_i_read_load(r, name, -1, extra, out->fields, err));
    }
out:
    if (group >= 0) H5Gclose(group);
    return st;
}

ph_status ph_read_fields_step(const char *path, const ph_grid *grid, int step,
                              unsigned loads, ph_fields_step **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_fields_reader r = {.path = path, .file = -1};
    ph_fields_step *made = NULL;
    size_t nodes = 3;
    ph_i_hdf5_quiet quiet;
    PH_GIVEN(path && grid && out);
    r.grid = *grid;
    ph_i_hdf5_begin(&quiet);
    for (int a = 0; a < 3; a++)
        nodes *= (size_t)grid->n[a] + 1;
    PH_ALLOC(made, 1, "a step of the fields file");
    PH_ALLOC(r.buffer, nodes, "the fields on their way in");
    PH_HDF5(r.file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT), "read");
    PH_TRY(read_step(&r, step, loads, made, err));
    *out = made;
    made = NULL;
out:
    if (r.file >= 0) H5Fclose(r.file);
    ph_i_hdf5_end(&quiet);
    ph_fields_step_free(&made);
    free(r.buffer);
    return st;
}
