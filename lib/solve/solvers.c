/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solve/solver.h"

#include <string.h>

#define FUNCTIONS(name)                                                                  \
    ph_i_##name##_refuses, ph_i_##name##_init, ph_i_##name##_solve, ph_i_##name##_free

const ph_solver_method ph_solvers[] = {
    {{"fft_cg", "conjugate gradients, homogeneous medium as preconditioner, by FFT",
      "Brisard2010 Leuschner2018", "always"},
     false,
     FUNCTIONS(fft_cg),
     NULL},
    {{"direct", "assembled matrix, Cholesky factors (CHOLMOD), one for all loads",
      "Chen2008 Davis1999", "small grids, families cut at the faces"},
     true,
     FUNCTIONS(direct),
     ph_i_direct_broke},
    {{"relaxation", "adaptive dynamic relaxation: the steady state of a damped motion",
      "Underwood1983 Kilic2010", "to compare with; thousands of steps"},
     true,
     FUNCTIONS(relaxation),
     NULL},
    {{"fft_cg_single", "fft_cg in single precision: half the memory, refined in double",
      "Wilkinson1963", "periodic; stress points of the smallest family, local"},
     false,
     FUNCTIONS(fft_cg_single),
     NULL},
};
const size_t ph_nsolvers = sizeof ph_solvers / sizeof *ph_solvers;

enum { DIRECT_CELLS = 65536 };

/* Voids whose inside only the uniform term of (S) holds, or nothing: hundreds to thousands
 * of iterations, where a factor in two dimensions with neighbours only costs about a hundred.
 * Everywhere else fft_cg was the faster one at any size: docs/theory/solvers.md. */
static bool hard_for_cg(const ph_system *system)
{
    const ph_operator *op = system->op;
    int dims = 0;
    for (int a = 0; a < 3; a++)
        dims += op->layout.axis[a] >= 0;
    return op->has_cells && system->params->family && op->map->has_void && dims <= 2 &&
           system->params->stabilisation != PH_STABILISE_SUBPOINT &&
           op->layout.cells <= DIRECT_CELLS;
}

static const ph_solver_method *automatic(const ph_system *system, char *why)
{
    if (system->one_sided) {
        snprintf(why, 256,
                 "solver: direct (families cut at the faces are no convolution)");
        return &ph_solvers[1];
    }
    if (hard_for_cg(system)) {
        snprintf(why, 256,
                 "solver: direct (voids without sub-points take fft_cg too many "
                 "iterations)");
        return &ph_solvers[1];
    }
    snprintf(why, 256, "solver: fft_cg, whose iterations do not grow with the grid");
    return &ph_solvers[0];
}

const ph_solver_method *ph_i_solver_find(const char *name, const ph_system *system,
                                         char *why)
{
    why[0] = 0;
    if (!name || strcmp(name, "auto") == 0) return automatic(system, why);
    for (size_t i = 0; i < ph_nsolvers; i++)
        if (strcmp(name, ph_solvers[i].info.name) == 0) return &ph_solvers[i];
    return NULL;
}
