/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inside of the readers of YAML documents, the case file and those of campaigns: text -> tree of nodes (case_yaml.c), overrides put into the
 * tree (case_set.c), typed reads that collect complaints (case_read.c), one file a section. */
#ifndef PH_IO_CASE_INTERNAL_H
#define PH_IO_CASE_INTERNAL_H

#include <perihom/case.h>

#include "core/check.h"

typedef enum ph_i_kind { PH_I_SCALAR, PH_I_LIST, PH_I_MAP } ph_i_kind;

/** A value of the document. Aliases are copied, so every node has one parent. */
typedef struct ph_i_node {
    ph_i_kind kind;
    bool plain;    /* scalar without quotes: may be a number, a flag or null */
    bool from_set; /* came with --set */
    int line;      /* of its key, or of itself in a list; 0: --set */
    struct ph_i_node *parent;
    char *key;         /* in a map, else NULL */
    size_t index;      /* in the parent */
    char *text;        /* scalar: UTF-8 without NUL */
    const char *meant; /* an unknown key: the known one that it looks like */
    size_t count, capacity;
    struct ph_i_node **child;
} ph_i_node;

/** The admissible words of a key. */
typedef struct ph_i_names {
    const char *const *name;
    size_t count;
} ph_i_names;

/** What one reading carries along. */
typedef struct ph_i_reader {
    const char *file; /* name in messages */
    ph_case_issues *issues;
    size_t invalid, unphysical; /* complaints by status, warnings in neither */
    const char *set;            /* key path of the --set being read, else NULL */
    bool out_of_memory;
    ph_case *c;
    ph_i_names materials; /* names in the case's order; count 0: section unusable */
    const char **material_names; /* owned: the array of `materials` */
    int dimension;               /* 2, 3, or 0 where the case does not say */
    bool automatic;              /* `accuracy` is there: nodes need not be */
} ph_i_reader;

/* ---- case_yaml.c */

/** Parse one YAML document. `*root` stays NULL where the text is no usable document; the
 *  reason is then a complaint. With r->set it is the value of an override.
 *  @return PH_OK (complaints or not); PH_ENOMEM */
ph_status ph_i_tree_parse(ph_i_reader *r, const char *text, size_t length,
                          ph_i_node **root, ph_error *err);
void ph_i_tree_free(ph_i_node **node);
/** A new node at the end of a list or map; owned by it. @param[in] key NULL in a list */
ph_status ph_i_tree_append(ph_i_node *parent, const char *key, ph_i_node *child,
                           ph_error *err);

/** The node as YAML of one line (malloc'd), which parses to the same again: the value of an
 *  override. NULL: no memory. */
char *ph_i_tree_text(const ph_i_node *node);
/** Folder part of a path: "." where it has none, "/" for the root. */
void ph_i_folder_of(const char *path, char *folder, size_t size);

/* ---- case_set.c */

/** Put "key.path=value" into the tree; what is wrong with it is a complaint. */
ph_status ph_i_tree_set(ph_i_reader *r, ph_i_node **root, const char *set, ph_error *err);

/* ---- case_read.c: complaints. `status` is PH_EINVAL or PH_EUNPHYSICAL; PH_OK: warning. */

/** "path: text". @param[in] at node it is about, or NULL for the whole file */
void ph_i_complain(ph_i_reader *r, const ph_i_node *at, ph_status status, const char *fmt,
                   ...) PH_PRINTF(4, 5);
/** The same about a key that the map `at` has not. */
void ph_i_complain_key(ph_i_reader *r, const ph_i_node *at, const char *key,
                       ph_status status, const char *fmt, ...) PH_PRINTF(5, 6);
/** The same at a line that has no node. */
void ph_i_complain_line(ph_i_reader *r, int line, const char *fmt, ...) PH_PRINTF(3, 4);
/** "path: VALUE is not admissible: rule". */
void ph_i_reject(ph_i_reader *r, const ph_i_node *at, ph_status status, const char *fmt,
                 ...) PH_PRINTF(4, 5);
/** "path.key: missing: rule"; silent where an unknown key was taken for a misspelt `key`. */
void ph_i_missing(ph_i_reader *r, const ph_i_node *map, const char *key, const char *fmt,
                  ...) PH_PRINTF(4, 5);

/** What all complaints come to, in the order of the file, the first in `err`.
 *  @return PH_OK (warnings at most); PH_EINVAL; PH_EUNPHYSICAL; PH_ENOMEM */
ph_status ph_i_verdict(ph_i_reader *r, ph_error *err);

/* ---- case_read.c: typed reads. False or -1 after a complaint; `rule` says what is
 * admissible ("Young's modulus must be a number > 0"). */

/** Child of a map, NULL where there is none or it is null. */
const ph_i_node *ph_i_get(const ph_i_node *map, const char *key);
/** Child that must be there. */
const ph_i_node *ph_i_need(ph_i_reader *r, const ph_i_node *map, const char *key,
                           const char *rule);
/** Complain about every key not in `known`; call it before ph_i_need. */
void ph_i_check_keys(ph_i_reader *r, const ph_i_node *map, ph_i_names known,
                     const char *what);
bool ph_i_is_null(const ph_i_node *node);
bool ph_i_is_word(const ph_i_node *node, const char *word);
bool ph_i_read_map(ph_i_reader *r, const ph_i_node *node, const char *rule);
/** A list of `count` entries (any number if `count` is 0). */
bool ph_i_read_list(ph_i_reader *r, const ph_i_node *node, size_t count,
                    const char *rule);
/** Finite number inside the open interval (lo, hi). */
bool ph_i_read_number(ph_i_reader *r, const ph_i_node *node, double lo, double hi,
                      const char *rule, double *out);
/** Number > 0 of a magnitude that can be squared and inverted. */
bool ph_i_read_positive(ph_i_reader *r, const ph_i_node *node, const char *rule,
                        double *out);
bool ph_i_read_integer(ph_i_reader *r, const ph_i_node *node, int64_t lo, int64_t hi,
                       const char *rule, int64_t *out);
/** List of `count` finite numbers, each a length > 0 where `positive`. */
bool ph_i_read_numbers(ph_i_reader *r, const ph_i_node *node, size_t count, bool positive,
                       const char *rule, double *out);
/** A direction: 3 numbers, not all zero. */
bool ph_i_read_direction(ph_i_reader *r, const ph_i_node *node, const char *rule,
                         double out[3]);
bool ph_i_read_flag(ph_i_reader *r, const ph_i_node *node, bool *out);
/** Printable text of less than `size` bytes. */
bool ph_i_read_text(ph_i_reader *r, const ph_i_node *node, size_t size, char *out);
/** Index of the word in `names`. */
int ph_i_read_name(ph_i_reader *r, const ph_i_node *node, ph_i_names names);
/** Index of a material of the case. */
int ph_i_read_material(ph_i_reader *r, const ph_i_node *node);
/** "a, b or c", cut at `size`. */
void ph_i_join_names(ph_i_names names, const char *last, char *out, size_t size);

/* ---- case_names.c: the words of the format, one place */

extern const ph_i_names ph_i_model_names;
extern const ph_i_names ph_i_later_model_names; /* known, not in this version */
extern const ph_i_names ph_i_points_names;      /* in the order of ph_points */
extern const ph_i_names ph_i_influence_names;
extern const ph_i_names ph_i_weight_names;
extern const ph_i_names ph_i_micromodulus_names;
extern const ph_i_names ph_i_calibration_names; /* in the order of ph_calibration */
extern const ph_i_names ph_i_constraint_names;
extern const ph_i_names ph_i_solver_names;
extern const ph_i_names ph_i_precision_names;
extern const ph_i_names ph_i_interface_names; /* in the order of ph_interface */
extern const ph_i_names ph_i_plane_names;     /* generalised_strain, strain, stress */
extern const ph_i_names ph_i_raw_type_names;
extern const ph_i_names ph_i_route_names;     /* of viscoelastic */
extern const ph_i_names ph_i_component_names; /* 11 22 33 23 13 12 */
/** Index of a component in the order of the case, -1 after a complaint. */
int ph_i_read_component(ph_i_reader *r, const ph_i_node *node);
extern const ph_i_names ph_i_filler_names;   /* platelet, fibre, particle */
extern const ph_i_names ph_i_amount_names;   /* in the order of ph_amount */
extern const ph_i_names ph_i_counting_names; /* in the order of ph_counting */
extern const ph_i_names ph_i_tip_names;      /* in the order of ph_crack_tip */

/* ---- one function a section; `node` is NULL where the section is not given */

ph_status ph_i_read_materials(ph_i_reader *r, const ph_i_node *root, ph_error *err);
/** E, bulk or shear as a number or {infinity, terms}, stiffness as {infinity, terms}: is
 *  this material a viscoelastic one? */
bool ph_i_is_relaxing(const ph_i_node *map);
/** The series of such a material; its stiffness and series at the case's temperature. */
ph_status ph_i_read_relaxation(ph_i_reader *r, const ph_i_node *map, ph_material *out,
                               ph_case_relaxation *relaxation, ph_error *err);
void ph_i_relaxation_clear(ph_case_relaxation *relaxation);
/** 6 rows of 6 numbers. */
bool ph_i_read_matrix(ph_i_reader *r, const ph_i_node *node, double voigt[36]);
/** `rotation` or `euler`. @return whether R was read; `*good` false where something is there
 *  but wrong */
bool ph_i_read_rotation(ph_i_reader *r, const ph_i_node *map, double R[9], bool *good);
/** Keys of `map` that do not go with `kind`. */
void ph_i_refuse_others(ph_i_reader *r, const ph_i_node *map, const char *kind,
                        ph_i_names allowed);
/** "material 'ply': stiffness must ..." without the name, which the key path says. */
const char *ph_i_without_name(const ph_error *why, const char *name);
void ph_i_read_temperature(ph_i_reader *r, const ph_i_node *root);
ph_status ph_i_read_viscoelastic(ph_i_reader *r, const ph_i_node *node, ph_error *err);
ph_status ph_i_read_microstructure(ph_i_reader *r, const ph_i_node *root, ph_error *err);
ph_status ph_i_read_inclusions(ph_i_reader *r, const ph_i_node *list, ph_error *err);
ph_status ph_i_read_fillers(ph_i_reader *r, const ph_i_node *list, ph_error *err);
/** The interphase factor of the fillers becomes that of the model. */
void ph_i_take_kappa(ph_i_reader *r);
/** `cracks` and `sequence`. */
ph_status ph_i_read_cracks(ph_i_reader *r, const ph_i_node *root, ph_error *err);
void ph_i_cracks_free(ph_case *c);
/** `failure` and `loading`. */
ph_status ph_i_read_failure(ph_i_reader *r, const ph_i_node *root, ph_error *err);
void ph_i_failure_free(ph_case *c);
/** A number or a distribution, every value in [lo, hi], above lo where `open`. */
void ph_i_read_distribution(ph_i_reader *r, const ph_i_node *node, const char *what,
                            double lo, double hi, bool open, ph_distribution *d);
void ph_i_read_voxels(ph_i_reader *r, const ph_i_node *node);
void ph_i_read_model(ph_i_reader *r, const ph_i_node *node);
void ph_i_read_constraint(ph_i_reader *r, const ph_i_node *node);
void ph_i_read_solver(ph_i_reader *r, const ph_i_node *node);
void ph_i_read_output(ph_i_reader *r, const ph_i_node *node);
void ph_i_read_error_bar(ph_i_reader *r, const ph_i_node *node);
/** `accuracy` and `budget`, after everything else. */
void ph_i_read_accuracy(ph_i_reader *r, const ph_i_node *root);

#define PH_I_NAMES(array)                                                                \
    {                                                                                    \
        (array), sizeof(array) / sizeof((array)[0])                                      \
    }

#endif
