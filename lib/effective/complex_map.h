/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Storage and loss of every cell at one frequency: two tables of tensors for one map. */
#ifndef PH_EFFECTIVE_COMPLEX_MAP_H
#define PH_EFFECTIVE_COMPLEX_MAP_H

#include "model/relaxing_map.h"

/** A complex symmetric tensor. */
typedef struct ph_complex_tensor {
    ph_sym4 re, im;
} ph_complex_tensor;

/** x^2/(1+x^2) and x/(1+x^2), x = omega tau, which may overflow. */
double ph_i_storage_weight(double x);
double ph_i_loss_weight(double x);

/** ph_sym4_laminate of complex tensors, neither of them void.
 *  @return PH_OK; PH_ESINGULAR */
ph_status ph_i_complex_laminate(const ph_complex_tensor *c1, const ph_complex_tensor *c2,
                                double fraction2, const double normal[3],
                                ph_complex_tensor *out, ph_error *err);

typedef struct ph_complex_map {
    ph_relaxing_map *relax; /* borrowed; its mixed table holds the storage */
    ph_tensor_table loss;
    size_t reserved;
    double *weight;           /* [ntimes] */
    ph_complex_tensor *phase; /* [materials] */
    double stabilise[2];      /* factor of (S): storage, loss */
} ph_complex_map;

ph_status ph_i_complex_map_new(ph_relaxing_map *relax, ph_complex_map **out,
                               ph_error *err);
void ph_i_complex_map_free(ph_complex_map **map);

/** C*(i omega) of every phase and cut cell. @param[in] measure false: as it is; true: show
 *  real tensors of that size instead, C' + C'', of which a preconditioner is made. */
ph_status ph_i_complex_map_set(ph_complex_map *map, double omega, bool measure,
                               ph_error *err);
/** Show the storage or the loss tensors. */
void ph_i_complex_map_show(ph_complex_map *map, bool loss);

#endif
