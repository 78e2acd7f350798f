/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/homogenise.h>

#include "model/models.h"
#include "solve/solver.h"

#include <math.h>
#include <omp.h>
#include <string.h>
#include <time.h>

static const double default_tolerance = 1e-6;
enum { DEFAULT_ITERATIONS = 2000 };
/* A load below this share of the forces that its stresses could make is round-off. */
static const double no_load = 1e-13;

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Everything that one call makes and has to release. */
typedef struct run {
    const ph_problem *problem;
    const ph_ctx *ctx;
    int threads;
    ph_meter meter;
    const ph_constraint_method *constraint;
    ph_setting setting;
    ph_stiffness_map *map;
    ph_operator_params params;
    ph_family *family;
    ph_operator *op;
    ph_system system;
    const ph_solver_method *solver;
    void *state;
    double *load, *u; /* the operator's work fields, see solver.h */
    ph_sym4 columns; /* C or, by_stress, the compliance */
    ph_result *result;
} run;

static void run_clear(run *r)
{
    if (r->solver && r->state) r->solver->free(&r->state);
    ph_i_operator_free(&r->op);
    ph_family_free(&r->family);
    ph_i_stiffness_map_free(&r->meter, &r->map);
    ph_i_setting_clear(&r->setting);
}

/* ---- bounds and what needs no equations ------------------------------------------------ */

static ph_status simple_bounds(const ph_problem *p, ph_result *res, ph_error *err)
{
    ph_status st = PH_OK;
    int ns = ph_strains(res->grid.kinematics);
    ph_sym4 sum = {.n = ns}, inv;
    res->voigt.n = res->reuss.n = ns;
    for (int m = 0; m < res->nmaterials; m++) {
        ph_sym4 c;
        if (res->fractions[m] <= 0.0) continue;
        PH_TRY(ph_sym4_reduce(&p->micro->materials[m].stiffness, res->grid.kinematics, &c,
                              err));
        res->voigt = ph_sym4_combine(1.0, &res->voigt, res->fractions[m], &c);
        if (ph_sym4_norm(&c) == 0.0) {
            res->reuss_is_zero = true;
            continue;
        }
        PH_TRY(ph_sym4_inverse(&c, &inv, err));
        sum = ph_sym4_combine(1.0, &sum, res->fractions[m], &inv);
    }
    if (!res->reuss_is_zero) PH_TRY(ph_sym4_inverse(&sum, &res->reuss, err));
out:
    return st;
}

static ph_status new_result(const ph_problem *p, ph_result **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_result *res = NULL;
    const ph_microstructure *micro = p->micro;
    PH_ALLOC(res, 1, "the result");
    res->grid = micro->grid;
    res->nmaterials = micro->nmaterials;
    PH_ALLOC(res->names, micro->nmaterials, "names");
    PH_ALLOC(res->fractions, micro->nmaterials, "fractions");
    for (int m = 0; m < micro->nmaterials; m++)
        memcpy(res->names[m], micro->materials[m].name, sizeof res->names[m]);
    res->interface = p->interface;
    if (p->interface == PH_INTERFACE_COMPOSITE) {
        ph_microstructure_fractions(micro, res->fractions);
    } else {
        ptrdiff_t cells = ph_grid_cells(&micro->grid);
        for (ptrdiff_t x = 0; x < cells; x++)
            res->fractions[micro->phase[x]] += 1.0 / (double)cells;
    }
    res->stiffness.n = ph_strains(micro->grid.kinematics);
    PH_TRY(simple_bounds(p, res, err));
    *out = res;
    res = NULL;
out:
    ph_result_free(&res);
    return st;
}

void ph_result_free(ph_result **result)
{
    if (!result || !*result) return;
    ph_result *res = *result;
    for (int i = 0; i < res->nfields; i++) {
        free(res->fields[i].displacement);
        free(res->fields[i].strain);
        free(res->fields[i].stress);
    }
    free(res->fields);
    free(res->names);
    free(res->fractions);
    free(res);
    *result = NULL;
}

static bool is_homogeneous(const ph_stiffness_map *map)
{
    for (ptrdiff_t x = 1; x < map->cells; x++)
        if (map->index[x] != map->index[0]) return false;
    return true;
}

static unsigned all_loads(const ph_result *res)
{
    return (1u << ph_strains(res->grid.kinematics)) - 1u;
}

static void analytic_answer(ph_result *res, const ph_sym4 *c, const char *why)
{
    res->stiffness = *c;
    res->loads = all_loads(res);
    res->route = "analytic";
    res->solver = "analytic";
    res->converged = true;
    ph_i_note(res, "solver: none (%s)", why);
}

/* ---- set up -------------------------------------------------------------------------- */

static ph_status check_problem(const ph_problem *p, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(p && p->micro, PH_EINVAL, "no microstructure");
    PH_TRY(ph_microstructure_check(p->micro, err));
    double t = p->solver.tolerance;
    PH_CHECK(t == 0.0 || (t > 0.0 && t < 1.0), PH_EINVAL,
             "solver tolerance must be in (0, 1), got %g", t);
    PH_CHECK(p->solver.max_iterations >= 0, PH_EINVAL,
             "max_iterations must not be negative, got %d", p->solver.max_iterations);
    PH_CHECK(isfinite(p->model.horizon) && p->model.horizon >= 0.0, PH_EINVAL,
             "horizon must be > 0, got %g", p->model.horizon);
    double v = p->model.stabilisation_value;
    PH_CHECK(v >= 0.0 && v <= 1.0, PH_EINVAL, "the stabilisation must be in (0, 1], got %g",
             v);
out:
    return st;
}

/* Map of the RVE itself, which is what `auto` looks at. */
static ph_status prepare(run *r, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_problem *p = r->problem;
    ph_result *res = r->result;
    ptrdiff_t cells = ph_grid_cells(&p->micro->grid);
    PH_TRY(ph_i_stiffness_map_new(p->micro, p->interface, NULL, cells, &r->meter, &r->map,
                                  err));
    PH_CHECK(r->map->softest > 0.0, PH_EUNPHYSICAL,
             "every phase of the microstructure is void: its stiffness is zero");
    PH_TRY(ph_i_model_choose(p, r->map, r->constraint->exact_cells_only, &r->params,
                             &r->family, res, err));
    res->model = ph_i_model_find(p->model.kind)->info.name;
    res->points = r->family ? r->family->points : PH_POINTS_STRESS;
    res->horizon = r->family ? r->family->horizon : 0.0;
    res->stabilisation = r->params.stabilisation;
    res->stabilisation_value = r->params.value;
    PH_TRY(r->constraint->prepare(p, r->family, &r->setting, err));
    if (r->setting.source) {
        ph_i_stiffness_map_free(&r->meter, &r->map);
        PH_TRY(ph_i_stiffness_map_new(p->micro, p->interface, r->setting.source,
                                      ph_grid_cells(&r->setting.box), &r->meter, &r->map,
                                      err));
    }
out:
    return st;
}

static ph_status build(run *r, ph_error *err)
{
    ph_status st = PH_OK;
    char why[256];
    /* Held or missing nodes need the hourglass term where the material is. */
    r->params.hourglass_in_space = r->setting.source || r->setting.fixed;
    r->params.threads = r->threads;
    PH_TRY(ph_i_operator_new(&r->setting.box, r->map, &r->params, &r->meter, &r->op, err));
    r->system = (ph_system){.op = r->op,
                            .setting = &r->setting,
                            .params = &r->params,
                            .meter = &r->meter};
    r->solver = ph_i_solver_find(r->problem->solver.kind, &r->system, why);
    PH_CHECK(r->solver, PH_EINVAL, "unknown solver '%s'", r->problem->solver.kind);
    const char *no = r->solver->refuses(&r->system);
    PH_CHECK(!no, PH_EINVAL, "solver '%s' cannot take this case: %s", r->solver->info.name,
             no);
    if (why[0]) ph_i_note(r->result, "%s", why);
    PH_TRY(r->solver->init(&r->system, &r->state, err));
    r->load = r->op->f;
    r->u = r->op->u;
    r->result->solver = r->solver->info.name;
    r->result->route = ph_i_route_name(r->op->route);
out:
    return st;
}

/* ---- one load ------------------------------------------------------------------------ */

static bool load_is_nothing(const run *r)
{
    ptrdiff_t cells = r->op->layout.cells, n = r->op->layout.nd * cells;
    double sum = 0.0, stiffest = 0.0, least = INFINITY;
    const uint8_t *held = r->setting.fixed; /* their forces are reactions */
    for (ptrdiff_t x = 0; x < n; x++)
        if (!held || !held[x % cells]) sum += r->load[x] * r->load[x];
    for (int i = 0; i < r->map->ns * r->map->ns * (r->map->materials); i++)
        stiffest = fmax(stiffest, fabs(r->map->c[i]));
    for (int d = 0; d < 3; d++)
        if (r->setting.box.n[d] > 1) least = fmin(least, r->setting.box.h[d]);
    return sqrt(sum) <= no_load * stiffest / least * sqrt((double)n);
}

/* Voigt component i of Mandel values: strain (engineering shear) or stress. */
static double to_voigt(int ns, int i, double mandel, bool strain)
{
    bool shear = i >= (ns == 6 ? 3 : 2);
    return !shear ? mandel : strain ? mandel * sqrt(2.0) : mandel / sqrt(2.0);
}

static ph_status keep_fields(run *r, int load, const double *macro, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_layout *l = &r->op->layout;
    const ph_grid *g = &r->result->grid, *box = &r->setting.box;
    ptrdiff_t cells = ph_grid_cells(g), x = 0;
    double *strain = NULL;
    ph_fields *f = &r->result->fields[r->result->nfields];
    f->load = load;
    f->nu = l->nd;
    f->ns = l->ns;
    PH_ALLOC(f->displacement, l->nd * cells, "the displacement field");
    PH_ALLOC(f->strain, l->ns * cells, "the strain field");
    PH_ALLOC(f->stress, l->ns * cells, "the stress field");
    r->result->nfields++;
    PH_DOUBLES(strain, &r->meter, (size_t)(l->ns * l->cells), "the strain field");
    ph_i_operator_strain(r->op, r->u, macro, strain);
    double shift = r->result->points == PH_POINTS_NODES ? 0.5 : 0.0;
    for (ptrdiff_t i = 0; i < g->n[0]; i++)
        for (ptrdiff_t j = 0; j < g->n[1]; j++)
            for (ptrdiff_t k = 0; k < g->n[2]; k++, x++) {
                ptrdiff_t at[3] = {i, j, k}, b = 0;
                double pos[3], e[6], s[6];
                for (int d = 0; d < 3; d++) {
                    b = b * box->n[d] + at[d] + r->setting.first[d];
                    pos[d] = g->n[d] > 1 ? ((double)at[d] + shift) * g->h[d] : 0.0;
                }
                for (int a = 0; a < l->ns; a++) e[a] = strain[a * l->cells + b];
                ph_i_hooke(r->map, r->map->index[b], e, s);
                for (int a = 0; a < l->ns; a++) {
                    f->strain[a * cells + x] = to_voigt(l->ns, a, e[a], true);
                    f->stress[a * cells + x] = to_voigt(l->ns, a, s[a], false);
                }
                for (int a = 0; a < l->nd; a++) {
                    double u = r->u[a * l->cells + b];
                    for (int d = 0; macro && d < l->nd; d++) {
                        int c = a == d ? a : l->nd == 3 ? 6 - a - d : 2;
                        u += macro[c] * (a == d ? 1.0 : 1.0 / sqrt(2.0)) * pos[d];
                    }
                    f->displacement[a * cells + x] = u;
                }
            }
out:
    ph_i_doubles_free(&r->meter, &strain, (size_t)(l->ns * l->cells));
    return st;
}

/* A macro stress is prescribed, but for components that no displacement of this grid can
 * produce (33 of generalised plane strain): there it is the strain. */
static bool load_by_stress(const run *r, int load)
{
    static const int axes[6][2] = {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};
    int a = r->map->ns == 6 ? load : load == 2 ? 5 : load;
    const ptrdiff_t *n = r->problem->micro->grid.n;
    return r->constraint->by_stress && (n[axes[a][0]] > 1 || n[axes[a][1]] > 1);
}

/* Averages of a solved load: its column, and what the energies say. */
static void take_column(run *r, int load, const double *macro, const double *unit)
{
    int ns = r->map->ns;
    double stress[6], strain[6], work = 0.0, off = 0.0, size = 0.0;
    ph_cell_energy e;
    ph_i_operator_sums(r->op, r->u, macro, r->setting.region, stress, strain, &e);
    double n = (double)r->setting.averaged;
    for (int i = 0; i < ns; i++) {
        stress[i] /= n;
        strain[i] /= n;
        work += stress[i] * strain[i];
        bool by_stress = load_by_stress(r, i);
        double wrong = (by_stress ? stress[i] : strain[i]) - unit[i];
        off += wrong * wrong;
        size += unit[i] * unit[i];
        r->columns.m[i][load] = by_stress ? strain[i] : stress[i];
    }
    double total = (e.mean + e.modes + e.stabilisation) / n;
    double theta = r->params.stabilisation == PH_STABILISE_SUBPOINT ? r->params.value : 0.0;
    double extra = e.stabilisation;
    if (theta > 0.0)
        extra += r->op->has_cells ? e.modes : e.modes - theta / (1.0 - theta + 1e-300) * e.mean;
    ph_result *res = r->result;
    res->hill_mandel = fmax(res->hill_mandel, fabs(total - work) / fabs(total));
    res->strain_average = fmax(res->strain_average, sqrt(off / size));
    res->stabilisation_energy =
        fmax(res->stabilisation_energy, fabs(extra) / n / fabs(total));
}

static ph_status solve_load(run *r, int load, int number, int loads, ph_error *err)
{
    ph_status st = PH_OK;
    ph_result *res = r->result;
    const ph_solver_params *sp = &r->problem->solver;
    double unit[6] = {0};
    unit[load] = 1.0;
    const double *macro = load_by_stress(r, load) ? NULL : unit;
    ph_cg_report report = {
        .tolerance = sp->tolerance > 0.0 ? sp->tolerance : default_tolerance,
        .max_iterations = sp->max_iterations > 0 ? sp->max_iterations : DEFAULT_ITERATIONS,
        .ctx = r->ctx,
        .load = number,
        .loads = loads};
    if (macro)
        ph_i_operator_load(r->op, macro, r->load);
    else
        ph_i_cells_pull(&r->op->cells, unit, r->setting.region, r->load);
    if (load_is_nothing(r))
        memset(r->u, 0, sizeof(double) * (size_t)(r->op->layout.nd * r->op->layout.cells));
    else
        st = r->solver->solve(r->state, r->load, r->u, &report, err);
    res->iterations[res->nloads] = report.iterations;
    res->residual[res->nloads++] = report.residual;
    if (st != PH_OK && st != PH_ENOCONV) return st;
    take_column(r, load, macro, unit);
    if (r->problem->keep_fields && st == PH_OK) st = keep_fields(r, load, macro, err);
    return st;
}

static ph_status solve_loads(run *r, ph_error *err)
{
    ph_status st = PH_OK;
    ph_result *res = r->result;
    unsigned all = all_loads(res), loads = r->problem->loads ? r->problem->loads & all : all;
    int count = 0, number = 0;
    if (r->constraint->by_stress) loads = all; /* the compliance is inverted as a whole */
    for (int a = 0; a < r->map->ns; a++) count += (loads >> a) & 1;
    PH_ALLOC(res->fields, count, "fields");
    r->columns.n = r->map->ns;
    for (int a = 0; a < r->map->ns; a++) {
        if (!((loads >> a) & 1)) continue;
        PH_TRY(solve_load(r, a, ++number, count, err));
        res->loads |= 1u << a;
    }
    res->converged = true;
out:
    return st;
}

/* Columns of mixed loads -> stiffness. With X the components loaded by stress and M the
 * others, e_X = A s_X + B e_M and s_M = D s_X + F e_M. */
static ph_status from_mixed(const run *r, ph_sym4 *c, ph_error *err)
{
    ph_status st = PH_OK;
    int ns = r->map->ns, x[6], nx = 0;
    ph_sym4 A = {.n = ns}, mixed = *c;
    for (int i = 0; i < ns; i++)
        if (load_by_stress(r, i)) x[nx++] = i;
    for (int i = 0; i < ns; i++) A.m[i][i] = 1.0;
    for (int p = 0; p < nx; p++)
        for (int q = 0; q < nx; q++) A.m[x[p]][x[q]] = mixed.m[x[p]][x[q]];
    PH_TRY(ph_sym4_inverse(&A, &A, err));
    for (int i = 0; i < ns; i++)
        for (int j = 0; j < ns; j++) {
            bool xi = load_by_stress(r, i), xj = load_by_stress(r, j);
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

static ph_status finish(run *r, ph_error *err)
{
    ph_status st = PH_OK;
    ph_result *res = r->result;
    int ns = r->map->ns;
    ph_sym4 c = r->columns;
    if (r->constraint->by_stress) PH_TRY(from_mixed(r, &c, err));
    if (res->loads == all_loads(res)) {
        double off = 0.0;
        for (int i = 0; i < ns; i++)
            for (int j = 0; j < i; j++) {
                double d = c.m[i][j] - c.m[j][i];
                off += 2.0 * d * d;
                c.m[i][j] = c.m[j][i] = 0.5 * (c.m[i][j] + c.m[j][i]);
            }
        res->asymmetry = sqrt(off) / ph_sym4_norm(&c);
    }
    res->stiffness = c;
out:
    return st;
}

static void account(run *r, double start, double solving)
{
    ph_result *res = r->result;
    res->seconds = now() - start;
    res->seconds_solve = solving;
    res->peak_bytes = r->meter.peak;
    res->threads = r->threads;
    if (r->op) {
        res->applications = r->op->applications;
        res->ffts = ph_i_fft_count(r->op->fft);
    }
}

static ph_status answer(run *r, double *solving, ph_error *err)
{
    ph_status st = PH_OK;
    ph_result *res = r->result;
    const char *name = r->constraint->info.name;
    if (r->constraint->analytic) {
        bool upper = strcmp(name, "voigt") == 0;
        analytic_answer(res, upper ? &res->voigt : &res->reuss, name);
        res->model = "none";
        if (!upper && res->reuss_is_zero)
            ph_i_note(res, "a void phase: the Reuss bound is zero");
        return PH_OK;
    }
    PH_TRY(prepare(r, err));
    if (!r->setting.source && !r->problem->keep_fields && is_homogeneous(r->map)) {
        analytic_answer(res, &res->voigt, "the cell is homogeneous");
        return PH_OK;
    }
    PH_TRY(build(r, err));
    double start = now();
    st = solve_loads(r, err);
    *solving = now() - start;
    if (st != PH_OK) goto out;
    PH_TRY(finish(r, err));
out:
    return st;
}

ph_status ph_homogenise(const ph_problem *problem, const ph_ctx *ctx, ph_result **out,
                        ph_error *err)
{
    ph_status st = PH_OK;
    double start = now(), solving = 0.0;
    run r = {.problem = problem, .ctx = ctx};
    PH_CHECK(out, PH_EINVAL, "NULL result");
    *out = NULL;
    PH_TRY(check_problem(problem, err));
    r.threads = ctx && ctx->threads > 0 ? ctx->threads : omp_get_max_threads();
    r.constraint = ph_i_constraint_find(problem->constraint.kind);
    PH_CHECK(r.constraint, PH_EINVAL, "unknown constraint '%s'", problem->constraint.kind);
    PH_TRY(new_result(problem, &r.result, err));
    r.result->constraint = r.constraint->info.name;
    st = answer(&r, &solving, err);
    account(&r, start, solving);
    if (st == PH_OK || st == PH_ENOCONV) {
        *out = r.result;
        r.result = NULL;
    }
out:
    run_clear(&r);
    ph_result_free(&r.result);
    return st;
}

/* ---- estimate ------------------------------------------------------------------------ */

/* Iterations to 1e-6 by contrast, as measured for composite cells (docs/performance.md). */
static double expected_iterations(const ph_stiffness_map *map)
{
    return map->has_void ? 110.0 : 12.0 + 8.0 * log10(fmax(1.0, map->contrast)) +
                                       3.5 * sqrt(fmin(map->contrast, 1e3));
}

/* Doubles per node that the solver keeps, and nanoseconds per node and iteration, measured. */
static void unit_cost(const run *r, double *doubles, double *ns)
{
    int nd = ph_displacements(r->result->grid.kinematics);
    bool cells = !r->family || r->params.smallest;
    *doubles = cells ? 8.2 * nd + 2.0 : 8.2 * nd + 2.0 * nd + 7.0;
    *ns = (cells ? 20.0 : 30.0) * nd;
    if (r->setting.fixed) *ns *= cells ? 1.3 : 2.5;
}

ph_status ph_homogenise_estimate(const ph_problem *problem, ph_estimate *out, ph_error *err)
{
    ph_status st = PH_OK;
    run r = {.problem = problem, .threads = 1};
    double doubles, ns;
    PH_CHECK(out, PH_EINVAL, "NULL estimate");
    memset(out, 0, sizeof *out);
    PH_TRY(check_problem(problem, err));
    r.constraint = ph_i_constraint_find(problem->constraint.kind);
    PH_CHECK(r.constraint, PH_EINVAL, "unknown constraint '%s'", problem->constraint.kind);
    PH_TRY(new_result(problem, &r.result, err));
    if (!r.constraint->analytic) {
        PH_TRY(prepare(&r, err));
        unit_cost(&r, &doubles, &ns);
        double nodes = (double)ph_grid_cells(&r.setting.box);
        int loads = ph_strains(r.result->grid.kinematics);
        bool trivial = !r.setting.source && is_homogeneous(r.map);
        out->nodes = ph_grid_cells(&r.setting.box);
        out->unknowns = out->nodes * ph_displacements(r.result->grid.kinematics);
        out->bytes = (size_t)(8.0 * doubles * nodes) + r.meter.peak;
        if (!trivial)
            out->seconds = 1e-9 * ns * nodes * loads * expected_iterations(r.map);
    }
    out->nnotes = r.result->nnotes;
    memcpy(out->notes, r.result->notes, sizeof out->notes);
out:
    run_clear(&r);
    ph_result_free(&r.result);
    return st;
}
