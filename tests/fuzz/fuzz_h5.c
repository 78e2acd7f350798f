/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Any bytes as a .h5 file: read or refused with a reason, nothing else. */
#include "voxels.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    ph_error err = PH_ERROR_INIT;
    ph_voxel_data v = {0};
    ph_status st = ph_i_hdf5_parse((ph_bytes){data, size}, "/phase", &v, &err);
    if (st == PH_OK ? !v.values : !err.msg[0]) abort();
    free(v.values);
    return 0;
}
