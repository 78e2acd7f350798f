/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Phases and owners in one .h5 file, and the owners back again. */
#include "core/check.h"
#include "perihom_rve.h"

#include <hdf5.h>

#include <errno.h>
#include <string.h>

static ph_status add_owners(const char *path, int rank, const ptrdiff_t n[3],
                            const int32_t *owner, ph_error *err)
{
    ph_status st = PH_OK;
    const hsize_t dims[3] = {(hsize_t)n[0], (hsize_t)n[1], (hsize_t)n[2]};
    hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT), set = -1;
    hid_t space = H5Screate_simple(rank, dims, NULL);
    hid_t timeless = H5Pcreate(H5P_DATASET_CREATE); /* equal contents, equal files */
    PH_CHECK(file >= 0 && space >= 0 && timeless >= 0, PH_EIO, "cannot be written");
    H5Pset_obj_track_times(timeless, false);
    set = H5Dcreate2(file, "/owner", H5T_STD_I32LE, space, H5P_DEFAULT, timeless,
                     H5P_DEFAULT);
    PH_CHECK(set >= 0 && H5Dwrite(set, H5T_NATIVE_INT32, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                                  owner) >= 0,
             PH_EIO, "cannot be written");
out:
    if (set >= 0) H5Dclose(set);
    if (timeless >= 0) H5Pclose(timeless);
    if (space >= 0) H5Sclose(space);
    if (file >= 0 && H5Fclose(file) < 0 && st == PH_OK)
        st = PH_FAIL(err, PH_EIO, "cannot be closed");
    return st;
}

/* HDF5 prints its errors unless told not to; restored by the caller. */
static void silence(H5E_auto2_t *print, void **data)
{
    H5Eget_auto2(H5E_DEFAULT, print, data);
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
}

ph_status ph_rve_write_owners(const char *path, const ph_microstructure *m, ph_error *err)
{
    PH_GIVEN(path && m);
    ph_status st = PH_OK;
    char *part = NULL;
    H5E_auto2_t print;
    void *data;
    int rank = m->grid.kinematics == PH_SPACE ? 3 : 2;
    silence(&print, &data);
    PH_CHECK(m->owner, PH_EINVAL, "the microstructure has no owners");
    PH_ALLOC(part, strlen(path) + 16, "a path");
    snprintf(part, strlen(path) + 16, "%s.part.h5", path);
    PH_TRY(ph_rve_write_voxels(part, "/phase", NULL, rank, m->grid.n, m->phase, err));
    PH_TRY(add_owners(part, rank, m->grid.n, m->owner, err));
    PH_CHECK(rename(part, path) == 0, PH_EIO, "cannot be written: %s", strerror(errno));
out:
    if (st != PH_OK && part) remove(part);
    if (st != PH_OK) ph_error_prefix(err, "%s: ", path);
    free(part);
    H5Eset_auto2(H5E_DEFAULT, print, data);
    return st;
}

ph_status ph_rve_read_owners(const char *path, const char *dataset, int dimensions,
                             const ptrdiff_t n[3], int32_t *owner, ph_error *err)
{
    PH_GIVEN(path && dataset && n && owner);
    ph_status st = PH_OK;
    H5E_auto2_t print;
    void *data;
    hsize_t dims[3] = {1, 1, 1};
    silence(&print, &data);
    hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT), set = -1, space = -1;
    PH_CHECK(file >= 0, PH_EIO, "%s: is not an HDF5 file that can be read", path);
    set = H5Dopen2(file, dataset, H5P_DEFAULT);
    PH_CHECK(set >= 0, PH_EINVAL, "%s: has no dataset '%s'", path, dataset);
    space = H5Dget_space(set);
    bool fits = H5Sget_simple_extent_ndims(space) == dimensions &&
                H5Sget_simple_extent_dims(space, dims, NULL) == dimensions;
    for (int a = 0; a < dimensions; a++)
        fits = fits && dims[a] == (hsize_t)n[a];
    PH_CHECK(fits, PH_EINVAL, "%s: '%s' does not have the cells of the phases", path,
             dataset);
    PH_CHECK(H5Dread(set, H5T_NATIVE_INT32, H5S_ALL, H5S_ALL, H5P_DEFAULT, owner) >= 0,
             PH_EINVAL, "%s: '%s' cannot be read", path, dataset);
    for (ptrdiff_t c = 0; c < n[0] * n[1] * (dimensions == 3 ? n[2] : 1); c++)
        PH_CHECK(owner[c] >= 0, PH_EINVAL, "%s: '%s' has a negative owner", path,
                 dataset);
out:
    if (space >= 0) H5Sclose(space);
    if (set >= 0) H5Dclose(set);
    if (file >= 0) H5Fclose(file);
    H5Eset_auto2(H5E_DEFAULT, print, data);
    return st;
}
