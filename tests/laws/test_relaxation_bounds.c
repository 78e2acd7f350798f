/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What holds of the relaxation of every composite, on random cells: Voigt and Reuss at real
 * s, the bounds that the minimum principle of Cherkaev and Gibiansky gives for complex moduli, dissipation, C' that rises,
 * Kramers-Kronig, terms that are positive semidefinite.
 *
 * All of them hold of the discrete problem and not only of the continuous one: its stresses
 * and strains are those of quadrature points with <s:e> = <s>:<e>, and (S) is a spring whose
 * mean strain is zero. They hold of the reduced model too, which is the same problem on fewer
 * fields, whatever its tolerance; in plane stress only while no phase's Poisson's ratio moves
 * (else the strain across the plane is a field of the basis), so kinds 0 and 1 there.
 * What is left is arithmetic: 1e-9 of the largest eigenvalue. */
#include <perihom.h>

#include "check.h"
#include "core/jacobi.h"
#include "relaxing.h"

enum { MOST = 12 };
static const double arithmetic = 1e-9, pi = 3.14159265358979323846;

static void eigenvalues(int n, const double a[MOST * MOST], double *low, double *high)
{
    double d[MOST * MOST];
    memcpy(d, a, sizeof d);
    ph_i_jacobi(n, MOST, d, NULL);
    *low = INFINITY, *high = -INFINITY;
    for (int i = 0; i < n; i++) {
        *low = fmin(*low, d[i * MOST + i]);
        *high = fmax(*high, d[i * MOST + i]);
    }
}

/* a >= b but for `tolerance` of the largest eigenvalue of a */
static bool above(int n, const double *a, const double *b, double tolerance)
{
    double d[MOST * MOST] = {0}, low, high, none, scale;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            d[i * MOST + j] = a[i * MOST + j] - b[i * MOST + j];
    eigenvalues(n, d, &low, &high);
    eigenvalues(n, a, &none, &scale);
    return low >= -tolerance * scale;
}

static bool tensor_above(const ph_sym4 *a, const ph_sym4 *b, double tolerance)
{
    double x[MOST * MOST] = {0}, y[MOST * MOST] = {0};
    for (int i = 0; i < a->n; i++)
        for (int j = 0; j < a->n; j++) {
            x[i * MOST + j] = a->m[i][j];
            y[i * MOST + j] = b->m[i][j];
        }
    return above(a->n, x, y, tolerance);
}

static ph_sym4 inverse(const ph_sym4 *a)
{
    ph_error err = PH_ERROR_INIT;
    ph_sym4 b = {0};
    CHECK_OK(ph_sym4_inverse(a, &b, &err));
    return b;
}

/* C_p(s) and C_p(i omega) of the kinematics. */
static ph_sym4 phase_at(const ph_material *m, double s, ph_kinematics kin)
{
    ph_error err = PH_ERROR_INIT;
    ph_material at;
    ph_sym4 c = {0};
    CHECK_OK(ph_material_at(m, s, &at, &err));
    CHECK_OK(ph_sym4_reduce(&at.stiffness, kin, &c, &err));
    return c;
}

static void phase_complex(const ph_material *m, double omega, ph_kinematics kin,
                          ph_sym4 *re, ph_sym4 *im)
{
    ph_error err = PH_ERROR_INIT;
    ph_prony *p = NULL;
    if (m->relaxation) {
        CHECK_OK(ph_prony_reduce(m->relaxation, kin, &p, &err));
        ph_prony_complex(p, omega, re, im);
        ph_prony_free(&p);
    } else {
        CHECK_OK(ph_sym4_reduce(&m->stiffness, kin, re, &err));
        *im = (ph_sym4){.n = re->n};
    }
}

/* ---- real s ---------------------------------------------------------------------------------- */

static void real_bounds(const ph_microstructure *micro, const ph_viscoelastic *v,
                        double s)
{
    ph_kinematics kin = micro->grid.kinematics;
    ph_sym4 voigt = {.n = ph_strains(kin)}, soft = voigt,
            got = ph_prony_carson(v->series, s);
    for (int p = 0; p < micro->nmaterials; p++) {
        ph_sym4 c = phase_at(&micro->materials[p], s, kin), j = inverse(&c);
        voigt = ph_sym4_combine(1.0, &voigt, v->elastic->fractions[p], &c);
        soft = ph_sym4_combine(1.0, &soft, v->elastic->fractions[p], &j);
    }
    ph_sym4 reuss = inverse(&soft);
    CHECK(tensor_above(&voigt, &got, arithmetic));
    CHECK(tensor_above(&got, &reuss, arithmetic));
}

/* ---- complex ----------------------------------------------------------------------------------- */

/* With (re + i im) e^{i theta} = B + i A, A > 0, a medium that is driven in harmonics has
 * (s'', -e'') = D (e', s'),  D = [ A + B A^-1 B   -B A^-1 ]
 *                                [   -A^-1 B        A^-1  ],
 * which is positive definite, so that e' and s' minimise the mean of (e', s').D.(e', s')
 * among compatible strains and balanced stresses of given means, and what is left is
 * D of the effective modulus [Milton2002]. Constant fields are admissible: D* <= <D>, and
 * so are the dual ones: D* >= <D^-1>^-1, which is the same bound, for D is symplectic.
 * e^{i theta} multiplies all phases and the composite alike; with 0 < theta <= pi/2 elastic
 * phases have A > 0 too. theta = pi/2 gives C'* >= <C'^-1>^-1 among others. */
static void cherkaev(const ph_sym4 *re, const ph_sym4 *im, double theta, double weight,
                     double D[MOST * MOST])
{
    const int n = re->n;
    ph_sym4 A = ph_sym4_combine(sin(theta), re, cos(theta), im),
            B = ph_sym4_combine(cos(theta), re, -sin(theta), im), inv = inverse(&A),
            BA = ph_sym4_product(&B, &inv), BAB = ph_sym4_product(&BA, &B);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            D[i * MOST + j] += weight * (A.m[i][j] + 0.5 * (BAB.m[i][j] + BAB.m[j][i]));
            D[i * MOST + n + j] -= weight * BA.m[i][j];
            D[(n + j) * MOST + i] -= weight * BA.m[i][j];
            D[(n + i) * MOST + n + j] += weight * inv.m[i][j];
        }
}

static void complex_bounds(const ph_microstructure *micro, const double *fractions,
                           double omega, const ph_sym4 *storage, const ph_sym4 *loss,
                           double tolerance)
{
    static const double theta[] = {0.02, 0.3, 0.785398163, 1.570796326};
    for (size_t k = 0; k < sizeof theta / sizeof *theta; k++) {
        double mean[MOST * MOST] = {0}, effective[MOST * MOST] = {0};
        for (int p = 0; p < micro->nmaterials; p++) {
            ph_sym4 re, im;
            phase_complex(&micro->materials[p], omega, micro->grid.kinematics, &re, &im);
            cherkaev(&re, &im, theta[k], fractions[p], mean);
        }
        cherkaev(storage, loss, theta[k], 1.0, effective);
        CHECK(above(2 * storage->n, mean, effective, tolerance));
    }
}

/* C'(w) = C_inf + 2/pi P int C''(x) w^2 / (x (w^2 - x^2)) dx; with x = w e^u the midpoint rule
 * about u = 0 takes the principal value, and converges like exp(-pi^2/h), the strip of
 * analyticity of C''(w e^u) being |Im u| < pi/2: h = 1/4, 1e-17. */
static void kramers_kronig(const ph_prony *p, double omega)
{
    const double h = 0.25;
    ph_sym4 sum = {.n = p->equilibrium.n}, re, im, up, down;
    for (int k = 0; k < 240; k++) { /* to u = 60: e^-60 of what is left */
        double u = h * (k + 0.5), x = exp(-2 * u);
        ph_prony_complex(p, omega * exp(u), &re, &up);
        ph_prony_complex(p, omega * exp(-u), &re, &down);
        ph_sym4 add = ph_sym4_combine(1 / (1 - x), &down, -x / (1 - x), &up);
        sum = ph_sym4_combine(1.0, &sum, h, &add);
    }
    ph_prony_complex(p, omega, &re, &im);
    ph_sym4 want = ph_sym4_combine(1.0, &p->equilibrium, 2 / pi, &sum);
    CHECK(off(&re, &want) < arithmetic);
}

/* 0 <= C_m, C_inf; 0 <= C''; C_inf <= C' <= C(0), and rises. */
static void laws_of_series(const ph_prony *p, int n, const double *omega)
{
    ph_sym4 zero = {.n = p->equilibrium.n}, last = p->equilibrium, re, im,
            first = ph_prony_instantaneous(p);
    for (int m = 0; m < p->nterms; m++) /* against its own largest eigenvalue */
        CHECK(tensor_above(&p->term[m].stiffness, &zero, arithmetic));
    CHECK(tensor_above(&p->equilibrium, &zero, arithmetic));
    for (int k = 0; k < n; k++) {
        ph_prony_complex(p, omega[k], &re, &im);
        CHECK(tensor_above(&im, &zero, arithmetic));
        CHECK(tensor_above(&re, &last, arithmetic));
        CHECK(tensor_above(&first, &re, arithmetic));
        last = re;
    }
}

static ph_microstructure *random_cell(uint64_t *seed, ph_kinematics kin)
{
    int kinds[3], most = kin == PH_PLANE_STRESS ? 2 : 4;
    for (int i = 0; i < 3; i++)
        kinds[i] = (int)(most * check_random(seed));
    double contrast = pow(10.0, check_uniform(seed, -1.5, 1.5));
    return blocks_cell(seed, kin, kin == PH_SPACE ? 3 : 6, kinds, contrast, 6.0, 3,
                       false);
}

enum { FREQUENCIES = 6 };
static const double omegas[FREQUENCIES] = {1e-4, 1e-2, 0.3, 2.0, 50.0, 1e4};

static void reduced_models_keep_the_laws(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int k = 0; k < 4; k++)
        for (int trial = 0; trial < check_trials(2); trial++) {
            ph_error err = PH_ERROR_INIT;
            ph_microstructure *micro = random_cell(&seed, (ph_kinematics)k);
            ph_problem problem = {.micro = micro};
            if ((k + trial) % 3 == 1) problem.model.kind = "local";
            if ((k + trial) % 3 == 2) problem.model.points = PH_POINTS_NODES;
            /* whatever the tolerance: a rough model keeps them as well */
            ph_relaxation_params params = {.tolerance = trial % 2 ? 1e-2 : 1e-5};
            ph_viscoelastic *v = NULL;
            CHECK_OK(ph_viscoelastic_solve(&problem, &params, &one_thread, &v, &err));
            for (int i = 0; v && i < FREQUENCIES; i++) {
                ph_sym4 re, im;
                ph_prony_complex(v->series, omegas[i], &re, &im);
                real_bounds(micro, v, omegas[i]);
                complex_bounds(micro, v->elastic->fractions, omegas[i], &re, &im,
                               arithmetic);
                kramers_kronig(v->series, omegas[i]);
            }
            if (v) laws_of_series(v->series, FREQUENCIES, omegas);
            ph_viscoelastic_free(&v);
            ph_microstructure_free(&micro);
        }
    CHECK_END();
}

/* Complex problems of their own, which know of no series; solved to 1e-2 of the tolerance. */
static void complex_solutions_keep_the_bounds(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int k = 0; k < 4; k++) {
        ph_error err = PH_ERROR_INIT;
        ph_microstructure *micro = random_cell(&seed, (ph_kinematics)k);
        ph_relaxation_params params = {
            .route = "frequency", .tolerance = 1e-6, .omega = omegas + 1, .nomega = 4};
        ph_viscoelastic *v = NULL;
        CHECK_OK(ph_viscoelastic_solve(&(ph_problem){.micro = micro}, &params,
                                       &one_thread, &v, &err));
        for (int i = 0; v && i < v->ndynamic; i++) {
            const ph_dynamic_value *d = &v->dynamic[i];
            complex_bounds(micro, v->elastic->fractions, d->omega, &d->storage, &d->loss,
                           1e-6);
            ph_sym4 zero = {.n = d->loss.n};
            CHECK(tensor_above(&d->loss, &zero, 1e-6));
            if (i > 0) CHECK(tensor_above(&d->storage, &v->dynamic[i - 1].storage, 1e-6));
        }
        ph_viscoelastic_free(&v);
        ph_microstructure_free(&micro);
    }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reduced_models_keep_the_laws),
        cmocka_unit_test(complex_solutions_keep_the_bounds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
