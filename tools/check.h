/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The error idiom of the library for tools, which see only its public headers: a function
 * that can fail has `ph_status st = PH_OK`, the parameter `ph_error *err`, a label `out`. */
#ifndef TOOLS_CHECK_H
#define TOOLS_CHECK_H

#include <perihom/error.h>

#include <stdio.h>
#include <stdlib.h>

#define PH_TRY(call)                                                                     \
    do {                                                                                 \
        st = (call);                                                                     \
        if (st != PH_OK) goto out;                                                       \
    } while (0)

#define PH_CHECK(cond, status, ...)                                                      \
    do {                                                                                 \
        if (cond) {                                                                      \
        } else {                                                                         \
            st = ph_error_set(err, (status), __FILE__, __LINE__, __VA_ARGS__);           \
            goto out;                                                                    \
        }                                                                                \
    } while (0)

#endif
