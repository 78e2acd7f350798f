/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solve/solver.h"

#include <string.h>

#define FUNCTIONS(name)                                                                  \
    ph_i_##name##_refuses, ph_i_##name##_init, ph_i_##name##_solve, ph_i_##name##_free

static const ph_solver_method fft_cg_single = {
    {"fft_cg", "conjugate gradients in single precision", "Wilkinson1963",
     "periodic; stress points of the smallest family, local"},
    false,
    FUNCTIONS(fft_cg_single),
    NULL,
    NULL,
    NULL};

const ph_solver_method ph_solvers[] = {
    {{"fft_cg", "conjugate gradients, homogeneous medium as preconditioner, by FFT",
      "Brisard2010 Leuschner2018", "always"},
     false,
     FUNCTIONS(fft_cg),
     NULL,
     ph_i_fft_cg_solve_free,
     &fft_cg_single},
    {{"direct", "assembled matrix, Cholesky factors (CHOLMOD), one for all loads",
      "Chen2008 Davis1999", "small grids, families cut at the faces"},
     true,
     FUNCTIONS(direct),
     ph_i_direct_broke,
     NULL,
     NULL},
    {{"relaxation", "adaptive dynamic relaxation: the steady state of a damped motion",
      "Underwood1983 Kilic2010", "to compare with; thousands of steps"},
     true,
     FUNCTIONS(relaxation),
     NULL,
     NULL,
     NULL},
};
const size_t ph_nsolvers = sizeof ph_solvers / sizeof *ph_solvers;

const ph_entry ph_precisions[] = {
    {"double", "iterates of 53 bits", "", "always"},
    {"single",
     "iterates of 24 bits, half the memory; below a tolerance of 1e-5 refined in "
     "double",
     "Wilkinson1963",
     "solver fft_cg, periodic, stress points of the smallest family or "
     "local"},
    {"auto", "single where it was measured to pay, else double", "", "always"},
};
const size_t ph_nprecisions = sizeof ph_precisions / sizeof *ph_precisions;

enum { DIRECT_CELLS = 65536 };

static double cells_of(const ph_system *system)
{
    return (double)ph_grid_cells(&system->setting->box);
}

/* Voids whose inside only the uniform term of (S) holds, or nothing: hundreds to thousands
 * of iterations, where a factor in two dimensions with neighbours only costs about a hundred.
 * Everywhere else fft_cg was the faster one at any size: docs/theory/solvers.md. */
static bool hard_for_cg(const ph_system *system)
{
    int dims = 0;
    for (int a = 0; a < 3; a++)
        dims += system->setting->box.n[a] > 1;
    return ph_i_operator_by_cells(system->params) && system->params->family &&
           system->map->has_void && dims <= 2 &&
           system->params->stabilisation != PH_STABILISE_SUBPOINT &&
           cells_of(system) <= DIRECT_CELLS;
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

const ph_solver_method *ph_i_solver_find(const char *name)
{
    for (size_t i = 0; i < ph_nsolvers; i++)
        if (strcmp(name, ph_solvers[i].info.name) == 0) return &ph_solvers[i];
    return NULL;
}

bool ph_i_precision_is_known(const char *name)
{
    for (size_t i = 0; name && i < ph_nprecisions; i++)
        if (strcmp(name, ph_precisions[i].name) == 0) return true;
    return !name;
}

static const char *no_single(const ph_solver_method *method, const ph_system *system)
{
    return method->single ? method->single->refuses(system)
                          : "fft_cg alone has it: name it as solver.kind";
}

/* Where floats were measured to pay: docs/theory/solvers.md. Smaller grids fit the cache, and
 * a wider spread of eigenvalues leaves more round-off than the residual says. */
static const double worthwhile_cells = 32768, most_spread = 1e4;

/* Why floats, which could, would not pay, or NULL. */
static const char *no_gain(const ph_solver_params *p, const ph_system *system)
{
    const ph_operator_params *op = system->params;
    if (system->relaxes)
        return "phases relax: their residuals are below what floats hold";
    if (p->energy > 0.0) return "the energy that is left is bounded in doubles alone";
    if (!(p->tolerance >= PH_SINGLE_LIMIT))
        return "below a tolerance of 1e-5 floats are refined, which gains little";
    if (system->few) return "a mean stress is fewer loads, and has no floats";
    if (cells_of(system) < worthwhile_cells)
        return "floats are not faster on fewer than 32768 cells";
    if (system->map->spread > most_spread)
        return "stiffnesses spread over more than 1e4: round-off of floats would show";
    if (system->map->has_void && op->family && op->stabilisation != PH_STABILISE_SUBPOINT)
        return "voids without sub-points take floats more iterations";
    return NULL;
}

static ph_status choose_precision(const ph_solver_params *p, const ph_system *system,
                                  ph_solver_choice *out, ph_error *err)
{
    ph_status st = PH_OK;
    const char *word = p->precision ? p->precision : "double";
    const char *no = no_single(out->method, system);
    bool automatically = strcmp(word, "auto") == 0, single = strcmp(word, "single") == 0;
    PH_CHECK_KEY(!single || !no, PH_EINVAL, "solver.precision",
                 "precision single cannot take this case: %s", no);
    if (automatically) {
        if (!no) no = no_gain(p, system);
        single = !no;
        if (single)
            snprintf(
                out->why[1], sizeof out->why[1],
                "precision: single (%.0f cells to a residual of %.3g: less memory and "
                "time than double)",
                cells_of(system), p->tolerance);
        else
            snprintf(out->why[1], sizeof out->why[1], "precision: double (%s)", no);
    }
    if (!single) return PH_OK;
    out->method = out->method->single;
    out->precision = "single";
out:
    return st;
}

ph_status ph_i_solver_choose(const ph_solver_params *params, const ph_system *system,
                             ph_solver_choice *out, ph_error *err)
{
    ph_status st = PH_OK;
    bool automatically = !params->kind || strcmp(params->kind, "auto") == 0;
    *out = (ph_solver_choice){.precision = "double"};
    out->method =
        automatically ? automatic(system, out->why[0]) : ph_i_solver_find(params->kind);
    PH_CHECK_KEY(out->method, PH_EINVAL, "solver.kind", "unknown solver '%s'",
                 params->kind);
    const char *no = out->method->refuses(system);
    PH_CHECK_KEY(!no, PH_EINVAL, "solver.kind", "solver '%s' cannot take this case: %s",
                 out->method->info.name, no);
    PH_TRY(choose_precision(params, system, out, err));
out:
    return st;
}
