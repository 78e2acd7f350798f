/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cases by hand: an inclusion with nothing given, random ones of each shape, a case. */
#ifndef TESTS_RVE_CASE_H
#define TESTS_RVE_CASE_H

#include <perihom_rve.h>

#include "check.h"

static const double pi = 3.14159265358979323846;

static inline ph_inclusion no_inclusion(const char *shape, int material)
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

/* Any shape, with lengths from..to (half lengths for most) and its centre in the box. */
static inline ph_inclusion random_inclusion(const char *shape, int material,
                                            const double size[3], double from, double to,
                                            uint64_t *seed)
{
    ph_inclusion inc = no_inclusion(shape, material);
    for (int a = 0; a < 3; a++) {
        inc.centre[a] = check_uniform(seed, 0, size[a]);
        inc.semi_axes[a] = check_uniform(seed, from, to);
        inc.size[a] = 2 * check_uniform(seed, from, to);
        inc.axis[a] = check_uniform(seed, -1, 1);
    }
    inc.radius = check_uniform(seed, from, to);
    inc.angle = check_uniform(seed, 0, 360);
    inc.length = 2 * check_uniform(seed, from, to);
    inc.normal = 1 + (int)(2 * check_random(seed));
    inc.from = check_uniform(seed, 0, 1);
    inc.to = inc.from + check_uniform(seed, from, to);
    return inc;
}

static inline bool has_dimension(const ph_shape *shape, int dim)
{
    return shape->dimensions == 0 || shape->dimensions == dim;
}

enum { TEST_MATERIALS = 4 };

static inline ph_case shapes_case(int dim, const ptrdiff_t n[3], const double size[3],
                                  ph_inclusion *inc, int ninclusions,
                                  ph_material *materials)
{
    ph_case c = {.path = "test.yaml",
                 .nmaterials = TEST_MATERIALS,
                 .materials = materials,
                 .kinematics = dim == 3 ? PH_SPACE : PH_PLANE_STRAIN,
                 .inclusions = inc,
                 .ninclusions = ninclusions};
    for (int a = 0; a < dim; a++) {
        c.nodes[a] = n[a];
        c.size[a] = size[a];
    }
    for (int i = 0; i < TEST_MATERIALS; i++) {
        materials[i] = (ph_material){.is_isotropic = true, .E = 1 + i, .nu = 0.3};
        snprintf(materials[i].name, sizeof materials[i].name, "m%d", i);
    }
    return c;
}

#endif
