/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The fields file: microstructure and the fields of every load, HDF5 beside XDMF.
 * Ours is z fastest, XDMF is x fastest, so every array is transposed on its way out. */
#include <perihom/output.h>
#include <perihom/version.h>

#include "io/draft.h"
#include "io/fields_writer.h"
#include "io/hdf5.h"

#include <math.h>
#include <string.h>

/* One dataset, and whether the disk took it. */
static ph_status put_array(ph_i_fields_writer *w, hid_t group, const char *name,
                           hid_t type, int rank, const hsize_t *shape, ph_i_storage how,
                           const void *data, ph_error *err)
{
    ph_status st =
        ph_i_hdf5_put_array(group, name, type, rank, shape, how, data, w->path, err);
    if (w->sink.failed) return ph_i_io_error(err, "write", w->path, w->sink.failed);
    return st;
}

/* [x][y][z] to [z][y][x]. */
static void transpose_cells(const ph_grid *g, const double *from, double *to)
{
    for (ptrdiff_t i = 0; i < g->n[0]; i++)
        for (ptrdiff_t j = 0; j < g->n[1]; j++)
            for (ptrdiff_t k = 0; k < g->n[2]; k++)
                to[(k * g->n[1] + j) * g->n[0] + i] = *from++;
}

/* Add the displacement of component `c` to `to`, [z][y][x][3], on the mesh with `extra` more
 * nodes per axis: where that leaves the box, the other side plus the macro strain times the
 * box. `slope[a]`: the macro gradient of this component along axis a. */
static void transpose_displacement(const ph_grid *g, int extra, const double *from, int c,
                                   const double slope[3], double *to)
{
    ptrdiff_t m[3];
    for (int a = 0; a < 3; a++)
        m[a] = g->n[a] + (a < 2 || g->kinematics == PH_SPACE ? extra : 0);
    for (ptrdiff_t k = 0; k < m[2]; k++)
        for (ptrdiff_t j = 0; j < m[1]; j++)
            for (ptrdiff_t i = 0; i < m[0]; i++) {
                ptrdiff_t node[3] = {i, j, k};
                double jump = 0;
                for (int a = 0; a < 3; a++)
                    if (node[a] == g->n[a]) {
                        node[a] = 0;
                        jump += slope[a] * g->size[a];
                    }
                ptrdiff_t cell = (node[0] * g->n[1] + node[1]) * g->n[2] + node[2];
                to[3 * ((k * m[1] + j) * m[0] + i) + c] = from[cell] + jump;
            }
}

/* The macro strain of a load: as the solver says, else the mean of its strain field. */
static void macro_strain(const ph_grid *g, const ph_fields *f, double eps[6])
{
    bool given = false;
    ptrdiff_t cells = ph_grid_cells(g);
    for (int a = 0; a < f->ns; a++)
        given = given || f->macro_strain[a] != 0;
    for (int a = 0; a < f->ns; a++) {
        double sum = 0;
        for (ptrdiff_t x = 0; x < cells && f->strain; x++)
            sum += f->strain[a * cells + x];
        eps[a] = given ? f->macro_strain[a] : sum / (double)cells;
    }
}

/* Row `c` of the strain tensor from its Voigt components. */
static void strain_row(int ns, const double *eps, int c, double row[3])
{
    static const int index6[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
    static const int index3[2][2] = {{0, 2}, {2, 1}};
    for (int a = 0; a < 3; a++) {
        row[a] = 0;
        if (ns == 6) row[a] = eps[index6[c][a]] * (a == c ? 1 : 0.5);
        if (ns == 3 && a < 2) row[a] = eps[index3[c][a]] * (a == c ? 1 : 0.5);
    }
}

static ph_status write_displacement(ph_i_fields_writer *w, hid_t group,
                                    const ph_fields *f, const double *eps, bool at_nodes,
                                    ph_error *err)
{
    hsize_t shape[4];
    ph_i_array_shape(w->grid, at_nodes, shape);
    shape[3] = 3; /* always three, so that ParaView can warp 2D meshes too */
    size_t count = (size_t)(shape[0] * shape[1] * shape[2] * shape[3]);
    memset(w->buffer, 0, count * sizeof(double));
    for (int c = 0; c < f->nu; c++) {
        double slope[3];
        strain_row(f->ns, eps, c, slope);
        transpose_displacement(w->grid, at_nodes,
                               f->displacement + c * ph_grid_cells(w->grid), c, slope,
                               w->buffer);
    }
    return put_array(w, group, "displacement", H5T_NATIVE_DOUBLE, 4, shape, PH_I_CHUNKED,
                     w->buffer, err);
}

/* strain/11 ... or stress/11 ...: one array a component. */
static ph_status write_components(ph_i_fields_writer *w, hid_t load, const char *name,
                                  int ns, const double *value, ph_error *err)
{
    ph_status st = PH_OK;
    const char *path = w->path;
    hsize_t shape[3];
    ph_i_array_shape(w->grid, 0, shape);
    hid_t group = -1;
    PH_HDF5(group = H5Gcreate2(load, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
            "write");
    for (int a = 0; a < ns; a++) {
        transpose_cells(w->grid, value + a * ph_grid_cells(w->grid), w->buffer);
        PH_TRY(put_array(w, group, ph_i_voigt_name(ns, a), H5T_NATIVE_DOUBLE, 3, shape,
                         PH_I_CHUNKED, w->buffer, err));
    }
out:
    if (group >= 0) H5Gclose(group);
    return st;
}

ph_status ph_i_write_field(ph_i_fields_writer *w, hid_t group, const ph_fields *f,
                           bool at_nodes, ph_error *err)
{
    ph_status st = PH_OK;
    double eps[6] = {0};
    macro_strain(w->grid, f, eps);
    PH_TRY(ph_i_hdf5_put_doubles(group, "macro_strain", f->ns, eps, w->path, err));
    if (f->displacement) PH_TRY(write_displacement(w, group, f, eps, at_nodes, err));
    if (f->strain) PH_TRY(write_components(w, group, "strain", f->ns, f->strain, err));
    if (f->stress) PH_TRY(write_components(w, group, "stress", f->ns, f->stress, err));
out:
    return st;
}

ph_status ph_i_write_cells(ph_i_fields_writer *w, hid_t group, const char *name,
                           const double *value, ph_error *err)
{
    hsize_t shape[3];
    ph_i_array_shape(w->grid, 0, shape);
    transpose_cells(w->grid, value, w->buffer);
    return put_array(w, group, name, H5T_NATIVE_DOUBLE, 3, shape, PH_I_DEFLATED,
                     w->buffer, err);
}

ph_status ph_i_write_load(ph_i_fields_writer *w, hid_t loads, const ph_fields *f,
                          bool at_nodes, ph_error *err)
{
    ph_status st = PH_OK;
    const char *path = w->path;
    hid_t group = -1;
    PH_HDF5(group = H5Gcreate2(loads, ph_i_voigt_name(f->ns, f->load), H5P_DEFAULT,
                               H5P_DEFAULT, H5P_DEFAULT),
            "write");
    PH_TRY(ph_i_hdf5_put_ints(group, "load", 1, &f->load, path, err));
    PH_TRY(ph_i_write_field(w, group, f, at_nodes, err));
out:
    if (group >= 0) H5Gclose(group);
    return st;
}

static ph_status write_loads(ph_i_fields_writer *w, const ph_result *result,
                             ph_error *err)
{
    ph_status st = PH_OK;
    const char *path = w->path;
    hid_t group = -1;
    bool at_nodes = ph_i_displacement_at_nodes(result);
    PH_HDF5(group = H5Gcreate2(w->file, "loads", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
            "write");
    PH_TRY(ph_i_hdf5_put_text(group, "displacement_at",
                              at_nodes                            ? "nodes"
                              : result->points == PH_POINTS_NODES ? "cell centres"
                                                                  : "lower cell corners",
                              path, err));
    for (int i = 0; i < result->nfields; i++)
        PH_TRY(ph_i_write_load(w, group, &result->fields[i], at_nodes, err));
out:
    if (group >= 0) H5Gclose(group);
    return st;
}

static ph_status write_phase(ph_i_fields_writer *w, const ph_microstructure *micro,
                             ph_error *err)
{
    const ph_grid *g = w->grid;
    const uint16_t *from = micro->phase;
    uint16_t *to = w->buffer;
    hsize_t shape[3];
    ph_i_array_shape(g, 0, shape);
    for (ptrdiff_t i = 0; i < g->n[0]; i++)
        for (ptrdiff_t j = 0; j < g->n[1]; j++)
            for (ptrdiff_t k = 0; k < g->n[2]; k++)
                to[(k * g->n[1] + j) * g->n[0] + i] = *from++;
    return put_array(w, w->file, "phase", H5T_NATIVE_UINT16, 3, shape, PH_I_DEFLATED, to,
                     err);
}

static ph_status write_materials(ph_i_fields_writer *w, const ph_microstructure *micro,
                                 ph_error *err)
{
    ph_status st = PH_OK;
    const char *path = w->path;
    hsize_t n = (hsize_t)micro->nmaterials;
    ph_i_material_row *row = NULL;
    double *fraction = NULL;
    hid_t type = -1;
    PH_ALLOC(row, n, "the materials");
    PH_ALLOC(fraction, n, "the fractions");
    ph_microstructure_fractions(micro, fraction);
    for (hsize_t i = 0; i < n; i++) {
        const ph_material *m = &micro->materials[i];
        row[i] = (ph_i_material_row){.is_void = m->is_void,
                                     .is_isotropic = m->is_isotropic,
                                     .E = m->E,
                                     .nu = m->nu,
                                     .density = m->density,
                                     .fraction = fraction[i]};
        snprintf(row[i].name, sizeof row[i].name, "%s", m->name);
        if (m->stiffness.n == 6) ph_sym4_to_voigt(&m->stiffness, true, row[i].voigt);
    }
    PH_TRY(ph_i_material_type(&type, path, err));
    PH_TRY(put_array(w, w->file, "materials", type, 1, &n, PH_I_PLAIN, row, err));
out:
    if (type >= 0) H5Tclose(type);
    free(fraction);
    free(row);
    return st;
}

static ph_status write_cuts(ph_i_fields_writer *w, const ph_microstructure *micro,
                            ph_error *err)
{
    ph_status st = PH_OK;
    const char *path = w->path;
    const ph_grid *g = w->grid;
    hsize_t n = (hsize_t)micro->ncuts;
    ph_i_cut_row *row = NULL;
    hid_t type = -1;
    PH_ALLOC(row, n, "the cut cells");
    for (hsize_t q = 0; q < n; q++) {
        const ph_cut *cut = &micro->cuts[q];
        row[q] =
            (ph_i_cut_row){.index = {cut->cell / (g->n[1] * g->n[2]),
                                     cut->cell / g->n[2] % g->n[1], cut->cell % g->n[2]},
                           .base = cut->base,
                           .material = cut->material,
                           .fraction = cut->fraction};
        memcpy(row[q].normal, cut->normal, sizeof row[q].normal);
    }
    PH_TRY(ph_i_cut_type(&type, path, err));
    PH_TRY(put_array(w, w->file, "cuts", type, 1, &n, PH_I_PLAIN, row, err));
out:
    if (type >= 0) H5Tclose(type);
    free(row);
    return st;
}

static ph_status write_head(ph_i_fields_writer *w, const ph_case *c, ph_error *err)
{
    const ph_grid *g = w->grid;
    const int nodes[3] = {(int)g->n[0], (int)g->n[1], (int)g->n[2]};
    const struct {
        const char *name, *text;
    } texts[] = {{"schema", PH_I_FIELDS_SCHEMA},
                 {"title", c ? c->title : ""},
                 {"unit_length", c ? c->unit_length : ""},
                 {"unit_stress", c ? c->unit_stress : ""},
                 {"perihom", ph_version()},
                 {"git", ph_git_revision()},
                 {"kinematics", ph_i_kinematics_names[g->kinematics]},
                 {"axes", "z y x"}};
    ph_status st = PH_OK;
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        PH_TRY(ph_i_hdf5_put_text(w->file, texts[i].name, texts[i].text, w->path, err));
    PH_TRY(ph_i_hdf5_put_ints(w->file, "nodes", 3, nodes, w->path, err));
    PH_TRY(ph_i_hdf5_put_doubles(w->file, "size", 3, g->size, w->path, err));
    PH_TRY(ph_i_hdf5_put_doubles(w->file, "spacing", 3, g->h, w->path, err));
out:
    return st;
}

/* Doubles that the largest array on its way out takes. */
static size_t buffer_length(const ph_grid *g, const ph_result *result)
{
    size_t cells = 1, nodes = 1;
    for (int a = 0; a < 3; a++) {
        cells *= (size_t)g->n[a];
        nodes *= (size_t)g->n[a] + (a < 2 || g->kinematics == PH_SPACE);
    }
    bool fields = result && (result->nfields > 0 || ph_i_has_steps(result));
    return fields ? 3 * nodes : cells;
}

static ph_status write_all(ph_i_fields_writer *w, const ph_microstructure *micro,
                           const ph_result *result, const ph_case *c, ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(write_head(w, c, err));
    PH_TRY(write_phase(w, micro, err));
    PH_TRY(write_materials(w, micro, err));
    PH_TRY(write_cuts(w, micro, err));
    if (result && result->nfields > 0) PH_TRY(write_loads(w, result, err));
    if (ph_i_has_steps(result)) PH_TRY(ph_i_write_steps(w, result, err));
out:
    return st;
}

/* The HDF5 file as a draft; `draft` is open for the caller to commit. */
static ph_status write_hdf5(ph_i_draft *draft, const char *path,
                            const ph_microstructure *micro, const ph_result *result,
                            const ph_case *c, ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_fields_writer w = {.path = path, .grid = &micro->grid, .file = -1};
    double *buffer = NULL;
    hid_t access = -1;
    ph_i_hdf5_quiet quiet;
    ph_i_hdf5_begin(&quiet);
    PH_ALLOC(buffer, buffer_length(w.grid, result), "the fields on their way out");
    w.buffer = buffer;
    PH_TRY(ph_i_draft_begin(draft, path, err));
    PH_CHECK(!draft->in_place, PH_EIO, "cannot write '%.300s': not a regular file", path);
    PH_HDF5(access = ph_i_hdf5_sink_access(&w.sink), "write");
    w.file = H5Fcreate(draft->path, H5F_ACC_TRUNC, H5P_DEFAULT, access);
    if (w.file < 0 && w.sink.failed) { /* clearer than what HDF5 makes of it */
        st = ph_i_io_error(err, "write", path, w.sink.failed);
        goto out;
    }
    PH_HDF5(w.file, "write");
    PH_TRY(write_all(&w, micro, result, c, err));
out:
    if (w.file >= 0 && H5Fclose(w.file) < 0 && st == PH_OK)
        st = ph_i_hdf5_error(err, "write", path);
    if (access >= 0) H5Pclose(access);
    if (st == PH_OK && w.sink.failed)
        st = ph_i_io_error(err, "write", path, w.sink.failed);
    ph_i_hdf5_end(&quiet);
    free(buffer);
    return st;
}

static ph_status check_input(const char *base, const ph_microstructure *micro,
                             const ph_result *result, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(base && base[0] && micro, PH_EINVAL,
             "no name or no microstructure to write");
    PH_CHECK(strlen(base) < PH_I_PATH - 8, PH_EIO, "cannot write '%.100s...': %s", base,
             "the path is too long");
    bool fields = result && (result->nfields > 0 || ph_i_has_steps(result));
    for (int a = 0; fields && a < 3; a++)
        PH_CHECK(micro->grid.n[a] == result->grid.n[a], PH_EINVAL,
                 "the result has %td cells along axis %d, the microstructure %td",
                 result->grid.n[a], a + 1, micro->grid.n[a]);
    for (int i = 0; result && i < result->nfields; i++) {
        const ph_fields *f = &result->fields[i];
        PH_CHECK((f->ns == 3 || f->ns == 6) && f->nu >= 1 && f->nu <= 3 && f->load >= 0 &&
                     f->load < f->ns,
                 PH_EINVAL, "fields of load %d with %d strains, %d displacements",
                 f->load, f->ns, f->nu);
    }
out:
    return st;
}

ph_status ph_write_fields(const char *base, const ph_microstructure *micro,
                          const ph_result *result, const ph_case *c, ph_error *err)
{
    ph_status st = PH_OK;
    char path[PH_I_PATH], *text = NULL;
    size_t length;
    ph_i_draft draft = {.open = false};
    PH_TRY(check_input(base, micro, result, err));
    snprintf(path, sizeof path, "%s.h5", base);
    PH_TRY(write_hdf5(&draft, path, micro, result, c, err));
    const char *slash = strrchr(path, '/');
    PH_TRY(
        ph_i_xdmf_text(slash ? slash + 1 : path, micro, result, c, &text, &length, err));
    snprintf(path, sizeof path, "%s.xdmf", base);
    PH_TRY(ph_i_draft_commit(&draft, err));
    PH_TRY(ph_write_file(path, text, length, err));
out:
    ph_i_draft_discard(&draft);
    free(text);
    return st;
}
