/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The cracks of a case: those that it names, those that it draws, and their steps. */
#include <perihom_rve.h>

#include "core/check.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;
enum { MOST_CRACKS = 1000000 };

/* Random numbers of cracks stand apart from those of fillers, whose kinds are below 2^15. */
#define OBJECT_CRACK(entry) ((UINT64_C(1) << 60) | (uint64_t)(entry) << 40)

void ph_crack_plan_free(ph_crack_plan **plan)
{
    if (!plan || !*plan) return;
    ph_cracks_free(&(*plan)->cracks);
    free((*plan)->grows);
    free((*plan)->start);
    free(*plan);
    *plan = NULL;
}

/* A direction of the sphere, or the normal that is given. */
static void draw_normal(const ph_crack_entry *k, ph_random *r, double normal[3])
{
    if (k->aligned) {
        memcpy(normal, k->normal, 3 * sizeof *normal);
        return;
    }
    double z = 2.0 * ph_random_uniform(r) - 1.0, phi = 2.0 * pi * ph_random_uniform(r);
    normal[0] = sqrt(1.0 - z * z) * cos(phi);
    normal[1] = sqrt(1.0 - z * z) * sin(phi);
    normal[2] = z;
}

/* One crack of a population: centre, direction and length are its own random numbers. */
static ph_status draw_crack(const ph_case *c, ptrdiff_t entry, ptrdiff_t number,
                            ph_cracks *to, ph_error *err)
{
    const ph_crack_entry *k = &c->cracks[entry];
    ph_random r = {c->seed, c->realisation, OBJECT_CRACK(entry) | (uint64_t)number, 0};
    double centre[3] = {0};
    int axes = c->kinematics == PH_SPACE ? 3 : 2;
    for (int d = 0; d < axes; d++)
        centre[d] = c->size[d] * ph_random_uniform(&r);
    double half = 0.5 * ph_distribution_quantile(&k->length, ph_random_uniform(&r));
    if (axes == 3) {
        double normal[3];
        draw_normal(k, &r, normal);
        return ph_cracks_add_ellipse(to, centre, normal, NULL, (double[]){half, half},
                                     err);
    }
    double angle = k->aligned ? k->angle * pi / 180.0 : pi * ph_random_uniform(&r);
    double v[2][3] = {{0}};
    for (int end = 0; end < 2; end++) {
        double s = end ? half : -half;
        v[end][0] = centre[0] + s * cos(angle);
        v[end][1] = centre[1] + s * sin(angle);
    }
    return ph_cracks_add_line(to, 2, (const double(*)[3])v, err);
}

static double share(const ph_grid *g, const ph_cracks *cracks, ptrdiff_t which)
{
    ph_cracks one = *cracks;
    one.crack += which;
    one.count = 1;
    return ph_cracks_density(&one, g);
}

/* Add cracks until their number, or their density, is reached: one is added while the
 * density with half of it does not exceed the target. */
static ph_status draw_population(const ph_case *c, ptrdiff_t entry, double target,
                                 const ph_grid *g, ph_cracks *to, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_crack_entry *k = &c->cracks[entry];
    double density = 0.0;
    bool counted = k->count >= 0 && isnan(target);
    if (isnan(target)) target = k->density;
    for (ptrdiff_t i = 0; !counted || i < k->count; i++) {
        PH_CHECK(i < MOST_CRACKS, PH_EUNPHYSICAL,
                 "line %d: more than %d cracks for a density of %g", k->line, MOST_CRACKS,
                 target);
        PH_TRY(draw_crack(c, entry, i, to, err));
        double one = share(g, to, to->count - 1);
        PH_CHECK(counted || i > 0 || target <= 0.0 || 0.5 * one <= target, PH_EUNPHYSICAL,
                 "line %d: cracks.%td.random.length: no crack is placed: one of length "
                 "%.6g has density %.4g, more than twice the %.4g that is asked for: a "
                 "shorter length, a larger density or a larger cell",
                 k->line, entry, ph_crack_length(to, to->count - 1), one, target);
        if (!counted && density + 0.5 * one > target) {
            to->count--;
            to->nvertices = to->crack[to->count].first;
            break;
        }
        density += one;
    }
out:
    return st;
}

static ph_status add_entry(const ph_case *c, ptrdiff_t entry, const ph_grid *g,
                           ph_cracks *to, ph_error *err)
{
    const ph_crack_entry *k = &c->cracks[entry];
    const ph_sequence_entry *q = &c->sequence;
    const double(*v)[3] = (const double(*)[3])k->point;
    double target = NAN;
    switch (k->kind) {
    case PH_CRACKS_LINE:
        return ph_cracks_add_line(to, k->npoints, v, err);
    case PH_CRACKS_POLYGON:
        return ph_cracks_add_polygon(to, k->npoints, v, err);
    case PH_CRACKS_ELLIPSE:
        return ph_cracks_add_ellipse(to, k->centre, k->normal,
                                     isnan(k->axis[0]) ? NULL : k->axis, k->semi_axes,
                                     err);
    case PH_CRACKS_RANDOM:
        break;
    }
    /* With a rising density the last step says how many there are. */
    if (q->kind == PH_SEQUENCE_DENSITY)
        target = q->value[q->nsteps - 1] - ph_cracks_density(to, g);
    return draw_population(c, entry, target, g, to, err);
}

static ph_status plan_growth(const ph_case *c, ph_crack_plan *p, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_sequence_entry *q = &c->sequence;
    PH_ALLOC(p->grows, p->cracks.count, "the cracks that grow");
    for (ptrdiff_t i = 0; i < p->cracks.count; i++)
        p->grows[i] = q->nwhich == 0;
    for (ptrdiff_t i = 0; i < q->nwhich; i++)
        p->grows[p->start[q->which[i]]] = true;
    p->sequence.grows = p->grows;
    p->sequence.tip = q->tip;
out:
    return st;
}

ph_status ph_rve_cracks(const ph_case *c, ph_crack_plan **out, ph_error *err)
{
    PH_GIVEN(c && out);
    ph_status st = PH_OK;
    ph_crack_plan *p = NULL;
    ph_grid g = {.kinematics = c->kinematics};
    *out = NULL;
    memcpy(g.size, c->size, sizeof g.size);
    PH_ALLOC(p, 1, "cracks");
    PH_ALLOC(p->start, c->ncracks, "cracks");
    for (ptrdiff_t i = 0; i < c->ncracks; i++) {
        p->start[i] = p->cracks.count;
        PH_TRY(add_entry(c, i, &g, &p->cracks, err));
    }
    p->sequence = (ph_crack_sequence){.kind = c->sequence.kind,
                                      .nsteps = c->sequence.nsteps,
                                      .value = c->sequence.value};
    if (c->sequence.kind == PH_SEQUENCE_GROWTH) PH_TRY(plan_growth(c, p, err));
    if (c->sequence.kind == PH_SEQUENCE_DENSITY)
        p->sequence.first = p->start[c->ncracks - 1];
    *out = p;
    p = NULL;
out:
    ph_crack_plan_free(&p);
    return st;
}
