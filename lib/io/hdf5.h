/* SPDX-License-Identifier: GPL-3.0-or-later */
/* HDF5 with our errors: its own printing is off between begin and end, and its message
 * goes into ph_error. */
#ifndef PH_IO_HDF5_H
#define PH_IO_HDF5_H

#include "core/check.h"

#include <hdf5.h>

/** HDF5's automatic error printing, as it was before. */
typedef struct ph_i_hdf5_quiet {
    H5E_auto2_t print;
    void *user;
} ph_i_hdf5_quiet;
void ph_i_hdf5_begin(ph_i_hdf5_quiet *quiet);
void ph_i_hdf5_end(const ph_i_hdf5_quiet *quiet);

/** PH_EIO (PH_ENOMEM where HDF5 had no memory) with "cannot <verb> '<path>': <the innermost
 *  message of HDF5's error stack>". */
ph_status ph_i_hdf5_error(ph_error *err, const char *verb, const char *path);

/* Calls that give a negative number when they fail; `path` must be in scope. */
#define PH_HDF5(call, verb)                                                              \
    do {                                                                                 \
        if ((call) < 0) {                                                                \
            st = ph_i_hdf5_error(err, (verb), path);                                     \
            goto out;                                                                    \
        }                                                                                \
    } while (0)

/** Attributes of `object`; `path` is for messages. */
ph_status ph_i_hdf5_put_text(hid_t object, const char *name, const char *text,
                             const char *path, ph_error *err);
ph_status ph_i_hdf5_put_doubles(hid_t object, const char *name, int count,
                                const double *x, const char *path, ph_error *err);
ph_status ph_i_hdf5_put_ints(hid_t object, const char *name, int count, const int *x,
                             const char *path, ph_error *err);
/** In one piece; in chunks of about 1 MiB; in such chunks, compressed. */
typedef enum ph_i_storage { PH_I_PLAIN, PH_I_CHUNKED, PH_I_DEFLATED } ph_i_storage;
/** Whole dataset `name` under `object`. @param[in] type in memory and in the file. */
ph_status ph_i_hdf5_put_array(hid_t object, const char *name, hid_t type, int rank,
                              const hsize_t *dims, ph_i_storage how, const void *data,
                              const char *path, ph_error *err);

/** Read them back: the shape must be as given, the numbers are converted to `type`. */
ph_status ph_i_hdf5_get_text(hid_t object, const char *name, char *text, size_t size,
                             const char *path, ph_error *err);
ph_status ph_i_hdf5_get_attribute(hid_t object, const char *name, hid_t type, int count,
                                  void *x, const char *path, ph_error *err);
ph_status ph_i_hdf5_get_array(hid_t object, const char *name, hid_t type, int rank,
                              const hsize_t *dims, void *data, const char *path,
                              ph_error *err);

#endif
