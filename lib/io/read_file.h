/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PH_IO_READ_FILE_H
#define PH_IO_READ_FILE_H

#include "core/check.h"

/** All bytes of a file or pipe, malloc'd, with a zero after them that `length` does not count.
 *  @param[in] most bytes; `what` it should be ("case file"), for messages
 *  @return PH_OK; PH_EIO (cannot be opened or read); PH_EINVAL (more than `most`); PH_ENOMEM */
ph_status ph_i_read_file(const char *path, size_t most, const char *what, char **text,
                         size_t *length, ph_error *err);

#endif
