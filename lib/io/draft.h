/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A file that appears under its name only when it is complete: everything that perihom
 * writes goes through a draft, so a reader sees the old file or the new one, never half. */
#ifndef PH_IO_DRAFT_H
#define PH_IO_DRAFT_H

#include "core/check.h"

enum { PH_I_PATH = 4096 };

typedef struct ph_i_draft {
    char target[PH_I_PATH]; /* what it will be called, symbolic links followed */
    char path[PH_I_PATH]; /* where to write now: beside the target, in the same folder */
    bool in_place;        /* the target is a device or a pipe: nothing to rename */
    bool open;            /* between begin and commit or discard */
} ph_i_draft;

/** Create the empty draft of `path`.
 *  @return PH_OK; PH_EIO (folder missing, not a folder, not writable, name too long, target
 *          is a folder). On failure nothing is left behind. */
ph_status ph_i_draft_begin(ph_i_draft *draft, const char *path, ph_error *err);
/** To disk, then under its name. On failure the draft is gone and the old file untouched. */
ph_status ph_i_draft_commit(ph_i_draft *draft, ph_error *err);
/** Remove the draft if it was not committed. Does nothing on a zeroed draft. */
void ph_i_draft_discard(ph_i_draft *draft);

/** PH_EIO (PH_ENOMEM where errno says so) with "cannot <verb> '<path>': <what errno says>". */
ph_status ph_i_io_error(ph_error *err, const char *verb, const char *path, int number);

#endif
