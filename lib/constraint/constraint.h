/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What closes the RVE problem: the box that is solved, which of its cells are averaged and
 * which of its nodes are free. */
#ifndef PH_CONSTRAINT_CONSTRAINT_H
#define PH_CONSTRAINT_CONSTRAINT_H

#include <perihom/homogenise.h>

#include "core/check.h"

/** A periodic box with the RVE in it. */
typedef struct ph_setting {
    ph_grid box;
    ptrdiff_t *source;  /* [cells] see ph_i_stiffness_map_new; NULL: the box is the RVE */
    uint8_t *region;    /* [cells] averaged; NULL: all */
    uint8_t *fixed;     /* [nodes] fluctuation held at zero; NULL: none */
    ptrdiff_t averaged; /* cells in the region */
    ptrdiff_t first[3]; /* cell of the box where the RVE begins */
} ph_setting;

typedef struct ph_constraint_method {
    ph_entry info;
    bool analytic;  /* voigt, reuss: no equations are solved */
    bool by_stress; /* the load is a macro stress, the answer a compliance */
    bool bounded;   /* nodes are held, or end at the faces of the RVE: steers `auto` */
    ph_status (*prepare)(const ph_problem *problem, const ph_family *family,
                         ph_setting *setting, ph_error *err);
} ph_constraint_method;

extern const ph_constraint_method ph_constraints[];
extern const size_t ph_nconstraints;

/** By name; NULL: periodic. Returns NULL for an unknown name. */
const ph_constraint_method *ph_i_constraint_find(const char *name);
void ph_i_setting_clear(ph_setting *setting);

#endif
