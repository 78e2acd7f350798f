/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One table a verb: it parses the command line, prints the help and words the errors. */
#ifndef TOOLS_OPTIONS_H
#define TOOLS_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

typedef enum option_type {
    OPTION_FLAG,    /* bool, no argument */
    OPTION_INTEGER, /* int >= 1 */
    OPTION_TEXT,    /* const char *, borrowed from argv */
    OPTION_LIST     /* text_list, may be repeated */
} option_type;

/** Words of the command line, borrowed from argv; `item` is freed by its owner. */
typedef struct text_list {
    const char **item;
    size_t count;
} text_list;

typedef struct option_spec {
    char letter;      /* 0: only the long form */
    const char *name; /* long form, without dashes */
    const char *arg;  /* what the argument is called in the help; NULL for a flag */
    option_type type;
    size_t offset;        /* of the member in the verb's struct of values */
    const char *fallback; /* the default, for the help; NULL: none worth saying */
    const char *help;
} option_spec;

typedef struct verb_example {
    const char *command, *says;
} verb_example;

/** What a verb accepts. The struct of values starts zeroed: zero means not given. */
typedef struct verb_spec {
    const char *name;
    const char *title;    /* what it does, in one line */
    const char *operands; /* as the usage line shows them, e.g. "CASE.yaml" */
    size_t operands_min, operands_max;
    size_t operands_offset; /* of a text_list */
    verb_example example[3];
    const option_spec *options; /* [noptions]; --help is added to every verb */
    size_t noptions;
    const char *more; /* closing lines of the help, or NULL */
} verb_spec;

/** Fill `values` from the command line; argv[0] is the verb.
 *  @return -1: go on; else the exit code: 0 after --help, 2 after a usage error. */
int options_parse(const verb_spec *verb, int argc, char **argv, void *values);
/** The long help. */
void options_help(const verb_spec *verb, FILE *to);
/** "perihom VERB: message" and the short usage on stderr. @return 2 */
int options_usage_error(const verb_spec *verb, const char *fmt, ...)
    __attribute__((format(printf, 2, 3)));

/* Options that several verbs share, for a struct `type` with a member of that name. */
#define OPTION_SET(type)                                                                 \
    {                                                                                    \
        0, "set", "KEY=VALUE", OPTION_LIST, offsetof(type, set), NULL,                   \
            "override a key of the case, e.g. model.kind=local; may be repeated"         \
    }
#define OPTION_JSON(type)                                                                \
    {                                                                                    \
        0, "json", NULL, OPTION_FLAG, offsetof(type, json), NULL,                        \
            "print one JSON document on stdout and nothing else"                         \
    }

#endif
