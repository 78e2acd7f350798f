/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom_rve.h>

#include "check.h"

static const double pi = 3.14159265358979323846;

static ph_inclusion nothing(const char *shape, int material)
{
    ph_inclusion inc = {.material = material, .line = 7};
    snprintf(inc.shape, sizeof inc.shape, "%s", shape);
    double *all[] = {inc.centre, inc.semi_axes, inc.size, inc.axis};
    for (int i = 0; i < 4; i++)
        for (int a = 0; a < 3; a++)
            all[i][a] = NAN;
    inc.radius = inc.fraction = inc.angle = inc.length = inc.from = inc.to = NAN;
    return inc;
}

static void test_disk_area(void **state)
{
    (void)state;
    ph_material mat[2] = {{.name = "a"}, {.name = "b"}};
    ph_inclusion inc = nothing("disk", 1);
    ph_error err = PH_ERROR_INIT;
    inc.centre[0] = 0.31, inc.centre[1] = 0.87, inc.radius = 0.27;
    ph_case c = {.nmaterials = 2,
                 .materials = mat,
                 .kinematics = PH_PLANE_STRAIN,
                 .nodes = {17, 31},
                 .size = {1, 1.3},
                 .ninclusions = 1,
                 .inclusions = &inc};
    ph_microstructure *m = NULL;
    CHECK_OK(ph_rve_build(&c, &m, &err));
    double f[2];
    CHECK_OK(ph_microstructure_check(m, &err));
    ph_microstructure_fractions(m, f);
    CHECK_REL(f[1], pi * 0.27 * 0.27 / 1.3, 1e-12);
    ph_microstructure_free(&m);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_disk_area)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
