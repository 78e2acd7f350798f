/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effective/composite.h"

#define ENTRY(name, title, reference, valid, kind)                                       \
    {                                                                                    \
        {#name, title, reference, valid}, kind, ph_i_##name##_refuses, ph_i_##name       \
    }

const ph_estimate_method ph_estimate_methods[] = {
    ENTRY(voigt, "Voigt bound: uniform strain", "Hill1963", "any phases, any geometry",
          PH_BOUND_UPPER),
    ENTRY(reuss, "Reuss bound: uniform stress", "Hill1963",
          "any phases, any geometry; zero with a void", PH_BOUND_LOWER),
    ENTRY(hashin_shtrikman_lower, "Hashin-Shtrikman lower bound",
          "Hashin1963 Hashin1965 Willis1977",
          "one phase the softest in every direction; two-point statistics with the "
          "symmetry "
          "of the shape; zero with a void",
          PH_BOUND_LOWER),
    ENTRY(hashin_shtrikman_upper, "Hashin-Shtrikman upper bound",
          "Hashin1963 Hashin1965 Willis1977",
          "one phase the stiffest in every direction; two-point statistics with the "
          "symmetry "
          "of the shape",
          PH_BOUND_UPPER),
    ENTRY(walpole_lower, "Walpole lower bound: smallest moduli of all phases",
          "Walpole1966 Walpole1969",
          "isotropic phases in any order; otherwise as hashin_shtrikman_lower",
          PH_BOUND_LOWER),
    ENTRY(walpole_upper, "Walpole upper bound: largest moduli of all phases",
          "Walpole1966 Walpole1969",
          "isotropic phases in any order; otherwise as hashin_shtrikman_upper",
          PH_BOUND_UPPER),
    ENTRY(laminate, "exact fine laminate, normal along axis 1", "Backus1962 Milton2002",
          "layers without voids", PH_POINT_ESTIMATE),
    ENTRY(dilute, "dilute inclusions: each alone in the matrix", "Eshelby1957",
          "fractions of a few per cent", PH_POINT_ESTIMATE),
    ENTRY(mori_tanaka, "Mori-Tanaka: inclusions in the mean strain of the matrix",
          "Mori1973 Benveniste1987", "inclusions of one shape and direction in a matrix",
          PH_POINT_ESTIMATE),
    ENTRY(self_consistent, "self-consistent: every phase in the effective medium",
          "Hill1965",
          "phases on equal terms (polycrystal-like); voids below their percolation",
          PH_POINT_ESTIMATE),
    ENTRY(differential, "differential: inclusions added little by little",
          "Norris1985 McLaughlin1977", "inclusions of very different sizes in a matrix",
          PH_POINT_ESTIMATE),
    ENTRY(generalised_self_consistent,
          "generalised self-consistent: coated inclusion in the effective medium",
          "Christensen1979", "one phase of spheres or cylinders, isotropic phases",
          PH_POINT_ESTIMATE),
};
const size_t ph_nestimate_methods =
    sizeof ph_estimate_methods / sizeof *ph_estimate_methods;
