/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/table.h>

#include "io/read_file.h"
#include "io/text.h"

#include <math.h>
#include <string.h>

enum { MOST_BYTES = 1 << 30, LONGEST_CELL = 256 };

/* Where the reader stands. */
typedef struct reader {
    const char *at, *end; /* what is left of the text */
    const char *file;
    int line;       /* of what next_line gave last */
    char separator; /* ' ' stands for any number of blanks and tabs */
} reader;

/* One line without comment, end and blanks around it. */
typedef struct text_line {
    const char *at, *end;
} text_line;

static bool is_blank(char ch)
{
    return ch == ' ' || ch == '\t';
}

/* Tabs may be cells: only those of a line of blanks are dropped where they separate. */
static bool is_padding(const reader *r, char ch)
{
    return ch == ' ' || (ch == '\t' && r->separator != '\t');
}

/* The next line that holds something; false at the end of the text. */
static bool next_line(reader *r, text_line *out)
{
    while (r->at < r->end) {
        const char *from = r->at, *at = from, *stop = NULL;
        bool quoted = false, something = false;
        for (; at < r->end && *at != '\n' && *at != '\r'; at++) {
            if (*at == '"') quoted = !quoted;
            if (*at == '#' && !quoted && !stop) stop = at;
            if (!stop && !is_blank(*at)) something = true;
        }
        if (!stop) stop = at;
        if (at < r->end) at += *at == '\r' && at + 1 < r->end && at[1] == '\n' ? 2 : 1;
        r->at = at;
        r->line++;
        if (!something) continue;
        while (stop > from && is_padding(r, stop[-1]))
            stop--;
        *out = (text_line){from, stop};
        return true;
    }
    return false;
}

/* A cell for messages: printable, not long. */
static const char *shown(const char *cell, char out[64])
{
    size_t used = 0, left = strlen(cell);
    while (left > 0 && used < 48) {
        uint32_t code = 0;
        int n = ph_i_utf8(cell, left, &code);
        if (n == 0 || code < 0x20 || code == 0x7f) {
            out[used++] = '?';
            n = 1;
        } else {
            memcpy(out + used, cell, (size_t)n);
            used += (size_t)n;
        }
        cell += n;
        left -= (size_t)n;
    }
    strcpy(out + used, left > 0 ? "..." : "");
    return out;
}

/* The inside of a quoted cell; *line stands behind the closing quote afterwards. */
static ph_status quoted_cell(const reader *r, text_line *line, char cell[LONGEST_CELL],
                             ph_error *err)
{
    ph_status st = PH_OK;
    size_t used = 0;
    for (line->at++;; line->at++) {
        PH_CHECK(line->at < line->end, PH_EINVAL,
                 "%s:%d: a quote is opened and not closed on its line", r->file, r->line);
        if (*line->at == '"' && (++line->at == line->end || *line->at != '"')) break;
        PH_CHECK(used + 1 < LONGEST_CELL, PH_EINVAL,
                 "%s:%d: a cell of more than %d bytes", r->file, r->line,
                 LONGEST_CELL - 1);
        cell[used++] = *line->at;
    }
    cell[used] = 0;
out:
    return st;
}

static bool at_separator(const reader *r, const text_line *line)
{
    return line->at < line->end &&
           (*line->at == r->separator || (r->separator == ' ' && *line->at == '\t'));
}

/* Take the next cell off the line; *more says whether a separator came after it. */
static ph_status next_cell(const reader *r, text_line *line, char cell[LONGEST_CELL],
                           bool *more, ph_error *err)
{
    ph_status st = PH_OK;
    while (line->at < line->end && is_padding(r, *line->at))
        line->at++;
    if (line->at < line->end && *line->at == '"') {
        PH_TRY(quoted_cell(r, line, cell, err));
    } else {
        const char *from = line->at;
        while (line->at < line->end && !at_separator(r, line))
            line->at++;
        const char *to = line->at;
        while (to > from && is_padding(r, to[-1]))
            to--;
        PH_CHECK(to - from < LONGEST_CELL, PH_EINVAL,
                 "%s:%d: a cell of more than %d bytes", r->file, r->line,
                 LONGEST_CELL - 1);
        memcpy(cell, from, (size_t)(to - from));
        cell[to - from] = 0;
    }
    const char *behind = line->at;
    while (line->at < line->end && is_padding(r, *line->at))
        line->at++;
    *more = at_separator(r, line) || (r->separator == ' ' && line->at < line->end);
    PH_CHECK(*more || line->at == line->end, PH_EINVAL,
             "%s:%d: text behind a closing quote: a quote inside of quotes is written "
             "twice",
             r->file, r->line);
    PH_CHECK(r->separator != ' ' || !*more || behind < line->at, PH_EINVAL,
             "%s:%d: no blank between two cells", r->file, r->line);
    if (*more && r->separator != ' ') line->at++;
out:
    return st;
}

/* Of tab, semicolon and comma the most frequent in the header, else blanks. */
static char separator_of(text_line header)
{
    static const char candidate[3] = {'\t', ';', ','};
    int count[3] = {0}, best = 0;
    bool quoted = false;
    for (; header.at < header.end; header.at++) {
        if (*header.at == '"') quoted = !quoted;
        for (int k = 0; k < 3 && !quoted; k++)
            count[k] += *header.at == candidate[k];
    }
    for (int k = 1; k < 3; k++)
        if (count[k] > count[best]) best = k;
    return (char)(count[best] > 0 ? candidate[best] : ' ');
}

/* A name that can stand in messages and other files. */
static ph_status check_name(const char *name, int column, ph_error *err)
{
    ph_status st = PH_OK;
    char text[64];
    double ignored;
    PH_CHECK(name && name[0], PH_EINVAL, "column %d has no name", column + 1);
    PH_CHECK(strlen(name) < PH_TABLE_NAME, PH_EINVAL,
             "column %d: the name '%s' is longer than %d bytes", column + 1,
             shown(name, text), PH_TABLE_NAME - 1);
    for (size_t left = strlen(name), k = 0; left > 0;) {
        uint32_t code = 0;
        int n = ph_i_utf8(name + k, left, &code);
        PH_CHECK(n > 0, PH_EINVAL,
                 "column %d: the name '%s' is not UTF-8: save the file as UTF-8",
                 column + 1, shown(name, text));
        PH_CHECK(code >= 0x20 && code != 0x7f, PH_EINVAL,
                 "column %d: the name '%s' has a control character", column + 1,
                 shown(name, text));
        k += (size_t)n;
        left -= (size_t)n;
    }
    PH_CHECK(!ph_i_text_to_number(name, &ignored), PH_EINVAL,
             "column %d: '%s' where a name should be: a table begins with a row of names",
             column + 1, name);
out:
    return st;
}

static ph_status add_name(ph_table *t, const char *name, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(t->ncolumns < PH_TABLE_COLUMNS, PH_EINVAL, "more than %d columns",
             PH_TABLE_COLUMNS);
    PH_TRY(check_name(name, t->ncolumns, err));
    for (int k = 0; k < t->ncolumns; k++)
        PH_CHECK(strcmp(t->name[k], name) != 0, PH_EINVAL,
                 "columns %d and %d have the same name '%s'", k + 1, t->ncolumns + 1,
                 name);
    strcpy(t->name[t->ncolumns++], name);
out:
    return st;
}

static ph_status read_header(reader *r, ph_table *t, ph_error *err)
{
    ph_status st = PH_OK;
    char cell[LONGEST_CELL];
    text_line line;
    bool more = true;
    r->separator = '\t'; /* tabs at the end of the header may be cells */
    PH_CHECK(next_line(r, &line), PH_EINVAL,
             "%s: empty: a table begins with a row of names", r->file);
    r->separator = separator_of(line);
    while (line.end > line.at && is_padding(r, line.end[-1]))
        line.end--;
    PH_ALLOC(t->name, PH_TABLE_COLUMNS, "the names of a table");
    while (more) {
        PH_TRY(next_cell(r, &line, cell, &more, err));
        st = add_name(t, cell, err);
        if (st != PH_OK) {
            ph_error_prefix(err, "%s:%d: ", r->file, r->line);
            goto out;
        }
    }
out:
    return st;
}

static bool is_word(const char *cell, const char *lower)
{
    for (; *cell && *lower; cell++, lower++)
        if ((*cell | 0x20) != *lower) return false;
    return !*cell && !*lower;
}

static ph_status read_number(const reader *r, const char *column, const char *cell,
                             double *out, ph_error *err)
{
    ph_status st = PH_OK;
    char text[64];
    *out = NAN;
    if (!cell[0] || is_word(cell, "nan") || is_word(cell, "na")) goto out;
    bool good = !strpbrk(cell, "nN") && ph_i_text_to_number(cell, out);
    PH_CHECK(good, PH_EINVAL, "%s:%d: column '%s': '%s' is not a number%s", r->file,
             r->line, column, shown(cell, text),
             strchr(cell, ',') ? ": write a decimal point"
             : strpbrk(cell, "iI") && strpbrk(cell, "nN") && strpbrk(cell, "fF")
                 ? ": leave the cell empty where there is no value"
                 : " such as 12.5 or 1.25e1; leave the cell empty where there is none");
    PH_CHECK(isfinite(*out), PH_EINVAL,
             "%s:%d: column '%s': '%s' is too large: choose another unit", r->file,
             r->line, column, shown(cell, text));
out:
    return st;
}

static ph_status read_row(const reader *r, text_line line, ph_table *t, ptrdiff_t row,
                          ph_error *err)
{
    ph_status st = PH_OK;
    char cell[LONGEST_CELL];
    bool more = true;
    for (int k = 0; k < t->ncolumns; k++) {
        PH_CHECK(more, PH_EINVAL,
                 "%s:%d: %d cells, but the header has %d: '%s' is missing", r->file,
                 r->line, k, t->ncolumns, t->name[k]);
        PH_TRY(next_cell(r, &line, cell, &more, err));
        PH_TRY(read_number(r, t->name[k], cell, &t->value[k * t->nrows + row], err));
    }
    PH_CHECK(!more, PH_EINVAL, "%s:%d: more cells than the %d names of the header%s",
             r->file, r->line, t->ncolumns,
             r->separator == ','   ? ": a comma separates, it is no decimal point"
             : r->separator == ' ' ? ": blanks separate"
                                   : "");
    t->line[row] = r->line;
out:
    return st;
}

static ph_status allocate_rows(ph_table *t, ptrdiff_t nrows, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(nrows <= PH_TABLE_CELLS / t->ncolumns, PH_EINVAL,
             "a table of %d columns and %td rows: at most %d cells", t->ncolumns, nrows,
             PH_TABLE_CELLS);
    PH_ALLOC(t->value, (size_t)t->ncolumns * (size_t)nrows, "a table");
    PH_ALLOC(t->line, nrows, "the lines of a table");
    t->nrows = nrows;
out:
    return st;
}

static ph_status read_rows(reader *r, ph_table *t, ph_error *err)
{
    ph_status st = PH_OK;
    const reader start = *r;
    text_line line;
    ptrdiff_t nrows = 0;
    while (next_line(r, &line))
        nrows++;
    *r = start;
    st = allocate_rows(t, nrows, err);
    if (st != PH_OK) {
        ph_error_prefix(err, "%s: ", r->file);
        goto out;
    }
    for (ptrdiff_t row = 0; row < nrows && next_line(r, &line); row++)
        PH_TRY(read_row(r, line, t, row, err));
out:
    return st;
}

static ph_status check_bytes(const char *text, size_t length, const char *name,
                             ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(text || length == 0, PH_EINVAL, "%s: no text", name);
    PH_CHECK(length <= MOST_BYTES, PH_EINVAL, "%s: more than 1 GiB: not a table", name);
    PH_CHECK(length == 0 || !memchr(text, 0, length), PH_EINVAL,
             "%s: not a text in UTF-8 (it has a zero byte)%s", name,
             length > 2 && ((unsigned char)text[0] | 1) == 0xff
                 ? ": this is UTF-16, save it as UTF-8"
                 : "");
out:
    return st;
}

ph_status ph_table_parse(const char *text, size_t length, const char *name,
                         ph_table **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_table *t = NULL;
    name = name ? name : "table";
    PH_TRY(check_bytes(text, length, name, err));
    PH_ALLOC(t, 1, "a table");
    snprintf(t->path, sizeof t->path, "%s", name);
    reader r = {.at = text, .end = text ? text + length : text, .file = name};
    if (length >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0) r.at += 3;
    PH_TRY(read_header(&r, t, err));
    PH_TRY(read_rows(&r, t, err));
    *out = t;
    t = NULL;
out:
    ph_table_free(&t);
    return st;
}

ph_status ph_table_read(const char *path, ph_table **out, ph_error *err)
{
    ph_status st = PH_OK;
    char *text = NULL;
    size_t length = 0;
    PH_CHECK(path && path[0], PH_EINVAL, "no file name of a table");
    PH_TRY(ph_i_read_file(path, MOST_BYTES, "table", &text, &length, err));
    PH_TRY(ph_table_parse(text, length, path, out, err));
out:
    free(text);
    return st;
}

ph_status ph_table_new(int ncolumns, const char *const *name, ptrdiff_t nrows,
                       ph_table **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_table *t = NULL;
    PH_CHECK(ncolumns > 0 && ncolumns <= PH_TABLE_COLUMNS && name && nrows >= 0,
             PH_EINVAL, "a table of %d columns and %td rows: 1 to %d columns", ncolumns,
             nrows, PH_TABLE_COLUMNS);
    PH_ALLOC(t, 1, "a table");
    PH_ALLOC(t->name, ncolumns, "the names of a table");
    for (int k = 0; k < ncolumns; k++)
        PH_TRY(add_name(t, name[k], err));
    PH_TRY(allocate_rows(t, nrows, err));
    for (ptrdiff_t k = 0; k < ncolumns * nrows; k++)
        t->value[k] = NAN;
    for (ptrdiff_t row = 0; row < nrows; row++)
        t->line[row] = (int)row + 2;
    *out = t;
    t = NULL;
out:
    ph_table_free(&t);
    return st;
}

void ph_table_free(ph_table **table)
{
    if (!table || !*table) return;
    free((*table)->name);
    free((*table)->value);
    free((*table)->line);
    free(*table);
    *table = NULL;
}

/* Length of a column's name without a unit in brackets behind it. */
static size_t bare_length(const char *name)
{
    size_t n = strcspn(name, "([");
    while (n > 0 && is_blank(name[n - 1]))
        n--;
    return n;
}

static char folded(char ch)
{
    return (char)(ch >= 'A' && ch <= 'Z' ? ch | 0x20 : ch);
}

int ph_table_column(const ph_table *table, const char *name)
{
    if (!table || !name) return -1;
    for (int k = 0; k < table->ncolumns; k++)
        if (strcmp(table->name[k], name) == 0) return k;
    for (int k = 0; k < table->ncolumns; k++) {
        const char *have = table->name[k];
        size_t n = bare_length(have), same = 0;
        while (same < n && folded(have[same]) == folded(name[same]))
            same++;
        if (n > 0 && same == n && !name[n]) return k;
    }
    return -1;
}

/* Where the parser could take the name for something else: in quotes. */
static void grow_name(ph_i_growing *g, const char *name, bool alone)
{
    bool quote = strpbrk(name, alone ? " ,;\t#\"" : ",;\t#\"") || name[0] == ' ' ||
                 name[strlen(name) - 1] == ' ';
    if (quote) ph_i_append(g, "\"", 1);
    for (; *name; name++) {
        ph_i_append(g, name, 1);
        if (*name == '"') ph_i_append(g, "\"", 1);
    }
    if (quote) ph_i_append(g, "\"", 1);
}

ph_status ph_table_to_csv(const ph_table *table, char **text, ph_error *err)
{
    PH_GIVEN(table && text);
    ph_status st = PH_OK;
    ph_i_growing g = {.text = NULL};
    for (int k = 0; k < table->ncolumns; k++) {
        if (k > 0) ph_i_append(&g, ",", 1);
        grow_name(&g, table->name[k], table->ncolumns == 1);
    }
    ph_i_append(&g, "\n", 1);
    for (ptrdiff_t row = 0; row < table->nrows && !g.failed; row++)
        for (int k = 0; k < table->ncolumns; k++) {
            double x = table->value[k * table->nrows + row];
            if (isfinite(x))
                ph_i_append_exact(&g, x);
            else if (table->ncolumns == 1)
                ph_i_append(&g, "nan", 3); /* an empty line would not be a row */
            ph_i_append(&g, k + 1 < table->ncolumns ? "," : "\n", 1);
        }
    PH_CHECK(!g.failed, PH_ENOMEM, "no memory for the text of a table");
    *text = g.text;
    g.text = NULL;
out:
    free(g.text);
    return st;
}
