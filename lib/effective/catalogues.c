/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every catalogue of the library in one table. */
#include <perihom/distribution.h>
#include <perihom/error_bar.h>
#include <perihom/estimates.h>
#include <perihom/quantity.h>
#include <perihom/viscoelastic.h>

#include "model/models.h"
#include "solve/solver.h"

static const ph_catalogue catalogues[] = {
    {"models", "what a bond does", ph_models, &ph_nmodels, sizeof *ph_models},
    {"constraints", "what closes the RVE problem", ph_constraints, &ph_nconstraints,
     sizeof *ph_constraints},
    {"solvers", "how the equations are solved", ph_solvers, &ph_nsolvers,
     sizeof *ph_solvers},
    {"precisions", "of the numbers that a solver iterates with", ph_precisions,
     &ph_nprecisions, sizeof *ph_precisions},
    {"influences", "influence functions of the bond length", ph_influences,
     &ph_ninfluences, sizeof *ph_influences},
    {"micromoduli", "bond-based: stiffness of a bond by its length", ph_micromoduli,
     &ph_nmicromoduli, sizeof *ph_micromoduli},
    {"calibrations", "bond-based: what is exact on the lattice", ph_calibrations,
     &ph_ncalibrations, sizeof *ph_calibrations},
    {"volume_weights", "share of a cell in the family ball", ph_volume_weights,
     &ph_nvolume_weights, sizeof *ph_volume_weights},
    {"failure_criteria", "when a bond breaks", ph_failure_criteria, &ph_nfailure_criteria,
     sizeof *ph_failure_criteria},
    {"estimates", "analytic bounds and estimates", ph_estimate_methods,
     &ph_nestimate_methods, sizeof *ph_estimate_methods},
    {"distributions", "how a quantity of random fillers varies", ph_distributions,
     &ph_ndistributions, sizeof *ph_distributions},
    {"routes", "how the relaxation of a composite is computed", ph_relaxation_routes,
     &ph_nrelaxation_routes, sizeof *ph_relaxation_routes},
    {"quantities", "scalars of a result, by name", ph_quantity_kinds, &ph_nquantity_kinds,
     sizeof *ph_quantity_kinds},
    {"error_parts", "what an error bar is made of", ph_error_parts, &ph_nerror_parts,
     sizeof *ph_error_parts},
    {NULL, NULL, NULL, NULL, 0},
};

const ph_catalogue *ph_catalogues(void)
{
    return catalogues;
}
