/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The loads of a run and their columns. */
#include "effective/run.h"
#include "effective/visco.h"

#include <math.h>
#include <string.h>

enum { DEFAULT_ITERATIONS = 2000, ENERGY_STEPS = 4 };
/* A load below this share of the forces that its stresses could make is round-off. */
static const double no_load = 1e-13;

static bool load_is_nothing(const ph_run *r, bool by_stress)
{
    ptrdiff_t cells = r->op->layout.cells, n = r->op->layout.nd * cells;
    double sum = 0.0, stiffest = 0.0, least = INFINITY;
    const uint8_t *held = r->setting.fixed; /* their forces are reactions */
    for (ptrdiff_t x = 0; x < n; x++)
        if (!held || !held[x % cells]) sum += r->load[x] * r->load[x];
    for (int i = 0; i < r->map->ns * r->map->ns * r->map->materials; i++)
        stiffest = fmax(stiffest, fabs(r->map->c[i]));
    if (by_stress)
        stiffest = 1.0; /* the stress that pulls is one, whatever the material */
    for (int d = 0; d < 3; d++)
        if (r->setting.box.n[d] > 1) least = fmin(least, r->setting.box.h[d]);
    return sqrt(sum) <= no_load * stiffest / least * sqrt((double)n);
}

/* A macro stress is prescribed, but for components that no displacement of this grid can
 * produce (33 of generalised plane strain): there it is the strain. */
bool ph_i_run_by_stress(const ph_run *r, int load)
{
    static const int axes[6][2] = {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};
    int a = r->map->ns == 6 ? load : load == 2 ? 5 : load;
    const ptrdiff_t *n = r->problem->micro->grid.n;
    return r->constraint->by_stress && (n[axes[a][0]] > 1 || n[axes[a][1]] > 1);
}

/* The same column from the forces on the faces of an RVE with a frame around it. */
static void take_reactions(ph_run *r, int load, const double *macro)
{
    double stress[6];
    ph_i_springs_reactions(r->op->springs, r->setting.first, r->result->grid.n, r->u,
                           macro, stress);
    r->result->bond.has_reactions = true;
    r->result->bond.reactions.n = r->map->ns;
    for (int i = 0; i < r->map->ns; i++)
        r->result->bond.reactions.m[i][load] = stress[i];
}

/* One load of a run. */
typedef struct one_load {
    int component;
    bool by_stress;   /* a mean stress of a periodic cell, whose mean strain is found */
    double unit[6];   /* what is prescribed, Mandel */
    double strain[6]; /* the mean strain */
    bool traction;    /* on a body: there is none */
    double **kept;    /* [6] displacements of the loads of this kind */
    ph_sym4 *columns, *second;
} one_load;

static one_load new_load(ph_run *r, int component, bool by_stress)
{
    one_load l = {.component = component, .by_stress = by_stress};
    l.unit[component] = 1.0;
    l.kept = by_stress ? r->pulled : r->kept;
    l.columns = by_stress ? &r->compliance : &r->columns;
    l.second = by_stress ? &r->second_compliance : &r->second;
    l.traction = !by_stress && ph_i_run_by_stress(r, component);
    if (!by_stress) memcpy(l.strain, l.unit, sizeof l.strain);
    return l;
}

static const double *macro_of(const one_load *l)
{
    return l->traction ? NULL : l->strain;
}

/* A mean stress is met to the tolerance of the solver: what is left of it strains the cell as
 * the mean stiffness would have it, which is what makes entries off by products of errors only.
 * Second-order columns come as they are. */
static ph_status correct_column(ph_run *r, const one_load *l, const double *stress,
                                ph_error *err)
{
    ph_status st = PH_OK;
    ph_sym4 mean = ph_i_stiffness_map_mean(r->map), inverse;
    if (!l->by_stress || ph_i_run_second_order(r)) return PH_OK;
    PH_TRY(ph_sym4_inverse(&mean, &inverse, err));
    for (int i = 0; i < mean.n; i++)
        for (int j = 0; j < mean.n; j++)
            l->columns->m[i][l->component] += inverse.m[i][j] * (l->unit[j] - stress[j]);
out:
    return st;
}

/* Averages of a solved load: its column, and what the energies say. */
static ph_status take_column(ph_run *r, const one_load *l, ph_error *err)
{
    ph_status st = PH_OK;
    const int ns = r->map->ns;
    double stress[6], strain[6], work = 0.0, off = 0.0, size = 0.0;
    ph_cell_energy e;
    PH_TRY(ph_i_operator_sums(r->op, r->u, macro_of(l), r->setting.region, stress, strain,
                              &e, err));
    double n = (double)r->setting.averaged;
    for (int i = 0; i < ns; i++) {
        stress[i] /= n;
        strain[i] /= n;
        if (r->broken && !l->traction)
            strain[i] = l->strain[i]; /* the rest is in the gaps */
        work += stress[i] * strain[i];
        bool pulled = ph_i_run_by_stress(r, i);
        double meant = l->by_stress ? l->strain[i] : l->unit[i];
        double wrong = (pulled ? stress[i] : strain[i]) - meant;
        off += wrong * wrong;
        size += meant * meant;
        l->columns->m[i][l->component] = l->by_stress ? l->strain[i]
                                         : pulled     ? strain[i]
                                                      : stress[i];
    }
    PH_TRY(correct_column(r, l, stress, err));
    double total = (e.mean + e.modes + e.stabilisation) / n;
    double theta =
        r->params.stabilisation == PH_STABILISE_SUBPOINT ? r->params.value : 0.0;
    double extra = e.stabilisation;
    if (theta > 0.0)
        extra += r->op->has_cells ? e.modes
                                  : e.modes - theta / (1.0 - theta + 1e-300) * e.mean;
    ph_result *res = r->result;
    double solid = res->voigt.m[l->component][l->component];
    double size_of_energy = fabs(total);
    /* A cell that cracks cut through has no energy but the solver's tolerance. */
    if (r->broken && !l->traction)
        size_of_energy = fmax(size_of_energy, ph_i_run_tolerance(r) * solid);
    res->strain_average = fmax(res->strain_average, sqrt(off / size));
    /* Layers with nothing between them: a load without energy has no share of it. */
    bool pulled = l->by_stress || ph_i_run_by_stress(r, l->component);
    if (size_of_energy > no_load * (pulled ? 1.0 / solid : solid)) {
        res->hill_mandel = fmax(res->hill_mandel, fabs(total - work) / size_of_energy);
        res->stabilisation_energy =
            fmax(res->stabilisation_energy, fabs(extra) / n / size_of_energy);
    }
    for (int i = 0; r->op->springs && i < ns; i++)
        res->bond.virial.m[i][l->component] = stress[i];
    res->bond.virial.n = ns;
    if (r->op->springs && r->setting.source) take_reactions(r, l->component, macro_of(l));
    for (int i = 0; l->by_stress && i < ns; i++)
        r->stress_left[i] = l->unit[i] - stress[i];
out:
    return st;
}

/* Above this contrast, or this tolerance, an average of stress is not good enough: with a
 * residual r_b it is off by u_a . r_b, the solver's error times the contrast. The energy of
 * two fields, <e_a : C : e_b> = <sigma_b>_a - u_a . r_b, is off by the product of their
 * errors only. */
static const double second_order_contrast = 1e3, second_order_tolerance = 1e-4;

bool ph_i_run_second_order(const ph_run *r)
{
    return (r->map->contrast > second_order_contrast || r->broken ||
            ((ph_i_run_tolerance(r) > second_order_tolerance ||
              r->problem->solver.energy > 0.0) &&
             !r->problem->nconstants)) &&
           !r->constraint->by_stress && !(r->op && r->op->bonds) &&
           (r->problem->nconstants || !r->problem->loads ||
            r->problem->loads == ph_i_run_all_loads(r->result));
}

static ph_status keep_displacement(ph_run *r, const one_load *l, ph_error *err)
{
    ph_status st = PH_OK;
    size_t n = (size_t)(r->op->layout.nd * r->op->layout.cells);
    double **kept = &l->kept[l->component];
    if (!*kept) PH_DOUBLES(*kept, &r->meter, n, "the displacement of a load");
    memcpy(*kept, r->u, n * sizeof(double));
    if (l->by_stress) memcpy(r->strain[l->component], l->strain, sizeof l->strain);
out:
    return st;
}

/* Products of the residual of a load that is kept with the displacements kept so far; r->u is
 * lost. */
static ph_status keep_residual(ph_run *r, const one_load *l, ph_error *err)
{
    ph_status st = PH_OK;
    ptrdiff_t cells = r->op->layout.cells, n = r->op->layout.nd * cells;
    if (!r->residual) {
        PH_DOUBLES(r->residual, &r->meter, (size_t)n, "a residual");
        PH_DOUBLES(r->product, &r->meter, (size_t)n, "a product");
        PH_TRY(ph_i_operator_in_space(r->op, err));
    }
    ph_i_operator_load(r->op, macro_of(l), r->residual);
    ph_i_operator_apply(r->op, l->kept[l->component], r->product);
    for (int a = 0; a <= l->component; a++) {
        double sum = 0.0;
        const double *u = l->kept[a];
        for (ptrdiff_t x = 0; u && x < n; x++)
            if (!r->setting.fixed || !r->setting.fixed[x % cells])
                sum += u[x] * (r->residual[x] - r->product[x]);
        l->second->m[a][l->component] = sum / (double)r->setting.averaged;
    }
    memcpy(r->u, l->kept[l->component], (size_t)n * sizeof(double));
out:
    return st;
}

static ph_cg_report new_report(const ph_run *r, int number, int loads, bool guessed)
{
    const ph_solver_params *sp = &r->problem->solver;
    return (ph_cg_report){.tolerance = ph_i_run_tolerance(r),
                          .max_iterations = sp->max_iterations > 0 ? sp->max_iterations
                                                                   : DEFAULT_ITERATIONS,
                          .ctx = r->ctx,
                          .load = number,
                          .loads = loads,
                          .guessed = guessed};
}

ph_status ph_i_run_iterate(ph_run *r, const double *load, double *u, ph_cg_report *report,
                           ph_error *err)
{
    ph_status st = r->solver->solve(r->state, load, u, report, err);
    r->work.loads++;
    r->work.iterations += report->iterations;
    return st;
}

/* r->load is made; r->u on return. */
static ph_status solve_for(ph_run *r, bool by_stress, const double *guess,
                           ph_cg_report *report, ph_error *err)
{
    size_t size = sizeof(double) * (size_t)(r->op->layout.nd * r->op->layout.cells);
    if (guess) memcpy(r->u, guess, size);
    if (!load_is_nothing(r, by_stress))
        return ph_i_run_iterate(r, r->load, r->u, report, err);
    memset(r->u, 0, size);
    return PH_OK;
}

ph_status ph_i_run_solve(ph_run *r, const double *macro, bool by_stress,
                         const double *guess, double energy_most, ph_cg_report *report,
                         ph_error *err)
{
    *report = new_report(r, 1, 1, guess != NULL);
    report->energy_most = energy_most;
    report->look_back = energy_most > 0.0 ? ENERGY_STEPS : 0;
    if (by_stress)
        ph_i_operator_pull(r->op, macro, r->setting.region, r->load);
    else
        ph_i_operator_load(r->op, macro, r->load);
    return solve_for(r, by_stress, guess, report, err);
}

/* What is wanted of the load whose displacement is in r->u. */
static ph_status take_load(ph_run *r, const one_load *l, bool converged, ph_error *err)
{
    ph_status st = PH_OK;
    bool second = converged && !l->traction && ph_i_run_second_order(r);
    if (second) PH_TRY(keep_residual(r, l, err));
    if (!l->by_stress && r->first[l->component])
        memcpy(r->first[l->component], r->u,
               sizeof(double) * (size_t)(r->op->layout.nd * r->op->layout.cells));
    PH_TRY(take_column(r, l, err));
    for (int a = 0; second && l->by_stress && a <= l->component; a++)
        for (int i = 0; l->kept[a] && i < r->map->ns; i++)
            l->second->m[a][l->component] += r->strain[a][i] * r->stress_left[i];
    if (r->keep_fields && converged)
        st = ph_i_run_keep_fields(r, l->component, macro_of(l), err);
out:
    return st;
}

/* From the strain that the mean stiffness has under the stress: its load, and what the cell
 * strains beside. */
static ph_status solve_stress(ph_run *r, one_load *l, ph_cg_report *report, ph_error *err)
{
    ph_status st = PH_OK;
    ph_sym4 mean = ph_i_stiffness_map_mean(r->map), inverse;
    PH_TRY(ph_sym4_inverse(&mean, &inverse, err));
    for (int i = 0; i < mean.n; i++)
        l->strain[i] = inverse.m[i][l->component];
    ph_i_operator_load(r->op, l->strain, r->load);
    if (load_is_nothing(r, true)) {
        memset(r->u, 0,
               sizeof(double) * (size_t)(r->op->layout.nd * r->op->layout.cells));
        return PH_OK;
    }
    st = r->solver->solve_free(r->state, r->load, r->u, l->strain, report, err);
    r->work.loads++;
    r->work.iterations += report->iterations;
out:
    return st;
}

/* Bound of the eigenvalues of the preconditioned operator; 0: none is known. */
static double least_eigenvalue(const ph_run *r)
{
    bool bounded = !r->broken && !r->classes && !r->setting.source && !r->setting.fixed &&
                   !r->constraint->by_stress;
    return bounded ? ph_i_visco_least(r->map) : 0.0;
}

/* Energy of uniform strain, at u = 0; below that of Voigt, for cut cells are layers. */
static double uniform_energy(const ph_stiffness_map *map, int load)
{
    double sum = 0.0;
    for (ptrdiff_t x = 0; x < map->cells; x++)
        sum += map->c[((ptrdiff_t)map->index[x] * map->ns + load) * map->ns + load];
    return sum;
}

static void stop_by_energy(const ph_run *r, int load, ph_cg_report *report)
{
    if (!(r->problem->solver.energy > 0.0)) return;
    report->least = least_eigenvalue(r);
    report->energy_share = report->least > 0.0 ? r->problem->solver.energy : 0.0;
    report->energy_start = uniform_energy(r->map, load);
}

static ph_status solve_load(ph_run *r, one_load *l, int number, int loads, ph_error *err)
{
    ph_status st = PH_OK;
    ph_result *res = r->result;
    const double *guess = l->by_stress ? NULL : r->first[l->component];
    ph_cg_report report = new_report(r, number, loads, guess != NULL);
    if (l->by_stress) {
        st = solve_stress(r, l, &report, err);
    } else {
        if (!l->traction)
            ph_i_operator_load(r->op, macro_of(l), r->load);
        else
            ph_i_operator_pull(r->op, l->unit, r->setting.region, r->load);
        stop_by_energy(r, l->component, &report);
        st = solve_for(r, l->traction, guess, &report, err);
    }
    res->iterations[res->nloads] = report.iterations;
    res->residual[res->nloads++] = report.residual;
    if (st != PH_OK && st != PH_ENOCONV) return st;
    bool follow = r->symmetry.count > 1 && r->keep_fields;
    if (st == PH_OK && (follow || ph_i_run_second_order(r)))
        PH_TRY(keep_displacement(r, l, err));
    ph_status taken = take_load(r, l, st == PH_OK, err);
    if (taken != PH_OK) st = taken;
out:
    return st;
}

/* A load that a symmetry makes of one that is solved and kept: its field is that one turned. */
static ph_status turn_load(ph_run *r, one_load *l, unsigned solved, ph_error *err)
{
    ph_status st = PH_OK;
    int from = l->component;
    const ph_turn *t = ph_i_symmetry_source(&r->symmetry, solved, l->component, &from);
    const ptrdiff_t n = r->op->layout.nd * r->op->layout.cells;
    bool corners = r->result->points != PH_POINTS_NODES;
    ph_i_symmetry_turn_field(t, &r->setting.box, r->op->layout.nd, corners, l->kept[from],
                             r->u);
    for (ptrdiff_t x = 0; t->flip[from] < 0 && x < n; x++)
        r->u[x] = -r->u[x];
    for (int i = 0; l->by_stress && i < r->map->ns; i++)
        l->strain[t->place[i]] = t->flip[from] * t->flip[i] * r->strain[from][i];
    if (ph_i_run_second_order(r)) PH_TRY(keep_displacement(r, l, err));
    st = take_load(r, l, true, err);
out:
    return st;
}

static void say_symmetry(const ph_run *r)
{
    const ph_result *res = r->result;
    int follow = ph_i_run_count(res->loads & ~res->solved) +
                 ph_i_run_count(res->stresses & ~res->solved_stresses);
    if (follow)
        ph_i_note(r->result,
                  "loads: %d of the columns follow from the %d symmetries of the cell",
                  follow, r->symmetry.count);
}

static unsigned solved_of(const ph_run *r, unsigned wanted)
{
    return r->symmetry.count ? ph_i_symmetry_loads(&r->symmetry, wanted) : wanted;
}

/* Solve or turn the loads of one kind. */
static ph_status take_loads(ph_run *r, bool by_stress, unsigned wanted, int *number,
                            int count, ph_error *err)
{
    ph_status st = PH_OK;
    ph_result *res = r->result;
    unsigned *there = by_stress ? &res->stresses : &res->loads;
    unsigned *solved = by_stress ? &res->solved_stresses : &res->solved;
    unsigned loads =
        r->symmetry.count ? ph_i_symmetry_loads(&r->symmetry, wanted) : wanted;
    bool all_fields = r->keep_fields || ph_i_run_second_order(r);
    for (int a = 0; a < r->map->ns; a++) {
        one_load l = new_load(r, a, by_stress);
        if (loads >> a & 1)
            PH_TRY(solve_load(r, &l, ++*number, count, err));
        else if (all_fields && wanted >> a & 1)
            PH_TRY(turn_load(r, &l, *solved, err));
        else
            continue;
        *solved |= loads & 1u << a;
        *there |= 1u << a;
    }
    if (!r->symmetry.count) return PH_OK;
    ph_sym4 unused = r->columns, *columns = by_stress ? &r->compliance : &r->columns;
    if (ph_i_run_second_order(r)) columns = &unused; /* made of pairs, later */
    if (*solved) *there = ph_i_symmetry_complete(&r->symmetry, *solved, columns);
out:
    return st;
}

/* A cell that falls to pieces has no strain under a stress, but a stiffness. */
static ph_status without_stresses(ph_run *r, ph_error *err)
{
    ph_result *res = r->result;
    ph_i_note(res, "loads: strains, because a mean stress found no strain");
    r->no_stress = true;
    res->nloads = 0;
    res->loads = res->solved = res->stresses = res->solved_stresses = 0;
    res->hill_mandel = res->strain_average = res->stabilisation_energy = 0.0;
    if (err) *err = (ph_error)PH_ERROR_INIT;
    return ph_i_run_loads(r, err);
}

ph_status ph_i_run_loads(ph_run *r, ph_error *err)
{
    ph_status st = PH_OK;
    ph_result *res = r->result;
    const ph_load_plan plan = ph_i_run_plan(r);
    int number = 0, count = 0;
    if (!res->fields)
        PH_ALLOC(res->fields, ph_i_run_count(plan.strain | plan.stress), "fields");
    count = ph_i_run_count(solved_of(r, plan.strain)) +
            ph_i_run_count(solved_of(r, plan.stress));
    r->columns.n = r->compliance.n = r->map->ns;
    st = take_loads(r, true, plan.stress, &number, count, err);
    if (st == PH_ESINGULAR || (st == PH_ENOCONV && plan.stress))
        return without_stresses(r, err);
    if (st != PH_OK) goto out;
    PH_TRY(take_loads(r, false, plan.strain, &number, count, err));
    say_symmetry(r);
    res->converged = true;
out:
    return st;
}
