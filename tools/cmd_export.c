/* SPDX-License-Identifier: GPL-3.0-or-later */
/* perihom export: material cards. */
#include "tools.h"

#include <stdlib.h>
#include <string.h>

typedef struct export_options {
    text_list operands;
    const char *to, *output, *name, *symmetry, *state;
    int id;
    bool nearest;
} export_options;

static const option_spec options[] = {
    {0, "to", "FORMAT", OPTION_TEXT, offsetof(export_options, to), NULL,
     "abaqus, calculix, ansys ...: 'perihom list formats'"},
    {'o', "output", "FILE", OPTION_TEXT, offsetof(export_options, output),
     "standard output", "where the card goes"},
    {0, "name", "NAME", OPTION_TEXT, offsetof(export_options, name), "perihom",
     "of the material in the card"},
    {0, "id", "N", OPTION_INTEGER, offsetof(export_options, id), "1",
     "number of the material, for codes that number them"},
    {0, "symmetry", "CLASS", OPTION_TEXT, offsetof(export_options, symmetry),
     "the simplest that fits", "isotropic, orthotropic or anisotropic"},
    {0, "state", "STATE", OPTION_TEXT, offsetof(export_options, state), "relaxation",
     "of a viscoelastic result: relaxation (the series), instantaneous or equilibrium"},
    {0, "nearest", NULL, OPTION_FLAG, offsetof(export_options, nearest), NULL,
     "where the format or CLASS cannot hold the tensor, write the nearest one"},
};

static const verb_spec export_verb = {
    .name = "export",
    .title = "a result as a material card for another code",
    .operands = "RESULT",
    .operands_min = 1,
    .operands_max = 1,
    .operands_offset = offsetof(export_options, operands),
    .example =
        {{"perihom export boron-aluminium-results --to calculix -o ply.inp",
          "a card of nine orthotropic constants"},
         {"perihom export spheres-results --to abaqus --symmetry isotropic --nearest",
          "E and nu of the nearest isotropic material, with its distance"},
         {"perihom export case-results --to json", "the tensor for a script"}},
    .options = options,
    .noptions = sizeof options / sizeof *options,
    .more = "RESULT is a result folder or its result.json. A format that cannot hold the "
            "tensor is\nan error, with the distance of the nearest one.\n"
            "exit codes: 0 done, 2 usage, 3 cannot be held, 5 file or memory",
};

static const char *const classes[] = {"auto", "isotropic", "orthotropic", "anisotropic"};
static const char *const states[] = {"relaxation", "instantaneous", "equilibrium"};

/* Index of a word in `names`; 0 where it is not given, -1 where it is none of them. */
static int find_word(const char *word, const char *const *names, int n)
{
    if (!word) return 0;
    for (int i = 0; i < n; i++)
        if (strcmp(word, names[i]) == 0) return i;
    return -1;
}

static int check_words(const export_options *o)
{
    const ph_catalogue *formats = ph_card_formats();
    const char *names[64];
    size_t n = 0;
    if (!o->to) return options_usage_error(&export_verb, "--to FORMAT is missing");
    if (find_word(o->state, states, 3) < 0)
        return options_usage_error(
            &export_verb, "--state is relaxation, instantaneous or equilibrium, not '%s'",
            o->state);
    if (find_word(o->symmetry, classes, 4) < 0)
        return options_usage_error(
            &export_verb, "--symmetry is isotropic, orthotropic or anisotropic, not '%s'",
            o->symmetry);
    if (ph_catalogue_find(formats, o->to) >= 0) return 0;
    for (; n < *formats->count && n < 64; n++)
        names[n] = ph_catalogue_entry(formats, n)->name;
    const char *near = ph_nearest_name(o->to, names, n);
    return options_usage_error(&export_verb,
                               near ? "unknown format '%s'; did you mean '%s'?"
                                    : "unknown format '%s'; see 'perihom list formats'",
                               o->to, near);
}

static ph_status export_result(const export_options *o, ph_error *err)
{
    ph_effective *effective = NULL;
    char *text = NULL;
    double distance = 0.0;
    const ph_card_params params = {.name = o->name,
                                   .id = o->id,
                                   .symmetry =
                                       (ph_symmetry)find_word(o->symmetry, classes, 4),
                                   .state = (ph_card_state)find_word(o->state, states, 3),
                                   .nearest = o->nearest};
    ph_status st = ph_effective_read(o->operands.item[0], &effective, err);
    if (st == PH_OK) st = ph_card_write(effective, o->to, &params, &text, &distance, err);
    if (st == PH_OK && o->output)
        st = ph_write_file(o->output, text, strlen(text), err);
    else if (st == PH_OK)
        fputs(text, stdout);
    if (st == PH_OK && o->nearest && distance > 1e-5)
        talk("the card is %.2g of the tensor's norm away from the result", distance);
    free(text);
    ph_effective_free(&effective);
    return st;
}

static int run_with(const export_options *o)
{
    ph_error err = PH_ERROR_INIT;
    int code = check_words(o);
    if (code == 0 && export_result(o, &err) != PH_OK) code = talk_error(&err);
    return code;
}

int cmd_export(int argc, char **argv)
{
    export_options o = {0};
    int code = options_parse(&export_verb, argc, argv, &o);
    if (code < 0) code = run_with(&o);
    free(o.operands.item);
    return code;
}
