/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Generalised self-consistent scheme: an inclusion in a shell of matrix in the effective
 * medium. Christensen and Lo 1979; all moduli but one are those of the composite spheres
 * (cylinders) assemblage, which the Mori-Tanaka formula of two phases gives. */
#include "effective/composite.h"

#include <math.h>

const char *ph_i_generalised_self_consistent_refuses(const ph_composite *composite)
{
    const char *matrix = ph_i_matrix_refusal(composite);
    if (matrix) return matrix;
    if (composite->shape != PH_SHAPE_SPHERE && composite->shape != PH_SHAPE_CYLINDER)
        return "only for spheres and cylinders";
    if (composite->n != 2) return "only for one inclusion phase";
    if (!ph_i_all_isotropic(composite)) return "phases must be isotropic";
    return NULL;
}

/* Positive root of a x^2 + 2 b x + c = 0, without cancellation. */
static double positive_root(double a, double b, double c)
{
    double q = -(b + copysign(sqrt(b * b - a * c), b));
    return fmax(q / a, c / q);
}

/* Shear modulus of spheres over that of the matrix: r = G1/G0, Poisson ratios. */
static double sphere_shear(double r, double nu1, double nu0, double f)
{
    if (r == 0.0) nu1 = 0.0; /* a void has none; it drops out */
    const double d = r - 1.0;
    const double e1 =
        (49 - 50 * nu1 * nu0) * d + 35 * r * (nu1 - 2 * nu0) + 35 * (2 * nu1 - nu0);
    const double e2 = 5 * nu1 * (r - 8) + 7 * (r + 4);
    const double e3 = r * (8 - 10 * nu0) + (7 - 5 * nu0);
    const double f73 = pow(f, 7.0 / 3.0), f53 = pow(f, 5.0 / 3.0), f103 = f73 * f;
    const double middle = 2 * (63 * d * e2 + 2 * e1 * e3) * f73 - 252 * d * e2 * f53;
    const double a = 8 * d * (4 - 5 * nu0) * e1 * f103 - middle -
                     50 * d * (7 - 12 * nu0 + 8 * nu0 * nu0) * e2 * f +
                     4 * (7 - 10 * nu0) * e2 * e3;
    const double b = -2 * d * (1 - 5 * nu0) * e1 * f103 + middle +
                     75 * d * (3 - nu0) * nu0 * e2 * f + 1.5 * (15 * nu0 - 7) * e2 * e3;
    const double c = 4 * d * (5 * nu0 - 7) * e1 * f103 - middle +
                     25 * d * (nu0 * nu0 - 7) * e2 * f - (7 + 5 * nu0) * e2 * e3;
    return positive_root(a, b, c);
}

/* Transverse shear modulus of fibres over that of the matrix; e = 3 - 4 nu in plane strain,
 * 1 + 2 G/k with the plane bulk modulus k in either plane kinematics. */
static double fibre_shear(double r, double e1, double e0, double f)
{
    const double d = r - 1.0, f3 = f * f * f;
    const double near = r + e1, jump = r * e0 - e1;
    const double common = 3 * f * (1 - f) * (1 - f) * d * near;
    const double shell = e0 * r + d * f + 1.0;
    const double a =
        common + (r * e0 + e1 * e0 - jump * f3) * (f * e0 * d - (r * e0 + 1));
    const double b = -common + 0.5 * shell * ((e0 - 1) * near - 2 * jump * f3) +
                     0.5 * f * (e0 + 1) * d * (near + jump * f3);
    const double c = common + shell * (near + jump * f3);
    return positive_root(a, b, c);
}

static double plane_bulk(const ph_sym4 *c)
{
    return 0.5 * (c->m[0][0] + c->m[0][1]);
}

ph_status ph_i_generalised_self_consistent(const ph_composite *composite, ph_sym4 *out,
                                           ph_error *err)
{
    ph_status st = PH_OK;
    ph_sym4 c0, c1, c;
    PH_TRY(ph_i_composite_check(
        composite, ph_i_generalised_self_consistent_refuses(composite), err));
    PH_TRY(ph_i_mori_tanaka(composite, &c, err));
    PH_TRY(ph_i_phase_stiffness(composite, 0, &c0, err));
    PH_TRY(ph_i_phase_stiffness(composite, 1, &c1, err));
    const int last = c.n - 1;
    const double f = composite->fraction[1];
    const double G0 = 0.5 * c0.m[last][last], G1 = 0.5 * c1.m[last][last];
    if (f > 0.0 && f < 1.0 && composite->shape == PH_SHAPE_SPHERE) {
        double nu0 = ph_nearest_isotropic(&c0, PH_SPACE).nu;
        double nu1 = ph_nearest_isotropic(&c1, PH_SPACE).nu;
        double K = ph_nearest_isotropic(&c, PH_SPACE).K;
        c = ph_sym4_isotropic_kg(K, G0 * sphere_shear(G1 / G0, nu1, nu0, f));
    } else if (f > 0.0 && f < 1.0) {
        double e0 = 1.0 + 2.0 * G0 / plane_bulk(&c0);
        double e1 = G1 > 0.0 ? 1.0 + 2.0 * G1 / plane_bulk(&c1) : 1.0;
        double k = plane_bulk(&c), G = G0 * fibre_shear(G1 / G0, e1, e0, f);
        c.m[0][0] = c.m[1][1] = k + G;
        c.m[0][1] = c.m[1][0] = k - G;
        c.m[last][last] = 2.0 * G;
    }
    *out = c;
out:
    return st;
}
