/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PERIHOM_ERROR_H
#define PERIHOM_ERROR_H

#include <stdbool.h>
#include <stddef.h>

#if defined(__GNUC__)
#define PH_API               __attribute__((visibility("default")))
#define PH_PRINTF(fmt, args) __attribute__((format(printf, fmt, args)))
#else
#define PH_API
#define PH_PRINTF(fmt, args)
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Every status: name, number, text, exit code of the command-line tool. */
#define PH_STATUS_LIST(X)                                                                \
    X(PH_OK, 0, "done", 0)                                                               \
    X(PH_EINTERNAL, 1, "internal error", 1)                                              \
    X(PH_EUSAGE, 2, "wrong usage", 2)                                                    \
    X(PH_EINVAL, 3, "input not admissible", 3)                                           \
    X(PH_EUNPHYSICAL, 4, "physically not admissible", 3)                                 \
    X(PH_ENOCONV, 5, "not converged", 4)                                                 \
    X(PH_ESINGULAR, 6, "singular", 4)                                                    \
    X(PH_ENOMEM, 7, "out of memory", 5)                                                  \
    X(PH_EIO, 8, "file could not be read or written", 5)                                 \
    X(PH_EPARTIAL, 9, "some cases of a batch failed", 6)                                 \
    X(PH_ECANCELLED, 10, "interrupted", 130)

typedef enum ph_status {
#define PH_STATUS_ENUM(name, number, text, code) name = number,
    PH_STATUS_LIST(PH_STATUS_ENUM)
#undef PH_STATUS_ENUM
} ph_status;

/** What went wrong, by value: the caller puts it on the stack, or passes NULL.
 *
 *  The first failure wins; callers up the stack only put context in front of `msg`.
 *  Works when memory is exhausted, needs no release, and is never shared. */
typedef struct ph_error {
    ph_status status;
    const char *file; /* source file of the failed check */
    int line;
    int iteration;   /* of an iterative solver, else 0 */
    double residual; /* relative, where a solver failed, else 0 */
    char msg[512];
    char key[80]; /* of a case, that the failure is about: "model.horizon"; else empty */
} ph_error;

#define PH_ERROR_INIT                                                                    \
    {                                                                                    \
        PH_OK, NULL, 0, 0, 0.0, "", ""                                                   \
    }

/** Text of a status, e.g. "not converged"; never NULL. */
PH_API const char *ph_status_text(ph_status status);
/** Exit code of the command-line tool for a status. */
PH_API int ph_status_exit_code(ph_status status);

/** Fill `err` (may be NULL, kept if it already holds a failure) and return `status`. */
PH_API ph_status ph_error_set(ph_error *err, ph_status status, const char *file, int line,
                              const char *fmt, ...) PH_PRINTF(5, 6);
/** Put context before the message: "phase 'fibre': " + msg. No effect without a failure. */
PH_API void ph_error_prefix(ph_error *err, const char *fmt, ...) PH_PRINTF(2, 3);

/** Say which key of a case the failure is about, "materials.%s.nu"; the first stays. */
PH_API void ph_error_about(ph_error *err, const char *fmt, ...) PH_PRINTF(2, 3);

/** Where a long computation is; handed to the progress callback. */
typedef struct ph_progress {
    const char *stage; /* "load 2 of 6", ... */
    int load, loads;   /* 1-based load case and their number */
    int iteration;
    double residual;  /* relative, now */
    double tolerance; /* where it will stop */
} ph_progress;

/** How a call runs: threads, and one callback for progress and cancelling.
 *
 *  `progress` returns false to stop; the call then returns PH_ECANCELLED.
 *  NULL or a zeroed struct: silent, one thread per processor that OpenMP offers. */
typedef struct ph_ctx {
    bool (*progress)(void *user, const ph_progress *now);
    void *user;
    int threads; /* 0: as many as OpenMP offers */
} ph_ctx;

#ifdef __cplusplus
}
#endif
#endif
