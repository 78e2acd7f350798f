/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/version.h>

#include "check.h"

static void test_versions(void **state)
{
    (void)state;
    char want[32];
    snprintf(want, sizeof want, "%d.%d.%d", PH_VERSION_MAJOR, PH_VERSION_MINOR,
             PH_VERSION_PATCH);
    CHECK(strcmp(ph_version(), want) == 0);
    CHECK(strlen(ph_git_revision()) > 0 && strlen(ph_compiler()) > 3);
    int n = 0;
    const char *version;
    for (const char *name; (name = ph_dependency(n, &version)) != NULL; n++)
        CHECK(strlen(name) > 2 && strpbrk(version, "0123456789") != NULL);
    CHECK(n == 7);
    CHECK(ph_dependency(n, &version) == NULL && version == NULL);
    CHECK(ph_dependency(0, NULL) != NULL && ph_dependency(-1, NULL) == NULL);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_versions)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
