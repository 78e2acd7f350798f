/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Unknowns of a model from measurements: weighted least squares on means over random
 * realisations. Theory, and when it fails: docs/theory/calibration.md. */
#ifndef PERIHOM_CALIBRATE_H
#define PERIHOM_CALIBRATE_H

#include <perihom.h>
#include <perihom/quantity.h>

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum {
    PH_FIT_UNKNOWNS = 8, /* most unknowns */
    PH_FIT_OUTPUTS = 16, /* most measured quantities */
    PH_FIT_MINIMA = 8,   /* most minima kept */
    PH_FIT_PROFILE = 65, /* points of a profile */
    PH_FIT_NOTES = 24,
    PH_FIT_NAME = 128
};

/** One unknown, from <= start <= to. Inside it is u in [0, 1]:
 *  value = from + (to - from) u, or from (to / from)^u where `log`. */
typedef struct ph_fit_unknown {
    char name[PH_FIT_NAME];
    double from, to; /* from < to; log: from > 0 */
    double start;    /* NaN: the middle of the scale */
    bool log;
} ph_fit_unknown;

/** One measured number: output `output` at data point `point`. */
typedef struct ph_fit_measurement {
    int point, output;
    double value;
    double sigma; /* standard deviation of `value`; NaN: not known */
} ph_fit_measurement;

/** The model: outputs of one realisation at one data point.
 *
 *  A pure function of its inputs: equal realisations share their random numbers whatever the
 *  unknowns and the point, so that the mean is a smooth function of the unknowns (common
 *  random numbers). Called from several threads at once.
 *  @param[out] output [noutputs]; NaN where this point has no such output
 *  @return PH_OK; PH_ECANCELLED, PH_ENOMEM, PH_EIO and PH_EINTERNAL end the calibration; anything
 *          else is a failed realisation, which is counted and left out. */
typedef ph_status (*ph_fit_model)(void *user, const double *unknown, int point,
                                  uint64_t realisation, double *output, ph_error *err);

/** What to calibrate. Borrows everything. If the sigma of every measurement is NaN their
 *  relative error is one unknown number, found from the scatter; some NaN are refused. */
typedef struct ph_fit_problem {
    int nunknowns;
    const ph_fit_unknown *unknown;
    int npoints, noutputs, nmeasurements;
    const ph_fit_measurement *measurement;
    bool random; /* realisations differ */
    ph_fit_model model;
    void *user;
} ph_fit_problem;

/** How. Zero means the default. */
typedef struct ph_fit_params {
    double relative_error; /* 0.01; target of the sampling error, see ph_calibrate */
    int at_least;          /* 8; realisations of each point in the end */
    int at_most;           /* 1000; realisations of each point */
    double seconds;        /* no more realisations after so long; 0: no limit */
    int starts;    /* 4; local searches from `start` and the best points of a scan */
    int samples;   /* of the posterior; 0: none */
    uint64_t seed; /* of the posterior's chain */
} ph_fit_params;

/** Whether the data say anything of an unknown or of a direction. */
typedef enum ph_fit_knowledge {
    PH_FIT_KNOWN, /* the 95 % interval is shorter than the range */
    PH_FIT_WEAK,  /* it is the whole range */
    PH_FIT_FLAT   /* one standard error is the whole range, or nothing changes at all */
} ph_fit_knowledge;
/** In a word; "unknown" for what is none. Never NULL. */
PH_API const char *ph_fit_knowledge_text(ph_fit_knowledge k);

/** What came out for one unknown. */
typedef struct ph_fit_estimate {
    double value;
    double standard_error; /* of both errors; NaN where flat or not known */
    double error_data;     /* from the errors of the measurements */
    double error_sampling; /* from the finite number of realisations */
    double freedom;        /* degrees of freedom of the interval, INFINITY: normal */
    double local[2];       /* 95 % interval from curvature */
    double profile[2];     /* 95 % interval from the profile; NaN where there is none */
    double interval[2];    /* the better of both: profile if there is one */
    bool open[2];          /* the interval ends at the bound, not in the data */
    bool at_bound;         /* the best value lies at from or to, and would go beyond */
    bool several; /* the profile falls below the limit in more than one interval */
    ph_fit_knowledge knowledge;
    int nprofile; /* 0: none */
    double profile_value[PH_FIT_PROFILE];
    double profile_misfit[PH_FIT_PROFILE]; /* least misfit over the other unknowns */
    double posterior_mean, posterior_std, posterior_quantile[3]; /* 2.5, 50, 97.5 % */
    double autocorrelation; /* integrated time of the chain, steps */
} ph_fit_estimate;

/** A principal direction of the Fisher matrix, in units of the unknowns' ranges. */
typedef struct ph_fit_direction {
    double eigenvalue;
    double component[PH_FIT_UNKNOWNS];
    double standard_error; /* in shares of the range; INFINITY where nothing changes */
    ph_fit_knowledge knowledge;
} ph_fit_direction;

/** A local minimum of the misfit. */
typedef struct ph_fit_minimum {
    double value[PH_FIT_UNKNOWNS];
    double misfit;
    bool as_good; /* within the 95 % limit of the best: the data do not tell them apart */
} ph_fit_minimum;

/** One measurement and what the model says of it. */
typedef struct ph_fit_point {
    double measured, sigma;
    double model, model_error; /* mean and its standard error */
    int realisations, failed;
    double residual; /* (model - measured) / sigma */
    double leverage; /* 0..1: how far the fit follows this measurement */
    double left_out; /* prediction of a fit without this measurement; NaN: impossible */
    bool outlier;    /* |residual| / sqrt(1 - leverage) above the 99.9 % quantile */
} ph_fit_point;

/** Result of a calibration. Owns its arrays. */
typedef struct ph_fit {
    int nunknowns, nmeasurements;
    ph_fit_estimate *unknown;    /* [nunknowns] */
    double *correlation;         /* [nunknowns][nunknowns]; NaN for flat ones */
    ph_fit_direction *direction; /* [nunknowns], largest eigenvalue first */
    ph_fit_point *point;         /* [nmeasurements] */
    int nminima;
    ph_fit_minimum minimum[PH_FIT_MINIMA]; /* the first is the best */
    double misfit;                         /* sum of squared residuals */
    int freedom;                           /* measurements minus known directions */
    double probability; /* of a larger misfit by chance; NaN where sigma is not known */
    bool sigma_known;
    double sigma_scale; /* sigma not given: the relative error found; else 1 */
    double
        misfit_limit; /* rise of the misfit at the ends of a 95 % interval, data alone */
    double left_out_rms; /* of (prediction - measured) / sigma; NaN: impossible */
    double residual_rms;
    bool reached;          /* the target of the sampling error */
    int evaluations;       /* parameter sets */
    long solves, failures; /* calls of the model, and those that failed */
    int rounds;            /* of raising the number of realisations */
    double
        surrogate_error; /* largest error at check points, in sigma; NaN: no surrogate */
    int nsamples;        /* of the posterior */
    double *sample;      /* [nsamples][nunknowns] */
    double acceptance;
    int walkers;
    int nnotes;
    char notes[PH_FIT_NOTES][256];
    double seconds;
} ph_fit;

/** Unknowns that minimise chi2 = sum_i ((M_i - y_i) / sigma_i)^2, M_i the mean over realisations.
 *
 *  Trust-region Gauss-Newton (Levenberg-Marquardt) inside the bounds from several starts;
 *  then more realisations, in each round where they change the estimate most, until the
 *  sampling error of every unknown is at most
 *
 *      max(relative_error x |value|, a third of the data's error);
 *
 *  then profile likelihood, leave-one-out and posterior on a Chebyshev surrogate of the means
 *  (up to four unknowns). Intervals at 95 %, errors of data and of sampling together.
 *
 *  The same bits for any number of threads.
 *  @return PH_OK; PH_EINVAL (more unknowns than measurements, values not finite, bounds);
 *          PH_ENOCONV (the model fails at the start and wherever the scan looked; or in more
 *          than half of the realisations); PH_ECANCELLED; PH_ENOMEM; or what ended the model.
 *  Cost: about (10 + 6 unknowns + nodes of the surrogate) x points x realisations calls.
 *  Ref: [Seber2003], [Raue2009], [Goodman2010]. Tested: tests/laws/test_calibrate.c */
PH_API ph_status ph_calibrate(const ph_fit_problem *problem, const ph_fit_params *params,
                              const ph_ctx *ctx, ph_fit **out, ph_error *err);
PH_API void ph_fit_free(ph_fit **fit);

/* ---- calibrations of a case file */

enum { PH_FIT_KEYS = 8, PH_FIT_KEY = 200, PH_FIT_ALSO = 4 };

/** A calibration file, parsed and checked (docs/case-file.md, "Calibrations"), with its case
 *  and its data. Owns its arrays. */
typedef struct ph_fit_file {
    char path[512], title[256];
    char case_path[1024], data_path[1024];
    char *case_text; /* of the case file */
    size_t case_length;
    ph_case *base; /* the case with --set and nothing else */
    size_t nsets;
    char **sets; /* [nsets] --set, put before everything */
    int nunknowns;
    ph_fit_unknown unknown[PH_FIT_UNKNOWNS];
    char unknown_key[PH_FIT_UNKNOWNS][PH_FIT_KEY]; /* key of the case */
    int nalso[PH_FIT_UNKNOWNS]; /* further keys that get the same value */
    char also[PH_FIT_UNKNOWNS][PH_FIT_ALSO][PH_FIT_KEY];
    int nkeys; /* keys of the case that the data vary */
    char key[PH_FIT_KEYS][PH_FIT_KEY];
    int noutputs;
    ph_quantity output[PH_FIT_OUTPUTS];
    int npoints;
    double (*place)[PH_FIT_KEYS]; /* [npoints] values of the keys */
    int *line;                    /* [npoints] of the data file */
    int nmeasurements;
    ph_fit_measurement *measurement;
    ph_fit_params params;
} ph_fit_file;

/** Read a calibration with its case and data.
 *  @param[in] sets   overrides of the case, "key.path=value"
 *  @param[out] issues complaints of the calibration file and of the case, with line, key,
 *              value and what is admissible; their file is *where (the calibration or the
 *              case); NULL to get only the first in `err`
 *  @return as ph_case_read. Tested: tests/io/test_fit_file.c */
PH_API ph_status ph_fit_file_read(const char *path, const char *const *sets, size_t nsets,
                                  ph_fit_file **out, ph_case_issues *issues,
                                  char where[1024], ph_error *err);
PH_API void ph_fit_file_free(ph_fit_file **file);

/** Calibrate. Every realisation that was solved is a line of `dir`/evaluations.jsonl before it
 *  counts, and is never solved again: a run that was killed goes on where it was. The file
 *  is locked meanwhile.
 *  @param[in] dir   exists, or NULL: keep nothing
 *  @param[in] retry solve again what failed before
 *  @param[out] solved how many were solved now, those read back not counted
 *  @return as ph_calibrate; PH_EIO: the file is locked, or of another case. */
PH_API ph_status ph_fit_file_run(const ph_fit_file *file, const char *dir, bool retry,
                                 const ph_ctx *ctx, ph_fit **out, long *solved,
                                 ph_error *err);
/** The document perihom.calibration/1 as text, malloc'd. */
PH_API ph_status ph_fit_to_json(const ph_fit_file *file, const ph_fit *fit,
                                const char *command, char **json, ph_error *err);
/** Pictures into `dir`: model-QUANTITY.svg (model against measurement), profile-NAME.svg of
 *  each unknown, and samples.csv where there are any. */
PH_API ph_status ph_fit_write_pictures(const ph_fit_file *file, const ph_fit *fit,
                                       const char *dir, ph_error *err);

#ifdef __cplusplus
}
#endif
#endif
