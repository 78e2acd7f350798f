/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PH_RVE_STATISTICS_H
#define PH_RVE_STATISTICS_H

#include "perihom_rve.h"

/* filler[cell] != 0 where there is filler. Each fills its members of s. */
ph_status ph_i_percolation(const ph_grid *g, const uint8_t *filler, ph_statistics *s,
                           ph_error *err);
ph_status ph_i_filler_statistics(const ph_microstructure *m, const ph_packing *p,
                                 const uint8_t *filler, ph_statistics *s, ph_error *err);
/* Cell beside cell `at`, moved by `step`. */
ptrdiff_t ph_i_beside(const ph_grid *g, const ptrdiff_t at[3], const int step[3]);

#endif
