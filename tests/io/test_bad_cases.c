/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every malformed case of tests/cli/bad gives exactly the complaints of its .expect file. */
#include <perihom/case.h>

#include "check.h"

#include <dirent.h>
#include <unistd.h>

enum { AT_LEAST = 65 };

static char *read_text(const char *path)
{
    static char text[1 << 16];
    FILE *file = fopen(path, "rb");
    if (!file) return NULL;
    text[fread(text, 1, sizeof text - 1, file)] = 0;
    fclose(file);
    return text;
}

static bool ends_with(const char *text, const char *end)
{
    size_t n = strlen(text), m = strlen(end);
    return n >= m && strcmp(text + n - m, end) == 0;
}

/* All complaints as the command line prints them. */
static void print_issues(const ph_case_issues *issues, const char *name, char *out,
                         size_t size)
{
    size_t used = 0;
    out[0] = 0;
    for (size_t i = 0; i < issues->count && used < size; i++) {
        char line[700];
        ph_case_issue_text(&issues->item[i], name, line, sizeof line);
        used += (size_t)snprintf(out + used, size - used, "%s\n", line);
    }
}

static void check_one(const char *name)
{
    char expect[300], got[1 << 16];
    snprintf(expect, sizeof expect, "%.*s.expect", (int)(strlen(name) - 5), name);
    const char *want = read_text(expect);
    ph_case *c = NULL;
    ph_case_issues issues = {0};
    ph_error err = PH_ERROR_INIT, alone = PH_ERROR_INIT;
    /* files named physics-* are well-formed, what they say is impossible */
    ph_status status = strncmp(name, "physics-", 8) == 0 ? PH_EUNPHYSICAL : PH_EINVAL;
    ph_status st = ph_case_read(name, NULL, 0, &c, &issues, &err);
    if (st != status) print_error("%s: status %d, want %d\n", name, st, status);
    CHECK(st == status);
    CHECK(ph_status_exit_code(st) == 3);
    CHECK(c == NULL);
    print_issues(&issues, name, got, sizeof got);
    if (!want || strcmp(got, want) != 0) {
        print_error("%s: got\n%swant\n%s", name, got,
                    want ? want : "(no .expect file)\n");
        check_failures++;
    }
    CHECK(strncmp(got, err.msg, strlen(err.msg)) == 0); /* err has the first of them */
    CHECK(ph_case_read(name, NULL, 0, &c, NULL, &alone) ==
          st); /* a caller without a list */
    CHECK(strcmp(alone.msg, err.msg) == 0);
    ph_case_issues_free(&issues);
    CHECK(issues.item == NULL && issues.count == 0);
}

static void test_every_bad_file(void **state)
{
    (void)state;
    assert_int_equal(chdir(PH_TEST_DIR "/cli/bad"), 0);
    DIR *folder = opendir(".");
    assert_non_null(folder);
    int files = 0;
    for (struct dirent *entry; (entry = readdir(folder));) {
        if (!ends_with(entry->d_name, ".yaml")) continue;
        check_one(entry->d_name);
        files++;
    }
    closedir(folder);
    CHECK(files >= AT_LEAST);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_every_bad_file)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
