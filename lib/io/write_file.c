/* SPDX-License-Identifier: GPL-3.0-or-later */
#define _XOPEN_SOURCE 700 /* realpath */
#include <perihom/output.h>

#include "io/draft.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

ph_status ph_i_io_error(ph_error *err, const char *verb, const char *path, int number)
{
    char text[128];
    if (strerror_r(number, text, sizeof text) != 0)
        snprintf(text, sizeof text, "error %d", number);
    const char *hint = number == ENOENT    ? " (does the folder exist?)"
                       : number == ENOTDIR ? " (a part of the path is a file)"
                       : number == EFBIG   ? " (file size limit of this process)"
                                           : "";
    return PH_FAIL(err, number == ENOMEM ? PH_ENOMEM : PH_EIO, "cannot %s '%.300s': %s%s",
                   verb, path, text, hint);
}

/* Length of the folder part of a path, the slash not counted; 0: no slash. */
static size_t folder_length(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? (size_t)(slash - path) + (slash == path) : 0;
}

/* The file that `path` means: the end of a symbolic link, if it exists. */
static ph_status resolve_target(ph_i_draft *draft, const char *path, ph_error *err)
{
    ph_status st = PH_OK;
    struct stat about;
    PH_CHECK(path && path[0], PH_EINVAL, "no file name to write to");
    PH_CHECK(strlen(path) < sizeof draft->target, PH_EIO,
             "cannot write '%.100s...': the path is longer than %d characters", path,
             PH_I_PATH - 1);
    strcpy(draft->target, path);
    if (lstat(path, &about) == 0 && S_ISLNK(about.st_mode)) {
        char *end = realpath(path, NULL);
        if (end && strlen(end) < sizeof draft->target) strcpy(draft->target, end);
        free(end);
    }
    if (stat(draft->target, &about) != 0) goto out; /* new, or its folder will complain */
    if (S_ISDIR(about.st_mode)) {
        st = ph_i_io_error(err, "write", path, EISDIR);
        goto out;
    }
    draft->in_place = !S_ISREG(about.st_mode);
out:
    return st;
}

ph_status ph_i_draft_begin(ph_i_draft *draft, const char *path, ph_error *err)
{
    ph_status st = PH_OK;
    memset(draft, 0, sizeof *draft);
    PH_TRY(resolve_target(draft, path, err));
    if (draft->in_place) {
        strcpy(draft->path, draft->target);
        draft->open = true;
        goto out;
    }
    size_t folder = folder_length(draft->target);
    PH_CHECK(folder + 64 < sizeof draft->path, PH_EIO, "cannot write '%.100s...': %s",
             path, "the path is too long");
    int fd = -1;
    for (int attempt = 0; attempt < 1000 && fd < 0; attempt++) {
        /* its own short name: one derived from the target could exceed NAME_MAX */
        snprintf(draft->path, sizeof draft->path, "%.*s%s.perihom-%ld-%d.tmp",
                 (int)folder, draft->target, folder ? "/" : "", (long)getpid(), attempt);
        fd = open(draft->path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (fd < 0 && errno != EEXIST) break;
    }
    if (fd < 0) {
        st = ph_i_io_error(err, "create a file beside", path, errno);
        goto out;
    }
    close(fd);
    draft->open = true;
out:
    return st;
}

/* Without this a power cut could leave the new name with none of the data. */
static int sync_path(const char *path)
{
    int fd = open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0) return errno;
    int failed = fsync(fd) != 0 ? errno : 0;
    close(fd);
    return failed;
}

ph_status ph_i_draft_commit(ph_i_draft *draft, ph_error *err)
{
    ph_status st = PH_OK;
    if (draft->in_place) {
        draft->open = false;
        goto out;
    }
    int failed = sync_path(draft->path);
    if (!failed && rename(draft->path, draft->target) != 0) failed = errno;
    if (failed) {
        st = ph_i_io_error(err, "write", draft->target, failed);
        goto out;
    }
    draft->open = false;
    /* The file is whole and in place; some file systems cannot sync a folder. */
    size_t folder = folder_length(draft->target);
    snprintf(draft->path, sizeof draft->path, "%.*s", folder ? (int)folder : 1,
             folder ? draft->target : ".");
    (void)sync_path(draft->path);
out:
    ph_i_draft_discard(draft);
    return st;
}

void ph_i_draft_discard(ph_i_draft *draft)
{
    if (draft->open && !draft->in_place) (void)unlink(draft->path);
    draft->open = false;
}

/* All of `text` into an existing file; errno of what failed, or 0. */
static int write_all(const char *path, const char *text, size_t length)
{
    int fd = open(path, O_WRONLY | O_CLOEXEC), failed = 0;
    if (fd < 0) return errno;
    while (length > 0 && !failed) {
        ssize_t n = write(fd, text, length);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) {
            failed = n < 0 ? errno : ENOSPC;
        } else {
            text += n;
            length -= (size_t)n;
        }
    }
    if (close(fd) != 0 && !failed && errno != EINTR) failed = errno;
    return failed;
}

ph_status ph_write_file(const char *path, const char *text, size_t length, ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_draft draft = {.open = false};
    PH_CHECK(text || length == 0, PH_EINVAL, "no text to write");
    PH_TRY(ph_i_draft_begin(&draft, path, err));
    int failed = write_all(draft.path, text, length);
    if (failed) {
        st = ph_i_io_error(err, "write", path, failed);
        goto out;
    }
    PH_TRY(ph_i_draft_commit(&draft, err));
out:
    ph_i_draft_discard(&draft);
    return st;
}
