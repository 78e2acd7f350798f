/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/operator.h"

#include <math.h>
#include <string.h>

#define R2_HALF 0.70710678118654752440 /* Mandel to tensor shear */

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
static const double ns_bond = 0.39, ns_transform = 4.5, ns_product = 1.3;

static ph_route choose_route(const ph_layout *l, const ph_operator_params *p)
{
    if (p->one_sided || p->route == PH_ROUTE_BONDS) return PH_ROUTE_BONDS;
    if (!p->family || p->smallest) return PH_ROUTE_CELLS;
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
    return op->has_convolution || op->spectral;
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
    PH_TRY(ph_i_fft_new(&op->layout, op->threads, &op->fft, err));
    op->modes = ph_i_fft_modes(op->fft);
    size_t cells = (size_t)op->layout.cells, nd = (size_t)op->layout.nd;
    if (p->classes) { /* a medium of springs */
        PH_DOUBLES(op->u, meter, nd * cells, "a displacement field");
        PH_DOUBLES(op->f, meter, nd * cells, "a force field");
        PH_TRY(ph_i_springs_new(&op->layout, op->fft, p->family, p->classes, p->route,
                                op->threads, meter, &op->springs, err));
        op->route = ph_i_springs_route(op->springs);
        op->share = 1.0;
        *out = op;
        return st;
    }
    op->route = choose_route(&op->layout, p);
    op->shares_f =
        op->route == PH_ROUTE_CONVOLUTION && p->stabilisation != PH_STABILISE_SUBPOINT;
    PH_DOUBLES(op->u, meter, nd * cells, "a displacement field");
    if (!op->shares_f) PH_DOUBLES(op->f, meter, nd * cells, "a force field");
    if (op->route == PH_ROUTE_BONDS) { /* everything is in the lists */
        op->share = p->stabilisation == PH_STABILISE_SUBPOINT ? 1.0 - p->value : 1.0;
        PH_TRY(ph_i_bondlist_new(box, map, p, meter, &op->bonds, err));
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
    if (by_spectrum(op))
        PH_DOUBLES(op->hat, meter, 2 * nd * (size_t)op->modes, "a transformed field");
    if (op->stencil || op->nsub)
        PH_DOUBLES(op->pad, meter, (size_t)pad_size(op), "padded rows");
    *out = op;
    op = NULL;
out:
    ph_i_operator_free(&op);
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
    ph_i_springs_free(&op->springs);
    for (int i = 0; i < op->nsub; i++)
        ph_i_stencil_free(&op->sub[i]);
    ph_i_doubles_free(op->meter, &op->u, nd * cells);
    if (!op->shares_f) ph_i_doubles_free(op->meter, &op->f, nd * cells);
    ph_i_doubles_free(op->meter, &op->e, (size_t)op->layout.ns * cells);
    ph_i_doubles_free(op->meter, &op->spectral, (size_t)op->modes);
    ph_i_doubles_free(op->meter, &op->hat, 2 * nd * (size_t)op->modes);
    ph_i_doubles_free(op->meter, &op->hat2, 2 * nd * (size_t)op->modes);
    ph_i_fft_free(&op->fft);
    free(op);
    *out = NULL;
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
#pragma omp parallel for simd num_threads(op->threads) schedule(static)
    for (ptrdiff_t x = 0; x < n; x++)
        u[x] *= scale;
}

/* f = scale * B^T C (B u + macro) of all parts that live in space; the convolution only if
 * `conv` (then u must be in op->hat as well). Adds nothing spectral. */
static void add_subpoints(ph_operator *op, const double *u, const double *macro,
                          double scale, double *f)
{
    for (int i = 0; i < op->nsub; i++) {
        ph_i_stencil_strain(op->sub[i], u, macro, op->pad, op->e);
        ph_i_hooke_field(op->map, op->threads, op->e, op->e);
        ph_i_stencil_divergence(op->sub[i], op->e, scale * (1.0 - op->share) / op->nsub,
                                true, op->pad, f);
    }
}

static void add_diagonal(const ph_operator *op, const double *uhat, double *fhat)
{
    if (!op->spectral) return;
    for (int a = 0; a < op->layout.nd; a++) {
        const double *u = uhat + 2 * a * op->modes, *s = op->spectral;
        double *f = fhat + 2 * a * op->modes;
#pragma omp parallel for num_threads(op->threads) schedule(static)
        for (ptrdiff_t k = 0; k < op->modes; k++) {
            f[2 * k] += s[k] * u[2 * k];
            f[2 * k + 1] += s[k] * u[2 * k + 1];
        }
    }
}

static void scale_field(const ph_operator *op, double s, ptrdiff_t n, double *x)
{
    if (s == 1.0) return;
#pragma omp parallel for simd num_threads(op->threads) schedule(static)
    for (ptrdiff_t i = 0; i < n; i++)
        x[i] *= s;
}

static void apply_convolution_hat(ph_operator *op, const double *uhat, double *fhat)
{
    ph_i_convolution_strain(&op->convolution, uhat, op->share / (double)op->layout.cells,
                            op->e);
    ph_i_hooke_field(op->map, op->threads, op->e, op->e);
    ph_i_convolution_divergence(&op->convolution, op->e, fhat);
    if (!op->nsub) return;
    /* fhat += F(sub-point forces); the forces of each component pass through op->f. */
    double *work = op->convolution.work;
    for (int a = 0; a < op->layout.nd; a++)
        ph_i_fft_backward(op->fft, uhat + 2 * a * op->modes, work,
                          op->u + a * op->layout.cells);
    memset(op->f, 0, sizeof(double) * (size_t)(op->layout.nd * op->layout.cells));
    add_subpoints(op, op->u, NULL, 1.0 / (double)op->layout.cells, op->f);
    for (int a = 0; a < op->layout.nd; a++) {
        ph_i_fft_forward(op->fft, op->f + a * op->layout.cells, work);
        for (ptrdiff_t k = 0; k < 2 * op->modes; k++)
            fhat[2 * a * op->modes + k] += work[k];
    }
}

/* f = scale * A u without the spectral part, for the routes that live in space. */
static void apply_in_space(ph_operator *op, const double *u, const double *macro,
                           double scale, double *f)
{
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
    ph_i_hooke_field(op->map, op->threads, op->e, op->e);
    ph_i_stencil_divergence(op->stencil, op->e, scale * op->share, false, op->pad, f);
    add_subpoints(op, u, macro, scale, f);
}

void ph_i_operator_apply_hat(ph_operator *op, const double *uhat, double *fhat)
{
    op->applications++;
    if (op->has_convolution) {
        apply_convolution_hat(op, uhat, fhat);
    } else {
        for (int a = 0; a < op->layout.nd;
             a++) /* fhat is the work space until it is set */
            ph_i_fft_backward(op->fft, uhat + 2 * a * op->modes, fhat + 2 * a * op->modes,
                              op->u + a * op->layout.cells);
        apply_in_space(op, op->u, NULL, 1.0 / (double)op->layout.cells, op->f);
        ph_i_operator_forward(op, op->f, fhat);
    }
    add_diagonal(op, uhat, fhat);
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
        apply_in_space(op, u, NULL, 1.0, f);
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
    ph_i_hooke_field(op->map, op->threads, op->e, op->e);
    if (op->has_convolution) {
        ph_i_convolution_divergence(&op->convolution, op->e, op->hat);
        ph_i_operator_backward(op, op->hat, op->hat, f);
        scale_field(op, -op->share, n, f);
    } else {
        ph_i_stencil_divergence(op->stencil, op->e, -op->share, false, op->pad, f);
    }
    if (!op->nsub) return;
    memset(op->u, 0, sizeof(double) * (size_t)n);
    add_subpoints(op, op->u, macro, -1.0, f);
}

void ph_i_operator_pull(ph_operator *op, const double *sigma, const uint8_t *region,
                        double *f)
{
    if (op->bonds)
        ph_i_bondlist_pull(op->bonds, sigma, region, f);
    else
        ph_i_cells_pull(&op->cells, sigma, region, f);
}

void ph_i_operator_strain(ph_operator *op, const double *u, const double *macro,
                          double *strain)
{
    const ph_layout *l = &op->layout;
    if (op->has_cells) {
        ph_i_cells_strain(&op->cells, u, macro, strain);
        return;
    }
    if (op->bonds) {
        ph_i_bondlist_strain(op->bonds, u, macro, strain);
        return;
    }
    if (op->stencil) {
        ph_i_stencil_strain(op->stencil, u, macro, op->pad, strain);
        return;
    }
    ph_i_operator_forward(op, u, op->hat);
    ph_i_convolution_strain(&op->convolution, op->hat, 1.0 / (double)l->cells, strain);
    for (int i = 0; macro && i < l->ns; i++)
        for (ptrdiff_t x = 0; x < l->cells; x++)
            strain[i * l->cells + x] += macro[i];
}

ph_status ph_i_operator_fields(ph_operator *op, const double *u, const double *macro,
                               double *strain, double *stress, ph_error *err)
{
    if (op->springs)
        return ph_i_springs_fields(op->springs, u, macro, stress, strain, NULL, err);
    ph_i_operator_strain(op, u, macro, strain);
    ph_i_hooke_field(op->map, op->threads, strain, stress);
    return PH_OK;
}

/* The strain of a periodic box is the macro strain; over a part of it, its nodes' mean. */
static ph_status sum_springs(ph_operator *op, const double *u, const double *macro,
                             const uint8_t *region, double *stress, double *strain,
                             ph_cell_energy *energy, ph_error *err)
{
    ph_status st = PH_OK;
    const ptrdiff_t n = op->layout.cells;
    const int ns = op->layout.ns;
    double *s = NULL, *e = NULL, *w = NULL;
    PH_DOUBLES(s, op->meter, (size_t)(ns * n), "the stress field");
    PH_DOUBLES(w, op->meter, (size_t)n, "the energy");
    if (region) PH_DOUBLES(e, op->meter, (size_t)(ns * n), "the strain field");
    PH_TRY(ph_i_springs_fields(op->springs, u, macro, s, e, w, err));
    memset(energy, 0, sizeof *energy);
    for (int i = 0; i < ns; i++) {
        stress[i] = 0.0;
        strain[i] = e ? 0.0 : (double)n * (macro ? macro[i] : 0.0);
    }
    for (ptrdiff_t x = 0; x < n; x++) {
        if (region && !region[x]) continue;
        energy->mean += w[x];
        for (int i = 0; i < ns; i++) {
            stress[i] += s[i * n + x];
            if (e) strain[i] += e[i * n + x];
        }
    }
out:
    ph_i_doubles_free(op->meter, &s, (size_t)(ns * n));
    ph_i_doubles_free(op->meter, &e, (size_t)(ns * n));
    ph_i_doubles_free(op->meter, &w, (size_t)n);
    return st;
}

/* Sums of a strain field [ns][cells]; adds share times stress, strain, energy. */
static void sum_field(const ph_operator *op, const double *e, const uint8_t *region,
                      double share, double *stress, double *strain, double *energy)
{
    const ph_layout *l = &op->layout;
    for (ptrdiff_t x = 0; x < l->cells; x++) {
        if (region && !region[x]) continue;
        double v[6], s[6];
        for (int i = 0; i < l->ns; i++)
            v[i] = e[i * l->cells + x];
        ph_i_hooke(op->map, op->map->index[x], v, s);
        for (int i = 0; i < l->ns; i++) {
            stress[i] += share * s[i];
            strain[i] += share * v[i];
            *energy += share * s[i] * v[i];
        }
    }
}

ph_status ph_i_operator_sums(ph_operator *op, const double *u, const double *macro,
                             const uint8_t *region, double *stress, double *strain,
                             ph_cell_energy *energy, ph_error *err)
{
    const ph_layout *l = &op->layout;
    if (op->springs)
        return sum_springs(op, u, macro, region, stress, strain, energy, err);
    if (op->has_cells) {
        ph_i_cells_sums(&op->cells, u, macro, region, stress, strain, energy);
    } else if (op->bonds) {
        ph_i_bondlist_sums(op->bonds, u, macro, region, stress, strain, energy);
    } else {
        memset(energy, 0, sizeof *energy);
        for (int i = 0; i < l->ns; i++)
            stress[i] = strain[i] = 0.0;
        ph_i_operator_strain(op, u, macro, op->e);
        sum_field(op, op->e, region, op->share, stress, strain, &energy->mean);
        for (int i = 0; i < op->nsub; i++) {
            ph_i_stencil_strain(op->sub[i], u, macro, op->pad, op->e);
            sum_field(op, op->e, region, (1.0 - op->share) / op->nsub, stress, strain,
                      &energy->modes);
        }
    }
    if (!op->spectral) return PH_OK;
    ph_i_operator_forward(op, u, op->hat);
    ptrdiff_t row = ph_i_fft_row(op->fft);
    for (int a = 0; a < l->nd; a++)
        for (ptrdiff_t k = 0; k < op->modes; k++) {
            const double *z = op->hat + 2 * (a * op->modes + k);
            ptrdiff_t c = k % row;
            double w = c == 0 || (l->n[2] % 2 == 0 && c == row - 1) ? 1.0 : 2.0;
            energy->stabilisation +=
                w * op->spectral[k] * (z[0] * z[0] + z[1] * z[1]) / (double)l->cells;
        }
    return PH_OK;
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

/* ---- symbol of the homogeneous medium ------------------------------------------------- */

/* P += weight * N_d^T C0 N_e Q_de, with Q the real part of conj(g_d) g_e. */
static void add_symbol(const ph_operator *op, double elasticity[3][3][3][3],
                       double Q[3][3], double weight, ptrdiff_t k, double *P)
{
    int nd = op->layout.nd;
    static const int place3[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
    static const int place2[2][2] = {{0, 2}, {2, 1}};
    for (int i = 0; i < nd; i++)
        for (int j = i; j < nd; j++) {
            double p = 0.0;
            for (int d = 0; d < 3; d++)
                for (int e = 0; e < 3; e++)
                    p += elasticity[i][d][j][e] * Q[d][e];
            int at = nd == 3 ? place3[i][j] : place2[i][j];
            P[at * op->modes + k] += weight * p;
        }
}

static void full_tensor(const ph_sym4 *c, double t[3][3][3][3])
{
    static const int place3[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
    static const int place2[2][2] = {{0, 2}, {2, 1}};
    int nd = c->n == 6 ? 3 : 2;
    memset(t, 0, sizeof(double) * 81);
    for (int i = 0; i < nd; i++)
        for (int j = 0; j < nd; j++)
            for (int k = 0; k < nd; k++)
                for (int m = 0; m < nd; m++) {
                    int a = nd == 3 ? place3[i][j] : place2[i][j];
                    int b = nd == 3 ? place3[k][m] : place2[k][m];
                    t[i][j][k][m] =
                        c->m[a][b] * (i == j ? 1.0 : R2_HALF) * (k == m ? 1.0 : R2_HALF);
                }
}

/* Corner cells: |symbols| of the modes are products of sines and cosines of k/2; modes of
 * one energy term share their phase, so that only the moduli matter. */
static void add_cells_symbol(const ph_operator *op, double elasticity[3][3][3][3],
                             double *P)
{
    const ph_layout *l = &op->layout;
    const ph_cells *c = &op->cells;
    ptrdiff_t row = ph_i_fft_row(op->fft);
    const double pi = 3.14159265358979323846;
#pragma omp parallel for num_threads(op->threads) schedule(static)
    for (ptrdiff_t m = 0; m < op->modes; m++) {
        ptrdiff_t at[3] = {m / row / l->n[1], m / row % l->n[1], m % row};
        double sn[3] = {0, 0, 0}, cs[3] = {1, 1, 1}, Q[3][3], g[3];
        for (int a = 0; a < 3; a++) {
            if (l->axis[a] < 0) continue;
            double half = pi * (double)at[a] / (double)l->n[a];
            sn[l->axis[a]] = 2.0 * sin(half);
            cs[l->axis[a]] = 2.0 * cos(half);
        }
        for (int mode = 0; mode < 8; mode++) { /* bit d: the mode is linear along d */
            int linear = (mode & 1) + (mode >> 1 & 1) + (mode >> 2 & 1);
            double w = linear == 0   ? 1.0
                       : linear == 1 ? c->c1
                       : linear == 2 ? c->c2
                                     : 0.0;
            if (w == 0.0) continue;
            for (int d = 0; d < 3; d++) {
                g[d] = (mode >> d & 1) ? 0.0 : c->f[d] * sn[d];
                for (int e = 0; e < 3; e++)
                    if (e != d) g[d] *= (mode >> e & 1) ? sn[e] : cs[e];
            }
            for (int d = 0; d < 3; d++)
                for (int e = 0; e < 3; e++)
                    Q[d][e] = g[d] * g[e];
            add_symbol(op, elasticity, Q, w, m, P);
        }
        if (c->hourglass == 0.0) continue;
        double all = 1.0, one = 1.0, grad = 0.0;
        for (int d = 0; d < 3; d++)
            one *= cs[d] * cs[d];
        for (int d = 0; d < 3; d++)
            all *= cs[d] * cs[d] + sn[d] * sn[d];
        for (int d = 0; d < 3; d++) {
            double v = sn[d] * sn[d];
            for (int e = 0; e < 3; e++)
                if (e != d) v *= cs[e] * cs[e];
            grad += v;
        }
        for (int a = 0; a < l->nd; a++)
            P[a * op->modes + m] += c->hourglass * (all - one - grad);
    }
}

static ph_status add_stencil_symbol(ph_operator *op, double elasticity[3][3][3][3],
                                    ptrdiff_t count, const int (*offset)[3],
                                    const double (*g)[3], double weight, double *P,
                                    ph_error *err)
{
    ph_status st = PH_OK;
    const ph_layout *l = &op->layout;
    double *hat[3] = {NULL, NULL, NULL};
    for (int a = 0; a < 3; a++) {
        int d = l->axis[a];
        if (d < 0) continue;
        PH_DOUBLES(hat[d], op->meter, (size_t)(2 * op->modes), "a gradient symbol");
        ph_i_gradient_symbol(op->fft, l, count, offset, g, d, op->f, hat[d]);
    }
#pragma omp parallel for num_threads(op->threads) schedule(static)
    for (ptrdiff_t k = 0; k < op->modes; k++) {
        double Q[3][3] = {{0}};
        for (int d = 0; d < 3; d++)
            for (int e = 0; e < 3; e++)
                if (hat[d] && hat[e])
                    Q[d][e] = hat[d][2 * k] * hat[e][2 * k] +
                              hat[d][2 * k + 1] * hat[e][2 * k + 1];
        add_symbol(op, elasticity, Q, weight, k, P);
    }
out:
    for (int d = 0; d < 3; d++)
        ph_i_doubles_free(op->meter, &hat[d], (size_t)(2 * op->modes));
    return st;
}

/* A stencil keeps its offsets by loop; the symbol wants them by direction. */
static ph_status add_simplex_symbol(ph_operator *op, double elasticity[3][3][3][3],
                                    const ph_stencil *s, double weight, double *P,
                                    ph_error *err)
{
    int offset[4][3] = {{0}};
    for (ptrdiff_t b = 0; b < s->count; b++)
        for (int a = 0; a < 3; a++)
            if (op->layout.axis[a] >= 0) offset[b][op->layout.axis[a]] = s->offset[b][a];
    return add_stencil_symbol(op, elasticity, s->count, (const int(*)[3])offset,
                              (const double(*)[3])s->g, weight, P, err);
}

ph_status ph_i_operator_symbol(ph_operator *op, const ph_sym4 *C0, double *P,
                               ph_error *err)
{
    ph_status st = PH_OK;
    double elasticity[3][3][3][3];
    int nd = op->layout.nd;
    if (op->springs) /* any multiple is as good a preconditioner */
        return ph_i_springs_symbol(op->springs, C0->m[0][0], P, err);
    full_tensor(C0, elasticity);
    memset(P, 0, sizeof(double) * (size_t)(nd * (nd + 1) / 2 * op->modes));
    if (op->has_cells)
        add_cells_symbol(op, elasticity, P);
    else
        PH_TRY(add_stencil_symbol(op, elasticity, op->family->count,
                                  (const int(*)[3])op->family->offset,
                                  (const double(*)[3])op->family->g, op->share, P, err));
    for (int i = 0; i < op->nsub; i++)
        PH_TRY(add_simplex_symbol(op, elasticity, op->sub[i],
                                  (1.0 - op->share) / op->nsub, P, err));
    for (int a = 0; op->spectral && a < nd; a++)
        for (ptrdiff_t k = 0; k < op->modes; k++)
            P[a * op->modes + k] += op->spectral[k];
out:
    return st;
}
