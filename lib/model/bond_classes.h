/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which modulus a bond has, from its two ends.
 *
 *   same material, and neither in different fillers   E of the material
 *   two materials                                     kappa E_m, or 2 E_a E_b / (E_a + E_b)
 *   two different fillers                             min(E_m, interphase bonds of the two)
 *   an end in a void                                  0
 *
 * E_m of a bond is the modulus of the end that is in no filler; where both or neither are,
 * of the softer one. E_m of two fillers is that of the matrix: the solid material that most
 * of the cells outside fillers have. Ref: [Ongaro2022] 3.3. Tested: tests/unit/test_bond_classes.c */
#ifndef PH_MODEL_BOND_CLASSES_H
#define PH_MODEL_BOND_CLASSES_H

#include <perihom/homogenise.h>

#include "core/memory.h"

/** How the modulus of a bond follows from those of two materials:
 *  factor E[first], or with a second one factor 2 E_a E_b / (E_a + E_b); first -1: none. */
typedef struct ph_bond_recipe {
    int first, second; /* materials, or -1 */
    double factor;
} ph_bond_recipe;

typedef struct ph_bond_classes {
    ptrdiff_t cells;
    int materials; /* and one more: nothing */
    int count;     /* 2 (materials + 1): class = 2 material + (in a filler) */
    int matrix;    /* material, or -1 */
    double *E;     /* [materials + 1] */
    double *pair;  /* [count][count] modulus of a bond between classes */
    double *apart; /* [count][count] the same where the ends are in different fillers */
    ph_bond_recipe *how, *how_apart; /* [count][count] of `pair` and `apart` */
    int32_t *class;                  /* [cells] */
    int32_t *owner;                  /* [cells] filler, 0: none */
} ph_bond_classes;

/** @param[in] kappa interphase factor; 0 or NaN: the harmonic mean
 *  @param[in] source as in ph_i_stiffness_map_new
 *  @return PH_OK; PH_EUNPHYSICAL (a phase that bonds cannot be); PH_ENOMEM */
ph_status ph_i_bond_classes_new(const ph_microstructure *micro, double kappa,
                                const ptrdiff_t *source, ptrdiff_t cells,
                                ph_bond_classes **out, ph_error *err);
void ph_i_bond_classes_free(ph_bond_classes **classes);

static inline double ph_i_bond_modulus(const ph_bond_classes *c, ptrdiff_t x, ptrdiff_t y)
{
    ptrdiff_t at = (ptrdiff_t)c->class[x] * c->count + c->class[y];
    bool apart = c->owner[x] > 0 && c->owner[y] > 0 && c->owner[x] != c->owner[y];
    return apart ? c->apart[at] : c->pair[at];
}

#endif
