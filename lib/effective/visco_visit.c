/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One value of s: the residual of the reduced solution, the correction that conjugate
 * gradients find for it, the error that follows, and the fields that the basis takes.
 *
 * The model holds 2 W(T) of its solution T = (e, u, layers) with C(s), and the cells may
 * lower that by what the layers hide and by r.A^-1.r, r = load - A u:
 *
 *   e.(C_model - C).e = [2 W(T) - 2 W(e, u)] + r.A^-1.r
 *
 * The correction captures d.r of the last term and the rule of Gauss-Radau bounds the rest. */
#include "core/dense.h"
#include "core/jacobi.h"
#include "effective/visco.h"

#include <math.h>
#include <string.h>

/* A load below this share of the forces that its stresses could make is round-off. */
static const double no_load = 1e-13;
/* A correction of less than this share of the tolerance, or than what may be left, is not
 * worth a field. */
static const double worth = 0.02;
/* Directions softer than this share of the stiffest are judged as if they had it. */
static const double softest_direction = 1e-6;
static const double default_tolerance = 1e-6;
enum { DEFAULT_ITERATIONS = 2000 };

typedef struct visit {
    double s, energy_share; /* of the tolerance that may be left */
    ph_sym4 C;              /* of the model, and with soft directions held up */
    ph_sym4 held, inverse;
    int old;                   /* fields before this visit */
    double *c;                 /* [ns][old] */
    double hidden[6], left[6]; /* energies per averaged cell */
    bool idle[6];              /* nothing to solve */
    ph_sym4 captured;
} visit;

static void release(ph_visco *v, double *f)
{
    const uint8_t *fixed = v->run.setting.fixed;
    ptrdiff_t cells = v->run.op->layout.cells;
    for (int a = 0; fixed && a < v->run.op->layout.nd; a++)
        for (ptrdiff_t x = 0; x < cells; x++)
            if (fixed[x]) f[a * cells + x] = 0.0;
}

/* u and uniform strain of the reduced solution of load a. */
static void reduced_field(ph_visco *v, const visit *now, int a, double *u, double *macro)
{
    size_t n = ph_i_visco_size(v);
    memset(u, 0, sizeof *u * n);
    memset(macro, 0, sizeof *macro * 6);
    macro[a] = 1.0;
    for (int i = 0; i < now->old; i++) {
        double c = now->c[a * now->old + i];
        const double *from = v->basis[i].u;
        if (c == 0.0) continue;
#pragma omp simd
        for (size_t k = 0; k < n; k++)
            u[k] += c * from[k];
        for (int b = 0; b < 6; b++)
            macro[b] += c * v->basis[i].macro[b];
    }
}

static double largest_load(const ph_visco *v)
{
    const ph_run *r = &v->run;
    double stiffest = 0.0, least = INFINITY;
    for (int i = 0; i < r->map->ns * r->map->ns * r->map->materials; i++)
        stiffest = fmax(stiffest, fabs(r->map->c[i]));
    for (int d = 0; d < 3; d++)
        if (r->setting.box.n[d] > 1) least = fmin(least, r->setting.box.h[d]);
    return stiffest / least * sqrt((double)ph_i_visco_size(v));
}

/* v->r[a] = load - A u; what the layers hide; the size of the load in `size`. */
static ph_status residual(ph_visco *v, visit *now, int a, double *size, ph_error *err)
{
    ph_status st = PH_OK;
    ph_run *r = &v->run;
    size_t n = ph_i_visco_size(v);
    double macro[6], *to = v->r[a], sigma[6] = {0};
    reduced_field(v, now, a, v->u, macro);
    ph_i_operator_load(r->op, macro, to);
    release(v, to);
    *size = sqrt(ph_i_inner((ptrdiff_t)n, to, to));
    ph_i_operator_apply(r->op, v->u, v->f);
    release(v, v->f);
    for (size_t i = 0; i < n; i++)
        to[i] -= v->f[i];
    v->out->applications++;
    if (v->layers.count > 0) {
        double stress[6], strain[6], energy;
        ph_cell_energy e;
        PH_TRY(ph_i_operator_sums(r->op, v->u, macro, r->setting.region, stress, strain,
                                  &e, err));
        v->out->applications++;
        energy = e.mean + e.modes + e.stabilisation;
        now->hidden[a] = fmax(0.0, now->C.m[a][a] - energy / (double)r->setting.averaged);
    }
    if (!r->constraint->by_stress) return PH_OK;
    for (int b = 0; b < r->map->ns; b++)
        if (ph_i_run_by_stress(r, b)) sigma[b] = now->C.m[b][a];
    ph_i_operator_pull(r->op, sigma, r->setting.region, v->f);
    *size = sqrt(ph_i_inner((ptrdiff_t)n, v->f, v->f));
    for (size_t i = 0; i < n; i++)
        to[i] += v->f[i];
out:
    return st;
}

/* v->d[a] = A^-1 r[a], until the energy left is little enough. */
static ph_status correct(ph_visco *v, visit *now, int a, double size, ph_error *err)
{
    ph_status st = PH_OK;
    ph_run *r = &v->run;
    size_t n = ph_i_visco_size(v);
    const ph_solver_params *sp = &r->problem->solver;
    double norm = sqrt(ph_i_inner((ptrdiff_t)n, v->r[a], v->r[a])),
           cells = (double)r->setting.averaged;
    double tolerance = sp->tolerance > 0.0 ? sp->tolerance : default_tolerance;
    double most = now->energy_share * v->tolerance / now->inverse.m[a][a] * cells;
    now->left[a] = 0.0;
    now->idle[a] = norm <= no_load * largest_load(v) ||
                   (!(v->least > 0.0) && norm <= tolerance * size);
    memset(v->d[a], 0, sizeof *v->d[a] * n);
    if (v->out->npoints == 0) r->result->nloads = a + 1; /* the instantaneous problem */
    if (now->idle[a]) return PH_OK;
    ph_cg_report report = {
        .tolerance = v->least > 0.0 ? no_load : fmin(0.5, tolerance * size / norm),
        .max_iterations =
            sp->max_iterations > 0 ? sp->max_iterations : DEFAULT_ITERATIONS,
        .ctx = r->ctx,
        .load = a + 1,
        .loads = r->map->ns,
        .least = v->least,
        .energy_most = most};
    memcpy(v->f, v->r[a], sizeof *v->f * n);
    st = ph_i_run_iterate(r, v->f, v->d[a], &report, err);
    v->out->iterations += report.iterations;
    if (v->out->npoints == 0) r->result->iterations[a] = report.iterations;
    now->left[a] = report.energy_left / cells;
    /* As far as arithmetic goes: of a contrast of 1e12 that may be above what was asked. */
    if (st == PH_ENOCONV && v->least > 0.0 &&
        report.residual * norm <= tolerance * size) {
        st = PH_OK;
        if (err) *err = (ph_error)PH_ERROR_INIT;
    }
    if (st != PH_OK) ph_error_prefix(err, "Carson variable %g: ", now->s);
    return st;
}

/* x.(C_model - C).x <= (|d x| + sum_a |x_a| left_a^(1/2))^2 + hidden part, in the metric of
 * the model's tensor. */
static double error_of(const ph_visco *v, const visit *now, bool corrected)
{
    double low, high, left = 0.0, hidden = 0.0;
    int ns = v->run.map->ns;
    ph_i_visco_relative(&now->captured, &now->held, &low, &high);
    for (int a = 0; a < ns; a++) {
        left += sqrt(fmax(0.0, now->inverse.m[a][a] * now->left[a]));
        for (int b = 0; b < ns; b++)
            hidden += fabs(now->inverse.m[a][b]) * sqrt(now->hidden[a] * now->hidden[b]);
    }
    if (corrected) return left * left;
    left += sqrt(fmax(0.0, high));
    return left * left + hidden;
}

/* Layers of correction a: those of T + d at s minus those of T. The mean strain of d that
 * `macro` takes away is spread evenly over the layers, like that of every macro strain. */
static ph_status take_layers(ph_visco *v, const visit *now, int a, ph_basis_field *b,
                             ph_error *err)
{
    ph_status st = PH_OK;
    size_t n = ph_i_visco_size(v), hidden = ph_i_visco_hidden(v);
    double macro[6], unit[6];
    reduced_field(v, now, a, v->u, macro);
    for (size_t k = 0; k < n; k++)
        v->u[k] += b->u[k];
    ph_i_sites_strain(&v->sites, v->u, macro, v->strain);
    PH_TRY(ph_i_layers_localise(&v->layers, &v->sites, v->phase, v->space, v->strain,
                                b->x, err));
    for (int k = 0; k < 6; k++)
        unit[k] = (k == a ? 1.0 : 0.0) - b->macro[k];
    ph_i_sites_strain(&v->sites, NULL, unit, v->strain);
    ph_i_layers_spread(&v->layers, &v->sites, v->strain, v->x);
    for (size_t k = 0; k < hidden; k++)
        b->x[k] -= v->x[k];
    for (int i = 0; i < now->old; i++)
        for (size_t k = 0; k < hidden; k++)
            b->x[k] -= now->c[a * now->old + i] * v->basis[i].x[k];
out:
    return st;
}

static ph_status new_field(ph_visco *v, ph_basis_field **out, ph_error *err)
{
    ph_status st = PH_OK;
    if (v->nbasis == v->room) {
        int room = 2 * v->room + 12;
        void *p = realloc(v->basis, sizeof *v->basis * (size_t)room);
        PH_CHECK(p, PH_ENOMEM, "no memory for the basis");
        v->basis = p;
        v->room = room;
    }
    *out = &v->basis[v->nbasis];
    **out = (ph_basis_field){0};
    PH_DOUBLES((*out)->u, &v->run.meter, ph_i_visco_size(v), "a field of the basis");
    v->nbasis++; /* cleared with the others from here on */
    PH_DOUBLES((*out)->x, &v->run.meter, ph_i_visco_hidden(v), "a field of the basis");
out:
    return st;
}

/* The field of correction a, in units of its energy. */
static ph_status take_field(ph_visco *v, const visit *now, int a, ph_error *err)
{
    ph_status st = PH_OK;
    ph_run *r = &v->run;
    size_t n = ph_i_visco_size(v), hidden = ph_i_visco_hidden(v);
    double stress[6], strain[6], scale = 1.0 / sqrt(now->captured.m[a][a]);
    ph_cell_energy e;
    ph_basis_field *b = NULL;
    PH_TRY(new_field(v, &b, err));
    memcpy(b->u, v->d[a], sizeof *b->u * n);
    if (r->constraint->by_stress) { /* its mean strain is no part of the fluctuation */
        PH_TRY(ph_i_operator_sums(r->op, b->u, NULL, r->setting.region, stress, strain,
                                  &e, err));
        v->out->applications++;
        for (int c = 0; c < r->map->ns; c++)
            if (ph_i_run_by_stress(r, c))
                b->macro[c] = -strain[c] / (double)r->setting.averaged;
    }
    if (v->layers.count > 0) PH_TRY(take_layers(v, now, a, b, err));
    for (size_t k = 0; k < n; k++)
        b->u[k] *= scale;
    for (size_t k = 0; k < hidden; k++)
        b->x[k] *= scale;
    for (int k = 0; k < 6; k++)
        b->macro[k] *= scale;
out:
    return st;
}

static ph_status start(ph_visco *v, visit *now, ph_error *err)
{
    ph_status st = PH_OK;
    int ns = v->run.map->ns;
    now->old = v->nbasis;
    PH_ALLOC(now->c, ns * now->old, "the reduced solution");
    PH_TRY(ph_i_reduced_at(&v->model, now->s, &now->C, now->c, err));
    double low, high;
    ph_sym4_eigenvalues(&now->C, &low, &high);
    now->held = now->C;
    for (int a = 0; a < ns; a++)
        now->held.m[a][a] += softest_direction * high;
    PH_TRY(ph_sym4_inverse(&now->held, &now->inverse, err));
    now->captured = (ph_sym4){.n = ns};
out:
    return st;
}

ph_status ph_i_visco_visit(ph_visco *v, double s, double share, double enough,
                           double *error, double *left, int *added, ph_error *err)
{
    ph_status st = PH_OK;
    int ns = v->run.map->ns;
    size_t n = ph_i_visco_size(v);
    double size[6], cells = (double)v->run.setting.averaged;
    visit now = {.s = s, .energy_share = share};
    *added = 0;
    PH_TRY(ph_i_visco_set(v, s, err));
    PH_TRY(start(v, &now, err));
    for (int a = 0; a < ns; a++)
        PH_TRY(residual(v, &now, a, &size[a], err));
    for (int a = 0; a < ns; a++)
        PH_TRY(correct(v, &now, a, size[a], err));
    for (int a = 0; a < ns; a++)
        for (int b = 0; b <= a; b++)
            now.captured.m[a][b] = now.captured.m[b][a] =
                0.5 *
                (ph_i_inner((ptrdiff_t)n, v->r[a], v->d[b]) +
                 ph_i_inner((ptrdiff_t)n, v->r[b], v->d[a])) /
                cells;
    *error = error_of(v, &now, false);
    *left = error_of(v, &now, true);
    for (int a = 0; a<ns && * error> enough; a++) {
        double gain = now.captured.m[a][a] + now.hidden[a];
        if (now.idle[a] || !(now.captured.m[a][a] > 0.0)) continue;
        if (!(gain * now.inverse.m[a][a] > fmin(worth, share) * v->tolerance)) continue;
        PH_TRY(take_field(v, &now, a, err));
        ++*added;
    }
    PH_TRY(ph_i_visco_gram(v, *added, err));
out:
    free(now.c);
    return st;
}
