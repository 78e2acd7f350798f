/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where a solve is, on stderr: a bar with the time to go, or plain lines. */
#ifndef TOOLS_PROGRESS_H
#define TOOLS_PROGRESS_H

#include <perihom/error.h>

#include <stddef.h>

typedef enum progress_style {
    PROGRESS_NONE,
    PROGRESS_LINES,   /* a line every few seconds */
    PROGRESS_VERBOSE, /* a line an iteration */
    PROGRESS_BAR
} progress_style;

/** State between two calls of the callback. */
typedef struct progress {
    progress_style style;
    double start, shown; /* seconds of the clock */
    int load;
    double first; /* residual at the start of this load */
    int width;    /* of the bar on the screen, to wipe it */
} progress;

/** The style for a verb's options: -q, -v, --progress, and whether stderr is a terminal. */
progress_style progress_choose(bool quiet, bool verbose, bool forced);
void progress_start(progress *p, progress_style style);
/** The callback of ph_ctx, `user` a progress; false as soon as a signal arrived. */
bool progress_step(void *user, const ph_progress *now);
/** Wipe the bar. */
void progress_end(progress *p);
/** "mm:ss" or "h:mm h"; "--:--" where unknown. */
void progress_time(char *text, size_t size, double seconds);
/** Share of one load that is done, from the logarithm of its residual; 0..1. */
double progress_share(double first, double residual, double tolerance);

/** Wall clock, seconds since some moment. */
double progress_clock(void);

#endif
