/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The route `frequency`: the complex problem at one angular frequency.
 *
 * With C(i omega) = C' + i C'' in every cell, A = A' + i A'' is complex symmetric, and both
 * parts are the operator of the elastic problem with other tensors. COCG needs four real
 * applications an iteration. The stabilisation relaxes
 * with the phase that it follows.
 * C*(i omega) comes out with C'' positive semidefinite, for the discrete medium is a network
 * of springs and dashpots. `reduced` gives the same numbers from a few real solves; this route
 * is the check of it. Tested: tests/cross/test_time_and_frequency.c. Ref: [VanDerVorst1990] */
#ifndef PH_EFFECTIVE_FREQUENCY_H
#define PH_EFFECTIVE_FREQUENCY_H

#include "effective/complex_map.h"
#include "effective/run.h"

/** Effective complex modulus at one frequency. */
typedef struct ph_complex_modulus {
    double omega;          /* angular, 1/time */
    ph_sym4 storage, loss; /* Mandel */
    int iterations;        /* all loads */
    double residual;       /* worst load, relative */
    double asymmetry;      /* |C* - C*^T| / |C*| before it was made symmetric */
    long applications;     /* real, of the operator */
} ph_complex_modulus;

/** All loads at the frequencies asked for.
 *  @param[in] run   built (ph_i_run_build); its map is changed, its solver is made anew
 *  @param[in] omega [n] > 0, finite
 *  @return PH_OK; PH_EINVAL (families cut at the faces, frequency); PH_ENOCONV;
 *          PH_ESINGULAR; PH_ENOMEM; PH_ECANCELLED */
ph_status ph_i_frequency(ph_run *run, double tolerance, int n, const double *omega,
                         ph_complex_modulus *out, ph_error *err);

#endif
