/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The inverse of the operator of a homogeneous medium, mode by mode. */
#ifndef PH_SOLVE_GREEN_H
#define PH_SOLVE_GREEN_H

#include "model/operator.h"

typedef struct ph_green {
    int nd, threads;
    ptrdiff_t modes;
    double *inverse; /* [nd (nd+1)/2][modes], packed as ph_i_operator_symbol */
} ph_green;

/** G(k) = P(k)^-1 for the medium C0; k = 0 and modes that P does not see get zero.
 *  @param[in] storage of `inverse`, the caller's; NULL: made, and released by _clear */
ph_status ph_i_green_init(ph_green *green, ph_operator *op, const ph_sym4 *C0,
                          double *storage, ph_error *err);
void ph_i_green_clear(ph_green *green, ph_meter *meter);
/** zhat = G rhat, [nd][modes] complex; may be in place. */
void ph_i_green_apply(const ph_green *green, const double *rhat, double *zhat);

#endif
