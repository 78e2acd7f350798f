/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/sample.h"

#include <signal.h>
#include <sys/resource.h>

static char folder[256];

static const char *in_folder(const char *name)
{
    static char path[2048];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static void check_holds(const char *path, const char *want)
{
    size_t length = 0;
    char *text = sample_read(path, &length);
    CHECK(text && length == strlen(want) && memcmp(text, want, length) == 0);
    free(text);
}

static void test_writes_and_replaces(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    CHECK_OK(ph_write_file(in_folder("a.txt"), "first, longer", 13, &err));
    check_holds(in_folder("a.txt"), "first, longer");
    CHECK_OK(ph_write_file(in_folder("a.txt"), "second", 6, &err));
    check_holds(in_folder("a.txt"), "second");
    CHECK_OK(ph_write_file(in_folder("empty"), NULL, 0, &err));
    check_holds(in_folder("empty"), "");
    CHECK(sample_entries(folder, true) == 2);
    CHECK_END();
}

static void test_new_file_honours_the_umask(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    struct stat about;
    mode_t old = umask(027);
    CHECK_OK(ph_write_file(in_folder("a.txt"), "x", 1, &err));
    umask(old);
    CHECK(stat(in_folder("a.txt"), &about) == 0 && (about.st_mode & 0777) == 0640);
    sample_entries(folder, true);
    CHECK_END();
}

static void test_a_link_stays_a_link(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    struct stat about;
    char target[300];
    snprintf(target, sizeof target, "%s/target", folder);
    CHECK_OK(ph_write_file(target, "old", 3, &err));
    CHECK(symlink("target", in_folder("link")) == 0);
    CHECK_OK(ph_write_file(in_folder("link"), "new", 3, &err));
    CHECK(lstat(in_folder("link"), &about) == 0 && S_ISLNK(about.st_mode));
    check_holds(target, "new");
    CHECK(sample_entries(folder, true) == 2);
    CHECK_END();
}

/* The call fails with PH_EIO, says `word` and the path, and leaves nothing behind. */
static void check_fails(const char *path, const char *word)
{
    ph_error err = PH_ERROR_INIT;
    CHECK(ph_write_file(path, "x", 1, &err) == PH_EIO);
    CHECK(err.status == PH_EIO);
    if (!strstr(err.msg, word)) {
        check_failures++;
        print_error("'%s' not in '%s'\n", word, err.msg);
    }
    CHECK(sample_entries(folder, false) == 0);
}

static void test_paths_that_cannot_be_written(void **state)
{
    (void)state;
    char name[400], deep[5000];
    check_fails(in_folder("missing/a.txt"), "No such file");
    check_fails("/dev/null/a.txt", "Not a directory");
    check_fails(folder, "Is a directory");
    check_fails("/proc/perihom.txt", "/proc/perihom.txt"); /* read-only even for root */
    memset(name, 'n', sizeof name);
    name[sizeof name - 1] = 0;
    check_fails(in_folder(name), "too long");
    memset(deep, 'd', sizeof deep);
    deep[sizeof deep - 1] = 0;
    check_fails(deep, "longer than");
    check_fails("/dev/full", "No space left");
    ph_error err = PH_ERROR_INIT;
    CHECK(ph_write_file("", "x", 1, &err) == PH_EINVAL);
    CHECK(ph_write_file(NULL, "x", 1, NULL) == PH_EINVAL);
    CHECK_END();
}

static void test_a_read_only_folder(void **state)
{
    (void)state;
    if (geteuid() == 0) skip(); /* root writes everywhere */
    CHECK(chmod(folder, 0555) == 0);
    check_fails(in_folder("a.txt"), "Permission denied");
    CHECK(chmod(folder, 0755) == 0);
    CHECK_END();
}

static void test_devices_are_written_in_place(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    struct stat about;
    CHECK_OK(ph_write_file("/dev/null", "x", 1, &err));
    CHECK(stat("/dev/null", &about) == 0 && S_ISCHR(about.st_mode));
    CHECK(stat("/dev/full", &about) == 0 && S_ISCHR(about.st_mode));
    CHECK_END();
}

/* A limit on the size of files stands for a disk that fills up half-way. */
static void test_full_disk_keeps_the_old_file(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    struct rlimit old, small;
    size_t length = 100000;
    char *big = malloc(length);
    assert_non_null(big);
    memset(big, 'b', length);
    CHECK_OK(ph_write_file(in_folder("a.txt"), "old", 3, &err));
    signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &old);
    small = (struct rlimit){4096, old.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
    ph_status got = ph_write_file(in_folder("a.txt"), big, length, &err);
    setrlimit(RLIMIT_FSIZE, &old);
    CHECK(got == PH_EIO && strstr(err.msg, "too large"));
    check_holds(in_folder("a.txt"), "old");
    CHECK(sample_entries(folder, true) == 1);
    free(big);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_writes_and_replaces),
        cmocka_unit_test(test_new_file_honours_the_umask),
        cmocka_unit_test(test_a_link_stays_a_link),
        cmocka_unit_test(test_paths_that_cannot_be_written),
        cmocka_unit_test(test_a_read_only_folder),
        cmocka_unit_test(test_devices_are_written_in_place),
        cmocka_unit_test(test_full_disk_keeps_the_old_file),
    };
    sample_folder(folder);
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    sample_remove_folder(folder);
    return failed;
}
