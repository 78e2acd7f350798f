/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PERIHOM_CASE_H
#define PERIHOM_CASE_H

#include <perihom/distribution.h>
#include <perihom/history.h>
#include <perihom/homogenise.h>
#include <perihom/quantity.h>
#include <perihom/shift.h>

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
    char owners[128];   /* .h5: dataset with the filler of each cell; "" : none */
    int line;
} ph_voxels;

/** How a random filler bends. */
typedef enum ph_curvature {
    PH_CURVATURE_NONE,
    PH_CURVATURE_ARC_ANGLE, /* subtended angle, degrees */
    PH_CURVATURE_RADIUS,    /* of the arc */
    PH_CURVATURE_HELIX,     /* radius and pitch; fibres in 3D */
    PH_CURVATURE_WORM       /* persistence length of a worm-like chain; fibres */
} ph_curvature;

typedef enum ph_orientation {
    PH_ORIENT_UNIFORM,
    PH_ORIENT_ALIGNED,   /* about an axis, spread = std of the angle to it */
    PH_ORIENT_VON_MISES, /* von Mises-Fisher about an axis, concentration */
    PH_ORIENT_TENSOR     /* second-order orientation tensor */
} ph_orientation;

/** How much of it there is, and how far apart. */
typedef enum ph_amount { PH_AMOUNT_WEIGHT, PH_AMOUNT_VOLUME, PH_AMOUNT_COUNT } ph_amount;
/** What counts as content of fillers thinner than the spacing. */
typedef enum ph_counting { PH_COUNT_AUTO, PH_COUNT_NODES, PH_COUNT_AREA } ph_counting;

/** A population of random fillers of a case file: `microstructure.fillers`. Lengths in case
 *  units, angles in degrees. Distributions not given have kind -1. */
typedef struct ph_filler {
    int line;
    char shape[16]; /* in ph_filler_shapes[]: "platelet", "fibre", "particle" */
    int material;
    ph_amount amount;
    double amount_value;
    ph_counting counting;
    ph_distribution thickness;    /* platelet; diameter of a fibre */
    ph_distribution aspect_ratio; /* length / thickness; particle: long / short axis */
    ph_distribution length;
    ph_distribution size;  /* particle: diameter, the short one of an ellipsoid */
    ph_distribution width; /* 3D platelet; not given: its length */
    bool disc;             /* 3D platelet: round, not rectangular */
    ph_curvature curvature;
    ph_distribution bend; /* arc angle, radius, helix radius, persistence length */
    ph_distribution pitch;
    ph_orientation orientation; /* of the length; 3D platelets: of the normal */
    double axis[3];             /* unit */
    double spread;              /* degrees */
    double concentration;
    double tensor[9];
    double gap;   /* least distance between surfaces; NaN: fillers may overlap */
    int clusters; /* agglomerates; 0: none */
    double cluster_radius, cluster_share;
    double interphase_kappa;     /* 0: not given */
    double interphase_thickness; /* 0: none */
    int interphase_material;
} ph_filler;

/** What a case file says of the relaxation of a material, at the reference temperature. */
typedef enum ph_relaxation_kind {
    PH_RELAXATION_NONE, /* elastic */
    PH_RELAXATION_E,
    PH_RELAXATION_BULK_SHEAR,
    PH_RELAXATION_TENSOR
} ph_relaxation_kind;
typedef struct ph_case_relaxation {
    ph_relaxation_kind kind;
    ph_modulus modulus[2]; /* E; or bulk and shear; owned */
    double nu;             /* of E */
    ph_prony *tensor;      /* rotated; owned */
    ph_shift shift;
    double factor; /* a_T at the temperature of the case; 1 where nothing shifts */
} ph_case_relaxation;

/** What is wanted of the relaxation: `viscoelastic` of a case file. */
typedef struct ph_case_viscoelastic {
    bool given;
    const char *route;  /* name of a route */
    double tolerance;   /* relative error of the effective tensor */
    int terms;          /* compress to so many; 0: as many as there are */
    double compression; /* compress to this relative error; 0: do not */
    int ntimes, nfrequencies;
    double *times, *frequencies; /* owned; increasing; NULL: chosen automatically */
    ph_history *history;         /* owned; or NULL */
} ph_case_viscoelastic;

typedef enum ph_crack_kind {
    PH_CRACKS_LINE,    /* from, to or points */
    PH_CRACKS_ELLIPSE, /* disk and ellipse */
    PH_CRACKS_POLYGON,
    PH_CRACKS_RANDOM /* a population: lines in 2D, disks in 3D */
} ph_crack_kind;

#define PH_MAX_CONSTANTS 16 /* of output.constants */

/** An entry of `cracks` of a case file. Lengths in case units, angles in degrees. */
typedef struct ph_crack_entry {
    int line;
    ph_crack_kind kind;
    ptrdiff_t npoints; /* line, polygon */
    double (*point)[3];
    bool disk;                   /* ellipse: with one radius */
    double centre[3], normal[3]; /* ellipse; random in 3D: aligned along normal */
    double axis[3];              /* ellipse: of the first semi-axis; NaN: any */
    double semi_axes[2];         /* ellipse */
    double density;              /* random; NaN: not given */
    ptrdiff_t count;             /* random; -1: not given */
    ph_distribution length;      /* random: tip to tip, or diameter */
    bool aligned;                /* random, else any direction */
    double angle;                /* random, 2D, aligned: to axis 1 */
} ph_crack_entry;

/** `sequence` of a case file. */
typedef struct ph_sequence_entry {
    int line;
    ph_sequence_kind kind;
    int nsteps;
    double *value;   /* [nsteps] */
    double range[3]; /* growth: from, step, to as they were given; NaN: a list was */
    ph_crack_tip tip;
    ptrdiff_t nwhich; /* growth: entries of `cracks` that grow; 0: all */
    int *which;
} ph_sequence_entry;

/** Settings that `accuracy` leaves to perihom unless the case gives them. */
enum {
    PH_SETTING_NODES = 1,
    PH_SETTING_POINTS = 2,
    PH_SETTING_HORIZON = 4,
    PH_SETTING_INTERFACE = 8,
    PH_SETTING_TOLERANCE = 16,
    PH_SETTING_MODEL = 32,
    PH_SETTING_PRECISION = 64
};
enum { PH_ACCURACY_CONSTANTS = 16 };

/** `accuracy` and `budget` of a case file: what is wanted in place of settings. */
typedef struct ph_case_accuracy {
    double relative; /* error of the worst constant; 0: not asked for */
    int nconstants;  /* 0: the engineering constants of the kinematics */
    char constant[PH_ACCURACY_CONSTANTS][96]; /* names of quantities */
    double seconds, memory; /* budget, wall clock and bytes; 0: no end */
    unsigned given; /* settings that the case gives, which stay: PH_SETTING_NODES ... */
} ph_case_accuracy;

/** A case file, parsed and checked. Owns its arrays; everything else is a value. */
typedef struct ph_case {
    char path[512];   /* as given, or "" */
    char folder[512]; /* of the file, for relative paths */
    char title[256];
    char unit_length[32], unit_stress[32], unit_time[32];
    char unit_temperature[8]; /* "K", "C"; "": not given */
    double temperature;       /* in this unit; NaN: not given */
    int nmaterials;
    ph_material *materials;         /* their series at the temperature of the case */
    ph_case_relaxation *relaxation; /* [nmaterials] as the file says it */
    ph_kinematics kinematics;
    ptrdiff_t nodes[3]; /* zeros: take them from the voxel file */
    double size[3];
    /* grid on which the fillers are placed, counted and drawn; zeros: nodes */
    ptrdiff_t drawn_on[3];
    int matrix;
    int ninclusions;
    ph_inclusion *inclusions;
    int nfillers;
    ph_filler *fillers; /* painted after the inclusions */
    ptrdiff_t ncracks;
    ph_crack_entry *cracks;
    ph_sequence_entry sequence;
    ph_failure_rule *strengths; /* [nmaterials], or NULL: not given */
    double *targets, *target_times;
    ph_failure failure; /* with `strengths` */
    ph_loading loading; /* with `targets`; none: not given */
    int pictures_every; /* steps of the loading between pictures; 0: the last one only */
    ph_voxels voxels;
    ph_interface interface;
    uint64_t seed;
    uint64_t realisation;  /* which of the random microstructures of this seed */
    ph_model_params model; /* strings point to catalogue names */
    ph_constraint_params constraint;
    ph_solver_params solver;
    ph_case_viscoelastic viscoelastic;
    unsigned error_parts; /* bit i: ph_error_parts[i] is estimated; 0: no error bars */
    ph_case_accuracy accuracy;
    bool fields;
    int nconstants; /* that are asked for; 0: the whole tensor */
    ph_quantity constants[PH_MAX_CONSTANTS];
} ph_case;

/** Whether a material of the case relaxes. */
PH_API bool ph_case_relaxes(const ph_case *c);

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

/** An error about a key of a case (`key` of ph_error), as a complaint of the reader: with file,
 *  line, key and what stands there; the file is read again.
 *  @param[in] sets  the overrides that the case was read with
 *  @param[out] text "file.yaml:15: model.horizon: 100 is not admissible: ...", cut at `size`
 *  @return false where it is about no key, or the file cannot be read any more; `text` is then
 *  untouched. Tested: tests/io/test_case.c */
PH_API bool ph_case_error_text(const char *path, const char *const *sets, size_t nsets,
                               const ph_error *about, char *text, size_t size);

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
