/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PH_MODEL_OPERATOR_PARAMS_H
#define PH_MODEL_OPERATOR_PARAMS_H

#include <perihom/family.h>
#include <perihom/homogenise.h>

#include "model/bond_classes.h"
#include "space/broken.h"

typedef enum ph_route {
    PH_ROUTE_AUTO,
    PH_ROUTE_CELLS,
    PH_ROUTE_STENCIL,
    PH_ROUTE_CONVOLUTION,
    PH_ROUTE_BONDS
} ph_route;

/** How an operator is to be made; everything decided, nothing automatic but the route. */
typedef struct ph_operator_params {
    const ph_family *family; /* NULL: `local`, finite elements on the cells */
    bool smallest;           /* the family is the corners of the cell */
    ph_stabilisation stabilisation;
    double value; /* alpha or theta */
    ph_route route;
    bool
        hourglass_in_space; /* (S) of the cells route by the kernel, not in Fourier space */
    bool one_sided;   /* families end at the faces of the RVE, which fills the first */
    ptrdiff_t rve[3]; /* cells of the box; bonds route only */
    const ph_bond_classes *classes; /* model bond: a spring for every bond; else NULL */
    bool cut_only; /* bond lists: the points of cut cells alone, without stabilisation */
    const ph_broken *broken; /* bonds that are broken, or NULL: none ever */
    int threads;
} ph_operator_params;

#endif
