/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a run with a loading leaves in its folder, and says. */
#ifndef TOOLS_FAILURE_H
#define TOOLS_FAILURE_H

#include <perihom.h>

#include "destination.h"

#include <stdio.h>

/** stress-strain.csv and .svg, events.csv, and the damage of the steps that the case asks for
 *  on one sheet (damage-steps.png). */
ph_status failure_write(const destination *to, const ph_case *c, const ph_result *result,
                        ph_error *err);
void failure_print(FILE *to, const ph_case *c, const ph_failure_path *path);

#endif
