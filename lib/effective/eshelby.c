/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effective/composite.h"
#include "effective/directions.h"

#include <math.h>

/* Averages over the directions n = A^-1 xi / |A^-1 xi|, xi uniform on the sphere, with
 * s = 1 - n3^2: all that Hill's tensor of an isotropic medium needs of the shape. */
typedef struct shape_moments {
    double n2, s, n4, sn, ss; /* <n3^2> <s> <n3^4> <s n3^2> <s^2> */
} shape_moments;

static const shape_moments cylinder_moments = {0.0, 1.0, 0.0, 0.0, 1.0};

/* Near the sphere, in powers of b = 1 - a^2:
 * n3^2 = t^2/(1 - b (1-t^2)), t uniform in [0,1], <t^2 (1-t^2)^k> = prod 2j/(2j+3) / 3. */
static shape_moments moments_near_sphere(double b)
{
    shape_moments m = {0};
    double c = 1.0 / 3.0, d = 1.0 / 5.0, power = 1.0;
    for (int k = 0; k < 60; k++) {
        m.n2 += power * c;
        m.n4 += power * d * (k + 1);
        power *= b;
        c *= (2.0 * k + 2.0) / (2.0 * k + 5.0);
        d *= (2.0 * k + 2.0) / (2.0 * k + 7.0);
    }
    m.s = 1.0 - m.n2;
    m.sn = m.n2 - m.n4;
    m.ss = m.s - m.sn;
    return m;
}

/* Closed forms with J = int_0^1 dt/(a^2 + b t^2); each moment in the form that keeps its
 * digits where it is small. */
static shape_moments moments(double a)
{
    const double a2 = a * a, b = (1.0 - a) * (1.0 + a);
    if (fabs(b) < 0.5) return moments_near_sphere(b);
    shape_moments m;
    double J = a < 1.0 ? acos(a) / (a * sqrt(b)) : acosh(a) / (a * sqrt(-b));
    m.n2 = (1.0 - a2 * J) / b;
    m.n4 = (1.0 + 0.5 * a2 - 1.5 * a2 * J) / (b * b);
    if (a < 1.0) {
        m.s = a2 * (J - m.n2);
        m.sn = a2 * ((J - 1.0) / (2.0 * b) - m.n4);
    } else {
        m.s = 1.0 - m.n2;
        m.sn = m.n2 - m.n4;
    }
    m.ss = m.s - m.sn;
    return m;
}

/* P = (<sym n n 1> - beta <n n n n>) / G, beta = (lambda + G)/(lambda + 2 G). */
static ph_sym4 hill_isotropic(double beta, double G, const shape_moments *m)
{
    const double m1 = 0.5 * m->s, m3 = m->n2;
    const double q11 = 0.375 * m->ss, q12 = 0.125 * m->ss, q13 = 0.5 * m->sn;
    ph_sym4 p = {.n = 6};
    p.m[0][0] = p.m[1][1] = (m1 - beta * q11) / G;
    p.m[2][2] = (m3 - beta * m->n4) / G;
    p.m[0][1] = p.m[1][0] = -beta * q12 / G;
    p.m[0][2] = p.m[2][0] = p.m[1][2] = p.m[2][1] = -beta * q13 / G;
    p.m[3][3] = p.m[4][4] = (0.5 * (m1 + m3) - 2.0 * beta * q13) / G;
    p.m[5][5] = (m1 - 2.0 * beta * q12) / G;
    return p;
}

/* The plane part of a tensor of the cylinder. */
static ph_sym4 disk(const ph_sym4 *p)
{
    ph_sym4 r = {.n = 3};
    for (int a = 0; a < 2; a++)
        for (int b = 0; b < 2; b++)
            r.m[a][b] = p->m[a][b];
    r.m[2][2] = p->m[5][5];
    return r;
}

static ph_status check_shape(const ph_sym4 *c0, ph_inclusion_shape shape, double aspect,
                             ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(c0->n == 6 || shape == PH_SHAPE_CYLINDER || shape == PH_SHAPE_LAMINATE,
             PH_EINVAL, "Hill tensor: in the plane an inclusion is a disk or a layer");
    PH_CHECK(shape != PH_SHAPE_SPHEROID || (aspect >= 1e-6 && aspect <= 1e6), PH_EINVAL,
             "Hill tensor: aspect ratio must be in [1e-6, 1e6], got %g", aspect);
    PH_CHECK(ph_sym4_is_stiffness(c0), PH_ESINGULAR,
             "Hill tensor: the medium is not positive definite");
out:
    return st;
}

static ph_status one_direction(const ph_sym4 *c0, const double n[3], double weight,
                               ph_sym4 *sum, ph_error *err)
{
    ph_status st = PH_OK;
    ph_sym4 g;
    PH_CHECK(ph_i_gamma(c0, n, &g), PH_ESINGULAR,
             "Hill tensor: the medium does not resist in direction %g %g %g", n[0], n[1],
             n[2]);
    *sum = ph_sym4_combine(1.0, sum, weight, &g);
out:
    return st;
}

/* Mean of a tensor over all turns about axis 3. */
static ph_sym4 axial_mean(const ph_sym4 *g)
{
    ph_sym4 p = {.n = 6};
    double sum = 0.25 * (g->m[0][0] + g->m[1][1]), bulk = sum + 0.5 * g->m[0][1];
    double shear = 0.5 * (sum - 0.5 * g->m[0][1] + 0.5 * g->m[5][5]);
    p.m[0][0] = p.m[1][1] = bulk + shear;
    p.m[0][1] = p.m[1][0] = bulk - shear;
    p.m[5][5] = 2.0 * shear;
    p.m[2][2] = g->m[2][2];
    p.m[0][2] = p.m[2][0] = p.m[1][2] = p.m[2][1] = 0.5 * (g->m[0][2] + g->m[1][2]);
    p.m[3][3] = p.m[4][4] = 0.5 * (g->m[3][3] + g->m[4][4]);
    return p;
}

/* Mean of Gamma over `count` directions around axis 3 that have height z to radius rho;
 * count = 1 where the caller takes the axial mean. */
static ph_status around_axis(const ph_sym4 *c0, double rho, double z, int count,
                             double weight, ph_sym4 *sum, ph_error *err)
{
    ph_status st = PH_OK;
    const double length = hypot(rho, z), step = 2.0 * acos(-1.0) / count;
    rho /= length;
    z /= length;
    for (int k = 0; k < count; k++) {
        double n[3] = {rho * cos(k * step), rho * sin(k * step), z};
        PH_TRY(one_direction(c0, n, weight / count, sum, err));
    }
out:
    return st;
}

/* The double exponential rule over t in (0, 1): resolves both ends, where the directions of
 * a flat or long spheroid crowd. */
static ph_status over_sphere(const ph_sym4 *c0, double aspect, double step, int count,
                             ph_sym4 *sum, ph_error *err)
{
    ph_status st = PH_OK;
    const double pi = acos(-1.0);
    const int half = (int)(3.6 / step);
    double total = 0.0;
    *sum = (ph_sym4){.n = 6};
    for (int k = -half; k <= half; k++) {
        double u = k * step, x = exp(-pi * sinh(u));
        double t = 1.0 / (1.0 + x), rest = x / (1.0 + x); /* rest = 1 - t, all digits */
        double weight = step * pi * cosh(u) * t * rest;
        total += weight;
        PH_TRY(
            around_axis(c0, sqrt(rest * (1.0 + t)), t / aspect, count, weight, sum, err));
    }
    *sum = ph_sym4_combine(1.0 / total, sum, 0.0, sum);
out:
    return st;
}

/* No direction in the plane 1-2 is special: then one direction gives the mean around. */
static bool transversely_isotropic(const ph_sym4 *c)
{
    const double w = 1.0, R[9] = {cos(w), -sin(w), 0, sin(w), cos(w), 0, 0, 0, 1};
    if (c->n != 6) return false;
    ph_sym4 r = ph_sym4_rotate(c, R);
    r = ph_sym4_combine(1.0, &r, -1.0, c);
    return ph_sym4_norm(&r) <= 1e-12 * ph_sym4_norm(c);
}

static ph_status quadrature(const ph_sym4 *c0, ph_inclusion_shape shape, double aspect,
                            ph_sym4 *p, ph_error *err)
{
    ph_status st = PH_OK;
    const double tolerance = 1e-12;
    const bool flat = shape == PH_SHAPE_CYLINDER;
    const bool axial = transversely_isotropic(c0);
    int count = axial ? 1 : 8;
    double step = 0.25, change = INFINITY;
    ph_sym4 last = {.n = c0->n}, now = {.n = c0->n};
    for (int level = 0; level < 8 && change > tolerance; level++) {
        now = (ph_sym4){.n = c0->n};
        if (flat)
            PH_TRY(around_axis(c0, 1.0, 0.0, count, 1.0, &now, err));
        else
            PH_TRY(over_sphere(c0, aspect, step, count, &now, err));
        if (axial) now = axial_mean(&now);
        ph_sym4 d = ph_sym4_combine(1.0, &now, -1.0, &last);
        change = ph_sym4_norm(&d) / ph_sym4_norm(&now);
        last = now;
        if (!axial) count *= 2;
        if (level < 4) step *= 0.5;
    }
    PH_CHECK(change <= 1e-8, PH_ENOCONV,
             "Hill tensor: quadrature over directions is only good to %.1g", change);
    *p = now;
out:
    return st;
}

ph_status ph_hill_tensor_quadrature(const ph_sym4 *c0, ph_inclusion_shape shape,
                                    double aspect, ph_sym4 *p, ph_error *err)
{
    PH_GIVEN(c0 && p);
    ph_status st = PH_OK;
    const double e1[3] = {1.0, 0.0, 0.0};
    PH_TRY(check_shape(c0, shape, aspect, err));
    if (shape == PH_SHAPE_LAMINATE) {
        ph_sym4 sum = {.n = c0->n};
        PH_TRY(one_direction(c0, e1, 1.0, &sum, err));
        *p = sum;
    } else {
        PH_TRY(quadrature(c0, shape, shape == PH_SHAPE_SPHEROID ? aspect : 1.0, p, err));
    }
out:
    return st;
}

ph_status ph_hill_tensor(const ph_sym4 *c0, ph_inclusion_shape shape, double aspect,
                         ph_sym4 *p, ph_error *err)
{
    PH_GIVEN(c0 && p);
    ph_status st = PH_OK;
    ph_isotropic iso = ph_nearest_isotropic(c0, PH_SPACE);
    if (shape == PH_SHAPE_LAMINATE || iso.distance > 1e-12)
        return ph_hill_tensor_quadrature(c0, shape, aspect, p, err);
    PH_TRY(check_shape(c0, shape, aspect, err));
    const double k = c0->n == 3 ? iso.K : iso.K + iso.G / 3.0; /* lambda + G */
    shape_moments m = shape == PH_SHAPE_CYLINDER ? cylinder_moments
                      : shape == PH_SHAPE_SPHERE ? moments(1.0)
                                                 : moments(aspect);
    ph_sym4 r = hill_isotropic(k / (k + iso.G), iso.G, &m);
    *p = c0->n == 3 ? disk(&r) : r;
out:
    return st;
}

ph_status ph_eshelby_tensor(const ph_sym4 *c0, ph_inclusion_shape shape, double aspect,
                            ph_sym4 *s, ph_error *err)
{
    PH_GIVEN(c0 && s);
    ph_status st = PH_OK;
    ph_sym4 p;
    PH_TRY(ph_hill_tensor(c0, shape, aspect, &p, err));
    *s = ph_sym4_product(&p, c0);
out:
    return st;
}
