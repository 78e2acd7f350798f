/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "check.h"
#include "effective/composite.h"
#include "tensors.h"

static void test_general_inverse(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_error err = PH_ERROR_INIT;
    for (int t = 0; t < check_trials(20); t++) {
        ph_sym4 a = {.n = t % 2 ? 3 : 6}, inv, one = {.n = a.n}, p;
        for (int i = 0; i < a.n; i++) {
            one.m[i][i] = 1;
            for (int j = 0; j < a.n; j++)
                a.m[i][j] = check_uniform(&seed, -0.1, 0.1);
            a.m[i][(i + 1) % a.n] += 1; /* far from symmetric, tiny diagonal */
            a.m[i][i] *= 1e-14;
        }
        CHECK_OK(ph_i_inverse_general(&a, &inv, &err));
        p = ph_sym4_product(&a, &inv);
        CHECK_ABS(difference(&p, &one), 0, 1e-13); /* condition below 10 */
        CHECK_OK(ph_i_inverse_general(&a, &a, &err));
        CHECK_ABS(difference(&a, &inv), 0, 0);
    }
    ph_sym4 flat = {.n = 3, .m = {{1, 1}, {1, 1}, {0, 0, 1}}};
    CHECK(ph_i_inverse_general(&flat, &flat, NULL) == PH_ESINGULAR);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_general_inverse)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
