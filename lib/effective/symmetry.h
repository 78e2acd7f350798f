/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Symmetries of a periodic cell: the reflections and quarter turns of the axes, each up to a
 * shift, that take the stiffness of every cell to where it is already. The effective tensor
 * has them too, so that loads which they turn into one another are solved once, and entries
 * whose sign one of them changes are zero. */
#ifndef PH_EFFECTIVE_SYMMETRY_H
#define PH_EFFECTIVE_SYMMETRY_H

#include <perihom/microstructure.h>

#include "model/stiffness_map.h"

/** Axis d becomes sign[d] times axis to[d]; so Mandel component a becomes flip[a] times
 *  component place[a]. Then all moves by `shift` cells, 0 to n - 1. */
typedef struct ph_turn {
    int to[3], sign[3];
    int place[6], flip[6];
    ptrdiff_t shift[3];
} ph_turn;

enum { PH_TURNS = 48 };

typedef struct ph_cell_symmetry {
    int count, ns; /* the identity counts */
    ph_turn turn[PH_TURNS];
} ph_cell_symmetry;

/** No symmetry but the identity. */
ph_cell_symmetry ph_i_symmetry_none(int ns);
/** All symmetries of a box whose cells hold the stiffness of `map` (a group).
 *  @return PH_OK; PH_ENOMEM. Cost: a few passes over the cells for each of at most 47
 *  candidates; one that needs more is taken for none. */
ph_status ph_i_symmetry_find(const ph_grid *box, const ph_stiffness_map *map,
                             ph_cell_symmetry *out, ph_error *err);
/** The first of `wanted` that the others of them follow from. */
unsigned ph_i_symmetry_loads(const ph_cell_symmetry *s, unsigned wanted);
/** The turn that makes load a, times its flip[*from], of load *from, one of `loads`; the
 *  identity where a is one of them, NULL where a does not follow. */
const ph_turn *ph_i_symmetry_source(const ph_cell_symmetry *s, unsigned loads, int a,
                                    int *from);
/** Turn a displacement [nd][cells] at the cell centres or at the lower corners of the cells.
 *  @param[out] out is not u */
void ph_i_symmetry_turn_field(const ph_turn *turn, const ph_grid *box, int nd,
                              bool corners, const double *u, double *out);
/** Components that stresses or strains of component `a` alone may come with: the block of the
 *  effective tensor that has to be inverted for row a of the compliance. */
unsigned ph_i_symmetry_block(const ph_cell_symmetry *s, int a);
/** Make the columns `solved` exactly symmetric and fill in those that follow.
 *  @return the columns that are there */
unsigned ph_i_symmetry_complete(const ph_cell_symmetry *s, unsigned solved,
                                ph_sym4 *columns);
/** Mean of a symmetric tensor over the symmetries, exactly symmetric, with exact zeros. Entries
 *  that are NaN are not known: they follow from those that are. */
void ph_i_symmetry_average(const ph_cell_symmetry *s, ph_sym4 *tensor);

#endif
