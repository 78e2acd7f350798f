/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Arrays of the solver: aligned for SIMD, counted in bytes. */
#ifndef PH_CORE_MEMORY_H
#define PH_CORE_MEMORY_H

#include "core/check.h"

/* Elements that a thread takes at a time in a loop over cells or modes. The compiler rounds
 * the body and the tail of a loop differently (which product of a b + c d is fused), so where
 * a piece begins must not depend on the number of threads. */
enum { PH_CHUNK = 2048 };

/** Bytes now and at the most, of one computation. */
typedef struct ph_meter {
    size_t bytes, peak;
} ph_meter;

/** Zeroed array of `count` doubles on a 64-byte boundary, counted in `meter`.
 *  NULL when memory is exhausted. */
double *ph_i_doubles_new(ph_meter *meter, size_t count);
/** Release and null; NULL-safe. `count` as in _new. */
void ph_i_doubles_free(ph_meter *meter, double **p, size_t count);

#define PH_DOUBLES(p, meter, count, what)                                                \
    do {                                                                                 \
        (p) = ph_i_doubles_new((meter), (count));                                        \
        PH_CHECK((p) != NULL, PH_ENOMEM, "no memory for %s (%zu bytes)", (what),         \
                 (size_t)(count) * sizeof(double));                                      \
    } while (0)

#endif
