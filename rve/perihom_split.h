/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An error parted between the size of the RVE, the grid and the number of realisations.
 * Theory: docs/theory/sampling.md. Knows nothing of cases: numbers in, numbers out. */
#ifndef PERIHOM_SPLIT_H
#define PERIHOM_SPLIT_H

#include <perihom/error.h>

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { PH_SPLIT_SIZES = 8, PH_SPLIT_GRIDS = 8 };

/** What pilot realisations of a few sizes of the RVE have shown, and what is wanted. Borrows
 *  its arrays. The same n realisations are there at every size. */
typedef struct ph_split_question {
    int dimensions;       /* d: the volume is factor^d */
    double exponent;      /* p of the law of the bias, factor^-p, > 0 */
    double accuracy;      /* of the mean, size, grid and interval together, > 0 */
    bool absolute;        /* in the unit of the values; else over the mean */
    double confidence;    /* 0 < . < 1 */
    int64_t least;        /* realisations that a point has at least, >= 2 */
    int64_t most;         /* and at most */
    int npoints;          /* of a sweep; all get one size, one grid, one half width */
    int nsizes;           /* 2 .. PH_SPLIT_SIZES that have pilots */
    int nmore;            /* sizes behind these that may be tried as well */
    const double *factor; /* [nsizes + nmore] edge over that of the case, increasing */
    int64_t n;            /* pilots, >= 4 */
    const double *value;  /* [nsizes][npoints][n], NaN: failed */
    const double *cost;   /* [nsizes][npoints] of one realisation, any unit, > 0 */
    int ngrids;           /* 1 .. PH_SPLIT_GRIDS, the first is that of the pilots */
    const double *grid_error; /* [ngrids] over the mean, >= 0 */
    const double *grid_cost;  /* [ngrids] over the cost on the first */
} ph_split_question;

/** What the pilots say of one point at one size. */
typedef struct ph_split_size {
    int64_t n; /* pilots that did not fail */
    double mean;
    double deviation; /* of a realisation, as its pilots have it */
    double scatter;   /* the same, as it is reckoned with */
    double bias;      /* mean less that of infinitely large cells */
    double bias_half_width;
} ph_split_size;

/** A size on a grid: what it would take. */
typedef struct ph_split_candidate {
    int size, grid;
    bool meets; /* the accuracy can be reached with it */
    int point;  /* the one that leaves least to the interval */
    double bias,
        bias_half_width; /* of that point, over its mean (absolute: in its unit) */
    double half_width;   /* what is left for the interval, of all points; NaN: nothing */
    double error;  /* of the number that is needed; meets false: of the pilots as they
                        * are (of `least` realisations on another grid) */
    double needed; /* realisations of all points together, pilots among them */
    double cost;   /* of these, pilots of this size among them */
    double to_go;  /* of those that are not there */
} ph_split_candidate;

typedef enum ph_split_step {
    PH_SPLIT_CHOSEN, /* the campaign may go on with `chosen` */
    PH_SPLIT_LARGER, /* pilots of the next size first */
    PH_SPLIT_MORE,   /* twice as many pilots of all sizes first */
    PH_SPLIT_NONE    /* no plan meets the accuracy, and edges up to 1 were tried */
} ph_split_step;

/** The answer. Owns its arrays. */
typedef struct ph_split_answer {
    ph_split_step step;
    int chosen;      /* candidate of least cost to go, -1: none meets the accuracy */
    int nearest;     /* candidate of least error */
    int ncandidates; /* sizes x grids, grids run fastest */
    ph_split_candidate *candidate;
    ph_split_size *point; /* [nsizes][npoints] */
    bool one_scatter;     /* variance ~ 1 / volume was taken for granted at every point */
    double pilot_cost;    /* of all pilots */
    double factor_needed; /* an edge at which the bias takes half of what the grid leaves;
                           * 0: the bias cannot be told from zero */
} ph_split_answer;
PH_API void ph_split_answer_free(ph_split_answer **answer);

/** Part an error between size, grid and number at least cost.
 *
 *    mean of a size   m(f) = m + a f^-p,   scatter   s(f)^2 = A f^-d
 *
 *  a by least squares with weights f^d, realisation by realisation: a_i = sum_k c_k x_i(f_k),
 *  so that a and its interval are those of n independent numbers, whatever realisations of
 *  one index at two sizes have in common. A is common to all sizes unless Bartlett's test
 *  [Bartlett1937] tells the variances times the volumes apart at 5 %: then each has its own.
 *  A candidate meets the accuracy t if
 *
 *    |b| + g + sqrt(w^2 + h^2) <= t |mean|,     b = a f^-p +- w,  g: grid,  h: interval
 *
 *  b is never taken for zero: where it cannot be told from it, its estimate and half width
 *  count all the same. Of those that do, the one with the least cost of what is not there yet
 *  is chosen, of equal ones that with the least error. Plans with larger sizes and 2, 4 .. 1024
 *  times as many pilots are weighed in the same way, with b as it is now and w as the pilots
 *  will make it; `step` is the first step of the cheapest plan.
 *  @return PH_OK; PH_EINVAL (the question); PH_ESINGULAR (fewer than four realisations that
 *          did not fail at all sizes, a mean of zero); PH_ENOMEM.
 *          Cost: O(sizes points pilots). Tested: tests/unit/test_split.c */
PH_API ph_status ph_split_choose(const ph_split_question *q, ph_split_answer **out,
                                 ph_error *err);
/** The accuracy that a cost (beside the pilots') affords, best candidate; in the unit of
 *  ph_split_question.accuracy. Realisations are dealt to the points evenly. */
PH_API double ph_split_afforded(const ph_split_question *q, const ph_split_answer *answer,
                                double cost);

#ifdef __cplusplus
}
#endif
#endif
