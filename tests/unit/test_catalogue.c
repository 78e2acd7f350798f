/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/catalogue.h>

#include "check.h"

static void test_entries_are_complete_and_found(void **state)
{
    (void)state;
    int catalogues = 0;
    for (const ph_catalogue *c = ph_catalogues(); c->name; c++, catalogues++) {
        CHECK(*c->count > 0 && strlen(c->title) > 0);
        for (size_t i = 0; i < *c->count; i++) {
            const ph_entry *e = ph_catalogue_entry(c, i);
            CHECK(e->name && e->title && e->reference && e->valid);
            CHECK(ph_catalogue_find(c, e->name) == (int)i); /* names are unique */
        }
        CHECK(ph_catalogue_find(c, "no such method") == -1);
        CHECK(ph_catalogue_find(c, NULL) == -1);
    }
    CHECK(catalogues > 0);
    CHECK_END();
}

static const char *nearest(const char *word)
{
    static const char *const names[] = {
        "horizon", NULL, "influence", "stabilisation", "plane_stress", "nu", "E"};
    const char *found = ph_nearest_name(word, names, 7);
    return found ? found : "";
}

static void test_nearest_name(void **state)
{
    (void)state;
    CHECK(strcmp(nearest("horizn"), "horizon") == 0);
    CHECK(strcmp(nearest("hroizon"), "horizon") == 0);
    CHECK(strcmp(nearest("Influence"), "influence") == 0);
    CHECK(strcmp(nearest("stabilization"), "stabilisation") == 0);
    CHECK(strcmp(nearest("plane_strain"), "plane_stress") == 0);
    CHECK(strcmp(nearest("mu"), "nu") == 0);
    CHECK(strcmp(nearest("un"), "nu") == 0); /* a swap is one slip */
    CHECK(strcmp(nearest("e"), "E") == 0);
    CHECK(strcmp(nearest("x"), "") == 0);
    CHECK(strcmp(nearest("temperature"), "") == 0);
    CHECK(strcmp(nearest(""), "") == 0);
    CHECK(ph_nearest_name(NULL, NULL, 0) == NULL);
    char longest[200];
    memset(longest, 'a', sizeof longest);
    longest[sizeof longest - 1] = 0;
    CHECK(strcmp(nearest(longest), "") == 0);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_entries_are_complete_and_found),
        cmocka_unit_test(test_nearest_name),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
