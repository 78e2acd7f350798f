/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "destination.h"

#include "check.h"

#include <jansson.h>

#include <errno.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* What a result may consist of; result.json last: where it is, the rest is. */
static const char *const result_files[] = {
    "phases.png",        "fields.h5",        "fields.xdmf",     "damage.png",
    "damage.csv",        "damage-law.csv",   "prony.csv",       "prony.yaml",
    "relaxation.csv",    "dynamic.csv",      "response.csv",    "relaxation.svg",
    "dynamic.svg",       "tan-delta.svg",    "response.svg",    "stress-strain.csv",
    "stress-strain.svg", "stress-time.svg",  "strain-time.svg", "energy-time.svg",
    "events.csv",        "damage-steps.png", "result.json"};
enum { NFILES = sizeof result_files / sizeof *result_files };

void destination_default(const char *case_path, char dir[DESTINATION_PATH])
{
    const char *slash = strrchr(case_path, '/'), *name = slash ? slash + 1 : case_path;
    const char *dot = strrchr(name, '.');
    bool yaml = dot && dot > name && (!strcmp(dot, ".yaml") || !strcmp(dot, ".yml"));
    int length = yaml ? (int)(dot - name) : (int)strlen(name);
    snprintf(dir, DESTINATION_PATH, "%.*s-results", length, name);
}

static ph_status same_case(const char *path, const char *case_json, ph_error *err)
{
    ph_status st = PH_OK;
    json_error_t why;
    json_t *old = json_load_file(path, JSON_REJECT_DUPLICATES, &why);
    json_t *mine = json_loads(case_json, 0, NULL);
    const json_t *title = json_object_get(json_object_get(old, "case"), "title");
    PH_CHECK(
        old && json_object_get(old, "case"), PH_EIO,
        "%s is there and is not a result of perihom; choose another folder with -o, or "
        "overwrite it with --force",
        path);
    PH_CHECK(json_equal(json_object_get(old, "case"), mine), PH_EIO,
             "%s is the result of another case%s%s%s; choose another folder with -o, or "
             "overwrite it with --force",
             path, json_is_string(title) ? " ('" : "",
             json_is_string(title) ? json_string_value(title) : "",
             json_is_string(title) ? "')" : "");
out:
    json_decref(old);
    json_decref(mine);
    return st;
}

/* The folder that `path` is in, as text; "." where it has no slash. */
static void parent_of(char *path)
{
    char *slash = strrchr(path, '/');
    if (!slash)
        strcpy(path, ".");
    else if (slash == path)
        path[1] = 0;
    else
        *slash = 0;
}

/* An empty name would be the root folder: its files begin with a slash. */
static ph_status check_name(const char *dir, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(*dir, PH_EIO, "the name of the folder is empty");
    PH_CHECK(strlen(dir) < DESTINATION_PATH, PH_EIO,
             "the name of the folder is too long");
out:
    return st;
}

static ph_status check_writable(const char *dir, ph_error *err)
{
    ph_status st = PH_OK;
    struct stat s;
    char at[DESTINATION_PATH];
    PH_TRY(check_name(dir, err));
    strcpy(at, dir);
    /* What is not there yet will be made in the nearest folder that is. */
    while (stat(at, &s) != 0 && errno == ENOENT && strcmp(at, "/") != 0 &&
           strcmp(at, ".") != 0)
        parent_of(at);
    PH_CHECK(stat(at, &s) == 0, PH_EIO, "%s: %s", dir, strerror(errno));
    PH_CHECK(S_ISDIR(s.st_mode), PH_EIO, "%s is not a folder", at);
    PH_CHECK(access(at, W_OK | X_OK) == 0, PH_EIO, "%s: cannot write into %s: %s", dir,
             at, strerror(errno));
out:
    return st;
}

ph_status destination_check(const char *dir, const char *case_json, bool force,
                            ph_error *err)
{
    ph_status st = PH_OK;
    char path[DESTINATION_PATH + 32];
    PH_TRY(check_writable(dir, err));
    snprintf(path, sizeof path, "%s/result.json", dir);
    if (!force && access(path, F_OK) == 0) PH_TRY(same_case(path, case_json, err));
out:
    return st;
}

ph_status destination_make(const char *dir, ph_error *err)
{
    ph_status st = PH_OK;
    char at[DESTINATION_PATH];
    PH_TRY(check_name(dir, err));
    strcpy(at, dir);
    for (char *c = at + 1; c[-1]; c++) {
        if (*c && *c != '/') continue;
        char kept = *c;
        *c = 0;
        PH_CHECK(mkdir(at, 0777) == 0 || errno == EEXIST, PH_EIO, "%s: %s", at,
                 strerror(errno));
        *c = kept;
        if (!kept) break;
    }
out:
    return st;
}

ph_status destination_open(destination *d, const char *dir, ph_error *err)
{
    ph_status st = PH_OK;
    *d = (destination){0};
    d->made = access(dir, F_OK) != 0;
    PH_TRY(destination_make(dir, err));
    snprintf(d->dir, sizeof d->dir, "%s", dir);
    snprintf(d->stage, sizeof d->stage, "%s/.writing-XXXXXX", dir);
    if (!mkdtemp(d->stage)) {
        d->stage[0] = 0;
        PH_CHECK(false, PH_EIO, "%s: %s", dir, strerror(errno));
    }
out:
    return st;
}

void destination_file(const destination *d, const char *name, char *path, size_t size)
{
    snprintf(path, size, "%s/%s", d->stage, name);
}

ph_status destination_commit(destination *d, ph_error *err)
{
    ph_status st = PH_OK;
    for (int i = 0; i < NFILES; i++) {
        char from[DESTINATION_PATH + 64], to[DESTINATION_PATH + 64];
        destination_file(d, result_files[i], from, sizeof from);
        snprintf(to, sizeof to, "%s/%s", d->dir, result_files[i]);
        if (access(from, F_OK) == 0)
            PH_CHECK(rename(from, to) == 0, PH_EIO, "%s: %s", to, strerror(errno));
        else
            PH_CHECK(unlink(to) == 0 || errno == ENOENT, PH_EIO, "%s: %s", to,
                     strerror(errno));
    }
out:
    destination_discard(d);
    return st;
}

void destination_discard(destination *d)
{
    if (!d->stage[0]) return;
    for (int i = 0; i < NFILES; i++) {
        char path[DESTINATION_PATH + 64];
        destination_file(d, result_files[i], path, sizeof path);
        unlink(path);
    }
    rmdir(d->stage);
    d->stage[0] = 0;
    if (d->made) rmdir(d->dir); /* stays where files have moved in */
}
