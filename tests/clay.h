/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Moduli of many realisations of a random case; include after check.h. */
#ifndef TESTS_CLAY_H
#define TESTS_CLAY_H

#include <perihom_rve.h>

/* Mean, standard deviation of one realisation, standard error of the mean. */
typedef struct clay_mean {
    double mean, std, error;
} clay_mean;

typedef struct clay_sample {
    int asked, refused; /* refused: a filler was longer than the box */
    clay_mean E1, E2, fillers, fraction, reactions;
    double iterations; /* of both loads, mean */
} clay_sample;

static inline clay_mean clay_mean_of(int n, const double *x)
{
    double sum = 0, square = 0;
    int count = 0;
    for (int i = 0; i < n; i++)
        if (!isnan(x[i])) sum += x[i], count++;
    double mean = sum / count;
    for (int i = 0; i < n; i++)
        if (!isnan(x[i])) square += (x[i] - mean) * (x[i] - mean);
    double std = count > 1 ? sqrt(square / (count - 1)) : 0.0;
    return (clay_mean){mean, std, std / sqrt(count)};
}

/* E11 = a11 (1 - nu21^2), nu21 = a21 / a11, the way [Ongaro2022] (3.5)-(3.8) take moduli
 * from the two stretches; axis 1: E22. */
static inline double clay_modulus(const ph_sym4 *c, int axis)
{
    double a = c->m[axis][axis], b = c->m[1 - axis][axis];
    return a * (1 - (b / a) * (b / a));
}

enum { CLAY_E1, CLAY_E2, CLAY_FILLERS, CLAY_FRACTION, CLAY_REACTIONS, CLAY_ITERATIONS };

/* Realisation k of a case: out[6]; NaN where a filler was longer than the box. */
static inline ph_status clay_one(const ph_case *c, int k, double out[6], ph_error *err)
{
    ph_case mine = *c; /* borrows the arrays of c */
    ph_ctx ctx = {.threads = 1};
    ph_microstructure *micro = NULL;
    ph_packing *packing = NULL;
    ph_result *r = NULL;
    mine.realisation = (uint64_t)k;
    for (int i = 0; i < 6; i++)
        out[i] = NAN;
    ph_status st = ph_rve_generate(&mine, &micro, &packing, err);
    if (st == PH_EUNPHYSICAL) return PH_OK;
    ph_problem p = {.micro = micro,
                    .interface = c->interface,
                    .model = c->model,
                    .constraint = c->constraint,
                    .solver = c->solver,
                    .loads = 3};
    if (!st) st = ph_homogenise(&p, &ctx, &r, err);
    if (!st) {
        const ph_sym4 *C = r->bond.present ? &r->bond.virial : &r->stiffness;
        out[CLAY_E1] = clay_modulus(C, 0);
        out[CLAY_E2] = clay_modulus(C, 1);
        out[CLAY_FILLERS] = packing ? (double)packing->n : 0;
        out[CLAY_FRACTION] = packing ? packing->kind[0].reached : 0;
        if (r->bond.has_reactions)
            out[CLAY_REACTIONS] = clay_modulus(&r->bond.reactions, 0);
        out[CLAY_ITERATIONS] = r->iterations[0] + r->iterations[1];
    }
    ph_result_free(&r);
    ph_packing_free(&packing);
    ph_microstructure_free(&micro);
    return st;
}

/* Realisations 0 .. n - 1, one a thread at a time: the same numbers on any number of
 * threads. */
static inline ph_status clay_sample_of(const ph_case *c, int n, clay_sample *s,
                                       ph_error *err)
{
    ph_status st = PH_OK;
    double(*all)[6] = calloc((size_t)n, sizeof *all), *x = calloc((size_t)n, sizeof *x);
    clay_mean *to[] = {&s->E1, &s->E2, &s->fillers, &s->fraction, &s->reactions};
    if (!all || !x) st = PH_ENOMEM;
#ifdef _OPENMP
#pragma omp parallel for schedule(dynamic)
#endif
    for (int k = 0; k < (st ? 0 : n); k++) {
        ph_error mine = PH_ERROR_INIT;
        ph_status got = clay_one(c, k, all[k], &mine);
        if (got) {
#ifdef _OPENMP
#pragma omp critical(clay_failed)
#endif
            st = got, *err = mine;
        }
    }
    *s = (clay_sample){.asked = n};
    for (int i = 0; !st && i < 6; i++) {
        for (int k = 0; k < n; k++)
            x[k] = all[k][i];
        if (i < CLAY_ITERATIONS)
            *to[i] = clay_mean_of(n, x);
        else
            s->iterations = clay_mean_of(n, x).mean;
    }
    for (int k = 0; !st && k < n; k++)
        s->refused += isnan(all[k][0]);
    free(all);
    free(x);
    return st;
}

#endif
