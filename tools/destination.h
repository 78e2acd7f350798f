/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The folder of a result: who may write there, and writing all of it or nothing. */
#ifndef TOOLS_DESTINATION_H
#define TOOLS_DESTINATION_H

#include <perihom/error.h>

enum { DESTINATION_PATH = 1024 };

/** A result on its way: files go to `stage`, a folder inside `dir`, and move up at once. */
typedef struct destination {
    char dir[DESTINATION_PATH];
    char stage[DESTINATION_PATH + 32];
    bool made; /* `dir` was not there before */
} destination;

/** "NAME-results" for a case file called .../NAME.yaml. */
void destination_default(const char *case_path, char dir[DESTINATION_PATH]);
/** May `dir` take the result of this case? Writes nothing.
 *  @param[in] case_json the resolved case; a result.json in `dir` must be of the same case
 *  @return PH_OK; PH_EIO with the reason: another case is there (not with `force`), not a
 *          folder, no permission. */
ph_status destination_check(const char *dir, const char *case_json, bool force,
                            ph_error *err);
/** Make `dir` with its parents; one that is there is fine. */
ph_status destination_make(const char *dir, ph_error *err);
/** Make `dir` with its parents, and the stage in it. */
ph_status destination_open(destination *d, const char *dir, ph_error *err);
/** Path of a file in the stage. */
void destination_file(const destination *d, const char *name, char *path, size_t size);
/** Move every file of the stage to `dir`, result.json last; files of an earlier result that
 *  this one does not have are removed. */
ph_status destination_commit(destination *d, ph_error *err);
/** Remove the stage and what is in it; also `dir` if it was made for this result.
 *  No effect after commit. */
void destination_discard(destination *d);

#endif
