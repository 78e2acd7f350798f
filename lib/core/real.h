/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One source, two precisions. NAME.c is compiled as it is, in double, and by NAME_single.c,
 * which defines PH_SINGLE and includes it: `real` is then float, and PH_REAL adds _single to
 * the names of functions. Sums and what is handed over by value stay double. */
#ifndef PH_CORE_REAL_H
#define PH_CORE_REAL_H

#include <stdint.h>

#ifdef PH_SINGLE
typedef float real;
typedef int32_t real_mask; /* of the same size */
#define PH_REAL(name) name##_single
#else
typedef double real;
typedef int64_t real_mask;
#define PH_REAL(name) name
#endif

#endif
