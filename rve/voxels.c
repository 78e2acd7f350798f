/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/check.h"
#include "perihom_rve.h"

ph_status ph_rve_read_voxels(const char *path, const char *dataset, const char *type,
                             int dimensions, ptrdiff_t n[3], uint16_t **values,
                             ph_error *err)
{
    (void)dataset, (void)type, (void)dimensions, (void)n;
    *values = NULL;
    return PH_FAIL(err, PH_EINVAL, "%s: voxel files are not read yet", path);
}
