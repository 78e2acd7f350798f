/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a problem would take. */
#include "effective/failure.h"
#include "effective/patch.h"
#include "effective/run.h"

#include <math.h>
#include <string.h>

/* What one application of the operator goes with, and how many there are. */
typedef struct work {
    double nodes;
    double ns;         /* a node and iteration */
    double iterations; /* of a load of the pristine cell, from nothing */
    double solved;     /* loads' worth of the pristine cell, in all */
    double least;      /* if no bond breaks */
} work;

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
    *ns = (cells ? 20.0 : r->broken ? 40.0 : 30.0) * nd;
    if (single)
        *doubles =
            ph_i_run_tolerance(r) >= PH_SINGLE_LIMIT ? 3.7 * nd + 1.0 : 6.7 * nd + 1.0;
    if (r->setting.fixed) *ns *= cells ? 1.3 : 2.5;
}

static bool is_sequence(const ph_problem *p)
{
    return p->sequence && p->sequence->kind != PH_SEQUENCE_NONE;
}

/* ---- cracks ------------------------------------------------------------------------------ */

/* Iterations of a load grow with the cracks: about 20 for a few of them, more where many lie
 * near each other (measured: 31 for one that grows, 108 on the mean of densities up to 0.1). */
static double with_cracks(double iterations, double density, ptrdiff_t count)
{
    return iterations + 20.0 + 1000.0 * density * (1.0 - 1.0 / (double)count);
}

/* The pristine cell, then every step; on the mean with half of what there is at last. */
static double loads_of_steps(const ph_problem *p, const work *w, double density,
                             ptrdiff_t count)
{
    bool steps = is_sequence(p);
    double each = with_cracks(w->iterations, steps ? 0.5 * density : density, count);
    return 1.0 + (steps ? p->sequence->nsteps : 1) * each / w->iterations;
}

/* First guesses of the loads, and the fields of steps that are kept. */
static double bytes_of_steps(const ph_run *r, int loads)
{
    const ph_problem *p = r->problem;
    ph_kinematics kin = r->result->grid.kinematics;
    double cells = (double)ph_grid_cells(&r->result->grid),
           doubles = (double)ph_displacements(kin) * loads;
    if (p->keep_fields && is_sequence(p))
        doubles += p->sequence->nsteps *
                   (1.0 + loads * (ph_displacements(kin) + 2.0 * ph_strains(kin)));
    return 8.0 * doubles * cells;
}

/* ---- bonds that break -------------------------------------------------------------------- */

/* A solution from the one before, of the iterations from nothing; nanoseconds where bonds are
 * broken and looked at; bonds of an event, and of a solution of the whole cell where patches
 * take the events between (all measured on the cases of data/cases). */
static const double warm = 0.3, broken_ns = 220.0, bonds_an_event = 2.0,
                    bonds_a_solution = 8.0;
/* Solutions of a step in time in which nothing breaks. */
static const double solutions_a_time = 2.5;

/* Bonds through the smallest section of the cell: a node has a bond through a plane beside it
 * for each spacing that the bond reaches. */
static double bonds_through(const ph_run *r)
{
    const ph_family *f = r->family;
    const ph_grid *g = &r->result->grid;
    double least = INFINITY;
    for (int d = 0; d < 3; d++) {
        double reach = 0.0;
        if (g->n[d] == 1) continue;
        for (ptrdiff_t b = 0; b < f->count; b++)
            if (f->offset[b][d] > 0) reach += f->offset[b][d];
        least = fmin(least, reach * (double)ph_grid_cells(g) / (double)g->n[d]);
    }
    return isfinite(least) ? least : 0.0;
}

static bool takes_patches(const ph_run *r)
{
    const ph_loading *l = r->problem->loading;
    return r->result->bond.present && !l->together && !l->every_event && !l->times &&
           l->stress_free == 0;
}

static void count_failure(const ph_run *r, int loads, work *w, ph_estimate *out)
{
    const ph_loading *l = r->problem->loading;
    double bonds = bonds_through(r), steps = (double)l->ntargets * l->steps;
    double tensors = 1.0 + ph_i_stiffness_steps(l); /* the pristine cell's too */
    double events = bonds / (takes_patches(r) ? bonds_a_solution : bonds_an_event);
    if (l->together) events = fmin(events, 4.0 * steps);
    w->least = 1.0 + loads * tensors + (l->times ? warm * solutions_a_time * steps : 0.0);
    w->solved = w->least + warm * events;
    w->ns = broken_ns;
    out->bonds = (ptrdiff_t)bonds;
}

/* The strength of every bond, and a patch of a quarter of the cell at most. */
static double bytes_of_failure(const ph_run *r)
{
    double cells = (double)ph_grid_cells(&r->result->grid);
    double doubles = cells * (0.5 * (double)r->family->count + 1.0);
    int nd = ph_displacements(r->result->grid.kinematics);
    if (takes_patches(r))
        doubles +=
            2.0 * PH_PATCH_BONDS * nd * fmin(0.25 * cells, nd == 2 ? 2000.0 : 1000.0);
    if (r->problem->loading->times) doubles += 40.0 * nd * cells; /* the pasts of bonds */
    return 8.0 * doubles;
}

/* ---- all --------------------------------------------------------------------------------- */

static ph_status count(ph_run *r, ph_estimate *out, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_problem *p = r->problem;
    double doubles, density = 0.0;
    ptrdiff_t cracks = 0;
    ph_sym4 exact;
    char why[64];
    work w = {.nodes = (double)ph_grid_cells(&r->setting.box),
              .iterations = expected_iterations(r->map)};
    if (r->broken) PH_TRY(ph_i_run_cut_last(r, &density, &cracks, err));
    PH_TRY(ph_i_run_find_symmetry(r, err));
    bool closed = ph_i_run_closed_form(r, &exact, why);
    ph_solver_choice choice = {.precision = "double"};
    if (!closed) PH_TRY(ph_i_run_choose_solver(r, &choice, err));
    r->solver = choice.method;
    int loads = ph_i_run_load_count(r);
    if (choice.why[1][0]) ph_i_note(r->result, "%s", choice.why[1]);
    unit_cost(r, strcmp(choice.precision, "single") == 0, &doubles, &w.ns);
    w.solved = w.least = loads;
    if (p->loading)
        count_failure(r, loads, &w, out);
    else if (cracks > 0)
        w.solved = w.least = loads * loads_of_steps(p, &w, density, cracks);
    double extra = p->loading   ? bytes_of_failure(r)
                   : cracks > 0 ? bytes_of_steps(r, loads)
                                : 0.0;
    out->nodes = ph_grid_cells(&r->setting.box);
    out->unknowns = out->nodes * ph_displacements(r->result->grid.kinematics);
    out->bytes = (size_t)(8.0 * doubles * w.nodes + extra) + r->meter.peak;
    out->loads = loads;
    out->seconds_load = 1e-9 * w.ns * w.nodes * w.iterations;
    out->seconds = closed ? 0.0 : out->seconds_load * w.solved;
    out->seconds_least = closed ? 0.0 : out->seconds_load * w.least;
out:
    return st;
}

ph_status ph_homogenise_estimate(const ph_problem *problem, ph_estimate *out,
                                 ph_error *err)
{
    ph_status st = PH_OK;
    ph_run r = {.problem = problem};
    PH_CHECK(out, PH_EINVAL, "NULL estimate");
    memset(out, 0, sizeof *out);
    PH_TRY(ph_i_run_begin(&r, err));
    if (!r.constraint->analytic) {
        PH_TRY(ph_i_run_prepare(&r, err));
        PH_TRY(count(&r, out, err));
    }
    out->nnotes = r.result->nnotes;
    memcpy(out->notes, r.result->notes, sizeof out->notes);
out:
    ph_i_run_clear(&r);
    ph_result_free(&r.result);
    return st;
}
