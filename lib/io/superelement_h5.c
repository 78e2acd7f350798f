/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A superelement as HDF5, its matrix in compressed rows as scipy and others keep them. */
#include <perihom/superelement.h>

#include "io/draft.h"
#include "io/fields.h"
#include "io/hdf5.h"
#include "io/hdf5_sink.h"

typedef struct rows {
    int64_t *start;
    int32_t *column;
    double *value;
} rows;

static ph_status compress_rows(const double *S, ptrdiff_t n, rows *out, ph_error *err)
{
    ph_status st = PH_OK;
    ptrdiff_t count = 0;
    for (ptrdiff_t i = 0; i < n * n; i++)
        count += S[i] != 0.0;
    PH_ALLOC(out->start, n + 1, "the rows of a superelement");
    PH_ALLOC(out->column, count, "the rows of a superelement");
    PH_ALLOC(out->value, count, "the rows of a superelement");
    count = 0;
    for (ptrdiff_t i = 0; i < n; i++) {
        for (ptrdiff_t j = 0; j < n; j++) {
            if (S[i * n + j] == 0.0) continue;
            out->column[count] = (int32_t)j;
            out->value[count++] = S[i * n + j];
        }
        out->start[i + 1] = count;
    }
out:
    return st;
}

static ph_status put_stiffness(hid_t file, const ph_superelement *e, const char *path,
                               ph_error *err)
{
    ph_status st = PH_OK;
    const ptrdiff_t n = e->nd * e->nodes + e->strains;
    const int shape[2] = {(int)n, (int)n};
    const hsize_t ends = (hsize_t)n + 1;
    hid_t group = -1;
    rows r = {NULL, NULL, NULL};
    PH_TRY(compress_rows(e->stiffness, n, &r, err));
    const hsize_t count = (hsize_t)r.start[n];
    PH_HDF5(group = H5Gcreate2(file, "stiffness", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
            "write");
    PH_TRY(ph_i_hdf5_put_ints(group, "shape", 2, shape, path, err));
    PH_TRY(ph_i_hdf5_put_array(group, "indptr", H5T_NATIVE_INT64, 1, &ends, PH_I_PLAIN,
                               r.start, path, err));
    PH_TRY(ph_i_hdf5_put_array(group, "indices", H5T_NATIVE_INT32, 1, &count, PH_I_PLAIN,
                               r.column, path, err));
    PH_TRY(ph_i_hdf5_put_array(group, "data", H5T_NATIVE_DOUBLE, 1, &count, PH_I_PLAIN,
                               r.value, path, err));
out:
    if (group >= 0) H5Gclose(group);
    free(r.start);
    free(r.column);
    free(r.value);
    return st;
}

static ph_status put_tensor(hid_t file, const char *name, const ph_sym4 *c,
                            const char *path, ph_error *err)
{
    double voigt[36];
    const hsize_t shape[2] = {(hsize_t)c->n, (hsize_t)c->n};
    ph_sym4_to_voigt(c, true, voigt);
    return ph_i_hdf5_put_array(file, name, H5T_NATIVE_DOUBLE, 2, shape, PH_I_PLAIN, voigt,
                               path, err);
}

static ph_status put_all(hid_t file, const ph_superelement *e, const char *path,
                         ph_error *err)
{
    ph_status st = PH_OK;
    const hsize_t shape[2] = {(hsize_t)e->nodes, 3};
    PH_TRY(ph_i_hdf5_put_text(file, "schema", "perihom.superelement/1", path, err));
    PH_TRY(ph_i_hdf5_put_text(file, "kinematics", ph_i_kinematics_names[e->kinematics],
                              path, err));
    PH_TRY(ph_i_hdf5_put_ints(file, "components", 1, &e->nd, path, err));
    PH_TRY(ph_i_hdf5_put_ints(file, "strains", 1, &e->strains, path, err));
    PH_TRY(ph_i_hdf5_put_array(file, "position", H5T_NATIVE_DOUBLE, 2, shape, PH_I_PLAIN,
                               e->position, path, err));
    PH_TRY(put_tensor(file, "linear", &e->linear, path, err));
    PH_TRY(put_tensor(file, "periodic", &e->periodic, path, err));
    PH_TRY(put_stiffness(file, e, path, err));
out:
    return st;
}

ph_status ph_superelement_write_h5(const ph_superelement *e, const char *path,
                                   ph_error *err)
{
    PH_GIVEN(e && e->stiffness && e->position && path && path[0]);
    ph_status st = PH_OK;
    ph_i_draft draft = {.open = false};
    ph_i_hdf5_sink sink = {0};
    hid_t access = -1, file = -1;
    ph_i_hdf5_quiet quiet;
    ph_i_hdf5_begin(&quiet);
    PH_TRY(ph_i_draft_begin(&draft, path, err));
    PH_CHECK(!draft.in_place, PH_EIO, "cannot write '%.300s': not a regular file", path);
    PH_HDF5(access = ph_i_hdf5_sink_access(&sink), "write");
    file = H5Fcreate(draft.path, H5F_ACC_TRUNC, H5P_DEFAULT, access);
    if (file < 0 && sink.failed) PH_TRY(ph_i_io_error(err, "write", path, sink.failed));
    PH_HDF5(file, "write");
    PH_TRY(put_all(file, e, path, err));
out:
    if (file >= 0 && H5Fclose(file) < 0 && st == PH_OK)
        st = ph_i_hdf5_error(err, "write", path);
    if (access >= 0) H5Pclose(access);
    if (st == PH_OK && sink.failed) st = ph_i_io_error(err, "write", path, sink.failed);
    ph_i_hdf5_end(&quiet);
    if (st == PH_OK) st = ph_i_draft_commit(&draft, err);
    ph_i_draft_discard(&draft);
    return st;
}
