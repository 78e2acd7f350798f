/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a grid is expected to be off, before two grids are compared. */
#ifndef RVE_SLOPE_H
#define RVE_SLOPE_H

#include <perihom_rve.h>

/** The law slope / n, n nodes along the longest axis: relative error of the moduli. */
typedef struct ph_i_slope {
    double spread; /* ln(Voigt / Reuss) of the worst modulus, at most ln 1000 */
    double
        boundary; /* cells that are cut or beside another phase: share of all, times n */
    double slope; /* K spread boundary, K found on random cells: docs/accuracy-costs.md */
} ph_i_slope;

/** @param[in] bounds any result of the microstructure: its bounds of Voigt and Reuss */
ph_i_slope ph_i_slope_of(const ph_microstructure *m, ph_interface interface,
                         const ph_result *bounds);

#endif
