/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/case_internal.h"

#include <math.h>
#include <string.h>

static const char *const model_keys[] = {
    "kind",          "points", "horizon",      "influence",   "weights",
    "stabilisation", "kappa",  "micromodulus", "calibration", "crack_tips"};
static const char *const horizon_keys[] = {"length"};
static const char *const power_law_keys[] = {"power_law"};
static const char *const stabilisation_keys[] = {"spectral", "subpoint"};
static const char *const constraint_keys[] = {"kind", "collar"};
static const char *const solver_keys[] = {"kind", "tolerance", "energy", "max_iterations",
                                          "precision"};

static void read_kind(ph_i_reader *r, const ph_i_node *node, ph_model_params *model)
{
    char list[100];
    for (size_t i = 0; i < ph_i_later_model_names.count; i++) {
        if (!ph_i_is_word(node, ph_i_later_model_names.name[i])) continue;
        ph_i_join_names(ph_i_model_names, " or ", list, sizeof list);
        ph_i_reject(r, node, PH_EINVAL, "this version does not have it yet: must be %s",
                    list);
        return;
    }
    int i = ph_i_read_name(r, node, ph_i_model_names);
    if (i >= 0) model->kind = ph_i_model_names.name[i];
}

/* auto, a number of node spacings, or {length: x}. */
static void read_horizon(ph_i_reader *r, const ph_i_node *node, ph_model_params *model)
{
    static const char rule[] =
        "must be a number of node spacings > 0, {length: x} or auto";
    static const char length_rule[] = "the horizon must be a length > 0";
    if (ph_i_is_word(node, "auto")) return;
    if (node->kind != PH_I_MAP) {
        ph_i_read_positive(r, node, rule, &model->horizon);
        return;
    }
    ph_i_check_keys(r, node, (ph_i_names)PH_I_NAMES(horizon_keys), "horizon");
    const ph_i_node *length = ph_i_need(r, node, "length", length_rule);
    if (!length) return;
    model->horizon_is_length =
        ph_i_read_positive(r, length, length_rule, &model->horizon);
}

/* auto, none, {spectral: alpha} or {subpoint: theta}. */
static void read_stabilisation(ph_i_reader *r, const ph_i_node *node,
                               ph_model_params *model)
{
    static const char rule[] = "must be auto, none, {spectral: x} or {subpoint: x}";
    static const char subpoint_rule[] =
        "the share of the energy must be > 0 and at most 1";
    if (ph_i_is_word(node, "auto")) return;
    if (ph_i_is_word(node, "none")) {
        model->stabilisation = PH_STABILISE_NONE;
        return;
    }
    if (!ph_i_read_map(r, node, rule)) return;
    ph_i_check_keys(r, node, (ph_i_names)PH_I_NAMES(stabilisation_keys), "stabilisation");
    const ph_i_node *spectral = ph_i_get(node, "spectral"),
                    *subpoint = ph_i_get(node, "subpoint");
    if ((spectral != NULL) == (subpoint != NULL)) {
        ph_i_reject(r, node, PH_EINVAL, "%s", rule);
    } else if (spectral) {
        model->stabilisation = PH_STABILISE_SPECTRAL;
        ph_i_read_positive(r, spectral, "the coefficient must be > 0",
                           &model->stabilisation_value);
    } else {
        model->stabilisation = PH_STABILISE_SUBPOINT;
        ph_i_read_number(r, subpoint, 0, nextafter(1, 2), subpoint_rule,
                         &model->stabilisation_value);
    }
}

/* A name, or {power_law: alpha}. */
static void read_micromodulus(ph_i_reader *r, const ph_i_node *node,
                              ph_model_params *model)
{
    static const char rule[] = "the exponent must be below 3 in the plane, 4 in space";
    if (node->kind != PH_I_MAP) {
        int i = ph_i_read_name(r, node, ph_i_micromodulus_names);
        if (i < 0) return;
        model->micromodulus = ph_i_micromodulus_names.name[i];
        if (strcmp(model->micromodulus, "power_law") == 0)
            ph_i_reject(r, node, PH_EINVAL, "give its exponent: {power_law: 1}");
        return;
    }
    ph_i_check_keys(r, node, (ph_i_names)PH_I_NAMES(power_law_keys), "micromodulus");
    const ph_i_node *power = ph_i_need(r, node, "power_law", rule);
    if (!power) return;
    model->micromodulus = "power_law";
    ph_i_read_number(r, power, -100, r->c->kinematics == PH_SPACE ? 4 : 3, rule,
                     &model->power);
}

/* What belongs to one model is a complaint in another. */
static void read_bond(ph_i_reader *r, const ph_i_node *node, ph_model_params *model)
{
    static const char *const bond[] = {"kappa", "micromodulus", "calibration"};
    static const char *const other[] = {"influence", "stabilisation"};
    const ph_i_node *child;
    int i;
    bool is_bond = strcmp(model->kind, "bond") == 0;
    for (size_t k = 0; k < 3 && !is_bond; k++)
        if ((child = ph_i_get(node, bond[k])))
            ph_i_complain(r, child, PH_EINVAL, "belongs to model bond only");
    for (size_t k = 0; k < 2 && is_bond; k++)
        if ((child = ph_i_get(node, other[k])))
            ph_i_complain(r, child, PH_EINVAL, "does not belong to model bond");
    if (!is_bond) return;
    if (r->c->kinematics == PH_GENERALISED_STRAIN)
        ph_i_reject(r, ph_i_get(node, "kind"), PH_EINVAL,
                    "bonds in a plane know no strain along axis 3: give plane: stress or "
                    "strain, or take nosb");
    if (model->points == PH_POINTS_STRESS)
        ph_i_reject(r, ph_i_get(node, "points"), PH_EINVAL,
                    "the forces of model bond act between nodes");
    if (!ph_i_get(node, "weights")) model->weights = "exact";
    model->micromodulus = "constant";
    if ((child = ph_i_get(node, "kappa")))
        ph_i_read_positive(r, child, "the interphase factor must be > 0", &model->kappa);
    if ((child = ph_i_get(node, "micromodulus"))) read_micromodulus(r, child, model);
    if ((child = ph_i_get(node, "calibration")) &&
        (i = ph_i_read_name(r, child, ph_i_calibration_names)) >= 0)
        model->calibration = (ph_calibration)i;
    if (model->horizon == 0) model->horizon = 3;
}

void ph_i_read_model(ph_i_reader *r, const ph_i_node *node)
{
    ph_model_params *model = &r->c->model;
    const ph_i_node *child;
    int i;
    *model =
        (ph_model_params){.kind = "nosb", .influence = "constant", .weights = "linear"};
    if (!node || !ph_i_read_map(r, node, "must be a map such as {kind: nosb}")) return;
    ph_i_check_keys(r, node, (ph_i_names)PH_I_NAMES(model_keys), "model");
    if ((child = ph_i_get(node, "kind"))) read_kind(r, child, model);
    if ((child = ph_i_get(node, "points")) &&
        (i = ph_i_read_name(r, child, ph_i_points_names)) >= 0)
        model->points = (ph_points)i;
    if ((child = ph_i_get(node, "horizon"))) read_horizon(r, child, model);
    if ((child = ph_i_get(node, "influence")) &&
        (i = ph_i_read_name(r, child, ph_i_influence_names)) >= 0)
        model->influence = ph_i_influence_names.name[i];
    if ((child = ph_i_get(node, "weights")) &&
        (i = ph_i_read_name(r, child, ph_i_weight_names)) >= 0)
        model->weights = ph_i_weight_names.name[i];
    if ((child = ph_i_get(node, "stabilisation"))) read_stabilisation(r, child, model);
    if ((child = ph_i_get(node, "crack_tips")))
        ph_i_read_number(r, child, -1e-300, 2.0, "must be from 0 to below 2 spacings",
                         &model->crack_tips);
    read_bond(r, node, model);
    if (model->points == PH_POINTS_NODES && model->horizon == 0) model->horizon = 2;
}

/* inside the RVE, or outside: periodic continuation, the matrix, any material. */
static void read_collar(ph_i_reader *r, const ph_i_node *node, ph_constraint_params *out)
{
    if (strcmp(out->kind, "linear_displacement") != 0) {
        ph_i_complain(r, node, PH_EINVAL, "belongs to linear_displacement only");
    } else if (ph_i_is_word(node, "matrix") && r->c->voxels.file[0]) {
        ph_i_reject(r, node, PH_EINVAL,
                    "voxels have no matrix: must be inside, periodic or a material");
    } else if (ph_i_is_word(node, "matrix")) {
        out->collar = PH_COLLAR_MATRIX;
        out->collar_material = r->c->matrix;
    } else if (ph_i_is_word(node, "periodic")) {
        out->collar = PH_COLLAR_PERIODIC;
    } else if (!ph_i_is_word(node, "inside")) {
        int i = ph_i_read_material(r, node);
        out->collar = PH_COLLAR_MATRIX;
        if (i >= 0) out->collar_material = i;
    }
}

void ph_i_read_constraint(ph_i_reader *r, const ph_i_node *node)
{
    ph_constraint_params *out = &r->c->constraint;
    *out = (ph_constraint_params){.kind = "periodic"};
    if (!node) return;
    const ph_i_node *kind = node, *collar = NULL;
    if (node->kind == PH_I_MAP) {
        ph_i_check_keys(r, node, (ph_i_names)PH_I_NAMES(constraint_keys), "constraint");
        kind = ph_i_need(r, node, "kind", "must be the kind of constraint");
        collar = ph_i_get(node, "collar");
    }
    int i = kind ? ph_i_read_name(r, kind, ph_i_constraint_names) : -1;
    if (i < 0) return;
    out->kind = ph_i_constraint_names.name[i];
    if (collar) read_collar(r, collar, out);
}

void ph_i_read_solver(ph_i_reader *r, const ph_i_node *node)
{
    ph_solver_params *solver = &r->c->solver;
    const ph_i_node *child;
    int64_t iterations = 2000;
    int i;
    *solver = (ph_solver_params){
        .kind = "auto", .tolerance = 1e-6, .max_iterations = 2000, .precision = "double"};
    if (!node || !ph_i_read_map(r, node, "must be a map such as {tolerance: 1e-6}"))
        return;
    ph_i_check_keys(r, node, (ph_i_names)PH_I_NAMES(solver_keys), "solver");
    if ((child = ph_i_get(node, "kind")) &&
        (i = ph_i_read_name(r, child, ph_i_solver_names)) >= 0)
        solver->kind = ph_i_solver_names.name[i];
    if ((child = ph_i_get(node, "tolerance")))
        ph_i_read_number(r, child, 0, 1, "the relative residual must be > 0 and < 1",
                         &solver->tolerance);
    if ((child = ph_i_get(node, "energy")))
        ph_i_read_number(r, child, 0, 1, "the share of the energy must be > 0 and < 1",
                         &solver->energy);
    if ((child = ph_i_get(node, "max_iterations")))
        ph_i_read_integer(r, child, 1, 1000000000, "must be an integer from 1 to 1e9",
                          &iterations);
    solver->max_iterations = (int)iterations;
    if ((child = ph_i_get(node, "precision")) &&
        (i = ph_i_read_name(r, child, ph_i_precision_names)) >= 0)
        solver->precision = ph_i_precision_names.name[i];
    bool floats =
        strcmp(solver->kind, "auto") == 0 || strcmp(solver->kind, "fft_cg") == 0;
    if (strcmp(solver->precision, "single") == 0 && !floats)
        ph_i_reject(r, child, PH_EINVAL, "of the solvers fft_cg alone has it, not %s",
                    solver->kind);
}
