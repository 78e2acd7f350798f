/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PERIHOM_CASE_H
#define PERIHOM_CASE_H

#include <perihom/homogenise.h>

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** One inclusion of a case file, as written. Lengths in case units, angles in degrees.
 *  Which members count depends on the shape; NaN means not given. */
typedef struct ph_inclusion {
    char shape[32]; /* name in the catalogue of shapes */
    int line;       /* in the case file */
    int material;   /* index into the case's materials */
    double centre[3];
    double radius;       /* disk, sphere, cylinder */
    double fraction;     /* disk, sphere: volume fraction instead of radius */
    double semi_axes[3]; /* ellipse (2), ellipsoid (3) */
    double size[3];      /* box */
    double angle;        /* ellipse, box: about axis 3 */
    double axis[3];  /* ellipsoid: direction of the first semi-axis; cylinder: its axis */
    double length;   /* cylinder */
    int normal;      /* layer: 1, 2 or 3; 0: not given */
    double from, to; /* layer */
} ph_inclusion;

/** A voxel file instead of matrix and inclusions. */
typedef struct ph_voxels {
    char file[512]; /* "" : none; relative to the case file's folder */
    char dataset[128];
    int nmaterials;
    int materials[256]; /* material of voxel value v, or -1 where value v has none */
    char type[16];      /* .raw: "uint8", "uint16", "int32" */
    int line;
} ph_voxels;

/** A case file, parsed and checked. Owns its arrays; everything else is a value. */
typedef struct ph_case {
    char path[512];   /* as given, or "" */
    char folder[512]; /* of the file, for relative paths */
    char title[256];
    char unit_length[32], unit_stress[32], unit_time[32];
    int nmaterials;
    ph_material *materials;
    ph_kinematics kinematics;
    ptrdiff_t nodes[3]; /* zeros: take them from the voxel file */
    double size[3];
    int matrix;
    int ninclusions;
    ph_inclusion *inclusions;
    ph_voxels voxels;
    ph_interface interface;
    uint64_t seed;
    ph_model_params model; /* strings point to catalogue names */
    ph_constraint_params constraint;
    ph_solver_params solver;
    bool fields;
} ph_case;

/** One complaint about a case file. */
typedef struct ph_case_issue {
    int line;          /* 1-based, 0: --set or the file as a whole */
    bool warning;      /* the case can be used as it is */
    char message[400]; /* "key.path: ...", one line without the file's name */
} ph_case_issue;

/** All complaints, in the order of the file. Zeroed to begin with; freed by _free. */
typedef struct ph_case_issues {
    size_t count, capacity;
    ph_case_issue *item;
} ph_case_issues;
PH_API void ph_case_issues_free(ph_case_issues *issues);
/** The line that people read: "file.yaml:14: materials.fibre.nu: 0.62 is not admissible: ...",
 *  "file.yaml: --set ...". @param[in] name of the file; @param[out] text cut at `size` */
PH_API void ph_case_issue_text(const ph_case_issue *issue, const char *name, char *text,
                               size_t size);

/** Read a case file.
 *  @param[in] sets   overrides "key.path=value" (YAML values), applied before checking
 *  @param[out] issues every complaint of the file, each with line, key, value, what is
 *              admissible and the nearest known key; NULL to get only the first in `err`
 *  @return PH_OK (issues then hold warnings only); with `out` NULL: PH_EUNPHYSICAL where all
 *  that is wrong is physics (nu = 0.62), else PH_EINVAL; PH_EIO; PH_ENOMEM. `err` gets the
 *  first complaint as ph_case_issue_text writes it.
 *  Format: docs/case-file.md. Tested: tests/io/test_case.c, tests/io/test_bad_cases.c */
PH_API ph_status ph_case_read(const char *path, const char *const *sets, size_t nsets,
                              ph_case **out, ph_case_issues *issues, ph_error *err);
/** The same from text; `name` stands for the file in messages. */
PH_API ph_status ph_case_parse(const char *text, size_t length, const char *name,
                               const char *const *sets, size_t nsets, ph_case **out,
                               ph_case_issues *issues, ph_error *err);
PH_API void ph_case_free(ph_case **c);
/** The resolved case as JSON text (malloc'd, caller frees), with every default filled in. */
PH_API ph_status ph_case_to_json(const ph_case *c, char **json, ph_error *err);

#ifdef __cplusplus
}
#endif
#endif
