/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The error idiom: a function that can fail has `ph_status st = PH_OK`, the parameter
 * `ph_error *err` and one label `out`. Pointers start NULL, frees accept NULL. */
#ifndef PH_CORE_CHECK_H
#define PH_CORE_CHECK_H

#include <perihom/error.h>

#include <stdio.h>
#include <stdlib.h>

#define PH_FAIL(err, status, ...)                                                        \
    ph_error_set((err), (status), __FILE__, __LINE__, __VA_ARGS__)

#define PH_TRY(call)                                                                     \
    do {                                                                                 \
        st = (call);                                                                     \
        if (st != PH_OK) goto out;                                                       \
    } while (0)

#define PH_CHECK(cond, status, ...)                                                      \
    do {                                                                                 \
        if (cond) {                                                                      \
        } else {                                                                         \
            st = PH_FAIL(err, (status), __VA_ARGS__);                                    \
            goto out;                                                                    \
        }                                                                                \
    } while (0)

/* The same about a key of a case, "model.horizon": who has the case says where it stands. */
#define PH_CHECK_KEY(cond, status, key, ...)                                             \
    do {                                                                                 \
        if (cond) {                                                                      \
        } else {                                                                         \
            st = PH_FAIL(err, (status), __VA_ARGS__);                                    \
            ph_error_about(err, "%s", (key));                                            \
            goto out;                                                                    \
        }                                                                                \
    } while (0)

/* First of a public function: the arguments that must be there are. Nothing is held yet. */
#define PH_GIVEN(cond)                                                                   \
    do {                                                                                 \
        if (cond) {                                                                      \
        } else                                                                           \
            return PH_FAIL(err, PH_EINVAL, "an argument is missing: %s", #cond);         \
    } while (0)

/* Our own mistakes; kept in release builds because it is cheap. */
#define PH_ASSERT(cond)                                                                  \
    do {                                                                                 \
        if (cond) {                                                                      \
        } else {                                                                         \
            st = PH_FAIL(err, PH_EINTERNAL, "assertion failed: %s", #cond);              \
            goto out;                                                                    \
        }                                                                                \
    } while (0)

/* calloc into p, or fail with what the memory was for. */
#define PH_ALLOC(p, count, what)                                                         \
    do {                                                                                 \
        (p) = calloc((size_t)(count) > 0 ? (size_t)(count) : 1, sizeof *(p));            \
        PH_CHECK((p) != NULL, PH_ENOMEM, "no memory for %s (%zu x %zu bytes)", (what),   \
                 (size_t)(count), sizeof *(p));                                          \
    } while (0)

#endif
