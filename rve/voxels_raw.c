/* SPDX-License-Identifier: GPL-3.0-or-later */
/* .raw: nothing but the values, little-endian, last axis fastest. */
#include "core/check.h"
#include "voxels.h"

#include <string.h>

static int bytes_of(const char *type)
{
    static const struct {
        const char *name;
        int bytes;
    } types[] = {{"uint8", 1}, {"uint16", 2}, {"int32", 4}};
    for (int i = 0; i < 3; i++)
        if (type && strcmp(type, types[i].name) == 0) return types[i].bytes;
    return 0;
}

ph_status ph_i_raw_parse(ph_bytes file, const char *type, const ptrdiff_t n[3],
                         ph_voxel_data *v, ph_error *err)
{
    ph_status st = PH_OK;
    int bytes = bytes_of(type);
    PH_CHECK(bytes, PH_EINVAL, "type must be uint8, uint16 or int32, got '%s'",
             type ? type : "");
    v->rank = 3;
    for (int a = 0; a < 3; a++) {
        v->n[a] = n[a];
        PH_CHECK(n[a] > 0, PH_EINVAL,
                 "the number of nodes must be given for a .raw file");
    }
    PH_TRY(ph_i_voxels_alloc(v, (size_t)bytes, file.size, err));
    ptrdiff_t cells = n[0] * n[1] * n[2];
    PH_CHECK((size_t)cells * (size_t)bytes == file.size, PH_EINVAL,
             "has %zu bytes, %td x %td x %td voxels of %s take %zu", file.size, n[0],
             n[1], n[2], type, (size_t)cells * (size_t)bytes);
    for (ptrdiff_t i = 0; i < cells; i++) {
        const unsigned char *p = file.data + i * bytes;
        uint32_t value = p[0];
        if (bytes > 1) value |= (uint32_t)p[1] << 8;
        if (bytes > 2) value |= (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
        double x =
            bytes == 4 && value >> 31 ? (double)value - 4294967296.0 : (double)value;
        PH_TRY(ph_i_voxel_value(v, i, x, err));
    }
out:
    return st;
}
