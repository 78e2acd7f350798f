/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PERIHOM_VERSION_H
#define PERIHOM_VERSION_H

#include <perihom/error.h>

#define PH_VERSION_MAJOR 0
#define PH_VERSION_MINOR 1
#define PH_VERSION_PATCH 0
#define PH_VERSION       "0.1.0"

#ifdef __cplusplus
extern "C" {
#endif

/** Version of the library that runs, e.g. "0.1.0". */
PH_API const char *ph_version(void);
/** Git revision it was built from, or "unknown". */
PH_API const char *ph_git_revision(void);
/** Name and version of dependency `i`; NULL after the last. */
PH_API const char *ph_dependency(int i, const char **version);
/** Compiler it was built with. */
PH_API const char *ph_compiler(void);

#ifdef __cplusplus
}
#endif
#endif
