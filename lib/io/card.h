/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a card format is given, and the formats. */
#ifndef PH_IO_CARD_H
#define PH_IO_CARD_H

#include <perihom/card.h>

#include <stdio.h>

/** A material ready to be written: its class decided, its constants at hand. */
typedef struct ph_i_card {
    const ph_effective *effective;
    const char *name;
    int id;
    ph_symmetry symmetry; /* never AUTO */
    double distance;      /* of the tensor written from the effective one, relative */
    int n;
    double D[6][6]; /* stiffness, Voigt 11 22 33 23 13 12, engineering shear */
    ph_engineering e;
    double density; /* NaN: not known */
    /* viscoelastic and isotropic: shear and bulk moduli of equilibrium and terms */
    const ph_prony *series; /* NULL: elastic */
    double G0, K0;          /* instantaneous */
    double *G, *K;          /* [1 + terms], the equilibrium first */
} ph_i_card;

typedef struct ph_card_format {
    ph_entry info;
    const char *ending;
    unsigned classes; /* bit ph_symmetry: the format can hold it */
    bool plane;       /* takes tensors of n = 3 too */
    unsigned relaxes; /* bit ph_symmetry: classes of relaxation series that it can hold */
    void (*write)(FILE *to, const ph_i_card *card);
    int most_terms; /* of a series, its equilibrium beside; 0: any number */
} ph_card_format;

extern const ph_card_format ph_i_card_formats[];
extern const size_t ph_i_ncard_formats;

#endif
