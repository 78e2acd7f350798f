/* SPDX-License-Identifier: GPL-3.0-or-later */
/* realisations.jsonl: whole lines at its end, on disk before they count. */
#include "campaign/campaign.h"
#include "io/draft.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { WINDOW = 1 << 17 };
_Static_assert((int)PH_I_LINE < (int)WINDOW, "a line fits into the window");

static ph_status make_folder(const char *folder, ph_error *err)
{
    ph_status st = PH_OK;
    char at[1024];
    PH_CHECK(folder && folder[0], PH_EIO, "the name of the folder is empty");
    PH_CHECK(strlen(folder) < sizeof at, PH_EIO, "the name of the folder is too long");
    strcpy(at, folder);
    for (char *p = at + 1;; p++) {
        if (*p != '/' && *p != 0) continue;
        char end = *p;
        *p = 0;
        if (mkdir(at, 0777) != 0 && errno != EEXIST) {
            st = ph_i_io_error(err, "make the folder", at, errno);
            goto out;
        }
        if (end == 0) break;
        *p = end;
    }
out:
    return st;
}

/* The lock goes with the process, however it ends. */
static ph_status take_lock(ph_i_store *s, ph_error *err)
{
    ph_status st = PH_OK;
    char path[1100];
    snprintf(path, sizeof path, "%s/campaign.lock", s->folder);
    s->lock = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (s->lock < 0) {
        st = ph_i_io_error(err, "write", path, errno);
        goto out;
    }
    PH_CHECK(flock(s->lock, LOCK_EX | LOCK_NB) == 0, PH_EIO,
             "%s: another perihom is working in this folder", s->folder);
out:
    return st;
}

static ph_status remember(ph_i_store *s, const ph_i_record *r, int64_t offset,
                          size_t length, ph_error *err)
{
    ph_status st = PH_OK;
    if (s->count == s->room) {
        size_t room = s->room + s->room / 2 + 256;
        ph_i_entry *grown = realloc(s->entry, room * sizeof *grown);
        PH_CHECK(grown, PH_ENOMEM, "no memory for %zu realisations", room);
        s->entry = grown;
        s->room = room;
    }
    s->entry[s->count++] = (ph_i_entry){.point = r->point,
                                        .failed = r->status != PH_OK,
                                        .i = r->i,
                                        .offset = offset,
                                        .length = (int32_t)length};
out:
    return st;
}

static ph_status check_header(const ph_campaign *c, const char *path, const char *line,
                              size_t length, ph_error *err)
{
    ph_status st = PH_OK;
    char mine[PH_I_LINE];
    size_t n = ph_i_record_header(c, mine);
    PH_CHECK(n == length && memcmp(mine, line, n) == 0, PH_EIO,
             "%s holds the realisations of another campaign: its case, sweep or outputs "
             "are not those of %s. Choose another folder with -o, or remove this one",
             path, c->path);
out:
    return st;
}

ph_status ph_i_store_probe(const ph_campaign *c, const char *folder, ph_error *err)
{
    ph_status st = PH_OK;
    char path[1100], line[PH_I_LINE];
    snprintf(path, sizeof path, "%s/realisations.jsonl", folder);
    FILE *file = fopen(path, "r");
    PH_CHECK(file, PH_EIO, "%s: cannot be opened: %s", path, strerror(errno));
    PH_CHECK(fgets(line, sizeof line, file), PH_EIO, "%s holds no realisations", path);
    PH_TRY(check_header(c, path, line, strlen(line), err));
out:
    if (file) fclose(file);
    return st;
}

/* Lines of the file behind `file`; what has no end is torn and does not count.
 * @param[out] end offset behind the last whole line */
static ph_status read_lines(ph_i_store *s, FILE *file, const char *path, bool merging,
                            int64_t *end, ph_error *err)
{
    ph_status st = PH_OK;
    char *line = NULL;
    size_t size = 0;
    ph_i_record r;
    *end = 0;
    for (ptrdiff_t number = 0;; number++) {
        ssize_t n = getline(&line, &size, file);
        if (n <= 0 || line[n - 1] != '\n') break;
        if (number == 0)
            PH_TRY(check_header(s->c, path, line, (size_t)n, err));
        else if (!ph_i_record_parse(s->c, line, (size_t)n, &r))
            s->dropped++;
        else if (merging)
            PH_TRY(ph_i_store_add(s, &r, err));
        else
            PH_TRY(remember(s, &r, *end, (size_t)n, err));
        *end += n;
    }
    PH_CHECK(!ferror(file), PH_EIO, "%s: cannot be read", path);
out:
    free(line);
    return st;
}

/* All bytes at the end of the file, or the file as it was. */
static ph_status append(ph_i_store *s, const char *text, size_t length, ph_error *err)
{
    ph_status st = PH_OK;
    size_t done = 0;
    while (done < length) {
        ssize_t n = write(s->fd, text + done, length - done);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) {
            st = ph_i_io_error(err, "write", s->path, n < 0 ? errno : ENOSPC);
            goto out;
        }
        done += (size_t)n;
    }
    if (fdatasync(s->fd) != 0) {
        st = ph_i_io_error(err, "write", s->path, errno);
        goto out;
    }
    s->size += (int64_t)length;
out:
    if (st != PH_OK && ftruncate(s->fd, s->size) != 0)
        ph_error_prefix(err, "(its last line is torn) ");
    return st;
}

static ph_status open_file(ph_i_store *s, ph_error *err)
{
    ph_status st = PH_OK;
    s->fd = open(s->path, O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (s->fd < 0) st = ph_i_io_error(err, "write", s->path, errno);
    return st;
}

static ph_status read_file(ph_i_store *s, ph_error *err)
{
    ph_status st = PH_OK;
    char header[PH_I_LINE];
    FILE *file = fopen(s->path, "r");
    PH_CHECK(file, PH_EIO, "%s: cannot be read: %s", s->path, strerror(errno));
    PH_TRY(read_lines(s, file, s->path, false, &s->size, err));
    if (ftruncate(s->fd, s->size) != 0) {
        st = ph_i_io_error(err, "write", s->path, errno);
        goto out;
    }
    if (s->size == 0) PH_TRY(append(s, header, ph_i_record_header(s->c, header), err));
    s->sorted = s->dropped == 0;
    PH_TRY(ph_i_store_sort(s, err));
out:
    if (file) fclose(file);
    return st;
}

ph_status ph_i_store_open(ph_i_store *s, const char *folder, const ph_campaign *c,
                          ph_error *err)
{
    ph_status st = PH_OK;
    *s = (ph_i_store){.c = c, .lock = -1, .fd = -1};
    PH_TRY(make_folder(folder, err));
    snprintf(s->folder, sizeof s->folder, "%s", folder);
    snprintf(s->path, sizeof s->path, "%s/realisations.jsonl", folder);
    PH_TRY(take_lock(s, err));
    PH_TRY(open_file(s, err));
    PH_TRY(read_file(s, err));
out:
    if (st != PH_OK) ph_i_store_close(s);
    return st;
}

void ph_i_store_close(ph_i_store *s)
{
    if (s->fd >= 0) close(s->fd);
    if (s->lock >= 0) close(s->lock);
    free(s->waiting);
    free(s->entry);
    free(s->window);
    *s = (ph_i_store){.lock = -1, .fd = -1};
}

ph_status ph_i_store_add(ph_i_store *s, const ph_i_record *r, ph_error *err)
{
    ph_status st = PH_OK;
    char line[PH_I_LINE];
    size_t n = ph_i_record_line(s->c, r, line);
    if (s->nwaiting + n > s->capacity) {
        size_t capacity = 2 * (s->nwaiting + n);
        char *grown = realloc(s->waiting, capacity);
        PH_CHECK(grown, PH_ENOMEM, "no memory for the lines of realisations");
        s->waiting = grown;
        s->capacity = capacity;
    }
    PH_TRY(remember(s, r, s->size + (int64_t)s->nwaiting, n, err));
    memcpy(s->waiting + s->nwaiting, line, n);
    s->nwaiting += n;
    size_t k = s->count - 1;
    if (k > 0 && (s->entry[k - 1].point > r->point ||
                  (s->entry[k - 1].point == r->point && s->entry[k - 1].i >= r->i)))
        s->sorted = false;
out:
    return st;
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

ph_status ph_i_store_sync(ph_i_store *s, ph_error *err)
{
    if (s->nwaiting == 0) return PH_OK;
    double start = now();
    ph_status st = append(s, s->waiting, s->nwaiting, err);
    s->sync_seconds = now() - start;
    s->nwaiting = 0;
    return st;
}

/* The bytes of a line; from the window, which moves there if it has to. */
static ph_status read_line(ph_i_store *s, const ph_i_entry *e, char *line, ph_error *err)
{
    ph_status st = PH_OK;
    if (!s->window) PH_ALLOC(s->window, WINDOW, "reading lines");
    if (e->offset < s->window_at ||
        e->offset + e->length > s->window_at + s->window_size) {
        ssize_t n = pread(s->fd, s->window, WINDOW, e->offset);
        s->window_at = e->offset;
        s->window_size = n > 0 ? n : 0;
    }
    PH_CHECK(e->length <= PH_I_LINE && e->length <= s->window_size, PH_EIO,
             "%s: cannot be read at byte %lld", s->path, (long long)e->offset);
    memcpy(line, s->window + (e->offset - s->window_at), (size_t)e->length);
out:
    return st;
}

ph_status ph_i_store_get(ph_i_store *s, const ph_i_entry *e, ph_i_record *r,
                         ph_error *err)
{
    ph_status st = PH_OK;
    char line[PH_I_LINE];
    PH_TRY(read_line(s, e, line, err));
    PH_CHECK(ph_i_record_parse(s->c, line, (size_t)e->length, r), PH_EIO,
             "%s: the line at byte %lld has changed", s->path, (long long)e->offset);
out:
    return st;
}

static int compare_entries(const void *a, const void *b)
{
    const ph_i_entry *x = a, *y = b;
    if (x->point != y->point) return x->point < y->point ? -1 : 1;
    if (x->i != y->i) return x->i < y->i ? -1 : 1;
    if (x->failed != y->failed) return x->failed ? 1 : -1;
    return (x->offset > y->offset) - (x->offset < y->offset);
}

/* Of two lines of one realisation the one to keep: *kept becomes it. */
static ph_status choose(ph_i_store *s, ph_i_entry *kept, const ph_i_entry *other,
                        ph_error *err)
{
    ph_status st = PH_OK;
    char x[PH_I_LINE], y[PH_I_LINE];
    if (kept->failed != other->failed) goto out; /* sorted: success first */
    PH_TRY(read_line(s, kept, x, err));
    PH_TRY(read_line(s, other, y, err));
    size_t nx = (size_t)kept->length, ny = (size_t)other->length;
    int order = memcmp(x, y, nx < ny ? nx : ny);
    if (order == 0 && nx == ny) goto out;
    if (!kept->failed) s->differing++;
    if (order > 0) *kept = *other;
out:
    return st;
}

ph_status ph_i_store_sort(ph_i_store *s, ph_error *err)
{
    ph_status st = PH_OK;
    size_t kept = 0;
    PH_TRY(ph_i_store_sync(s, err));
    bool in_order = true;
    for (size_t k = 1; k < s->count && in_order; k++)
        in_order = compare_entries(&s->entry[k - 1], &s->entry[k]) < 0;
    if (!in_order) qsort(s->entry, s->count, sizeof *s->entry, compare_entries);
    for (size_t k = 0; k < s->count; k++) {
        ph_i_entry *last = kept > 0 ? &s->entry[kept - 1] : NULL;
        bool twin = last && last->point == s->entry[k].point && last->i == s->entry[k].i;
        if (twin)
            PH_TRY(choose(s, last, &s->entry[k], err));
        else
            s->entry[kept++] = s->entry[k];
    }
    if (!in_order || kept < s->count) s->sorted = false;
    s->count = kept;
out:
    return st;
}

static ph_status copy_lines(ph_i_store *s, FILE *to, ph_error *err)
{
    ph_status st = PH_OK;
    char line[PH_I_LINE];
    bool good = fwrite(line, 1, ph_i_record_header(s->c, line), to) > 0;
    for (size_t k = 0; k < s->count && good; k++) {
        size_t n = (size_t)s->entry[k].length;
        PH_TRY(read_line(s, &s->entry[k], line, err));
        good = fwrite(line, 1, n, to) == n;
    }
    PH_CHECK(good && fflush(to) == 0, PH_EIO, "%s: cannot be written: %s", s->path,
             strerror(errno));
out:
    return st;
}

ph_status ph_i_store_compact(ph_i_store *s, ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_draft draft = {.open = false};
    FILE *to = NULL;
    char header[PH_I_LINE];
    PH_TRY(ph_i_store_sort(s, err));
    if (s->sorted) goto out;
    PH_TRY(ph_i_draft_begin(&draft, s->path, err));
    to = fopen(draft.path, "w");
    PH_CHECK(to, PH_EIO, "%s: cannot be written: %s", draft.path, strerror(errno));
    PH_TRY(copy_lines(s, to, err));
    PH_CHECK(fclose(to) == 0, PH_EIO, "%s: cannot be written", draft.path);
    to = NULL;
    PH_TRY(ph_i_draft_commit(&draft, err));
    close(s->fd);
    PH_TRY(open_file(s, err));
    s->window_size = 0; /* another file now */
    s->size = (int64_t)ph_i_record_header(s->c, header);
    for (size_t k = 0; k < s->count; k++) {
        s->entry[k].offset = s->size;
        s->size += s->entry[k].length;
    }
    s->sorted = true;
out:
    if (to) fclose(to);
    ph_i_draft_discard(&draft);
    return st;
}

ph_status ph_i_store_merge(ph_i_store *s, const char *path, ph_error *err)
{
    ph_status st = PH_OK;
    int64_t end;
    FILE *file = fopen(path, "r");
    PH_CHECK(file, PH_EIO, "%s: cannot be opened: %s", path, strerror(errno));
    PH_TRY(read_lines(s, file, path, true, &end, err));
    PH_CHECK(end > 0, PH_EIO, "%s holds no realisations", path);
    PH_TRY(ph_i_store_sort(s, err));
out:
    if (file) fclose(file);
    return st;
}
