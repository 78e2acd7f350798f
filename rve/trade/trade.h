/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inside of a trade: one file a step. */
#ifndef RVE_TRADE_H
#define RVE_TRADE_H

#include "campaign/campaign.h"

#include <perihom_trade.h>

enum { PH_I_TRADE_RUNGS = 32 };

/** A sweep at work. */
typedef struct ph_i_trade {
    const ph_trade_params *params;
    ph_trade *t;
    ph_case *c; /* as the caller has it */
    int nrungs;
    ptrdiff_t rung[PH_I_TRADE_RUNGS]; /* nodes of the longest axis; 0: as the case */
    uint64_t *hash;                   /* [capacity] of each row: what it computes */
    struct ph_i_trade_kept *kept;     /* rows of the journal, or NULL */
    int planned;                      /* rows that are known to come */
    bool given;                       /* the reference is given, not found */
} ph_i_trade;

/** Seconds of CPU time of this process. */
double ph_i_cpu_seconds(void);

/* ---- solve.c */

/** Override "KEY=VALUE" at the end of a row. PH_EINVAL where there is no room. */
ph_status ph_i_trade_add_set(ph_trade_row *row, const char *set, ph_error *err);
/** Solve a row unless there is one alike, the journal has it or the budget is used up, and put
 *  it at the end. Rows that cannot be solved are put there with the reason. */
ph_status ph_i_trade_take(ph_i_trade *s, const ph_trade_row *row, ph_error *err);

/* ---- journal.c: rows.jsonl */

typedef struct ph_i_trade_kept {
    int count, capacity;
    uint64_t *hash;
    ph_trade_row *row;
} ph_i_trade_kept;
ph_status ph_i_trade_journal_read(const char *folder, int nconstants,
                                  ph_i_trade_kept **out, ph_error *err);
void ph_i_trade_kept_free(ph_i_trade_kept **kept);
/** Results of the row with this hash into `row`, whose words stay. */
bool ph_i_trade_recall(const ph_i_trade_kept *kept, uint64_t hash, ph_trade_row *row);
ph_status ph_i_trade_journal_add(const char *folder, int nconstants, uint64_t hash,
                                 const ph_trade_row *row, ph_error *err);

/* ---- reference.c */

/** Constants and, where it is given, the reference. */
ph_status ph_i_trade_begin(ph_i_trade *s, ph_error *err);
/** The reference from the two finest grids of the case as it is; none where fewer are solved. */
void ph_i_trade_find_reference(ph_trade *t);
bool ph_i_trade_has_reference(const ph_trade *t);
/** Fill t->unsolved. */
void ph_i_trade_say_unsolved(ph_trade *t);

/* ---- judge.c */

/** The error of means over realisations, once all are there: standard error and the distance
 *  to the mean of the largest RVE. */
void ph_i_trade_judge_means(ph_trade *t);

/* ---- report.c */

/** At the end of `text`, cut at `size`, a word as a shell takes it: in quotes where it has anything but plain letters. */
void ph_i_trade_word(char *text, size_t size, const char *word);
/** "perihom run CASE --set ..." of a row, quoted for a shell. */
void ph_i_trade_command(const ph_trade *t, const ph_trade_row *row, char *text,
                        size_t size);

#endif
