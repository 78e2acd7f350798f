/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effective/composite.h"

const ph_estimate_method ph_estimate_methods[] = {
    {{"voigt", "uniform strain", "Hill1963", "any phases, any geometry"},
     PH_BOUND_UPPER,
     ph_i_voigt_refuses,
     ph_i_voigt},
    {{"reuss", "uniform stress", "Hill1963",
      "any phases, any geometry; zero with a void"},
     PH_BOUND_LOWER,
     ph_i_reuss_refuses,
     ph_i_reuss},
};
const size_t ph_nestimate_methods =
    sizeof ph_estimate_methods / sizeof *ph_estimate_methods;
