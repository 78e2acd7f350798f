/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random relaxation series for the tests; include after check.h. */
#ifndef TESTS_SERIES_H
#define TESTS_SERIES_H

#include <perihom/prony.h>

#include "check.h"
#include "tensors.h"

enum { MOST_RANDOM_TERMS = 64 };

/* a a^T with `rank` columns */
static inline ph_sym4 random_semidefinite(uint64_t *seed, int n, int rank)
{
    ph_sym4 c = {.n = n};
    for (int k = 0; k < rank; k++) {
        double a[6];
        for (int i = 0; i < n; i++)
            a[i] = check_uniform(seed, -1, 1);
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++)
                c.m[i][j] += a[i] * a[j];
    }
    return c;
}

/* `nterms` terms over so many decades around 1, the first of full rank, and an equilibrium
 * tensor of this size. */
static inline ph_prony *random_series(uint64_t *seed, int n, int nterms, double decades,
                                      int rank, double equilibrium)
{
    ph_error err = PH_ERROR_INIT;
    ph_prony_term term[MOST_RANDOM_TERMS];
    ph_prony *p = NULL;
    ph_sym4 e = random_stiffness(seed, n), zero = {.n = n};
    e = ph_sym4_combine(equilibrium, &e, 0, &zero);
    for (int m = 0; m < nterms; m++)
        term[m] = (ph_prony_term){
            pow(10, decades * (m / (double)nterms - 0.5) + check_uniform(seed, 0, 0.4)),
            random_semidefinite(seed, n, m == 0 ? n : rank)};
    CHECK_OK(ph_prony_new(&e, nterms, term, &p, &err));
    return p;
}

#endif
