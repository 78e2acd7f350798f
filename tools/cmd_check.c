/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "check.h"
#include "fidelity.h"
#include "memory.h"
#include "report.h"
#include "tools.h"

#include <jansson.h>

#include <perihom_error_bar.h>
#include <string.h>

typedef struct check_options {
    text_list operands, set;
    bool json;
} check_options;

static const option_spec options[] = {OPTION_SET(check_options),
                                      OPTION_JSON(check_options)};

static const verb_spec check_verb = {
    .name = "check",
    .title = "what a case means and what it would take; solves nothing",
    .operands = "CASE.yaml",
    .operands_min = 1,
    .operands_max = 1,
    .operands_offset = offsetof(check_options, operands),
    .example = {{"perihom check boron-aluminium.yaml",
                 "every key with its default filled in, nodes, memory and time"},
                {"perihom check case.yaml > resolved.yaml",
                 "what is printed is a case file again"},
                {"perihom check case.yaml --set microstructure.nodes=[512,512] --json",
                 "what a finer grid would take, for a script"}},
    .options = options,
    .noptions = sizeof options / sizeof *options,
    .more = "exit codes: 0 the case is admissible, 2 usage, 3 not admissible, 5 file or "
            "memory",
};

/* The fewest digits that read back as the same number. */
static void put_real(FILE *to, double x)
{
    char text[40];
    int digits = 6;
    do
        snprintf(text, sizeof text, "%.*g", digits, x);
    while (strtod(text, NULL) != x && digits++ < 17);
    /* YAML wants a point in a number with an exponent */
    char *e = strchr(text, 'e');
    if (e && !strchr(text, '.'))
        fprintf(to, "%.*s.0%s", (int)(e - text), text, e);
    else
        fprintf(to, "%s", text);
}

/* JSON on one line, which is YAML too. */
static void put_flow(FILE *to, const json_t *value)
{
    const char *key, *comma = "";
    json_t *item;
    size_t i;
    if (json_is_real(value)) {
        put_real(to, json_real_value(value));
    } else if (json_is_array(value)) {
        fputc('[', to);
        json_array_foreach(value, i, item)
        {
            fputs(i ? ", " : "", to);
            put_flow(to, item);
        }
        fputc(']', to);
    } else if (json_is_object(value)) {
        fputc('{', to);
        json_object_foreach((json_t *)(size_t)value, key, item)
        {
            fprintf(to, "%s%s: ", comma, key);
            comma = ", ";
            put_flow(to, item);
        }
        fputc('}', to);
    } else {
        char *text = json_dumps(value, JSON_ENCODE_ANY);
        fputs(text ? text : "null", to);
        free(text);
    }
}

static bool is_block(const json_t *value)
{
    return (json_is_object(value) && json_object_size(value) > 0) ||
           json_is_object(json_array_get(value, 0));
}

/* Maps and lists of maps are indented, the rest stands on one line. */
static void put_yaml(FILE *to, const json_t *map, int indent)
{
    const char *key;
    json_t *value, *item;
    size_t i;
    json_object_foreach((json_t *)(size_t)map, key, value)
    {
        fprintf(to, "%*s%s:", indent, "", key);
        if (json_is_object(value) && is_block(value)) {
            fputc('\n', to);
            put_yaml(to, value, indent + 2);
            continue;
        }
        fputc(is_block(value) ? '\n' : ' ', to);
        if (!is_block(value)) {
            put_flow(to, value);
            fputc('\n', to);
            continue;
        }
        json_array_foreach(value, i, item)
        {
            fprintf(to, "%*s- ", indent + 2, "");
            put_flow(to, item);
            fputc('\n', to);
        }
    }
}

/* Relaxation times of the phases at the temperature of the case, shortest and longest. */
static void print_relaxation(const ph_case *c)
{
    const char *comma = "";
    if (!ph_case_relaxes(c)) return;
    printf("# relaxation by route %s; relaxation times [%s]:", c->viscoelastic.route,
           c->unit_time);
    for (int i = 0; i < c->nmaterials; i++) {
        const ph_prony *p = c->materials[i].relaxation;
        if (!p) continue;
        printf("%s %s %g", comma, c->materials[i].name, p->term[0].time);
        comma = ",";
        if (p->nterms > 1) printf(" .. %g (%d)", p->term[p->nterms - 1].time, p->nterms);
        if (c->relaxation[i].factor != 1) printf(" (a_T = %g)", c->relaxation[i].factor);
    }
    putchar('\n');
}

static void print_text(const json_t *resolved, const ph_case *c,
                       const ph_microstructure *micro, const double *fraction,
                       const ph_estimate *e)
{
    char bytes[32], seconds[32];
    put_yaml(stdout, resolved, 0);
    printf("\n# %s, %td nodes, %td unknowns\n", report_kinematics(c->kinematics),
           e->nodes, e->unknowns);
    printf("# phases:");
    for (int i = 0; i < micro->nmaterials; i++)
        printf("%s %s %.4f", i ? "," : "", micro->materials[i].name, fraction[i]);
    putchar('\n');
    print_relaxation(c);
    double here = memory_here();
    printf("# memory about %s, time about %s on one thread\n",
           report_bytes(e->bytes, bytes), report_seconds(e->seconds, seconds));
    if (e->bonds > 0)
        printf("# that is the time until a crack runs through the cell, %td bonds; %s if "
               "none breaks\n",
               e->bonds, report_seconds(e->seconds_least, seconds));
    if (here > 0.0 && (double)e->bytes > here)
        printf(
            "# too much for this machine, which has %s of memory: run will refuse it\n",
            report_bytes((size_t)here, bytes));
    for (int i = 0; i < e->nnotes; i++)
        printf("# %s\n", e->notes[i]);
}

static ph_status print_json(json_t *resolved, const ph_microstructure *micro,
                            const double *fraction, const ph_estimate *e, ph_error *err)
{
    ph_status st = PH_OK;
    json_t *fractions = json_object(), *notes = json_array();
    for (int i = 0; i < micro->nmaterials; i++)
        json_object_set_new(fractions, micro->materials[i].name, json_real(fraction[i]));
    for (int i = 0; i < e->nnotes; i++)
        json_array_append_new(notes, json_string(e->notes[i]));
    json_t *document =
        json_pack("{s:s, s:O, s:o, s:{s:I, s:I, s:I, s:f, s:f, s:I, s:o}}", "schema",
                  "perihom.check/1", "case", resolved, "fractions", fractions, "estimate",
                  "nodes", (json_int_t)e->nodes, "unknowns", (json_int_t)e->unknowns,
                  "bytes", (json_int_t)e->bytes, "seconds", e->seconds, "seconds_least",
                  e->seconds_least, "bonds", (json_int_t)e->bonds, "notes", notes);
    PH_CHECK(document, PH_ENOMEM, "no memory for the document");
    json_dumpf(document, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(17));
    putchar('\n');
out:
    json_decref(document);
    return st;
}

/* A run that solves nothing takes so long: it reads, draws and writes. */
static void add_start(ph_estimate *e)
{
    static const double start = 0.06;
    e->seconds += start;
    e->seconds_least += start;
}

static ph_status check_case(const ph_case *c, bool json, ph_error *err)
{
    ph_status st = PH_OK;
    char *text = NULL;
    double *fraction = NULL;
    ph_microstructure *micro = NULL;
    ph_crack_plan *plan = NULL;
    json_t *resolved = NULL;
    ph_estimate e = {0};
    ph_fidelity_plan fidelity = {0};
    PH_TRY(memory_check_cells(c, case_solves(c), err));
    PH_TRY(ph_rve_build(c, &micro, err));
    PH_TRY(ph_rve_cracks(c, &plan, err));
    const ph_problem problem = ph_rve_problem(c, micro, plan);
    PH_TRY(ph_rve_estimate(c, &problem, &e, err));
    add_start(&e);
    PH_TRY(ph_case_to_json(c, &text, err));
    resolved = json_loads(text, 0, NULL);
    fraction = calloc((size_t)micro->nmaterials + 1, sizeof *fraction);
    PH_CHECK(fraction && resolved, PH_ENOMEM, "no memory for the resolved case");
    ph_microstructure_fractions(micro, fraction);
    if (c->accuracy.relative > 0) PH_TRY(ph_fidelity_plan_case(c, &fidelity, err));
    if (json)
        PH_TRY(print_json(resolved, micro, fraction, &e, err));
    else
        print_text(resolved, c, micro, fraction, &e);
    if (!json && c->accuracy.relative > 0) fidelity_print_plan(stdout, c, &fidelity);
out:
    json_decref(resolved);
    free(fraction);
    free(text);
    ph_crack_plan_free(&plan);
    ph_microstructure_free(&micro);
    return st;
}

int cmd_check(int argc, char **argv)
{
    check_options o = {0};
    ph_case *c = NULL;
    ph_error err = PH_ERROR_INIT;
    int code = options_parse(&check_verb, argc, argv, &o);
    if (code < 0) {
        code = case_load(o.operands.item[0], &o.set, &c);
        if (code == 0 && check_case(c, o.json, &err) != PH_OK)
            code = talk_case_error(o.operands.item[0], &o.set, &err);
    }
    ph_case_free(&c);
    free(o.operands.item);
    free(o.set.item);
    return code;
}
