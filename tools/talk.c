/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tools.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

void talk(const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    fputs("perihom: ", stderr);
    vfprintf(stderr, fmt, args);
    fputc('\n', stderr);
    va_end(args);
}

bool talk_in_colour(FILE *to)
{
    const char *no = getenv("NO_COLOR"), *term = getenv("TERM");
    return !(no && *no) && term && strcmp(term, "dumb") != 0 && isatty(fileno(to));
}

int talk_error(const ph_error *err)
{
    bool colour = talk_in_colour(stderr);
    fprintf(stderr, "perihom: %serror:%s %s\n", colour ? "\033[1;31m" : "",
            colour ? "\033[0m" : "",
            err->msg[0] ? err->msg : ph_status_text(err->status));
    return ph_status_exit_code(err->status);
}

int talk_case_error(const char *path, const text_list *sets, const ph_error *err)
{
    char text[1024];
    if (!ph_case_error_text(path, sets->item, sets->count, err, text, sizeof text))
        return talk_error(err);
    fprintf(stderr, "%s\n", text);
    return ph_status_exit_code(err->status);
}

void talk_issues(const char *path, const ph_case_issues *issues)
{
    for (size_t i = 0; i < issues->count; i++) {
        char text[1024];
        ph_case_issue_text(&issues->item[i], path, text, sizeof text);
        fprintf(stderr, "%s\n", text);
    }
}

int case_load(const char *path, const text_list *sets, ph_case **out)
{
    ph_error err = PH_ERROR_INIT;
    ph_case_issues issues = {0};
    ph_status st = ph_case_read(path, sets->item, sets->count, out, &issues, &err);
    int code = ph_status_exit_code(st);
    talk_issues(path, &issues); /* of a good case: warnings */
    if (st != PH_OK && issues.count == 0) code = talk_error(&err);
    ph_case_issues_free(&issues);
    return code;
}

bool case_solves(const ph_case *c)
{
    return strcmp(c->constraint.kind, "voigt") != 0 &&
           strcmp(c->constraint.kind, "reuss") != 0;
}
