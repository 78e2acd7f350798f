/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/homogenise.h>

#include "effective/failure.h"

#include <math.h>
#include <omp.h>
#include <string.h>
#include <time.h>

/* Fewer cells than this do not pay for another thread; the result has the same bits. */
enum { CELLS_PER_THREAD = 8192 };

double ph_i_run_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

void ph_i_run_clear(ph_run *r)
{
    if (r->solver && r->state) r->solver->free(&r->state);
    size_t n = r->op ? (size_t)(r->op->layout.nd * r->op->layout.cells) : 0;
    for (int a = 0; a < 6; a++) {
        ph_i_doubles_free(&r->meter, &r->kept[a], n);
        ph_i_doubles_free(&r->meter, &r->pulled[a], n);
        ph_i_doubles_free(&r->meter, &r->first[a], n);
    }
    ph_i_doubles_free(&r->meter, &r->residual, n);
    ph_i_doubles_free(&r->meter, &r->product, n);
    ph_i_operator_free(&r->op);
    ph_i_broken_free(&r->broken);
    ph_family_free(&r->family);
    ph_i_bond_classes_free(&r->classes);
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
    res->precision = "double";
    res->nmaterials = micro->nmaterials;
    PH_ALLOC(res->names, micro->nmaterials, "names");
    PH_ALLOC(res->fractions, micro->nmaterials, "fractions");
    for (int m = 0; m < micro->nmaterials; m++)
        memcpy(res->names[m], micro->materials[m].name, sizeof res->names[m]);
    res->interface = p->interface;
    if (p->interface == PH_INTERFACE_COMPOSITE) {
        ph_microstructure_fractions(micro, res->fractions);
        PH_CHECK(!isnan(res->fractions[0]), PH_ENOMEM, "no memory for %d fractions",
                 micro->nmaterials);
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

void ph_i_fields_free(int count, ph_fields *fields)
{
    for (int i = 0; i < count; i++) {
        free(fields[i].displacement);
        free(fields[i].strain);
        free(fields[i].stress);
    }
    free(fields);
}

void ph_result_free(ph_result **result)
{
    if (!result || !*result) return;
    ph_result *res = *result;
    ph_i_fields_free(res->nfields, res->fields);
    free(res->error_bar);
    ph_prony_free(&res->relaxation);
    ph_damage_free(&res->damage);
    ph_failure_path_free(&res->failure);
    free(res->names);
    free(res->fractions);
    free(res);
    *result = NULL;
}

unsigned ph_i_run_all_loads(const ph_result *res)
{
    return (1u << ph_strains(res->grid.kinematics)) - 1u;
}

static void analytic_answer(ph_result *res, const ph_sym4 *c, const char *why)
{
    res->stiffness = *c;
    res->loads = ph_i_run_all_loads(res);
    res->route = "analytic";
    res->solver = "analytic";
    res->converged = true;
    ph_i_note(res, "solver: none (%s)", why);
}

/* ---- set up -------------------------------------------------------------------------- */

/* Squares and cubes of moduli over lengths have to stay within the range of a double. */
static const double least_modulus = 1e-60, most_modulus = 1e60;

static ph_status check_materials(const ph_microstructure *micro, ph_error *err)
{
    ph_status st = PH_OK;
    for (int m = 0; m < micro->nmaterials; m++) {
        char key[80];
        double size = ph_sym4_norm(&micro->materials[m].stiffness);
        snprintf(key, sizeof key, "materials.%s", micro->materials[m].name);
        PH_CHECK_KEY(
            size == 0.0 || (size > least_modulus && size < 1e2 * most_modulus),
            PH_EUNPHYSICAL, key,
            "material '%s': stiffness of %g is outside %g to %g: choose other units",
            micro->materials[m].name, size, least_modulus, most_modulus);
    }
out:
    return st;
}

static ph_status check_problem(const ph_problem *p, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(p && p->micro, PH_EINVAL, "no microstructure");
    PH_TRY(ph_microstructure_check(p->micro, err));
    PH_TRY(check_materials(p->micro, err));
    int collar = p->constraint.collar_material;
    PH_CHECK_KEY(p->constraint.collar != PH_COLLAR_MATRIX ||
                     (collar >= 0 && collar < p->micro->nmaterials),
                 PH_EINVAL, "constraint.collar",
                 "material %d of the collar is outside 0..%d", collar,
                 p->micro->nmaterials - 1);
    double t = p->solver.tolerance;
    PH_CHECK_KEY(t == 0.0 || (t > 0.0 && t < 1.0), PH_EINVAL, "solver.tolerance",
                 "solver tolerance must be in (0, 1), got %g", t);
    PH_CHECK_KEY(
        ph_i_precision_is_known(p->solver.precision), PH_EINVAL, "solver.precision",
        "unknown precision '%.40s': must be double, single or auto", p->solver.precision);
    PH_CHECK_KEY(p->solver.max_iterations >= 0, PH_EINVAL, "solver.max_iterations",
                 "max_iterations must not be negative, got %d", p->solver.max_iterations);
    PH_CHECK_KEY(isfinite(p->model.horizon) && p->model.horizon >= 0.0, PH_EINVAL,
                 "model.horizon", "horizon must be > 0, got %g", p->model.horizon);
    double v = p->model.stabilisation_value;
    PH_CHECK_KEY(v >= 0.0 && v <= 1.0, PH_EINVAL, "model.stabilisation",
                 "the stabilisation must be in (0, 1], got %g", v);
    double tips = p->model.crack_tips;
    PH_CHECK_KEY(tips >= 0.0 && tips <= 2.0, PH_EINVAL, "model.crack_tips",
                 "crack_tips must be in [0, 2] spacings, got %g", tips);
out:
    return st;
}

ph_status ph_i_run_begin(ph_run *r, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_problem *p = r->problem;
    PH_TRY(check_problem(p, err));
    r->threads = r->ctx && r->ctx->threads > 0 ? r->ctx->threads : omp_get_max_threads();
    ptrdiff_t worth = 1 + ph_grid_cells(&p->micro->grid) / CELLS_PER_THREAD;
    if (r->threads > worth) r->threads = (int)worth;
    r->constraint = ph_i_constraint_find(p->constraint.kind);
    PH_CHECK_KEY(r->constraint, PH_EINVAL, "constraint.kind", "unknown constraint '%s'",
                 p->constraint.kind);
    const ph_model_method *model = ph_i_model_find(p->model.kind);
    bool mixes = p->interface == PH_INTERFACE_COMPOSITE && p->micro->ncuts > 0;
    bool in_time = p->loading && p->loading->times; /* a cut cell has two pasts */
    if (model && (model->pairwise || in_time) &&
        !r->constraint->analytic) { /* a node is one material */
        r->own = *p;
        r->own.interface = PH_INTERFACE_NODE_CENTRE;
        r->problem = p = &r->own;
    } else
        mixes = false;
    PH_TRY(new_result(p, &r->result, err));
    r->result->constraint = r->constraint->info.name;
    if (mixes)
        ph_i_note(r->result,
                  "interface: node_centre (the end of a bond is one material)");
out:
    return st;
}

static double widest_spacing(const ph_grid *g)
{
    double h = 0.0;
    for (int d = 0; d < 3; d++)
        if (g->n[d] > 1) h = fmax(h, g->h[d]);
    return h;
}

/* Anew where there is a map already. */
static ph_status make_map(ph_run *r, bool apparent, const ptrdiff_t *source,
                          const ph_grid *box, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_problem *p = r->problem;
    ph_i_stiffness_map_free(&r->meter, &r->map);
    PH_TRY(ph_i_stiffness_map_new(p->micro, p->interface, apparent, source,
                                  ph_grid_cells(box), &r->meter, &r->map, err));
    r->map->contrast = fmax(r->map->contrast, r->contrast);
    r->map->least_contrast = fmax(r->map->least_contrast, r->contrast);
out:
    return st;
}

/* Strains that are the mean gradient of a cell's corners see oblique interfaces turned. */
static bool sees_apparent_normals(const ph_run *r)
{
    const ph_problem *p = r->problem;
    bool corners = !r->family || (r->params.smallest && !r->result->bond.present);
    return corners && p->interface == PH_INTERFACE_COMPOSITE && p->micro->ncuts > 0;
}

/* Map of the RVE itself, which is what `auto` looks at. */
ph_status ph_i_run_prepare(ph_run *r, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_problem *p = r->problem;
    ph_result *res = r->result;
    PH_TRY(make_map(r, false, NULL, &p->micro->grid, err));
    PH_CHECK(r->map->softest > 0.0, PH_EUNPHYSICAL,
             "every phase of the microstructure is void: its stiffness is zero");
    PH_TRY(ph_i_model_choose(p, r->map, r->constraint->bounded, &r->params, &r->family,
                             res, err));
    PH_CHECK_KEY(
        !(res->bond.present && r->constraint->by_stress), PH_EINVAL, "constraint.kind",
        "model bond does not take %s: bonds that are missing at the faces make the "
        "material soft there. Take periodic or linear_displacement, or model nosb",
        r->constraint->info.name);
    res->model = ph_i_model_find(p->model.kind)->info.name;
    res->points = r->family ? r->family->points : PH_POINTS_STRESS;
    res->horizon = r->family ? r->family->horizon : 0.0;
    res->stabilisation = r->params.stabilisation;
    res->stabilisation_value = r->params.value;
    PH_TRY(r->constraint->prepare(p, r->family, &r->setting, err));
    if (ph_i_has_cracks(p))
        PH_TRY(ph_i_broken_new(&r->setting.box, r->family, &r->meter, &r->broken, err));
    if (r->broken) r->broken->tips = p->model.crack_tips * widest_spacing(&res->grid);
    r->params.broken = r->broken;
    if (res->bond.present)
        PH_TRY(ph_i_bond_classes_new(p->micro, p->model.kappa, r->setting.source,
                                     ph_grid_cells(&r->setting.box), &r->classes, err));
    r->params.classes = r->classes;
    if (r->setting.source || sees_apparent_normals(r))
        PH_TRY(make_map(r, sees_apparent_normals(r), r->setting.source, &r->setting.box,
                        err));
out:
    return st;
}

static const double default_tolerance = 1e-6;

double ph_i_run_tolerance(const ph_run *r)
{
    double t = r->problem->solver.tolerance;
    return t > 0.0 ? t : default_tolerance;
}

ph_status ph_i_run_choose_solver(ph_run *r, ph_solver_choice *out, ph_error *err)
{
    ph_solver_params wanted = r->problem->solver;
    wanted.tolerance = ph_i_run_tolerance(r);
    /* Points that see more than their own cell end with the body at its faces. */
    bool body = r->constraint->by_stress;
    r->params.one_sided = body && r->family && !r->params.smallest;
    r->system = (ph_system){.setting = &r->setting,
                            .params = &r->params,
                            .map = r->map,
                            .meter = &r->meter,
                            .one_sided = r->params.one_sided,
                            .relaxes = r->contrast > 0.0,
                            .few = ph_i_run_stress_is_less(r)};
    return ph_i_solver_choose(&wanted, &r->system, out, err);
}

ph_status ph_i_run_in_double(const ph_run *r, const char *route, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(strcmp(r->result->precision, "double") == 0, PH_EINVAL,
             "precision single cannot take route %s, which is solved in double: take "
             "carson or stepping, or precision double",
             route);
out:
    return st;
}

ph_status ph_i_run_build(ph_run *r, ph_error *err)
{
    ph_status st = PH_OK;
    ph_solver_choice choice;
    /* Held or missing nodes need the hourglass term where the material is. */
    r->params.hourglass_in_space = r->setting.source || r->setting.fixed;
    r->params.threads = r->threads;
    memcpy(r->params.rve, r->result->grid.n, sizeof r->params.rve);
    PH_TRY(ph_i_run_choose_solver(r, &choice, err));
    r->solver = choice.method;
    for (int i = 0; i < 2; i++)
        if (choice.why[i][0]) ph_i_note(r->result, "%s", choice.why[i]);
    PH_TRY(
        ph_i_operator_new(&r->setting.box, r->map, &r->params, &r->meter, &r->op, err));
    r->system.op = r->op;
    PH_TRY(r->solver->init(&r->system, &r->state, err));
    r->load = r->op->f;
    r->u = r->op->u;
    r->result->solver = r->solver->info.name;
    r->result->precision = choice.precision;
    r->result->route = ph_i_route_name(r->op->route);
out:
    return st;
}

/* The factors of a solver, where it cannot change them, and the lists of the route `bonds` are
 * made once: make them anew.
 * Everything else takes in the damaged nodes in place. */
ph_status ph_i_run_rebuild(ph_run *r, ph_error *err)
{
    ph_status st = PH_OK;
    bool done = !r->solver->keeps_matrix;
    PH_TRY(ph_i_operator_update(r->op, err));
    if (!done && !r->op->bonds && r->solver->broke)
        PH_TRY(r->solver->broke(r->state, &done, err));
    ph_i_broken_seen(r->broken);
    if (done && !r->op->bonds) return PH_OK;
    r->solver->free(&r->state);
    if (!r->op->bonds) return r->solver->init(&r->system, &r->state, err);
    int notes = r->result->nnotes; /* they are there already */
    ph_i_operator_free(&r->op);
    PH_TRY(ph_i_run_build(r, err));
    r->result->nnotes = notes;
out:
    return st;
}

void ph_i_run_account(ph_run *r, double start, double solving)
{
    ph_result *res = r->result;
    res->seconds = ph_i_run_now() - start;
    res->seconds_solve = solving;
    res->threads = r->threads;
    res->work = r->work;
    res->work.peak_bytes = r->meter.peak;
    res->work.bond_bits = r->broken ? ph_i_broken_bits(r->broken) : 0;
    if (!r->op) return;
    res->work.applications = r->op->applications;
    res->work.ffts = ph_i_fft_count(r->op->fft) + r->op->ffts;
    res->work.collar = r->op->layout.cells - ph_grid_cells(&res->grid);
}

static size_t larger(size_t a, size_t b)
{
    return a > b ? a : b;
}

void ph_i_work_add(ph_work *sum, const ph_work *more)
{
    sum->loads += more->loads;
    sum->iterations += more->iterations;
    sum->applications += more->applications;
    sum->ffts += more->ffts;
    if (more->collar > sum->collar) sum->collar = more->collar;
    sum->history_variables = larger(sum->history_variables, more->history_variables);
    sum->bond_bits = larger(sum->bond_bits, more->bond_bits);
    sum->peak_bytes = larger(sum->peak_bytes, more->peak_bytes);
}

/* Cracks, held nodes and bonds have a load solved for each column. */
ph_status ph_i_run_find_symmetry(ph_run *r, ph_error *err)
{
    bool plain =
        !r->setting.source && !r->setting.fixed && !r->broken && !r->result->bond.present;
    r->symmetry = ph_i_symmetry_none(r->map->ns);
    if (!plain) return PH_OK;
    return ph_i_symmetry_find(&r->setting.box, r->map, &r->symmetry, err);
}

ph_status ph_i_run_check_analytic(const ph_run *r, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK_KEY(
        !r->constraint->analytic || !ph_i_has_cracks(r->problem), PH_EINVAL,
        "constraint.kind",
        "constraint %s solves no equations and knows nothing of cracks: take periodic "
        "or linear_displacement",
        r->constraint->info.name);
out:
    return st;
}

static ph_status answer(ph_run *r, double *solving, ph_error *err)
{
    ph_status st = PH_OK;
    ph_result *res = r->result;
    const char *name = r->constraint->info.name;
    PH_TRY(ph_i_run_check_analytic(r, err));
    if (r->constraint->analytic) {
        bool upper = strcmp(name, "voigt") == 0;
        analytic_answer(res, upper ? &res->voigt : &res->reuss, name);
        res->model = "none";
        if (!upper && res->reuss_is_zero)
            ph_i_note(res, "a void phase: the Reuss bound is zero");
        return PH_OK;
    }
    PH_TRY(ph_i_run_prepare(r, err));
    ph_sym4 exact;
    char why[64];
    if (ph_i_run_closed_form(r, &exact, why)) {
        analytic_answer(res, &exact, why);
        return PH_OK;
    }
    PH_TRY(ph_i_run_find_symmetry(r, err));
    PH_TRY(ph_i_run_build(r, err));
    double start = ph_i_run_now();
    r->keep_fields = r->problem->keep_fields;
    st = r->problem->loading ? ph_i_run_failure(r, err)
         : r->broken         ? ph_i_run_damage(r, err)
                             : ph_i_run_loads(r, err);
    *solving = ph_i_run_now() - start;
    if (st == PH_ENOCONV) ph_i_run_solved_columns(r);
    if (st != PH_OK) goto out;
    if (!r->broken) PH_TRY(ph_i_run_stiffness(r, err));
out:
    return st;
}

/* Bonds break while phases relax. */
static ph_status in_time(ph_run *r, double *solving, ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(ph_i_run_relaxing(r, err));
    double start = ph_i_run_now();
    st = ph_i_run_failure_in_time(r, err);
    *solving = ph_i_run_now() - start;
    if (st == PH_ENOCONV) ph_i_run_solved_columns(r);
out:
    return st;
}

ph_status ph_homogenise(const ph_problem *problem, const ph_ctx *ctx, ph_result **out,
                        ph_error *err)
{
    ph_status st = PH_OK;
    double start = ph_i_run_now(), solving = 0.0;
    ph_run r = {.problem = problem, .ctx = ctx};
    PH_CHECK(out, PH_EINVAL, "NULL result");
    *out = NULL;
    if (problem && problem->loading && problem->loading->times) {
        st = in_time(&r, &solving, err);
        if (!r.result) goto out;
    } else {
        PH_TRY(ph_i_run_begin(&r, err));
        st = answer(&r, &solving, err);
    }
    ph_i_run_account(&r, start, solving);
    if (st == PH_OK || st == PH_ENOCONV) {
        *out = r.result;
        r.result = NULL;
    }
out:
    ph_i_run_clear(&r);
    ph_result_free(&r.result);
    return st;
}
