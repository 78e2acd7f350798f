/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/memory.h"

#include <stdint.h>
#include <string.h>

enum { ALIGNMENT = 64 };

double *ph_i_doubles_new(ph_meter *meter, size_t count)
{
    if (count > (SIZE_MAX - ALIGNMENT) / sizeof(double)) return NULL;
    size_t bytes = (count * sizeof(double) + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
    if (bytes == 0) bytes = ALIGNMENT;
    double *p = aligned_alloc(ALIGNMENT, bytes);
    if (!p) return NULL;
    memset(p, 0, bytes);
    if (meter) {
        meter->bytes += count * sizeof(double);
        if (meter->bytes > meter->peak) meter->peak = meter->bytes;
    }
    return p;
}

void ph_i_doubles_free(ph_meter *meter, double **p, size_t count)
{
    if (!p || !*p) return;
    free(*p);
    *p = NULL;
    if (meter) meter->bytes -= count * sizeof(double);
}
