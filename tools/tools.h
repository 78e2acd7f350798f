/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TOOLS_H
#define TOOLS_H

#include <perihom_rve.h>

/* Subcommands: argv[0] is the verb; each returns the exit code. */
int cmd_run(int argc, char **argv);
int cmd_check(int argc, char **argv);
int cmd_generate(int argc, char **argv);
int cmd_bounds(int argc, char **argv);
int cmd_view(int argc, char **argv);
int cmd_list(int argc, char **argv);
int cmd_version(int argc, char **argv);
int cmd_help(int argc, char **argv);

#endif
