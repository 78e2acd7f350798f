/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inside of calibration files: reading, the journal of evaluations, the documents. */
#ifndef RVE_CALIBRATE_FILE_H
#define RVE_CALIBRATE_FILE_H

#include "core/check.h"
#include "io/case_internal.h"
#include "io/json.h"

#include <perihom_calibrate.h>

/* ---- file_data.c */

/** `data` of a calibration file: columns and sigma. Complaints go to r. */
ph_status ph_i_fit_read_data(ph_i_reader *r, const ph_i_node *node, const char *folder,
                             ph_fit_file *file, ph_error *err);

/* ---- file_run.c */

/** The case at a point, "key=value" of every key and unknown put in. */
ph_status ph_i_fit_case(const ph_fit_file *file, int point, const double *unknown,
                        ph_case **out, ph_case_issues *issues, ph_error *err);

/* ---- journal.c: what was solved, one line a realisation */

/** Realisation of the model: `place` are the values of keys, then unknowns. */
typedef struct ph_i_fit_record {
    double place[PH_FIT_KEYS + PH_FIT_UNKNOWNS];
    uint64_t realisation;
    ph_status status; /* PH_OK, or why it failed */
    double value[PH_FIT_OUTPUTS];
    char message[256];
} ph_i_fit_record;

typedef struct ph_i_fit_journal {
    int fd; /* -1: none is kept */
    char path[1024];
    const ph_fit_file *file;
    size_t count, capacity;
    ph_i_fit_record *record; /* [count] read back, sorted */
    double synced;           /* when, seconds */
} ph_i_fit_journal;

/** Open or begin `dir`/evaluations.jsonl, lock it, and read what it holds. A last line that
 *  was cut off by a crash is removed. @param[in] dir NULL: an empty journal that keeps nothing */
ph_status ph_i_fit_journal_open(ph_i_fit_journal *j, const ph_fit_file *file,
                                const char *dir, bool retry, ph_error *err);
/** What is known of a realisation, or NULL. */
const ph_i_fit_record *ph_i_fit_journal_find(const ph_i_fit_journal *j,
                                             const double *place, uint64_t realisation);
/** Write a line, whole or not at all. One thread at a time. */
ph_status ph_i_fit_journal_add(ph_i_fit_journal *j, const ph_i_fit_record *record,
                               ph_error *err);
void ph_i_fit_journal_close(ph_i_fit_journal *j);

#endif
