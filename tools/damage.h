/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cases with cracks: what is printed, written and drawn of them. */
#ifndef TOOLS_DAMAGE_H
#define TOOLS_DAMAGE_H

#include <perihom.h>

#include "destination.h"

#include <stdio.h>

/** A line a step: moduli over those without cracks, anisotropy, damage. */
void damage_print(FILE *to, const char *length, const ph_damage *damage);
/** damage.csv, damage.png. */
ph_status damage_write(const destination *to, const ph_result *result, ph_error *err);
/** Curves over the steps of a result folder that has any, damage-moduli.png and
 *  damage-anisotropy.png. @param[in,out] drawn how many */
ph_status damage_view(const char *result, const char *folder, bool quiet, int *drawn,
                      ph_error *err);

#endif
