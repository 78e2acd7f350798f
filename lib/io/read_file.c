/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/read_file.h"

#include <errno.h>
#include <string.h>

ph_status ph_i_read_file(const char *path, size_t most, const char *what, char **text,
                         size_t *length, ph_error *err)
{
    ph_status st = PH_OK;
    size_t capacity = 1 << 16, used = 0;
    char *buffer = NULL;
    FILE *file = fopen(path, "rb");
    PH_CHECK(file != NULL, PH_EIO, "%s: cannot be opened: %s", path, strerror(errno));
    PH_ALLOC(buffer, capacity, what);
    for (;;) {
        used += fread(buffer + used, 1, capacity - 1 - used, file);
        if (used < capacity - 1) break;
        PH_CHECK(used <= most, PH_EINVAL, "%s: more than %zu MB: not a %s", path,
                 most >> 20, what);
        capacity *= 2;
        char *grown = realloc(buffer, capacity);
        PH_CHECK(grown != NULL, PH_ENOMEM, "no memory for a %s", what);
        buffer = grown;
    }
    PH_CHECK(!ferror(file), PH_EIO, "%s: cannot be read: %s", path, strerror(errno));
    PH_CHECK(used <= most, PH_EINVAL, "%s: more than %zu MB: not a %s", path, most >> 20,
             what);
    buffer[used] = 0;
    *text = buffer;
    *length = used;
    buffer = NULL;
out:
    if (file) fclose(file);
    free(buffer);
    return st;
}
