/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tools.h"

#include <stdlib.h>

typedef struct generate_options {
    text_list operands, set;
} generate_options;

static const option_spec options[] = {OPTION_SET(generate_options)};

static const verb_spec generate_verb = {
    .name = "generate",
    .title = "build the microstructure of a case and describe it; solve nothing",
    .operands = "CASE.yaml",
    .operands_min = 1,
    .operands_max = 1,
    .operands_offset = offsetof(generate_options, operands),
    .example = {{"perihom generate case.yaml", "fractions and cut cells"}},
    .options = options,
    .noptions = sizeof options / sizeof *options,
};

static int generate(const generate_options *o)
{
    ph_error err = PH_ERROR_INIT;
    ph_case *c = NULL;
    ph_microstructure *micro = NULL;
    double *fraction = NULL;
    int code = case_load(o->operands.item[0], &o->set, &c);
    if (code != 0) return code;
    if (ph_rve_build(c, &micro, &err) != PH_OK) {
        code = talk_error(&err);
    } else if ((fraction = calloc((size_t)micro->nmaterials, sizeof *fraction))) {
        ph_microstructure_fractions(micro, fraction);
        printf("cells %td, cut %td\n", ph_grid_cells(&micro->grid), micro->ncuts);
        for (int m = 0; m < micro->nmaterials; m++)
            printf("%-20s %.6f\n", micro->materials[m].name, fraction[m]);
    }
    free(fraction);
    ph_microstructure_free(&micro);
    ph_case_free(&c);
    return code;
}

int cmd_generate(int argc, char **argv)
{
    generate_options o = {0};
    int code = options_parse(&generate_verb, argc, argv, &o);
    if (code < 0) code = generate(&o);
    free(o.operands.item);
    free(o.set.item);
    return code;
}
