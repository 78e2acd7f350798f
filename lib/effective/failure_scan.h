/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which bonds are the nearest to breaking, for a displacement that is linear in the load. */
#ifndef PH_EFFECTIVE_FAILURE_SCAN_H
#define PH_EFFECTIVE_FAILURE_SCAN_H

#include "effective/failure.h"

/** A bond that is to break. */
typedef struct ph_picked {
    ptrdiff_t x, b, y;
    double pull; /* xi . (macro xi + u(y) - u(x)) for the unit load */
} ph_picked;

typedef struct ph_scan {
    const ph_run *run;
    const ph_strengths *strengths;
    const double *macro; /* [ns] Mandel, of the unit load */
    ptrdiff_t cells, nhalf;
    int *half;        /* [nhalf] one bond of each pair */
    int32_t *wrap[3]; /* cell number i - reach .. n + reach of each axis */
    double *critical; /* [cells][nhalf] with scatter, else NULL */
    double weakest;   /* least critical stretch of all */
    double *stretch;  /* [nhalf] xi . macro xi, as last scanned */
    double *least;    /* [cells] least critical load of the bonds of a cell */
    ptrdiff_t npicked, room;
    ph_picked *picked;
} ph_scan;

ph_status ph_i_scan_new(const ph_run *run, const ph_strengths *strengths,
                        const double *macro, ph_scan **out, ph_error *err);
void ph_i_scan_free(ph_scan **scan);
/** Least load > 0 at which an intact bond breaks, where u [nd][cells] belongs to the unit
 *  load times sign; INFINITY: none. Cost: bonds. The same bits for any number of threads. */
double ph_i_scan(ph_scan *scan, const double *u, double sign);
/** Look again at the bonds of some cells. */
void ph_i_scan_cells(ph_scan *scan, const double *u, double sign, ptrdiff_t count,
                     const int32_t *cell);
/** The least of all cells, as last scanned. */
double ph_i_scan_least(const ph_scan *scan);
/** Least t >= 0 at which an intact bond breaks, where its displacement is u + t du and the macro
 *  strain macro + t dmacro; INFINITY: none. Cost and bits as above. */
double ph_i_scan_reach(ph_scan *scan, const double *u, const double *macro,
                       const double *du, const double *dmacro);
/** Collect the bonds whose critical load, as last scanned, is not above `most`. */
ph_status ph_i_scan_pick(ph_scan *scan, const double *u, double sign, double most,
                         ph_error *err);
/** Keep the bonds that were picked as broken by the next event. */
ph_status ph_i_failure_keep_bonds(const ph_run *run, const ph_scan *scan, ph_error *err);

/** Pull of a bond in any state. */
double ph_i_scan_pull_of(const ph_scan *scan, const double *u, const double *macro,
                         ptrdiff_t x, ptrdiff_t b, ptrdiff_t y);
/** Pull of a bond, see ph_picked. */
double ph_i_scan_pull(const ph_scan *scan, const double *u, ptrdiff_t x, ptrdiff_t b,
                      ptrdiff_t y);

#endif
