/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The same geometry on a grid with half the nodes. */
#ifndef PH_RVE_COMPANION_H
#define PH_RVE_COMPANION_H

#include "perihom_error_bar.h"

/** What is made for one set of error bars. Zeroed but for what it borrows. */
typedef struct ph_i_companion {
    const ph_case *c;
    const ph_problem *problem; /* of the case, on its grid */
    const ph_ctx *ctx;
    double horizon; /* of the result, length */
    ph_case coarse; /* borrows the arrays of the case */
    ph_microstructure *micro;
    ph_packing *packing;
    ph_crack_plan *plan;
    ph_problem coarse_problem; /* of micro and plan; only where `why` is empty */
    double ratio;
    char why[200]; /* why there is no companion; "": there is one */
    /* what the companions took */
    double seconds;
    long iterations, applications, ffts;
} ph_i_companion;

ph_status ph_i_companion_build(ph_i_companion *k, ph_error *err);
void ph_i_companion_clear(ph_i_companion *k);
/** Solve a problem on the coarser grid. One that cannot be solved is a reason in `why` [200],
 *  not a failure, and *out NULL; an interruption and a lack of memory are failures. */
ph_status ph_i_companion_solve(ph_i_companion *k, const ph_problem *problem,
                               ph_result **out, char why[200], ph_error *err);
/** Voxels on a coarser grid, half of their number to all of it along each axis: the most
 *  frequent phase of a cell, cut by the others with their shares, normals from centroid to
 *  centroid. @return PH_OK; PH_EINVAL; PH_ENOMEM. Tested: tests/unit/test_coarsen.c */
ph_status ph_i_coarsen(const ph_microstructure *fine, const ptrdiff_t nodes[3],
                       ph_microstructure **out, ph_error *err);
/** Every voxel of a microstructure without cuts by twos, its owner too. */
ph_status ph_i_refine(const ph_microstructure *coarse, ph_microstructure **out,
                      ph_error *err);

#endif
