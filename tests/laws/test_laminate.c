/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/tensor.h>

#include "check.h"
#include "tensors.h"

/* Backus 1962 for isotropic layers with normal 3, from Lame constants. */
static ph_sym4 backus(const double E[2], const double nu[2], double f)
{
    double inv_m = 0, l_m = 0, shear = 0, inv_g = 0, a = 0;
    for (int i = 0; i < 2; i++) {
        double w = i ? f : 1 - f, G = E[i] / (2 * (1 + nu[i]));
        double L = 2 * G * nu[i] / (1 - 2 * nu[i]), M = L + 2 * G;
        inv_m += w / M, l_m += w * L / M, shear += w * G, inv_g += w / G;
        a += w * 4 * G * (L + G) / M;
    }
    double C11 = a + l_m * l_m / inv_m, C33 = 1 / inv_m, C13 = l_m / inv_m,
           C44 = 1 / inv_g;
    double C12 = C11 - 2 * shear;
    double v[36] = {C11, C12, C13, 0, 0,   0, C12, C11, C13, 0,   0, 0,
                    C13, C13, C33, 0, 0,   0, 0,   0,   0,   C44, 0, 0,
                    0,   0,   0,   0, C44, 0, 0,   0,   0,   0,   0, shear};
    return ph_sym4_from_voigt(6, v, true);
}

static void test_is_backus_for_isotropic_layers(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_error err = PH_ERROR_INIT;
    for (int t = 0; t < check_trials(50); t++) {
        double E[2], nu[2], f = check_random(&seed);
        for (int i = 0; i < 2; i++) {
            E[i] = pow(10, check_uniform(&seed, -2, 2));
            nu[i] = check_uniform(&seed, -0.3, 0.45);
        }
        ph_sym4 c1 = ph_sym4_isotropic(E[0], nu[0]), c2 = ph_sym4_isotropic(E[1], nu[1]),
                c;
        CHECK_OK(ph_sym4_laminate(&c1, &c2, f, (double[]){0, 0, 1}, &c, &err));
        ph_sym4 want = backus(E, nu, f);
        /* The softest entry is up to 1e4 below the norm: round-off 1e-16 x 1e4 in it. */
        CHECK_ABS(difference(&c, &want), 0, 1e-13);
        CHECK_REL(c.m[2][2], want.m[2][2], 1e-10);
        CHECK_REL(c.m[4][4], want.m[4][4], 1e-10);
    }
    CHECK_END();
}

/* Laws that hold for any two stiffnesses, any direction, n = 3 and n = 6. */
static void check_laws(uint64_t *seed, int n)
{
    ph_error err = PH_ERROR_INIT;
    double R[9], r[9], f = check_random(seed), e1[3] = {1, 0, 0};
    ph_sym4 c1 = random_stiffness(seed, n), c2 = random_stiffness(seed, n), c, other, s1,
            s2;
    random_rotation(seed, R);
    memcpy(r, R, sizeof r);
    if (n == 3) {
        double w = check_uniform(seed, 0, 6.28);
        const double p[4] = {cos(w), -sin(w), sin(w), cos(w)};
        memcpy(r, p, sizeof p);
    }
    double normal[3] = {r[0], r[n == 3 ? 2 : 3], n == 3 ? 0 : r[6]}; /* R e1 */
    CHECK_OK(ph_sym4_laminate(&c1, &c2, f, e1, &c, &err));
    /* order of the phases */
    CHECK_OK(ph_sym4_laminate(&c2, &c1, 1 - f, e1, &other, &err));
    CHECK_ABS(difference(&c, &other), 0, 1e-12);
    /* sign of the normal */
    CHECK_OK(ph_sym4_laminate(&c1, &c2, f, (double[]){-1, 0, 0}, &other, &err));
    CHECK_ABS(difference(&c, &other), 0, 1e-12);
    CHECK(ph_sym4_is_stiffness(&c));
    /* Reuss <= laminate <= Voigt */
    ph_sym4 voigt = ph_sym4_combine(1 - f, &c1, f, &c2);
    CHECK_OK(ph_sym4_inverse(&c1, &s1, &err));
    CHECK_OK(ph_sym4_inverse(&c2, &s2, &err));
    ph_sym4 reuss = ph_sym4_combine(1 - f, &s1, f, &s2);
    CHECK_OK(ph_sym4_inverse(&reuss, &reuss, &err));
    CHECK(gap(&voigt, &c) > -1e-12 && gap(&c, &reuss) > -1e-12);
    /* rotation of everything */
    c1 = ph_sym4_rotate(&c1, r), c2 = ph_sym4_rotate(&c2, r), c = ph_sym4_rotate(&c, r);
    CHECK_OK(ph_sym4_laminate(&c1, &c2, f, normal, &other, &err));
    CHECK_ABS(difference(&c, &other), 0, 1e-12);
    /* ends, equal phases */
    CHECK_OK(ph_sym4_laminate(&c1, &c2, 0, normal, &other, &err));
    CHECK_ABS(difference(&other, &c1), 0, 0);
    CHECK_OK(ph_sym4_laminate(&c1, &c2, 1, normal, &other, &err));
    CHECK_ABS(difference(&other, &c2), 0, 0);
    CHECK_OK(ph_sym4_laminate(&c1, &c1, f, normal, &other, &err));
    CHECK_ABS(difference(&other, &c1), 0, 1e-15);
    /* the output may be an input */
    CHECK_OK(ph_sym4_laminate(&c1, &c2, f, normal, &c1, &err));
    CHECK_ABS(difference(&c1, &c), 0, 1e-12);
}

static void test_laws(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int t = 0; t < check_trials(50); t++)
        check_laws(&seed, t % 2 ? 3 : 6);
    CHECK_END();
}

/* Lamination commutes with the reduction to a plane that holds the normal. */
static void test_plane_is_the_block(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_error err = PH_ERROR_INIT;
    ph_sym4 c1 = ph_sym4_isotropic(1, 0.3), c2 = ph_sym4_isotropic(7, 0.1), c, p1, p2, p;
    double w = check_uniform(&seed, 0, 6.28), normal[3] = {cos(w), sin(w), 0};
    CHECK_OK(ph_sym4_laminate(&c1, &c2, 0.3, normal, &c, &err));
    CHECK_OK(ph_sym4_reduce(&c, PH_PLANE_STRAIN, &c, &err));
    CHECK_OK(ph_sym4_reduce(&c1, PH_PLANE_STRAIN, &p1, &err));
    CHECK_OK(ph_sym4_reduce(&c2, PH_PLANE_STRAIN, &p2, &err));
    CHECK_OK(ph_sym4_laminate(&p1, &p2, 0.3, normal, &p, &err));
    CHECK_ABS(difference(&p, &c), 0, 1e-14);
    CHECK_END();
}

static void test_void_and_refusals(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_sym4 c = ph_sym4_isotropic(1, 0.3), zero = {.n = 6}, plane = {.n = 3}, out;
    const double n1[3] = {1, 0, 0};
    CHECK_OK(ph_sym4_laminate(&c, &zero, 0.25, n1, &out, &err));
    ph_sym4 want = ph_sym4_combine(0.75, &c, 0, &c);
    CHECK_ABS(difference(&out, &want), 0, 0);
    CHECK_OK(ph_sym4_laminate(&zero, &c, 0.75, n1, &out, &err));
    CHECK_ABS(difference(&out, &want), 0, 0);
    CHECK(ph_sym4_laminate(&c, &plane, 0.5, n1, &out, NULL) == PH_EINVAL);
    CHECK(ph_sym4_laminate(&c, &c, 1.5, n1, &out, NULL) == PH_EINVAL);
    CHECK(ph_sym4_laminate(&c, &c, NAN, n1, &out, NULL) == PH_EINVAL);
    CHECK(ph_sym4_laminate(&c, &c, 0.5, (double[]){1, 1, 0}, &out, NULL) == PH_EINVAL);
    CHECK(ph_sym4_laminate(&c, &c, 0.5, (double[]){NAN, 1, 0}, &out, NULL) == PH_EINVAL);
    ph_sym4 liquid = ph_sym4_isotropic_kg(1, 0);
    CHECK(ph_sym4_laminate(&liquid, &liquid, 0.5, n1, &out, NULL) == PH_ESINGULAR);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_is_backus_for_isotropic_layers),
        cmocka_unit_test(test_laws),
        cmocka_unit_test(test_plane_is_the_block),
        cmocka_unit_test(test_void_and_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
