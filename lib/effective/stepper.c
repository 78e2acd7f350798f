/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effective/stepper.h"

#include <math.h>
#include <string.h>

enum { DEFAULT_ITERATIONS = 2000 };
/* Forces below this share of what the stresses could make are round-off. */
static const double no_force = 1e-13;

double ph_i_step_decay(double x)
{
    return exp(-x);
}

double ph_i_step_ramp(double x)
{
    return x == 0.0 ? 1.0 : -expm1(-x) / x;
}

/* ---- making ----------------------------------------------------------------------------- */

static ptrdiff_t jumps(const ph_stepper *s)
{
    return s->cuts ? s->cuts->size : 0;
}

static ph_status new_block(ph_stepper *s, ph_error *err)
{
    ph_status st = PH_OK;
    ptrdiff_t nt = s->ntimes, n = s->unknowns, nj = jumps(s);
    s->size = (size_t)(2 + 18 + 6 * nt + n + nt * n + n + nj + nt * nj);
    PH_DOUBLES(s->block, &s->run->meter, s->size, "what the medium remembers");
    s->run->work.history_variables = (size_t)(nt * (6 + n + nj));
    double *next = s->block;
    s->time = next, next += 1;
    s->last_dt = next, next += 1;
    s->macro = next, next += 6;
    s->macro_memory = next, next += 6 * nt;
    s->last_macro = next, next += 6;
    s->traction = next, next += 6;
    s->u = next, next += n;
    s->memory = next, next += nt * n;
    s->last = next, next += n;
    s->jump = next, next += nj;
    s->jump_memory = next;
out:
    return st;
}

/* Every part of the moduli a set of springs: what a part has does not change with dt. */
static ph_status use_bonds(ph_stepper *s, ph_error *err)
{
    ph_status st = PH_OK;
    double *weight = NULL;
    ph_run *r = s->run;
    PH_TRY(ph_i_relaxing_bonds_new(r->op, r->classes, r->problem->micro, -1, &s->bonds,
                                   err));
    s->ntimes = s->bonds->ntimes;
    s->tau = s->bonds->time;
    PH_ALLOC(weight, s->ntimes, "weights of the parts");
    for (int m = 0; m <= s->ntimes; m++) {
        if (m > 0) weight[m - 1] = 0.0;
        if (m < s->ntimes) weight[m] = 1.0;
        PH_TRY(ph_i_relaxing_bonds_make(s->bonds, m, m < s->ntimes ? 0.0 : 1.0, weight,
                                        err));
    }
out:
    free(weight);
    return st;
}

ph_status ph_i_stepper_new(ph_run *run, double tolerance, ph_stepper **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_stepper *s = NULL;
    ph_meter *m = &run->meter;
    *out = NULL;
    PH_ALLOC(s, 1, "the stepper");
    s->run = run;
    s->tolerance = tolerance;
    s->ns = run->map->ns;
    s->unknowns = run->op->layout.nd * run->op->layout.cells;
    s->tangent_dt = (double)NAN;
    PH_TRY(ph_i_relaxing_map_new(run->map, run->problem->micro, run->soft, m, &s->relax,
                                 err));
    s->ntimes = s->relax->ntimes;
    s->tau = s->relax->time;
    PH_ALLOC(s->map_weight, s->relax->ntimes, "weights of a step");
    if (run->op->springs) PH_TRY(use_bonds(s, err));
    PH_TRY(
        ph_i_cut_points_new(&run->setting.box, &run->params, s->relax, m, &s->cuts, err));
    PH_TRY(new_block(s, err));
    PH_ALLOC(s->decay, s->ntimes, "weights of a step");
    PH_ALLOC(s->ramp, s->ntimes, "weights of a step");
    PH_ALLOC(s->weight, s->ntimes, "weights of a step");
    PH_ALLOC(s->part, 6 * (s->ntimes + 1), "stresses of the branches");
    PH_ALLOC(s->held, s->ntimes + 1, "energies of the branches");
    PH_DOUBLES(s->du, m, (size_t)s->unknowns, "an increment");
    PH_DOUBLES(s->residual, m, (size_t)s->unknowns, "the forces of the past");
    PH_DOUBLES(s->work, m, (size_t)s->unknowns, "a force field");
    PH_TRY(ph_i_operator_in_space(run->op, err));
    *out = s;
    s = NULL;
out:
    ph_i_stepper_free(&s);
    return st;
}

void ph_i_stepper_free(ph_stepper **stepper)
{
    if (!stepper || !*stepper) return;
    ph_stepper *s = *stepper;
    ph_meter *m = &s->run->meter;
    ph_i_doubles_free(m, &s->block, s->size);
    ph_i_doubles_free(m, &s->du, (size_t)s->unknowns);
    ph_i_doubles_free(m, &s->residual, (size_t)s->unknowns);
    ph_i_doubles_free(m, &s->work, (size_t)s->unknowns);
    ph_i_cut_points_free(&s->cuts);
    ph_i_relaxing_bonds_free(&s->bonds);
    ph_i_relaxing_map_free(&s->relax);
    free(s->decay);
    free(s->ramp);
    free(s->weight);
    free(s->map_weight);
    free(s->part);
    free(s->held);
    free(s);
    *stepper = NULL;
}

void ph_i_stepper_reset(ph_stepper *s)
{
    memset(s->block, 0, s->size * sizeof(double));
    s->measured = false;
}

void ph_i_stepper_corner(ph_stepper *s)
{
    *s->last_dt = 0.0;
}

void ph_i_stepper_restore(ph_stepper *s, const double *block)
{
    memcpy(s->block, block, s->size * sizeof(double));
    s->measured = false;
}

/* ---- the parts: C_inf with the total strain, C_m with what branch m remembers ------------ */

static double *memory(const ph_stepper *s, int m)
{
    return s->memory + m * s->unknowns;
}

static ph_cut_state cut_state(const ph_stepper *s)
{
    return (ph_cut_state){s->u,    s->macro,      s->memory, s->macro_memory,
                          s->jump, s->jump_memory};
}

/* With its share of (S). */
void ph_i_stepper_show(ph_stepper *s, int m)
{
    if (s->bonds) {
        ph_i_relaxing_bonds_show(s->bonds, m);
        return;
    }
    memset(s->weight, 0, sizeof(double) * (size_t)s->ntimes);
    if (m < s->ntimes) s->weight[m] = 1.0;
    ph_i_relaxing_map_whole(s->relax, m < s->ntimes ? 0.0 : 1.0, s->weight);
    ph_i_operator_stabilise(s->run->op,
                            m < s->ntimes ? s->relax->give[m] : s->relax->hold);
}

void ph_i_stepper_show_tangent(ph_stepper *s)
{
    ph_i_relaxing_map_again(s->relax);
    if (s->bonds)
        ph_i_relaxing_bonds_show(s->bonds, -1);
    else
        ph_i_operator_stabilise(s->run->op,
                                ph_i_relaxing_stabilisation(s->relax, 1.0, s->ramp));
}

static double norm(const ph_stepper *s, const double *f)
{
    const uint8_t *held = s->run->setting.fixed; /* their forces are reactions */
    ptrdiff_t cells = s->run->op->layout.cells;
    double sum = 0.0;
    for (ptrdiff_t x = 0; x < s->unknowns; x++)
        if (!held || !held[x % cells]) sum += f[x] * f[x];
    return sqrt(sum);
}

static bool is_zero(const double *x, ptrdiff_t n)
{
    for (ptrdiff_t i = 0; i < n; i++)
        if (x[i] != 0.0) return false;
    return true;
}

/* residual -= weight B^T C (B u + macro) of the tensors that are shown. */
static void subtract(ph_stepper *s, const double *u, const double *macro, double weight)
{
    ph_operator *op = s->run->op;
    double size = 0.0;
    if (weight == 0.0) return;
    if (!is_zero(u, s->unknowns)) {
        ph_i_operator_apply(op, u, s->work);
        for (ptrdiff_t x = 0; x < s->unknowns; x++)
            s->residual[x] -= weight * s->work[x];
        size += norm(s, s->work);
    }
    if (!is_zero(macro, s->ns)) {
        ph_i_operator_load(op, macro, s->work);
        for (ptrdiff_t x = 0; x < s->unknowns; x++)
            s->residual[x] += weight * s->work[x];
        size += norm(s, s->work);
    }
    s->reference += weight * size;
}

/* Mean stresses and energies of every part of the state. */
static ph_status measure(ph_stepper *s, ph_error *err)
{
    ph_status st = PH_OK;
    const double n = (double)s->run->setting.averaged;
    const uint8_t *region = s->run->setting.region;
    s->part_energy = s->part_dissipation = 0.0;
    memset(s->cut_stress, 0, sizeof s->cut_stress);
    for (int m = 0; m <= s->ntimes; m++) {
        bool total = m == s->ntimes;
        ph_cell_energy e;
        double *part = s->part + 6 * m, strain[6];
        ph_i_stepper_show(s, m);
        PH_TRY(ph_i_operator_sums(s->run->op, total ? s->u : memory(s, m),
                                  total ? s->macro : s->macro_memory + 6 * m, region,
                                  part, strain, &e, err));
        for (int i = 0; i < s->ns; i++)
            part[i] /= n;
        s->held[m] = e.mean + e.modes + e.stabilisation;
        s->part_energy += s->held[m];
        if (!total) s->part_dissipation += s->held[m] / s->tau[m];
        for (int i = 0; total && i < s->ns; i++)
            s->mean_strain[i] = strain[i] / n;
    }
    if (s->cuts) {
        ph_cut_state state = cut_state(s);
        ph_i_cut_points_sums(s->cuts, &state, region, s->cut_stress, &s->part_energy,
                             &s->part_dissipation);
    }
    for (int i = 0; i < s->ns; i++)
        s->cut_stress[i] /= n;
    s->part_energy /= 2.0 * n;
    s->part_dissipation /= n;
    s->measured = true;
out:
    ph_i_stepper_show_tangent(s);
    return st;
}

ph_status ph_i_stepper_state(ph_stepper *s, ph_step_state *out, ph_error *err)
{
    ph_status st = PH_OK;
    if (!s->measured) PH_TRY(measure(s, err));
    memset(out, 0, sizeof *out);
    for (int i = 0; i < s->ns; i++) {
        out->strain[i] = s->mean_strain[i];
        out->stress[i] = s->cut_stress[i];
        for (int m = 0; m <= s->ntimes; m++)
            out->stress[i] += s->part[6 * m + i];
    }
    out->energy = s->part_energy;
    out->dissipation = s->part_dissipation;
out:
    return st;
}

/* ---- a step ------------------------------------------------------------------------------ */

/* Tensors of a step of dt in the map, and a solver that knows them. */
static ph_status set_tangent(ph_stepper *s, double dt, ph_error *err)
{
    ph_status st = PH_OK;
    ph_run *r = s->run;
    for (int m = 0; m < s->ntimes; m++) {
        s->decay[m] = ph_i_step_decay(dt / s->tau[m]);
        s->ramp[m] = ph_i_step_ramp(dt / s->tau[m]);
    }
    s->dt = dt;
    if (dt == s->tangent_dt) return PH_OK;
    s->tangent_dt = (double)NAN;
    for (int m = 0; m < s->relax->ntimes; m++)
        s->map_weight[m] = ph_i_step_ramp(dt / s->relax->time[m]);
    PH_TRY(ph_i_relaxing_map_mixed(s->relax, 1.0, s->map_weight, err));
    if (s->bonds)
        PH_TRY(ph_i_relaxing_bonds_make(s->bonds, -1, 1.0, s->ramp, err));
    else
        r->map->softest =
            r->softness * ph_i_relaxing_stabilisation(s->relax, 1.0, s->ramp);
    ph_i_stepper_show_tangent(s);
    if (r->state) r->solver->free(&r->state);
    PH_TRY(r->solver->init(&r->system, &r->state, err));
    s->tangent_dt = dt;
out:
    return st;
}

ph_status ph_i_stepper_instantaneous(ph_stepper *s, ph_error *err)
{
    return set_tangent(s, 0.0, err);
}

ph_status ph_i_stepper_broken(ph_stepper *s, ph_error *err)
{
    ph_status st = PH_OK;
    ph_run *r = s->run;
    s->measured = false;
    if (r->op->bonds) { /* whose lists are made once */
        s->tangent_dt = (double)NAN;
        PH_TRY(ph_i_run_rebuild(r, err));
        PH_TRY(ph_i_operator_in_space(r->op, err));
        return PH_OK;
    }
    PH_TRY(ph_i_operator_update(r->op, err));
    bool done = !r->solver->keeps_matrix;
    if (!done && r->solver->broke &&
        s->tangent_dt == 0.0) /* that of the jump that follows */
        PH_TRY(r->solver->broke(r->state, &done, err));
    ph_i_broken_seen(r->broken);
    if (!done) s->tangent_dt = (double)NAN;
out:
    return st;
}

static double largest_tangent(const ph_stepper *s)
{
    double top = 0.0;
    for (int p = 0; p < s->relax->materials; p++)
        for (int i = 0; i < s->ns; i++)
            top = fmax(top, fabs(s->relax->phase[p].m[i][i]));
    return top;
}

/* Forces that are round-off of stresses in a macro strain, or of a macro stress. */
static double floor_of_forces(const ph_stepper *s, const double *strain,
                              const double *stress)
{
    double size = 0.0, stiff = largest_tangent(s), least = INFINITY;
    const ph_grid *box = &s->run->setting.box;
    for (int i = 0; i < s->ns; i++) {
        size += stiff * fabs(strain[i]) + fabs(stress[i]);
    }
    for (int d = 0; d < 3; d++)
        if (box->n[d] > 1) least = fmin(least, box->h[d]);
    return isinf(least) ? 0.0 : no_force * size / least * sqrt((double)s->unknowns);
}

/* The increment of the step before, as far as this one is long: if it helps. */
static void guess(ph_stepper *s)
{
    if (*s->last_dt <= 0.0 || s->dt <= 0.0) return;
    double ratio = s->dt / *s->last_dt, before = norm(s, s->residual), after;
    ph_i_operator_apply(s->run->op, s->last, s->work);
    for (ptrdiff_t x = 0; x < s->unknowns; x++)
        s->residual[x] -= ratio * s->work[x];
    after = norm(s, s->residual);
    if (after < before) {
        for (ptrdiff_t x = 0; x < s->unknowns; x++)
            s->du[x] = ratio * s->last[x];
        return;
    }
    for (ptrdiff_t x = 0; x < s->unknowns; x++)
        s->residual[x] += ratio * s->work[x];
}

/* residual += B^T of a macro stress. */
static void pull(ph_stepper *s, const double *traction)
{
    if (is_zero(traction, s->ns)) return;
    ph_i_operator_pull(s->run->op, traction, s->run->setting.region, s->work);
    for (ptrdiff_t x = 0; x < s->unknowns; x++)
        s->residual[x] += s->work[x];
    s->reference += norm(s, s->work);
}

ph_status ph_i_stepper_begin(ph_stepper *s, double dt, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(isfinite(dt) && dt >= 0.0, PH_EINVAL, "a time step must be >= 0, got %g",
             dt);
    if (!s->measured) PH_TRY(measure(s, err));
    PH_TRY(set_tangent(s, dt, err));
    memset(s->du, 0, sizeof(double) * (size_t)s->unknowns);
    memset(s->residual, 0, sizeof(double) * (size_t)s->unknowns);
    memcpy(s->strain, s->mean_strain, sizeof s->strain);
    memset(s->dmacro, 0, sizeof s->dmacro);
    memset(s->dtraction, 0, sizeof s->dtraction);
    s->reference = 0.0;
    s->pending = false;
    for (int i = 0; i < s->ns; i++) {
        s->history[i] = s->part[6 * s->ntimes + i];
        for (int m = 0; m < s->ntimes; m++)
            s->history[i] += s->decay[m] * s->part[6 * m + i];
    }
    ph_i_stepper_show(s, s->ntimes);
    subtract(s, s->u, s->macro, 1.0);
    for (int m = 0; m < s->ntimes; m++) {
        ph_i_stepper_show(s, m);
        subtract(s, memory(s, m), s->macro_memory + 6 * m, s->decay[m]);
    }
    if (s->cuts) {
        ph_cut_state state = cut_state(s);
        double sum[6] = {0};
        PH_TRY(ph_i_cut_points_load(s->cuts, &state, s->relax->phase, s->decay,
                                    s->run->setting.region, s->residual, sum, err));
        for (int i = 0; i < s->ns; i++)
            s->history[i] += sum[i] / (double)s->run->setting.averaged;
    }
    ph_i_stepper_show_tangent(s);
    if (s->run->constraint->by_stress) pull(s, s->traction);
    guess(s);
out:
    ph_i_stepper_show_tangent(s);
    return st;
}

/* K du = residual to what the tolerance asks for. */
static ph_status correct(ph_stepper *s, ph_error *err)
{
    ph_status st = PH_OK;
    ph_run *r = s->run;
    double strain[6], stress[6];
    for (int i = 0; i < s->ns; i++) {
        strain[i] = fabs(s->macro[i]) + fabs(s->dmacro[i]);
        stress[i] = fabs(s->traction[i]) + fabs(s->dtraction[i]);
    }
    double goal = fmax(s->tolerance * s->reference, floor_of_forces(s, strain, stress));
    double size = norm(s, s->residual);
    if (size <= goal) return PH_OK;
    ph_cg_report report = {.tolerance = goal / size,
                           .max_iterations = r->problem->solver.max_iterations > 0
                                                 ? r->problem->solver.max_iterations
                                                 : DEFAULT_ITERATIONS,
                           .ctx = r->ctx,
                           .load = 1,
                           .loads = 1};
    PH_TRY(ph_i_run_iterate(r, s->residual, s->work, &report, err));
    s->solves++;
    s->iterations += report.iterations;
    for (ptrdiff_t x = 0; x < s->unknowns; x++)
        s->du[x] += s->work[x];
    s->pending = true;
out:
    return st;
}

/* The residual after a correction, for those who correct again. */
static void settle(ph_stepper *s)
{
    ph_operator *op = s->run->op;
    if (!s->pending) return;
    ph_i_operator_apply(op, s->work, op->f);
    for (ptrdiff_t x = 0; x < s->unknowns; x++)
        s->residual[x] -= op->f[x];
    s->pending = false;
}

ph_status ph_i_stepper_solve(ph_stepper *s, const double *dload, ph_error *err)
{
    double dmacro[6] = {0}, dtraction[6] = {0};
    settle(s);
    for (int i = 0; i < s->ns; i++) {
        bool by_stress = ph_i_run_by_stress(s->run, i);
        *(by_stress ? &dtraction[i] : &dmacro[i]) = dload[i];
        s->dmacro[i] += dmacro[i];
        s->dtraction[i] += dtraction[i];
    }
    if (!is_zero(dmacro, s->ns)) {
        ph_i_operator_load(s->run->op, dmacro, s->work);
        for (ptrdiff_t x = 0; x < s->unknowns; x++)
            s->residual[x] += s->work[x];
        s->reference += norm(s, s->work);
    }
    pull(s, dtraction);
    return correct(s, err);
}

ph_status ph_i_stepper_response(ph_stepper *s, double *response, double *stress,
                                ph_error *err)
{
    ph_status st = PH_OK;
    double strain[6], n = (double)s->run->setting.averaged;
    ph_cell_energy e;
    PH_TRY(ph_i_operator_sums(s->run->op, s->du, s->dmacro, s->run->setting.region,
                              stress, strain, &e, err));
    for (int i = 0; i < s->ns; i++) {
        stress[i] = stress[i] / n + s->history[i];
        response[i] =
            ph_i_run_by_stress(s->run, i) ? strain[i] / n + s->strain[i] : stress[i];
    }
out:
    return st;
}

static void advance(ptrdiff_t n, double decay, double ramp, const double *d, double *q)
{
    for (ptrdiff_t x = 0; x < n; x++)
        q[x] = decay * q[x] + ramp * d[x];
}

ph_status ph_i_stepper_accept(ph_stepper *s, ph_error *err)
{
    ph_status st = PH_OK;
    if (s->cuts) {
        ph_cut_state state = cut_state(s);
        PH_TRY(ph_i_cut_points_advance(s->cuts, &state, s->relax->phase, s->decay,
                                       s->ramp, s->du, s->dmacro, err));
    }
    for (int m = 0; m < s->ntimes; m++) {
        advance(s->unknowns, s->decay[m], s->ramp[m], s->du, memory(s, m));
        advance(s->ns, s->decay[m], s->ramp[m], s->dmacro, s->macro_memory + 6 * m);
    }
    advance(s->unknowns, 1.0, 1.0, s->du, s->u);
    advance(s->ns, 1.0, 1.0, s->dmacro, s->macro);
    advance(s->ns, 1.0, 1.0, s->dtraction, s->traction);
    advance(s->ns, 0.0, 1.0, s->dmacro, s->last_macro);
    memcpy(s->last, s->du, sizeof(double) * (size_t)s->unknowns);
    *s->last_dt = s->dt;
    *s->time += s->dt;
    s->measured = false;
out:
    return st;
}

ph_status ph_i_stepper_take(ph_stepper *s, double dt, const double *du,
                            const double *dmacro, ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(set_tangent(s, dt, err));
    memcpy(s->du, du, sizeof(double) * (size_t)s->unknowns);
    memset(s->dmacro, 0, sizeof s->dmacro);
    memset(s->dtraction, 0, sizeof s->dtraction);
    memcpy(s->dmacro, dmacro, sizeof(double) * (size_t)s->ns);
    PH_TRY(ph_i_stepper_accept(s, err));
out:
    return st;
}

/* ---- what a step says -------------------------------------------------------------------- */

/* Bending of a strain over a step: q_m gets tau dt (1 - (1 - exp(-x)) (1/x + 1/2)) times its
 * second derivative more than the straight line gives, dt^3/(12 tau) for short steps. */
static double bending(double x)
{
    if (x < 1e-2) return x * x / 12.0 * (1.0 - 0.5 * x);
    return 1.0 + expm1(-x) * (1.0 / x + 0.5);
}

/* Weight of branch m that makes a stress of the bending of strains over the step. */
static double bending_weight(const ph_stepper *s, int m)
{
    return 2.0 * s->tau[m] / (s->dt + *s->last_dt) * bending(s->dt / s->tau[m]);
}

/* Stress sums [ns] and forces, in `residual`, of the bent strains of `work` and macro, by
 * the tensors that are shown; added. */
static ph_status add_bending(ph_stepper *s, const double *macro, double weight,
                             double *stress, ph_error *err)
{
    ph_status st = PH_OK;
    ph_operator *op = s->run->op;
    double part[6], strain[6];
    ph_cell_energy e;
    PH_TRY(ph_i_operator_sums(op, s->work, macro, s->run->setting.region, part, strain,
                              &e, err));
    for (int i = 0; i < s->ns; i++)
        stress[i] += weight * part[i];
    ph_i_operator_apply(op, s->work, op->f);
    for (ptrdiff_t x = 0; x < s->unknowns; x++)
        s->residual[x] -= weight * op->f[x];
    ph_i_operator_load(op, macro, op->f);
    for (ptrdiff_t x = 0; x < s->unknowns; x++)
        s->residual[x] += weight * op->f[x];
out:
    return st;
}

static ph_status bend(ph_stepper *s, const double *macro, double *stress, ph_error *err)
{
    ph_status st = PH_OK;
    memset(s->residual, 0, sizeof(double) * (size_t)s->unknowns);
    for (int m = 0; m < s->ntimes; m++)
        s->weight[m] = bending_weight(s, m);
    if (!s->bonds) {
        ph_i_relaxing_map_whole(s->relax, 0.0, s->weight);
        ph_i_relaxing_map_fill_cuts(s->relax);
        ph_i_operator_stabilise(s->run->op, 0.0);
        PH_TRY(add_bending(s, macro, 1.0, stress, err));
    }
    for (int m = 0; s->bonds && m < s->ntimes; m++) {
        ph_i_relaxing_bonds_show(s->bonds, m);
        PH_TRY(add_bending(s, macro, s->weight[m], stress, err));
    }
out:
    ph_i_relaxing_map_empty_cuts(s->relax);
    ph_i_stepper_show_tangent(s);
    return st;
}

/* What the medium makes of the forces of that stress, in `work`; a rough solve will do. */
static ph_status answer_bending(ph_stepper *s, ph_error *err)
{
    ph_status st = PH_OK;
    ph_run *r = s->run;
    ph_cg_report report = {
        .tolerance = 0.1, .max_iterations = 100, .ctx = r->ctx, .load = 1, .loads = 1};
    memset(s->work, 0, sizeof(double) * (size_t)s->unknowns);
    if (norm(s, s->residual) <= s->tolerance * s->reference) return PH_OK;
    st = ph_i_run_iterate(r, s->residual, s->work, &report, err);
    if (st == PH_ENOCONV && err) *err = (ph_error)PH_ERROR_INIT;
    if (st == PH_ENOCONV) st = PH_OK;
    s->iterations += report.iterations;
    s->solves++;
    return st;
}

ph_status ph_i_stepper_error(ph_stepper *s, unsigned bends, double *error, ph_error *err)
{
    ph_status st = PH_OK;
    ph_run *r = s->run;
    double stress[6] = {0}, more[6] = {0}, strain[6], macro[6] = {0}, sum = 0.0;
    const double zero[6] = {0}, before = *s->last_dt;
    ph_cell_energy e;
    *error = 0.0;
    if (before <= 0.0 || s->dt <= 0.0) return PH_OK;
    for (ptrdiff_t x = 0; x < s->unknowns; x++)
        s->work[x] = s->du[x] - s->dt / before * s->last[x];
    for (int i = 0; i < s->ns; i++)
        if (bends >> i & 1) macro[i] = s->dmacro[i] - s->dt / before * s->last_macro[i];
    PH_TRY(bend(s, macro, stress, err));
    if (!r->constraint->by_stress) { /* whose stress no error of the medium can change */
        PH_TRY(answer_bending(s, err));
        PH_TRY(ph_i_operator_sums(r->op, s->work, zero, r->setting.region, more, strain,
                                  &e, err));
    }
    for (int i = 0; i < s->ns; i++)
        sum += (stress[i] + more[i]) * (stress[i] + more[i]);
    *error = sqrt(sum) / (double)r->setting.averaged;
out:
    return st;
}

ph_status ph_i_stepper_tangent(ph_stepper *s, double dt, ph_sym4 *tangent,
                               double *const *field, ph_error *err)
{
    ph_status st = PH_OK;
    *tangent = (ph_sym4){.n = s->ns};
    PH_TRY(set_tangent(s, dt, err));
    for (int a = 0; a < s->ns; a++) {
        double unit[6] = {0}, stress[6], response[6];
        unit[a] = 1.0;
        memset(s->du, 0, sizeof(double) * (size_t)s->unknowns);
        memset(s->residual, 0, sizeof(double) * (size_t)s->unknowns);
        memset(s->dmacro, 0, sizeof s->dmacro);
        memset(s->dtraction, 0, sizeof s->dtraction);
        memset(s->history, 0, sizeof s->history);
        memset(s->strain, 0, sizeof s->strain);
        s->reference = 0.0;
        s->pending = false;
        PH_TRY(ph_i_stepper_solve(s, unit, err));
        PH_TRY(ph_i_stepper_response(s, response, stress, err));
        for (int i = 0; i < s->ns; i++)
            tangent->m[i][a] = response[i];
        if (field) memcpy(field[a], s->du, sizeof(double) * (size_t)s->unknowns);
    }
out:
    return st;
}
