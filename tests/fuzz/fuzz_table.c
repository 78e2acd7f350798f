/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Any text at all is either a table or a complaint; a table can be written and read back to
 * the same numbers. */
#include <perihom/table.h>

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void demand(int condition)
{
    if (!condition) abort();
}

static void check_table(const ph_table *t)
{
    char *text = NULL;
    ph_table *again = NULL;
    ph_error err = PH_ERROR_INIT;
    demand(ph_table_to_csv(t, &text, &err) == PH_OK);
    demand(ph_table_parse(text, strlen(text), "again", &again, &err) == PH_OK);
    demand(again->ncolumns == t->ncolumns && again->nrows == t->nrows);
    for (int k = 0; k < t->ncolumns; k++)
        demand(strcmp(again->name[k], t->name[k]) == 0 &&
               ph_table_column(t, t->name[k]) == k);
    for (ptrdiff_t i = 0; i < t->ncolumns * t->nrows; i++)
        demand(isnan(t->value[i]) ? isnan(again->value[i])
                                  : again->value[i] == t->value[i]);
    ph_table_free(&again);
    free(text);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    ph_table *t = NULL;
    ph_error err = PH_ERROR_INIT;
    if (ph_table_parse((const char *)data, size, "fuzz", &t, &err) == PH_OK)
        check_table(t);
    else
        demand(err.msg[0] && !strchr(err.msg, '\n') && !t);
    ph_table_free(&t);
    return 0;
}
