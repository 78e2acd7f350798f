/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The stiffness of every cell: a table of distinct tensors and an index per cell. */
#ifndef PH_MODEL_STIFFNESS_MAP_H
#define PH_MODEL_STIFFNESS_MAP_H

#include <perihom/homogenise.h>

#include "core/memory.h"

typedef enum ph_hooke { PH_HOOKE_ZERO, PH_HOOKE_ISOTROPIC, PH_HOOKE_GENERAL } ph_hooke;

typedef struct ph_stiffness_map {
    int ns;          /* 3 or 6 */
    ptrdiff_t cells; /* of the box that is solved */
    int count;       /* distinct tensors: the materials, then one per cut cell */
    int materials;
    size_t reserved; /* doubles of c as they were counted */
    double *c;       /* [count][ns*ns] Mandel */
    ph_hooke *hooke; /* [count] */
    int32_t *index;  /* [cells] into c */
    bool *used;      /* [materials] is it anywhere? */
    bool has_void;
    double contrast; /* of the phases; 1: homogeneous; voids not counted */
    double spread;   /* largest over smallest eigenvalue of all phases but voids */
    double
        least_contrast; /* of their smallest eigenvalues: what is soft or rigid, not what
                            * is only nearly incompressible */
    double softest;     /* trace / ns of the softest solid phase */
    bool
        apparent; /* cut cells are layered along the apparent normal of their interface */
    ph_sym4 middle; /* mean of the stiffest and the softest solid: the reference medium */
} ph_stiffness_map;

enum { PH_SOURCE_VOID = -1 }; /* other negatives: -2 - material */

/** Reduce the phases to the kinematics, mix the cut cells, index every cell.
 *  @param[in] source [cells] which cell of the RVE stands in each cell of the box, or
 *             PH_SOURCE_VOID, or -2 - material; NULL: the box is the RVE
 *  @param[in] apparent see ph_i_cut_normal */
ph_status ph_i_stiffness_map_new(const ph_microstructure *micro, ph_interface interface,
                                 bool apparent, const ptrdiff_t *source, ptrdiff_t cells,
                                 ph_meter *meter, ph_stiffness_map **out, ph_error *err);
/** Other tensors for the same cells. What was made of the map (a preconditioner, a factor)
 *  does not follow, and `softest`, of which the stabilisation is made, stays.
 *  @param[in] phase [materials], n = ns
 *  @param[in] mixed true: cut cells are mixed anew, and contrast and middle are measured
 *             again; false: cut cells hold nothing, nothing is measured
 *  @return PH_OK; PH_ESINGULAR where a cut cell cannot be mixed */
ph_status ph_i_stiffness_map_set(ph_stiffness_map *map, const ph_microstructure *micro,
                                 const ph_sym4 *phase, bool mixed, ph_error *err);
/** One tensor of the table, with its kind. */
void ph_i_stiffness_map_store(ph_stiffness_map *map, int entry, const ph_sym4 *c);
/** Mean over the cells: the stiffness under a uniform strain. */
ph_sym4 ph_i_stiffness_map_mean(const ph_stiffness_map *map);
void ph_i_stiffness_map_free(ph_meter *meter, ph_stiffness_map **map);

/** Number of cuts of the cell whose first cut is `i`. Cut cells have the entries after
 *  `materials`, in the order of the cuts. */
ptrdiff_t ph_i_cuts_of_cell(const ph_microstructure *micro, ptrdiff_t i);
/** The fraction that a cut gets over a cell of which the share `solid` is not void; updates
 *  it. A cell keeps a least share of solid. @param[in] hole the cut brings in a void */
double ph_i_cut_fraction(const ph_cut *cut, bool hole, double *solid);
/** The normal along which a cut cell is layered: that of the interface, or, where the strain
 *  of a cell is the mean gradient of its corners, the apparent one, n + dn with
 *
 *      dn = -(v - (v.n) n) / 2,    v_a = n_a^3 h_a^2 / sum_b n_b^2 h_b^2
 *
 *  (docs/theory/microstructure.md#the-apparent-normal), which takes the first-order error of
 *  oblique interfaces away. Along axes and, in square cells, diagonals both are the same. */
void ph_i_cut_normal(const ph_stiffness_map *map, const ph_grid *grid, const ph_cut *cut,
                     double normal[3]);

/** First entry of a cut cell: entry - this is its number in painting order of cells. */
static inline int ph_i_first_mixture(const ph_stiffness_map *map)
{
    return map->materials + 1;
}

/* s = C e for one cell. */
static inline void ph_i_hooke(const ph_stiffness_map *map, int entry, const double *e,
                              double *s)
{
    int n = map->ns;
    const double *c = map->c + (ptrdiff_t)entry * n * n;
    for (int i = 0; i < n; i++) {
        s[i] = 0.0;
        for (int j = 0; j < n; j++)
            s[i] += c[i * n + j] * e[j];
    }
}

#endif
