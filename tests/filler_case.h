/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cases of random fillers from one line of YAML. */
#ifndef TESTS_FILLER_CASE_H
#define TESTS_FILLER_CASE_H

#include <perihom_rve.h>

#include "check.h"

static inline ph_status filler_parse(int dim, int n, const char *fillers,
                                     const char *more, ph_case **c, ph_error *err)
{
    char text[4096], nodes[64];
    snprintf(nodes, sizeof nodes, dim == 3 ? "%d, %d, %d" : "%d, %d", n, n, n);
    snprintf(text, sizeof text,
             "perihom: 1\n"
             "materials:\n"
             "  m: {E: 1, nu: 0.3, density: 1156.5}\n"
             "  f: {E: 9, nu: 0.3, density: 1660}\n"
             "  i: {E: 3, nu: 0.3}\n"
             "microstructure:\n  dimension: %d\n%s  size: [%s]\n  nodes: [%s]\n"
             "  matrix: m\n%s  fillers: [%s]\n",
             dim, dim == 2 ? "  plane: strain\n" : "", dim == 2 ? "64, 64" : "64, 64, 64",
             nodes, more, fillers);
    return ph_case_parse(text, strlen(text), "t.yaml", NULL, 0, c, NULL, err);
}

static inline ph_case *filler_case(int dim, int n, const char *fillers, const char *more)
{
    ph_case *c = NULL;
    ph_error err = PH_ERROR_INIT;
    CHECK_OK(filler_parse(dim, n, fillers, more, &c, &err));
    if (!c) fail_msg("no case");
    return c;
}

#endif
