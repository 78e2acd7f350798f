/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effective/visco.h"

#include "core/jacobi.h"

#include <math.h>
#include <string.h>

/* As in the stiffness map: near incompressibility the trace is bulk modulus. */
static const double most_of_least = 3.0;

double ph_i_visco_softness(const ph_sym4 *c)
{
    double low, high, trace = 0.0;
    ph_sym4_eigenvalues(c, &low, &high);
    for (int i = 0; i < c->n; i++)
        trace += c->m[i][i] / c->n;
    return fmin(trace, most_of_least * low);
}

/* C_p(s) of every phase of the map; of those that are not there, nothing. */
static ph_status phases_at(ph_visco *v, const ph_stiffness_map *map, double s,
                           ph_error *err)
{
    ph_status st = PH_OK;
    const ph_microstructure *micro = v->run.problem->micro;
    for (int p = 0; p < micro->nmaterials; p++) {
        const ph_material *m = &micro->materials[p];
        v->space[p] = m->relaxation ? ph_prony_carson(m->relaxation, s) : m->stiffness;
        v->phase[p] = (ph_sym4){.n = map->ns};
        if (!map->used[p]) continue;
        PH_TRY(ph_sym4_reduce(&v->space[p], micro->grid.kinematics, &v->phase[p], err));
    }
out:
    return st;
}

void ph_i_visco_relative(const ph_sym4 *a, const ph_sym4 *b, double *low, double *high)
{
    ph_sym4 root = *b, V = {.n = b->n};
    ph_i_jacobi(b->n, 6, &root.m[0][0], &V.m[0][0]);
    ph_sym4 R = {.n = b->n}, Rt = {.n = b->n};
    for (int k = 0; k < b->n; k++)
        for (int i = 0; i < b->n; i++)
            R.m[k][i] = Rt.m[i][k] =
                root.m[k][k] > 0.0 ? V.m[i][k] / sqrt(root.m[k][k]) : 0.0;
    ph_sym4 c = ph_sym4_product(&R, a);
    c = ph_sym4_product(&c, &Rt);
    ph_sym4_eigenvalues(&c, low, high);
}

double ph_i_visco_least(const ph_stiffness_map *map)
{
    const int ns = map->ns;
    double least = 1.0, low, high;
    if (map->has_void) return 0.0;
    for (int p = 0; p < map->materials; p++) {
        ph_sym4 c = {.n = ns};
        if (!map->used[p]) continue;
        for (int i = 0; i < ns * ns; i++)
            c.m[i / ns][i % ns] = map->c[(ptrdiff_t)p * ns * ns + i];
        ph_i_visco_relative(&c, &map->middle, &low, &high);
        least = fmin(least, low);
    }
    return fmax(0.0, least * (1.0 - 1e-9));
}

/* Lower bound of the eigenvalues of the operator in the metric of its preconditioner: of
 * bonds the smallest modulus over that of ph_i_operator_symbol, else that of the phases. */
static double least_eigenvalue(const ph_visco *v)
{
    const ph_stiffness_map *map = v->run.map;
    /* Held nodes: the preconditioner lacks the mean, which is no rigid motion there. */
    if (v->run.setting.fixed || v->run.constraint->by_stress) return 0.0;
    if (strcmp(v->run.solver->info.name, "fft_cg") != 0) return 0.0;
    if (v->run.broken) return 0.0; /* softer than any phase */
    if (v->run.op->springs)
        return fmin(1.0, ph_i_bond_functions_least(&v->bonds, v->run.classes) /
                             map->middle.m[0][0]);
    return ph_i_visco_least(map);
}

double ph_i_visco_factor(const ph_visco *v, double s)
{
    const ph_material *m = &v->run.problem->micro->materials[v->soft];
    double whole = 0.0, now = 0.0;
    if (!m->relaxation) return 1.0;
    ph_sym4 at = ph_prony_carson(m->relaxation, s);
    for (int i = 0; i < 6; i++)
        now += at.m[i][i], whole += m->stiffness.m[i][i];
    return now / whole;
}

ph_status ph_i_visco_set(ph_visco *v, double s, ph_error *err)
{
    ph_status st = PH_OK;
    ph_run *r = &v->run;
    PH_TRY(phases_at(v, r->map, s, err));
    PH_TRY(ph_i_stiffness_map_set(r->map, r->problem->micro, v->phase, true, err));
    double factor = ph_i_visco_factor(v, s);
    r->map->softest = v->softness * factor;
    ph_i_operator_stabilise(r->op, factor);
    if (r->op->springs) {
        ph_i_bond_functions_set(&v->bonds, s, -1, r->classes);
        PH_TRY(ph_i_operator_renew_springs(r->op, err));
    }
    if (r->state) r->solver->free(&r->state);
    PH_TRY(r->solver->init(&r->system, &r->state, err));
    v->least = least_eigenvalue(v);
out:
    return st;
}

/* ---- set up -------------------------------------------------------------------------------- */

static bool is_fluid(const ph_material *m)
{
    if (!m->relaxation) return false;
    double low, high;
    ph_sym4 begin = ph_prony_instantaneous(m->relaxation);
    ph_i_visco_relative(&m->relaxation->equilibrium, &begin, &low, &high);
    return !(low > 1e-12);
}

/* Contrast at both ends, so that `auto` decides for all s; the phase that is softest late. */
static ph_status look_ahead(ph_visco *v, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_run *r = &v->run;
    const ph_microstructure *micro = r->problem->micro;
    bool composite = r->problem->interface == PH_INTERFACE_COMPOSITE;
    double longest = 0.0, least = INFINITY, most = 0.0;
    bool *used = NULL;
    PH_ALLOC(used, micro->nmaterials, "phase flags");
    for (ptrdiff_t x = 0; x < ph_grid_cells(&micro->grid); x++)
        used[micro->phase[x]] = true;
    for (ptrdiff_t i = 0; composite && i < micro->ncuts; i++) {
        used[micro->cuts[i].material] = true;
        if (micro->cuts[i].base >= 0) used[micro->cuts[i].base] = true;
    }
    for (int p = 0; p < micro->nmaterials; p++) {
        const ph_prony *series = micro->materials[p].relaxation;
        v->fluid = v->fluid || (used[p] && is_fluid(&micro->materials[p]));
        for (int t = 0; series && t < series->nterms; t++)
            longest = fmax(longest, series->term[t].time);
    }
    v->soft = -1;
    for (int p = 0; p < micro->nmaterials; p++) {
        const ph_material *m = &micro->materials[p];
        if (!used[p] || m->is_void) continue;
        double late = v->fluid ? 1e-6 / longest : 0.0, low, high;
        ph_sym4 c = m->relaxation ? ph_prony_carson(m->relaxation, late) : m->stiffness;
        ph_sym4_eigenvalues(&c, &low, &high);
        if (v->soft < 0 || ph_i_visco_softness(&c) < least) v->soft = p;
        least = fmin(least, ph_i_visco_softness(&c));
        most = fmax(most, low);
    }
    PH_CHECK(v->soft >= 0, PH_EUNPHYSICAL,
             "every phase of the microstructure is void: its stiffness is zero");
    v->run.contrast = most / fmax(least, 1e-300);
out:
    free(used);
    return st;
}

/* Shapes of the functions in the kinematics of the case. */
static ph_status reduce_shapes(ph_visco *v, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_microstructure *micro = v->run.problem->micro;
    int n = micro->nmaterials;
    PH_ALLOC(v->shape, v->split.nfunctions * n, "shapes of the phases");
    for (int q = 0; q < v->split.nfunctions; q++)
        for (int p = 0; p < n; p++) {
            ph_sym4 *to = &v->shape[q * n + p];
            *to = (ph_sym4){.n = v->run.map->ns};
            if (v->layers.six[p] || !v->run.map->used[p]) continue;
            PH_TRY(ph_sym4_reduce(ph_i_split_shape(&v->split, q, p),
                                  micro->grid.kinematics, to, err));
        }
out:
    return st;
}

static ph_status work_fields(ph_visco *v, ph_error *err)
{
    ph_status st = PH_OK;
    ph_meter *m = &v->run.meter;
    size_t n = ph_i_visco_size(v), x = ph_i_visco_hidden(v);
    int ns = v->run.map->ns;
    for (int a = 0; a < ns; a++) {
        PH_DOUBLES(v->r[a], m, n, "a residual");
        PH_DOUBLES(v->d[a], m, n, "a correction");
    }
    PH_DOUBLES(v->u, m, n, "a displacement");
    PH_DOUBLES(v->f, m, n, "a force");
    PH_DOUBLES(v->strain, m, (size_t)(v->sites.records * ns) * (size_t)v->layers.count,
               "strains of cut cells");
    PH_DOUBLES(v->x, m, x, "strains of layers");
    PH_DOUBLES(v->y, m, x, "stresses of layers");
out:
    return st;
}

/* Phases of one stiffness at once may relax differently: equal numbers are not enough. */
static bool is_one_material(const ph_stiffness_map *map)
{
    for (ptrdiff_t x = 1; x < map->cells; x++)
        if (map->index[x] != map->index[0]) return false;
    return true;
}

/* Voigt, Reuss, or one phase everywhere: true once the model is there. */
static ph_status without_equations(ph_visco *v, bool *done, ph_error *err)
{
    ph_status st = PH_OK;
    ph_run *r = &v->run;
    double *only = NULL;
    *done = false;
    if (r->constraint->analytic) {
        const char *name = r->constraint->info.name;
        ph_i_note(r->result, "solver: none (%s)", name);
        r->result->model = "none";
        PH_TRY(
            ph_i_visco_lumped(v, strcmp(name, "voigt") == 0, r->result->fractions, err));
        *done = true;
        return PH_OK;
    }
    if (r->result->bond.present || r->broken || !is_one_material(r->map) ||
        r->setting.source || r->map->index[0] >= r->map->materials)
        return PH_OK;
    PH_ALLOC(only, r->map->materials, "fractions");
    only[r->map->index[0]] = 1.0;
    ph_i_note(r->result, "solver: none (the cell is homogeneous)");
    PH_TRY(ph_i_visco_lumped(v, true, only, err));
    *done = true;
out:
    free(only);
    return st;
}

static ph_status with_equations(ph_visco *v, ph_error *err)
{
    ph_status st = PH_OK;
    ph_run *r = &v->run;
    const ph_microstructure *micro = r->problem->micro;
    PH_ALLOC(v->phase, micro->nmaterials, "phases");
    PH_ALLOC(v->space, micro->nmaterials, "phases");
    PH_TRY(phases_at(v, r->map, INFINITY, err));
    v->softness = r->map->softest = ph_i_visco_softness(&v->phase[v->soft]);
    PH_TRY(ph_i_run_build(r, err));
    PH_TRY(ph_i_run_in_double(r, "reduced", err));
    PH_TRY(ph_i_operator_in_space(r->op, err));
    v->nfunctions = v->split.nfunctions;
    if (r->op->springs) {
        PH_CHECK_KEY(
            !r->setting.source, PH_EINVAL, "constraint.collar",
            "model bond with a collar outside the RVE has a virial for its stress, "
            "and no energy to project: take `collar: inside`, or route carson");
        PH_TRY(ph_i_bond_functions_new(r->classes, micro, &v->bonds, err));
        v->nfunctions = v->bonds.count;
    }
    PH_TRY(
        ph_i_layers_init(&v->layers, micro, &v->split, r->map, r->setting.region, err));
    PH_TRY(ph_i_sites_init(&v->sites, r->op, v->layers.count, v->layers.cell, err));
    PH_TRY(reduce_shapes(v, err));
    PH_TRY(work_fields(v, err));
    PH_TRY(ph_i_reduced_init(&v->model, r->map->ns, v->nfunctions,
                             r->op->springs ? v->bonds.function : v->split.function,
                             err));
    PH_TRY(ph_i_visco_macro_rows(v, err));
out:
    return st;
}

/* The cracks as they are, before the operator is made. */
static ph_status cut_cracks(ph_run *r, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_problem *p = r->problem;
    if (!r->broken) return PH_OK;
    PH_CHECK_KEY(!p->sequence || p->sequence->kind == PH_SEQUENCE_NONE, PH_EINVAL,
                 "sequence",
                 "a cell that relaxes has its cracks from the beginning: leave out the "
                 "sequence");
    if (p->cracks && !p->loading) /* a failure begins with the whole cell */
        PH_TRY(ph_i_run_cut(r, p->cracks, ph_i_run_whole_collar(r), true, err));
    ph_i_broken_seen(r->broken);
out:
    return st;
}

ph_status ph_i_visco_choose(ph_visco *v, const ph_problem *problem, const ph_ctx *ctx,
                            ph_error *err)
{
    ph_status st = PH_OK;
    *v = (ph_visco){.run = {.problem = problem, .ctx = ctx}};
    PH_TRY(ph_i_run_begin(&v->run, err));
    PH_TRY(look_ahead(v, err));
    if (v->run.constraint->analytic) {
        PH_TRY(ph_i_run_check_analytic(&v->run, err));
        return PH_OK;
    }
    PH_TRY(ph_i_run_prepare(&v->run, err));
    PH_TRY(cut_cracks(&v->run, err));
out:
    return st;
}

ph_status ph_i_visco_begin(ph_visco *v, const ph_problem *problem,
                           const ph_relaxation_params *params, const ph_ctx *ctx,
                           ph_viscoelastic *out, ph_error *err)
{
    ph_status st = PH_OK;
    bool done;
    PH_TRY(ph_i_visco_choose(v, problem, ctx, err));
    const ph_microstructure *micro = v->run.problem->micro;
    v->out = out;
    v->tolerance = params->tolerance > 0.0 ? params->tolerance : 1e-4;
    PH_TRY(ph_i_split_new(micro->nmaterials, micro->materials, &v->split, err));
    PH_TRY(without_equations(v, &done, err));
    if (!done) PH_TRY(with_equations(v, err));
out:
    return st;
}

void ph_i_visco_clear(ph_visco *v)
{
    ph_meter *m = &v->run.meter;
    if (v->run.op) {
        size_t n = ph_i_visco_size(v), x = ph_i_visco_hidden(v);
        size_t e = (size_t)(v->sites.records * v->run.map->ns) * (size_t)v->layers.count;
        for (int i = 0; i < v->nbasis; i++) {
            ph_i_doubles_free(m, &v->basis[i].u, n);
            ph_i_doubles_free(m, &v->basis[i].x, x);
        }
        for (int a = 0; a < 6; a++) {
            ph_i_doubles_free(m, &v->r[a], n);
            ph_i_doubles_free(m, &v->d[a], n);
        }
        ph_i_doubles_free(m, &v->u, n);
        ph_i_doubles_free(m, &v->f, n);
        ph_i_doubles_free(m, &v->strain, e);
        ph_i_doubles_free(m, &v->x, x);
        ph_i_doubles_free(m, &v->y, x);
        ph_i_sites_clear(&v->sites);
    }
    free(v->basis);
    ph_i_reduced_clear(&v->model);
    ph_i_layers_clear(&v->layers);
    ph_i_split_clear(&v->split);
    ph_i_bond_functions_clear(&v->bonds);
    free(v->shape);
    free(v->whole);
    free(v->phase);
    free(v->space);
    ph_i_run_clear(&v->run);
    ph_result_free(&v->run.result);
}

/* The first solution goes as far as the error of the series asks and no elastic check is made
 * of it. */
static void say_unchecked(ph_result *r)
{
    for (int a = 0; a < r->nloads; a++)
        r->residual[a] = (double)NAN;
    r->hill_mandel = r->strain_average = (double)NAN;
    r->asymmetry = r->stabilisation_energy = (double)NAN;
    r->unchecked = "route reduced checks the error of the series instead";
}

void ph_i_visco_end(ph_visco *v, double start)
{
    ph_viscoelastic *out = v->out;
    if (!out || !v->run.result) return; /* the problem was not admissible */
    ph_i_run_account(&v->run, start, ph_i_run_now() - start);
    out->functions = v->model.nfunctions;
    out->basis = v->nbasis;
    if (v->run.op) {
        size_t field = ph_i_visco_size(v) + ph_i_visco_hidden(v);
        out->basis_bytes = (size_t)v->nbasis * field * sizeof(double);
        out->applications += v->run.op->applications;
    }
    out->seconds = ph_i_run_now() - start;
    out->elastic = v->run.result;
    v->run.result = NULL;
    if (!out->elastic || !out->series) return;
    out->elastic->stiffness = out->instantaneous;
    out->elastic->loads = ph_i_run_all_loads(out->elastic);
    out->elastic->converged = true;
    if (v->run.op)
        say_unchecked(out->elastic);
    else
        out->elastic->route = out->elastic->solver = "analytic";
}
