/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A run whose phases relax: what `auto` chooses, and the stabilisation, hold for all times. */
#include "effective/visco.h"

#include <math.h>

/* As in the stiffness map: near incompressibility the trace is bulk modulus. */
static const double most_of_least = 3.0;

static double softness_of(const ph_sym4 *c)
{
    double low, high, trace = 0.0;
    ph_sym4_eigenvalues(c, &low, &high);
    for (int i = 0; i < c->n; i++)
        trace += c->m[i][i] / c->n;
    return fmin(trace, most_of_least * low);
}

static bool is_fluid(const ph_material *m)
{
    if (!m->relaxation) return false;
    double low, high;
    ph_sym4 begin = ph_prony_instantaneous(m->relaxation);
    ph_i_visco_relative(&m->relaxation->equilibrium, &begin, &low, &high);
    return !(low > 1e-12);
}

ph_status ph_i_run_look_ahead(ph_run *r, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_microstructure *micro = r->problem->micro;
    bool composite = r->problem->interface == PH_INTERFACE_COMPOSITE;
    double longest = 0.0, least = INFINITY, most = 0.0;
    bool *used = NULL;
    PH_ALLOC(used, micro->nmaterials, "phase flags");
    for (ptrdiff_t x = 0; x < ph_grid_cells(&micro->grid); x++)
        used[micro->phase[x]] = true;
    for (ptrdiff_t i = 0; composite && i < micro->ncuts; i++) {
        used[micro->cuts[i].material] = true;
        if (micro->cuts[i].base >= 0) used[micro->cuts[i].base] = true;
    }
    for (int p = 0; p < micro->nmaterials; p++) {
        const ph_prony *series = micro->materials[p].relaxation;
        r->fluid = r->fluid || (used[p] && is_fluid(&micro->materials[p]));
        for (int t = 0; series && t < series->nterms; t++)
            longest = fmax(longest, series->term[t].time);
    }
    r->soft = -1;
    for (int p = 0; p < micro->nmaterials; p++) {
        const ph_material *m = &micro->materials[p];
        if (!used[p] || m->is_void) continue;
        double late = r->fluid ? 1e-6 / longest : 0.0, low, high;
        ph_sym4 c = m->relaxation ? ph_prony_carson(m->relaxation, late) : m->stiffness;
        ph_sym4_eigenvalues(&c, &low, &high);
        if (r->soft < 0 || softness_of(&c) < least) r->soft = p;
        least = fmin(least, softness_of(&c));
        most = fmax(most, low);
    }
    PH_CHECK(r->soft >= 0, PH_EUNPHYSICAL,
             "every phase of the microstructure is void: its stiffness is zero");
    r->contrast = most / fmax(least, 1e-300);
out:
    free(used);
    return st;
}

ph_status ph_i_run_build_relaxing(ph_run *r, ph_error *err)
{
    ph_status st = PH_OK;
    ph_sym4 c;
    const ph_microstructure *micro = r->problem->micro;
    PH_TRY(ph_sym4_reduce(&micro->materials[r->soft].stiffness, micro->grid.kinematics,
                          &c, err));
    r->softness = r->map->softest = softness_of(&c);
    PH_TRY(ph_i_run_build(r, err));
out:
    return st;
}

ph_status ph_i_run_relaxing(ph_run *r, ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(ph_i_run_begin(r, err));
    PH_CHECK(!r->constraint->analytic, PH_EINVAL,
             "constraint %s needs no equations, and no route that solves them",
             r->constraint->info.name);
    PH_TRY(ph_i_run_look_ahead(r, err));
    PH_TRY(ph_i_run_prepare(r, err));
    PH_TRY(ph_i_run_build_relaxing(r, err));
out:
    return st;
}
