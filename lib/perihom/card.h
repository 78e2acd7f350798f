/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Material cards: an effective material in the words of a macroscale code. */
#ifndef PERIHOM_CARD_H
#define PERIHOM_CARD_H

#include <perihom/catalogue.h>
#include <perihom/effective.h>

#ifdef __cplusplus
extern "C" {
#endif

/** The class of elastic symmetry that a card writes, in the axes of the RVE. */
typedef enum ph_symmetry {
    PH_SYMMETRY_AUTO, /* the simplest one that holds the tensor to `tolerance` */
    PH_SYMMETRY_ISOTROPIC,
    PH_SYMMETRY_ORTHOTROPIC,
    PH_SYMMETRY_ANISOTROPIC
} ph_symmetry;

/** What a card says of a viscoelastic material. */
typedef enum ph_card_state {
    PH_CARD_RELAXATION,    /* the whole series; elastic materials: their tensor */
    PH_CARD_INSTANTANEOUS, /* the elastic tensor at t = 0 */
    PH_CARD_EQUILIBRIUM    /* the elastic tensor after infinite time */
} ph_card_state;

/** How to write a card. Zeroed: all defaults. */
typedef struct ph_card_params {
    const char *name; /* of the material in the card; NULL: "perihom" */
    int id;           /* for codes that number materials; 0: 1 */
    ph_symmetry symmetry;
    ph_card_state state;
    double tolerance; /* relative distance |C - C_class| / |C| that counts as none;
                       * 0: 1e-5, what a solve to 1e-6 leaves */
    bool nearest;     /* write the nearest tensor that the format or `symmetry` can hold,
                       * with its distance in the card; else that is an error */
} ph_card_params;

/** The formats: codes and their keywords; `valid` says what a format can hold. */
PH_API const ph_catalogue *ph_card_formats(void);
/** Ending of a card's file, e.g. ".inp". */
PH_API const char *ph_card_ending(const char *format);

/** Nearest tensor of a class in the Frobenius norm, in the given axes.
 *  @param[out] out may be NULL. @return |C - C_class| / |C|. Tested: tests/io/test_card.c */
PH_API double ph_symmetry_project(const ph_sym4 *c, ph_symmetry symmetry, ph_sym4 *out);

/** The card as text, malloc'd. Numbers have 10 digits or more where the format has room.
 *
 *  @param[in]  effective n = 6: a 3D tensor; plane strain and plane stress results have no
 *              out-of-plane constants, only format "json" takes them
 *  A relaxation series is one isotropic series of shear and bulk in the codes that have
 *  any (Abaqus, Ansys, LS-DYNA); only "json" holds one of full tensors.
 *  @param[out] distance of the tensor written from the effective one, or NULL; of a series:
 *              the largest distance of a term over |C(0+)|
 *  @return PH_OK; PH_EINVAL (unknown format, 2D tensor, a name the code would not read);
 *          PH_EUNPHYSICAL where the format cannot hold the material and `nearest` is not
 *          set: the message has the distance of the nearest one; PH_ENOMEM.
 *  Tested: tests/io/test_card.c, tests/consumers/calculix.py */
PH_API ph_status ph_card_write(const ph_effective *effective, const char *format,
                               const ph_card_params *params, char **text,
                               double *distance, ph_error *err);

#ifdef __cplusplus
}
#endif
#endif
