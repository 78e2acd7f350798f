/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effective/failure.h"

#include <math.h>
#include <string.h>

static const ph_volume_weight *weight_of(const ph_run *r)
{
    const char *name = r->problem->model.weights;
    if (!name) name = r->classes ? "exact" : "linear";
    for (size_t i = 0; i < ph_nvolume_weights; i++)
        if (strcmp(ph_volume_weights[i].info.name, name) == 0)
            return &ph_volume_weights[i];
    return &ph_volume_weights[0];
}

static double volume_of(const ph_grid *g)
{
    return g->h[0] * g->h[1] * (g->kinematics == PH_SPACE ? g->h[2] : 1.0);
}

static double length_of(const double xi[3])
{
    return sqrt(xi[0] * xi[0] + xi[1] * xi[1] + xi[2] * xi[2]);
}

static double share_of(const ph_run *r, const ph_grid *g, const double xi[3])
{
    const bool active[3] = {true, true, g->kinematics == PH_SPACE};
    return weight_of(r)->eval(xi, g->h, active, r->family->horizon);
}

/* Of a lattice that one bond holds together, with the nearest neighbours alone. */
static const double most_of_rigidity = 0.5;

/* ---- what crosses a plane ---------------------------------------------------------------- */

/* sum over b of k_b (1 - cos k.o_b) xi_b xi_b, the symbol of springs, inverted
 * on the active axes; false at k = 0. */
static bool inverse_symbol(const ph_family *f, const double k[3], ph_sym4 *inverse)
{
    ph_sym4 P = {.n = 3};
    ph_error ignored = PH_ERROR_INIT;
    double trace = 0.0;
    for (ptrdiff_t b = 0; b < f->count; b++) {
        double c = 1.0 - cos(k[0] * f->offset[b][0] + k[1] * f->offset[b][1] +
                             k[2] * f->offset[b][2]);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                P.m[i][j] += c * f->w[b] * f->xi[b][i] * f->xi[b][j];
    }
    for (int i = 0; i < 3; i++)
        trace += P.m[i][i];
    for (int i = 0; i < 3; i++)
        if (!f->active[i]) P.m[i][i] = trace;
    return trace > 0.0 && ph_sym4_inverse(&P, inverse, &ignored) == PH_OK;
}

/* rho_b = k_b c_b . A^-1 c_b of every bond of an endless lattice, c_b its elongation: the
 * mean over wave vectors of k_b 2 (1 - cos k.o_b) xi_b . P^-1 xi_b. */
static void shares_of_rigidity(const ph_family *f, int dims, double *rho)
{
    enum { WAVES = 12 };
    static const double pi = 3.14159265358979323846;
    int points = dims == 3 ? WAVES * WAVES * WAVES : WAVES * WAVES;
    for (int at = 0; at < points; at++) {
        double k[3];
        ph_sym4 inverse;
        for (int d = 0, rest = at; d < 3; d++, rest /= WAVES)
            k[d] = 2.0 * pi * (rest % WAVES) / WAVES;
        if (!inverse_symbol(f, k, &inverse)) continue;
        for (ptrdiff_t b = 0; b < f->count; b++) {
            double c = 1.0 - cos(k[0] * f->offset[b][0] + k[1] * f->offset[b][1] +
                                 k[2] * f->offset[b][2]);
            double sum = 0.0;
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 3; j++)
                    sum += f->xi[b][i] * inverse.m[i][j] * f->xi[b][j];
            rho[b] += 2.0 * c * f->w[b] * sum / points;
        }
    }
}

static ph_status crossing_of(const ph_run *r, const ph_grid *g, const ph_family *f,
                             bool springs, ph_crossing *sum, ph_error *err)
{
    ph_status st = PH_OK;
    int dims = g->kinematics == PH_SPACE ? 3 : 2;
    double *rho = NULL;
    *sum = (ph_crossing){0};
    PH_ALLOC(rho, f->count, "shares of rigidity");
    if (springs) shares_of_rigidity(f, dims, rho);
    for (ptrdiff_t b = 0; b < f->count; b++) {
        double l = length_of(f->xi[b]), mean = 0.0;
        for (int d = 0; d < dims; d++)
            mean += fabs(f->xi[b][d]) / dims;
        mean /= 1.0 - fmin(rho[b], most_of_rigidity);
        sum->stretch += mean * f->w[b] * l * l * l * l;
        sum->count += mean * share_of(r, g, f->xi[b]) * volume_of(g);
    }
out:
    free(rho);
    return st;
}

/* The springs that stand for a medium with states: their horizon, their modulus. What a bond
 * of states releases beyond what its spring would hold is not known. */
static ph_status crossing_of_states(const ph_run *r, ph_crossing *out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_family *springs = NULL;
    ph_grid g = r->setting.box;
    if (g.kinematics == PH_GENERALISED_STRAIN) g.kinematics = PH_PLANE_STRAIN;
    PH_TRY(ph_bond_family_new(&g, r->family->horizon, &ph_micromoduli[0], 0.0,
                              weight_of(r), PH_CALIBRATE_LATTICE, &springs, NULL, err));
    PH_TRY(crossing_of(r, &g, springs, false, out, err));
out:
    ph_family_free(&springs);
    return st;
}

/* ---- classes ----------------------------------------------------------------------------- */

/* Modulus of a bond between two classes; of states the mean of two springs in series. */
static double modulus(const ph_run *r, int i, int j, bool apart)
{
    const ph_bond_classes *c = r->classes;
    const ph_microstructure *m = r->problem->micro;
    if (c) return (apart ? c->apart : c->pair)[(ptrdiff_t)i * c->count + j];
    if (i / 2 >= m->nmaterials || j / 2 >= m->nmaterials) return 0.0;
    const ph_material *a = &m->materials[i / 2], *b = &m->materials[j / 2];
    if (a->is_void || b->is_void) return 0.0;
    if (!a->is_isotropic || !b->is_isotropic) return NAN;
    return 2.0 * a->E * b->E / (a->E + b->E);
}

static ph_status classes_of_nodes(const ph_run *r, ph_strengths *s, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_microstructure *m = r->problem->micro;
    ptrdiff_t cells = ph_grid_cells(&r->setting.box);
    s->source = r->setting.source;
    s->classes = 2 * (m->nmaterials + 1);
    if (r->classes) {
        s->class = r->classes->class;
        s->owner = r->classes->owner;
        return PH_OK;
    }
    PH_ALLOC(s->own, 2 * cells, "classes of bonds");
    for (ptrdiff_t x = 0; x < cells; x++) {
        ptrdiff_t from = s->source ? s->source[x] : x;
        if (from < 0) continue; /* around the RVE: nothing breaks */
        s->own[cells + x] = m->owner ? m->owner[from] : 0;
        s->own[x] = 2 * m->phase[from] + (s->own[cells + x] > 0);
    }
    s->class = s->own;
    s->owner = s->own + cells;
out:
    return st;
}

/* ---- rules ------------------------------------------------------------------------------- */

static const ph_bond_facts unit_bond = {1.0, 1.0, 1.0, 1.0};
static const ph_failure_rule unbreakable = {.given = true, .criterion = PH_UNBREAKABLE};

static ph_status check_rule(const ph_run *r, const ph_failure_rule *k, const char *what,
                            ph_error *err)
{
    ph_status st = PH_OK;
    if (!k->given) return PH_OK;
    PH_CHECK(k->criterion >= 0 && (size_t)k->criterion < ph_nfailure_criteria, PH_EINVAL,
             "failure of %s: unknown criterion %d", what, k->criterion);
    const ph_failure_criterion *c = &ph_failure_criteria[k->criterion];
    PH_CHECK(r->classes || !c->springs, PH_EINVAL,
             "failure of %s: %s is the energy of a spring: take critical_stretch, or "
             "model bond",
             what, c->info.name);
    PH_CHECK(k->weibull == 0.0 || (k->weibull >= 1.0 && isfinite(k->weibull)), PH_EINVAL,
             "failure of %s: the Weibull shape must be >= 1, got %g", what, k->weibull);
    if (k->criterion == PH_UNBREAKABLE) return PH_OK;
    double x = isnan(k->value) ? k->fracture_energy : k->value;
    PH_CHECK(isfinite(x) && x > 0.0, PH_EINVAL,
             "failure of %s: its %s must be > 0, got %g", what,
             isnan(k->value) ? "fracture energy" : c->info.name, x);
out:
    return st;
}

/* Critical stretch of a bond of mean length under a rule: which is the weaker. */
static double typical(const ph_run *r, const ph_strengths *s, const ph_failure_rule *k,
                      double E)
{
    const ph_failure_criterion *c = &ph_failure_criteria[k->criterion];
    if (k->criterion == PH_UNBREAKABLE) return INFINITY;
    double value =
        isnan(k->value) ? c->from_energy(k->fracture_energy, E, &s->crossing) : k->value;
    ph_bond_facts bond = {r->family->w[0], length_of(r->family->xi[0]), 1.0,
                          volume_of(&r->setting.box)};
    return c->stretch(value, E, &bond);
}

static const ph_failure_rule *of_material(const ph_run *r, const ph_failure *f, int m)
{
    bool known = m >= 0 && m < r->problem->micro->nmaterials && f->material[m].given;
    return known ? &f->material[m] : &unbreakable;
}

static const ph_failure_rule *rule_of(const ph_run *r, const ph_strengths *s,
                                      const ph_failure *f, int i, int j, bool apart,
                                      double E)
{
    const ph_failure_rule *a = of_material(r, f, i / 2), *b = of_material(r, f, j / 2);
    if (apart && f->agglomeration.given) return &f->agglomeration;
    if (!apart && i / 2 == j / 2) return a;
    if (f->interphase.given) return &f->interphase;
    if (apart && r->classes) a = of_material(r, f, r->classes->matrix);
    return typical(r, s, a, E) <= typical(r, s, b, E) ? a : b;
}

static ph_status fill_pair(const ph_run *r, const ph_failure *f, int i, int j, bool apart,
                           ph_strengths *s, ph_error *err)
{
    ph_status st = PH_OK;
    ptrdiff_t at = (ptrdiff_t)i * s->classes + j;
    double E = modulus(r, i, j, apart), value;
    s->amplitude[apart][at] = INFINITY;
    if (E == 0.0) return PH_OK;
    const ph_failure_rule *k = rule_of(r, s, f, i, j, apart, E);
    if (k->criterion == PH_UNBREAKABLE) return PH_OK;
    const ph_failure_criterion *c = &ph_failure_criteria[k->criterion];
    PH_CHECK(isfinite(E) || !isnan(k->value), PH_EINVAL,
             "a fracture energy needs the modulus of an isotropic material: give "
             "critical_stretch for '%s'",
             r->problem->micro->materials[i / 2].name);
    value =
        isnan(k->value) ? c->from_energy(k->fracture_energy, E, &s->crossing) : k->value;
    /* stretch() is the product of a number for the classes and one for the bond */
    s->amplitude[apart][at] = c->stretch(value, E, &unit_bond);
    s->criterion[apart][at] = (uint8_t)k->criterion;
    s->shape[apart][at] = k->weibull;
    s->scatters = s->scatters || k->weibull > 0.0;
out:
    return st;
}

static ph_status fill_forms(const ph_run *r, ph_strengths *s, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_family *f = r->family;
    for (int c = 0; c < PH_STRENGTH_FORMS; c++) {
        PH_ALLOC(s->form[c], f->count, "strengths by bond");
        for (ptrdiff_t b = 0; b < f->count; b++) {
            ph_bond_facts bond = {f->w[b], length_of(f->xi[b]),
                                  share_of(r, &r->setting.box, f->xi[b]),
                                  volume_of(&r->setting.box)};
            s->form[c][b] = ph_failure_criteria[c].stretch(1.0, 1.0, &bond) /
                            ph_failure_criteria[c].stretch(1.0, 1.0, &unit_bond);
        }
    }
out:
    return st;
}

ph_status ph_i_strengths_new(const ph_run *r, const ph_failure *f, ph_strengths **out,
                             ph_error *err)
{
    ph_status st = PH_OK;
    ph_strengths *s = NULL;
    const ph_microstructure *m = r->problem->micro;
    PH_ALLOC(s, 1, "strengths");
    s->broken = r->broken;
    s->seed = f->seed;
    s->realisation = f->realisation;
    for (int i = 0; i < m->nmaterials; i++)
        PH_TRY(check_rule(r, &f->material[i], m->materials[i].name, err));
    PH_TRY(check_rule(r, &f->interphase, "the interphase", err));
    PH_TRY(check_rule(r, &f->agglomeration, "agglomerations", err));
    PH_TRY(classes_of_nodes(r, s, err));
    if (r->classes)
        PH_TRY(crossing_of(r, &r->setting.box, r->family, true, &s->crossing, err));
    else
        PH_TRY(crossing_of_states(r, &s->crossing, err));
    for (int apart = 0; apart < 2; apart++) {
        PH_ALLOC(s->amplitude[apart], s->classes * s->classes, "strengths");
        PH_ALLOC(s->criterion[apart], s->classes * s->classes, "strengths");
        PH_ALLOC(s->shape[apart], s->classes * s->classes, "strengths");
        for (int i = 0; i < s->classes; i++)
            for (int j = 0; j < s->classes; j++)
                PH_TRY(fill_pair(r, f, i, j, apart, s, err));
    }
    PH_TRY(fill_forms(r, s, err));
    *out = s;
    s = NULL;
out:
    ph_i_strengths_free(&s);
    return st;
}

void ph_i_strengths_free(ph_strengths **out)
{
    if (!out || !*out) return;
    ph_strengths *s = *out;
    for (int i = 0; i < 2; i++) {
        free(s->amplitude[i]);
        free(s->criterion[i]);
        free(s->shape[i]);
    }
    for (int i = 0; i < PH_STRENGTH_FORMS; i++)
        free(s->form[i]);
    free(s->own);
    free(s);
    *out = NULL;
}

/* Strengths stand apart from fillers and cracks in the numbers of a realisation. */
#define OBJECT_BOND (UINT64_C(1) << 61)

/* (-ln(1 - U))^(1/m) over the root of its mean square, Gamma(1 + 2/m). */
static double scatter(const ph_strengths *s, double m, ptrdiff_t x, ptrdiff_t b)
{
    if (s->source) x = s->source[x] < 0 ? 0 : s->source[x];
    uint64_t number = (uint64_t)x * (uint64_t)s->broken->family->count + (uint64_t)b;
    ph_random random = {s->seed, s->realisation, OBJECT_BOND | number, 0};
    return pow(-log(ph_random_uniform(&random)), 1.0 / m) / sqrt(tgamma(1.0 + 2.0 / m));
}

double ph_i_strength(const ph_strengths *s, ptrdiff_t x, ptrdiff_t b, ptrdiff_t y)
{
    ptrdiff_t at = (ptrdiff_t)s->class[x] * s->classes + s->class[y];
    int apart = s->owner[x] > 0 && s->owner[y] > 0 && s->owner[x] != s->owner[y];
    double a = s->amplitude[apart][at];
    if (!isfinite(a)) return INFINITY;
    double stretch = a * s->form[s->criterion[apart][at]][b];
    if (s->shape[apart][at] > 0.0) stretch *= scatter(s, s->shape[apart][at], x, b);
    return stretch;
}
