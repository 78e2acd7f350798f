/* SPDX-License-Identifier: GPL-3.0-or-later */
/* perihom generate: the microstructure of a case, its picture and its voxel file. */
#include "check.h"
#include "destination.h"
#include "memory.h"
#include "tools.h"

#include <jansson.h>

#include <math.h>

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
        "with random fillers also fillers.png, correlation.png, and phases.h5 with the\n"
        "filler of each cell; --json then has their statistics.\n"
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
    ph_packing *packing;       /* NULL: no random fillers */
    ph_statistics *statistics; /* where there is a packing */
    char fillers[DESTINATION_PATH + 32], owners[DESTINATION_PATH + 32],
        correlation[DESTINATION_PATH + 32];
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

static ph_status write_filler_files(built *b, const char *dir, ph_error *err)
{
    ph_status st = PH_OK;
    char fields[DESTINATION_PATH + 16];
    snprintf(fields, sizeof fields, "%s/microstructure", dir);
    snprintf(b->fillers, sizeof b->fillers, "%s/fillers.png", dir);
    snprintf(b->owners, sizeof b->owners, "%s/phases.h5", dir);
    snprintf(b->correlation, sizeof b->correlation, "%s/correlation.png", dir);
    PH_TRY(ph_rve_write_picture(b->fillers, b->micro, b->c->matrix, b->c->title, err));
    PH_TRY(ph_rve_write_owners(b->owners, b->micro, err));
    PH_TRY(ph_write_fields(fields, b->micro, NULL, b->c, err));
    PH_TRY(ph_write_png(b->correlation, &b->micro->grid, b->statistics->correlation, 3,
                        "two-point correlation, lag zero in the middle", err));
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
    if (b->packing) PH_TRY(write_filler_files(b, dir, err));
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

static const char *counting_name(const ph_filler_report *r)
{
    return r->counting == PH_COUNT_NODES ? "nodes" : "area";
}

static void print_fillers(const built *b)
{
    const ph_packing *p = b->packing;
    const ph_statistics *s = b->statistics;
    printf("\n  filler     count  counting  content    target     relaxed\n");
    for (int k = 0; k < p->nkinds; k++) {
        const ph_filler_report *r = &p->kind[k];
        printf("  %-9s %6td  %-8s  %.6f  ", b->c->fillers[k].shape, r->count,
               counting_name(r), r->reached);
        if (r->target >= 0)
            printf("%.6f", r->target);
        else
            printf("%-8s", "count");
        printf("   %td\n", r->relaxed);
    }
    printf("\nclusters    %td, the largest of %td fillers\n", s->clusters, s->largest);
    printf("box size    %.3g of its longest feature\n", s->size_indicator);
}

static json_t *numbers_json(const double *x, ptrdiff_t n)
{
    json_t *list = json_array();
    for (ptrdiff_t i = 0; i < n; i++)
        json_array_append_new(list, isfinite(x[i]) ? json_real(x[i]) : json_null());
    return list;
}

static json_t *number_json(double x)
{
    return isfinite(x) ? json_real(x) : json_null();
}

static json_t *reports_json(const built *b)
{
    json_t *list = json_array();
    int dim = b->packing->dimensions;
    for (int k = 0; k < b->packing->nkinds; k++) {
        const ph_filler_report *r = &b->packing->kind[k];
        json_t *tensor = json_array();
        for (int i = 0; i < dim; i++)
            json_array_append_new(tensor, numbers_json(&r->tensor[3 * i], dim));
        json_array_append_new(
            list, json_pack("{s:s, s:s, s:I, s:s, s:o, s:f, s:f, s:o, s:I, s:i}", "shape",
                            b->c->fillers[k].shape, "material",
                            b->micro->materials[b->c->fillers[k].material].name, "count",
                            (json_int_t)r->count, "counting", counting_name(r), "target",
                            number_json(r->target), "content", r->reached, "largest",
                            r->largest, "orientation_tensor", tensor, "relaxed",
                            (json_int_t)r->relaxed, "sweeps", r->sweeps));
    }
    return list;
}

static json_t *statistics_json(const ph_statistics *s)
{
    json_t *two = json_array(), *path = json_array(), *percolates = json_array();
    for (int a = 0; a < s->dimensions; a++) {
        json_array_append_new(two, numbers_json(s->two_point[a], s->nlags[a]));
        json_array_append_new(path, numbers_json(s->lineal_path[a], s->nlags[a]));
        json_array_append_new(percolates, json_boolean(s->percolates[a]));
    }
    return json_pack(
        "{s:f, s:o, s:o, s:o, s:o, s:o, s:{s:o, s:o, s:o}, s:I, s:I, s:o, s:{s:f, s:f}}",
        "fraction", s->fraction, "two_point", two, "lineal_path", path,
        "correlation_length", numbers_json(s->correlation_length, s->dimensions),
        "half_box_scatter", number_json(s->half_scatter), "size_indicator",
        number_json(s->size_indicator), "nearest_neighbour", "mean",
        number_json(s->nearest_mean), "std", number_json(s->nearest_std), "min",
        number_json(s->nearest_min), "clusters", (json_int_t)s->clusters,
        "largest_cluster", (json_int_t)s->largest, "percolates", percolates,
        "agglomeration", "xi", s->agglomerate_volume, "zeta", s->agglomerate_share);
}

static void add_fillers_json(json_t *document, const built *b)
{
    json_t *files = json_object_get(document, "files");
    json_object_set_new(document, "seed", json_integer((json_int_t)b->c->seed));
    json_object_set_new(document, "realisation",
                        json_integer((json_int_t)b->c->realisation));
    json_object_set_new(document, "fillers", reports_json(b));
    json_object_set_new(document, "statistics", statistics_json(b->statistics));
    json_object_set_new(files, "fillers", json_string(b->fillers));
    json_object_set_new(files, "owners", json_string(b->owners));
    json_object_set_new(files, "correlation", json_string(b->correlation));
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
    if (b->packing) add_fillers_json(document, b);
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
    PH_TRY(ph_rve_generate(c, &b.micro, &b.packing, err));
    PH_TRY(measure(&b, err));
    if (b.packing)
        PH_TRY(ph_rve_statistics(b.micro, b.packing, c->matrix, &b.statistics, err));
    PH_TRY(write_files(&b, o, err));
    if (o->json)
        PH_TRY(print_json(&b, err));
    else
        print_table(&b);
    if (!o->json && b.packing) print_fillers(&b);
    if (!o->quiet) talk("%s, %s", b.picture, b.voxels);
out:
    free(b.fraction);
    free(b.at_centres);
    ph_packing_free(&b.packing);
    ph_statistics_free(&b.statistics);
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
        if (code == 0 && generate(&o, c, &err) != PH_OK)
            code = talk_case_error(o.operands.item[0], &o.set, &err);
    }
    ph_case_free(&c);
    free(o.operands.item);
    free(o.set.item);
    return code;
}
