/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PH_MODEL_MODELS_H
#define PH_MODEL_MODELS_H

#include "model/operator.h"

typedef struct ph_model_method {
    ph_entry info;
    bool has_family; /* bonds over a horizon, or neighbours only */
    bool pairwise;   /* forces between pairs of nodes: springs */
} ph_model_method;

extern const ph_model_method ph_models[];
extern const size_t ph_nmodels;

/** By name; NULL: nosb. Returns NULL for an unknown name. */
const ph_model_method *ph_i_model_find(const char *name);

/** Everything about the operator that `auto` leaves open, decided; notes say what and why.
 *  @param[in] bounded nodes are held, or end at the faces of the RVE: points that see only
 *             their own cell suit it best
 *  @param[out] family NULL for local; the caller frees it */
ph_status ph_i_model_choose(const ph_problem *problem, const ph_stiffness_map *map,
                            bool bounded, ph_operator_params *params, ph_family **family,
                            ph_result *notes, ph_error *err);

/** Does a problem have cracks, so that bonds break? */
bool ph_i_has_cracks(const ph_problem *problem);

/** A line of the result's notes. */
void ph_i_note(ph_result *result, const char *fmt, ...) PH_PRINTF(2, 3);

#endif
