/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tools.h"

#include <jansson.h>

#include <perihom_estimators.h>
#include <perihom_trade.h>
#include <stdlib.h>
#include <string.h>

typedef struct list_options {
    text_list operands;
    bool json;
} list_options;

static const option_spec options[] = {OPTION_JSON(list_options)};

static const verb_spec list_verb = {
    .name = "list",
    .title = "the catalogues of this build",
    .operands = "[CATALOGUE]",
    .operands_max = 1,
    .operands_offset = offsetof(list_options, operands),
    .example = {{"perihom list", "which catalogues there are"},
                {"perihom list models",
                 "the entries of one: name, title, validity, reference"},
                {"perihom list shapes --json", "the same for a script"}},
    .options = options,
    .noptions = sizeof options / sizeof *options,
    .more = "references are keys of docs/references.bib",
};

enum { MAX_CATALOGUES = 32 };

static const size_t nmaterials = 0; /* none are built in so far */

/* Those of the library, the shapes, and the built-in materials. */
static size_t gather(ph_catalogue all[MAX_CATALOGUES])
{
    size_t n = 0;
    for (const ph_catalogue *c = ph_catalogues(); c->name && n < MAX_CATALOGUES - 6; c++)
        all[n++] = *c;
    all[n++] = (ph_catalogue){"shapes", "inclusions that a case can place", ph_shapes,
                              &ph_nshapes, sizeof *ph_shapes};
    all[n++] =
        (ph_catalogue){"fillers", "random fillers that a case can place",
                       ph_filler_shapes, &ph_nfiller_shapes, sizeof *ph_filler_shapes};
    all[n++] = (ph_catalogue){"estimators", "means over realisations", ph_estimators,
                              &ph_nestimators, sizeof *ph_estimators};
    all[n++] = (ph_catalogue){"knobs", "what 'perihom trade' varies", ph_knobs,
                              &ph_nknobs, sizeof *ph_knobs};
    all[n++] = *ph_card_formats();
    all[n++] = (ph_catalogue){"materials", "built-in material data", NULL, &nmaterials,
                              sizeof(ph_entry)};
    return n;
}

static json_t *entries_json(const ph_catalogue *c)
{
    json_t *list = json_array();
    for (size_t i = 0; i < *c->count; i++) {
        const ph_entry *e = ph_catalogue_entry(c, i);
        json_array_append_new(list, json_pack("{s:s, s:s, s:s, s:s}", "name", e->name,
                                              "title", e->title, "valid", e->valid,
                                              "reference", e->reference));
    }
    return list;
}

static void put_json(const ph_catalogue *all, size_t n)
{
    json_t *catalogues = json_object();
    for (size_t i = 0; i < n; i++)
        json_object_set_new(catalogues, all[i].name,
                            json_pack("{s:s, s:o}", "title", all[i].title, "entries",
                                      entries_json(&all[i])));
    json_t *document =
        json_pack("{s:s, s:o}", "schema", "perihom.list/1", "catalogues", catalogues);
    json_dumpf(document, stdout, JSON_INDENT(2));
    putchar('\n');
    json_decref(document);
}

static void put_overview(const ph_catalogue *all, size_t n)
{
    for (size_t i = 0; i < n; i++)
        printf("%-14s %3zu  %s\n", all[i].name, *all[i].count, all[i].title);
}

static void put_entries(const ph_catalogue *c)
{
    if (*c->count == 0) printf("no %s in this build\n", c->name);
    for (size_t i = 0; i < *c->count; i++) {
        const ph_entry *e = ph_catalogue_entry(c, i);
        printf("%-20s %s\n", e->name, e->title);
        if (c->first == ph_shapes)
            printf("%-20s keys: %s\n", "", ph_shapes[i].parameters);
        if (c->first == ph_filler_shapes)
            printf("%-20s keys: %s\n", "", ph_filler_shapes[i].parameters);
        if (e->valid[0]) printf("%-20s valid: %s\n", "", e->valid);
        if (e->reference[0]) printf("%-20s ref: %s\n", "", e->reference);
    }
}

static int unknown_catalogue(const char *word, const ph_catalogue *all, size_t n)
{
    const char *names[MAX_CATALOGUES];
    for (size_t i = 0; i < n; i++)
        names[i] = all[i].name;
    const char *near = ph_nearest_name(word, names, n);
    if (near)
        return options_usage_error(&list_verb, "no catalogue '%s'; did you mean '%s'?",
                                   word, near);
    return options_usage_error(&list_verb, "no catalogue '%s'; 'perihom list' names them",
                               word);
}

static int list(const list_options *o)
{
    ph_catalogue all[MAX_CATALOGUES];
    size_t n = gather(all), at = 0;
    if (o->operands.count == 0) {
        (o->json ? put_json : put_overview)(all, n);
        return 0;
    }
    const char *word = o->operands.item[0];
    while (at < n && strcmp(all[at].name, word) != 0)
        at++;
    if (at == n) return unknown_catalogue(word, all, n);
    if (o->json)
        put_json(&all[at], 1);
    else
        put_entries(&all[at]);
    return 0;
}

int cmd_list(int argc, char **argv)
{
    list_options o = {0};
    int code = options_parse(&list_verb, argc, argv, &o);
    if (code < 0) code = list(&o);
    free(o.operands.item);
    return code;
}
