/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tools.h"

#include <stdlib.h>
#include <string.h>

typedef struct help_options {
    text_list operands;
} help_options;

static const verb_spec help_verb = {
    .name = "help",
    .title = "the list of verbs, or the help of one",
    .operands = "[VERB]",
    .operands_max = 1,
    .operands_offset = offsetof(help_options, operands),
    .example = {{"perihom help", "what perihom can do"},
                {"perihom help run", "what a verb does, three examples, its options"},
                {"perihom run --help", "the same"}},
};

void help_overview(FILE *to)
{
    fprintf(to,
            "perihom: effective properties of composites from their microstructure\n\n"
            "usage: perihom VERB [arguments] [options]\n");
    const char *group = "";
    for (const verb *v = verbs; v->name; v++) {
        if (strcmp(group, v->group) != 0) fprintf(to, "\n%s\n", v->group);
        group = v->group;
        fprintf(to, "  %-10s %s\n", v->name, v->title);
    }
    fprintf(to, "\n'perihom help VERB' explains a verb. stdout is data, stderr is talk.\n"
                "exit codes: 0 done, 1 internal error, 2 usage, 3 input not admissible,\n"
                "  4 not converged or singular, 5 file or memory, 130 interrupted\n");
}

static int help_of(const char *name)
{
    const verb *v = verb_find(name);
    if (!v) return verb_unknown(name);
    char word[32], option[] = "--help";
    snprintf(word, sizeof word, "%s", name);
    return v->run(2, (char *[]){word, option, NULL});
}

int cmd_help(int argc, char **argv)
{
    help_options o = {0};
    int code = options_parse(&help_verb, argc, argv, &o);
    if (code < 0 && o.operands.count > 0) {
        code = help_of(o.operands.item[0]);
    } else if (code < 0) {
        help_overview(stdout);
        code = 0;
    }
    free(o.operands.item);
    return code;
}
