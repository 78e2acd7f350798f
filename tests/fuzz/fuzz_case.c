/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Any text at all is either a case or a complaint; a case can be written and read back.
 * An input is the text of a case file; a line "#set key.path=value" in it is an override. */
#include <perihom/case.h>

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { MAX_SETS = 8 };

static size_t find_sets(char *text, const char *sets[MAX_SETS])
{
    size_t n = 0;
    for (char *at = strstr(text, "#set "); at && n < MAX_SETS; at = strstr(at, "#set ")) {
        sets[n++] = at += 5;
        at += strcspn(at, "\n");
        if (*at) *at++ = 0;
    }
    return n;
}

static void demand(int condition)
{
    if (!condition) abort();
}

static void check_case(ph_case *c)
{
    char *json = NULL;
    ph_case *again = NULL;
    ph_error err = PH_ERROR_INIT;
    demand(ph_case_to_json(c, &json, &err) == PH_OK);
    demand(ph_case_parse(json, strlen(json), "again", NULL, 0, &again, NULL, &err) ==
           PH_OK);
    demand(again->ninclusions == c->ninclusions && again->nmaterials == c->nmaterials);
    demand(strcmp(again->model.kind, c->model.kind) == 0 && again->seed == c->seed);
    ph_case_free(&again);
    free(json);
}

static void check_complaints(const ph_case_issues *issues, const ph_error *err)
{
    demand(issues->count > 0 && err->msg[0]);
    for (size_t i = 0; i < issues->count; i++)
        demand(issues->item[i].message[0] && !strchr(issues->item[i].message, '\n') &&
               issues->item[i].line >= 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const char *sets[MAX_SETS];
    ph_case *c = NULL;
    ph_case_issues issues = {0};
    ph_error err = PH_ERROR_INIT;
    char *copy = malloc(size + 1);
    if (!copy) return 0;
    if (size) memcpy(copy, data, size);
    copy[size] = 0;
    size_t nsets = find_sets(copy, sets);
    ph_status st =
        ph_case_parse((const char *)data, size, "fuzz", sets, nsets, &c, &issues, &err);
    if (st == PH_OK)
        check_case(c);
    else
        check_complaints(&issues, &err);
    ph_case_free(&c);
    ph_case_issues_free(&issues);
    free(copy);
    return 0;
}
