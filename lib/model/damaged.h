/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Nodes that have lost bonds. Each has the shape tensor of the bonds that it still has:
 *
 *   K = sum over intact b of w_b xi_b xi_b,   grad u = sum over intact b of w_b du_b xi_b K^-1
 *   force on x+o_b, and its opposite on x:  sigma K^-1 w_b xi_b
 *
 * An operator takes the strains of these nodes from here instead of its own, and gives their
 * stresses here instead of to its own divergence. Strain and force are sums over the same
 * bonds with the same weights, one the transpose of the other. Where the bonds that are left
 * do not span space, K is singular and the node carries no stress.
 *
 * The uniform term of (S) counts every bond of every node. What it counts too much,
 *
 *   s/2 sum over b of w_b |z_b|^2,  z_b = du_b - grad u xi_b   (whole family, its own K)
 *   less the same over intact bonds with the gradient of these,
 *
 * is taken away at damaged nodes; no stabilisation acts across a crack. As grad u is the
 * weighted least-squares fit of du_b, sum w_b z_b xi_b = 0, and the force of either sum is
 * s w_b z_b on x+o_b, its opposite on x.
 * Tested: tests/cross/test_broken.c */
#ifndef PH_MODEL_DAMAGED_H
#define PH_MODEL_DAMAGED_H

#include "model/stiffness_map.h"
#include "space/broken.h"
#include "space/layout.h"

typedef struct ph_damaged {
    ph_layout layout;
    const ph_broken *broken; /* borrowed */
    const ph_family *family;
    ph_meter *meter;
    int threads;
    int (*o)[3];         /* [family->count] offsets along the loops */
    double (*wxi)[3];    /* [family->count] w_b xi_b */
    int reach[3];        /* along the loops */
    int32_t *wrapped[3]; /* line i - reach .. n + reach of each loop */
    double whole[6];     /* K^-1 of a whole family */
    double s;            /* coefficient of (S) */
    ptrdiff_t count, room;
    int32_t *node; /* [count] as in `broken` when last updated */
    double
        *inverse;   /* [count][6] K^-1: 00 11 22 12 02 01 by direction; zero: no stress */
    double *stress; /* [count][6] Mandel, between ph_i_damaged_take and _scatter */
    ptrdiff_t mute; /* nodes that carry no stress */
    size_t bytes;
} ph_damaged;

/** @param[in] s coefficient of (S), 0: none. @return PH_OK; PH_ENOMEM */
ph_status ph_i_damaged_new(const ph_layout *layout, const ph_broken *broken, double s,
                           int threads, ph_meter *meter, ph_damaged **out, ph_error *err);
void ph_i_damaged_free(ph_damaged **damaged);
/** Take in what has broken since: nodes that are fresh get a new shape tensor.
 *  @return PH_OK; PH_ENOMEM. Cost: fresh nodes x family + damaged nodes. */
ph_status ph_i_damaged_update(ph_damaged *damaged, ph_error *err);

/** strain [ns][cells] at the damaged nodes = scale * sym grad u + macro; u NULL: zero,
 *  macro NULL: zero. Zero where a node carries no stress. */
void ph_i_damaged_strain(const ph_damaged *damaged, const double *u, const double *macro,
                         double scale, double *strain);
/** Keep the stresses of the damaged nodes and leave zeros in the field [ns][cells]. */
void ph_i_damaged_take(ph_damaged *damaged, double *stress);
/** f [nd][cells] += scale * B^T of the stresses kept, and, with u, the forces of the
 *  correction of (S), times `correction`. The same bits for any number of threads. */
void ph_i_damaged_scatter(ph_damaged *damaged, double scale, const double *u,
                          double correction, double *f);
/** Twice the energy of the correction of (S): what it adds to u . A u. */
double ph_i_damaged_energy(const ph_damaged *damaged, const double *u);
/** Does the node at a place carry no stress? */
bool ph_i_damaged_is_mute(const ph_damaged *damaged, ptrdiff_t place);

#endif
