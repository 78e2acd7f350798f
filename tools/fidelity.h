/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Automatic fidelity in words. */
#ifndef TOOLS_FIDELITY_H
#define TOOLS_FIDELITY_H

#include <perihom_fidelity.h>
#include <stdio.h>

/** What `run` will begin with, as comment lines of `check`. */
void fidelity_print_plan(FILE *to, const ph_case *c, const ph_fidelity_plan *plan);
/** Steps and reasons, under a result. */
void fidelity_print(FILE *to, const ph_fidelity *fidelity);

#endif
