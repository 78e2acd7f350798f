/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables for people. */
#ifndef TOOLS_REPORT_H
#define TOOLS_REPORT_H

#include <perihom.h>

#include <stdio.h>

/** A result: constants with units beside their bounds, stiffness, how it was solved, what
 *  it is worth and what it cost. */
void report_result(FILE *to, const ph_case *c, const ph_result *result);
/** "1.5 GB", "20 kB" ... @return text */
const char *report_bytes(size_t bytes, char text[32]);
/** "0.04 s", "3 min", "2.5 h" ... @return text */
const char *report_seconds(double seconds, char text[32]);
/** A kinematic assumption in words. */
const char *report_kinematics(ph_kinematics kin);

#endif
