/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables of numbers: measurements from a text file, and back. */
#ifndef PERIHOM_TABLE_H
#define PERIHOM_TABLE_H

#include <perihom/error.h>

#ifdef __cplusplus
extern "C" {
#endif

enum {
    PH_TABLE_COLUMNS = 256,   /* most columns */
    PH_TABLE_CELLS = 1 << 25, /* most cells: 256 MiB of numbers */
    PH_TABLE_NAME = 64        /* bytes of a column's name, the closing zero included */
};

/** Columns of numbers with names. */
typedef struct ph_table {
    int ncolumns;
    ptrdiff_t nrows;
    char (*name)[PH_TABLE_NAME]; /* [ncolumns], UTF-8, no two alike */
    double *value;               /* [ncolumns][nrows], NaN where the cell is empty */
    int *line;                   /* [nrows] line in the file, 1-based */
    char path[512];              /* the file, for messages */
} ph_table;

/** A table of measurements as text: a header row of names, then rows of numbers.
 *
 *  - Cells are separated by what separates the names: of tab, semicolon and comma the one
 *    that is most frequent in the header; blanks if it has none of them.
 *  - Blank lines and what follows a `#` outside of quotes do not count. Lines end with LF or
 *    CRLF; a UTF-8 byte order mark is skipped; cells may stand in double quotes ("" is a
 *    quote in them), names then may hold separators. Blanks around a cell do not count.
 *  - Numbers have a decimal point, whatever the locale. An empty cell, `nan` and `NA` are
 *    missing values: NaN. Infinite ones are refused.
 *  - Every row has a cell for every name.
 *  @param[in]  text   [length]; need not end with a zero
 *  @param[in]  name   what messages call it: "name:line: column 'E': ..."
 *  @param[out] out    free with ph_table_free; untouched on failure
 *  @return PH_OK; PH_EINVAL with file, line, column, value and what is admissible (no header,
 *          a name twice, a cell too many or too few, not a number, too large, no UTF-8);
 *          PH_ENOMEM. Cost: two passes. Tested: tests/io/test_table.c */
PH_API ph_status ph_table_parse(const char *text, size_t length, const char *name,
                                ph_table **out, ph_error *err);
/** The same from a file of at most 1 GiB. @return also PH_EIO. */
PH_API ph_status ph_table_read(const char *path, ph_table **out, ph_error *err);

/** A table to be filled: every cell NaN, lines 2, 3, ... as ph_table_to_csv writes them.
 *  @param[in] name [ncolumns]
 *  @return PH_OK; PH_EINVAL (limits, a name empty, too long, twice or with a control
 *          character); PH_ENOMEM */
PH_API ph_status ph_table_new(int ncolumns, const char *const *name, ptrdiff_t nrows,
                              ph_table **out, ph_error *err);
PH_API void ph_table_free(ph_table **table);

/** Index of the column with this name, else -1. The exact name is looked for first, then,
 *  without regard to case, one that is equal but for a unit behind it: "time" finds
 *  "Time (s)", "time [s]" and "TIME"; if two columns fit so, the first one. */
PH_API int ph_table_column(const ph_table *table, const char *name);

/** As text that ph_table_parse reads back to the same doubles: commas, names quoted where
 *  they need it, 17 digits at most and not more than it takes, empty cells where not finite.
 *  The text is malloc'd; untouched on failure. @return PH_OK; PH_ENOMEM.
 *  Tested: tests/io/test_table.c */
PH_API ph_status ph_table_to_csv(const ph_table *table, char **text, ph_error *err);

#ifdef __cplusplus
}
#endif
#endif
