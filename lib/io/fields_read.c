/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/fields_reader.h"
#include "io/hdf5.h"

#include <string.h>

void ph_i_read_fields_free(int count, ph_fields *fields)
{
    for (int i = 0; i < count; i++) {
        free(fields[i].displacement);
        free(fields[i].strain);
        free(fields[i].stress);
    }
    free(fields);
}

void ph_fields_file_free(ph_fields_file **file)
{
    if (!file || !*file) return;
    ph_i_read_fields_free((*file)->nfields, (*file)->fields);
    ph_microstructure_free(&(*file)->micro);
    free(*file);
    *file = NULL;
}

static ph_status read_grid(ph_i_fields_reader *r, ph_error *err)
{
    ph_status st = PH_OK;
    char schema[64], kinematics[64];
    int64_t n[3];
    double size[3];
    int kin = 0;
    PH_TRY(ph_i_hdf5_get_text(r->file, "schema", schema, sizeof schema, r->path, err));
    PH_CHECK(strcmp(schema, PH_I_FIELDS_SCHEMA) == 0, PH_EIO,
             "'%.300s' has the schema '%s', this version reads '%s'", r->path, schema,
             PH_I_FIELDS_SCHEMA);
    PH_TRY(ph_i_hdf5_get_text(r->file, "kinematics", kinematics, sizeof kinematics,
                              r->path, err));
    while (kin < 4 && strcmp(kinematics, ph_i_kinematics_names[kin]) != 0)
        kin++;
    PH_CHECK(kin < 4, PH_EIO, "'%.300s': kinematics '%s' is not known", r->path,
             kinematics);
    PH_TRY(
        ph_i_hdf5_get_attribute(r->file, "nodes", H5T_NATIVE_INT64, 3, n, r->path, err));
    PH_TRY(ph_i_hdf5_get_attribute(r->file, "size", H5T_NATIVE_DOUBLE, 3, size, r->path,
                                   err));
    const ptrdiff_t cells[3] = {n[0], n[1], n[2]};
    for (int a = 0; a < 3; a++) /* a damaged file must not overflow the product */
        PH_CHECK(n[a] >= 1 && n[a] <= 1 << 20, PH_EIO,
                 "'%.300s': %lld nodes along axis %d", r->path, (long long)n[a], a + 1);
    PH_TRY(ph_grid_init(&r->grid, (ph_kinematics)kin, cells, size, err));
out:
    return st;
}

static ph_material material_of_row(const ph_i_material_row *row)
{
    ph_material m = {.is_void = row->is_void != 0,
                     .is_isotropic = row->is_isotropic != 0,
                     .E = row->E,
                     .nu = row->nu,
                     .density = row->density,
                     .stiffness = ph_sym4_from_voigt(6, row->voigt, true)};
    snprintf(m.name, sizeof m.name, "%.*s", (int)sizeof row->name - 1, row->name);
    return m;
}

/* Rows of a table of the given type; malloc'd. */
static ph_status read_table(ph_i_fields_reader *r, const char *name, hid_t type,
                            size_t size, hsize_t *rows, void **out, ph_error *err)
{
    ph_status st = PH_OK;
    const char *path = r->path;
    hid_t set = -1, space = -1;
    char *data = NULL;
    PH_HDF5(set = H5Dopen2(r->file, name, H5P_DEFAULT), "read");
    PH_HDF5(space = H5Dget_space(set), "read");
    hssize_t n = H5Sget_simple_extent_npoints(space);
    PH_CHECK(n >= 0 && n <= INT32_MAX, PH_EIO, "'%.300s': table '%s' has %lld rows", path,
             name, (long long)n);
    PH_ALLOC(data, (size_t)n * size, name);
    if (n > 0) PH_HDF5(H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data), "read");
    *rows = (hsize_t)n;
    *out = data;
    data = NULL;
out:
    free(data);
    if (space >= 0) H5Sclose(space);
    if (set >= 0) H5Dclose(set);
    return st;
}

static ph_status read_materials(ph_i_fields_reader *r, ph_microstructure **micro,
                                ph_error *err)
{
    ph_status st = PH_OK;
    hid_t type = -1;
    hsize_t n = 0;
    void *rows = NULL;
    ph_material *list = NULL;
    PH_TRY(ph_i_material_type(&type, r->path, err));
    PH_TRY(read_table(r, "materials", type, sizeof(ph_i_material_row), &n, &rows, err));
    PH_CHECK(n >= 1 && n <= UINT16_MAX, PH_EIO, "'%.300s' has %llu materials", r->path,
             (unsigned long long)n);
    PH_ALLOC(list, n, "the materials");
    for (hsize_t i = 0; i < n; i++)
        list[i] = material_of_row((ph_i_material_row *)rows + i);
    PH_TRY(ph_microstructure_new(&r->grid, (int)n, list, micro, err));
out:
    free(list);
    free(rows);
    if (type >= 0) H5Tclose(type);
    return st;
}

static ph_status read_cuts(ph_i_fields_reader *r, ph_microstructure *micro, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_grid *g = &r->grid;
    hid_t type = -1;
    hsize_t n = 0;
    void *rows = NULL;
    ph_cut *cuts = NULL;
    PH_TRY(ph_i_cut_type(&type, r->path, err));
    PH_TRY(read_table(r, "cuts", type, sizeof(ph_i_cut_row), &n, &rows, err));
    if (n > 0) PH_ALLOC(cuts, n, "the cut cells");
    for (hsize_t q = 0; q < n; q++) {
        const ph_i_cut_row *row = (ph_i_cut_row *)rows + q;
        for (int a = 0; a < 3; a++)
            PH_CHECK(row->index[a] >= 0 && row->index[a] < g->n[a], PH_EINVAL,
                     "'%.300s': cut %llu lies outside the grid", r->path,
                     (unsigned long long)q);
        cuts[q] = (ph_cut){.cell = (row->index[0] * g->n[1] + row->index[1]) * g->n[2] +
                                   row->index[2],
                           .base = row->base,
                           .material = row->material,
                           .fraction = row->fraction};
        memcpy(cuts[q].normal, row->normal, sizeof cuts[q].normal);
    }
    free(micro->cuts);
    micro->cuts = cuts;
    micro->ncuts = (ptrdiff_t)n;
    cuts = NULL;
out:
    free(cuts);
    free(rows);
    if (type >= 0) H5Tclose(type);
    return st;
}

static ph_status read_phase(ph_i_fields_reader *r, ph_microstructure *micro,
                            ph_error *err)
{
    ph_status st = PH_OK;
    const ph_grid *g = &r->grid;
    hsize_t shape[3];
    ph_i_array_shape(g, 0, shape);
    uint16_t *from = (uint16_t *)r->buffer, *to = micro->phase;
    PH_TRY(ph_i_hdf5_get_array(r->file, "phase", H5T_NATIVE_UINT16, 3, shape, from,
                               r->path, err));
    for (ptrdiff_t i = 0; i < g->n[0]; i++)
        for (ptrdiff_t j = 0; j < g->n[1]; j++)
            for (ptrdiff_t k = 0; k < g->n[2]; k++)
                *to++ = from[(k * g->n[1] + j) * g->n[0] + i];
out:
    return st;
}

/* `nc` components of each entry of [z][y][x][stride], with `extra` more per axis in the
 * file, to component-first [x][y][z]. */
static void untranspose(const ph_grid *g, int extra, int stride, int nc,
                        const double *from, double *to)
{
    const ptrdiff_t m0 = g->n[0] + extra, m1 = g->n[1] + extra;
    for (int c = 0; c < nc; c++)
        for (ptrdiff_t i = 0; i < g->n[0]; i++)
            for (ptrdiff_t j = 0; j < g->n[1]; j++)
                for (ptrdiff_t k = 0; k < g->n[2]; k++)
                    *to++ = from[stride * ((k * m1 + j) * m0 + i) + c];
}

ph_status ph_i_read_cells(ph_i_fields_reader *r, hid_t group, const char *name,
                          double *to, ph_error *err)
{
    ph_status st = PH_OK;
    hsize_t shape[3];
    ph_i_array_shape(&r->grid, 0, shape);
    PH_TRY(ph_i_hdf5_get_array(group, name, H5T_NATIVE_DOUBLE, 3, shape, r->buffer,
                               r->path, err));
    untranspose(&r->grid, 0, 1, 1, r->buffer, to);
out:
    return st;
}

static ph_status read_displacement(ph_i_fields_reader *r, hid_t load, int extra,
                                   ph_fields *f, ph_error *err)
{
    ph_status st = PH_OK;
    hsize_t shape[4];
    ph_i_array_shape(&r->grid, extra, shape);
    shape[3] = 3;
    PH_ALLOC(f->displacement, f->nu * ph_grid_cells(&r->grid), "the displacement");
    PH_TRY(ph_i_hdf5_get_array(load, "displacement", H5T_NATIVE_DOUBLE, 4, shape,
                               r->buffer, r->path, err));
    untranspose(&r->grid, extra, 3, f->nu, r->buffer, f->displacement);
out:
    return st;
}

static ph_status read_components(ph_i_fields_reader *r, hid_t load, const char *kind,
                                 int ns, double **value, ph_error *err)
{
    ph_status st = PH_OK;
    ptrdiff_t cells = ph_grid_cells(&r->grid);
    char name[32];
    PH_ALLOC(*value, ns * cells, kind);
    for (int a = 0; a < ns; a++) {
        snprintf(name, sizeof name, "%s/%s", kind, ph_i_voigt_name(ns, a));
        PH_TRY(ph_i_read_cells(r, load, name, *value + a * cells, err));
    }
out:
    return st;
}

ph_status ph_i_read_load(ph_i_fields_reader *r, const char *name, int load, int extra,
                         ph_fields *f, ph_error *err)
{
    ph_status st = PH_OK;
    const char *path = r->path;
    hid_t group = -1;
    f->load = load;
    f->ns = ph_strains(r->grid.kinematics);
    f->nu = ph_displacements(r->grid.kinematics);
    PH_HDF5(group = H5Gopen2(r->file, name, H5P_DEFAULT), "read");
    PH_TRY(ph_i_hdf5_get_attribute(group, "macro_strain", H5T_NATIVE_DOUBLE, f->ns,
                                   f->macro_strain, path, err));
    if (H5Lexists(group, "displacement", H5P_DEFAULT) > 0)
        PH_TRY(read_displacement(r, group, extra, f, err));
    if (H5Lexists(group, "strain", H5P_DEFAULT) > 0)
        PH_TRY(read_components(r, group, "strain", f->ns, &f->strain, err));
    if (H5Lexists(group, "stress", H5P_DEFAULT) > 0)
        PH_TRY(read_components(r, group, "stress", f->ns, &f->stress, err));
out:
    if (group >= 0) H5Gclose(group);
    return st;
}

ph_status ph_i_read_loads(ph_i_fields_reader *r, const char *where, unsigned loads,
                          int extra, unsigned *there, int *count, ph_fields **fields,
                          ph_error *err)
{
    ph_status st = PH_OK;
    int ns = ph_strains(r->grid.kinematics);
    char name[64];
    PH_ALLOC(*fields, ns, "the loads");
    for (int a = 0; a < ns; a++) {
        snprintf(name, sizeof name, "%s/%s", where, ph_i_voigt_name(ns, a));
        if (H5Lexists(r->file, name, H5P_DEFAULT) <= 0) continue;
        *there |= 1u << a;
        if (!(loads >> a & 1u)) continue;
        PH_TRY(ph_i_read_load(r, name, a, extra, &(*fields)[(*count)++], err));
    }
out:
    return st;
}

ph_status ph_i_read_extra(ph_i_fields_reader *r, int *extra, ph_error *err)
{
    ph_status st = PH_OK;
    const char *path = r->path;
    char at[64];
    hid_t group = -1;
    *extra = 0;
    if (H5Lexists(r->file, "loads", H5P_DEFAULT) <= 0) goto out;
    PH_HDF5(group = H5Gopen2(r->file, "loads", H5P_DEFAULT), "read");
    PH_TRY(ph_i_hdf5_get_text(group, "displacement_at", at, sizeof at, path, err));
    *extra = strcmp(at, "nodes") == 0;
out:
    if (group >= 0) H5Gclose(group);
    return st;
}

static ph_status read_loads(ph_i_fields_reader *r, unsigned loads, ph_fields_file *out,
                            ph_error *err)
{
    ph_status st = PH_OK;
    int extra;
    if (H5Lexists(r->file, "loads", H5P_DEFAULT) <= 0) return PH_OK;
    PH_TRY(ph_i_read_extra(r, &extra, err));
    PH_TRY(ph_i_read_loads(r, "loads", loads, extra, &out->loads, &out->nfields,
                           &out->fields, err));
out:
    return st;
}

static ph_status read_step_count(ph_i_fields_reader *r, ph_fields_file *out,
                                 ph_error *err)
{
    ph_status st = PH_OK;
    const char *path = r->path;
    hid_t group = -1;
    if (H5Lexists(r->file, "steps", H5P_DEFAULT) <= 0) return PH_OK;
    PH_HDF5(group = H5Gopen2(r->file, "steps", H5P_DEFAULT), "read");
    PH_TRY(ph_i_hdf5_get_attribute(group, "count", H5T_NATIVE_INT, 1, &out->nsteps, path,
                                   err));
    PH_TRY(ph_i_hdf5_get_text(group, "value_is", out->step_value, sizeof out->step_value,
                              path, err));
    PH_CHECK(out->nsteps >= 0 && out->nsteps < 10000000, PH_EINVAL,
             "'%.300s': %d steps are not admissible", path, out->nsteps);
out:
    if (group >= 0) H5Gclose(group);
    return st;
}

static ph_status read_all(ph_i_fields_reader *r, unsigned loads, ph_fields_file *out,
                          ph_error *err)
{
    ph_status st = PH_OK;
    size_t nodes = 3;
    PH_TRY(read_grid(r, err));
    for (int a = 0; a < 3; a++)
        nodes *= (size_t)r->grid.n[a] + 1;
    PH_ALLOC(r->buffer, nodes, "the fields on their way in");
    PH_TRY(ph_i_hdf5_get_text(r->file, "title", out->title, sizeof out->title, r->path,
                              err));
    PH_TRY(ph_i_hdf5_get_text(r->file, "unit_length", out->unit_length,
                              sizeof out->unit_length, r->path, err));
    PH_TRY(ph_i_hdf5_get_text(r->file, "unit_stress", out->unit_stress,
                              sizeof out->unit_stress, r->path, err));
    PH_TRY(ph_i_hdf5_get_text(r->file, "git", out->git, sizeof out->git, r->path, err));
    PH_TRY(read_materials(r, &out->micro, err));
    PH_TRY(read_phase(r, out->micro, err));
    PH_TRY(read_cuts(r, out->micro, err));
    PH_TRY(ph_microstructure_check(out->micro, err));
    PH_TRY(read_loads(r, loads, out, err));
    PH_TRY(read_step_count(r, out, err));
out:
    return st;
}

ph_status ph_read_fields(const char *path, unsigned loads, ph_fields_file **out,
                         ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_fields_reader r = {.path = path, .file = -1};
    ph_fields_file *made = NULL;
    ph_i_hdf5_quiet quiet;
    ph_i_hdf5_begin(&quiet);
    PH_CHECK(path && out, PH_EINVAL, "no file to read");
    PH_ALLOC(made, 1, "the fields file");
    PH_HDF5(r.file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT), "read");
    PH_TRY(read_all(&r, loads, made, err));
    *out = made;
    made = NULL;
out:
    if (r.file >= 0) H5Fclose(r.file);
    ph_i_hdf5_end(&quiet);
    ph_fields_file_free(&made);
    free(r.buffer);
    return st;
}
