/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What writer, reader and XDMF of the fields agree on. */
#ifndef PH_IO_FIELDS_H
#define PH_IO_FIELDS_H

#include <perihom/output.h>

#include "core/check.h"

#include <hdf5.h>

#define PH_I_FIELDS_SCHEMA "perihom.fields/1"

/** "11", "12" ...: Voigt component `a` of n = 3 or 6. */
const char *ph_i_voigt_name(int n, int a);
/** Whether displacement goes to the (n+1) nodes of the closed mesh: it lives at the corners
 *  and is affine plus periodic. Else it is cell data. */
bool ph_i_displacement_at_nodes(const ph_result *result);
/** Extents of the arrays, slowest first ([z][y][x], 2D: one layer) with `extra` more per
 *  axis that the fields vary along (1: nodes of the closed mesh). */
void ph_i_array_shape(const ph_grid *grid, int extra, hsize_t shape[3]);

/** Names of ph_kinematics in files. */
extern const char *const ph_i_kinematics_names[4];

/** One row of the table /materials. */
typedef struct ph_i_material_row {
    char name[64];
    int is_void, is_isotropic;
    double E, nu, density, fraction;
    double voigt[36]; /* stiffness, 6 x 6 */
} ph_i_material_row;
/** One row of the table /cuts: ph_cut with the cell as (i, j, k). */
typedef struct ph_i_cut_row {
    int64_t index[3];
    int base, material;
    double fraction, normal[3];
} ph_i_cut_row;
/** Their HDF5 types; close with H5Tclose. */
ph_status ph_i_material_type(hid_t *out, const char *path, ph_error *err);
ph_status ph_i_cut_type(hid_t *out, const char *path, ph_error *err);

/** Are there steps of damage with fields, and of step `number`: its name in /steps, its value
 *  (number where it has none), whether it has fields at its load, and those of unit loads. */
bool ph_i_has_steps(const ph_result *result);
#define PH_I_STEP_NAME "%04d"
double ph_i_step_value(const ph_result *result, int number);
bool ph_i_step_is_loaded(const ph_result *result, int number);
bool ph_i_step_has_loads(const ph_result *result, int number, const ph_fields **fields,
                         int *count);

/** The XDMF that describes `h5_name`, a file in the same folder; malloc'd. */
ph_status ph_i_xdmf_text(const char *h5_name, const ph_microstructure *micro,
                         const ph_result *result, const ph_case *c, char **text,
                         size_t *length, ph_error *err);

#endif
