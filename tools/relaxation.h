/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cases whose materials relax: solving them, what is printed and what is written. */
#ifndef TOOLS_RELAXATION_H
#define TOOLS_RELAXATION_H

#include <perihom.h>

#include "destination.h"

#include <stdio.h>

/** Solve by the route of the case and evaluate what it asks for.
 *  @param[out] report NULL where the route gives no series */
ph_status relaxation_solve(const ph_case *c, const ph_problem *problem, const ph_ctx *ctx,
                           ph_viscoelastic **v, ph_relaxation_report **report,
                           ph_error *err);
/** Tables (CSV), plots (SVG) and the series (YAML) into the folder of the result. */
ph_status relaxation_write(const destination *to, const ph_case *c,
                           const ph_relaxation_report *report, ph_error *err);
/** PNG plots of the tables of a result folder that has any. @param[out] drawn how many */
ph_status relaxation_view(const char *result, const char *folder, bool quiet, int *drawn,
                          ph_error *err);
/** For people: the elastic part, both limits, terms, cost. */
void relaxation_print(FILE *to, const ph_case *c, const ph_viscoelastic *v,
                      const ph_relaxation_report *report);

#endif
