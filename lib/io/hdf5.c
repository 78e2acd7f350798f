/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/hdf5.h"

#include <string.h>

void ph_i_hdf5_begin(ph_i_hdf5_quiet *quiet)
{
    H5Eget_auto2(H5E_DEFAULT, &quiet->print, &quiet->user);
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
}

void ph_i_hdf5_end(const ph_i_hdf5_quiet *quiet)
{
    H5Eset_auto2(H5E_DEFAULT, quiet->print, quiet->user);
}

typedef struct innermost {
    char text[300];
    bool no_memory;
} innermost;

/* Walked from the inside out: the first entry with a text is where it broke. */
static herr_t keep_innermost(unsigned n, const H5E_error2_t *entry, void *user)
{
    innermost *found = user;
    if (n == 0)
        found->no_memory =
            entry->min_num == H5E_NOSPACE || entry->min_num == H5E_CANTALLOC;
    if (!found->text[0] && entry->desc)
        snprintf(found->text, sizeof found->text, "%s", entry->desc);
    return 0;
}

/* HDF5 says "file write failed: time = ..., error message = 'No space left on device', ..."
 * Keep what a person needs of it. */
static void shorten(char *text)
{
    const char *mark = "error message = '";
    char *from = strstr(text, mark);
    if (!from) return;
    from += strlen(mark);
    size_t length = strcspn(from, "'");
    memmove(text, from, length);
    text[length] = 0;
}

ph_status ph_i_hdf5_error(ph_error *err, const char *verb, const char *path)
{
    innermost found = {.text = ""};
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_innermost, &found);
    H5Eclear2(H5E_DEFAULT);
    if (!found.text[0]) snprintf(found.text, sizeof found.text, "HDF5 does not say why");
    shorten(found.text);
    return PH_FAIL(err, found.no_memory ? PH_ENOMEM : PH_EIO, "cannot %s '%.300s': %s",
                   verb, path, found.text);
}

/* ---- writing ---- */

/* An attribute of any type; closes nothing that it did not open. */
static ph_status put_attribute(hid_t object, const char *name, hid_t type, hid_t space,
                               const void *x, const char *path, ph_error *err)
{
    ph_status st = PH_OK;
    hid_t attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    PH_HDF5(attribute, "write");
    PH_HDF5(H5Awrite(attribute, type, x), "write");
out:
    if (attribute >= 0) H5Aclose(attribute);
    return st;
}

ph_status ph_i_hdf5_put_text(hid_t object, const char *name, const char *text,
                             const char *path, ph_error *err)
{
    ph_status st = PH_OK;
    hid_t type = -1, space = -1;
    PH_HDF5(type = H5Tcopy(H5T_C_S1), "write");
    PH_HDF5(H5Tset_size(type, strlen(text) + 1), "write");
    PH_HDF5(H5Tset_cset(type, H5T_CSET_UTF8), "write");
    PH_HDF5(space = H5Screate(H5S_SCALAR), "write");
    PH_TRY(put_attribute(object, name, type, space, text, path, err));
out:
    if (space >= 0) H5Sclose(space);
    if (type >= 0) H5Tclose(type);
    return st;
}

static ph_status put_row(hid_t object, const char *name, hid_t type, int count,
                         const void *x, const char *path, ph_error *err)
{
    ph_status st = PH_OK;
    hsize_t n = (hsize_t)count;
    hid_t space = -1;
    PH_HDF5(space = H5Screate_simple(1, &n, NULL), "write");
    PH_TRY(put_attribute(object, name, type, space, x, path, err));
out:
    if (space >= 0) H5Sclose(space);
    return st;
}

ph_status ph_i_hdf5_put_doubles(hid_t object, const char *name, int count,
                                const double *x, const char *path, ph_error *err)
{
    return put_row(object, name, H5T_NATIVE_DOUBLE, count, x, path, err);
}

ph_status ph_i_hdf5_put_ints(hid_t object, const char *name, int count, const int *x,
                             const char *path, ph_error *err)
{
    return put_row(object, name, H5T_NATIVE_INT, count, x, path, err);
}

/* Chunks of at most 2^17 entries: halve the slowest axis that is left. */
static void chunk_shape(int rank, const hsize_t *dims, hsize_t *chunk)
{
    hsize_t entries = 1;
    for (int a = 0; a < rank; a++) {
        chunk[a] = dims[a] > 0 ? dims[a] : 1;
        entries *= chunk[a];
    }
    for (int a = 0; a < rank; a++)
        while (entries > 131072 && chunk[a] > 1) {
            entries /= chunk[a];
            chunk[a] = (chunk[a] + 1) / 2;
            entries *= chunk[a];
        }
}

ph_status ph_i_hdf5_put_array(hid_t object, const char *name, hid_t type, int rank,
                              const hsize_t *dims, ph_i_storage how, const void *data,
                              const char *path, ph_error *err)
{
    ph_status st = PH_OK;
    hid_t space = -1, props = -1, set = -1;
    hsize_t shape[H5S_MAX_RANK];
    PH_HDF5(space = H5Screate_simple(rank, dims, NULL), "write");
    PH_HDF5(props = H5Pcreate(H5P_DATASET_CREATE), "write");
    if (how != PH_I_PLAIN) {
        chunk_shape(rank, dims, shape);
        PH_HDF5(H5Pset_chunk(props, rank, shape), "write");
        if (how == PH_I_DEFLATED) PH_HDF5(H5Pset_deflate(props, 4), "write");
    }
    PH_HDF5(set = H5Dcreate2(object, name, type, space, H5P_DEFAULT, props, H5P_DEFAULT),
            "write");
    PH_HDF5(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data), "write");
out:
    if (set >= 0 && H5Dclose(set) < 0 && st == PH_OK)
        st = ph_i_hdf5_error(err, "write", path);
    if (props >= 0) H5Pclose(props);
    if (space >= 0) H5Sclose(space);
    return st;
}

/* ---- reading ---- */

ph_status ph_i_hdf5_get_text(hid_t object, const char *name, char *text, size_t size,
                             const char *path, ph_error *err)
{
    ph_status st = PH_OK;
    hid_t attribute = -1, type = -1;
    char *all = NULL;
    PH_HDF5(attribute = H5Aopen(object, name, H5P_DEFAULT), "read");
    PH_HDF5(type = H5Aget_type(attribute), "read");
    PH_CHECK(H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0 &&
                 H5Aget_storage_size(attribute) == H5Tget_size(type),
             PH_EIO, "cannot read '%.300s': attribute '%s' is not one text", path, name);
    PH_ALLOC(all, H5Tget_size(type) + 1, "a text");
    PH_HDF5(H5Aread(attribute, type, all), "read");
    snprintf(text, size, "%s", all);
out:
    free(all);
    if (type >= 0) H5Tclose(type);
    if (attribute >= 0) H5Aclose(attribute);
    return st;
}

ph_status ph_i_hdf5_get_attribute(hid_t object, const char *name, hid_t type, int count,
                                  void *x, const char *path, ph_error *err)
{
    ph_status st = PH_OK;
    hid_t attribute = -1, space = -1;
    PH_HDF5(attribute = H5Aopen(object, name, H5P_DEFAULT), "read");
    PH_HDF5(space = H5Aget_space(attribute), "read");
    PH_CHECK(H5Sget_simple_extent_npoints(space) == count, PH_EIO,
             "cannot read '%.300s': attribute '%s' has not %d numbers", path, name,
             count);
    PH_HDF5(H5Aread(attribute, type, x), "read");
out:
    if (space >= 0) H5Sclose(space);
    if (attribute >= 0) H5Aclose(attribute);
    return st;
}

ph_status ph_i_hdf5_get_array(hid_t object, const char *name, hid_t type, int rank,
                              const hsize_t *dims, void *data, const char *path,
                              ph_error *err)
{
    ph_status st = PH_OK;
    hid_t set = -1, space = -1;
    hsize_t found[H5S_MAX_RANK];
    PH_HDF5(set = H5Dopen2(object, name, H5P_DEFAULT), "read");
    PH_HDF5(space = H5Dget_space(set), "read");
    bool same = H5Sget_simple_extent_ndims(space) == rank;
    if (same) H5Sget_simple_extent_dims(space, found, NULL);
    for (int a = 0; same && a < rank; a++)
        same = found[a] == dims[a];
    PH_CHECK(same, PH_EIO, "cannot read '%.300s': '%s' has not the shape of the grid",
             path, name);
    PH_HDF5(H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data), "read");
out:
    if (space >= 0) H5Sclose(space);
    if (set >= 0) H5Dclose(set);
    return st;
}
