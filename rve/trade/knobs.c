/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The settings that trade accuracy for cost, as a catalogue. */
#include "trade/trade.h"

#include <string.h>

static bool has_model(const ph_case *c, const char *kind)
{
    return strcmp(c->model.kind ? c->model.kind : "nosb", kind) == 0;
}

static const char *nodes_refuse(const ph_case *c)
{
    return c->voxels.file[0] ? "a voxel file has its own grid" : NULL;
}

static const char *interface_refuses(const ph_case *c)
{
    if (c->voxels.file[0]) return "voxels know no interface inside a cell";
    return has_model(c, "bond") ? "bonds take the material at the nodes" : NULL;
}

static const char *not_for_bond(const ph_case *c)
{
    return has_model(c, "bond") ? "does not belong to model bond" : NULL;
}

static const char *tips_refuse(const ph_case *c)
{
    return c->ncracks > 0 ? NULL : "there are no cracks";
}

static const char *always(const ph_case *c)
{
    (void)c;
    return NULL;
}

static const char *rve_refuses(const ph_case *c)
{
    return c->nfillers > 0 && !c->voxels.file[0]
               ? NULL
               : "nothing of the microstructure is random";
}

static const char *precision_refuses(const ph_case *c)
{
    if (has_model(c, "bond") || c->ncracks > 0) return "bonds have no single precision";
    const char *kind = c->constraint.kind ? c->constraint.kind : "periodic";
    return strcmp(kind, "periodic") == 0 ? NULL : "single precision is periodic";
}

/* One setting a line; a semicolon between the overrides of one. */
static const char *const points[] = {"model.points=nodes", "model.points=stress", NULL};
static const char *const horizon[] = {
    "model.points=nodes;model.horizon=1.5", "model.points=nodes;model.horizon=2",
    "model.points=nodes;model.horizon=3", "model.points=nodes;model.horizon=4", NULL};
static const char *const influence[] = {
    "model.points=nodes;model.horizon=3;model.influence=constant",
    "model.points=nodes;model.horizon=3;model.influence=conical",
    "model.points=nodes;model.horizon=3;model.influence=gaussian",
    "model.points=nodes;model.horizon=3;model.influence=inverse",
    "model.points=nodes;model.horizon=3;model.influence=inverse_square",
    "model.points=nodes;model.horizon=3;model.influence=cubic",
    NULL};
static const char *const interface[] = {"microstructure.interface=composite",
                                        "microstructure.interface=node_centre", NULL};
static const char *const stabilisation[] = {"model.stabilisation=none",
                                            "model.stabilisation={spectral: 0.5}",
                                            "model.stabilisation={subpoint: 0.05}",
                                            "model.stabilisation={subpoint: 0.2}",
                                            "model.stabilisation={subpoint: 0.5}",
                                            NULL};
static const char *const tolerance[] = {"solver.tolerance=1e-2", "solver.tolerance=1e-3",
                                        "solver.tolerance=1e-4", "solver.tolerance=1e-6",
                                        "solver.tolerance=1e-8", NULL};
static const char *const precision[] = {
    "model.points=stress;solver.precision=double",
    "model.points=stress;solver.precision=single",
    "model.points=stress;solver.precision=double;solver.tolerance=1e-4",
    "model.points=stress;solver.precision=single;solver.tolerance=1e-4", NULL};
static const char *const model[] = {"model.kind=nosb", "model.kind=local",
                                    "model.kind=bond", NULL};
static const char *const crack_tips[] = {"model.crack_tips=0", "model.crack_tips=0.42",
                                         NULL};
static const char *const constraint[] = {"constraint=periodic",
                                         "constraint=linear_displacement",
                                         "constraint=uniform_traction",
                                         "constraint=voigt",
                                         "constraint=reuss",
                                         NULL};

const ph_knob ph_knobs[] = {
    {{"nodes", "cells along each axis", "", "not with voxels"},
     "microstructure.nodes",
     NULL,
     nodes_refuse},
    {{"points", "where strain is taken", "", "model nosb"},
     "model.points",
     points,
     not_for_bond},
    {{"interface", "what a cell holds that an interface cuts", "", "not with voxels"},
     "microstructure.interface",
     interface,
     interface_refuses},
    {{"model", "what a bond does", "", "bond: nu = 1/3 (plane stress), 1/4 (else)"},
     "model.kind",
     model,
     always},
    {{"horizon", "reach of the bonds", "", "nodes"},
     "model.horizon",
     horizon,
     not_for_bond},
    {{"influence", "weight of a bond by its length", "", "nodes, horizon 3"},
     "model.influence",
     influence,
     not_for_bond},
    {{"stabilisation", "against zero-energy modes", "", "model nosb"},
     "model.stabilisation",
     stabilisation,
     not_for_bond},
    {{"tolerance", "relative residual of the solver", "", "always"},
     "solver.tolerance",
     tolerance,
     always},
    {{"precision", "of the numbers that the solver iterates with", "",
      "periodic, stress points or model local"},
     "solver.precision",
     precision,
     precision_refuses},
    {{"crack_tips", "what cracks seem too long on the lattice", "", "cracks"},
     "model.crack_tips",
     crack_tips,
     tips_refuse},
    {{"constraint", "what closes the problem", "",
      "another problem, whose solution differs from the periodic one in a finite RVE"},
     "constraint",
     constraint,
     always},
    {{"threads", "processors of one solution", "", "seconds only: results are the same"},
     NULL,
     NULL,
     always},
    {{"rve", "size of the RVE against the number of realisations", "", "random fillers"},
     NULL,
     NULL,
     rve_refuses},
};
const size_t ph_nknobs = sizeof ph_knobs / sizeof *ph_knobs;
