/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a cell hides: the strains of the layers of a cut cell, and of a phase in plane stress
 * the strains out of the plane. Both follow from the strain of the cell at the Carson
 * variable at which it was solved; kept with a basis field they are degrees of freedom like
 * any other, so that the energy of a cell is a sum over phases,
 *
 *   2 W / V = sum_layers share e_p : sum_q phi_q(s) X_qp : e_p,
 *
 * which the laminate's own stiffness, a quotient of moduli, is not.
 * Tested: tests/cross/test_sites.c */
#ifndef PH_EFFECTIVE_VISCO_LAYERS_H
#define PH_EFFECTIVE_VISCO_LAYERS_H

#include "effective/visco_functions.h"
#include "model/sites.h"

typedef struct ph_layer {
    int material;
    double share;      /* of the cell's volume */
    double fraction;   /* of what the cell is with this cut, see ph_i_cut_fraction */
    int size;          /* strains kept: ns, or 6 in plane stress */
    ptrdiff_t first;   /* of them in the doubles of a record */
    const ph_cut *cut; /* that brought it in; NULL: the base */
    double normal[3];  /* of the cut, see ph_i_cut_normal */
} ph_layer;

typedef struct ph_layers {
    const ph_microstructure *micro; /* borrowed */
    int ns;
    bool *six;       /* [materials] plane stress of a phase with more than one function */
    ptrdiff_t count; /* cells */
    ptrdiff_t *cell; /* [count] of the box, increasing */
    ptrdiff_t *begin; /* [count + 1] layers of a cell: base, then cuts */
    ph_layer *layer;
    int deepest;      /* most layers of a cell */
    ptrdiff_t record; /* doubles of one record of the sites */
    ph_sym4 *under;   /* [deepest] work */
} ph_layers;

/** The cells of `map` (region[x] != 0; NULL: all) whose layers have to be kept. */
ph_status ph_i_layers_init(ph_layers *layers, const ph_microstructure *micro,
                           const ph_split *split, const ph_stiffness_map *map,
                           const uint8_t *region, ph_error *err);
void ph_i_layers_clear(ph_layers *layers);

/** Strains of the layers from those of the sites, where the phases have the stiffness of
 *  one value of s.
 *  @param[in] phase  [materials] n = ns; space [materials] n = 6 (plane stress)
 *  @param[in] strain [records][count][ns]
 *  @param[out] x     [records][record]
 *  @return PH_OK; PH_ESINGULAR */
ph_status ph_i_layers_localise(ph_layers *layers, const ph_sites *sites,
                               const ph_sym4 *phase, const ph_sym4 *space,
                               const double *strain, double *x, ph_error *err);
/** The strain of the cell in every layer, nothing out of the plane: as good a field as any
 *  other to begin with. */
void ph_i_layers_spread(const ph_layers *layers, const ph_sites *sites,
                        const double *strain, double *x);
/** y = weight share X x.
 *  @param[in] shape [materials] n = ns, and space [materials] n = 6 for layers of six */
void ph_i_layers_stress(const ph_layers *layers, const ph_sites *sites,
                        const ph_sym4 *shape, const ph_sym4 *space, const double *x,
                        double *y);

#endif
