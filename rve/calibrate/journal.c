/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The evaluations of a calibration, one JSON line each, so that none is made twice. */
#include "calibrate/file.h"
#include "io/json.h"
#include "io/read_file.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/file.h>
#include <time.h>
#include <unistd.h>

#define SCHEMA "perihom.evaluations/1"
static const size_t MOST = (size_t)1 << 33; /* bytes of a journal */
static const double SYNC_EVERY = 0.2;       /* seconds */

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int width(const ph_fit_file *f)
{
    return f->nkeys + f->nunknowns;
}

static const char *key_of(const ph_fit_file *f, int i)
{
    return i < f->nkeys ? f->key[i] : f->unknown_key[i - f->nkeys];
}

/* What the lines are of: another case, key or quantity makes another journal. */
static ph_status header(const ph_fit_file *f, json_t **out, ph_error *err)
{
    ph_status st = PH_OK;
    json_t *h = json_object(), *c = NULL, *names = NULL;
    PH_CHECK(h, PH_ENOMEM, "no memory for a journal");
    PH_TRY(ph_i_json_put(h, "schema", json_string(SCHEMA), err));
    PH_TRY(ph_i_case_json(f->base, &c, err));
    st = ph_i_json_put(h, "case", c, err);
    c = NULL;
    PH_TRY(st);
    names = json_array();
    PH_CHECK(names, PH_ENOMEM, "no memory for a journal");
    for (int i = 0; i < width(f); i++)
        PH_TRY(ph_i_json_add(names, json_string(key_of(f, i)), err));
    for (int j = 0; j < f->nunknowns; j++)
        for (int a = 0; a < f->nalso[j]; a++)
            PH_TRY(ph_i_json_add(names, json_string(f->also[j][a]), err));
    st = ph_i_json_put(h, "keys", names, err);
    names = NULL;
    PH_TRY(st);
    names = json_array();
    PH_CHECK(names, PH_ENOMEM, "no memory for a journal");
    for (int i = 0; i < f->noutputs; i++)
        PH_TRY(ph_i_json_add(names, json_string(f->output[i].name), err));
    st = ph_i_json_put(h, "outputs", names, err);
    names = NULL;
    PH_TRY(st);
    *out = h;
    h = NULL;
out:
    json_decref(names);
    json_decref(h);
    return st;
}

static ph_status numbers(json_t *obj, const char *key, int n, const double *x,
                         ph_error *err)
{
    ph_status st = PH_OK;
    json_t *list = json_array();
    PH_CHECK(list, PH_ENOMEM, "no memory for a journal");
    for (int i = 0; i < n; i++)
        PH_TRY(ph_i_json_add(list, ph_i_json_number(x[i]), err));
    json_t *full = list;
    list = NULL;
    PH_TRY(ph_i_json_put(obj, key, full, err));
out:
    json_decref(list);
    return st;
}

static ph_status to_json(const ph_fit_file *f, const ph_i_fit_record *r, json_t **out,
                         ph_error *err)
{
    ph_status st = PH_OK;
    json_t *line = json_object();
    PH_CHECK(line, PH_ENOMEM, "no memory for a journal");
    PH_TRY(numbers(line, "at", width(f), r->place, err));
    PH_TRY(ph_i_json_put(line, "realisation", json_integer((json_int_t)r->realisation),
                         err));
    if (r->status == PH_OK) {
        PH_TRY(numbers(line, "values", f->noutputs, r->value, err));
    } else {
        PH_TRY(ph_i_json_put(line, "status", json_integer(r->status), err));
        PH_TRY(ph_i_json_put(line, "error", ph_i_json_text(r->message), err));
    }
    *out = line;
    line = NULL;
out:
    json_decref(line);
    return st;
}

static bool read_numbers(const json_t *list, int n, double *x)
{
    if (!json_is_array(list) || json_array_size(list) != (size_t)n) return false;
    for (int i = 0; i < n; i++) {
        const json_t *v = json_array_get(list, (size_t)i);
        if (!json_is_number(v)) return false;
        x[i] = json_number_value(v);
    }
    return true;
}

static bool from_json(const ph_fit_file *f, const json_t *line, ph_i_fit_record *r)
{
    const json_t *index = json_object_get(line, "realisation"),
                 *values = json_object_get(line, "values"),
                 *status = json_object_get(line, "status"),
                 *why = json_object_get(line, "error");
    *r = (ph_i_fit_record){.status = PH_OK};
    if (!read_numbers(json_object_get(line, "at"), width(f), r->place) ||
        !json_is_integer(index) || json_integer_value(index) < 0)
        return false;
    r->realisation = (uint64_t)json_integer_value(index);
    if (values) return read_numbers(values, f->noutputs, r->value);
    if (!json_is_integer(status) || json_integer_value(status) <= PH_OK ||
        json_integer_value(status) > PH_ECANCELLED)
        return false;
    r->status = (ph_status)json_integer_value(status);
    snprintf(r->message, sizeof r->message, "%s",
             json_is_string(why) ? json_string_value(why) : "");
    return true;
}

static int compare(const ph_i_fit_record *a, const ph_i_fit_record *b)
{
    for (int i = 0; i < PH_FIT_KEYS + PH_FIT_UNKNOWNS; i++)
        if (a->place[i] != b->place[i]) return a->place[i] < b->place[i] ? -1 : 1;
    return a->realisation < b->realisation ? -1 : a->realisation > b->realisation;
}

static int compare_records(const void *a, const void *b)
{
    return compare(a, b);
}

const ph_i_fit_record *ph_i_fit_journal_find(const ph_i_fit_journal *j,
                                             const double *place, uint64_t realisation)
{
    ph_i_fit_record wanted = {.realisation = realisation};
    memcpy(wanted.place, place, (size_t)width(j->file) * sizeof *place);
    if (j->count == 0) return NULL;
    return bsearch(&wanted, j->record, j->count, sizeof wanted, compare_records);
}

static ph_status take_line(ph_i_fit_journal *j, const char *text, size_t length,
                           int number, bool retry, ph_error *err)
{
    ph_status st = PH_OK;
    json_t *line = json_loadb(text, length, 0, NULL);
    if (j->count == j->capacity) {
        size_t capacity = j->capacity ? 2 * j->capacity : 256;
        ph_i_fit_record *grown = realloc(j->record, capacity * sizeof *grown);
        PH_CHECK(grown, PH_ENOMEM, "no memory for %zu evaluations", capacity);
        j->record = grown;
        j->capacity = capacity;
    }
    PH_CHECK(line && from_json(j->file, line, &j->record[j->count]), PH_EIO,
             "%s:%d: not a line of evaluations: delete it, or use another folder",
             j->path, number);
    if (j->record[j->count].status == PH_OK || !retry) j->count++;
out:
    json_decref(line);
    return st;
}

static ph_status check_header(const ph_i_fit_journal *j, const char *text, size_t length,
                              ph_error *err)
{
    ph_status st = PH_OK;
    json_t *mine = NULL, *theirs = json_loadb(text, length, 0, NULL);
    char *dump = NULL;
    PH_TRY(header(j->file, &mine, err));
    /* Through text: what a number is after reading back, an integer or a real. */
    dump = json_dumps(mine, JSON_COMPACT | JSON_REAL_PRECISION(17));
    PH_CHECK(dump, PH_ENOMEM, "no memory for a journal");
    json_decref(mine);
    mine = json_loads(dump, 0, NULL);
    PH_CHECK(mine, PH_ENOMEM, "no memory for a journal");
    PH_CHECK(theirs && json_equal(mine, theirs), PH_EIO,
             "%s holds the evaluations of another case or of other keys and quantities: "
             "use another folder (-o), or delete it",
             j->path);
out:
    free(dump);
    json_decref(mine);
    json_decref(theirs);
    return st;
}

static ph_status load(ph_i_fit_journal *j, bool retry, size_t *good, ph_error *err)
{
    ph_status st = PH_OK;
    char *text = NULL;
    size_t length = 0;
    int number = 0;
    *good = 0;
    PH_TRY(ph_i_read_file(j->path, MOST, "journal", &text, &length, err));
    for (char *line = text, *end; (end = memchr(line, '\n', length - *good)) != NULL;
         line = end + 1) {
        size_t n = (size_t)(end - line);
        if (number++ == 0)
            PH_TRY(check_header(j, line, n, err));
        else
            PH_TRY(take_line(j, line, n, number, retry, err));
        *good += n + 1;
    }
    if (j->count) qsort(j->record, j->count, sizeof *j->record, compare_records);
out:
    free(text);
    return st;
}

/* All of it at the end of the file, or nothing. */
static ph_status append(ph_i_fit_journal *j, const json_t *line, ph_error *err)
{
    ph_status st = PH_OK;
    char *text = json_dumps(line, JSON_COMPACT | JSON_REAL_PRECISION(17));
    PH_CHECK(text, PH_ENOMEM, "no memory for a line of %s", j->path);
    size_t length = strlen(text), done = 0;
    text[length++] = '\n'; /* in place of the zero */
    off_t before = lseek(j->fd, 0, SEEK_END);
    while (done < length) {
        ssize_t n = write(j->fd, text + done, length - done);
        if (n < 0 && errno == EINTR) continue;
        int number = n < 0 ? errno : 0;
        if (n <= 0 && before >= 0 && ftruncate(j->fd, before) != 0) number = errno;
        PH_CHECK(n > 0, PH_EIO, "%s: cannot be written: %s", j->path, strerror(number));
        done += (size_t)n;
    }
out:
    free(text);
    return st;
}

static ph_status begin(ph_i_fit_journal *j, ph_error *err)
{
    ph_status st = PH_OK;
    json_t *h = NULL;
    PH_TRY(header(j->file, &h, err));
    PH_TRY(append(j, h, err));
    PH_CHECK(fsync(j->fd) == 0, PH_EIO, "%s: cannot be written: %s", j->path,
             strerror(errno));
out:
    json_decref(h);
    return st;
}

ph_status ph_i_fit_journal_open(ph_i_fit_journal *j, const ph_fit_file *file,
                                const char *dir, bool retry, ph_error *err)
{
    ph_status st = PH_OK;
    size_t good = 0;
    *j = (ph_i_fit_journal){.fd = -1, .file = file, .synced = now()};
    if (!dir) return PH_OK;
    PH_CHECK(snprintf(j->path, sizeof j->path, "%s/evaluations.jsonl", dir) <
                 (int)sizeof j->path,
             PH_EIO, "%.100s...: the path is too long", dir);
    j->fd = open(j->path, O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    PH_CHECK(j->fd >= 0, PH_EIO, "%s: cannot be opened: %s", j->path, strerror(errno));
    PH_CHECK(flock(j->fd, LOCK_EX | LOCK_NB) == 0, PH_EIO,
             "%s: another calibration is writing to this folder", j->path);
    PH_TRY(load(j, retry, &good, err));
    PH_CHECK(ftruncate(j->fd, (off_t)good) == 0, PH_EIO, "%s: cannot be written: %s",
             j->path, strerror(errno));
    if (good == 0) PH_TRY(begin(j, err));
out:
    if (st != PH_OK) ph_i_fit_journal_close(j);
    return st;
}

ph_status ph_i_fit_journal_add(ph_i_fit_journal *j, const ph_i_fit_record *record,
                               ph_error *err)
{
    ph_status st = PH_OK;
    json_t *line = NULL;
    if (j->fd < 0) goto out;
    PH_TRY(to_json(j->file, record, &line, err));
    PH_TRY(append(j, line, err));
    if (now() - j->synced < SYNC_EVERY) goto out;
    PH_CHECK(fdatasync(j->fd) == 0, PH_EIO, "%s: cannot be written: %s", j->path,
             strerror(errno));
    j->synced = now();
out:
    json_decref(line);
    return st;
}

void ph_i_fit_journal_close(ph_i_fit_journal *j)
{
    if (j->fd >= 0) {
        fdatasync(j->fd);
        close(j->fd);
    }
    free(j->record);
    j->record = NULL;
    j->count = 0;
    j->fd = -1;
}
