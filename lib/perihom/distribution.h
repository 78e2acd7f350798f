/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PERIHOM_DISTRIBUTION_H
#define PERIHOM_DISTRIBUTION_H

#include <perihom/catalogue.h>

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { PH_TABLE_MAX = 32, PH_DISTRIBUTION_KEYS = 3 };

/** A random quantity: an entry of ph_distributions[] with its parameters. A plain value. */
typedef struct ph_distribution {
    int kind;                       /* index into ph_distributions; -1: not given */
    double p[PH_DISTRIBUTION_KEYS]; /* in the order of the entry's keys */
    double min, max;                /* truncation, -INFINITY and INFINITY where none */
    int n;                          /* table: number of values */
    double value[PH_TABLE_MAX];     /* table: ascending */
    double weight[PH_TABLE_MAX];    /* table: share of each value, adding up to 1 */
} ph_distribution;

/** A kind of distribution. cdf and quantile are those without truncation. */
typedef struct ph_distribution_kind {
    ph_entry info;
    const char *keys[PH_DISTRIBUTION_KEYS]; /* of the case file, NULL beyond the last */
    bool truncates;                         /* may have min and max besides */
    double (*cdf)(const ph_distribution *d, double x);
    double (*quantile)(const ph_distribution *d, double u);
} ph_distribution_kind;
PH_API extern const ph_distribution_kind ph_distributions[];
PH_API extern const size_t ph_ndistributions;

/** The constant x. */
PH_API ph_distribution ph_distribution_constant(double x);
/** Parameters in range, an interval that the distribution can reach.
 *  @return PH_OK; PH_EUNPHYSICAL with what is admissible. */
PH_API ph_status ph_distribution_check(const ph_distribution *d, ph_error *err);
/** P(X <= x), truncation included. */
PH_API double ph_distribution_cdf(const ph_distribution *d, double x);
/** The x with P(X <= x) = u: monotone in u, so that equal random numbers give neighbouring
 *  values for neighbouring parameters. With F the distribution without truncation it is
 *  F^-1(F(min) + u (F(max) - F(min))). @param u 0 < u < 1.
 *  Tested: tests/unit/test_distributions.c */
PH_API double ph_distribution_quantile(const ph_distribution *d, double u);
/** Mean of g(X), or of X where g is NULL, by the midpoint rule in u with 512 points. */
PH_API double ph_distribution_mean(const ph_distribution *d, double (*g)(double x));
/** Smallest and largest value that can come (may be infinite). */
PH_API void ph_distribution_range(const ph_distribution *d, double *lo, double *hi);

/** Where a random number stands: numbers are a pure function of these four, so that no
 *  order of computation, machine or number of threads changes them. */
typedef struct ph_random {
    uint64_t seed, realisation, object, draw;
} ph_random;
/** Uniform in (0, 1), 52 bits, never 0 or 1; steps r->draw. Each of the four numbers goes
 *  through the finaliser of splitmix64 [Steele2014]. Cost: four of them. */
PH_API double ph_random_uniform(ph_random *r);
/** Standard normal, by its quantile. */
PH_API double ph_random_normal(ph_random *r);

#ifdef __cplusplus
}
#endif
#endif
