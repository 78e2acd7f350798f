/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Directions and sizes of one filler from its random numbers. */
#include "core/check.h"
#include "fillers.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_sf_ellint.h>

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

double ph_i_dot3(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

void ph_i_cross3(const double a[3], const double b[3], double c[3])
{
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

void ph_i_frame_about(const double axis[3], double roll, double frame[3][3])
{
    int across = 0;
    double u[3], w[3], length = 0;
    for (int a = 1; a < 3; a++)
        if (fabs(axis[a]) < fabs(axis[across]) - 1e-12) across = a;
    for (int a = 0; a < 3; a++) {
        u[a] = (a == across) - axis[across] * axis[a];
        length += u[a] * u[a];
    }
    for (int a = 0; a < 3; a++)
        u[a] /= sqrt(length);
    ph_i_cross3(axis, u, w);
    for (int a = 0; a < 3; a++) {
        frame[0][a] = axis[a];
        frame[1][a] = cos(roll) * u[a] + sin(roll) * w[a];
        frame[2][a] = cos(roll) * w[a] - sin(roll) * u[a];
    }
}

/* Eigenvectors (columns of q) and eigenvalues of a symmetric 3 x 3 matrix, by Jacobi. */
static void eigen(const double m[9], double value[3], double q[9])
{
    double a[9];
    memcpy(a, m, sizeof a);
    for (int i = 0; i < 9; i++)
        q[i] = i % 4 == 0;
    for (int sweep = 0; sweep < 50; sweep++)
        for (int i = 0; i < 2; i++)
            for (int j = i + 1; j < 3; j++) {
                if (a[3 * i + j] == 0) continue;
                double t = 0.5 * atan2(2 * a[3 * i + j], a[4 * j] - a[4 * i]);
                double c = cos(t), s = sin(t);
                for (int k = 0; k < 3; k++) {
                    double x = a[3 * k + i], y = a[3 * k + j];
                    a[3 * k + i] = c * x - s * y;
                    a[3 * k + j] = s * x + c * y;
                    x = q[3 * k + i], y = q[3 * k + j];
                    q[3 * k + i] = c * x - s * y;
                    q[3 * k + j] = s * x + c * y;
                }
                for (int k = 0; k < 3; k++) {
                    double x = a[3 * i + k], y = a[3 * j + k];
                    a[3 * i + k] = c * x - s * y;
                    a[3 * j + k] = s * x + c * y;
                }
                a[3 * i + j] = a[3 * j + i] = 0;
            }
    for (int i = 0; i < 3; i++)
        value[i] = a[4 * i];
}

/* Covariance b whose normalised Gaussian has the second moments m. In 2D b_i ~ m_i^2
 * exactly; in 3D the moments are E_i = R_D(x_j, x_k, x_i) / (3 sqrt(b_1 b_2 b_3)), x = 1 / b
 * [Tyler1987; Carlson1995], and b follows by fixed point. */
static void covariance(const double m[3], int dim, double b[3])
{
    for (int i = 0; i < 3; i++)
        b[i] = fmax(m[i] * m[i], 1e-10);
    if (dim == 2) return;
    for (int step = 0; step < 400; step++) {
        double x[3], root = sqrt(b[0] * b[1] * b[2]), worst = 0, largest = 0;
        for (int i = 0; i < 3; i++)
            x[i] = 1 / b[i];
        for (int i = 0; i < 3; i++) {
            double E =
                gsl_sf_ellint_RD(x[(i + 1) % 3], x[(i + 2) % 3], x[i], GSL_PREC_DOUBLE) /
                (3 * root);
            worst = fmax(worst, fabs(E - m[i]));
            b[i] *= fmax(m[i], 1e-6) / E;
            largest = fmax(largest, b[i]);
        }
        for (int i = 0; i < 3; i++)
            b[i] = fmax(b[i] / largest, 1e-10);
        if (worst < 1e-9) break;
    }
}

void ph_i_tensor_map(const ph_filler *f, int dim, double map[9])
{
    double value[3], q[9], b[3];
    memset(map, 0, 9 * sizeof *map);
    if (f->orientation != PH_ORIENT_TENSOR) return;
    eigen(f->tensor, value, q);
    if (dim == 2) value[2] = 0;
    covariance(value, dim, b);
    for (int i = 0; i < dim; i++)
        for (int k = 0; k < 3; k++)
            map[3 * k + i] = q[3 * k + i] * sqrt(b[i]);
}

/* Cosine of the angle to the axis, on the sphere. */
static double fisher_cosine(double kappa, double u)
{
    if (kappa < 1e-8) return 2 * u - 1;
    return 1 + log(u + (1 - u) * exp(-2 * kappa)) / kappa;
}

/* Angle on the circle: rejection of Best and Fisher [Best1979]. */
static double mises_angle(double kappa, ph_random *r)
{
    if (kappa < 1e-8) return 2 * pi * ph_random_uniform(r);
    double tau = 1 + sqrt(1 + 4 * kappa * kappa);
    double rho = (tau - sqrt(2 * tau)) / (2 * kappa), s = (1 + rho * rho) / (2 * rho);
    for (;;) {
        double z = cos(pi * ph_random_uniform(r)), w = (1 + s * z) / (s + z);
        double c = kappa * (s - w), u = ph_random_uniform(r);
        if (c * (2 - c) - u > 0 || log(c / u) + 1 - c >= 0)
            return (ph_random_uniform(r) < 0.5 ? -1 : 1) * acos(fmin(fmax(w, -1), 1));
    }
}

static void about(const double axis[3], double angle, double azimuth, int dim,
                  double out[3])
{
    double f[3][3];
    if (dim == 2) {
        double c = cos(angle), s = sin(angle);
        out[0] = c * axis[0] - s * axis[1];
        out[1] = s * axis[0] + c * axis[1];
        out[2] = 0;
        return;
    }
    ph_i_frame_about(axis, azimuth, f);
    for (int a = 0; a < 3; a++)
        out[a] = cos(angle) * f[0][a] + sin(angle) * f[1][a];
}

void ph_i_draw_direction(const ph_filler *f, const double map[9], int dim, ph_random r,
                         double out[3])
{
    double axis[3] = {1, 0, 0};
    r.draw = DRAW_DIRECTION;
    switch (f->orientation) {
    case PH_ORIENT_UNIFORM: {
        double a = 2 * pi * ph_random_uniform(&r), z = 2 * ph_random_uniform(&r) - 1;
        double rho = dim == 3 ? sqrt(1 - z * z) : 1;
        out[0] = rho * cos(a);
        out[1] = rho * sin(a);
        out[2] = dim == 3 ? z : 0;
        return;
    }
    case PH_ORIENT_ALIGNED: {
        double angle = f->spread * pi / 180 * ph_random_normal(&r);
        about(f->axis, angle, 2 * pi * ph_random_uniform(&r), dim, out);
        return;
    }
    case PH_ORIENT_VON_MISES: {
        double angle =
            dim == 2
                ? mises_angle(f->concentration, &r)
                : acos(fmin(
                      fmax(fisher_cosine(f->concentration, ph_random_uniform(&r)), -1),
                      1));
        about(f->axis, angle, 2 * pi * ph_random_uniform(&r), dim, out);
        return;
    }
    case PH_ORIENT_TENSOR: {
        double g[3] = {0}, n = 0;
        for (int a = 0; a < dim; a++)
            g[a] = ph_random_normal(&r);
        for (int a = 0; a < 3; a++) {
            axis[a] = ph_i_dot3(&map[3 * a], g);
            n += axis[a] * axis[a];
        }
        for (int a = 0; a < 3; a++)
            out[a] = axis[a] / sqrt(n);
        return;
    }
    }
    memcpy(out, axis, sizeof axis);
}

static double quantity(const ph_distribution *d, ph_random r, uint64_t draw)
{
    r.draw = draw;
    return d->kind < 0 ? (double)NAN : ph_distribution_quantile(d, ph_random_uniform(&r));
}

static void draw_frame(const ph_filler *f, const double map[9], int dim, ph_random r,
                       ph_placed *x)
{
    double d[3], frame[3][3];
    ph_i_draw_direction(f, map, dim, r, d);
    if (dim == 2) {
        double flat[3][3] = {{d[0], d[1], 0}, {-d[1], d[0], 0}, {0, 0, 1}};
        memcpy(x->frame, flat, sizeof flat);
        return;
    }
    r.draw = DRAW_ROLL;
    ph_i_frame_about(d, 2 * pi * ph_random_uniform(&r), frame);
    bool sheet = strcmp(f->shape, "platelet") == 0; /* d is its normal: second row */
    for (int i = 0; i < 3; i++)
        memcpy(x->frame[sheet ? (i + 1) % 3 : i], frame[i], sizeof frame[i]);
}

void ph_i_drop_filler(ph_packing *p)
{
    const ph_placed *x = &p->filler[--p->n];
    p->nsolids = x->first;
    p->npoints = x->first_point;
}

static ph_counting counting_of(const ph_i_generator *g, const ph_filler *f, int k,
                               const ph_placed *x)
{
    ph_counting *c = &g->p->kind[k].counting;
    if (*c == PH_COUNT_AUTO) {
        bool thin = x->thickness < g->spacing && strcmp(f->shape, "particle") != 0;
        *c = f->counting != PH_COUNT_AUTO ? f->counting
             : thin                       ? PH_COUNT_NODES
                                          : PH_COUNT_AREA;
        if (strcmp(f->shape, "particle") == 0) *c = PH_COUNT_AREA;
    }
    return *c;
}

ph_status ph_i_draw_filler(ph_i_generator *g, int k, const double map[9], uint64_t number,
                           ph_error *err)
{
    ph_status st = PH_OK;
    ph_packing *p = g->p;
    const ph_filler *f = &g->c->fillers[k];
    ph_random r = {g->c->seed, g->c->realisation, OBJECT_KIND(k) | number, 0};
    void *array = p->filler;
    st = ph_i_grow(&array, p->n, &g->fillers_held, sizeof *p->filler, "fillers", err);
    p->filler = array;
    if (st != PH_OK) return st;
    ph_placed *x = &p->filler[p->n++];
    *x = (ph_placed){
        .kind = k, .number = number, .first = p->nsolids, .first_point = p->npoints};
    double ratio = quantity(&f->aspect_ratio, r, DRAW_LENGTH);
    if (strcmp(f->shape, "particle") == 0) {
        x->thickness = quantity(&f->size, r, DRAW_THICKNESS);
        x->length = x->thickness * (isnan(ratio) ? 1 : ratio);
    } else {
        x->thickness = quantity(&f->thickness, r, DRAW_THICKNESS);
        x->length =
            isnan(ratio) ? quantity(&f->length, r, DRAW_LENGTH) : ratio * x->thickness;
    }
    x->width = quantity(&f->width, r, DRAW_WIDTH);
    if (isnan(x->width)) x->width = x->length;
    x->bend = quantity(&f->bend, r, DRAW_BEND);
    draw_frame(f, map, p->dimensions, r, x);
    PH_TRY(ph_i_shape_filler(g, counting_of(g, f, k, x), r, err));
out:
    return st;
}
