/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Models of a random quantity whose mean is known, and the loop that a campaign runs over
 * ph_estimation_next; include after check.h. */
#ifndef TESTS_SYNTHETIC_MODELS_H
#define TESTS_SYNTHETIC_MODELS_H

#include <perihom_rve.h>

#include <perihom_estimators.h>

/* Model i of realisation k of repetition r: out[dimension]. */
typedef void synthetic_model(uint64_t r, uint64_t k, int i, double *out);

typedef struct synthetic {
    int nmodels;
    int dimension[PH_MAX_MODELS];
    double cost[PH_MAX_MODELS];
    synthetic_model *model;
} synthetic;

typedef struct synthetic_run {
    double *value[PH_MAX_MODELS];
    ph_model_samples samples[PH_MAX_MODELS];
    ph_estimation e;
} synthetic_run;

static inline double synthetic_normal(uint64_t r, uint64_t k, uint64_t what)
{
    ph_random q = {r, k, what, 0};
    return ph_random_normal(&q);
}

static inline void synthetic_extend(const synthetic *s, uint64_t r, synthetic_run *run,
                                    int i, ptrdiff_t n)
{
    ph_model_samples *x = &run->samples[i];
    int d = s->dimension[i];
    if (n <= x->n) return;
    run->value[i] = realloc(run->value[i], sizeof(double) * (size_t)(n * d));
    for (ptrdiff_t k = x->n; k < n; k++)
        s->model(r, (uint64_t)k, i, &run->value[i][k * d]);
    x->n = n;
    x->value = run->value[i];
}

static inline void synthetic_free(synthetic_run *run)
{
    for (int i = 0; i < PH_MAX_MODELS; i++)
        free(run->value[i]);
}

/* Until done; `extra` realisations more than wanted are offered every time. */
static inline ph_status synthetic_estimate(const synthetic *s,
                                           const ph_estimation_rule *rule, uint64_t r,
                                           int extra, synthetic_run *run, ph_error *err)
{
    memset(run, 0, sizeof *run);
    for (int i = 0; i < s->nmodels; i++)
        run->samples[i] =
            (ph_model_samples){.dimension = s->dimension[i], .cost = s->cost[i]};
    for (;;) {
        ph_status st = ph_estimation_next(rule, s->nmodels, run->samples, &run->e, err);
        if (st || run->e.done) return st;
        for (int i = 0; i < s->nmodels; i++)
            synthetic_extend(s, r, run, i, run->e.want[i] + extra);
    }
}

#endif
