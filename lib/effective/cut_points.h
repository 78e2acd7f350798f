/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cut cells of viscoelastic phases: the laminate in a cell remembers the strain of each of
 * its phases.
 *
 * At every strain point of a cut cell, phase k of the laminate has the strain
 *
 *     eps_k = eps + G_k a
 *
 * with one jump vector for each cut: cut j with fraction f and normal n brings (1-f) N a_j to
 * what it paints and -f N a_j to what lies under it, N a the strain of sym(a (x) n). The
 * tractions across the cuts are continuous where sum_k phi_k G_k^T sigma_k = 0, phi_k the
 * share of phase k. With sigma_k = C_k (d eps + G_k d a) + p_k of a time step this gives
 *
 *     d a = -M^-1 (H^T d eps + r),   sigma = (C - H M^-1 H^T) d eps + p - H M^-1 r
 *     M = <G^T C G>, H = <C G>, C = <C_k>, r = <G^T p_k>, p = <p_k>,  <.> = sum phi_k
 *
 * the first bracket being the laminate of the C_k. Next to a void there is no jump.
 * Tested: tests/cross/test_time_and_frequency.c */
#ifndef PH_EFFECTIVE_CUT_POINTS_H
#define PH_EFFECTIVE_CUT_POINTS_H

#include "model/bondlist.h"
#include "model/relaxing_map.h"

enum { PH_CELL_CUTS = 8, PH_CELL_JUMPS = 3 * PH_CELL_CUTS };

/* The laminate in one cell. */
typedef struct ph_cell_laminate {
    int nphases, njumps; /* jump components, nd a cut that is not at a void */
    int phase[PH_CELL_CUTS + 1];
    double share[PH_CELL_CUTS + 1];
    double G[PH_CELL_CUTS + 1][6][PH_CELL_JUMPS]; /* [phase][strain][jump] */
} ph_cell_laminate;

/* State of all points at one instant: total strains and jumps, and those that each branch
 * remembers. Displacements as in the stepper. */
typedef struct ph_cut_state {
    const double *u, *macro;    /* [nd][cells], [6] */
    const double *memory;       /* [ntimes][nd * cells] */
    const double *macro_memory; /* [ntimes][6] */
    double *jump, *jump_memory; /* [size], [ntimes][size] */
} ph_cut_state;

typedef struct ph_cut_points {
    ph_relaxing_map *relax; /* borrowed */
    ph_meter *meter;
    ph_bondlist *list;
    ptrdiff_t *cut;   /* [mixtures] first cut of the cells with an entry */
    ptrdiff_t *first; /* [points + 1] jumps of a point */
    ptrdiff_t size;   /* jump components of all points */
} ph_cut_points;

/** The points of the cut cells of a box; NULL where there are none that relax.
 *  @return PH_OK; PH_EINVAL (more than PH_CELL_CUTS cuts in a cell); PH_ENOMEM */
ph_status ph_i_cut_points_new(const ph_grid *box, const ph_operator_params *params,
                              ph_relaxing_map *relax, ph_meter *meter,
                              ph_cut_points **out, ph_error *err);
void ph_i_cut_points_free(ph_cut_points **points);

/** f -= B^T (p - H M^-1 r), p_k = C_inf eps_k + sum_m decay_m C_m q_km; adds the average of
 *  p - H M^-1 r over the cells with region[x] != 0 to `stress` (a sum over cells).
 *  @param[in] tangent [materials] tensors of the step */
ph_status ph_i_cut_points_load(const ph_cut_points *points, const ph_cut_state *state,
                               const ph_sym4 *tangent, const double *decay,
                               const uint8_t *region, double *f, double *stress,
                               ph_error *err);
/** Jumps at the end of a step: a += d a, alpha_m = decay_m alpha_m + ramp_m d a. */
ph_status ph_i_cut_points_advance(const ph_cut_points *points, const ph_cut_state *state,
                                  const ph_sym4 *tangent, const double *decay,
                                  const double *ramp, const double *du,
                                  const double *dmacro, ph_error *err);
/** Adds, over the cells of a region, the stress, twice the stored energy and the dissipation
 *  rate of the phases. */
void ph_i_cut_points_sums(const ph_cut_points *points, const ph_cut_state *state,
                          const uint8_t *region, double *stress, double *energy,
                          double *dissipation);

#endif
