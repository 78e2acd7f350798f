/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/operator.h"

#include <math.h>
#include <string.h>

static double sum_squares_half(const ph_layout *l)
{
    double s = 0.0;
    for (int a = 0; a < 3; a++)
        if (l->axis[a] >= 0) s += 0.25 * l->h[a] * l->h[a];
    return s;
}

static int dimensions(const ph_layout *l)
{
    return (l->axis[0] >= 0) + (l->axis[1] >= 0) + (l->axis[2] >= 0);
}

/* (S) of the smallest family: alpha kappa d / tr K per squared corner deviation, and the
 * squared deviations of 2^d corners are the squared raw amplitudes over 2^d. */
static double hourglass_coefficient(const ph_layout *l, double alpha, double softest)
{
    double corners = pow(2.0, dimensions(l));
    if (dimensions(l) == 0) return 0.0;
    return alpha * softest * dimensions(l) / (corners * corners * sum_squares_half(l));
}

/* Nanoseconds per cell: a bond of the stencil (strain and divergence), a transform, the
 * products in Fourier space. Measured, see docs/performance.md. Fixed numbers, so that the
 * choice, and with it every bit of the result, does not depend on the load of the machine. */
static const double ns_bond = 0.45, ns_transform = 4.5, ns_product = 1.3;

bool ph_i_operator_by_cells(const ph_operator_params *p)
{
    return !p->classes && !p->one_sided && p->route != PH_ROUTE_BONDS &&
           (!p->family || p->smallest);
}

static ph_route choose_route(const ph_layout *l, const ph_operator_params *p)
{
    if (ph_i_operator_by_cells(p)) return PH_ROUTE_CELLS;
    if (p->one_sided || p->route == PH_ROUTE_BONDS) return PH_ROUTE_BONDS;
    if (p->route != PH_ROUTE_AUTO) return p->route;
    int strains = dimensions(l) == 3 ? 6 : l->ns == 6 ? 5 : 3;
    double stencil = ns_bond * l->nd * l->nd * (double)p->family->count;
    double convolution =
        2.0 * (strains - l->nd) * ns_transform + 2.0 * strains * ns_product;
    return stencil < convolution ? PH_ROUTE_STENCIL : PH_ROUTE_CONVOLUTION;
}

/* Energy share theta at the simplices of a cell, one stencil for each of its 2^d corners.
 * Node families: the node and its neighbours on one side along every axis. Stress points:
 * the corner and the other ends of its edges. */
static ph_status new_simplices(ph_operator *op, const ph_grid *box, ph_error *err)
{
    ph_status st = PH_OK;
    for (int corner = 0; corner < 8; corner++) {
        int offset[4][3] = {{0}};
        double g[4][3] = {{0}};
        ptrdiff_t n = 1;
        bool skip = false;
        for (int d = 0; d < 3; d++) {
            bool up = (corner >> d) & 1;
            if (box->n[d] == 1) {
                skip = skip || up;
                continue;
            }
            double s = (up ? 1.0 : -1.0) / box->h[d];
            offset[n][d] = up ? 1 : -1;
            g[n++][d] = s;
            g[0][d] -= s;
        }
        if (op->family->points == PH_POINTS_STRESS) /* from the opposite corner inwards */
            for (ptrdiff_t b = 0; b < n; b++)
                for (int d = 0; d < 3; d++)
                    if (box->n[d] > 1 && !((corner >> d) & 1)) offset[b][d]++;
        if (skip) continue;
        PH_TRY(ph_i_stencil_new(&op->layout, n, (const int(*)[3])offset,
                                (const double(*)[3])g, op->threads, &op->sub[op->nsub],
                                err));
        op->nsub++;
    }
out:
    return st;
}

/* S(k) of a family with points at nodes or between them. */
static ph_status new_spectral(ph_operator *op, double alpha, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_family *fam = op->family;
    const ph_layout *l = &op->layout;
    double *real = NULL, *hat = NULL, *g[3] = {NULL, NULL, NULL};
    size_t nhat = (size_t)(2 * op->modes);
    PH_DOUBLES(op->spectral, op->meter, (size_t)op->modes, "the stabilisation");
    PH_DOUBLES(real, op->meter, (size_t)l->cells, "one field");
    PH_DOUBLES(hat, op->meter, nhat, "one transform");
    for (int a = 0; a < 3; a++) {
        int d = l->axis[a];
        if (d < 0) continue;
        PH_DOUBLES(g[d], op->meter, nhat, "a gradient symbol");
        ph_i_gradient_symbol(op->fft, l, fam->count, (const int(*)[3])fam->offset,
                             (const double(*)[3])fam->g, d, real, g[d]);
    }
    double trace = fam->K[0][0] + fam->K[1][1] + fam->K[2][2];
    double s = trace > 0.0 ? alpha * op->map->softest * dimensions(l) / trace : 0.0;
    op->s = s;
    double(*w)[3] = NULL;
    PH_ALLOC(w, fam->count, "bond weights");
    for (ptrdiff_t b = 0; b < fam->count; b++)
        w[b][0] = fam->w[b];
    ph_i_gradient_symbol(op->fft, l, fam->count, (const int(*)[3])fam->offset,
                         (const double(*)[3])w, 0, real, hat);
    free(w);
    for (ptrdiff_t k = 0; k < op->modes; k++) {
        double sum = hat[2 * k], sum2 = sum * sum + hat[2 * k + 1] * hat[2 * k + 1];
        double all = fam->points == PH_POINTS_STRESS ? fam->weight - sum2 / fam->weight
                                                     : 2.0 * (fam->weight - sum);
        for (int d = 0; d < 3; d++)
            for (int e = 0; e < 3; e++)
                if (g[d] && g[e])
                    all -= fam->K[d][e] * (g[d][2 * k] * g[e][2 * k] +
                                           g[d][2 * k + 1] * g[e][2 * k + 1]);
        op->spectral[k] = s * fmax(0.0, all);
    }
out:
    ph_i_doubles_free(op->meter, &real, (size_t)l->cells);
    ph_i_doubles_free(op->meter, &hat, nhat);
    for (int d = 0; d < 3; d++)
        ph_i_doubles_free(op->meter, &g[d], nhat);
    return st;
}

/* The family part by its route. */
static ph_status new_family_part(ph_operator *op, const ph_operator_params *p,
                                 ph_error *err)
{
    ph_status st = PH_OK;
    const ph_layout *l = &op->layout;
    ph_meter *m = op->meter;
    double theta = p->stabilisation == PH_STABILISE_SUBPOINT ? p->value : 0.0;
    op->share = 1.0 - theta;
    if (op->route == PH_ROUTE_CELLS) {
        double c1 = p->family ? theta : 1.0 / 3.0, c2 = p->family ? theta : 1.0 / 9.0;
        bool in_space =
            p->hourglass_in_space && p->stabilisation == PH_STABILISE_SPECTRAL;
        double s = in_space ? hourglass_coefficient(l, p->value, op->map->softest) : 0.0;
        PH_TRY(ph_i_cells_init(&op->cells, l, op->map, c1, c2, s, op->threads, m, err));
        op->hourglass = s;
        op->has_cells = true;
        op->share = 1.0;
        return st;
    }
    PH_DOUBLES(op->e, m, (size_t)(l->ns * l->cells), "the strain field");
    if (op->route == PH_ROUTE_CONVOLUTION) {
        PH_TRY(ph_i_convolution_init(&op->convolution, l, op->fft, p->family, op->threads,
                                     m, err));
        op->has_convolution = true;
    } else {
        PH_TRY(ph_i_stencil_new(l, p->family->count, (const int(*)[3])p->family->offset,
                                (const double(*)[3])p->family->g, op->threads,
                                &op->stencil, err));
    }
out:
    return st;
}

static ptrdiff_t pad_size(const ph_operator *op)
{
    ptrdiff_t row = op->stencil ? ph_i_stencil_row(op->stencil) : 0;
    for (int i = 0; i < op->nsub; i++) {
        ptrdiff_t r = ph_i_stencil_row(op->sub[i]);
        if (r > row) row = r;
    }
    return row * op->layout.n[0] * op->layout.n[1] * op->layout.ns;
}

/* Does a field have to pass through Fourier space to meet this operator? */
static bool by_spectrum(const ph_operator *op)
{
    return op->has_convolution || (op->spectral && op->stabilise != 0.0);
}

ph_status ph_i_operator_new(const ph_grid *box, const ph_stiffness_map *map,
                            const ph_operator_params *p, ph_meter *meter,
                            ph_operator **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_operator *op = NULL;
    *out = NULL;
    PH_ALLOC(op, 1, "the operator");
    op->layout = ph_i_layout(box);
    op->map = map;
    op->meter = meter;
    op->family = p->family;
    op->threads = p->threads > 0 ? p->threads : 1;
    op->stabilise = 1.0;
    PH_TRY(ph_i_fft_new(&op->layout, op->threads, &op->fft, err));
    op->modes = ph_i_fft_modes(op->fft);
    size_t cells = (size_t)op->layout.cells, nd = (size_t)op->layout.nd;
    op->nu = nd * cells;
    if (p->classes) { /* a medium of springs */
        PH_DOUBLES(op->u, meter, op->nu, "a displacement field");
        PH_DOUBLES(op->f, meter, nd * cells, "a force field");
        PH_TRY(ph_i_springs_new(&op->layout, op->fft, p->family, p->classes, p->route,
                                op->threads, meter, &op->springs, err));
        op->springs->broken = p->broken;
        op->route = ph_i_springs_route(op->springs);
        op->share = 1.0;
        *out = op;
        return st;
    }
    op->route = choose_route(&op->layout, p);
    PH_CHECK(!p->broken || p->stabilisation != PH_STABILISE_SUBPOINT, PH_EINVAL,
             "sub-points know nothing of broken bonds: take stabilisation spectral");
    op->shares_f = op->route == PH_ROUTE_CONVOLUTION &&
                   p->stabilisation != PH_STABILISE_SUBPOINT && !p->broken;
    PH_DOUBLES(op->u, meter, op->nu, "a displacement field");
    if (!op->shares_f) PH_DOUBLES(op->f, meter, nd * cells, "a force field");
    if (op->route == PH_ROUTE_BONDS) { /* everything is in the lists */
        op->share = p->stabilisation == PH_STABILISE_SUBPOINT ? 1.0 - p->value : 1.0;
        PH_TRY(ph_i_bondlist_new(box, map, p, meter, &op->bonds, err));
        ph_operator_params whole = *p;
        whole.broken = NULL;
        if (p->broken)
            PH_TRY(ph_i_bondlist_new(box, map, &whole, meter, &op->whole, err));
        op->hourglass = op->bonds->s;
        *out = op;
        return st;
    }
    PH_TRY(new_family_part(op, p, err));
    if (op->shares_f) op->f = op->e; /* forces are needed only when strains are not */
    if (p->stabilisation == PH_STABILISE_SUBPOINT && op->route != PH_ROUTE_CELLS)
        PH_TRY(new_simplices(op, box, err));
    if (p->stabilisation == PH_STABILISE_SPECTRAL && p->family &&
        !(op->has_cells && p->hourglass_in_space))
        PH_TRY(new_spectral(op, p->value, err));
    if (op->has_convolution || op->spectral)
        PH_DOUBLES(op->hat, meter, 2 * nd * (size_t)op->modes, "a transformed field");
    if (p->broken)
        PH_TRY(ph_i_damaged_new(&op->layout, p->broken, op->s, op->threads, meter,
                                &op->damaged, err));
    if (op->stencil || op->nsub)
        PH_DOUBLES(op->pad, meter, (size_t)pad_size(op), "padded rows");
    *out = op;
    op = NULL;
out:
    ph_i_operator_free(&op);
    return st;
}

ph_status ph_i_operator_widen(ph_operator *op, size_t count, ph_error *err)
{
    ph_status st = PH_OK;
    if (op->nu >= count) return PH_OK;
    ph_i_doubles_free(op->meter, &op->u, op->nu);
    op->nu = count;
    PH_DOUBLES(op->u, op->meter, op->nu, "a displacement field");
out:
    return st;
}

void ph_i_operator_free(ph_operator **out)
{
    if (!out || !*out) return;
    ph_operator *op = *out;
    size_t cells = (size_t)op->layout.cells, nd = (size_t)op->layout.nd;
    ph_i_doubles_free(op->meter, &op->pad, (size_t)pad_size(op));
    if (op->has_cells) ph_i_cells_clear(&op->cells, op->meter);
    if (op->has_convolution) ph_i_convolution_clear(&op->convolution, op->meter);
    ph_i_stencil_free(&op->stencil);
    ph_i_bondlist_free(&op->bonds);
    ph_i_bondlist_free(&op->whole);
    ph_i_springs_free(&op->springs);
    ph_i_damaged_free(&op->damaged);
    for (int i = 0; i < op->nsub; i++)
        ph_i_stencil_free(&op->sub[i]);
    ph_i_doubles_free(op->meter, &op->u, op->nu);
    if (!op->shares_f) ph_i_doubles_free(op->meter, &op->f, nd * cells);
    ph_i_doubles_free(op->meter, &op->e, (size_t)op->layout.ns * cells);
    ph_i_doubles_free(op->meter, &op->spectral, (size_t)op->modes);
    ph_i_doubles_free(op->meter, &op->hat, 2 * nd * (size_t)op->modes);
    ph_i_doubles_free(op->meter, &op->hat2, 2 * nd * (size_t)op->modes);
    ph_i_fft_free(&op->fft);
    free(op);
    *out = NULL;
}

void ph_i_operator_stabilise(ph_operator *op, double factor)
{
    op->stabilise = factor;
    if (op->has_cells) op->cells.hourglass = factor * op->hourglass;
    if (op->bonds) op->bonds->s = factor * op->hourglass;
    if (op->damaged) op->damaged->s = factor * op->s;
}

ph_status ph_i_operator_renew_springs(ph_operator *op, ph_error *err)
{
    const ph_family *family = op->springs->family;
    const ph_bond_classes *classes = op->springs->classes;
    const ph_broken *broken = op->springs->broken;
    ph_route route = ph_i_springs_route(op->springs);
    ph_i_springs_free(&op->springs);
    ph_status st = ph_i_springs_new(&op->layout, op->fft, family, classes, route,
                                    op->threads, op->meter, &op->springs, err);
    if (st == PH_OK) op->springs->broken = broken;
    return st;
}

void ph_i_operator_forward(ph_operator *op, const double *u, double *uhat)
{
    for (int a = 0; a < op->layout.nd; a++)
        ph_i_fft_forward(op->fft, u + a * op->layout.cells, uhat + 2 * a * op->modes);
}

void ph_i_operator_backward(ph_operator *op, const double *uhat, double *work, double *u)
{
    double scale = 1.0 / (double)op->layout.cells;
    for (int a = 0; a < op->layout.nd; a++)
        ph_i_fft_backward(op->fft, uhat + 2 * a * op->modes, work + 2 * a * op->modes,
                          u + a * op->layout.cells);
    ptrdiff_t n = op->layout.nd * op->layout.cells;
#pragma omp parallel for simd num_threads(op->threads) schedule(static, PH_CHUNK)
    for (ptrdiff_t x = 0; x < n; x++)
        u[x] *= scale;
}

/* f = scale * B^T C (B u + macro) of all parts that live in space; the convolution only if
 * `conv` (then u must be in op->hat as well). Adds nothing spectral.
 * Where `sum` is not NULL the stresses of all points are added to it, times the scale. */
enum { PARTS = 64 };

/* sum += scale * the stresses in op->e, the same bits for any number of threads. */
static void add_stresses(const ph_operator *op, double scale, double *sum)
{
    const ptrdiff_t cells = op->layout.cells;
    double part[6][PARTS];
    const int ns = op->layout.ns;
#pragma omp parallel for num_threads(op->threads) schedule(static)
    for (int q = 0; q < ns * PARTS; q++) {
        ptrdiff_t first = cells * (q % PARTS) / PARTS,
                  end = cells * (q % PARTS + 1) / PARTS;
        double s = 0.0;
        for (ptrdiff_t x = first; x < end; x++)
            s += op->e[q / PARTS * cells + x];
        part[q / PARTS][q % PARTS] = s;
    }
    for (int i = 0; i < ns; i++)
        for (int q = 0; q < PARTS; q++)
            sum[i] += scale * part[i][q];
}

static void add_subpoints(ph_operator *op, const double *u, const double *macro,
                          double scale, double *f, double *sum)
{
    const double share = scale * (1.0 - op->share) / op->nsub;
    for (int i = 0; i < op->nsub; i++) {
        ph_i_stencil_strain(op->sub[i], u, macro, op->pad, op->e);
        ph_i_hooke_field(op->map, op->threads, op->e, op->e);
        if (sum) add_stresses(op, share, sum);
        ph_i_stencil_divergence(op->sub[i], op->e, share, true, op->pad, f);
    }
}

static void add_diagonal(const ph_operator *op, const double *uhat, double *fhat)
{
    const double factor = op->stabilise;
    if (!op->spectral || factor == 0.0) return;
    for (int a = 0; a < op->layout.nd; a++) {
        const double *u = uhat + 2 * a * op->modes, *s = op->spectral;
        double *f = fhat + 2 * a * op->modes;
#pragma omp parallel for num_threads(op->threads) schedule(static, PH_CHUNK)
        for (ptrdiff_t k = 0; k < op->modes; k++) {
            f[2 * k] += factor * s[k] * u[2 * k];
            f[2 * k + 1] += factor * s[k] * u[2 * k + 1];
        }
    }
}

static void scale_field(const ph_operator *op, double s, ptrdiff_t n, double *x)
{
    if (s == 1.0) return;
#pragma omp parallel for simd num_threads(op->threads) schedule(static, PH_CHUNK)
    for (ptrdiff_t i = 0; i < n; i++)
        x[i] *= s;
}

/* Stresses of the strains in op->e, those of damaged nodes with the damaged. */
static void make_stress(ph_operator *op)
{
    ph_i_hooke_field(op->map, op->threads, op->e, op->e);
    if (op->damaged) ph_i_damaged_take(op->damaged, op->e);
}

static void add_uniform(const ph_operator *op, double scale, const double *macro,
                        double *e)
{
    const ptrdiff_t cells = op->layout.cells;
    for (int i = 0; i < op->layout.ns; i++)
#pragma omp parallel for simd num_threads(op->threads) schedule(static, PH_CHUNK)
        for (ptrdiff_t x = 0; x < cells; x++)
            e[i * cells + x] += scale * macro[i];
}

static void apply_convolution_hat(ph_operator *op, const double *uhat,
                                  const double *macro, double *fhat, double *sum)
{
    const double cells = (double)op->layout.cells, back = 1.0 / cells;
    double *work = op->convolution.work;
    bool in_space = op->nsub || op->damaged;
    for (int a = 0; in_space && a < op->layout.nd; a++)
        ph_i_fft_backward(op->fft, uhat + 2 * a * op->modes, work,
                          op->u + a * op->layout.cells);
    ph_i_convolution_strain(&op->convolution, uhat, op->share * back, op->e);
    if (macro) add_uniform(op, op->share, macro, op->e);
    if (op->damaged) ph_i_damaged_strain(op->damaged, op->u, NULL, back, op->e);
    make_stress(op);
    if (sum) add_stresses(op, 1.0, sum);
    ph_i_convolution_divergence(&op->convolution, op->e, fhat);
    if (!in_space) return;
    /* fhat += F(forces made in space); those of each component pass through op->f. */
    memset(op->f, 0, sizeof(double) * (size_t)(op->layout.nd * op->layout.cells));
    double whole[6]; /* u is so many times what it should be */
    for (int i = 0; macro && i < op->layout.ns; i++)
        whole[i] = cells * macro[i];
    if (op->nsub) add_subpoints(op, op->u, macro ? whole : NULL, back, op->f, sum);
    if (op->damaged) ph_i_damaged_scatter(op->damaged, 1.0, op->u, back, op->f);
    for (int a = 0; a < op->layout.nd; a++) {
        ph_i_fft_forward(op->fft, op->f + a * op->layout.cells, work);
        for (ptrdiff_t k = 0; k < 2 * op->modes; k++)
            fhat[2 * a * op->modes + k] += work[k];
    }
}

/* f = scale * A u without the spectral part, for the routes that live in space. */
static void apply_in_space(ph_operator *op, const double *u, const double *macro,
                           double scale, double *f, double *sum)
{
    if (op->has_cells && sum) {
        ph_i_cells_apply_mean(&op->cells, u, macro, scale, f, sum);
        return;
    }
    if (op->has_cells) {
        ph_i_cells_apply(&op->cells, u, macro, scale, f);
        return;
    }
    if (op->springs) {
        ph_i_springs_apply(op->springs, u, scale, f);
        return;
    }
    if (op->bonds) {
        ph_i_bondlist_apply(op->bonds, u, f);
        scale_field(op, scale, op->layout.nd * op->layout.cells, f);
        return;
    }
    ph_i_stencil_strain(op->stencil, u, macro, op->pad, op->e);
    if (op->damaged) ph_i_damaged_strain(op->damaged, u, macro, 1.0, op->e);
    make_stress(op);
    if (sum) add_stresses(op, scale * op->share, sum);
    ph_i_stencil_divergence(op->stencil, op->e, scale * op->share, false, op->pad, f);
    if (op->damaged) ph_i_damaged_scatter(op->damaged, scale, u, scale, f);
    add_subpoints(op, u, macro, scale, f, sum);
}

static void apply_hat(ph_operator *op, const double *uhat, const double *macro,
                      double *fhat, double *sum)
{
    const double cells = (double)op->layout.cells;
    op->applications++;
    if (op->has_convolution) {
        apply_convolution_hat(op, uhat, macro, fhat, sum);
    } else {
        double whole[6];
        for (int i = 0; macro && i < op->layout.ns; i++)
            whole[i] = cells * macro[i];
        for (int a = 0; a < op->layout.nd;
             a++) /* fhat is the work space until it is set */
            ph_i_fft_backward(op->fft, uhat + 2 * a * op->modes, fhat + 2 * a * op->modes,
                              op->u + a * op->layout.cells);
        apply_in_space(op, op->u, macro ? whole : NULL, 1.0 / cells, op->f, sum);
        ph_i_operator_forward(op, op->f, fhat);
    }
    add_diagonal(op, uhat, fhat);
}

void ph_i_operator_apply_hat(ph_operator *op, const double *uhat, double *fhat)
{
    apply_hat(op, uhat, NULL, fhat, NULL);
}

void ph_i_operator_apply_mean(ph_operator *op, const double *uhat, const double *macro,
                              double *fhat, double *sum)
{
    memset(sum, 0, (size_t)op->layout.ns * sizeof *sum);
    apply_hat(op, uhat, macro, fhat, sum);
}

ph_status ph_i_operator_update(ph_operator *op, ph_error *err)
{
    return op->damaged ? ph_i_damaged_update(op->damaged, err) : PH_OK;
}

ph_status ph_i_operator_in_space(ph_operator *op, ph_error *err)
{
    ph_status st = PH_OK;
    if (by_spectrum(op) && !op->hat2)
        PH_DOUBLES(op->hat2, op->meter, (size_t)(2 * op->layout.nd * op->modes),
                   "a transformed force");
out:
    return st;
}

void ph_i_operator_apply(ph_operator *op, const double *u, double *f)
{
    if (!by_spectrum(op)) {
        op->applications++;
        apply_in_space(op, u, NULL, 1.0, f, NULL);
        return;
    }
    ph_i_operator_forward(op, u, op->hat);
    ph_i_operator_apply_hat(op, op->hat, op->hat2);
    ph_i_operator_backward(op, op->hat2, op->hat2, f);
}

void ph_i_operator_load(ph_operator *op, const double *macro, double *f)
{
    const ph_layout *l = &op->layout;
    ptrdiff_t n = l->nd * l->cells;
    if (op->has_cells) {
        ph_i_cells_apply(&op->cells, NULL, macro, -1.0, f);
        return;
    }
    if (op->bonds) {
        ph_i_bondlist_load(op->bonds, macro, f);
        return;
    }
    if (op->springs) {
        ph_i_springs_load(op->springs, macro, f);
        return;
    }
    for (int i = 0; i < l->ns; i++)
        for (ptrdiff_t x = 0; x < l->cells; x++)
            op->e[i * l->cells + x] = macro[i];
    if (op->damaged) ph_i_damaged_strain(op->damaged, NULL, macro, 1.0, op->e);
    make_stress(op);
    if (op->has_convolution) {
        ph_i_convolution_divergence(&op->convolution, op->e, op->hat);
        ph_i_operator_backward(op, op->hat, op->hat, f);
        scale_field(op, -op->share, n, f);
    } else {
        ph_i_stencil_divergence(op->stencil, op->e, -op->share, false, op->pad, f);
    }
    if (op->damaged) ph_i_damaged_scatter(op->damaged, -1.0, NULL, 0.0, f);
    if (!op->nsub) return;
    memset(op->u, 0, sizeof(double) * (size_t)n);
    add_subpoints(op, op->u, macro, -1.0, f, NULL);
}

void ph_i_operator_pull(ph_operator *op, const double *sigma, const uint8_t *region,
                        double *f)
{
    if (op->bonds)
        ph_i_bondlist_pull(op->whole ? op->whole : op->bonds, sigma, region, f);
    else
        ph_i_cells_pull(&op->cells, sigma, region, f);
}

/* ---- entries ---------------------------------------------------------------------------- */

ph_status ph_i_assembly_init(ph_assembly *a, const ph_operator *op, const ph_grid *box,
                             const ph_operator_params *params, ph_meter *meter,
                             ph_error *err)
{
    *a = (ph_assembly){.springs = op->springs, .list = op->bonds};
    if (a->springs || a->list) return PH_OK;
    ph_status st = ph_i_bondlist_new(box, op->map, params, meter, &a->own, err);
    a->list = a->own;
    return st;
}

void ph_i_assembly_clear(ph_assembly *a)
{
    ph_i_bondlist_free(&a->own);
    a->list = NULL;
}

ph_status ph_i_assembly_matrix(const ph_assembly *a, const int *unknown, int n,
                               ph_csc *out, ph_error *err)
{
    return a->springs ? ph_i_springs_matrix(a->springs, unknown, n, out, err)
                      : ph_i_bondlist_matrix(a->list, unknown, n, out, err);
}

ph_status ph_i_assembly_row_sums(const ph_assembly *a, double *sum, ph_error *err)
{
    return a->springs ? ph_i_springs_row_sums(a->springs, sum, err)
                      : ph_i_bondlist_row_sums(a->list, sum, err);
}
