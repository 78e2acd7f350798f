/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TOOLS_H
#define TOOLS_H

#include "options.h"

#include <perihom_campaign.h>

/** A subcommand; argv[0] is the verb, the value the exit code. With "--help" as its only
 *  argument it prints its help on stdout and returns 0. */
typedef struct verb {
    const char *group, *name, *title;
    int (*run)(int argc, char **argv);
} verb;
/* The table, in main.c, ended by a verb without name. */
extern const verb verbs[];

int cmd_run(int argc, char **argv);
int cmd_calibrate(int argc, char **argv);
int cmd_check(int argc, char **argv);
int cmd_fit(int argc, char **argv);
int cmd_generate(int argc, char **argv);
int cmd_bounds(int argc, char **argv);
int cmd_campaign(int argc, char **argv);
int cmd_trade(int argc, char **argv);
int cmd_view(int argc, char **argv);
int cmd_export(int argc, char **argv);
int cmd_list(int argc, char **argv);
int cmd_version(int argc, char **argv);
int cmd_help(int argc, char **argv);
/** The list of verbs: what `perihom help` prints. */
void help_overview(FILE *to);
/** The verb called `name`, or NULL. */
const verb *verb_find(const char *name);
/** "unknown verb" with the nearest known one, on stderr. @return 2 */
int verb_unknown(const char *name);

/* talk.c: stderr is talk. */

/** A line on stderr, after "perihom: ". */
void talk(const char *fmt, ...) __attribute__((format(printf, 1, 2)));
/** The message of `err` on stderr. @return the exit code of its status */
int talk_error(const ph_error *err);
/** True if `to` is a terminal that may be coloured: respects NO_COLOR and TERM=dumb. */
bool talk_in_colour(FILE *to);
/** Read a case; every complaint goes to stderr as FILE:LINE: message.
 *  @return 0, or the exit code with `out` NULL. */
int case_load(const char *path, const text_list *sets, ph_case **out);
/** talk_error, with file, line and key where the error is about one of a case. */
int talk_case_error(const char *path, const text_list *sets, const ph_error *err);
/** Complaints on stderr as FILE:LINE: message. */
void talk_issues(const char *path, const ph_case_issues *issues);
/** Whether a case has equations to solve: not for the bounds of Voigt and Reuss. */
bool case_solves(const ph_case *c);

#endif
