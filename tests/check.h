/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What numerics need beside cmocka: checks that print got, want, error and tolerance and
 * go on; a printed seed; a random generator. A test function ends with CHECK_END(). */
#ifndef TESTS_CHECK_H
#define TESTS_CHECK_H

/* cmocka.h needs the others before it. */
/* clang-format off */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
/* clang-format on */

static int check_failures;

#define CHECK(c)                                                                         \
    do {                                                                                 \
        if (c) {                                                                         \
        } else {                                                                         \
            check_failures++;                                                            \
            print_error("%s:%d: CHECK(%s)\n", __FILE__, __LINE__, #c);                   \
        }                                                                                \
    } while (0)

/* |got - want| <= tol */
#define CHECK_ABS(got, want, tol)                                                        \
    check_abs_(__FILE__, __LINE__, #got, (got), (want), (tol))
/* |got - want| <= tol |want| */
#define CHECK_REL(got, want, tol)                                                        \
    check_abs_(__FILE__, __LINE__, #got, (got), (want), (tol)*fabs((double)(want)))
/* the call succeeds; prints the message of `err` if not */
#define CHECK_OK(call)                                                                   \
    do {                                                                                 \
        ph_status check_st_ = (call);                                                    \
        if (check_st_ != PH_OK) {                                                        \
            check_failures++;                                                            \
            print_error("%s:%d: %s: %s: %s\n", __FILE__, __LINE__, #call,                \
                        ph_status_text(check_st_), err.msg);                             \
        }                                                                                \
    } while (0)

static inline void check_abs_(const char *file, int line, const char *what, double got,
                              double want, double tol)
{
    if (fabs(got - want) <= tol) return;
    check_failures++;
    print_error("%s:%d: %s: got %.17g, want %.17g, error %.3g, tolerance %.3g\n", file,
                line, what, got, want, got - want, tol);
}

#define CHECK_END()                                                                      \
    do {                                                                                 \
        int n_ = check_failures;                                                         \
        check_failures = 0;                                                              \
        if (n_) fail_msg("%d checks failed", n_);                                        \
    } while (0)

/* Seed of the random inputs: PH_TEST_SEED, else 1. Printed, so that a failure can be rerun. */
static inline uint64_t check_seed(void)
{
    const char *s = getenv("PH_TEST_SEED");
    uint64_t seed = s ? strtoull(s, NULL, 10) : 1;
    print_message("seed %llu\n", (unsigned long long)seed);
    return seed;
}

/* How many random trials: `n` times PH_TEST_MULTIPLIER. */
static inline int check_trials(int n)
{
    const char *s = getenv("PH_TEST_MULTIPLIER");
    int k = s ? atoi(s) : 1;
    return n * (k > 0 ? k : 1);
}

/* Uniform in [0, 1): splitmix64. */
static inline double check_random(uint64_t *state)
{
    uint64_t z = (*state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    z ^= z >> 31;
    return (double)(z >> 11) * 0x1p-53;
}

static inline double check_uniform(uint64_t *state, double from, double to)
{
    return from + (to - from) * check_random(state);
}

#endif
