/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solve/solver.h"

#include <string.h>

#define FUNCTIONS(name)                                                                  \
    ph_i_##name##_refuses, ph_i_##name##_init, ph_i_##name##_solve, ph_i_##name##_free

const ph_solver_method ph_solvers[] = {
    {{"fft_cg", "conjugate gradients, homogeneous medium as preconditioner, by FFT",
      "Brisard2010 Leuschner2018", "always"},
     FUNCTIONS(fft_cg)},
    {{"direct", "assembled matrix, Cholesky factors (CHOLMOD), one for all loads",
      "Chen2008", "small grids, families cut at the faces"},
     FUNCTIONS(direct)},
};
const size_t ph_nsolvers = sizeof ph_solvers / sizeof *ph_solvers;

const ph_solver_method *ph_i_solver_find(const char *name, const ph_system *system,
                                         char *why)
{
    why[0] = 0;
    if (!name || strcmp(name, "auto") == 0) {
        (void)system;
        snprintf(why, 256, "solver: fft_cg, whose iterations do not grow with the grid");
        return &ph_solvers[0];
    }
    for (size_t i = 0; i < ph_nsolvers; i++)
        if (strcmp(name, ph_solvers[i].info.name) == 0) return &ph_solvers[i];
    return NULL;
}
