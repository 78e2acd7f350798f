/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/case_internal.h"

static const char *const models[] = {"nosb", "local", "bond"};
static const char *const later_models[] = {"ordinary"};
static const char *const points[] = {"auto", "nodes", "stress"};
static const char *const influences[] = {"constant", "conical",        "gaussian",
                                         "inverse",  "inverse_square", "cubic"};
static const char *const micromoduli[] = {"constant", "conical", "inverted_conical",
                                          "power_law"};
static const char *const calibrations[] = {"lattice", "gamma", "continuum"};
static const char *const weights[] = {"linear", "exact", "none"};
static const char *const constraints[] = {"periodic", "linear_displacement",
                                          "uniform_traction", "voigt", "reuss"};
static const char *const solvers[] = {"auto", "fft_cg", "direct", "relaxation"};
static const char *const precisions[] = {"double", "single", "auto"};
static const char *const interfaces[] = {"composite", "node_centre"};
static const char *const planes[] = {"generalised_strain", "strain", "stress"};
static const char *const raw_types[] = {"uint8", "uint16", "int32"};
static const char *const routes[] = {"reduced", "carson", "stepping", "frequency"};
static const char *const components[] = {"11", "22", "33", "23", "13", "12"};
static const char *const fillers[] = {"platelet", "fibre", "particle"};
static const char *const amounts[] = {"weight_fraction", "volume_fraction", "count"};
static const char *const countings[] = {"auto", "nodes", "area"};

static const char *const tips[] = {"both", "to", "from"};

const ph_i_names ph_i_model_names = PH_I_NAMES(models);
const ph_i_names ph_i_later_model_names = PH_I_NAMES(later_models);
const ph_i_names ph_i_points_names = PH_I_NAMES(points);
const ph_i_names ph_i_influence_names = PH_I_NAMES(influences);
const ph_i_names ph_i_micromodulus_names = PH_I_NAMES(micromoduli);
const ph_i_names ph_i_calibration_names = PH_I_NAMES(calibrations);
const ph_i_names ph_i_weight_names = PH_I_NAMES(weights);
const ph_i_names ph_i_constraint_names = PH_I_NAMES(constraints);
const ph_i_names ph_i_solver_names = PH_I_NAMES(solvers);
const ph_i_names ph_i_precision_names = PH_I_NAMES(precisions);
const ph_i_names ph_i_interface_names = PH_I_NAMES(interfaces);
const ph_i_names ph_i_plane_names = PH_I_NAMES(planes);
const ph_i_names ph_i_raw_type_names = PH_I_NAMES(raw_types);
const ph_i_names ph_i_route_names = PH_I_NAMES(routes);
const ph_i_names ph_i_component_names = PH_I_NAMES(components);
const ph_i_names ph_i_filler_names = PH_I_NAMES(fillers);
const ph_i_names ph_i_amount_names = PH_I_NAMES(amounts);
const ph_i_names ph_i_counting_names = PH_I_NAMES(countings);
const ph_i_names ph_i_tip_names = PH_I_NAMES(tips);
