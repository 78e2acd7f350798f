/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "progress.h"

#include "interrupt.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { BAR_CELLS = 24 };

double progress_clock(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

progress_style progress_choose(bool quiet, bool verbose, bool forced)
{
    if (quiet) return PROGRESS_NONE;
    if (verbose) return PROGRESS_VERBOSE;
    return forced || isatty(STDERR_FILENO) ? PROGRESS_BAR : PROGRESS_LINES;
}

void progress_start(progress *p, progress_style style)
{
    *p = (progress){.style = style, .start = progress_clock()};
    p->shown = style == PROGRESS_BAR ? -HUGE_VAL : p->start; /* the bar shows at once */
}

double progress_share(double first, double residual, double tolerance)
{
    if (!(residual > 0) || !(tolerance > 0) || !(first > tolerance)) return 0.0;
    double share = log(first / residual) / log(first / tolerance);
    return fmin(fmax(share, 0.0), 1.0);
}

void progress_time(char *text, size_t size, double seconds)
{
    if (!(seconds >= 0) || seconds > 1e8)
        snprintf(text, size, "--:--");
    else if (seconds < 3600)
        snprintf(text, size, "%02d:%02d", (int)seconds / 60, (int)seconds % 60);
    else
        snprintf(text, size, "%d:%02d h", (int)seconds / 3600, (int)seconds / 60 % 60);
}

static void draw_bar(progress *p, const ph_progress *now, double done, double to_go)
{
    char bar[BAR_CELLS + 1], left[32];
    int full = (int)(done * BAR_CELLS);
    memset(bar, '-', BAR_CELLS);
    memset(bar, '#', (size_t)full);
    bar[BAR_CELLS] = 0;
    progress_time(left, sizeof left, to_go);
    int width =
        fprintf(stderr,
                "\r[%s] %3.0f %%  load %d/%d  iteration %d  residual %.1e  ETA %s", bar,
                100 * done, now->load, now->loads, now->iteration, now->residual, left) -
        1;
    if (width < p->width) fprintf(stderr, "%*s", p->width - width, "");
    p->width = width;
    fflush(stderr);
}

static void show(progress *p, const ph_progress *now, double t)
{
    int loads = now->loads > 0 ? now->loads : 1;
    double in_load = progress_share(p->first, now->residual, now->tolerance);
    double done = fmin(fmax((now->load - 1 + in_load) / loads, 0.0), 1.0);
    double to_go = done > 0 ? (t - p->start) * (1 - done) / done : -1;
    p->shown = t;
    if (p->style == PROGRESS_BAR)
        draw_bar(p, now, done, to_go);
    else
        fprintf(stderr, "load %d of %d: iteration %d, residual %.2e, %.1f s\n", now->load,
                now->loads, now->iteration, now->residual, t - p->start);
}

bool progress_step(void *user, const ph_progress *now)
{
    progress *p = user;
    if (now->load != p->load) {
        p->load = now->load;
        p->first = now->residual;
    }
    static const double every[] = {HUGE_VAL, 5.0, 0.0, 0.1}; /* seconds, by style */
    double t = progress_clock();
    if (t - p->shown >= every[p->style]) show(p, now, t);
    return interrupt_signal() == 0;
}

void progress_end(progress *p)
{
    if (p->width > 0) fprintf(stderr, "\r%*s\r", p->width, "");
    p->width = 0;
}
