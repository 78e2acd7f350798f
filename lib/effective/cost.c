/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a problem would take. */
#include "effective/run.h"

#include <math.h>
#include <string.h>

/* Iterations to 1e-6 by contrast, as measured for composite cells (docs/performance.md). */
static double expected_iterations(const ph_stiffness_map *map)
{
    return map->has_void ? 110.0
                         : 12.0 + 8.0 * log10(fmax(1.0, map->contrast)) +
                               3.5 * sqrt(fmin(map->contrast, 1e3));
}

/* Doubles per node that the solver keeps, and nanoseconds per node and iteration, measured. */
static void unit_cost(const ph_run *r, bool single, double *doubles, double *ns)
{
    int nd = ph_displacements(r->result->grid.kinematics);
    bool cells = !r->family || r->params.smallest;
    *doubles = cells ? 7.2 * nd + 1.0 : 8.2 * nd + 5.0;
    *ns = (cells ? 20.0 : 30.0) * nd;
    if (single)
        *doubles =
            ph_i_run_tolerance(r) >= PH_SINGLE_LIMIT ? 3.7 * nd + 1.0 : 6.7 * nd + 1.0;
    if (r->setting.fixed) *ns *= cells ? 1.3 : 2.5;
}

ph_status ph_homogenise_estimate(const ph_problem *problem, ph_estimate *out,
                                 ph_error *err)
{
    ph_status st = PH_OK;
    ph_run r = {.problem = problem};
    double doubles, ns;
    ph_sym4 exact;
    ph_solver_choice choice = {.precision = "double"};
    char why[64];
    PH_CHECK(out, PH_EINVAL, "NULL estimate");
    memset(out, 0, sizeof *out);
    PH_TRY(ph_i_run_begin(&r, err));
    if (!r.constraint->analytic) {
        PH_TRY(ph_i_run_prepare(&r, err));
        bool solves = !ph_i_run_closed_form(&r, &exact, why);
        if (solves) PH_TRY(ph_i_run_choose_solver(&r, &choice, err));
        if (choice.why[1][0]) ph_i_note(r.result, "%s", choice.why[1]);
        unit_cost(&r, strcmp(choice.precision, "single") == 0, &doubles, &ns);
        double nodes = (double)ph_grid_cells(&r.setting.box);
        int loads = ph_strains(r.result->grid.kinematics);
        out->nodes = ph_grid_cells(&r.setting.box);
        out->unknowns = out->nodes * ph_displacements(r.result->grid.kinematics);
        out->bytes = (size_t)(8.0 * doubles * nodes) + r.meter.peak;
        if (solves) out->seconds = 1e-9 * ns * nodes * loads * expected_iterations(r.map);
    }
    out->nnotes = r.result->nnotes;
    memcpy(out->notes, r.result->notes, sizeof out->notes);
out:
    ph_i_run_clear(&r);
    ph_result_free(&r.result);
    return st;
}
