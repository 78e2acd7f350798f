/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cases that are larger than the machine are refused before they fill it. */
#ifndef PERIHOM_TOOLS_MEMORY_H
#define PERIHOM_TOOLS_MEMORY_H

#include <perihom.h>

/** Bytes that this process may have: the memory of the machine, or the limit of the process
 *  (ulimit -v) where that is less; 0 where the system does not say. */
double memory_here(void);

/** Refuse a case whose cells alone do not fit, before they are built.
 *  @param[in] solves the case will be solved: the vectors of a solver count too
 *  @return PH_OK; PH_ENOMEM. Tested: tests/cli/memory.t */
ph_status memory_check_cells(const ph_case *c, bool solves, ph_error *err);

/** Refuse a problem that would not fit. @return PH_OK; PH_ENOMEM; as ph_homogenise_estimate */
ph_status memory_check_problem(const ph_problem *problem, ph_error *err);

#endif
