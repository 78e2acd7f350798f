/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which settings to begin with, from what the case is. */
#include "fidelity/fidelity.h"
#include "slope.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

/* Up to here errors fall faster than the law: slope / n sqrt(few / n). */
static const double few = 8;
/* The first grid is expected to be off by so many accuracies; what is offered is better. */
static const double first_2d = 1 / 1.2, first_3d = 1 / 0.6;
static const double for_solver = 0.1; /* of the accuracy, in energy */
static const double high_contrast = 1e3;
enum { FEWEST = 6, FEWEST_CRACKED = 24, MOST = 65536 };

void ph_i_fidelity_say(ph_fidelity_plan *p, const char *fmt, ...)
{
    va_list args;
    if (p->nwhy == PH_FIDELITY_WHY) return;
    va_start(args, fmt);
    vsnprintf(p->why[p->nwhy++], sizeof p->why[0], fmt, args);
    va_end(args);
}

int ph_i_fidelity_axes(const ph_case *c)
{
    return c->kinematics == PH_SPACE ? 3 : 2;
}

ptrdiff_t ph_i_fidelity_longest(const ptrdiff_t nodes[3])
{
    ptrdiff_t n = nodes[0];
    for (int a = 1; a < 3; a++)
        n = nodes[a] > n ? nodes[a] : n;
    return n;
}

ptrdiff_t ph_i_fidelity_round(double n)
{
    static const ptrdiff_t part[] = {4, 5, 6};
    for (ptrdiff_t unit = 1; unit <= MOST; unit *= 2)
        for (int i = 0; i < 3; i++)
            if ((double)(part[i] * unit) >= n && part[i] * unit % 2 == 0)
                return part[i] * unit;
    return MOST;
}

void ph_i_fidelity_grid(const ph_case *c, ptrdiff_t n, ptrdiff_t nodes[3])
{
    double share = (double)n / (double)ph_i_fidelity_longest(c->nodes);
    for (int a = 0; a < 3; a++) {
        ptrdiff_t k = (ptrdiff_t)floor((double)c->nodes[a] * share + 0.5);
        nodes[a] = c->nodes[a] <= 1 ? 1 : k < 2 ? 2 : k;
    }
}

static ph_status find_constants(const ph_case *c, ph_fidelity_plan *p, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_case_accuracy *a = &c->accuracy;
    for (int k = 0; k < a->nconstants && k < PH_TRADE_CONSTANTS; k++)
        PH_TRY(ph_quantity_find(a->constant[k], &p->constant[k], err));
    p->nconstants = a->nconstants;
    if (p->nconstants == 0) p->nconstants = ph_trade_constants(c, p->constant);
    PH_CHECK(p->nconstants > 0, PH_EINVAL, "accuracy: there is no constant to judge");
out:
    return st;
}

/* What the law of the microstructure makes of its bounds; bytes and seconds. */
static ph_status find_law(const ph_case *c, const ph_microstructure *micro,
                          ph_fidelity_plan *p, ph_error *err)
{
    ph_status st = PH_OK;
    ph_result *bounds = NULL;
    ph_problem problem = ph_rve_problem(c, micro, NULL);
    problem.constraint = (ph_constraint_params){.kind = "voigt"};
    problem.loading = NULL;
    problem.failure = NULL;
    problem.keep_fields = false;
    PH_TRY(ph_homogenise(&problem, NULL, &bounds, err));
    ph_estimate e = {0};
    problem.constraint = c->constraint;
    PH_TRY(ph_homogenise_estimate(&problem, &e, err));
    p->bytes_a_node = (double)e.bytes / (double)e.nodes;
    p->seconds_a_node = e.seconds / (double)e.nodes;
    const ph_i_slope law = ph_i_slope_of(micro, c->interface, bounds);
    p->spread = law.spread;
    p->boundary = law.boundary;
    p->slope = law.slope;
out:
    ph_result_free(&bounds);
    return st;
}

double ph_i_fidelity_contrast(const ph_case *c)
{
    double softest = INFINITY, stiffest = 0;
    for (int m = 0; m < c->nmaterials; m++) {
        double low, high;
        if (c->materials[m].is_void) return INFINITY;
        ph_sym4_eigenvalues(&c->materials[m].stiffness, &low, &high);
        softest = fmin(softest, low);
        stiffest = fmax(stiffest, high);
    }
    return stiffest / softest;
}

double ph_i_fidelity_expected(const ph_fidelity_plan *p, double n)
{
    return p->slope / n * sqrt(few / n);
}

static void choose_grid(const ph_case *c, ph_fidelity_plan *p)
{
    double first = ph_i_fidelity_axes(c) == 3 ? first_3d : first_2d;
    double n = pow(sqrt(few) * p->slope / (first * p->accuracy), 2.0 / 3.0);
    ptrdiff_t least = c->ncracks > 0 ? FEWEST_CRACKED : FEWEST;
    if (c->nfillers > 0) { /* the grid shows the fillers */
        ptrdiff_t drawn = ph_i_fidelity_longest(c->drawn_on);
        least = drawn > least ? drawn : least;
    }
    p->fixed = c->accuracy.given & PH_SETTING_NODES;
    if (p->fixed) {
        memcpy(p->nodes, c->nodes, sizeof p->nodes);
        ph_i_fidelity_say(p, "the case gives the nodes");
        return;
    }
    ph_i_fidelity_grid(c, ph_i_fidelity_round(fmax(n, (double)least)), p->nodes);
    ph_i_fidelity_say(p,
                      "ln(Voigt/Reuss) %.3g and a boundary in %.3g/n of the cells: error "
                      "about %.2g/n sqrt(8/n) on n nodes",
                      p->spread, p->boundary, p->slope);
    if (c->ncracks > 0) ph_i_fidelity_say(p, "cracks: at least %d nodes", FEWEST_CRACKED);
    if (c->nfillers > 0)
        ph_i_fidelity_say(p, "fillers are drawn on a grid: no coarser one shows them");
}

/* The bound of its energy is there for pristine periodic cells without voids. */
static bool energy_is_bounded(const ph_case *c, double contrast)
{
    const char *constraint = c->constraint.kind;
    return isfinite(contrast) && c->ncracks == 0 && strcmp(c->model.kind, "bond") != 0 &&
           (!constraint || strcmp(constraint, "periodic") == 0);
}

static void choose_tolerance(const ph_case *c, ph_fidelity_plan *p)
{
    double contrast = ph_i_fidelity_contrast(c);
    p->tolerance = c->solver.tolerance;
    if (c->accuracy.given & PH_SETTING_TOLERANCE) return;
    if (energy_is_bounded(c, contrast)) {
        p->energy = for_solver * p->accuracy;
        ph_i_fidelity_say(p, "solved until %.1g of the energy is left at most",
                          p->energy);
        return;
    }
    bool high = contrast > high_contrast;
    p->tolerance = fmin(high ? 1e-3 : 3e-2, high ? 0.1 * p->accuracy : p->accuracy);
    p->tolerance = fmax(p->tolerance, 1e-10);
    ph_i_fidelity_say(p, "tolerance %.1g: the energy is off by its square%s",
                      p->tolerance, high ? ", contrast above 1000" : "");
}

static void choose_rest(const ph_case *c, ph_fidelity_plan *p)
{
    choose_tolerance(c, p);
    if (!(c->accuracy.given & PH_SETTING_PRECISION))
        ph_i_fidelity_say(p, "precision auto: single where it was measured to take less "
                             "time and memory; the result says which");
    if (!(c->accuracy.given & (PH_SETTING_POINTS | PH_SETTING_MODEL)))
        ph_i_fidelity_say(
            p, "stress points: the error of nodes, half of finite elements' or less");
    if (!(c->accuracy.given & PH_SETTING_INTERFACE))
        ph_i_fidelity_say(
            p, "composite interface: half of the error of node centres or less");
}

ph_status ph_fidelity_plan_case(const ph_case *c, ph_fidelity_plan *out, ph_error *err)
{
    PH_GIVEN(c && out);
    ph_status st = PH_OK;
    ph_microstructure *micro = NULL;
    ph_fidelity_plan p = {.accuracy = c->accuracy.relative};
    PH_CHECK(p.accuracy > 0 && c->nmaterials > 0 && c->nodes[0] > 0, PH_EINVAL,
             "the case asks for no accuracy");
    PH_TRY(find_constants(c, &p, err));
    PH_TRY(ph_rve_build(c, &micro, err));
    PH_TRY(find_law(c, micro, &p, err));
    choose_grid(c, &p);
    choose_rest(c, &p);
    *out = p;
out:
    ph_microstructure_free(&micro);
    return st;
}
