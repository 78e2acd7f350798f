/* SPDX-License-Identifier: GPL-3.0-or-later */
/* HDF5 does not survive a full disk: a flush that fails leaves the file open inside the
 * library for good ("slist already enabled", 1.10.8). So we give it a file driver whose
 * writes never fail: it keeps the first error for us and drops what follows. */
#ifndef PH_IO_HDF5_SINK_H
#define PH_IO_HDF5_SINK_H

#include <hdf5.h>

typedef struct ph_i_hdf5_sink {
    int failed; /* errno of the first write that failed, or 0; look after every array */
} ph_i_hdf5_sink;

/** File access properties for H5Fcreate; close with H5Pclose. Negative on failure. `sink`
 *  must outlive the file. */
hid_t ph_i_hdf5_sink_access(ph_i_hdf5_sink *sink);

#endif
