/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Readers and writers of voxel files: one format a file, parsed from memory. */
#ifndef PH_RVE_VOXELS_H
#define PH_RVE_VOXELS_H

#include "perihom_rve.h"

/* What a file holds: values [n[0]][n[1]][n[2]], axes beyond `rank` are 1. Zeroed to begin
 * with; the values are malloc'd. */
typedef struct ph_voxel_data {
    int rank;
    ptrdiff_t n[3];
    uint16_t *values;
} ph_voxel_data;

/* A file in memory. */
typedef struct ph_bytes {
    const unsigned char *data;
    size_t size;
} ph_bytes;

/* Each fails with PH_EINVAL on what it does not understand and leaves v->values NULL or for
 * the caller to free. */
ph_status ph_i_npy_parse(ph_bytes file, ph_voxel_data *v, ph_error *err);
ph_status ph_i_png_parse(ph_bytes file, ph_voxel_data *v, ph_error *err);
/* n must be given. */
ph_status ph_i_raw_parse(ph_bytes file, const char *type, const ptrdiff_t n[3],
                         ph_voxel_data *v, ph_error *err);
ph_status ph_i_hdf5_parse(ph_bytes file, const char *dataset, ph_voxel_data *v,
                          ph_error *err);
ph_status ph_i_hdf5_read(const char *path, const char *dataset, ph_voxel_data *v,
                         ph_error *err);
ph_status ph_i_hdf5_write(const char *path, const char *dataset, int rank,
                          const ptrdiff_t n[3], const uint16_t *values, ph_error *err);

/* Cells of v->n, each of `bytes` bytes in `available` bytes of file; allocates the values.
 * Fails if the file is too short, or an axis is empty. */
ph_status ph_i_voxels_alloc(ph_voxel_data *v, size_t bytes, size_t available,
                            ph_error *err);
/* A number of the file as a voxel value; says which one is none. */
ph_status ph_i_voxel_value(const ph_voxel_data *v, ptrdiff_t cell, double value,
                           ph_error *err);

#endif
