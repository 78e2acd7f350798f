/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Many realisations of many cases: one scenario, a stopping rule, campaigns. */
#ifndef PERIHOM_CAMPAIGN_H
#define PERIHOM_CAMPAIGN_H

#include <perihom_rve.h>

#include <perihom_estimators.h>
#include <perihom_split.h>

#ifdef __cplusplus
extern "C" {
#endif

#define PH_MAX_OUTPUTS 64

/** One realisation of a case, and what is asked of it. Borrows everything. */
typedef struct ph_scenario {
    const ph_case *c;     /* read with its overrides: ph_case_read(path, sets, ...) */
    uint64_t realisation; /* in place of the one of the case */
    int noutputs;         /* 1 .. PH_MAX_OUTPUTS */
    const ph_quantity *output; /* [noutputs] */
} ph_scenario;

/** What came out of a scenario, and what it cost. */
typedef struct ph_evaluation {
    int n;
    double value[PH_MAX_OUTPUTS]; /* in the order of the outputs */
    ph_work work;
    ptrdiff_t nodes;
    double seconds; /* wall clock, microstructure and solution */
    double seconds_solve;
} ph_evaluation;

/** Which loads the outputs of a case need together (as ph_problem.loads; 0: none).
 *
 *  The union of ph_quantity_loads; all where that is not accurate enough: contrast above
 *  1e3 or a void (then entries are refined with the fields of all loads), or
 *  uniform_traction, whose compliance is inverted as a whole. */
PH_API unsigned ph_scenario_loads(const ph_scenario *scenario);
/** May realisations of the case have the output: does its kinematics have the quantity, and the
 *  case the material of a fraction?
 *  @return PH_OK; PH_EINVAL with the reason. Tested: tests/unit/test_scenario.c */
PH_API ph_status ph_scenario_admits(const ph_case *c, const ph_quantity *output,
                                    ph_error *err);

/** Build the microstructure of the realisation, solve the loads that the outputs need, and
 *  read the outputs off.
 *
 *  A pure function of (case, seed, realisation, outputs): the same bits on any number of
 *  threads, in any order. Two cases that differ in any key but the seed draw the same random
 *  numbers for the same realisation (common random numbers): filler k of both has the same
 *  draws, whatever its amount or properties.
 *  @param[out] out untouched on failure
 *  @return PH_OK; PH_EINVAL (no outputs, an output that this kinematics has not);
 *          PH_EUNPHYSICAL (fillers that find no room); PH_ENOCONV; PH_ESINGULAR; PH_ENOMEM;
 *          PH_ECANCELLED. Tested: tests/unit/test_scenario.c */
PH_API ph_status ph_scenario_evaluate(const ph_scenario *scenario, const ph_ctx *ctx,
                                      ph_evaluation *out, ph_error *err);

/** When a point has enough realisations: at a fixed number, or when the mean of one output is
 *  known well enough. Zero widths: a fixed number, at_most. */
typedef struct ph_stopping {
    int64_t at_least, at_most;  /* 2 <= at_least <= at_most; at_least: the pilot sample */
    double relative_half_width; /* of the interval of the mean, over the mean; or */
    double half_width;          /* in the unit of the output */
    double confidence;          /* 0 < . < 1 */
} ph_stopping;

/** The values of one output in the order of the realisations, as the rule sees them. */
typedef struct ph_sequence {
    ph_stopping rule;
    int stage;         /* stages completed */
    int64_t n, target; /* values so far; so many are certainly needed */
    double mean, m2;   /* m2: sum of squared deviations from the mean */
    bool done;         /* all that it asked for are there */
} ph_sequence;

/** A confidence interval of a mean. */
typedef struct ph_interval {
    double mean, deviation, standard_error, half_width;
} ph_interval;

/** Sampling in stages for a confidence interval of given width [Hall1981], [Stein1945].
 *
 *    pilot     n = at_least
 *    second    n = half of N(n), at least the pilot
 *    further   n = N(n) until N(n) <= n, that is until the half width is reached
 *    with      N(n) = ceil((t(n - 1) s_n / d)^2)
 *
 *  t the two-sided quantile of Student's t, s_n the deviation of the first n values and d the
 *  half width (relative_half_width |mean_n|). The rule looks only at the end of a stage,
 *  whose length was fixed before it began: two to four looks as a rule; between them anybody
 *  may look, nothing is decided. Feed values in the order of the realisations: then N is the
 *  same whatever the order of computing. Without widths: at_most values.
 *  Theory and measured coverage: docs/theory/sampling.md.
 *  @return PH_OK; PH_EINVAL. Tested: tests/unit/test_stopping.c */
PH_API ph_status ph_sequence_start(ph_sequence *s, const ph_stopping *rule,
                                   ph_error *err);
PH_API void ph_sequence_add(ph_sequence *s, double x);
/** Interval of the mean of the values so far, half width t(n - 1) s_n / sqrt(n); NaN below
 *  two values. */
PH_API ph_interval ph_sequence_interval(const ph_sequence *s);

/** One point of a sweep: a case, and what makes it different from the others. */
typedef struct ph_campaign_point {
    char **value;   /* [nkeys] YAML text */
    double *number; /* [nkeys] the value where it is a number, else NaN */
    ph_case *c;
    ph_case *model[PH_MAX_MODELS]; /* cheaper models of c, from 1 on */
    ph_grid_pair
        grid; /* two models on two grids, else alike: for the discretisation; ratio
                        * 0: none */
} ph_campaign_point;

/** Measurements to draw beside the means. */
typedef struct ph_campaign_data {
    char file[512]; /* "": none; relative to the campaign's folder */
    char key[160], x[PH_TABLE_NAME];
    char quantity[96], y[PH_TABLE_NAME], sigma[PH_TABLE_NAME];
} ph_campaign_data;

/** A size of the RVE that was weighed. */
typedef struct ph_campaign_size {
    double factor; /* edge over that of the case */
    double size[3];
    ptrdiff_t nodes[PH_SPLIT_GRIDS][3]; /* on every grid, that of the pilots first */
    int64_t pilots;                     /* of every point; 0: none */
    char reason[240];                   /* why it was left out; "": it was not */
} ph_campaign_size;

/** How the size of the RVE was chosen (ph_campaign_choose_size). */
typedef struct ph_campaign_sizes {
    double accuracy; /* over the mean, or (`absolute`) in the unit of the output */
    bool absolute;
    double exponent; /* of the law of the bias */
    int n, ntried;   /* sizes; those with pilots, in the order of the answer */
    int tried[PH_SPLIT_SIZES];
    ph_campaign_size size[PH_SPLIT_SIZES];
    int ngrids;                         /* that were weighed */
    ptrdiff_t nodes[PH_SPLIT_GRIDS][3]; /* of them, at the case's own edge */
    double grid_error[PH_SPLIT_GRIDS];
    ph_split_answer *answer; /* NULL: not even two sizes could be tried */
    bool chosen;             /* the campaign is that of the size; else only a report */
    char why[400];           /* the choice, or why there is none */
} ph_campaign_sizes;

/** A campaign file, parsed and checked, with the case of every point. Owns its arrays. */
typedef struct ph_campaign {
    char path[512], folder[512], title[256];
    char case_path[1024];
    int nkeys;
    char **key; /* [nkeys] dotted keys of the case */
    int npoints;
    ph_campaign_point *point;
    int noutputs;
    ph_quantity *output;
    ph_stopping stopping;
    double relative_error; /* in place of a half width: that of grid and interval together
                            * (ph_estimation_rule.total), over the mean; 0: not asked for */
    double grid_error;     /* of the grid that ph_campaign_settle chose, over the mean */
    int judged;            /* the output of the stopping rule, or -1 */
    int nfactors;          /* sizes of the RVE to choose from; 0: the size is given */
    double factor[PH_SPLIT_SIZES]; /* edges over that of the case, increasing */
    ph_campaign_sizes *sizes;      /* what came of it, or NULL */
    double seconds, memory;        /* budget: wall clock of a run, bytes; 0: no end */
    bool common_random_numbers;
    /* Variance reduction: cheaper models of each point, with the same realisations. */
    ph_quantity
        *cheap;        /* [noutputs] what the cheaper models have in place of the outputs:
                         * stretch.E1, one load, for E1, three */
    int nmodels;       /* the case and its cheaper models; 1: none */
    int fillers_model; /* the model that is read off the fillers (ph_rve_describe), or -1 */
    const char *method;                  /* in ph_estimators[], or NULL: auto */
    int64_t pilot;                       /* 0: default */
    char model_name[PH_MAX_MODELS][256]; /* what each differs in */
    ph_campaign_data data;
    uint64_t hash; /* of everything that makes a realisation what it is: the resolved case
                    * of every point, its voxel file, the outputs; not of the stopping rule */
} ph_campaign;

enum { PH_CAMPAIGN_POINTS = 10000 }; /* most points */

/** Read a campaign file and the case of every point. Format: docs/campaigns.md.
 *  @param[in] sets overrides of the case, applied to every point before its own
 *  @param[out] issues as ph_case_read; complaints about the case of a point name the point
 *  @return as ph_case_read. Tested: tests/io/test_campaign_file.c */
PH_API ph_status ph_campaign_read(const char *path, const char *const *sets, size_t nsets,
                                  ph_campaign **out, ph_case_issues *issues,
                                  ph_error *err);
/** The same from text; `name` stands for the file in messages and for its folder. */
PH_API ph_status ph_campaign_parse(const char *text, size_t length, const char *name,
                                   const char *const *sets, size_t nsets,
                                   ph_campaign **out, ph_case_issues *issues,
                                   ph_error *err);
PH_API void ph_campaign_free(ph_campaign **campaign);
/** Why the discretisation of output k at a point cannot be had from its models; NULL: it can. */
PH_API const char *ph_campaign_no_grid(const ph_campaign *c, int point, int k);
/** What ph_campaign_settle chose. */
typedef struct ph_campaign_split {
    double accuracy;    /* relative error of the mean, grid and interval together */
    double grid;        /* estimated error of the grid; 0: there was nothing to split */
    double half_width;  /* what is left for the interval, relative */
    ptrdiff_t nodes[3]; /* of every point */
    int pilots;         /* realisations that were solved for it */
    double seconds;
} ph_campaign_split;

/** Choose the grid of a campaign whose case asks for an accuracy in place of nodes, with
 *  `realisations.until.relative_error` t and no variance reduction.
 *
 *  A realisation on n nodes an axis costs n^d and has an error a / n of the grid, N of them
 *  leave an interval of half width z s / sqrt(N). The cheapest N n^d with a / n + z s / sqrt(N)
 *  = t has
 *
 *      error of the grid  t d / (d + 2),    half width  2 t / (d + 2),
 *
 *  whatever a, z and s. Realisation 0 of every point is solved to that error of the grid
 *  (ph_fidelity_solve); all points get the finest of these grids, and the interval the rest of
 *  t over the estimate. The size of the RVE: ph_campaign_choose_size.
 *  @param[in,out] c read again with the nodes; as it was on failure, and where no point is open
 *  @return PH_OK; PH_EINVAL (points of different boxes); as ph_fidelity_solve, with
 *          PH_ENOCONV where the budget of the case ends before. Uses one thread, so that the
 *          campaign may fork after it. Tested: tests/unit/test_settle.c */
PH_API ph_status ph_campaign_settle(ph_campaign **c, const char *const *sets,
                                    size_t nsets, const ph_ctx *ctx,
                                    ph_campaign_split *out, ph_error *err);
/** The realisation that number i of a point is: i itself, so that all points see the same
 *  random numbers; without common random numbers point 2^32 + i. */
PH_API uint64_t ph_campaign_realisation(const ph_campaign *c, int point, int64_t i);

/** Where a campaign is. */
typedef struct ph_campaign_progress {
    int points, points_done, point; /* point: of the last result */
    int64_t realisations;           /* on disk, those of earlier runs too */
    int64_t wanted;                 /* in all, as far as is certain */
    int64_t failed;
    double seconds, to_go; /* of this run; to_go: NaN where unknown */
    ph_interval mean;      /* of the judged (or first) output at `point` */
    int workers, threads;  /* processes, threads of each */
    const char *event;     /* something to say (a worker died), or NULL */
    const char *stage;     /* "pilots at 0.7 of the edge", or NULL: the campaign itself */
} ph_campaign_progress;

/** How a campaign is run. Zeroed: all defaults. */
typedef struct ph_campaign_params {
    const char *folder; /* of realisations.jsonl */
    int jobs;           /* processors to use; 0: all that this process may use */
    int threads;        /* of each worker; 0: 1 unless memory allows fewer workers only */
    size_t memory;      /* bytes that all workers may take; 0: 80 % of the machine's */
    int shard, shards;  /* this is shard 1 .. shards of so many; 0: the whole campaign */
    bool retry_failed;  /* compute again what failed */
    double seconds;     /* wall clock that the call may take; 0: the campaign's budget */
    const char *stage;  /* handed on to `progress` */
    /* Instead of ph_scenario_evaluate, in a worker process: e.g. known distributions. */
    ph_status (*evaluate)(void *user, const ph_scenario *scenario, int point,
                          ph_evaluation *out, ph_error *err);
    void *evaluate_user;
    bool (*progress)(void *user, const ph_campaign_progress *now); /* false: stop */
    void *user;
} ph_campaign_params;

/** Statistics of one output at one point. */
typedef struct ph_campaign_mean {
    int64_t n;
    ph_interval mean;       /* half width at the confidence of the campaign */
    ph_discretisation bias; /* what the grid adds; NaN and n = 0 where it is not known */
} ph_campaign_mean;

/** Statistics of one point. */
typedef struct ph_campaign_summary {
    int64_t counted, failed;  /* realisations 0 .. counted - 1 make the statistics */
    bool complete;            /* the stopping rule has all that it wants */
    bool reached;             /* the half width asked for is reached, or none was */
    ph_campaign_mean *output; /* [noutputs] */
    const ph_estimation *estimation; /* of the judged (or first) output, or NULL */
} ph_campaign_summary;

/** What a campaign knows so far. */
typedef struct ph_campaign_result {
    int npoints, noutputs;
    ph_campaign_summary *point;
    ph_campaign_mean *all;     /* [npoints][noutputs], held for the points */
    ph_estimation *estimation; /* [npoints] with variance reduction, else NULL */
    int64_t realisations, failed;
    int64_t dropped;   /* damaged lines that were found and computed again */
    int64_t differing; /* realisations that came with two results */
    bool complete;
} ph_campaign_result;
PH_API void ph_campaign_result_free(ph_campaign_result **result);

/** Compute what is missing of a campaign, and sum up.
 *
 *  Realisations are computed by worker processes, each written to realisations.jsonl as one
 *  line, on disk before it counts; what was there before is not computed again. The result
 *  is that of computing all realisations in the order of their indices, bit for bit, whatever
 *  the workers, shards, interruptions. A worker that dies costs one more trial of its
 *  realisation, which is then marked as failed.
 *  Shards: with a stopping rule shard k of n has the points p with p mod n = k - 1, else the
 *  realisations with (i npoints + p) mod n = k - 1.
 *  The caller must not have used OpenMP in this process before (workers are forked).
 *  @return PH_OK; PH_EPARTIAL (some realisations failed; the result is there); PH_ECANCELLED
 *          (what was computed is on disk; the result is there); PH_ENOCONV (the budget ends
 *          first, or the pilots say that it will; the result is there but where not even one
 *          realisation fits into the memory); PH_EIO (the folder is in use
 *          or holds another campaign, disk full); PH_EINVAL; PH_ENOMEM.
 *  Tested: tests/unit/test_campaign.c, tests/cli/campaign.sh */
PH_API ph_status ph_campaign_run(const ph_campaign *c, const ph_campaign_params *params,
                                 ph_campaign_result **out, ph_error *err);
/** Choose the size of the RVE of a campaign with `size: auto` or edges to choose from.
 *
 *  Pilots of two sizes, the smallest first, in params->folder/sizes: what they show
 *  (ph_split_choose) says whether to go on with one of them, to try the next larger one or to
 *  double the pilots first. All sizes have the spacing of the case, on which the fillers are
 *  drawn; sizes and grids are moved by up to 8 % to numbers of nodes that transform well. Where
 *  ph_campaign_settle chose the grid before, coarser and finer ones are weighed too.
 *  The pilots of the chosen size are the first realisations of the campaign: they are brought
 *  to params->folder, and at_least becomes their number. Numbers and choice depend neither on
 *  workers nor on clocks; the budget of seconds only ends it.
 *  @param[in,out] c that of the chosen size, which has `sizes`; where there is nothing to
 *          choose as it was; on failure as it was, with `sizes` where some were tried
 *  @return PH_OK; PH_ENOCONV (no size meets the accuracy, or the budget does not reach to it:
 *          the message says what it takes and what it affords); PH_EINVAL (fewer than two
 *          sizes can be had); as ph_campaign_run. Tested: tests/unit/test_size.c */
PH_API ph_status ph_campaign_choose_size(ph_campaign **c, const char *const *sets,
                                         size_t nsets, const ph_campaign_params *params,
                                         ph_error *err);
/** Bring the realisations of other folders into `folder`: in any order, any number of times
 *  the same file comes out. Of two results of one realisation a success is taken before a
 *  failure, then the first in the order of bytes.
 *  @return as ph_campaign_run */
PH_API ph_status ph_campaign_merge(const ph_campaign *c, const char *folder,
                                   const char *const *from, size_t nfrom,
                                   ph_campaign_result **out, ph_error *err);
/** Only sum up what is there. @return as ph_campaign_run; PH_EIO where nothing is there, and
 *  no folder is made */
PH_API ph_status ph_campaign_summarise(const ph_campaign *c, const char *folder,
                                       ph_campaign_result **out, ph_error *err);
/** The document of schema perihom.campaign/1 (docs/campaigns.md), malloc'd: the same bytes
 *  for the same realisations. */
PH_API ph_status ph_campaign_to_json(const ph_campaign *c,
                                     const ph_campaign_result *result, char **json,
                                     ph_error *err);

/** Everything that follows from the realisations: campaign.json, campaign.h5 and the plots.
 *  Each file is whole or not there. Docs: docs/campaigns.md.
 *  @return PH_OK; PH_EIO; PH_ENOMEM */
PH_API ph_status ph_campaign_write(const ph_campaign *c, const char *folder,
                                   const ph_campaign_result *result, ph_error *err);

#ifdef __cplusplus
}
#endif
#endif
