/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/models.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

const ph_model_method ph_models[] = {
    {{"nosb", "non-ordinary state-based peridynamics, correspondence model",
      "Silling2007", "always"},
     true,
     false},
    {{"bond", "bond-based peridynamics, linearised: springs between nodes",
      "Silling2000 Ongaro2022", "nu = 1/3 in plane stress, 1/4 in plane strain and 3D"},
     true,
     true},
    {{"local", "Q1 finite elements on the same grid: the local limit", "Leuschner2018",
      "always"},
     false,
     false},
};
const size_t ph_nmodels = sizeof ph_models / sizeof *ph_models;

const ph_model_method *ph_i_model_find(const char *name)
{
    for (size_t i = 0; i < ph_nmodels; i++)
        if (strcmp(name ? name : "nosb", ph_models[i].info.name) == 0)
            return &ph_models[i];
    return NULL;
}

bool ph_i_has_cracks(const ph_problem *p)
{
    return p->loading || (p->cracks && p->cracks->count > 0);
}

void ph_i_note(ph_result *result, const char *fmt, ...)
{
    if (!result || result->nnotes >= PH_MAX_NOTES) return;
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(result->notes[result->nnotes++], sizeof result->notes[0], fmt, ap);
    va_end(ap);
}

/* Above this contrast the families of nodes need too many iterations. Measured: see the
 * page on stabilisation in the manual. */
static const double high_contrast = 300.0;
static const double default_alpha = 1e-5, default_theta = 0.01, default_spacings = 2.0,
                    bond_spacings = 3.0;
/* Around voids a little more is more accurate; where nodes are held the preconditioner must
 * not reach far above the operator, or the mask mixes what it separates. */
static const double void_theta = 0.05, bounded_alpha = 1e-4;
/* Families that a crack cuts on one side see the modes that whole families do not, and the
 * preconditioner must not lie far below them: docs/theory/cracks.md has what was measured. */
static const double crack_alpha = 0.1;
/* Fewer nodes than this along an axis, and a family of two spacings meets its images. */
enum { FEW_NODES = 5 };

static double widest(const ph_grid *g)
{
    double h = 0.0;
    for (int d = 0; d < 3; d++)
        if (g->n[d] > 1) h = fmax(h, g->h[d]);
    return h > 0.0 ? h : g->h[0];
}

static double half_diagonal(const ph_grid *g)
{
    double s = 0.0;
    for (int d = 0; d < 3; d++)
        if (g->n[d] > 1) s += g->h[d] * g->h[d];
    return 0.5 * sqrt(s);
}

static bool few_nodes(const ph_grid *g)
{
    for (int d = 0; d < 3; d++)
        if (g->n[d] > 1 && g->n[d] < FEW_NODES) return true;
    return false;
}

static ph_points choose_points(const ph_problem *p, const ph_stiffness_map *map,
                               bool bounded, ph_result *notes)
{
    if (p->model.points != PH_POINTS_AUTO) return p->model.points;
    const char *why = NULL;
    if (ph_i_has_cracks(p)) {
        ph_i_note(notes, "points: nodes (cracks cut bonds between nodes)");
        return PH_POINTS_NODES;
    }
    if (bounded)
        why = "their smallest family is exact at the faces of the RVE";
    else if (map->has_void)
        why = "a void phase: families of nodes reach across its surface";
    else if (map->least_contrast > high_contrast)
        why = "high contrast: families of nodes would need many iterations";
    else if (few_nodes(&p->micro->grid))
        why = "few nodes along an axis";
    else if (p->model.horizon > 0.0)
        return PH_POINTS_NODES;
    else
        why = "no length scale is given, and their smallest family costs least";
    ph_i_note(notes, "points: stress (%s)", why);
    return PH_POINTS_STRESS;
}

static void choose_stabilisation(const ph_problem *p, const ph_stiffness_map *map,
                                 ph_points points, bool bounded, ph_operator_params *out,
                                 ph_result *notes)
{
    bool hard = map->has_void || map->least_contrast > high_contrast || bounded;
    out->stabilisation = p->model.stabilisation;
    out->value = p->model.stabilisation_value;
    bool automatic = out->stabilisation == PH_STABILISE_AUTO;
    if (automatic)
        out->stabilisation = hard && points == PH_POINTS_STRESS ? PH_STABILISE_SUBPOINT
                                                                : PH_STABILISE_SPECTRAL;
    if (automatic && ph_i_has_cracks(p)) out->stabilisation = PH_STABILISE_SPECTRAL;
    if (out->value == 0.0 && out->stabilisation == PH_STABILISE_SPECTRAL)
        out->value = ph_i_has_cracks(p) ? crack_alpha
                     : bounded          ? bounded_alpha
                                        : default_alpha;
    if (out->value == 0.0 && out->stabilisation == PH_STABILISE_SUBPOINT)
        out->value = map->has_void ? void_theta : default_theta;
    if (automatic)
        ph_i_note(notes, "stabilisation: %s %g (contrast %.3g%s)",
                  out->stabilisation == PH_STABILISE_SUBPOINT ? "subpoint" : "spectral",
                  out->value, map->contrast, map->has_void ? ", voids" : "");
}

static double choose_horizon(const ph_problem *p, ph_points points)
{
    const ph_grid *g = &p->micro->grid;
    if (p->model.horizon > 0.0)
        return p->model.horizon_is_length ? p->model.horizon
                                          : p->model.horizon * widest(g);
    double least =
        half_diagonal(g); /* zero: a single cell has no family, any length will do */
    return points == PH_POINTS_STRESS && least > 0.0 ? least
                                                     : default_spacings * widest(g);
}

static const void *by_name(const ph_entry *first, size_t stride, size_t count,
                           const char *name)
{
    for (size_t i = 0; i < count; i++) {
        const ph_entry *e = (const ph_entry *)((const char *)first + i * stride);
        if (strcmp(e->name, name) == 0) return e;
    }
    return NULL;
}

static bool is_smallest(const ph_family *f)
{
    ptrdiff_t corners = 1;
    for (int d = 0; d < 3; d++)
        if (f->active[d]) corners *= 2;
    if (corners == 1) return true; /* one cell: no bonds at all */
    return f->points == PH_POINTS_STRESS && f->count == corners;
}

/* Everything of model bond; its bonds reach to images too. */
static ph_status choose_bonds(const ph_problem *p, ph_operator_params *out,
                              ph_family **family, ph_result *notes, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_model_params *m = &p->model;
    const ph_grid *g = &p->micro->grid;
    ph_bond_report *report = &notes->bond;
    const char *profile = m->micromodulus ? m->micromodulus : ph_micromoduli[0].info.name;
    const char *weights = m->weights ? m->weights : "exact";
    const ph_micromodulus *c = by_name(&ph_micromoduli[0].info, sizeof *ph_micromoduli,
                                       ph_nmicromoduli, profile);
    const ph_volume_weight *be =
        by_name(&ph_volume_weights[0].info, sizeof *ph_volume_weights, ph_nvolume_weights,
                weights);
    PH_CHECK_KEY(c, PH_EINVAL, "model.micromodulus", "unknown micromodulus '%s'",
                 profile);
    PH_CHECK_KEY(be, PH_EINVAL, "model.weights", "unknown volume weight '%s'", weights);
    PH_CHECK_KEY((size_t)m->calibration < ph_ncalibrations, PH_EINVAL,
                 "model.calibration", "unknown calibration %d", (int)m->calibration);
    PH_CHECK_KEY(m->points != PH_POINTS_STRESS, PH_EINVAL, "model.points",
                 "model bond has no stress points: its forces act between nodes");
    PH_CHECK_KEY(m->stabilisation == PH_STABILISE_AUTO ||
                     m->stabilisation == PH_STABILISE_NONE,
                 PH_EINVAL, "model.stabilisation",
                 "model bond needs no stabilisation: bonds see every displacement");
    PH_CHECK_KEY(!m->influence || strcmp(m->influence, "constant") == 0, PH_EINVAL,
                 "model.influence",
                 "influence '%s' belongs to nosb; model bond has a micromodulus",
                 m->influence);
    double horizon =
        m->horizon > 0.0 ? choose_horizon(p, PH_POINTS_NODES) : bond_spacings * widest(g);
    PH_TRY(ph_bond_family_new(g, horizon, c, m->power, be, m->calibration, family,
                              &report->lattice, err));
    out->family = *family;
    report->present = true;
    report->micromodulus = c->info.name;
    report->calibration = ph_calibrations[m->calibration].info.name;
    report->power = c == &ph_micromoduli[3] ? m->power : (double)NAN;
    report->kappa = m->kappa > 0.0 ? m->kappa : (double)NAN;
    if (m->kappa > 0.0)
        ph_i_note(notes,
                  "kappa %g is the interphase of this horizon (%g) and spacing; the "
                  "bounds of Voigt and Reuss know nothing of it",
                  m->kappa, (*family)->horizon);
    ph_i_note(notes, "bonds: the lattice has nu = %.6g, Zener ratio %.6g",
              report->lattice.nu, report->lattice.zener);
out:
    return st;
}

ph_status ph_i_model_choose(const ph_problem *p, const ph_stiffness_map *map,
                            bool bounded, ph_operator_params *out, ph_family **family,
                            ph_result *notes, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_model_method *model = ph_i_model_find(p->model.kind);
    *family = NULL;
    memset(out, 0, sizeof *out);
    out->stabilisation = PH_STABILISE_NONE;
    PH_CHECK_KEY(model, PH_EINVAL, "model.kind", "unknown model '%s'", p->model.kind);
    PH_CHECK_KEY(!ph_i_has_cracks(p) ||
                     (model->has_family && p->model.points != PH_POINTS_STRESS &&
                      p->model.stabilisation != PH_STABILISE_SUBPOINT),
                 PH_EINVAL, "model",
                 "cracks cut bonds between nodes: take model nosb with points nodes and "
                 "without sub-points, or model bond");
    if (!model->has_family) return PH_OK;
    if (model->pairwise) return choose_bonds(p, out, family, notes, err);
    const char *influence = p->model.influence ? p->model.influence : "constant";
    const char *weights = p->model.weights ? p->model.weights : "linear";
    const ph_influence *om =
        by_name(&ph_influences[0].info, sizeof *ph_influences, ph_ninfluences, influence);
    const ph_volume_weight *be =
        by_name(&ph_volume_weights[0].info, sizeof *ph_volume_weights, ph_nvolume_weights,
                weights);
    PH_CHECK_KEY(om, PH_EINVAL, "model.influence", "unknown influence function '%s'",
                 influence);
    PH_CHECK_KEY(be, PH_EINVAL, "model.weights", "unknown volume weight '%s'", weights);
    ph_points points = choose_points(p, map, bounded, notes);
    PH_TRY(ph_family_new(&p->micro->grid, points, choose_horizon(p, points), om, be,
                         family, err));
    out->family = *family;
    out->smallest = is_smallest(*family);
    choose_stabilisation(p, map, points, bounded, out, notes);
out:
    if (st != PH_OK) ph_family_free(family);
    return st;
}
