/* SPDX-License-Identifier: GPL-3.0-or-later */
/* json_get PATH < document: the value at a.b.0.c as JSON on stdout, numbers with 6 digits.
 * Exit code 1 if the document is not JSON (nothing may follow it), 2 if PATH is not there. */
#include <jansson.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static json_t *step(json_t *at, const char *key)
{
    if (json_is_array(at)) return json_array_get(at, (size_t)strtoul(key, NULL, 10));
    return json_object_get(at, key);
}

int main(int argc, char **argv)
{
    json_error_t why;
    json_t *document = json_loadf(stdin, JSON_REJECT_DUPLICATES, &why);
    if (!document) {
        fprintf(stderr, "not JSON: line %d: %s\n", why.line, why.text);
        return 1;
    }
    json_t *at = document;
    char path[512];
    snprintf(path, sizeof path, "%s", argc > 1 ? argv[1] : "");
    for (char *key = strtok(path, "."); key && at; key = strtok(NULL, "."))
        at = step(at, key);
    if (at) {
        json_dumpf(at, stdout, JSON_ENCODE_ANY | JSON_REAL_PRECISION(6) | JSON_COMPACT);
        putchar('\n');
    }
    json_decref(document);
    return at ? 0 : 2;
}
