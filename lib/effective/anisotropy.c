/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Numbers that say what damage has done to a stiffness. */
#include <perihom/damage.h>

#include "core/jacobi.h"
#include "effective/run.h"

#include <math.h>
#include <string.h>

/* [Li2020] as [Galadima2023] (7-1), with 1/16. C and S Mandel: C66 = C_m/2, S66 = 2 S_m. */
static double plane_index(const ph_sym4 *c, const ph_sym4 *s)
{
    double bulk = (c->m[0][0] + c->m[1][1] + 2.0 * c->m[0][1]) *
                  (s->m[0][0] + s->m[1][1] + 2.0 * s->m[0][1]) / 4.0;
    double shear = (c->m[0][0] + c->m[1][1] - 2.0 * c->m[0][1] + 2.0 * c->m[2][2]) *
                   (s->m[0][0] + s->m[1][1] - 2.0 * s->m[0][1] + 2.0 * s->m[2][2]) / 16.0;
    return sqrt((bulk - 1.0) * (bulk - 1.0) + 2.0 * (shear - 1.0) * (shear - 1.0));
}

/* Thrice the bulk part and five times twice the shear part of the isotropic projection:
 * of C they are 3 K and 2 G of Voigt's averages, of S the inverses of Reuss's. */
static void isotropic_parts(const ph_sym4 *c, double *bulk, double *shear)
{
    double sum = 0.0, trace = 0.0;
    for (int i = 0; i < 6; i++) {
        trace += c->m[i][i];
        for (int j = 0; i < 3 && j < 3; j++)
            sum += c->m[i][j];
    }
    *bulk = sum / 3.0;
    *shear = (trace - *bulk) / 5.0;
}

/* [Kube2016] */
static double space_index(const ph_sym4 *c, const ph_sym4 *s)
{
    double k, g, ik, ig;
    isotropic_parts(c, &k, &g);
    isotropic_parts(s, &ik, &ig);
    double a = log(k * ik), b = log(g * ig);
    return sqrt(a * a + 5.0 * b * b);
}

/* A stiffness below this share of the largest is what a solver leaves of nothing. */
static const double nothing = 1e-10;

static bool is_singular(const ph_sym4 *c)
{
    double least, top;
    ph_sym4_eigenvalues(c, &least, &top);
    return !(least > nothing * top);
}

void ph_i_drop_nothing(ph_sym4 *c)
{
    double a[6][6] = {{0}}, v[6][6] = {{0}}, top = 0.0;
    if (!is_singular(c)) return;
    for (int i = 0; i < c->n; i++)
        for (int j = 0; j < c->n; j++)
            a[i][j] = c->m[i][j];
    ph_i_jacobi(c->n, 6, &a[0][0], &v[0][0]);
    for (int k = 0; k < c->n; k++)
        top = fmax(top, a[k][k]);
    for (int i = 0; i < c->n; i++)
        for (int j = 0; j < c->n; j++) {
            c->m[i][j] = 0.0;
            for (int k = 0; k < c->n; k++)
                if (a[k][k] > nothing * top) c->m[i][j] += v[i][k] * v[j][k] * a[k][k];
        }
}

double ph_anisotropy_index(const ph_sym4 *c)
{
    if (!c) return NAN;
    ph_sym4 s;
    ph_error ignored = PH_ERROR_INIT;
    if (is_singular(c) || ph_sym4_inverse(c, &s, &ignored) != PH_OK) return INFINITY;
    double a = c->n == 3 ? plane_index(c, &s) : space_index(c, &s);
    return isfinite(a) ? a : (double)INFINITY;
}

double ph_axial_modulus(const ph_sym4 *c, int axis)
{
    if (!c || axis < 0 || axis >= c->n) return NAN;
    static const double blind = 1e-13; /* of the largest: strains that cost nothing */
    int n = c->n, rest = 0, at[6];
    double a[6][6] = {{0}}, v[6][6] = {{0}}, top = 0.0, E = c->m[axis][axis];
    for (int i = 0; i < n; i++)
        if (i != axis) at[rest++] = i;
    for (int i = 0; i < n; i++)
        top = fmax(top, c->m[i][i]);
    for (int i = 0; i < rest; i++)
        for (int j = 0; j < rest; j++)
            a[i][j] = c->m[at[i]][at[j]];
    ph_i_jacobi(rest, 6, &a[0][0], &v[0][0]);
    for (int k = 0; k < rest; k++) {
        double along = 0.0;
        if (a[k][k] <= blind * top) continue;
        for (int i = 0; i < rest; i++)
            along += v[i][k] * c->m[axis][at[i]];
        E -= along * along / a[k][k];
    }
    return E;
}
