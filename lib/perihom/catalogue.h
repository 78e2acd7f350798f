/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PERIHOM_CATALOGUE_H
#define PERIHOM_CATALOGUE_H

#include <perihom/error.h>

#ifdef __cplusplus
extern "C" {
#endif

/** What every catalogue entry begins with: a method is a value. */
typedef struct ph_entry {
    const char *name;      /* the word of the case file and of `perihom list` */
    const char *title;     /* one line for people */
    const char *reference; /* key(s) in docs/references.bib, or "" */
    const char *valid;     /* when it may be used */
} ph_entry;

/** One catalogue as an array whose elements start with a ph_entry. */
typedef struct ph_catalogue {
    const char *name;  /* "models", "solvers", ... */
    const char *title; /* one line */
    const void *first;
    const size_t *count; /* entries */
    size_t stride;       /* bytes from one to the next */
} ph_catalogue;

/** The catalogues of libperihom, ended by an entry with name NULL. */
PH_API const ph_catalogue *ph_catalogues(void);
/** Entry `i` of a catalogue. 0 <= i < *count. */
PH_API const ph_entry *ph_catalogue_entry(const ph_catalogue *catalogue, size_t i);
/** Index of the entry called `name`, or -1. */
PH_API int ph_catalogue_find(const ph_catalogue *catalogue, const char *name);
/** The name in `names` (n of them, may hold NULL) nearest to `word` by edit distance, or
 *  NULL if none is near enough to be what was meant. */
PH_API const char *ph_nearest_name(const char *word, const char *const *names, size_t n);

#ifdef __cplusplus
}
#endif
#endif
