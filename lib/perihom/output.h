/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What leaves the program. Every file appears under its name only when it is complete; a
 * call that fails leaves the old file as it was and nothing else behind. */
#ifndef PERIHOM_OUTPUT_H
#define PERIHOM_OUTPUT_H

#include <perihom/case.h>
#include <perihom/damage_law.h>
#include <perihom/relaxation.h>
#include <perihom/viscoelastic.h>

#ifdef __cplusplus
extern "C" {
#endif

/** The result document (schema perihom.result/1, docs/results.md) as JSON text, malloc'd.
 *
 *  Numbers have 17 digits, so a double comes back as it was. What is not a number is null,
 *  and "reasons" says why under its dotted path. Columns of load cases that were not solved
 *  are null, and so is everything that needs them.
 *  @param[in]  c       the case it came from, or NULL
 *  @param[in]  command the command line to record, or NULL
 *  @param[out] json    untouched on failure
 *  @return PH_OK; PH_EINVAL; PH_ENOMEM. Tested: tests/io/test_result_json.c */
PH_API ph_status ph_result_to_json(const ph_result *result, const ph_case *c,
                                   const char *command, char **json, ph_error *err);

/** What is asked of an effective relaxation, evaluated. Owns its parts. Of a route without
 *  series (stepping, frequency) it has what that computed, components only; series,
 *  constants and terms are then NULL, and so is what was not computed. */
typedef struct ph_relaxation_report {
    ph_prony *series; /* compressed where the case asks for it, else as computed */
    double fit_error; /* of the compression, see ph_prony_compress; 0: none */
    ph_constants *constants;
    ph_table *curves;   /* "time", C11 ... */
    ph_table *dynamic;  /* "omega", C11_storage, ... */
    ph_table *terms;    /* "time", C11 ... */
    ph_table *response; /* "time", strain_11 ..., stress_11 ...; NULL without a history */
} ph_relaxation_report;
/** @param[in] v with a series or curves; `wanted` the case's, or NULL: automatic.
 *  @return PH_OK; PH_EINVAL (neither); PH_ESINGULAR (history of stress, no compliance);
 *  PH_ENOMEM. Tested: tests/io/test_relaxation_report.c */
PH_API ph_status ph_relaxation_report_new(const ph_viscoelastic *v,
                                          const ph_case_viscoelastic *wanted,
                                          ph_relaxation_report **out, ph_error *err);
PH_API void ph_relaxation_report_free(ph_relaxation_report **report);

/** The result document of a viscoelastic computation: that of the instantaneous problem
 *  (ph_result_to_json) with the block effective.viscoelastic (docs/results.md).
 *  @param[in] report of v, or NULL where the route gives no series */
PH_API ph_status ph_viscoelastic_to_json(const ph_viscoelastic *v,
                                         const ph_relaxation_report *report,
                                         const ph_case *c, const char *command,
                                         char **json, ph_error *err);
/** A series as `stiffness` of a material of a case file (YAML), malloc'd. n = 6 only. */
PH_API ph_status ph_prony_to_yaml(const ph_prony *p, const char *name, char **text,
                                  ph_error *err);

/** The steps of damage as a table, one row a step: value, density, C11 .. (Voigt, upper
 *  triangle), psi1 .., anisotropy_index, mean_damage, counts. The text is malloc'd.
 *  @return PH_OK; PH_ENOMEM. Tested: tests/unit/test_cracks.c */
PH_API ph_status ph_damage_to_csv(const ph_damage *damage, char **text, ph_error *err);

/** A damage law as a table, one row a knot: damage, begin and end of the segment that leads to
 *  it (empty: none), C11 .. (Voigt, upper triangle). malloc'd.
 *  @return PH_OK; PH_ENOMEM. Tested: tests/laws/test_damage_law.c */
PH_API ph_status ph_damage_law_to_csv(const ph_damage_law *law, char **text,
                                      ph_error *err);

/** The steps of a loading as a table: load, stress_11 .., conjugate_stress, broken_bonds and
 *  the energies; and its events: load, stress before and after, the same. malloc'd.
 *  @return PH_OK; PH_EINVAL; PH_ENOMEM. Tested: tests/verify/test_failure.c */
PH_API ph_status ph_failure_steps_csv(const ph_failure_path *path, char **text,
                                      ph_error *err);
PH_API ph_status ph_failure_events_csv(const ph_failure_path *path, char **text,
                                       ph_error *err);

/** Write text to a file so that a reader sees the old file or the new one, never half: a
 *  temporary file in the same folder, fsync, rename. A symbolic link is followed; a device
 *  or a pipe (/dev/stdout) is written in place.
 *  @return PH_OK; PH_EIO with what the system says (no space, no permission, no folder).
 *  Tested: tests/io/test_write_file.c */
PH_API ph_status ph_write_file(const char *path, const char *text, size_t length,
                               ph_error *err);

/** Phases, cuts and materials and, if kept, the fields of every load: `base`.h5 and
 *  `base`.xdmf, which ParaView and meshio open. Layout: docs/results.md.
 *
 *  HDF5 arrays are indexed [z][y][x] (2D: one layer), x fastest, as XDMF wants it. Displacement
 *  of nodal models is cell data. Where displacement lives at the corners and is periodic
 *  around the affine field (constraints periodic and linear_displacement), it is node data
 *  on the closed mesh, continued by the macro strain to the far faces, ready for warping.
 *  @param[in] result with the fields, or NULL: the microstructure alone
 *  @param[in] c      for title and units, or NULL
 *  @return PH_OK; PH_EINVAL (grids differ); PH_EIO; PH_ENOMEM. HDF5 is not thread-safe: one
 *          call at a time. Memory: two scalar fields. Tested: tests/io/test_fields.c */
PH_API ph_status ph_write_fields(const char *base, const ph_microstructure *micro,
                                 const ph_result *result, const ph_case *c,
                                 ph_error *err);

/** What ph_write_fields wrote, in memory again. Owns its arrays. */
typedef struct ph_fields_file {
    char title[256];
    char unit_length[32], unit_stress[32];
    char git[64]; /* revision that wrote the file */
    ph_microstructure *micro;
    unsigned loads;      /* bit a: the file has the fields of load a */
    int nsteps;          /* of damage, see ph_read_fields_step */
    char step_value[16]; /* what the value of a step is: "load", "crack_length" ... */
    int nfields;
    ph_fields *fields; /* [nfields], those that were asked for */
} ph_fields_file;

/** Read a fields file. @param[in] loads bit a: read the fields of load a; ~0u: all.
 *  @return PH_OK; PH_EIO (missing, not HDF5, cut off, not ours); PH_EINVAL (contents not
 *          admissible); PH_ENOMEM. Tested: tests/io/test_fields.c */
PH_API ph_status ph_read_fields(const char *path, unsigned loads, ph_fields_file **out,
                                ph_error *err);
PH_API void ph_fields_file_free(ph_fields_file **file);

/** One step of damage. Owns its arrays. */
typedef struct ph_fields_step {
    double value;   /* load, crack length, density; else the number of the step */
    double *damage; /* [cells] */
    int nfields;
    ph_fields *fields; /* those asked for; of a loading the one at its load, `load` -1 */
} ph_fields_step;

/** Read a step of a fields file. @param[in] grid of the file @param[in] step from 0
 *  @param[in] loads bit a: the fields of load a; 0: the damage alone
 *  @return as ph_read_fields; PH_EINVAL: no such step. Tested: tests/io/test_fields.c */
PH_API ph_status ph_read_fields_step(const char *path, const ph_grid *grid, int step,
                                     unsigned loads, ph_fields_step **out, ph_error *err);
PH_API void ph_fields_step_free(ph_fields_step **step);

/** A picture of a scalar cell field: 2D as it is, 3D the slice through the middle of
 *  `axis` (1, 2 or 3). Colour bar with its range, title on top. Of the two axes that are
 *  left the first points to the right, the second up. Dark to bright is low to high with
 *  even steps in lightness; a field with both signs gets blue and red around zero. Cells
 *  that are NaN are grey. @param[in] value [cells]; title ASCII, may be NULL.
 *  @return PH_OK; PH_EINVAL; PH_EIO; PH_ENOMEM. Tested: tests/io/test_png.c */
PH_API ph_status ph_write_png(const char *path, const ph_grid *grid, const double *value,
                              int axis, const char *title, ph_error *err);
/** The same with colours from `low` to `high` > low, so that pictures of a series compare;
 *  values beyond have the colour of the end. */
PH_API ph_status ph_write_png_range(const char *path, const ph_grid *grid,
                                    const double *value, int axis, const char *title,
                                    double low, double high, ph_error *err);
/** A picture of the phases, one colour a material with a legend; cut cells are mixed. */
PH_API ph_status ph_write_phases_png(const char *path, const ph_microstructure *micro,
                                     int axis, const char *title, ph_error *err);

#ifdef __cplusplus
}
#endif
#endif
