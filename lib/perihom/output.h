/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PERIHOM_OUTPUT_H
#define PERIHOM_OUTPUT_H

#include <perihom/case.h>

#ifdef __cplusplus
extern "C" {
#endif

/** The result document (schema perihom.result/1) as JSON text, malloc'd.
 *  @param[in] c the case it came from, or NULL. Numbers have 17 digits; what is not a
 *  number is null with its reason under "reasons". */
PH_API ph_status ph_result_to_json(const ph_result *result, const ph_case *c, char **json,
                                   ph_error *err);
/** Write text to a file so that a reader sees the old file or the new one, never half. */
PH_API ph_status ph_write_file(const char *path, const char *text, size_t length,
                               ph_error *err);
/** Phases and, if kept, the fields of every load: `base`.h5 and `base`.xdmf. */
PH_API ph_status ph_write_fields(const char *base, const ph_microstructure *micro,
                                 const ph_result *result, ph_error *err);
/** A picture of a scalar cell field: 2D as it is, 3D the slice through the middle of
 *  `axis` (1, 2 or 3). Colour bar with its range, title on top. Axis 1 to the right, axis 2 up. */
PH_API ph_status ph_write_png(const char *path, const ph_grid *grid, const double *value,
                              int axis, const char *title, ph_error *err);
/** A picture of the phases, one colour a material with a legend; cut cells are mixed. */
PH_API ph_status ph_write_phases_png(const char *path, const ph_microstructure *micro,
                                     int axis, const char *title, ph_error *err);

#ifdef __cplusplus
}
#endif
#endif
