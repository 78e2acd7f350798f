/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Campaigns on cells of several sizes whose mean, bias and scatter are known. */
#ifndef TESTS_SPLIT_MODEL_H
#define TESTS_SPLIT_MODEL_H

#include <math.h>
#include <perihom_campaign.h>
#include <stdlib.h>

/* x(f) = 1 + bias f^-power + scatter f^(-d/2) z, in d dimensions; the z of one realisation at
 * two sizes have the correlation `common`. A realisation costs f^d. */
typedef struct split_model {
    int dimensions;
    double power, bias, scatter, common;
} split_model;

enum { SPLIT_SIZES = 5, SPLIT_PILOTS = 20 };
static const double split_factor[SPLIT_SIZES] = {0.5, 0.7071, 1, 1.4142, 2};

static inline double split_normal(uint64_t seed, uint64_t k, uint64_t object)
{
    ph_random r = {.seed = seed, .realisation = k, .object = object};
    double u = ph_random_uniform(&r), v = ph_random_uniform(&r);
    return sqrt(-2 * log(u)) * cos(2 * 3.14159265358979323846 * v);
}

static inline double split_value(const split_model *m, uint64_t seed, double f,
                                 uint64_t i)
{
    double z = sqrt(m->common) * split_normal(seed, i, 0) +
               sqrt(1 - m->common) * split_normal(seed, i, (uint64_t)(1e6 * f));
    return 1 + m->bias * pow(f, -m->power) +
           m->scatter * pow(f, -0.5 * m->dimensions) * z;
}

typedef struct split_run {
    ph_split_step step;
    int sizes;      /* with pilots */
    int64_t pilots; /* of each */
    double factor;  /* chosen */
    double error;   /* of the mean at the end, off 1 */
    double cost;    /* all pilots, and the rest of the campaign */
    int64_t n;      /* realisations of the campaign */
} split_run;

/* A question with pilots of the first `sizes` sizes; value and cost to be freed. */
static inline ph_split_question split_ask(const split_model *m, uint64_t seed,
                                          double accuracy, int sizes, int64_t pilots)
{
    static const double no_error = 0, no_cost = 1;
    double *value = calloc((size_t)(sizes * pilots), sizeof *value),
           *cost = calloc((size_t)sizes, sizeof *cost);
    for (int k = 0; k < sizes; k++) {
        cost[k] = pow(split_factor[k], m->dimensions);
        for (int64_t i = 0; i < pilots; i++)
            value[k * pilots + i] = split_value(m, seed, split_factor[k], (uint64_t)i);
    }
    return (ph_split_question){.dimensions = m->dimensions,
                               .exponent = m->dimensions,
                               .accuracy = accuracy,
                               .confidence = 0.95,
                               .least = SPLIT_PILOTS,
                               .most = 100000,
                               .npoints = 1,
                               .nsizes = sizes,
                               .nmore = SPLIT_SIZES - sizes,
                               .factor = split_factor,
                               .n = pilots,
                               .value = value,
                               .cost = cost,
                               .ngrids = 1,
                               .grid_error = &no_error,
                               .grid_cost = &no_cost};
}

static inline void split_clear(ph_split_question *q)
{
    free((void *)(uintptr_t)q->value);
    free((void *)(uintptr_t)q->cost);
}

/* Pilots, the choice, and the campaign of the chosen size to its end. */
static inline split_run split_campaign(const split_model *m, uint64_t seed,
                                       double accuracy)
{
    split_run run = {.sizes = 2, .pilots = SPLIT_PILOTS, .error = NAN};
    ph_split_answer *a = NULL;
    ph_split_question q;
    for (;;) {
        q = split_ask(m, seed, accuracy, run.sizes, run.pilots);
        if (ph_split_choose(&q, &a, NULL) != PH_OK) abort();
        run.step = a->step;
        run.cost = a->pilot_cost;
        split_clear(&q);
        if (run.step == PH_SPLIT_MORE)
            run.pilots *= 2;
        else if (run.step == PH_SPLIT_LARGER)
            run.sizes++;
        else
            break;
        ph_split_answer_free(&a);
    }
    if (run.step == PH_SPLIT_CHOSEN) {
        const ph_split_candidate *c = &a->candidate[a->chosen];
        const ph_stopping rule = {run.pilots, 100000, c->half_width, 0, 0.95};
        ph_sequence s;
        run.factor = split_factor[c->size];
        ph_sequence_start(&s, &rule, NULL);
        while (!s.done)
            ph_sequence_add(&s, split_value(m, seed, run.factor, (uint64_t)s.n));
        run.n = s.n;
        run.error = fabs(s.mean - 1);
        run.cost += (double)(s.n - run.pilots) * pow(run.factor, m->dimensions);
    }
    ph_split_answer_free(&a);
    return run;
}

/* Who knows bias and scatter: the cheapest size, and its factor. */
static inline double split_least(const split_model *m, double accuracy, double *factor)
{
    double least = INFINITY;
    for (int k = 0; k < SPLIT_SIZES; k++) {
        double f = split_factor[k], v = pow(f, m->dimensions),
               room = accuracy - fabs(m->bias) * pow(f, -m->power);
        if (room <= 0) continue;
        double n = fmax(SPLIT_PILOTS, ceil(pow(1.96 * m->scatter / room, 2) / v));
        if (n * v >= least) continue;
        least = n * v;
        *factor = f;
    }
    return least;
}

#endif
