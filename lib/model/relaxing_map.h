/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Viscoelastic phases on the cells: one stiffness map whose tensors take turns.
 *
 * With C(t) = C_inf + sum_m C_m exp(-t/tau_m) in every phase, and tau_1 < tau_2 < .. the
 * distinct times of all of them, whatever a route needs of a phase is a weighted sum
 *
 *     w_inf C_inf + sum_m w_m C_m
 *
 * (the tangent of a time step, one branch, storage, loss). An operator reads its tensors from
 * the map each time that it is applied, so that one operator serves all of them.
 *
 * A cut cell is a laminate, which is not a weighted sum: `mixed` shows the laminates of the
 * weighted phases, `whole` leaves the cut cells empty. Tested: tests/unit/test_relaxing_map.c */
#ifndef PH_MODEL_RELAXING_MAP_H
#define PH_MODEL_RELAXING_MAP_H

#include "model/stiffness_map.h"

/* Tables that one map may show. */
typedef struct ph_tensor_table {
    double *c;
    ph_hooke *hooke;
    int32_t *index;
} ph_tensor_table;

typedef struct ph_relaxing_map {
    ph_stiffness_map *map; /* borrowed: what operators read */
    const ph_microstructure *micro;
    ph_meter *meter;
    int materials, ntimes;
    double *time;      /* [ntimes] increasing */
    ph_sym4 *infinity; /* [materials] in the kinematics of the grid */
    ph_sym4 *branch;   /* [ntimes][materials] */
    ph_sym4 *phase;    /* [materials] work: the weighted sums */
    /* (S) relaxes with the trace of one phase, `soft` (-1: not at all), as a series whose
     * instantaneous value is 1. */
    double hold, *give; /* equilibrium, and [ntimes] of the branches */
    bool has_cuts;      /* the map has cut cells */
    ph_tensor_table mixed, whole;
} ph_relaxing_map;

/** @param[in] map made of `micro`; borrowed, its tensors are changed from now on
 *  @param[in] soft the phase that (S) follows, or -1
 *  @return PH_OK; PH_ESINGULAR (a series that cannot be reduced to the plane); PH_ENOMEM */
ph_status ph_i_relaxing_map_new(ph_stiffness_map *map, const ph_microstructure *micro,
                                int soft, ph_meter *meter, ph_relaxing_map **out,
                                ph_error *err);
/** The map is left with the tensors of its cut cells as they were last. */
void ph_i_relaxing_map_free(ph_relaxing_map **relaxing);

/** Weighted phases and the laminates of them. @param[in] weight [ntimes] */
ph_status ph_i_relaxing_map_mixed(ph_relaxing_map *relaxing, double infinity,
                                  const double *weight, ph_error *err);
/** Show the mixed tensors again, as they were last. */
void ph_i_relaxing_map_again(ph_relaxing_map *relaxing);
/** Weighted phases, cut cells empty. Phases that the sum leaves without stiffness are empty. */
void ph_i_relaxing_map_whole(ph_relaxing_map *relaxing, double infinity,
                             const double *weight);
/** Give the cut cells of the whole tensors that are shown the mean of the phases, which is
 *  good enough for an estimate; and empty them again. */
void ph_i_relaxing_map_fill_cuts(ph_relaxing_map *relaxing);
void ph_i_relaxing_map_empty_cuts(ph_relaxing_map *relaxing);
/** The weighted sum of the factor of (S). */
double ph_i_relaxing_stabilisation(const ph_relaxing_map *relaxing, double infinity,
                                   const double *weight);
/** The weighted sum of one phase. */
ph_sym4 ph_i_relaxing_phase(const ph_relaxing_map *relaxing, int material,
                            double infinity, const double *weight);

#endif
