/* SPDX-License-Identifier: GPL-3.0-or-later */
/* perihom generate: the microstructure of a case, its picture and its voxel file. */
#include "check.h"
#include "destination.h"
#include "memory.h"
#include "tools.h"

#include <jansson.h>

typedef struct generate_options {
    text_list operands, set;
    const char *output;
    bool json, quiet, force;
} generate_options;

static const option_spec options[] = {
    {'o', "output", "DIR", OPTION_TEXT, offsetof(generate_options, output),
     "NAME-results", "folder of the files; NAME is the case file without .yaml"},
    OPTION_SET(generate_options),
    OPTION_JSON(generate_options),
    {'q', "quiet", NULL, OPTION_FLAG, offsetof(generate_options, quiet), NULL,
     "no talk on stderr but errors"},
    {0, "force", NULL, OPTION_FLAG, offsetof(generate_options, force), NULL,
     "write into the folder of another case"},
};

static const verb_spec generate_verb = {
    .name = "generate",
    .title = "build the microstructure of a case and describe it; solve nothing",
    .operands = "CASE.yaml",
    .operands_min = 1,
    .operands_max = 1,
    .operands_offset = offsetof(generate_options, operands),
    .example =
        {{"perihom generate case.yaml", "fractions, cut cells; phases.png, phases.npy"},
         {"perihom generate case.yaml --set microstructure.nodes=[512,512] -o fine",
          "the same microstructure on a finer grid, into the folder fine"},
         {"perihom generate case.yaml --json | jq .fractions", "for a script"}},
    .options = options,
    .noptions = sizeof options / sizeof *options,
    .more =
        "phases.npy holds the material at the centre of each cell, numbered as printed.\n"
        "exit codes: 0 done, 2 usage, 3 not admissible, 5 file or memory",
};

/* What was built, and what can be said of it. */
typedef struct built {
    const ph_case *c;
    ph_microstructure *micro;
    double *fraction;   /* [nmaterials] seen, cuts counted */
    double *at_centres; /* [nmaterials] of the cell centres, what node_centre would see */
    ptrdiff_t cut_cells; /* a cell may have several cuts */
    char picture[DESTINATION_PATH + 32], voxels[DESTINATION_PATH + 32];
} built;

static int dimensions_of(const ph_grid *g)
{
    return g->kinematics == PH_SPACE ? 3 : 2;
}

static ph_status measure(built *b, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_microstructure *m = b->micro;
    ptrdiff_t cells = ph_grid_cells(&m->grid);
    b->fraction = calloc((size_t)m->nmaterials, sizeof *b->fraction);
    b->at_centres = calloc((size_t)m->nmaterials, sizeof *b->at_centres);
    PH_CHECK(b->fraction && b->at_centres, PH_ENOMEM, "no memory for the fractions");
    ph_microstructure_fractions(m, b->fraction);
    for (ptrdiff_t i = 0; i < cells; i++)
        b->at_centres[m->phase[i]] += 1;
    for (int i = 0; i < m->nmaterials; i++)
        b->at_centres[i] /= (double)cells;
    for (ptrdiff_t k = 0; k < m->ncuts; k++)
        b->cut_cells += k == 0 || m->cuts[k].cell != m->cuts[k - 1].cell;
out:
    return st;
}

static ph_status write_files(built *b, const generate_options *o, ph_error *err)
{
    ph_status st = PH_OK;
    char dir[DESTINATION_PATH], *json = NULL;
    const ph_grid *g = &b->micro->grid;
    if (o->output)
        snprintf(dir, sizeof dir, "%s", o->output);
    else
        destination_default(o->operands.item[0], dir);
    PH_TRY(ph_case_to_json(b->c, &json, err));
    PH_TRY(destination_check(dir, json, o->force, err));
    PH_TRY(destination_make(dir, err));
    snprintf(b->picture, sizeof b->picture, "%s/phases.png", dir);
    snprintf(b->voxels, sizeof b->voxels, "%s/phases.npy", dir);
    PH_TRY(ph_write_phases_png(b->picture, b->micro, 3, b->c->title, err));
    PH_TRY(ph_rve_write_voxels(b->voxels, NULL, NULL, dimensions_of(g), g->n,
                               b->micro->phase, err));
out:
    free(json);
    return st;
}

static void print_table(const built *b)
{
    const ph_microstructure *m = b->micro;
    const ph_grid *g = &m->grid;
    printf("cells       %td x %td", g->n[0], g->n[1]);
    if (dimensions_of(g) == 3) printf(" x %td", g->n[2]);
    printf("\ncut cells   %td", b->cut_cells);
    if (m->ncuts > b->cut_cells) printf(" (%td cuts)", m->ncuts);
    printf("\n\n  value  material              fraction   at cell centres\n");
    for (int i = 0; i < m->nmaterials; i++)
        printf("  %5d  %-20s  %.6f   %.6f\n", i, m->materials[i].name, b->fraction[i],
               b->at_centres[i]);
}

static ph_status print_json(const built *b, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_microstructure *m = b->micro;
    int dim = dimensions_of(&m->grid);
    json_t *fractions = json_object(), *centres = json_object(), *names = json_array(),
           *nodes = json_array(), *size = json_array(), *document = NULL;
    for (int i = 0; i < m->nmaterials; i++) {
        json_object_set_new(fractions, m->materials[i].name, json_real(b->fraction[i]));
        json_object_set_new(centres, m->materials[i].name, json_real(b->at_centres[i]));
        json_array_append_new(names, json_string(m->materials[i].name));
    }
    for (int a = 0; a < dim; a++) {
        json_array_append_new(nodes, json_integer(m->grid.n[a]));
        json_array_append_new(size, json_real(m->grid.size[a]));
    }
    document = json_pack("{s:s, s:s, s:o, s:o, s:o, s:o, s:o, s:I, s:I, s:{s:s, s:s}}",
                         "schema", "perihom.microstructure/1", "title", b->c->title,
                         "nodes", nodes, "size", size, "materials", names, "fractions",
                         fractions, "fractions_at_centres", centres, "cut_cells",
                         (json_int_t)b->cut_cells, "cuts", (json_int_t)m->ncuts, "files",
                         "picture", b->picture, "voxels", b->voxels);
    PH_CHECK(document, PH_ENOMEM, "no memory for the document");
    json_dumpf(document, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(17));
    putchar('\n');
out:
    json_decref(document);
    return st;
}

static ph_status generate(const generate_options *o, const ph_case *c, ph_error *err)
{
    ph_status st = PH_OK;
    built b = {.c = c};
    PH_TRY(memory_check_cells(c, false, err));
    PH_TRY(ph_rve_build(c, &b.micro, err));
    PH_TRY(measure(&b, err));
    PH_TRY(write_files(&b, o, err));
    if (o->json)
        PH_TRY(print_json(&b, err));
    else
        print_table(&b);
    if (!o->quiet) talk("%s, %s", b.picture, b.voxels);
out:
    free(b.fraction);
    free(b.at_centres);
    ph_microstructure_free(&b.micro);
    return st;
}

int cmd_generate(int argc, char **argv)
{
    generate_options o = {0};
    ph_case *c = NULL;
    ph_error err = PH_ERROR_INIT;
    int code = options_parse(&generate_verb, argc, argv, &o);
    if (code < 0) {
        code = case_load(o.operands.item[0], &o.set, &c);
        if (code == 0 && generate(&o, c, &err) != PH_OK) code = talk_error(&err);
    }
    ph_case_free(&c);
    free(o.operands.item);
    free(o.set.item);
    return code;
}
