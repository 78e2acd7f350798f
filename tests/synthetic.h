/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cheap models for calibrations, with noise of realisations that is a pure function of seed,
 * point and realisation; include after check.h. */
#ifndef TESTS_SYNTHETIC_H
#define TESTS_SYNTHETIC_H

#include <perihom_calibrate.h>

enum { SYNTHETIC_POINTS = 12 };

typedef struct synthetic {
    uint64_t seed;
    double content[SYNTHETIC_POINTS];
    double noise; /* relative, of one realisation, times content */
    int outputs;
    double (*mean)(const double *unknown, double content, int output);
    /* what the model does at some unknown, point, realisation */
    ph_status (*odd)(const double *unknown, int point, uint64_t r, ph_error *err);
} synthetic;

/* A modulus that a stiff interphase raises and saturates, like that of bonds with kappa. */
static inline double synthetic_kappa(const double *unknown, double content, int output)
{
    double k = unknown[0];
    (void)output;
    return 3.5 * (1 + 8 * content * (k - 0.5) / (k + 8));
}

/* Half of the noise is common to all points of a realisation, half is their own. */
static inline ph_status synthetic_model(void *user, const double *unknown, int point,
                                        uint64_t r, double *output, ph_error *err)
{
    const synthetic *s = user;
    ph_random common = {.seed = s->seed, .realisation = r};
    ph_random own = {.seed = s->seed, .realisation = r, .object = (uint64_t)point + 1};
    double z = sqrt(0.5) * (ph_random_normal(&common) + ph_random_normal(&own));
    if (s->odd) {
        ph_status st = s->odd(unknown, point, r, err);
        if (st != PH_OK) return st;
    }
    for (int i = 0; i < s->outputs; i++)
        output[i] = s->mean(unknown, s->content[point], i) *
                    (1 + s->noise * s->content[point] * z);
    return PH_OK;
}

/* A calibration of one modulus at n contents 0 .. 0.05. */
typedef struct synthetic_fit {
    synthetic model;
    ph_fit_unknown unknown[4];
    ph_fit_measurement measurement[2 * SYNTHETIC_POINTS];
    ph_fit_problem problem;
} synthetic_fit;

static inline void synthetic_setup(synthetic_fit *f, int points, double sigma)
{
    *f = (synthetic_fit){.model = {.seed = 1, .outputs = 1, .mean = synthetic_kappa}};
    f->unknown[0] = (ph_fit_unknown){
        .name = "kappa", .from = 0.01, .to = 100, .start = 1, .log = true};
    f->problem = (ph_fit_problem){.nunknowns = 1,
                                  .unknown = f->unknown,
                                  .npoints = points,
                                  .noutputs = 1,
                                  .nmeasurements = points,
                                  .measurement = f->measurement,
                                  .model = synthetic_model,
                                  .user = &f->model};
    for (int i = 0; i < points; i++) {
        f->model.content[i] = 0.05 * (i + 1) / points;
        f->measurement[i] = (ph_fit_measurement){.point = i, .sigma = sigma};
    }
}

/* Measurements of the model's mean at the true unknowns, with errors of size sigma. */
static inline void synthetic_measure(synthetic_fit *f, const double *truth, double sigma,
                                     uint64_t seed)
{
    ph_random r = {.seed = seed, .object = 77};
    for (int i = 0; i < f->problem.nmeasurements; i++) {
        ph_fit_measurement *m = &f->measurement[i];
        m->value = f->model.mean(truth, f->model.content[m->point], m->output) +
                   sigma * ph_random_normal(&r);
    }
}

#endif
