/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The criteria, and what is kept of a failure. A spring at stretch s holds the pair energy
 * 1/2 V k E s^2 |xi|^4, and |xi_n| / (2 V) bonds of an offset pass through a unit of area. A
 * bond that breaks releases 1/2 k e- e+, its elongations before and after: of a bond in a
 * whole lattice e+ = e- / (1 - rho_b), where rho_b is its share in what holds its ends.
 *
 *   G = 1/4 E s_c^2 sum_b |xi_n| k_b |xi_b|^4 / (1 - rho_b)    critical stretch
 *   G = 1/2 w_c sum_b |xi_n| share_b V / (1 - rho_b)           energy w_c share_b V^2
 */
#include <perihom/failure.h>

#include "core/check.h"

#include <math.h>
#include <string.h>

static double same_stretch(double value, double E, const ph_bond_facts *bond)
{
    (void)E, (void)bond;
    return value;
}

static double stretch_from_energy(double G, double E, const ph_crossing *sum)
{
    return sqrt(4.0 * G / (E * sum->stretch));
}

/* 1/2 V k E s^2 |xi|^4 = w share V^2 */
static double energy_stretch(double value, double E, const ph_bond_facts *b)
{
    return sqrt(2.0 * value * b->share * b->volume / (b->k * E)) /
           (b->length * b->length);
}

static double bond_energy_from_energy(double G, double E, const ph_crossing *sum)
{
    (void)E;
    return 2.0 * G / sum->count;
}

static double never(double value, double E, const ph_bond_facts *bond)
{
    (void)value, (void)E, (void)bond;
    return INFINITY;
}

static double no_value(double G, double E, const ph_crossing *sum)
{
    (void)G, (void)E, (void)sum;
    return 0.0;
}

const ph_failure_criterion ph_failure_criteria[] = {
    {{"critical_stretch", "the same stretch for every bond length", "Silling2005",
      "brittle phases in tension; mixed modes by their opening only"},
     "critical_stretch",
     same_stretch,
     stretch_from_energy,
     false},
    {{"bond_energy", "the same energy for every bond length", "Foster2011",
      "model bond; brittle phases in tension"},
     "critical_bond_energy",
     energy_stretch,
     bond_energy_from_energy,
     true},
    {{"unbreakable", "bonds do not break", "", "phases far stronger than the others"},
     "unbreakable",
     never,
     no_value,
     false},
};
const size_t ph_nfailure_criteria =
    sizeof ph_failure_criteria / sizeof *ph_failure_criteria;

void ph_failure_path_free(ph_failure_path **path)
{
    if (!path || !*path) return;
    free((*path)->event);
    free((*path)->step);
    free((*path)->bond);
    free((*path)->share);
    free((*path)->initial);
    free((*path)->error);
    free(*path);
    *path = NULL;
}

ph_status ph_failure_field(const ph_failure_path *p, int step, double *field,
                           ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(p && field, PH_EINVAL, "NULL argument");
    PH_CHECK(step >= 0 && step < p->nsteps, PH_EINVAL, "step %d is outside 0..%d", step,
             p->nsteps - 1);
    memcpy(field, p->initial, sizeof *field * (size_t)p->cells);
    for (ptrdiff_t i = 0; i < p->nbonds && p->bond[i].event < p->step[step].events; i++) {
        double share = p->share[p->bond[i].bond]; /* of the opposite bond too */
        field[p->bond[i].node] += share;
        field[p->bond[i].other] += share;
    }
    for (ptrdiff_t x = 0; x < p->cells; x++)
        field[x] = fmin(field[x], 1.0);
out:
    return st;
}
