/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "options.h"

#include <perihom/catalogue.h>

#include <errno.h>
#include <limits.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

enum { GO_ON = -1, USAGE = 2, HELP_COLUMN = 26 };

static void *member(void *values, size_t offset)
{
    return (char *)values + offset;
}

void options_help(const verb_spec *verb, FILE *to)
{
    fprintf(to, "perihom %s: %s\n\nusage: perihom %s%s%s [options]\n\nexamples:\n",
            verb->name, verb->title, verb->name, *verb->operands ? " " : "",
            verb->operands);
    for (int i = 0; i < 3 && verb->example[i].command; i++)
        fprintf(to, "  %s\n      %s\n", verb->example[i].command, verb->example[i].says);
    fprintf(to, "\noptions:\n");
    for (size_t i = 0; i < verb->noptions; i++) {
        const option_spec *o = &verb->options[i];
        char left[64], letter[8] = "    ";
        if (o->letter) snprintf(letter, sizeof letter, "-%c, ", o->letter);
        snprintf(left, sizeof left, "%s--%s%s%s", letter, o->name, o->arg ? " " : "",
                 o->arg ? o->arg : "");
        fprintf(to, "  %-*s %s", HELP_COLUMN, left, o->help);
        if (o->fallback) fprintf(to, "  [%s]", o->fallback);
        fputc('\n', to);
    }
    fprintf(to, "  %-*s %s\n", HELP_COLUMN, "-h, --help", "print this text");
    if (verb->more) fprintf(to, "\n%s\n", verb->more);
}

int options_usage_error(const verb_spec *verb, const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    fprintf(stderr, "perihom %s: ", verb->name);
    vfprintf(stderr, fmt, args);
    va_end(args);
    fprintf(stderr, "\nusage: perihom %s%s%s [options]\n", verb->name,
            *verb->operands ? " " : "", verb->operands);
    fprintf(stderr, "'perihom help %s' lists the options\n", verb->name);
    return USAGE;
}

static int unknown_option(const verb_spec *verb, const char *word)
{
    const char *names[32] = {"help"};
    size_t n = 1;
    for (size_t i = 0; i < verb->noptions && n < 32; i++)
        names[n++] = verb->options[i].name;
    const char *near =
        strncmp(word, "--", 2) ? NULL : ph_nearest_name(word + 2, names, n);
    if (near)
        return options_usage_error(verb, "unknown option '%s'; did you mean '--%s'?",
                                   word, near);
    return options_usage_error(verb, "unknown option '%s'", word);
}

/* Every list has room for all words of the command line. */
static bool append(text_list *list, const char *word, int argc)
{
    if (!list->item) list->item = calloc((size_t)argc + 1, sizeof *list->item);
    if (!list->item) return false;
    list->item[list->count++] = word;
    return true;
}

static int store(const verb_spec *verb, const option_spec *o, const char *word, int argc,
                 void *values)
{
    char *end = NULL;
    long number = 0;
    switch (o->type) {
    case OPTION_FLAG:
        *(bool *)member(values, o->offset) = true;
        break;
    case OPTION_TEXT:
        *(const char **)member(values, o->offset) = word;
        break;
    case OPTION_LIST:
        if (!append(member(values, o->offset), word, argc))
            return options_usage_error(verb, "no memory for the command line");
        break;
    case OPTION_INTEGER:
        errno = 0;
        number = strtol(word, &end, 10);
        if (errno || end == word || *end || number < 1 || number > INT_MAX)
            return options_usage_error(verb, "--%s: '%s' is not an integer from 1 on",
                                       o->name, word);
        *(int *)member(values, o->offset) = (int)number;
        break;
    }
    return GO_ON;
}

static const option_spec *by_letter(const verb_spec *verb, char letter)
{
    for (size_t i = 0; i < verb->noptions; i++)
        if (verb->options[i].letter == letter) return &verb->options[i];
    return NULL;
}

static const option_spec *by_name(const verb_spec *verb, const char *name, size_t length)
{
    for (size_t i = 0; i < verb->noptions; i++)
        if (strlen(verb->options[i].name) == length &&
            strncmp(verb->options[i].name, name, length) == 0)
            return &verb->options[i];
    return NULL;
}

/* --name, --name VALUE or --name=VALUE */
static int parse_long(const verb_spec *verb, int argc, char **argv, int *at, void *values)
{
    const char *word = argv[*at], *equals = strchr(word, '=');
    size_t length = equals ? (size_t)(equals - word) - 2 : strlen(word) - 2;
    const option_spec *o = by_name(verb, word + 2, length);
    if (!o) return unknown_option(verb, word);
    if (!o->arg && equals)
        return options_usage_error(verb, "--%s takes no argument", o->name);
    const char *value = equals ? equals + 1 : NULL;
    if (o->arg && !value && *at + 1 < argc) value = argv[++*at];
    if (o->arg && !value)
        return options_usage_error(verb, "--%s needs an argument: %s", o->name, o->arg);
    return store(verb, o, value, argc, values);
}

/* -q, -qv, -oDIR or -o DIR */
static int parse_letters(const verb_spec *verb, int argc, char **argv, int *at,
                         void *values)
{
    for (const char *c = argv[*at] + 1; *c; c++) {
        const option_spec *o = by_letter(verb, *c);
        if (!o) return unknown_option(verb, (char[]){'-', *c, 0});
        const char *value = o->arg && c[1] ? c + 1 : NULL;
        if (o->arg && !value && *at + 1 < argc) value = argv[++*at];
        if (o->arg && !value)
            return options_usage_error(verb, "-%c needs an argument: %s", *c, o->arg);
        int code = store(verb, o, value, argc, values);
        if (code != GO_ON || o->arg) return code;
    }
    return GO_ON;
}

static bool is_help(const char *word)
{
    return strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0;
}

int options_parse(const verb_spec *verb, int argc, char **argv, void *values)
{
    text_list *operands = member(values, verb->operands_offset);
    bool only_operands = false;
    for (int i = 1; i < argc; i++) {
        const char *word = argv[i];
        int code = GO_ON;
        if (only_operands || word[0] != '-' || !word[1]) {
            if (!append(operands, word, argc))
                code = options_usage_error(verb, "no memory for the command line");
        } else if (strcmp(word, "--") == 0) {
            only_operands = true;
        } else if (is_help(word)) {
            options_help(verb, stdout);
            return 0;
        } else {
            code = (word[1] == '-' ? parse_long : parse_letters)(verb, argc, argv, &i,
                                                                 values);
        }
        if (code != GO_ON) return code;
    }
    if (operands->count < verb->operands_min)
        return options_usage_error(verb, "missing %s", verb->operands);
    if (operands->count > verb->operands_max)
        return options_usage_error(verb, "one argument too many: '%s'",
                                   operands->item[verb->operands_max]);
    return GO_ON;
}
