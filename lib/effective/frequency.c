/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effective/frequency.h"

#include "core/complex.h"
#include "effective/relaxing_bonds.h"
#include "solve/cocg.h"

#include <math.h>
#include <string.h>

enum { DEFAULT_ITERATIONS = 2000 };
/* As in loads.c: forces that are round-off of the stresses behind them. */
static const double no_force = 1e-13;

typedef double complex cplx;

typedef struct sweep {
    ph_run *run;
    ph_relaxing_map *relax;
    ph_complex_map *map;
    ph_relaxing_bonds
        *bonds;     /* of model bond, or NULL: its own springs store, slot 0 loses */
    double *weight; /* of the times of the bonds */
    void *state;    /* of fft_cg */
    ph_linear real; /* its system */
    double *own[4]; /* its vectors: the real parts */
    double *im[4];  /* imaginary parts of x, r, p, q */
    double *t;
    double *u[2]; /* displacement, real and imaginary */
    size_t size, unknowns;
    double tolerance;
} sweep;

static void clear(sweep *s)
{
    ph_meter *m = &s->run->meter;
    for (int i = 0; i < 4; i++)
        ph_i_doubles_free(m, &s->im[i], s->size);
    ph_i_doubles_free(m, &s->t, s->size);
    for (int i = 0; i < 2; i++)
        ph_i_doubles_free(m, &s->u[i], s->unknowns);
    ph_i_fft_cg_free(&s->state);
    ph_i_relaxing_bonds_free(&s->bonds);
    free(s->weight);
    ph_i_operator_stabilise(s->run->op, 1.0);
    ph_i_complex_map_free(&s->map);
    ph_i_relaxing_map_free(&s->relax);
}

static ph_status new_sweep(sweep *s, ph_error *err)
{
    ph_status st = PH_OK;
    ph_run *r = s->run;
    ph_meter *m = &r->meter;
    const char *no = ph_i_fft_cg_refuses(&r->system);
    PH_CHECK(!no, PH_EINVAL, "frequency cannot take this case: %s", no);
    PH_TRY(ph_i_run_in_double(r, "frequency", err));
    if (r->state) r->solver->free(&r->state);
    PH_TRY(ph_i_relaxing_map_new(r->map, r->problem->micro, r->soft, m, &s->relax, err));
    PH_TRY(ph_i_complex_map_new(s->relax, &s->map, err));
    if (r->op->springs) {
        PH_TRY(ph_i_relaxing_bonds_new(r->op, r->classes, r->problem->micro, 1, &s->bonds,
                                       err));
        PH_ALLOC(s->weight, s->bonds->ntimes, "weights of the branches");
    }
    s->unknowns = (size_t)(r->op->layout.nd * r->op->layout.cells);
    for (int i = 0; i < 2; i++)
        PH_DOUBLES(s->u[i], m, s->unknowns, "a complex displacement");
out:
    return st;
}

static ph_status set_bonds(sweep *s, double omega, ph_error *err)
{
    ph_status st = PH_OK;
    ph_relaxing_bonds *b = s->bonds;
    for (int loss = 0; loss < 2; loss++) {
        for (int k = 0; k < b->ntimes; k++)
            s->weight[k] = loss ? ph_i_loss_weight(omega * b->time[k])
                                : ph_i_storage_weight(omega * b->time[k]);
        PH_TRY(ph_i_relaxing_bonds_make(b, loss - 1, loss ? 0.0 : 1.0, s->weight, err));
    }
out:
    return st;
}

/* Tensors of a frequency, and a preconditioner of their size. */
static ph_status set_frequency(sweep *s, double omega, ph_error *err)
{
    ph_status st = PH_OK;
    ph_run *r = s->run;
    PH_TRY(ph_i_complex_map_set(s->map, omega, true, err));
    if (s->bonds) PH_TRY(set_bonds(s, omega, err));
    ph_i_fft_cg_free(&s->state);
    if (!s->bonds) ph_i_operator_stabilise(r->op, s->map->stabilise[0]);
    PH_TRY(ph_i_fft_cg_init(&r->system, &s->state, err));
    ph_i_fft_cg_parts(s->state, &s->real, s->own);
    s->size = ph_i_space_size(s->real.space);
    for (int i = 0; i < 4; i++)
        if (!s->im[i]) PH_DOUBLES(s->im[i], &r->meter, s->size, "an imaginary part");
    if (!s->t) PH_DOUBLES(s->t, &r->meter, s->size, "a product");
    PH_TRY(ph_i_complex_map_set(s->map, omega, false, err));
out:
    return st;
}

static void show(sweep *s, bool loss)
{
    ph_i_complex_map_show(s->map, loss);
    if (s->bonds)
        ph_i_relaxing_bonds_show(s->bonds, loss ? 0 : -1);
    else
        ph_i_operator_stabilise(s->run->op, s->map->stabilise[loss]);
}

static void apply(void *self, bool loss, const double *p, double *q)
{
    sweep *s = self;
    show(s, loss);
    s->real.apply(s->real.self, p, q);
}

static void precondition(void *self, const double *r, double *z)
{
    sweep *s = self;
    s->real.precondition(s->real.self, r, z);
}

static double norm(const sweep *s, const double *f)
{
    const uint8_t *held = s->run->setting.fixed;
    ptrdiff_t cells = s->run->op->layout.cells;
    double sum = 0.0;
    for (size_t x = 0; x < s->unknowns; x++)
        if (!held || !held[(ptrdiff_t)x % cells]) sum += f[x] * f[x];
    return sqrt(sum);
}

/* A load of one unit, in r: true if it is more than round-off. */
static bool set_load(sweep *s, int load, bool by_stress)
{
    ph_run *r = s->run;
    double unit[6] = {0}, size = 0.0, stiff = by_stress ? 1.0 : 0.0, least = INFINITY;
    unit[load] = 1.0;
    for (int part = 0; part < 2; part++) {
        double *vector = part ? s->im[1] : s->own[1];
        show(s, part == 1);
        if (!by_stress)
            ph_i_operator_load(r->op, unit, r->load);
        else if (part == 0)
            ph_i_operator_pull(r->op, unit, r->setting.region, r->load);
        else
            memset(r->load, 0, sizeof(double) * s->unknowns);
        size = hypot(size, norm(s, r->load));
        for (int i = 0; !by_stress && i < r->map->ns * r->map->ns * r->map->materials;
             i++)
            stiff = fmax(stiff, fabs(r->map->c[i]));
        ph_i_fft_cg_enter(s->state, r->load, vector);
    }
    for (int d = 0; d < 3; d++)
        if (r->setting.box.n[d] > 1) least = fmin(least, r->setting.box.h[d]);
    return size > no_force * stiff / least * sqrt((double)s->unknowns);
}

/* Means of stress and strain of the displacement, complex. */
static ph_status means(sweep *s, const double *macro, cplx *stress, cplx *strain,
                       ph_error *err)
{
    ph_status st = PH_OK;
    ph_run *r = s->run;
    const double n = (double)r->setting.averaged;
    for (int i = 0; i < 6; i++)
        stress[i] = strain[i] = 0.0;
    for (int part = 0; part < 4; part++) {
        bool loss = part >= 2, imaginary = part % 2;
        double a[6], e[6];
        ph_cell_energy w;
        show(s, loss);
        PH_TRY(ph_i_operator_sums(r->op, s->u[imaginary], imaginary ? NULL : macro,
                                  r->setting.region, a, e, &w, err));
        const int turns = loss + imaginary; /* i for each */
        const cplx factor = ph_i_complex(turns == 0   ? 1.0 / n
                                         : turns == 2 ? -1.0 / n
                                                      : 0.0,
                                         turns == 1 ? 1.0 / n : 0.0);
        for (int i = 0; i < r->map->ns; i++) {
            stress[i] += factor * a[i];
            if (!loss) strain[i] += factor * e[i];
        }
    }
out:
    return st;
}

static ph_status solve_load(sweep *s, int load, ph_complex_modulus *out, cplx C[6][6],
                            ph_error *err)
{
    ph_status st = PH_OK;
    ph_run *r = s->run;
    const ph_solver_params *sp = &r->problem->solver;
    bool by_stress = ph_i_run_by_stress(r, load);
    double unit[6] = {0};
    cplx stress[6], strain[6];
    ph_cg_report rep = {.tolerance = s->tolerance,
                        .max_iterations = sp->max_iterations > 0 ? sp->max_iterations
                                                                 : DEFAULT_ITERATIONS,
                        .ctx = r->ctx,
                        .load = load + 1,
                        .loads = r->map->ns};
    unit[load] = 1.0;
    if (set_load(s, load, by_stress)) {
        ph_complex_linear system = {s->real.space, s, apply, precondition};
        ph_complex_vector v[4];
        for (int i = 0; i < 4; i++)
            v[i] = (ph_complex_vector){s->own[i], s->im[i]};
        PH_TRY(ph_i_cocg(&system, v[0], v[1], v[2], v[3], s->t, &rep, err));
        r->work.loads++;
        r->work.iterations += rep.iterations;
        ph_i_fft_cg_leave(s->state, s->own[0], s->t, s->u[0]);
        ph_i_fft_cg_leave(s->state, s->im[0], s->t, s->u[1]);
    } else {
        for (int part = 0; part < 2; part++)
            memset(s->u[part], 0, sizeof(double) * s->unknowns);
    }
    out->iterations += rep.iterations;
    out->residual = fmax(out->residual, rep.residual);
    PH_TRY(means(s, by_stress ? NULL : unit, stress, strain, err));
    for (int i = 0; i < r->map->ns; i++)
        C[i][load] = ph_i_run_by_stress(r, i) ? strain[i] : stress[i];
out:
    return st;
}

/* Columns of mixed loads -> stiffness: exchange load and response of a component. */
static bool exchange(int n, cplx C[6][6], int k)
{
    cplx pivot = C[k][k];
    if (!(cabs(pivot) > 0.0)) return false;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            if (i != k && j != k) C[i][j] -= C[i][k] * C[k][j] / pivot;
    for (int i = 0; i < n; i++)
        if (i != k) {
            C[i][k] /= pivot;
            C[k][i] /= -pivot;
        }
    C[k][k] = 1.0 / pivot;
    return true;
}

static void symmetrise(int n, cplx C[6][6], ph_complex_modulus *out)
{
    double off = 0.0, size = 0.0;
    out->storage.n = out->loss.n = n;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            cplx c = 0.5 * (C[i][j] + C[j][i]);
            out->storage.m[i][j] = creal(c);
            out->loss.m[i][j] = cimag(c);
            off += pow(cabs(C[i][j] - C[j][i]), 2);
            size += pow(cabs(c), 2);
        }
    out->asymmetry = size > 0.0 ? sqrt(off / size) : 0.0;
}

static ph_status one_frequency(sweep *s, ph_complex_modulus *out, ph_error *err)
{
    ph_status st = PH_OK;
    cplx C[6][6] = {{0}};
    const int ns = s->run->map->ns;
    long before = s->run->op->applications;
    PH_TRY(set_frequency(s, out->omega, err));
    for (int a = 0; a < ns; a++)
        PH_TRY(solve_load(s, a, out, C, err));
    for (int a = 0; a < ns; a++)
        if (ph_i_run_by_stress(s->run, a))
            PH_CHECK(exchange(ns, C, a), PH_ESINGULAR,
                     "the medium yields to a stress along %d without end", a + 1);
    symmetrise(ns, C, out);
    out->applications = s->run->op->applications - before;
out:
    return st;
}

/* Norm of the stiffest phase at this frequency. */
static double stiffest(const ph_microstructure *micro, double omega)
{
    double most = 0.0;
    for (int p = 0; p < micro->nmaterials; p++) {
        const ph_material *m = &micro->materials[p];
        ph_sym4 re = m->stiffness, im = {.n = 6};
        if (m->is_void) continue;
        if (m->relaxation) ph_prony_complex(m->relaxation, omega, &re, &im);
        most = fmax(most, hypot(ph_sym4_norm(&re), ph_sym4_norm(&im)));
    }
    return most;
}

/* A mean stress may be off by the residual times the stiffest phase (a thousandth of that is
 * usual): a composite softer than that is noise. */
static ph_status check_noise(const sweep *s, const ph_complex_modulus *c, ph_error *err)
{
    ph_status st = PH_OK;
    double size = hypot(ph_sym4_norm(&c->storage), ph_sym4_norm(&c->loss));
    double noise = c->residual * stiffest(s->run->problem->micro, c->omega);
    PH_CHECK(noise <= size, PH_ENOCONV,
             "the effective modulus, %.2g, is below what the residual may leave of the "
             "stress averages, %.2g: ask for a lower solver.tolerance, or take route "
             "reduced",
             size, noise);
out:
    return st;
}

ph_status ph_i_frequency(ph_run *run, double tolerance, int n, const double *omega,
                         ph_complex_modulus *out, ph_error *err)
{
    ph_status st = PH_OK;
    sweep s = {.run = run, .tolerance = tolerance};
    PH_TRY(new_sweep(&s, err));
    for (int k = 0; k < n; k++) {
        PH_CHECK(isfinite(omega[k]) && omega[k] > 0.0, PH_EINVAL,
                 "an angular frequency must be > 0, got %g", omega[k]);
        out[k] = (ph_complex_modulus){.omega = omega[k]};
        st = one_frequency(&s, &out[k], err);
        if (st == PH_OK) st = check_noise(&s, &out[k], err);
        if (st != PH_OK) {
            ph_error_prefix(err, "frequency %g: ", omega[k]);
            goto out;
        }
    }
out:
    clear(&s);
    return st;
}
