/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The split of phases into functions, and the poles of reduced models made of random Gram
 * matrices. */
#include "check.h"
#include "effective/visco_model.h"
#include "relaxing.h"

enum { NS = 3, NB = 7, TERMS = 4 };

static void phases_are_their_functions(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    static const int functions[] = {1, 2,
                                    3}; /* const; E: one more; bulk and shear: two */
    for (int kind = 0; kind < 4; kind++) {
        ph_error err = PH_ERROR_INIT;
        ph_material m[2] = {random_phase("a", &seed, kind, 2.0, (double)NAN, 0.1, 12.0),
                            isotropic("b", 1.0, 0.2)};
        ph_split split;
        CHECK_OK(ph_i_split_new(2, m, &split, &err));
        if (kind < 3) CHECK(split.nfunctions == functions[kind]);
        for (int i = -8; i <= 8; i++) {
            double s = pow(10.0, i);
            ph_sym4 c = ph_i_split_at(&split, 0, s),
                    want = m[0].relaxation ? ph_prony_carson(m[0].relaxation, s)
                                           : m[0].stiffness;
            CHECK(off(&c, &want) < 1e-12);
        }
        for (int q = 0; q < split.nfunctions; q++)
            CHECK_REL(ph_i_decay_at(&split.function[q], INFINITY), 1.0, 1e-14);
        ph_i_split_clear(&split);
        for (int p = 0; p < 2; p++)
            ph_material_clear(&m[p]);
    }
    CHECK_END();
}

static ph_decay random_decay(uint64_t *seed, double rest, double decades, double *time,
                             double *weight)
{
    for (int t = 0; t < TERMS; t++) {
        time[t] = pow(10.0, decades * ((t + check_random(seed)) / TERMS - 0.5));
        weight[t] = (1.0 - rest) / TERMS;
    }
    return (ph_decay){rest, TERMS, time, weight};
}

/* K_q = A A^T of `rank` random columns. */
static void random_gram(uint64_t *seed, ph_reduced *m, int q, int rank)
{
    for (int k = 0; k < rank; k++) {
        double a[NS + NB];
        for (int i = 0; i < m->n; i++)
            a[i] = check_uniform(seed, -1, 1);
        for (int i = 0; i < m->n; i++)
            for (int j = 0; j <= i; j++)
                ph_i_reduced_add(m, q, i, j, a[i] * a[j]);
    }
}

/* The series is the model at every s: to 1e-11 of the tensor there, over the decades of its
 * times and beyond, whatever they span. */
static void poles_are_exact(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    static const double decades[] = {0.5, 6.0, 24.0};
    for (int d = 0; d < 3; d++)
        for (int fluid = 0; fluid < 3; fluid++) {
            ph_error err = PH_ERROR_INIT;
            double time[3][TERMS], weight[3][TERMS];
            ph_decay f[3];
            ph_reduced m;
            ph_prony *series = NULL;
            for (int q = 0; q < 3; q++) /* rest; all flow; all but one of low rank flow */
                f[q] = random_decay(&seed, fluid == 0 || (fluid == 2 && q == 0) ? 0.1 : 0,
                                    decades[d], time[q], weight[q]);
            CHECK_OK(ph_i_reduced_init(&m, NS, 3, f, &err));
            CHECK_OK(ph_i_reduced_grow(&m, NB, &err));
            for (int q = 0; q < 3; q++)
                random_gram(&seed, &m, q, q == 0 ? NB + 1 : NS + NB);
            CHECK_OK(ph_i_reduced_series(&m, &series, &err));
            CHECK_OK(ph_prony_validate(series, &err));
            for (int i = 0; i <= 60; i++) {
                double s = pow(10.0, (decades[d] + 4) * (i / 60.0 - 0.5));
                ph_sym4 want, got = ph_prony_carson(series, s);
                CHECK_OK(ph_i_reduced_at(&m, s, &want, NULL, &err));
                CHECK(off(&got, &want) < 1e-11);
            }
            double low, high, top;
            ph_sym4 begin = ph_prony_instantaneous(series);
            ph_sym4_eigenvalues(&begin, &low, &top);
            ph_sym4_eigenvalues(&series->equilibrium, &low, &high);
            if (fluid == 0) CHECK(low > 1e-3 * top);
            if (fluid == 1) CHECK(high == 0.0);
            if (fluid == 2) CHECK(low < 1e-14 * top && high > 1e-3 * top);
            ph_prony_free(&series);
            ph_i_reduced_clear(&m);
        }
    CHECK_END();
}

/* A modulus a / (1 + t s) in series with one that stays: 1/C = 1/a(s) + 1/b, one pole at
 * (a_0 + b) / (a_inf + b) tau. */
static void springs_in_series(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    double tau = 3.0, weight = 0.99, rest = 0.01, a = 10.0, b = 2.0;
    ph_decay f[2] = {{1.0, 0, NULL, NULL}, {rest, 1, &tau, &weight}};
    ph_reduced m;
    ph_prony *series = NULL;
    CHECK_OK(ph_i_reduced_init(&m, NS, 2, f, &err));
    CHECK_OK(ph_i_reduced_grow(&m, 1, &err));
    /* strain e of component 0, x in the first, e - x in the second */
    ph_i_reduced_add(&m, 1, NS, NS, a);
    ph_i_reduced_add(&m, 0, NS, NS, b);
    ph_i_reduced_add(&m, 0, 0, 0, b);
    ph_i_reduced_add(&m, 0, NS, 0, -b);
    CHECK_OK(ph_i_reduced_series(&m, &series, &err));
    CHECK(series->nterms == 1);
    double late = 1 / (1 / (rest * a) + 1 / b), early = 1 / (1 / a + 1 / b);
    CHECK_REL(series->term[0].time, tau * (a + b) / (rest * a + b), 1e-14);
    CHECK_REL(series->equilibrium.m[0][0], late, 1e-13);
    CHECK_REL(series->term[0].stiffness.m[0][0], early - late, 1e-13);
    ph_prony_free(&series);
    ph_i_reduced_clear(&m);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(phases_are_their_functions),
        cmocka_unit_test(poles_are_exact),
        cmocka_unit_test(springs_in_series),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
