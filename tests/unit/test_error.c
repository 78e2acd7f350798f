/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/error.h>

#include "check.h"

static void test_first_failure_wins(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    CHECK(ph_error_set(&err, PH_EINVAL, "f.c", 7, "nu is %g", 0.62) == PH_EINVAL);
    ph_error_set(&err, PH_ENOMEM, "g.c", 8, "later");
    ph_error_prefix(&err, "phase '%s': ", "fibre");
    CHECK(err.status == PH_EINVAL && err.line == 7);
    CHECK(strcmp(err.msg, "phase 'fibre': nu is 0.62") == 0);
    CHECK(ph_error_set(NULL, PH_EIO, "h.c", 9, "nobody listens") == PH_EIO);
    CHECK_END();
}

static void test_long_messages_are_cut_not_overrun(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    char big[2000];
    memset(big, 'x', sizeof big - 1);
    big[sizeof big - 1] = 0;
    ph_error_set(&err, PH_EIO, "f.c", 1, "%s", big);
    CHECK(strlen(err.msg) == sizeof err.msg - 1);
    ph_error_prefix(&err, "%s", big);
    CHECK(strlen(err.msg) == sizeof err.msg - 1);
    CHECK_END();
}

static void test_exit_codes(void **state)
{
    (void)state;
    CHECK(ph_status_exit_code(PH_OK) == 0);
    CHECK(ph_status_exit_code(PH_EUSAGE) == 2);
    CHECK(ph_status_exit_code(PH_EUNPHYSICAL) == 3);
    CHECK(ph_status_exit_code(PH_ESINGULAR) == 4);
    CHECK(ph_status_exit_code(PH_EIO) == 5);
    CHECK(ph_status_exit_code(PH_ECANCELLED) == 130);
    CHECK(ph_status_text((ph_status)99) != NULL);
    CHECK_END();
}

static void test_about(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_error_about(&err, "model.%s", "kind"); /* of no failure */
    CHECK(!err.key[0]);
    ph_error_set(&err, PH_EINVAL, NULL, 0, "no");
    CHECK(!err.key[0]);
    ph_error_about(&err, "materials.%s.nu", "fibre");
    ph_error_about(&err, "model"); /* whoever is nearest knows best */
    CHECK(strcmp(err.key, "materials.fibre.nu") == 0);
    ph_error_about(NULL, "model");
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_about),
        cmocka_unit_test(test_first_failure_wins),
        cmocka_unit_test(test_long_messages_are_cut_not_overrun),
        cmocka_unit_test(test_exit_codes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
