/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cells to homogenise and their answers, for the tests; include after check.h. */
#ifndef TESTS_SOLVE_H
#define TESTS_SOLVE_H

#include <perihom_rve.h>

#include "tensors.h"

static const ph_ctx one_thread = {.threads = 1};

static inline ph_material isotropic(const char *name, double E, double nu)
{
    ph_error err = PH_ERROR_INIT;
    ph_material m;
    CHECK_OK(ph_material_isotropic(name, E, nu, &m, &err));
    return m;
}

/* From Lame's first parameter and the shear modulus. */
static inline ph_material isotropic_lame(const char *name, double lambda, double G)
{
    return isotropic(name, G * (3 * lambda + 2 * G) / (lambda + G),
                     lambda / (2 * (lambda + G)));
}

static inline ph_material anisotropic(const char *name, uint64_t *seed)
{
    ph_error err = PH_ERROR_INIT;
    ph_material m;
    double voigt[36];
    ph_sym4 c = random_stiffness(seed, 6);
    ph_sym4_to_voigt(&c, true, voigt);
    CHECK_OK(ph_material_anisotropic(name, voigt, NULL, &m, &err));
    return m;
}

static inline ph_grid box_grid(ph_kinematics kin, ptrdiff_t n1, ptrdiff_t n2,
                               ptrdiff_t n3, double l1, double l2, double l3)
{
    ph_error err = PH_ERROR_INIT;
    ph_grid g;
    ptrdiff_t n[3] = {n1, n2, n3};
    double size[3] = {l1, l2, l3};
    CHECK_OK(ph_grid_init(&g, kin, n, size, &err));
    return g;
}

static inline ph_inclusion blank_inclusion(const char *shape, int material)
{
    ph_inclusion inc = {.material = material};
    snprintf(inc.shape, sizeof inc.shape, "%s", shape);
    double *all[] = {inc.centre, inc.semi_axes, inc.size, inc.axis};
    for (int i = 0; i < 4; i++)
        for (int a = 0; a < 3; a++)
            all[i][a] = NAN;
    inc.radius = inc.fraction = inc.angle = inc.length = inc.from = inc.to = NAN;
    return inc;
}

/* A disk (2D) or sphere. */
static inline ph_inclusion ball(ph_kinematics kin, int material, double x, double y,
                                double z, double radius)
{
    ph_inclusion inc = blank_inclusion(kin == PH_SPACE ? "sphere" : "disk", material);
    inc.centre[0] = x;
    inc.centre[1] = y;
    inc.centre[2] = z;
    inc.radius = radius;
    return inc;
}

/* material[0] everywhere, then the inclusions. */
static inline ph_microstructure *shapes_cell(ph_grid g, int nmaterials,
                                             ph_material *material, int ninclusions,
                                             ph_inclusion *inc)
{
    ph_error err = PH_ERROR_INIT;
    ph_microstructure *m = NULL;
    ph_case c = {.path = "test",
                 .nmaterials = nmaterials,
                 .materials = material,
                 .kinematics = g.kinematics,
                 .ninclusions = ninclusions,
                 .inclusions = inc};
    memcpy(c.nodes, g.n, sizeof c.nodes);
    memcpy(c.size, g.size, sizeof c.size);
    CHECK_OK(ph_rve_build(&c, &m, &err));
    return m;
}

/* One centred disk or sphere of this volume fraction in the unit cell of n nodes an axis. */
static inline ph_microstructure *round_cell(ph_kinematics kin, ptrdiff_t n,
                                            double fraction, ph_material matrix,
                                            ph_material inside)
{
    ph_material material[2] = {matrix, inside};
    ph_inclusion inc = ball(kin, 1, 0.5, 0.5, 0.5, NAN);
    inc.fraction = fraction;
    return shapes_cell(box_grid(kin, n, n, kin == PH_SPACE ? n : 1, 1, 1, 1), 2, material,
                       1, &inc);
}

/* Hexagonal array, 1 x sqrt(3), two disks. */
static inline ph_microstructure *hexagonal_cell(ph_kinematics kin, ptrdiff_t n,
                                                double fraction, ph_material matrix,
                                                ph_material inside)
{
    double w = sqrt(3.0), r = sqrt(fraction * w / (2 * 3.14159265358979323846));
    ph_material material[2] = {matrix, inside};
    ph_inclusion inc[2] = {ball(kin, 1, 0.5, 0.5 * w, 0, r), ball(kin, 1, 0, 0, 0, r)};
    return shapes_cell(box_grid(kin, n, lround((double)n * w), 1, 1, w, 1), 2, material,
                       2, inc);
}

/* Every cell a random one of the materials; no cuts. */
static inline ph_microstructure *voxel_cell(ph_grid g, int nmaterials,
                                            const ph_material *material, uint64_t *seed)
{
    ph_error err = PH_ERROR_INIT;
    ph_microstructure *m = NULL;
    CHECK_OK(ph_microstructure_new(&g, nmaterials, material, &m, &err));
    for (ptrdiff_t x = 0; m && x < ph_grid_cells(&g); x++)
        m->phase[x] = (uint16_t)(nmaterials * check_random(seed));
    return m;
}

/* The answer, or NULL with the reason printed. */
static inline ph_result *homogenise(const ph_problem *p)
{
    ph_error err = PH_ERROR_INIT;
    ph_result *res = NULL;
    CHECK_OK(ph_homogenise(p, &one_thread, &res, &err));
    return res;
}

/* Stiffness only; zero where it failed. */
static inline ph_sym4 stiffness_of(const ph_problem *p)
{
    ph_result *res = homogenise(p);
    ph_sym4 c =
        res ? res->stiffness : (ph_sym4){.n = ph_strains(p->micro->grid.kinematics)};
    ph_result_free(&res);
    return c;
}

static inline ph_engineering engineering(const ph_sym4 *c)
{
    ph_error err = PH_ERROR_INIT;
    ph_engineering e;
    memset(&e, 0, sizeof e);
    CHECK_OK(ph_engineering_constants(c, &e, &err));
    return e;
}

/* Entry of the Voigt matrix (stress over engineering strain), from 1. */
static inline double voigt(const ph_sym4 *c, int i, int j)
{
    double v[36];
    ph_sym4_to_voigt(c, true, v);
    return v[(i - 1) * c->n + j - 1];
}

static inline int most_iterations(const ph_result *res)
{
    int most = 0;
    for (int i = 0; res && i < res->nloads; i++)
        most = res->iterations[i] > most ? res->iterations[i] : most;
    return most;
}

/* Slope of log(error) over log(h), least squares. */
static inline double fitted_order(int n, const double *h, const double *error)
{
    double x = 0, y = 0, xx = 0, xy = 0;
    for (int i = 0; i < n; i++) {
        double a = log(h[i]), b = log(error[i]);
        x += a, y += b, xx += a * a, xy += a * b;
    }
    return (n * xy - x * y) / (n * xx - x * x);
}

#endif
