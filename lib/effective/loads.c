/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The loads of a run, their columns, and the stiffness that the columns make. */
#include <perihom/quantity.h>

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

/* Averages of a solved load: its column, and what the energies say. */
static ph_status take_column(ph_run *r, int load, const double *macro, const double *unit,
                             ph_error *err)
{
    ph_status st = PH_OK;
    int ns = r->map->ns;
    double stress[6], strain[6], work = 0.0, off = 0.0, size = 0.0;
    ph_cell_energy e;
    PH_TRY(ph_i_operator_sums(r->op, r->u, macro, r->setting.region, stress, strain, &e,
                              err));
    double n = (double)r->setting.averaged;
    for (int i = 0; i < ns; i++) {
        stress[i] /= n;
        strain[i] /= n;
        if (r->broken && macro) strain[i] = macro[i]; /* the rest is in the gaps */
        work += stress[i] * strain[i];
        bool by_stress = ph_i_run_by_stress(r, i);
        double wrong = (by_stress ? stress[i] : strain[i]) - unit[i];
        off += wrong * wrong;
        size += unit[i] * unit[i];
        r->columns.m[i][load] = by_stress ? strain[i] : stress[i];
    }
    double total = (e.mean + e.modes + e.stabilisation) / n;
    double theta =
        r->params.stabilisation == PH_STABILISE_SUBPOINT ? r->params.value : 0.0;
    double extra = e.stabilisation;
    if (theta > 0.0)
        extra += r->op->has_cells ? e.modes
                                  : e.modes - theta / (1.0 - theta + 1e-300) * e.mean;
    ph_result *res = r->result;
    double solid = res->voigt.m[load][load], size_of_energy = fabs(total);
    /* A cell that cracks cut through has no energy but the solver's tolerance. */
    if (r->broken && macro)
        size_of_energy = fmax(size_of_energy, ph_i_run_tolerance(r) * solid);
    res->strain_average = fmax(res->strain_average, sqrt(off / size));
    /* Layers with nothing between them: a load without energy has no share of it. */
    if (size_of_energy > no_load * (ph_i_run_by_stress(r, load) ? 1.0 / solid : solid)) {
        res->hill_mandel = fmax(res->hill_mandel, fabs(total - work) / size_of_energy);
        res->stabilisation_energy =
            fmax(res->stabilisation_energy, fabs(extra) / n / size_of_energy);
    }
    for (int i = 0; r->op->springs && i < ns; i++)
        res->bond.virial.m[i][load] = stress[i];
    res->bond.virial.n = ns;
    if (r->op->springs && r->setting.source) take_reactions(r, load, macro);
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
           (!r->problem->loads || r->problem->loads == ph_i_run_all_loads(r->result));
}

static ph_status keep_displacement(ph_run *r, int load, ph_error *err)
{
    ph_status st = PH_OK;
    size_t n = (size_t)(r->op->layout.nd * r->op->layout.cells);
    if (!r->kept[load])
        PH_DOUBLES(r->kept[load], &r->meter, n, "the displacement of a load");
    memcpy(r->kept[load], r->u, n * sizeof(double));
out:
    return st;
}

/* Products of the residual of a load that is kept with the displacements kept so far. */
static ph_status keep_residual(ph_run *r, int load, const double *macro, ph_error *err)
{
    ph_status st = PH_OK;
    ptrdiff_t cells = r->op->layout.cells, n = r->op->layout.nd * cells;
    if (!r->residual) {
        PH_DOUBLES(r->residual, &r->meter, (size_t)n, "a residual");
        PH_DOUBLES(r->product, &r->meter, (size_t)n, "a product");
        PH_TRY(ph_i_operator_in_space(r->op, err));
    }
    ph_i_operator_load(r->op, macro, r->residual);
    ph_i_operator_apply(r->op, r->kept[load], r->product);
    for (int a = 0; a <= load; a++) {
        double sum = 0.0;
        for (ptrdiff_t x = 0; r->kept[a] && x < n; x++)
            if (!r->setting.fixed || !r->setting.fixed[x % cells])
                sum += r->kept[a][x] * (r->residual[x] - r->product[x]);
        r->second.m[a][load] = sum / (double)r->setting.averaged;
    }
    memcpy(r->u, r->kept[load], (size_t)n * sizeof(double));
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
static ph_status take_load(ph_run *r, int load, const double *macro, const double *unit,
                           bool converged, ph_error *err)
{
    ph_status st = PH_OK;
    if (converged && macro && ph_i_run_second_order(r))
        PH_TRY(keep_residual(r, load, macro, err));
    if (r->first[load])
        memcpy(r->first[load], r->u,
               sizeof(double) * (size_t)(r->op->layout.nd * r->op->layout.cells));
    PH_TRY(take_column(r, load, macro, unit, err));
    if (r->keep_fields && converged) st = ph_i_run_keep_fields(r, load, macro, err);
out:
    return st;
}

/* The softest phase in the metric of the reference medium, which a laminate is not below: the
 * least eigenvalue of the preconditioned operator is not, either. 0: there is no bound. */
static double least_eigenvalue(const ph_run *r)
{
    const ph_stiffness_map *map = r->map;
    const int ns = map->ns;
    double least = 1.0;
    if (map->has_void || r->broken || r->classes || r->setting.source ||
        r->setting.fixed || r->constraint->by_stress)
        return 0.0;
    for (int p = 0; p < map->materials; p++) {
        ph_sym4 c = {.n = ns};
        double low, high;
        for (int i = 0; i < ns * ns; i++)
            c.m[i / ns][i % ns] = map->c[(ptrdiff_t)p * ns * ns + i];
        if (!map->used[p]) continue;
        ph_i_visco_relative(&c, &map->middle, &low, &high);
        least = fmin(least, low);
    }
    return fmax(0.0, least * (1.0 - 1e-9));
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

static ph_status solve_load(ph_run *r, int load, int number, int loads, ph_error *err)
{
    ph_status st = PH_OK;
    ph_result *res = r->result;
    double unit[6] = {0};
    unit[load] = 1.0;
    const double *macro = ph_i_run_by_stress(r, load) ? NULL : unit;
    ph_cg_report report = new_report(r, number, loads, r->first[load] != NULL);
    if (macro)
        ph_i_operator_load(r->op, macro, r->load);
    else
        ph_i_operator_pull(r->op, unit, r->setting.region, r->load);
    stop_by_energy(r, load, &report);
    st = solve_for(r, !macro, r->first[load], &report, err);
    res->iterations[res->nloads] = report.iterations;
    res->residual[res->nloads++] = report.residual;
    if (st != PH_OK && st != PH_ENOCONV) return st;
    bool follow = r->symmetry.count > 1 && r->keep_fields;
    if (st == PH_OK && (follow || ph_i_run_second_order(r)))
        PH_TRY(keep_displacement(r, load, err));
    ph_status taken = take_load(r, load, macro, unit, st == PH_OK, err);
    if (taken != PH_OK) st = taken;
out:
    return st;
}

/* A load that a symmetry makes of one that is solved and kept: its field is that one turned. */
static ph_status turn_load(ph_run *r, int load, ph_error *err)
{
    ph_status st = PH_OK;
    int from = load;
    double unit[6] = {0};
    unit[load] = 1.0;
    const ph_turn *t = ph_i_symmetry_source(&r->symmetry, r->result->solved, load, &from);
    const ptrdiff_t n = r->op->layout.nd * r->op->layout.cells;
    bool corners = r->result->points != PH_POINTS_NODES;
    ph_i_symmetry_turn_field(t, &r->setting.box, r->op->layout.nd, corners, r->kept[from],
                             r->u);
    for (ptrdiff_t x = 0; t->flip[from] < 0 && x < n; x++)
        r->u[x] = -r->u[x];
    if (ph_i_run_second_order(r)) PH_TRY(keep_displacement(r, load, err));
    st = take_load(r, load, unit, unit, true, err);
out:
    return st;
}

/* Loads that the constants which are asked for need, in this cell. */
static unsigned loads_of_constants(const ph_run *r)
{
    const ph_problem *p = r->problem;
    ph_kinematics kin = r->result->grid.kinematics;
    ph_cell_symmetry none = ph_i_symmetry_none(r->map->ns);
    const ph_cell_symmetry *s = r->symmetry.count ? &r->symmetry : &none;
    unsigned loads = 0;
    for (int i = 0; i < p->nconstants; i++) {
        const ph_quantity *q = &p->constants[i];
        bool by_row = q->kind && q->kind->row && !ph_quantity_refuses(q, kin);
        loads |= by_row ? ph_i_symmetry_block(s, q->kind->row(q, kin))
                        : ph_quantity_loads(q, kin);
    }
    return loads;
}

/* Refined entries take the fields of all loads, and so does a compliance as a whole. */
static unsigned wanted_loads(const ph_run *r)
{
    const ph_problem *p = r->problem;
    unsigned all = ph_i_run_all_loads(r->result);
    if (r->constraint->by_stress || ph_i_run_second_order(r)) return all;
    if (p->nconstants) return loads_of_constants(r) & all;
    return p->loads ? p->loads & all : all;
}

static int count_of(unsigned loads)
{
    int count = 0;
    for (; loads; loads >>= 1)
        count += (int)(loads & 1u);
    return count;
}

unsigned ph_i_run_solved_loads(const ph_run *r)
{
    unsigned loads = wanted_loads(r);
    return r->symmetry.count ? ph_i_symmetry_loads(&r->symmetry, loads) : loads;
}

static void say_symmetry(const ph_run *r)
{
    int follow = count_of(r->result->loads & ~r->result->solved);
    if (follow)
        ph_i_note(r->result,
                  "loads: %d of the columns follow from the %d symmetries of the cell",
                  follow, r->symmetry.count);
}

ph_status ph_i_run_loads(ph_run *r, ph_error *err)
{
    ph_status st = PH_OK;
    ph_result *res = r->result;
    unsigned wanted = wanted_loads(r), loads = ph_i_run_solved_loads(r);
    int number = 0;
    bool all_fields = r->keep_fields || ph_i_run_second_order(r);
    if (!res->fields) PH_ALLOC(res->fields, count_of(wanted), "fields");
    r->columns.n = r->map->ns;
    for (int a = 0; a < r->map->ns; a++) {
        if (loads >> a & 1)
            PH_TRY(solve_load(r, a, ++number, count_of(loads), err));
        else if (all_fields && wanted >> a & 1)
            PH_TRY(turn_load(r, a, err));
        else
            continue;
        res->solved |= loads & 1u << a;
        res->loads |= 1u << a;
    }
    if (r->symmetry.count && !ph_i_run_second_order(r))
        res->loads = ph_i_symmetry_complete(&r->symmetry, res->solved, &r->columns);
    say_symmetry(r);
    res->converged = true;
out:
    return st;
}

/* Columns of mixed loads -> stiffness. With X the components loaded by stress and M the
 * others, e_X = A s_X + B e_M and s_M = D s_X + F e_M. */
static ph_status from_mixed(const ph_run *r, ph_sym4 *c, ph_error *err)
{
    ph_status st = PH_OK;
    int ns = r->map->ns, x[6], nx = 0;
    ph_sym4 A = {.n = ns}, mixed = *c;
    for (int i = 0; i < ns; i++)
        if (ph_i_run_by_stress(r, i)) x[nx++] = i;
    for (int i = 0; i < ns; i++)
        A.m[i][i] = 1.0;
    for (int p = 0; p < nx; p++)
        for (int q = 0; q < nx; q++)
            A.m[x[p]][x[q]] = mixed.m[x[p]][x[q]];
    PH_TRY(ph_sym4_inverse(&A, &A, err));
    for (int i = 0; i < ns; i++)
        for (int j = 0; j < ns; j++) {
            bool xi = ph_i_run_by_stress(r, i), xj = ph_i_run_by_stress(r, j);
            double v = !xi && !xj ? mixed.m[i][j] : 0.0;
            for (int p = 0; p < nx; p++)
                for (int q = 0; q < nx; q++) {
                    double left = xi ? (double)(x[p] == i) : mixed.m[i][x[p]];
                    double right = xj ? (double)(x[q] == j) : -mixed.m[x[q]][j];
                    v += left * A.m[x[p]][x[q]] * right;
                }
            c->m[i][j] = v;
        }
out:
    return st;
}

/* The largest correction m_ab over sqrt(c_aa c_bb): a direction in which the composite is as
 * stiff as its fibres must not hide the others.
 * An isolated body in a void has c = 0: `least` is what counts as nothing. */
static double worst_correction(const ph_sym4 *m, const ph_sym4 *c, double least)
{
    double worst = 0.0;
    for (int a = 0; a < c->n; a++)
        for (int b = 0; b < c->n; b++)
            worst = fmax(worst, fabs(m->m[a][b]) / sqrt(fmax(c->m[a][a], least)) /
                                    sqrt(fmax(c->m[b][b], least)));
    return worst;
}

/* Cracks may leave nothing at all: what matters is small beside the whole cell. */
static double least_stiffness(const ph_run *r)
{
    return (r->broken ? 1e-3 : 1e-6) * r->map->softest;
}

/* Second-order entries. Where the correction is as large as the answer, its square is not
 * small either (measured: a tenth of the answer goes with an error of a percent). */
static ph_status refine(ph_run *r, ph_sym4 *c, ph_error *err)
{
    ph_status st = PH_OK;
    int ns = r->map->ns;
    if (!ph_i_run_second_order(r)) return PH_OK;
    for (int b = 0; b < ns; b++)
        for (int a = 0; a <= b; a++) {
            r->second.m[b][a] = r->second.m[a][b];
            c->m[a][b] = c->m[b][a] = r->columns.m[a][b] - r->second.m[a][b];
        }
    if (r->symmetry.count) ph_i_symmetry_average(&r->symmetry, c);
    double off = worst_correction(&r->second, c, least_stiffness(r));
    r->result->converged = off <= 0.1;
    r->result->second_order = true;
    r->result->stiffness = *c;
    PH_CHECK(r->result->converged, PH_ENOCONV,
             "the error of the stress averages is %.2g of the effective tensor: contrast "
             "%.2g asks for a lower solver.tolerance",
             off, r->map->contrast);
out:
    return st;
}

void ph_i_run_solved_columns(ph_run *r)
{
    ph_result *res = r->result;
    int ns = r->map->ns;
    if (r->constraint->by_stress) res->loads = 0; /* the inverse needs them all */
    for (int a = 0; a < ns; a++)
        for (int b = 0; b < ns; b++)
            res->stiffness.m[b][a] = (res->loads >> a) & 1 ? r->columns.m[b][a] : 0.0;
}

ph_status ph_i_run_stiffness(ph_run *r, ph_error *err)
{
    ph_status st = PH_OK;
    ph_result *res = r->result;
    int ns = r->map->ns;
    ph_sym4 c = r->columns;
    if (r->constraint->by_stress) PH_TRY(from_mixed(r, &c, err));
    if (res->loads == ph_i_run_all_loads(res)) {
        double off = 0.0;
        for (int i = 0; i < ns; i++)
            for (int j = 0; j < i; j++) {
                double d = c.m[i][j] - c.m[j][i];
                off += 2.0 * d * d;
                c.m[i][j] = c.m[j][i] = 0.5 * (c.m[i][j] + c.m[j][i]);
            }
        double size = fmax(ph_sym4_norm(&c), least_stiffness(r));
        res->asymmetry = size > 0.0 ? sqrt(off) / size : 0.0;
        st = refine(r, &c, err);
    }
    res->stiffness = c;
out:
    return st;
}
