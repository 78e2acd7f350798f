/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A Prony series as a network of internal variables, from which components of the strain are
 * eliminated; the method stands in prony_network.c. */
#ifndef PH_MATERIAL_PRONY_NETWORK_H
#define PH_MATERIAL_PRONY_NETWORK_H

#include <perihom/prony.h>

#include "core/check.h"

/** Equilibrium stiffness over instantaneous stiffness that counts as zero. */
#define PH_I_NOTHING 1e-13

typedef struct ph_i_network {
    int n, q;  /* strain components, internal variables */
    double *L; /* [q][6] */
    double *time;
    double *G; /* [q][6]: R^-T L_d */
    int nd;    /* eliminated components */
    double R[6][6], sigma[6], U[6][6];
    double *X; /* [q] columns of B T^-1/2, each `rows` long; then X V */
    double *V; /* [q] columns */
    int rows;
    double *rate; /* [q] lambda */
} ph_i_network;

/** Eliminate the components `drop`. `w` comes zeroed and is freed by the caller in any case.
 *  @return PH_OK; PH_ESINGULAR; PH_ENOCONV; PH_ENOMEM */
ph_status ph_i_network_new(ph_i_network *w, const ph_prony *p, int nd, const int *drop,
                           ph_error *err);
void ph_i_network_free(ph_i_network *w);
/** x = C_0dd^-1 L_d of internal variable `k`. @param[out] x [nd] */
void ph_i_network_dropped(const ph_i_network *w, int k, double *x);
/** sum_k P_k v_k / sqrt(tau_k) over the internal variables, for mode `mode`.
 *  @param[in] P [q][6], the first n of each; @param[out] x [6] */
void ph_i_network_project(const ph_i_network *w, int mode, int n, const double *P,
                          double *x);
/** Upper R with R^T R = c; false where c is not positive definite. */
bool ph_i_factor(int n, double c[6][6], double R[6][6]);
/** S <- R^-T S R^-1 */
void ph_i_both_sides(int n, double R[6][6], double S[6][6]);

#endif
