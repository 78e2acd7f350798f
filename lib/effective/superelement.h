/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The energy of an RVE alone: of its own points, whose families reach into the collar around
 * it, or of its own nodes, whose bonds do. */
#ifndef PH_EFFECTIVE_SUPERELEMENT_H
#define PH_EFFECTIVE_SUPERELEMENT_H

#include <perihom/superelement.h>

#include "effective/run.h"

typedef struct ph_body {
    const ph_run *run; /* borrowed: chosen, not built */
    ph_grid box;       /* all nodes that move; nothing of it wraps */
    ph_meter *meter;
    ptrdiff_t *source; /* [cells of the box] */
    ph_stiffness_map *map;
    ph_operator_params params;
    ph_bondlist *list;        /* or, of model bond, */
    ph_bond_classes *classes; /* with the material around the RVE */
    ptrdiff_t low[3];         /* node of the RVE where the box begins, <= 0 */
    ptrdiff_t inner[3][2];    /* first and last node that only points of the RVE move */
} ph_body;

/** Of a run that was prepared. @return PH_OK; PH_EINVAL (one cell along an axis); PH_ENOMEM */
ph_status ph_i_body_new(ph_run *run, ph_body **out, ph_error *err);
void ph_i_body_free(ph_body **body);
/** Node of the RVE, 0 .. n - 1 of each axis or outside of that, at a node of the box. */
void ph_i_body_at(const ph_body *body, ptrdiff_t x, ptrdiff_t at[3]);
/** Is it kept: could a neighbour of the RVE move with it? */
bool ph_i_body_is_kept(const ph_body *body, const ptrdiff_t at[3]);
/** Matrix and absolute row sums of the energy per cell, as ph_i_bondlist_matrix. */
ph_status ph_i_body_matrix(const ph_body *body, const int *unknown, int n, ph_csc *out,
                           ph_error *err);
ph_status ph_i_body_row_sums(const ph_body *body, double *sum, ph_error *err);
/** Generalised plane strain: forces of the uniform strain 33 [nd][box], and its own
 *  stiffness, per cell. @return PH_OK; PH_ENOMEM */
ph_status ph_i_body_stretch(const ph_body *body, double *force, double *stiffness,
                            ph_error *err);

#endif
