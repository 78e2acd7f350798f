/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The constants of a tensor, and what the parts of their errors add up to. */
#include "effective/error_bar.h"

#include "core/check.h"

#include <math.h>
#include <string.h>

static const char *const names[] = {
    "E1",          "E2",          "E3",  "nu12", "nu13", "nu21",        "nu23",
    "nu31",        "nu32",        "G23", "G13",  "G12",  "isotropic.E", "isotropic.nu",
    "isotropic.K", "isotropic.G", "C11", "C12",  "C13",  "C14",         "C15",
    "C16",         "C22",         "C23", "C24",  "C25",  "C26",         "C33",
    "C34",         "C35",         "C36", "C44",  "C45",  "C46",         "C55",
    "C56",         "C66"};
static const int nnames = sizeof names / sizeof *names;
_Static_assert(sizeof names / sizeof *names <= PH_MAX_ERROR_CONSTANTS,
               "PH_MAX_ERROR_CONSTANTS");

/* A constant below this share of the moduli beside it has no relative error worth a name. */
static const double too_small = 1e-3;

/* On grids that one takes, errors fall faster than they do in the limit, where they are of
 * first order: the order for which extrapolation leaves least (docs/validation/error-bars.md). */
static const double observed_order = 1.7;

const ph_sym4 *ph_i_error_tensor(const ph_error_evidence *e)
{
    return e->stiffness ? e->stiffness : &e->result->stiffness;
}

int ph_i_error_component(const ph_error_evidence *e, int component)
{
    return ph_i_error_tensor(e)->n == 3 && component == 5 ? 2 : component;
}

/* sqrt(C_ii C_jj) of an entry, Voigt: Mandel entries of shear are twice as large. */
double ph_i_error_beside(const ph_error_evidence *e, const ph_quantity *q)
{
    const ph_sym4 *c = ph_i_error_tensor(e);
    int a = ph_i_error_component(e, q->row), b = ph_i_error_component(e, q->column);
    double shears = (q->row > 2) + (q->column > 2);
    return sqrt(fabs(c->m[a][a] * c->m[b][b]) / exp2(shears));
}

double ph_i_error_value(const ph_error_evidence *e, const ph_quantity *q,
                        const ph_sym4 *stiffness)
{
    ph_result shell = {.grid = e->result->grid,
                       .stiffness = *stiffness,
                       .loads = (1u << stiffness->n) - 1u};
    double x = NAN;
    ph_quantity_value(q, &shell, &x, NULL); /* untouched on failure */
    return x;
}

/* Couplings have a relative error beside the diagonal entries of their row and column, Poisson
 * ratios beside one. */
static bool is_small(const ph_error_evidence *e, const ph_quantity *q, double value)
{
    if (q->name[0] == 'C') return fabs(value) < too_small * ph_i_error_beside(e, q);
    return fabs(value) <= (q->stress ? 0.0 : too_small);
}

/* Monotone in the tensor: between the values of Reuss and Voigt. */
static bool is_bounded(const ph_quantity *q)
{
    if (q->stress != 1) return false;
    return q->name[0] != 'C' || q->row == q->column;
}

static double farther_bound(const ph_error_evidence *e, const ph_quantity *q,
                            double value)
{
    const ph_result *r = e->result;
    if (e->stiffness || r->bond.present || r->damage || !is_bounded(q)) return INFINITY;
    double upper = ph_i_error_value(e, q, &r->voigt);
    double lower = r->reuss_is_zero ? 0.0 : ph_i_error_value(e, q, &r->reuss);
    if (!(lower <= value && value <= upper)) return INFINITY;
    return fmax(upper - value, value - lower);
}

/* Relative parts and their sum. */
static void add_up(const ph_error_evidence *e, const ph_quantity *q, unsigned parts,
                   ph_error_bar *bar, ph_error_constant *k)
{
    double squares = 0.0, plain = 0.0, size = fabs(k->value);
    for (size_t i = 0; i < ph_nerror_parts; i++) {
        const ph_error_part *p = &ph_error_parts[i];
        k->part[i] = NAN;
        if (!(parts >> i & 1u) || bar->why[i][0]) {
            if (parts >> i & 1u && p->needed && !k->why) k->why = bar->why[i];
            continue;
        }
        k->part[i] = p->error(e, q, k->value) / size;
        if (!isfinite(k->part[i]) && !k->why)
            k->why = "a part of the error could not be computed";
        if (p->bound)
            plain += k->part[i];
        else
            squares += k->part[i] * k->part[i];
    }
    k->bar = fmin(sqrt(squares) + plain, farther_bound(e, q, k->value) / size);
    if (k->why) k->bar = NAN;
}

static void judge(const ph_error_evidence *e, const ph_quantity *q, unsigned parts,
                  ph_error_bar *bar)
{
    const ph_sym4 *c = ph_i_error_tensor(e);
    ph_error_constant *k = &bar->constant[bar->count++];
    *k = (ph_error_constant){.bar = NAN, .richardson = NAN};
    memcpy(k->name, q->name, sizeof k->name - 1);
    for (size_t i = 0; i < PH_MAX_ERROR_PARTS; i++)
        k->part[i] = NAN;
    k->value = ph_i_error_value(e, q, c);
    if (!isfinite(k->value)) {
        k->why = "the stiffness has no such constant";
    } else if (is_small(e, q, k->value)) {
        k->why = "too small beside the others for a relative error";
    } else {
        add_up(e, q, parts, bar, k);
    }
    if (isfinite(k->value) && e->coarse && e->ratio > 0.0 && e->ratio != 1.0)
        k->richardson = k->value + (k->value - ph_i_error_value(e, q, e->coarse)) /
                                       (pow(e->ratio, observed_order) - 1.0);
}

static void say_why(const ph_error_evidence *e, unsigned parts, ph_error_bar *bar)
{
    for (size_t i = 0; i < ph_nerror_parts; i++) {
        const char *no = parts >> i & 1u ? ph_error_parts[i].refuses(e) : "not asked for";
        snprintf(bar->why[i], sizeof bar->why[i], "%s", no ? no : "");
    }
}

ph_status ph_error_bar_estimate(const ph_error_evidence *e, ph_error_bar *out,
                                ph_error *err)
{
    PH_GIVEN(e && e->result && out);
    ph_status st = PH_OK;
    const ph_sym4 *c = ph_i_error_tensor(e);
    unsigned parts = e->parts ? e->parts : ph_error_parts_auto();
    unsigned all = (1u << ph_strains(e->result->grid.kinematics)) - 1u;
    PH_CHECK(c->n == ph_strains(e->result->grid.kinematics), PH_EINVAL,
             "the tensor has n = %d, which its grid has not", c->n);
    PH_CHECK((e->result->loads & all) == all, PH_EINVAL,
             "error bars need all load cases to be solved");
    out->count = 0;
    out->ratio = e->ratio;
    say_why(e, parts, out);
    for (int i = 0; i < nnames; i++) {
        ph_quantity q;
        PH_TRY(ph_quantity_find(names[i], &q, err));
        if (ph_quantity_refuses(&q, e->result->grid.kinematics)) continue;
        judge(e, &q, parts, out);
    }
out:
    return st;
}

const ph_error_constant *ph_error_bar_find(const ph_error_bar *bar, const char *name)
{
    if (!bar || !name) return NULL;
    for (int i = 0; i < bar->count; i++)
        if (strcmp(bar->constant[i].name, name) == 0) return &bar->constant[i];
    return NULL;
}
