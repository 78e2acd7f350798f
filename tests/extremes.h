/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A cell at the far ends of what may be asked for, and what became of it; include after
 * solve.h. */
#ifndef TESTS_EXTREMES_H
#define TESTS_EXTREMES_H

#include "solve.h"

/** One disk in a square cell, plane strain; contrast 0: a hole. */
typedef struct extreme {
    double contrast, nu_matrix, nu_disk;
    bool
        equal_shear; /* the disk has the shear modulus of the matrix, whatever `contrast` */
    double fraction;        /* 0: one node */
    ptrdiff_t nodes, block; /* block: nodes along an edge of that one node; 0: one */
    double horizon;         /* spacings, of nodes; 0: default points */
    double tolerance;
    int max_iterations;
} extreme;

/** SOLVED: an answer within the bounds, all checks passed. FLAGGED: an answer that says of
 *  itself that it is not good (not converged, stabilisation, energy balance). REFUSED: an
 *  error that says why. WRONG: anything else. */
typedef enum outcome { SOLVED, FLAGGED, REFUSED, WRONG } outcome;

typedef struct answer {
    outcome outcome;
    int iterations;
    ph_sym4 stiffness;
    double bulk,
        exact_bulk; /* plane; exact: of equal shear moduli [Hill1964], else NaN */
    char message[256];
} answer;

static inline ph_material extreme_disk(const extreme *x)
{
    double shear = 1.0 / (2 * (1 + x->nu_matrix));
    if (x->equal_shear)
        return isotropic("disk", 2 * shear * (1 + x->nu_disk), x->nu_disk);
    return x->contrast > 0 ? isotropic("disk", x->contrast, x->nu_disk)
                           : ph_material_void("hole");
}

static inline ph_microstructure *extreme_cell(const extreme *x)
{
    ph_material matrix = isotropic("matrix", 1, x->nu_matrix), disk = extreme_disk(x);
    if (x->fraction > 0)
        return round_cell(PH_PLANE_STRAIN, x->nodes, x->fraction, matrix, disk);
    uint64_t seed = 1;
    ph_grid g = box_grid(PH_PLANE_STRAIN, x->nodes, x->nodes, 1, 1, 1, 1);
    ph_microstructure *m = voxel_cell(g, 2, (ph_material[2]){matrix, disk}, &seed);
    ptrdiff_t b = x->block > 0 ? x->block : 1, middle = x->nodes / b / 2;
    for (ptrdiff_t i = 0; m && i < x->nodes * x->nodes; i++)
        m->phase[i] = i / x->nodes / b == middle && i % x->nodes / b == middle;
    return m;
}

/* Plane bulk modulus of two phases of shear modulus G, whatever the geometry: 1/(K* + G) is
 * the mean of 1/(K + G), plane strain, K = lambda + G. */
static inline double equal_shear_bulk(const ph_microstructure *m, const double *fraction)
{
    double sum = 0, G = 0;
    for (int i = 0; i < 2; i++) {
        ph_sym4 c;
        if (ph_sym4_reduce(&m->materials[i].stiffness, PH_PLANE_STRAIN, &c, NULL) !=
            PH_OK)
            return (double)NAN;
        G = c.m[2][2] / 2;
        sum += fraction[i] / ((c.m[0][0] + c.m[0][1]) / 2 + G);
    }
    return 1 / sum - G;
}

/* Energies of random strains between those of the bounds, to 1e-6 of the upper one. */
static inline bool within_bounds(const ph_result *r)
{
    uint64_t seed = 7;
    for (int trial = 0; trial < 20; trial++) {
        double e[6], low = 0, high = 0, here = 0;
        for (int i = 0; i < r->stiffness.n; i++)
            e[i] = check_uniform(&seed, -1, 1);
        for (int i = 0; i < r->stiffness.n; i++)
            for (int j = 0; j < r->stiffness.n; j++) {
                low += r->reuss_is_zero ? 0 : e[i] * r->reuss.m[i][j] * e[j];
                high += e[i] * r->voigt.m[i][j] * e[j];
                here += e[i] * r->stiffness.m[i][j] * e[j];
            }
        if (!(here >= low - 1e-6 * high && here <= high * (1 + 1e-6))) return false;
    }
    return true;
}

static inline answer ask(const extreme *x)
{
    ph_error err = PH_ERROR_INIT;
    ph_result *r = NULL;
    answer a = {.outcome = REFUSED, .bulk = NAN, .exact_bulk = NAN};
    ph_microstructure *m = extreme_cell(x);
    ph_problem p = {
        .micro = m,
        .solver = {.tolerance = x->tolerance, .max_iterations = x->max_iterations}};
    if (x->horizon > 0)
        p.model = (ph_model_params){.points = PH_POINTS_NODES, .horizon = x->horizon};
    ph_status st = m ? ph_homogenise(&p, &one_thread, &r, &err) : PH_EINVAL;
    snprintf(a.message, sizeof a.message, "%s", err.msg);
    if (st == PH_OK && r) {
        bool doubtful = r->stabilisation_energy > 0.01 || r->hill_mandel > 1e-3;
        a.outcome = !within_bounds(r) ? WRONG : doubtful ? FLAGGED : SOLVED;
        a.iterations = most_iterations(r);
        a.stiffness = r->stiffness;
        a.bulk = (r->stiffness.m[0][0] + r->stiffness.m[0][1]) / 2;
        if (x->equal_shear) a.exact_bulk = equal_shear_bulk(m, r->fractions);
    } else if (st == PH_ENOCONV) {
        a.outcome = FLAGGED;
    } else if (!err.msg[0] ||
               (st != PH_EINVAL && st != PH_EUNPHYSICAL && st != PH_ESINGULAR)) {
        a.outcome = WRONG;
    }
    ph_result_free(&r);
    ph_microstructure_free(&m);
    return a;
}

#endif
