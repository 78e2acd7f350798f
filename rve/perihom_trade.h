/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What accuracy costs: the settings of a case, the error of each and what it takes. */
#ifndef PERIHOM_TRADE_H
#define PERIHOM_TRADE_H

#include <perihom_campaign.h>

#ifdef __cplusplus
extern "C" {
#endif

/** A setting of a computation that trades accuracy for cost. */
typedef struct ph_knob {
    ph_entry info;
    const char *key; /* of the case file; NULL: none (threads, rve) */
    /* overrides of the case to try, one or more KEY=VALUE separated by blanks, ended by NULL;
     * NULL: they follow from the case */
    const char *const *values;
    /** Why it does not apply to a case, or NULL. */
    const char *(*refuses)(const ph_case *c);
} ph_knob;
PH_API extern const ph_knob ph_knobs[];
PH_API extern const size_t ph_nknobs;

enum {
    PH_TRADE_CONSTANTS = 16,
    PH_TRADE_SETS = 8,
    PH_TRADE_TARGETS = 3,
    PH_TRADE_ROWS = 4096
};

typedef enum ph_trade_state {
    PH_TRADE_DONE,
    PH_TRADE_REFUSED, /* the case is not admissible with this setting */
    PH_TRADE_FAILED,  /* not converged, singular, out of memory */
    PH_TRADE_SKIPPED  /* the budget was used up */
} ph_trade_state;

/** One setting: what it is, what came out and what it took. */
typedef struct ph_trade_row {
    char knob[32]; /* the knob that it turns, or "grid" for the sweeps over grids */
    char family
        [160]; /* everything but the grid: "model.points=nodes" ...; "": as the case */
    char setting[240]; /* all overrides, for people and for --set */
    int nsets;
    char set[PH_TRADE_SETS][96];
    int threads;
    int realisations; /* mean over so many; 1: one solution */
    ptrdiff_t nodes;  /* cells of the RVE */
    ph_trade_state state;
    ph_status status;
    char reason[256]; /* of what was refused or failed */
    double value[PH_TRADE_CONSTANTS];
    double error; /* worst relative error of the constants; NaN: not known */
    int iterations;
    long applications, ffts;
    size_t bytes;
    double work;         /* floating-point operations, counted: ph_trade_work */
    double cpu, seconds; /* CPU and wall clock, microstructure and solution */
    bool front;          /* no cheaper row (work) has a smaller error */
    bool kept;           /* came from the journal */
} ph_trade_row;

/** The cheapest setting for an accuracy. */
typedef struct ph_trade_advice {
    double target; /* relative error */
    int row;       /* -1: nothing of the sweep reaches it */
    char command[640];
} ph_trade_advice;

typedef struct ph_trade_progress {
    int done, rows;          /* rows so far; known to come */
    double cpu;              /* seconds used by this run */
    const ph_trade_row *row; /* the last one */
} ph_trade_progress;

/** How to trade. Zeroed but for `path`: all defaults. Borrows everything. */
typedef struct ph_trade_params {
    const char *path; /* case file */
    const char *const *sets;
    size_t nsets;
    const char *const *constants; /* names of quantities; none: see ph_trade_constants */
    size_t nconstants;
    const char
        *reference;     /* a result.json, or "E1=143.9,G12=45.8"; NULL: own finest grid */
    const char *folder; /* of rows.jsonl, where rows are kept; NULL: nowhere */
    const char *const *knobs; /* names of the knobs to turn; none: all */
    size_t nknobs;
    ptrdiff_t finest; /* nodes of the longest axis on the finest grid; 0: by the case */
    double budget;    /* CPU seconds; 0: no end */
    int threads;      /* of every row but those of knob threads; 0: 1 */
    bool (*progress)(void *user, const ph_trade_progress *now); /* false: stop */
    void *user;
} ph_trade_params;

/** A sweep over the knobs of one case. Owns its arrays. */
typedef struct ph_trade {
    char path[512], title[256];
    char base_sets
        [512]; /* KEY=VALUE of the call, each ended by a zero; an empty one ends them */
    int axes;  /* of the grid with more than one cell */
    int nconstants;
    ph_quantity constant[PH_TRADE_CONSTANTS];
    char reference_kind[320]; /* what the errors are relative to; "none: ..." says why */
    double
        reference[PH_TRADE_CONSTANTS]; /* NaN: there is none, and no error, no advice */
    double
        reference_error; /* estimated, relative, worst constant; 0: exact as far as known */
    int nrows, capacity;
    ph_trade_row *row;
    ph_trade_advice advice[PH_TRADE_TARGETS];
    char unsolved[256]; /* why no grid of the case as it is was solved; "": one was */
    double cpu;         /* of all rows */
    bool complete;      /* there is a reference, and nothing was skipped */
} ph_trade;
PH_API void ph_trade_free(ph_trade **trade);

/** The constants that are judged where none are named: E, G and nu_12, nu_13, nu_23 of the
 *  kinematics; with materials that relax, these at once and at the longest relaxation time.
 *  @param[out] out [PH_TRADE_CONSTANTS]; @return how many */
PH_API int ph_trade_constants(const ph_case *c, ph_quantity *out);
/** |value - reference| over |reference|; of a Poisson's ratio below 0.1 over 0.1, because a
 *  ratio near zero has no relative error that means anything. */
PH_API double ph_trade_error(const ph_quantity *q, double value, double reference);
/** Floating-point operations of a solution from its counters: 5/2 n log2 n a real transform,
 *  and a cell, per application, those of strain, stress and force, per iteration those of
 *  conjugate gradients and of the preconditioner. Deterministic; a measure to rank settings by,
 *  within a factor of two of hardware counters. */
PH_API double ph_trade_work(const ph_result *result);

/** Sweep the knobs of a case.
 *
 *  1. A ladder of grids, crossed with the kinds of points, interface and model.
 *  2. Every knob on its own, on a grid in the middle of the ladder.
 *  3. The ladder again with looser tolerances, for what is on the front by then.
 *
 *  Each row is solved as `perihom run CASE --set ...` would. The errors are relative to the
 *  reference; without one, to the values extrapolated from the two finest grids of the case
 *  as it is (first order in the spacing), whose own error is estimated as their distance to
 *  the finest grid's. Where fewer than two grids of the case are solved there is no reference:
 *  the sweep ends after its first part, and `reference_kind` says why. Rows that cannot be
 *  solved stay with their reason. Cases whose bonds break are refused.
 *  @param[out] out on PH_OK and PH_ECANCELLED (what is there so far)
 *  @return PH_OK; PH_EINVAL, PH_EUNPHYSICAL (case, constants, reference); PH_EIO; PH_ENOMEM;
 *          PH_ECANCELLED. Tested: tests/unit/test_trade.c */
PH_API ph_status ph_trade_run(const ph_trade_params *params, ph_trade **out,
                              ph_case_issues *issues, ph_error *err);
/** Errors, front and advice of rows that were solved. Public for tests: ph_trade_run calls it.
 *  A row is advised where its error is at most the target, and that of every finer grid with
 *  the same settings too: an error that is small by chance is not advised. */
PH_API void ph_trade_judge(ph_trade *trade);

/** The document of schema perihom.trade/1 (docs/accuracy-costs.md), malloc'd. */
PH_API ph_status ph_trade_to_json(const ph_trade *trade, char **json, ph_error *err);
/** The rows as a table, malloc'd. */
PH_API ph_status ph_trade_to_csv(const ph_trade *trade, char **text, ph_error *err);
/** The front as a self-contained page, malloc'd: advice, figures, rows. */
PH_API ph_status ph_trade_to_html(const ph_trade *trade, char **text, ph_error *err);
/** Error against work as SVG; `seconds`: against CPU seconds. */
PH_API ph_status ph_trade_plot(const ph_trade *trade, bool seconds, char **svg,
                               ph_error *err);

#ifdef __cplusplus
}
#endif
#endif
