/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PERIHOM_MICROSTRUCTURE_H
#define PERIHOM_MICROSTRUCTURE_H

#include <perihom/material.h>

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** A periodic box of equal cells. Cell (i,j,k) has index (i n[1] + j) n[2] + k and its
 *  centre at ((i+1/2) h[0], (j+1/2) h[1], (k+1/2) h[2]). 2D: n[2] = 1. */
typedef struct ph_grid {
    ph_kinematics kinematics;
    ptrdiff_t n[3]; /* cells per axis, >= 1 */
    double size[3]; /* of the box, > 0; size[2] = h[2] = 1 in 2D */
    double h[3];    /* spacing, size / n */
} ph_grid;

/** @param n,size two or three entries, by `kin`. @return PH_OK; PH_EINVAL. */
PH_API ph_status ph_grid_init(ph_grid *grid, ph_kinematics kin, const ptrdiff_t *n,
                              const double *size, ph_error *err);
/** Number of cells. */
PH_API ptrdiff_t ph_grid_cells(const ph_grid *grid);

/** An interface that cuts a cell: `fraction` of the cell is `material`, whose surface in the
 *  cell has the mean outward unit normal `normal`; the rest is what the cell held before.
 *  Several cuts of one cell stand in painting order, each scaling all that is below it:
 *  with fractions f_1 .. f_n, cut k is left with the share f_k (1-f_k+1) ... (1-f_n). */
typedef struct ph_cut {
    ptrdiff_t cell;
    int base;         /* material under the first cut of this cell; later cuts: -1 */
    int material;     /* the material that the cut brings in */
    double fraction;  /* 0 < fraction < 1 */
    double normal[3]; /* unit; 2D: third entry 0 */
} ph_cut;

/** Which material is where. Owns its arrays. */
typedef struct ph_microstructure {
    ph_grid grid;
    int nmaterials;
    ph_material *materials;
    uint16_t *phase; /* [cells] material at the cell's centre */
    ptrdiff_t ncuts;
    ph_cut *cuts; /* sorted by cell, then painting order; empty for node_centre */
    /* [cells] number of the filler that a cell belongs to, from 1; 0: none. NULL where
     * nothing was generated. Bonds ask for it. */
    int32_t *owner;
} ph_microstructure;

/** A box of material 0 everywhere. Copies `materials`, their relaxation series too. */
PH_API ph_status ph_microstructure_new(const ph_grid *grid, int nmaterials,
                                       const ph_material *materials,
                                       ph_microstructure **out, ph_error *err);
PH_API void ph_microstructure_free(ph_microstructure **micro);
/** Volume fraction of each material, cuts counted with their fractions.
 *  @param[out] fraction [nmaterials], adds up to 1; NaN if memory is exhausted. */
PH_API void ph_microstructure_fractions(const ph_microstructure *micro, double *fraction);
/** Range, sorting and fractions of phases and cuts. @return PH_OK; PH_EINVAL. */
PH_API ph_status ph_microstructure_check(const ph_microstructure *micro, ph_error *err);

#ifdef __cplusplus
}
#endif
#endif
