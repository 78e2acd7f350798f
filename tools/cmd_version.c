/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tools.h"

#include <jansson.h>

#include <stdlib.h>

typedef struct version_options {
    text_list operands;
    bool json;
} version_options;

static const option_spec options[] = {OPTION_JSON(version_options)};

static const verb_spec version_verb = {
    .name = "version",
    .title = "version, licence, compiler and libraries of this build",
    .operands = "",
    .operands_offset = offsetof(version_options, operands),
    .example = {{"perihom version", "what to write into a bug report"},
                {"perihom version --json", "the same for a script"},
                {"perihom --version", "also works"}},
    .options = options,
    .noptions = sizeof options / sizeof *options,
};

static const char licence[] = "GPL-3.0-or-later";

static void print_text(void)
{
    const char *version = NULL, *name;
    printf("perihom %s (git %s)\n", ph_version(), ph_git_revision());
    printf("licence   %s\n", licence);
    printf("compiler  %s\n", ph_compiler());
    printf("libraries");
    for (int i = 0; (name = ph_dependency(i, &version)); i++)
        printf("%s %s %s", i ? "," : "", name, version);
    putchar('\n');
}

static void print_json(void)
{
    const char *version = NULL, *name;
    json_t *libraries = json_object();
    for (int i = 0; (name = ph_dependency(i, &version)); i++)
        json_object_set_new(libraries, name, json_string(version));
    json_t *document =
        json_pack("{s:s, s:s, s:s, s:s, s:s, s:o}", "schema", "perihom.version/1",
                  "perihom", ph_version(), "git", ph_git_revision(), "licence", licence,
                  "compiler", ph_compiler(), "libraries", libraries);
    json_dumpf(document, stdout, JSON_INDENT(2));
    putchar('\n');
    json_decref(document);
}

int cmd_version(int argc, char **argv)
{
    version_options o = {0};
    int code = options_parse(&version_verb, argc, argv, &o);
    if (code < 0) {
        (o.json ? print_json : print_text)();
        code = 0;
    }
    free(o.operands.item);
    return code;
}
