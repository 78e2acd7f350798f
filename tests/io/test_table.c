/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/table.h>

#include "io/sample.h"

#include <locale.h>

static ph_table *parse(const char *text)
{
    ph_error err = PH_ERROR_INIT;
    ph_table *t = NULL;
    ph_status st = ph_table_parse(text, strlen(text), "t.csv", &t, &err);
    if (st != PH_OK) fail_msg("%s", err.msg);
    return t;
}

/* The four separators, with everything around the cells that is allowed there. */
static void test_separators(void **state)
{
    (void)state;
    static const char *const text[] = {
        "a,b,c\n1,2.5,-3e2\n4,,6\n",
        "\xef\xbb\xbf# measured\r\n\r\n a , b ,c # names\r\n1, 2.5 ,-3e2#x\r\n"
        "  \t\r\n4,   ,6\r\n",
        "a;b;c\n1;2.5;-3e2\n4;;6",
        "a\tb\tc\n1\t2.5\t-3e2\n4\t\t6\n",
        "  a   b   c\n 1 2.5 \t -3e2 \n4 nan 6\n",
        "\"a\",\"b\",\"c\"\n\"1\",\"2.5\",\"-3e2\"\n\"4\",\"\",\"6\"\n",
        "a,b,c\r1,2.5,-3e2\r4,NA,6\r",
        "\"a\" b c\n1 2.5 -3e2\n4 \"\" 6\n",
    };
    for (size_t i = 0; i < sizeof text / sizeof *text; i++) {
        ph_table *t = parse(text[i]);
        CHECK(t->ncolumns == 3 && t->nrows == 2);
        CHECK(strcmp(t->name[0], "a") == 0 && strcmp(t->name[1], "b") == 0 &&
              strcmp(t->name[2], "c") == 0);
        static const double want[6] = {1, 4, 2.5, NAN, -300, 6};
        for (int k = 0; k < 6 && t->nrows == 2; k++)
            CHECK(isnan(want[k]) ? isnan(t->value[k]) : t->value[k] == want[k]);
        CHECK(strcmp(t->path, "t.csv") == 0);
        ph_table_free(&t);
        CHECK(t == NULL);
    }
    CHECK_END();
}

static void test_lines_and_names(void **state)
{
    (void)state;
    ph_table *t =
        parse("# one\n\n\"time, s\";\"E \"\"dry\"\"\";Storage (GPa);\xc3\xa9 [s]\n"
              "# two\n1;2;3;4\n\n5;6;7;8\n");
    CHECK(t->line[0] == 5 && t->line[1] == 7);
    CHECK(strcmp(t->name[0], "time, s") == 0 && strcmp(t->name[1], "E \"dry\"") == 0);
    CHECK(ph_table_column(t, "time, s") == 0);
    CHECK(ph_table_column(t, "storage") == 2);
    CHECK(ph_table_column(t, "STORAGE") == 2);
    CHECK(ph_table_column(t, "Storage (GPa)") == 2);
    CHECK(ph_table_column(t, "storage (GPa)") == -1);
    CHECK(ph_table_column(t, "stor") == -1 && ph_table_column(t, "storages") == -1);
    CHECK(ph_table_column(t, "\xc3\xa9") == 3 && ph_table_column(t, "") == -1);
    ph_table_free(&t);
    t = parse("E (1),e,E\n1,2,3\n");
    CHECK(ph_table_column(t, "E") == 2 && ph_table_column(t, "e") == 1);
    ph_table_free(&t);
    t = parse("only names\n");
    CHECK(t->ncolumns == 2 && t->nrows == 0);
    ph_table_free(&t);
    ph_table_free(&t);
    ph_table_free(NULL);
    CHECK_END();
}

static void check_refused(const char *text, size_t length, const char *says)
{
    ph_error err = PH_ERROR_INIT;
    ph_table *t = NULL;
    ph_status st = ph_table_parse(text, length, "t.csv", &t, &err);
    CHECK(st == PH_EINVAL && err.status == PH_EINVAL && t == NULL);
    if (!strstr(err.msg, says)) {
        print_error("'%s' does not say '%s'\n", err.msg, says);
        CHECK(false);
    }
    CHECK(strncmp(err.msg, "t.csv", 5) == 0 && !strchr(err.msg, '\n'));
}

static void test_refused(void **state)
{
    (void)state;
    static const struct {
        const char *text, *says;
    } bad[] = {
        {"", "t.csv: empty"},
        {"# nothing\n\n", "t.csv: empty"},
        {"a,b\n1,2,3\n", "t.csv:2: more cells than the 2 names of the header: a comma"},
        {"a b\n1 2 3\n", "blanks separate"},
        {"a;b\n1;2;3\n", "t.csv:2: more cells than the 2 names"},
        {"a,b\n\n1\n", "t.csv:3: 1 cells, but the header has 2: 'b' is missing"},
        {"a,b\n1,x1\n", "t.csv:2: column 'b': 'x1' is not a number"},
        {"a;b\n1;2,5\n", "column 'b': '2,5' is not a number: write a decimal point"},
        {"a,b\n1,inf\n", "leave the cell empty"},
        {"a,b\n1,.inf\n", "'.inf' is not a number"},
        {"a,b\n1,1e999\n", "'1e999' is too large"},
        {"a,b\n1,0x10\n", "'0x10' is not a number"},
        {"a,b\n1,1 2\n", "'1 2' is not a number"},
        {"a,b\n1,\"2\n", "t.csv:2: a quote is opened and not closed"},
        {"a,b\n1,\"2\"3\n", "t.csv:2: text behind a closing quote"},
        {"a b\n1 \"2\"3\n", "t.csv:2: no blank between two cells"},
        {"a,a\n", "columns 1 and 2 have the same name 'a'"},
        {"a,,c\n", "column 2 has no name"},
        {"a,b,\n1,2,\n", "column 3 has no name"},
        {"1,2\n3,4\n", "a table begins with a row of names"},
        {"a\x01"
         "b,c\n",
         "control character"},
        {"\xff"
         "b,c\n",
         "'?b' is not UTF-8"},
        {"a,b\n1,\x1b[2J\n", "'?[2J' is not a number"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        check_refused(bad[i].text, strlen(bad[i].text), bad[i].says);
    check_refused("\xff\xfe"
                  "a\0,\0b\0",
                  8, "UTF-16");
    check_refused("a,b\n1,\0\n", 8, "zero byte");
    CHECK_END();
}

/* A text of `count` times `piece` after `head`. */
static char *repeated(const char *head, const char *piece, size_t count)
{
    size_t size = strlen(piece), at = strlen(head);
    char *text = malloc(at + count * size + 1);
    assert_non_null(text);
    strcpy(text, head);
    for (size_t k = 0; k < count; k++, at += size)
        memcpy(text + at, piece, size + 1);
    return text;
}

static void test_limits(void **state)
{
    (void)state;
    char *text = repeated("", "0123456789", 7);
    char name[80] = "n,";
    memcpy(name + 2, text, 64);
    name[2] = 'x';
    check_refused(name, 66, "longer than 63 bytes");
    name[65] = 0;
    ph_table *t = parse(name);
    CHECK(strlen(t->name[1]) == 63);
    ph_table_free(&t);
    free(text);
    text = repeated("a,b\n1,", "0", 300);
    check_refused(text, strlen(text), "t.csv:2: a cell of more than 255 bytes");
    free(text);
    text = repeated("a,b\n1,\"", "\"\"", 300);
    check_refused(text, strlen(text), "t.csv:2: a cell of more than 255 bytes");
    free(text);
    text = repeated("x", ",y", 300);
    check_refused(text, strlen(text), "same name 'y'");
    free(text);
    text = repeated("x\n", "7\n", 200000);
    t = parse(text);
    CHECK(t->nrows == 200000 && t->value[199999] == 7 && t->line[199999] == 200001);
    ph_table_free(&t);
    free(text);
    CHECK_END();
}

static void test_new_is_checked(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    static const char *const good[] = {"a", "b"}, *const same[] = {"a", "a"};
    static const char *const none[] = {"a", NULL};
    ph_table *t = NULL;
    CHECK_OK(ph_table_new(2, good, 3, &t, &err));
    CHECK(t && t->nrows == 3 && isnan(t->value[5]) && t->line[2] == 4);
    ph_table_free(&t);
    CHECK(ph_table_new(2, same, 3, &t, NULL) == PH_EINVAL);
    CHECK(ph_table_new(2, none, 3, &t, NULL) == PH_EINVAL);
    CHECK(ph_table_new(0, good, 3, &t, NULL) == PH_EINVAL);
    CHECK(ph_table_new(PH_TABLE_COLUMNS + 1, good, 3, &t, NULL) == PH_EINVAL);
    CHECK(ph_table_new(2, good, -1, &t, NULL) == PH_EINVAL);
    CHECK(ph_table_new(2, good, PTRDIFF_MAX, &t, NULL) == PH_EINVAL);
    CHECK(ph_table_parse(NULL, 3, "t", &t, NULL) == PH_EINVAL);
    CHECK(t == NULL);
    CHECK_END();
}

/* Written and read: the same names and the same bits, whatever the locale. */
static void check_round_trip(uint64_t *seed)
{
    ph_error err = PH_ERROR_INIT;
    static const char *const name[] = {"time (s)", "E, dry", " \"q\" #", "\xcf\x89"};
    static const char *const alone[] = {"one name"};
    for (int columns = 1; columns <= 4; columns += 3) {
        ph_table *t = NULL, *back = NULL;
        char *text = NULL;
        CHECK_OK(ph_table_new(columns, columns == 1 ? alone : name, 50, &t, &err));
        for (ptrdiff_t k = 0; k < columns * 50; k++)
            t->value[k] = k % 7 == 3   ? (double)NAN
                          : k % 7 == 4 ? (double)k
                          : k == 5     ? -0x1p-1074
                                       : check_uniform(seed, -1, 1) *
                                         pow(10, check_uniform(seed, -300, 300));
        CHECK_OK(ph_table_to_csv(t, &text, &err));
        CHECK_OK(ph_table_parse(text, strlen(text), "t", &back, &err));
        CHECK(back && back->nrows == 50 && back->ncolumns == columns);
        for (int k = 0; back && k < columns; k++)
            CHECK(strcmp(back->name[k], t->name[k]) == 0);
        for (ptrdiff_t k = 0; back && k < columns * 50; k++)
            CHECK(isnan(t->value[k]) ? isnan(back->value[k])
                                     : back->value[k] == t->value[k]);
        for (int k = 0; back && k < 50; k++)
            CHECK(back->line[k] == t->line[k]);
        free(text);
        ph_table_free(&t);
        ph_table_free(&back);
    }
}

static void test_round_trip(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    check_round_trip(&seed);
    if (setlocale(LC_ALL, "de_DE.UTF-8")) check_round_trip(&seed);
    setlocale(LC_ALL, "C");
    CHECK_END();
}

static void test_files(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    char folder[256], path[300];
    ph_table *t = NULL;
    sample_folder(folder);
    snprintf(path, sizeof path, "%s/a.csv", folder);
    CHECK_OK(ph_write_file(path, "x y\n1 2\n", 8, &err));
    CHECK_OK(ph_table_read(path, &t, &err));
    CHECK(t && t->ncolumns == 2 && strcmp(t->path, path) == 0);
    ph_table_free(&t);
    CHECK(ph_table_read(folder, &t, &err) == PH_EIO && err.msg[0]);
    err = (ph_error)PH_ERROR_INIT;
    snprintf(path, sizeof path, "%s/none.csv", folder);
    CHECK(ph_table_read(path, &t, &err) == PH_EIO && strstr(err.msg, "none.csv"));
    CHECK(ph_table_read("", &t, NULL) == PH_EINVAL && t == NULL);
    sample_remove_folder(folder);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_separators),     cmocka_unit_test(test_lines_and_names),
        cmocka_unit_test(test_refused),        cmocka_unit_test(test_limits),
        cmocka_unit_test(test_new_is_checked), cmocka_unit_test(test_round_trip),
        cmocka_unit_test(test_files),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
