/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Repeated synthetic campaigns whose mean is known. */
#ifndef TESTS_COVERAGE_H
#define TESTS_COVERAGE_H

#include <math.h>
#include <perihom_campaign.h>

typedef enum coverage_kind {
    COVERAGE_NORMAL,    /* mean 1, deviation 0.05 */
    COVERAGE_UNIFORM,   /* mean 1, deviation 0.05 */
    COVERAGE_LOGNORMAL, /* 0.9 + 0.1 of a lognormal: mean 1, deviation 0.05, skewness 1.6 */
    COVERAGE_EXPONENTIAL /* mean 1, deviation 1, skewness 2 */
} coverage_kind;

typedef struct coverage {
    const char *name;
    double skewness, ideal, number, covered, covered_greedy;
} coverage;

/* Value i of campaign k. */
static inline double coverage_value(coverage_kind kind, uint64_t seed, uint64_t k,
                                    uint64_t i)
{
    ph_random r = {.seed = seed, .realisation = k, .object = i};
    double u = ph_random_uniform(&r), v = ph_random_uniform(&r);
    double z = sqrt(-2 * log(u)) * cos(2 * 3.14159265358979323846 * v);
    const double s = sqrt(log(1.25)); /* deviation half of the mean */
    switch (kind) {
    case COVERAGE_NORMAL:
        return 1 + 0.05 * z;
    case COVERAGE_UNIFORM:
        return 1 + 0.05 * sqrt(12.0) * (u - 0.5);
    case COVERAGE_LOGNORMAL:
        return 0.9 + 0.1 * exp(s * z - 0.5 * s * s);
    default:
        return -log(u);
    }
}

/* The rule that looks every time: stop when the interval of all values is narrow enough. */
static inline bool coverage_greedy(coverage_kind kind, const ph_stopping *rule,
                                   uint64_t seed, uint64_t k)
{
    ph_sequence s;
    ph_stopping fixed = *rule;
    fixed.relative_half_width = 0;
    ph_interval i = {0};
    ph_sequence_start(&s, &fixed, NULL);
    do {
        ph_sequence_add(&s, coverage_value(kind, seed, k, (uint64_t)s.n));
        i = ph_sequence_interval(&s);
    } while (s.n < rule->at_least ||
             !(i.half_width <= rule->relative_half_width * fabs(i.mean)));
    return fabs(i.mean - 1) <= i.half_width;
}

static inline coverage coverage_of(coverage_kind kind, double width, int pilot,
                                   int campaigns, uint64_t seed, bool greedy)
{
    static const char *const names[] = {"normal", "uniform", "shifted lognormal",
                                        "exponential"};
    static const double skewness[] = {0, 0, 1.625, 2};
    const double deviation = kind == COVERAGE_EXPONENTIAL ? 1 : 0.05;
    const ph_stopping rule = {pilot, 1000000, width, 0, 0.95};
    coverage c = {names[kind], skewness[kind], pow(1.96 * deviation / width, 2), 0, 0, 0};
    for (int k = 0; k < campaigns; k++) {
        ph_sequence s;
        ph_sequence_start(&s, &rule, NULL);
        while (!s.done)
            ph_sequence_add(&s, coverage_value(kind, seed, (uint64_t)k, (uint64_t)s.n));
        ph_interval i = ph_sequence_interval(&s);
        c.number += (double)s.n / campaigns;
        c.covered += (fabs(i.mean - 1) <= i.half_width) / (double)campaigns;
        if (greedy)
            c.covered_greedy +=
                coverage_greedy(kind, &rule, seed, (uint64_t)k) / (double)campaigns;
    }
    return c;
}

#endif
