/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where a failure is on its way, and the events.
 *
 * While no bond breaks the displacement is lambda times that of the unit load, so that the
 * load of the next break is known without stepping: lambda_b = s_c / s_b(1), least over the
 * intact bonds. An event takes these bonds away at that load. Which bonds break next does not
 * depend on the load, so that one sequence of events serves two paths: the load follows every
 * event, up and down (crack-length control), or it only grows and bonds break at once that
 * would break at less (controlled strain).
 *
 * After an event a patch of nodes around it is brought into equilibrium, see patch.h, and
 * after some events the whole box, from what the patch has found: a settlement.
 *
 * With u- before and u+ after, both in equilibrium, the energies of the unit load differ by
 * W- - W+ = 1/2 sum k e- e+ over the bonds that went: what was dissipated, known from the
 * bonds alone, where the mean stress and the stored energy are known from all others. Within
 * a patch this is what relaxing it released; a settlement adds the rest. */
#ifndef PH_EFFECTIVE_FAILURE_WALK_H
#define PH_EFFECTIVE_FAILURE_WALK_H

#include "effective/patch.h"
#include "effective/unit_load.h"

/* A bond that broke since the box was settled. */
typedef struct ph_open_bond {
    ptrdiff_t x, b, y;
    double k, e; /* stiffness; elongation when the box was settled last, unit load */
} ph_open_bond;

typedef struct ph_walk {
    ph_run *run;
    const ph_loading *loading;
    ph_failure_path *path;
    ph_strengths *strengths;
    ph_scan *scan;
    ph_unit_load unit;
    ph_patch *patch; /* or NULL: the box is settled at every event */
    double pristine; /* energy of the unit load at the beginning */
    int stiffnesses; /* that were solved */
    double load;     /* controlled strain */
    double last;     /* load of the last event, by its size */
    ph_failure_energy events, controlled;
    double settled;  /* energy of the unit load when the box was settled last */
    double released; /* since then, per volume, unit load */
    double critical; /* largest k e e of a bond at the load where it broke */
    bool stale;      /* bonds have broken since the box was settled */
    double scanned;  /* sign of the load for which the scan is that of u; 0: of none */
    ptrdiff_t nopen, open_room;
    ph_open_bond *open;
} ph_walk;

/** The unit load before anything breaks; unit, scan and path are made.
 *  @return PH_OK; what a solver may return; PH_ENOMEM */
ph_status ph_i_walk_start(ph_walk *walk, ph_error *err);
void ph_i_walk_clear(ph_walk *walk);
/** Everything that breaks on the way to a load; `last`: settle the box at the end. */
ph_status ph_i_walk_to(ph_walk *walk, double load, bool last, ph_error *err);

#endif
