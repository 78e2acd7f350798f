/* SPDX-License-Identifier: GPL-3.0-or-later */
/* .h5: a dataset of whole numbers of one to three axes. */
#include "core/check.h"
#include "voxels.h"

#include <hdf5.h>

#include <string.h>

/* The most that HDF5's filters shrink data (deflate, 1032), and some; in one block we read
 * at most this many values. */
enum { FILTER_MOST = 1100, BLOCK = 1 << 16 };

/* HDF5 prints its errors unless told not to. */
typedef struct quiet {
    H5E_auto2_t print;
    void *data;
} quiet;

static quiet silence(void)
{
    quiet q = {0};
    H5Eget_auto2(H5E_DEFAULT, &q.print, &q.data);
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    return q;
}

static void restore(quiet q)
{
    H5Eset_auto2(H5E_DEFAULT, q.print, q.data);
}

/* The innermost reason on HDF5's error stack. */
static herr_t on_error(unsigned n, const H5E_error2_t *e, void *text)
{
    if (n == 0 && e->desc) snprintf(text, 160, "%s", e->desc);
    return 0;
}

static const char *reason(char text[160])
{
    snprintf(text, 160, "unknown reason");
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, on_error, text);
    return text;
}

/* At most so many bytes of values are in the file: what the dataset says it stores, but not
 * more than the file has; times what the filters of chunks may have shrunk. 0 if a chunk,
 * which HDF5 holds in memory as a whole, would be larger than that. */
static size_t most_bytes(hid_t file, hid_t set, size_t bytes)
{
    hsize_t stored = H5Dget_storage_size(set), size = 0, chunk[3] = {1, 1, 1};
    hid_t creation = H5Dget_create_plist(set);
    bool chunked = creation >= 0 && H5Pget_layout(creation) == H5D_CHUNKED;
    bool filtered = chunked && H5Pget_nfilters(creation) > 0;
    if (chunked && H5Pget_chunk(creation, 3, chunk) < 0) chunk[0] = 0;
    if (creation >= 0) H5Pclose(creation);
    if (H5Fget_filesize(file, &size) < 0) return 0;
    stored = stored < size ? stored : size;
    size_t most = (size_t)stored * (filtered ? FILTER_MOST : 1), left = most / bytes;
    for (int a = 0; a < 3; a++)
        left = chunk[a] > 0 ? left / (size_t)chunk[a] : 0;
    return left > 0 ? most : 0;
}

/* Checked against what is stored before anything is allocated. */
static ph_status find_shape(hid_t file, hid_t set, size_t bytes, ph_voxel_data *v,
                            ph_error *err)
{
    ph_status st = PH_OK;
    hsize_t dims[3] = {1, 1, 1};
    hid_t space = H5Dget_space(set);
    int rank = space >= 0 ? H5Sget_simple_extent_ndims(space) : -1;
    PH_CHECK(rank >= 1 && rank <= 3, PH_EINVAL,
             "the dataset has %d axes; 1 to 3 are wanted", rank);
    PH_CHECK(H5Sget_simple_extent_dims(space, dims, NULL) == rank, PH_EINVAL,
             "the shape of the dataset cannot be read");
    v->rank = rank;
    for (int a = 0; a < 3; a++) {
        PH_CHECK(dims[a] <= PTRDIFF_MAX, PH_EINVAL, "the dataset is too large");
        v->n[a] = (ptrdiff_t)dims[a];
    }
    PH_TRY(ph_i_voxels_alloc(v, bytes, most_bytes(file, set, bytes), err));
out:
    if (space >= 0) H5Sclose(space);
    return st;
}

static ph_status check_type(hid_t set, size_t *bytes, ph_error *err)
{
    ph_status st = PH_OK;
    hid_t type = H5Dget_type(set);
    H5T_class_t class = type >= 0 ? H5Tget_class(type) : H5T_NO_CLASS;
    *bytes = type >= 0 ? H5Tget_size(type) : 0;
    PH_CHECK(class == H5T_INTEGER || class == H5T_ENUM || class == H5T_FLOAT, PH_EINVAL,
             "the dataset does not hold whole numbers");
    PH_CHECK(*bytes >= 1 && *bytes <= 16, PH_EINVAL, "its numbers have %zu bytes",
             *bytes);
out:
    if (type >= 0) H5Tclose(type);
    return st;
}

/* Blocks of planes across the first axis. */
static ph_status read_values(hid_t set, ph_voxel_data *v, ph_error *err)
{
    ph_status st = PH_OK;
    char text[160];
    double *block = NULL;
    hid_t memory = -1, space = H5Dget_space(set);
    ptrdiff_t plane = v->n[1] * v->n[2], planes = plane < BLOCK ? BLOCK / plane : 1;
    planes = planes < v->n[0] ? planes : v->n[0];
    PH_CHECK(space >= 0, PH_EINVAL, "the dataset cannot be read: %s", reason(text));
    PH_ALLOC(block, planes * plane, "a block of voxels");
    for (ptrdiff_t i = 0; i < v->n[0]; i += planes) {
        ptrdiff_t now = planes < v->n[0] - i ? planes : v->n[0] - i;
        hsize_t start[3] = {(hsize_t)i, 0, 0};
        hsize_t count[3] = {(hsize_t)now, (hsize_t)v->n[1], (hsize_t)v->n[2]};
        H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, count, NULL);
        memory = H5Screate_simple(v->rank, count, NULL);
        herr_t bad = H5Dread(set, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, block);
        H5Sclose(memory);
        PH_CHECK(bad >= 0, PH_EINVAL, "the dataset cannot be read: %s", reason(text));
        for (ptrdiff_t k = 0; k < now * plane; k++)
            PH_TRY(ph_i_voxel_value(v, i * plane + k, block[k], err));
    }
out:
    if (space >= 0) H5Sclose(space);
    free(block);
    return st;
}

static ph_status read_dataset(hid_t file, const char *dataset, ph_voxel_data *v,
                              ph_error *err)
{
    ph_status st = PH_OK;
    char text[160];
    hid_t set = -1;
    PH_CHECK(file >= 0, PH_EINVAL, "is not an HDF5 file that can be read: %s",
             reason(text));
    PH_CHECK(dataset && dataset[0], PH_EINVAL, "the path of the dataset is missing");
    set = H5Dopen2(file, dataset, H5P_DEFAULT);
    PH_CHECK(set >= 0, PH_EINVAL, "has no dataset '%s': %s", dataset, reason(text));
    size_t bytes;
    PH_TRY(check_type(set, &bytes, err));
    PH_TRY(find_shape(file, set, bytes, v, err));
    PH_TRY(read_values(set, v, err));
out:
    if (set >= 0) H5Dclose(set);
    return st;
}

ph_status ph_i_hdf5_read(const char *path, const char *dataset, ph_voxel_data *v,
                         ph_error *err)
{
    ph_status st = PH_OK;
    FILE *f = fopen(path, "rb");
    if (!f) return PH_FAIL(err, PH_EIO, "cannot be opened");
    fclose(f);
    quiet q = silence();
    hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
    st = read_dataset(file, dataset, v, err);
    if (file >= 0) H5Fclose(file);
    restore(q);
    return st;
}

ph_status ph_i_hdf5_parse(ph_bytes bytes, const char *dataset, ph_voxel_data *v,
                          ph_error *err)
{
    ph_status st = PH_OK;
    quiet q = silence();
    hid_t file = -1, access = H5Pcreate(H5P_FILE_ACCESS);
    void *copy = malloc(bytes.size ? bytes.size : 1);
    PH_CHECK(access >= 0 && copy, PH_ENOMEM, "no memory for an HDF5 file");
    memcpy(copy, bytes.data, bytes.size);
    H5Pset_fapl_core(access, 1 << 16, false);
    H5Pset_file_image(access, copy, bytes.size);
    file = H5Fopen("image", H5F_ACC_RDONLY, access);
    PH_TRY(read_dataset(file, dataset, v, err));
out:
    if (file >= 0) H5Fclose(file);
    if (access >= 0) H5Pclose(access);
    free(copy);
    restore(q);
    return st;
}

ph_status ph_i_hdf5_write(const char *path, const char *dataset, int rank,
                          const ptrdiff_t n[3], const uint16_t *values, ph_error *err)
{
    ph_status st = PH_OK;
    char text[160];
    const hsize_t dims[3] = {(hsize_t)n[0], (hsize_t)n[1], (hsize_t)n[2]};
    quiet q = silence();
    hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), set = -1;
    hid_t space = H5Screate_simple(rank, dims, NULL), groups = H5Pcreate(H5P_LINK_CREATE);
    hid_t timeless = H5Pcreate(H5P_DATASET_CREATE); /* equal contents, equal files */
    PH_CHECK(file >= 0, PH_EIO, "cannot be written: %s", reason(text));
    PH_CHECK(space >= 0 && groups >= 0 && timeless >= 0, PH_ENOMEM,
             "no memory for an HDF5 file");
    H5Pset_create_intermediate_group(groups, 1);
    H5Pset_obj_track_times(timeless, false);
    set = H5Dcreate2(file, dataset && dataset[0] ? dataset : "/phase", H5T_STD_U16LE,
                     space, groups, timeless, H5P_DEFAULT);
    PH_CHECK(set >= 0, PH_EIO, "cannot be written: %s", reason(text));
    PH_CHECK(H5Dwrite(set, H5T_NATIVE_UINT16, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0,
             PH_EIO, "cannot be written: %s", reason(text));
out:
    if (set >= 0 && H5Dclose(set) < 0 && st == PH_OK)
        st = PH_FAIL(err, PH_EIO, "not closed");
    if (groups >= 0) H5Pclose(groups);
    if (timeless >= 0) H5Pclose(timeless);
    if (space >= 0) H5Sclose(space);
    if (file >= 0 && H5Fclose(file) < 0 && st == PH_OK)
        st = PH_FAIL(err, PH_EIO, "cannot be closed: %s", reason(text));
    restore(q);
    return st;
}
