/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The first four bytes choose type and shape, the rest is the .raw file. */
#include "voxels.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const char *const types[4] = {"uint8", "uint16", "int32", "float"};
    if (size < 4) return 0;
    ph_error err = PH_ERROR_INIT;
    ph_voxel_data v = {0};
    ptrdiff_t n[3] = {data[1], data[2], data[3]};
    if (data[0] & 4) n[data[0] % 3] = PTRDIFF_MAX / (1 + data[1]);
    if (data[0] & 8) n[data[0] % 3] = -1;
    ph_status st =
        ph_i_raw_parse((ph_bytes){data + 4, size - 4}, types[data[0] & 3], n, &v, &err);
    if (st == PH_OK ? !v.values : !err.msg[0]) abort();
    free(v.values);
    return 0;
}
