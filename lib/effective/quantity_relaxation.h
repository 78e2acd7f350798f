/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Quantities of an effective relaxation: E1(t=10), C11_storage(omega=2) ... */
#ifndef PH_EFFECTIVE_QUANTITY_RELAXATION_H
#define PH_EFFECTIVE_QUANTITY_RELAXATION_H

#include <perihom/quantity.h>

/** q->argument: the constant; q->row: 0 in time, 1 storage, 2 loss, 3 tan delta; q->at. */
bool ph_i_relaxing_parse(ph_quantity *q);
const char *ph_i_relaxing_word(size_t i);
const char *ph_i_relaxing_refuses(const ph_quantity *q, ph_kinematics kin);
unsigned ph_i_relaxing_loads(const ph_quantity *q, ph_kinematics kin);
ph_status ph_i_relaxing_value(const ph_quantity *q, const ph_result *r, double *out,
                              ph_error *err);

#endif
