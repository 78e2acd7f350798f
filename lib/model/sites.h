/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The strains of some cells wherever their energy is taken: the family's point and the
 * sub-points, modes or Gauss points of the cell, by whatever route. With strain e and weight
 * w of each, the energy of a cell is V/2 sum w e:C:e, as the operator has it without (S).
 * Tested: tests/cross/test_sites.c */
#ifndef PH_MODEL_SITES_H
#define PH_MODEL_SITES_H

#include "model/operator.h"

typedef struct ph_sites {
    ph_operator *op;       /* borrowed */
    ptrdiff_t count;       /* cells */
    int records;           /* strains of a cell at the most */
    const ptrdiff_t *cell; /* [count] increasing; borrowed */
    double *weight;        /* [records][count], 0 where a cell has no such point */
    ptrdiff_t *point;      /* bond lists: [count] first point of the cell, -1: none */
    double *field;         /* [ns][cells] work, where strains come as fields */
} ph_sites;

ph_status ph_i_sites_init(ph_sites *sites, ph_operator *op, ptrdiff_t count,
                          const ptrdiff_t *cell, ph_error *err);
void ph_i_sites_clear(ph_sites *sites);
/** @param[in] u [nd][cells], or NULL: zero; macro [ns] Mandel, or NULL
 *  @param[out] strain [records][count][ns] Mandel */
void ph_i_sites_strain(ph_sites *sites, const double *u, const double *macro,
                       double *strain);

#endif
