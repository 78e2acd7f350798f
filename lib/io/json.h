/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Building JSON documents: every helper takes over the values that it is given, a NULL value
 * means that memory ran out, and what is not a number becomes null with its reason. */
#ifndef PH_IO_JSON_H
#define PH_IO_JSON_H

#include <perihom/case.h>
#include <perihom/damage_law.h>
#include <perihom/error_bar.h>

#include "core/check.h"

#include <jansson.h>

/** obj[key] = value; steals `value`, also on failure. */
ph_status ph_i_json_put(json_t *obj, const char *key, json_t *value, ph_error *err);
/** Append `value` to an array; steals it, also on failure. */
ph_status ph_i_json_add(json_t *array, json_t *value, ph_error *err);
/** A string; bytes that are not UTF-8 become '?'. NULL text: null. */
json_t *ph_i_json_text(const char *text);
/** A number, or null where there is none (NaN, infinity). */
json_t *ph_i_json_number(double x);
/** Row-major matrix as rows; entries that are not finite are null. */
ph_status ph_i_json_matrix(int n, const double *a, json_t **out, ph_error *err);
/** obj[key] = x; if x is not finite, null, and reasons[path.key] = why. */
ph_status ph_i_json_put_number(json_t *obj, const char *path, const char *key, double x,
                               json_t *reasons, const char *why, ph_error *err);
/** The document as text with 17 digits, malloc'd. */
ph_status ph_i_json_dump(const json_t *document, char **text, ph_error *err);

/** A document from text, a new reference. @param[in] name of the file, for the message
 *  @return PH_OK; PH_EINVAL where it is not JSON or has a key twice; PH_ENOMEM */
ph_status ph_i_json_parse(const char *text, size_t length, const char *name,
                          json_t **document, ph_error *err);

/** The result document (result_json.c), a new reference. */
ph_status ph_i_result_document(const ph_result *result, const ph_case *c,
                               const char *command, json_t **document, ph_error *err);

/* Building without a status: jansson takes NULL for "that failed" and hands it on; *good turns
 * false where anything failed. All of them steal the value. */
void ph_i_json_set(json_t *object, const char *key, json_t *value, bool *good);
void ph_i_json_append(json_t *list, json_t *value, bool *good);
json_t *ph_i_json_numbers(const double *x, ptrdiff_t n, bool *good);

/** The resolved case (case_json.c). PH_EINVAL where it holds what JSON cannot; PH_ENOMEM. */
ph_status ph_i_case_json(const ph_case *c, json_t **out, ph_error *err);
/** `microstructure.fillers` (case_fillers_json.c); *good turns false where it fails. */
json_t *ph_i_fillers_to_json(const ph_case *c, bool *good);
json_t *ph_i_distribution_to_json(const ph_distribution *d, bool *good);
/** `cracks` and `sequence` (case_cracks_json.c). */
json_t *ph_i_cracks_to_json(const ph_case *c, bool *good);
json_t *ph_i_sequence_to_json(const ph_case *c, bool *good);
/** `failure` and `loading` (case_failure_json.c). */
json_t *ph_i_failure_to_json(const ph_case *c, bool *good);
json_t *ph_i_loading_to_json(const ph_case *c, bool *good);
/** `effective.failure` (failure_json.c). */
ph_status ph_i_json_failure(const ph_failure_path *path, json_t *effective,
                            json_t *reasons, ph_error *err);
/** `error_bar`, `error_parts` and `richardson` of `quality`, with reasons; `error_bar` of
 *  `cost` (error_bar_json.c). @param[in] bar NULL: an empty `error_bar` */
ph_status ph_i_json_error_bar(const ph_error_bar *bar, json_t *quality, json_t *reasons,
                              ph_error *err);
/** The bars alone: map[key] by constant. @param[in] linear only what is linear in the tensor */
ph_status ph_i_json_error_list(const ph_error_bar *bar, const char *path, bool linear,
                               json_t *map, const char *key, json_t *reasons,
                               ph_error *err);
/** Is a constant linear in the tensor: C_ij, isotropic.K and G? */
bool ph_i_is_linear(const ph_error_constant *k);
ph_status ph_i_json_error_cost(const ph_error_bar *bar, json_t *cost, ph_error *err);
/** `effective.damage` (damage_json.c). */
ph_status ph_i_json_damage(const ph_result *result, json_t *effective, json_t *reasons,
                           ph_error *err);
/** `effective.damage.law` of a result, null and a reason where there is none; and back: NULL
 *  where nothing drives it (damage_law_json.c). */
ph_status ph_i_json_damage_law(const ph_result *result, json_t *damage, json_t *reasons,
                               ph_error *err);
ph_status ph_i_json_read_damage_law(const json_t *from, int n, ph_damage_law **out,
                                    ph_error *err);
/** `error_bar` (case_error_bar.c). */
json_t *ph_i_error_bar_to_json(const ph_case *c, bool *good);
json_t *ph_i_output_to_json(const ph_case *c, bool *good);
/** A viscoelastic material and `viscoelastic` (case_viscoelastic_json.c). */
json_t *ph_i_relaxation_to_json(const ph_case_relaxation *x, double density, bool *good);
json_t *ph_i_viscoelastic_to_json(const ph_case_viscoelastic *v, bool *good);
/** `accuracy` and `budget`, and no setting that is left open (case_accuracy.c). */
void ph_i_accuracy_to_json(const ph_case *c, json_t *map, bool *good);
/** Where a result was made: version, git, compiler, libraries, processor, date, command
 *  (may be NULL). */
ph_status ph_i_json_provenance(const char *command, json_t **out, ph_error *err);

#endif
